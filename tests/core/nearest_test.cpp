// Compares the suggestion for a mistyped name with the result of trying all edits of the name.
#include "core/nearest.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

namespace chronormal::nearest_test {
namespace {

// Returns all words that one edit makes of a word. The alphabet is a and b.
std::set<std::string> edited(const std::string& word) {
  std::set<std::string> words;
  for (std::size_t i = 0; i <= word.size(); ++i) {
    for (const char c : {'a', 'b'}) {
      words.insert(word.substr(0, i) + c + word.substr(i));
      if (i < word.size()) words.insert(word.substr(0, i) + c + word.substr(i + 1));
    }
    if (i < word.size()) words.insert(word.substr(0, i) + word.substr(i + 1));
    if (i + 1 < word.size()) words.insert(word.substr(0, i) + word[i + 1] + word[i] + word.substr(i + 2));
  }
  return words;
}

TEST(Nearest, one_edit_is_a_distance_of_one) {
  for (const std::string word : {"", "a", "ab", "abba", "bbabaa"}) {
    EXPECT_EQ(edit_distance(word, word), 0U);
    for (const std::string& other : edited(word))
      EXPECT_EQ(edit_distance(word, other), word == other ? 0U : 1U) << other;
  }
  EXPECT_EQ(edit_distance("kitten", "sitting"), 3U);
  EXPECT_EQ(edit_distance("ca", "abc"), 3U);  // the two letters that were swapped cannot be edited again
}

TEST(Nearest, only_what_is_near_is_suggested) {
  const std::vector<std::string> names = {"audit", "bake", "--samples", "--sample"};
  EXPECT_EQ(nearest_name("bka", names), "");
  EXPECT_EQ(nearest_name("bkae", names), "bake");
  EXPECT_EQ(nearest_name("--smaple", names), "--sample");
  EXPECT_EQ(nearest_name("duait", names), "audit");  // two edits in a word of five letters
  EXPECT_EQ(nearest_name("compare", names), "");
  EXPECT_EQ(nearest_name(std::string(40, 'a'), std::vector<std::string>{std::string(40, 'a')}), "");
  EXPECT_EQ(nearest_name("", names), "");
}

}  // namespace
}  // namespace chronormal::nearest_test
