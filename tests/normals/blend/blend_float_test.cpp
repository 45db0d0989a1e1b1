// Tests blends whose normals are computed in float32, which a caller can request.

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstring>
#include <vector>

#include "chronormal/normals/float_recompute.h"
#include "normals/blend/blend_normals.h"
#include "simd/targets.h"
#include "tests/support/fixtures.h"

namespace chronormal::blend_float_test {
namespace {

// Makes a sheet with `dense` targets that move all vertices and `sparse` targets that move a few vertices.
BlendSet sheet(std::size_t dense, std::size_t sparse) {
  const Motion motion = fixtures::smooth_morph(20);
  BlendSet set;
  set.topology = motion.topology;
  set.base = motion.keyframes[0].positions;
  fixtures::Random random(20261125);
  const std::size_t vertices = set.topology.vertex_count();
  for (std::size_t k = 0; k < dense + sparse; ++k) {
    std::vector<float> deltas(3 * vertices);
    for (std::size_t i = 0; i < deltas.size(); ++i) {
      const bool moves = k < dense || (i / 3 + 7 * k) % 19 == 0;
      if (moves) deltas[i] = static_cast<float>(random.uniform(-0.01, 0.01));
    }
    set.targets.push_back(BlendTarget::from_dense(deltas));
  }
  return set;
}

std::vector<double> some_weights(std::size_t count) {
  std::vector<double> weights(count);
  for (std::size_t k = 0; k < count; ++k) weights[k] = k % 3 == 1 ? 0 : 0.1 + 0.07 * static_cast<double>(k);
  return weights;
}

NormalGroups groups_of(const BlendSet& set) {
  return NormalGroups::of_vertices(set.topology, separate_points(set.topology.vertex_count()));
}

// Returns the blended positions, computed by a plain loop in float32.
std::vector<float> blended(const BlendSet& set, const std::vector<double>& weights) {
  std::vector<float> positions = set.base;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] == 0) continue;
    const auto weight = static_cast<float>(weights[k]);
    const BlendTarget& target = set.targets[k];
    for (std::size_t n = 0; n < target.vertices.size(); ++n) {
      for (std::size_t c = 0; c < 3; ++c) {
        const float step = weight * target.deltas[3 * n + c];
        positions[3 * std::size_t{target.vertices[n]} + c] += step;
      }
    }
  }
  return positions;
}

TEST(BlendFloat, whole_mesh_has_the_bits_of_float_recompute_of_the_blended_positions) {
  const BlendSet set = sheet(3, 20);
  const std::vector<double> weights = some_weights(set.targets.size());
  const std::vector<float> positions = blended(set, weights);
  const auto points = VectorView<const float>::packed(positions.data(), positions.size() / 3);
  for (const auto target : supported_targets()) {
    const ScopedTarget scope(target);
    for (const bool of_faces : {false, true}) {
      const BlendNormalsOptions options{.forced = BlendPath::kWhole, .in_float32 = true};
      const NormalGroups groups = groups_of(set);
      BlendNormals normals =
          of_faces ? BlendNormals::of_faces(set, options) : BlendNormals::of_groups(set, groups, options);
      FloatRecompute recompute = of_faces ? FloatRecompute(set.topology) : FloatRecompute(set.topology, groups);
      std::vector<float> found(3 * normals.size()), expected(3 * normals.size());
      (void)recompute.unit_normals(points, VectorView<float>::packed(expected.data(), normals.size()));
      for (const Threads threads : {Threads::kOne, Threads::kAll, Threads::kOne}) {
        std::fill(found.begin(), found.end(), 7.0F);
        const BlendEvaluation done =
            normals.unit_normals(weights, VectorView<float>::packed(found.data(), normals.size()), threads);
        EXPECT_EQ(done.path, BlendPath::kWhole);
        EXPECT_EQ(done.recomputed_elements, normals.size());
        EXPECT_EQ(done.zeros, 0U);
        ASSERT_EQ(std::memcmp(found.data(), expected.data(), found.size() * sizeof(float)), 0) << target_name(target);
      }
    }
  }
}

TEST(BlendFloat, other_paths_are_as_exact_as_ever) {
  const BlendSet set = sheet(1, 6);
  const std::vector<double> weights = some_weights(set.targets.size());
  for (const BlendPath path : {BlendPath::kTerms, BlendPath::kTouched}) {
    BlendNormals exact = BlendNormals::of_groups(set, groups_of(set), {.forced = path}),
                 normals = BlendNormals::of_groups(set, groups_of(set), {.forced = path, .in_float32 = true});
    std::vector<float> found(3 * normals.size()), expected(3 * normals.size());
    (void)exact.unit_normals(weights, VectorView<float>::packed(expected.data(), normals.size()));
    (void)normals.unit_normals(weights, VectorView<float>::packed(found.data(), normals.size()));
    EXPECT_EQ(found, expected);
    EXPECT_GT(normals.bytes(), exact.bytes()) << "points in float32";
  }
}

TEST(BlendFloat, is_chosen_where_it_is_cheaper_than_terms) {
  const BlendSet set = sheet(5, 60);
  std::vector<double> weights(set.targets.size(), 0.1);
  BlendNormals exact = BlendNormals::of_groups(set, groups_of(set)),
               normals = BlendNormals::of_groups(set, groups_of(set), {.in_float32 = true});
  const BlendChoice choice = normals.set_weights(weights);
  EXPECT_LT(choice.whole_ns, 0.6 * exact.set_weights(weights).whole_ns);
  EXPECT_EQ(choice.path, BlendPath::kWhole);
  std::fill(weights.begin(), weights.end(), 0);
  weights[10] = 1;
  EXPECT_EQ(normals.set_weights(weights).path, BlendPath::kTerms);
}

TEST(BlendFloat, has_no_effect_where_a_ring_is_too_long_for_lanes) {
  // Makes a fan of 80 triangles around vertex 0. The float32 code does not accept so many faces around one vertex.
  constexpr std::uint32_t kTriangles = 80;
  BlendSet set;
  set.base = {0, 0, 1};
  std::vector<std::uint32_t> corners;
  for (std::uint32_t i = 0; i < kTriangles; ++i) {
    const double angle = 6.28 * i / kTriangles;
    set.base.insert(set.base.end(), {static_cast<float>(std::cos(angle)), static_cast<float>(std::sin(angle)), 0.0F});
    corners.insert(corners.end(), {0, i + 1, (i + 1) % kTriangles + 1});
  }
  set.topology = Topology::triangles(kTriangles + 1, corners).value();
  std::vector<float> deltas(set.base.size());
  deltas[2] = 0.3F;
  set.targets.push_back(BlendTarget::from_dense(deltas));
  const std::vector<double> weights = {0.7};
  std::vector<std::vector<float>> found;
  for (const bool in_float32 : {false, true}) {
    BlendNormals normals =
        BlendNormals::of_groups(set, groups_of(set), {.forced = BlendPath::kWhole, .in_float32 = in_float32});
    found.emplace_back(3 * normals.size());
    (void)normals.unit_normals(weights, VectorView<float>::packed(found.back().data(), normals.size()));
  }
  EXPECT_EQ(found[0], found[1]);
}

}  // namespace
}  // namespace chronormal::blend_float_test
