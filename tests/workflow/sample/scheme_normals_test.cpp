// Tests the normals that `sample --scheme` writes. Compares every scheme with the oracle of tests/support/reference.h,
// on faces and on vertices. Also checks the drift of schemes that are played step by step.
#include "workflow/sample/scheme_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/workflow/sample.h"
#include "tests/support/elements.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference_elements.h"
#include "tests/support/scheme_names.h"

namespace chronormal::scheme_normals_test {
namespace {

using reference::Real;
using reference::Vector;

constexpr std::uint64_t kSeed = 20261127;

SampleOptions by_scheme(const std::string& scheme, ElementKind kind, std::optional<Stepping> stepping = {}) {
  SampleOptions options;
  options.elements.kind = kind;
  options.scheme = scheme;
  options.stepping = stepping;
  return options;
}

std::vector<float> normals_at(NormalSampler& sampler, double time) {
  const Result<Pose> pose = sampler.at_time(time);
  if (!pose) {
    ADD_FAILURE() << pose.error().text();
    return {};
  }
  return sampler.normals_of_outputs(pose.value());
}

Vector vector_of(const std::vector<float>& values, std::size_t i) {
  return {values.at(3 * i), values.at(3 * i + 1), values.at(3 * i + 2)};
}

reference::Triangle triangle_of(const reference::Mesh& mesh, std::size_t f) {
  reference::Triangle triangle{};
  for (std::size_t c = 0; c < 3; ++c) {
    triangle.from[c] = mesh.from[mesh.faces[f][c]];
    triangle.to[c] = mesh.to[mesh.faces[f][c]];
  }
  return triangle;
}

// The errors of all outputs at one time, in radians.
struct Errors {
  double sum = 0, largest = 0;
  std::size_t judged = 0, all = 0;

  void add(const std::optional<Vector>& expected, const Vector& found) {
    ++all;
    if (!expected) return;
    const auto error = static_cast<double>(reference::angle(*expected, found));
    sum += error;
    largest = std::max(largest, error);
    ++judged;
  }
};

std::vector<Motion> mild_motions() {
  fixtures::Random random(kSeed);
  return {fixtures::smooth_morph(4),
          fixtures::shaken(fixtures::icosphere(1), random.uniform(0.05, 0.2), random.below(1000))};
}

class EveryScheme : public testing::TestWithParam<std::string> {};

TEST_P(EveryScheme, gives_the_normals_of_its_definition_for_faces_and_vertices) {
  const std::string& name = GetParam();
  for (const Motion& motion : mild_motions()) {
    const reference::Mesh mesh = test::reference_mesh(motion.segment(0));
    const auto corners = test::reference_corners(
        mesh, NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count())));
    for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
      const bool are_faces = kind == ElementKind::kFaces;
      Result<NormalSampler> sampler = NormalSampler::make(motion, by_scheme(name, kind));
      if (!sampler) {
        EXPECT_TRUE(!are_faces && make_scheme(name).value()->needs_faces()) << sampler.error().text();
        continue;
      }
      const std::vector<float> middle = normals_at(sampler.value(), 0.5);
      Errors errors;
      for (const double t : {0.0, 0.125, 0.3, 0.5, 0.71, 0.9375, 1.0}) {
        const std::vector<float> found = normals_at(sampler.value(), t);
        ASSERT_EQ(found.size(), 3 * (are_faces ? mesh.faces.size() : corners.size()));
        for (std::size_t i = 0; i < found.size() / 3; ++i) {
          const Vector at_middle = vector_of(middle, i);
          errors.add(are_faces
                         ? reference::unit_normal(name, triangle_of(mesh, i), static_cast<Real>(t), {i, 0}, at_middle)
                         : reference::unit_normal(name, reference::MovingElement{mesh, corners[i]},
                                                  static_cast<Real>(t), {i, 0}, at_middle),
                     vector_of(found, i));
        }
      }
      std::cout << "  " << name << ", " << element_kind_name(kind) << ": mean "
                << errors.sum / static_cast<double>(errors.judged) << ", largest " << errors.largest << " rad of "
                << errors.judged << "\n";
      EXPECT_GE(static_cast<double>(errors.judged), 0.95 * static_cast<double>(errors.all));
      EXPECT_LT(errors.largest, 1e-6);
    }
  }
}

std::string test_name(const testing::TestParamInfo<std::string>& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), ':', '_');
  return name;
}

INSTANTIATE_TEST_SUITE_P(Schemes, EveryScheme, testing::ValuesIn(test::scheme_names()), test_name);

TEST(SchemeNormals, targets_are_gone_to_one_at_a_time) {
  Motion star = fixtures::smooth_morph(4);
  star.keyframes.push_back(star.keyframes[0]);
  fixtures::Random random(kSeed);
  for (float& p : star.keyframes[2].positions) p += static_cast<float>(random.uniform(-0.1, 0.1));
  star.connect_as_targets();
  Motion second = star;
  second.keyframes.erase(second.keyframes.begin() + 1);
  second.keyframes[0].time = 0;
  second.keyframes[1].time = 1;
  second.connect_as_sequence();
  NormalSampler of_star = NormalSampler::make(star, by_scheme("slerp", ElementKind::kFaces)).value();
  NormalSampler of_second = NormalSampler::make(second, by_scheme("slerp", ElementKind::kFaces)).value();
  EXPECT_EQ(of_star.at_weights(std::vector<double>{0, 0.375}).value().normals,
            of_second.at_time(0.375).value().normals);
  for (const std::vector<double>& wrong : std::vector<std::vector<double>>{{0.5, 0.5}, {0, 1.5}, {-0.25, 0}})
    EXPECT_EQ(of_star.at_weights(wrong).error().code, ErrorCode::kUsage);

  const Moments steps = step_moments(star, 4).value();
  ASSERT_EQ(steps.weights.size(), 10U);
  EXPECT_EQ(steps.weights[1], (std::vector<double>{0.25, 0}));
  EXPECT_EQ(steps.weights[9], (std::vector<double>{0, 1}));
}

