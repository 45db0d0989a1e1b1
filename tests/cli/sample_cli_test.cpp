// Tests the results of `sample` that scripts and people read: arrays of normals, meshes with normals, and exit codes.
// If the environment variable CHRONORMAL_DATA names a folder of meshes from other tools, also compares the computed
// normals with the normals of these meshes.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "tests/support/array_file.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::sample_cli_test {
namespace {

namespace fs = std::filesystem;

constexpr double kDegreesPerRadian = 57.29577951308232;

class SampleCli : public testing::Test {
 protected:
  SampleCli() {
    // Two quads fold to a right angle along a seam: vertices 2 and 4 are at the same point, and so are vertices 3 and
    // 5.
    folder_.write("a.obj",
                  std::string("v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 1 0 0\nv 1 1 0\nv 2 0 0\nv 2 1 0\n") + kFaces);
    folder_.write("b.obj",
                  std::string("v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 1 0 0\nv 1 1 0\nv 1 0 1\nv 1 1 1\n") + kFaces);
    folder_.write("quad.glb", test::quad_document().glb());
  }

  [[nodiscard]] ProcessResult run(const std::string& arguments, const std::string& input = "") const {
    return run_shell(std::string(kProgram) + " sample " + arguments, folder_.path(), input);
  }
  void expect_error(const std::string& arguments, int exit_code, const std::string& word) const {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
  }
  // Runs `sample` with the given arguments, and returns the array that it writes to standard output. Fails if the
  // program writes anything to standard error.
  [[nodiscard]] test::ArrayFile array_of(const std::string& arguments) const {
    const ProcessResult result = run(arguments + " -o -");
    EXPECT_EQ(result.exit_code, 0) << arguments << "\n" << result.err;
    EXPECT_EQ(result.err, "");
    return result.exit_code == 0 ? test::parse_npy(result.out) : test::ArrayFile{};
  }

