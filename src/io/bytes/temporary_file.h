/// A new file beside the one that it is to become, which is gone when its time is over or the process is told to end.
/// Private to io.
///
/// All that there are stand in one list, from before they exist, so that remove_temporaries() (chronormal/io/output.h)
/// misses none. Their names are random: nobody else has a file of that name, whenever it is removed.
///
/// Threads    every thread may have temporary files of its own.
#ifndef CHRONORMAL_IO_BYTES_TEMPORARY_FILE_H_
#define CHRONORMAL_IO_BYTES_TEMPORARY_FILE_H_

#include <sys/types.h>

#include <cstddef>
#include <memory>
#include <string>

#include "io/bytes/descriptor.h"

namespace chronormal::inline internal {

class TemporaryFile {
 public:
  /// Opens a file in the folder of target; is_open() says whether that went well, and errno why not.
  TemporaryFile(const std::string& target, mode_t mode);
  /// Opens the file `name`, which may be there already. It stays where it is when its time is over and when the process
  /// is told to end, so that a later run can go on with it.
  struct Kept {
    std::string name;
  };
  TemporaryFile(const Kept& kept, mode_t mode);
  /// Opens the temporary file that another process has opened, by the name that it has there. Each of the two removes
  /// it.
  [[nodiscard]] static std::unique_ptr<TemporaryFile> of_peer(const std::string& name);
  /// Opens a file in the folder of target, to be read and written, whose name is gone when this returns: the file is
  /// there as long as its descriptor, however the process ends. Closed, with errno, on failure.
  [[nodiscard]] static Descriptor nameless(const std::string& target);
  /// The error of a file that could not be opened, from errno: kFailed with `place` as the place.
  [[nodiscard]] static Error not_opened(const std::string& place);
  TemporaryFile(const TemporaryFile&) = delete;
  TemporaryFile& operator=(const TemporaryFile&) = delete;
  /// Removes the file, unless it was renamed or is one that stays.
  ~TemporaryFile();

  [[nodiscard]] bool is_open() const noexcept { return file_.is_open(); }
  [[nodiscard]] int descriptor() const noexcept { return file_.number(); }
  [[nodiscard]] const char* name() const noexcept { return name_; }
  /// As Descriptor has it.
  [[nodiscard]] bool close() noexcept { return file_.close(); }

  /// Gives the file its name; with replace in place of what has that name already. False, with errno, on failure:
  /// EEXIST where something has that name and must not be replaced.
  [[nodiscard]] bool rename_to(const std::string& target, bool replace) noexcept;

  /// Leaves the file to the other process, which has renamed it.
  void forget() noexcept;

 private:
  TemporaryFile() noexcept = default;
  void open(const std::string& name, int flags, mode_t mode);

  char* name_ = nullptr;   // on the heap, for the list; nullptr where there is no file
  std::size_t place_ = 0;  // in the list
  bool stays_ = false;     // then it is in no list
  Descriptor file_{-1};
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_TEMPORARY_FILE_H_
