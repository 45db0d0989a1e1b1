/// Compares names that look the same but may consist of different bytes. For example, an e with an accent is one
/// character on most systems, and two in file names that come from a Mac. Private to io.
#ifndef CHRONORMAL_IO_GLTF_MODEL_UNICODE_FORMS_H_
#define CHRONORMAL_IO_GLTF_MODEL_UNICODE_FORMS_H_

#include <string_view>

namespace chronormal::inline internal {

/// Returns true if two names in UTF-8 are equal after letters are decomposed into a letter and its marks (the form NFD
/// of Unicode, for Latin, Greek and Cyrillic letters, kana and Hangul). Text that is not UTF-8 is compared byte by
/// byte.
[[nodiscard]] bool are_same_text(std::string_view a, std::string_view b);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_GLTF_MODEL_UNICODE_FORMS_H_
