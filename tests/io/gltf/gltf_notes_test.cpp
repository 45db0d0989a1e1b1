// Checks that the reader skips an invalid part of a file with a note if no other part needs it, and that a strict
// reader refuses the file.
#include <gtest/gtest.h>

#include <cstdint>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "fuzz/gltf_invariants.h"
#include "io/gltf/gltf_motion.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_documents.h"
#include "tests/support/random_edits.h"

namespace chronormal::gltf_notes_test {
namespace {

using test::GltfBuilder, test::GltfFixture;
using Json = nlohmann::json;

struct Case {
  const char* label;
  void (*edit)(GltfBuilder& file);
  const char* pointer;  // the place of the note must begin with this
};

// Makes a document with a quad, two targets, and an animation of the two weights.
GltfBuilder animated() {
  GltfBuilder builder = test::quad_document();
  builder.add_track<float>(builder.add_animation("a"), 0, {0, 1, 2}, {0, 0, 1, 0, 0, 1});
  return builder;
}

GltfFixture lenient(const GltfBuilder& builder) { return GltfFixture(builder.gltf(), std::nullopt, {}); }

const std::vector<Case> kCases = {
    {"an empty target",
     [](GltfBuilder& f) {
       f.json["meshes"][0]["primitives"][0]["targets"].push_back(Json::object());
       f.json["animations"] = Json::array({f.json["animations"][0]});
       f.json.erase("animations");
     },
     "/meshes/0/primitives/0/targets/2"},
    {"a primitive without targets",
     [](GltfBuilder& f) {
       Json primitive = f.json["meshes"][0]["primitives"][0];
       primitive.erase("targets");
       f.json["meshes"][0]["primitives"].push_back(primitive);
     },
     "/meshes/0/primitives/1/targets"},
    {"the first primitive without targets",
     [](GltfBuilder& f) {
       Json primitive = f.json["meshes"][0]["primitives"][0];
       primitive.erase("targets");
       f.json["meshes"][0]["primitives"].insert(f.json["meshes"][0]["primitives"].begin(), primitive);
     },
     "/meshes/0/primitives/0/targets"},
    {"a primitive with one target of two",
     [](GltfBuilder& f) {
       Json primitive = f.json["meshes"][0]["primitives"][0];
       primitive["targets"].erase(1);
       f.json["meshes"][0]["primitives"].push_back(primitive);
     },
     "/meshes/0/primitives/1/targets"},
    {"an unused accessor of no elements",
     [](GltfBuilder& f) {
       f.add("accessors", {{"componentType", 5126}, {"count", 0}, {"type", "VEC3"}});
     },
     "/accessors/6/count"},
    {"normalised floats nobody reads",
     [](GltfBuilder& f) {
       const std::size_t a =
           f.add("accessors", {{"componentType", 5126}, {"count", 4}, {"type", "VEC2"}, {"normalized", true}});
       f.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = a;
     },
     "/accessors/6/normalized"},
    {"an unused view beyond its buffer",
     [](GltfBuilder& f) {
       f.add("bufferViews", {{"buffer", 0}, {"byteLength", 1 << 30}});
     },
     "/bufferViews/6"},
    {"a lamp without a rotation",
     [](GltfBuilder& f) {
       f.add("nodes", {{"name", "lamp"}, {"rotation", {0, 0, 0, 0}}});
     },
     "/nodes/1/rotation"},
    {"a spline of one key beside a good track",
     [](GltfBuilder& f) {
       const std::size_t other = f.add_node(0);
       const std::size_t a = f.add_animation("b");
       f.add_track<float>(a, other, {0}, {0, 0, 0, 0, 0, 0}, "CUBICSPLINE");
     },
     "/animations/1/samplers/0/input"},
    {"a bad channel in an animation with a good one",
     [](GltfBuilder& f) {
       f.json["animations"][0]["channels"].push_back({{"sampler", 7}, {"target", {{"node", 0}, {"path", "weights"}}}});
     },
     "/animations/0/channels/1/target"},
    {"weights for a node without targets",
     [](GltfBuilder& f) {
       f.add("nodes", {{"name", "empty"}});
       f.json["animations"][0]["channels"].push_back({{"sampler", 0}, {"target", {{"node", 1}, {"path", "weights"}}}});
     },
     "/animations/0/channels/1/target/node"},
    {"an animation without samplers",
     [](GltfBuilder& f) {
       f.add("animations", {{"name", "none"}});
     },
     "/animations/1"},
    {"times that do not ascend",
     [](GltfBuilder& f) {
       f.add_track<float>(f.add_animation("b"), 0, {0, 1, 1}, {0, 0, 1, 0, 0, 1});
     },
     "/accessors/6"},
    {"EXT_mesh_gpu_instancing",
     [](GltfBuilder& f) {
       f.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] = 2;
       f.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
     },
     "/extensionsRequired/0"},
    {"VRMC_vrm",
     [](GltfBuilder& f) {
       f.json["extensions"]["VRMC_vrm"] = Json::object();
       f.json["extensionsRequired"] = {"VRMC_vrm"};
     },
     "/extensionsRequired/0"},
    {"KHR_node_visibility", [](GltfBuilder& f) { f.json["extensionsRequired"] = {"KHR_node_visibility"}; },
     "/extensionsRequired/0"},
    {"an extension of points",
     [](GltfBuilder& f) {
       f.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"mode", 0}}}}});
       f.json["meshes"][1]["primitives"][0]["extensions"]["KHR_gaussian_splatting"] = Json::object();
       f.json["extensionsRequired"] = {"KHR_gaussian_splatting"};
     },
     "/extensionsRequired/0"},
    {"an extension of lines",
     [](GltfBuilder& f) {
       f.json["meshes"].push_back({{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"mode", 3}}}}});
       f.json["meshes"][1]["primitives"][0]["extensions"]["KHR_gaussian_splatting"] = Json::object();
       f.json["extensionsRequired"] = {"KHR_gaussian_splatting"};
     },
     "/extensionsRequired/0"},
    {"an extension that nobody has heard of",
     [](GltfBuilder& f) {
       f.json["extensionsRequired"] = {"FOO_bar"};
       f.json["scenes"] = {{{"extensions", {{"FOO_bar", 1}}}}};
     },
     "/extensionsRequired/0"},
};

