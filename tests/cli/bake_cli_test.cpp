// Tests the results of `bake` that scripts and people read: the files that it writes, its report, and its exit codes.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <nlohmann/json.hpp>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/bake_fixture.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/shaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::bake_cli_test {
namespace {

using Json = nlohmann::json;

class BakeCli : public testing::Test {
 protected:
  BakeCli() {
    test::GltfBuilder moving = test::hills_document(2);
    moving.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
    folder_.write("moving.glb", moving.glb());
    folder_.write("moving.gltf", moving.gltf());
    folder_.write("still.glb", test::still_hills_document(1).glb());
    folder_.write("f_0.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 3 2 4\n");
    folder_.write("f_1.obj", "v 0 0 0\nv 1 0 1\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 3 2 4\n");
    folder_.write("f_2.obj", "v 0 0 1\nv 1 0 0\nv 0 1 0\nv 1 1 1\nf 1 2 3\nf 3 2 4\n");
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments, const std::string& input = "") const {
    return run_shell(std::string(kProgram) + " bake " + arguments, folder_.path(), input);
  }
  [[nodiscard]] std::string bytes_of(const std::string& name) const { return test::read_whole(folder_ / name); }
  void expect_error(const std::string& arguments, int exit_code, const std::string& word) const {
    const std::size_t entries = folder_.entry_count();
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, exit_code) << arguments << "\n" << result.err;
    EXPECT_EQ(result.out, "");
    EXPECT_NE(result.err.find(word), std::string::npos) << word << "\n" << result.err;
    EXPECT_EQ(folder_.entry_count(), entries);
  }

  test::TemporaryFolder folder_;
};

void expect_words(const std::string& text, const std::vector<std::string>& words) {
  for (const std::string& word : words) EXPECT_NE(text.find(word), std::string::npos) << word << "\nin\n" << text;
}

// Bakes files for viewers that add up deltas. In other viewers, some of the baked files have larger errors than the
// input. The report must name exactly these viewers.
TEST_F(BakeCli, report_names_the_viewers_in_which_the_file_gets_worse) {
  constexpr std::uint64_t kFirstSeed = 1128;
  std::cout << "  from seed " << kFirstSeed << "\n";
  std::size_t named = 0;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + 4; ++seed) {
    const std::size_t targets = 1 + seed % 3;
    test::GltfBuilder sheet = test::with_misleading_normals(test::hills_document(targets, static_cast<unsigned>(seed)));
    std::vector<float> weights(3 * targets);
    for (std::size_t n = targets; n < weights.size(); ++n) weights[n] = n % 2 == 0 ? 1 : 0.6F;
    sheet.add_track(0, 0, std::vector<float>{0, 1, 2}, weights);
    folder_.write("sheet.glb", sheet.glb());
    // Makes another input, right.glb, in which each target has the right normals at weight 1.
    ASSERT_EQ(run("sheet.glb -o right.glb --encode harmless --force").exit_code, 0);
    for (const char* input : {"sheet.glb", "right.glb", "moving.glb"}) {
      for (const char* tolerance : {"", " --tolerance 0.01", " --encode endpoint"}) {
        const ProcessResult result = run(std::string(input) + " -o baked.glb --force" + tolerance);
        ASSERT_TRUE(result.exit_code == 0 || result.exit_code == 4) << result.err;
        std::string worse;
        double gain = 0, harm = 0;  // how much the average errors change, in degrees
        const std::regex row("(three.js|Godot 4|Filament) +(\\S+) +(\\S+) +\\S+ +\\S+ +(\\S+) +(\\S+)");
        const auto number = [](std::string text) {
          std::erase(text, ',');
          return std::stod(text);
        };
        for (std::istringstream lines(result.out); lines;) {
          std::string line;
          std::getline(lines, line);
          std::smatch cells;
          if (!std::regex_match(line, cells, row)) continue;
          const double growth = number(cells[3].str()) - number(cells[2].str());
          const bool is_torn = number(cells[5].str()) > 1.1 * number(cells[4].str()) + 1;
          if (cells[1] == "three.js") gain = -growth;
          if (cells[1] == "three.js" || (growth <= 0.5 && !is_torn)) continue;
          harm = std::max(harm, growth);
          worse.append(worse.empty() ? "" : ", ").append(cells[1]);
        }
        const std::string words = "the average error or the number of torn edges grew in ";
        if (worse.empty())
          EXPECT_EQ(result.out.find(words), std::string::npos) << result.out;
        else
          expect_words(result.out,
                       {words + worse + "; if the file is shown there, bake the original file with --for "});
        if (!worse.empty()) ++named;
        if (*tolerance == '\0') {
          EXPECT_LE(harm, gain) << input << ", seed " << seed;
        }
      }
    }
  }
  EXPECT_GT(named, 0U);
}

