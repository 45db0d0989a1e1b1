#include "chronormal/workflow/sample.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iostream>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/elements.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"
#include "tests/support/reference_elements.h"

namespace chronormal::sample_test {
namespace {

using reference::Real;
using reference::Vector;

constexpr double kTolerance = 2e-6;  // in radians: the error of curves, plus rounding to three floats

SampleOptions options_of(ElementKind kind, Weighting weighting = Weighting::kArea, double crease_angle = 180) {
  SampleOptions options;
  options.elements.kind = kind;
  options.elements.crease_angle = crease_angle;
  options.weighting = weighting;
  return options;
}

Pose good(Result<Pose> pose) {
  if (!pose) {
    ADD_FAILURE() << pose.error().text();
    return {};
  }
  return std::move(pose).value();
}

NormalSampler sampler_of(const Motion& motion, const SampleOptions& options) {
  return NormalSampler::make(motion, options).value();
}

Vector vector_at(const std::vector<float>& values, std::size_t i) {
  return {values.at(3 * i), values.at(3 * i + 1), values.at(3 * i + 2)};
}

// Returns for each output the corners whose normals the oracle adds up. Vertices that coincide in both keyframes are
// one point.
std::vector<std::vector<reference::Corner>> corners_of_outputs(const reference::Mesh& mesh, ElementKind kind, bool weld,
                                                               Real crease_angle) {
  const auto all = reference::corners_of(mesh);
  const std::vector<std::size_t> point = reference::flood(mesh.from.size(), [&](std::size_t a, std::size_t b) {
    return a == b || (weld && mesh.from[a] == mesh.from[b] && mesh.to[a] == mesh.to[b]);
  });
  std::vector<std::vector<reference::Corner>> outputs;
  if (kind == ElementKind::kFaces) {
    for (std::size_t f = 0; f < mesh.faces.size(); ++f) outputs.push_back({{f, 0}});
  } else if (kind == ElementKind::kVertices) {
    outputs.resize(mesh.from.size());
    for (std::size_t v = 0; v < mesh.from.size(); ++v) {
      for (const auto& c : all) {
        if (point[vertex_of(mesh, c)] == point[v]) outputs[v].push_back(c);
      }
    }
  } else {
    const auto classes = reference::crease_classes(mesh, point, crease_angle);
    outputs.resize(all.size());
    for (std::size_t c = 0; c < all.size(); ++c) {
      for (std::size_t k = 0; k < all.size(); ++k) {
        if (classes[c] == classes[k]) outputs[c].push_back(all[k]);
      }
    }
  }
  return outputs;
}

// Returns the largest angle, in radians, between `normals` and the normals of the oracle. If the oracle has no normal
// for an output, the normal in `normals` must be zero.
double largest_error(const reference::Mesh& mesh, const std::vector<std::vector<reference::Corner>>& outputs,
                     const std::vector<float>& normals, const std::string& weighting, Real t) {
  EXPECT_EQ(normals.size(), 3 * outputs.size());
  double worst = 0;
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const Vector expected = reference::element_normal(mesh, outputs[i], weighting, t), found = vector_at(normals, i);
    EXPECT_EQ(reference::length(expected) == 0, reference::length(found) == 0) << i;
    worst = std::max(worst, static_cast<double>(reference::angle(expected, found)));
  }
  return worst;
}

std::vector<Motion> motions() {
  return {fixtures::smooth_morph(5), fixtures::shaken(fixtures::box_grid(2), 0.2, 3),
          test::torn(fixtures::shaken(fixtures::icosphere(1), 0.2, 4))};
}

TEST(NormalSampler, faces_vertices_and_corners_are_exact_at_every_time) {
  for (const Motion& motion : motions()) {
    const reference::Mesh mesh = test::reference_mesh(motion.segment(0));
    for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices, ElementKind::kCorners}) {
      for (const bool weld : {true, false}) {
        SampleOptions options = options_of(kind, Weighting::kArea, kind == ElementKind::kCorners ? 33 : 180);
        options.elements.weld = weld;
        NormalSampler sampler = sampler_of(motion, options);
        const auto outputs = corners_of_outputs(mesh, kind, weld, 33);
        EXPECT_EQ(sampler.output_count(), outputs.size());
        for (const double t : {0.0, 0.3, 0.5, 0.8125, 1.0}) {
          const Pose pose = good(sampler.at_time(t));
          EXPECT_LT(largest_error(mesh, outputs, sampler.normals_of_outputs(pose), "area", t), kTolerance) << t;
          for (std::size_t v = 0; v < mesh.from.size(); ++v) {
            const Vector p = reference::position(mesh, v, t);
            for (std::size_t k = 0; k < 3; ++k)
              EXPECT_FLOAT_EQ(pose.positions[3 * v + k], static_cast<float>(p[k])) << v << " at " << t;
          }
        }
      }
    }
  }
}