  static constexpr const char* kFaces = "s 1\nf 1 3 4 2\ns 2\nf 5 7 8 6\n";
  test::TemporaryFolder folder_;
};

std::array<float, 3> row(const std::vector<float>& values, std::size_t i) {
  return {values.at(3 * i), values.at(3 * i + 1), values.at(3 * i + 2)};
}

TEST_F(SampleCli, vertices_across_a_seam_are_exact_by_hand) {
  const test::ArrayFile array = array_of("a.obj b.obj --times 0,0.5,1");
  EXPECT_EQ(array.shape, (std::vector<std::size_t>{3, 8, 3}));
  const auto normals = array.as<float>();
  // An edge of the second quad moves from (1, 0, 0) to (0, 0, 1), so the normal of the second quad at t is (-t, 0, 1 -
  // t). At the seam, the normals of both quads are added. The normal of the first quad is (0, 0, 1).
  for (const auto& [time, t] : {std::pair{0U, 0.0}, std::pair{1U, 0.5}, std::pair{2U, 1.0}}) {
    const double length = std::sqrt(t * t + (2 - t) * (2 - t));
    for (const std::size_t v : {2U, 3U, 4U, 5U}) {
      EXPECT_NEAR(row(normals, 8 * time + v)[0], -t / length, 1e-6) << t;
      EXPECT_NEAR(row(normals, 8 * time + v)[2], (2 - t) / length, 1e-6) << t;
      EXPECT_EQ(row(normals, 8 * time + v), row(normals, 8 * time + 2)) << "copies have the same bits";
    }
    EXPECT_EQ(row(normals, 8 * time), (std::array<float, 3>{0, 0, 1}));
  }
  const auto apart = array_of("a.obj b.obj --times 1 --no-weld").as<float>();
  EXPECT_EQ(row(apart, 2), (std::array<float, 3>{0, 0, 1}));
  EXPECT_EQ(row(apart, 4), (std::array<float, 3>{-1, 0, 0}));
}

TEST_F(SampleCli, elements_lengths_and_hard_edges) {
  EXPECT_EQ(array_of("a.obj b.obj --times 0 --elements faces").shape, (std::vector<std::size_t>{1, 2, 3}));
  EXPECT_EQ(array_of("a.obj b.obj --times 0 --elements corners").shape, (std::vector<std::size_t>{1, 8, 3}));
  const auto faces = array_of("a.obj b.obj --times 0.5 --elements faces --length area").as<float>();
  EXPECT_EQ(row(faces, 0), (std::array<float, 3>{0, 0, 2}));
  EXPECT_EQ(row(faces, 1), (std::array<float, 3>{-1, 0, 1}));
  // The motion goes from b.obj to a.obj, so it starts with the two quads folded by 90 degrees.
  const auto distinct = [this](const std::string& options) {
    const auto normals = array_of("b.obj a.obj --times 0 --elements corners " + options).as<float>();
    std::set<std::array<float, 3>> set;
    for (std::size_t c = 0; c < 8; ++c) set.insert({row(normals, c)[0] + 0.0F, 0, row(normals, c)[2] + 0.0F});
    return set.size();
  };
  EXPECT_EQ(distinct(""), 3U);
  EXPECT_EQ(distinct("--crease 91"), 3U);
  EXPECT_EQ(distinct("--crease 89"), 2U);
  EXPECT_EQ(distinct("--hard-edges groups"), 2U);
  expect_error("b.obj a.obj --times 0 --elements corners --hard-edges normals -o n.npy", 3,
               "b.obj: the file has no normals");
}

TEST_F(SampleCli, gltf_files_have_hard_edges_by_their_own_normals) {
  // Two triangles with separate vertices meet at a right angle along the x axis, and the mesh has one target. At the
  // seam, the normals that the file stores are either equal (smooth) or different (hard).
  const auto distinct = [this](const std::vector<float>& normals) {
    test::GltfBuilder builder;
    const auto base = builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0, /**/ 0, 0, 0, 0, 0, -1, 1, 0, 0});
    const auto lift = builder.add_positions({0, 0, 0, 0, 0, 0, 0, 0, 1, /**/ 0, 0, 0, 0, 0, 0, 0, 0, 0});
    auto primitive =
        test::GltfBuilder::primitive(base, std::nullopt, test::GltfBuilder::Json::array({{{"POSITION", lift}}}));
    primitive["attributes"]["NORMAL"] = builder.add_positions(normals);
    builder.add_mesh(primitive);
    folder_.write("corner.glb", builder.glb());
    const auto result = array_of("corner.glb --weights 0 --elements corners --hard-edges normals").as<float>();
    std::set<std::array<float, 3>> set;
    for (std::size_t c = 0; c < 6; ++c) {
      const auto n = row(result, c);
      set.insert({n[0] + 0.0F, n[1] + 0.0F, n[2] + 0.0F});
    }
    return set.size();
  };
  EXPECT_EQ(distinct({0, 0, 1, 0, 0, 1, 0, 0, 1, /**/ 0, 1, 0, 0, 1, 0, 0, 1, 0}), 2U);
  const float half = 0.70710678F;
  EXPECT_EQ(distinct({0, half, half, 0, half, half, 0, 0, 1, /**/ 0, half, half, 0, 1, 0, 0, half, half}), 3U);
}

TEST_F(SampleCli, times_are_a_list_or_a_range) {
  const auto times_of = [this](const std::string& times, const std::string& more = "") {
    const ProcessResult result = run("a.obj b.obj a.obj --times " + times + more + " --force -o t.npz");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return test::parse_npz(test::read_whole(folder_ / "t.npz")).at("times").as<double>();
  };
  EXPECT_EQ(times_of("0:0.5:2"), (std::vector<double>{0, 0.5, 1, 1.5, 2}));
  EXPECT_EQ(times_of("0:0.7:2"), (std::vector<double>{0, 0.7, 1.4}));
  EXPECT_EQ(times_of("1.9,0:1:1,+.25").size(), 4U);
  const auto tenths = times_of("0:0.1:2");
  EXPECT_EQ(tenths.size(), 21U);
  EXPECT_EQ(tenths.back(), 2) << "the last is the end itself";
  EXPECT_EQ(times_of("0.5:1:0.5"), (std::vector<double>{0.5}));
  // In floating point, 3 x 0.1 is larger than 0.3, and 0.3 / 0.1 is smaller than 3. In spite of such rounding errors,
  // the range must have four times and end at 0.3.
  const auto thirds = times_of("0:0.1:0.3");
  EXPECT_EQ(thirds.size(), 4U);
  EXPECT_EQ(thirds.back(), 0.3);
  EXPECT_EQ(times_of("0:0.01:0.04", " --fps 50").size(), 5U);
  for (const char* const wrong : {"x", "0,,1", "1:2", "0:0:1", "0:-1:1", "1:1:0", "nan", "0:1e-9:1", "1e999", "''"})
    expect_error(std::string("a.obj b.obj -o n.npy --times ") + wrong, 2, "--times");
  expect_error("a.obj b.obj -o n.npy --times 0,1.5", 2,
               "time 1.5 is outside of the motion, which goes from 0 to 1; choose a time in between");
  expect_error("a.obj b.obj -o n.npy --times=-1", 2, "from 0 to 1");
  expect_error("a.obj b.obj -o n.npy --times 1 --fps 30", 2, "from 0 to 0.0333333");
  expect_error("a.obj b.obj -o n.npy", 2, "0 to 1");
  expect_error("a.obj b.obj -o n.npy --times 0:1:999998,0,0", 2,
               "--times: the list has more than 1,000,000 times; give fewer times");
}

