#include "chronormal/io/gltf_document.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "fuzz/json_tokens.h"
#include "tests/support/glb_parts.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::gltf_edit_test {
namespace {

using test::bytes_of;
using test::bytes_or_error;
using test::GlbParts;
using test::GltfBuilder;
using test::GltfFixture;
using test::kLift;
using test::kQuad;
using test::read_whole;
using test::take_apart;
using test::TemporaryFolder;
using Json = nlohmann::json;

// Checks that an edit of a GLB file keeps everything else: the JSON beside the changed values, the bytes of the BIN
// chunk, and all further chunks.
void expect_the_rest_unchanged(const std::string& before, const GltfEdit& edit) {
  const GlbParts source = take_apart(before), result = take_apart(bytes_or_error(edit));
  EXPECT_EQ(fuzz::difference_beside(fuzz::JsonTokens(source.json.substr(0, source.json.find_last_of('}') + 1)),
                                    fuzz::JsonTokens(result.json.substr(0, result.json.find_last_of('}') + 1)),
                                    edit.pointers().value()),
            "");
  EXPECT_TRUE(result.bin.starts_with(source.bin));
  EXPECT_EQ(result.rest, source.rest);
}

// A chunk of a type that the specification does not define. Readers must ignore such chunks.
const std::string kUnknownChunk("\x08\0\0\0XTRA12345678", 16);

std::string with_chunk(std::string glb, const std::string& chunk) {
  glb += chunk;
  return glb.replace(8, 4, bytes_of<std::uint32_t>({static_cast<std::uint32_t>(glb.size())}));
}

TEST(GltfEdit, without_changes_writes_the_same_bytes) {
  const std::string glb = test::quad_document().glb();
  const std::vector<std::string> sources = {glb,
                                            with_chunk(glb, kUnknownChunk),
                                            test::glb_bytes(R"({"asset":{"version":"2.0"}}  )", std::nullopt),
                                            test::glb_bytes("{\"asset\":{\"version\":\"2.0\"}}\n\n", "junk"),
                                            test::quad_document().gltf(),
                                            "\xEF\xBB\xBF{\r\n\t\"asset\": {\"version\": \"2.0\"}}\r\n"};
  const TemporaryFolder folder;
  for (const std::string& source : sources) {
    const GltfFixture fixture(source, folder.path());
    ASSERT_TRUE(fixture.ok()) << fixture.error();
    const GltfEdit edit(*fixture);
    EXPECT_TRUE(bytes_or_error(edit) == source);
    EXPECT_TRUE(edit.pointers().value().empty());
    EXPECT_EQ(edit.added_bytes(), 0U);
    const std::string path = folder / (source.starts_with("glTF") ? "out.glb" : "out.gltf");
    EXPECT_TRUE(edit.write(path, true).ok());
    EXPECT_TRUE(read_whole(path) == source);
  }
}

// JSON that would change if a program parsed it and printed it again.
const char* const kNastyJson =
    "{\r\n"
    R"(  "asset" : {"version" : "2.0", "generator" : "caf\u00e9 \ud834\udd1e \"{[,]}\" é", "extras" : 1e400},
	"extras": {"int": 9223372036854775807, "uint": 18446744073709551615, "exact": 9007199254740993, "zero": -0.0,
    "null": null, "array": [], "object": {}, "blank": [ ], "huge": [1e400, -1E+999, 1.0e-999, 123e9223372036854775807, 1e-9223372036854775808], "one": 1.0,
    "digits": 0.1000000000000000055511151231257827, "e": 1E3, "text": "\/\b\u0000\\\" ~ / 
é"},
  "extensionsUsed": ["VENDOR_unknown"], "extensions": {"VENDOR_unknown": {"accessors": [1e400, {"": {}}]}},
  "meshes": [{"name": "m", "weights": [9], "\u0077eights": [0.50, 1e0],
    "primitives": [{"attributes": {"POSITION": 0}, "targets": [ {"POSITION": 0} , {"POSITION": 0}], "targets ": [7]}]}],
  "accessors" : [
    {"bufferView": 0, "componentType": 5126, "count": 3, "type": "VEC3", "min": [0.0, 0, 0], "max": [1.0, 1.00, 0]}
  ],
  "bufferViews": [{"buffer": 0, "byteLength": 36}], "Accessors": [], "accessors ": {},
  "buffers": [ {"byteLength": 40, "name": "\u0062uffer" } ]})"
    "\r\n ";

