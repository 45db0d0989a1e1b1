/// A temporary file in the folder of the file that it is to become. The temporary file is removed when its object or
/// the process ends, unless it was renamed. Private to io.
///
/// All temporary files are entered into one list before they are created, so that remove_temporaries()
/// (chronormal/io/output.h) misses none. Their names are random, so no other file has such a name, even if the file is
/// removed late.
///
/// Threads    every thread may have temporary files of its own.
#ifndef CHRONORMAL_IO_SYSTEM_TEMPORARY_FILE_H_
#define CHRONORMAL_IO_SYSTEM_TEMPORARY_FILE_H_

#include <cstddef>
#include <memory>
#include <string>

#include "io/system/files.h"

namespace chronormal::inline internal {

class TemporaryFile {
 public:
  /// Opens a new file in the folder of `target`. Other users may read the file unless is_private is true. After the
  /// call, is_open() is true on success, and errno has the reason on failure.
  TemporaryFile(const std::string& target, bool is_private);
  /// Opens the file `name`, which may exist already. The file is not removed when the object or the process ends, so
  /// that a later run can continue it.
  struct Kept {
    std::string name;
  };
  TemporaryFile(const Kept& kept, bool is_private);
  /// Opens a temporary file that another process has created, by its name. Both processes remove the file when they are
  /// done with it, and the second process finds that the file no longer exists.
  [[nodiscard]] static std::unique_ptr<TemporaryFile> of_peer(const std::string& name);
  /// Creates a file in the folder of `target` for reading and writing, and removes its name at once. The file exists as
  /// long as its descriptor is open, however the process ends. Returns a closed descriptor and sets errno on failure.
  [[nodiscard]] static Descriptor nameless(const std::string& target);
  /// Returns the error for a file that could not be opened, with the reason from errno: kFailed with `place` as the
  /// place.
  [[nodiscard]] static Error not_opened(const std::string& place);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  /// Removes the file, unless it was renamed or was opened as Kept.
  ~TemporaryFile();

  [[nodiscard]] bool is_open() const noexcept { return file_.is_open(); }
  [[nodiscard]] int descriptor() const noexcept { return file_.number(); }
  [[nodiscard]] const char* name() const noexcept { return name_; }
  /// Closes the descriptor. Returns false and sets errno if the system could not write bytes that it still held.
  [[nodiscard]] bool close() noexcept { return file_.close(); }

  /// Renames the file to `target`. If `replace` is true, the file takes the place of an existing file. Returns false
  /// and sets errno on failure: EEXIST if a file of that name exists and must not be replaced.
  [[nodiscard]] bool rename_to(const std::string& target, bool replace) noexcept;

  /// Leaves the file to the other process that has the file open (of_peer()) and has renamed it. The destructor does
  /// not remove the file.
  void forget() noexcept;

 private:
  TemporaryFile() noexcept = default;
  void open(const std::string& name, const Opening& how);

  char* name_ = nullptr;   // name on the heap, to which the list points; nullptr if there is no file
  std::size_t place_ = 0;  // index in the list
  bool stays_ = false;     // true for a file that was opened as Kept; such a file is not in the list
  Descriptor file_{-1};
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_SYSTEM_TEMPORARY_FILE_H_
