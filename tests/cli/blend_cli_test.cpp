// Tests the outputs of `compare --blend` that scripts depend on: text, JSON and CSV, the compared normals, and refused
// requests.

#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/gltf_builder.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/shaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::blend_cli_test {
namespace {

using Json = nlohmann::json;

class BlendCli : public testing::Test {
 protected:
  BlendCli() {
    folder_.write("base.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
    folder_.write("lift.target", "3 0 0 .5\n1 -.25 .125 .1\n");
    folder_.write("smile.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 2\nf 1 2 3\nf 1 3 4\n");
    test::GltfBuilder builder = test::random_sheet(1, 5, 2, 0.2).file();
    builder.json["meshes"][0]["name"] = "sheet";
    builder.json["meshes"][0]["extras"]["targetNames"] = {"left", "right, \"up\""};
    builder.add_track<float>(builder.add_animation("walk"), 0, {0, 1}, {1, 0, 0, 1});
    folder_.write("sheet.glb", builder.glb());
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments) const {
    return run_shell("COLUMNS=200 " + std::string(kProgram) + " compare " + arguments, folder_.path());
  }
  [[nodiscard]] Json json_of(const std::string& arguments) const {
    const ProcessResult result = run("--json " + arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return result.exit_code == 0 ? Json::parse(result.out) : Json();
  }
  void expect_misuse(const std::string& arguments, const std::vector<std::string>& words) const {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << "\n" << result.err;
    EXPECT_EQ(result.out, "");
    for (const std::string& word : words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
  }

  test::TemporaryFolder folder_;
};

std::vector<std::string> names_of_deltas(const Json& errors) {
  std::vector<std::string> names;
  for (const Json& one : errors["deltas"]) names.push_back(one["deltas"]);
  return names;
}

TEST_F(BlendCli, file_has_its_own_deltas_and_targets_by_name) {
  const Json json = json_of("sheet.glb --blend 3");
  EXPECT_EQ(json["command"], "compare");
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["input"], "sheet.glb");
  EXPECT_EQ(json["weights"], "random");
  ASSERT_EQ(json["meshes"].size(), 1U);
  const Json& mesh = json["meshes"][0];
  EXPECT_EQ(mesh["name"], "sheet");
  EXPECT_EQ(mesh["vertices"], 25);
  EXPECT_EQ(mesh["targets"], 2);
  ASSERT_EQ(mesh["errors"].size(), 2U);
  EXPECT_EQ(mesh["errors"][1]["active"], 2);
  EXPECT_EQ(mesh["errors"][1]["rows"], 3);
  EXPECT_EQ(names_of_deltas(mesh["errors"][1]),
            (std::vector<std::string>{"file", "end point", "least squares", "exact"}));
  const Json& file = mesh["errors"][1]["deltas"][0];
  EXPECT_GT(file["max_degrees"], 1.0);
  EXPECT_GE(file["rms_degrees"], file["mean_degrees"]);
  ASSERT_EQ(file["max_at"]["weights"].size(), 2U);
  EXPECT_EQ(file["max_at"]["weights"][1]["name"], "right, \"up\"");
  EXPECT_EQ(file["max_at"]["primitive"], 0);
  EXPECT_LT(file["max_at"]["vertex"], 25);
}

TEST_F(BlendCli, elements_that_are_asked_for_come_from_the_geometry) {
  const Json corners = json_of("sheet.glb --blend 3 --elements faces")["meshes"][0];
  EXPECT_EQ(corners["elements"], "faces");
  EXPECT_EQ(names_of_deltas(corners["errors"][0]), (std::vector<std::string>{"end point", "least squares", "exact"}));
  const Json base = json_of("--base base.obj smile.obj lift.target --blend 3")["meshes"][0];
  EXPECT_EQ(base["elements"], "vertices");
  EXPECT_EQ(base["targets"], 2);
  EXPECT_FALSE(base.contains("mesh"));
  EXPECT_EQ(json_of("--base base.obj smile.obj --blend 3 --elements corners --crease 30")["meshes"][0]["normals"], 4);
  EXPECT_EQ(json_of("sheet.glb --blend 3 --elements vertices --world")["meshes"][0]["normals"], 25);
}

TEST_F(BlendCli, animation_takes_the_place_of_random_weights) {
  const Json json = json_of("sheet.glb --blend 5 --animation walk");
  EXPECT_EQ(json["weights"], "animation");
  EXPECT_EQ(json["animation"], "walk");
  ASSERT_EQ(json["meshes"][0]["errors"].size(), 1U);
  EXPECT_EQ(json["meshes"][0]["errors"][0]["rows"], 5);
}

TEST_F(BlendCli, table_has_a_line_for_each_number_and_kind_and_the_same_bytes_on_every_run) {
  const ProcessResult result = run("--sample bumps --blend 4 --seed 7");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(std::count(result.out.begin(), result.out.end(), '\n'), 5 + 5 * 3);
  for (const char* const words : {"bumps: 3,136 vertices, 6,144 faces, 12 targets\n", "4 random poses", "end point",
                                  "least squares", "exact", "bump_", " and 9 more\n"})
    EXPECT_NE(result.out.find(words), std::string::npos) << words << result.out;
  EXPECT_EQ(run("--sample bumps --blend 4 --seed 7").out, result.out);
  EXPECT_NE(run("--sample bumps --blend 4 --seed 8").out, result.out);
  const std::string file = run("sheet.glb --blend 4").out;
  EXPECT_TRUE(file.starts_with("sheet.glb, mesh 0 'sheet': 25 vertices, ")) << file;
  EXPECT_NE(file.find("25 vertices with normals"), std::string::npos) << file;
}

TEST_F(BlendCli, csv_has_a_header_and_a_line_for_each_with_as_many_fields) {
  const ProcessResult result = run("sheet.glb --blend 2 --csv --active 2");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  std::istringstream stream(result.out);
  std::vector<std::string> lines;
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 5U);
  EXPECT_TRUE(lines[0].starts_with("input,mesh,")) << lines[0];
  const auto fields = [](const std::string& line) {
    bool quoted = false;
    std::size_t count = 1;
    for (const char c : line) {
      if (c == '"') quoted = !quoted;
      if (c == ',' && !quoted) ++count;
    }
    return count;
  };
  for (const std::string& line : lines) EXPECT_EQ(fields(line), fields(lines[0])) << line;
  EXPECT_TRUE(lines[1].starts_with("sheet.glb,0,25,32,2,vertices,2,2,file,")) << lines[1];
  EXPECT_NE(lines[1].find("\"left:"), std::string::npos) << lines[1];
}

TEST_F(BlendCli, output_goes_to_a_file_and_is_not_overwritten) {
  EXPECT_EQ(run("--sample bumps --blend 1 -o out.txt").exit_code, 0);
  EXPECT_EQ(test::read_whole(folder_ / "out.txt"), run("--sample bumps --blend 1").out);
  EXPECT_NE(run("--sample bumps --blend 1 -o out.txt").exit_code, 0);
}

TEST_F(BlendCli, names_in_files_cannot_reach_the_terminal) {
  test::GltfBuilder builder = test::random_sheet(1, 4, 1, 0.2).file();
  builder.json["meshes"][0]["name"] = "a\x1b[31mb";
  builder.json["meshes"][0]["extras"]["targetNames"] = {"c\x1b]0;d"};
  folder_.write("evil.glb", builder.glb());
  const ProcessResult result = run("evil.glb --blend 2");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.out.find('\x1b'), std::string::npos) << result.out;
}

TEST_F(BlendCli, wrong_usage_is_exit_2_and_says_what_to_do) {
  expect_misuse("sheet.glb --blend 0", {"--blend", "1 to 10,000"});
  expect_misuse("sheet.glb --blend 10001", {"--blend", "1 to 10,000"});
  expect_misuse("sheet.glb --blend many", {"--blend"});
  expect_misuse("sheet.glb --blend -3", {"--blend"});
  expect_misuse("base.obj smile.obj --blend 3", {"--blend", "sequence", "only for blend shapes"});
  expect_misuse("--sample bend --blend 3", {"--blend", "sequence"});
  expect_misuse("--sample cloth --blend 3", {"--blend", "sequence"});
  expect_misuse("sheet.glb --active 1", {"--active", "--blend"});
  expect_misuse("sheet.glb --seed 1", {"--seed", "--blend"});
  expect_misuse("sheet.glb --blend 3 --active 0", {"--active", "at least 1"});
  expect_misuse("sheet.glb --blend 3 --active 3", {"--active", "2 targets"});
  expect_misuse("--sample bumps --blend 3 --active 13", {"--active", "12 targets"});
  expect_misuse("sheet.glb --blend 3 --animation walk --active 1", {"--active", "animation"});
  expect_misuse("sheet.glb --blend 3 --animation walk --elements faces", {"--animation", "--elements"});
  expect_misuse("sheet.glb --blend 3 --animation run", {"no animation 'run'", "walk"});
  expect_misuse("--base base.obj smile.obj --blend 3 --animation walk", {"--animation"});
  expect_misuse("sheet.glb --blend 3 --world", {"--world", "--elements"});
  expect_misuse("sheet.glb --blend 3 --crease 30", {"--elements"});
  expect_misuse("--sample bumps --blend 3 --crease 30", {"--crease", "corners"});
  for (const char* const other : {"--schemes linear", "--samples 3", "--access random", "--each"})
    expect_misuse(std::string("sheet.glb --blend 3 ") + other, {"--blend"});
  expect_misuse("--blend 3", {"there is no input"});
}

TEST_F(BlendCli, wrong_input_is_exit_3) {
  folder_.write("broken.glb", "glTF and nothing else");
  EXPECT_EQ(run("broken.glb --blend 3").exit_code, 3);
  test::ShadedMesh flat = test::random_sheet(1, 4, 1, 0.2);
  flat.normals.clear();
  flat.targets[0].normals.clear();
  folder_.write("flat.glb", flat.file().glb());
  const ProcessResult result = run("flat.glb --blend 3");
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("the file has no mesh with both morph targets and normals; export the mesh with both"),
            std::string::npos)
      << result.err;
  EXPECT_EQ(run("flat.glb --blend 3 --elements vertices").exit_code, 0);
}

}  // namespace
}  // namespace chronormal::blend_cli_test
