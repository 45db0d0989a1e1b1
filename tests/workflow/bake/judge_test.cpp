// Compares the results of a bake's judge with a list of all errors: the average, the worst error, the 99.9 % quantile
// and the torn edges. Also checks that each target alone is judged at weight 1.
#include "workflow/bake/judge/judge.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "tests/support/bake_fixture.h"

namespace chronormal::judge_test {
namespace {

constexpr std::size_t kTargets = 3;
constexpr unsigned kSeed = 7;

double degrees_between(const Vec3d& a, const Vec3d& b) {
  const double x = a.y * b.z - a.z * b.y, y = a.z * b.x - a.x * b.z, z = a.x * b.y - a.y * b.x;
  return std::atan2(std::sqrt(x * x + y * y + z * z), a.x * b.x + a.y * b.y + a.z * b.z) * 57.29577951308232;
}

using Edge = std::pair<std::uint32_t, std::uint32_t>;

// Returns all edges of the triangles. Adds edges that link the vertices that share a normal, each vertex to the next
// vertex.
std::set<Edge> edges_of(const GltfShading& shading) {
  std::set<Edge> edges;
  const Topology& topology = shading.set.topology;
  for (std::size_t f = 0; f < topology.face_count(); ++f)
    for (std::size_t c = 0; c < 3; ++c) edges.insert(std::minmax(topology.face(f)[c], topology.face(f)[(c + 1) % 3]));
  std::map<std::uint32_t, std::uint32_t> last;
  for (std::uint32_t v = 0; v < shading.element_of_vertex.size(); ++v) {
    const auto [before, is_first] = last.try_emplace(shading.element_of_vertex[v], v);
    if (!is_first) edges.insert({std::exchange(before->second, v), v});
  }
  return edges;
}

TEST(Judge, finds_the_errors_and_tears_of_a_list_of_all_pairs) {
  const test::GltfFixture file(test::still_hills_document(kTargets, kSeed));
  const GltfShading shading = read_gltf_shading(*file, 0).value();
  const AuthorTruth truth(shading, Weighting::kArea);
  const NormalTerms terms(shading, truth);
  MeshPlan plan;
  plan.largest.assign(shading.groups.size(), 1.0);
  const DeltaSource source{shading, terms, plan, shading.normals};
  const RightNormals rights(shading, terms, shading.normals, plan.largest);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> part(-0.5, 1);
  MeshWeights weights{{}, {}, {}, {}, 0, WeightUse(kTargets), false, {}};
  weights.poses.assign(400, std::vector<double>(kTargets));
  for (std::vector<double>& pose : weights.poses)
    for (double& weight : pose) weight = part(random);

  // The deltas need not be good for this test, so they are random.
  const std::array<Viewer, 1> viewer = {kViewers[0]};
  const Judge judge(source, rights, weights, viewer, 1, true);
  Candidate candidate;
  candidate.own.resize(kTargets);
  for (VertexVectors& column : candidate.own) {
    column.vertices.assign(judge.vertices().begin(), judge.vertices().end());
    for (std::size_t n = 0; n < column.vertices.size(); ++n)
      column.vectors.push_back(to_float(Vec3d{part(random), part(random), 0.3 * part(random)}));
  }

  std::vector<double> errors;
  std::array<std::size_t, 3> tears{};
  const std::set<Edge> edges = edges_of(shading);
  for (const std::vector<double>& pose : weights.poses) {
    const std::vector<Vec3d> normals = rights.of_elements(pose);
    std::map<std::uint32_t, Vec3d> differences;
    for (const std::uint32_t v : judge.vertices()) {
      Vec3d shown = {shading.normals[3 * v], shading.normals[3 * v + 1], shading.normals[3 * v + 2]};
      for (std::size_t k = 0; k < kTargets; ++k) shown = shown + pose[k] * to_double(candidate.own[k].at(v));
      const Vec3d right = rights.of_vertex(v, normals[shading.element_of_vertex[v]]);
      errors.push_back(degrees_between(shown, right));
      differences[v] = (1 / std::sqrt(dot(shown, shown))) * shown - (1 / std::sqrt(dot(right, right))) * right;
    }
    for (const auto& [a, b] : edges) {
      if (differences.count(a) + differences.count(b) == 0) continue;
      const Vec3d jump = differences[a] - differences[b];
      const double tear = 2 * std::asin(std::min(1.0, std::sqrt(dot(jump, jump)) / 2)) * 57.29577951308232;
      for (std::size_t k = 0; k < tears.size(); ++k) tears[k] += tear > 10 * std::exp2(k) ? 1U : 0U;
    }
  }
  std::sort(errors.begin(), errors.end());
  double sum = 0;
  for (const double error : errors) sum += error;
  const double most = errors[errors.size() - 1 - errors.size() / 1000];

  const ShownErrors found = errors_of_all(judge.measure(candidate, Judge::Depth::kAll)[0]).errors();
  EXPECT_EQ(found.judged, errors.size());
  EXPECT_NEAR(found.mean, sum / static_cast<double>(errors.size()), 1e-4);
  EXPECT_NEAR(found.worst, errors.back(), 1e-3);
  EXPECT_GE(found.most, most * (1 - 1e-5));
  EXPECT_LE(found.most, 1.07 * most) << "of a worst of " << errors.back();
  EXPECT_LT(found.most, found.worst) << "else this says nothing";
  for (std::size_t k = 0; k < tears.size(); ++k) {
    EXPECT_NEAR(static_cast<double>(found.tears[k]), static_cast<double>(tears[k]), 2) << "one next to the limit";
    EXPECT_GT(tears[k], 100U) << "else this says nothing";
  }
}

TEST(Judge, looks_at_each_target_alone_where_it_ends) {
  const test::GltfFixture file(test::still_hills_document(kTargets, kSeed));
  const MeshWeights nothing = read_weights(*file, read_gltf_shading(*file, 0).value()).value();
  const std::vector<std::vector<std::uint32_t>> numbers(kTargets, {0});
  const std::array<Viewer, 1> viewer = {kViewers[0]};
  for (std::size_t k = 0; k < kTargets; ++k) {
    std::vector<double> end(kTargets, 0.0);
    end[k] = 1;
    std::size_t count = 0;
    for (const PoseSet& set : pose_sets(nothing, viewer, numbers, 1000, false))
      for (const PlayedPose& pose : set.poses) count += pose.seen.weights == end ? 1U : 0U;
    EXPECT_EQ(count, 1U) << "target " << k;
  }
}

}  // namespace
}  // namespace chronormal::judge_test
