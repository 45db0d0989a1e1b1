/// Makes a process unable to open files, to cause errors of the system that no file can cause.
#ifndef CHRONORMAL_TESTS_SUPPORT_NO_DESCRIPTORS_H_
#define CHRONORMAL_TESTS_SUPPORT_NO_DESCRIPTORS_H_

#include <sys/resource.h>

namespace chronormal::test {

/// An object during whose lifetime this process can open neither files nor folders.
class NoDescriptors {
 public:
  NoDescriptors() {
    ::getrlimit(RLIMIT_NOFILE, &saved_);
    const rlimit none{0, saved_.rlim_max};
    ::setrlimit(RLIMIT_NOFILE, &none);
  }
  NoDescriptors(const NoDescriptors&) = delete;
  NoDescriptors& operator=(const NoDescriptors&) = delete;
  ~NoDescriptors() { ::setrlimit(RLIMIT_NOFILE, &saved_); }

 private:
  rlimit saved_{};
};

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_NO_DESCRIPTORS_H_
