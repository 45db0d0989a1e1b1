// Kills a run with --resume at a system call, and starts the run again. The result must equal that of a run that was
// not killed. ./test --full slow kills runs at random calls, and `./test --full faults` (CHRONORMAL_FULL=1) at each
// call.

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::killed_test {
namespace {

namespace fs = std::filesystem;

struct Command {
  std::string name, arguments, undisturbed;

  friend void PrintTo(const Command& command, std::ostream* out) { *out << command.arguments; }
};

const Command kCommands[] = {
    {"sample", "sample w_0.obj w_1.obj w_2.obj w_3.obj --times 0:0.25:3 --format npy", ""},
    {"compare", "compare w_0.obj w_1.obj w_2.obj w_3.obj --schemes linear,slerp --json", " --no-times"},
    {"audit", "audit w_0.obj w_1.obj w_2.obj w_3.obj --path catmull-rom --shard 1/1", ""},
};

class Killed : public testing::TestWithParam<Command> {
 protected:
  void SetUp() override {
    if (std::string(kProgram).ends_with("_sanitized")) GTEST_SKIP() << "a sanitizer has a malloc of its own";
    for (int k = 0; k < 4; ++k)
      folder_.write("w_" + std::to_string(k) + ".obj", "v 0 0 0\nv 1 0 0\nv 0 1 " + std::to_string(0.1 * k * k) +
                                                           "\nv 1 1 0." + std::to_string(k) + "\nf 1 2 3\nf 2 4 3\n");
    ASSERT_EQ(run(GetParam().undisturbed + " -o whole").exit_code, 0);
    whole_ = test::read_whole(folder_ / "whole");
    ASSERT_EQ(run(" --resume -o counted", "CHRONORMAL_FAULT_COUNTS=counts LD_PRELOAD=").exit_code, 0);
    std::ifstream counts(folder_ / "counts");
    std::string kind;
    for (std::size_t count = 0; counts >> kind >> count;)
      if (kind == "any") calls_ = count;
    ASSERT_GT(calls_, 20U);
  }

  // Runs the command. `layer` has the environment variables of the fault layer, and ends with LD_PRELOAD=, after which
  // run() puts the path of the layer. If `layer` is empty, runs without the fault layer.
  [[nodiscard]] ProcessResult run(const std::string& more, const std::string& layer = "") const {
    const std::string before = layer.empty() ? "" : layer + kFaultLayer + " ";
    // The second command, `exit`, makes the shell run the program in a child process. The shell can then report how the
    // program ended.
    return run_shell(before + kProgram + " " + GetParam().arguments + more + "; exit $?", folder_.path());
  }
  [[nodiscard]] ProcessResult run_to(std::size_t call, int signal) const {
    return run(" --resume -q -o out",
               "CHRONORMAL_FAULT=any:" + std::to_string(call) + ":signal" + std::to_string(signal) + " LD_PRELOAD=");
  }
  // Resumes a killed run until the run is complete, and checks the files.
  void finish(const std::string& what) const {
    const ProcessResult done = run(" --resume -q -o out");
    // If the run was killed after it had removed its journal, the run was complete, and only its output exists.
    if (done.exit_code != 0) {
      EXPECT_NE(done.err.find("the file exists already"), std::string::npos) << what << ": " << done.err;
    }
    EXPECT_TRUE(test::read_whole(folder_ / "out") == whole_) << what;
    EXPECT_FALSE(fs::exists(folder_ / "out.journal")) << what;
    EXPECT_FALSE(fs::exists(folder_ / "out.partial")) << what;
    fs::remove(folder_ / "out");
  }

  test::TemporaryFolder folder_;
  std::string whole_;
  std::size_t calls_ = 0;
};

TEST_P(Killed, runs_that_are_killed_twice_give_the_bytes_of_an_undisturbed_run) {
  constexpr unsigned kSeed = 26;
  constexpr std::size_t kMoments = 17;  // at how many calls each command is killed
  std::mt19937 random(kSeed);
  const bool is_full = std::getenv("CHRONORMAL_FULL") != nullptr;
  for (std::size_t i = 0; i < (is_full ? calls_ : kMoments) && !HasFailure(); ++i) {
    const std::size_t first = is_full ? i + 1 : 1 + random() % calls_, second = 1 + random() % calls_;
    const std::string what =
        "seed " + std::to_string(kSeed) + ", calls " + std::to_string(first) + " and " + std::to_string(second);
    EXPECT_EQ(run_to(first, SIGKILL).exit_code, 128 + SIGKILL) << what;
    (void)run_to(second, SIGKILL);  // the second run has less work, and may end before it is killed
    finish(what);
  }
}

TEST_P(Killed, runs_that_are_interrupted_say_how_to_go_on) {
  std::size_t kept = 0;
  for (std::size_t call = 1; call <= calls_ && !HasFailure(); call += calls_ / 12) {
    const ProcessResult ended = run_to(call, SIGINT);
    const std::string what = "call " + std::to_string(call) + ": " + ended.err;
    EXPECT_EQ(ended.exit_code, 128 + SIGINT) << what;
    EXPECT_NE(ended.err.find("interrupted (SIGINT)"), std::string::npos) << what;
    const std::string journal = test::read_whole(folder_ / "out.journal");
    const bool has_records = std::count(journal.begin(), journal.end(), '\n') > 1;
    if (has_records) {
      EXPECT_NE(ended.err.find("repeat the command to go on"), std::string::npos) << what;
    }
    kept += has_records ? 1U : 0U;
    for (const auto& entry : fs::directory_iterator(folder_.path()))
      EXPECT_NE(entry.path().extension(), ".tmp") << what;
    finish(what);
  }
  EXPECT_GT(kept, 0U);
}

INSTANTIATE_TEST_SUITE_P(Command, Killed, testing::ValuesIn(kCommands),
                         [](const testing::TestParamInfo<Command>& tested) { return tested.param.name; });

}  // namespace
}  // namespace chronormal::killed_test
