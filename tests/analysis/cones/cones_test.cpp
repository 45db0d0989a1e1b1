// Compares normal cones with normals that are computed in integers of any size: no exact normal of the interval may lie
// outside the cone of its element. Each element is tested at 64 instants. The test has 2,000 elements, or 200,000 under
// ./test --full exact.

#include "chronormal/analysis/cones.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <limits>
#include <string>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/normals/normal_groups.h"
#include "simd/targets.h"
#include "tests/support/cone_oracle.h"
#include "tests/support/exact_cases.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"

namespace chronormal::cones_test {
namespace {

using test::contains;
using test::IntegerNormals;
using test::IntegerTime;
using test::IntegerVector;

constexpr std::uint64_t kSeed = 31230;

struct Interval {
  double t0 = 0, t1 = 1;
};

Interval some_interval(fixtures::Random& random) {
  switch (random.below(6)) {
    case 0:
    case 1:
      return {};
    case 2: {
      const double t = static_cast<double>(random.below(9)) / 8;
      return {t, t};
    }
    case 3: {
      const std::size_t i = random.below(8);
      return {static_cast<double>(i) / 8, static_cast<double>(i + 1 + random.below(8 - i)) / 8};
    }
    default: {
      const double a = random.uniform(0, 1), b = random.uniform(0, 1);
      return {std::min(a, b), std::max(a, b)};
    }
  }
}

std::vector<NormalCone> cones_of_faces(const Segment& segment, const Interval& part) {
  std::vector<NormalCone> cones(segment.topology->face_count());
  face_normal_cones(segment, {0, cones.size()}, part.t0, part.t1, cones);
  return cones;
}

// Returns cones around the normals at both ends of the interval, without the normals between. Such cones are right only
// if n(t) follows a straight line between the ends.
std::vector<NormalCone> cones_of_ends(const Segment& segment, const Interval& part) {
  std::vector<ControlNormals> ends = all_face_control_normals(segment);
  for (ControlNormals& c : ends) {
    const Vec3d from = normal_at(c, part.t0), to = normal_at(c, part.t1);
    c = {from, 0.5 * (from + to), to};
  }
  std::vector<NormalCone> cones(ends.size());
  normal_cones(ends, 0, 1, cones);
  return cones;
}

struct Tally {
  std::size_t elements = 0, cases = 0, outside = 0, whole = 0, empty = 0;
};

template <class ConesOf>
void judge(const Segment& segment, const Interval& part, fixtures::Random& random, Tally& tally,
           const ConesOf& cones_of) {
  const std::vector<NormalCone> cones = cones_of(segment, part);
  const IntegerNormals oracle(segment);
  tally.elements += cones.size();
  for (const NormalCone& cone : cones) {
    tally.whole += cone.is_whole_sphere() ? 1U : 0U;
    tally.empty += cone.is_empty() ? 1U : 0U;
  }
  for (const double t : test::some_times_in(part.t0, part.t1, random)) {
    const std::vector<IntegerVector> normals = oracle.at(IntegerTime::of(t));
    for (std::size_t f = 0; f < cones.size(); ++f) {
      ++tally.cases;
      if (!contains(cones[f], normals[f])) ++tally.outside;
    }
  }
}

struct Family {
  std::string name;
  Motion (*make)(fixtures::Random&);
};

std::vector<Family> families() {
  std::vector<Family> all;
  for (const test::HardMotions& hard : test::hard_motions()) all.push_back({hard.name, hard.make});
  using fixtures::Random;
  all.push_back({"independent triangles",
                 [](Random& r) { return fixtures::soup({.face_count = 20, .seed = r.below(1000000)}); }});
  all.push_back({"moving a little", [](Random& r) {
                   return fixtures::soup({.face_count = 20, .seed = r.below(1000000), .motion = 0.05});
                 }});
  all.push_back({"needles far from the origin", [](Random& r) {
                   return fixtures::soup(
                       {.face_count = 20, .seed = r.below(1000000), .motion = 1e-4, .offset = 10, .needle = 1e-5});
                 }});
  all.push_back({"moved as a whole", [](Random& r) {
                   Motion motion = fixtures::soup({.face_count = 20, .seed = r.below(1000000), .motion = 0});
                   for (float& x : motion.keyframes[1].positions) x += 2;
                   return motion;
                 }});
  return all;
}

template <class ConesOf>
std::size_t outside_of(const ConesOf& cones_of, bool is_printed) {
  const std::size_t wanted = test::wanted_cases() / 50;
  const std::vector<Family> all = families();
  std::size_t outside = 0, elements = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    fixtures::Random random(kSeed + k);
    Tally tally;
    while (tally.elements < wanted / all.size() + 1) {
      const Motion motion = all[k].make(random);
      judge(motion.segment(0), some_interval(random), random, tally, cones_of);
    }
    if (is_printed)
      std::cout << "  " << all[k].name << ": " << tally.elements << " faces from seed " << kSeed + k << ", "
                << tally.cases << " normals, " << tally.outside << " outside; " << tally.whole << " whole spheres, "
                << tally.empty << " empty\n";
    outside += tally.outside;
    elements += tally.elements;
  }
  EXPECT_GE(elements, wanted);
  return outside;
}

TEST(ExactCones, of_faces_contain_every_exact_normal_of_the_interval) {
  EXPECT_EQ(outside_of(cones_of_faces, true), 0u);
}

TEST(ExactCones, of_control_normals_contain_every_exact_normal_of_the_interval) {
  const auto cones_of = [](const Segment& segment, const Interval& part) {
    const std::vector<ControlNormals> normals = all_face_control_normals(segment);
    std::vector<NormalCone> cones(normals.size());
    normal_cones(normals, part.t0, part.t1, cones);
    return cones;
  };
  EXPECT_EQ(outside_of(cones_of, false), 0u);
}

// Cones around the normals of both ends alone are a tempting but wrong method. The test must detect its errors.
TEST(ExactCones, of_the_two_ends_alone_do_not) { EXPECT_GT(outside_of(cones_of_ends, false), 1000u); }

TEST(Cones, have_the_same_bits_on_every_instruction_set_and_in_any_number) {
  const Motion motion = fixtures::large_soup(70);
  const std::vector<ControlNormals> normals = all_face_control_normals(motion.segment(0));
  for (const auto& [t0, t1] : {std::pair{0.0, 1.0}, std::pair{0.25, 0.7}, std::pair{0.3, 0.3}}) {
    std::vector<NormalCone> expected(normals.size());
    normal_cones(normals, t0, t1, expected);
    for (const std::int64_t target : supported_targets()) {
      const ScopedTarget scoped(target);
      for (const std::size_t count : {1U, 7U, 8U, 9U, 64U, 70U}) {
        std::vector<NormalCone> cones(count + 1, NormalCone{{7, 7, 7}, 7});
        normal_cones(std::span(normals).first(count), t0, t1, std::span(cones).first(count));
        for (std::size_t i = 0; i < count; ++i) EXPECT_EQ(cones[i], expected[i]) << target_name(target) << ", " << i;
        EXPECT_EQ(cones[count].sine, 7);
      }
    }
  }
}

TEST(Cones, leave_out_control_normals_that_are_zero) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0}, zero{};
  const std::vector<ControlNormals> normals{
      {zero, zero, zero}, {zero, zero, x}, {zero, x, zero}, {x, zero, y}, {x, y, zero}};
  std::vector<NormalCone> cones(normals.size());
  normal_cones(normals, 0, 1, cones);
  EXPECT_TRUE(cones[0].is_empty());
  EXPECT_EQ(half_angle(cones[0]), 0);
  for (const std::size_t i : {1U, 2U}) {
    EXPECT_EQ(cones[i].axis, (Vec3f{1, 0, 0}));
    EXPECT_LT(half_angle(cones[i]), 4e-7);
  }
  for (const std::size_t i : {3U, 4U}) {
    EXPECT_NEAR(half_angle(cones[i]) * kDegreesPerRadian, 45, 3e-4);
    EXPECT_GE(half_angle(cones[i]) * kDegreesPerRadian, 45);
  }
  // On the first half of the interval, the control normals of element 1 are {zero, zero, x / 4}. On the second half,
  // none of its control normals is zero.
  normal_cones(normals, 0, 0.5, cones);
  EXPECT_EQ(cones[1].axis, (Vec3f{1, 0, 0}));
  normal_cones(normals, 0.5, 1, cones);
  EXPECT_EQ(cones[1].axis, (Vec3f{1, 0, 0}));
  EXPECT_TRUE(cones[0].is_empty());
}

