// Compares the points at which a bake fits normals with the entries of a std::map, whose keys are pairs of an element
// and a stored normal. The normals are random.
#include "workflow/bake/fits/missing_normals.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <map>
#include <random>
#include <tuple>
#include <vector>

#include "tests/support/bake_fixture.h"

namespace chronormal::missing_normals_test {
namespace {

TEST(MissingNormals, vertices_of_a_point_have_one_element_and_one_stored_normal) {
  constexpr unsigned kSeed = 20261128;
  std::cout << "  from seed " << kSeed << '\n';
  std::mt19937 random(kSeed);
  const test::GltfFixture file(test::still_hills_document(1, 3));
  const GltfShading shading = read_gltf_shading(*file, 0).value();
  const AuthorTruth truth(shading, Weighting::kArea);
  const NormalTerms terms(shading, truth);
  const std::vector<double> largest(shading.groups.size(), 1.0);
  for (int draw = 0; draw < 40; ++draw) {
    // Many normals are equal, and many differ in one coordinate. Some normals are zero, so they have no direction.
    std::vector<float> normals(shading.normals.size());
    for (float& c : normals) c = static_cast<float>(random() % 3) - 1;
    const RightNormals rights(shading, terms, normals, largest);
    std::vector<std::uint32_t> vertices, element_of_vertex;
    for (std::uint32_t v = 0; 3 * v < normals.size(); ++v) {
      element_of_vertex.push_back(static_cast<std::uint32_t>(random() % 3));
      if (random() % 5 != 0) vertices.push_back(v);
    }
    std::map<std::tuple<std::uint32_t, float, float, float>, PointVertices> of_normals;
    for (const std::uint32_t v : vertices) {
      const float x = normals[3 * v], y = normals[3 * v + 1], z = normals[3 * v + 2];
      if (x != 0 || y != 0 || z != 0) of_normals[{element_of_vertex[v], x, y, z}].push_back(v);
    }
    std::vector<PointVertices> expected;
    for (const auto& [key, of_one] : of_normals) expected.push_back(of_one);
    std::sort(expected.begin(), expected.end());
    std::shuffle(vertices.begin(), vertices.end(), random);
    EXPECT_EQ(points_of(rights, vertices, element_of_vertex), expected) << draw;
  }
}

}  // namespace
}  // namespace chronormal::missing_normals_test
