// Tests the option --path, which curves the motion: the reports of the commands, their warnings, and refused requests.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/curved_motion.h"
#include "tests/support/fixtures.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/shown_glb.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::paths_cli_test {
namespace {

using Json = nlohmann::json;

class Paths : public testing::Test {
 protected:
  // Writes five frames of two triangles that turn by `angle` radians from frame to frame. The triangles also lean over:
  // y grows by lean * frame^2 * x.
  void write_turn(double angle, double lean = 0.1) {
    for (int frame = 0; frame < 5; ++frame) {
      std::ostringstream text;
      text.precision(9);
      const double c = std::cos(angle * frame), s = std::sin(angle * frame);
      const double places[4][3] = {{1, 0, 0}, {2, 0.3, 0.2}, {1.5, 1, 0.4}, {2.4, 1.2, -0.3}};
      for (const auto& p : places)
        text << "v " << c * p[0] + s * p[2] << ' ' << p[1] + lean * frame * frame * p[0] << ' ' << c * p[2] - s * p[0]
             << '\n';
      text << "f 1 2 3\nf 2 4 3\n";
      folder_.write("f" + std::to_string(frame) + ".obj", text.str());
    }
  }
  // Writes five frames of a triangle that turns by `angle` radians from frame to frame, one frame per second. Stores
  // the true velocities, multiplied by `factor`.
  void write_turn_with_velocities(double angle, double factor) {
    for (int frame = 0; frame < 5; ++frame) {
      std::ostringstream text;
      text.precision(9);
      text << "ply\nformat ascii 1.0\nelement vertex 3\n";
      for (const char* name : {"x", "y", "z", "vx", "vy", "vz"}) text << "property float " << name << '\n';
      text << "element face 1\nproperty list uchar int vertex_indices\nend_header\n";
      const double c = std::cos(angle * frame), s = std::sin(angle * frame), rate = factor * angle;
      const double places[3][3] = {{1, 0, 0}, {2, 0.3, 0.2}, {1.5, 1, 0.4}};
      for (const auto& p : places) {
        const double x = c * p[0] + s * p[2], z = c * p[2] - s * p[0];
        text << x << ' ' << p[1] << ' ' << z << ' ' << rate * z << " 0 " << -rate * x << '\n';
      }
      text << "3 0 1 2\n";
      folder_.write("v" + std::to_string(frame) + ".ply", text.str());
    }
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments) const {
    return run_shell(std::string(kProgram) + " " + arguments, folder_.path());
  }
  void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
  [[nodiscard]] std::string read(const std::string& name) const {
    return test::read_whole(folder_.path() + "/" + name);
  }
  [[nodiscard]] Json json(const std::string& arguments) const {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 0) << arguments << '\n' << result.err;
    return result.exit_code == 0 ? Json::parse(result.out) : Json();
  }

 private:
  test::TemporaryFolder folder_;
};

TEST_F(Paths, say_into_how_many_pieces_they_were_cut_and_how_near_these_are) {
  write_turn(0.3);
  const ProcessResult usual = run("inspect 'f*.obj' --path catmull-rom");
  EXPECT_NE(usual.err.find("catmull-rom paths: 4 segments cut into "), std::string::npos) << usual.err;
  EXPECT_NE(usual.err.find("whose normals are within 0.01 degrees of the normals of the curves"), std::string::npos)
      << usual.err;
  EXPECT_NE(run("inspect 'f*.obj' --path catmull-rom:0.5").err.find("whose normals are within 0.5 degrees"),
            std::string::npos);
  EXPECT_EQ(run("inspect 'f*.obj' --path catmull-rom -q").err, "");
  EXPECT_EQ(run("inspect 'f*.obj'").err, "");
  // Every command must compute with the same straight pieces, which approximate the curves.
  const auto pieces = json("inspect 'f*.obj' --path catmull-rom:0.5 --json")["input"]["keyframes"].get<int>() - 1;
  EXPECT_GT(pieces, 4);
  EXPECT_EQ(json("compare 'f*.obj' --path catmull-rom:0.5 --json --no-times")["input"]["segments"], pieces);
  EXPECT_EQ(json("bake 'f*.obj' --path catmull-rom:0.5 -o out.glb --json")["keyframes"], pieces + 1);
  EXPECT_EQ(run("audit out.glb --tolerance 0.01").exit_code, 0);
  EXPECT_EQ(run("convert 'f*.obj' --path catmull-rom:0.5 -o out.npz").exit_code, 0);
  EXPECT_EQ(json("inspect out.npz --json")["input"]["keyframes"], pieces + 1);
  EXPECT_EQ(run("query collapse 'f*.obj' --path catmull-rom:0.5 --json").exit_code, 0);
  EXPECT_LE(json("inspect 'f*.obj' --path catmull-rom --max-expansion 2 --json")["input"]["keyframes"], 9);
  EXPECT_NE(run("inspect 'f*.obj' --path catmull-rom --max-expansion 2")
                .err.find("(a case is one face in one segment), normals may differ by more than"),
            std::string::npos);
}

