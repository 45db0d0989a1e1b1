// Tests the option --base, with which commands read morph targets from files: folders of targets, names, and refused
// requests. Scripts depend on this behaviour.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/target_bytes.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::targets_cli_test {
namespace {

using Json = nlohmann::json;

class TargetsCli : public testing::Test {
 protected:
  TargetsCli() {
    folder_.write("base.obj", test::kSquareObj);
    std::filesystem::create_directories(folder_ / "targets/mouth");
    folder_.write("targets/mouth/lift.target", test::kLiftTarget);
    folder_.write("targets/mouth/packed.target.gz", test::gzip("2 0 0 1\n"));
    folder_.write("smile.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 2\nf 1 2 3\nf 1 3 4\n");
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments, const std::string& input = "") const {
    return run_shell(std::string(kProgram) + " " + arguments, folder_.path(), input);
  }
  [[nodiscard]] Json json_of(const std::string& arguments, const std::string& input = "") const {
    const ProcessResult result = run("compare --json --no-times --schemes linear " + arguments, input);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err, "");
    return result.exit_code == 0 ? Json::parse(result.out) : Json();
  }
  void expect_error(const std::string& arguments, int exit_code, const std::vector<std::string>& words) const {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.err;
    EXPECT_EQ(result.out, "");
    for (const std::string& word : words)
      EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
  }

  test::TemporaryFolder folder_;
};

TEST_F(TargetsCli, base_and_its_targets_are_one_input_with_the_name_of_the_base) {
  const Json json = json_of("--base base.obj targets/ smile.obj");
  EXPECT_EQ(json["input"]["name"], "base.obj");
  EXPECT_EQ(json["input"]["vertices"], 4);
  EXPECT_EQ(json["input"]["segments"], 3);
  EXPECT_EQ(json_of("--base base.obj smile.obj")["input"]["segments"], 1);
  EXPECT_EQ(json_of("--base base.obj 'targets/*/*.target*'")["input"]["segments"], 2);
  EXPECT_EQ(json_of("--base - targets", test::kSquareObj)["input"]["segments"], 2);
}

TEST_F(TargetsCli, star_errs_as_its_segments_do_one_by_one) {
  const double all = json_of("--base base.obj targets smile.obj")["schemes"][0]["sum_degrees"];
  double sum = 0;
  for (const char* const one : {"targets/mouth/lift.target", "targets/mouth/packed.target.gz", "smile.obj"})
    sum += json_of(std::string("--base base.obj ") + one)["schemes"][0]["sum_degrees"].get<double>();
  EXPECT_GT(all, 1.0);
  EXPECT_NEAR(all, sum, 1e-9);
  const double sequence = json_of("base.obj smile.obj")["schemes"][0]["sum_degrees"];
  EXPECT_EQ(json_of("--base base.obj smile.obj")["schemes"][0]["sum_degrees"], sequence);
}

TEST_F(TargetsCli, tables_say_the_number_and_the_name_of_a_target) {
  const ProcessResult compared = run("compare --base base.obj targets smile.obj --schemes linear --no-times");
  EXPECT_NE(compared.out.find("2 (smile)"), std::string::npos) << compared.out;
  const ProcessResult blended = run("compare --base base.obj targets smile.obj --blend 3 --active 1");
  EXPECT_NE(blended.out.find("2 (smile) "), std::string::npos) << blended.out;
}

TEST_F(TargetsCli, each_makes_every_input_a_star_of_its_own) {
  const ProcessResult result =
      run("compare --each --base base.obj targets/ smile.obj --schemes linear --no-times --csv");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("\ntargets/,4,2,2,"), std::string::npos) << result.out;
  EXPECT_NE(result.out.find("\nsmile.obj,4,2,1,"), std::string::npos) << result.out;
  folder_.write("bad.target", "7 0 0 0\n");
  expect_error("compare --each --base base.obj smile.obj bad.target", 3, {"chronormal compare: bad.target, line 1: "});
}

TEST_F(TargetsCli, wrong_usage_of_base_is_exit_2_and_says_what_to_do) {
  expect_error("compare smile.obj targets/mouth/lift.target", 2, {"targets/mouth/lift.target", "--base"});
  expect_error("compare targets/mouth/packed.target.gz", 2, {"packed.target.gz", "--base"});
  expect_error("compare --each base.obj 'targets/*/*.target'", 2, {"--base"});
  expect_error("convert targets/mouth/lift.target -o out.obj", 2, {"lift.target", "--base"});
  expect_error("compare --base base.obj", 2, {"--base", "targets"});
  expect_error("compare --base base.obj --each", 2, {"--base", "targets"});
  expect_error("compare --base base.obj --sample twist", 2, {"--base", "--sample cannot be used with --base"});
  expect_error("compare --base base.obj --each smile.obj --sample twist", 2,
               {"--base", "--sample cannot be used with --base"});
  expect_error("convert --base base.obj -o out_%d.obj", 2, {"--base", "targets"});
  expect_error("compare --base base.obj targets --fps 30", 2, {"--fps"});
  expect_error("compare --base '' targets", 2, {"--base"});
  expect_error("compare --base - -", 2, {"only be read once"});
}

