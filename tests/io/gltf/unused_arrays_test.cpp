// Checks that a file edited by GltfEdit omits the bytes that no array uses any more, in every buffer, and that all
// other arrays keep their values. The test reads accessors with its own code.
#include <gtest/gtest.h>

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "tests/support/glb_parts.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::unused_arrays_test {
namespace {

using test::bytes_of;
using test::bytes_or_error;
using test::GltfBuilder;
using test::GltfFixture;
using Json = nlohmann::json;

const std::vector<float> kBase = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};

struct Parts {
  explicit Parts(const std::string& glb)
      : json(Json::parse(test::take_apart(glb).json)), bin(test::take_apart(glb).bin) {}
  Json json;
  std::string bin;

  // Returns the bytes of the elements of an accessor, followed by the bytes of its sparse arrays.
  [[nodiscard]] std::string elements(std::size_t index) const {
    const Json& accessor = json.at("accessors").at(index);
    const std::string type = accessor.at("type");
    const std::size_t components = type == "SCALAR" ? 1 : type == "VEC4" ? 4 : 3;
    const auto size_of = [](const Json& component) {
      return component == 5126 || component == 5125 ? 4U : component == 5123 ? 2U : 1U;
    };
    std::string result;
    const auto add = [&](const Json& place, std::size_t count, std::size_t size, bool strides) {
      const Json& view = json.at("bufferViews").at(place.at("bufferView").get<std::size_t>());
      EXPECT_EQ(view.at("buffer"), 0);
      const std::size_t stride = strides ? view.value("byteStride", size) : size;
      const std::size_t begin = place.value("byteOffset", std::size_t{0}), length = view.at("byteLength");
      for (std::size_t i = 0; i < count; ++i) {
        EXPECT_LE(begin + i * stride + size, length) << "accessor " << index;
        result += bin.substr(view.value("byteOffset", std::size_t{0}) + begin + i * stride, size);
      }
    };
    const std::size_t size = components * size_of(accessor.at("componentType"));
    if (accessor.contains("bufferView")) add(accessor, accessor.at("count"), size, true);
    if (accessor.contains("sparse")) {
      const Json& sparse = accessor["sparse"];
      add(sparse.at("indices"), sparse.at("count"), size_of(sparse.at("indices").at("componentType")), false);
      add(sparse.at("values"), sparse.at("count"), size, false);
    }
    return result;
  }
};

// Adds a mesh without indices. The accessor of its base positions is also that of its base normals.
void add_mesh(GltfBuilder& builder, std::size_t base, const std::vector<Json>& targets) {
  Json primitive = GltfBuilder::primitive(base, std::nullopt, targets);
  primitive["attributes"]["NORMAL"] = base;
  builder.add_mesh(std::move(primitive));
}

std::string bytes_without_unused(const GltfFixture& fixture, const std::vector<std::size_t>& replaced_targets) {
  GltfEdit edit(*fixture);
  for (const std::size_t k : replaced_targets)
    edit.set(
        "/meshes/0/primitives/0/targets/" + std::to_string(k) + "/NORMAL",
        std::to_string(edit.add_vectors(std::vector<float>{9, 8, 7, 6, 5, 4, 3, 2, 1, static_cast<float>(k), 2, 3})));
  edit.leave_out_unused();
  return bytes_or_error(edit);
}

TEST(UnusedArrays, arrays_in_views_of_their_own_are_left_out_whole) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(kBase), lift = builder.add_positions(kBase);
  const std::size_t turn = builder.add_positions(kBase), image = builder.add_view("a picture"),
                    last = builder.add_positions(kBase);
  add_mesh(builder, base, {{{"POSITION", lift}, {"NORMAL", turn}}, {{"POSITION", last}}});
  builder.json["images"] = Json::array({{{"bufferView", image}, {"mimeType", "image/png"}}});
  const GltfFixture fixture(builder);
  const std::string result = bytes_without_unused(fixture, {0});
  const Parts before(builder.glb()), after(result);
  for (const std::size_t accessor : {base, lift, last}) EXPECT_EQ(after.elements(accessor), before.elements(accessor));
  EXPECT_EQ(after.bin.size(), before.bin.size()) << "48 bytes out, and 48 in";
  EXPECT_EQ(after.json["buffers"][0]["byteLength"], after.bin.size());
  const std::size_t at = after.json["bufferViews"][image]["byteOffset"];
  EXPECT_EQ(after.bin.substr(at, 9), "a picture");
  EXPECT_EQ(GltfFixture(result).error(), "");
  EXPECT_EQ(after.elements(4), bytes_of<float>({9, 8, 7, 6, 5, 4, 3, 2, 1, 0, 2, 3}));
}

