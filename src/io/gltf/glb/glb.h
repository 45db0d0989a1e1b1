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

/// The parts of a GLB file, as views.
struct GlbChunks {
  std::string_view json;
  std::size_t json_offset = 0;          ///< offset of the JSON in the file
  std::optional<std::string_view> bin;  ///< nothing if there is no BIN chunk
  std::string_view rest;                ///< further chunks, with their headers
};

[[nodiscard]] inline bool is_glb(std::string_view bytes) noexcept { return bytes.starts_with("glTF"); }
/// Returns true for extensions of GLB files, in lower case. VRM avatars are GLB files, too.
[[nodiscard]] inline bool is_glb_extension(std::string_view extension) noexcept {
  return extension == ".glb" || extension == ".vrm";
}

/// Finds the chunks of a GLB file. The place of an error is "NAME, byte N". Errors: kInvalidInput for another version,
/// a declared length that differs from the size of the file, a chunk that does not lie inside the file, and a first
/// chunk that is not JSON.
[[nodiscard]] Result<GlbChunks> read_glb(std::string_view bytes, const std::string& name);

/// The headers and the padding around the chunks of a GLB file. A file has a JSON chunk and at most one BIN chunk.
struct GlbFrame {
  /// the bytes in front of the JSON, behind the JSON, and behind the bytes of BIN: padding and headers of chunks
  std::string before_json, behind_json, behind_bin;
  std::uint64_t size = 0;  ///< size of the file in bytes
};

/// Makes the frame for chunks of the given sizes in bytes. Pass no bin_size for a file without a BIN chunk. rest_size
/// is the size of further chunks with their headers. Errors: kInvalidInput with `name` as the place, for a file of 4
/// GiB or more.
[[nodiscard]] Result<GlbFrame> frame_glb(std::uint64_t json_size, std::optional<std::uint64_t> bin_size,
                                         std::uint64_t rest_size, const std::string& name);

/// A file in pieces: views of the chunks and of the frame around them. The views stay valid when this object is moved.
struct GlbPieces {
  std::unique_ptr<const GlbFrame> frame;
  std::vector<std::string_view> pieces;
};

/// Lays chunks out as a file. Pass no `bin` for a file without a BIN chunk. `rest` has the further chunks with their
/// headers. Errors: those of frame_glb().
[[nodiscard]] Result<GlbPieces> lay_out_glb(std::span<const std::string_view> json,
                                            const std::optional<std::vector<std::string_view>>& bin,
                                            std::string_view rest, const std::string& name);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_GLTF_GLB_GLB_H_
