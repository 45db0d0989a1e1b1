// Implements io/system for Linux, other POSIX systems, and Emscripten.
#ifndef _WIN32

#include <fcntl.h>
#include <glob.h>
#include <poll.h>
#include <sys/file.h>
#include <sys/ioctl.h>
#include <sys/mman.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#ifdef __GLIBC__
#include <malloc.h>
#endif

#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <system_error>

#include "core/charconv.h"
#include "io/system/files.h"
#include "io/system/names.h"
#include "io/system/process.h"
#include "io/system/terminal.h"

namespace chronormal::inline internal {
namespace {

FileStatus status_from(const struct stat& found, int descriptor) {
  FileStatus status;
  if (S_ISDIR(found.st_mode))
    status.kind = FileStatus::Kind::kFolder;
  else if (S_ISCHR(found.st_mode) && descriptor >= 0 && ::isatty(descriptor) != 0)
    status.kind = FileStatus::Kind::kTerminal;
  else if (S_ISCHR(found.st_mode) || S_ISBLK(found.st_mode))
    status.kind = FileStatus::Kind::kDevice;
  else if (!S_ISREG(found.st_mode))
    status.kind = FileStatus::Kind::kPipe;
  status.size = static_cast<std::uint64_t>(found.st_size);
#ifdef __APPLE__
  const timespec& changed = found.st_mtimespec;
#else
  const timespec& changed = found.st_mtim;
#endif
  status.changed = std::int64_t{changed.tv_sec} * 1000000000 + changed.tv_nsec;
  status.volume = static_cast<std::uint64_t>(found.st_dev);
  status.number = static_cast<std::uint64_t>(found.st_ino);
  status.is_removed = found.st_nlink == 0;
  status.permissions = found.st_mode & 07777U;
  status.owner = found.st_uid;
  status.group = found.st_gid;
  return status;
}

// Opens a path. Tries again if a signal interrupts the call.
int open_path(const std::string& path, int flags, mode_t mode) {
  int descriptor = -1;
  do descriptor = ::open(path.c_str(), flags | O_CLOEXEC, mode);
  while (descriptor < 0 && errno == EINTR);
  return descriptor;
}

// Returns true if a call that failed with an error in errno should be repeated. If a pipe is not ready (EAGAIN),
// because the other side made it non-blocking, waits until the pipe is ready. If a signal interrupted the call (EINTR),
// does not wait. Returns false for all other errors.
bool may_go_on(int descriptor, short events) noexcept {
  if (errno == EINTR) return true;
  if (errno != EAGAIN) return false;
  pollfd waiting{descriptor, events, 0};
  return ::poll(&waiting, 1, -1) >= 0 || errno == EINTR;
}

}  // namespace

bool close_descriptor(int descriptor) noexcept { return ::close(descriptor) == 0 || errno == EINTR; }

Error failure(const std::string& path, int system_error) {
  return Error{ErrorCode::kFailed, path, std::generic_category().message(system_error)};
}

std::optional<FileStatus> status_of(const std::string& path) {
  struct stat found {};
  if (::stat(path.c_str(), &found) != 0) return std::nullopt;
  return status_from(found, -1);
}

std::optional<FileStatus> status_of(int descriptor) {
  struct stat found {};
  if (::fstat(descriptor, &found) != 0) return std::nullopt;
  return status_from(found, descriptor);
}

Descriptor open_file(const std::string& path, const Opening& how) {
  int flags = how.reads && how.writes ? O_RDWR : how.writes ? O_WRONLY : O_RDONLY | O_NOCTTY;
  if (how.makes != Opening::Makes::kNothing) flags |= O_CREAT;
  if (how.makes == Opening::Makes::kNew) flags |= O_EXCL;
  if (!how.follows_links) flags |= O_NOFOLLOW;
  if (!how.waits) flags |= O_NONBLOCK;
  return Descriptor(open_path(path, flags, how.is_private ? 0600 : 0666));
}

std::optional<int> stream_of(std::string_view path) {
  if (path == "-" || path == "/dev/stdout") return kStandardOutput;
  if (path == "/dev/stderr") return kStandardError;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!path.starts_with(folder)) continue;
    int number = -1;
    const char* const last = path.data() + path.size();
    const auto [end, code] = from_chars(path.data() + folder.size(), last, number);
    if (code == std::errc{} && end == last && number >= 0) return number;
  }
  return std::nullopt;
}

void never_wait(int descriptor) noexcept { (void)::fcntl(descriptor, F_SETFL, O_NONBLOCK); }

std::optional<std::size_t> read_some(int descriptor, std::span<char> bytes, bool waits) {
  for (;;) {
    const ssize_t count = ::read(descriptor, bytes.data(), bytes.size());
    if (count >= 0) return static_cast<std::size_t>(count);
    if ((!waits && errno == EAGAIN) || !may_go_on(descriptor, POLLIN)) return std::nullopt;
  }
}

