/// Makes a base mesh and MakeHuman targets byte by byte, without chronormal's writers.
#ifndef CHRONORMAL_TESTS_SUPPORT_TARGET_BYTES_H_
#define CHRONORMAL_TESTS_SUPPORT_TARGET_BYTES_H_

#include <zlib.h>

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/cache_bytes.h"
#include "tests/support/ply_bytes.h"

namespace chronormal::test {

/// A square of two triangles: the x, y and z of four vertices, and the text of an OBJ file.
inline const std::vector<float> kSquare = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
inline const std::string kSquareObj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n";

/// A MakeHuman target that moves the vertices 1 and 3 of the square.
inline const std::string kLiftTarget = "# made for a test\n\n3 0 0 .5\n1 -.25 +0.125 1e-1 # a corner\n";

/// Makes one gzip member: the header, the deflated text, the checksum and the length.
[[nodiscard]] inline std::string gzip(const std::string& text) {
  const auto sum = static_cast<std::uint32_t>(
      ::crc32(0, reinterpret_cast<const Bytef*>(text.data()), static_cast<uInt>(text.size())));
  return std::string("\x1F\x8B\x08\0\0\0\0\0\0\x03", 10) + deflated(text) +
         ByteWriter("", false).add(sum).add(static_cast<std::uint32_t>(text.size())).bytes();
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_TARGET_BYTES_H_