TEST_F(TargetsCli, errors_in_targets_have_the_exit_code_and_the_file) {
  folder_.write("bad.target", "0 0 0 0\n0 1 1 1\n");
  expect_error("compare --base base.obj targets bad.target", 3, {"bad.target, line 2", "two deltas"});
  expect_error("compare --base base.obj none.target", 1, {"none.target"});
  expect_error("compare --base none.obj targets", 1, {"none.obj"});
  expect_error("compare --base base.obj base.obj", 3, {"base.obj", "there is no target beside the base"});
  folder_.write("three.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nf 1 2 3\n");
  expect_error("convert --base base.obj three.obj -o out_%d.obj", 3, {"three.obj", "3 vertices", "the base has 4"});
}

TEST_F(TargetsCli, convert_writes_the_base_and_the_targets_but_no_cache_of_them) {
  const ProcessResult result = run("convert --base base.obj targets -o out_%d.obj");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(test::read_whole(folder_ / "out_0.obj"), test::kSquareObj);
  EXPECT_EQ(test::read_whole(folder_ / "out_1.obj"),
            "v 0 0 0\nv 0.75 0.125 0.1\nv 1 1 0\nv 0 1 0.5\nf 1 2 3\nf 1 3 4\n");
  EXPECT_EQ(test::read_whole(folder_ / "out_2.obj"), "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0\nf 1 2 3\nf 1 3 4\n");
  for (const char* const name : {"out.pc2", "out.mdd"}) {
    expect_error(std::string("convert --base base.obj targets -o ") + name, 2, {name, "sequence"});
    EXPECT_FALSE(std::filesystem::exists(folder_ / name));
  }
  // A base and one target stay targets, and do not become a sequence of two keyframes.
  EXPECT_EQ(run("convert --base base.obj smile.obj -o out.npz").exit_code, 0);
  EXPECT_EQ(Json::parse(run("inspect out.npz --json").out)["kind"], "targets");
  expect_error("sample out.npz --times 0.5 -o n.npy", 2, {"--times", "blend shapes have no times", "--weights"});
  expect_error("bake out.npz -o out.glb", 3, {"out.npz", "targets"});
  expect_error("convert out.npz -o out.mdd", 2, {"out.mdd", "targets"});
  expect_error("convert out.npz -o out.fbx", 2, {"must end in one of .obj, ", "or .glb (for targets over a base)\n"});
}

TEST_F(TargetsCli, targets_have_weights_and_sequences_have_times) {
  const ProcessResult targets = run("audit --base base.obj smile.obj --samples 3");
  EXPECT_EQ(targets.exit_code, 0) << targets.err;
  EXPECT_NE(targets.out.find("target 0 (smile) at weight "), std::string::npos) << targets.out;
  EXPECT_EQ(targets.out.find(" s  "), std::string::npos) << targets.out;
  const Json worst = Json::parse(run("audit --base base.obj smile.obj --json").out)["worst_at"];
  EXPECT_TRUE(worst.contains("weight")) << worst;
  EXPECT_FALSE(worst.contains("time")) << worst;
  const ProcessResult sequence = run("audit base.obj smile.obj --samples 3");
  EXPECT_NE(sequence.out.find("sequence at "), std::string::npos) << sequence.out;
  EXPECT_EQ(sequence.out.find("weight "), std::string::npos) << sequence.out;
  EXPECT_TRUE(Json::parse(run("audit base.obj smile.obj --json").out)["worst_at"].contains("time"));
  for (const char* const input : {"--base base.obj smile.obj", "--sample bumps"}) {
    const std::string text = run(std::string("inspect ") + input).out;
    EXPECT_EQ(text.find(" 0 s to 1 s"), std::string::npos) << text;
    EXPECT_NE(text.find(" target"), std::string::npos) << text;
    EXPECT_EQ(Json::parse(run(std::string("inspect --json ") + input).out)["kind"], "targets");
  }
}

TEST_F(TargetsCli, targets_become_morph_targets_of_a_glb_with_their_names) {
  EXPECT_EQ(run("convert --base base.obj targets smile.obj -o face.glb").exit_code, 0);
  const GltfDocument document = GltfDocument::open(folder_ / "face.glb").value();
  ASSERT_EQ(document.meshes().size(), 1U);
  const GltfMesh& mesh = document.meshes()[0];
  EXPECT_EQ(mesh.name, "base");
  EXPECT_EQ(mesh.target_names, (std::vector<std::string>{"lift", "packed", "smile"}));
  const GltfGeometry geometry = document.geometry(0, 0, {.shading = true}).value();
  EXPECT_EQ(geometry.normals, (std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}));
  // face.glb has the same shapes as base.obj and its targets, so the schemes must have the same errors.
  const auto sum = [&](const std::string& input) { return json_of(input)["schemes"][0]["sum_degrees"].get<double>(); };
  EXPECT_NEAR(sum("face.glb"), sum("--base base.obj targets smile.obj"), 1e-3);
  EXPECT_EQ(run("bake face.glb baked.glb").exit_code, 0);
  EXPECT_EQ(run("audit baked.glb").exit_code, 0);
  EXPECT_EQ(run("convert --sample bumps -o bumps.vrm").exit_code, 0);
  expect_error("convert base.obj smile.obj -o walk.glb", 2, {"walk.glb", "use bake instead"});
  expect_error("convert --base base.obj smile.obj -o face.gltf", 2, {"face.gltf", ".glb"});
  expect_error("convert --base base.obj smile.obj -o face.glb", 1, {"face.glb", "--force"});
}

}  // namespace
}  // namespace chronormal::targets_cli_test
