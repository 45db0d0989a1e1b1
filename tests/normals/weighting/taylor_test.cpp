// Tests interval arithmetic, and Taylor series whose coefficients are intervals. All intervals must contain the true
// values.

#include "normals/weighting/taylor.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>

#include "normals/weighting/series_bounds.h"
#include "tests/support/fixtures.h"

namespace chronormal::taylor_test {
namespace {

using Real = long double;

bool contains(const Interval& a, Real x) { return Real(a.low) <= x && x <= Real(a.high); }

RC_GTEST_PROP(Interval, results_contain_those_of_all_numbers_inside, ()) {
  fixtures::Random random(*rc::gen::arbitrary<std::uint64_t>());
  const auto any = [&] {
    const double middle = random.uniform(-2, 2) * std::pow(10, random.uniform(-9, 9));
    const double radius = std::fabs(middle) * random.uniform(0, 1.5) * (random.below(3) == 0 ? 0 : 1);
    return Interval{middle - radius, middle + radius};
  };
  const auto inside = [&](const Interval& a) {
    const double x = a.low + random.uniform(0, 1) * (a.high - a.low);
    return Real(std::fmin(std::fmax(x, a.low), a.high));
  };
  for (int round = 0; round < 50; ++round) {
    const Interval a = any(), b = any();
    const Real x = inside(a), y = inside(b);
    RC_ASSERT(contains(a + b, x + y));
    RC_ASSERT(contains(a - b, x - y));
    RC_ASSERT(contains(a * b, x * y));
    RC_ASSERT(contains((1 / 3.0) * b, y / 3));
    RC_ASSERT(contains(square(a), x * x) && square(a).low >= 0);
    RC_ASSERT(contains(reciprocal(a), 1 / x));
    if (a.low >= 0) RC_ASSERT(contains(square_root(a), std::sqrt(x)));
    const Interval upper = square(b);
    const Real z = y * y;
    RC_ASSERT(contains(angle_of(upper, a), std::atan2(z, x)));
  }
}

TEST(Interval, what_is_not_defined_everywhere_is_the_whole_line) {
  EXPECT_FALSE(reciprocal({-1, 2}).finite());
  EXPECT_FALSE(reciprocal({0, 2}).finite());
  EXPECT_FALSE(square_root({-1e-300, 2}).finite());
  EXPECT_FALSE(angle_of({0, 1}, {-1, 1}).finite()) << "the origin is inside";
  EXPECT_FALSE((Interval::whole() * Interval{0, 0}).finite());
  EXPECT_FALSE((Interval::whole() - Interval::whole()).finite());
}

// p(t) = 1 + a t + b t^2. The coefficients are so small that p is positive over [-1, 1].
struct Quadratic {
  double a, b;