// Compares the normals of moving meshes, and of the same meshes at rest, with normals that are computed in integers.
TEST(NormalSampler, no_mesh_is_too_hard_for_a_millionth_of_a_radian) {
  constexpr double kTime = 0.375;
  fixtures::Random random(71);
  for (const auto& family : test::hard_motions()) {
    for (int i = 0; i < 20; ++i) {
      const Motion motion = family.make(random);
      Motion mesh = motion;
      mesh.keyframes.resize(1);
      mesh.segments.clear();
      Segment still = motion.segment(0);
      still.to = still.from;
      const auto moving_faces = test::IntegerNormals(motion.segment(0)).at(test::IntegerTime::of(kTime)),
                 standing_faces = test::IntegerNormals(still).at({});
      const NormalGroups vertices =
          NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
      for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
        for (const NormalLength length : {NormalLength::kUnit, NormalLength::kArea}) {
          SampleOptions options = options_of(kind);
          options.elements.weld = false;
          options.length = length;
          NormalSampler sampler = sampler_of(motion, options), at_rest = sampler_of(mesh, options);
          const std::vector<float> moving = good(sampler.at_time(kTime)).normals, standing = at_rest.at_rest().normals;
          for (std::size_t e = 0; e < moving.size() / 3; ++e) {
            for (const bool moves : {true, false}) {
              const auto& faces = moves ? moving_faces : standing_faces;
              const auto n = kind == ElementKind::kFaces ? faces[e] : test::sum_of(faces, vertices.faces(e));
              const std::vector<float>& found = moves ? moving : standing;
              const Vec3d v{found[3 * e], found[3 * e + 1], found[3 * e + 2]};
              if (test::is_zero(n)) {
                if (!moves) {
                  EXPECT_EQ(v, Vec3d{}) << family.name;
                }
              } else if (length == NormalLength::kUnit || (1e-30 < max_abs(v) && max_abs(v) < 3e38)) {
                // The length of n may exceed the range of float32, so its direction is compared in double.
                EXPECT_LE(test::angle_between(to_float(unit(v)), test::direction_of(n)), 1e-6) << family.name;
              }
            }
          }
        }
      }
    }
  }
}

