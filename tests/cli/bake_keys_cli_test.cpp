// Tests `bake --encode keys` on the command line: the report, the exit codes, and refused requests.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <string>

#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::bake_keys_cli_test {
namespace {

using Json = nlohmann::json;

class BakeKeysCommand : public testing::Test {
 protected:
  [[nodiscard]] ProcessResult run(const std::string& arguments) const {
    return run_shell(std::string(kProgram) + " bake " + arguments, folder_.path());
  }
  test::TemporaryFolder folder_;
};

TEST_F(BakeKeysCommand, report_counts_keys_and_what_they_save) {
  const ProcessResult made = run("--sample bend --encode keys --tolerance 2 --json -o bend.glb");
  ASSERT_EQ(made.exit_code, 0) << made.err;
  const Json report = Json::parse(made.out);
  EXPECT_EQ(report["encoding"], "keys");
  EXPECT_GT(report["keys"]["count"], 2);
  EXPECT_EQ(report["keys"]["in_between"].get<int>() + 2, report["keys"]["count"].get<int>());
  EXPECT_EQ(report["keys"]["keyframes_left_out"], 0);
  EXPECT_GE(report["keys"]["even"], report["keys"]["count"]);
  EXPECT_EQ(report["keys"]["beyond"], 0);
  EXPECT_LE(report["bound_degrees"], 2);
  const std::string text = run("--sample bend --encode keys --tolerance 2 --force -o bend.glb").out;
  EXPECT_NE(text.find(" between keyframes; 0 keyframes were left out; "), std::string::npos) << text;
  EXPECT_NE(text.find("\nthe error is at most "), std::string::npos) << text;
  // A bake with --encode keys leaves a mark in the file that has the same form as the mark of a bake for all viewers,
  // so all readers of marks understand it.
  const Json audited = Json::parse(
      run_shell(std::string(kProgram) + " audit bend.glb --json --for three --tolerance 2.01", folder_.path()).out);
  EXPECT_LE(audited["viewers"][0]["worst_degrees"], 2.01) << audited;
}

TEST_F(BakeKeysCommand, a_collapse_is_beyond_what_was_asked_for) {
  folder_.write("0.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder_.write("1.obj", "v 0 0 0\nv 1 0 0\nv 0 -3 0\nf 1 2 3\n");
  const ProcessResult asked = run("0.obj 1.obj --encode keys --tolerance 1 -o out.glb");
  EXPECT_EQ(asked.exit_code, 4) << asked.err;
  EXPECT_NE(asked.err.find("in 3 cases, a normal vanishes or turns too fast between two keyframes"), std::string::npos);
  EXPECT_EQ(run("0.obj 1.obj --encode keys -o other.glb").exit_code, 4);
}

TEST_F(BakeKeysCommand, what_has_no_meaning_is_refused) {
  EXPECT_EQ(run("--sample bend --encode keys --tolerance 0 -o a.glb").exit_code, 2);
  EXPECT_EQ(run("--sample bend --encode keys --weighting angle -o a.glb").exit_code, 2);
  ASSERT_EQ(run("--sample bend --encode keys --tolerance 20 -o bend.glb").exit_code, 0);
  const ProcessResult document = run("bend.glb --encode keys -o b.glb");
  EXPECT_EQ(document.exit_code, 2);
  EXPECT_NE(document.err.find(
                "the encoding keys is only for sequences of keyframes, not for glTF files; choose another --encode"),
            std::string::npos)
      << document.err;
}

}  // namespace
}  // namespace chronormal::bake_keys_cli_test