bool write_bytes(int descriptor, std::string_view bytes) noexcept {
  while (!bytes.empty()) {
    const ssize_t count = ::write(descriptor, bytes.data(), bytes.size());
    if (count > 0) {
      bytes.remove_prefix(static_cast<std::size_t>(count));
      // write() should never return 0 here. Treating 0 as an error avoids an endless loop.
    } else if (count == 0) {
      errno = EIO;
      return false;
    } else if (!may_go_on(descriptor, POLLOUT)) {
      return false;
    }
  }
  return true;
}

std::optional<std::span<char>> read_at(int descriptor, std::uint64_t at, std::span<char> bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pread(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return std::nullopt;
    if (count == 0) break;
    at += static_cast<std::uint64_t>(count);
    bytes = bytes.subspan(static_cast<std::size_t>(count));
  }
  return bytes;
}

bool write_at(int descriptor, std::uint64_t at, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    at += static_cast<std::uint64_t>(count);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

bool set_end(int descriptor, std::uint64_t size) {
  const auto end = static_cast<off_t>(size);
  return ::ftruncate(descriptor, end) == 0 && ::lseek(descriptor, end, SEEK_SET) == end;
}

void forget_bytes([[maybe_unused]] int descriptor, [[maybe_unused]] std::uint64_t at,
                  [[maybe_unused]] std::uint64_t size) noexcept {
#ifdef __linux__
  // The system can use the freed pages for the next files, and the bytes that were in them are never written to the
  // disk.
  (void)::fallocate(descriptor, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, static_cast<off_t>(at),
                    static_cast<off_t>(size));
#endif
}

std::uint64_t written_bytes([[maybe_unused]] int descriptor, std::uint64_t size,
                            [[maybe_unused]] std::uint64_t enough) {
#if defined(SEEK_DATA) && defined(SEEK_HOLE)
  std::uint64_t written = 0;
  off_t hole = 0;
  while (written < enough) {
    const off_t data = ::lseek(descriptor, hole, SEEK_DATA);
    if (data < 0 && errno == ENXIO) break;  // the rest of the file is a hole
    hole = data < 0 ? -1 : ::lseek(descriptor, data, SEEK_HOLE);
    if (hole <= data) {
      written = size;
      break;
    }
    written += static_cast<std::uint64_t>(hole - data);
  }
  (void)::lseek(descriptor, 0, SEEK_SET);
  return written;
#else
  return size;
#endif
}

bool take_permissions(int descriptor, const FileStatus& old) {
  // Only root may give a file to another owner, so a failure is not an error.
  if (::fchown(descriptor, old.owner, old.group) != 0) errno = 0;
  return ::fchmod(descriptor, static_cast<mode_t>(old.permissions)) == 0;
}

bool flush_file(int descriptor) { return ::fsync(descriptor) == 0 || errno == EINVAL || errno == EROFS; }

void flush_folder_of(const std::string& path) {
  const std::string folder = folder_of(path);
  const Descriptor descriptor(open_path(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY, 0));
  if (descriptor.is_open()) (void)::fsync(descriptor.number());
}

bool lock_file(int descriptor) noexcept { return ::flock(descriptor, LOCK_EX | LOCK_NB) == 0 || errno != EWOULDBLOCK; }

bool remove_file(const char* path) noexcept { return ::unlink(path) == 0; }

bool rename_file(const char* from, const char* to, bool replace) noexcept {
#ifdef RENAME_NOREPLACE
  if (!replace) {
    if (::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return true;
    if (errno != EINVAL && errno != ENOSYS) return false;
  }
#endif
  return std::rename(from, to) == 0;
}

const char* map_file(int descriptor, std::size_t size) noexcept {
  void* const mapping = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, descriptor, 0);
  if (mapping == MAP_FAILED) return nullptr;
  (void)::madvise(mapping, size, MADV_SEQUENTIAL);
  return static_cast<const char*>(mapping);
}

// Mappings are read-only and private to this process (MAP_PRIVATE), so the const_casts do no harm.
void unmap(const char* bytes, std::size_t size) noexcept { (void)::munmap(const_cast<char*>(bytes), size); }

void release_mapping(const char* bytes, std::size_t size) noexcept {
  (void)::madvise(const_cast<char*>(bytes), size, MADV_DONTNEED);
}

std::uint64_t random_number() noexcept {
  std::uint64_t number = 0;
  if (::getentropy(&number, sizeof number) != 0)
    number = static_cast<std::uint64_t>(::getpid()) << 32U ^ reinterpret_cast<std::uintptr_t>(&number);
  return number;
}

std::vector<std::string> match_pattern(const std::string& pattern, bool has_escapes) {
  std::vector<std::string> files;
  glob_t matches{};
  const int code = ::glob(pattern.c_str(), GLOB_NOSORT | (has_escapes ? 0 : GLOB_NOESCAPE), nullptr, &matches);
  for (std::size_t i = 0; code == 0 && i < matches.gl_pathc; ++i) files.emplace_back(matches.gl_pathv[i]);
  ::globfree(&matches);
  return files;
}

std::filesystem::path path_of(std::string_view name) { return name; }

std::string utf8_of(const std::filesystem::path& path) { return path.string(); }

std::span<char*> arguments_of_program(int count, char** arguments) {
  return {arguments, static_cast<std::size_t>(count)};
}

std::optional<std::string> file_of_program() {
  std::error_code failed;
  const std::filesystem::path program = std::filesystem::read_symlink("/proc/self/exe", failed);
  return failed ? std::nullopt : std::optional(program.string());
}

bool is_terminal(int stream) noexcept { return ::isatty(stream) != 0; }

bool is_clever_terminal(int stream) noexcept {
  const char* const kind = std::getenv("TERM");
  return is_terminal(stream) && (kind == nullptr || std::string_view(kind) != "dumb");
}

bool has_colours(int stream) noexcept {
  const char* const kind = std::getenv("TERM");
  return kind != nullptr && *kind != '\0' && is_clever_terminal(stream);
}

std::size_t columns_of_terminal(int stream) noexcept {
  winsize size{};
  return is_terminal(stream) && ::ioctl(stream, TIOCGWINSZ, &size) == 0 ? size.ws_col : 0;
}

namespace {

struct Request {
  int signal;
  const char* message;
};

constexpr Request kRequests[] = {
    {SIGHUP, "the program was stopped, since its terminal was closed (SIGHUP)"},
    {SIGINT, "interrupted (SIGINT)"},
    {SIGQUIT, "stopped (SIGQUIT)"},
    {SIGTERM, "stopped (SIGTERM)"},
    {SIGXCPU, "the program was stopped, since it used more time than allowed (SIGXCPU)"},
};

// The functions that the signal handlers call. These functions are set before the handlers are installed.
Endings watched{};

extern "C" void end_by_request(int signal) {
  for (const Request& request : kRequests) {
    if (request.signal == signal) watched.by_request(request.message);
  }
  // SA_RESETHAND has restored the default action of the signal. That action runs when this handler returns.
  (void)std::raise(signal);
}

extern "C" void end_by_lost_reader(int signal) {
  if (!watched.by_lost_reader()) return;
  (void)std::signal(signal, SIG_DFL);
  (void)std::raise(signal);
}

extern "C" void end_by_lost_input(int /*signal*/) { watched.by_lost_input(); }

extern "C" void end_by_abort(int /*signal*/) { watched.by_abort(); }

void install(int signal, void (*handler)(int), unsigned flags = SA_RESETHAND) {
  struct sigaction action {};
  action.sa_handler = handler;
  // SA_RESETHAND in `flags` does no harm if the action is SIG_IGN, because an ignored signal runs no handler.
  action.sa_flags = static_cast<int>(flags);
  (void)sigfillset(&action.sa_mask);  // without ::, because it is a macro on macOS
  (void)::sigaction(signal, &action, nullptr);
}

bool is_ignored(int signal) {
  struct sigaction action {};
  return ::sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

}  // namespace

// Opens /dev/null for each closed standard stream, in the direction that the program does not use. The system assigns
// the lowest free number, so the new descriptor has the number of the closed stream.
void prepare_standard_streams() noexcept {
  for (int stream = kStandardInput; stream <= kStandardError; ++stream) {
    if (::fcntl(stream, F_GETFD) >= 0 || errno != EBADF) continue;
    if (::open("/dev/null", stream == kStandardInput ? O_WRONLY : O_RDONLY) < 0) return;
  }
}

void watch_endings(const Endings& endings) noexcept {
  watched = endings;
  for (const Request& request : kRequests) {
    if (!is_ignored(request.signal)) install(request.signal, end_by_request);
  }
  install(SIGBUS, end_by_lost_input);
  install(SIGXFSZ, SIG_IGN);
  if (!is_ignored(SIGPIPE)) install(SIGPIPE, end_by_lost_reader, 0);
  if (endings.by_abort != nullptr) install(SIGABRT, end_by_abort);
}

void give_back_free_memory() noexcept {
#ifdef __GLIBC__
  (void)::malloc_trim(0);
#endif
}

void end_now(int exit_code) { ::_exit(exit_code); }

}  // namespace chronormal::inline internal

#endif  // _WIN32