// A request for one time, for two or for many, in any order, must give the same bytes for the same time. Normals must
// be within 1e-6 rad of normals that are computed in integers.
TEST(NormalSampler, normals_at_a_time_have_the_same_bits_whatever_is_asked_beside_it) {
  fixtures::Random random(4949);
  for (const auto& family : test::hard_motions()) {
    const int meshes = family.make == test::cancelling_star ? 40 : 3;
    for (int i = 0; i < meshes; ++i) {
      const Motion motion = family.make(random);
      const NormalGroups vertices =
          NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
      const test::IntegerNormals oracle(motion.segment(0));
      const std::vector<double> times = {1, 0.375, 0};
      for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
        SampleOptions options = options_of(kind);
        options.elements.weld = false;
        NormalSampler several = sampler_of(motion, options);
        for (const double t : times) {
          const auto faces = oracle.at(test::IntegerTime::of(t));
          const std::vector<float> found = good(several.at_time(t)).normals;
          EXPECT_EQ(found, good(sampler_of(motion, options).at_time(t)).normals)
              << family.name << ", mesh " << i << " at " << t << " alone";
          for (std::size_t e = 0; e < found.size() / 3; ++e) {
            const auto n = kind == ElementKind::kFaces ? faces[e] : test::sum_of(faces, vertices.faces(e));
            if (test::is_zero(n)) continue;
            const Vec3f u{found[3 * e], found[3 * e + 1], found[3 * e + 2]};
            EXPECT_LE(test::angle_between(u, test::direction_of(n)), 1e-6)
                << family.name << ", mesh " << i << ", element " << e << " at " << t;
          }
        }
        for (auto t = times.rbegin(); t != times.rend(); ++t)
          EXPECT_EQ(good(several.at_time(*t)).normals, good(sampler_of(motion, options).at_time(*t)).normals)
              << family.name << ", mesh " << i << " at " << *t << " after others";
      }
    }
  }
}

TEST(NormalSampler, every_weighting_is_computed_anew_at_each_time) {
  for (const Motion& motion : motions()) {
    const reference::Mesh mesh = test::reference_mesh(motion.segment(0));
    for (const WeightingInfo& weighting : kAllWeightings) {
      NormalSampler sampler = sampler_of(motion, options_of(ElementKind::kVertices, weighting.weighting));
      const auto outputs = corners_of_outputs(mesh, ElementKind::kVertices, true, 180);
      for (const double t : {0.0, 0.4, 1.0}) {
        const auto normals = sampler.normals_of_outputs(good(sampler.at_time(t)));
        EXPECT_LT(largest_error(mesh, outputs, normals, std::string(weighting.name), t), kTolerance) << weighting.name;
      }
    }
  }
}

TEST(NormalSampler, length_area_is_n_itself) {
  const Motion motion = fixtures::smooth_morph(5);
  const reference::Mesh mesh = test::reference_mesh(motion.segment(0));
  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
    SampleOptions options = options_of(kind);
    options.length = NormalLength::kArea;
    NormalSampler sampler = sampler_of(motion, options);
    const auto outputs = corners_of_outputs(mesh, kind, true, 180);
    const auto normals = sampler.normals_of_outputs(good(sampler.at_time(0.7)));
    for (std::size_t i = 0; i < outputs.size(); ++i) {
      const Vector expected = reference::element_normal(mesh, outputs[i], "area", 0.7L);
      const Real error = reference::length(reference::subtract(expected, vector_at(normals, i)));
      EXPECT_LT(error, 1e-6L * reference::length(expected)) << i;
    }
    const auto rest = sampler.normals_of_outputs(sampler.at_rest());
    const Vector first = reference::element_normal(mesh, outputs[0], "area", 0);
    EXPECT_NEAR(rest[2], static_cast<float>(first[2]), 1e-6);
  }
}

// Makes a base and two targets. Moves all of them by `offset` along x and z, and by -`offset` along y, so that the
// faces are small compared with their distance from the origin.
Motion star(double offset) {
  Motion motion = fixtures::shaken(fixtures::icosphere(1), 0.2, 11);
  const Motion other = fixtures::shaken(fixtures::icosphere(1), 0.3, 12);
  motion.keyframes.push_back(other.keyframes[1]);
  motion.connect_as_targets();
  return test::with_positions(motion, [offset](const fixtures::Point& p) {
    return fixtures::Point{p[0] + offset, p[1] - offset, p[2] + offset};
  });
}