TEST_F(BakeCli, targets_of_the_file_beyond_the_limit_are_kept_and_end_with_code_4) {
  for (const char* options :
       {"moving.glb -o out.glb --max-targets 1", "moving.glb -o out.glb --force --max-targets 1 --tolerance 90"}) {
    const ProcessResult result = run(options);
    EXPECT_EQ(result.exit_code, 4) << options;
    EXPECT_NE(
        result.err.find("has 2 targets of its own, more than 1, and bake removes none of these; raise --max-targets"),
        std::string::npos)
        << result.err;
    EXPECT_EQ(result.err.find("could not bring all errors"), std::string::npos) << result.err;
  }
  EXPECT_EQ(run("moving.glb -o out.glb --force --max-targets 2 --tolerance 90").exit_code, 0);
}

TEST_F(BakeCli, a_tolerance_that_is_given_precedes_viewers_that_are_not_named) {
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
  const std::string head = std::string(data) + "/rigs/blender_suzanne_two_keys.glb";
  const ProcessResult result = run("'" + head + "' -o head.glb --tolerance 0.5 --no-audit --json");
  EXPECT_EQ(result.exit_code, 0) << result.err;
}

TEST_F(BakeCli, report_says_what_was_added_and_how_wrong_the_file_was) {
  const ProcessResult result = run("moving.glb -o out.glb");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  expect_words(result.out, {"moving.glb -> out.glb\n", "hills  smallest", " targets and ", "bytes of data were added",
                            "in the animations of the file, and with each slider alone", "three.js", "Filament",
                            "on average ", "torn edges", "all errors before -> after: on average "});
  EXPECT_EQ(result.out.find("cubic spline"), std::string::npos);
  const ProcessResult exact = run("moving.glb -o exact.glb --encode exact");
  expect_words(exact.out, {"hills  exact", "3 targets and ", "1 animation of weights is a cubic spline now"});
  expect_words(exact.err, {"chronormal bake: hills: 5 morph targets are in the result, and viewers that show only ",
                           "can look wrong in Godot 4, Filament"});
  EXPECT_TRUE(bytes_of("out.glb").starts_with("glTF"));
}

TEST_F(BakeCli, what_was_baked_before_takes_its_images_along) {
  test::GltfBuilder builder = test::hills_document(2);
  builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
  builder.json["images"] = {{{"uri", "image.png"}}};
  folder_.write("image.png", "\x89PNG\r\n\x1A\n and so on");
  folder_.write("painted.glb", builder.glb());
  ASSERT_EQ(run("painted.glb -o once.glb").exit_code, 0);
  ASSERT_EQ(run_shell("mkdir folder", folder_.path()).exit_code, 0);
  const ProcessResult result = run("once.glb -o folder/twice.glb");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(bytes_of("folder/twice.glb").find("image.png"), std::string::npos);
  EXPECT_NE(bytes_of("folder/twice.glb").find(" and so on"), std::string::npos);
  // A bake of the file once.glb, which was baked already, writes the same bytes again if the result is in the same
  // folder.
  EXPECT_EQ(run("once.glb -o again.glb").exit_code, 0);
  EXPECT_TRUE(bytes_of("again.glb") == bytes_of("once.glb"));
}

