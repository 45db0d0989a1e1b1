// Tests the results of `audit` that scripts and people read: the verdict, the tables, the JSON, and the exit codes.

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "chronormal/workflow/viewers.h"
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
  EXPECT_EQ(text.find("hinge.glb: errors of 28.33 degrees on average, 90.00 at worst, 3 torn edges on average\n"), 0U)
      << text;
  expect_words(
      text,
      {"vertex 3 of Hinge, primitive 0, target 0 (fold\\x1b[2J) at weight 1\n",
       "checked 126 samples (vertices at moments) in 2 motions, by the rule gltf from stored normals\n",
       "animation 0 (swing), node 0", "90 and more",
       "target 0 (fold\\x1b[2J) of Hinge moves positions but has no normals (1 primitive); errors of up to 90.00"});
  const std::string last =
      "\nchronormal bake hinge.glb -o baked.glb corrects these normals to within 0.5 degrees where it can; for "
      "viewers that add up targets as glTF says, --encode "
      "exact comes within about 0.01 degrees\n";
  ASSERT_GT(text.size(), last.size());
  EXPECT_EQ(text.substr(text.size() - last.size()), last);
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
}

TEST_F(AuditCli, tolerance_is_a_gate) {
  const ProcessResult beyond = run("hinge.glb --tolerance 89.9");
  EXPECT_EQ(beyond.exit_code, 4);
  expect_words(beyond.out, {"90.00 at worst", "; beyond 89.9 degrees\n"});
  EXPECT_EQ(beyond.err,
            "chronormal audit: the worst error is 90 degrees, beyond the tolerance of 89.9 degrees: "
            "vertex 3 of Hinge, primitive 0, target 0 (fold\\x1b[2J) at weight 1\n");
  expect_words(text_of("hinge.glb --tolerance 90.1"), {"; within 90.1 degrees\n"});
  // In every viewer, four edges of the hinge are torn at the same moment.
  EXPECT_EQ(run("hinge.glb --tears 4").exit_code, 0);
  const ProcessResult torn = run("hinge.glb --tears 3 --tolerance 91");
  EXPECT_EQ(torn.exit_code, 4);
  EXPECT_EQ(torn.err, "chronormal audit: 4 edges are torn at one moment, more than --tears allows (3)\n");
  expect_words(torn.out, {"; beyond 91 degrees and 3 torn edges\n"});
  const ProcessResult in_viewer = run("hinge.glb --tears 3 --for three --json");
  EXPECT_EQ(in_viewer.exit_code, 4);
  const Json torn_json = Json::parse(in_viewer.out);
  EXPECT_EQ(torn_json["tolerance_torn_edges"], 3);
  EXPECT_EQ(torn_json["viewers"][0]["most_torn_edges"], 4);
  EXPECT_EQ(torn_json["viewers"][0]["passed"], false);
  const ProcessResult json = run("hinge.glb --tolerance 1 --json");
  EXPECT_EQ(json.exit_code, 4);
  EXPECT_EQ(Json::parse(json.out)["passed"], false);
  EXPECT_EQ(json_of("hinge.glb --tolerance 91")["passed"], true);
  EXPECT_EQ(json_of("hinge.glb")["passed"], Json());
}

TEST_F(AuditCli, viewers_have_a_row_each_below_the_specification) {
  const std::string text = text_of("hinge.glb --for three,godot");
  expect_words(text, {"\nviewer ", "\n(specification) ", "\nthree.js ", "\nGodot 4 "});
  EXPECT_LT(text.find("(specification)"), text.find("three.js"));
  EXPECT_LT(text.find("three.js"), text.find("Godot 4"));
  EXPECT_LT(text.find("Godot 4"), text.find("\nmotion "));
  EXPECT_EQ(text.find("Filament"), std::string::npos);
  EXPECT_EQ(text_of("hinge.glb").find("(specification)"), std::string::npos);
  const std::string all = text_of("hinge.glb --for all,gltfpack,quantize,meshopt");
  for (const Viewer& viewer : kViewers) expect_words(all, {"\n" + std::string(viewer.title) + " "});
}

TEST_F(AuditCli, viewers_are_in_the_json_with_their_errors_and_sources) {
  const Json json = json_of("hinge.glb --for filament,gltfpack");
  ASSERT_EQ(json["viewers"].size(), 2U);
  const Json& filament = json["viewers"][0];
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
  EXPECT_EQ(json["viewers"][1]["most_targets"], Json());
  EXPECT_EQ(json["viewers"][1]["tracks"], "all_resampled");
  EXPECT_EQ(json_of("hinge.glb")["viewers"], Json::array());
}

