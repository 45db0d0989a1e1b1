// Compares control normals, which are in double, and their curves, which are in float32, with exact rational arithmetic
// (tests/support/exact_normal.h).

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_curves.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"

namespace chronormal::accuracy_test {
namespace {

constexpr std::size_t kFaces = 300;
constexpr double kPromised = 1e-6;  // in radians, the guaranteed largest error (evaluate.h)

struct Family {
  const char* name;
  Motion (*make)();
};

// Makes faces whose n(t) has degree 0, 1 or 2, a third of each: faces at rest, faces with one moving corner, and faces
// whose corners all move.
Motion mixed_degrees() {
  Motion motion = fixtures::moderate_soup(kFaces, 41);
  const auto& from = motion.keyframes[0].positions;
  auto& to = motion.keyframes[1].positions;
  for (std::size_t f = 0; f < kFaces; ++f) {
    const std::size_t still = f % 3;  // 0: all corners move; 1: all corners rest; 2: only corner c moves
    if (still == 0) continue;
    const std::size_t count = still == 1 ? 9 : 6;
    for (std::size_t k = 0; k < count; ++k) to[9 * f + k] = from[9 * f + k];
  }
  return motion;
}

const std::array<Family, 18> kFamilies{
    Family{"random, independent ends", [] { return fixtures::large_soup(kFaces); }},
    Family{"random, motion 0.2", [] { return fixtures::moderate_soup(kFaces); }},
    Family{"needles", [] { return fixtures::needle_soup(kFaces); }},
    Family{"needles, motion 0.2",
           [] { return fixtures::soup({.face_count = kFaces, .seed = 42, .motion = 0.2, .needle = 1e-4}); }},
    Family{"needles of 1e-6", [] { return fixtures::soup({.face_count = kFaces, .seed = 43, .needle = 1e-6}); }},
    Family{"edges of 1e-6", [] { return fixtures::tiny_soup(kFaces); }},
    Family{"edges of 1e-13", [] { return fixtures::soup({.face_count = kFaces, .seed = 44, .size = 1e-13}); }},
    Family{"edges of 1e6", [] { return fixtures::huge_soup(kFaces); }},
    Family{"edges of 1e18", [] { return fixtures::soup({.face_count = kFaces, .seed = 45, .size = 1e18}); }},
    Family{"far off the origin", [] { return fixtures::far_soup(kFaces); }},
    Family{"far off, motion 0.2",
           [] { return fixtures::soup({.face_count = kFaces, .seed = 46, .motion = 0.2, .offset = 1e4}); }},
    Family{"passing a collapse by 0.1", [] { return fixtures::collapsing_soup(0.1, kFaces); }},
    Family{"passing a collapse by 1e-3", [] { return fixtures::collapsing_soup(1e-3, kFaces); }},
    Family{"passing a collapse by 1e-5", [] { return fixtures::collapsing_soup(1e-5, kFaces); }},
    Family{"motion of 1e-9 to 1", [] { return fixtures::graded_soup(kFaces); }},
    Family{"thinnest needles", [] { return fixtures::thinnest_soup(false, kFaces); }},
    Family{"thinnest needles in a plane", [] { return fixtures::thinnest_soup(true, kFaces); }},
    Family{"degrees 0, 1 and 2", mixed_degrees},
};

exact::Triangle exact_triangle(const Segment& segment, std::size_t f) {
  exact::Triangle result;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const auto vertex = segment.topology->face(f)[corner];
    const Vec3f a = segment.from[vertex], b = segment.to[vertex];
    result.from[corner] = exact::vector(a.x, a.y, a.z);
    result.to[corner] = exact::vector(b.x, b.y, b.z);
  }
  return result;
}

std::vector<ControlNormals> control_normals(const Segment& segment) {
  std::vector<ControlNormals> normals(segment.topology->face_count());
  face_control_normals(segment, {0, normals.size()}, normals);
  return normals;
}

// Returns the time at which |n(t)| is smallest, where float32 has the largest errors.
double hardest_time(const ControlNormals& normals) {
  double best = 0, smallest = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 256; ++i) {
    const double t = i / 256.0, size = length(normal_at(normals, t));
    if (size < smallest) {
      smallest = size;
      best = t;
    }
  }
  double low = std::max(0.0, best - 1 / 256.0), high = std::min(1.0, best + 1 / 256.0);
  for (int i = 0; i < 60; ++i) {
    const double left = low + (high - low) / 3, right = high - (high - low) / 3;
    if (length(normal_at(normals, left)) < length(normal_at(normals, right))) {
      high = right;
    } else {
      low = left;
    }
  }
  return (low + high) / 2;
}

