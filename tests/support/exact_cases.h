/// Segments for tests that demand no wrong answer at all: hard motions, and small whole coordinates, which meet every
/// exact coincidence again and again.
#ifndef CHRONORMAL_TESTS_SUPPORT_EXACT_CASES_H_
#define CHRONORMAL_TESTS_SUPPORT_EXACT_CASES_H_

#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <string>

#include "tests/support/child_process.h"
#include "tests/support/hard_motions.h"

namespace chronormal::test {

/// How many cases are wanted: 100,000, or a tenth of that where a sanitizer watches, or what the variable
/// CHRONORMAL_FULL_CASES says.
[[nodiscard]] inline std::size_t wanted_cases() {
  const char* const full = std::getenv("CHRONORMAL_FULL_CASES");
  if (full != nullptr) return static_cast<std::size_t>(std::strtoull(full, nullptr, 10));
  return is_sanitized() ? 10000 : 100000;
}
/// At how many instants a case is looked at: few, and 64 in one of fifty.
[[nodiscard]] inline std::size_t wanted_times(Random& random) { return random.below(50) == 0 ? 64 : 3; }

/// Corners among -3 ... 3, half of them in a plane.
[[nodiscard]] inline MovingTriangle on_a_lattice(Random& random) {
  MovingTriangle triangle;
  const bool is_flat = random.below(2) == 0;
  for (auto* corners : {&triangle.from, &triangle.to}) {
    for (Point& p : *corners)
      for (std::size_t k = 0; k < 3; ++k) p[k] = k == 2 && is_flat ? 1 : static_cast<double>(random.below(7)) - 3;
  }
  return triangle;
}

/// Two corners close to each other, far from the third.
[[nodiscard]] inline MovingTriangle needle(Random& random) {
  MovingTriangle triangle = ordinary(random);
  const double width = random_decade(random, -9, -3);
  for (auto* corners : {&triangle.from, &triangle.to}) {
    for (std::size_t k = 0; k < 3; ++k)
      (*corners)[1][k] = (*corners)[0][k] + width * ((*corners)[1][k] - (*corners)[0][k]);
  }
  return triangle;
}

/// Calls judge(segment, face, random), which returns what is wrong or nothing, on faces of all families until there are
/// enough: so many, or a share of them. Returns the number of wrong answers, and prints a line for each family.
template <class Judge>
std::size_t judge_cases(std::uint64_t seed, const Judge& judge, std::size_t share = 1) {
  std::vector<HardMotions> families = hard_motions();
  families.push_back({"on a lattice", [](Random& r) { return soup_of(r, on_a_lattice); }});
  families.push_back({"needles", [](Random& r) { return soup_of(r, needle); }});
  std::size_t wrong = 0;
  for (std::size_t k = 0; k < families.size(); ++k) {
    Random random(seed + k);
    std::size_t cases = 0, wrong_here = 0;
    std::string first;
    while (cases < wanted_cases() / share / families.size() + 1) {
      const Motion motion = families[k].make(random);
      for (std::size_t f = 0; f < motion.topology.face_count(); ++f, ++cases) {
        const std::string fault = judge(motion.segment(0), f, random);
        if (!fault.empty() && wrong_here++ == 0) first = fault;
      }
    }
    std::cout << "  " << families[k].name << ": " << cases << " cases from seed " << seed + k << ", " << wrong_here
              << " wrong" << (first.empty() ? "" : ", first: " + first) << '\n';
    wrong += wrong_here;
  }
  return wrong;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_EXACT_CASES_H_
