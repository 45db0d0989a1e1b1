// Tests the results of `report` that scripts and people read: the page and its data, the table, the JSON, and the
// message if the page is missing.

#include <gtest/gtest.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/gltf_builder.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/report_file.h"
#include "tests/support/shaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::report_cli_test {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

class ReportCli : public testing::Test {
 protected:
  ReportCli() {
    test::GltfBuilder builder = test::hinge().file();
    builder.json["meshes"][0]["name"] = "Hinge";
    builder.json["meshes"][0]["extras"]["targetNames"] = {"fold"};
    builder.add_track(builder.add_animation("swing"), 0, std::vector<float>{0, 2}, std::vector<float>{0, 1});
    folder_.write("hinge.glb", builder.glb());
    folder_.write("page.html", "<p>a page</p><!--chronormal-data-->");
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments, const std::string& program = kProgram) const {
    return run_shell(program + " report " + arguments, folder_.path());
  }
  [[nodiscard]] std::string bytes(const std::string& name) const { return test::read_whole(folder_ / name); }
  void expect_error(const ProcessResult& result, int exit_code, const std::string& word) const {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_TRUE(result.err.starts_with("chronormal report: ")) << result.err;
    EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
  }

  test::TemporaryFolder folder_;
};

TEST_F(ReportCli, table_says_what_was_written_and_where_the_worst_places_are) {
  const ProcessResult result = run("hinge.glb -o hinge.bin");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_TRUE(result.out.starts_with("hinge.glb -> hinge.bin, ")) << result.out;
  for (const char* words : {"Hinge", "42", "mesh 0, primitive 0, vertex 3", "fold at 1", "90.00"})
    EXPECT_NE(result.out.find(words), std::string::npos) << words << "\nin\n" << result.out;
  const test::ReportFile file(bytes("hinge.bin"));
  ASSERT_FALSE(file.json.is_null());
  EXPECT_EQ(file.json["input"], "hinge.glb");
  EXPECT_NEAR(file.degrees_at(file.json["worst"][0]), 90, 1e-3);
  const Json audit = Json::parse(
      run_shell(std::string(kProgram) + " audit hinge.glb --for all,gltfpack,quantize,meshopt --json", folder_.path())
          .out);
  for (const char* field : {"worst_degrees", "worst_at", "subjects", "viewers", "findings"})
    EXPECT_EQ(file.json["audit"][field], audit[field]) << field;
  const Json plan = Json::parse(run_shell(std::string(kProgram) + " bake hinge.glb --plan --json", folder_.path()).out);
  EXPECT_EQ(file.json["plan"]["meshes"], plan["meshes"]);
}

TEST_F(ReportCli, json_is_for_programs) {
  const ProcessResult result = run("hinge.glb -o hinge.bin --no-plan --json");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["command"], "report");
  EXPECT_EQ(json["output"]["bytes"], bytes("hinge.bin").size());
  EXPECT_EQ(json["parts"][0]["vertices"], 4);
  EXPECT_EQ(json["worst"][0]["degrees"], 90);
  EXPECT_EQ(json["planned"], false);
  EXPECT_EQ(json["thinned"], Json::array());
}

TEST_F(ReportCli, page_is_the_template_with_the_report_in_it) {
  const ProcessResult result = run("hinge.glb -o hinge.HTML --template page.html --for gltfpack");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::string page = bytes("hinge.HTML");
  EXPECT_TRUE(page.starts_with("<p>a page</p><script type=\"application/octet-stream\" id=\"chronormal-data\">H4sI"));
  EXPECT_TRUE(page.ends_with("</script>"));
  expect_error(run("hinge.glb -o hinge.HTML --template page.html"), 1, "--force");
}

TEST_F(ReportCli, template_is_looked_for_beside_the_program) {
  fs::create_directories(folder_ / "bin");
  fs::copy_file(kProgram, folder_ / "bin/chronormal");
  const std::string program = folder_ / "bin/chronormal";
  expect_error(run("hinge.glb -o hinge.html", program), 1, "./run report");
  EXPECT_FALSE(fs::exists(folder_ / "hinge.html"));
  EXPECT_EQ(run("hinge.glb -o hinge.bin", program).exit_code, 0);
  fs::create_directories(folder_ / "share/chronormal");
  folder_.write("share/chronormal/report.html", "found <!--chronormal-data-->");
  const ProcessResult result = run("hinge.glb -o hinge.html", program);
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(bytes("hinge.html").starts_with("found <script"));
}

TEST_F(ReportCli, broken_template_is_refused_before_anything_is_computed) {
  folder_.write("broken.html", "<p>no mark</p>");
  expect_error(run("missing.glb -o hinge.html --template broken.html"), 3, "broken.html: the template");
  expect_error(run("hinge.glb -o hinge.html --template no.html"), 1, "no.html");
  EXPECT_FALSE(fs::exists(folder_ / "hinge.html"));
}

TEST_F(ReportCli, misuse_is_said_before_anything_is_read) {
  expect_error(run("missing.glb -o page.txt"), 2, "page.txt: the name of the output must end in .html");
  expect_error(run("missing.glb -o -"), 2, "the name of the output must end in .html");
  expect_error(run("missing.glb -o a.bin --template page.html"), 2, "--template");
  expect_error(run("missing.glb -o a.bin --for unreal"), 2, "--for");
  expect_error(run("missing.glb -o a.bin --weighting weight"), 2, "--weighting");
  expect_error(run("--sample twist -o a.bin --for three"), 2, "--for");
  expect_error(run("missing.glb"), 2, "-o OUT");
}

TEST_F(ReportCli, a_file_without_targets_is_refused_with_what_to_do) {
  test::ShadedMesh still = test::hinge();
  still.targets.clear();
  folder_.write("still.glb", still.file().glb());
  expect_error(run("still.glb -o still.bin"), 3,
               "the file has no morph target that moves a surface with normals, so there is nothing to show");
}

TEST_F(ReportCli, keyframes_that_do_not_move_are_refused) {
  folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_error(run("a.obj a.obj -o still.bin"), 3,
               "nothing moves in this input, so there is nothing to show; give a motion");
}

TEST_F(ReportCli, a_mesh_whose_normals_stay_right_has_no_worst_places) {
  folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder_.write("b.obj", "v 0 0 1\nv 1 0 1\nv 0 1 1\nf 1 2 3\n");
  const ProcessResult result = run("a.obj b.obj -o slide.bin");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("no error is larger than 0.001 degrees\n"), std::string::npos) << result.out;
  EXPECT_EQ(test::ReportFile(bytes("slide.bin")).json["worst"], Json::array());
}

TEST_F(ReportCli, sequence_says_which_of_its_vertices_are_worst) {
  const ProcessResult result = run("--sample twist -o twist.bin");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("vertex 7601  0.5 s    39.12"), std::string::npos) << result.out;
}

}  // namespace
}  // namespace chronormal::report_cli_test
