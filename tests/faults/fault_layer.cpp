// A layer between the program and the system, in which the n-th call fails. LD_PRELOAD inserts the layer, so the
// program under test is exactly the program that users have.
//
//     CHRONORMAL_FAULT=write:3:28          the third write() fails with errno 28 (ENOSPC)
//     CHRONORMAL_FAULT=write:3:28+         the third and all later write() fail
//     CHRONORMAL_FAULT=write:3:short       the third write() writes half of its bytes
//     CHRONORMAL_FAULT=mmap:1:short        the file that is mapped first is empty from then on
//     CHRONORMAL_FAULT=any:7:signal15      before the seventh call of any kind but malloc, the process gets SIGTERM
//     CHRONORMAL_FAULT=A,B                 two faults A and B
//     CHRONORMAL_ROUNDING=down             floating-point numbers are rounded down from the start, or "up", or to
//                                          "zero"
//     CHRONORMAL_FAULT_COUNTS=FILE         at the end, FILE gets the number of calls of each kind and, as "start", the
//                                          number of allocations before the first call of another kind
//
// Only calls after the start of main() count, since earlier calls belong to the libraries. A close() that fails still
// closes the file, as on Linux, and an unlink() that fails still removes the file. fsync() only counts its calls, since
// no power is cut. The layer never allocates memory, and calls the kernel directly.

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/file.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/types.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cfenv>
#include <csignal>
#include <cstdarg>
#include <cstddef>
#include <cstdlib>
#include <cstring>

extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t count, std::size_t size);
void* __libc_realloc(void* old, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
}

