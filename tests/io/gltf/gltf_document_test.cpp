// Tests the structure of glTF documents: containers, meshes, nodes, animations, and how primitives become triangles.
#include "chronormal/io/gltf_document.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/child_process.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::gltf_document_test {
namespace {

using test::GltfBuilder, test::GltfFixture;
using Corners = std::vector<std::uint32_t>;

GltfGeometry geometry_of(const GltfFixture& file, std::size_t mesh = 0, std::size_t primitive = 0) {
  EXPECT_TRUE(file.ok()) << file.error();
  if (!file.ok()) return {};
  Result<GltfGeometry> geometry = file->geometry(mesh, primitive, {true, true});
  EXPECT_TRUE(geometry.ok()) << geometry.error().text();
  return geometry ? geometry.value() : GltfGeometry{};
}

void expect_quad(const GltfGeometry& geometry) {
  EXPECT_EQ(geometry.corners, (Corners{0, 1, 2, 0, 2, 3}));
  EXPECT_EQ(geometry.positions, test::kQuad);
  ASSERT_EQ(geometry.targets.size(), 2U);
  EXPECT_EQ(geometry.targets[0].positions, test::kLift);
  EXPECT_EQ(geometry.targets[1].positions, test::kShift);
}

TEST(GltfContainer, glb_and_gltf_hold_the_same) {
  const GltfBuilder builder = test::quad_document();
  expect_quad(geometry_of(GltfFixture(builder.glb())));
  expect_quad(geometry_of(GltfFixture(builder.gltf())));
  expect_quad(geometry_of(
      GltfFixture(builder.gltf_with_uri("data:application/gltf-buffer;base64," + test::base64(builder.buffer)))));
}

TEST(GltfContainer, bin_chunk_has_at_most_3_bytes_more_than_its_buffer) {
  // After the data of the buffer, the chunk may have only the bytes that pad it to a multiple of four.
  GltfBuilder builder = test::quad_document();
  builder.buffer.resize((builder.buffer.size() + 3) / 4 * 4);
  for (const std::size_t surplus : {std::size_t{0}, std::size_t{1}, std::size_t{3}, std::size_t{4}, std::size_t{5}}) {
    GltfBuilder::Json json = builder.json;
    const std::string bin = builder.buffer + std::string(4 * ((surplus + 3) / 4), '\0');
    json["buffers"] = {{{"byteLength", bin.size() - surplus}}};
    const GltfFixture file(test::glb_bytes(json.dump(), bin));
    ASSERT_TRUE(file.ok()) << file.error();
    const Result<GltfGeometry> geometry = file->geometry(0, 0, {true, true});
    EXPECT_EQ(geometry.ok(), surplus <= 3) << surplus;
    if (surplus > 3 && !geometry) {
      EXPECT_EQ(geometry.error().code, ErrorCode::kInvalidInput);
      EXPECT_NE(geometry.error().text().find("/buffers/0/byteLength"), std::string::npos) << geometry.error().text();
    }
  }
}

TEST(GltfContainer, buffer_lies_in_a_file_beside_the_asset) {
  const GltfBuilder builder = test::quad_document();
  const test::TemporaryFolder folder;
  (void)folder.write("quad.bin", builder.buffer);
  (void)folder.write("a name%.bin", builder.buffer);
  std::filesystem::create_directory(folder / "inner");
  (void)folder.write("inner/\xC3\xA9.bin", builder.buffer);
  for (const char* const uri : {"quad.bin", "./quad.bin", "inner/../quad.bin", "a%20name%25.bin", "a name%25.bin",
                                "%71uad%2Ebin", "inner/%C3%A9.bin", "inner/\xC3\xA9.bin", "inner%2F%c3%a9.bin"}) {
    SCOPED_TRACE(uri);
    expect_quad(geometry_of(GltfFixture(builder.gltf_with_uri(uri), folder.path())));
    const std::string path = folder.write("quad.gltf", builder.gltf_with_uri(uri));
    const Result<GltfDocument> document = GltfDocument::open(path);
    ASSERT_TRUE(document.ok()) << document.error().text();
    const Result<GltfGeometry> geometry = document.value().geometry(0, 0, {});
    ASSERT_TRUE(geometry.ok()) << geometry.error().text();
    expect_quad(geometry.value());
  }
}

TEST(GltfContainer, opened_file_is_known_by_its_path) {
  const test::TemporaryFolder folder;
  const std::string path = folder.write("quad.glb", test::quad_document().glb());
  const Result<GltfDocument> document = GltfDocument::open(path);
  ASSERT_TRUE(document.ok()) << document.error().text();
  EXPECT_TRUE(document.value().name().ends_with("quad.glb")) << document.value().name();
  const Result<GltfDocument> missing = GltfDocument::open(folder / "none.glb");
  ASSERT_FALSE(missing.ok());
  EXPECT_EQ(missing.error().code, ErrorCode::kFailed);
}

TEST(GltfContainer, document_survives_being_moved) {
  const std::string bytes = test::quad_document().glb();
  Result<GltfDocument> first = GltfDocument::read(bytes, "a.glb");
  ASSERT_TRUE(first.ok());
  const GltfDocument moved = std::move(first).value();
  expect_quad(moved.geometry(0, 0, {}).value());
  expect_quad(moved.geometry(0, 0, {}).value());
}

TEST(GltfContainer, standard_input_is_read_and_has_no_files_beside_it) {
  const test::TemporaryFolder folder;
  const auto read_standard_input = [](const std::string& path) {
    return test::run_in_child(20, [&]() -> std::string {
      if (std::freopen(path.c_str(), "rb", stdin) == nullptr) return "no input";
      const Result<GltfDocument> document = GltfDocument::open("-");
      if (!document) return document.error().text();
      const Result<GltfGeometry> geometry = document.value().geometry(0, 0, {});
      return geometry ? "read" : geometry.error().place;
    });
  };
  const GltfBuilder builder = test::quad_document();
  (void)folder.write("own.bin", builder.buffer);
  EXPECT_EQ(read_standard_input(folder.write("a.glb", builder.glb())).text, "read");
  EXPECT_EQ(read_standard_input(folder.write("a.gltf", builder.gltf_with_uri("own.bin"))).text,
            "<stdin>, /buffers/0/uri");
}

TEST(GltfContainer, first_bytes_tell_gltf_from_other_files) {
  EXPECT_TRUE(GltfDocument::recognises(test::quad_document().glb()));
  EXPECT_TRUE(GltfDocument::recognises(test::quad_document().gltf()));
  EXPECT_TRUE(GltfDocument::recognises(" \r\n\t{ \"asset\""));
  EXPECT_TRUE(GltfDocument::recognises("\xEF\xBB\xBF{\"asset\""));
  for (const char* const other : {"", "v 0 0 0\nf 1 1 1\n", "ply\n", "[1]", "PK\3\4", "glT"})
    EXPECT_FALSE(GltfDocument::recognises(other)) << other;
}

TEST(GltfContainer, further_chunks_of_a_glb_are_skipped) {
  std::string bytes = test::quad_document().glb();
  bytes += test::bytes_of(Corners{4}) + "NOPE" + "abcd";
  bytes.replace(8, 4, test::bytes_of(Corners{static_cast<std::uint32_t>(bytes.size())}));
  expect_quad(geometry_of(GltfFixture(bytes)));
}

TEST(GltfContainer, buffer_may_be_longer_than_what_is_used_of_it) {
  GltfBuilder builder = test::quad_document();
  builder.buffer += std::string(100, 'x');
  expect_quad(geometry_of(GltfFixture(builder)));
}

TEST(GltfStructure, meshes_nodes_and_animations_are_listed) {
  GltfBuilder builder = test::quad_document();
  builder.json["meshes"][0]["weights"] = {0.25, 0.75};
  builder.json["meshes"][0]["extras"] = {{"targetNames", {"lift", "shift"}}};
  builder.add_node(0, {{"weights", {1, 0}}, {"skin", 0}});
  builder.add("nodes", {{"name", "parent"}, {"children", {0, 1}}, {"translation", {1, 2, 3}}});
  builder.add("skins", {{"joints", {2}}});
  const std::size_t walk = builder.add_animation("walk");
  builder.add_track<float>(walk, 1, {0, 1}, {0, 0, 1, 1});
  const std::size_t other = builder.add_animation("");
  builder.add_track<float>(other, 0, {0, 2, 3}, {0, 0, 1, 1, 0, 0}, "STEP");
  builder.json["animations"][other]["channels"].push_back(
      {{"sampler", 0}, {"target", {{"node", 2}, {"path", "translation"}}}});
  builder.json["extensionsUsed"] = {"KHR_materials_unlit", "EXT_something"};

  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  EXPECT_EQ(file->name(), "a.gltf");
  ASSERT_EQ(file->meshes().size(), 1U);
  const GltfMesh& mesh = file->meshes()[0];
  EXPECT_EQ(mesh.name, "quad");
  EXPECT_EQ(mesh.target_count, 2U);
  EXPECT_EQ(mesh.target_names, (std::vector<std::string>{"lift", "shift"}));
  EXPECT_EQ(mesh.weights, (std::vector{0.25, 0.75}));
  ASSERT_EQ(mesh.primitives.size(), 1U);
  EXPECT_EQ(mesh.primitives[0].mode, 4);
  EXPECT_EQ(mesh.primitives[0].vertex_count, 4U);
  EXPECT_EQ(mesh.primitives[0].element_count, 6U);
  EXPECT_FALSE(mesh.primitives[0].has_normals || mesh.primitives[0].has_tangents || mesh.primitives[0].has_draco);
  ASSERT_EQ(mesh.primitives[0].targets.size(), 2U);
  EXPECT_TRUE(mesh.primitives[0].targets[1].positions);
  EXPECT_FALSE(mesh.primitives[0].targets[1].normals || mesh.primitives[0].targets[1].tangents);

  ASSERT_EQ(file->nodes().size(), 3U);
  EXPECT_EQ(file->nodes()[0].name, "node");
  EXPECT_EQ(file->nodes()[0].mesh, 0U);
  EXPECT_EQ(file->nodes()[0].parent, 2U);
  EXPECT_FALSE(file->nodes()[0].has_skin);
  EXPECT_TRUE(file->nodes()[0].weights.empty());
  EXPECT_TRUE(file->nodes()[1].has_skin);
  EXPECT_EQ(file->nodes()[1].weights, (std::vector{1.0, 0.0}));
  EXPECT_FALSE(file->nodes()[2].mesh.has_value() || file->nodes()[2].parent.has_value());

  ASSERT_EQ(file->animations().size(), 2U);
  EXPECT_EQ(file->animations()[0].name, "walk");
  EXPECT_EQ(file->animations()[0].channel_count, 1U);
  ASSERT_EQ(file->animations()[0].tracks.size(), 1U);
  EXPECT_EQ(file->animations()[0].tracks[0].node, 1U);
  EXPECT_EQ(file->animations()[0].tracks[0].key_count, 2U);
  EXPECT_EQ(file->animations()[1].channel_count, 2U);
  ASSERT_EQ(file->animations()[1].tracks.size(), 1U);
  EXPECT_EQ(file->animations()[1].tracks[0].interpolation, GltfInterpolation::kStep);
  EXPECT_EQ(file->animations()[1].tracks[0].channel, 0U);
  EXPECT_EQ(file->extensions(), (std::vector<std::string>{"KHR_materials_unlit", "EXT_something"}));
}

TEST(GltfStructure, weights_are_zero_where_the_file_has_none) {
  const GltfFixture file(test::quad_document());
  ASSERT_TRUE(file.ok()) << file.error();
  EXPECT_EQ(file->meshes()[0].weights, (std::vector{0.0, 0.0}));
  EXPECT_TRUE(file->meshes()[0].target_names.empty());
}

TEST(GltfStructure, target_names_count_only_when_there_is_one_for_each) {
  for (const nlohmann::json& names :
       {nlohmann::json{"one"}, nlohmann::json{"one", 2}, nlohmann::json("one"), nlohmann::json{"a", "b", "c"}}) {
    GltfBuilder builder = test::quad_document();
    builder.json["meshes"][0]["extras"]["targetNames"] = names;
    const GltfFixture file(builder);
    ASSERT_TRUE(file.ok()) << file.error();
    EXPECT_TRUE(file->meshes()[0].target_names.empty()) << names;
  }
}

// A bake leaves a mark in the extras. Programs that rewrite a file may keep only the extras of nodes, and gltfpack
// moves the mesh into a new child node.
TEST(GltfStructure, mark_of_a_bake_is_found_in_the_node_of_a_mesh_or_above_it) {
  using Json = nlohmann::json;
  const auto mark = [](double factor) -> Json {
    return {{"version", 2},
            {"encode", "exact"},
            {"sequence", false},
            {"extras", {{{"target", 1}, {"linear", Json::array()}, {"quadratic", {{0, 0, factor}}}}}}};
  };
  // Returns the factor in the mark that the reader finds for the mesh, or 0 if it finds no mark.
  const auto factor_of = [](const GltfBuilder& builder) {
    const GltfFixture file(builder);
    EXPECT_TRUE(file.ok()) << file.error();
    const std::optional<GltfBakeMark>& found = file->meshes()[0].mark;
    return found && found->extras.size() == 1 ? found->extras[0].quadratic[0].q : 0.0;
  };
  GltfBuilder builder = test::quad_document();
  builder.json["nodes"] = Json::array({{{"children", {1}}}, {{"mesh", 0}}});
  EXPECT_EQ(factor_of(builder), 0);
  builder.json["nodes"][0]["extras"]["chronormal"] = mark(1);
  EXPECT_EQ(factor_of(builder), 1);
  builder.json["nodes"][1]["extras"]["chronormal"] = mark(2);
  EXPECT_EQ(factor_of(builder), 2);
  builder.json["meshes"][0]["extras"]["chronormal"] = mark(3);
  EXPECT_EQ(factor_of(builder), 3);

  builder.json["meshes"][0].erase("extras");
  builder.json["nodes"][1]["extras"]["chronormal"] = {{"version", 7}};
  const GltfFixture broken(builder);
  ASSERT_TRUE(broken.ok()) << broken.error();
  ASSERT_TRUE(broken->meshes()[0].mark_fault);
  EXPECT_EQ(broken->meshes()[0].mark_fault->place, "a.gltf, /nodes/1/extras/chronormal/version");

  // If node 0 has another mesh than its child, a mark in node 0 belongs only to that other mesh.
  builder.json["meshes"].push_back(builder.json["meshes"][0]);
  builder.json["nodes"][0]["mesh"] = 1;
  builder.json["nodes"][1].erase("extras");
  EXPECT_EQ(factor_of(builder), 0);
}

TEST(GltfStructure, mark_of_a_bake_says_whether_its_normals_are_still_those_of_the_author) {
  GltfBuilder builder = test::quad_document();
  nlohmann::json& mark = builder.json["meshes"][0]["extras"]["chronormal"];
  mark = {{"version", 2}, {"encode", "exact"}, {"sequence", false}, {"extras", nlohmann::json::array()}};
  EXPECT_FALSE(GltfFixture(builder)->meshes()[0].mark.value().author);
  for (const nlohmann::json& value : {nlohmann::json(true), nlohmann::json(1)}) {
    mark["author"] = value;
    EXPECT_TRUE(GltfFixture(builder)->meshes()[0].mark.value().author) << value;
  }
  mark["author"] = false;
  EXPECT_FALSE(GltfFixture(builder)->meshes()[0].mark.value().author);
  mark["author"] = "me";
  EXPECT_FALSE(GltfFixture(builder)->meshes()[0].mark);
}

TEST(GltfStructure, what_is_not_read_is_not_checked) {
  GltfBuilder builder = test::quad_document();
  builder.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 99}}}}}}};
  builder.json["meshes"][0]["primitives"][0]["material"] = 99;
  builder.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_0"] = 99;
  builder.json["meshes"][0]["primitives"][0]["attributes"]["_OWN"] = 99;
  builder.json["accessors"][0]["min"] = {9, 9, 9};
  builder.json["accessors"][0]["max"] = {"x"};
  builder.json["bufferViews"][0]["target"] = 34963;
  builder.json["skins"] = {{{"joints", {77}}}};
  builder.json["extras"] = {{"deep", {1, {2}}}};
  expect_quad(geometry_of(GltfFixture(builder)));
}

