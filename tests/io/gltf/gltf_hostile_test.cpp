// Reads malicious files with huge structures, and the invalid files of other projects in the folder that
// CHRONORMAL_DATA names.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "fuzz/gltf_invariants.h"
#include "tests/support/child_process.h"
#include "tests/support/cpu_time.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_compressed.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::gltf_hostile_test {
namespace {

namespace fs = std::filesystem;
using test::GltfBuilder;
using Json = nlohmann::json;

constexpr std::size_t kMostGrowth = std::size_t{256} << 20;

// Reads a file of any size in a child process. Returns "" or the first error. Fails if reading breaks an invariant, or
// takes more memory than is allowed in addition to the file itself.
std::string read_apart(const std::string& label, const std::string& bytes) {
  const test::ChildRun run = test::run_in_child(120, [&]() -> std::string {
    const Result<GltfDocument> document = GltfDocument::read(bytes, "a.gltf");
    const fuzz::GltfReading reading = fuzz::read_all_of(document, "a.gltf", GltfMotionOptions().most_bytes);
    if (!reading.broken.empty()) return "broken: " + reading.broken;
    if (!reading.errors.empty()) return reading.errors.front().text();
    return reading.no_moves.empty() ? "" : reading.no_moves.front().text();
  });
  EXPECT_TRUE(run.finished) << label << ": " << run.text;
  EXPECT_FALSE(run.text.starts_with("broken")) << label << ": " << run.text;
  if (!test::is_sanitized()) {
    EXPECT_LT(run.peak_growth, kMostGrowth) << label;
  }
  std::printf("%s: %.1f MB of text, %.2f s, %.1f MB of memory: %s\n", label.c_str(),
              static_cast<double>(bytes.size()) / 1e6, run.seconds, static_cast<double>(run.peak_growth) / 1e6,
              run.text.substr(0, 100).c_str());
  return run.text;
}

constexpr const char* kSlow = "under a sanitizer memory is not measured, and this takes a minute";

constexpr const char* kHead = R"({"asset": {"version": "2.0"}, )";

// Makes a document with a chain of nodes, in which each node is the only child of the node before it. The last node has
// the child `back`, unless `back` is empty.
std::string chain(std::size_t count, const std::string& back) {
  std::string text = std::string(kHead) + R"("nodes": [)";
  for (std::size_t i = 0; i + 1 < count; ++i) text += std::string(R"({"children":[)") + std::to_string(i + 1) + "]},";
  return text + (back.empty() ? "{}" : std::string(R"({"children":[)") + back + "]}") + "]}";
}

TEST(GltfHuge, chain_of_a_million_nodes_is_walked_without_recursion) {
  EXPECT_TRUE(read_apart("chain", chain(1000000, "")).starts_with("a.gltf: "));
  EXPECT_TRUE(read_apart("ring", chain(1000000, "0")).starts_with("a.gltf, /nodes/"));
  EXPECT_TRUE(read_apart("lasso", chain(1000000, "500000")).starts_with("a.gltf, /nodes/"));
}

TEST(GltfHuge, nested_arrays_are_refused_at_the_level_that_is_too_deep) {
  const std::string head = std::string(kHead) + R"("extras": )";
  const std::string place = "a.gltf, byte " + std::to_string(head.size() + 255) + ": ";
  EXPECT_TRUE(
      read_apart("arrays", head + std::string(200000, '[') + std::string(200000, ']') + "}").starts_with(place));
  EXPECT_TRUE(read_apart("open arrays", head + std::string(200000, '[')).starts_with(place));
  std::string objects = head;
  for (int i = 0; i < 200000; ++i) objects += R"({"a":)";
  EXPECT_TRUE(read_apart("objects", objects).starts_with("a.gltf, byte "));
  // Brackets inside a string do not count as nested arrays.
  EXPECT_TRUE(read_apart("text", head + "\"\\\"" + std::string(200000, '[') + "\"}").starts_with("a.gltf: "));
}

TEST(GltfHuge, a_million_children_are_read) {
  std::string text = std::string(kHead) + R"("nodes": [{"children": [1)";
  for (int i = 2; i <= 1000000; ++i) text.append(",").append(std::to_string(i));
  text += "]}";
  for (int i = 1; i <= 1000000; ++i) text += ",{}";
  EXPECT_TRUE(read_apart("children", text + "]}").starts_with("a.gltf: "));
  std::string same = std::string(kHead) + R"("nodes": [{"children": [1)";
  for (int i = 0; i < 1000000; ++i) same += ",1";
  EXPECT_TRUE(read_apart("same child", same + "]}, {}]}").starts_with("a.gltf, /nodes/0/children"));
}

TEST(GltfHuge, keys_may_be_there_twice) {
  const std::string good = test::quad_document().gltf();
  EXPECT_EQ(read_apart("twice", std::string("{\"meshes\": [{\"name\": 4}], \"accessors\": 7, ") + good.substr(1)), "");
  const std::string text = read_apart("twice the other way", good.substr(0, good.size() - 1) + ", \"meshes\": 7}");
  EXPECT_TRUE(text.starts_with("a.gltf, /meshes: ")) << text;
  std::string many = "{";
  for (int i = 0; i < 300000; ++i) many += "\"asset\": {\"version\": \"1.0\"}, ";
  EXPECT_EQ(read_apart("often", many + good.substr(1)), "");
}

TEST(GltfHuge, numbers_and_texts_of_a_million_digits) {
  const std::string digits(1000000, '9');
  EXPECT_TRUE(read_apart("digits", std::string(kHead) + "\"extras\": " + digits + "}").starts_with("a.gltf: "));
  EXPECT_TRUE(read_apart("fraction", std::string(kHead) + "\"extras\": 0." + digits + "}").starts_with("a.gltf: "));
  EXPECT_TRUE(read_apart("exponent", std::string(kHead) + "\"extras\": 1e-" + digits + "}").starts_with("a.gltf"));
  EXPECT_TRUE(read_apart("version", std::string(R"({"asset": {"version": ")") + digits + "\"}}")
                  .starts_with("a.gltf, /asset/version: "));
  // If the file requires an unknown extension but does not use it, the reader only gives a note. The error here is that
  // nothing in the file moves.
  EXPECT_TRUE(read_apart("extension", std::string(kHead) + R"("extensionsRequired": [")" + digits + "\"]}")
                  .starts_with("a.gltf: nothing in this file moves"));
}

