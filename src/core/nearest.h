/// Guesses which name a user meant by a mistyped name.
#ifndef CHRONORMAL_CORE_NEAREST_H_
#define CHRONORMAL_CORE_NEAREST_H_

#include <cstddef>
#include <span>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Returns the number of edits that turn one word into the other, where no letter is edited twice (optimal string
/// alignment). An edit inserts, deletes or replaces a letter, or swaps it with its neighbour. O(product of the
/// lengths).
[[nodiscard]] std::size_t edit_distance(std::string_view a, std::string_view b);

/// Returns the name with the smallest edit distance to a word, and the first of several such names. Returns "" if that
/// distance is more than one for a word of 3 or 4 letters, or more than two for a longer word, or if the word has fewer
/// than 3 letters or more than 32.
[[nodiscard]] std::string nearest_name(std::string_view word, std::span<const std::string> names);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_NEAREST_H_
