/// Reads, writes, locks, maps and finds files through the operating system. Files are known by descriptors, which are
/// small numbers, and by names in UTF-8. Private to io, workflow and the program.
///
/// No other folder of the source code asks the system for files. posix.cpp and windows.cpp define these functions, each
/// for its systems.
///
/// Errors     functions that can fail return false, nothing or a closed descriptor, and leave the reason in errno.
/// Threads    functions on different descriptors may run at the same time; read_at() and write_at() also on the same
///            descriptor.
#ifndef CHRONORMAL_IO_SYSTEM_FILES_H_
#define CHRONORMAL_IO_SYSTEM_FILES_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal::inline internal {

inline constexpr int kStandardInput = 0, kStandardOutput = 1, kStandardError = 2;

/// Closes a descriptor. Returns false if the system could not write bytes that it still held.
[[nodiscard]] bool close_descriptor(int descriptor) noexcept;

/// A descriptor that its destructor closes.
class Descriptor {
 public:
  explicit Descriptor(int number) noexcept : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (number_ >= 0) (void)close_descriptor(number_);
  }

  [[nodiscard]] int number() const noexcept { return number_; }
  [[nodiscard]] bool is_open() const noexcept { return number_ >= 0; }
  /// Closes the descriptor now. Returns false if the system could not write bytes that it still held.
  [[nodiscard]] bool close() noexcept { return close_descriptor(std::exchange(number_, -1)); }

 private:
  int number_;
};

/// Returns the error for a path and an error number of the system. Does not read errno.
[[nodiscard]] Error failure(const std::string& path, int system_error);

/// The facts that the system knows about the file behind a name or a descriptor.
struct FileStatus {
  enum class Kind { kFile, kFolder, kTerminal, kDevice, kPipe };

  Kind kind = Kind::kFile;
  std::uint64_t size = 0;                ///< size in bytes; 0 for anything but a regular file
  std::int64_t changed = 0;              ///< time of the last change, in nanoseconds since 1970
  std::uint64_t volume = 0, number = 0;  ///< number of the disk, and number of the file on this disk
  bool is_removed = false;               ///< true if no name leads to the file any more
  unsigned permissions = 0, owner = 0, group = 0;

  [[nodiscard]] bool is_file() const noexcept { return kind == Kind::kFile; }
};
[[nodiscard]] std::optional<FileStatus> status_of(const std::string& path);
[[nodiscard]] std::optional<FileStatus> status_of(int descriptor);

/// The way in which a file is opened. The file must exist, unless `makes` says that it may be created.
struct Opening {
  bool reads = false, writes = false;
  enum class Makes { kNothing, kMissing, kNew } makes = Makes::kNothing;  ///< kNew: an existing file is an error
  bool follows_links = true;
  bool waits = true;        ///< false to return at once if the other side of a pipe is not open
  bool is_private = false;  ///< true if other users may not read a file that is created
};
[[nodiscard]] Descriptor open_file(const std::string& path, const Opening& how);

/// Returns the standard stream of this process that a path names: "-", or a name that the system has for it, such as
/// /dev/stderr. Returns nothing for other paths.
[[nodiscard]] std::optional<int> stream_of(std::string_view path);

/// Makes reading fail with EAGAIN if there are no bytes to read yet. On a system that cannot do this, reading still
/// waits.
void never_wait(int descriptor) noexcept;
/// Reads at most as many bytes as `bytes` has room for, and returns their number, which is 0 at the end of the file.
/// Waits for the first byte, unless `waits` is false and never_wait() was called before.
[[nodiscard]] std::optional<std::size_t> read_some(int descriptor, std::span<char> bytes, bool waits = true);
/// Writes all bytes. Safe to call in a signal handler.
[[nodiscard]] bool write_bytes(int descriptor, std::string_view bytes) noexcept;

