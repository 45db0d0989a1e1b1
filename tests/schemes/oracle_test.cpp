// Compares every scheme with an oracle that shares no code with the scheme (tests/support/reference.h).

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <memory>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/schemes/scheme.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference.h"
#include "tests/support/scheme_names.h"

namespace chronormal::oracle_test {
namespace {

using fixtures::Shape;
using test::scheme_names;

constexpr double kDegree = std::numbers::pi / 180;

// Returns the largest permitted difference between 1 and the length of a result. The scheme `rational` divides by a
// length that a quartic polynomial in float32 gives, and not by the length of its result. If n(t) is short relative to
// its control normals, the polynomial loses digits, but the direction is as accurate as in other schemes.
double length_tolerance(std::string_view scheme) { return scheme == "rational" ? 2e-6 : 1e-6; }

// A motion, and all data that schemes and oracles need.
struct Subject {
  explicit Subject(Motion moving) : motion(std::move(moving)), normals(motion.topology.face_count()) {
    face_control_normals(motion.segment(0), faces(), normals);
  }

  [[nodiscard]] IndexRange faces() const { return {0, motion.topology.face_count()}; }
  [[nodiscard]] Segment segment() const { return motion.segment(0); }

  [[nodiscard]] reference::Triangle triangle(std::size_t f) const {
    const Segment moving = segment();
    reference::Triangle result{};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      const auto vertex = motion.topology.face(f)[corner];
      const Vec3f a = moving.from[vertex], b = moving.to[vertex];
      result.from[corner] = {a.x, a.y, a.z};
      result.to[corner] = {b.x, b.y, b.z};
    }
    return result;
  }

  Motion motion;
  std::vector<ControlNormals> normals;
};

// The normals of a scheme for all faces, at equidistant times.
class Output {
 public:
  Output(const std::string& name, const Subject& subject, std::size_t sample_count)
      : face_count_(subject.faces().count), sample_count_(sample_count), values_(3 * face_count_ * sample_count) {
    auto scheme = make_scheme(name);
    EXPECT_TRUE(scheme.ok()) << name;
    if (!scheme) return;
    const Segment segment = subject.segment();
    scheme.value()->prepare({&segment, subject.faces(), subject.normals});
    fallback_count = scheme.value()->fallback_count();
    flagged_count = scheme.value()->flagged_count();
    for (std::size_t i = 0; i < sample_count; ++i) {
      float* const out = values_.data() + 3 * face_count_ * i;
      (void)scheme.value()->evaluate(time(i), VectorView<float>::packed(out, face_count_));
    }
  }

  [[nodiscard]] double time(std::size_t sample) const {
    return static_cast<double>(sample) / static_cast<double>(sample_count_ - 1);
  }
  [[nodiscard]] reference::VectorD at(std::size_t face, std::size_t sample) const {
    const float* const v = values_.data() + 3 * (face_count_ * sample + face);
    return {v[0], v[1], v[2]};
  }

  std::size_t fallback_count = 0;
  std::size_t flagged_count = 0;