namespace {

enum Kind {
  kMalloc,
  kWrite,
  kRead,
  kFsync,
  kClose,
  kRename,
  kOpen,
  kMmap,
  kStat,
  kChange,
  kTruncate,
  kSeek,
  kUnlink,
  kLock,
  kThread,
  kAny,
  kKinds
};
constexpr const char* kNames[kKinds] = {"malloc", "write",  "read",     "fsync", "close",  "rename", "open",   "mmap",
                                        "stat",   "change", "truncate", "seek",  "unlink", "lock",   "thread", "any"};

struct Fault {
  int kind = kKinds;
  long number = 0;
  int error = 0, signal = 0;
  bool is_short = false, goes_on = false;
};

constexpr int kMostFaults = 2;
Fault faults[kMostFaults];
std::atomic<long> counts[kKinds];
std::atomic<long> mallocs_at_start{-1};  // number of malloc() calls before a call of another kind; -1 until then
std::atomic<bool> is_armed{false};

long number_at(const char*& text) {
  long value = 0;
  while (*text >= '0' && *text <= '9') value = 10 * value + (*text++ - '0');
  return value;
}

bool take(const char*& text, const char* word) {
  const std::size_t length = std::strlen(word);
  if (std::strncmp(text, word, length) != 0) return false;
  text += length;
  return true;
}

__attribute__((constructor)) void set_rounding() {
  const char* text = std::getenv("CHRONORMAL_ROUNDING");
  if (text != nullptr) std::fesetround(*text == 'd' ? FE_DOWNWARD : *text == 'u' ? FE_UPWARD : FE_TOWARDZERO);
}

__attribute__((constructor)) void read_faults() {
  const char* text = std::getenv("CHRONORMAL_FAULT");
  for (int i = 0; text != nullptr && *text != '\0' && i < kMostFaults; ++i) {
    Fault& fault = faults[i];
    for (int kind = 0; kind < kKinds && fault.kind == kKinds; ++kind) {
      if (take(text, kNames[kind])) fault.kind = kind;
    }
    if (!take(text, ":")) std::abort();
    fault.number = number_at(text);
    if (!take(text, ":")) std::abort();
    if (take(text, "short"))
      fault.is_short = true;
    else if (take(text, "signal"))
      fault.signal = static_cast<int>(number_at(text));
    else
      fault.error = static_cast<int>(number_at(text));
    fault.goes_on = take(text, "+");
    if (*text != '\0' && !take(text, ",")) std::abort();
  }
}

void write_count(long file, const char* name, long number) {
  char line[64];
  std::size_t end = 0;
  for (const char* c = name; *c != '\0'; ++c) line[end++] = *c;
  line[end++] = ' ';
  char digits[24];
  int count = 0;
  for (long rest = number; rest > 0 || count == 0; rest /= 10) digits[count++] = static_cast<char>('0' + rest % 10);
  while (count > 0) line[end++] = digits[--count];
  line[end++] = '\n';
  (void)::syscall(SYS_write, file, line, end);
}

__attribute__((destructor)) void write_counts() {
  const char* path = std::getenv("CHRONORMAL_FAULT_COUNTS");
  if (path == nullptr) return;
  const long file = ::syscall(SYS_openat, AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
  for (int kind = 0; kind < kKinds; ++kind) write_count(file, kNames[kind], counts[kind]);
  write_count(file, "start", mallocs_at_start >= 0 ? mallocs_at_start.load() : counts[kMalloc].load());
  (void)::syscall(SYS_close, file);
}

// Counts a call of the given kind. Returns the fault that was requested for this call, or nullptr.
const Fault* fault_at(int kind) {
  if (!is_armed) return nullptr;
  const long number = ++counts[kind], any = kind == kMalloc ? 0 : ++counts[kAny];
  if (any == 1) mallocs_at_start = counts[kMalloc].load();
  const Fault* found = nullptr;
  for (const Fault& fault : faults) {
    const long now = fault.kind == kind ? number : fault.kind == kAny ? any : 0;
    if (now == 0 || (now != fault.number && !(fault.goes_on && now > fault.number))) continue;
    if (fault.signal != 0)
      (void)std::raise(fault.signal);
    else
      found = &fault;
  }
  return found;
}

// Tells whether a call of the given kind must fail with an error, and sets errno if so.
bool fails(int kind) {
  const Fault* const fault = fault_at(kind);
  if (fault == nullptr || fault->is_short) return false;
  errno = fault->error;
  return true;
}

int (*real_main)(int, char**, char**) = nullptr;

int armed_main(int count, char** arguments, char** environment) {
  is_armed = true;
  return real_main(count, arguments, environment);
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

mode_t mode_of(int flags, va_list rest) {
  return (flags & (O_CREAT | __O_TMPFILE)) != 0 ? static_cast<mode_t>(va_arg(rest, int)) : 0;
}

}  // namespace

extern "C" {

int __libc_start_main(int (*main)(int, char**, char**), int count, char** arguments, void (*init)(), void (*fini)(),
                      void (*rtld_fini)(), void* stack_end) {
  real_main = main;
  using Start = int(int (*)(int, char**, char**), int, char**, void (*)(), void (*)(), void (*)(), void*);
  return next<Start>("__libc_start_main")(armed_main, count, arguments, init, fini, rtld_fini, stack_end);
}

void* malloc(std::size_t size) { return fails(kMalloc) ? nullptr : __libc_malloc(size); }
void* calloc(std::size_t count, std::size_t size) { return fails(kMalloc) ? nullptr : __libc_calloc(count, size); }
void* realloc(void* old, std::size_t size) { return fails(kMalloc) ? nullptr : __libc_realloc(old, size); }
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  return fails(kMalloc) ? nullptr : __libc_memalign(alignment, size);
}
int posix_memalign(void** result, std::size_t alignment, std::size_t size) {
  if (fails(kMalloc)) return ENOMEM;
  *result = __libc_memalign(alignment, size);
  return *result == nullptr ? ENOMEM : 0;
}

ssize_t write(int file, const void* bytes, std::size_t size) {
  const Fault* const fault = fault_at(kWrite);
  if (fault != nullptr && !fault->is_short) {
    errno = fault->error;
    return -1;
  }
  return ::syscall(SYS_write, file, bytes, fault != nullptr && size > 1 ? size / 2 : size);
}
ssize_t pwrite(int file, const void* bytes, std::size_t size, off_t at) {
  const Fault* const fault = fault_at(kWrite);
  if (fault != nullptr && !fault->is_short) {
    errno = fault->error;
    return -1;
  }
  return ::syscall(SYS_pwrite64, file, bytes, fault != nullptr && size > 1 ? size / 2 : size, at);
}
int ftruncate(int file, off_t size) noexcept {
  return fails(kTruncate) ? -1 : static_cast<int>(::syscall(SYS_ftruncate, file, size));
}
off_t lseek(int file, off_t at, int from) noexcept {
  return fails(kSeek) ? -1 : static_cast<off_t>(::syscall(SYS_lseek, file, at, from));
}
// Deletes the file even if the call must return an error. The test then finds no remains that the program had no way to
// delete.
int unlink(const char* path) noexcept {
  const bool is_refused = fails(kUnlink);
  const long result = ::syscall(SYS_unlinkat, AT_FDCWD, path, 0);
  return is_refused ? -1 : static_cast<int>(result);
}
int flock(int file, int operation) noexcept {
  return fails(kLock) ? -1 : static_cast<int>(::syscall(SYS_flock, file, operation));
}
ssize_t read(int file, void* bytes, std::size_t size) {
  const Fault* const fault = fault_at(kRead);
  if (fault != nullptr && !fault->is_short) {
    errno = fault->error;
    return -1;
  }
  return ::syscall(SYS_read, file, bytes, fault != nullptr && size > 1 ? size / 2 : size);
}
ssize_t pread(int file, void* bytes, std::size_t size, off_t at) {
  const Fault* const fault = fault_at(kRead);
  if (fault != nullptr && !fault->is_short) {
    errno = fault->error;
    return -1;
  }
  return ::syscall(SYS_pread64, file, bytes, fault != nullptr && size > 1 ? size / 2 : size, at);
}
int fsync(int /*file*/) { return fails(kFsync) ? -1 : 0; }
int close(int file) {
  const Fault* const fault = fault_at(kClose);
  const long result = ::syscall(SYS_close, file);
  if (fault == nullptr || fault->is_short) return static_cast<int>(result);
  errno = fault->error;
  return -1;
}
int rename(const char* from, const char* to) noexcept {
  return fails(kRename) ? -1 : static_cast<int>(::syscall(SYS_rename, from, to));
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) noexcept {
  return fails(kRename) ? -1 : static_cast<int>(::syscall(SYS_renameat2, from_folder, from, to_folder, to, flags));
}
int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return fails(kOpen) ? -1 : static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}
int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = mode_of(flags, rest);
  va_end(rest);
  return fails(kOpen) ? -1 : static_cast<int>(::syscall(SYS_openat, AT_FDCWD, path, flags, mode));
}
void* mmap(void* at, std::size_t size, int protection, int flags, int file, off_t offset) noexcept {
  const Fault* const fault = fault_at(kMmap);
  if (fault != nullptr && !fault->is_short) {
    errno = fault->error;
    return MAP_FAILED;
  }
  void* const result = reinterpret_cast<void*>(::syscall(SYS_mmap, at, size, protection, flags, file, offset));
  if (fault != nullptr && file >= 0) {
    char path[32] = "/proc/self/fd/";
    std::size_t end = std::strlen(path);
    if (file >= 10) path[end++] = static_cast<char>('0' + file / 10);
    path[end] = static_cast<char>('0' + file % 10);
    (void)::truncate(path, 0);
  }
  return result;
}
int stat(const char* path, struct stat* result) noexcept {
  return fails(kStat) ? -1 : static_cast<int>(::syscall(SYS_stat, path, result));
}
int fstat(int file, struct stat* result) noexcept {
  return fails(kStat) ? -1 : static_cast<int>(::syscall(SYS_fstat, file, result));
}
int fchmod(int file, mode_t mode) noexcept {
  return fails(kChange) ? -1 : static_cast<int>(::syscall(SYS_fchmod, file, mode));
}
int fchown(int file, uid_t user, gid_t group) noexcept {
  return fails(kChange) ? -1 : static_cast<int>(::syscall(SYS_fchown, file, user, group));
}
int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*body)(void*), void* argument) noexcept {
  const Fault* const fault = fault_at(kThread);
  if (fault != nullptr && !fault->is_short) return fault->error;
  using Create = int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  return next<Create>("pthread_create")(thread, attributes, body, argument);
}

}  // extern "C"