TEST(GltfStructure, harmless_required_extensions_are_accepted_and_others_are_refused_by_name) {
  for (const char* const name :
       {"KHR_mesh_quantization", "KHR_materials_unlit", "KHR_materials_clearcoat", "KHR_texture_transform",
        "KHR_texture_basisu", "EXT_texture_webp", "KHR_lights_punctual", "KHR_animation_pointer"}) {
    GltfBuilder builder = test::quad_document();
    builder.json["extensionsRequired"] = builder.json["extensionsUsed"] = {name};
    EXPECT_TRUE(GltfFixture(builder).ok()) << name;
  }
  for (const char* const name : {"EXT_mesh_gpu_instancing", "ACME_own", "KHR_material", ""}) {
    GltfBuilder builder = test::quad_document();
    builder.json["extensionsUsed"] = {name};
    EXPECT_TRUE(GltfFixture(builder).ok()) << name;
    builder.json["extensionsRequired"] = {name};
    const GltfFixture file(builder);
    ASSERT_FALSE(file.ok()) << name;
    EXPECT_EQ(file.result().error().code, ErrorCode::kInvalidInput);
    EXPECT_TRUE(file.error().starts_with("a.gltf, /extensionsRequired/0: ")) << file.error();
    EXPECT_NE(file.error().find(name), std::string::npos) << file.error();
  }
}

