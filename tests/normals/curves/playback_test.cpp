// Sequential access: playback of curves and of every scheme that can be played.

#include "chronormal/normals/playback.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "chronormal/io/builtin_morphs.h"
#include "chronormal/schemes/scheme.h"
#include "schemes/curve_scheme.h"
#include "schemes/kernels/curve_kernels.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_normals.h"

namespace chronormal::playback_test {
namespace {

struct Prepared {
  Motion motion;
  Segment segment;
  IndexRange faces;
  std::vector<ControlNormals> normals;

  explicit Prepared(const char* morph, std::size_t count = 600)
      : motion(make_builtin_morph(morph).value()), segment(motion.segment(0)), faces{1000, count}, normals(count) {
    face_control_normals(segment, faces, normals);
  }
  Prepared(const Prepared&) = delete;
};

// The largest angle between what is played and what random access gives, over all steps.
template <class Next, class At>
double largest_drift(std::size_t count, std::size_t steps, Next next, At at) {
  std::vector<float> played(3 * count), exact(3 * count);
  const auto a = VectorView<float>::packed(played.data(), count), b = VectorView<float>::packed(exact.data(), count);
  double largest = 0;
  for (std::size_t k = 0; k <= steps; ++k) {
    next(a);
    at(static_cast<double>(k) / static_cast<double>(steps), b);
    for (std::size_t i = 0; i < count; ++i)
      largest = std::max(largest, angle_between(to_double(a[i]), to_double(b[i])));
  }
  return largest;
}

double drift_of_curves(const Prepared& prepared, std::size_t steps, std::size_t anchor_interval) {
  const NormalCurves curves(prepared.normals);
  NormalPlayback playback(curves, 0, 1.0 / static_cast<double>(steps), anchor_interval);
  return largest_drift(
      curves.size(), steps, [&](VectorView<float> out) { (void)playback.next(out); },
      [&](double t, VectorView<float> out) { (void)curves.unit_normals(t, out); });
}

double drift_of_scheme(const char* name, const Prepared& prepared, std::size_t steps, std::size_t anchor_interval) {
  const auto scheme = make_scheme(name).value();
  scheme->prepare({&prepared.segment, prepared.faces, prepared.normals});
  const auto playback = scheme->play(0, 1.0 / static_cast<double>(steps), anchor_interval);
  return largest_drift(
      prepared.faces.count, steps, [&](VectorView<float> out) { playback->next(out); },
      [&](double t, VectorView<float> out) { scheme->evaluate(t, out); });
}

constexpr const char* kPlayed[] = {"linear",
                                   "quadratic",
                                   "cubic",
                                   "polynomial",
                                   "slerp",
                                   "quaternion:matrix",
                                   "quaternion:edge",
                                   "quaternion:polar",
                                   "quaternion:random:1",
                                   "quaternion:optimal",
                                   "circle"};

TEST(Playback, anchored_curves_stay_within_the_stated_drift) {
  for (const char* morph : {"cloth", "bend", "twist", "eversion", "soup"})
    EXPECT_LT(drift_of_curves(Prepared(morph), 2000, kDefaultAnchorInterval), 5e-6) << morph;
}

TEST(Playback, anchored_schemes_stay_within_the_stated_drift) {
  for (const char* morph : {"bend", "twist"}) {
    const Prepared prepared(morph);
    for (const char* name : kPlayed)
      EXPECT_LT(drift_of_scheme(name, prepared, 2000, kDefaultAnchorInterval), 5e-6) << name << " on " << morph;
  }
}

TEST(Playback, drift_is_real_and_anchors_remove_it) {
  const Prepared twist("twist");
  const double without = drift_of_curves(twist, 5000, 0), with = drift_of_curves(twist, 5000, 32);
  EXPECT_GT(without, 4 * with);
  EXPECT_GT(drift_of_scheme("circle", twist, 5000, 0), 2 * drift_of_scheme("circle", twist, 5000, 32));
}

TEST(Playback, a_face_that_shrinks_keeps_its_direction) {
  // The error of the state is absolute: what shrinks must not be played.
  for (const double shrink : {0.1, 1e-2, 1e-4, 1e-8}) {
    for (const double tilt : {0.0, 0.2}) {
      const Vec3d end = (shrink * shrink) * Vec3d{std::sin(tilt), 0, std::cos(tilt)};
      const ControlNormals c{{0, 0, 1}, shrink * Vec3d{std::sin(tilt / 2), 0, std::cos(tilt / 2)}, end};
      const std::vector<ControlNormals> normals(20, c);
      const NormalCurves curves(normals);
      NormalPlayback playback(curves, 0, 1.0 / 63);
      EXPECT_EQ(playback.unplayed_count() + curves.flagged_count(), 20u) << shrink;
      std::vector<float> played(60);
      for (int k = 0; k <= 63; ++k) {
        EXPECT_EQ(playback.next(VectorView<float>::packed(played.data(), 20)), 0u);
        for (std::size_t i = 0; i < 60; i += 3)
          EXPECT_LT(angle_between({played[i], played[i + 1], played[i + 2]}, unit_normal_at(c, k / 63.0).vector), 1e-6)
              << shrink << " " << tilt << " step " << k;
      }
    }
  }
}

TEST(Playback, most_faces_of_a_mild_morph_are_played) {
  for (const char* morph : {"cloth", "bend", "twist"}) {
    const Prepared prepared(morph);
    const NormalCurves curves(prepared.normals);
    EXPECT_LT(NormalPlayback(curves, 0, 0.01).unplayed_count(), curves.size() / 20) << morph;
  }
}

TEST(Playback, one_anchor_per_step_is_random_access) {
  const Prepared twist("twist");
  EXPECT_LT(drift_of_curves(twist, 50, 1), 3e-7);
  for (const char* name : kPlayed) EXPECT_LT(drift_of_scheme(name, twist, 50, 1), 6e-7) << name;
}

TEST(Playback, is_anchored_at_every_nth_step_and_at_no_other) {
  // Its bits are those of a playback without anchors that began at the last anchor.
  constexpr std::size_t kInterval = 8;
  constexpr double kStep = 0x1p-6;  // so that all times are exact
  const Prepared twist("twist");
  const NormalCurves curves(twist.normals);
  const auto scheme = make_scheme("circle").value();
  scheme->prepare({&twist.segment, twist.faces, twist.normals});
  std::vector<float> found(3 * curves.size()), expected(found.size()), random(found.size());
  const auto view = [&curves](std::vector<float>& xyz) { return VectorView<float>::packed(xyz.data(), curves.size()); };
  NormalPlayback playback(curves, 0, kStep, kInterval), since_anchor(curves, 0, kStep, 0);
  const auto scheme_playback = scheme->play(0, kStep, kInterval);
  auto scheme_since_anchor = scheme->play(0, kStep, 0);
  std::size_t drifted = 0;
  for (std::size_t k = 0; k <= 5 * kInterval; ++k) {
    const double t = static_cast<double>(k) * kStep;
    if (k % kInterval == 0) {
      since_anchor = NormalPlayback(curves, t, kStep, 0);
      scheme_since_anchor = scheme->play(t, kStep, 0);
    }
    (void)playback.next(view(found));
    (void)since_anchor.next(view(expected));
    ASSERT_EQ(found, expected) << "step " << k;
    (void)curves.unit_normals(t, view(random));
    if (k % kInterval == kInterval - 1 && found != random) ++drifted;
    scheme_playback->next(view(found));
    scheme_since_anchor->next(view(expected));
    ASSERT_EQ(found, expected) << "circle, step " << k;
  }
  EXPECT_EQ(drifted, 5u) << "an anchor that comes early would not be seen";
}

TEST(Playback, a_part_of_the_segment_can_be_played_backwards) {
  const Prepared twist("twist");
  const NormalCurves curves(twist.normals);
  NormalPlayback playback(curves, 0.75, -0.01, 16);
  std::vector<float> played(3 * curves.size()), exact(3 * curves.size());
  const auto a = VectorView<float>::packed(played.data(), curves.size());
  const auto b = VectorView<float>::packed(exact.data(), curves.size());
  for (int k = 0; k <= 50; ++k) {
    (void)playback.next(a);
    (void)curves.unit_normals(0.75 - 0.01 * k, b);
    for (std::size_t i = 0; i < curves.size(); ++i) ASSERT_LT(angle_between(to_double(a[i]), to_double(b[i])), 3e-6);
  }
}

TEST(Playback, mixed_degrees_and_degenerate_elements_are_played_too) {
  std::vector<ControlNormals> normals;
  const auto add = [&normals](const ControlNormals& c, int count) {
    normals.insert(normals.end(), static_cast<std::size_t>(count), c);
  };
  add({{0, 0, 2}, {0, 0, 2}, {0, 0, 2}}, 11);      // constant
  add({{0, 0, 2}, {0, 0.5, 1.5}, {0, 1, 1}}, 13);  // linear
  add({{0, 0, 1}, {0.5, 0, 1}, {1, 0, 0.2}}, 9);   // quadratic
  add({}, 2);                                      // nothing
  add({{0, 0, 1}, {0, 0, 0}, {0, 0, -1}}, 1);      // through zero at 1/2
  const NormalCurves curves(normals);
  NormalPlayback playback(curves, 0, 0.1);
  std::vector<float> played(3 * normals.size());
  const auto result = VectorView<float>::packed(played.data(), normals.size());
  for (int k = 0; k <= 10; ++k) {
    EXPECT_EQ(playback.next(result), 2u);
    for (std::size_t i = 0; i < normals.size(); ++i)
      EXPECT_LT(angle_between(to_double(result[i]), unit_normal_at(normals[i], 0.1 * k).vector), 2e-6) << i << " " << k;
  }
}

// Every remainder of a block, every form, every tolerance: runs that are played, and runs that are not.
TEST(Playback, of_any_size_form_and_tolerance_stays_within_its_bounds) {
  fixtures::Random random(62);
  std::vector<ControlNormals> elements;
  while (elements.size() < 1000) {
    const auto& family = test::hard_families()[random.below(test::hard_families().size())];
    for (std::size_t run = 1 + random.below(120); run > 0; --run) elements.push_back(family.make(random));
  }
  constexpr double kDriftBound = 5e-5;  // radians, playback.h
  constexpr int kSteps = 64;
  for (const double tolerance : {1e-6, 1e-5, 1e-3, 5e-3}) {
    for (std::size_t size = 1; size <= 1000; size += size < 70 ? 1 : 465) {
      const auto some = std::span(elements).last(size);
      const NormalCurves curves(some, {tolerance});
      const double step = 1.0 / kSteps;
      NormalPlayback one(curves, 0, step), two(curves, 0, step), three(curves, 0, step);
      std::vector<float> memory(10 * size + 1);
      float* const p = memory.data() + 1;
      const auto packed = VectorView<float>::packed(p, size);
      const auto planes = VectorView<float>::planes(p + 3 * size, p + 4 * size, p + 5 * size, size);
      const VectorView<float> strided{p + 6 * size + 2, p + 6 * size + 1, p + 6 * size, size, 4};
      for (int k = 0; k <= kSteps; ++k) {
        const std::size_t zeros = one.next(packed);
        ASSERT_EQ(two.next(planes), zeros);
        ASSERT_EQ(three.next(strided), zeros);
        for (std::size_t i = 0; i < size; ++i) {
          ASSERT_EQ(packed[i], planes[i]) << i << " of " << size;
          ASSERT_EQ(packed[i], strided[i]) << i << " of " << size;
          const UnitNormal u = unit_normal_at(some[i], k * step);
          if (u.direction != Direction::kRegular) continue;
          ASSERT_LE(test::angle_to(packed[i], some[i], k * step), tolerance + kDriftBound)
              << i << " of " << size << ", step " << k;
        }
      }
    }
  }
}

TEST(Playback, of_what_is_kept_in_few_bytes_is_random_access) {
  fixtures::Random random(63);
  std::vector<ControlNormals> normals;
  for (int i = 0; i < 500; ++i)
    normals.push_back(test::hard_families()[1].make(random));  // one direction, turned a little
  for (const double tolerance : {1e-3, 5e-3}) {
    const NormalCurves curves(normals, {tolerance});
    NormalPlayback playback(curves, 0.25, 0.05);
    EXPECT_EQ(playback.bytes(), 0u);
    EXPECT_EQ(playback.unplayed_count(), 0u);
    std::vector<float> played(1500), exact(1500);
    for (int k = 0; k < 10; ++k) {
      (void)playback.next(VectorView<float>::packed(played.data(), 500));
      (void)curves.unit_normals(0.25 + k * 0.05, VectorView<float>::packed(exact.data(), 500));
      EXPECT_EQ(played, exact);
    }
  }
  // And units as well, whatever the tolerance.
  const std::vector<ControlNormals> still(35, ControlNormals{{0, 3, 4}, {0, 3, 4}, {0, 3, 4}});
  for (const double tolerance : {1e-6, 1e-3}) {
    const NormalCurves curves(still, {tolerance});
    NormalPlayback playback(curves, 0, 0.5);
    EXPECT_EQ(playback.bytes(), 0u);
    std::vector<float> x(35), y(35), z(35);
    (void)playback.next(VectorView<float>::planes(x.data(), y.data(), z.data(), 35));
    for (std::size_t i = 0; i < 35; ++i) {
      EXPECT_EQ(x[i], 0);
      EXPECT_FLOAT_EQ(y[i], 0.6F);
      EXPECT_FLOAT_EQ(z[i], 0.8F);
    }
  }
}

TEST(Playback, schemes_without_an_incremental_form_say_so) {
  for (const char* name :
       {"recompute", "rational", "decasteljau:4", "circle:timed", "linear:scaled", "lagrange:4", "lagrange:12"}) {
    const auto scheme = make_scheme(name).value();
    EXPECT_EQ(scheme->play(0, 0.1, 0), nullptr) << name;
    EXPECT_FALSE(scheme->sequential_operations().has_value()) << name;
  }
  for (const char* name : kPlayed) EXPECT_TRUE(make_scheme(name).value()->sequential_operations().has_value()) << name;
}

TEST(Playback, a_quadratic_steps_with_two_additions_per_component) {
  // The rest is the normalisation: 2 additions, 6 products, a quotient and a root.
  EXPECT_EQ(*make_scheme("polynomial").value()->sequential_operations(), (OperationCounts{6 + 2, 6, 1, 1, 0}));
  EXPECT_EQ(*make_scheme("quadratic").value()->sequential_operations(), (OperationCounts{6 + 2, 6, 1, 1, 0}));
  EXPECT_EQ(*make_scheme("cubic").value()->sequential_operations(), (OperationCounts{9 + 2, 6, 1, 1, 0}));
  EXPECT_EQ(make_scheme("slerp").value()->sequential_operations()->trigonometric, 0);
}

// Counting sees the code that runs: one vector more in a sum is three products and three sums more.
TEST(Operations, one_vector_more_changes_the_count) {
  const std::vector<float> coefficients(12, 0.5F), state(12, 0.25F);
  SharedValues weights{};
  weights.fill(0.5F);
  OperationCounts expected = count_evaluation(Formula::kSumOf3, std::span(coefficients).first(9), weights);
  expected.add += 3;
  expected.multiply += 3;
  EXPECT_EQ(count_evaluation(Formula::kSumOf4, coefficients, weights), expected);
  expected = count_advance(Formula::kSumOf3, std::span(coefficients).first(9), std::span(state).first(9));
  expected.add += 3;
  EXPECT_EQ(count_advance(Formula::kSumOf4, coefficients, state), expected);
}

}  // namespace
}  // namespace chronormal::playback_test