TEST(NormalSampler, poses_of_weights_are_those_of_the_positions_in_double) {
  for (const double offset : {0.0, 1000.0}) {
    const Motion motion = star(offset);
    const reference::Mesh to_first = test::reference_mesh(motion.segment(0));
    const reference::Mesh to_second = test::reference_mesh(motion.segment(1));
    for (const WeightingInfo& weighting : kAllWeightings) {
      for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
        if (kind == ElementKind::kFaces && weighting.weighting != Weighting::kArea) continue;
        NormalSampler sampler = sampler_of(motion, options_of(kind, weighting.weighting));
        const auto outputs = corners_of_outputs(to_first, kind, true, 180);
        for (const auto& weights : std::vector<std::vector<double>>{{0, 0}, {1, 0}, {0.3, 0.6}, {-0.25, 1.5}}) {
          reference::Mesh pose = to_first;
          for (std::size_t v = 0; v < pose.from.size(); ++v) {
            const Vector first = reference::subtract(to_first.to[v], to_first.from[v]);
            const Vector second = reference::subtract(to_second.to[v], to_second.from[v]);
            pose.from[v] =
                reference::add(to_first.from[v], reference::add(reference::scaled(Real(weights[0]), first),
                                                                reference::scaled(Real(weights[1]), second)));
          }
          pose.to = pose.from;
          const Pose found = good(sampler.at_weights(weights));
          EXPECT_LT(largest_error(pose, outputs, sampler.normals_of_outputs(found), std::string(weighting.name), 0),
                    kTolerance)
              << weighting.name << " at " << offset;
          EXPECT_FLOAT_EQ(found.positions[3], static_cast<float>(pose.from[1][0]));
        }
      }
    }
  }
}

// Draws weights of three targets: integers, weights in which the base cancels, and others.
std::vector<double> weights_of_three(test::Random& random) {
  const double w = std::ldexp(static_cast<double>(random.below(65)), -6), any = random.uniform(-2, 2);
  switch (random.below(5)) {
    case 0:
      return {0, 1, 0};
    case 1:
      return {w, 0, 1 - w};
    case 2:
      return {-any, 1, any};
    case 3:
      return {-1, 1, 1};
    default:
      return {w, random.uniform(-1, 1), 0.25};
  }
}

// Compares the normals of poses with exact normals of the positions base + sum of w (target - base), in rational
// numbers.
TEST(NormalSampler, poses_lose_nothing_of_a_base_that_is_far_from_its_targets) {
  constexpr std::uint64_t kSeed = 20261127;
  std::cout << "  from seed " << kSeed << '\n';
  test::Random random(kSeed);
  double worst = 0;
  for (int i = 0; i < 400; ++i) {
    Motion motion;
    motion.topology = Topology::triangles(3, {0, 1, 2}).value();
    const double far = std::ldexp(1.0, static_cast<int>(random.below(100)));
    for (std::size_t k = 0; k < 4; ++k) {
      Motion::Keyframe& keyframe = motion.keyframes.emplace_back();
      keyframe.time = k == 0 ? 0 : 1;
      for (int c = 0; c < 9; ++c)
        keyframe.positions.push_back(static_cast<float>((k == 0 ? far : 1) * random.uniform(-1, 1)));
    }
    motion.connect_as_targets();
    const std::vector<double> weights = weights_of_three(random);
    std::array<exact::Vector, 3> corners;
    for (std::size_t c = 0; c < 9; ++c) {
      const auto at = [&](std::size_t k) { return exact::Rational(double{motion.keyframes[k].positions[c]}); };
      exact::Rational& sum = corners[c / 3][c % 3];
      sum = at(0);
      for (std::size_t k = 0; k < 3; ++k) sum += exact::Rational(weights[k]) * (at(k + 1) - at(0));
    }
    const exact::Vector right =
        exact::cross(exact::subtract(corners[1], corners[0]), exact::subtract(corners[2], corners[0]));
    NormalSampler sampler = sampler_of(motion, options_of(ElementKind::kFaces));
    const Pose pose = good(sampler.at_weights(weights));
    const double angle = exact::angle(pose.normals[0], pose.normals[1], pose.normals[2], right);
    EXPECT_LT(angle, 1e-6) << "case " << i << ", base " << far;
    worst = std::max(worst, angle);
    if (weights == std::vector<double>{0, 1, 0}) {
      EXPECT_EQ(pose.positions, motion.keyframes[2].positions);
    }
  }
  std::cout << "  at most " << worst << " rad\n";
}