/// Reads a file from byte `at` on, until `bytes` is full or the file ends. Returns the part of `bytes` that was not
/// filled.
[[nodiscard]] std::optional<std::span<char>> read_at(int descriptor, std::uint64_t at, std::span<char> bytes);
/// Writes all bytes to a file from byte `at` on. The call may move the place at which write_bytes() writes next.
[[nodiscard]] bool write_at(int descriptor, std::uint64_t at, std::string_view bytes);
/// Makes a file `size` bytes long. The next call of write_bytes() then appends to the file.
[[nodiscard]] bool set_end(int descriptor, std::uint64_t size);
/// Tells the system that nobody will read the `size` bytes of a file from byte `at` on again. If the system can do
/// this, the disk space of these bytes becomes free.
void forget_bytes(int descriptor, std::uint64_t at, std::uint64_t size) noexcept;
/// Returns the number of bytes of a file that were ever written; the other bytes are holes. Stops counting at `enough`.
/// If the system cannot find holes, every byte counts.
[[nodiscard]] std::uint64_t written_bytes(int descriptor, std::uint64_t size, std::uint64_t enough);

/// Gives a file the permissions of an old file, and also the owner of the old file if that is allowed.
[[nodiscard]] bool take_permissions(int descriptor, const FileStatus& old);
/// Writes the bytes that the system still holds for a file to the disk. Also returns true if the file system cannot do
/// this.
[[nodiscard]] bool flush_file(int descriptor);
/// Writes the folder of a file to the disk, so that a rename survives a power cut, if the file system can do this.
void flush_folder_of(const std::string& path);

/// Locks a file for this process as long as its descriptor is open. Returns false if another process has locked the
/// file. On file systems without locks, every process succeeds.
[[nodiscard]] bool lock_file(int descriptor) noexcept;

/// Removes the name of a file. Safe to call in a signal handler. Errors: ENOENT if there is no such name.
bool remove_file(const char* path) noexcept;
/// Renames a file. If `replace` is true, the file takes the place of an existing file of that name. Otherwise an
/// existing file is the error EEXIST, except on systems that cannot rename without replacing: there the existing file
/// is replaced in both cases.
[[nodiscard]] bool rename_file(const char* from, const char* to, bool replace) noexcept;

/// Maps all bytes of a file into memory, to be read once from the first to the last. Returns nullptr on failure. If the
/// file becomes shorter or its disk fails, reading the lost part ends the program (io/system/process.h).
[[nodiscard]] const char* map_file(int descriptor, std::size_t size) noexcept;
void unmap(const char* bytes, std::size_t size) noexcept;
/// Releases the memory that a mapping has taken so far. The system reads the bytes from the file again when they are
/// needed.
void release_mapping(const char* bytes, std::size_t size) noexcept;

/// Returns a random number that nobody can guess.
[[nodiscard]] std::uint64_t random_number() noexcept;

/// Returns the files that match a pattern with *, ? and [...], in any order. If has_escapes is true, the character
/// after a backslash stands for itself. On Windows, a backslash always separates folders.
[[nodiscard]] std::vector<std::string> match_pattern(const std::string& pattern, bool has_escapes);

/// Returns the file that a program writes to when it writes to `path`. If `path` is a symbolic link, the result is the
/// file at the end of the chain of links, which need not exist.
[[nodiscard]] std::string follow_links(const std::string& path);

/// An identity of a file that does not depend on the spelling of its path: "s.npz" and "./s.npz" have the same key, and
/// links are followed. The key of an existing file is its volume and number with an empty name. The key of a file that
/// does not exist yet is the volume and number of its folder, and its name.
using FileKey = std::tuple<std::uint64_t, std::uint64_t, std::string>;
/// Finds the file that writing to `path` would replace or create; "-" is the standard output. Returns nothing for pipes
/// and devices, which are not replaced, and if the system has no information about the path.
[[nodiscard]] std::optional<FileKey> key_of_file(const std::string& path);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_SYSTEM_FILES_H_