TEST(SchemeNormals, steps_lead_through_all_segments_and_drift_as_far_as_is_said) {
  Motion motion = fixtures::shaken(fixtures::icosphere(1), 0.3, kSeed % 1000);
  motion.keyframes.push_back(motion.keyframes[0]);
  motion.keyframes[1].time = 0.3;
  motion.keyframes[2].time = 1.7;
  motion.connect_as_sequence();
  constexpr std::size_t kSteps = 300;
  const Moments moments = step_moments(motion, kSteps).value();
  ASSERT_EQ(moments.times.size(), 2 * kSteps + 1);
  EXPECT_EQ(moments.times[kSteps], 0.3);
  EXPECT_EQ(moments.times.back(), 1.7);
  std::size_t played = 0;
  for (const std::string& name : test::scheme_names()) {
    for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
      std::array<double, 2> drifts{};
      for (const std::size_t anchor_interval : {std::size_t{0}, kDefaultAnchorInterval}) {
        const Stepping stepping{kSteps, anchor_interval};
        Result<NormalSampler> made = NormalSampler::make(motion, by_scheme(name, kind, stepping));
        if (!make_scheme(name).value()->sequential_operations() ||
            (make_scheme(name).value()->needs_faces() && kind != ElementKind::kFaces)) {
          EXPECT_FALSE(made.ok()) << name;
          continue;
        }
        NormalSampler stepped = std::move(made).value(),
                      at_random = NormalSampler::make(motion, by_scheme(name, kind)).value();
        double largest = 0;
        for (std::size_t i = 0; i < moments.times.size(); ++i) {
          const std::vector<float> found = normals_at(stepped, moments.times[i]);
          const std::vector<float> expected = normals_at(at_random, moments.times[i]);
          for (std::size_t e = 0; e < found.size() / 3; ++e)
            largest =
                std::max(largest, static_cast<double>(reference::angle(vector_of(expected, e), vector_of(found, e))));
        }
        // The program measures the drift at exact multiples of the step, while the times of this test are rounded.
        EXPECT_NEAR(stepped.drift().largest, largest, 3e-7) << name;
        EXPECT_GT(stepped.drift().largest, 0) << name;
        drifts[anchor_interval == 0 ? 0 : 1] = stepped.drift().largest;
        // A playback that begins in the middle must give the same bits at each time.
        NormalSampler later = NormalSampler::make(motion, by_scheme(name, kind, stepping)).value();
        for (const std::size_t i : {std::size_t{500}, std::size_t{17}, std::size_t{130}})
          EXPECT_EQ(normals_at(later, moments.times[i]), normals_at(stepped, moments.times[i])) << name << " " << i;
        ++played;
      }
      EXPECT_GE(drifts[0], drifts[1]) << name << ": what is made anew drifts less";
    }
  }
  EXPECT_GT(played, 20U);
  NormalSampler stepped = NormalSampler::make(motion, by_scheme("linear", ElementKind::kFaces, Stepping{4})).value();
  EXPECT_EQ(stepped.at_time(0.05).error().code, ErrorCode::kUsage) << "no step leads there";
}

TEST(SchemeNormals, what_has_no_meaning_is_refused) {
  Motion motion = fixtures::smooth_morph(3);
  const auto message = [&](const SampleOptions& options) {
    const auto made = NormalSampler::make(motion, options);
    return made ? std::string("it is taken") : made.error().text();
  };
  EXPECT_NE(message(by_scheme("bicubic", ElementKind::kFaces)).find("there is no scheme 'bicubic'"), std::string::npos);
  const std::string mistyped = message(by_scheme("slrp", ElementKind::kFaces));
  EXPECT_NE(mistyped.find("'slrp'; did you mean slerp? Choose one of recompute, "), std::string::npos) << mistyped;
  EXPECT_NE(message(by_scheme("quaternion:polar", ElementKind::kVertices)).find("edges of faces"), std::string::npos);
  EXPECT_NE(message(by_scheme("rational", ElementKind::kFaces, Stepping{8})).find("cannot go step by step"),
            std::string::npos);
  EXPECT_NE(message(by_scheme("", ElementKind::kFaces, Stepping{8})).find("name a scheme"), std::string::npos);
  EXPECT_NE(message(by_scheme("linear", ElementKind::kFaces, Stepping{0})).find("at least 1"), std::string::npos);
  SampleOptions weighted = by_scheme("linear", ElementKind::kVertices);
  weighted.weighting = Weighting::kAngle;
  EXPECT_NE(message(weighted).find("the weighting area and the length unit"), std::string::npos);
  SampleOptions of_areas = by_scheme("linear", ElementKind::kFaces);
  of_areas.length = NormalLength::kArea;
  EXPECT_NE(message(of_areas).find("the weighting area and the length unit"), std::string::npos);
  motion.segments.clear();
  motion.keyframes.resize(1);
  EXPECT_NE(message(by_scheme("linear", ElementKind::kFaces)).find("does not move"), std::string::npos);
  EXPECT_FALSE(step_moments(motion, 4).ok());
}

}  // namespace
}  // namespace chronormal::scheme_normals_test