TEST(NormalSampler, largest_positions_still_have_a_pose) {
  Motion motion = star(0);
  for (auto& keyframe : motion.keyframes) {
    for (float& c : keyframe.positions) c *= 2e38F;
  }
  NormalSampler sampler = sampler_of(motion, options_of(ElementKind::kFaces));
  const Pose pose = good(sampler.at_weights(std::vector<double>{0, 0}));
  EXPECT_EQ(pose.positions, motion.keyframes[0].positions);
  for (const float component : pose.normals) EXPECT_TRUE(std::isfinite(component));
  EXPECT_EQ(sampler.at_weights(std::vector<double>{99, 0}).error().code, ErrorCode::kUsage);
}

TEST(NormalSampler, copies_along_a_seam_have_the_same_bits) {
  const Motion motion = test::torn(fixtures::shaken(fixtures::icosphere(1), 0.2, 4));
  const auto distinct = [&motion](bool weld, Weighting weighting) {
    SampleOptions options = options_of(ElementKind::kVertices, weighting);
    options.elements.weld = weld;
    NormalSampler sampler = sampler_of(motion, options);
    const auto normals = sampler.normals_of_outputs(good(sampler.at_time(0.37)));
    std::set<std::vector<float>> at_points;  // each position, followed by its normal
    for (std::size_t v = 0; v < motion.topology.vertex_count(); ++v) {
      std::vector<float> both(motion.keyframes[0].positions.begin() + static_cast<std::ptrdiff_t>(3 * v),
                              motion.keyframes[0].positions.begin() + static_cast<std::ptrdiff_t>(3 * v + 3));
      both.insert(both.end(), normals.begin() + static_cast<std::ptrdiff_t>(3 * v),
                  normals.begin() + static_cast<std::ptrdiff_t>(3 * v + 3));
      at_points.insert(std::move(both));
    }
    return at_points.size();
  };
  for (const Weighting weighting : {Weighting::kArea, Weighting::kAngle}) {
    EXPECT_EQ(distinct(true, weighting), 42U);
    EXPECT_EQ(distinct(false, weighting), 240U);
  }
}

// Makes a cube of quads for tests of hard edges.
Motion cube() { return fixtures::shaken(fixtures::box_grid(1), 0, 1); }

TEST(NormalSampler, hard_edges_come_from_smoothing_groups_or_split_normals) {
  const Motion motion = cube();
  ASSERT_EQ(motion.topology.face_count(), 6U);
  const auto count_normals = [&motion](const ElementOptions& elements) {
    SampleOptions options;
    options.elements = elements;
    options.elements.kind = ElementKind::kCorners;
    NormalSampler sampler = sampler_of(motion, options);
    const auto normals = sampler.normals_of_outputs(sampler.at_rest());
    std::set<std::vector<float>> distinct;
    for (std::size_t c = 0; c < 24; ++c)
      distinct.insert({normals[3 * c] + 0.0F, normals[3 * c + 1] + 0.0F, normals[3 * c + 2] + 0.0F});
    return distinct.size();
  };
  ElementOptions elements;
  EXPECT_EQ(count_normals(elements), 8U) << "smooth";
  const std::vector<std::uint32_t> none(6, 0), all(6, 7), two = {1, 1, 2, 2, 1, 1};
  elements.group_of_face = none;
  EXPECT_EQ(count_normals(elements), 6U) << "every edge is hard";
  elements.group_of_face = all;
  EXPECT_EQ(count_normals(elements), 8U);
  elements.group_of_face = two;
  EXPECT_EQ(count_normals(elements), 6U) << "four edges of two faces each, and two faces";
  elements.group_of_face = {};
  std::vector<float> split;
  for (std::size_t c = 0; c < 24; ++c) split.insert(split.end(), {0, 0, c < 4 ? 1.0F : -1.0F});
  elements.normal_of_corner = VectorView<const float>::packed(split.data(), 24);
  EXPECT_EQ(count_normals(elements), 9U) << "one face apart from the others: 1 + 4 + 4";

  elements.normal_of_corner = VectorView<const float>::packed(split.data(), 23);
  SampleOptions wrong;
  wrong.elements = elements;
  wrong.elements.kind = ElementKind::kCorners;
  EXPECT_EQ(NormalSampler::make(motion, wrong).error().code, ErrorCode::kInvalidInput);
}