// Rotates each triangle so that its smallest corner is first. Keeps the winding.
Corners turned(Corners corners) {
  for (auto face = corners.begin(); face != corners.end(); face += 3)
    std::rotate(face, std::min_element(face, face + 3), face + 3);
  return corners;
}

// Makes a document with five vertices, and reads its geometry. The vertices suit every mode of primitives: in a
// triangle fan, vertex 0 is in the middle.
GltfGeometry five_vertices(int mode, std::optional<std::vector<std::uint8_t>> indices) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0});
  std::optional<std::size_t> corners;
  if (indices) corners = builder.add_indices(*indices);
  builder.add_mesh(GltfBuilder::primitive(base, corners, {}, mode));
  return geometry_of(GltfFixture(builder));
}

TEST(GltfPrimitiveModes, strips_alternate_their_winding) {
  EXPECT_EQ(turned(five_vertices(5, std::nullopt).corners), turned(Corners{0, 1, 2, 1, 3, 2, 2, 3, 4}));
  EXPECT_EQ(turned(five_vertices(5, std::vector<std::uint8_t>{4, 1, 0, 2}).corners), turned(Corners{4, 1, 0, 1, 2, 0}));
}

TEST(GltfPrimitiveModes, fans_turn_round_their_first_vertex) {
  // The specification defines triangle i of a fan as p_i = {v_(i+1), v_(i+2), v_0}.
  EXPECT_EQ(turned(five_vertices(6, std::nullopt).corners), turned(Corners{1, 2, 0, 2, 3, 0, 3, 4, 0}));
  EXPECT_EQ(turned(five_vertices(6, std::vector<std::uint8_t>{3, 1, 0, 2}).corners), turned(Corners{1, 0, 3, 0, 2, 3}));
}

