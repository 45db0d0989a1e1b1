/// Changes bytes at random, to test that readers withstand any input.
#ifndef CHRONORMAL_TESTS_SUPPORT_RANDOM_EDITS_H_
#define CHRONORMAL_TESTS_SUPPORT_RANDOM_EDITS_H_

#include <cstddef>
#include <random>
#include <string>

namespace chronormal::test {

/// Returns the bytes after one to six random edits. Each edit changes a byte, inserts a byte, erases some bytes, or
/// repeats some of the bytes at another place.
[[nodiscard]] inline std::string with_random_edits(std::string bytes, std::mt19937& random) {
  for (std::size_t edits = 1 + random() % 6; edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = random() % bytes.size();
    const std::size_t from = random() % bytes.size();
    switch (random() % 4) {
      case 0:
        bytes[at] = static_cast<char>(random());
        break;
      case 1:
        bytes.insert(at, 1, static_cast<char>(random()));
        break;
      case 2:
        bytes.erase(at, 1 + random() % 8);
        break;
      default:
        bytes.insert(at, bytes.substr(from, random() % 24));
        break;
    }
  }
  return bytes;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_RANDOM_EDITS_H_
