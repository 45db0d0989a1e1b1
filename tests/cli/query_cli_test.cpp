// Tests the results of `query` that scripts and people read: tables, JSON, arrays, and the exit codes of invalid calls.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tests/support/array_file.h"
#include "tests/support/bake_fixture.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::query_cli_test {
namespace {

using Json = nlohmann::json;

class QueryCli : public testing::Test {
 protected:
  // Writes three keyframes of a square of two triangles. The last vertex moves across the diagonal and back on the same
  // path. Face 1 turns over at t = 1/2 of both segments, and face 0 stands still.
  QueryCli() {
    for (const auto& [name, corner] : {std::pair{"a.obj", "1 1 0"}, {"b.obj", "0 0 0"}, {"c.obj", "1 1 0"}})
      folder_.write(name, std::string("v 0 0 0\nv 1 0 0\nv 0 1 0\nv ") + corner + "\nf 1 2 3\nf 2 4 3\n");
  }

  [[nodiscard]] ProcessResult run(const std::string& arguments) const {
    return run_shell(std::string(kProgram) + " query " + arguments, folder_.path());
  }
  [[nodiscard]] Json json_of(const std::string& arguments) const {
    const ProcessResult result = run(arguments + " --json");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return Json::parse(result.out);
  }
  // Expects numbers that differ from the wanted numbers by at most 1e-12. This tolerance is wider than the brackets
  // around the computed times.
  static void expect_near(const Json& values, const std::vector<double>& wanted) {
    ASSERT_EQ(values.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) EXPECT_NEAR(values[i].get<double>(), wanted[i], 1e-12) << i;
  }
  void expect_misuse(const std::string& arguments, const std::string& word) const {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(word), std::string::npos) << word << " in " << result.err;
  }

  test::TemporaryFolder folder_;
};

TEST_F(QueryCli, a_skin_that_cannot_be_read_is_said_and_left_out) {
  test::GltfBuilder builder = test::still_hills_document(1);
  const auto joint = builder.add("nodes", {{"translation", {0, 5, 0}}});
  builder.json["nodes"][0]["skin"] = builder.add("skins", {{"joints", {joint}}});
  folder_.write("skinned.glb", builder.glb());
  const ProcessResult skinned = run("collapse skinned.glb");
  EXPECT_EQ(skinned.exit_code, 0) << skinned.err;
  EXPECT_NE(skinned.err.find("JOINTS_0); export the file again; the mesh is moved without its skin"), std::string::npos)
      << skinned.err;
  EXPECT_EQ(run("collapse skinned.glb --strict").exit_code, 3);
}

TEST_F(QueryCli, a_mesh_behind_a_skin_is_asked_as_it_is_in_the_scene) {
  test::GltfBuilder builder = test::still_hills_document(1);
  folder_.write("free.glb", builder.glb());
  auto& attributes = builder.json["meshes"][0]["primitives"][0]["attributes"];
  const std::size_t count = builder.json["accessors"][attributes["POSITION"].get<std::size_t>()]["count"];
  attributes["JOINTS_0"] = builder.add_accessor("VEC4", std::vector<std::uint8_t>(4 * count));
  attributes["WEIGHTS_0"] = builder.add_accessor("VEC4", std::vector<float>(4 * count));
  const auto joint = builder.add("nodes", {{"rotation", {1, 0, 0, 0}}});  // half a turn around x
  builder.json["nodes"][0]["skin"] = builder.add("skins", {{"joints", {joint}}});
  builder.json["nodes"][0]["rotation"] = {0, 1, 0, 0};
  folder_.write("skinned.glb", builder.glb());
  const auto rows = [&](const std::string& arguments) {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("skinned paths: ") != std::string::npos &&
                  result.err.find("in the scene's world") != std::string::npos,
              arguments.find("skinned.glb") != std::string::npos)
        << result.err;
    return std::count(result.out.begin(), result.out.end(), ',');
  };
  const auto front = rows("facing free.glb --direction 0.2,0.9,0.4 --json");
  const auto back = rows("facing free.glb --direction 0.2,-0.9,-0.4 --json");
  EXPECT_NE(front, back);
  EXPECT_EQ(rows("facing skinned.glb --direction 0.2,-0.9,-0.4 --json"), front);
  EXPECT_EQ(rows("facing skinned.glb --direction 0.2,-0.9,-0.4 --json --world"), front);
}

