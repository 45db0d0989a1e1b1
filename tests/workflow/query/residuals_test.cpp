// Compares the results for a mesh near the origin with the results for the same mesh far away. Far away, float32 cannot
// represent the coordinates, so keyframes also store the rounding errors (residuals). All results must be equal.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/analysis/certify.h"
#include "chronormal/analysis/cones.h"
#include "chronormal/analysis/containment.h"
#include "chronormal/analysis/quality.h"
#include "chronormal/analysis/signs.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/weighting.h"
#include "chronormal/schemes/scheme.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/compare.h"
#include "chronormal/workflow/inspect.h"
#include "core/twofold.h"
#include "normals/recompute/recompute.h"
#include "tests/support/fixtures.h"

namespace chronormal::residuals_test {
namespace {

using fixtures::Random;

constexpr std::uint64_t kSeed = 4902;
constexpr int kMeshes = 16;
constexpr Vec3d kAway{1.25, -1.5, 1.75};
// The coordinates near the origin are at most about kSize, and are multiples of kUnit, so 22 bits hold each of them.
constexpr double kUnit = 0x1p-42, kSize = 0x1p-20;

// A mesh near the origin and the same mesh far away, in one segment. The mesh is a closed surface, or separate
// triangles with collapses, slivers and planes.
struct Twins {
  Motion near, far;
};

Twins random_twins(Random& random, bool is_soup) {
  Twins twins;
  twins.near = is_soup ? fixtures::shaken(fixtures::box_grid(1), 0.3, random.below(1000))
                       : fixtures::shaken(fixtures::icosphere(1), 0.3, random.below(1000));
  const bool is_lattice = random.below(3) == 0;
  for (Motion::Keyframe& keyframe : twins.near.keyframes) {
    for (float& x : keyframe.positions) {
      // Rounds the coordinates to a coarse lattice, so that many faces have no area and many corners are on a line.
      constexpr double kOdd = 349525;  // far from the origin, no point of the lattice is a float
      const double units = is_lattice ? kOdd * std::round(2 * double{x}) : std::round(double{x} / 4 * (kSize / kUnit));
      x = static_cast<float>(kUnit * units);
    }
  }
  twins.far = twins.near;
  for (Motion::Keyframe& keyframe : twins.far.keyframes) {
    std::vector<double> high;
    for (std::size_t i = 0; i < keyframe.positions.size(); ++i) {
      const double away = i % 3 == 0 ? kAway.x : i % 3 == 1 ? kAway.y : kAway.z;
      high.push_back(double{keyframe.positions[i]} + away);
    }
    keyframe.set_positions(high, std::vector<double>(high.size()));
  }
  EXPECT_FALSE(twins.far.keyframes[1].residuals.empty());
  EXPECT_TRUE(validate(twins.near).ok());
  EXPECT_TRUE(validate(twins.far).ok());
  return twins;
}

bool operator==(const FacingChange& a, const FacingChange& b) {
  return a.before == b.before && a.after == b.after && std::fabs(a.lower - b.lower) < 1e-14 &&
         std::fabs(a.upper - b.upper) < 1e-14;
}

void expect_same(const Facing& a, const Facing& b, std::size_t face) {
  ASSERT_EQ(a.count, b.count) << face;
  EXPECT_EQ(a.side, b.side) << face;
  for (std::size_t k = 0; k < a.count; ++k) EXPECT_TRUE(a.at[k] == b.at[k]) << face;
}

void expect_close(const Vec3d& a, const Vec3d& b, double share) { EXPECT_LE(max_abs(a - b), share * max_abs(a)); }

class Residuals : public testing::Test {
 protected:
  template <class Body>
  static void for_twins(const Body& body) {
    std::cout << "seed " << kSeed << '\n';
    for (int i = 0; i < kMeshes; ++i) {
      Random random(kSeed + static_cast<std::uint64_t>(i));
      const Twins twins = random_twins(random, i % 2 == 0);
      body(twins, twins.near.segment(0), twins.far.segment(0), random);
    }
  }
};

TEST_F(Residuals, leave_control_normals_and_their_curves_as_they_are_at_the_origin) {
  for_twins([](const Twins& twins, const Segment& near, const Segment& far, Random& random) {
    const std::size_t faces = near.topology->face_count();
    std::vector<ControlNormals> of_near(faces), of_far(faces);
    face_control_normals(near, {0, faces}, of_near);
    face_control_normals(far, {0, faces}, of_far);
    const NormalGroups groups =
        NormalGroups::of_vertices(twins.near.topology, separate_points(twins.near.topology.vertex_count()));
    const double t = random.uniform(0, 1);
    std::vector<Vec3d> reference_near(faces), reference_far(faces);
    reference_normals(near, {0, faces}, t, reference_near);
    reference_normals(far, {0, faces}, t, reference_far);
    for (std::size_t f = 0; f < faces; ++f) {
      EXPECT_EQ(of_near[f], of_far[f]) << f;
      EXPECT_EQ(reference_near[f], reference_far[f]) << f;
    }
    for (std::size_t v = 0; v < groups.size(); ++v)
      EXPECT_EQ(reference_normal(near, groups.faces(v), t), reference_normal(far, groups.faces(v), t)) << v;
    std::vector<float> a(3 * groups.size()), b(a);
    const auto to_a = VectorView<float>::packed(std::span(a)), to_b = VectorView<float>::packed(std::span(b));
    const auto expect_same_directions = [&](const char* way) {
      for (std::size_t v = 0; v < groups.size(); ++v)
        EXPECT_LE(max_abs(to_double(to_a[v]) - to_double(to_b[v])), 5e-7) << way << " at " << v;
    };
    (void)NormalCurves::of_groups(near, groups).unit_normals(t, to_a);
    (void)NormalCurves::of_groups(far, groups).unit_normals(t, to_b);
    expect_same_directions("curves");
    (void)NormalRecompute(near, groups).unit_normals(t, to_a);
    (void)NormalRecompute(far, groups).unit_normals(t, to_b);
    expect_same_directions("recompute");
    const Result<NormalGroups> creased = NormalGroups::by_crease_angle(
                                   twins.near, separate_points(twins.near.topology.vertex_count()), 40),
                               creased_far = NormalGroups::by_crease_angle(
                                   twins.far, separate_points(twins.near.topology.vertex_count()), 40);
    EXPECT_TRUE(std::equal(creased.value().element_of_output().begin(), creased.value().element_of_output().end(),
                           creased_far.value().element_of_output().begin()));
    for (const WeightingInfo& info : kAllWeightings) {
      const auto at_near = all_weighted_normals_at(near, groups, info.weighting, t),
                 at_far = all_weighted_normals_at(far, groups, info.weighting, t);
      for (std::size_t v = 0; v < groups.size(); ++v) expect_close(at_near[v], at_far[v], 1e-12);
    }
    const WeightingFit fit_near = fit_weighting(near, groups, Weighting::kAngle),
                       fit_far = fit_weighting(far, groups, Weighting::kAngle);
    for (std::size_t v = 0; v < groups.size(); ++v) EXPECT_NEAR(fit_near.bounds[v], fit_far.bounds[v], 1e-9) << v;
  });
}

TEST_F(Residuals, leave_schemes_and_certificates_as_they_are_at_the_origin) {
  for_twins([](const Twins&, const Segment& near, const Segment& far, Random&) {
    const std::size_t faces = near.topology->face_count();
    std::vector<ControlNormals> control(faces);
    face_control_normals(near, {0, faces}, control);
    for (const char* const name : {"quaternion:edge", "quaternion:matrix", "slerp", "recompute"}) {
      std::vector<float> a(3 * faces), b(a);
      for (const auto& [segment, to] : {std::pair(&near, &a), std::pair(&far, &b)}) {
        const auto scheme = make_scheme(name).value();
        scheme->prepare({segment, {0, faces}, control, true});
        scheme->evaluate(0.375, VectorView<float>::packed(std::span(*to)));
      }
      for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(a[i], b[i], 5e-7) << name << " at " << i;
    }
    const auto bounds_near = certify("linear", near).value(), bounds_far = certify("linear", far).value();
    for (std::size_t f = 0; f < faces; ++f) EXPECT_NEAR(bounds_near[f].upper, bounds_far[f].upper, 1e-9) << f;
  });
}

TEST_F(Residuals, leave_the_answers_of_queries_as_they_are_at_the_origin) {
  for_twins([](const Twins&, const Segment& near, const Segment& far, Random& random) {
    const std::size_t faces = near.topology->face_count();
    const fixtures::Point to = random.in_cube(1), first = random.in_cube(2 * kSize), last = random.in_cube(2 * kSize);
    // Rounds the position of the eye to multiples of kUnit. The position is then exact in double, even near the mesh
    // that is far from the origin.
    const auto eye = [](const fixtures::Point& p, const Vec3d& away) {
      const auto whole = [](double x) { return kUnit * std::round(x / kUnit); };
      return Vec3d{whole(p[0]), whole(p[1]), whole(p[2])} + away;
    };
    std::vector<NormalCone> cones_near(faces), cones_far(faces);
    face_normal_cones(near, {0, faces}, 0.25, 0.75, cones_near);
    face_normal_cones(far, {0, faces}, 0.25, 0.75, cones_far);
    EXPECT_EQ(cones_near, cones_far);
    std::vector<ShutterNormal> shutter_near(faces), shutter_far(faces);
    face_shutter_normals(near, {0, faces}, 0.25, 0.75, shutter_near);
    face_shutter_normals(far, {0, faces}, 0.25, 0.75, shutter_far);
    for (std::size_t f = 0; f < faces; ++f) {
      EXPECT_EQ(shutter_near[f].mean, shutter_far[f].mean) << f;
      EXPECT_EQ(shutter_near[f].mean_unit, shutter_far[f].mean_unit) << f;
      const Vec3d direction{to[0], to[1], to[2]};
      expect_same(find_facing(near, f, View::of_direction(direction)),
                  find_facing(far, f, View::of_direction(direction)), f);
      expect_same(find_facing(near, f, View::of_eye(eye(first, {}))),
                  find_facing(far, f, View::of_eye(eye(first, kAway))), f);
      expect_same(find_facing(near, f, View::of_moving_eye(eye(first, {}), eye(last, {}))),
                  find_facing(far, f, View::of_moving_eye(eye(first, kAway), eye(last, kAway))), f);
      const Collapses a = find_collapses(near, f), b = find_collapses(far, f);
      ASSERT_EQ(a.count, b.count) << f;
      EXPECT_EQ(a.always, b.always) << f;
      for (std::size_t k = 0; k < a.count; ++k) {
        EXPECT_EQ(a.at[k].lower, b.at[k].lower) << f;
        EXPECT_EQ(a.at[k].upper, b.at[k].upper) << f;
        EXPECT_EQ(a.at[k].turns_over, b.at[k].turns_over) << f;
      }
    }
    const std::vector<std::uint32_t> all = {0, 1, 2, 3, 4, 5};
    const ClusterBounds bounds_near = cluster_bounds(near, all, 0, 1), bounds_far = cluster_bounds(far, all, 0, 1);
    EXPECT_EQ(bounds_near.cone_cutoff, bounds_far.cone_cutoff);
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_EQ(bounds_near.cone_axis[axis], bounds_far.cone_axis[axis]);
  });
}

TEST_F(Residuals, leave_points_inside_or_outside_as_they_are_at_the_origin) {
  for_twins([](const Twins& twins, const Segment& near, const Segment& far, Random& random) {
    const Topology& topology = twins.near.topology;
    const auto make = [&](const Motion& motion) {
      return Containment::make(topology, weld_coincident(twins.near),
                               VectorView<const float>::packed(std::span(motion.keyframes[0].positions)));
    };
    const Result<Containment> in_near = make(twins.near), in_far = make(twins.far);
    ASSERT_TRUE(in_near.ok()) << in_near.error().text();
    ASSERT_TRUE(in_far.ok());
    // The points are multiples of 2^-23, which float32 represents near the origin and far away.
    constexpr double kGrid = 0x1p-23;
    std::vector<float> from, to, far_from, far_to;
    for (int i = 0; i < 3 * 300; ++i) {
      const double away = i % 3 == 0 ? kAway.x : i % 3 == 1 ? kAway.y : kAway.z;
      const double a = kGrid * (static_cast<double>(random.below(9)) - 4),
                   b = kGrid * (static_cast<double>(random.below(9)) - 4);
      from.push_back(static_cast<float>(a));
      to.push_back(static_cast<float>(b));
      far_from.push_back(static_cast<float>(a + away));
      far_to.push_back(static_cast<float>(b + away));
      ASSERT_EQ(double{far_from.back()}, a + away);
    }
    const auto view = [](const std::vector<float>& points) {
      return VectorView<const float>::packed(std::span(points));
    };
    for (const double t : {0.0, 0.3, 1.0})
      EXPECT_EQ(in_near.value().winding_numbers(near, t, view(from), view(to)),
                in_far.value().winding_numbers(far, t, view(far_from), view(far_to)));
    const std::vector<Crossing> crossings = in_near.value().crossings(near, view(from), view(to)),
                                of_far = in_far.value().crossings(far, view(far_from), view(far_to));
    ASSERT_EQ(crossings.size(), of_far.size());
    for (std::size_t i = 0; i < crossings.size(); ++i) {
      EXPECT_EQ(crossings[i].point, of_far[i].point);
      EXPECT_EQ(crossings[i].inward, of_far[i].inward);
      EXPECT_NEAR(crossings[i].t, of_far[i].t, 0x1p-43);
    }
  });
}

TEST_F(Residuals, leave_audits_and_errors_at_keyframes_as_they_are_at_the_origin) {
  std::cout << "seed " << kSeed << '\n';
  for (int i = 0; i < kMeshes; ++i) {
    Random random(kSeed + static_cast<std::uint64_t>(i));
    // The surfaces have no faces that nearly collapse. A face counts as collapsed relative to the size of the
    // coordinates, so the answer for such a face could differ between the two places.
    Twins twins;
    for (const int k : {0, 1, 2}) {
      const Motion shaken = fixtures::shaken(fixtures::icosphere(1), 0.3, 100 * static_cast<std::uint64_t>(i) + 7);
      if (k == 0) twins.near.topology = shaken.topology;
      Motion::Keyframe& near = twins.near.keyframes.emplace_back();
      near.time = k;
      std::vector<double> high;
      for (const float x : shaken.keyframes[static_cast<std::size_t>(k % 2)].positions) {
        const double moved = double{x} / 4 + (k == 2 ? random.uniform(0, 0.1) : 0);
        near.positions.push_back(static_cast<float>(kUnit * std::round(moved * (kSize / kUnit))));
        const std::size_t c = high.size() % 3;
        high.push_back(double{near.positions.back()} + (c == 0 ? kAway.x : c == 1 ? kAway.y : kAway.z));
      }
      Motion::Keyframe& far = twins.far.keyframes.emplace_back();
      far.time = k;
      far.set_positions(high, std::vector<double>(high.size()));
    }
    twins.far.topology = twins.near.topology;
    twins.near.connect_as_sequence();
    twins.far.connect_as_sequence();
    // Tests both ways in which audits measure: with area weights in blocks of faces, and with angle weights one vertex
    // after the other.
    for (const Weighting weighting : {Weighting::kArea, Weighting::kAngle}) {
      AuditOptions options;
      options.weighting = weighting;
      options.weld = false;
      const Audit near = audit(twins.near, {}, options).value(), far = audit(twins.far, {}, options).value();
      ASSERT_EQ(near.subjects.size(), 1U);
      ASSERT_EQ(far.subjects.size(), 1U);
      EXPECT_GT(near.subjects[0].error.worst, 1);
      EXPECT_NEAR(near.subjects[0].error.worst, far.subjects[0].error.worst, 1e-4);
      EXPECT_NEAR(near.subjects[0].error.mean(), far.subjects[0].error.mean(), 1e-4);
    }
    for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
      TruthOptions options;
      options.schemes = {"polynomial"};
      options.elements.kind = kind;
      options.elements.weld = false;
      const TruthComparison near = compare_with_truth(twins.near, options).value(),
                            far = compare_with_truth(twins.far, options).value();
      EXPECT_NEAR(near.rows[0].quality.max, far.rows[0].quality.max, 1e-6);
      EXPECT_NEAR(near.rows[0].quality.mean(), far.rows[0].quality.mean(), 1e-6);
    }
    const Inspection near = inspect(twins.near), far = inspect(twins.far);
    EXPECT_NEAR(near.motion.value, far.motion.value, 1e-9 * near.motion.value);
  }
}

TEST_F(Residuals, are_checked_and_say_nothing_where_nothing_was_rounded) {
  Random random(kSeed);
  Motion motion = random_twins(random, true).far;
  ASSERT_FALSE(motion.keyframes[1].residuals.empty());
  motion.keyframes[1].residuals[4] = 1e-3;
  EXPECT_EQ(validate(motion).error().place, "frame 1, vertex 1");
  motion.keyframes[1].residuals.pop_back();
  EXPECT_EQ(validate(motion).error().place, "frame 1");
  Motion::Keyframe exact;
  exact.set_positions(std::vector<double>{0.5, -3, 0x1p-149}, std::vector<double>(3));
  EXPECT_TRUE(exact.residuals.empty());
}

TEST_F(Residuals, give_targets_their_deltas_back) {
  Motion star;
  star.topology = fixtures::make_triangles(3, {0, 1, 2});
  const std::vector<float> base = {1, 0.1F, -3, 7, 0.3F, 0, 0.7F, 1.0F / 3, 11},
                           delta = {1e-3F, 1e-5F, 3e-7F, 0.1F, 1e-9F, 1, 1e-4F, 0.2F, 1e-8F};
  star.keyframes.resize(2);
  star.keyframes[0].positions = base;
  star.keyframes[1].time = 1;
  std::vector<double> high, low;
  for (std::size_t i = 0; i < base.size(); ++i) {
    const Twofold sum = Twofold::sum(double{base[i]}, double{delta[i]});
    high.push_back(sum.high);
    low.push_back(sum.low);
  }
  star.keyframes[1].set_positions(high, low);
  star.connect_as_targets();
  EXPECT_EQ(blend_set_of(star).value().targets[0].deltas, delta);
}

}  // namespace
}  // namespace chronormal::residuals_test