TEST(GltfEdit, keeps_every_token_and_the_bin_chunk) {
  std::string json = kNastyJson;
  json.replace(json.find('\n', json.find("~ / ")), 1, "\\n");
  const std::string bin = bytes_of<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}) + "tail";
  const std::string source = with_chunk(test::glb_bytes(json, bin), kUnknownChunk);
  const GltfFixture fixture(source);
  ASSERT_TRUE(fixture.ok()) << fixture.error();
  GltfEdit edit(*fixture);
  EXPECT_TRUE(edit.has("/extras/huge/2"));
  EXPECT_FALSE(edit.has("/extras/huge/5"));
  EXPECT_EQ(edit.text("/extensions/VENDOR_unknown/accessors/0"), "1e400");
  EXPECT_EQ(edit.text("/meshes/0/weights"), "[0.50, 1e0]");
  EXPECT_EQ(edit.text("/nodes"), "");

  const std::vector<float> deltas = {0, 0, 1, 0, 0.1F, 0, -2, 0, 0};
  const std::size_t normals = edit.add_vectors(deltas, {.bounds = true});
  const std::size_t zeros = edit.add_vectors(std::vector<float>(9, 0.0F), {.bounds = true});
  EXPECT_EQ(normals, 1U);
  EXPECT_EQ(zeros, 2U);
  edit.set("/meshes/0/primitives/0/attributes/NORMAL", std::to_string(normals));
  for (const char* const target : {"0", "1"})
    edit.set(std::string("/meshes/0/primitives/0/targets/") + target + "/NORMAL", std::to_string(normals));
  edit.append("/meshes/0/primitives/0/targets", R"({"POSITION":2,"NORMAL":1})");
  edit.append("/meshes/0/weights", "0");
  edit.append("/meshes/0/extras/targetNames", "\"a\"");
  edit.append("/meshes/0/extras/targetNames", "\"b\"");
  edit.append("/meshes/0/extras/targetNames", "\"c\"");
  edit.set("/extras/int", "1e400");
  expect_the_rest_unchanged(source, edit);
  EXPECT_EQ(
      edit.pointers().value(),
      (std::vector<std::string>{"/accessors/1", "/accessors/2", "/bufferViews/1", "/buffers/0/byteLength",
                                "/extras/int", "/meshes/0/extras", "/meshes/0/primitives/0/attributes/NORMAL",
                                "/meshes/0/primitives/0/targets/0/NORMAL", "/meshes/0/primitives/0/targets/1/NORMAL",
                                "/meshes/0/primitives/0/targets/2", "/meshes/0/weights/2"}));
  const std::string result = bytes_or_error(edit);
  EXPECT_NE(result.find("\"weights\": [9], \"\\u0077eights\": [0.50, 1e0, 0]"), std::string::npos);
  EXPECT_NE(result.find("{\"targetNames\":[\"a\",\"b\",\"c\"]}"), std::string::npos);
  EXPECT_NE(result.find("1.00, 0]},\n    {\"bufferView\":1,"), std::string::npos) << "indented like its sibling";

  const GltfFixture read(result);
  ASSERT_TRUE(read.ok()) << read.error();
  EXPECT_EQ(read->meshes()[0].target_names.size(), 3U);
  const auto geometry = read->geometry(0, 0, {.shading = true});
  ASSERT_TRUE(geometry.ok()) << geometry.error().text();
  ASSERT_EQ(geometry.value().targets.size(), 3U);
  for (const auto& target : geometry.value().targets) EXPECT_EQ(target.normals, deltas);
  EXPECT_EQ(geometry.value().targets[2].positions, std::vector<float>(9, 0.0F));
}