TEST_F(BakeCli, hard_edges_of_a_sequence_are_those_that_its_files_show) {
  // Vertices 1 and 2 are on the ridge of a roof. Each has two normals, one for each side of the roof.
  const std::string faces = "vn -1 0 1\nvn 1 0 1\nf 1//1 2//1 3//1\nf 3//2 2//2 4//2\n";
  folder_.write("roof_0.obj", "v -1 0 0\nv 0 0 1\nv 0 1 1\nv 1 0 0\n" + faces);
  folder_.write("roof_1.obj", "v -1 0 0\nv 0 0 2\nv 0 1 2\nv 1 0 0\n" + faces);
  const ProcessResult hard = run("roof_0.obj roof_1.obj -o hard.glb");
  EXPECT_EQ(hard.exit_code, 0) << hard.err;
  expect_words(hard.out, {" 6 vertices"});
  EXPECT_EQ(run_shell(std::string(kProgram) + " audit hard.glb --tolerance 0.01", folder_.path()).exit_code, 0);
}

TEST_F(BakeCli, json_is_one_object_with_schema_2) {
  const ProcessResult result = run("moving.glb -o out.glb --json --encode exact");
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const Json json = Json::parse(result.out);
  EXPECT_EQ(json["schema"], 3);
  EXPECT_EQ(json["command"], "bake");
  EXPECT_EQ(json["output"], "out.glb");
  EXPECT_TRUE(json["changed"]);
  EXPECT_EQ(json["meshes"][0]["encoding"], "exact");
  EXPECT_EQ(json["meshes"][0]["extra_targets"][1], R"({"target": 3, "linear": [], "quadratic": [[0, 1, 1.0]]})"_json);
  EXPECT_EQ(json["added_targets"], 3);
  EXPECT_GT(json["added_bytes"], 0);
  EXPECT_GT(json["audit"]["worst_degrees_before"], 5);
  EXPECT_LT(json["audit"]["worst_degrees_after"], 0.05);
  EXPECT_EQ(json["audit"]["worse"], false);
  bool names_normal = false;
  for (const Json& pointer : json["pointers"]) names_normal |= pointer == "/meshes/0/primitives/0/targets/0/NORMAL";
  EXPECT_TRUE(names_normal) << json["pointers"];
  EXPECT_FALSE(Json::parse(run("moving.glb -o b.glb --json --no-audit").out).contains("audit"));
}

TEST_F(BakeCli, json_tells_what_targets_leave_from_what_tracks_leave) {
  test::GltfBuilder bent = test::hills_document(1);
  bent.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, -2, 1, 0}, "CUBICSPLINE");
  folder_.write("bent.glb", bent.glb());
  const auto mesh = [&](const std::string& arguments) {
    return Json::parse(run(arguments + " --json --no-audit").out)["meshes"][0];
  };
  const Json of_tracks = mesh("bent.glb of_tracks.glb --encode exact --tolerance 1");
  EXPECT_EQ(of_tracks["target_fit_degrees"], 0.0);
  EXPECT_GT(of_tracks["track_fit_degrees"], 0.0);
  const Json of_targets = mesh("moving.glb of_targets.glb --encode endpoint");
  EXPECT_GT(of_targets["target_fit_degrees"], 0.0);
  EXPECT_EQ(of_targets["track_fit_degrees"], 0.0);
}

TEST_F(BakeCli, output_may_be_the_input) {
  const std::string before = bytes_of("moving.glb");
  expect_error("moving.glb -o moving.glb", 1, "--force");
  EXPECT_EQ(bytes_of("moving.glb"), before);
  ASSERT_EQ(run("moving.glb -o out.glb").exit_code, 0);
  ASSERT_EQ(run("moving.glb -o moving.glb --force").exit_code, 0);
  EXPECT_EQ(bytes_of("moving.glb"), bytes_of("out.glb"));
}

TEST_F(BakeCli, a_baked_file_is_copied_as_it_is) {
  for (const std::string extension : {".glb", ".gltf"}) {
    ASSERT_EQ(run("moving" + extension + " -o once" + extension).exit_code, 0);
    const ProcessResult again = run("once" + extension + " -o twice" + extension);
    EXPECT_EQ(again.exit_code, 0) << again.err;
    expect_words(again.out, {"nothing was changed, since this file was baked before. "});
    EXPECT_EQ(bytes_of("twice" + extension), bytes_of("once" + extension));
    EXPECT_NE(bytes_of("once" + extension), bytes_of("moving" + extension));
  }
}

