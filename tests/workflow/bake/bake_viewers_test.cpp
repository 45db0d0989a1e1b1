// Reads a baked file with tinygltf and Assimp. The bake stores arrays of zeros as bytes, as older readers need.
// tests/viewers has tests with other viewers.
#include <assimp/scene.h>
#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <array>
#include <assimp/Importer.hpp>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "tests/support/gltf_builder.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::bake_viewers_test {
namespace {

using Numbers = std::vector<double>;
using Vector = std::array<double, 3>;

Vector vector_at(const Numbers& numbers, std::size_t i) {
  return {numbers.at(3 * i), numbers.at(3 * i + 1), numbers.at(3 * i + 2)};
}

// Returns the sums of the cross products of the two triangles of test::kQuad around each vertex, at these positions.
Numbers quad_normals(const Numbers& places) {
  Numbers sums(places.size(), 0.0);
  for (std::size_t f = 0; f < test::kQuadCorners.size(); f += 3) {
    const Vector a = vector_at(places, test::kQuadCorners[f]), b = vector_at(places, test::kQuadCorners[f + 1]),
                 c = vector_at(places, test::kQuadCorners[f + 2]);
    for (std::size_t k = 0; k < 3; ++k) {
      const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
      const double normal = (b[i] - a[i]) * (c[j] - a[j]) - (b[j] - a[j]) * (c[i] - a[i]);
      for (std::size_t corner = f; corner < f + 3; ++corner) sums[3 * test::kQuadCorners[corner] + k] += normal;
    }
  }
  return sums;
}

double degrees_between(const Vector& a, const Vector& b) {
  const Vector cross = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
  const double dot = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
  return std::atan2(std::hypot(cross[0], cross[1], cross[2]), dot) * 180 / 3.14159265358979323846;
}

// A quad with normals and one target, whose weight goes from 0 to 1. The quad is baked so that arrays of zeros are
// stored as bytes.
class BakedQuad : public ::testing::Test {
 protected:
  void SetUp() override {
    test::GltfBuilder builder;
    const std::size_t base = builder.add_positions(test::kQuad), corners = builder.add_indices(test::kQuadCorners);
    const Numbers sums = quad_normals(Numbers(test::kQuad.begin(), test::kQuad.end()));
    std::vector<float> normals;
    for (std::size_t i = 0; i < sums.size(); ++i) {
      const Vector sum = vector_at(sums, i / 3);
      normals.push_back(static_cast<float>(sums[i] / std::hypot(sum[0], sum[1], sum[2])));
    }
    auto primitive = test::GltfBuilder::primitive(base, corners, {{{"POSITION", builder.add_positions(test::kLift)}}});
    primitive["attributes"]["NORMAL"] = builder.add_positions(normals);
    const std::size_t node = builder.add_node(builder.add_mesh(primitive));
    builder.json["scenes"] = {{{"nodes", {node}}}};
    builder.json["scene"] = 0;
    for (const std::size_t place : {base, std::size_t{2}}) {
      builder.json["accessors"][place]["min"] = {-1, -1, -1};
      builder.json["accessors"][place]["max"] = {4, 4, 4};
    }
    builder.add_track<float>(builder.add_animation("lift"), node, {0, 1}, {0, 1});
    folder_.write("quad.glb", builder.glb());
    const std::string program = kProgram;
    const ProcessResult bake =
        run_shell(program + " bake quad.glb -o baked.glb --encode exact --dense-zeros", folder_.path());
    ASSERT_EQ(bake.exit_code, 0) << bake.err;
    path_ = folder_ / "baked.glb";
  }