TEST_F(SampleCli, weights_are_for_blend_shapes) {
  const ProcessResult npz = run("--base a.obj b.obj --weights 0 --weights=-0.5 --weights 1 -o w.npz");
  EXPECT_EQ(npz.exit_code, 0) << npz.err;
  const auto arrays = test::parse_npz(test::read_whole(folder_ / "w.npz"));
  EXPECT_EQ(arrays.at("weights").shape, (std::vector<std::size_t>{3, 1}));
  EXPECT_EQ(arrays.at("weights").as<double>(), (std::vector<double>{0, -0.5, 1}));
  const auto positions = arrays.at("positions").as<float>();
  EXPECT_EQ(row(positions, 8 + 6), (std::array<float, 3>{2.5, 0, -0.5}));
  const std::vector<std::size_t> two_faces = {1, 2, 3};
  EXPECT_EQ(array_of("--base a.obj b.obj a.obj --weights -0.5 --elements faces").shape, two_faces)
      << "the base is no target";
  EXPECT_EQ(array_of("quad.glb --weights 0.5,0 --elements faces").shape, two_faces);
  const auto time = array_of("a.obj b.obj --times 0.25").as<float>();
  const auto weight = array_of("--base a.obj b.obj --weights 0.25").as<float>();
  for (std::size_t i = 0; i < time.size(); ++i) EXPECT_NEAR(time[i], weight[i], 1e-6);

  expect_error("--base a.obj b.obj --times 0.5 -o n.npy", 2,
               "blend shapes have no times; give --weights, 1 number for");
  expect_error("quad.glb --times 0.5 -o n.npy", 2, "--weights, 2 numbers for each pose");
  expect_error("--base a.obj b.obj -o n.npy", 2, "--weights");
  expect_error("--base a.obj b.obj --weights 1,0 -o n.npy", 2, "the input has 1 target, but the pose has 2 weights");
  expect_error("--base a.obj b.obj --weights 1x -o n.npy", 2, "'1x' is not a number");
  expect_error("--base a.obj b.obj --weights 1 --times 0 -o n.npy", 2, "cannot be used together");
  expect_error("a.obj b.obj --weights 1 -o n.npy", 2, "give --times instead, from 0 to 1");
  expect_error("a.obj --weights 1 -o n.npy", 2, "no targets");
}

