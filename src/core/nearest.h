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
/// distance is more than two or more than a third of the word's length, or if the word has more than 32 letters.
[[nodiscard]] std::string nearest_name(std::string_view word, std::span<const std::string> names);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_NEAREST_H_
