// What scripts and people get from `audit`: the verdict, the tables, the JSON, exit codes.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "chronormal/workflow/hosts.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/shaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::audit_cli_test {
namespace {

using Json = nlohmann::json;

class AuditCli : public testing::Test {
 protected:
  AuditCli() {
    folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n");
    folder_.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nvn 0 -1 0\nf 1//1 2//1 3//1\n");
    folder_.write("stale.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nvn 0 0 1\nf 1//1 2//1 3//1\n");
    folder_.write("bare.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
    test::GltfBuilder builder = test::hinge().file();
    builder.json["meshes"][0]["name"] = "Hinge";
    builder.json["meshes"][0]["extras"]["targetNames"] = {"fold\x1b[2J"};
    builder.add_track(builder.add_animation("swing"), 0, std::vector<float>{0, 2}, std::vector<float>{0, 1});
    folder_.write("hinge.glb", builder.glb());
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments, const std::string& input = "") const {
    return run_shell(std::string(kProgram) + " audit " + arguments, folder_.path(), input);
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
    EXPECT_EQ(result.out, "") << arguments;
    EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
  }

  test::TemporaryFolder folder_;
};

void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << "\nin\n" << text;
}

TEST_F(AuditCli, verdict_comes_first_and_what_to_do_last) {
  const std::string text = text_of("hinge.glb");
  EXPECT_EQ(text.find("hinge.glb: worst 90.00 degrees, mean "), 0U) << text;
  expect_words(text,
               {"vertex 3 of Hinge, primitive 0, target 0 (fold\\x1b[2J) at weight 1\n",
                "shown by the rule gltf, from the stored normals; 126 pairs judged in 2 motions\n",
                "animation 0 (swing), node 0", "90 and more",
                "target 0 (fold\\x1b[2J) of Hinge moves positions and no normals (1 primitive): off by up to 90.00"});
  const std::string last =
      "\nto write normals that are right at every instant: chronormal bake hinge.glb -o baked.glb\n";
  ASSERT_GT(text.size(), last.size());
  EXPECT_EQ(text.substr(text.size() - last.size()), last);
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}

TEST_F(AuditCli, tolerance_is_a_gate) {
  const ProcessResult beyond = run("hinge.glb --tolerance 89.9");
  EXPECT_EQ(beyond.exit_code, 4);
  expect_words(beyond.out, {"worst 90.00 degrees, ", ", beyond 89.9 degrees\n"});
  EXPECT_EQ(beyond.err,
            "chronormal audit: the worst error is 90 degrees, beyond the tolerance of 89.9: "
            "vertex 3 of Hinge, primitive 0, target 0 (fold\\x1b[2J) at weight 1\n");
  expect_words(text_of("hinge.glb --tolerance 90.1"), {", within 90.1 degrees\n"});
  const ProcessResult json = run("hinge.glb --tolerance 1 --json");
  EXPECT_EQ(json.exit_code, 4);
  EXPECT_EQ(Json::parse(json.out)["passed"], false);
  EXPECT_EQ(json_of("hinge.glb --tolerance 91")["passed"], true);
  EXPECT_EQ(json_of("hinge.glb")["passed"], Json());
}

TEST_F(AuditCli, hosts_have_a_row_each_below_the_specification) {
  const std::string text = text_of("hinge.glb --host three,godot");
  expect_words(text, {"\nhost ", "\n(specification) ", "\nthree.js ", "\nGodot 4 "});
  EXPECT_LT(text.find("(specification)"), text.find("three.js"));
  EXPECT_LT(text.find("three.js"), text.find("Godot 4"));
  EXPECT_LT(text.find("Godot 4"), text.find("\nmotion "));
  EXPECT_EQ(text.find("Filament"), std::string::npos);
  EXPECT_EQ(text_of("hinge.glb").find("(specification)"), std::string::npos);
  const std::string all = text_of("hinge.glb --host all");
  for (const Host& host : kHosts) expect_words(all, {"\n" + std::string(host.title) + " "});
}

TEST_F(AuditCli, hosts_are_in_the_json_with_their_errors_and_sources) {
  const Json json = json_of("hinge.glb --host filament,gltfpack");
  ASSERT_EQ(json["hosts"].size(), 2U);
  const Json& filament = json["hosts"][0];
  EXPECT_EQ(filament["name"], "filament");
  EXPECT_EQ(filament["title"], "Filament");
  EXPECT_EQ(filament["normals"], "unit");
  EXPECT_EQ(filament["tracks"], "splines_without_duration");
  EXPECT_EQ(filament["most_targets"], 256);
  EXPECT_FALSE(filament["source"].get<std::string>().empty());
  EXPECT_EQ(filament["passed"], Json());
  for (const char* key : {"worst_degrees", "mean_degrees", "percentile_99_degrees", "percentile_99_9_degrees"}) {
    EXPECT_NEAR(filament[key].get<double>(), json[key].get<double>(), 1e-4) << key;
    EXPECT_GE(json["worst_degrees"], json[key]) << key;
  }
  EXPECT_EQ(filament["judged"], json["judged"]);
  EXPECT_EQ(filament["worst_at"]["vertex"], 3);
  EXPECT_EQ(filament["worst_subject"], 0);
  EXPECT_EQ(filament["displaced_share"], 0.0);
  EXPECT_EQ(json["hosts"][1]["most_targets"], Json());
  EXPECT_EQ(json["hosts"][1]["tracks"], "all_resampled");
  EXPECT_EQ(json_of("hinge.glb")["hosts"], Json::array());
}

TEST_F(AuditCli, tolerance_is_a_gate_for_every_host_that_is_named) {
  // Each normal is right at weight 1, and on the way the long one turns too soon where deltas are added as they are.
  test::ShadedMesh mesh = test::hinge();
  mesh.targets[0].normals = {0, 0, 0, -1, 0, 0, -1, 0, 0, -3, 0, -1};
  folder_.write("long.glb", mesh.file().glb());
  const std::string one_weight = "long.glb --samples 2 --tolerance 1";
  EXPECT_EQ(run(one_weight).exit_code, 0);
  EXPECT_EQ(run(one_weight + " --host three,godot").exit_code, 0);
  const ProcessResult half_way = run("long.glb --samples 3 --tolerance 20 --host three,godot");
  EXPECT_EQ(half_way.exit_code, 4);
  expect_words(half_way.out, {"within 20 degrees in 1 of 2 hosts\n", "beyond the tolerance"});
  expect_words(half_way.err, {"chronormal audit: three.js: the worst error is ",
                              " degrees, beyond the tolerance of 20: vertex 3 of "});
  EXPECT_EQ(half_way.err.find("Godot"), std::string::npos);
  const Json json = Json::parse(run("long.glb --samples 3 --tolerance 20 --host three,godot --json").out);
  EXPECT_EQ(json["passed"], false);
  EXPECT_EQ(json["hosts"][0]["passed"], false);
  EXPECT_EQ(json["hosts"][1]["passed"], true);
  EXPECT_EQ(Json::parse(run("long.glb --samples 3 --tolerance 20 --host godot --json").out)["passed"], true);
}

TEST_F(AuditCli, hosts_that_there_are_none_of_are_a_misuse) {
  expect_error("hinge.glb --host gdot", 2, "did you mean godot?");
  expect_error("hinge.glb --host unreal", 2, "there are three, babylon, ");
  expect_error("hinge.glb --host all --rule slerp", 2, "--host");
  expect_error("a.obj b.obj --host all", 2, "--host");
}

TEST_F(AuditCli, gate_is_shut_for_what_cannot_be_lit) {
  test::ShadedMesh mesh = test::hinge();
  mesh.targets[0].normals = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1};
  folder_.write("zero.glb", mesh.file().glb());
  mesh.targets[0].normals.assign(12, 3e38F);
  mesh.targets.push_back({std::vector<float>(12, 0), std::vector<float>(12, -3e38F), {}});
  test::GltfBuilder huge = mesh.file();
  huge.add_track(huge.add_animation("huge"), 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 100, 100});
  folder_.write("nan.glb", huge.glb());
  for (const std::string file : {"zero.glb", "nan.glb --animation huge"}) {
    for (const std::string tolerance : {"1", "180", "1000"}) {
      const ProcessResult result = run(file + " --tolerance " + tolerance);
      EXPECT_EQ(result.exit_code, 4);
      expect_words(result.out,
                   {"worst 180.00 degrees, ", " cannot be lit, which counts as 180 degrees: the first is at vertex ",
                    " cannot be lit: what is shown is zero, infinite or no number (vertex "});
      expect_words(result.err, {" cannot be lit, which no tolerance allows: vertex "});
    }
    const Json json = Json::parse(run(file + " --tolerance 180 --json").out);
    EXPECT_EQ(json["passed"], false);
    EXPECT_GT(json["unlit"], 0);
    EXPECT_EQ(json["worst_degrees"], 180.0);
    EXPECT_TRUE(json["mean_degrees"].is_number());
    EXPECT_EQ(json["subjects"][0]["unlit"], json["unlit"]);
    EXPECT_TRUE(json["subjects"][0]["unlit_at"].contains("vertex"));
    EXPECT_EQ(json["findings"][0]["kind"], "unlit");
    EXPECT_EQ(json["findings"][0]["fault"], true);
  }
  EXPECT_EQ(json_of("hinge.glb")["subjects"][0]["unlit_at"], Json());
}

