/// Identifies the files of an input by their names, sizes and modification times. A run compares them with those of an
/// earlier run, and thus knows without reading the files if its input has changed. Private to io and the program.
#ifndef CHRONORMAL_IO_INPUT_INPUT_IDENTITY_H_
#define CHRONORMAL_IO_INPUT_INPUT_IDENTITY_H_

#include <cstdint>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"

namespace chronormal::inline internal {

struct FileIdentity {
  std::string path;
  std::uint64_t size = 0;    ///< size in bytes
  std::int64_t changed = 0;  ///< time of the last change, in nanoseconds since 1970

  /// Returns the size and the modification time of the file as text for messages and journals: "1200 bytes, changed at
  /// 1795430000.123456789 s".
  [[nodiscard]] std::string text() const;
};

/// Returns the files that the options name, in order, or no files for a built-in morph. Errors: the errors of
/// find_frames(); kFailed if the system has no information about a file; kUsage for a pipe, which cannot be read again,
/// and for the .xml of a Maya cache, because its data are in other files.
[[nodiscard]] Result<std::vector<FileIdentity>> identify_files(const InputOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_INPUT_IDENTITY_H_
