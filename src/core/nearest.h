/// Guesses which name was meant by a mistyped one. Private.
#ifndef CHRONORMAL_CORE_NEAREST_H_
#define CHRONORMAL_CORE_NEAREST_H_

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Returns how many letters must be inserted, deleted, replaced, or swapped with their neighbour to turn one word into
/// the other, where no letter is edited twice (optimal string alignment). O(product of lengths).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// Returns the name that is nearest to a word, the first of equals. Returns "" if none is within two letters or a third
/// of the word, whichever is less, or if the word has more than 32 letters.
[[nodiscard]] std::string nearest_name(std::string_view word, std::span<const std::string> names);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_NEAREST_H_