TEST_F(BakeCli, endpoint_says_what_was_fitted_and_audit_what_would_be_exact) {
  const ProcessResult baked = run("moving.glb -o out.glb --encode endpoint");
  EXPECT_EQ(baked.exit_code, 0) << baked.err;
  expect_words(
      baked.out,
      {"hills  endpoint", "0 targets and ",
       "the deltas of 24 normals that several targets move at once were fitted to the weights that the file uses\n"});
  EXPECT_EQ(Json::parse(run("moving.glb -o json.glb --encode endpoint --json").out)["meshes"][0]["fitted_normals"], 24);
  const auto audit = [&](const std::string& name) {
    return run_shell(std::string(kProgram) + " audit " + name, folder_.path()).out;
  };
  expect_words(audit("moving.glb"), {"chronormal bake moving.glb"});
  expect_words(audit("out.glb"),
               {"the meshes with errors were baked before", "a single delta for each target", "--encode exact"});
  ASSERT_EQ(run("moving.glb -o exact.glb --encode exact").exit_code, 0);
  expect_words(audit("exact.glb"), {"nothing to do"});
}

// The program reads files above 64 MiB one keyframe at a time, without keeping their stored normals. The audit of such
// a file must still judge the stored normals.
TEST_F(BakeCli, of_large_files_it_audits_the_normals_that_they_store_all_the_same) {
  constexpr std::size_t kLine = 1 << 20, kLines = 24;
  const std::string comment = "#" + std::string(kLine - 2, ' ') + "\n";
  std::string room;
  for (std::size_t i = 0; i < kLines; ++i) room += comment;
  // The stored normals of keyframe 1 are wrong. Only an audit that reads the stored normals can find this error.
  for (const int k : {0, 1, 2}) {
    std::string mesh = bytes_of("f_" + std::to_string(k) + ".obj");
    mesh = mesh.substr(0, mesh.find('f')) + (k == 1 ? "vn 1 0 0\n" : "vn 0 0 1\n") +
           "f 1//1 2//1 3//1\nf 3//1 2//1 4//1\n";
    folder_.write("s_" + std::to_string(k) + ".obj", mesh);
    folder_.write("l_" + std::to_string(k) + ".obj", mesh + room);
  }
  const ProcessResult small = run("s_0.obj s_1.obj s_2.obj -o s.glb --json");
  const ProcessResult large = run("l_0.obj l_1.obj l_2.obj -o l.glb --json");
  ASSERT_EQ(small.exit_code, 0) << small.err;
  ASSERT_EQ(large.exit_code, 0) << large.err;
  EXPECT_TRUE(bytes_of("s.glb") == bytes_of("l.glb"));
  const Json expected = Json::parse(small.out)["audit"];
  EXPECT_GT(expected["worst_degrees_before"], 45);
  EXPECT_EQ(Json::parse(large.out)["audit"], expected);
}

TEST_F(BakeCli, errors_in_its_table_are_those_that_audit_finds) {
  for (const char* const how : {"exact", "endpoint"}) {
    const ProcessResult text = run(std::string("moving.glb -o out.glb --force --encode ") + how);
    const Json json = Json::parse(run(std::string("moving.glb -o out.glb --force --json --encode ") + how).out);
    const auto audited = [&](const std::string& name) {
      return Json::parse(run_shell(std::string(kProgram) + " audit --json " + name, folder_.path()).out);
    };
    const Json before = audited("moving.glb"), after = audited("out.glb");
    for (const Json& audit : {json["audit"], json["meshes"][0]["audit"]}) {
      EXPECT_EQ(audit["worst_degrees_before"], before["worst_degrees"]);
      EXPECT_EQ(audit["worst_degrees_after"], after["worst_degrees"]);
      EXPECT_EQ(audit["mean_degrees_after"], after["mean_degrees"]);
      EXPECT_EQ(audit["unlit_after"], after["unlit"]);
    }
    char worst[32];
    std::snprintf(worst, sizeof worst, "  %.4f  ", before["worst_degrees"].get<double>());
    expect_words(text.out, {"before     after\n", "degrees  at worst\n", worst});
  }
  // Without an audit, the table shows the errors that the bake itself measures, under the name "fit".
  expect_words(run("moving.glb -o out.glb --force --no-audit --encode endpoint").out, {"    fit\n"});
}

