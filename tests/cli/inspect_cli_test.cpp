// Tests the results of `inspect` that scripts and people read: the facts about a file, the problems that it reports,
// the JSON, and the exit codes.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/gltf_builder.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::inspect_cli_test {
namespace {

using Json = nlohmann::json;

class InspectCli : public testing::Test {
 protected:
  InspectCli() {
    folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    folder_.write("over.obj", "v 0 0 0\nv 1 0 0\nv 0 -1 0\nf 1 2 3\n");
    folder_.write("line.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
    folder_.write("quad.glb", test::quad_document().glb());
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments, const std::string& input = "") const {
    return run_shell(std::string(kProgram) + " inspect " + arguments, folder_.path(), input);
  }
  [[nodiscard]] std::string text_of(const std::string& arguments, const std::string& input = "") const {
    const ProcessResult result = run(arguments, input);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return result.out;
  }
  [[nodiscard]] Json json_of(const std::string& arguments, const std::string& input = "") const {
    return Json::parse(text_of(arguments + " --json", input));
  }
  void expect_error(const std::string& arguments, int exit_code, const std::string& word) const {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
  }

  test::TemporaryFolder folder_;
};

void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << "\nin\n" << text;
}

std::vector<std::string> kinds_of(const Json& json) {
  std::vector<std::string> kinds;
  for (const Json& trouble : json["trouble"]) kinds.push_back(trouble["kind"]);
  return kinds;
}

TEST_F(InspectCli, mesh_without_trouble_says_so) {
  const std::string text = text_of("a.obj");
  expect_words(text,
               {"a.obj: 3 vertices, 1 triangle, no motion\n", "1 piece, 3 edges; 3 open", "\nno problems found\n"});
  EXPECT_EQ(text.find("What can make normals wrong"), std::string::npos);
  EXPECT_TRUE(json_of("a.obj")["trouble"].empty());
}

TEST_F(InspectCli, trouble_says_what_where_and_what_it_means) {
  expect_words(
      text_of("a.obj over.obj"),
      {"1 face turns over between two keyframes, at an instant without area (face 0 in segment 0 at t = 0.5000)\n"
       "    the normal flips to the opposite direction at that instant\n",
       "90 degrees"});
  expect_words(text_of("a.obj line.obj"), {"1 face has no area at a keyframe (face 0 at keyframe 1 (line.obj))\n"});
  expect_words(text_of("line.obj"), {"1 face has no area (face 0)\n", "there is no normal, so results have (0, 0, 0)"});
  EXPECT_EQ(kinds_of(json_of("line.obj line.obj")), (std::vector<std::string>{"no_normal", "no_area_at_keyframe"}));
  EXPECT_EQ(kinds_of(json_of("a.obj over.obj")), (std::vector<std::string>{"turns_over", "turns_far"}));
}

TEST_F(InspectCli, json_is_one_object_with_schema_1) {
  const Json json = json_of("a.obj over.obj a.obj");
  EXPECT_EQ(json["chronormal"], kVersion);
  EXPECT_EQ(json["command"], "inspect");
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["input"],
            Json({{"name", "a.obj ... a.obj"}, {"vertices", 3}, {"faces", 1}, {"keyframes", 3}, {"segments", 2}}));
  EXPECT_EQ(json["kind"], "sequence");
  EXPECT_EQ(json["segments"].size(), 2U);
  EXPECT_EQ(json["segments"][1]["turns_over"], 1);
  EXPECT_EQ(json["segment_faces"]["turns_over"]["pairs"], 2);
  EXPECT_EQ(json["segment_faces"]["turns_over"]["faces"], 1);
  EXPECT_EQ(json["segment_faces"]["turns_over"]["first"], Json({{"segment", 0}, {"face", 0}, {"t", 0.5}}));
  EXPECT_EQ(json["keyframe_faces"]["no_area"]["first"], nullptr);
  EXPECT_NEAR(json["largest_turn"]["degrees"].get<double>(), 180, 1e-9);
  EXPECT_EQ(json["surface"]["open_edges"]["count"], 3);
  EXPECT_FALSE(json.contains("gltf"));
  EXPECT_EQ(json_of("a.obj")["kind"], "mesh");
}