TEST_F(QueryCli, elements_are_of_the_questions_that_take_them) {
  expect_misuse("collapse a.obj b.obj --elements vertices", "query collapse can only be asked of faces");
  expect_misuse("facing a.obj b.obj --direction 0,0,1 --elements edges", "--elements");
  expect_misuse("facing a.obj b.obj --direction 0,0,1 --elements vertices --silhouettes", "--silhouettes");
  const Json vertices = json_of("facing a.obj b.obj --direction 0,0,1 --elements vertices");
  EXPECT_EQ(vertices["summary"]["vertices"], 4);
  // Vertex 3 crosses the diagonal. Only face 1 has this vertex, so the vertex counts as front-facing until face 1 turns
  // over at t = 1/2.
  const Json &of = vertices["arrays"]["vertex"], &to = vertices["arrays"]["to"];
  ASSERT_EQ(of.size(), 4U);
  expect_near(Json::array({to[3]}), {0.5});
}

TEST_F(QueryCli, collapses_are_rows_of_segment_and_face) {
  const Json json = json_of("collapse a.obj b.obj c.obj");
  EXPECT_EQ(json.at("question"), "collapse");
  EXPECT_EQ(json.at("summary").at("collapses"), 2);
  const Json& arrays = json.at("arrays");
  EXPECT_EQ(arrays.at("segment"), Json({0, 1}));
  EXPECT_EQ(arrays.at("face"), Json({1, 1}));
  EXPECT_EQ(arrays.at("lower"), Json({0.5, 0.5}));
  EXPECT_EQ(arrays.at("upper"), Json({0.5, 0.5}));
  EXPECT_EQ(arrays.at("time"), Json({0.5, 1.5}));
  EXPECT_EQ(arrays.at("turns_over"), Json({true, true}));
  EXPECT_EQ(arrays.at("before"), Json::parse("[[0.0, 0.0, 1.0], [0.0, 0.0, -1.0]]"));
  EXPECT_EQ(arrays.at("after"), Json::parse("[[0.0, 0.0, -1.0], [0.0, 0.0, 1.0]]"));
}

TEST_F(QueryCli, a_span_asks_about_its_own_time_only) {
  EXPECT_EQ(json_of("collapse a.obj b.obj c.obj --from 1").at("arrays").at("segment"), Json::array({1}));
  EXPECT_EQ(json_of("collapse a.obj b.obj c.obj --to 0.75").at("arrays").at("segment"), Json::array({0}));
  EXPECT_EQ(json_of("collapse a.obj b.obj c.obj --from .6 --to 1.4").at("summary").at("segments"), 2);
  EXPECT_EQ(json_of("collapse a.obj b.obj c.obj --from .6 --to 1.4").at("summary").at("collapses"), 0);
  EXPECT_EQ(json_of("collapse a.obj b.obj c.obj --from 5 --to 15 --fps .1").at("summary").at("collapses"), 2);
}

TEST_F(QueryCli, arrays_are_those_of_json) {
  EXPECT_EQ(run("collapse a.obj b.obj c.obj -o found.npz").exit_code, 0);
  const auto arrays = test::parse_npz(test::read_whole(folder_ / "found.npz"));
  EXPECT_EQ(arrays.at("segment").as<std::int64_t>(), (std::vector<std::int64_t>{0, 1}));
  EXPECT_EQ(arrays.at("lower").as<double>(), (std::vector<double>{0.5, 0.5}));
  EXPECT_EQ(arrays.at("before").shape, (std::vector<std::size_t>{2, 3}));
  EXPECT_EQ(arrays.at("turns_over").shape, (std::vector<std::size_t>{2}));
  EXPECT_EQ(arrays.at("always_face").shape, (std::vector<std::size_t>{0}));
  EXPECT_EQ(arrays.size(), json_of("collapse a.obj b.obj c.obj").at("arrays").size());
}