TEST_F(BakeCli, a_result_that_is_worse_than_the_input_is_told_of) {
  // In the files of this test, products of deltas and squares of weights exceed the range of float32, so a bake is
  // written only with --force.
  std::size_t worse = 0;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    test::GltfBuilder builder = test::hills_document(1, seed);
    builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{3e38F, 3e38F});
    folder_.write("huge.glb", builder.glb());
    const ProcessResult result = run("huge.glb -o out.glb --force --json --encode exact");
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json audit = Json::parse(result.out)["audit"];
    const bool says_so = result.err.find("the result is ") != std::string::npos;
    EXPECT_EQ(audit["worse"], says_so);
    if (audit["worst_degrees_after"] > audit["worst_degrees_before"]) {
      EXPECT_TRUE(says_so);
      expect_words(result.err, {"worse", "in its worst error ("});
      ++worse;
    }
  }
  EXPECT_GT(worse, 0U);
  expect_words(run("huge.glb -o other.glb").out,
               {"nothing was changed, since every candidate makes some error larger; --plan lists the candidates"});
  EXPECT_EQ(run("moving.glb -o fine.glb").err.find("worse"), std::string::npos);
}

TEST_F(BakeCli, a_result_that_is_better_in_one_respect_and_worse_in_another_is_told_of_by_both) {
  std::size_t mixed = 0;
  constexpr std::size_t kTargets = 7, kKeys = 5;
  for (unsigned seed = 1; seed <= 8; ++seed) {
    test::GltfBuilder builder = test::hills_document(kTargets, seed);
    test::Hills random(seed + 50);
    std::vector<float> weights;
    for (std::size_t n = 0; n < kTargets * kKeys; ++n) weights.push_back(random.uniform(0, 0.4));
    builder.add_track(0, 0, std::vector<float>{0, 1, 2, 3, 4}, weights);
    folder_.write("talk.glb", builder.glb());
    const ProcessResult result = run("talk.glb -o out.glb --force --json --animations-only --for three");
    ASSERT_EQ(result.exit_code, 0) << result.err;
    const Json json = Json::parse(result.out), &audit = json["audit"];
    const auto figure = [&](const char* name) {
      char text[32];
      std::snprintf(text, sizeof text, "%.4f", audit[name].get<double>());
      return std::string(text);
    };
    const auto grown = [&](const std::string& error) {
      return audit[error + "_after"].get<double>() - audit[error + "_before"].get<double>();
    };
    if (grown("mean_degrees") > -0.01 || grown("worst_degrees") < 0.1) continue;
    ++mixed;
    EXPECT_EQ(audit["worse"], true);
    expect_words(result.err,
                 {"the result is better than the input on average (" + figure("mean_degrees_after") +
                      " degrees, before " + figure("mean_degrees_before") + ")",
                  ", but worse in its worst error (" + figure("worst_degrees_after") + " degrees, before " +
                      figure("worst_degrees_before") +
                      "); these errors include single sliders, which --animations-only does not correct\n"});
    // The heading of a table of viewers must name the poses whose errors the table shows.
    const std::string both = "in the animations of the file, and with each slider alone:",
                      tracks = "in the animations of the file (--animations-only does not correct single sliders";
    const std::string text = run("talk.glb -o out.glb --force --animations-only --for three").out;
    expect_words(text, {tracks});
    EXPECT_EQ(text.find(both), std::string::npos);
    expect_words(run("talk.glb --plan --animations-only --for three").out, {tracks, both});
    EXPECT_EQ(run("talk.glb --plan --for three").out.find(tracks), std::string::npos);
  }
  EXPECT_GT(mixed, 0U);
}

