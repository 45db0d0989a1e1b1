/// Finds the bytes to which the URI of a glTF buffer refers. The bytes are in the URI itself (data:...;base64,) or in a
/// file. Private to io.
///
/// The file must be a regular file inside the folder of the asset. The path is checked after the URI is decoded and
/// links and ".." are followed, because an untrusted model must not read /etc/passwd or wait for a device.
#ifndef CHRONORMAL_IO_GLTF_MODEL_GLTF_URI_H_
#define CHRONORMAL_IO_GLTF_MODEL_GLTF_URI_H_

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"

namespace chronormal::inline internal {

/// Returns true if a URI contains the bytes of its buffer itself (data:...).
[[nodiscard]] bool is_data_uri(std::string_view uri) noexcept;

/// Decodes a data URI that must have at least `least` bytes. Errors: kInvalidInput at `place` for text that is not
/// base64 (RFC 4648), for another media type than a buffer may have (application/octet-stream,
/// application/gltf-buffer), and for too few bytes.
[[nodiscard]] Result<std::string> decode_data_uri(std::string_view uri, std::size_t least, const std::string& place);

/// Returns the path of the file to which a relative URI refers. `folder` is the folder of the asset, or has no value
/// for the standard input. Errors: kInvalidInput at `place` for a URI that does not name a file or that names a device,
/// and for a malformed percent code. Unless allow_external is true, an absolute path, another scheme, and everything
/// outside the folder are also errors.
[[nodiscard]] Result<std::string> resolve_file_uri(std::string_view uri, const std::optional<std::string>& folder,
                                                   bool allow_external, const std::string& place);

/// Returns the name of the file of a relative URI for the caller's resolver (InputOptions::resolve), which is used
/// instead of the file system. The name is the folder and the URI, joined to a path without "." and "..". Errors: those
/// of resolve_file_uri(), and a URI that leads out of the folder.
[[nodiscard]] Result<std::string> name_file_uri(std::string_view uri, const std::optional<std::string>& folder,
                                                const std::string& place);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_GLTF_MODEL_GLTF_URI_H_