TEST_F(SampleCli, weights_are_given_by_the_names_of_targets) {
  const auto named = [this](const std::string& weights) { return array_of("named.glb --weights " + weights).elements; };
  test::GltfBuilder builder = test::quad_document();
  builder.json["meshes"][0]["extras"]["targetNames"] = {"jawOpen", "mouth, \"left\" = up "};
  folder_.write("named.glb", builder.glb());
  EXPECT_EQ(named("jawOpen=0.5"), named("0.5,0"));
  EXPECT_EQ(named("1=0.25,jawOpen=-2"), named("-2,0.25"));
  EXPECT_EQ(named("' jawOpen = 2 , \"mouth, \"\"left\"\" = up \"=1'"), named("2,1"));
  EXPECT_EQ(array_of("--base a.obj b.obj --weights b=0.5").elements,
            array_of("--base a.obj b.obj --weights 0.5").elements);
  const auto refused = [this](const std::string& weights, const std::string& why) {
    expect_error("named.glb -o n.npy --weights " + weights, 2, "--weights: " + why);
  };
  refused("jawopen=1", "there is no target 'jawopen'; did you mean jawOpen? The targets are 0 (jawOpen), 1 (mouth");
  refused("2=1", "there is no target '2'; the targets are 0 (jawOpen)");
  refused("jawOpen=1,0=2", "target 0 (jawOpen) has two weights");
  refused("jawOpen=1,2", "'jawOpen=1,2' mixes numbers with NAME=WEIGHT");
  refused("jawOpen", "'jawOpen' is not a number; give a number such as 0.5, or NAME=WEIGHT");
  refused("jawOpen=", "'' is not a number");
  refused("'\"jawOpen=1'", "a closing quote is missing in '\"jawOpen=1'");
  refused("'\"jawOpen\",1'", "target 'jawOpen' has no weight; write \"jawOpen\"=WEIGHT");
  refused("jawOpen=1,", "'' is not a number");
  expect_error("a.obj b.obj -o n.npy --weights b=1", 2, "weights are only for blend shapes");
}

TEST_F(SampleCli, a_name_that_several_targets_have_is_refused_with_their_numbers) {
  test::GltfBuilder builder = test::quad_document();
  builder.json["meshes"][0]["extras"]["targetNames"] = {"smile", "smile"};
  folder_.write("twice.glb", builder.glb());
  expect_error("twice.glb -o n.npy --weights smile=1", 2,
               "targets 0 and 1 all have the name 'smile'; give the number of the target instead");
  EXPECT_EQ(array_of("twice.glb --weights 1=1").elements, array_of("twice.glb --weights 0,1").elements);
  // If a number is also the name of a target, it selects the target with this name.
  builder.json["meshes"][0]["extras"]["targetNames"] = {"1", "smile"};
  folder_.write("number.glb", builder.glb());
  EXPECT_EQ(array_of("number.glb --weights 1=1").elements, array_of("number.glb --weights 1,0").elements);
}

TEST_F(SampleCli, keys_are_the_times_of_the_keyframes) {
  const auto times_of = [this](const std::string& arguments) {
    const ProcessResult result = run(arguments + " --times keys --force -o t.npz");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return test::parse_npz(test::read_whole(folder_ / "t.npz")).at("times").as<double>();
  };
  EXPECT_EQ(times_of("a.obj b.obj a.obj --fps 2"), (std::vector<double>{0, 0.5, 1}));
  EXPECT_EQ(times_of("a.obj"), (std::vector<double>{0}));
  ASSERT_EQ(run_shell(std::string(kProgram) + " convert a.obj b.obj b.obj --fps 4 -o c.mdd", folder_.path()).exit_code,
            0);
  EXPECT_EQ(times_of("a.obj c.mdd"), (std::vector<double>{0, 0.25, 0.5}));
  // The program divides a cubic spline into many pieces, whose ends do not count as keys. A jump of the weights counts
  // as one key.
  test::GltfBuilder builder = test::quad_document();
  const std::vector<float> times = {0.5F, 1, 3};
  builder.add_track(0, 0, times, std::vector<float>{0, 0, 0, 0, 9, 9, 0, 0, 1, 1, 0, 0, 0, 0, 0, 0, 9, 9},
                    "CUBICSPLINE");
  builder.add_track(1, 0, times, std::vector<float>{0, 0, 1, 0, 0, 1}, "STEP");
  folder_.write("moving.glb", builder.glb());
  EXPECT_EQ(times_of("moving.glb --animation 0"), (std::vector<double>{0.5, 1, 3}));
  EXPECT_EQ(times_of("moving.glb --animation 1"), (std::vector<double>{0.5, 1, 3}));
  expect_error("moving.glb --times keys -o n.npy", 2, "blend shapes have no times");
  expect_error("a.obj b.obj --times keys,0.5 -o n.npy", 2, "'keys' is not a number");
}

TEST_F(SampleCli, a_single_mesh_is_one_pose) {
  EXPECT_EQ(array_of("a.obj").shape, (std::vector<std::size_t>{1, 8, 3}));
  EXPECT_EQ(array_of("a.obj --times 0").elements, array_of("a.obj").elements);
  expect_error("a.obj --times 0.5 -o n.npy", 2, "does not move");
  expect_error("a.obj --times 0,0 -o n.npy", 2, "leave --times out");
  const ProcessResult piped = run("- -o -", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  EXPECT_EQ(test::parse_npy(piped.out).as<float>(), (std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}));
}

