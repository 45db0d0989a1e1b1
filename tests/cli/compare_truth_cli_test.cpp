// Tests `compare --truth`: all output formats must have the same figures, its remarks must fit the figures, and it must
// refuse unsuitable options.

#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::compare_truth_cli_test {
namespace {

using Json = nlohmann::json;

class CompareTruth : public testing::Test {
 protected:
  // Writes `frames` OBJ files of two triangles. From file to file, both triangles turn by `angle` radians about an axis
  // that goes through neither of them.
  void write_turn(double angle, int frames, bool with_velocities = false) {
    for (int frame = 0; frame < frames; ++frame) {
      std::ostringstream text;
      text.precision(9);
      const double c = std::cos(angle * frame), s = std::sin(angle * frame);
      const double places[4][3] = {{1, 0, 0}, {2, 0.3, 0.2}, {1.5, 1, 0.4}, {2.4, 1.2, -0.3}};
      for (const auto& p : places)
        text << "v " << c * p[0] + s * p[2] << ' ' << p[1] << ' ' << c * p[2] - s * p[0] << '\n';
      text << "f 1 2 3\nf 2 4 3\n";
      folder_.write("f" + std::to_string(frame) + ".obj", text.str());
      if (!with_velocities) continue;
      std::ostringstream ply;
      ply.precision(9);
      ply << "ply\nformat ascii 1.0\nelement vertex 4\n";
      for (const char* name : {"x", "y", "z", "vx", "vy", "vz"}) ply << "property float " << name << '\n';
      ply << "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
      for (const auto& p : places) {
        const double x = c * p[0] + s * p[2], z = c * p[2] - s * p[0];
        ply << x << ' ' << p[1] << ' ' << z << ' ' << angle * z << " 0 " << -angle * x << '\n';
      }
      ply << "4 0 1 3 2\n";
      folder_.write("f" + std::to_string(frame) + ".ply", ply.str());
    }
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments) const {
    return run_shell(std::string(kProgram) + " compare 'f*.obj' " + arguments, folder_.path());
  }

  test::TemporaryFolder folder_;
};

TEST_F(CompareTruth, table_json_and_csv_say_the_same) {
  write_turn(0.2, 9);
  const ProcessResult table = run("--truth 2"), csv = run("--truth 2 --csv");
  const Json json = Json::parse(run("--truth 2 --json").out);
  EXPECT_EQ(json["kept_keyframes"], 5);
  EXPECT_EQ(json["left_out_keyframes"], 4);
  EXPECT_NEAR(json["bend"], std::sin(0.2), 1e-5);
  EXPECT_EQ(json["is_too_sparse"], false);
  EXPECT_NE(table.out.find("5 keyframes were kept and compared with the 4 that were left out"), std::string::npos)
      << table.out;
  std::istringstream lines(csv.out);
  std::string line;
  std::getline(lines, line);
  for (const Json& row : json["rows"]) {
    std::getline(lines, line);
    const std::string names = row["path"].get<std::string>() + "," + row["scheme"].get<std::string>() + ",";
    EXPECT_NE(line.find(names), std::string::npos) << line;
    if (row["mean_degrees"] < 0.01) continue;  // the table shows fewer digits of small numbers
    char mean[32];
    std::snprintf(mean, sizeof mean, "%.4f", row["mean_degrees"].get<double>());
    EXPECT_NE(table.out.find(mean), std::string::npos) << names << mean << '\n' << table.out;
  }
  EXPECT_EQ(json["rows"].back()["path"], "catmull-rom");
}

TEST_F(CompareTruth, says_where_keyframes_are_too_far_apart_and_where_exact_is_hardly_nearer) {
  write_turn(0.1, 9);
  const std::string near = run("--truth 2").out;
  EXPECT_EQ(near.find("too far apart"), std::string::npos) << near;
  EXPECT_NE(near.find("hardly closer to this motion than linear"), std::string::npos) << near;
  write_turn(0.9, 9);
  const std::string far = run("--truth 2").out;
  EXPECT_NE(far.find("too far apart for curves"), std::string::npos) << far;
  EXPECT_NE(run("--truth 8").out.find("they need at least three keyframes"), std::string::npos);
}

TEST_F(CompareTruth, refuses_what_does_not_go_with_it) {
  write_turn(0.2, 5);
  for (const std::string other :
       {"--blend 4", "--each", "--samples 5", "--access random", "--certify", "--tolerance 1", "--errors e.npz"}) {
    const ProcessResult refused = run("--truth 2 " + other);
    EXPECT_EQ(refused.exit_code, 2) << other;
    EXPECT_NE(refused.err.find(other == "--blend 4" ? "--truth" : other.substr(0, other.find(' '))), std::string::npos)
        << refused.err;
  }
  EXPECT_EQ(run("--truth 1").exit_code, 2);
  const ProcessResult refused = run("--truth 5");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("only the first of 5 keyframes would be kept"), std::string::npos) << refused.err;
  EXPECT_NE(refused.err.find("give --truth 4 or less"), std::string::npos) << refused.err;
  write_turn(0.2, 2);
  const ProcessResult two = run_shell(std::string(kProgram) + " compare f0.obj f1.obj --truth 2", folder_.path());
  EXPECT_EQ(two.exit_code, 2);
  EXPECT_NE(two.err.find("the motion has only two keyframes"), std::string::npos) << two.err;
}

TEST_F(CompareTruth, says_that_velocities_make_a_curve_of_two_keyframes) {
  write_turn(0.2, 3, true);
  const ProcessResult result = run_shell(std::string(kProgram) + " compare 'f*.ply' --truth 2", folder_.path());
  EXPECT_NE(result.out.find("hermite"), std::string::npos) << result.out << result.err;
  EXPECT_NE(result.out.find("catmull-rom is not compared"), std::string::npos) << result.out;
}

TEST_F(CompareTruth, calls_exact_hardly_nearer_where_it_is_a_little_nearer) {
  for (const double angle : {0.1, 0.2, 0.4}) {
    write_turn(angle, 9);
    const Json json = Json::parse(run("--truth 2 --json").out);
    double linear = 0, exact = 0;
    for (const Json& row : json["rows"]) {
      if (row["scheme"] == "linear") linear = row["mean_degrees"];
      if (row["scheme"] == "polynomial") exact = row["mean_degrees"];
    }
    const std::string text = run("--truth 2").out;
    EXPECT_EQ(text.find("are not closer to this motion than linear") != std::string::npos, exact >= linear) << text;
    EXPECT_EQ(text.find("are hardly closer to this motion than linear") != std::string::npos,
              exact < linear && exact > 0.98 * linear)
        << text;
  }
}

}  // namespace
}  // namespace chronormal::compare_truth_cli_test
