#include "io/gltf/gltf_skin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_compressed.h"

namespace chronormal::gltf_skin_test {
namespace {

using test::GltfBuilder;
using test::GltfFixture;
using Json = GltfBuilder::Json;

// A quad with two targets in node 0, whose skin has the joints 1 and 2. The weights of vertex v are 1 - v / 4 for joint
// 1 and v / 4 for joint 2.
struct Skinned {
  GltfBuilder builder = test::quad_document();

  Skinned() {
    builder.add("nodes", {{"translation", {1, 2, 3}}, {"children", {2}}});
    builder.add("nodes", {{"scale", {2, 2, 2}}});
    joints(builder.add_accessor("VEC4", std::vector<std::uint8_t>{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}));
    weights(builder.add_accessor(
        "VEC4", std::vector<float>{1, 0, 0, 0, 0.75F, 0.25F, 0, 0, 0.5F, 0.5F, 0, 0, 0.25F, 0.75F, 0, 0}));
    builder.json["nodes"][0]["skin"] = builder.add("skins", {{"joints", {1, 2}}});
  }
  [[nodiscard]] Json& attributes() { return builder.json["meshes"][0]["primitives"][0]["attributes"]; }
  void joints(std::size_t accessor) { attributes()["JOINTS_0"] = accessor; }
  void weights(std::size_t accessor) { attributes()["WEIGHTS_0"] = accessor; }
  void binds(const std::vector<float>& numbers, std::size_t count) {
    builder.json["skins"][0]["inverseBindMatrices"] =
        builder.add_accessor_over(builder.add_view(test::bytes_of(numbers)), "MAT4", 5126, count);
  }
  // Adds a channel that animates a property of node 1, with keys at 0 s and 1 s.
  void animate(const char* path, const std::vector<float>& values, const char* type) {
    if (!builder.json.contains("animations")) builder.add_animation("");
    const std::size_t input = builder.add_accessor("SCALAR", std::vector<float>{0, 1});
    const std::size_t output = builder.add_accessor(type, values);
    Json& animation = builder.json["animations"][0];
    animation["channels"].push_back(
        {{"sampler", animation["samplers"].size()}, {"target", {{"node", 1}, {"path", path}}}});
    animation["samplers"].push_back({{"input", input}, {"output", output}});
  }
};

// Reads the skin of all parts of a file, as an audit does. Returns the joints of the vertices with their weights, or an
// error.
Result<std::vector<JointShare>> read(const GltfFixture& fixture, std::vector<std::size_t>* first = nullptr,
                                     std::optional<std::size_t> animation = std::nullopt) {
  EXPECT_TRUE(fixture.ok()) << fixture.error();
  const Result<GltfSkin> skin = GltfSkin::read(*fixture, 0, animation);
  if (!skin) return skin.error();
  std::vector<std::size_t> begins;
  std::vector<JointShare> shares;
  const Status status = skin.value().read_shares(*fixture, 0, 0, first != nullptr ? *first : begins, shares);
  if (!status) return status.error();
  return shares;
}

// Returns the joints of each vertex and their weights in percent, as text: "0 100; 0 75, 1 25; ...". A semicolon
// separates vertices.
std::string shares_of(const Skinned& skinned) {
  const GltfFixture fixture(skinned.builder);
  std::vector<std::size_t> first;
  const Result<std::vector<JointShare>> shares = read(fixture, &first);
  if (!shares) return shares.error().text();
  first.push_back(shares.value().size());
  std::string text;
  for (std::size_t v = 0; v + 1 < first.size(); ++v) {
    for (std::size_t i = first[v]; i < first[v + 1]; ++i) {
      const auto hundredths = static_cast<int>(std::lround(100 * shares.value()[i].share));
      text += (i > first[v] ? ", "
               : v > 0      ? "; "
                            : "") +
              std::to_string(shares.value()[i].joint) + " " + std::to_string(hundredths);
    }
  }
  return text;
}

std::string error_of(const Skinned& skinned, std::optional<std::size_t> animation = std::nullopt) {
  const Result<std::vector<JointShare>> shares = read(GltfFixture(skinned.builder), nullptr, animation);
  return shares ? "" : shares.error().text();
}

// ---- contents that a file may have

constexpr const char* kExpected = "0 100; 0 75, 1 25; 0 50, 1 50; 0 25, 1 75";

TEST(GltfSkin, joints_and_weights_may_be_of_every_type_that_the_format_has) {
  EXPECT_EQ(shares_of(Skinned()), kExpected);
  Skinned wide;
  wide.joints(
      wide.builder.add_accessor("VEC4", std::vector<std::uint16_t>{0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0}));
  EXPECT_EQ(shares_of(wide), kExpected);
  Skinned bytes;
  bytes.weights(bytes.builder.add_accessor(
      "VEC4", std::vector<std::uint8_t>{255, 0, 0, 0, 191, 64, 0, 0, 128, 127, 0, 0, 64, 191, 0, 0}, true));
  EXPECT_EQ(shares_of(bytes), kExpected);
  Skinned shorts;
  shorts.weights(shorts.builder.add_accessor(
      "VEC4", std::vector<std::uint16_t>{65535, 0, 0, 0, 49151, 16384, 0, 0, 32768, 32767, 0, 0, 16384, 49151, 0, 0},
      true));
  EXPECT_EQ(shares_of(shorts), kExpected);
  Skinned strided;
  strided.weights(
      strided.builder.add_strided("VEC4", std::vector<float>{1, 0, 0, 0, 3, 1, 0, 0, 2, 2, 0, 0, 1, 3, 0, 0}, 20));
  EXPECT_EQ(shares_of(strided), kExpected);  // weights need not sum to 1
  // A sparse accessor may have no buffer view, so all values come from its sparse arrays.
  Skinned sparse;
  sparse.weights(sparse.builder.add_accessor_over(std::nullopt, "VEC4", 5126, 4));
  sparse.builder.make_sparse(sparse.builder.json["accessors"].size() - 1, std::vector<std::uint8_t>{0, 1, 2, 3},
                             std::vector<float>{1, 0, 0, 0, 3, 1, 0, 0, 2, 2, 0, 0, 1, 3, 0, 0});
  EXPECT_EQ(shares_of(sparse), kExpected);
}

TEST(GltfSkin, sets_add_up_and_a_vertex_without_weights_follows_its_first_joint) {
  Skinned skinned;
  skinned.joints(
      skinned.builder.add_accessor("VEC4", std::vector<std::uint8_t>{1, 1, 9, 0, 1, 9, 0, 0, 0, 9, 0, 0, 1, 9, 0, 0}));
  skinned.weights(
      skinned.builder.add_accessor("VEC4", std::vector<float>{1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0}));
  skinned.attributes()["JOINTS_1"] =
      skinned.builder.add_accessor("VEC4", std::vector<std::uint8_t>{0, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0});
  skinned.attributes()["WEIGHTS_1"] =
      skinned.builder.add_accessor("VEC4", std::vector<float>{1, 0, 0, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 3, 0, 0});
  EXPECT_EQ(shares_of(skinned), "1 25, 1 50, 0 25; 1 100; 1 100; 1 25, 0 75");
}

TEST(GltfSkin, joints_stand_below_their_parents_and_inverse_binds_may_be_missing) {
  Skinned skinned;
  const auto pose = [&] {
    const GltfFixture fixture(skinned.builder);
    return GltfSkin::read(*fixture, 0, std::nullopt).value().pose(0, false);
  };
  EXPECT_EQ(pose()[1](Vec3d{1, 0, 0}), (Vec3d{3, 2, 3}));
  skinned.binds({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 5, 0, 0, 1}, 2);
  EXPECT_EQ(pose()[0](Vec3d{1, 0, 0}), (Vec3d{2, 2, 3}));
  EXPECT_EQ(pose()[1](Vec3d{1, 0, 0}), (Vec3d{13, 2, 3}));
}

TEST(GltfSkin, a_rotation_that_has_no_length_turns_nothing) {
  Skinned skinned;
  skinned.animate("rotation", {0, 0, 0, 0, 0, 0, 0, 0}, "VEC4");
  const GltfFixture fixture(skinned.builder);
  const Result<GltfSkin> skin = GltfSkin::read(*fixture, 0, 0);
  ASSERT_TRUE(skin.ok());
  EXPECT_TRUE(skin.value().moves());
  for (const double time : {0.0, 0.5, 1.0})
    EXPECT_EQ(skin.value().pose(time, false)[0](Vec3d{1, 0, 0}), (Vec3d{2, 2, 3}));
}

// ---- faults of a file, which are reported only to code that reads the skin

struct Case {
  std::string error;
  std::function<void(Skinned&)> spoil;
};

TEST(GltfSkin, every_fault_is_told_with_its_place) {
  const std::string attributes = "a.gltf, /meshes/0/primitives/0/attributes";
  const std::vector<Case> cases = {
      {"a.gltf, /nodes/0/skin: the node refers to a skin that does not exist, since the file has only 1 skin; export "
       "the file again",
       [](Skinned& s) { s.builder.json["nodes"][0]["skin"] = 1; }},
      {"a.gltf, /nodes/0/skin: the node refers to a skin that does not exist, since the file has only 1 skin; export "
       "the file again",
       [](Skinned& s) { s.builder.json["nodes"][0]["skin"] = "first"; }},
      {"a.gltf, /nodes/0/skin: the node refers to a skin that does not exist, since the file has only 0 skins; export "
       "the file again",
       [](Skinned& s) { s.builder.json["skins"] = Json::object(); }},
      {"a.gltf, /skins/0: the value must be an object, not a number",
       [](Skinned& s) { s.builder.json["skins"] = {5}; }},
      {"a.gltf, /skins/0/joints: the skin has no joints; export the file again",
       [](Skinned& s) { s.builder.json["skins"][0].erase("joints"); }},
      {"a.gltf, /skins/0/joints/1: the index is 3, but must be less than the number of nodes, which is 3",
       [](Skinned& s) {
         s.builder.json["skins"][0]["joints"] = {1, 3};
       }},
      {"a.gltf, /skins/0/inverseBindMatrices: the accessor has 1 matrix, but the skin has 2 joints; export the file "
       "again",
       [](Skinned& s) {
         s.binds({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1}, 1);
       }},
      {"a.gltf, /skins/0/inverseBindMatrices: accessor 0 must be of type MAT4; export the file again",
       [](Skinned& s) { s.builder.json["skins"][0]["inverseBindMatrices"] = 0; }},
      {"a.gltf, /accessors/6: the last row of matrix 1 must be 0, 0, 0, 1; export the file again",
       [](Skinned& s) {
         s.binds({1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 2}, 2);
       }},
      {"a.gltf, /accessors/6: element 0 is NaN or infinite; export the file again",
       [](Skinned& s) {
         std::vector<float> numbers(32, 0);
         numbers[5] = INFINITY;
         s.binds(numbers, 2);
       }},
      {attributes + ": the mesh has a skin, but its vertices have no joints (JOINTS_0); export the file again",
       [](Skinned& s) {
         s.attributes().erase("JOINTS_0");
         s.attributes().erase("WEIGHTS_0");
       }},
      {attributes + ": the primitive has JOINTS_0 but no WEIGHTS_0; export the file again",
       [](Skinned& s) { s.attributes().erase("WEIGHTS_0"); }},
      {attributes + ": the primitive has WEIGHTS_0 but no JOINTS_0; export the file again",
       [](Skinned& s) { s.attributes().erase("JOINTS_0"); }},
      {attributes + "/JOINTS_0: vertex 2 follows joint 2, but the skin has only 2 joints; export the file again",
       [](Skinned& s) {
         s.joints(
             s.builder.add_accessor("VEC4", std::vector<std::uint8_t>{0, 1, 9, 9, 0, 1, 0, 0, 0, 2, 0, 0, 0, 1, 0, 0}));
       }},
      {attributes +
           "/JOINTS_0: accessor 5 has a componentType that glTF does not allow for this use; export the file again",
       [](Skinned& s) { s.joints(5); }},
      {attributes + "/JOINTS_0: accessor 0 must be of type VEC4; export the file again",
       [](Skinned& s) { s.joints(0); }},
      {attributes +
           "/WEIGHTS_0: accessor 4 has a componentType that glTF does not allow for this use; export the file again",
       [](Skinned& s) { s.weights(4); }},
      {attributes + "/WEIGHTS_0: the accessor has 1 element, but the primitive has 4 positions; export the file again",
       [](Skinned& s) {
         s.weights(s.builder.add_accessor("VEC4", std::vector<float>{1, 0, 0, 0}));
       }},
      {attributes + "/WEIGHTS_0: accessor 5 ends beyond buffer view 5, which has 64 bytes; export the file again",
       [](Skinned& s) { s.builder.json["accessors"][5]["count"] = std::uint64_t{1} << 52U; }},
      {"a.gltf, /accessors/5: element 3 is NaN or infinite; export the file again",
       [](Skinned& s) { s.builder.buffer.replace(s.builder.buffer.size() - 4, 4, "\xFF\xFF\xFF\x7F", 4); }},
  };
  for (const Case& spoilt : cases) {
    Skinned skinned;
    spoilt.spoil(skinned);
    EXPECT_EQ(error_of(skinned), spoilt.error);
    // A fault in the skin must not keep the reader from reading the mesh.
    const GltfFixture fixture(skinned.builder);
    ASSERT_TRUE(fixture.ok()) << spoilt.error;
    EXPECT_TRUE(fixture->geometry(0, 0, {true, true}).ok()) << spoilt.error;
  }
}

TEST(GltfSkin, every_fault_of_an_animation_of_joints_is_told_with_its_place) {
  const std::string sampler = "a.gltf, /animations/0/samplers/0";
  const std::vector<Case> cases = {
      {sampler +
           "/output: the output has 3 values for 2 keys, but must have 1 for each key; export the animation again",
       [](Skinned& s) {
         s.animate("scale", {1, 1, 1, 1, 1, 1, 1, 1, 1}, "VEC3");
       }},
      {sampler + "/output: accessor 7 must be of type VEC4; export the file again",
       [](Skinned& s) {
         s.animate("rotation", {1, 1, 1, 1, 1, 1}, "VEC3");
       }},
      {sampler + "/interpolation: interpolation must be LINEAR, STEP or CUBICSPLINE; export the file again",
       [](Skinned& s) {
         s.animate("scale", {1, 1, 1, 1, 1, 1}, "VEC3");
         s.builder.json["animations"][0]["samplers"][0]["interpolation"] = "CURVED";
       }},
      {"a.gltf, /animations/0/channels/1/target: another channel of this animation drives the scale of the same node; "
       "remove one of the two channels",
       [](Skinned& s) {
         s.animate("scale", {1, 1, 1, 1, 1, 1}, "VEC3");
         s.animate("scale", {1, 1, 1, 1, 1, 1}, "VEC3");
       }},
      {"a.gltf, /animations/0/channels/0/target: the channel drives the translation of a node that has a matrix; give "
       "the node translation, rotation and scale instead",
       [](Skinned& s) {
         s.animate("translation", {1, 1, 1, 1, 1, 1}, "VEC3");
         s.builder.json["nodes"][1].erase("translation");
         s.builder.json["nodes"][1]["matrix"] = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
       }},
      {"a.gltf, /animations/0/channels/0/target/node: the index is 9, but must be less than the number of nodes, which "
       "is 3",
       [](Skinned& s) {
         s.animate("scale", {1, 1, 1, 1, 1, 1}, "VEC3");
         s.builder.json["animations"][0]["channels"][0]["target"]["node"] = 9;
       }},
      {"a.gltf, /accessors/6: the time of key 1 is not later than the time of the key before; export the animation "
       "again",
       [](Skinned& s) {
         s.animate("scale", {1, 1, 1, 1, 1, 1}, "VEC3");
         s.builder.json["animations"][0]["samplers"][0]["input"] = 6;
         const std::size_t view = s.builder.json["accessors"][6]["bufferView"];
         const std::size_t at = s.builder.json["bufferViews"][view]["byteOffset"];
         s.builder.buffer.replace(at + 4, 4, std::string(4, '\0'));
       }},
      {"a.gltf, /accessors/7: element 0 is NaN or infinite; export the file again",
       [](Skinned& s) {
         s.animate("scale", {INFINITY, 1, 1, 1, 1, 1}, "VEC3");
       }},
  };
  for (const Case& spoilt : cases) {
    Skinned skinned;
    spoilt.spoil(skinned);
    EXPECT_EQ(error_of(skinned, 0), spoilt.error);
    EXPECT_EQ(error_of(skinned), "") << spoilt.error;  // without the animation, the skin can be read
  }
}

TEST(GltfSkin, channels_that_move_no_joint_or_point_elsewhere_are_passed_over) {
  Skinned skinned;
  skinned.animate("scale", {1, 1, 1, 1, 1, 1}, "VEC3");
  Json& target = skinned.builder.json["animations"][0]["channels"][0]["target"];
  const std::vector<Json> targets = {
      {{"node", 0}, {"path", "scale"}},
      {{"path", "scale"}},
      {{"node", 1}, {"path", "colour"}},
      {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", "/materials/0/alphaCutoff"}}}}}},
      {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/x/scale"}}}}}},
      {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/9/scale"}}}}}},
      {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", "/nodes/1"}}}}}},
  };
  for (const Json& other : targets) {
    target = other;
    const GltfFixture fixture(skinned.builder);
    ASSERT_TRUE(fixture.ok()) << fixture.error();
    const Result<GltfSkin> skin = GltfSkin::read(*fixture, 0, 0);
    ASSERT_TRUE(skin.ok()) << skin.error().text();
    EXPECT_FALSE(skin.value().moves()) << other;
  }
}

// ---- skins in KHR_draco_mesh_compression

const std::vector<std::uint8_t> kDracoJoints = {0, 1, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0};
const std::vector<float> kDracoWeights = {1, 0, 0, 0, 0.75F, 0.25F, 0, 0, 0.5F, 0.5F, 0, 0, 0.25F, 0.25F, 0, 0};

// A quad whose positions, joints and weights are in a Draco mesh. The encoder may reorder vertices, so the test
// identifies them by their positions.
struct Compressed {
  Skinned skinned;

  explicit Compressed(test::DracoOrder order = test::DracoOrder::kKept,
                      const test::DracoShares& shares = {kDracoJoints, kDracoWeights}) {
    const Json node = skinned.builder.json["nodes"];
    skinned.builder = GltfBuilder();
    const std::vector<std::uint32_t> corners = {0, 1, 2, 0, 2, 3};
    const std::size_t lift = skinned.builder.add_positions(std::vector<float>(12, 1.0F));
    Json primitive =
        test::draco_primitive(skinned.builder, test::draco_mesh(test::kQuad, corners, order, {}, 0, shares), 4, 6,
                              false, {{{"POSITION", lift}}});
    primitive["attributes"]["JOINTS_0"] = skinned.builder.add_accessor_over(std::nullopt, "VEC4", 5121, 4);
    primitive["attributes"]["WEIGHTS_0"] = skinned.builder.add_accessor_over(std::nullopt, "VEC4", 5126, 4);
    Json& ids = primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"];
    ids["JOINTS_0"] = 1;
    ids["WEIGHTS_0"] = 2;
    skinned.builder.add_mesh(primitive);
    skinned.builder.json["nodes"] = node;
    skinned.builder.json["skins"] = {{{"joints", {1, 2}}}};
  }
  [[nodiscard]] Json& ids() {
    return skinned.builder.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"];
  }
};

// Returns the weights of joint 0 and joint 1 for a vertex. Computes these weights from the data of the file, without
// code of src/.
std::pair<double, double> expected_shares(std::size_t vertex) {
  std::pair<double, double> of_joints;
  double sum = 0;
  for (std::size_t i = 4 * vertex; i < 4 * vertex + 4; ++i) {
    (kDracoJoints[i] == 0 ? of_joints.first : of_joints.second) += static_cast<double>(kDracoWeights[i]);
    sum += static_cast<double>(kDracoWeights[i]);
  }
  return {of_joints.first / sum, of_joints.second / sum};
}

TEST(GltfSkin, joints_and_weights_of_a_compressed_mesh_are_those_that_were_coded) {
  for (const test::DracoOrder order : {test::DracoOrder::kKept, test::DracoOrder::kFree}) {
    Compressed compressed(order);
    const GltfFixture fixture(compressed.skinned.builder);
    std::vector<std::size_t> first;
    const Result<std::vector<JointShare>> shares = read(fixture, &first);
    ASSERT_TRUE(shares.ok()) << shares.error().text();
    ASSERT_EQ(first.size(), 4U);
    first.push_back(shares.value().size());
    const std::vector<float> positions = fixture->geometry(0, 0, {}).value().positions;
    for (std::size_t v = 0; v < 4; ++v) {
      std::size_t coded = 0;  // index that the vertex at this position had before compression
      while (!std::equal(positions.begin() + static_cast<std::ptrdiff_t>(3 * v),
                         positions.begin() + static_cast<std::ptrdiff_t>(3 * v + 3),
                         test::kQuad.begin() + static_cast<std::ptrdiff_t>(3 * coded)))
        ASSERT_LT(++coded, 4U);
      std::pair<double, double> found;
      for (std::size_t i = first[v]; i < first[v + 1]; ++i)
        (shares.value()[i].joint == 0 ? found.first : found.second) += shares.value()[i].share;
      EXPECT_EQ(found, expected_shares(coded)) << v;
    }
  }
}

TEST(GltfSkin, what_the_compressed_mesh_does_not_hold_is_in_accessors_as_ever) {
  Compressed compressed(test::DracoOrder::kKept, {kDracoJoints, {}});
  compressed.ids().erase("WEIGHTS_0");
  compressed.skinned.weights(compressed.skinned.builder.add_accessor("VEC4", kDracoWeights));
  const Result<std::vector<JointShare>> shares = read(GltfFixture(compressed.skinned.builder));
  ASSERT_TRUE(shares.ok()) << shares.error().text();
  ASSERT_EQ(shares.value().size(), 7U);
  EXPECT_EQ(shares.value()[1].joint, 1U);
  EXPECT_EQ(shares.value()[1].share, 0.75);
}

TEST(GltfSkin, faults_of_a_compressed_mesh_have_their_place) {
  const std::string extension = "a.gltf, /meshes/0/primitives/0/extensions/KHR_draco_mesh_compression";
  Compressed other;
  other.ids()["WEIGHTS_0"] = 7;
  EXPECT_EQ(
      error_of(other.skinned),
      extension +
          "/attributes/WEIGHTS_0: the Draco data lack an attribute that the primitive declares; export the file again");
  Compressed swapped;
  std::swap(swapped.ids()["JOINTS_0"], swapped.ids()["WEIGHTS_0"]);
  EXPECT_EQ(
      error_of(swapped.skinned),
      extension +
          "/attributes/JOINTS_0: the Draco data lack an attribute that the primitive declares; export the file again");
  Compressed no_id;
  no_id.ids()["JOINTS_0"] = "one";
  EXPECT_NE(error_of(no_id.skinned).find(extension + "/attributes/JOINTS_0: "), std::string::npos);
  Skinned no_mesh;
  const std::size_t view = no_mesh.builder.add_view("none of this is a mesh");
  no_mesh.builder.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", 0}, {"JOINTS_0", 1}, {"WEIGHTS_0", 2}}}};
  EXPECT_TRUE(error_of(no_mesh).starts_with(
      extension + ": the Draco data cannot be decoded; export the file again. The decoder says: "))
      << error_of(no_mesh);
}

// If many sets of weights share an accessor, the sets take few bytes of the file but much memory.
TEST(GltfSkin, many_sets_are_held_to_the_limit_of_expansion) {
  Skinned skinned;
  constexpr std::size_t kVertices = 4096, kSets = 120;
  skinned.builder = GltfBuilder();
  const std::size_t places = skinned.builder.add_accessor_over(std::nullopt, "VEC3", 5126, kVertices);
  const std::size_t joints = skinned.builder.add_accessor_over(std::nullopt, "VEC4", 5121, kVertices);
  const std::size_t weights = skinned.builder.add_accessor_over(std::nullopt, "VEC4", 5126, kVertices);
  skinned.builder.add_node(
      skinned.builder.add_mesh(GltfBuilder::primitive(places, std::nullopt, {{{"POSITION", places}}})));
  skinned.builder.json["nodes"][0]["skin"] = skinned.builder.add("skins", {{"joints", {0}}});
  for (std::size_t n = 0; n < kSets; ++n) {
    skinned.attributes()["JOINTS_" + std::to_string(n)] = joints;
    skinned.attributes()["WEIGHTS_" + std::to_string(n)] = weights;
  }
  GltfOptions options;
  options.max_expansion = 1;
  const Result<std::vector<JointShare>> found = read(GltfFixture(skinned.builder.glb(), std::nullopt, options));
  ASSERT_FALSE(found.ok());
  EXPECT_EQ(found.error().place, "a.gltf, /meshes/0/primitives/0/attributes");
  EXPECT_NE(found.error().message.find("--max-expansion"), std::string::npos) << found.error().message;
  options.max_expansion = 100000;
  EXPECT_EQ(read(GltfFixture(skinned.builder.glb(), std::nullopt, options)).value().size(), kVertices);
}

}  // namespace
}  // namespace chronormal::gltf_skin_test
