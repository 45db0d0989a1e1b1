/// A new file beside the one that it is to become. It is removed when its object or the process ends. Private to io.
///
/// All temporary files are entered into one list before they exist, so that remove_temporaries()
/// (chronormal/io/output.h) misses none. Their names are random: nobody else has a file of that name, whenever it is
/// removed.
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
  /// Opens a file in the folder of target, which others may read unless it is private; is_open() says whether that
  /// succeeded, and errno why not.
  TemporaryFile(const std::string& target, bool is_private);
  /// Opens the file `name`, which may exist already. It stays when the object ends and when the process is told to end,
  /// so that a later run can go on with it.
  struct Kept {
    std::string name;
  };
  TemporaryFile(const Kept& kept, bool is_private);
  /// Opens a temporary file that another process has opened, by its name there. Each of the two processes removes it.
  [[nodiscard]] static std::unique_ptr<TemporaryFile> of_peer(const std::string& name);
  /// Opens a file in the folder of target for reading and writing, and removes its name at once: the file exists as
  /// long as its descriptor, however the process ends. Returns a closed descriptor, with errno, on failure.
  [[nodiscard]] static Descriptor nameless(const std::string& target);
  /// Returns the error of a file that could not be opened, from errno: kFailed with `place` as the place.
  [[nodiscard]] static Error not_opened(const std::string& place);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  /// Removes the file, unless it was renamed or is one that stays.
  ~TemporaryFile();

  [[nodiscard]] bool is_open() const noexcept { return file_.is_open(); }
  [[nodiscard]] int descriptor() const noexcept { return file_.number(); }
  [[nodiscard]] const char* name() const noexcept { return name_; }
  /// Closes the descriptor; returns false, with errno, where the system could not write what was left.
  [[nodiscard]] bool close() noexcept { return file_.close(); }

  /// Gives the file its name; with replace, it takes the place of what has that name already. Returns false, with
  /// errno, on failure: EEXIST if something has that name and must not be replaced.
  [[nodiscard]] bool rename_to(const std::string& target, bool replace) noexcept;

  /// Leaves the file to the other process, which has renamed it.
  void forget() noexcept;

 private:
  TemporaryFile() noexcept = default;
  void open(const std::string& name, const Opening& how);

  char* name_ = nullptr;   // on the heap, for the list; nullptr where there is no file
  std::size_t place_ = 0;  // in the list
  bool stays_ = false;     // not in the list then
  Descriptor file_{-1};
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_SYSTEM_TEMPORARY_FILE_H_