TEST_F(AuditCli, json_is_one_object_with_schema_1) {
  const Json json = json_of("hinge.glb --samples 2");
  EXPECT_EQ(json["command"], "audit");
  EXPECT_EQ(json["schema"], 1);
  EXPECT_EQ(json["input"]["name"], "hinge.glb");
  EXPECT_EQ(json["rule"], "gltf");
  EXPECT_EQ(json["weighting"], "area");
  EXPECT_EQ(json["judged"], 12);
  EXPECT_DOUBLE_EQ(json["worst_degrees"], 90);
  EXPECT_DOUBLE_EQ(json["mean_degrees"], 30);
  EXPECT_EQ(json["worst_at"], (Json{{"mesh", 0}, {"primitive", 0}, {"vertex", 3}, {"segment", 0}, {"weight", 1.0}}));
  EXPECT_EQ(json["histogram"].size(), 10U);
  ASSERT_EQ(json["subjects"].size(), 2U);
  EXPECT_EQ(json["subjects"][0]["kind"], "target");
  EXPECT_EQ(json["subjects"][1]["kind"], "track");
  EXPECT_EQ(json["subjects"][1]["name"], "swing");
  EXPECT_DOUBLE_EQ(json["subjects"][1]["worst_at"]["time"], 2);
  ASSERT_EQ(json["findings"].size(), 1U);
  EXPECT_EQ(json["findings"][0]["kind"], "missing_normals");
  EXPECT_EQ(json["findings"][0]["fault"], true);
  EXPECT_EQ(json["authored_offsets"][0]["vertices"], 4);
}

