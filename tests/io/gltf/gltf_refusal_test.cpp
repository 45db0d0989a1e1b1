// Checks that the reader refuses files that the glTF specification forbids, with a JSON pointer to the fault. Each line
// of the table of cases makes one fault in a valid document.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "fuzz/gltf_invariants.h"
#include "tests/support/gltf_builder.h"

namespace chronormal::gltf_refusal_test {
namespace {

using test::GltfBuilder, test::GltfFixture;
using Json = nlohmann::json;

// Makes a document with everything that the reader checks. The accessors are: 0 positions, 1 indices, 2 and 3 targets,
// 4 and 5 times and values of keys, 6 a sparse target that replaces target 3, 7 normals. The buffer views are in the
// order in which the accessors were made.
GltfBuilder rich_document() {
  GltfBuilder builder = test::quad_document();
  builder.add_track<float>(builder.add_animation("a"), 0, {0, 1, 2}, {0, 0, 1, 0, 0, 1});
  const std::size_t sparse = builder.add_accessor_over(std::nullopt, "VEC3", 5126, 4);
  builder.make_sparse<std::uint16_t, float>(sparse, {1, 3}, {1, 2, 3, 4, 5, 6});
  builder.json["meshes"][0]["weights"] = {0, 0};
  builder.json["nodes"][0]["weights"] = {0, 0};
  auto& primitive = builder.json["meshes"][0]["primitives"][0];
  primitive["targets"][1]["POSITION"] = sparse;
  primitive["attributes"]["NORMAL"] = builder.add_strided<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 16);
  return builder;
}

struct Case {
  const char* label;
  void (*edit)(GltfBuilder& file);
  const char* pointer;  // the place of the error must begin with this
};

// Returns the first error from reading everything in a file, or "" if there is no error.
std::string first_error(const GltfBuilder& builder) {
  const GltfFixture file(builder.gltf());
  const fuzz::GltfReading reading = fuzz::read_all_of(file.result(), "a.gltf", std::size_t{1} << 24);
  EXPECT_EQ(reading.broken, "");
  return reading.errors.empty() ? "" : reading.errors.front().text();
}

void expect_refusals(const std::vector<Case>& cases) {
  for (const Case& c : cases) {
    SCOPED_TRACE(c.label);
    GltfBuilder builder = rich_document();
    c.edit(builder);
    const std::string error = first_error(builder);
    EXPECT_TRUE(error.starts_with("a.gltf, " + std::string(c.pointer))) << (error.empty() ? "no error" : error);
  }
}

TEST(GltfRefusals, document_that_is_to_be_broken_is_right) { EXPECT_EQ(first_error(rich_document()), ""); }

TEST(GltfRefusals, of_the_asset_and_of_lists) {
  expect_refusals({
      {"no asset", [](GltfBuilder& f) { f.json.erase("asset"); }, "/"},
      {"no version", [](GltfBuilder& f) { f.json["asset"].erase("version"); }, "/asset"},
      {"version 1", [](GltfBuilder& f) { f.json["asset"]["version"] = "1.0"; }, "/asset/version"},
      {"version 3", [](GltfBuilder& f) { f.json["asset"]["version"] = "3.0"; }, "/asset/version"},
      {"version is a number", [](GltfBuilder& f) { f.json["asset"]["version"] = 2.0; }, "/asset/version"},
      {"later minimum", [](GltfBuilder& f) { f.json["asset"]["minVersion"] = "2.1"; }, "/asset/minVersion"},
      {"empty meshes", [](GltfBuilder& f) { f.json["meshes"] = Json::array(); }, "/meshes"},
      {"empty nodes", [](GltfBuilder& f) { f.json["nodes"] = Json::array(); }, "/nodes"},
      {"empty accessors", [](GltfBuilder& f) { f.json["accessors"] = Json::array(); }, "/accessors"},
      {"empty views", [](GltfBuilder& f) { f.json["bufferViews"] = Json::array(); }, "/bufferViews"},
      {"empty animations", [](GltfBuilder& f) { f.json["animations"] = Json::array(); }, "/animations"},
      {"meshes are an object", [](GltfBuilder& f) { f.json["meshes"] = Json::object(); }, "/meshes"},
      {"a mesh is a number", [](GltfBuilder& f) { f.json["meshes"][0] = 4; }, "/meshes/0"},
      {"extensions are no list", [](GltfBuilder& f) { f.json["extensionsRequired"] = "a"; }, "/extensionsRequired"},
      {"an extension is no name", [](GltfBuilder& f) { f.json["extensionsRequired"] = {4}; }, "/extensionsRequired/0"},
  });
}

TEST(GltfRefusals, of_buffers_and_views) {
  expect_refusals({
      {"no byteLength", [](GltfBuilder& f) { f.json["bufferViews"][0].erase("byteLength"); }, "/bufferViews/0"},
      {"no buffer", [](GltfBuilder& f) { f.json["bufferViews"][0].erase("buffer"); }, "/bufferViews/0"},
      {"other buffer", [](GltfBuilder& f) { f.json["bufferViews"][0]["buffer"] = 1; }, "/bufferViews/0/buffer"},
      {"empty view", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteLength"] = 0; }, "/bufferViews/0/byteLength"},
      {"too long", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteLength"] = 1 << 20; }, "/bufferViews/0"},
      {"too far", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteOffset"] = 1 << 20; }, "/bufferViews/0"},
      {"overflow", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteOffset"] = ~std::uint64_t{0} - 3; },
       "/bufferViews/0"},
      {"stride 0", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteStride"] = 0; }, "/bufferViews/0/byteStride"},
      {"stride 14", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteStride"] = 14; }, "/bufferViews/0/byteStride"},
      {"stride 256", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteStride"] = 256; }, "/bufferViews/0/byteStride"},
      {"stride below the element", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteStride"] = 8; }, "/"},
      {"stride beyond the view", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteStride"] = 20; }, "/"},
      {"strided indices", [](GltfBuilder& f) { f.json["bufferViews"][1]["byteStride"] = 4; }, "/"},
      {"text for a number", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteLength"] = "48"; },
       "/bufferViews/0/byteLength"},
      {"a broken number", [](GltfBuilder& f) { f.json["bufferViews"][0]["byteLength"] = 47.5; },
       "/bufferViews/0/byteLength"},
      {"buffer without length",
       [](GltfBuilder& f) {
         f.json["buffers"] = {Json::object(), Json::object()};
       },
       "/buffers/1"},
      {"buffer of length 0",
       [](GltfBuilder& f) {
         f.json["buffers"] = {Json::object(), {{"byteLength", 0}}};
       },
       "/buffers/1/byteLength"},
  });
}

TEST(GltfRefusals, of_accessors) {
  expect_refusals({
      {"no count", [](GltfBuilder& f) { f.json["accessors"][0].erase("count"); }, "/accessors/0"},
      {"no type", [](GltfBuilder& f) { f.json["accessors"][0].erase("type"); }, "/accessors/0"},
      {"no componentType", [](GltfBuilder& f) { f.json["accessors"][0].erase("componentType"); }, "/accessors/0"},
      {"count 0", [](GltfBuilder& f) { f.json["accessors"][0]["count"] = 0; }, "/accessors/0/count"},
      {"too many", [](GltfBuilder& f) { f.json["accessors"][0]["count"] = 5; }, "/"},
      {"far too many", [](GltfBuilder& f) { f.json["accessors"][0]["count"] = std::uint64_t{1} << 62; }, "/"},
      {"unknown type", [](GltfBuilder& f) { f.json["accessors"][0]["type"] = "VEC5"; }, "/accessors/0/type"},
      {"unknown component", [](GltfBuilder& f) { f.json["accessors"][0]["componentType"] = 5124; },
       "/accessors/0/componentType"},
      {"no such view", [](GltfBuilder& f) { f.json["accessors"][0]["bufferView"] = 99; }, "/accessors/0/bufferView"},
      {"misaligned", [](GltfBuilder& f) { f.json["accessors"][2]["byteOffset"] = 2; }, "/"},
      {"misaligned view", [](GltfBuilder& f) { f.json["bufferViews"][2]["byteOffset"] = 2; }, "/"},
      {"offset beyond the view", [](GltfBuilder& f) { f.json["accessors"][2]["byteOffset"] = 4; }, "/"},
      {"offset without view", [](GltfBuilder& f) { f.json["accessors"][6]["byteOffset"] = 4; }, "/accessors/6"},
      {"floats that are normalised", [](GltfBuilder& f) { f.json["accessors"][0]["normalized"] = true; }, "/"},
      {"normalised is a number", [](GltfBuilder& f) { f.json["accessors"][0]["normalized"] = 1; },
       "/accessors/0/normalized"},
      {"positions without a view and too many",
       [](GltfBuilder& f) {
         f.json["accessors"][0].erase("bufferView");
         f.json["accessors"][0]["count"] = 1U << 30;
       },
       "/"},
  });
}

TEST(GltfRefusals, of_sparse_accessors) {
  expect_refusals({
      {"no count", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"].erase("count"); }, "/accessors/6/sparse"},
      {"no indices", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"].erase("indices"); }, "/accessors/6/sparse"},
      {"no values", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"].erase("values"); }, "/accessors/6/sparse"},
      {"count 0", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"]["count"] = 0; }, "/accessors/6/sparse/count"},
      {"more than there are", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"]["count"] = 5; },
       "/accessors/6/sparse"},
      {"more than the views have", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"]["count"] = 3; }, "/"},
      {"float indices", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"]["indices"]["componentType"] = 5126; },
       "/accessors/6/sparse/indices/componentType"},
      {"signed indices", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"]["indices"]["componentType"] = 5122; },
       "/accessors/6/sparse/indices/componentType"},
      {"no index view", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"]["indices"]["bufferView"] = 77; },
       "/accessors/6/sparse/indices/bufferView"},
      {"no value view", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"]["values"].erase("bufferView"); },
       "/accessors/6/sparse/values"},
      {"indices too far", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"]["indices"]["byteOffset"] = 2; }, "/"},
      {"misaligned indices", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"]["indices"]["byteOffset"] = 1; },
       "/"},
      {"values too far", [](GltfBuilder& f) { f.json["accessors"][6]["sparse"]["values"]["byteOffset"] = 4; }, "/"},
      {"the same twice",
       [](GltfBuilder& f) {
         f.make_sparse<std::uint16_t, float>(6, {2, 2}, {1, 2, 3, 4, 5, 6});
       },
       "/accessors/6"},
      {"descending",
       [](GltfBuilder& f) {
         f.make_sparse<std::uint16_t, float>(6, {3, 1}, {1, 2, 3, 4, 5, 6});
       },
       "/accessors/6"},
      {"beyond the end",
       [](GltfBuilder& f) {
         f.make_sparse<std::uint16_t, float>(6, {3, 4}, {1, 2, 3, 4, 5, 6});
       },
       "/accessors/6"},
      {"not a number",
       [](GltfBuilder& f) {
         f.make_sparse<std::uint16_t, float>(6, {1}, {1, 2, NAN});
       },
       "/accessors/6"},
  });
}

TEST(GltfRefusals, of_meshes_and_primitives) {
  expect_refusals({
      {"no primitives", [](GltfBuilder& f) { f.json["meshes"][0].erase("primitives"); }, "/meshes/0"},
      {"empty primitives", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"] = Json::array(); },
       "/meshes/0/primitives"},
      {"no attributes", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0].erase("attributes"); },
       "/meshes/0/primitives/0"},
      {"attributes are a list", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["attributes"] = {1}; },
       "/meshes/0/primitives/0/attributes"},
      {"mode 7", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["mode"] = 7; },
       "/meshes/0/primitives/0/mode"},
      {"no such positions", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 55; },
       "/meshes/0/primitives/0/attributes/POSITION"},
      {"no such indices", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["indices"] = 55; },
       "/meshes/0/primitives/0/indices"},
      {"no such target", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["targets"][0]["POSITION"] = 55; },
       "/meshes/0/primitives/0/targets/0/POSITION"},
      {"empty targets", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["targets"] = Json::array(); },
       "/meshes/0/primitives/0/targets"},
      {"a target is a number", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["targets"][0] = 2; },
       "/meshes/0/primitives/0/targets/0"},
      {"indices for positions",
       [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["attributes"]["POSITION"] = 1; }, "/"},
      {"positions for indices", [](GltfBuilder& f) { f.json["meshes"][0]["primitives"][0]["indices"] = 0; }, "/"},
      {"positions of four",
       [](GltfBuilder& f) {
         f.json["accessors"][0]["type"] = "VEC4";
         f.json["accessors"][0]["count"] = 3;
       },
       "/"},
      {"whole numbers without the extension", [](GltfBuilder& f) { f.json["accessors"][0]["componentType"] = 5123; },
       "/"},
      {"signed indices", [](GltfBuilder& f) { f.json["accessors"][1]["componentType"] = 5122; }, "/"},
      {"fewer normals", [](GltfBuilder& f) { f.json["accessors"][7]["count"] = 3; },
       "/meshes/0/primitives/0/attributes/NORMAL"},
      {"fewer deltas", [](GltfBuilder& f) { f.json["accessors"][2]["count"] = 3; },
       "/meshes/0/primitives/0/targets/0/POSITION"},
      {"target without base",
       [](GltfBuilder& f) {
         f.json["meshes"][0]["primitives"][0]["attributes"].erase("NORMAL");
         f.json["meshes"][0]["primitives"][0]["targets"][0]["NORMAL"] = 2;
       },
       "/meshes/0/primitives/0/targets/0/NORMAL"},
      {"unequal targets",
       [](GltfBuilder& f) {
         f.add_primitive(0, GltfBuilder::primitive(0, 1, {{{"POSITION", 2}}}));
       },
       "/meshes/0/primitives/1"},
      {"no targets beside targets", [](GltfBuilder& f) { f.add_primitive(0, GltfBuilder::primitive(0, 1)); },
       "/meshes/0/primitives/1"},
      {"three weights",
       [](GltfBuilder& f) {
         f.json["meshes"][0]["weights"] = {0, 0, 0};
       },
       "/meshes/0/weights"},
      {"no weights in the list", [](GltfBuilder& f) { f.json["meshes"][0]["weights"] = Json::array(); },
       "/meshes/0/weights"},
      {"a weight is a text",
       [](GltfBuilder& f) {
         f.json["meshes"][0]["weights"] = {0, "1"};
       },
       "/meshes/0/weights/1"},
  });
}

TEST(GltfRefusals, of_numbers_in_buffers) {
  expect_refusals({
      {"corner beyond the vertices", [](GltfBuilder& f) { f.buffer[48] = 4; }, "/"},
      {"primitive restart", [](GltfBuilder& f) { f.buffer[48] = f.buffer[49] = '\xFF'; }, "/"},
      {"infinite position", [](GltfBuilder& f) { f.buffer.replace(0, 4, test::bytes_of<float>({INFINITY})); }, "/"},
      {"no number", [](GltfBuilder& f) { f.buffer.replace(44, 4, test::bytes_of<float>({NAN})); }, "/"},
      {"infinite delta", [](GltfBuilder& f) { f.buffer.replace(60, 4, test::bytes_of<float>({-INFINITY})); }, "/"},
  });
}

TEST(GltfRefusals, of_nodes) {
  expect_refusals({
      {"no such mesh", [](GltfBuilder& f) { f.json["nodes"][0]["mesh"] = 3; }, "/nodes/0/mesh"},
      {"no such child", [](GltfBuilder& f) { f.json["nodes"][0]["children"] = {4}; }, "/nodes/0/children"},
      {"own child", [](GltfBuilder& f) { f.json["nodes"][0]["children"] = {0}; }, "/nodes/0"},
      {"no children in the list", [](GltfBuilder& f) { f.json["nodes"][0]["children"] = Json::array(); },
       "/nodes/0/children"},
      {"the same child twice",
       [](GltfBuilder& f) {
         f.add("nodes", {{"children", {0, 0}}});
       },
       "/nodes/"},
      {"two parents",
       [](GltfBuilder& f) {
         f.add("nodes", {{"children", {0}}});
         f.add("nodes", {{"children", {0}}});
       },
       "/nodes/"},
      {"ring",
       [](GltfBuilder& f) {
         f.json["nodes"][0]["children"] = {1};
         f.add("nodes", {{"children", {2}}});
         f.add("nodes", {{"children", {0}}});
       },
       "/nodes/"},
      {"weights of no mesh",
       [](GltfBuilder& f) {
         f.add("nodes", {{"weights", {1}}});
       },
       "/nodes/1/weights"},
      {"one weight", [](GltfBuilder& f) { f.json["nodes"][0]["weights"] = {1}; }, "/nodes/0/weights"},
  });
}

TEST(GltfRefusals, of_animations) {
  expect_refusals({
      {"no channels", [](GltfBuilder& f) { f.json["animations"][0].erase("channels"); }, "/animations/0"},
      {"empty channels", [](GltfBuilder& f) { f.json["animations"][0]["channels"] = Json::array(); },
       "/animations/0/channels"},
      {"no samplers", [](GltfBuilder& f) { f.json["animations"][0].erase("samplers"); }, "/animations/0"},
      {"no target", [](GltfBuilder& f) { f.json["animations"][0]["channels"][0].erase("target"); },
       "/animations/0/channels/0"},
      {"no path", [](GltfBuilder& f) { f.json["animations"][0]["channels"][0]["target"].erase("path"); },
       "/animations/0/channels/0/target"},
      {"no such node", [](GltfBuilder& f) { f.json["animations"][0]["channels"][0]["target"]["node"] = 9; },
       "/animations/0/channels/0/target/node"},
      {"node without mesh",
       [](GltfBuilder& f) {
         f.json["nodes"][0].erase("mesh");
         f.json["nodes"][0].erase("weights");
       },
       "/animations/0/channels/0"},
      {"no such sampler", [](GltfBuilder& f) { f.json["animations"][0]["channels"][0]["sampler"] = 9; },
       "/animations/0/channels/0/sampler"},
      {"no sampler", [](GltfBuilder& f) { f.json["animations"][0]["channels"][0].erase("sampler"); },
       "/animations/0/channels/0"},
      {"no input", [](GltfBuilder& f) { f.json["animations"][0]["samplers"][0].erase("input"); },
       "/animations/0/samplers/0"},
      {"no output", [](GltfBuilder& f) { f.json["animations"][0]["samplers"][0].erase("output"); },
       "/animations/0/samplers/0"},
      {"no such output", [](GltfBuilder& f) { f.json["animations"][0]["samplers"][0]["output"] = 88; },
       "/animations/0/samplers/0/output"},
      {"unknown interpolation",
       [](GltfBuilder& f) { f.json["animations"][0]["samplers"][0]["interpolation"] = "EASE"; },
       "/animations/0/samplers/0/interpolation"},
      {"spline with the values of lines",
       [](GltfBuilder& f) { f.json["animations"][0]["samplers"][0]["interpolation"] = "CUBICSPLINE"; }, "/"},
      {"fewer values", [](GltfBuilder& f) { f.json["accessors"][5]["count"] = 5; }, "/"},
      {"times are vectors", [](GltfBuilder& f) { f.json["animations"][0]["samplers"][0]["input"] = 2; },
       "/animations/0/samplers/0/input"},
      {"values are vectors", [](GltfBuilder& f) { f.json["animations"][0]["samplers"][0]["output"] = 2; },
       "/animations/0/samplers/0/output"},
      {"times do not ascend",
       [](GltfBuilder& f) {
         f.add_track<float>(f.add_animation("b"), 0, {0, 2, 1}, {0, 0, 0, 0, 0, 0});
       },
       "/"},
      {"the same time twice",
       [](GltfBuilder& f) {
         f.add_track<float>(f.add_animation("b"), 0, {0, 1, 1}, {0, 0, 0, 0, 0, 0});
       },
       "/"},
      {"negative time",
       [](GltfBuilder& f) {
         f.add_track<float>(f.add_animation("b"), 0, {-1, 0}, {0, 0, 0, 0});
       },
       "/"},
      {"infinite time",
       [](GltfBuilder& f) {
         f.add_track<float>(f.add_animation("b"), 0, {0, INFINITY}, {0, 0, 0, 0});
       },
       "/"},
      {"infinite weight",
       [](GltfBuilder& f) {
         f.add_track<float>(f.add_animation("b"), 0, {0, 1}, {0, 0, INFINITY, 0});
       },
       "/"},
  });
}

TEST(GltfRefusals, of_json_name_a_byte) {
  const auto error_of = [](const std::string& bytes) { return GltfFixture(bytes).error(); };
  EXPECT_TRUE(error_of("").starts_with("a.gltf, byte 0: ")) << error_of("");
  EXPECT_TRUE(error_of("{\"asset\": nothing}").starts_with("a.gltf, byte 11: ")) << error_of("{\"asset\": nothing}");
  EXPECT_TRUE(error_of("{} {}").starts_with("a.gltf, byte ")) << error_of("{} {}");
  EXPECT_EQ(error_of("{\"asset\": 1e999}"), "a.gltf, /asset: the value must be an object, not a number");
  EXPECT_TRUE(error_of("{\"a\": \"\xFF\"}").starts_with("a.gltf, byte ")) << error_of("{\"a\": \"\xFF\"}");
  EXPECT_TRUE(error_of("[]").starts_with("a.gltf")) << error_of("[]");
  const std::string deep = "{\"asset\": " + std::string(256, '[');
  EXPECT_TRUE(error_of(deep).starts_with("a.gltf, byte 265: ")) << error_of(deep);
  const std::string allowed =
      R"({"asset": {"version": "2.0"}, "extras": )" + std::string(255, '[') + std::string(255, ']') + "}";
  EXPECT_EQ(error_of(allowed), "");
}

TEST(GltfRefusals, of_containers_name_a_byte) {
  const std::string good = test::quad_document().glb();
  const auto with_word = [&](std::size_t at, std::uint32_t value) {
    return GltfFixture(std::string(good).replace(at, 4, test::bytes_of<std::uint32_t>({value}))).error();
  };
  ASSERT_EQ(GltfFixture(good).error(), "");
  EXPECT_TRUE(with_word(4, 1).starts_with("a.gltf, byte 4: "));
  EXPECT_TRUE(with_word(8, 12).starts_with("a.gltf, byte 8: "));
  EXPECT_TRUE(with_word(12, 0xFFFFFFF0).starts_with("a.gltf, byte 12: "));
  EXPECT_TRUE(with_word(16, 0x12345678).starts_with("a.gltf, byte 16: "));
  EXPECT_NE(
      GltfFixture(
          test::glb_bytes(
              R"({"asset": {"version": "2.0"}, "buffers": [{"byteLength": 4}], "bufferViews": [{"buffer": 0, "byteLength": 4}], "accessors": [{"bufferView": 0, "componentType": 5121, "count": 1, "type": "VEC3"}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}]})",
              std::nullopt))
              .error() +
          first_error(GltfBuilder()),
      "");
}

TEST(GltfRefusals, a_bin_chunk_has_the_bytes_of_the_buffer_and_at_most_three_more) {
  const GltfBuilder builder = test::quad_document();
  const auto error_with = [&builder](std::size_t declared) {
    Json document = Json::parse(builder.gltf());
    document["buffers"][0] = {{"byteLength", declared}};
    const GltfFixture file(test::glb_bytes(document.dump(), builder.buffer));
    if (!file.ok()) return file.error();
    const Result<GltfGeometry> geometry = file->geometry(0, 0, {});
    return geometry ? "" : geometry.error().text();
  };
  const std::size_t size = builder.buffer.size();
  ASSERT_EQ(size % 4, 0U);
  EXPECT_EQ(error_with(size), "");
  EXPECT_EQ(error_with(size + 1), "a.gltf, /buffers/0/byteLength: the BIN chunk has only " + std::to_string(size) +
                                      " bytes, but byteLength is " + std::to_string(size + 1) +
                                      "; export the file again");
}

}  // namespace
}  // namespace chronormal::gltf_refusal_test