TEST_F(Paths, that_bend_a_little_too_much_are_not_said_to_bend_by_the_limit) {
  write_turn(2 * std::asin(0.502), 0);  // a turn by the angle a per frame bends paths by sin(a / 2)
  EXPECT_NE(run("inspect 'f*.obj' --path catmull-rom:1").err.find("which bend by 0.51 of their length (at most 0.50"),
            std::string::npos);
  write_turn(std::asin(1) / 1.5, 0);  // a turn by 60 degrees bends paths by 1/2, except for rounding
  EXPECT_EQ(run("inspect 'f*.obj' --path catmull-rom:1").err.find("too far apart"), std::string::npos);
}

TEST_F(Paths, are_straight_between_two_keyframes_and_all_commands_say_so) {
  write_turn(0.3);
  for (const std::string command : {"compare f0.obj f1.obj", "audit f0.obj f1.obj", "bake f0.obj f1.obj -o out.glb",
                                    "sample f0.obj f1.obj --times 0.5 -o out.npz"}) {
    const ProcessResult result = run(command + " --path catmull-rom");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.err.find("there are only two keyframes"), std::string::npos) << result.err;
    EXPECT_NE(result.err.find("1 segment cut into 1 straight piece"), std::string::npos) << result.err;
  }
}

// Compares the rendered normals between keyframes with the normals of the curves through the keyframes. The tolerance
// includes the error of the straight pieces and the error of the keys that bake writes. Vertices whose face normals
// nearly cancel are skipped, since a bound for the normals of faces is not a bound for the direction of their sum.
TEST_F(Paths, keys_of_curves_are_within_the_tolerance_of_the_curves_themselves) {
  constexpr std::uint64_t kSeed = 20261127;
  constexpr std::size_t kSide = 8;
  std::cout << "  from seed " << kSeed << '\n';
  fixtures::Random random(kSeed);
  long double worst_of_all = 0;
  for (int i = 0; i < 12; ++i) {
    Motion motion;
    std::vector<std::uint32_t> corners;
    for (std::uint32_t v = 0; v + kSide < kSide * kSide; ++v) {
      if (v % kSide + 1 == kSide) continue;
      const std::uint32_t below = v + kSide;
      corners.insert(corners.end(), {v, v + 1, below, v + 1, below + 1, below});
    }
    motion.topology = Topology::triangles(kSide * kSide, corners).value();
    const double size = random.uniform(0.02, 0.3) / kSide;
    std::vector<std::array<std::array<double, 3>, 4>> ways(kSide * kSide);
    for (auto& way : ways)
      for (auto& one : way) one = random.in_cube(1.7 * size);
    for (int k = 0; k < 3; ++k) {
      Motion::Keyframe keyframe;
      keyframe.time = k;
      const double t = k / 2.0, shares[4] = {1, std::sin(2 * t), t * t, std::cos(3 * t)};
      std::ostringstream text;
      text.precision(9);
      for (std::size_t v = 0; v < ways.size(); ++v) {
        const double x = static_cast<double>(v / kSide) / (kSide - 1), y = static_cast<double>(v % kSide) / (kSide - 1);
        const double place[3] = {x, y, 0.3 * std::sin(3 * x + 2 * t)};
        text << 'v';
        for (std::size_t c = 0; c < 3; ++c) {
          double p = place[c];
          for (std::size_t j = 0; j < 4; ++j) p += shares[j] * ways[v][j][c];
          keyframe.positions.push_back(static_cast<float>(p));
          text << ' ' << keyframe.positions.back();
        }
        text << '\n';
      }
      for (std::size_t f = 0; f < corners.size(); f += 3)
        text << "f " << corners[f] + 1 << ' ' << corners[f + 1] + 1 << ' ' << corners[f + 2] + 1 << '\n';
      write("w" + std::to_string(k) + ".obj", text.str());
      motion.keyframes.push_back(keyframe);
    }
    motion.connect_as_sequence();
    const char* const options = i % 3 == 0 ? "" : i % 3 == 1 ? ":0.3" : ":0.49";
    const ProcessResult result =
        run(std::string("bake 'w*.obj' --encode keys --no-audit --force -o out.glb --path catmull-rom") + options);
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NE(result.out.find("from the normals on the curved paths"), std::string::npos) << result.out;
    const test::ShownGlb shown(read("out.glb"));
    ASSERT_EQ(shown.vertices(), kSide * kSide);
    long double worst = 0;
    for (int step = 0; step <= 2 * 40; ++step) {
      const double time = step / 40.0;
      const std::size_t segment = time < 1 ? 0 : 1;
      const auto positions =
          test::on_curve(motion, segment, static_cast<long double>(time) - static_cast<long double>(segment));
      const auto normals = test::normals_of(motion, positions, true),
                 faces = test::normals_of(motion, positions, false);
      std::vector<bool> agrees(kSide * kSide, true);
      for (std::size_t c = 0; c < corners.size(); ++c)
        if (test::angle_of(faces[c / 3], normals[corners[c]]) > 0.7) agrees[corners[c]] = false;
      const std::vector<double> weights = shown.weights(time);
      for (std::size_t v = 0; v < shown.vertices(); ++v)
        if (agrees[v]) worst = std::max<long double>(worst, test::angle_of(normals[v], shown.normal(v, weights)));
    }
    worst *= 180 / std::acos(-1.0L);
    EXPECT_LE(worst, 0.502L) << "motion " << i << options;
    worst_of_all = std::max(worst_of_all, worst);
  }
  std::cout << "  worst " << worst_of_all << " degrees\n";
  const ProcessResult refused = run("bake 'w*.obj' --encode keys --path catmull-rom:0.5 -o out.glb --force");
  EXPECT_EQ(refused.exit_code, 2);
  EXPECT_NE(refused.err.find("uses up the tolerance of 0.5"), std::string::npos) << refused.err;
  const std::string exact = run("bake 'w*.obj' --path catmull-rom:0.5 -o out.glb --force").out;
  EXPECT_NE(exact.find("exact at every instant of the straight pieces, which are within 0.5 degrees of the curves"),
            std::string::npos)
      << exact;
}

