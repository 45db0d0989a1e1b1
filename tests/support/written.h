/// Writes a motion by write_motion(), the function that programs call, and returns the bytes of the file.
#ifndef CHRONORMAL_TESTS_SUPPORT_WRITTEN_H_
#define CHRONORMAL_TESTS_SUPPORT_WRITTEN_H_

#include <string>

#include "chronormal/io/output.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::test {

/// Returns the bytes of a file with this extension, such as ".pc2". Returns the error if write_motion() fails.
[[nodiscard]] inline Result<std::string> written(const Motion& motion, const std::string& extension) {
  const TemporaryFolder folder;
  const std::string path = folder / ("motion" + extension);
  if (const Status status = write_motion(motion, path, false); !status) return status.error();
  return read_whole(path);
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_WRITTEN_H_