TEST(Cones, are_the_whole_sphere_where_a_normal_turns_over) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0};
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<ControlNormals> normals{
      {x, x, -x}, {x, y, -x}, {x, -x, x}, {x, {infinity, 0, 0}, x}, {x, {0, std::nan(""), 0}, x}};
  std::vector<NormalCone> cones(normals.size());
  for (const auto& [t0, t1] : {std::pair{0.0, 1.0}, std::pair{0.0625, 0.9375}}) {
    normal_cones(normals, t0, t1, cones);
    for (std::size_t i = 0; i < cones.size(); ++i) {
      if (i == 1 && t0 > 0) continue;
      EXPECT_TRUE(cones[i].is_whole_sphere()) << i << " from " << t0;
      EXPECT_NEAR(half_angle(cones[i]) * kDegreesPerRadian, 180, 1e-12);
    }
  }
}

// At t = 1/2, the weighted control normals of this test nearly cancel. Errors of 2^-26 in the control normals therefore
// change the direction of n(t) by much more than 2^-26 radians.
TEST(Cones, of_parts_cover_what_control_normals_may_be_off_by) {
  for (const double left : {0x1p-4, 0x1p-8, 0x1p-13, 0x1p-20}) {
    const ControlNormals given{{1, 0, left}, {-1, 0, left}, {1, 0, left}};
    ControlNormals exact = given;
    exact.m.y = 0x1p-26;
    NormalCone cone;
    normal_cones({&given, 1}, 0.5, 0.5, {&cone, 1});
    if (left >= 0x1p-14) {
      EXPECT_LE(angle_between(normal_at(exact, 0.5), to_double(cone.axis)), half_angle(cone)) << left;
      EXPECT_LT(half_angle(cone), 0x1p-24 / left + 1e-6) << left;
    } else {
      EXPECT_TRUE(cone.is_whole_sphere());
    }
  }
}

