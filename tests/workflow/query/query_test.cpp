// Tests which parts of which segments belong to an interval of time.
#include "chronormal/workflow/query.h"

#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <vector>

#include "tests/support/fixtures.h"

namespace chronormal::query_test {
namespace {

// Checks in rational numbers that the parts of segments include every instant of an interval of time, and that they
// exceed the interval by at most one rounding of t.
TEST(SegmentParts, hold_the_whole_span) {
  constexpr std::uint64_t kSeed = 20261128;
  std::cout << "  from seed " << kSeed << '\n';
  fixtures::Random random(kSeed);
  Motion motion = fixtures::large_soup(1);
  std::size_t not_doubles = 0;
  for (int i = 0; i < 2000; ++i) {
    double times[4];
    const bool is_whole = i % 2 == 0;
    for (double& time : times) time = is_whole ? static_cast<double>(random.below(1000)) : random.uniform(-9, 9);
    std::sort(times, times + 4);
    if (!(times[0] < times[1] && times[1] < times[2] && times[2] < times[3])) continue;
    motion.keyframes[0].time = times[0];
    motion.keyframes[1].time = times[3];
    const std::vector<SegmentPart> parts = segment_parts(motion, {times[1], times[2]}).value();
    ASSERT_EQ(parts.size(), 1u);
    const auto exact = [&](double time) {
      return mpq_class((mpq_class(time) - mpq_class(times[0])) / (mpq_class(times[3]) - mpq_class(times[0])));
    };
    EXPECT_LE(mpq_class(parts[0].t0), exact(times[1]));
    EXPECT_GE(mpq_class(parts[0].t1), exact(times[2]));
    EXPECT_LE(exact(times[1]) - mpq_class(parts[0].t0), mpq_class(0x1p-52));
    EXPECT_LE(mpq_class(parts[0].t1) - exact(times[2]), mpq_class(0x1p-52));
    not_doubles += exact(times[1]) != mpq_class(parts[0].t0) ? 1U : 0U;
  }
  EXPECT_GT(not_doubles, 1000u);
}

TEST(SegmentParts, end_with_the_segment_where_the_span_goes_on) {
  Motion motion = fixtures::large_soup(1);
  motion.keyframes[1].time = 3;
  const std::vector<SegmentPart> all = segment_parts(motion, {}).value();
  EXPECT_EQ(all[0].t0, 0);
  EXPECT_EQ(all[0].t1, 1);
  const std::vector<SegmentPart> half = segment_parts(motion, {1.5, 9.0}).value();
  EXPECT_EQ(half[0].t0, 0.5);
  EXPECT_EQ(half[0].t1, 1);
}

}  // namespace
}  // namespace chronormal::query_test
