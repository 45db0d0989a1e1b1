/// The names, sizes and modification times of the files of an input. By them, two inputs, or two states of one input,
/// can be told apart without reading a file. Private to io and the program.
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

  /// Returns size and time for messages and journals: "1200 bytes, changed at 1795430000.123456789 s".
  [[nodiscard]] std::string text() const;
};

/// Returns the files that the options name, in order; none for a built-in morph. Errors: those of finding the files;
/// kUsage for a pipe, which cannot be read again, and for a Maya .xml, because its data are in other files.
[[nodiscard]] Result<std::vector<FileIdentity>> identify_files(const InputOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_INPUT_INPUT_IDENTITY_H_