  [[nodiscard]] Real operator()(Real t) const { return 1 + a * t + b * t * t; }
  [[nodiscard]] Series<3> about(double c) const {
    const auto point = Interval::point;
    const Interval first = point(a) + 2.0 * (point(b) * point(c));
    return {point(1) + point(c) * (point(a) + point(b) * point(c)), first, point(b)};
  }
};

RC_GTEST_PROP(Taylor, polynomial_and_remainder_contain_the_function, ()) {
  fixtures::Random random(*rc::gen::arbitrary<std::uint64_t>());
  const Quadratic p{random.uniform(-0.6, 0.6), random.uniform(-0.3, 0.3)};
  const double centre = random.uniform(-0.5, 0.5), half = random.uniform(0.01, 0.4);
  for (const double exponent : {-0.5, 0.5, -1.0}) {
    const auto series = [&](const Interval& around) {
      const Series<3> here = shifted(p.about(centre), around);
      const Interval root = exponent == -1 ? here[0] : square_root(here[0]);
      return power<6>(here, exponent, exponent == 0.5 ? root : reciprocal(root));
    };
    const Series<6> at_centre = series({0, 0}), everywhere = series({-half, half});
    for (int round = 0; round < 20; ++round) {
      const double s = random.uniform(-half, half);
      Interval value = everywhere[5] * Interval::point(s);
      for (std::size_t k = 5; k > 1; --k) value = (value + at_centre[k - 1]) * Interval::point(s);
      value = value + at_centre[0];
      const Real truth = std::pow(p(Real(centre) + Real(s)), Real(exponent));
      RC_ASSERT(Real(value.low) <= truth + 1e-18L && truth <= Real(value.high) + 1e-18L);
      // The coefficients about any other point of the piece must overlap with those in `everywhere`, which hold about
      // all points of the piece.
      const Series<3> there = p.about(centre + s);
      const Interval root = exponent == -1 ? there[0] : square_root(there[0]);
      const Series<6> other = power<6>(there, exponent, exponent == 0.5 ? root : reciprocal(root));
      for (std::size_t k = 0; k < 6; ++k) {
        RC_ASSERT(everywhere[k].low <= other[k].high && other[k].low <= everywhere[k].high);
      }
    }
  }
}

RC_GTEST_PROP(Taylor, the_polynomial_alone_does_not_contain_the_function, ()) {
  // In this test, the enclosure is so narrow that a missing remainder would be noticed.
  fixtures::Random random(*rc::gen::arbitrary<std::uint64_t>());
  const Quadratic p{random.uniform(0.3, 0.6), random.uniform(-0.3, 0.3)};
  const Series<6> taylor = power<6>(p.about(0), -0.5, reciprocal(square_root(p.about(0)[0])));
  Interval value;
  for (std::size_t k = 5; k > 0; --k) value = value * Interval::point(0.4) + taylor[k - 1];
  RC_ASSERT(value.high - value.low < 1e-14);
  RC_ASSERT(!contains(value, 1 / std::sqrt(p(0.4L))));
}

// ---- bounds over a piece -------------------------------------------------------------------------------------------

// The Taylor coefficients of 1 / sqrt(p): about c, and about all points of [c - half, c + half] at once.
struct PieceOfRoot {
  Series<6> here, around;

  PieceOfRoot(const Quadratic& p, double c, double half) {
    const auto series = [&](const Interval& piece) {
      const Series<3> of_p = shifted(p.about(c), piece);
      return power<6>(of_p, -0.5, reciprocal(square_root(of_p[0])));
    };
    here = series({0, 0});
    around = series({-half, half});
  }
};

// The pieces are so long that the Taylor polynomial alone has errors of several percent, so the bounds hold only
// because they include the remainder.
TEST(SeriesBounds, hold_at_all_times_of_a_piece_and_would_not_without_the_remainder) {
  fixtures::Random random(83);
  std::size_t above_polynomial = 0, longer_than_polynomial = 0;
  for (int round = 0; round < 300; ++round) {
    const double centre = random.uniform(-0.3, 0.3), half = random.uniform(0.2, 0.6);
    std::array<Quadratic, 3> p{};
    VectorSeries<6> here, around;
    for (std::size_t k = 0; k < 3; ++k) {
      p[k] = {random.uniform(-0.7, 0.7), random.uniform(-0.2, 0.2)};
      const PieceOfRoot piece(p[k], centre, half);
      here[k] = piece.here;
      around[k] = piece.around;
    }
    const Series<6> none{};
    const double least = least_over(here[0], around[0], half, 0), unsafe = least_over(here[0], none, half, 0);
    const double largest = largest_length_over(here, around, half, 0);
    const double unsafe_length = largest_length_over(here, {none, none, none}, half, 0);
    for (int i = -32; i <= 32; ++i) {
      const Real t = Real(centre) + Real(half) * i / 32;
      Real square = 0;
      for (const Quadratic& q : p) square += 1 / q(t);
      ASSERT_LE(Real(least), 1 / std::sqrt(p[0](t))) << round;
      ASSERT_GE(Real(largest), std::sqrt(square)) << round;
      above_polynomial += Real(unsafe) > 1 / std::sqrt(p[0](t)) ? 1U : 0U;
      longer_than_polynomial += Real(unsafe_length) < std::sqrt(square) ? 1U : 0U;
    }
    ASSERT_EQ(least_over(here[0], none, half, 0.25), unsafe - (1 + 0x1p-50) * 0.25);
    ASSERT_EQ(largest_length_over(here, {none, none, none}, half, 0.25), unsafe_length + 0.25);
  }
  EXPECT_GT(above_polynomial, 0U) << "no piece shows whether there is a remainder";
  EXPECT_GT(longer_than_polynomial, 0U) << "no piece shows whether there is a remainder";
}

}  // namespace
}  // namespace chronormal::taylor_test