// Makes a small file that needs much memory: many targets share the same deltas, or have zeros that the file does not
// store.
std::string many_targets(std::size_t vertex_count, std::size_t target_count, bool has_view) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(std::vector<float>(3 * vertex_count, 1.0F));
  const std::size_t zeros = builder.add_accessor_over(std::nullopt, "VEC3", 5126, vertex_count);
  const std::vector<Json> targets(target_count, Json{{"POSITION", has_view ? base : zeros}});
  const std::size_t corners = builder.add_indices<std::uint8_t>({0, 1, 2});
  builder.add_node(builder.add_mesh(GltfBuilder::primitive(base, corners, targets)));
  return builder.glb();
}

TEST(GltfHuge, targets_that_multiply_memory_are_refused_before_it_is_taken) {
  if (test::is_sanitized()) GTEST_SKIP() << kSlow;
  for (const bool has_view : {false, true}) {
    const std::string text = read_apart("targets", many_targets(100000, 20000, has_view));
    EXPECT_TRUE(text.starts_with("a.gltf")) << text;
  }
}

TEST(GltfHuge, positions_that_nothing_backs_are_refused_before_they_are_made) {
  for (const std::uint64_t count : {std::uint64_t{100000000}, std::uint64_t{1} << 31, std::uint64_t{1} << 53}) {
    GltfBuilder builder;
    const std::size_t base = builder.add_accessor_over(std::nullopt, "VEC3", 5126, count);
    builder.add_mesh(GltfBuilder::primitive(base, std::nullopt, {{{"POSITION", base}}}));
    EXPECT_TRUE(read_apart("zeros", builder.gltf()).starts_with("a.gltf, /")) << count;
  }
}

TEST(GltfHuge, keys_that_nothing_backs_are_refused_before_they_are_made) {
  GltfBuilder builder = test::quad_document();
  builder.add_track<float>(builder.add_animation("a"), 0, {0, 1}, {0, 0, 1, 1});
  builder.json["accessors"][4].erase("bufferView");
  builder.json["accessors"][5].erase("bufferView");
  builder.json["accessors"][4]["count"] = std::uint64_t{1} << 40;
  builder.json["accessors"][5]["count"] = std::uint64_t{1} << 41;
  EXPECT_TRUE(read_apart("keys", builder.glb()).starts_with("a.gltf, /"));
}