TEST_F(AuditCli, tolerance_is_a_gate_for_every_viewer_that_is_named) {
  // The normal of each vertex is true at weight 1. At smaller weights, viewers that add up deltas turn the normal with
  // the longer delta too early.
  test::ShadedMesh mesh = test::hinge();
  mesh.targets[0].normals = {0, 0, 0, -1, 0, 0, -1, 0, 0, -3, 0, -1};
  folder_.write("long.glb", mesh.file().glb());
  const std::string one_weight = "long.glb --samples 2 --tolerance 1";
  EXPECT_EQ(run(one_weight).exit_code, 0);
  EXPECT_EQ(run(one_weight + " --for three,godot").exit_code, 0);
  const ProcessResult half_way = run("long.glb --samples 3 --tolerance 20 --for three,godot");
  EXPECT_EQ(half_way.exit_code, 4);
  expect_words(half_way.out, {"within 20 degrees in 1 of 2 viewers\n", "beyond the limits"});
  expect_words(half_way.err, {"chronormal audit: three.js: the worst error is ",
                              " degrees, beyond the tolerance of 20 degrees: vertex 3 of "});
  EXPECT_EQ(half_way.err.find("Godot"), std::string::npos);
  const Json json = Json::parse(run("long.glb --samples 3 --tolerance 20 --for three,godot --json").out);
  EXPECT_EQ(json["passed"], false);
  EXPECT_EQ(json["viewers"][0]["passed"], false);
  EXPECT_EQ(json["viewers"][1]["passed"], true);
  EXPECT_EQ(Json::parse(run("long.glb --samples 3 --tolerance 20 --for godot --json").out)["passed"], true);
}

