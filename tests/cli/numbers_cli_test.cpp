// Checks that infinities and NaN are never printed as numbers. The inputs cause infinities and NaN during the
// computation, and every command prints its results in all output formats.

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <sstream>
#include <string>
#include <vector>

#include "tests/support/gltf_builder.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/shaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::numbers_cli_test {
namespace {

namespace fs = std::filesystem;

// Returns true if a text has NaN or infinity in place of a number. Sentences that mention NaN do not count.
bool has_nan_or_infinity(const std::string& text) {
  static const std::regex kSentence("zero, infinite or NaN|NaN or infinite");
  static const std::regex kWord("(^|[^a-z])-?(nan|inf)([^a-z]|$)", std::regex::icase);
  return std::regex_search(std::regex_replace(text, kSentence, ""), kWord);
}

// Makes a hinge with normal deltas, and an animation of the weights of its two targets.
test::GltfBuilder moved_hinge(float normal, const std::vector<float>& times, const std::vector<float>& weights) {
  test::ShadedMesh mesh = test::hinge();
  for (float& c : mesh.normals) c *= normal;
  mesh.targets[0].normals.assign(12, 2 * normal);
  mesh.targets.push_back({mesh.targets[0].positions, std::vector<float>(12, -2 * normal), {}});
  test::GltfBuilder builder = mesh.file();
  builder.add_track(builder.add_animation("a"), 0, times, weights);
  return builder;
}

TEST(Numbers, no_command_prints_nan_or_infinity) {
  const test::TemporaryFolder folder;
  constexpr float kHuge = 3e38F;
  folder.write("weights.glb", moved_hinge(1, {0, 1}, {kHuge, kHuge, -kHuge, kHuge}).glb());
  folder.write("normals.glb", moved_hinge(1.5e38F, {0, 1}, {0, 1, 1, 1}).glb());
  folder.write("times.glb", moved_hinge(1, {0, 1e-45F, kHuge}, {0, 0, 1, 0.5F, 0, 1}).glb());
  folder.write("still.glb", moved_hinge(1, {0, 1}, {0, 0, 0, 0}).glb());
  folder.write("a.obj", "v 0 0 0\nv 3e38 0 0\nv 0 3e38 0\nv 0 0 0\nf 1 2 3\nf 1 1 4\n");
  folder.write("b.obj", "v 0 0 0\nv 3e38 0 3e38\nv 0 -3e38 0\nv 0 0 0\nf 1 2 3\nf 1 1 4\n");
  folder.write("point.obj", "v 0 0 0\nv 0 0 0\nv 0 0 0\nf 1 2 3\n");
  std::vector<std::string> commands = {"compare a.obj b.obj",
                                       "compare a.obj b.obj --csv",
                                       "compare a.obj b.obj --json",
                                       "compare point.obj point.obj",
                                       "compare point.obj point.obj --csv --elements vertices",
                                       "audit a.obj b.obj",
                                       "audit a.obj b.obj --json",
                                       "inspect a.obj b.obj",
                                       "inspect a.obj b.obj --json",
                                       "inspect point.obj",
                                       "bake a.obj b.obj -o seq.glb",
                                       "bake a.obj b.obj -o seq.glb --force --encode endpoint --json",
                                       "compare a.obj b.obj --certify",
                                       "compare a.obj b.obj --certify --json",
                                       "compare a.obj b.obj a.obj --path catmull-rom",
                                       "compare point.obj point.obj --tolerance 1",
                                       "audit a.obj b.obj a.obj --path catmull-rom --json",
                                       "audit point.obj point.obj --tolerance 1",
                                       "audit a.obj b.obj --shard 1/1 --tolerance 1 -o part.json",
                                       "merge part.json",
                                       "query cones a.obj b.obj",
                                       "query shutter a.obj b.obj --json",
                                       "query shutter point.obj point.obj",
                                       "query facing a.obj b.obj --direction 0,0,1",
                                       "query collapse a.obj b.obj --json",
                                       "report a.obj b.obj -o r.bin --json",
                                       "sample a.obj b.obj --times 0,0.5,1 --format obj -o -"};
  for (const std::string file : {"weights.glb", "normals.glb", "times.glb", "still.glb"}) {
    for (const std::string form : {"", " --json", " --csv"})
      commands.push_back("compare " + file + " --blend 3 --animation a" + form);
    for (const std::string form : {"", " --json"}) {
      for (const char* const verb :
           {"audit ", "audit --tolerance 1 --weighting angle ", "inspect ", "inspect --animation a "})
        commands.push_back(verb + file + form);
      for (const char* const how : {"exact", "endpoint"})
        commands.push_back("bake " + file + " -o out.glb --force --encode " + how + form);
    }
    for (const std::string form : {"", " --json"}) {
      commands.push_back("report " + file + " -o out.bin --force --no-plan" + form);
      commands.push_back("query shutter --animation a " + file + form);
    }
    commands.push_back("sample " + file + " --weights 1e38,1e38 --format obj -o -");
  }
  std::size_t done = 0;
  for (const std::string& command : commands) {
    const ProcessResult result = run_shell(std::string(kProgram) + " " + command, folder.path());
    EXPECT_FALSE(has_nan_or_infinity(result.out)) << command << "\n" << result.out;
    EXPECT_FALSE(has_nan_or_infinity(result.err)) << command << "\n" << result.err;
    EXPECT_LE(result.exit_code, 4) << command << "\n" << result.err;
    done += result.exit_code == 0 || result.exit_code == 4 ? 1 : 0;
  }
  EXPECT_GT(done, commands.size() * 3 / 4) << "the rest are refused";
}

TEST(Numbers, the_measure_finds_words_that_are_no_numbers) {
  for (const char* const text : {"nan", "mean -nan, rms", "1,-nan,2", "inf\n", "NaN", "up to -inf degrees"})
    EXPECT_TRUE(has_nan_or_infinity(text)) << text;
  for (const char* const text : {"a banana", "information", "finite", "nano 3", "1e-38"})
    EXPECT_FALSE(has_nan_or_infinity(text)) << text;
}

// fmt::format would print "nan", so the program may call fmt::format only in cli/terminal/format.h.
TEST(Numbers, are_formatted_in_one_place) {
  std::size_t files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(fs::path(kSourceFolder) / "cli")) {
    if (!entry.is_regular_file() || entry.path().filename() == "format.h") continue;
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    for (const char* const call : {"fmt::format", "fmt::vformat", "std::to_string", "printf"})
      EXPECT_EQ(text.str().find(call), std::string::npos) << entry.path() << " calls " << call;
    ++files;
  }
  EXPECT_GT(files, 20U);
}

}  // namespace
}  // namespace chronormal::numbers_cli_test