// Many tracks share the same arrays of key times and values. If the reader copied the arrays for each track, a small
// file would need much memory.
TEST(GltfHuge, tracks_that_share_their_keys_are_refused_before_these_are_copied) {
  if (test::is_sanitized()) GTEST_SKIP() << kSlow;
  GltfBuilder builder = test::quad_document();
  std::vector<float> times(100000);
  for (std::size_t i = 0; i < times.size(); ++i) times[i] = static_cast<float>(i);
  builder.add_track(builder.add_animation("a"), 0, times, std::vector<std::uint8_t>(2 * times.size(), 1));
  for (std::size_t node = 1; node < 1000; ++node) {
    builder.add_node(0);
    builder.json["animations"][0]["channels"].push_back(
        {{"sampler", 0}, {"target", {{"node", node}, {"path", "weights"}}}});
  }
  EXPECT_TRUE(read_apart("tracks", builder.glb()).starts_with("a.gltf"));
}

TEST(GltfHuge, primitives_that_share_their_corners_are_refused_before_these_are_copied) {
  if (test::is_sanitized()) GTEST_SKIP() << kSlow;
  GltfBuilder builder = test::quad_document();
  builder.json["meshes"][0]["primitives"][0]["indices"] = builder.add_indices(std::vector<std::uint8_t>(3000000, 1));
  const Json primitive = builder.json["meshes"][0]["primitives"][0];
  for (int i = 1; i < 400; ++i) builder.add_primitive(0, primitive);
  EXPECT_TRUE(read_apart("corners", builder.glb()).starts_with("a.gltf"));
}

TEST(GltfHuge, views_that_share_their_compressed_bytes_are_not_all_kept) {
  if (test::is_sanitized()) GTEST_SKIP() << kSlow;
  GltfBuilder builder;
  const std::string coded = test::meshopt_attributes(std::string(12 * 100000, '\0'), 12);
  const std::size_t first = test::add_meshopt_view(builder, coded, 100000, 12, "ATTRIBUTES");
  const Json view = builder.json["bufferViews"][first];
  const std::size_t corners = builder.add_indices<std::uint8_t>({0, 1, 2});
  for (int i = 0; i < 1000; ++i) {
    const std::size_t base = builder.add_accessor_over(builder.add("bufferViews", view), "VEC3", 5126, 3);
    builder.add_mesh(GltfBuilder::primitive(base, corners));
  }
  (void)read_apart("views", builder.glb());
}

TEST(GltfHuge, hundred_thousand_channels_are_read_in_a_breath) {
  GltfBuilder builder = test::quad_document();
  builder.add_track<float>(builder.add_animation("a"), 0, {0, 1}, {0, 0, 1, 1});
  Json channels = Json::array(), nodes = Json::array();
  for (int node = 0; node < 100000; ++node) {
    nodes.push_back({{"mesh", 0}});
    channels.push_back({{"sampler", 0}, {"target", {{"node", node}, {"path", "weights"}}}});
  }
  builder.json["nodes"] = nodes;
  builder.json["animations"][0]["channels"] = channels;
  const test::CpuClock clock;
  EXPECT_EQ(read_apart("channels", builder.glb()), "");
  if (!test::is_sanitized()) {
    EXPECT_LT(clock.seconds(), 5.0);
  }
}

// A fixture that finds the invalid files of other projects, and skips the test if CHRONORMAL_DATA does not name their
// folder.
class HostileData : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("CHRONORMAL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
    data_ = fs::path(folder) / "hostile";
  }
  fs::path data_;
};

// Reads a file. If `strict` is true, notes are errors. Otherwise the file is read with the settings that users have by
// default.
fuzz::GltfReading read_file(const fs::path& path, bool strict = true) {
  const Result<GltfDocument> document = GltfDocument::open(path.string(), {.strict = strict});
  return fuzz::read_all_of(document, path.filename().string(), GltfMotionOptions().most_bytes);
}