// Returns the times at which a face is tested: both ends, the time with the smallest |n(t)| and times near it, and
// random times in float32 and in double.
std::vector<double> times(const ControlNormals& normals, fixtures::Random& random) {
  const double hard = hardest_time(normals);
  std::vector<double> result{0, 1, 0.5, 1.0 / 3, 0x1p-30, 1 - 0x1p-30, hard};
  for (const double step : {1e-2, 1e-4}) {
    result.push_back(std::max(0.0, hard - step));
    result.push_back(std::min(1.0, hard + step));
  }
  for (int i = 0; i < 3; ++i) result.push_back(random.uniform(0, 1));
  result.push_back(static_cast<float>(random.uniform(0, 1)));
  return result;
}

// The largest error of one element of `curves` over many times, in radians, compared with exact normals. If float32 is
// not accurate enough for the element (it is flagged), times with |n(t)| below 1e-6 of the largest control normal are
// skipped.
struct Judgement {
  double largest = 0;
  double time = 0;
  std::size_t judged = 0;
  std::size_t left_out = 0;
};

Judgement judge(const NormalCurves& curves, std::size_t element, bool is_flagged, const ControlNormals& normals,
                const exact::Triangle& triangle, const exact::ControlNormals& exact_normals, fixtures::Random& random) {
  Judgement judgement;
  const exact::Rational largest_control = exact::max_abs(exact_normals);
  std::vector<float> out(3 * curves.size());
  for (const double t : times(normals, random)) {
    const exact::Vector expected = exact::normal_at(triangle, t);
    const bool is_small = exact::max_abs(expected) * 1000000 <= largest_control;
    if (exact::is_zero(expected) || (is_flagged && is_small)) {
      ++judgement.left_out;
      continue;
    }
    EXPECT_EQ(curves.unit_normals(t, VectorView<float>::packed(out.data(), curves.size())), 0U) << "t = " << t;
    const float* const u = out.data() + 3 * element;
    const double error = exact::angle(u[0], u[1], u[2], expected);
    EXPECT_NEAR(u[0] * u[0] + u[1] * u[1] + u[2] * u[2], 1.0F, 1e-6F) << "t = " << t;
    ++judgement.judged;
    if (!(error <= judgement.largest)) {
      judgement.largest = error;
      judgement.time = t;
    }
  }
  return judgement;
}

TEST(ExactNormals, agree_between_eq_1_and_eq_5) {
  fixtures::Random random(51);
  const Motion motion = fixtures::large_soup(50, 52);
  for (std::size_t f = 0; f < 50; ++f) {
    const exact::Triangle triangle = exact_triangle(motion.segment(0), f);
    const exact::ControlNormals normals = exact::control_normals(triangle);
    for (int i = 0; i < 5; ++i) {
      const double t = random.uniform(0, 1);
      ASSERT_EQ(exact::normal_at(triangle, t), exact::normal_at(normals, t));
    }
  }
}

TEST(ExactAngle, tells_the_smallest_angles_apart) {
  const exact::Vector x = exact::vector(1e-30, 0.0, 0.0);
  EXPECT_EQ(exact::angle(3.0, 0.0, 0.0, x), 0);
  EXPECT_NEAR(exact::angle(1.0, 1e-12, 0.0, x), 1e-12, 1e-26);
  EXPECT_NEAR(exact::angle(1e20, 0.0, 1e20, x), std::atan2(1, 1), 1e-15);
  EXPECT_NEAR(exact::angle(-1.0, 1e-12, 0.0, x), std::acos(-1.0), 1e-11);
  EXPECT_TRUE(std::isnan(exact::angle(0.0, 0.0, 0.0, x)));
}

