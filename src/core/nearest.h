/// Guesses which of some names a mistyped one was meant to be. Private.
#ifndef CHRONORMAL_CORE_NEAREST_H_
#define CHRONORMAL_CORE_NEAREST_H_

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Returns how many letters have to be put in, left out, replaced, or swapped with their neighbour to make one word of
/// the other, each at most once (optimal string alignment). O(product of lengths).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// Returns the name that is nearest to a word, the first of equals. Returns "" if none is within two letters or a third
/// of the word, whichever is less, or if the word has more than 32 letters.
[[nodiscard]] std::string nearest_name(std::string_view word, std::span<const std::string> names);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_NEAREST_H_
