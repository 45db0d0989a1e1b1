// Tests sequential access (playback step by step) for every scheme that has it.

#include "chronormal/normals/normal_curves.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <span>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/schemes/scheme.h"
#include "schemes/curve_scheme.h"
#include "schemes/kernels/curve_kernels.h"
#include "tests/support/fixtures.h"

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

// Returns the largest angle, in radians, between normals from sequential access and from random access, over all steps.
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

TEST(Playback, anchored_polynomials_stay_within_the_stated_drift) {
  for (const char* morph : {"cloth", "bend", "twist", "eversion", "soup"})
    EXPECT_LT(drift_of_scheme("polynomial", Prepared(morph), 2000, kDefaultAnchorInterval), 5e-6) << morph;
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
  EXPECT_GT(drift_of_scheme("polynomial", twist, 5000, 0), 4 * drift_of_scheme("polynomial", twist, 5000, 32));
  EXPECT_GT(drift_of_scheme("circle", twist, 5000, 0), 2 * drift_of_scheme("circle", twist, 5000, 32));
}

// Makes a scheme of the exact polynomials of the given control normals. The scheme never reads the segment.
std::unique_ptr<Scheme> polynomial_of(const std::vector<ControlNormals>& normals, const Segment& segment) {
  auto scheme = make_scheme("polynomial").value();
  scheme->prepare({&segment, {0, normals.size()}, normals});
  return scheme;
}

TEST(Playback, a_face_that_shrinks_keeps_its_direction) {
  // The rounding error of sequential access does not shrink together with the normal of an element, so elements whose
  // normals shrink must use random access.
  const Segment segment;
  for (const double shrink : {0.1, 1e-2, 1e-4, 1e-8}) {
    for (const double tilt : {0.0, 0.2}) {
      const Vec3d end = (shrink * shrink) * Vec3d{std::sin(tilt), 0, std::cos(tilt)};
      const ControlNormals c{{0, 0, 1}, shrink * Vec3d{std::sin(tilt / 2), 0, std::cos(tilt / 2)}, end};
      const std::vector<ControlNormals> normals(20, c);
      const auto scheme = polynomial_of(normals, segment);
      const auto playback = scheme->play(0, 1.0 / 63, kDefaultAnchorInterval);
      std::vector<float> played(60);
      for (int k = 0; k <= 63; ++k) {
        EXPECT_EQ(playback->next(VectorView<float>::packed(played.data(), 20)), 0u);
        for (std::size_t i = 0; i < 60; i += 3)
          EXPECT_LT(angle_between({played[i], played[i + 1], played[i + 2]}, unit_normal_at(c, k / 63.0).vector), 1e-6)
              << shrink << " " << tilt << " step " << k;
      }
    }
  }
}

TEST(Playback, one_anchor_per_step_is_random_access) {
  const Prepared twist("twist");
  for (const char* name : kPlayed) EXPECT_LT(drift_of_scheme(name, twist, 50, 1), 6e-7) << name;
}

TEST(Playback, is_anchored_at_every_nth_step_and_at_no_other) {
  // An anchor is a step that computes the state of the playback anew from t. Between two anchors, the bits must equal
  // those of a playback without anchors that begins at the first of these anchors.
  constexpr std::size_t kInterval = 8;
  constexpr double kStep = 0x1p-6;  // a power of two, so all times are exact
  const Prepared twist("twist");
  for (const char* name : {"circle", "polynomial"}) {
    const auto scheme = make_scheme(name).value();
    scheme->prepare({&twist.segment, twist.faces, twist.normals});
    std::vector<float> found(3 * twist.normals.size()), expected(found.size()), random(found.size());
    const auto playback = scheme->play(0, kStep, kInterval);
    auto since_anchor = scheme->play(0, kStep, 0);
    std::size_t drifted = 0;
    for (std::size_t k = 0; k <= 5 * kInterval; ++k) {
      const double t = static_cast<double>(k) * kStep;
      if (k % kInterval == 0) since_anchor = scheme->play(t, kStep, 0);
      playback->next(VectorView<float>::packed(found));
      since_anchor->next(VectorView<float>::packed(expected));
      ASSERT_EQ(found, expected) << name << ", step " << k;
      scheme->evaluate(t, VectorView<float>::packed(random));
      if (k % kInterval == kInterval - 1 && found != random) ++drifted;
    }
    EXPECT_EQ(drifted, 5u) << name << ": an anchor that comes early would not be seen";
  }
}

TEST(Playback, a_part_of_the_segment_can_be_played_backwards) {
  const Prepared twist("twist");
  const auto scheme = polynomial_of(twist.normals, twist.segment);
  const auto playback = scheme->play(0.75, -0.01, 16);
  std::vector<float> played(3 * twist.normals.size()), exact(played.size());
  const auto a = VectorView<float>::packed(played), b = VectorView<float>::packed(exact);
  for (int k = 0; k <= 50; ++k) {
    playback->next(a);
    scheme->evaluate(0.75 - 0.01 * k, b);
    for (std::size_t i = 0; i < a.count; ++i) ASSERT_LT(angle_between(to_double(a[i]), to_double(b[i])), 3e-6);
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
  add({}, 2);                                      // zero
  add({{0, 0, 1}, {0, 0, 0}, {0, 0, -1}}, 1);      // zero at t = 1/2
  add({{0, 0, 1e300}, {0, 1e299, 1e300}, {0, 1e300, 1e300}}, 1);
  const Segment segment;
  const auto scheme = polynomial_of(normals, segment);
  const auto playback = scheme->play(0, 0.1, kDefaultAnchorInterval);
  std::vector<float> played(3 * normals.size());
  const auto result = VectorView<float>::packed(played);
  for (int k = 0; k <= 10; ++k) {
    EXPECT_EQ(playback->next(result), 2u);
    for (std::size_t i = 0; i < normals.size(); ++i)
      EXPECT_LT(angle_between(to_double(result[i]), unit_normal_at(normals[i], 0.1 * k).vector), 2e-6) << i << " " << k;
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
  // The five counts are additions, products, quotients, roots and trigonometric functions. Normalising takes 2 of the
  // additions, 6 products, a quotient and a root.
  EXPECT_EQ(*make_scheme("polynomial").value()->sequential_operations(), (OperationCounts{6 + 2, 6, 1, 1, 0}));
  EXPECT_EQ(*make_scheme("quadratic").value()->sequential_operations(), (OperationCounts{6 + 2, 6, 1, 1, 0}));
  EXPECT_EQ(*make_scheme("cubic").value()->sequential_operations(), (OperationCounts{9 + 2, 6, 1, 1, 0}));
  EXPECT_EQ(make_scheme("slerp").value()->sequential_operations()->trigonometric, 0);
}

// The code that computes a formula also counts its operations. One more vector in a sum must therefore add three
// products and three sums to the count.
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