// Each component of a control normal is a sum of a few products of edges. The error of a component is a few roundings
// of the largest of these products, which may be much larger than the component itself.
TEST(FaceControlNormals, are_within_a_few_roundings_of_exact_arithmetic) {
  for (const Family& family : kFamilies) {
    SCOPED_TRACE(family.name);
    const Motion motion = family.make();
    const Segment segment = motion.segment(0);
    const auto normals = control_normals(segment);
    double largest = 0, largest_of_normal = 0;
    for (std::size_t f = 0; f < normals.size(); ++f) {
      const exact::Triangle triangle = exact_triangle(segment, f);
      const exact::ControlNormals expected = exact::control_normals(triangle);
      exact::Rational edge = 0;
      for (const auto* corners : {&triangle.from, &triangle.to}) {
        for (std::size_t i = 1; i < 3; ++i) {
          edge = std::max(edge, exact::max_abs(exact::subtract((*corners)[i], (*corners)[0])));
        }
      }
      for (const auto& [given, right] : {std::pair{&normals[f].n0, &expected.n0}, std::pair{&normals[f].m, &expected.m},
                                         std::pair{&normals[f].n1, &expected.n1}}) {
        const exact::Rational error =
            exact::max_abs(exact::subtract(exact::vector(given->x, given->y, given->z), *right));
        const double roundings = exact::ratio(error, edge * edge) * 0x1p53;
        largest = std::max(largest, roundings);
        if (!exact::is_zero(*right)) {
          largest_of_normal = std::max(largest_of_normal, exact::ratio(error, exact::max_abs(*right)));
        }
        EXPECT_LE(roundings, 8) << "face " << f;
      }
    }
    std::cout << "  " << family.name << ": largest error " << largest << " roundings of edge^2, " << largest_of_normal
              << " of the control normal itself\n";
  }
}

TEST(NormalCurvesAccuracy, are_within_a_millionth_of_a_radian_of_exact_arithmetic) {
  fixtures::Random random(53);
  for (const Family& family : kFamilies) {
    SCOPED_TRACE(family.name);
    const Motion motion = family.make();
    const Segment segment = motion.segment(0);
    const auto normals = control_normals(segment);
    std::array<double, 2> largest{};
    std::array<std::size_t, 2> count{}, judged{};
    std::size_t left_out = 0;
    for (std::size_t f = 0; f < normals.size(); ++f) {
      // The curves have only this face, so flagged_count() tells whether the face is flagged.
      const NormalCurves curves{std::span(normals).subspan(f, 1)};
      ASSERT_LE(curves.flagged_count(), 1U);
      const std::size_t flagged = curves.flagged_count();
      const exact::Triangle triangle = exact_triangle(segment, f);
      const Judgement judgement =
          judge(curves, 0, flagged == 1, normals[f], triangle, exact::control_normals(triangle), random);
      EXPECT_LE(judgement.largest, kPromised)
          << "face " << f << ", t = " << judgement.time << (flagged == 1 ? ", flagged" : ", not flagged");
      largest[flagged] = std::max(largest[flagged], judgement.largest);
      judged[flagged] += judgement.judged;
      left_out += judgement.left_out;
      ++count[flagged];
    }
    std::cout << "  " << family.name << ": flagged "
              << 100 * static_cast<double>(count[1]) / static_cast<double>(normals.size()) << " %, largest error "
              << largest[0] << " rad (" << judged[0] << " samples), flagged " << largest[1] << " rad (" << judged[1]
              << " samples), left out " << left_out << "\n";
    EXPECT_LE(left_out, (judged[0] + judged[1]) / 2);
  }
}

// All float32 elements of a block have a common exponent. This test checks that elements of other sizes in the same
// block do not reduce the accuracy.
TEST(NormalCurvesAccuracy, keep_their_accuracy_among_neighbours_of_any_size_and_degree) {
  fixtures::Random random(54);
  std::vector<ControlNormals> normals;
  std::vector<exact::Triangle> triangles;
  std::vector<bool> flagged_alone;
  std::size_t flagged_count = 0;
  std::vector<Motion> motions;
  for (const Family& family : kFamilies) motions.push_back(family.make());
  for (std::size_t f = 0; f < kFaces; f += 30) {
    for (const Motion& motion : motions) {
      const Segment segment = motion.segment(0);
      const std::size_t repeat =
          // Elements of one family are together, in runs shorter or longer than 8 elements.
          random.below(12) < 8 ? std::size_t{1} : std::size_t{12};
      for (std::size_t i = f; i < std::min(f + repeat, kFaces); ++i) {
        normals.emplace_back();
        face_control_normals(segment, {i, 1}, std::span(normals).last(1));
        triangles.push_back(exact_triangle(segment, i));
        flagged_alone.push_back(NormalCurves{std::span(normals).last(1)}.flagged_count() == 1);
        if (flagged_alone.back()) ++flagged_count;
      }
    }
  }
  const NormalCurves curves(normals);
  double largest = 0;
  for (std::size_t i = 0; i < normals.size(); ++i) {
    // If an element is flagged only because of its neighbours, the test judges it as if it were not flagged, which is
    // stricter.
    const Judgement judgement =
        judge(curves, i, flagged_alone[i], normals[i], triangles[i], exact::control_normals(triangles[i]), random);
    EXPECT_LE(judgement.largest, kPromised) << "element " << i << ", t = " << judgement.time;
    largest = std::max(largest, judgement.largest);
  }
  std::cout << "  " << normals.size() << " elements, flagged " << curves.flagged_count() << " (alone " << flagged_count
            << "), largest error " << largest << " rad\n";
}