TEST(GltfEdit, number_beyond_double_is_kept_and_refused_where_it_is_read) {
  const auto error_with = [](const char* pointer, const Json& value) {
    GltfBuilder builder = test::quad_document();
    builder.json[Json::json_pointer(pointer)] = value;
    std::string text = builder.gltf();
    text.replace(text.find("\"?\""), 3, "1e400");
    return GltfFixture(text).error();
  };
  EXPECT_EQ(error_with("/extras", {1, "?", nullptr}), "");
  EXPECT_EQ(error_with("/nodes/0/extras", "?"), "");
  EXPECT_EQ(error_with("/meshes/0/weights", {0, "?"}),
            "a.gltf, /meshes/0/weights/1: the number is too large for a double; use a smaller number");
  EXPECT_EQ(error_with("/nodes/0/scale", {1, "?", 1}),
            "a.gltf, /nodes/0/scale/1: the number is too large for a double; use a smaller number");
  EXPECT_EQ(error_with("/accessors/0/count", "?"),
            "a.gltf, /accessors/0/count: the number is too large for a double; use a smaller number");
  EXPECT_EQ(
      error_with("/meshes/0/primitives/0/attributes/POSITION", "?"),
      "a.gltf, /meshes/0/primitives/0/attributes/POSITION: the number is too large for a double; use a smaller number");
  EXPECT_EQ(error_with("/meshes/0/name", "?"), "a.gltf, /meshes/0/name: the value must be a string, not a number");
}

// Adds an array with the given options to a file, and returns the JSON of the accessor of this array.
Json accessor_of(const std::vector<float>& values, const GltfVectors& options, bool scalars = false) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(std::vector<float>(scalars ? 3 : values.size(), 1.0F));
  builder.add_mesh(GltfBuilder::primitive(base, std::nullopt, {{{"POSITION", base}}}));
  const GltfFixture fixture(builder);
  GltfEdit edit(*fixture);
  const std::size_t index = scalars ? edit.add_scalars(values, options) : edit.add_vectors(values, options);
  EXPECT_EQ(index, 1U);
  if (!scalars) edit.set("/meshes/0/primitives/0/targets/0/POSITION", "1");
  const std::string bytes = bytes_or_error(edit);
  const GltfFixture read(bytes);
  EXPECT_TRUE(read.ok()) << read.error();
  if (!read.ok()) return {};
  if (!scalars) {
    const auto geometry = read->geometry(0, 0, {});
    EXPECT_TRUE(geometry.ok()) << geometry.error().text();
    if (geometry) {
      EXPECT_EQ(geometry.value().targets[0].positions, values);
    }
  }
  const Json json = Json::parse(take_apart(bytes).json);
  for (const Json& view : json["bufferViews"]) EXPECT_EQ(view.value("byteOffset", 0) % 4, 0);
  EXPECT_EQ(json["buffers"][0]["byteLength"], take_apart(bytes).bin.size());
  return json["accessors"][1];
}

TEST(GltfEdit, mostly_zero_vectors_are_sparse_with_the_smallest_indices) {
  const auto with_one = [](std::size_t count, std::size_t element) {
    std::vector<float> values(3 * count, 0.0F);
    values[3 * element + 1] = -2.5F;
    values[2] = 1;
    return values;
  };
  for (const auto& [element, type] :
       std::vector<std::pair<std::size_t, int>>{{1, 5121}, {255, 5121}, {256, 5123}, {65535, 5123}, {65536, 5125}}) {
    const Json accessor = accessor_of(with_one(70000, element), {});
    EXPECT_FALSE(accessor.contains("bufferView"));
    ASSERT_TRUE(accessor.contains("sparse")) << element;
    EXPECT_EQ(accessor["sparse"]["count"], 2);
    EXPECT_EQ(accessor["sparse"]["indices"]["componentType"], type) << element;
  }
  EXPECT_TRUE(accessor_of(with_one(70000, 3), {.dense = true}).contains("bufferView"));
  EXPECT_TRUE(accessor_of(with_one(10, 3), {}).contains("bufferView")) << "sparse would take more";
  std::vector<float> half(3 * 1000, 0.0F);
  for (std::size_t i = 0; i < half.size(); i += 6) half[i] = 1;
  EXPECT_TRUE(accessor_of(half, {}).contains("sparse"));
  for (std::size_t i = 0; i + 300 < half.size(); i += 3) half[i] = 1;
  EXPECT_FALSE(accessor_of(half, {}).contains("sparse")) << "no smaller: indices take bytes too";
}