TEST(GltfPrimitiveModes, restart_index_is_refused_even_where_there_is_such_a_vertex) {
  const auto read = [](const auto& indices) {
    GltfBuilder builder;
    std::vector<float> positions(3 * 65536);
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = static_cast<float>(i);
    const std::size_t base = builder.add_positions(positions);
    builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(indices)));
    const GltfFixture file(builder);
    return file.ok() && file->geometry(0, 0, {}).ok();
  };
  EXPECT_FALSE(read(std::vector<std::uint8_t>{0, 1, 255}));
  EXPECT_TRUE(read(std::vector<std::uint8_t>{0, 1, 254}));
  EXPECT_FALSE(read(std::vector<std::uint16_t>{0, 1, 65535}));
  EXPECT_TRUE(read(std::vector<std::uint16_t>{0, 1, 255}));
  EXPECT_TRUE(read(std::vector<std::uint32_t>{0, 1, 65535}));
}

TEST(GltfPrimitiveModes, triangles_without_indices_take_vertices_in_order) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions({0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, -1, 1, 0, 2, 2, 2});
  builder.add_mesh(GltfBuilder::primitive(base));
  EXPECT_EQ(geometry_of(GltfFixture(builder)).corners, (Corners{0, 1, 2, 3, 4, 5}));
}