TEST_F(AuditCli, sequence_is_judged_by_its_stored_normals_or_by_those_of_a_player) {
  Json json = json_of("a.obj b.obj");
  EXPECT_EQ(json["rule"], "nlerp");
  EXPECT_EQ(json["stored_normals"], true);
  EXPECT_LT(json["worst_degrees"], 1e-4);
  expect_words(text_of("a.obj b.obj"), {"nothing to do: no normal is off by more than 1 degree\n"});
  json = json_of("a.obj stale.obj");
  EXPECT_NEAR(json["worst_degrees"], 90, 1e-9);
  EXPECT_EQ(json["findings"][0]["kind"], "wrong_at_keys");
  json = json_of("a.obj bare.obj --rule slerp");
  EXPECT_EQ(json["stored_normals"], false);
  EXPECT_GT(json["worst_degrees"], 4);
  expect_words(
      text_of("bare.obj a.obj --rule slerp"),
      {"normals that a host computes at keyframes, where none are stored", "right at keyframes, and off by up to"});
}

TEST_F(AuditCli, built_in_morphs_and_targets_of_a_base_are_inputs) {
  expect_words(text_of("--sample twist --samples 3"), {"twist: worst ", "chronormal bake --sample twist"});
  expect_words(text_of("--base a.obj b.obj bare.obj --rule slerp"),
               {"put the targets into a glTF file, and bake that\n"});
  const Json json = json_of("--base a.obj b.obj bare.obj");
  ASSERT_EQ(json["subjects"].size(), 2U);
  EXPECT_EQ(json["subjects"][1]["target"], 1);
  EXPECT_EQ(json["subjects"][0]["name"], "b");
}