TEST(UnusedArrays, nothing_is_left_out_unless_it_is_asked_for) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(kBase), turn = builder.add_positions(kBase);
  add_mesh(builder, base, {Json{{"NORMAL", turn}}});
  const GltfFixture fixture(builder);
  GltfEdit edit(*fixture);
  edit.set("/meshes/0/primitives/0/targets/0/NORMAL", std::to_string(base));
  EXPECT_EQ(Parts(bytes_or_error(edit)).bin, Parts(builder.glb()).bin);
  EXPECT_EQ(edit.unused_bytes().value(), 0U);
  edit.leave_out_unused();
  EXPECT_EQ(edit.unused_bytes().value(), 48U);
  EXPECT_EQ(Parts(bytes_or_error(edit)).bin.size(), 48U);
}

// Bytes of an unused array stay in the file if another accessor also uses them, or if an unknown extension might use
// them.
TEST(UnusedArrays, bytes_that_something_else_needs_stay) {
  const auto sharing = [] {
    GltfBuilder builder;
    const std::size_t base = builder.add_positions(kBase),
                      view = builder.add_view(bytes_of(kBase) + bytes_of(kBase), 24);
    const std::size_t positions = builder.add_accessor_over(view, "VEC3", 5126, 4);
    const std::size_t normals = builder.add_accessor_over(view, "VEC3", 5126, 4);
    builder.json["accessors"][normals]["byteOffset"] = 12;
    add_mesh(builder, base, {Json{{"POSITION", positions}, {"NORMAL", normals}}});
    return builder;
  };
  const auto left_out = [](const GltfBuilder& builder) {
    const GltfFixture fixture(builder);
    EXPECT_EQ(fixture.error(), "");
    const Parts before(builder.glb()), after(bytes_without_unused(fixture, {0}));
    EXPECT_EQ(after.elements(1), before.elements(1));
    return before.bin.size() + 48 - after.bin.size();
  };
  EXPECT_EQ(left_out(sharing()), 0U) << "interleaved: three.js takes all strides of what is used";

  GltfBuilder own;
  const std::size_t base = own.add_positions(kBase), lift = own.add_positions(kBase), turn = own.add_positions(kBase);
  add_mesh(own, base, {{{"POSITION", lift}, {"NORMAL", turn}}, {{"POSITION", lift}}});
  EXPECT_EQ(left_out(own), 48U);
  GltfBuilder known = own, unknown = own, twice = own, skin = own;
  known.json["materials"] = Json::array({{{"extensions", {{"KHR_materials_unlit", Json::object()}}}}});
  EXPECT_EQ(left_out(known), 48U);
  unknown.json["nodes"] =
      Json::array({{{"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", turn}}}}}}}}});
  EXPECT_EQ(left_out(unknown), 0U);
  twice.json["meshes"][0]["primitives"][0]["targets"][1]["NORMAL"] = turn;
  EXPECT_EQ(left_out(twice), 0U);
  const std::size_t matrix = skin.add_accessor_over(skin.json["accessors"][turn]["bufferView"], "SCALAR", 5126, 4);
  skin.json["skins"] = Json::array({{{"inverseBindMatrices", matrix}, {"joints", Json::array({0})}}});
  EXPECT_EQ(left_out(skin), 32U) << "of 48 bytes the first 16 are those of a skin";
}

