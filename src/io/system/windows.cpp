// Implements io/system for Windows. Descriptors are those of the C library of Windows, but files are opened by calls of
// the system. So names can be in UTF-16, bytes pass unchanged, and a file can be renamed and removed while it is open.
#ifdef _WIN32

#define WIN32_LEAN_AND_MEAN
#ifndef NOMINMAX
#define NOMINMAX
#endif
#include <fcntl.h>
#include <io.h>
#include <windows.h>

#include <shellapi.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <exception>
#include <random>
#include <system_error>

#include "io/system/files.h"
#include "io/system/names.h"
#include "io/system/process.h"
#include "io/system/terminal.h"

namespace chronormal::inline internal {
namespace {

constexpr DWORD kShared = FILE_SHARE_READ | FILE_SHARE_WRITE | FILE_SHARE_DELETE;

std::wstring wide(std::string_view text) {
  const int size = static_cast<int>(text.size());
  std::wstring result(static_cast<std::size_t>(::MultiByteToWideChar(CP_UTF8, 0, text.data(), size, nullptr, 0)),
                      L'\0');
  ::MultiByteToWideChar(CP_UTF8, 0, text.data(), size, result.data(), static_cast<int>(result.size()));
  return result;
}

std::string narrow(std::wstring_view text) {
  const int size = static_cast<int>(text.size());
  const int count = ::WideCharToMultiByte(CP_UTF8, 0, text.data(), size, nullptr, 0, nullptr, nullptr);
  std::string result(static_cast<std::size_t>(count), '\0');
  ::WideCharToMultiByte(CP_UTF8, 0, text.data(), size, result.data(), count, nullptr, nullptr);
  return result;
}

// Sets errno from the last error of Windows, and returns false.
bool fail() noexcept {
  switch (::GetLastError()) {
    case ERROR_FILE_NOT_FOUND:
    case ERROR_PATH_NOT_FOUND:
    case ERROR_INVALID_DRIVE:
    case ERROR_INVALID_NAME:
    case ERROR_BAD_NETPATH:
    case ERROR_BAD_NET_NAME:
      errno = ENOENT;
      break;
    case ERROR_FILE_EXISTS:
    case ERROR_ALREADY_EXISTS:
      errno = EEXIST;
      break;
    case ERROR_SHARING_VIOLATION:
    case ERROR_LOCK_VIOLATION:
    case ERROR_USER_MAPPED_FILE:
      errno = EBUSY;
      break;
    case ERROR_HANDLE_DISK_FULL:
    case ERROR_DISK_FULL:
      errno = ENOSPC;
      break;
    case ERROR_FILENAME_EXCED_RANGE:
      errno = ENAMETOOLONG;
      break;
    case ERROR_TOO_MANY_OPEN_FILES:
      errno = EMFILE;
      break;
    case ERROR_NOT_ENOUGH_MEMORY:
    case ERROR_COMMITMENT_LIMIT:
    case ERROR_OUTOFMEMORY:
      errno = ENOMEM;
      break;
    case ERROR_BROKEN_PIPE:
    case ERROR_NO_DATA:
      errno = EPIPE;
      break;
    case ERROR_WRITE_PROTECT:
      errno = EROFS;
      break;
    case ERROR_INVALID_HANDLE:
      errno = EBADF;
      break;
    case ERROR_DIRECTORY:
      errno = ENOTDIR;
      break;
    case ERROR_ACCESS_DENIED:
      errno = EACCES;
      break;
    default:
      errno = EIO;
  }
  return false;
}

HANDLE handle_of(int descriptor) noexcept { return reinterpret_cast<HANDLE>(::_get_osfhandle(descriptor)); }

bool is_console(int descriptor) noexcept {
  DWORD mode = 0;
  return ::GetConsoleMode(handle_of(descriptor), &mode) != 0;
}

constexpr std::uint64_t joined(DWORD high, DWORD low) noexcept { return std::uint64_t{high} << 32 | low; }

std::optional<FileStatus> status_from(HANDLE handle) {
  FileStatus status;
  DWORD mode = 0;
  switch (::GetFileType(handle)) {
    case FILE_TYPE_CHAR:
      status.kind = ::GetConsoleMode(handle, &mode) != 0 ? FileStatus::Kind::kTerminal : FileStatus::Kind::kDevice;
      return status;
    case FILE_TYPE_PIPE:
      status.kind = FileStatus::Kind::kPipe;
      return status;
    default:
      break;
  }
  BY_HANDLE_FILE_INFORMATION found{};
  if (::GetFileInformationByHandle(handle, &found) == 0) {
    // Under Wine, only GetFileSizeEx() and GetFileTime() work for a file that is the standard input.
    LARGE_INTEGER size{};
    if (::GetFileSizeEx(handle, &size) == 0 || ::GetFileTime(handle, nullptr, nullptr, &found.ftLastWriteTime) == 0) {
      (void)fail();
      return std::nullopt;
    }
    found.nFileSizeHigh = static_cast<DWORD>(size.HighPart);
    found.nFileSizeLow = size.LowPart;
    found.nNumberOfLinks = 1;
  }
  if ((found.dwFileAttributes & FILE_ATTRIBUTE_DIRECTORY) != 0) status.kind = FileStatus::Kind::kFolder;
  status.size = joined(found.nFileSizeHigh, found.nFileSizeLow);
  // Windows counts times in units of 100 nanoseconds from the year 1601.
  const auto ticks =
      static_cast<std::int64_t>(joined(found.ftLastWriteTime.dwHighDateTime, found.ftLastWriteTime.dwLowDateTime));
  status.changed = (ticks - 116444736000000000) * 100;
  status.volume = found.dwVolumeSerialNumber;
  status.number = joined(found.nFileIndexHigh, found.nFileIndexLow);
  status.is_removed = found.nNumberOfLinks == 0;
  return status;
}

HANDLE open_handle(const std::string& path, DWORD access, DWORD makes) {
  return ::CreateFileW(wide(path).c_str(), access, kShared, nullptr, makes,
                       FILE_ATTRIBUTE_NORMAL | FILE_FLAG_BACKUP_SEMANTICS, nullptr);  // the flags also open folders
}

// Calls ReadFile() or WriteFile() for the bytes of a file from offset `at` on.
template <class Call, class Bytes>
std::optional<std::size_t> call_at(Call call, int descriptor, std::uint64_t at, Bytes* bytes, std::size_t size) {
  constexpr std::size_t kMost = std::size_t{1} << 30;
  OVERLAPPED place{};
  place.Offset = static_cast<DWORD>(at);
  place.OffsetHigh = static_cast<DWORD>(at >> 32);
  DWORD count = 0;
  if (call(handle_of(descriptor), bytes, static_cast<DWORD>(std::min(size, kMost)), &count, &place) != 0) return count;
  if (::GetLastError() == ERROR_HANDLE_EOF) return 0;
  (void)fail();
  return std::nullopt;
}

// Writes text to a console in UTF-16, so that the code page of the console does not matter. A console takes less than
// 32 KiB at a time, so long text is written in parts.
bool write_to_console(HANDLE console, std::string_view text) {
  constexpr std::size_t kMost = std::size_t{1} << 13;
  while (!text.empty()) {
    std::size_t size = std::min(text.size(), kMost);
    // Returns true if the text would be cut inside a character.
    const auto is_inside = [&] { return (static_cast<unsigned char>(text[size]) & 0xC0U) == 0x80U; };
    for (int back = 0; size < text.size() && size > 1 && back < 3 && is_inside(); ++back) --size;
    const std::wstring wide_text = wide(text.substr(0, size));
    DWORD count = 0;
    if (::WriteConsoleW(console, wide_text.data(), static_cast<DWORD>(wide_text.size()), &count, nullptr) == 0)
      return fail();
    text.remove_prefix(size);
  }
  return true;
}

// Returns true if a name matches a pattern with *, ? and [...]. Upper and lower case are equal, as in file names of
// Windows.
bool matches(std::wstring_view pattern, std::wstring_view name) {
  const auto folded = [](wchar_t c) {
    return reinterpret_cast<std::uintptr_t>(
        ::CharLowerW(reinterpret_cast<wchar_t*>(std::uintptr_t{static_cast<std::uint16_t>(c)})));
  };
  if (pattern.empty()) return name.empty();
  if (pattern.front() == L'*') {
    for (std::size_t skipped = 0; skipped <= name.size(); ++skipped) {
      if (matches(pattern.substr(1), name.substr(skipped))) return true;
    }
    return false;
  }
  if (name.empty()) return false;
  if (pattern.front() == L'[') {
    const bool is_negative = pattern.size() > 1 && (pattern[1] == L'!' || pattern[1] == L'^');
    const std::size_t first = is_negative ? 2 : 1, end = pattern.find(L']', first + 1);
    if (end != std::wstring_view::npos) {
      bool is_in = false;
      for (std::size_t i = first; i < end; ++i) {
        const bool is_range = i + 2 < end && pattern[i + 1] == L'-';
        const std::size_t last = is_range ? i + 2 : i;
        is_in = is_in || (folded(pattern[i]) <= folded(name.front()) && folded(name.front()) <= folded(pattern[last]));
        i = last;
      }
      return is_in != is_negative && matches(pattern.substr(end + 1), name.substr(1));
    }
  }
  const bool is_same = pattern.front() == L'?' || folded(pattern.front()) == folded(name.front());
  return is_same && matches(pattern.substr(1), name.substr(1));
}

bool is_pattern(std::string_view text) { return text.find_first_of("*?[") != std::string_view::npos; }

}  // namespace

bool close_descriptor(int descriptor) noexcept { return ::_close(descriptor) == 0; }

Error failure(const std::string& path, int system_error) {
  const std::string reason = system_error == EBUSY   ? "another program is using this file; close it there"
                             : system_error == EPIPE ? "Broken pipe"
                                                     : std::generic_category().message(system_error);
  return Error{ErrorCode::kFailed, path, reason};
}

std::optional<FileStatus> status_of(const std::string& path) {
  const HANDLE handle = open_handle(path, FILE_READ_ATTRIBUTES, OPEN_EXISTING);
  if (handle == INVALID_HANDLE_VALUE) {
    (void)fail();
    return std::nullopt;
  }
  const std::optional<FileStatus> status = status_from(handle);
  const int system_error = errno;
  (void)::CloseHandle(handle);
  errno = system_error;
  return status;
}

std::optional<FileStatus> status_of(int descriptor) { return status_from(handle_of(descriptor)); }

Descriptor open_file(const std::string& path, const Opening& how) {
  const DWORD access = (how.reads ? GENERIC_READ : 0U) | (how.writes ? GENERIC_WRITE : 0U);
  const DWORD makes = how.makes == Opening::Makes::kNothing   ? OPEN_EXISTING
                      : how.makes == Opening::Makes::kMissing ? OPEN_ALWAYS
                                                              : CREATE_NEW;
  const HANDLE handle = open_handle(path, access, makes);
  if (handle == INVALID_HANDLE_VALUE) {
    (void)fail();
    return Descriptor(-1);
  }
  return Descriptor(
      ::_open_osfhandle(reinterpret_cast<std::intptr_t>(handle), _O_BINARY | (how.writes ? 0 : _O_RDONLY)));
}

std::optional<int> stream_of(std::string_view path) {
  if (path == "-" || path == "/dev/stdout") return kStandardOutput;
  if (path == "/dev/stderr") return kStandardError;
  return std::nullopt;
}

void never_wait(int /*descriptor*/) noexcept {}

std::optional<std::size_t> read_some(int descriptor, std::span<char> bytes, bool /*waits*/) {
  constexpr std::size_t kMost = std::size_t{1} << 30;
  DWORD count = 0;
  const auto size = static_cast<DWORD>(std::min(bytes.size(), kMost));
  if (::ReadFile(handle_of(descriptor), bytes.data(), size, &count, nullptr) != 0) return count;
  if (::GetLastError() == ERROR_BROKEN_PIPE) return 0;  // the writer has closed the pipe
  (void)fail();
  return std::nullopt;
}

bool write_bytes(int descriptor, std::string_view bytes) noexcept {
  constexpr std::size_t kMost = std::size_t{1} << 30;
  if (is_console(descriptor)) return write_to_console(handle_of(descriptor), bytes);
  while (!bytes.empty()) {
    DWORD count = 0;
    const auto size = static_cast<DWORD>(std::min(bytes.size(), kMost));
    if (::WriteFile(handle_of(descriptor), bytes.data(), size, &count, nullptr) == 0) return fail();
    // A count of 0 means that the disk is full, or that a pipe accepts no bytes.
    if (count == 0) {
      errno = ENOSPC;
      return false;
    }
    bytes.remove_prefix(count);
  }
  return true;
}

std::optional<std::span<char>> read_at(int descriptor, std::uint64_t at, std::span<char> bytes) {
  while (!bytes.empty()) {
    const auto count = call_at(::ReadFile, descriptor, at, bytes.data(), bytes.size());
    if (!count) return std::nullopt;
    if (*count == 0) break;
    at += *count;
    bytes = bytes.subspan(*count);
  }
  return bytes;
}

bool write_at(int descriptor, std::uint64_t at, std::string_view bytes) {
  while (!bytes.empty()) {
    const auto count = call_at(::WriteFile, descriptor, at, bytes.data(), bytes.size());
    if (!count) return false;
    if (*count == 0) {
      errno = ENOSPC;
      return false;
    }
    at += *count;
    bytes.remove_prefix(*count);
  }
  return true;
}

bool set_end(int descriptor, std::uint64_t size) {
  LARGE_INTEGER end{};
  end.QuadPart = static_cast<LONGLONG>(size);
  return (::SetFilePointerEx(handle_of(descriptor), end, nullptr, FILE_BEGIN) != 0 &&
          ::SetEndOfFile(handle_of(descriptor)) != 0) ||
         fail();
}

void forget_bytes(int /*descriptor*/, std::uint64_t /*at*/, std::uint64_t /*size*/) noexcept {}

std::uint64_t written_bytes(int /*descriptor*/, std::uint64_t size, std::uint64_t /*enough*/) { return size; }

// Does nothing, because new files have the permissions of their folder.
bool take_permissions(int /*descriptor*/, const FileStatus& /*old*/) { return true; }

bool flush_file(int descriptor) {
  return ::FlushFileBuffers(handle_of(descriptor)) != 0 || ::GetLastError() == ERROR_INVALID_FUNCTION || fail();
}

// Does nothing, because MOVEFILE_WRITE_THROUGH has already written the rename to the disk.
void flush_folder_of(const std::string& /*path*/) {}

// Locks a byte far beyond the end of any file, because a lock on Windows also keeps other processes from reading the
// locked bytes.
bool lock_file(int descriptor) noexcept {
  OVERLAPPED place{};
  place.Offset = 0xFFFFFFFE;
  place.OffsetHigh = 0x7FFFFFFF;
  if (::LockFileEx(handle_of(descriptor), LOCKFILE_EXCLUSIVE_LOCK | LOCKFILE_FAIL_IMMEDIATELY, 0, 1, 0, &place) != 0)
    return true;
  const DWORD reason = ::GetLastError();
  return reason != ERROR_LOCK_VIOLATION && reason != ERROR_IO_PENDING;
}

bool remove_file(const char* path) noexcept { return ::DeleteFileW(wide(path).c_str()) != 0 || fail(); }

bool rename_file(const char* from, const char* to, bool replace) noexcept {
  const std::wstring target = wide(to);
  const DWORD how = MOVEFILE_WRITE_THROUGH | (replace ? MOVEFILE_REPLACE_EXISTING : 0U);
  if (::MoveFileExW(wide(from).c_str(), target.c_str(), how) != 0) return true;
  (void)fail();
  if (!replace || errno != EACCES) return false;
  // Windows reports "access denied" if somebody has the target open, and also for other reasons. If this process can
  // open the target, the reason is that somebody has it open.
  const HANDLE old = ::CreateFileW(target.c_str(), DELETE, kShared, nullptr, OPEN_EXISTING, 0, nullptr);
  if (old == INVALID_HANDLE_VALUE) return fail();
  (void)::CloseHandle(old);
  errno = EBUSY;
  return false;
}

// Maps only files that are too large to be read into memory. Windows cannot replace a file while it is mapped, but a
// bake may write over its own input.
const char* map_file(int descriptor, std::size_t size) noexcept {
  constexpr std::size_t kSmallest = std::size_t{1} << 30;
  if (size < kSmallest) return nullptr;
  const HANDLE mapping = ::CreateFileMappingW(handle_of(descriptor), nullptr, PAGE_READONLY, 0, 0, nullptr);
  if (mapping == nullptr) return nullptr;
  const void* const bytes = ::MapViewOfFile(mapping, FILE_MAP_READ, 0, 0, 0);
  (void)::CloseHandle(mapping);  // the view keeps the mapping alive
  return static_cast<const char*>(bytes);
}

void unmap(const char* bytes, std::size_t /*size*/) noexcept { (void)::UnmapViewOfFile(bytes); }

// Releases the memory by VirtualUnlock(), which removes pages that were never locked from the working set.
void release_mapping(const char* bytes, std::size_t size) noexcept {
  (void)::VirtualUnlock(const_cast<char*>(bytes), size);
}

std::uint64_t random_number() noexcept {
  try {
    std::random_device device;
    return joined(device(), device());
  } catch (const std::exception&) {
    const int here = 0;
    return joined(::GetCurrentProcessId(), ::GetTickCount()) ^ reinterpret_cast<std::uintptr_t>(&here);
  }
}

// Searches the folders of the pattern from the outermost to the innermost.
std::vector<std::string> match_pattern(const std::string& pattern, bool /*has_escapes*/) {
  const std::size_t begin = begin_of_name(pattern);
  const std::string before = pattern.substr(0, begin), name = pattern.substr(begin);
  std::vector<std::string> folders = {before};
  if (is_pattern(before)) {
    folders.clear();
    const std::string separator(1, before.back());
    for (const std::string& folder : match_pattern(before.substr(0, before.size() - 1), false))
      folders.push_back(folder + separator);
  }
  std::vector<std::string> files;
  for (const std::string& folder : folders) {
    if (!is_pattern(name)) {
      if (status_of(folder + name)) files.push_back(folder + name);
      continue;
    }
    WIN32_FIND_DATAW entry{};
    const HANDLE search = ::FindFirstFileW(wide(folder + "*").c_str(), &entry);
    if (search == INVALID_HANDLE_VALUE) continue;
    do {
      const std::wstring_view found = entry.cFileName;
      const bool is_hidden = found.starts_with(L'.') && !name.starts_with('.');
      if (!is_hidden && found != L"." && found != L".." && matches(wide(name), found))
        files.push_back(folder + narrow(found));
    } while (::FindNextFileW(search, &entry) != 0);
    (void)::FindClose(search);
  }
  return files;
}

std::filesystem::path path_of(std::string_view name) { return wide(name); }

std::string utf8_of(const std::filesystem::path& path) { return narrow(path.native()); }

std::span<char*> arguments_of_program(int /*count*/, char** /*arguments*/) {
  static std::vector<std::string> words;
  static std::vector<char*> pointers;
  int count = 0;
  wchar_t** const wide_words = ::CommandLineToArgvW(::GetCommandLineW(), &count);
  for (int i = 0; wide_words != nullptr && i < count; ++i) words.push_back(narrow(wide_words[i]));
  (void)::LocalFree(wide_words);
  for (std::string& word : words) pointers.push_back(word.data());
  return pointers;
}

std::optional<std::string> file_of_program() {
  std::wstring name(32768, L'\0');  // the longest name that Windows allows
  const DWORD size = ::GetModuleFileNameW(nullptr, name.data(), static_cast<DWORD>(name.size()));
  if (size == 0 || size >= name.size()) return std::nullopt;
  return narrow(std::wstring_view(name).substr(0, size));
}

bool is_terminal(int stream) noexcept { return is_console(stream); }

// Asks the console to interpret escape sequences, and returns true if it will. Consoles before Windows 10 cannot do
// this.
bool is_clever_terminal(int stream) noexcept {
  const HANDLE handle = handle_of(stream);
  DWORD mode = 0;
  return ::GetConsoleMode(handle, &mode) != 0 &&
         ::SetConsoleMode(handle, mode | ENABLE_PROCESSED_OUTPUT | ENABLE_VIRTUAL_TERMINAL_PROCESSING) != 0;
}

bool has_colours(int stream) noexcept { return is_clever_terminal(stream); }

std::size_t columns_of_terminal(int stream) noexcept {
  CONSOLE_SCREEN_BUFFER_INFO screen{};
  if (::GetConsoleScreenBufferInfo(handle_of(stream), &screen) == 0) return 0;
  return static_cast<std::size_t>(screen.srWindow.Right - screen.srWindow.Left + 1);
}

namespace {

// The functions that the handlers below call. These functions are set before the handlers are installed.
Endings watched{};

// Ends the process with the exit code that Windows uses for Ctrl-C. The system runs this function in a thread of its
// own. Under Wine, the exit code would otherwise be 0.
BOOL WINAPI end_by_request(DWORD event) {
  const bool is_key = event == CTRL_C_EVENT || event == CTRL_BREAK_EVENT;
  watched.by_request(is_key ? "interrupted (Ctrl-C)" : "the program was ended, since its console was closed");
  return ::TerminateProcess(::GetCurrentProcess(), STATUS_CONTROL_C_EXIT);
}

LONG WINAPI end_by_exception(EXCEPTION_POINTERS* what) {
  if (what->ExceptionRecord->ExceptionCode == EXCEPTION_IN_PAGE_ERROR) watched.by_lost_input();
  return EXCEPTION_CONTINUE_SEARCH;
}

extern "C" void end_by_abort(int /*signal*/) { watched.by_abort(); }

}  // namespace

// Opens NUL for each closed standard stream. The C library of Windows gives no descriptor to a closed stream, and opens
// no other file under the number of this stream.
void prepare_standard_streams() noexcept {
  for (int stream = kStandardInput; stream <= kStandardError; ++stream) {
    if (::_get_osfhandle(stream) < 0) {
      const int nothing = ::_wopen(L"NUL", stream == kStandardInput ? _O_WRONLY : _O_RDONLY);
      if (nothing >= 0 && nothing != stream) (void)::_dup2(nothing, stream);
    }
    (void)::_setmode(stream, _O_BINARY);
  }
}

void watch_endings(const Endings& endings) noexcept {
  watched = endings;
  (void)::SetConsoleCtrlHandler(end_by_request, TRUE);
  (void)::SetUnhandledExceptionFilter(end_by_exception);
  (void)::SetErrorMode(SEM_FAILCRITICALERRORS | SEM_NOOPENFILEERRORBOX);
  if (endings.by_abort != nullptr) (void)std::signal(SIGABRT, end_by_abort);
}

void give_back_free_memory() noexcept {}

void end_now(int exit_code) { ::_exit(exit_code); }

}  // namespace chronormal::inline internal

#endif  // _WIN32