TEST(GltfEdit, all_zeros_need_no_bytes_unless_dense) {
  const std::vector<float> zeros = {0, 0, 0, 0, -0.0F, 0};
  EXPECT_EQ(accessor_of(zeros, {}), Json::parse(R"({"componentType":5126,"count":2,"type":"VEC3"})"));
  EXPECT_EQ(accessor_of(zeros, {.bounds = true})["min"], Json::parse("[0,0,0]"));
  EXPECT_EQ(accessor_of(zeros, {.dense = true})["bufferView"], 1);
  EXPECT_EQ(accessor_of({0, 0}, {}, true), Json::parse(R"({"componentType":5126,"count":2,"type":"SCALAR"})"));
}

TEST(GltfEdit, bounds_are_those_of_the_floats_and_of_the_zeros_between_them) {
  const auto check = [](const std::vector<float>& values, bool scalars) {
    const Json accessor = accessor_of(values, {.bounds = true}, scalars);
    const std::size_t n = scalars ? 1 : 3;
    ASSERT_EQ(accessor["min"].size(), n);
    ASSERT_EQ(accessor["max"].size(), n);
    for (std::size_t c = 0; c < n; ++c) {
      double low = values[c], high = values[c];
      for (std::size_t i = c; i < values.size(); i += n) {
        low = std::min(low, double{values[i]});
        high = std::max(high, double{values[i]});
      }
      EXPECT_EQ(accessor["min"][c].get<double>(), low);
      EXPECT_EQ(accessor["max"][c].get<double>(), high);
    }
  };
  check({0.1F, -1.0F / 3, 1e-45F, 0.3F, 3.4028235e38F, -1e-38F}, false);
  check({0, 0.1F, 1.0F / 3}, true);
  std::vector<float> sparse(3000, 0.0F);
  for (std::size_t i = 600; i < 660; ++i) sparse[i] = 5.1F;
  check(sparse, false);
}

TEST(GltfEdit, equal_arrays_share_an_accessor) {
  const GltfFixture fixture(test::quad_document());
  GltfEdit edit(*fixture);
  std::vector<float> sparse(3000, 0.0F);
  sparse[7] = 1;
  const std::size_t first = edit.add_vectors(kLift), second = edit.add_vectors(sparse);
  EXPECT_EQ(edit.add_vectors(kLift), first);
  EXPECT_EQ(edit.add_vectors(sparse), second);
  EXPECT_NE(edit.add_vectors(kLift, {.bounds = true}), first);
  EXPECT_NE(edit.add_vectors(sparse, {.dense = true}), second);
  EXPECT_NE(edit.add_scalars(kLift), first) << "12 scalars are no 4 vectors";
  EXPECT_NE(edit.add_vectors(std::vector<float>(6, 0.0F)), edit.add_vectors(std::vector<float>(9, 0.0F)));
}