TEST_F(BakeCli, what_drives_extra_targets_is_in_the_file_and_beside_it_where_that_is_asked_for) {
  const ProcessResult usual = run("still.glb -o out.glb");
  EXPECT_EQ(usual.exit_code, 0);
  expect_words(usual.out, {"hills  smallest"});
  expect_words(usual.err, {"no animation drives"});
  const std::size_t entries = folder_.entry_count();
  const ProcessResult exact = run("still.glb -o face.glb --encode exact");
  EXPECT_EQ(exact.exit_code, 0) << exact.err;
  EXPECT_EQ(folder_.entry_count(), entries + 1) << "nothing but the file";
  const Json mark = test::GltfPlayer(bytes_of("face.glb")).json["meshes"][0]["extras"]["chronormal"];
  EXPECT_EQ(mark["extras"][0], R"({"target": 1, "linear": [[0, 1.0]], "quadratic": [[0, 0, -1.0]]})"_json);

  const ProcessResult both = run("still.glb -o other.glb --encode exact --drivers drivers.json");
  EXPECT_EQ(both.exit_code, 0) << both.err;
  expect_words(both.out, {"drivers.json says how to drive the correction targets\n"});
  EXPECT_EQ(Json::parse(bytes_of("drivers.json"))["meshes"][0]["chronormal"], mark);
  EXPECT_TRUE(bytes_of("other.glb") == bytes_of("face.glb"));
  // The program does not overwrite the file drivers.json. If the input was baked before, the program still reports the
  // drivers.
  expect_error("still.glb -o third.glb --encode exact --drivers drivers.json", 1, "drivers.json");
  ASSERT_EQ(run("face.glb -o copy.glb --drivers again.json").exit_code, 0);
  EXPECT_EQ(bytes_of("again.json"), bytes_of("drivers.json"));
}

TEST_F(BakeCli, the_input_stays_where_the_drivers_cannot_be_written) {
  const std::string before = bytes_of("still.glb");
  expect_error("still.glb -o still.glb --force --encode exact --drivers /dev/full", 1, "/dev/full");
  EXPECT_TRUE(bytes_of("still.glb") == before);
  ASSERT_EQ(run("still.glb -o still.glb --force --encode exact --drivers drivers.json").exit_code, 0);
  EXPECT_EQ(Json::parse(bytes_of("drivers.json"))["meshes"].size(), 1U);
}

TEST_F(BakeCli, the_last_of_several_files_is_where_to_write) {
  const ProcessResult named = run("moving.glb -o named.glb"), unnamed = run("moving.glb unnamed.glb");
  EXPECT_EQ(unnamed.exit_code, 0) << unnamed.err;
  EXPECT_EQ(bytes_of("unnamed.glb"), bytes_of("named.glb"));
  EXPECT_EQ(run("f_0.obj f_1.obj f_2.obj frames.glb").exit_code, 0);
  expect_error("moving.glb", 2, "the output is missing");
  expect_error("f_0.obj f_1.obj f_2.obj", 2, "the output is missing");
  expect_error("moving.glb still.glb", 1, "still.glb");  // an output exists already, and may not be overwritten
}

TEST_F(BakeCli, avatars_are_read_and_written_as_glb_under_their_own_extension) {
  folder_.write("moving.vrm", bytes_of("moving.glb"));
  EXPECT_EQ(run("moving.vrm out.vrm").exit_code, 0);
  EXPECT_EQ(run("moving.glb out.glb").exit_code, 0);
  EXPECT_EQ(bytes_of("out.vrm"), bytes_of("out.glb"));
  folder_.write("broken.vrm", "none");
  expect_error("broken.vrm out_2.vrm", 3, "this is not a glTF file");
}

TEST_F(BakeCli, uris_that_another_folder_changes_are_among_the_pointers) {
  folder_.write("bytes.bin", "0123");
  Json document = Json::parse(bytes_of("moving.gltf"));
  document["buffers"].push_back({{"uri", "bytes.bin"}, {"byteLength", 4}});
  folder_.write("outside.gltf", document.dump());
  std::filesystem::create_directory(folder_ / "elsewhere");
  const auto names_uri = [&](const std::string& output) {
    const ProcessResult result = run("outside.gltf " + output + " --json");
    const Json pointers = Json::parse(result.out)["pointers"];
    return std::find(pointers.begin(), pointers.end(), "/buffers/1/uri") != pointers.end();
  };
  EXPECT_FALSE(names_uri("beside.gltf"));
  EXPECT_TRUE(names_uri("elsewhere/away.gltf"));
}

TEST_F(BakeCli, standard_streams_work) {
  const ProcessResult result = run("- -o - < moving.glb > piped.glb; exit $?");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  ASSERT_EQ(run("moving.glb -o out.glb").exit_code, 0);
  EXPECT_EQ(bytes_of("piped.glb"), bytes_of("out.glb"));
  expect_words(result.err, {"hills  smallest"});
}