TEST_F(InspectCli, gltf_shows_primitives_targets_and_tracks) {
  test::GltfBuilder builder = test::quad_document();
  builder.json["meshes"][0]["extras"] = {{"targetNames", {"lift", "shift"}}};
  const std::size_t animation = builder.add_animation("wave");
  builder.add_track(animation, 0, {0.5F, 2}, std::vector<float>{0, 0.25F, 1.5F, 0});
  folder_.write("wave.glb", builder.glb());
  const std::string text = text_of("wave.glb");
  expect_words(text, {"4 vertices, 2 triangles, 2 targets", "quad / 0", "lift", "shift", "wave", "LINEAR", "1.50",
                      "1 primitive has no normals (quad, primitive 0)",
                      "1 track with weights outside of 0 to 1, from 0 to 1.5"});
  const Json json = json_of("wave.glb");
  EXPECT_EQ(json["kind"], "targets");
  EXPECT_EQ(json["segments"][0]["name"], "lift");
  EXPECT_EQ(json["gltf"]["meshes"][0]["target_names"], Json({"lift", "shift"}));
  EXPECT_EQ(json["gltf"]["meshes"][0]["primitives"][0]["triangles"], 2);
  EXPECT_EQ(json["gltf"]["animations"][0]["weight_tracks"][0]["keys"], 2);
  EXPECT_EQ(json["gltf"]["parts"].size(), 1U);
}

TEST_F(InspectCli, gltf_is_known_by_its_content_too) {
  const std::string bytes = test::read_whole(folder_ / "quad.glb");
  folder_.write("no_extension", bytes);
  EXPECT_EQ(json_of("no_extension")["gltf"]["meshes"][0]["name"], "quad");
  EXPECT_EQ(json_of("-", bytes)["gltf"]["meshes"][0]["name"], "quad");
  EXPECT_EQ(json_of("-", test::read_whole(folder_ / "a.obj"))["input"]["faces"], 1);
}

TEST_F(InspectCli, gltf_without_targets_is_a_mesh_and_without_faces_is_no_error) {
  test::GltfBuilder still = test::quad_document();
  still.json["meshes"][0]["primitives"][0].erase("targets");
  folder_.write("still.glb", still.glb());
  EXPECT_EQ(json_of("still.glb")["kind"], "mesh");
  still.json["meshes"][0]["primitives"][0]["mode"] = 0;
  folder_.write("points.glb", still.glb());
  expect_words(text_of("points.glb"), {"points.glb: no faces", "1 primitive is points, lines or empty"});
  EXPECT_EQ(json_of("points.glb")["input"]["faces"], 0);
}

TEST_F(InspectCli, base_with_targets_is_a_table_of_targets) {
  const std::string text = text_of("--base a.obj over.obj line.obj");
  expect_words(text, {"2 targets", "target  ", "0  over ", "1  line ", "in target 0 (over) at w = 0.5000",
                      "at keyframe 2 (line)"});
  EXPECT_EQ(json_of("--base a.obj over.obj line.obj")["kind"], "targets");
}

TEST_F(InspectCli, names_can_not_write_to_the_terminal) {
  test::GltfBuilder builder = test::quad_document();
  builder.json["meshes"][0]["name"] = "red \x1b[31m\nline \xE2\x80\xAE turned";
  builder.json["meshes"][0]["extras"] = {{"targetNames", {"caf\xC3\xA9", std::string(500, 'x')}}};
  folder_.write("names.glb", builder.glb());
  const std::string text = text_of("names.glb");
  expect_words(text, {"red \\x1b[31m\\x0aline", "caf\xC3\xA9", "xxx..."});
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
  EXPECT_EQ(text.find("\xE2\x80\xAE"), std::string::npos);
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) EXPECT_LT(line.size(), 180U) << line;
  EXPECT_EQ(json_of("names.glb")["gltf"]["meshes"][0]["name"], "red \x1b[31m\nline \xE2\x80\xAE turned");
}