TEST(GltfNotes, a_part_that_nobody_needs_is_passed_over_with_a_note_and_refused_strictly) {
  for (const Case& c : kCases) {
    SCOPED_TRACE(c.label);
    GltfBuilder builder = animated();
    c.edit(builder);
    const GltfFixture strict(builder.gltf()), file = lenient(builder);
    const fuzz::GltfReading strictly = fuzz::read_all_of(strict.result(), "a.gltf", std::size_t{1} << 24);
    EXPECT_FALSE(strictly.errors.empty());
    ASSERT_TRUE(file.ok()) << file.error();
    const std::string place = "a.gltf, " + std::string(c.pointer);
    ASSERT_EQ(file->notes().size(), 1U);
    EXPECT_TRUE(file->notes()[0].place.starts_with(place)) << file->notes()[0].text();
    if (!strictly.errors.empty()) {
      EXPECT_EQ(strictly.errors.front().place, file->notes()[0].place);
    }
    const fuzz::GltfReading reading = fuzz::read_all_of(file.result(), "a.gltf", std::size_t{1} << 24);
    EXPECT_EQ(reading.broken, "");
    // An animation whose parts are all skipped keeps its index, but reading this animation is an error.
    for (const Error& error : reading.errors)
      EXPECT_NE(error.message.find("drives no morph targets"), std::string::npos) << error.text();
    // The targets can still be read without the animation.
    const Result<GltfMotion> motion = read_gltf_motion(*file, {});
    ASSERT_TRUE(motion.ok()) << motion.error().text();
    EXPECT_GE(motion.value().motion.segments.size(), 2U);
  }
}