TEST_F(AuditCli, bars_of_the_histogram_fit_a_narrow_output) {
  for (const std::size_t columns : {40U, 50U, 120U}) {
    const ProcessResult result = run_shell(
        "COLUMNS=" + std::to_string(columns) + ' ' + kProgram + " audit a.obj stale.obj --samples 5", folder_.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    std::istringstream lines(result.out);
    std::size_t bars = 0;
    for (std::string line; std::getline(lines, line);) {
      if (!line.ends_with('#')) continue;
      ++bars;
      EXPECT_LE(line.size(), columns) << line;
      EXPECT_NE(line.find_first_of("0123456789"), std::string::npos) << "a bar is beside its numbers: " << line;
    }
    EXPECT_GT(bars, 0U) << result.out;
  }
}

TEST_F(AuditCli, viewers_that_there_are_none_of_are_a_misuse) {
  expect_error("hinge.glb --for gdot", 2, "did you mean godot?");
  expect_error("hinge.glb --for ''", 2, "--for: the list of viewers is empty");
  expect_error("hinge.glb --for unreal", 2, "choose from three, babylon, ");
  expect_error("hinge.glb --for all --rule slerp", 2, "--for");
  expect_error("a.obj b.obj --for all", 2, "--for");
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
      expect_words(
          result.out,
          {"180.00 at worst",
           " would be zero, infinite or NaN in a viewer, and count as errors of 180 degrees. The first is at vertex ",
           " would be zero, infinite or NaN in a viewer (vertex "});
      expect_words(result.err,
                   {" of the file would be zero, infinite or NaN in a viewer, which no tolerance allows: vertex "});
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

TEST_F(AuditCli, json_is_one_object_with_schema_2) {
  const Json json = json_of("hinge.glb --samples 2");
  EXPECT_EQ(json["command"], "audit");
  EXPECT_EQ(json["schema"], 2);
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

// Notes on standard error must also be in the JSON, for programs that do not read standard error.
TEST_F(AuditCli, notes_on_a_file_are_in_the_json_of_audit_and_bake) {
  test::GltfBuilder builder = test::hinge().file();
  builder.json["extensionsRequired"] = {"FOO_bar"};
  builder.json["scenes"] = Json::array({{{"extensions", {{"FOO_bar", 1}}}}});
  folder_.write("required.glb", builder.glb());
  for (const std::string command : {"audit required.glb", "bake required.glb --plan", "bake required.glb -o out.glb"}) {
    const ProcessResult result = run_shell(std::string(kProgram) + " " + command + " --json", folder_.path());
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json notes = Json::parse(result.out)["notes"];
    ASSERT_EQ(notes.size(), 1U) << command;
    const std::string note = notes[0];
    EXPECT_TRUE(note.starts_with("required.glb, /extensionsRequired/0: ")) << note;
    EXPECT_NE(result.err.find(note), std::string::npos) << result.err;
  }
  EXPECT_EQ(json_of("hinge.glb")["notes"], Json::array());
}

TEST_F(AuditCli, sequence_is_judged_by_its_stored_normals_or_by_those_of_a_viewer) {
  Json json = json_of("a.obj b.obj");
  EXPECT_EQ(json["rule"], "nlerp");
  EXPECT_EQ(json["stored_normals"], true);
  EXPECT_LT(json["worst_degrees"], 1e-4);
  expect_words(text_of("a.obj b.obj"), {"nothing to do, since no error is larger than 1 degree\n"});
  json = json_of("a.obj stale.obj");
  EXPECT_NEAR(json["worst_degrees"], 90, 1e-9);
  EXPECT_EQ(json["findings"][0]["kind"], "wrong_at_keys");
  json = json_of("a.obj bare.obj --rule slerp");
  EXPECT_EQ(json["stored_normals"], false);
  EXPECT_GT(json["worst_degrees"], 4);
  expect_words(text_of("bare.obj a.obj --rule slerp"),
               {"normals that a viewer computes at keyframes, since none are stored",
                "right at keyframes, with errors of up to"});
}

TEST_F(AuditCli, built_in_morphs_and_targets_of_a_base_are_inputs) {
  expect_words(text_of("--sample twist --samples 3"), {"twist: errors of ", "chronormal bake --sample twist"});
  expect_words(text_of("--base a.obj b.obj bare.obj --rule slerp"),
               {"write the base and its targets as a .glb with chronormal convert, and bake that file\n"});
  const Json json = json_of("--base a.obj b.obj bare.obj");
  ASSERT_EQ(json["subjects"].size(), 2U);
  EXPECT_EQ(json["subjects"][1]["target"], 1);
  EXPECT_EQ(json["subjects"][0]["name"], "b");
}

TEST_F(AuditCli, file_comes_on_standard_input_and_leaves_by_o) {
  const std::string bytes = test::read_whole(folder_ / "hinge.glb");
  expect_words(text_of("-", bytes), {"<stdin>: errors of 28.33 degrees"});
  EXPECT_EQ(text_of("hinge.glb --json -o out.json"), "");
  EXPECT_EQ(Json::parse(test::read_whole(folder_ / "out.json"))["schema"], 2);
  expect_error("hinge.glb -o out.json", 1, "out.json");
}

TEST_F(AuditCli, file_without_motion_is_nothing_to_judge_and_passes_no_gate_alone) {
  test::ShadedMesh mesh = test::hinge();
  mesh.targets.clear();
  folder_.write("still.glb", mesh.file().glb());
  EXPECT_EQ(text_of("still.glb"),
            "still.glb: there is nothing to judge, since no morph target and no animation moves stored normals\n");
  const ProcessResult gate = run("still.glb --tolerance 180 --json"),
                      several = run("still.glb still.glb --tolerance 1");
  EXPECT_EQ(gate.exit_code, 4);
  expect_words(gate.err, {"chronormal audit: nothing could be judged"});
  EXPECT_EQ(Json::parse(gate.out)["passed"], false);
  EXPECT_EQ(several.exit_code, 4);
  EXPECT_EQ(Json::parse(run("still.glb still.glb --tolerance 1 --json").out)["passed"], false);
  mesh = test::hinge();
  mesh.normals.clear();
  folder_.write("flat.glb", mesh.file().glb());
  expect_words(text_of("flat.glb"),
               {"there is nothing to judge", "has no normals, and is rendered flat, which is right"});
}

TEST_F(AuditCli, motion_of_which_no_pair_can_be_judged_passes_no_gate) {
  folder_.write("line_0.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  folder_.write("line_1.obj", "v 0 0 1\nv 1 0 1\nv 3 0 1\nf 1 2 3\n");
  const ProcessResult gate = run("line_0.obj line_1.obj --tolerance 180 --json");
  EXPECT_EQ(gate.exit_code, 4);
  expect_words(gate.err, {"nothing could be judged"});
  const Json json = Json::parse(gate.out);
  EXPECT_EQ(json["passed"], false);
  EXPECT_EQ(json["judged"], 0);
  EXPECT_EQ(run("line_0.obj line_1.obj").exit_code, 0);
  const ProcessResult compared =
      run_shell(std::string(kProgram) + " compare line_0.obj line_1.obj --tolerance 0", folder_.path(), "");
  EXPECT_EQ(compared.exit_code, 4);
  expect_words(compared.err, {"no scheme could be judged"});
  ASSERT_EQ(run("line_0.obj line_1.obj --tolerance 180 --shard 1/1 -o part.json").exit_code, 0);
  EXPECT_EQ(run_shell(std::string(kProgram) + " merge part.json", folder_.path(), "").exit_code, 4);
}

// A sheet folds until both halves lie on each other. There is then no normal along the fold, although both halves are
// still drawn.
TEST_F(AuditCli, gate_does_not_pass_normals_of_drawn_faces_that_cancel) {
  const auto sheet = [](const std::string& x) {
    return "v 0 0 0\nv 0 1 0\nv -1 0 0\nv " + x + " 0 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 2//1 1//1 4//1\n";
  };
  folder_.write("open.obj", sheet("1"));
  folder_.write("half.obj", sheet(".5"));
  folder_.write("folded.obj", sheet("-1"));
  const Json json = json_of("open.obj folded.obj --samples 2");
  EXPECT_EQ(json["no_normal"], 2);
  EXPECT_EQ(json["cancelled"], 2);
  const ProcessResult gate = run("open.obj folded.obj --samples 2 --tolerance 180");
  EXPECT_EQ(gate.exit_code, 4);
  expect_words(
      gate.err,
      {"2 samples have no true normal and cannot be judged, since the normals of the faces around the vertex cancel "
       "each other"});
  expect_words(gate.out, {"2 of the samples cannot be judged because the normals of faces cancel", "beyond 180"});
  EXPECT_EQ(gate.out.find("nothing to do"), std::string::npos) << gate.out;
  EXPECT_EQ(run("open.obj half.obj --tolerance 180").exit_code, 0);
  ASSERT_EQ(run("open.obj folded.obj --samples 2 --tolerance 180 --shard 1/1 -o part.json").exit_code, 0);
  const ProcessResult merged = run_shell(std::string(kProgram) + " merge part.json", folder_.path(), "");
  EXPECT_EQ(merged.exit_code, 4);
  expect_words(merged.out, {"\"cancelled\": 2,"});
  const ProcessResult baked =
      run_shell(std::string(kProgram) + " bake open.obj folded.obj -o baked.glb", folder_.path(), "");
  expect_words(baked.out, {"exact, except around some vertices"});
  EXPECT_EQ(baked.out.find("exact at every instant"), std::string::npos) << baked.out;
}

// A triangle that shrinks to a hundredth of its size and turns over is still drawn. The direction of its normal is
// exact, so the audit must judge it.
TEST_F(AuditCli, gate_judges_small_normals_whose_direction_is_certain) {
  const std::string big = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\n";
  const auto small = [](const std::string& size, const std::string& at) {
    return "v " + at + " 0 0\nv " + at + size + " 0 0\nv " + at + " 0" + size + " 0\nvn 0 0 -1\nf 1//1 2//1 3//1\n";
  };
  folder_.write("big.obj", big);
  folder_.write("small.obj", small(".009", "0"));
  // At x = 100000, rounding to float32 collapses the triangle to a point or a line.
  folder_.write("far.obj", small(".009", "100000"));
  for (const std::string rule : {"--rule step", "--rule slerp --samples 2", "--rule nlerp --samples 2"}) {
    const std::string arguments = "big.obj small.obj " + rule;
    const Json json = json_of(arguments);
    EXPECT_EQ(json["worst_degrees"], 0.0) << "as before, sums leave such pairs out";
    EXPECT_EQ(json["no_normal"], 3);
    EXPECT_EQ(json["faint"], 3);
    EXPECT_NEAR(json["faint_worst_degrees"].get<double>(), 180, 1e-3) << rule;
    EXPECT_EQ(json["subjects"][0]["faint_at"]["time"], 1.0);
    const ProcessResult gate = run(arguments + " --tolerance 1 --json");
    EXPECT_EQ(gate.exit_code, 4) << rule;
    EXPECT_EQ(Json::parse(gate.out)["passed"], false);
    expect_words(gate.err, {"where faces almost vanish", "at 1 s"});
    EXPECT_EQ(run(arguments + " --tolerance 180").exit_code, 0);
    EXPECT_EQ(json_of("big.obj far.obj " + rule)["faint"], 0);
  }
  ASSERT_EQ(run("big.obj small.obj --rule step --tolerance 1 --shard 1/1 -o part.json").exit_code, 0);
  EXPECT_EQ(run_shell(std::string(kProgram) + " merge part.json", folder_.path(), "").exit_code, 4);
}

TEST_F(AuditCli, long_tables_are_cut_and_json_is_not) {
  test::ShadedMesh mesh = test::hinge();
  mesh.targets.resize(20, mesh.targets[0]);
  folder_.write("many.glb", mesh.file().glb());
  expect_words(text_of("many.glb"), {"... and 4 more motions with smaller errors (--json has all)\n"});
  EXPECT_EQ(json_of("many.glb")["subjects"].size(), 20U);
}

TEST_F(AuditCli, long_tables_show_the_worst) {
  // Every third of the 20 targets folds the hinge completely, and the other targets fold it by a tenth.
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
    // The table shows 16 rows: all 7 targets with an error of 90 degrees, and 9 of the other targets. Among equal
    // errors, the table prefers earlier targets.
    const bool is_shown = i % 3 == 0 || i < 14;
    EXPECT_EQ(table.find("\ntarget " + std::to_string(i) + " ") != std::string::npos, is_shown) << i << "\n" << table;
  }
}

std::string last_line(const std::string& text) {
  const std::size_t end = text.find_last_not_of('\n');
  const std::size_t start = text.rfind('\n', end);
  return text.substr(start + 1, end - start);
}

TEST_F(AuditCli, faults_are_said_once_for_each_mesh_and_cause_the_worst_first) {
  // All 20 targets of the mesh "Much" lack normals. Most of the targets have errors of a few degrees, and target 17 has
  // an error of 90 degrees. The only target of the mesh before "Much" has a smaller error.
  const auto slight = [](float share) {
    test::ShadedMesh::Target target = test::hinge().targets[0];
    for (float& c : target.positions) c *= share;
    return target;
  };
  test::ShadedMesh mesh = test::hinge();
  test::GltfBuilder builder;
  mesh.targets = {slight(0.3F)};
  builder.add_node(builder.add_mesh(mesh.primitive(builder), {{"name", "Little"}}));
  mesh.targets.assign(20, slight(0.1F));
  mesh.targets[17] = slight(1);
  builder.add_node(builder.add_mesh(mesh.primitive(builder), {{"name", "Much"}}));
  folder_.write("two.glb", builder.glb());
  const std::string text = text_of("two.glb");
  const std::size_t faults = text.find("\nFaults:\n");
  ASSERT_NE(faults, std::string::npos);
  const std::string much =
      "\n  20 targets of Much move positions but have no normals; errors of up to 90.00 degrees "
      "(worst: target 17 of Much, vertex 3 of Much, primitive 0)\n";
  EXPECT_EQ(text.find(much, faults), faults + 8) << text;
  expect_words(text, {"\n  target 0 of Little moves positions but has no normals (1 primitive); errors of up to "});
  const Json json = json_of("two.glb");
  EXPECT_EQ(json["findings"].size(), 21U);
}

TEST_F(AuditCli, targets_together_are_a_fault_of_their_own_where_they_are_worse_than_alone) {
  // Two targets fold the hinge by 14 degrees each, and by 27 degrees together.
  test::ShadedMesh mesh = test::hinge();
  for (float& c : mesh.targets[0].positions) c *= 0.125F;
  mesh.targets[0].positions[9] = 0;
  mesh.targets.push_back(mesh.targets[0]);
  test::GltfBuilder builder = mesh.file();
  builder.add_track(builder.add_animation("both"), 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
  folder_.write("both.glb", builder.glb());
  expect_words(text_of("both.glb"),
               {"2 targets of mesh 0 move positions but have no normals; errors of up to 7.13",
                "animation 0 (both), node 0: errors of up to 14.04 degrees where targets mix, and of up to 7.13"});
}

TEST_F(AuditCli, advice_is_kept_by_the_command_that_it_names) {
  expect_words(last_line(text_of("hinge.glb")), {"chronormal bake hinge.glb -o baked.glb corrects these normals to "
                                                 "within 0.5 degrees where it can",
                                                 "--encode exact comes within about 0.01 degrees"});
  const auto worst_after = [&](const std::string& arguments) {
    const ProcessResult baked =
        run_shell(std::string(kProgram) + " bake hinge.glb -o baked.glb -q --force " + arguments, folder_.path(), "");
    EXPECT_EQ(baked.exit_code, 0) << baked.err;
    return json_of("baked.glb")["worst_degrees"].get<double>();
  };
  EXPECT_LE(worst_after(""), 90.0);
  EXPECT_LE(worst_after("--encode exact"), 0.01);
  EXPECT_EQ(last_line(text_of("baked.glb")), "there is nothing to do, since no error is larger than 1 degree");
}

// A sheet in the plane z = 0 swings around the x axis. The normal is linear in the weight, so a single normal delta
// gives the true normal at all weights. The file has no deltas for the tangents, which point along y, so the tangents
// do not turn with the sheet.
TEST_F(AuditCli, advice_for_tangents_is_kept_by_the_command_that_it_names) {
  constexpr double kAngle = 0.9;
  test::ShadedMesh sheet = test::random_sheet(3, 5, 1, 0);
  test::ShadedMesh::Target& target = sheet.targets[0];
  target.normals.assign(sheet.positions.size(), 0);
  for (std::size_t v = 0; v < sheet.vertices(); ++v) {
    float* const position = sheet.positions.data() + 3 * v;
    float* const delta = target.positions.data() + 3 * v;
    position[2] = 0;
    delta[0] = 0;
    delta[1] = static_cast<float>(position[1] * (std::cos(kAngle) - 1));
    delta[2] = static_cast<float>(position[1] * std::sin(kAngle));
    target.normals[3 * v + 1] = static_cast<float>(-std::sin(kAngle));
    target.normals[3 * v + 2] = static_cast<float>(std::cos(kAngle) - 1);
    for (const std::size_t c : {0U, 1U, 2U}) sheet.normals[3 * v + c] = c == 2 ? 1.0F : 0.0F;
    for (const float c : {0.0F, 1.0F, 0.0F, 1.0F}) sheet.tangents.push_back(c);
  }
  folder_.write("swing.glb", sheet.file().glb());
  EXPECT_EQ(last_line(text_of("swing.glb")),
            "chronormal bake swing.glb -o baked.glb computes new tangents; the normals are right");
  const ProcessResult baked = run_shell(std::string(kProgram) + " bake swing.glb -o baked.glb -q", folder_.path(), "");
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  EXPECT_EQ(last_line(text_of("baked.glb")), "there is nothing to do, since no error is larger than 1 degree");
  // A bake for a viewer that does not morph tangents leaves the tangents as they are, so the advice must not be a
  // second bake.
  target.normals.clear();
  folder_.write("bare_swing.glb", sheet.file().glb());
  const ProcessResult of_three =
      run_shell(std::string(kProgram) + " bake bare_swing.glb -o three.glb -q --for three", folder_.path(), "");
  ASSERT_EQ(of_three.exit_code, 0) << of_three.err;
  expect_words(text_of("three.glb"), {"the normals are right, but the tangents are not; export tangents"});
}

TEST_F(AuditCli, advice_never_is_what_was_done_or_cannot_help) {
  const auto bake = [&](const std::string& arguments) {
    const ProcessResult result = run_shell(std::string(kProgram) + " bake " + arguments, folder_.path(), "");
    ASSERT_EQ(result.exit_code, 0) << result.err;
  };
  // Without an animation, nothing drives the weight of the target. A bake then cannot use correction targets, and gives
  // the target a single delta for each vertex.
  test::ShadedMesh sheet = test::random_sheet(3, 5, 1, 0);
  sheet.targets[0].normals.clear();
  test::GltfBuilder builder = sheet.file();
  folder_.write("still.glb", builder.glb());
  builder.add_track(builder.add_animation("move"), 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
  folder_.write("sheet.glb", builder.glb());
  expect_words(last_line(text_of("still.glb")), {"chronormal bake still.glb -o baked.glb corrects these normals to "
                                                 "within 0.5 degrees where it can"});
  bake("still.glb -o still_baked.glb -q");
  std::string advice = last_line(text_of("still_baked.glb"));
  expect_words(advice, {"were baked before", "that no animation moves"});
  EXPECT_EQ(advice.find("chronormal bake"), std::string::npos);
  // The bake below stores a single delta for each target, although the animation could drive correction targets.
  bake("sheet.glb -o endpoint.glb --encode endpoint -q");
  advice = last_line(text_of("endpoint.glb"));
  expect_words(advice, {"were baked before", "bake the ORIGINAL file with --encode exact"});
  EXPECT_EQ(advice.find("chronormal bake"), std::string::npos);
  // The bake below is for all viewers. A bake for fewer viewers would allow smaller errors.
  bake("sheet.glb -o alike.glb -q");
  advice = last_line(run("alike.glb --tolerance 1e-6").out);
  expect_words(advice, {"were baked before", "bake the ORIGINAL file with --for"});
  // The next case changes the positions of a file after its bake.
  bake("hinge.glb -o baked.glb --encode exact -q");
  std::string bytes = test::read_whole(folder_ / "baked.glb");
  const float folded = -2;
  const std::string four(reinterpret_cast<const char*>(&folded), 4);
  const std::size_t at = bytes.find(four, bytes.find("BIN"));
  ASSERT_NE(at, std::string::npos);
  for (std::size_t i = at; i != std::string::npos; i = bytes.find(four, i + 4)) bytes[i + 2] = '\x40';
  folder_.write("moved.glb", bytes);
  advice = last_line(text_of("moved.glb"));
  expect_words(advice, {"were baked before", "bake the ORIGINAL file again"});
  // An audit with --rule lerp measures errors that bake cannot correct.
  expect_words(last_line(text_of("hinge.glb --rule lerp")), {"leave --rule out to see what bake can do"});
  // A tolerance below one degree also lowers the limit for "nothing to do".
  expect_words(last_line(text_of("baked.glb --tolerance 0.1")),
               {"nothing to do, since no error is larger than 0.1 degrees"});
}

TEST_F(AuditCli, several_gltf_files_are_a_row_each) {
  test::ShadedMesh still = test::hinge();
  still.targets.clear();
  std::filesystem::create_directories(folder_ / "models/deep");
  folder_.write("models/m10.glb", test::hinge().file().glb());
  folder_.write("models/m9.glb", still.file().glb());
  folder_.write("models/deep/n.gltf", "{}");
  folder_.write("models/.hidden.glb", "");
  folder_.write("models/readme.txt", "");
  const ProcessResult all = run("hinge.glb models");
  EXPECT_EQ(all.exit_code, 3);
  EXPECT_EQ(all.err.find("chronormal audit: n.gltf"), 0U) << all.err;
  EXPECT_EQ(all.out.find("4 files, 2 judged; the worst error is 90.00 degrees, in hinge.glb\n"), 0U) << all.out;
  const std::size_t n = all.out.find("\nmodels/deep/n.gltf"), m9 = all.out.find("\nmodels/m9.glb"),
                    m10 = all.out.find("\nmodels/m10.glb");
  ASSERT_NE(m10, std::string::npos) << all.out;
  EXPECT_LT(n, m9);
  EXPECT_LT(m9, m10);
  expect_words(all.out, {"nothing moves\n", "not judged\n", "wrong, bake it\n"});
  const Json json = Json::parse(run("'models/m*.glb' hinge.glb --json").out);
  EXPECT_EQ(json["command"], "audit");
  EXPECT_EQ(json["schema"], 2);
  EXPECT_EQ(json["passed"], Json());
  ASSERT_EQ(json["files"].size(), 3U);
  EXPECT_EQ(json["files"][1]["input"]["name"], "models/m10.glb");
  EXPECT_EQ(json["files"][1]["worst_degrees"], 90.0);
  EXPECT_EQ(json["files"][0]["judged"], 0);
  // A folder counts as a list of files, even if it contains only one file.
  EXPECT_EQ(Json::parse(run("models/deep --json").out)["files"].size(), 1U);
}

TEST_F(AuditCli, exit_code_of_several_is_that_of_the_worst) {
  test::ShadedMesh still = test::hinge();
  still.targets.clear();
  folder_.write("still.glb", still.file().glb());
  folder_.write("broken.glb", "glTF\x02");
  const ProcessResult beyond = run("still.glb hinge.glb --tolerance 1");
  EXPECT_EQ(beyond.exit_code, 4);
  EXPECT_EQ(beyond.err.find("chronormal audit: hinge.glb: the worst error is 90 degrees, beyond the tolerance of 1"),
            0U)
      << beyond.err;
  expect_words(beyond.out, {"beyond the limits\n"});
  EXPECT_EQ(run("still.glb hinge.glb").exit_code, 0);
  EXPECT_EQ(run("hinge.glb broken.glb still.glb --tolerance 1").exit_code, 3);
  const ProcessResult missing = run("hinge.glb missing.glb broken.glb --tolerance 1 --json");
  EXPECT_EQ(missing.exit_code, 1);
  const Json json = Json::parse(missing.out);
  EXPECT_EQ(json["passed"], false);
  ASSERT_EQ(json["files"].size(), 3U);
  EXPECT_TRUE(json["files"][1]["error"].is_string());
  EXPECT_EQ(json["files"][0]["passed"], false);
}

TEST_F(AuditCli, gltf_files_and_keyframes_are_not_mixed) {
  expect_error("hinge.glb a.obj", 2, "a.obj: this file cannot be given together with the glTF file hinge.glb");
  expect_error("a.obj b.obj hinge.glb", 2, "a.obj: this file cannot be given together with the glTF file hinge.glb");
  expect_error("hinge.glb -", 2, "-: this file cannot be given together with the glTF file hinge.glb");
  expect_error(".", 2, "keyframes of a sequence, such as hinge.glb and ");
  expect_error("hinge.glb hinge.glb --animation swing", 2, "--animation");
  std::filesystem::create_directories(folder_ / "walk/models");
  folder_.write("walk/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder_.write("walk/b.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nf 1 2 3\n");
  folder_.write("walk/models/hinge.glb", test::hinge().file().glb());
  EXPECT_EQ(json_of("walk")["subjects"][0]["kind"], "sequence");
}

TEST_F(AuditCli, weighting_of_the_author_is_said_and_can_be_overridden) {
  // A face with the unit normal (0, 0, 1) and a larger, leaning face with the unit normal (r, 0, r) share the edge from
  // vertex 0 to vertex 2.
  test::ShadedMesh mesh;
  mesh.corners = {0, 1, 2, 0, 2, 3};
  mesh.positions = {0, 0, 0, 1, 0, 0, 0, 1, 0, -8, 8, 8};
  const float r = std::sqrt(0.5F);
  mesh.normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, r, 0, r};
  // By uniform weights, the normals of vertices 0 and 2 are parallel to the sum of the two unit normals, (r, 0, 1 + r).
  for (const std::size_t v : {0U, 2U}) {
    const float x = r, z = 1 + r, length = std::sqrt(x * x + z * z);
    mesh.normals[3 * v] = x / length;
    mesh.normals[3 * v + 2] = z / length;
  }
  mesh.targets = {{{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}, {}, {}}};
  folder_.write("uniform.glb", mesh.file().glb());
  expect_words(text_of("uniform.glb"),
               {"\n  true normals are uniform-weighted, as the base normals of the file are\n",
                "from uniform-weighted normals, which your normals follow; on average they are "});
  const Json detected = json_of("uniform.glb"), asked = json_of("uniform.glb --weighting area");
  EXPECT_EQ(detected["weighting"], "uniform");
  EXPECT_EQ(detected["subjects"][0]["weighting"], "uniform");
  EXPECT_EQ(detected["authored_offsets"][0]["weighting"], "uniform");
  EXPECT_EQ(detected["authored_offsets"][0]["weighting_detected"], true);
  EXPECT_EQ(asked["weighting"], "area");
  EXPECT_EQ(asked["authored_offsets"][0]["weighting_detected"], false);
  expect_words(text_of("uniform.glb --weighting area"), {"; --weighting uniform is closer, "});
  expect_words(text_of("uniform.glb --weighting max"), {"true normals are max-weighted, as --weighting says\n"});
}

TEST_F(AuditCli, every_error_goes_into_a_file_beside_the_report) {
  EXPECT_EQ(text_of("hinge.glb --errors e.npz"), text_of("hinge.glb"));
  EXPECT_TRUE(test::read_whole(folder_ / "e.npz").starts_with("PK"));
  EXPECT_EQ(text_of("hinge.glb --errors e.ply --json"), text_of("hinge.glb --json"));
  EXPECT_TRUE(test::read_whole(folder_ / "e.ply").starts_with("ply\n"));
  EXPECT_EQ(run("hinge.glb --errors e.npz --force").exit_code, 0);
  const std::size_t entries = folder_.entry_count();
  expect_error("hinge.glb --errors e.npz", 1, "e.npz: ");
  expect_error("hinge.glb --errors e.txt", 2, ".npz or .ply");
  expect_error("hinge.glb hinge.glb --errors f.npz", 2, "--errors: --errors is only for a single input");
  expect_error("hinge.glb --errors f.npz -o f.npz", 2, "--errors: this file is named twice, also for OUT");
  expect_error("a.obj a.obj --errors f.npz", 3, "nothing could be judged");
  EXPECT_EQ(folder_.entry_count(), entries) << "what fails leaves nothing";
}

TEST_F(AuditCli, errors_say_what_is_wrong) {
  expect_error("", 2, "there is no input");
  expect_error("missing.glb", 1, "missing.glb");
  expect_error("a.obj", 3, "two keyframes");
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
