// Compares the glTF reader with tinygltf and Assimp, on files of other projects. The test is skipped unless the
// variable CHRONORMAL_DATA names the folder of these files.
#include <assimp/scene.h>
#include <gtest/gtest.h>
#include <tiny_gltf.h>

#include <algorithm>
#include <assimp/Importer.hpp>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "io/gltf/gltf_motion.h"

namespace chronormal::gltf_oracle_test {
namespace {

namespace fs = std::filesystem;

template <class T>
double component(const unsigned char* at, bool normalized) {
  T value{};
  std::memcpy(&value, at, sizeof value);
  const double number = static_cast<double>(value);
  return normalized ? std::max(number / static_cast<double>(std::numeric_limits<T>::max()), -1.0) : number;
}

double component(int type, const unsigned char* at, bool normalized) {
  switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return component<std::int8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return component<std::uint8_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return component<std::int16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return component<std::uint16_t>(at, normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      return component<std::uint32_t>(at, normalized);
    default:
      return component<float>(at, false);
  }
}

// Returns all components of an accessor as numbers, from the raw buffers that tinygltf has read.
std::vector<double> numbers(const tinygltf::Model& model, int index) {
  const tinygltf::Accessor& accessor = model.accessors.at(static_cast<std::size_t>(index));
  const auto width =
      static_cast<std::size_t>(tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)));
  const auto size =
      static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType)));
  const auto bytes_at = [&](int view_index, std::size_t offset) {
    const tinygltf::BufferView& view = model.bufferViews.at(static_cast<std::size_t>(view_index));
    return &model.buffers.at(static_cast<std::size_t>(view.buffer)).data.at(view.byteOffset + offset);
  };
  std::vector<double> result(accessor.count * width, 0.0);
  const auto read_element = [&](std::size_t element, const unsigned char* at) {
    for (std::size_t c = 0; c < width; ++c)
      result.at(element * width + c) = component(accessor.componentType, at + c * size, accessor.normalized);
  };
  if (accessor.bufferView >= 0) {
    const std::size_t stride = model.bufferViews.at(static_cast<std::size_t>(accessor.bufferView)).byteStride;
    for (std::size_t i = 0; i < accessor.count; ++i)
      read_element(i, bytes_at(accessor.bufferView, accessor.byteOffset + i * (stride == 0 ? width * size : stride)));
  }
  if (accessor.sparse.isSparse) {
    const auto& sparse = accessor.sparse;
    const auto index_size = static_cast<std::size_t>(
        tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(sparse.indices.componentType)));
    for (std::size_t i = 0; i < static_cast<std::size_t>(sparse.count); ++i) {
      const double element = component(
          sparse.indices.componentType,
          bytes_at(sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset) + i * index_size),
          false);
      read_element(
          static_cast<std::size_t>(element),
          bytes_at(sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset) + i * width * size));
    }
  }
  return result;
}

std::vector<float> floats(const tinygltf::Model& model, const std::map<std::string, int>& attributes,
                          const char* name) {
  const auto found = attributes.find(name);
  if (found == attributes.end()) return {};
  const std::vector<double> values = numbers(model, found->second);
  std::vector<float> result;
  for (const double value : values) result.push_back(static_cast<float>(value));
  return result;
}

class GltfOracle : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("CHRONORMAL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(fs::path(folder) / "gltf")) {
      const std::string extension = entry.path().extension().string();
      if (extension == ".gltf" || extension == ".glb") files_.push_back(entry.path());
    }
    std::sort(files_.begin(), files_.end());
    ASSERT_GE(files_.size(), 10U);
  }
  std::vector<fs::path> files_;
};

void load(const fs::path& path, tinygltf::Model& model) {
  tinygltf::TinyGLTF loader;
  loader.SetImageLoader([](tinygltf::Image*, int, std::string*, std::string*, int, int, const unsigned char*, int,
                           void*) { return true; },
                        nullptr);
  std::string error, warning;
  const bool ok = path.extension() == ".glb" ? loader.LoadBinaryFromFile(&model, &error, &warning, path.string())
                                             : loader.LoadASCIIFromFile(&model, &error, &warning, path.string());
  ASSERT_TRUE(ok) << error;
}