TEST_F(InspectCli, columns_are_aligned_below_their_titles_even_with_accents) {
  test::GltfBuilder builder = test::quad_document();
  builder.json["meshes"][0]["extras"] = {{"targetNames", {"\xC3\xA9\xC3\xA9", "plain!"}}};
  folder_.write("accents.glb", builder.glb());
  std::istringstream lines(text_of("accents.glb"));
  std::vector<std::string> rows;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("0  ") || line.starts_with("1  ")) rows.push_back(line);
  }
  ASSERT_EQ(rows.size(), 2U);
  EXPECT_EQ(rows[0].size(), rows[1].size() + 2);  // the name has two accented letters of two bytes each
}

TEST_F(InspectCli, errors_and_output_are_as_in_other_commands) {
  expect_error("", 2, "there is no input");
  expect_error("a.obj --sample twist", 2, "give either files or one --sample");
  expect_error("a.obj --nonsense", 2, "--nonsense");
  expect_error("missing.glb", 1, "missing.glb");
  folder_.write("bad.glb", "glTF but not really");
  expect_error("bad.glb", 3, "bad.glb");
  folder_.write("bad.obj", "v 0 0 0\nf 1 2 3\n");
  expect_error("bad.obj", 3, "bad.obj");
  EXPECT_EQ(text_of("a.obj -o out.txt"), "");
  EXPECT_EQ(test::read_whole(folder_ / "out.txt"), text_of("a.obj"));
  expect_error("a.obj -o out.txt", 1, "--force");
  EXPECT_EQ(text_of("a.obj --json -o out.txt --force"), "");
  EXPECT_EQ(Json::parse(test::read_whole(folder_ / "out.txt"))["command"], "inspect");
  expect_words(text_of("--help"), {"--json", "--base", "Exit codes"});
}

TEST_F(InspectCli, face_with_a_point_twice_is_told) {
  folder_.write("rep.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 1 3\n");
  expect_words(text_of("rep.obj"), {"2 edges; 2 open", "1 face has the same point at two corners (face 0)"});
}

TEST_F(InspectCli, standard_input_has_one_name) {
  const std::string mesh = test::read_whole(folder_ / "a.obj"), gltf = test::read_whole(folder_ / "quad.glb");
  EXPECT_TRUE(text_of("-", mesh).starts_with("<stdin>: "));
  EXPECT_TRUE(text_of("-", gltf).starts_with("<stdin>: "));
}

TEST_F(InspectCli, gltf_parts_name_their_nodes_and_the_animation_is_named) {
  test::GltfBuilder builder = test::quad_document();
  builder.add_node(0, {{"name", "twin"}, {"translation", {5, 0, 0}}});
  builder.add_track(builder.add_animation("wave"), 0, {0, 1}, std::vector<float>{0, 0, 1, 0});
  folder_.write("twins.glb", builder.glb());
  const Json still = json_of("twins.glb")["gltf"], world = json_of("twins.glb --world")["gltf"];
  EXPECT_EQ(still["animation"], nullptr);
  EXPECT_EQ(still["curve_error"], 0);
  EXPECT_EQ(still["parts"][0]["node"], nullptr);
  ASSERT_EQ(world["parts"].size(), 2U);
  EXPECT_EQ(world["parts"][1]["node"], 1);
  EXPECT_EQ(json_of("twins.glb --animation wave")["gltf"]["animation"], 0);
  expect_words(text_of("twins.glb --world"), {"of quad, primitive 0, node 0"});
}

TEST_F(InspectCli, every_builtin_morph_is_inspected) {
  for (const char* const name : {"cloth", "bend", "twist", "eversion", "soup"}) {
    const Json json = json_of(std::string("--sample ") + name);
    EXPECT_EQ(json["kind"], "sequence") << name;
    EXPECT_GT(json["bytes"]["normals"], 0) << name;
  }
}

}  // namespace
}  // namespace chronormal::inspect_cli_test