TEST_F(SampleCli, meshes_go_to_a_file_each_or_one_to_standard_output) {
  EXPECT_EQ(run("a.obj b.obj --times 0,1 -o out_%03d.ply").exit_code, 0);
  EXPECT_TRUE(fs::exists(folder_ / "out_000.ply") && fs::exists(folder_ / "out_001.ply"));
  const ProcessResult obj = run("a.obj b.obj --times 1 --elements faces --format obj -o -");
  EXPECT_EQ(obj.exit_code, 0) << obj.err;
  EXPECT_NE(obj.out.find("vn -1 0 0\nf 1//1 3//1 4//1 2//1\nf 5//2 7//2 8//2 6//2\n"), std::string::npos) << obj.out;
  expect_error("a.obj b.obj --times 0,1 -o out.ply", 2, "%d");
  expect_error("a.obj b.obj --times 0,1 --format obj -o -", 2, "standard output can only take one");
  expect_error("a.obj b.obj --times 0 --elements corners -o out.ply", 2, "corners");
  expect_error("a.obj b.obj --times 0 -o out.stl", 2, ".npy, .npz, .ply or .obj");
  expect_error("a.obj b.obj --times 0 -o n.npy --format stl", 2, "npy, npz, ply, obj");
}

TEST_F(SampleCli, exit_codes_and_files_that_exist) {
  expect_error("a.obj b.obj --times 0", 2, "-o OUT");
  expect_error("a.obj missing.obj --times 0 -o n.npy", 1, "missing.obj");
  folder_.write("bad.obj", "v 0 0 0\nf 1 1 2\n");
  expect_error("a.obj bad.obj --times 0 -o n.npy", 3, "bad.obj");
  folder_.write("n.npy", "old");
  expect_error("a.obj b.obj --times 0 -o n.npy", 1, "--force");
  expect_error("a.obj missing.obj --times 0 -o n.npy", 1, "--force");
  EXPECT_EQ(test::read_whole(folder_ / "n.npy"), "old");
  EXPECT_EQ(run("a.obj b.obj --times 0 -o n.npy --force").exit_code, 0);
  EXPECT_EQ(test::parse_npy(test::read_whole(folder_ / "n.npy")).shape[1], 8U);
  if (fs::exists("/dev/full")) expect_error("a.obj b.obj --times 0 --format npy -o /dev/full", 1, "/dev/full");
}

