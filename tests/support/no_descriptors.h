/// Makes a process unable to open files. Tests thus cause errors of the operating system that no damaged file can
/// cause.
#ifndef CHRONORMAL_TESTS_SUPPORT_NO_DESCRIPTORS_H_
#define CHRONORMAL_TESTS_SUPPORT_NO_DESCRIPTORS_H_

#include <sys/resource.h>

namespace chronormal::test {

/// An object that keeps this process from opening files and folders as long as the object lives.
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