TEST_F(Paths, all_warn_of_velocities_that_are_not_those_of_the_motion) {
  for (const std::string command : {"compare 'v*.ply'", "audit 'v*.ply'", "bake 'v*.ply' --force -o out.glb",
                                    "sample 'v*.ply' --times 0:4:3 --force -o out.npz"}) {
    for (const double factor : {1.0, 100.0, -1.0, 0.01}) {
      write_turn_with_velocities(0.3, factor);
      const ProcessResult result = run(command + " --path hermite");
      EXPECT_EQ(result.exit_code, 0) << result.err;
      EXPECT_EQ(result.err.find("vertices would go") != std::string::npos, factor == 100 || factor == 0.01)
          << command << factor << result.err;
      EXPECT_EQ(result.err.find("velocities point against the motion") != std::string::npos, factor == -1)
          << command << factor << result.err;
    }
  }
  // The velocities in the files are for 24 frames per second, but the program assumes one frame per second.
  write_turn_with_velocities(0.3, 24);
  EXPECT_NE(run("compare 'v*.ply' --path hermite").err.find("vertices would go 24.1 times"), std::string::npos);
  EXPECT_EQ(run("compare 'v*.ply' --fps 24 --path hermite").err.find("vertices would go"), std::string::npos);
}

TEST_F(Paths, all_warn_where_keyframes_are_too_far_apart) {
  for (const std::string command : {"compare 'f*.obj'", "audit 'f*.obj'", "bake 'f*.obj' --force -o out.glb",
                                    "sample 'f*.obj' --times 0:4:3 --force -o out.npz"}) {
    write_turn(0.2);
    const ProcessResult near = run(command + " --path catmull-rom");
    EXPECT_EQ(near.exit_code, 0) << near.err;
    EXPECT_EQ(near.err.find("too far apart"), std::string::npos) << near.err;
    write_turn(1.6);
    EXPECT_NE(run(command + " --path catmull-rom").err.find("too far apart for curves"), std::string::npos) << command;
    EXPECT_EQ(run(command).err.find("too far apart"), std::string::npos) << "straight paths have no such trouble";
  }
}