TEST_F(AuditCli, file_comes_on_standard_input_and_leaves_by_o) {
  const std::string bytes = test::read_whole(folder_ / "hinge.glb");
  expect_words(text_of("-", bytes), {"<stdin>: worst 90.00"});
  EXPECT_EQ(text_of("hinge.glb --json -o out.json"), "");
  EXPECT_EQ(Json::parse(test::read_whole(folder_ / "out.json"))["schema"], 1);
  expect_error("hinge.glb -o out.json", 1, "out.json");
}

TEST_F(AuditCli, file_without_motion_is_nothing_to_judge_and_passes_every_gate) {
  test::ShadedMesh mesh = test::hinge();
  mesh.targets.clear();
  folder_.write("still.glb", mesh.file().glb());
  const std::string text = text_of("still.glb --tolerance 0");
  EXPECT_EQ(text, "still.glb: nothing to judge: no target and no animation moves stored normals\n");
  mesh = test::hinge();
  mesh.normals.clear();
  folder_.write("flat.glb", mesh.file().glb());
  expect_words(text_of("flat.glb"), {"nothing to judge", "has no normals, and is shown flat, which is right"});
}

TEST_F(AuditCli, long_tables_are_cut_and_json_is_not) {
  test::ShadedMesh mesh = test::hinge();
  mesh.targets.resize(20, mesh.targets[0]);
  folder_.write("many.glb", mesh.file().glb());
  expect_words(text_of("many.glb"), {"... and 4 more with smaller errors (--json has all)\n"});
  EXPECT_EQ(json_of("many.glb")["subjects"].size(), 20U);
}

TEST_F(AuditCli, long_tables_show_the_worst) {
  // 20 targets of which every third folds the hinge by its whole angle, and the others by a tenth of that.
  test::ShadedMesh mesh = test::hinge();
  const auto slight = [&] {
    test::ShadedMesh::Target target = mesh.targets[0];
    for (float& c : target.positions) c *= 0.1F;
    return target;
  }();
  const auto whole = mesh.targets[0];
  mesh.targets.clear();
  for (int i = 0; i < 20; ++i) mesh.targets.push_back(i % 3 == 0 ? whole : slight);
  folder_.write("many.glb", mesh.file().glb());
  const std::string text = text_of("many.glb --samples 2");
  const std::string table = text.substr(0, text.find("... and 4 more"));
  for (int i = 0; i < 20; ++i) {
    // The first of equals are shown: all 7 that are off by 90 degrees, and 9 of the rest.
    const bool is_shown = i % 3 == 0 || i < 14;
    EXPECT_EQ(table.find("\ntarget " + std::to_string(i) + " ") != std::string::npos, is_shown) << i << "\n" << table;
  }
}

TEST_F(AuditCli, errors_say_what_is_wrong) {
  expect_error("", 2, "nothing to read");
  expect_error("missing.glb", 1, "missing.glb");
  expect_error("a.obj", 3, "two frames");
  expect_error("hinge.glb --rule cubic", 2, "--rule: there is no rule 'cubic'");
  expect_error("a.obj b.obj --rule gltf", 2, "the rule gltf");
  expect_error("hinge.glb --weighting mass", 2, "--weighting");
  expect_error("hinge.glb --samples 1", 2, "--samples");
  expect_error("hinge.glb --samples 1000002", 2, "samples");
  expect_error("hinge.glb --tolerance -1", 2, "--tolerance");
  expect_error("hinge.glb --tolerance nan", 2, "--tolerance");
  expect_error("hinge.glb --animation walk", 2, "walk");
  expect_error("a.obj b.obj --animation 0", 2, "--animation");
  expect_error("hinge.glb --world", 2, "--world");
  folder_.write("broken.glb", "glTF\x02");
  expect_error("broken.glb", 3, "broken.glb");
  test::GltfBuilder builder = test::hinge().file();
  builder.json["meshes"][0]["extras"]["chronormal"] = {{"version", 7}};
  folder_.write("later.glb", builder.glb());
  expect_error("later.glb", 3, "/meshes/0/extras/chronormal/version");
}

}  // namespace
}  // namespace chronormal::audit_cli_test
