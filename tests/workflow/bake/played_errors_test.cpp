// What the choice among forms is made by: the mean, the worst, and what 99.9 % of the errors are below, held against a
// list of all errors that is sorted here; and that a target alone is looked at where it ends.
#include "workflow/bake/judge/played_errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/bake_fixture.h"
#include "workflow/bake/forms/form_poses.h"

namespace chronormal::played_errors_test {
namespace {

constexpr std::size_t kTargets = 3;
constexpr unsigned kSeed = 7;

double degrees_between(const Vec3d& a, const Vec3d& b) {
  const double x = a.y * b.z - a.z * b.y, y = a.z * b.x - a.x * b.z, z = a.x * b.y - a.y * b.x;
  return std::atan2(std::sqrt(x * x + y * y + z * z), a.x * b.x + a.y * b.y + a.z * b.z) * 57.29577951308232;
}

TEST(PlayedErrors, are_those_of_a_sorted_list_of_all_pairs) {
  const test::GltfFixture file(test::still_hills_document(kTargets, kSeed));
  const GltfShading shading = read_gltf_shading(*file, 0).value();
  const AuthorTruth truth(shading, Weighting::kArea);
  const NormalTerms terms(shading, truth);
  const std::vector<double> largest(shading.groups.size(), 1.0);
  const RightNormals rights(shading, terms, shading.normals, largest);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> part(-0.5, 1);
  PoseList poses(400, std::vector<double>(kTargets));
  for (std::vector<double>& pose : poses)
    for (double& weight : pose) weight = part(random);

  // Deltas of any kind.
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < shading.element_of_vertex.size(); ++v) vertices.push_back(v);
  std::vector<VertexVectors> deltas(kTargets);
  std::vector<const VertexVectors*> columns;
  for (VertexVectors& column : deltas) {
    column.vertices = vertices;
    for (std::size_t v = 0; v < vertices.size(); ++v)
      column.vectors.push_back(to_float(Vec3d{part(random), part(random), 0.3 * part(random)}));
    columns.push_back(&column);
  }

  std::vector<double> errors;
  for (const std::vector<double>& pose : poses) {
    const std::vector<Vec3d> normals = rights.of_elements(pose);
    for (const std::uint32_t v : vertices) {
      Vec3d shown = {shading.normals[3 * v], shading.normals[3 * v + 1], shading.normals[3 * v + 2]};
      for (std::size_t k = 0; k < kTargets; ++k) shown = shown + pose[k] * to_double(deltas[k].vectors[v]);
      errors.push_back(degrees_between(shown, rights.of_vertex(v, normals[shading.element_of_vertex[v]])));
    }
  }
  std::sort(errors.begin(), errors.end());
  double sum = 0;
  for (const double error : errors) sum += error;
  const double most = errors[errors.size() - 1 - errors.size() / 1000];

  const ShownErrors found = played_errors(rights, vertices, shading.element_of_vertex, by_vertex(columns, vertices),
                                          seen_through(poses, nullptr));
  EXPECT_EQ(found.judged, errors.size());
  EXPECT_NEAR(found.mean, sum / static_cast<double>(errors.size()), 1e-9);
  EXPECT_NEAR(found.worst, errors.back(), 1e-9);
  EXPECT_GE(found.most, most * (1 - 1e-9));
  EXPECT_LE(found.most, 1.11 * most) << "of a worst of " << errors.back();
  EXPECT_LT(found.most, found.worst) << "else this says nothing";
}

TEST(PlayedErrors, look_at_each_target_alone_where_it_ends) {
  const test::GltfFixture file(test::still_hills_document(kTargets, kSeed));
  const MeshWeights nothing = read_weights(*file, read_gltf_shading(*file, 0).value()).value();
  const PoseList poses = weights_of(played_poses(nothing, {}, kTargets, 1000));
  for (std::size_t k = 0; k < kTargets; ++k) {
    std::vector<double> end(kTargets, 0.0);
    end[k] = 1;
    EXPECT_EQ(std::count(poses.begin(), poses.end(), end), 1) << "target " << k;
  }
}

}  // namespace
}  // namespace chronormal::played_errors_test