TEST_F(HostileData, gltf_files_are_read_or_refused_with_a_place_within_a_second) {
  std::size_t count = 0, refused = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(data_)) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".gltf" && extension != ".glb") continue;
    SCOPED_TRACE(entry.path());
    ++count;
    const test::CpuClock clock;
    const fuzz::GltfReading reading = read_file(entry.path());
    EXPECT_LT(clock.seconds(), 1.0);
    EXPECT_EQ(reading.broken, "");
    EXPECT_EQ(read_file(entry.path(), false).broken, "");
    refused += reading.errors.empty() ? 0U : 1U;
    if (std::getenv("CHRONORMAL_VERBOSE") != nullptr)
      std::printf("%-90s %s\n", entry.path().lexically_relative(data_).c_str(),
                  reading.errors.empty() ? "read" : reading.errors.front().text().c_str());
  }
  EXPECT_GE(count, 100U);
  EXPECT_GE(refused, 50U);
  std::printf("%zu files, %zu of them refused\n", count, refused);
}

// Codes of errors that the Khronos validator reports about parts of a file that our reader reads. Our reader must
// refuse a file with such an error.
const std::set<std::string_view> kRead = {
    "ACCESSOR_INDEX_OOB",
    "ACCESSOR_INDEX_PRIMITIVE_RESTART",
    "ACCESSOR_NORMALIZED_INVALID",
    "ACCESSOR_SPARSE_COUNT_OUT_OF_RANGE",
    "BUFFER_VIEW_TOO_LONG",
    "EMPTY_ENTITY",
    "MESH_INVALID_WEIGHTS_COUNT",
    "MESH_PRIMITIVE_INDICES_ACCESSOR_INVALID_FORMAT",
    "MESH_PRIMITIVE_INDICES_ACCESSOR_WITH_BYTESTRIDE",
    "MESH_PRIMITIVE_MORPH_TARGET_INVALID_ATTRIBUTE_COUNT",
    "MESH_PRIMITIVES_UNEQUAL_TARGETS_COUNT",
    "TYPE_MISMATCH",
    "ARRAY_TYPE_MISMATCH",
    "UNDEFINED_PROPERTY",
    "UNRESOLVED_REFERENCE",
    "UNSATISFIED_DEPENDENCY",
    "VALUE_MULTIPLE_OF",
    "VALUE_NOT_IN_RANGE",
};

// Codes of errors that the Khronos validator reports about parts of a file that our reader does not read, or reads only
// if they are used, each with the reason.
const std::map<std::string_view, const char*> kNotRead = {
    {"ACCESSOR_INVALID_SIGN", "the sign of tangents does not touch geometry"},
    {"ACCESSOR_JOINTS_INDEX_DUPLICATE", "skins are not read"},
    {"ACCESSOR_JOINTS_INDEX_OOB", "skins are not read"},
    {"ACCESSOR_MATRIX_ALIGNMENT", "no matrix is read"},
    {"ACCESSOR_NON_CLAMPED", "colours are not read"},
    {"ACCESSOR_OFFSET_ALIGNMENT", "accessors are checked where a mesh or an animation uses them"},
    {"ACCESSOR_SMALL_BYTESTRIDE", "accessors are checked where a mesh or an animation uses them"},
    {"ACCESSOR_TOO_LONG", "accessors are checked where a mesh or an animation uses them"},
    {"ACCESSOR_TOTAL_OFFSET_ALIGNMENT", "accessors are checked where a mesh or an animation uses them"},
    {"ACCESSOR_VECTOR3_NON_UNIT", "the normals of a file are data to be judged"},
    {"ACCESSOR_WEIGHTS_NEGATIVE", "skins are not read"},
    {"ACCESSOR_WEIGHTS_NON_NORMALIZED", "skins are not read"},
    {"BUFFER_BYTE_LENGTH_MISMATCH", "buffers are opened where they are used"},
    {"BUFFER_DATA_URI_MIME_TYPE_INVALID", "buffers are opened where they are used"},
    {"BUFFER_MISSING_GLB_DATA", "buffers are opened where they are used"},
    {"BUFFER_VIEW_INVALID_BYTE_STRIDE", "the target of a view is not read; strided indices have a code of their own"},
    {"BUFFER_VIEW_TARGET_OVERRIDE", "the target of a view is not read"},
    {"BUFFER_VIEW_TOO_BIG_BYTE_STRIDE", "a stride is checked against the elements of the accessors over it"},
    {"INVALID_URI", "buffers are opened where they are used"},
    {"IO_ERROR", "buffers are opened where they are used"},
    {"MESH_PRIMITIVE_ACCESSOR_UNALIGNED", "the file has it in colours, which are not read"},
    {"MESH_PRIMITIVE_ACCESSOR_WITHOUT_BYTESTRIDE",
     "the file has it in colours; the data are where they are said to be"},
    {"MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT", "asked below: only POSITION, NORMAL, TANGENT are read"},
    {"MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_UNSIGNED_INT", "the file has it in an attribute of its own"},
    {"MESH_PRIMITIVE_INDEXED_SEMANTIC_CONTINUITY", "texture coordinates are not read"},
    {"MESH_PRIMITIVE_INVALID_ATTRIBUTE", "unknown attributes are not read"},
    {"MESH_PRIMITIVE_JOINTS_WEIGHTS_MISMATCH", "skins are not read"},
    {"MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR", "asked below: only POSITION, NORMAL, TANGENT are read"},
    {"MESH_PRIMITIVE_POSITION_ACCESSOR_WITHOUT_BOUNDS", "bounds are not read"},
    {"MESH_PRIMITIVE_TOO_FEW_TEXCOORDS", "texture coordinates are not read"},
    {"MESH_PRIMITIVE_UNEQUAL_ACCESSOR_COUNT", "the file has it in colours, which are not read"},
};

