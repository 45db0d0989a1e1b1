/// Names the kind of a file by its first bytes, for messages about a file of another kind than was expected. Private to
/// io.
#ifndef CHRONORMAL_IO_BYTES_KNOWN_KINDS_H_
#define CHRONORMAL_IO_BYTES_KNOWN_KINDS_H_

#include <string>
#include <string_view>

#include "chronormal/core/result.h"

namespace chronormal::inline internal {

/// "a PNG image": the kind of a file that begins with these bytes, where they tell it; else empty.
[[nodiscard]] std::string_view known_kind(std::string_view bytes) noexcept;

/// Refuses a file of a known kind that is not the one that it should be, the name of a format (io/input/formats.h) or
/// "json". Errors: kInvalidInput with this place: "this is a PNG image, not OBJ".
[[nodiscard]] Status check_kind(std::string_view bytes, const std::string& place, std::string_view expected);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_BYTES_KNOWN_KINDS_H_
