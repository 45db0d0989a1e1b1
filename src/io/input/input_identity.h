/// The names, sizes and times of change of the files of an input. They tell one input from another, and from itself
/// after a change, without reading a file. Private to io and the program.
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
  std::uint64_t size = 0;    ///< bytes
  std::int64_t changed = 0;  ///< nanoseconds since 1970

  /// Returns "1200 bytes, changed at 1795430000.123456789 s", for messages and journals.
  [[nodiscard]] std::string text() const;
};

/// Returns the files that the options name, in order; none for a built-in morph. Errors: those of finding them; kUsage
/// for a pipe, which cannot be read again, and for a Maya .xml, whose caches are other files.
[[nodiscard]] Result<std::vector<FileIdentity>> identify_files(const InputOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_INPUT_IDENTITY_H_