TEST(GltfPrimitiveModes, corners_left_over_make_no_face) {
  GltfBuilder builder = test::quad_document();
  builder.json["accessors"][1]["count"] = 5;
  EXPECT_EQ(geometry_of(GltfFixture(builder)).corners, (Corners{0, 1, 2}));
  EXPECT_TRUE(five_vertices(5, std::vector<std::uint8_t>{4, 1}).corners.empty());
  EXPECT_TRUE(five_vertices(6, std::vector<std::uint8_t>{4, 1}).corners.empty());
}

TEST(GltfPrimitiveModes, points_and_lines_have_no_faces) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(test::kQuad);
  builder.add_mesh(GltfBuilder::primitive(base));
  for (const int mode : {0, 1, 2, 3}) builder.add_primitive(0, GltfBuilder::primitive(base, std::nullopt, {}, mode));
  builder.json["accessors"][base]["count"] = 3;
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  EXPECT_TRUE(file->meshes()[0].primitives[0].has_faces());
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_EQ(file->meshes()[0].primitives[i].mode, static_cast<int>(i) - 1);
    EXPECT_FALSE(file->meshes()[0].primitives[i].has_faces());
  }
}

TEST(GltfPrimitiveModes, primitive_without_positions_has_no_faces) {
  GltfBuilder builder = test::quad_document();
  builder.add_primitive(0, {{"attributes", {{"NORMAL", 0}}}, {"targets", {{{"NORMAL", 2}}, {{"NORMAL", 3}}}}});
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  EXPECT_FALSE(file->meshes()[0].primitives[1].has_faces());
}

