/// GLB, the binary container of glTF 2.0 (section 4 of its specification). Little endian:
///
///     byte 0   "glTF"   4   version: 2   8   bytes of the file
///         12   bytes of the JSON chunk, "JSON", its text, padded to a multiple of 4 with blanks
///              bytes of the BIN chunk, "BIN\0", its bytes, padded with zeros       (at most one, and second)
///              further chunks, whose meaning is unknown
///
/// Private to io.
#ifndef CHRONORMAL_IO_GLTF_GLB_GLB_H_
#define CHRONORMAL_IO_GLTF_GLB_GLB_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal::inline internal {

/// Views of the parts of the file.
struct GlbChunks {
  std::string_view json;
  std::size_t json_offset = 0;          ///< byte at which the JSON begins
  std::optional<std::string_view> bin;  ///< nothing if there is no BIN chunk
  std::string_view rest;                ///< further chunks, with their headers
};

[[nodiscard]] inline bool is_glb(std::string_view bytes) noexcept { return bytes.starts_with("glTF"); }
/// Returns true for extensions of GLB files, in lower case. VRM avatars are GLB files, too.
[[nodiscard]] inline bool is_glb_extension(std::string_view extension) noexcept {
  return extension == ".glb" || extension == ".vrm";
}

/// Finds the chunks. Errors: kInvalidInput with the place "NAME, byte N": another version, a declared length that
/// differs from the size of the file, a chunk that does not lie inside the file, a first chunk that is not JSON.
[[nodiscard]] Result<GlbChunks> read_glb(std::string_view bytes, const std::string& name);

/// The headers and the padding around the chunks of a file. A file has a JSON chunk and at most one BIN chunk.
struct GlbFrame {
  std::string before_json, behind_json, behind_bin;  ///< headers, and the padding of the chunk before
  std::uint64_t size = 0;                            ///< size of the file
};

/// Makes the frame for chunks of these sizes. bin_size is empty without a BIN chunk; rest_size is the size of further
/// chunks with their headers. Errors: kInvalidInput with the name as the place, for a file of 4 GiB or more.
[[nodiscard]] Result<GlbFrame> frame_glb(std::uint64_t json_size, std::optional<std::uint64_t> bin_size,
                                         std::uint64_t rest_size, const std::string& name);

/// A file in pieces: views of the chunks and of the frame around them. The frame's memory stays in place when this is
/// moved.
struct GlbPieces {
  std::unique_ptr<const GlbFrame> frame;
  std::vector<std::string_view> pieces;
};

/// Lays chunks out as a file. `bin` is nothing if there is no BIN chunk; `rest` is the further chunks with their
/// headers. Errors: those of frame_glb().
[[nodiscard]] Result<GlbPieces> lay_out_glb(std::span<const std::string_view> json,
                                            const std::optional<std::vector<std::string_view>>& bin,
                                            std::string_view rest, const std::string& name);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_GLTF_GLB_GLB_H_