TEST(NormalSampler, elements_without_area_are_zero_and_limits_are_kept) {
  // Vertex 4 has no face. The first face has no area at t = 1, and the second face never has an area.
  Motion motion;
  motion.topology = Topology::triangles(5, {0, 1, 2, 0, 3, 3}).value();
  motion.keyframes = {{{0, 0, 0, 1, 0, 0, 0, 1, 0, 5, 5, 5, 9, 9, 9}, 0, ""},
                      {{0, 0, 0, 1, 0, 0, 2, 0, 0, 5, 5, 5, 9, 9, 9}, 1, ""}};
  motion.connect_as_sequence();
  NormalSampler exact = sampler_of(motion, options_of(ElementKind::kVertices));
  const auto limit = exact.normals_of_outputs(good(exact.at_time(1)));
  EXPECT_EQ(limit, (std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 0, 0, 0, 0}));
  NormalSampler anew = sampler_of(motion, options_of(ElementKind::kVertices, Weighting::kAngle));
  EXPECT_EQ(anew.normals_of_outputs(good(anew.at_time(1))), std::vector<float>(15, 0.0F));
}

Motion three_keyframes() {
  // A face turns by 90 degrees and then back another way, so its normals before and after the middle keyframe differ.
  Motion motion;
  motion.topology = Topology::triangles(3, {0, 1, 2}).value();
  motion.keyframes = {
      {{0, 0, 0, 1, 0, 0, 0, 1, 0}, 2, ""}, {{0, 0, 0, 1, 0, 0, 1, 0, 0}, 3, ""}, {{0, 0, 0, 1, 0, 0, 0, 0, 1}, 5, ""}};
  motion.connect_as_sequence();
  return motion;
}

TEST(NormalSampler, at_a_keyframe_has_the_limits_of_the_segment_that_begins_there) {
  const Motion motion = three_keyframes();
  NormalSampler sampler = sampler_of(motion, options_of(ElementKind::kFaces));
  EXPECT_EQ(good(sampler.at_time(3)).normals, (std::vector<float>{0, -1, 0})) << "the limit from after";
  EXPECT_EQ(good(sampler.at_time(2.5)).normals, (std::vector<float>{0, 0, 1})) << "curves of the right segment";
  EXPECT_EQ(good(sampler.at_time(4)).normals, (std::vector<float>{0, -1, 0}));
}

TEST(CheckWeights, asks_for_one_finite_weight_for_each_target) {
  EXPECT_TRUE(check_weights(star(0), std::vector<double>{0, -7}).ok());
  const auto message = [](const Motion& motion, const std::vector<double>& weights) {
    const Status status = check_weights(motion, weights);
    EXPECT_EQ(status.ok() ? ErrorCode::kFailed : status.error().code, ErrorCode::kUsage);
    return status.ok() ? "" : status.error().message;
  };
  EXPECT_NE(message(star(0), {1}).find("2 targets, but the pose has 1 weight"), std::string::npos);
  EXPECT_NE(message(star(0), {1, std::nan("")}).find("target 1"), std::string::npos);
  EXPECT_NE(message(three_keyframes(), {1, 0}).find("blend shapes"), std::string::npos);
}