TEST_F(BakeCli, sequences_become_an_animated_glb) {
  const ProcessResult result = run("'f_*.obj' -o dance.glb --fps 24");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  expect_words(result.out, {"f_*.obj -> dance.glb\n", "3 keyframes"});
  const test::GltfPlayer player(bytes_of("dance.glb"));
  EXPECT_EQ(player.json["animations"].size(), 1U);
  EXPECT_EQ(Json::parse(run("f_0.obj f_1.obj f_2.obj -o b.glb --json").out)["keyframes"], 3);
}

TEST_F(BakeCli, errors_have_their_exit_codes_and_leave_nothing_behind) {
  expect_error("moving.glb -o out.glb --encode best", 2, "--encode");
  expect_error("moving.glb -o out.glb --weighting heavy", 2, "--weighting");
  expect_error("moving.glb -o out.glb --for godott", 2, "did you mean godot?");
  expect_error("moving.glb -o out.glb --tolerance -1", 2, "--tolerance");
  expect_error("moving.glb -o out.glb --crease 200", 2, "--crease");
  expect_error("moving.glb -o out.glb --crease 30", 2, "--smooth");
  expect_error("moving.glb -o out.glb --fps 24", 2, "--fps");
  expect_error("moving.glb -o out.glb --world", 2, "--world");
  expect_error("moving.glb -o out.glb --animation move", 2, "--animation");
  expect_error("moving.glb -o out.obj", 2, "out.obj");
  expect_error("moving.glb -o - --json", 2, "--json");
  expect_error("moving.glb -o out.glb --drivers -", 2, "--drivers");
  expect_error("moving.glb -o out.glb --drivers out.glb", 2, "--drivers");
  expect_error("f_0.obj f_1.obj -o out.glb --drivers d.json", 2, "--drivers");
  expect_error("moving.glb", 2, "-o OUT");
  expect_error("moving.glb -o out.glb --encode harmless --max-bytes 100", 3, "allows only 100");
  expect_error("f_0.obj f_1.obj -o out.glb --max-bytes 100", 3, "more than 100 bytes");
  for (const std::string option : {"--max-targets 5", "--animations-only", "--plan", "--poses random"})
    expect_error("moving.glb -o out.glb --encode exact " + option, 2,
                 option.substr(0, option.find(' ')) + ": this option can only be used with --encode smallest");
  expect_error("f_0.obj f_1.obj -o out.glb --encode smallest", 2, "--encode: the encoding of a sequence must be");
  for (const char* const option : {"--plan", "--max-targets 5", "--animations-only"})
    expect_error(std::string("f_0.obj f_1.obj -o out.glb ") + option, 2, "is only for glTF files");
  expect_error("f_0.obj f_1.obj -o out.obj", 2, ".glb");
  expect_error("f_0.obj f_1.obj -o out.gltf", 2,
               "a sequence can only be written as .glb; choose a name that ends in .glb");
  expect_error("--base f_0.obj f_1.obj -o out.glb", 2, "--base");
  expect_error("f_0.obj f_1.obj -o out.glb --smooth", 2, "--smooth");
  expect_error("f_0.obj f_1.obj -o out.glb --recompute-base", 2, "--recompute-base");
  expect_error("none.glb -o out.glb", 1, "none.glb");
  folder_.write("bad.glb", "glTF");
  expect_error("bad.glb -o out.glb", 3, "bad.glb");
}

TEST_F(BakeCli, what_cannot_be_had_ends_in_exit_code_4_only_where_somebody_asked_for_it) {
  const std::string sentence = "could not bring all errors within 0.5 degrees";
  const ProcessResult plain = run("still.glb -o plain.glb");
  EXPECT_EQ(plain.exit_code, 0);
  EXPECT_EQ(plain.err.find(sentence), std::string::npos) << "nobody asked";
  const ProcessResult asked = run("still.glb -o asked.glb --tolerance 0.5");
  EXPECT_EQ(asked.exit_code, 4);
  expect_words(asked.err, {sentence, "choose a larger --tolerance"});
  EXPECT_EQ(bytes_of("asked.glb"), bytes_of("plain.glb"));
  const ProcessResult in_three = run("still.glb -o three.glb --tolerance 5 --for three");
  EXPECT_EQ(in_three.exit_code, 0);
  EXPECT_EQ(in_three.err.find("could not bring"), std::string::npos);
  const ProcessResult few = run("moving.glb -o few.glb --for three --max-bytes 100");
  EXPECT_EQ(few.exit_code, 4);
  expect_words(few.err, {"allow more targets or bytes with --max-targets or --max-bytes"});
  EXPECT_EQ(bytes_of("few.glb"), bytes_of("moving.glb"));
}