TEST(GltfEdit, first_arrays_of_a_file_make_its_buffer) {
  for (const bool glb : {false, true}) {
    const std::string json = R"({"asset":{"version":"2.0"}})";
    const std::string source = glb ? with_chunk(test::glb_bytes(json, std::nullopt), kUnknownChunk) : json;
    const GltfFixture fixture(source);
    GltfEdit edit(*fixture);
    EXPECT_EQ(edit.add_vectors(kQuad), 0U);
    edit.append("/meshes", R"({"primitives":[{"attributes":{"POSITION":0}}]})");
    const std::string bytes = bytes_or_error(edit);
    const GltfFixture read(bytes);
    ASSERT_TRUE(read.ok()) << read.error();
    EXPECT_EQ(read->geometry(0, 0, {}).value().positions, kQuad);
    EXPECT_EQ(edit.added_bytes(), 48U);
    EXPECT_EQ(edit.pointers().value(), (std::vector<std::string>{"/accessors", "/bufferViews", "/buffers", "/meshes"}));
    if (glb) {
      EXPECT_EQ(take_apart(bytes).rest, kUnknownChunk);
    }
  }
}

TEST(GltfEdit, change_that_is_not_possible_is_an_error_with_the_pointer) {
  const GltfFixture fixture(test::quad_document());
  const auto error_of = [&](const std::string& pointer, const std::string& json, bool append) {
    GltfEdit edit(*fixture);
    append ? edit.append(pointer, json) : edit.set(pointer, json);
    const Result<std::string> bytes = edit.bytes("");
    EXPECT_FALSE(bytes.ok()) << pointer;
    if (bytes.ok()) return std::string();
    EXPECT_EQ(bytes.error().code, ErrorCode::kInvalidInput);
    EXPECT_EQ(bytes.error().place, "a.gltf, " + pointer);
    EXPECT_FALSE(edit.pointers().ok());
    return bytes.error().message;
  };
  EXPECT_EQ(error_of("/meshes/0/name/x", "1", false),
            "only an object or an array can have a member 'x', and this value is neither; correct the pointer");
  EXPECT_EQ(error_of("/meshes/1", "{}", false), "the array has 1 item, and no item 1; point to an item that exists");
  EXPECT_EQ(error_of("/meshes/0/name", "1", true),
            "a value can only be added to an array, but the pointer leads to another value; point to an array");
  EXPECT_EQ(error_of("meshes", "1", false), "this is not a JSON pointer; write one like /meshes/0/extras");
  EXPECT_EQ(error_of("", "{}", false),
            "the whole document cannot be replaced; point to a member of it, such as /meshes/0/extras");
  for (const char* const pointer : {"/accessors", "/bufferViews", "/buffers"})
    EXPECT_EQ(error_of(pointer, "{}", true),
              "accessors, bufferViews and buffers cannot be changed as JSON; add a new array with add_vectors() or "
              "add_scalars()");
  for (const char* const json : {"", "nothing", "1,2", "\"", "{\"a\":1", "1}", "\"\xFF\"", "\n"})
    EXPECT_TRUE(error_of("/extras", json, false).starts_with("the new value is not valid JSON")) << json;
  EXPECT_TRUE(error_of("/extras", std::string("1\0", 2), false).ends_with("it has a zero byte; remove this byte"));
  EXPECT_TRUE(error_of("/extras",
                       "\xEF\xBB\xBF"
                       "1",
                       false)
                  .ends_with("it begins with a byte order mark; remove this mark"));
  EXPECT_EQ(GltfFixture("\xEF\xBB\xBF\xEF\xBB\xBF" + test::quad_document().gltf()).error(),
            "a.gltf, byte 3: the JSON is not valid: it has a second byte order mark; remove one of the two");
  EXPECT_TRUE(error_of("/extras/\xFF", "1", false).starts_with("the new value is not valid JSON"));
  const auto deep = [](std::size_t levels) { return std::string(levels, '[') + std::string(levels, ']'); };
  EXPECT_EQ(error_of("/extras", deep(256), false), "the new value is nested deeper than 256 levels; nest it less");
  EXPECT_EQ(error_of("/extras", deep(255), true), "the new value is nested deeper than 256 levels; nest it less");
  GltfEdit edit(*fixture);
  edit.set("/extras", deep(255));
  EXPECT_EQ(GltfFixture(bytes_or_error(edit)).error(), "");
}

}  // namespace
}  // namespace chronormal::gltf_edit_test