TEST_F(QueryCli, faces_show_their_front_in_intervals) {
  // A viewer above sees the front of face 1 until t = 1/2 of the first segment, and again from t = 1/2 of the second
  // segment.
  const Json above = json_of("facing a.obj b.obj c.obj --direction 0,0,1").at("arrays");
  EXPECT_EQ(above.at("segment"), Json({0, 0, 1, 1}));
  EXPECT_EQ(above.at("face"), Json({0, 1, 0, 1}));
  expect_near(above.at("from"), {0, 0, 0, 0.5});
  expect_near(above.at("from_upper"), {0, 0, 0, 0.5});
  expect_near(above.at("to_lower"), {1, 0.5, 1, 1});
  expect_near(above.at("to"), {1, 0.5, 1, 1});
  EXPECT_LE(above.at("from")[3], 0.5);
  EXPECT_GE(above.at("from_upper")[3], 0.5);
  EXPECT_EQ(json_of("facing a.obj b.obj c.obj --eye 0,0,9").at("arrays").at("face"), above.at("face"));
  const Json below = json_of("facing a.obj b.obj c.obj --direction 0,0,-1 --from .25 --to 1.25").at("arrays");
  EXPECT_EQ(below.at("face"), Json({1, 1}));
  expect_near(below.at("from"), {0.5, 0});
  expect_near(below.at("to"), {1, 0.25});
}

TEST_F(QueryCli, an_eye_moves_over_the_whole_motion) {
  // The eye passes through the plane z = 0 at time 1, so face 0 is hidden after time 1. Face 1 shows its front in the
  // first and the third quarter of the motion.
  const Json arrays = json_of("facing a.obj b.obj c.obj --eye .2,.2,1,.2,.2,-1").at("arrays");
  EXPECT_EQ(arrays.at("segment"), Json({0, 0, 1}));
  EXPECT_EQ(arrays.at("face"), Json({0, 1, 1}));
  expect_near(arrays.at("from"), {0, 0, 0});
  expect_near(arrays.at("to"), {1, 0.5, 0.5});
}

TEST_F(QueryCli, silhouettes_are_edges_between_front_and_back) {
  const Json json = json_of("facing a.obj b.obj c.obj --direction 0,0,1 --silhouettes");
  EXPECT_EQ(json.at("summary").at("silhouettes"), 2);
  EXPECT_EQ(json.at("arrays").at("silhouette_vertices"), Json::parse("[[1, 2], [1, 2]]"));
  expect_near(json.at("arrays").at("silhouette_from"), {0.5, 0});
  expect_near(json.at("arrays").at("silhouette_to"), {1, 0.5});
}

TEST_F(QueryCli, people_get_a_table) {
  const ProcessResult result = run("collapse a.obj b.obj c.obj");
  EXPECT_EQ(result.exit_code, 0);
  for (const char* const word : {"a.obj ... c.obj\n", "2  times a face loses all area at an instant\n",
                                 "2  times a face loses all area and turns over", "turns over", "0 0 -1"})
    EXPECT_NE(result.out.find(word), std::string::npos) << word << " in " << result.out;
}

TEST_F(QueryCli, misuse_is_answered_with_what_there_is) {
  expect_misuse("", "QUESTION: the question is missing; choose one of ");
  expect_misuse("why a.obj b.obj", "there is no question 'why'; choose one of ");
  expect_misuse("colapse a.obj b.obj", "there is no question 'colapse'; did you mean collapse? Choose one of cones, ");
  expect_misuse("collapse a.obj b.obj -o table.txt", "must end in .npz");
  expect_misuse("collapse a.obj b.obj --eye 1,2,3", "--eye: this option is only for query facing");
  expect_misuse("facing a.obj b.obj", "--direction: the camera is missing");
  expect_misuse("facing a.obj b.obj --eye 1,2", "--eye: the value must be three numbers X,Y,Z, or");
  expect_misuse("facing a.obj b.obj --eye 1,2,x", "--eye: 'x' is not a number");
  expect_misuse("facing a.obj b.obj --direction 0,0,0",
                "--direction: the direction must not be 0,0,0; give at least one number that is not 0");
  expect_misuse("collapse a.obj b.obj --from 1",
                "--from: the motion has nothing after 1; the motion goes from 0 to 1; choose a time in between");
  expect_misuse("collapse a.obj b.obj --to 0", "--to: the motion has nothing before 0");
  expect_misuse("collapse a.obj b.obj --from .5 --to .5", "--to: the last time must be later than the first");
  EXPECT_EQ(run("collapse a.obj").exit_code, 3) << "a mesh that stands still is no motion";
}

}  // namespace
}  // namespace chronormal::query_cli_test