TEST(GltfPrimitiveModes, indices_may_have_one_two_or_four_bytes) {
  const auto check = [](auto zero) {
    using Index = decltype(zero);
    GltfBuilder builder;
    const std::size_t base = builder.add_positions(test::kQuad);
    builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(std::vector<Index>{3, 1, 2, 0, 1, 3})));
    EXPECT_EQ(geometry_of(GltfFixture(builder)).corners, (Corners{3, 1, 2, 0, 1, 3}));
  };
  check(std::uint8_t{0});
  check(std::uint16_t{0});
  check(std::uint32_t{0});
}

TEST(GltfGeometry, shading_is_read_when_it_is_wanted) {
  GltfBuilder builder = test::quad_document();
  const std::vector<float> normals = {0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, -1};
  const std::vector<float> tangents = {1, 0, 0, 1, 0, 0, 1, -1, 0, 1, 0, 1, 0, 1, 0, -1};
  const std::vector<float> turn = {0.5F, 0, 0, 0, 0.5F, 0, 0, 0, 0.5F, 0, 0, 0},
                           twist = {0, 0, 0, 1, 2, 3, 4, 5, 6, 7, 8, 9};
  auto& primitive = builder.json["meshes"][0]["primitives"][0];
  primitive["attributes"]["NORMAL"] = builder.add_positions(normals);
  primitive["attributes"]["TANGENT"] = builder.add_accessor("VEC4", tangents);
  primitive["targets"][0] = {{"NORMAL", builder.add_positions(turn)}};
  primitive["targets"][1]["TANGENT"] = builder.add_positions(twist);
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  const GltfPrimitive& listed = file->meshes()[0].primitives[0];
  EXPECT_TRUE(listed.has_normals && listed.has_tangents);
  EXPECT_TRUE(!listed.targets[0].positions && listed.targets[0].normals && !listed.targets[0].tangents);
  EXPECT_TRUE(listed.targets[1].positions && !listed.targets[1].normals && listed.targets[1].tangents);

  const GltfGeometry all = geometry_of(file);
  EXPECT_EQ(all.normals, normals);
  EXPECT_EQ(all.tangents, tangents);
  ASSERT_EQ(all.targets.size(), 2U);
  EXPECT_TRUE(all.targets[0].positions.empty());
  EXPECT_EQ(all.targets[0].normals, turn);
  EXPECT_TRUE(all.targets[0].tangents.empty());
  EXPECT_EQ(all.targets[1].positions, test::kShift);
  EXPECT_TRUE(all.targets[1].normals.empty());
  EXPECT_EQ(all.targets[1].tangents, twist);

  const Result<GltfGeometry> plain = file->geometry(0, 0, {false, false});
  ASSERT_TRUE(plain.ok());
  EXPECT_EQ(plain.value().positions, test::kQuad);
  EXPECT_TRUE(plain.value().normals.empty() && plain.value().tangents.empty());
  for (const GltfGeometry::Target& target : plain.value().targets)
    EXPECT_TRUE(target.positions.empty() && target.normals.empty() && target.tangents.empty());
}