// Names of files with types from later versions of glTF. The Khronos validator only warns of such types.
const std::set<std::string_view> kOnlyWarned = {"unknown_type.gltf"};

// Tells whether a message of the Khronos validator is about a part of the file that our reader reads. If the code of
// the message also occurs for other parts, the JSON pointer decides.
bool is_about_what_is_read(const std::string& code, const std::string& pointer) {
  if (kRead.contains(code)) {
    // Our reader never reads the entries of the lists below.
    for (const char* const list : {"/materials", "/textures", "/images", "/samplers", "/skins", "/cameras", "/scenes"})
      if (pointer.starts_with(list)) return false;
    return !pointer.ends_with("/material");
  }
  const auto has = [&](const char* text) { return pointer.find(text) != std::string::npos; };
  return (code == "MESH_PRIMITIVE_ATTRIBUTES_ACCESSOR_INVALID_FORMAT" ||
          code == "MESH_PRIMITIVE_MORPH_TARGET_NO_BASE_ACCESSOR") &&
         (has("/POSITION") || has("/NORMAL") || has("/TANGENT"));
}

TEST_F(HostileData, what_the_validator_calls_an_error_is_refused_or_not_read) {
  std::size_t reports = 0, errors = 0, refused = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(data_ / "validator")) {
    const std::string path = entry.path().string();
    constexpr std::string_view kReport = ".report.json";
    if (!path.ends_with(kReport)) continue;
    ++reports;
    const std::string asset = path.substr(0, path.size() - kReport.size());
    SCOPED_TRACE(asset);
    const Json report = Json::parse(test::read_whole(path));
    bool must_be_refused = false;
    std::string codes;
    for (const Json& message : report["issues"]["messages"]) {
      if (message["severity"] != 0) continue;
      const std::string code = message["code"];
      ++errors;
      EXPECT_TRUE(kRead.contains(code) != kNotRead.contains(code)) << code << " must be in one of the tables";
      if (!is_about_what_is_read(code, message.value("pointer", ""))) continue;
      must_be_refused = true;
      codes += code + " " + message.value("pointer", "") + "; ";
    }
    if (!fs::exists(asset)) continue;
    const std::string name = fs::path(asset).filename().string();
    const fuzz::GltfReading reading = read_file(asset);
    if (must_be_refused) {
      EXPECT_FALSE(reading.errors.empty()) << codes;
      ++refused;
    } else if (report["issues"]["numErrors"] == 0 && !reading.errors.empty() && !kOnlyWarned.contains(name)) {
      ADD_FAILURE() << "the validator finds no error: " << reading.errors.front().text();
    }
  }
  EXPECT_EQ(reports, 80U);
  EXPECT_GE(errors, 100U);
  EXPECT_GE(refused, 30U);
  std::printf("%zu reports with %zu errors; %zu files must be refused\n", reports, errors, refused);
}

}  // namespace
}  // namespace chronormal::gltf_hostile_test