TEST_F(SampleCli, options_that_do_not_go_together_are_usage_errors) {
  const std::string input = "a.obj b.obj --times 0 -o n.npy ";
  expect_error(input + "--elements edges", 2, "--elements: ");
  expect_error(input + "--weighting sine", 2, "area-angle");
  expect_error(input + "--length long", 2, "must be unit (1) or area");
  expect_error(input + "--length area --weighting angle", 2, "--length");
  expect_error(input + "--elements faces --weighting angle", 2, "--weighting");
  expect_error(input + "--elements faces --no-weld", 2, "--no-weld");
  expect_error(input + "--crease 30", 2, "--elements corners");
  expect_error(input + "--elements corners --crease 200", 2, "0 to 180");
  expect_error(input + "--hard-edges groups", 2, "--elements corners");
  expect_error(input + "--elements corners --hard-edges all", 2, "groups or normals");
  expect_error(input + "--elements corners --hard-edges groups --crease 30", 2, "cannot be used together");
  expect_error("--sample twist --times 0 --elements corners --hard-edges groups -o n.npy", 2, "built-in");
  expect_error("quad.glb --weights 0,0 --elements corners --hard-edges groups -o n.npy", 2, "no smoothing groups");
  expect_error("quad.glb --weights 0,0 --elements corners --hard-edges normals -o n.npy", 3, "has no normals");
  EXPECT_EQ(run("a.obj b.obj --times 0 --elements corners --hard-edges groups -o -", "").exit_code, 0);
  folder_.write("plain.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  expect_error("plain.obj --elements corners --hard-edges groups -o n.npy", 3, "no smoothing groups");
  ASSERT_EQ(run_shell(std::string(kProgram) + " convert a.obj b.obj -o bare.npz", folder_.path()).exit_code, 0);
  expect_error("bare.npz --times 0 --elements corners --hard-edges normals -o n.npy", 2,
               "bare.npz has neither normals nor smoothing groups");
}

TEST_F(SampleCli, hard_edges_are_those_of_the_first_mesh) {
  ASSERT_EQ(run_shell(std::string(kProgram) + " convert b.obj a.obj -o cache.pc2", folder_.path()).exit_code, 0);
  const std::string options = " --elements corners --hard-edges groups ";
  const std::string expected = array_of("b.obj a.obj --times 0.25" + options).elements;
  EXPECT_NE(array_of("b.obj a.obj --times 0.25 --elements corners").elements, expected);
  EXPECT_EQ(array_of("cache.pc2 a.obj --times 0.25" + options).elements, expected);
  EXPECT_EQ(array_of("a.obj cache.pc2 --times 0.25" + options).elements, expected);
  EXPECT_EQ(array_of("--base b.obj a.obj --weights 0.25" + options).shape, (std::vector<std::size_t>{1, 8, 3}));
  std::string smooth = test::read_whole(folder_ / "b.obj");
  smooth.replace(smooth.find("s 2"), 3, "s 1");
  folder_.write("smooth.obj", smooth);
  EXPECT_NE(array_of("smooth.obj a.obj --times 0.25" + options).elements, expected) << "not of the second";
}

TEST_F(SampleCli, elements_without_a_normal_are_counted_on_stderr) {
  folder_.write("lonely.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 9 9 9\nf 1 2 3\n");
  const ProcessResult result = run("lonely.obj -o -");
  EXPECT_EQ(result.exit_code, 0);
  EXPECT_NE(result.err.find("of 4 normals of vertices, 1 is written as (0, 0, 0)"), std::string::npos) << result.err;
  EXPECT_EQ(row(test::parse_npy(result.out).as<float>(), 3), (std::array<float, 3>{0, 0, 0}));
}

// Face 1 turns by 90 degrees. The exact and the linear normals follow the straight path of an edge of this face, while
// slerp turns the normal at a constant speed.
TEST_F(SampleCli, a_scheme_is_written_in_every_format) {
  const auto tangent_of = [&](const std::string& scheme) {
    const std::vector<float> normals =
        array_of("a.obj b.obj --elements faces --times 0.25 --scheme " + scheme).as<float>();
    return normals.size() == 6 ? std::fabs(normals[3] / normals[5]) : 0;
  };
  EXPECT_NEAR(tangent_of("polynomial"), 1 / 3.0, 1e-6);
  EXPECT_NEAR(tangent_of("linear"), 1 / 3.0, 1e-6);
  EXPECT_NEAR(tangent_of("slerp"), std::tan(22.5 / kDegreesPerRadian), 1e-6);

  const std::string of_vertices = "a.obj b.obj --times 0.25 --scheme slerp";
  const std::vector<float> expected = array_of(of_vertices).as<float>();
  ASSERT_EQ(expected.size(), 24U);
  ASSERT_EQ(run(of_vertices + " -o v.npz").exit_code, 0);
  std::istringstream obj(run(of_vertices + " --format obj -o -").out), ply(run(of_vertices + " --format ply -o -").out);
  std::vector<float> found;
  for (std::string word; obj >> word;) {
    float n = 0;
    for (int c = 0; word == "vn" && c < 3 && obj >> n; ++c) found.push_back(n);
  }
  EXPECT_EQ(found, expected);
  EXPECT_NE(ply.str().find("property float nx"), std::string::npos);
  for (std::size_t v = 0; v < 8; ++v) {
    const std::string bytes(reinterpret_cast<const char*>(&expected[3 * v]), 3 * sizeof(float));
    EXPECT_NE(ply.str().find(bytes), std::string::npos) << v;
  }
}

TEST_F(SampleCli, steps_say_how_far_they_drift) {
  const ProcessResult played = run("a.obj b.obj a.obj --elements faces --scheme linear --step 100:0 -o played.npy");
  EXPECT_EQ(played.exit_code, 0);
  EXPECT_NE(played.err.find("scheme linear played step by step drifts from its curve by up to "), std::string::npos)
      << played.err;
  EXPECT_NE(played.err.find(" degrees, at face 1 and time "), std::string::npos) << played.err;
  const test::ArrayFile array = array_of("a.obj b.obj a.obj --scheme slerp --step 8 -q");
  EXPECT_EQ(array.shape, (std::vector<std::size_t>{17, 8, 3}));
  const test::ArrayFile of_targets = array_of("--base a.obj b.obj --scheme slerp --step 8 -q");
  EXPECT_EQ(of_targets.shape, (std::vector<std::size_t>{9, 8, 3}));
  // The rows of shards 1 and 2 together must equal the rows of a run without shards.
  const std::string steps = "a.obj b.obj a.obj --scheme slerp --step 100 ";
  ASSERT_EQ(run(steps + "-o all.npy").exit_code, 0);
  for (const char* const shard : {"1", "2"})
    ASSERT_EQ(run(steps + "--shard " + shard + "/2 -o " + shard + ".npy").exit_code, 0);
  const auto shell = [&](const std::string& command) { return run_shell(command, folder_.path()).exit_code; };
  EXPECT_EQ(shell(std::string(kProgram) + " merge 1.npy 2.npy -o merged.npy && cmp merged.npy all.npy"), 0);

  const std::string two = "a.obj b.obj -o - ";
  expect_error(two + "--step 4", 2, "name a scheme with --scheme");
  expect_error(two + "--step 4 --scheme circle:timed", 2, "circle:timed cannot be played step by step");
  expect_error(two + "--step 0 --scheme linear", 2, "'0' must be N or N:M");
  expect_error(two + "--step 4:x --scheme linear", 2, "must be N or N:M");
  expect_error(two + "--step 1000000 --scheme linear", 2, "more than 1,000,000 moments");
  expect_error(two + "--step 4 --times 0.5 --scheme linear", 2, "--times");
  expect_error(two + "--scheme linear --times 0.5 --weighting angle", 2, "--weighting area");
  expect_error(two + "--scheme linear --times 0.5 --length area", 2, "--length unit");
  expect_error(two + "--scheme quaternion:edge --times 0.5", 2, "cannot be used for vertices");
  expect_error(two + "--scheme bicubic --times 0.5", 2, "there is no scheme 'bicubic'");
  expect_error("a.obj -o - --scheme linear", 2, "does not move");
}

TEST_F(SampleCli, help_lists_weightings_and_examples) {
  const ProcessResult help = run("--help");
  EXPECT_EQ(help.exit_code, 0);
  for (const char* const word : {"--times", "--weights", "--hard-edges", "area-angle", "Exit codes", "%d"})
    EXPECT_NE(help.out.find(word), std::string::npos) << word;
}

// Returns the normals that an OBJ file stores, one for each corner.
std::vector<std::array<double, 3>> stored_normals(const fs::path& path) {
  std::vector<std::array<double, 3>> normals, of_corners;
  std::ifstream text(path);
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    if (word == "vn") {
      auto& n = normals.emplace_back();
      words >> n[0] >> n[1] >> n[2];
    }
    while (word == "f" && words >> line)
      of_corners.push_back(normals.at(std::stoul(line.substr(line.rfind('/') + 1)) - 1));
  }
  return of_corners;
}