 private:
  std::size_t face_count_;
  std::size_t sample_count_;
  std::vector<float> values_;
};

struct Family {
  const char* name;
  Motion (*make)();
};

const std::array<Family, 3> kFamilies{
    Family{"smooth morph", [] { return fixtures::smooth_morph(); }},
    Family{"soup, independent ends", [] { return fixtures::large_soup(); }},
    Family{"soup, motion 0.2", [] { return fixtures::moderate_soup(); }},
};

// Families of motions with few faces, since the dense searches are slow.
const std::array<Family, 4> kSmallFamilies{
    Family{"smooth morph", [] { return fixtures::smooth_morph(10); }},
    Family{"soup, independent ends", [] { return fixtures::large_soup(200, 11); }},
    Family{"soup, motion 0.2", [] { return fixtures::moderate_soup(200, 12); }},
    // If normals turn little, as between two frames of an animation, the normals at both ends are so close that the
    // circles among which quaternion:optimal searches differ visibly only if their angle phi is near +-pi/2.
    Family{"soup, motion 0.02", [] { return fixtures::soup({.face_count = 200, .seed = 13, .motion = 0.02}); }},
};

// ---- all schemes against their definitions -------------------------------------------------------------------------

class SchemeOracle : public testing::TestWithParam<std::string> {};

TEST_P(SchemeOracle, agrees_with_the_scheme) {
  constexpr std::size_t kSamples = 21;
  const std::string name = GetParam();
  ASSERT_TRUE(reference::parse_scheme(name)) << "the oracle does not know this scheme";
  for (const Family& family : kFamilies) {
    SCOPED_TRACE(family.name);
    const Subject subject(family.make());
    const Output output(name, subject, kSamples);
    double sum = 0, largest = 0, worst_time = 0, off_length = 0;
    std::size_t judged = 0, worst_face = 0;
    for (std::size_t f = 0; f < subject.faces().count; ++f) {
      const reference::Triangle triangle = subject.triangle(f);
      const reference::Vector middle = reference::to_real(output.at(f, kSamples / 2));
      for (std::size_t i = 0; i < kSamples; ++i) {
        const auto expected = reference::unit_normal(name, triangle, output.time(i), {f, 0}, middle);
        if (!expected) continue;
        const reference::VectorD given = output.at(f, i);
        off_length = std::max(off_length, std::fabs(reference::length(given) - 1));
        const double error = reference::angle(given, reference::to_double(*expected)) / kDegree;
        sum += error;
        ++judged;
        if (error > largest) {
          largest = error;
          worst_face = f;
          worst_time = output.time(i);
        }
      }
    }
    ASSERT_GT(judged, 0U);
    const double mean = sum / static_cast<double>(judged);
    const double share = static_cast<double>(judged) / static_cast<double>(subject.faces().count * kSamples);
    std::cout << "  " << family.name << ": mean " << mean << " deg, max " << largest << " deg (face " << worst_face
              << ", t = " << worst_time << "), length off by " << off_length << ", judged " << 100 * share
              << " %, fallbacks " << output.fallback_count << ", flagged " << output.flagged_count << "\n";
    EXPECT_GE(share, 0.95);
    EXPECT_LT(off_length, length_tolerance(name));
    EXPECT_LT(mean, 2e-4) << "degrees; worst: face " << worst_face << ", t = " << worst_time << ", " << largest;
  }
}

// Motions in which some scheme would divide by zero, overflow or be undefined.
const std::array<Family, 16> kNastyFamilies{
    Family{"needles", [] { return fixtures::needle_soup(200); }},
    Family{"edges of 1e-6", [] { return fixtures::tiny_soup(200); }},
    Family{"edges of 1e6", [] { return fixtures::huge_soup(200); }},
    Family{"edges of 1e-13", [] { return fixtures::soup({.face_count = 200, .seed = 31, .size = 1e-13}); }},
    Family{"edges of 1e17", [] { return fixtures::soup({.face_count = 200, .seed = 32, .size = 1e17}); }},
    Family{"far off the origin", [] { return fixtures::far_soup(200); }},
    Family{"nearly collapsing", [] { return fixtures::collapsing_soup(1e-4, 200); }},
    Family{"collapsing to rounding", [] { return fixtures::collapsing_soup(1e-30, 200); }},
    Family{"standing still", [] { return fixtures::soup({.face_count = 200, .seed = 33, .motion = 0}); }},
    Family{"turned inside out", [] { return fixtures::inside_out_soup(200); }},
    Family{"born of lines", [] { return fixtures::degenerate_soup(Shape::kLine, Shape::kTriangle); }},
    Family{"ending as lines", [] { return fixtures::degenerate_soup(Shape::kTriangle, Shape::kLine); }},
    Family{"from line to line", [] { return fixtures::degenerate_soup(Shape::kLine, Shape::kLine); }},
    Family{"born of points", [] { return fixtures::degenerate_soup(Shape::kPoint, Shape::kTriangle); }},
    Family{"ending as points", [] { return fixtures::degenerate_soup(Shape::kTriangle, Shape::kPoint); }},
    Family{"needles that stand still",
           [] { return fixtures::soup({.face_count = 200, .seed = 34, .motion = 0, .needle = 1e-7}); }},
};

TEST_P(SchemeOracle, meets_unit_vectors_or_zero_wherever_the_motion_is_nasty) {
  constexpr std::size_t kSamples = 101;
  const std::string name = GetParam();
  for (const Family& family : kNastyFamilies) {
    SCOPED_TRACE(family.name);
    const Subject subject(family.make());
    const Output output(name, subject, kSamples);
    double off_length = 0, worst_time = 0;
    std::size_t zeros = 0, worst_face = 0;
    for (std::size_t f = 0; f < subject.faces().count; ++f) {
      for (std::size_t i = 0; i < kSamples; ++i) {
        const reference::VectorD given = output.at(f, i);
        if (given == reference::VectorD{}) {
          ++zeros;
          continue;
        }
        const double off = std::fabs(reference::length(given) - 1);
        if (!(off <= off_length)) {  // also true if the difference is NaN
          off_length = off;
          worst_face = f;
          worst_time = output.time(i);
        }
      }
    }
    EXPECT_LT(off_length, length_tolerance(name)) << "face " << worst_face << ", t = " << worst_time;
    EXPECT_EQ(zeros, 0U) << "every one of these faces has a normal at some time";
  }
}

TEST_P(SchemeOracle, agrees_that_ends_without_a_normal_have_their_limits) {
  for (const auto& [start, end] :
       {std::pair{Shape::kTriangle, Shape::kTriangle}, std::pair{Shape::kLine, Shape::kTriangle},
        std::pair{Shape::kTriangle, Shape::kLine}, std::pair{Shape::kLine, Shape::kLine},
        std::pair{Shape::kPoint, Shape::kTriangle}, std::pair{Shape::kTriangle, Shape::kPoint}}) {
    const Subject subject(fixtures::degenerate_soup(start, end, 100));
    const Output output(GetParam(), subject, 2);
    for (std::size_t f = 0; f < subject.faces().count; ++f) {
      const reference::Triangle triangle = subject.triangle(f);
      for (const auto& [sample, inside] : {std::pair{0U, 0x1p-24L}, std::pair{1U, 1 - 0x1p-24L}}) {
        const auto expected = reference::exact_unit_normal(triangle, inside);  // the limit, up to 1e-5 radians
        ASSERT_TRUE(expected);
        ASSERT_LT(reference::angle(output.at(f, sample), reference::to_double(*expected)), 1e-5) << "face " << f;
      }
    }
  }
}

TEST_P(SchemeOracle, meets_zero_where_a_face_has_no_normal_at_any_time) {
  for (const auto& [start, end] : {std::pair{Shape::kPoint, Shape::kPoint}, std::pair{Shape::kPoint, Shape::kLine},
                                   std::pair{Shape::kLine, Shape::kPoint}}) {
    const Subject subject(fixtures::degenerate_soup(start, end, 20));
    const Output output(GetParam(), subject, 5);
    for (std::size_t f = 0; f < subject.faces().count; ++f) {
      for (std::size_t i = 0; i < 5; ++i) ASSERT_EQ(output.at(f, i), reference::VectorD{}) << "face " << f;
    }
  }
}

TEST_P(SchemeOracle, meets_the_same_bits_in_a_part_of_the_faces) {
  const Subject subject(fixtures::large_soup(60, 35));
  const IndexRange part{17, 30};
  const Output whole(GetParam(), subject, 5);
  auto scheme = make_scheme(GetParam());
  ASSERT_TRUE(scheme.ok());
  const Segment segment = subject.segment();
  scheme.value()->prepare({&segment, part, std::span(subject.normals).subspan(part.first, part.count)});
  std::vector<float> values(3 * part.count);
  const auto view = VectorView<float>::packed(values.data(), part.count);
  for (std::size_t i = 0; i < 5; ++i) {
    EXPECT_EQ(scheme.value()->evaluate(whole.time(i), view), 0U);
    for (std::size_t f = 0; f < part.count; ++f) {
      const Vec3d u = to_double(view[f]);
      ASSERT_EQ(whole.at(part.first + f, i), (reference::VectorD{u.x, u.y, u.z})) << "face " << part.first + f;
    }
  }
}

INSTANTIATE_TEST_SUITE_P(all, SchemeOracle, testing::ValuesIn(scheme_names()), [](const auto& tested) {
  std::string label = tested.param;
  std::replace(label.begin(), label.end(), ':', '_');
  return label;
});

// Tests a segment with index 1, since the random angles of quaternion:random depend on the index of the segment.
TEST(Oracle, agrees_with_random_frames_in_a_second_segment) {
  Motion motion = fixtures::large_soup(50, 36);
  motion.keyframes.insert(motion.keyframes.begin(), motion.keyframes[1]);
  motion.keyframes[0].time = -1;
  motion.segments.clear();
  motion.connect_as_sequence();
  ASSERT_EQ(motion.segments.size(), 2U);
  const Subject same_segment(fixtures::large_soup(50, 36));  // has the same triangles as segment 1
  const Segment segment = motion.segment(1);
  ASSERT_EQ(segment.index, 1U);
  auto scheme = make_scheme("quaternion:random:7");
  ASSERT_TRUE(scheme.ok());
  scheme.value()->prepare({&segment, same_segment.faces(), same_segment.normals});
  std::vector<float> values(3 * same_segment.faces().count);
  const auto view = VectorView<float>::packed(values.data(), same_segment.faces().count);
  (void)scheme.value()->evaluate(0.375, view);
  for (std::size_t f = 0; f < same_segment.faces().count; ++f) {
    const auto expected = reference::unit_normal("quaternion:random:7", same_segment.triangle(f), 0.375L, {f, 1});
    ASSERT_TRUE(expected);
    const Vec3d u = to_double(view[f]);
    EXPECT_LT(reference::angle({u.x, u.y, u.z}, reference::to_double(*expected)), 1e-5) << "face " << f;
  }
}

TEST(Oracle, knows_every_scheme_that_there_is) {
  EXPECT_FALSE(scheme_descriptions().empty());
  for (const std::string& name : scheme_names()) {
    EXPECT_TRUE(reference::parse_scheme(name)) << name << " has no oracle";
    EXPECT_TRUE(make_scheme(name).ok()) << name << " is described but cannot be made";
  }
}

TEST(Oracle, does_not_know_what_is_not_there) {
  for (const char* name : {"", "spline", "lagrange", "lagrange:", "lagrange:x", "quaternion", "quaternion:random"}) {
    EXPECT_FALSE(reference::parse_scheme(name)) << name;
  }
}

// ---- the oracle against itself -------------------------------------------------------------------------------------

TEST(Oracle, finds_every_quaternion_slerp_on_a_circle_of_constant_speed) {
  const Subject subject(fixtures::large_soup(200, 21));
  std::size_t judged = 0;
  for (const char* name : {"quaternion:matrix", "quaternion:edge", "quaternion:polar", "quaternion:random:3"}) {
    for (std::size_t f = 0; f < subject.faces().count; ++f) {
      const reference::Triangle triangle = subject.triangle(f);
      const auto at = [&](reference::Real t) { return reference::unit_normal(name, triangle, t, {f, 0}); };
      if (!at(0.5L)) continue;
      const auto circle = reference::circle_through(*at(0), *at(0.5L), *at(1));
      ASSERT_TRUE(circle);
      EXPECT_LE(circle->end, reference::kPi + 1e-6L);  // the shorter arc is at most half a turn
      for (const reference::Real t : {0.1L, 0.3L, 0.77L}) {
        EXPECT_LT(reference::angle(*at(t), circle->at(t * circle->end)), 1e-9L) << name << ", face " << f;
        ++judged;
      }
    }
  }
  EXPECT_GT(judged, 2000U);
}

TEST(Oracle, finds_no_pair_of_frames_better_than_its_dense_search) {
  const Subject subject(fixtures::large_soup(40, 22));
  for (std::size_t f = 0; f < subject.faces().count; ++f) {
    const reference::Triangle triangle = subject.triangle(f);
    const reference::ExactSamples exact(triangle, 201);
    const auto best = reference::optimal_circle_error(triangle, exact);
    ASSERT_TRUE(best);
    for (std::uint64_t seed = 0; seed < 20; ++seed) {
      const auto frames = reference::frames("random", triangle, seed, {f, 0});
      ASSERT_TRUE(frames);
      const double error = reference::mean_error(exact, [&](double t) {
        return reference::to_double(*reference::quaternion_slerp(frames->first, frames->second, t));
      });
      EXPECT_GE(error, *best * (1 - 1e-3)) << "face " << f << ", seed " << seed;
    }
  }
}

// ---- searched schemes ----------------------------------------------------------------------------------------------

// Compares a scheme that searches for the best curve of a family with a dense search in the same family, and with
// curves of the family that other schemes compute directly. Compares the average error over time of each face.
template <class DenseSearch>
void expect_nearly_optimal(const std::string& name, const std::vector<std::string>& members, DenseSearch&& search) {
  constexpr std::size_t kSamples = 201;
  for (const Family& family : kSmallFamilies) {
    SCOPED_TRACE(family.name);
    const Subject subject(family.make());
    const Output output(name, subject, kSamples);
    double total = 0, optimum = 0, worst_excess = 0;
    std::size_t judged = 0, worst_face = 0;
    for (std::size_t f = 0; f < subject.faces().count; ++f) {
      const reference::Triangle triangle = subject.triangle(f);
      const reference::ExactSamples exact(triangle, kSamples);
      const auto best = search(triangle, exact);
      if (!best) continue;
      const double error = reference::mean_error(exact, [&](double t) {
        return output.at(f, static_cast<std::size_t>(std::lround(t * static_cast<double>(kSamples - 1))));
      });
      ++judged;
      total += error;
      optimum += *best;
      if (error / *best - 1 > worst_excess && error - *best > 1e-6) {
        worst_excess = error / *best - 1;
        worst_face = f;
      }
      EXPECT_GE(error, *best * 0.99 - 1e-6) << "face " << f << " leaves the family: better than its best member";
      for (const std::string& member : members) {
        if (!reference::unit_normal(member, triangle, reference::Real(0.5L), {f, 0})) continue;
        const double other = reference::mean_error(exact, [&](double t) {
          return reference::to_double(*reference::unit_normal(member, triangle, t, {f, 0}));
        });
        EXPECT_LE(error, other * 1.01 + 1e-6) << "face " << f << " is worse than " << member;
      }
    }
    std::cout << "  " << family.name << ": " << total / optimum << " of the dense search over " << judged
              << " faces (mean " << optimum / static_cast<double>(judged) / kDegree << " deg), worst face "
              << worst_face << " by " << 100 * worst_excess << " %\n";
    EXPECT_GE(judged, subject.faces().count * 95 / 100);
    EXPECT_LE(total, optimum * 1.002);
    EXPECT_LE(worst_excess, 0.01) << "face " << worst_face;
  }
}

TEST(QuaternionOptimal, is_within_a_few_thousandths_of_a_dense_search_and_beats_every_other_frame) {
  expect_nearly_optimal(
      "quaternion:optimal", {"slerp", "quaternion:matrix", "quaternion:edge", "quaternion:polar"},
      [](const auto& triangle, const auto& exact) { return reference::optimal_circle_error(triangle, exact); });
}

TEST(LinearScaled, is_within_a_few_thousandths_of_a_dense_search_and_never_worse_than_linear) {
  expect_nearly_optimal("linear:scaled", {"linear"}, [](const auto& triangle, const auto& exact) {
    return reference::scaled_linear_error(triangle, exact);
  });
}

TEST(LinearScaled, meets_an_element_of_degree_1_by_the_ratio_of_its_areas) {
  // One edge rests and the other moves, so n(t) is linear, and linear interpolation with the right scale is exact. This
  // scale is the ratio of the areas. A search that does not try this ratio has an error of up to 3e-4 radians.
  struct Case {
    double ratio, turn;
  };
  for (const auto& [ratio, turn] : {Case{0.2035, 1.3639},
                                    {2.5507, 1.5899},
                                    {1.4755, 1.5553},
                                    {0.2189, 2.0712},
                                    {4.8312, 1.9857},
                                    {0.0225, 1.0805},
                                    {100, 2.5},
                                    {1, 0.7}}) {
    const double y1 = ratio * std::cos(turn), z1 = ratio * std::sin(turn);
    const Motion motion = fixtures::make_motion(fixtures::make_triangles(3, {0, 1, 2}),
                                                {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 0, 0}, {1, 0, 0}, {0, y1, z1}});
    const Segment segment = motion.segment(0);
    ControlNormals normals;
    face_control_normals(segment, {0, 1}, {&normals, 1});
    const auto scheme = make_scheme("linear:scaled").value();
    scheme->prepare({&segment, {0, 1}, {&normals, 1}});
    for (int k = 0; k <= 32; ++k) {
      const double t = k / 32.0;
      float u[3];
      (void)scheme->evaluate(t, VectorView<float>::packed(u, 1));
      const Vec3d by_hand{0, -t * z1, 1 - t + t * y1};
      EXPECT_LE(angle_between({u[0], u[1], u[2]}, by_hand), 1e-6) << "ratio " << ratio << ", turn " << turn;
    }
  }
}