TEST(NormalSampler, refuses_what_has_no_meaning) {
  const Motion motion = cube();
  EXPECT_EQ(NormalSampler::make(motion, options_of(ElementKind::kFaces, Weighting::kAngle)).error().code,
            ErrorCode::kUsage);
  SampleOptions options = options_of(ElementKind::kVertices, Weighting::kUniform);
  options.length = NormalLength::kArea;
  EXPECT_EQ(NormalSampler::make(motion, options).error().code, ErrorCode::kUsage);
  EXPECT_EQ(NormalSampler::make(motion, options_of(ElementKind::kCorners, Weighting::kArea, 181)).error().code,
            ErrorCode::kUsage);
}

TEST(NormalSampler, mesh_that_stands_still_has_normals) {
  Motion still = cube();
  still.segments.clear();
  still.keyframes.resize(1);
  for (const double crease : {180.0, 30.0}) {
    NormalSampler sampler = sampler_of(still, options_of(ElementKind::kCorners, Weighting::kArea, crease));
    const Pose pose = sampler.at_rest();
    EXPECT_EQ(pose.normals.size(), crease == 180 ? 24U : 72U);
    EXPECT_EQ(pose.positions, still.keyframes[0].positions);
  }
}

// The three corners of face 0 are always on a line, which moves as a whole.
TEST(Sampler, a_face_that_never_has_area_has_no_normal) {
  Motion motion;
  motion.topology = Topology::triangles(4, std::vector<std::uint32_t>{0, 1, 2, 0, 1, 3}).value();
  for (const double time : {0.0, 1.0, 2.0, 3.0}) {
    const std::array<double, 3> start = {0.5 + 1.25 * time, 0.25 + 0.375 * time * time, 0.125 - 0.75 * time * time},
                                along = {0.25, 0.5, 0.125};
    Motion::Keyframe& keyframe = motion.keyframes.emplace_back();
    keyframe.time = time;
    for (const double place : {0.0, 1.0, 3.0})
      for (std::size_t c = 0; c < 3; ++c) keyframe.positions.push_back(static_cast<float>(start[c] + place * along[c]));
    for (std::size_t c = 0; c < 3; ++c) keyframe.positions.push_back(static_cast<float>(start[c] + (c == 2 ? 1 : 0)));
  }
  motion.connect_as_sequence();
  for (const NormalLength length : {NormalLength::kUnit, NormalLength::kArea}) {
    SampleOptions options = options_of(ElementKind::kFaces);
    options.length = length;
    NormalSampler sampler = sampler_of(motion, options);
    for (const double time : {0.37, 0.5, 1.21, 2.9}) {
      const Pose pose = good(sampler.at_time(time));
      EXPECT_EQ(std::vector<float>(pose.normals.begin(), pose.normals.begin() + 3), std::vector<float>(3)) << time;
      EXPECT_NE(std::vector<float>(pose.normals.begin() + 3, pose.normals.end()), std::vector<float>(3)) << time;
    }
  }
  // Vertex 2 belongs only to the face without area. The normals of the other vertices have the direction of the other
  // face.
  for (const Weighting weighting : {Weighting::kArea, Weighting::kAngle, Weighting::kUniform}) {
    SampleOptions options = options_of(ElementKind::kVertices, weighting), of_faces = options_of(ElementKind::kFaces);
    NormalSampler sampler = sampler_of(motion, options), faces = sampler_of(motion, of_faces);
    for (const double time : {0.37, 1.21}) {
      const Pose pose = good(sampler.at_time(time));
      EXPECT_EQ(vector_at(pose.normals, 2), Vector()) << time;
      EXPECT_LT(reference::angle(vector_at(pose.normals, 0), vector_at(good(faces.at_time(time)).normals, 1)), 2e-6);
    }
  }
}

}  // namespace
}  // namespace chronormal::sample_test