// A bake packs the sparse arrays of all targets into one buffer view. If an unused array is omitted, the arrays after
// it have new offsets.
TEST(UnusedArrays, sparse_arrays_that_share_a_view_are_found_where_they_have_moved) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(kBase);
  const std::vector<float> values = {1, 2, 3, 4, 5, 6};
  const std::string indices("\1\3\0\0", 4), pair = indices + bytes_of(values);
  const std::size_t view = builder.add_view(pair + pair + pair);
  std::vector<Json> targets;
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t array = builder.add_accessor_over(std::nullopt, "VEC3", 5126, 4), at = k * pair.size();
    builder.json["accessors"][array]["sparse"] = {
        {"count", 2},
        {"indices", {{"bufferView", view}, {"byteOffset", at}, {"componentType", 5121}}},
        {"values", {{"bufferView", view}, {"byteOffset", at + indices.size()}}}};
    targets.push_back(Json{{"NORMAL", array}});
  }
  add_mesh(builder, base, targets);
  const GltfFixture fixture(builder);
  const Parts before(builder.glb()), after(bytes_without_unused(fixture, {1}));
  const std::size_t left_out = bytes_of(values).size();  // the two indices stay, as omitting them saves too little
  EXPECT_EQ(after.bin.size(), before.bin.size() + 48 - left_out);
  for (const std::size_t array : {1U, 3U}) EXPECT_EQ(after.elements(array), before.elements(array));
  EXPECT_EQ(after.json["accessors"][3]["sparse"]["values"]["byteOffset"], 2 * pair.size() + indices.size() - left_out);
}

// Makes a file with three buffers. The first has only the base, the second has the base and old deltas, and the third
// has only old deltas.
GltfBuilder in_three_buffers(const std::vector<std::string>& uris) {
  GltfBuilder builder;
  const std::string one = bytes_of(kBase),
                    two = bytes_of(kBase) + one + bytes_of<float>({1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4});
  builder.json["buffers"] = Json::array();
  for (const auto& [uri, size] : {std::pair(uris[0], one.size()), {uris[1], two.size()}, {uris[2], one.size()}})
    builder.json["buffers"].push_back({{"byteLength", size}, {"uri", uri}});
  const auto add = [&](std::size_t buffer, std::size_t offset) {
    builder.add("bufferViews", {{"buffer", buffer}, {"byteOffset", offset}, {"byteLength", 48}});
    return builder.add_accessor_over(builder.json["bufferViews"].size() - 1, "VEC3", 5126, 4);
  };
  const std::size_t base = add(0, 0), lift = add(1, 0), turn = add(1, 48), last = add(1, 96), other = add(2, 0);
  add_mesh(builder, base, {{{"POSITION", lift}, {"NORMAL", turn}}, {{"POSITION", last}, {"NORMAL", other}}});
  return builder;
}

TEST(UnusedArrays, unused_arrays_are_left_out_of_files_and_data_uris_wherever_these_go) {
  const test::TemporaryFolder folder, elsewhere;
  const std::string one = bytes_of(kBase), two = one + one + bytes_of<float>({1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4});
  folder.write("one.bin", one);
  folder.write("two.bin", two);
  folder.write("old.bin", one);
  const auto as_data = [](const std::string& bytes) {
    return "data:application/octet-stream;base64," + test::base64(bytes);
  };
  struct Case {
    const char* name;
    std::vector<std::string> uris;
    std::size_t beside, moved;  // number of omitted bytes if the .gltf is written beside its source, and elsewhere
  };
  // In the second buffer, 48 bytes are unused. In the third buffer, all bytes are unused except for four, which its
  // views need.
  for (const Case& of : {Case{"files.gltf", {"one.bin", "two.bin", "old.bin"}, 0, 92},
                         Case{"mixed.gltf", {"one.bin", as_data(two), "old.bin"}, 48, 92},
                         Case{"data.gltf", {as_data(one), as_data(two), as_data(one)}, 92, 92}}) {
    const Result<GltfDocument> document =
        GltfDocument::open(folder.write(of.name, in_three_buffers(of.uris).json.dump()));
    ASSERT_TRUE(document.ok()) << document.error().text();
    for (const auto& [path, left_out] : {std::pair(folder / "out.gltf", of.beside),
                                         {elsewhere / "out.gltf", of.moved},
                                         {folder / "out.glb", of.moved},
                                         {elsewhere / "out.glb", of.moved}}) {
      SCOPED_TRACE(std::string(of.name) + " to " + path);
      GltfEdit edit(document.value());
      for (const char* const k : {"0", "1"})
        edit.set(std::string("/meshes/0/primitives/0/targets/").append(k).append("/NORMAL"),
                 std::to_string(edit.add_vectors(std::vector<float>(12, 0.5F))));
      EXPECT_EQ(edit.unused_bytes(path).value(), 0U) << "unless it is asked for";
      const std::size_t before = edit.bytes(path).value().size();
      edit.leave_out_unused();
      EXPECT_EQ(edit.unused_bytes(path).value(), left_out);
      ASSERT_TRUE(edit.write(path, true).ok());
      const Result<GltfDocument> written = GltfDocument::open(path);
      ASSERT_TRUE(written.ok()) << written.error().text();
      const auto geometry = written.value().geometry(0, 0, {.shading = true});
      ASSERT_TRUE(geometry.ok()) << geometry.error().text();
      EXPECT_EQ(geometry.value().positions, kBase);
      EXPECT_EQ(geometry.value().targets[0].positions, kBase);
      EXPECT_EQ(geometry.value().targets[1].positions, (std::vector<float>{1, 1, 1, 2, 2, 2, 3, 3, 3, 4, 4, 4}));
      EXPECT_EQ(geometry.value().targets[1].normals, std::vector<float>(12, 0.5F));
      if (left_out > 0) {
        EXPECT_LT(edit.bytes(path).value().size(), before);
      }
    }
  }
  EXPECT_EQ(test::read_whole(folder / "two.bin"), two) << "files beside a source stay as they are";
}

