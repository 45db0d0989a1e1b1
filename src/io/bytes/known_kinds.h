/// Names the kind of a file by its first bytes, for messages about a file of an unexpected kind. Private to io.
#ifndef CHRONORMAL_IO_BYTES_KNOWN_KINDS_H_
#define CHRONORMAL_IO_BYTES_KNOWN_KINDS_H_

#include <string>
#include <string_view>

#include "chronormal/core/result.h"

namespace chronormal::inline internal {

/// Returns the kind of a file that begins with `bytes` ("a PNG image"), or an empty text if the kind is not known.
[[nodiscard]] std::string_view known_kind(std::string_view bytes) noexcept;

/// Refuses a file of a known kind other than `expected`, which is the name of a format (io/input/formats.h) or "json".
/// Errors: kInvalidInput at `place`: "this is a PNG image, not OBJ".
[[nodiscard]] Status check_kind(std::string_view bytes, const std::string& place, std::string_view expected);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_KNOWN_KINDS_H_