// ---- the exact curve in float32 ------------------------------------------------------------------------------------

TEST(PolynomialScheme, has_an_error_above_zero_and_below_a_ten_thousandth_of_a_degree_on_large_motion) {
  constexpr std::size_t kSamples = 21;
  const Subject subject(fixtures::large_soup());
  const Output output("polynomial", subject, kSamples);
  double largest = 0;
  std::size_t judged = 0;
  for (std::size_t f = 0; f < subject.faces().count; ++f) {
    const reference::Triangle triangle = subject.triangle(f);
    const auto n0 = reference::exact_normal(triangle, 0), n1 = reference::exact_normal(triangle, 1);
    const auto half = reference::exact_normal(triangle, reference::Real(0.5L));
    const auto m = reference::subtract(reference::scaled(reference::Real(2), half),
                                       reference::scaled(reference::Real(0.5L), reference::add(n0, n1)));
    const auto size = std::max({reference::length(n0), reference::length(m), reference::length(n1)});
    for (std::size_t i = 0; i < kSamples; ++i) {
      const auto normal = reference::exact_normal(triangle, output.time(i));
      if (reference::length(normal) < 1e-10L * size) continue;
      largest = std::max(largest, reference::angle(output.at(f, i), reference::to_double(normal)) / kDegree);
      ++judged;
    }
  }
  std::cout << "  largest error " << largest << " deg, " << output.flagged_count << " of " << subject.faces().count
            << " faces in double\n";
  EXPECT_GT(judged, subject.faces().count * kSamples * 99 / 100);
  EXPECT_GT(largest, 0);
  EXPECT_LT(largest, 1e-4);
}

}  // namespace
}  // namespace chronormal::oracle_test