class SampleCliGolden : public SampleCli {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("CHRONORMAL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
    data_ = folder;
  }

  // Returns the largest angle, in degrees, between the normals that `sample` computes for the corners of a file and the
  // normals that the file stores.
  [[nodiscard]] double largest_difference(const std::string& file, const std::string& options) const {
    const std::string path = (data_ / file).string();
    const auto expected = stored_normals(path);
    const ProcessResult result = run(path + " --elements corners --no-weld " + options + " -o -");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    if (result.exit_code != 0) return 180;
    const test::ArrayFile array = test::parse_npy(result.out);
    const auto found = array.as<float>();
    EXPECT_EQ(array.shape, (std::vector<std::size_t>{1, expected.size(), 3}));
    double worst = 0;
    for (std::size_t c = 0; c < expected.size(); ++c) {
      const auto a = row(found, c);
      const auto& b = expected[c];
      double dot = 0, square_a = 0, square_b = 0, cross = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
        dot += double{a[k]} * b[k];
        square_a += double{a[k]} * a[k];
        square_b += b[k] * b[k];
        cross += std::pow(double{a[i]} * b[j] - double{a[j]} * b[i], 2);
      }
      if ((square_a > 0) != (square_b > 0)) return 180;  // exactly one of the two normals is zero
      worst = std::max(worst, std::atan2(std::sqrt(cross), dot) * kDegreesPerRadian);
    }
    return worst;
  }

  fs::path data_;
};