TEST(GltfGeometry, that_would_take_more_memory_than_allowed_is_refused) {
  GltfOptions options;
  options.most_bytes = 3 * 4 * 12;  // room for the base and two targets
  EXPECT_TRUE(GltfFixture(test::quad_document().glb(), std::nullopt, options)->geometry(0, 0, {}).ok());
  --options.most_bytes;
  const GltfFixture file(test::quad_document().glb(), std::nullopt, options);
  ASSERT_TRUE(file.ok()) << file.error();
  const Result<GltfGeometry> geometry = file->geometry(0, 0, {});
  ASSERT_FALSE(geometry.ok());
  EXPECT_EQ(geometry.error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(geometry.error().place, "a.gltf, /meshes/0/primitives/0");
  EXPECT_TRUE(file->geometry(0, 0, {false, false}).ok());
}

TEST(GltfGeometry, buffers_beyond_the_first_are_read) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(test::kQuad);
  builder.add_mesh(GltfBuilder::primitive(base, builder.add_accessor_over(1, "SCALAR", 5123, 6)));
  builder.json["bufferViews"].push_back({{"buffer", 1}, {"byteLength", 12}});
  builder.json["buffers"] = {
      nlohmann::json::object(),
      {{"byteLength", 12},
       {"uri", "data:application/octet-stream;base64," + test::base64(test::bytes_of(test::kQuadCorners))}}};
  const GltfGeometry geometry = geometry_of(GltfFixture(builder));
  EXPECT_EQ(geometry.positions, test::kQuad);
  EXPECT_EQ(geometry.corners, (Corners{0, 1, 2, 0, 2, 3}));
}

TEST(GltfFindAnimation, goes_by_name_and_then_by_index) {
  GltfBuilder builder = test::quad_document();
  for (const char* const name : {"walk", "", "0", "walk"})
    builder.add_track<float>(builder.add_animation(name), 0, {0, 1}, {0, 0, 1, 1});
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  const auto find = [&](const char* name) {
    const Result<std::size_t> found = file->find_animation(name);
    return found ? static_cast<int>(found.value()) : -1;
  };
  EXPECT_EQ(find("walk"), 0);
  EXPECT_EQ(find("0"), 2);
  EXPECT_EQ(find("1"), 1);
  EXPECT_EQ(find("3"), 3);
  for (const char* const name : {"run", "4", "-1", "1.5", "1 ", "18446744073709551617", "Walk"}) {
    const Result<std::size_t> found = file->find_animation(name);
    ASSERT_FALSE(found.ok()) << name;
    EXPECT_EQ(found.error().code, ErrorCode::kUsage);
    EXPECT_NE(found.error().text().find("walk"), std::string::npos) << found.error().text();
  }
}

}  // namespace
}  // namespace chronormal::gltf_document_test