// ---- where n(t) = 0 ------------------------------------------------------------------------------------------------

// Returns the exact direction of n(t) just before t = 1, which is documented as the direction if n(1) = 0: the last
// control normal that is not zero.
exact::Vector limit_before(const exact::ControlNormals& normals) {
  if (!exact::is_zero(normals.n1)) return normals.n1;
  return exact::is_zero(normals.m) ? normals.n0 : normals.m;
}

exact::Vector limit_after(const exact::ControlNormals& normals) {
  if (!exact::is_zero(normals.n0)) return normals.n0;
  return exact::is_zero(normals.m) ? normals.n1 : normals.m;
}

void expect_direction(const Motion& motion, double t, Direction direction,
                      exact::Vector (*expected)(const exact::ControlNormals&)) {
  const auto normals = control_normals(motion.segment(0));
  std::vector<float> out(3 * normals.size());
  const auto view = VectorView<float>::packed(out.data(), normals.size());
  EXPECT_EQ(NormalCurves(normals).unit_normals(t, view), 0U);
  for (std::size_t f = 0; f < normals.size(); ++f) {
    const exact::Vector limit = expected(exact::control_normals(exact_triangle(motion.segment(0), f)));
    const UnitNormal u = unit_normal_at(normals[f], t);
    ASSERT_EQ(u.direction, direction) << "face " << f;
    ASSERT_LE(exact::angle(u.vector.x, u.vector.y, u.vector.z, limit), 1e-12) << "face " << f;
    ASSERT_LE(exact::angle(view[f].x, view[f].y, view[f].z, limit), kPromised) << "face " << f;
  }
}

TEST(VanishingNormal, has_its_limit_at_the_ends_of_a_segment) {
  using fixtures::degenerate_soup;
  using fixtures::Shape;
  for (const Shape shape : {Shape::kLine, Shape::kPoint}) {
    expect_direction(degenerate_soup(shape, Shape::kTriangle), 0, Direction::kLimit, limit_after);
    expect_direction(degenerate_soup(shape, Shape::kTriangle), 1, Direction::kRegular, limit_before);
    expect_direction(degenerate_soup(Shape::kTriangle, shape), 0, Direction::kRegular, limit_after);
    expect_direction(degenerate_soup(Shape::kTriangle, shape), 1, Direction::kLimit, limit_before);
  }
  expect_direction(degenerate_soup(Shape::kLine, Shape::kLine), 0, Direction::kLimit, limit_after);
  expect_direction(degenerate_soup(Shape::kLine, Shape::kLine), 1, Direction::kLimit, limit_before);
}

TEST(VanishingNormal, keeps_its_direction_through_a_double_zero) {
  expect_direction(fixtures::point_reflected_soup(200), 0.5, Direction::kLimit, limit_after);
}

TEST(VanishingNormal, has_the_direction_from_before_where_the_two_sides_are_antipodal) {
  expect_direction(fixtures::inside_out_soup(200), 0.5, Direction::kDiscontinuous, limit_after);
}

// Evaluates all elements in both layouts: (x, y, z) per element, and separate planes of x, y and z.
TEST(NormalCurvesAccuracy, give_the_same_direction_in_any_layout) {
  const Motion motion = mixed_degrees();
  const auto normals = control_normals(motion.segment(0));
  const NormalCurves curves(normals);
  const std::size_t n = normals.size();
  std::vector<float> packed(3 * n), planes(3 * n);
  for (const double t : {0.0, 0.125, 0.7, 1.0}) {
    ASSERT_EQ(curves.unit_normals(t, VectorView<float>::packed(packed.data(), n)), 0U);
    const auto view = VectorView<float>::planes(planes.data(), planes.data() + n, planes.data() + 2 * n, n);
    ASSERT_EQ(curves.unit_normals(t, view), 0U);
    for (std::size_t i = 0; i < n; ++i) {
      EXPECT_EQ((VectorView<float>::packed(packed.data(), n)[i]), view[i]) << "element " << i;
    }
  }
}

}  // namespace
}  // namespace chronormal::accuracy_test