TEST_F(GltfOracle, geometry_is_that_of_tinygltf_bit_for_bit) {
  std::size_t primitives = 0, targets = 0;
  for (const fs::path& path : files_) {
    SCOPED_TRACE(path);
    tinygltf::Model model;
    ASSERT_NO_FATAL_FAILURE(load(path, model));
    const Result<GltfDocument> opened = GltfDocument::open(path.string());
    ASSERT_TRUE(opened.ok()) << opened.error().text();
    const GltfDocument& document = opened.value();
    ASSERT_EQ(document.meshes().size(), model.meshes.size());
    for (std::size_t m = 0; m < model.meshes.size(); ++m) {
      const tinygltf::Mesh& mesh = model.meshes[m];
      EXPECT_EQ(document.meshes()[m].name, mesh.name);
      if (!mesh.weights.empty()) {
        EXPECT_EQ(document.meshes()[m].weights, mesh.weights);
      }
      ASSERT_EQ(document.meshes()[m].primitives.size(), mesh.primitives.size());
      for (std::size_t p = 0; p < mesh.primitives.size(); ++p, ++primitives) {
        const tinygltf::Primitive& primitive = mesh.primitives[p];
        ASSERT_EQ(primitive.mode == -1 ? 4 : primitive.mode, 4) << "only triangles are known to this test";
        const Result<GltfGeometry> read = document.geometry(m, p, {true, true});
        ASSERT_TRUE(read.ok()) << read.error().text();
        const GltfGeometry& geometry = read.value();
        EXPECT_EQ(geometry.positions, floats(model, primitive.attributes, "POSITION"));
        EXPECT_EQ(geometry.normals, floats(model, primitive.attributes, "NORMAL"));
        EXPECT_EQ(geometry.tangents, floats(model, primitive.attributes, "TANGENT"));
        std::vector<std::uint32_t> corners;
        if (primitive.indices >= 0) {
          for (const double index : numbers(model, primitive.indices))
            corners.push_back(static_cast<std::uint32_t>(index));
        } else {
          for (std::uint32_t i = 0; i < geometry.positions.size() / 3; ++i) corners.push_back(i);
        }
        EXPECT_EQ(geometry.corners, corners);
        ASSERT_EQ(geometry.targets.size(), primitive.targets.size());
        for (std::size_t k = 0; k < primitive.targets.size(); ++k, ++targets) {
          EXPECT_EQ(geometry.targets[k].positions, floats(model, primitive.targets[k], "POSITION"));
          EXPECT_EQ(geometry.targets[k].normals, floats(model, primitive.targets[k], "NORMAL"));
          EXPECT_EQ(geometry.targets[k].tangents, floats(model, primitive.targets[k], "TANGENT"));
        }
      }
    }
  }
  std::printf("%zu files, %zu primitives, %zu targets\n", files_.size(), primitives, targets);
  EXPECT_GE(targets, 30U);
}

TEST_F(GltfOracle, animations_are_those_of_tinygltf_bit_for_bit) {
  std::size_t tracks = 0;
  for (const fs::path& path : files_) {
    SCOPED_TRACE(path);
    tinygltf::Model model;
    ASSERT_NO_FATAL_FAILURE(load(path, model));
    const Result<GltfDocument> opened = GltfDocument::open(path.string());
    ASSERT_TRUE(opened.ok()) << opened.error().text();
    ASSERT_EQ(opened.value().animations().size(), model.animations.size());
    for (std::size_t a = 0; a < model.animations.size(); ++a) {
      const tinygltf::Animation& animation = model.animations[a];
      const GltfAnimation& listed = opened.value().animations()[a];
      EXPECT_EQ(listed.name, animation.name);
      EXPECT_EQ(listed.channel_count, animation.channels.size());
      std::size_t t = 0;
      for (std::size_t c = 0; c < animation.channels.size(); ++c) {
        const tinygltf::AnimationChannel& channel = animation.channels[c];
        if (channel.target_path != "weights") continue;
        ASSERT_LT(t, listed.tracks.size());
        const GltfTrack& track = listed.tracks[t];
        const tinygltf::AnimationSampler& sampler = animation.samplers.at(static_cast<std::size_t>(channel.sampler));
        EXPECT_EQ(track.node, static_cast<std::size_t>(channel.target_node));
        EXPECT_EQ(track.channel, c);
        const char* const names[] = {"LINEAR", "STEP", "CUBICSPLINE"};
        EXPECT_EQ(names[static_cast<int>(track.interpolation)], sampler.interpolation);
        const Result<GltfKeys> keys = opened.value().keys(a, t);
        ASSERT_TRUE(keys.ok()) << keys.error().text();
        EXPECT_EQ(keys.value().times, numbers(model, sampler.input));
        EXPECT_EQ(keys.value().values, numbers(model, sampler.output));
        ++t;
        ++tracks;
      }
      EXPECT_EQ(t, listed.tracks.size());
    }
  }
  std::printf("%zu tracks\n", tracks);
  EXPECT_GE(tracks, 40U);
}