TEST_F(SampleCliGolden, normals_of_other_tools_are_met_to_a_hundredth_of_a_degree) {
  std::vector<std::tuple<std::string, std::string, std::string>> cases = {
      {"golden/static/groups.obj", "normals", "area"},
      {"golden/static/textured_tetrahedron.obj", "groups", "angle"},
      {"golden/static/textured_tetrahedron.obj", "normals", "angle"},
      {"golden/static/spider.obj", "groups", "uniform"},
      {"golden/static/spider.obj", "normals", "uniform"},
      {"golden/blender_flat/blender_279_sausage_base_0.obj", "groups", "area"},
      {"caches/max_cache_box/max_cache_box_44.obj", "normals", "angle"}};
  for (const char* const folder : {"golden/maya_blend_inbetween", "golden/maya_cache_sine"}) {
    for (const auto& entry : fs::directory_iterator(data_ / folder)) {
      if (entry.path().extension() != ".obj") continue;
      const std::string file = (fs::path(folder) / entry.path().filename()).string();
      cases.emplace_back(file, "groups", "area-angle");
      cases.emplace_back(file, "normals", "area-angle");
    }
  }
  EXPECT_EQ(cases.size(), 25U);
  for (const auto& [file, edges, weighting] : cases)
    EXPECT_LT(largest_difference(file, "--hard-edges " + edges + " --weighting " + weighting), 0.01)
        << file << " " << edges;
}

TEST_F(SampleCliGolden, another_weighting_or_no_hard_edges_are_not_met) {
  const std::string spider = "golden/static/spider.obj";
  for (const char* const weighting : {"area", "angle", "area-angle", "max"})
    EXPECT_GT(largest_difference(spider, std::string("--hard-edges groups --weighting ") + weighting), 0.02);
  EXPECT_GT(largest_difference(spider, "--weighting uniform"), 0.02);
}

TEST_F(SampleCliGolden, trimesh_weighs_vertices_by_area) {
  const std::string path = (data_ / "golden/static/groups.obj").string();
  const auto normals = array_of(path + " --no-weld").as<float>();
  // The file stores the same normal for all corners of a vertex.
  std::ifstream text(path);
  const auto of_corners = stored_normals(path);
  std::size_t corner = 0, checked = 0;
  for (std::string line; std::getline(text, line);) {
    std::istringstream words(line);
    std::string word;
    words >> word;
    while (word == "f" && words >> line) {
      const std::size_t vertex = std::stoul(line.substr(0, line.find('/'))) - 1;
      const auto& expected = of_corners.at(corner++);
      const double length = std::hypot(expected[0], expected[1], expected[2]);
      for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(row(normals, vertex)[k], expected[k] / length, 1.7e-4);
      ++checked;
    }
  }
  EXPECT_GT(checked, 1000U);
}

TEST_F(SampleCli, curved_paths_are_for_sequences) {
  const std::string program = std::string(kProgram) + " sample ";
  folder_.write("c.obj",
                std::string("v 0 0 0\nv 0 1 0\nv 1 0 0\nv 1 1 0\nv 1 0 0\nv 1 1 0\nv 0 0 0.5\nv 0 1 0.5\n") + kFaces);
  const auto arrays = [&](const std::string& path) {
    return run_shell(program + "a.obj b.obj c.obj --times 0.5 --path " + path + " -o -", folder_.path());
  };
  EXPECT_EQ(arrays("catmull-rom").exit_code, 0);
  EXPECT_NE(arrays("catmull-rom").out, arrays("linear").out);
  for (const std::string wrong :
       {"a.obj b.obj --times 0.5 --path curved", "quad.glb --weights 1,0 --path catmull-rom"}) {
    const ProcessResult refused = run_shell(program + wrong + " -o -", folder_.path());
    EXPECT_EQ(refused.exit_code, 2) << wrong;
    EXPECT_NE(refused.err.find("--path"), std::string::npos) << refused.err;
  }
}

}  // namespace
}  // namespace chronormal::sample_cli_test