TEST_F(Paths, certificates_hold_what_samples_find) {
  write_turn(0.3);
  const Json result =
      json("compare 'f*.obj' --path catmull-rom:0.5 --schemes linear,slerp --tolerance 5 --json --no-times");
  ASSERT_EQ(result["schemes"].size(), 2U);
  for (const Json& row : result["schemes"]) {
    EXPECT_LE(row["max_degrees"], row["certified"]["upper_degrees"]) << row;
    EXPECT_LE(row["certified"]["lower_degrees"], row["certified"]["upper_degrees"]) << row;
  }
}

TEST_F(Paths, audit_advises_a_bake_of_the_same_keyframes_and_paths) {
  write_turn(0.6);
  const ProcessResult advised = run("audit 'f*.obj' --path catmull-rom:30 --fps 24 --from 1 --to 4 --every 1");
  EXPECT_NE(advised.out.find("chronormal bake 'f*.obj' --fps 24 --from 1 --to 4 --path catmull-rom:30 -o baked.glb "
                             "makes a glTF file with true normals at every instant"),
            std::string::npos)
      << advised.out;
  EXPECT_EQ(run("bake 'f*.obj' --fps 24 --from 1 --to 4 --path catmull-rom -o baked.glb").exit_code, 0);
  EXPECT_NE(
      run("audit 'f*.obj' --every 2")
          .out.find(
              "chronormal bake 'f*.obj' --every 2 -o baked.glb makes a glTF file with true normals at every instant"),
      std::string::npos);
}

TEST_F(Paths, refuse_what_has_no_such_path) {
  write_turn(0.2);
  for (const std::string command :
       {"compare 'f*.obj'", "audit 'f*.obj'", "bake 'f*.obj' -o out.glb", "sample 'f*.obj' --times 0:4:3 -o out.npz"}) {
    for (const std::string path : {"hermite", "spline", "catmull-rom:0"}) {
      const ProcessResult refused = run(command + " --path " + path);
      EXPECT_EQ(refused.exit_code, 2) << command << refused.out;
      EXPECT_NE(refused.err.find("--path"), std::string::npos) << refused.err;
      EXPECT_NE(refused.err.find(path), std::string::npos) << refused.err;
    }
  }
  for (const std::string other : {"--truth 2", "--blend 3"})
    EXPECT_EQ(run("compare 'f*.obj' --path catmull-rom " + other).exit_code, 2) << other;
  EXPECT_EQ(run("bake 'f*.obj' -o out.glb").exit_code, 0);
  for (const std::string command : {"audit out.glb", "bake out.glb -o more.glb"}) {
    const ProcessResult refused = run(command + " --path catmull-rom");
    EXPECT_EQ(refused.exit_code, 2) << command;
    EXPECT_NE(refused.err.find("--path is only for sequences of keyframes"), std::string::npos) << refused.err;
  }
}

}  // namespace
}  // namespace chronormal::paths_cli_test
