// Tests that the command line stays stable (docs/stability.md): every option and JSON key that ever existed must still
// exist. The lists of options and keys are in files beside this test. tools/update_docs adds new names. Only a person
// can remove a name, because other programs may depend on it.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "io/cache/npz.h"
#include "tests/support/bake_fixture.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::stability_cli_test {
namespace {

using Json = nlohmann::json;
using Names = std::set<std::string>;

class Stability : public testing::Test {
 protected:
  [[nodiscard]] ProcessResult run(const std::string& arguments) const {
    return run_shell(std::string(kProgram) + " " + arguments, folder_.path());
  }
  test::TemporaryFolder folder_;
};

// Checks that the found names of options or keys are exactly those of the list in `file`. If CHRONORMAL_UPDATE_DOCS is
// set, adds new names to the list instead.
void expect_listed(const Names& found, const std::string& file) {
  const std::filesystem::path path = std::filesystem::path(kSourceFolder) / "tests/cli" / file;
  Names listed;
  std::ifstream lines(path);
  for (std::string line; std::getline(lines, line);) listed.insert(line);
  for (const std::string& name : listed)
    EXPECT_TRUE(found.contains(name)) << name << " is gone, and stands in " << file;
  if (std::getenv("CHRONORMAL_UPDATE_DOCS") != nullptr) {
    listed.insert(found.begin(), found.end());
    std::ofstream updated(path);
    for (const std::string& name : listed) updated << name << '\n';
    return;
  }
  for (const std::string& name : found)
    EXPECT_TRUE(listed.contains(name)) << name << " is new: tools/update_docs puts it into " << file;
}

std::string word_at(const std::string& line, std::size_t at) { return line.substr(at, line.find(' ', at) - at); }

TEST_F(Stability, no_command_and_no_option_vanishes) {
  Names found;
  std::istringstream help(run("help").out);
  bool are_commands = false;
  for (std::string line; std::getline(help, line);) {
    are_commands = line == "Commands:" || (are_commands && !line.empty());
    if (!are_commands || !line.starts_with("  ") || line.starts_with("   ")) continue;
    const std::string command = word_at(line, 2);
    std::istringstream options(run(command + " --help-all").out);
    for (std::string option; std::getline(options, option);)
      if (option.starts_with("  -")) found.insert(command + ' ' + word_at(option, option.find("--")));
  }
  EXPECT_GT(found.size(), 60U);
  expect_listed(found, "stable_options.txt");
}

// Adds the paths of all keys of a JSON value to `found`, such as "audit viewers[].worst_at.vertex". An audit of several
// files has an entry of `files` for each file, with the same keys as an audit of one file.
void add_keys(const Json& json, const std::string& path, Names& found) {
  if (json.is_array())
    for (const Json& one : json) add_keys(one, path + "[]", found);
  if (!json.is_object()) return;
  for (const auto& [key, value] : json.items()) {
    const std::string own = path + (path.back() == ' ' ? "" : ".") + key;
    found.insert(own);
    if (own != "audit files") add_keys(value, own, found);
    if (own == "audit files")
      for (const Json& file : value) add_keys(file, "audit ", found);
  }
}

TEST_F(Stability, no_key_of_json_vanishes) {
  folder_.write("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvn 0 0 1\nf 1//1 2//1 3//1\nf 2//1 4//1 3//1\n");
  folder_.write("b.obj", "v 0 0 0\nv 1 0 0\nv 0 0 1\nv 1 0 1\nvn 0 0 1\nf 1//1 2//1 3//1\nf 2//1 4//1 3//1\n");
  folder_.write("closed.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n");
  folder_.write("points.npy", NpyBytes({1, 3}, std::vector<double>{1, 2, 3}).bytes());
  test::GltfBuilder moving = test::still_hills_document(2);
  moving.add_track(0, 0, std::vector<float>{0, 1, 2}, std::vector<float>{0, 0, 1, 0, 0, 1});
  folder_.write("face.glb", moving.glb());
  Names found;
  for (const std::string arguments : {"audit a.obj b.obj",
                                      "audit face.glb --for all --tolerance 1",
                                      "audit face.glb face.glb missing.glb",
                                      "bake a.obj b.obj -o ab.glb",
                                      "bake face.glb -o right.glb",
                                      "bake face.glb -o exact.glb --encode exact",
                                      "compare a.obj b.obj",
                                      "compare a.obj b.obj --elements vertices",
                                      "compare --each --base a.obj b.obj",
                                      "compare --base a.obj b.obj --blend 2",
                                      "compare face.glb --blend 2",
                                      "compare a.obj b.obj --face 0 --schemes linear,decasteljau:4,quaternion:matrix",
                                      "inspect a.obj b.obj",
                                      "inspect face.glb",
                                      "inspect a.obj",
                                      "query collapse a.obj b.obj",
                                      "query facing a.obj b.obj --eye 1,2,3 --silhouettes",
                                      "query contain closed.obj closed.obj --points points.npy",
                                      "query cones a.obj b.obj --meshlets 8",
                                      "query shutter a.obj b.obj a.obj",
                                      "query shutter a.obj b.obj --elements vertices",
                                      "query facing a.obj b.obj --eye 1,2,3 --elements corners",
                                      "report face.glb -o face.bin"}) {
    const ProcessResult result = run(arguments + " --json");
    const Json json = Json::parse(result.out, nullptr, false);
    ASSERT_FALSE(json.is_discarded()) << arguments << '\n' << result.err;
    add_keys(json, word_at(arguments, 0) + ' ', found);
  }
  EXPECT_GT(found.size(), 200U);
  expect_listed(found, "stable_json.txt");
}

}  // namespace
}  // namespace chronormal::stability_cli_test
