/// Makes segments for tests in which no answer may be wrong: hard motions, and motions with small integer coordinates,
/// in which exact coincidences are frequent.
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

/// Returns the number of cases to test: the value of CHRONORMAL_FULL_CASES if it is set, otherwise 100,000, or 10,000
/// under a sanitizer.
[[nodiscard]] inline std::size_t wanted_cases() {
  const char* const full = std::getenv("CHRONORMAL_FULL_CASES");
  if (full != nullptr) return static_cast<std::size_t>(std::strtoull(full, nullptr, 10));
  return is_sanitized() ? 10000 : 100000;
}
/// Draws the number of instants at which a case is tested: 64 in one case of fifty, and 3 in all other cases.
[[nodiscard]] inline std::size_t wanted_times(Random& random) { return random.below(50) == 0 ? 64 : 3; }

/// Makes a moving triangle with integer coordinates from -3 to 3. In half of the cases, the triangle stays in a plane.
[[nodiscard]] inline MovingTriangle on_a_lattice(Random& random) {
  MovingTriangle triangle;
  const bool is_flat = random.below(2) == 0;
  for (auto* corners : {&triangle.from, &triangle.to}) {
    for (Point& p : *corners)
      for (std::size_t k = 0; k < 3; ++k) p[k] = k == 2 && is_flat ? 1 : static_cast<double>(random.below(7)) - 3;
  }
  return triangle;
}

/// Makes a moving triangle with two corners that are close to each other and far from the third.
[[nodiscard]] inline MovingTriangle needle(Random& random) {
  MovingTriangle triangle = ordinary(random);
  const double width = random_decade(random, -9, -3);
  for (auto* corners : {&triangle.from, &triangle.to}) {
    for (std::size_t k = 0; k < 3; ++k)
      (*corners)[1][k] = (*corners)[0][k] + width * ((*corners)[1][k] - (*corners)[0][k]);
  }
  return triangle;
}

/// Calls judge(segment, face, random) for about wanted_cases() / share faces, spread evenly over all families. judge()
/// describes a wrong answer, or returns "" if the answer is right. Returns the number of wrong answers, and prints a
/// line for each family.
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