TEST_F(BakeCli, a_plan_recommends_what_a_bake_writes) {
  constexpr std::uint64_t kFirstSeed = 1134;
  std::cout << "  from seed " << kFirstSeed << "\n";
  std::size_t listed = 0;
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + 8; ++seed) {
    test::GltfBuilder sheet = test::random_sheet(seed, 5, 2 + seed % 2, 0).file();
    const std::size_t targets = 2 + seed % 2;
    std::vector<float> weights(4 * targets);
    for (std::size_t n = 0; n < weights.size(); ++n) weights[n] = static_cast<float>((n * seed) % 7) / 6;
    sheet.add_track(0, 0, std::vector<float>{0, 1, 2, 3}, weights);
    folder_.write("sheet.glb", sheet.glb());
    for (const char* viewers :
         {"", " --for all", " --for three,godot,filament", " --for gltfpack", " --tolerance 0.5"}) {
      const auto chosen_of = [&](const std::string& arguments) {
        const ProcessResult result = run("sheet.glb --json -q" + arguments + viewers);
        const Json candidates = Json::parse(result.out)["meshes"][0]["candidates"];
        listed += candidates.size();
        const auto found =
            std::find_if(candidates.begin(), candidates.end(), [](const Json& c) { return c["chosen"] == true; });
        return found == candidates.end() ? Json() : Json{(*found)["name"], (*found)["targets"], (*found)["bytes"]};
      };
      EXPECT_EQ(chosen_of(" --plan"), chosen_of(" -o out.glb --force")) << "seed " << seed << viewers;
    }
  }
  EXPECT_GT(listed, 100U);
}

TEST_F(BakeCli, a_plan_lists_the_forms_and_writes_nothing) {
  const std::size_t entries = folder_.entry_count();
  const ProcessResult plan = run("moving.glb --plan --for three"), json = run("moving.glb --plan --json");
  EXPECT_EQ(plan.exit_code, 0) << plan.err;
  expect_words(plan.out, {"--plan lists without writing a file", "as it is", "own deltas", "low rank", "recommended"});
  EXPECT_EQ(Json::parse(json.out)["meshes"][0]["candidates"][0]["name"], "as it is");
  EXPECT_EQ(plan.out.find("animations only"), std::string::npos);
  const ProcessResult alone = run("moving.glb --plan --for three --animations-only");
  EXPECT_EQ(alone.exit_code, 0) << alone.err;
  expect_words(alone.out, {"own deltas  ", "low rank, animations only", "low rank, animations only"});
  EXPECT_EQ(folder_.entry_count(), entries);
}

TEST_F(BakeCli, a_motion_that_jumps_is_no_sequence) {
  test::GltfBuilder steps = test::hills_document(2);
  steps.add_track(0, 0, std::vector<float>{0, 1, 2}, std::vector<float>{0, 0, 1, 0, 0, 1}, "STEP");
  folder_.write("steps.glb", steps.glb());
  const ProcessResult kept =
      run_shell(std::string(kProgram) + " convert steps.glb --animation move -o steps.npz", folder_.path());
  ASSERT_EQ(kept.exit_code, 0) << kept.err;
  expect_error("steps.npz -o out.glb", 3, "steps.npz: the weights of this animation jump");
}

TEST_F(BakeCli, file_in_which_nothing_moves_is_copied) {
  folder_.write("mesh.glb", test::still_hills_document(0).glb());
  const ProcessResult result = run("mesh.glb -o out.glb");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  expect_words(result.out, {"nothing was changed, since no morph target moves a face"});
  EXPECT_TRUE(bytes_of("out.glb") == bytes_of("mesh.glb"));
}

TEST_F(BakeCli, a_full_device_is_an_error) { EXPECT_EQ(run("moving.glb -o /dev/full").exit_code, 1); }

}  // namespace
}  // namespace chronormal::bake_cli_test