// The three directions are x, y and z, or x, x + y and y. The smallest cones around them are known.
TEST(Cones, are_the_smallest_around_three_directions) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const std::vector<ControlNormals> normals{{x, 3 * y, z}, {x, x + y, y}, {1e-140 * x, 1e140 * y, z}};
  std::vector<NormalCone> cones(normals.size());
  normal_cones(normals, 0, 1, cones);
  const std::vector<double> degrees{std::atan(std::sqrt(2.0)) * kDegreesPerRadian, 45,
                                    std::atan(std::sqrt(2.0)) * kDegreesPerRadian};
  for (std::size_t i = 0; i < cones.size(); ++i) {
    EXPECT_NEAR(half_angle(cones[i]) * kDegreesPerRadian, degrees[i], 3e-4);
    EXPECT_GE(half_angle(cones[i]) * kDegreesPerRadian, degrees[i]);
  }
}

// A face collapses to a line at exactly t = 1/2 and turns over there, so the normal has one direction in each half.
TEST(Cones, of_faces_are_sharp_up_to_the_very_instant_of_a_collapse) {
  const fixtures::Point o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, minus_y{0, -1, 0};
  const Motion motion = test::soup_of({{{o, x, minus_y}, {o, x, y}}});
  const Segment segment = motion.segment(0);
  EXPECT_TRUE(cones_of_faces(segment, {0, 1})[0].is_whole_sphere());
  EXPECT_EQ(cones_of_faces(segment, {0, 0.5})[0].axis, (Vec3f{0, 0, -1}));
  EXPECT_EQ(cones_of_faces(segment, {0.5, 1})[0].axis, (Vec3f{0, 0, 1}));
  EXPECT_TRUE(cones_of_faces(segment, {0.5, 0.5})[0].is_empty());
  EXPECT_TRUE(cones_of_faces(segment, {0.5 - 0x1p-53, 0.5 + 0x1p-52})[0].is_whole_sphere());
  EXPECT_EQ(cones_of_faces(segment, {0.5 + 0x1p-52, 1})[0].axis, (Vec3f{0, 0, 1}));
}

// The half-angle of a cone is at least half of the largest angle between two of its normals. Compares the half-angle of
// each cone with this lower bound, which is computed from 21 normals of the element.
TEST(Cones, are_tight) {
  for (const BuiltinMorph& morph : builtin_morphs()) {
    const Motion motion = make_builtin_morph(morph.name).value();
    double smallest = 0, ours = 0, of_parts = 0;
    for (std::size_t s = 0; s < motion.segments.size(); ++s) {
      const std::vector<NormalCone> cones = cones_of_faces(motion.segment(s), {});
      const std::vector<ControlNormals> normals = all_face_control_normals(motion.segment(s));
      std::vector<std::vector<NormalCone>> parts;
      for (int i = 0; i < 4; ++i) parts.push_back(cones_of_faces(motion.segment(s), {0.25 * i, 0.25 * (i + 1)}));
      for (std::size_t f = 0; f < cones.size(); f += 37) {
        if (cones[f].is_whole_sphere()) continue;
        const std::vector<NormalCone> quarters{parts[0][f], parts[1][f], parts[2][f], parts[3][f]};
        of_parts += half_angle(enclosing_cone(quarters));
        std::vector<Vec3d> samples;
        for (int i = 0; i <= 20; ++i) samples.push_back(unit(normal_at(normals[f], i / 20.0)));
        double largest = 0;
        for (const Vec3d& a : samples) {
          for (const Vec3d& b : samples) largest = std::max(largest, length(a - b));
        }
        EXPECT_GE(double{cones[f].sine}, largest / 2);
        smallest += std::asin(largest / 2);
        ours += half_angle(cones[f]);
      }
    }
    std::cout << "  " << morph.name << ": " << 100 * (ours / smallest - 1) << " % wider than any cone must be; around "
              << "those of four parts, " << 100 * (of_parts / smallest - 1) << " %\n";
    EXPECT_LT(ours, (morph.name == "eversion" ? 2.5 : 1.2) * smallest) << morph.name;
    EXPECT_LT(of_parts, (morph.name == "eversion" ? 1.8 : 1.3) * smallest) << morph.name;
  }
}