  // Checks that base + w deltas[0] + w (1 - w) deltas[1] has the direction of the true normals at some weights w.
  static void expect_exact(const Numbers& base, const std::vector<Numbers>& deltas) {
    ASSERT_EQ(deltas.size(), 2U);
    for (const double w : {0.0, 0.25, 0.5, 1.0}) {
      Numbers places;
      for (std::size_t i = 0; i < test::kQuad.size(); ++i)
        places.push_back(static_cast<double>(test::kQuad[i]) + w * static_cast<double>(test::kLift[i]));
      const Numbers exact = quad_normals(places);
      for (std::size_t v = 0; v < 4; ++v) {
        Vector shown = vector_at(base, v);
        for (std::size_t k = 0; k < 3; ++k)
          shown[k] += w * vector_at(deltas[0], v)[k] + w * (1 - w) * vector_at(deltas[1], v)[k];
        EXPECT_LT(degrees_between(shown, vector_at(exact, v)), 0.01) << "w = " << w << ", vertex " << v;
      }
    }
  }

  test::TemporaryFolder folder_;
  std::string path_;
};

// Returns the floats of an accessor. Fails if the file stores no data for the accessor, or data of another type.
Numbers numbers_of(const tinygltf::Model& model, int index) {
  const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
  EXPECT_GE(accessor.bufferView, 0);
  EXPECT_EQ(accessor.componentType, TINYGLTF_COMPONENT_TYPE_FLOAT);
  const tinygltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView));
  const auto& bytes = model.buffers.at(static_cast<std::size_t>(view.buffer)).data;
  Numbers numbers;
  const std::size_t stride = view.byteStride == 0 ? 3 * sizeof(float) : view.byteStride;
  for (std::size_t i = 0; i < 3 * accessor.count; ++i) {
    const std::size_t offset = view.byteOffset + accessor.byteOffset + i / 3 * stride + i % 3 * sizeof(float);
    float number = 0;
    std::memcpy(&number, &bytes.at(offset), sizeof number);
    numbers.push_back(static_cast<double>(number));
  }
  return numbers;
}

TEST_F(BakedQuad, is_exact_as_tinygltf_reads_it) {
  tinygltf::TinyGLTF loader;
  tinygltf::Model model;
  std::string error, warning;
  ASSERT_TRUE(loader.LoadBinaryFromFile(&model, &error, &warning, path_)) << error;
  EXPECT_EQ(warning, "");
  const tinygltf::Primitive& primitive = model.meshes.at(0).primitives.at(0);
  std::vector<Numbers> deltas;
  for (const auto& target : primitive.targets) {
    deltas.push_back(numbers_of(model, target.at("NORMAL")));
    EXPECT_EQ(numbers_of(model, target.at("POSITION")).size(), test::kQuad.size());
  }
  expect_exact(numbers_of(model, primitive.attributes.at("NORMAL")), deltas);
  EXPECT_EQ(model.animations.at(0).samplers.at(0).interpolation, "CUBICSPLINE");
}

TEST_F(BakedQuad, is_exact_as_assimp_reads_it) {
  Assimp::Importer importer;
  const aiScene* const scene = importer.ReadFile(path_, 0);
  ASSERT_NE(scene, nullptr) << importer.GetErrorString();
  ASSERT_EQ(scene->mNumMeshes, 1U);
  const aiMesh& mesh = *scene->mMeshes[0];
  ASSERT_EQ(mesh.mNumVertices, 4U);
  const auto numbers = [](const aiVector3D* vectors) {
    Numbers result;
    for (unsigned v = 0; v < 4; ++v)
      for (unsigned k = 0; k < 3; ++k) result.push_back(static_cast<double>(vectors[v][k]));
    return result;
  };
  const Numbers base = numbers(mesh.mNormals);
  std::vector<Numbers> deltas;
  for (unsigned t = 0; t < mesh.mNumAnimMeshes; ++t) {
    deltas.push_back(numbers(mesh.mAnimMeshes[t]->mNormals));
    for (std::size_t i = 0; i < base.size(); ++i) deltas.back()[i] -= base[i];
  }
  expect_exact(base, deltas);
  EXPECT_EQ(numbers(mesh.mAnimMeshes[mesh.mNumAnimMeshes - 1]->mVertices), numbers(mesh.mVertices));
}

}  // namespace
}  // namespace chronormal::bake_viewers_test