TEST_F(GltfOracle, every_animation_that_moves_is_a_motion) {
  std::size_t motions = 0;
  for (const fs::path& path : files_) {
    const Result<GltfDocument> document = GltfDocument::open(path.string());
    ASSERT_TRUE(document.ok()) << document.error().text();
    EXPECT_TRUE(read_gltf_mesh(document.value()).ok()) << path;
    for (std::size_t a = 0; a < document.value().animations().size(); ++a) {
      GltfMotionOptions options;
      options.animation = std::to_string(a);
      const Result<GltfMotion> motion = read_gltf_motion(document.value(), options);
      motions += motion.ok() ? 1U : 0U;
      std::size_t most_keys = 0;
      for (const GltfTrack& track : document.value().animations()[a].tracks)
        most_keys = std::max(most_keys, track.key_count);
      EXPECT_EQ(motion.ok(), most_keys > 1) << path << ", animation " << a;
    }
  }
  EXPECT_GE(motions, 20U);
}

TEST_F(GltfOracle, positions_and_targets_are_those_of_assimp_bit_for_bit) {
  std::size_t compared = 0, moved = 0;
  for (const fs::path& path : files_) {
    SCOPED_TRACE(path);
    Assimp::Importer importer;
    const aiScene* const scene = importer.ReadFile(path.string(), 0);
    ASSERT_NE(scene, nullptr) << importer.GetErrorString();
    const Result<GltfDocument> opened = GltfDocument::open(path.string());
    ASSERT_TRUE(opened.ok()) << opened.error().text();
    const GltfDocument& document = opened.value();
    unsigned next = 0;
    for (std::size_t m = 0; m < document.meshes().size(); ++m) {
      for (std::size_t p = 0; p < document.meshes()[m].primitives.size(); ++p) {
        SCOPED_TRACE(std::to_string(m) + " " + std::to_string(p));
        ASSERT_LT(next, scene->mNumMeshes);
        const aiMesh& mesh = *scene->mMeshes[next++];
        const Result<GltfGeometry> geometry = document.geometry(m, p, {});
        ASSERT_TRUE(geometry.ok()) << geometry.error().text();
        const std::vector<float>& base = geometry.value().positions;
        ASSERT_EQ(std::size_t{3} * mesh.mNumVertices, base.size());
        for (std::size_t i = 0; i < base.size(); ++i)
          ASSERT_EQ(mesh.mVertices[i / 3][static_cast<unsigned>(i % 3)], base[i]) << i;
        ASSERT_EQ(std::size_t{3} * mesh.mNumFaces, geometry.value().corners.size());
        for (std::size_t i = 0; i < geometry.value().corners.size(); ++i)
          ASSERT_EQ(mesh.mFaces[i / 3].mIndices[i % 3], geometry.value().corners[i]) << i;
        ++compared;
        ASSERT_EQ(mesh.mNumAnimMeshes, geometry.value().targets.size());
        for (unsigned k = 0; k < mesh.mNumAnimMeshes; ++k) {
          const std::vector<float>& deltas = geometry.value().targets[k].positions;
          ASSERT_EQ(deltas.size(), base.size());
          const aiAnimMesh& target = *mesh.mAnimMeshes[k];
          ASSERT_EQ(target.mNumVertices, mesh.mNumVertices);
          for (std::size_t i = 0; i < base.size(); ++i)
            ASSERT_EQ(target.mVertices[i / 3][static_cast<unsigned>(i % 3)], base[i] + deltas[i]) << k << " " << i;
          ++moved;
        }
      }
    }
    EXPECT_EQ(next, scene->mNumMeshes);
  }
  std::printf("%zu primitives, %zu targets\n", compared, moved);
  EXPECT_GE(compared, 30U);
}

}  // namespace
}  // namespace chronormal::gltf_oracle_test
