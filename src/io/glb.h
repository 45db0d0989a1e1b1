/// GLB, the binary container of glTF 2.0 (section 4 of its specification). Little endian:
///
///     byte 0   "glTF"   4   version: 2   8   bytes of the file
///         12   bytes of the JSON chunk, "JSON", its text, padded to a multiple of 4 with blanks
///              bytes of the BIN chunk, "BIN\0", its bytes, padded with zeros       (at most one, and second)
///              further chunks, which are skipped
///
/// Private to io.
#ifndef CHRONORMAL_IO_GLB_H_
#define CHRONORMAL_IO_GLB_H_

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"

namespace chronormal {

/// Views of the file.
struct GlbChunks {
  std::string_view json;
  std::size_t json_offset = 0;          ///< where the JSON begins, in bytes
  std::optional<std::string_view> bin;  ///< nothing where there is no BIN chunk
};

[[nodiscard]] inline bool is_glb(std::string_view bytes) noexcept { return bytes.starts_with("glTF"); }

/// Finds the chunks. Errors: kInvalidInput with the place "NAME, byte N": another version, a length that is not that of
/// the file, chunks that do not lie inside it, no JSON chunk first. Bytes after the declared length are refused.
[[nodiscard]] Result<GlbChunks> read_glb(std::string_view bytes, const std::string& name);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_GLB_H_