std::vector<IntegerVector> all_normals(const Segment& segment, double t) {
  return IntegerNormals(segment).at(IntegerTime::of(t));
}

TEST(EnclosingCone, of_a_hierarchy_contains_the_normals_of_all_faces_below) {
  fixtures::Random random(kSeed);
  for (const double motion_size : {0.02, 0.2}) {
    const Motion motion = fixtures::soup({.face_count = 256, .seed = 5, .motion = motion_size});
    Segment segment = motion.segment(0);
    std::vector<NormalCone> level = cones_of_faces(segment, {0.1, 0.8});
    // Sorts faces by their axes, so that each cluster has similar axes and its cone is narrow.
    std::vector<std::size_t> order(level.size());
    for (std::size_t i = 0; i < order.size(); ++i) order[i] = i;
    std::sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) {
      const auto key = [&](std::size_t i) {
        const Vec3f v = level[i].axis;
        return std::pair{(v.x > 0 ? 4 : 0) + (v.y > 0 ? 2 : 0) + (v.z > 0 ? 1 : 0), v.x};
      };
      return key(a) < key(b);
    });
    std::vector<std::vector<NormalCone>> levels{{}};
    for (const std::size_t i : order) levels[0].push_back(level[i]);
    while (levels.back().size() > 1) {
      std::vector<NormalCone> next;
      for (std::size_t i = 0; i < levels.back().size(); i += 4)
        next.push_back(enclosing_cone(std::span(levels.back()).subspan(i, 4)));
      levels.push_back(next);
    }
    std::size_t narrow = 0;
    for (const NormalCone& cone : levels[1]) narrow += cone.is_whole_sphere() ? 0U : 1U;
    EXPECT_GT(narrow, levels[1].size() / 2);
    for (int k = 0; k < 20; ++k) {
      const std::vector<IntegerVector> normals = all_normals(segment, random.uniform(0.1, 0.8));
      for (std::size_t i = 0; i < order.size(); ++i) {
        std::size_t node = i;
        for (const std::vector<NormalCone>& cones : levels) {
          EXPECT_TRUE(contains(cones[node], normals[order[i]]));
          node /= 4;
        }
      }
    }
  }
}

TEST(EnclosingCone, of_few_is_the_smallest_and_special_cones_keep_their_meaning) {
  const auto degrees = [](const NormalCone& cone) { return half_angle(cone) * kDegreesPerRadian; };
  const NormalCone x{{1, 0, 0}, 0}, y{{0, 1, 0}, 0}, z{{0, 0, 1}, 0}, minus_x{{-1, 0, 0}, 0}, wide{{1, 0, 0}, 0.5F};
  const auto enclosing = [](const std::vector<NormalCone>& cones) { return enclosing_cone(cones); };
  EXPECT_TRUE(enclosing({}).is_empty());
  EXPECT_TRUE(enclosing({NormalCone::empty(), NormalCone::empty()}).is_empty());
  EXPECT_EQ(enclosing({NormalCone::empty(), wide}), wide);
  EXPECT_TRUE(enclosing({x, NormalCone::whole_sphere()}).is_whole_sphere());
  EXPECT_TRUE(enclosing({x, minus_x}).is_whole_sphere());
  EXPECT_TRUE(enclosing({x, y, minus_x}).is_whole_sphere());
  EXPECT_NEAR(degrees(enclosing({x, y})), 45, 3e-4);
  EXPECT_NEAR(degrees(enclosing({x, y, z})), std::atan(std::sqrt(2.0)) * kDegreesPerRadian, 1);
  EXPECT_NEAR(degrees(enclosing({x, wide})), 30, 1);
  EXPECT_NEAR(degrees(enclosing({y, wide})), 60, 1.5);
}

}  // namespace
}  // namespace chronormal::cones_test
