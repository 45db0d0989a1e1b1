/// Reads targets of MakeHuman and MPFB. A target lists the deltas that a shape adds to some of the vertices of a base
/// mesh. The files are text, often gzipped:
///
///     # comments and empty lines may be anywhere
///     161 .003 0 .018        a delta: vertex, counted from 0, and x y z in the units of the base
///     184 .012 .014 .023     # a comment may follow
///
/// Vertices that are not listed do not move; lines may be in any order. Lines end in LF, CRLF or CR; a byte order mark
/// is skipped. A file that begins with the bytes 1F 8B is gzip (of one member or several), with any name.
///
/// Threads    pure.
#ifndef CHRONORMAL_IO_MESH_MAKE_HUMAN_TARGET_H_
#define CHRONORMAL_IO_MESH_MAKE_HUMAN_TARGET_H_

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"

namespace chronormal::inline internal {

/// The deltas of a target: deltas[i] is added to the vertex vertices[i]. Each vertex occurs at most once.
struct MakeHumanTarget {
  std::vector<std::uint32_t> vertices;
  std::vector<float> deltas;  ///< (vertices.size(), 3)
};

/// Returns the largest size in bytes to which a gzipped target may expand, for a base with vertex_count vertices. A
/// line of deltas takes 20 to 40 bytes.
[[nodiscard]] constexpr std::size_t most_target_bytes(std::size_t vertex_count) noexcept {
  return std::size_t{65536} + 256 * vertex_count;
}

/// Returns true if a file name ends in .target or .target.gz, in upper or lower case.
[[nodiscard]] bool is_make_human_target(std::string_view file_name);

/// Reads a target over a base with these positions, which must be finite; `name` is for messages.
///
/// Errors: kInvalidInput with the place "NAME, line N" (of the unpacked text) for a line that is not one index and
/// three numbers; numbers that are not finite or too large for float32; an index without a vertex; a vertex that
/// already has a delta (programs disagree on adding both or using the last); a delta whose float32 sum with the
/// coordinate exceeds the range of float32; a file of 0 bytes. kInvalidInput with the place "NAME, byte N" (of the
/// file) for gzip data that are damaged or end early, are followed by other data, or unpack to more than
/// most_target_bytes().
///
/// A file without any delta is valid: the target equals the base. A text that was cut off inside its last number, or
/// between two lines, cannot be told from a complete file and is read without an error. Cost: one pass; memory in
/// proportion to the text, and a bit per vertex.
[[nodiscard]] Result<MakeHumanTarget> read_make_human_target(std::string_view bytes, const std::string& name,
                                                             VectorView<const float> base);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_MESH_MAKE_HUMAN_TARGET_H_
