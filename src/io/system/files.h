/// Files as the operating system has them: by descriptors, which are small numbers, and by names in UTF-8. Private to
/// io, workflow and the program.
///
/// No other room calls the system for files. posix.cpp and windows.cpp define what stands here, each for its systems.
///
/// Errors     functions that can fail return false, nothing or a closed descriptor, and leave the reason in errno.
/// Threads    functions on different descriptors may run at the same time; read_at() and write_at() on one as well.
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

/// Closes a descriptor. Returns false where the system could not write what was left.
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
  /// Closes now; as close_descriptor().
  [[nodiscard]] bool close() noexcept { return close_descriptor(std::exchange(number_, -1)); }

 private:
  int number_;
};

/// Builds the error for a path from the system's own number for it; errno is not looked at.
[[nodiscard]] Error failure(const std::string& path, int system_error);

/// Describes what a name or a descriptor stands for.
struct FileStatus {
  enum class Kind { kFile, kFolder, kTerminal, kDevice, kPipe };

  Kind kind = Kind::kFile;
  std::uint64_t size = 0;                ///< bytes; 0 for what is no file
  std::int64_t changed = 0;              ///< nanoseconds since 1970
  std::uint64_t volume = 0, number = 0;  ///< the disk, and the file there
  bool is_removed = false;               ///< no name leads to it any more
  unsigned permissions = 0, owner = 0, group = 0;

  [[nodiscard]] bool is_file() const noexcept { return kind == Kind::kFile; }
};
[[nodiscard]] std::optional<FileStatus> status_of(const std::string& path);
[[nodiscard]] std::optional<FileStatus> status_of(int descriptor);

/// Selects how a file is opened. Readable files are opened for reading; others must exist unless they may be made.
struct Opening {
  bool reads = false, writes = false;
  enum class Makes { kNothing, kMissing, kNew } makes = Makes::kNothing;  ///< kNew: an error where there is one
  bool follows_links = true;
  bool waits = true;        ///< for the other side of a pipe
  bool is_private = false;  ///< nobody else may read what is made
};
[[nodiscard]] Descriptor open_file(const std::string& path, const Opening& how);

/// Returns the stream of this process that a path names: "-", and what the system calls it, such as /dev/stderr;
/// nothing for other paths.
[[nodiscard]] std::optional<int> stream_of(std::string_view path);

/// Makes reading fail with EAGAIN where there is nothing to read yet. A system that cannot do that goes on to wait.
void never_wait(int descriptor) noexcept;
/// Reads at most as many bytes as there is room for; 0 at the end. It waits for the first byte, unless `waits` is false
/// and never_wait() was called.
[[nodiscard]] std::optional<std::size_t> read_some(int descriptor, std::span<char> bytes, bool waits = true);
/// Writes all bytes. Safe to call from the handler of a signal.
[[nodiscard]] bool write_bytes(int descriptor, std::string_view bytes) noexcept;

/// Reads a file from byte `at` on, until `bytes` is full or the file ends. Returns the part that was not filled.
[[nodiscard]] std::optional<std::span<char>> read_at(int descriptor, std::uint64_t at, std::span<char> bytes);
/// Writes all bytes of a file from byte `at` on. Afterwards nobody knows where write_bytes() writes.
[[nodiscard]] bool write_at(int descriptor, std::uint64_t at, std::string_view bytes);
/// Makes a file this long; write_bytes() goes on there.
[[nodiscard]] bool set_end(int descriptor, std::uint64_t size);
/// Tells the system that nobody will read these bytes again. Where it can, their room on the disk becomes free.
void forget_bytes(int descriptor, std::uint64_t at, std::uint64_t size) noexcept;
/// Counts the bytes of a file that were ever written, and stops at `enough`; the others are holes. If the system does
/// not tell holes, every byte counts.
[[nodiscard]] std::uint64_t written_bytes(int descriptor, std::uint64_t size, std::uint64_t enough);

/// Gives a file the permissions of an old one, and its owner where that is allowed.
[[nodiscard]] bool take_permissions(int descriptor, const FileStatus& old);
/// Writes to the disk what the system holds of a file. True as well where the file system cannot do it.
[[nodiscard]] bool flush_file(int descriptor);
/// Makes the rename of a file last through a power cut, where the file system can.
void flush_folder_of(const std::string& path);

/// Locks a file for this process as long as its descriptor is open. Returns false where another process has it; file
/// systems without locks let everybody have it.
[[nodiscard]] bool lock_file(int descriptor) noexcept;

/// Removes a name. Safe to call from the handler of a signal. Errors: ENOENT where there is none.
bool remove_file(const char* path) noexcept;
/// Renames a file. With `replace`, it takes the place of an existing file of that name. Without `replace`, an existing
/// file is the error EEXIST. Only where the system cannot rename without replacing, the file is replaced all the same.
[[nodiscard]] bool rename_file(const char* from, const char* to, bool replace) noexcept;

/// Maps all bytes of a file into memory, to be read once from the first to the last. Returns nullptr where that fails.
/// Reading ends the program if the file becomes shorter or its disk fails (io/system/process.h).
[[nodiscard]] const char* map_file(int descriptor, std::size_t size) noexcept;
void unmap(const char* bytes, std::size_t size) noexcept;
/// Releases the memory of a mapping; its bytes are read again when they are looked at again.
void release_mapping(const char* bytes, std::size_t size) noexcept;

/// Returns a number that nobody can guess.
[[nodiscard]] std::uint64_t random_number() noexcept;

/// Returns the files that a pattern with *, ? and [...] matches, in any order. With escapes, a backslash takes the
/// meaning from the character after it; on Windows it stands between folders in any case.
[[nodiscard]] std::vector<std::string> match_pattern(const std::string& pattern, bool has_escapes);

/// Returns the file that a program writes when it writes to path: the end of a chain of symbolic links, which need not
/// exist.
[[nodiscard]] std::string follow_links(const std::string& path);

/// Identifies a file, whatever it is called: "s.npz" and "./s.npz" are one, and links are followed. One that exists has
/// its volume and number, and an empty name; one that does not exist yet has those of its folder, and its name.
using FileKey = std::tuple<std::uint64_t, std::uint64_t, std::string>;
/// Finds the file that writing to path would replace or make; "-" is the standard output. Returns nothing for pipes and
/// devices, which are not replaced, and for a path that the system tells nothing about.
[[nodiscard]] std::optional<FileKey> key_of_file(const std::string& path);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_SYSTEM_FILES_H_