TEST(GltfNotes, what_the_geometry_needs_is_an_error) {
  const auto error_of = [](void (*edit)(GltfBuilder&)) {
    GltfBuilder builder = animated();
    edit(builder);
    return lenient(builder).error();
  };
  EXPECT_NE(error_of([](GltfBuilder& f) { f.json["accessors"][0]["count"] = 0; }).find("/accessors/0/count"),
            std::string::npos);
  EXPECT_NE(error_of([](GltfBuilder& f) { f.json["bufferViews"][0]["byteLength"] = 0; }).find("/bufferViews/0"),
            std::string::npos);
  EXPECT_NE(error_of([](GltfBuilder& f) {
              f.json["nodes"][0]["rotation"] = {0, 0, 0, 0};
            }).find("/nodes/0/rotation"),
            std::string::npos);
  // If the reader uses a part of the file, an unknown extension of that part may change the meaning of the part, and is
  // therefore an error.
  for (const char* const pointer : {"/meshes/0/primitives/0", "/meshes/0", "/accessors/0", "/bufferViews/0",
                                    "/buffers/0", "/animations/0/samplers/0"}) {
    GltfBuilder builder = animated();
    builder.json["meshes"][0]["primitives"][0]["mode"] = 4;
    builder.json["buffers"] = Json::array({Json::object()});
    builder.json[Json::json_pointer(pointer)]["extensions"]["FOO_packed"] = Json::object();
    builder.json["extensionsRequired"] = {"FOO_packed"};
    EXPECT_NE(lenient(builder).error().find("/extensionsRequired/0: the file requires the extension FOO_packed, which "
                                            "is not supported; export the file without it"),
              std::string::npos)
        << pointer << lenient(builder).error();
  }
}

TEST(GltfNotes, khr_meshopt_compression_is_decoded_where_it_can_be_and_named_where_not) {
  GltfBuilder builder = test::meshopt_document();
  for (Json& view : builder.json["bufferViews"]) {
    if (!view.contains("extensions")) continue;
    view["extensions"]["KHR_meshopt_compression"] = view["extensions"]["EXT_meshopt_compression"];
    view["extensions"].erase("EXT_meshopt_compression");
  }
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"KHR_meshopt_compression"};
  const GltfFixture file(builder.gltf());
  ASSERT_TRUE(file.ok()) << file.error();
  EXPECT_EQ(file->geometry(0, 0, {}).value().positions, test::kQuad);
  // The first byte of a compressed array is the version of the codec, which this test increases.
  for (char& byte : builder.buffer)
    if (byte == '\xA0') byte = '\xA1';
  const GltfFixture later(builder.gltf());
  ASSERT_TRUE(later.ok()) << later.error();
  const std::string error = later->geometry(0, 0, {}).error().text();
  EXPECT_NE(error.find("KHR_meshopt_compression"), std::string::npos) << error;
  EXPECT_NE(error.find("gltfpack -c"), std::string::npos) << error;
}

// If a strict reader accepts a file, a lenient reader must give the same result without a note. If only the lenient
// reader accepts a file, the lenient reader must give a note.
TEST(GltfNotes, strict_and_lenient_readers_differ_by_notes_alone) {
  constexpr std::uint32_t kSeed = 5404;
  std::cout << "seed " << kSeed << '\n';
  std::mt19937 random(kSeed);
  std::size_t noted = 0, both = 0;
  for (int round = 0; round < 4000; ++round) {
    GltfBuilder builder = round % 2 == 0 ? animated() : test::sparse_document();
    for (std::size_t c = random() % 3; c > 0; --c) {
      try {
        kCases[random() % kCases.size()].edit(builder);
      } catch (const Json::exception&) {  // an earlier case has removed the member that this case would change
      }
    }
    std::string text = builder.gltf();
    if (random() % 2 == 0) text = test::with_random_edits(std::move(text), random);
    const GltfFixture strict(text), file(text, std::nullopt, {});
    const fuzz::GltfReading strictly = fuzz::read_all_of(strict.result(), "a.gltf", std::size_t{1} << 24),
                            reading = fuzz::read_all_of(file.result(), "a.gltf", std::size_t{1} << 24);
    ASSERT_EQ(reading.broken, "") << text;
    ASSERT_EQ(strictly.broken, "") << text;
    if (strict.ok()) {
      ASSERT_TRUE(file.ok()) << file.error();
    }
    if (!file.ok()) continue;
    if (file->notes().empty()) {
      ++both;
      ASSERT_TRUE(strict.ok()) << strict.error();
      ASSERT_EQ(strictly.errors.size(), reading.errors.size()) << text;
    } else {
      ++noted;
      ASSERT_FALSE(strictly.errors.empty()) << file->notes()[0].text() << text;
      // GltfEdit must be able to write the file again, although the reader gave notes on it.
      ASSERT_TRUE(GltfEdit(*file).bytes("").ok());
    }
  }
  EXPECT_GT(noted, 300U);
  EXPECT_GT(both, 300U);
}

}  // namespace
}  // namespace chronormal::gltf_notes_test