// Random documents have buffer views with one array or many, strided views, sparse arrays, and arrays that share bytes.
TEST(UnusedArrays, all_other_arrays_keep_their_numbers) {
  constexpr unsigned kSeed = 20261123;
  SCOPED_TRACE("seed " + std::to_string(kSeed));
  std::mt19937 random(kSeed);
  const auto below = [&](std::size_t n) { return static_cast<std::size_t>(random() % n); };
  std::size_t left_out = 0;
  for (int round = 0; round < 300; ++round) {
    GltfBuilder builder;
    std::vector<std::size_t> views, arrays = {builder.add_positions(kBase)};
    for (std::size_t n = 2 + below(6); n > 0; --n) {
      std::string bytes(48 * (1 + below(3)) + 4 * below(3), '\0');
      for (char& byte : bytes) byte = static_cast<char>(below(63));  // bytes that cannot give NaN or huge numbers
      views.push_back(builder.add_view(bytes, below(4) == 0 ? 12 : 0));
      if (below(3) == 0) builder.buffer += std::string(below(9), '\x11');
    }
    for (std::size_t n = 3 + below(9); n > 0; --n) {
      const std::size_t view = views[below(views.size())], length = builder.json["bufferViews"][view]["byteLength"];
      const std::size_t array = builder.add_accessor_over(view, "VEC3", 5126, 4);
      if (length >= 48) builder.json["accessors"][array]["byteOffset"] = 4 * below((length - 48) / 4 + 1);
      if (below(4) == 0) builder.make_sparse<std::uint8_t, float>(array, {1, 3}, {1, 2, 3, 4, 5, 6});
      arrays.push_back(array);
    }
    std::vector<Json> targets;
    std::vector<std::size_t> replaced;
    for (std::size_t k = 0; k < 6; ++k) {
      targets.push_back({{"POSITION", arrays[below(arrays.size())]}, {"NORMAL", arrays[below(arrays.size())]}});
      if (below(2) == 0) replaced.push_back(k);
    }
    add_mesh(builder, arrays[0], targets);
    const GltfFixture fixture(builder);
    ASSERT_EQ(fixture.error(), "");
    const std::string result = bytes_without_unused(fixture, replaced);
    ASSERT_EQ(GltfFixture(result).error(), "");
    const Parts before(builder.glb()), after(result);
    std::vector<bool> is_used(arrays.size(), true);
    const auto mark = [&](const Json& json, bool value) {
      for (const Json& target : json["meshes"][0]["primitives"][0]["targets"]) {
        for (const Json& index : target) {
          if (index < is_used.size()) is_used[index.get<std::size_t>()] = value;
        }
      }
    };
    mark(before.json, false);
    mark(after.json, true);
    is_used[0] = true;
    for (std::size_t i = 0; i < arrays.size(); ++i) {
      if (is_used[i]) {
        EXPECT_EQ(after.elements(arrays[i]), before.elements(arrays[i])) << "round " << round;
      }
    }
    GltfEdit edit(*fixture);
    for (const std::size_t k : replaced)
      edit.set("/meshes/0/primitives/0/targets/" + std::to_string(k) + "/NORMAL", "0");
    edit.leave_out_unused();
    left_out += edit.unused_bytes().value() > 0 ? 1U : 0U;
  }
  EXPECT_GT(left_out, 100U);
}

}  // namespace
}  // namespace chronormal::unused_arrays_test
