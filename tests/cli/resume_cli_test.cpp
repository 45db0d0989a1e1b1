// Tests `--resume`: a run that failed must continue where it stopped and write the same bytes, and the journal of
// another run is refused. In this file, runs fail because of a limit on the size of files. In
// tests/faults/killed_test.cpp, runs are killed.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::resume_cli_test {
namespace {

namespace fs = std::filesystem;

class Resume : public testing::Test {
 protected:
  // Writes nine keyframes of a strip of triangles that folds.
  Resume() {
    for (int k = 0; k < 9; ++k) {
      std::string text;
      for (int x = 0; x < 12; ++x)
        text +=
            "v " + std::to_string(x) + " 0 0\nv " + std::to_string(x) + " 1 " + std::to_string(0.02 * k * x * x) + "\n";
      for (int v = 1; v < 23; v += 2)
        text += "f " + std::to_string(v) + " " + std::to_string(v + 2) + " " + std::to_string(v + 1) + "\nf " +
                std::to_string(v + 2) + " " + std::to_string(v + 3) + " " + std::to_string(v + 1) + "\n";
      folder_.write("w_" + std::to_string(k) + ".obj", text);
    }
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments, const std::string& before = "") const {
    return run_shell(before + std::string(kProgram) + " " + arguments, folder_.path());
  }
  // Runs the program with a limit on the size of the files that it writes. A block of the limit has 512 bytes or, in
  // some shells, 1,024 bytes.
  [[nodiscard]] ProcessResult cut(const std::string& arguments, const std::string& blocks = "4") const {
    return run(arguments, "ulimit -f " + blocks + "; ");
  }
  [[nodiscard]] std::string file(const std::string& name) const { return test::read_whole(folder_ / name); }
  [[nodiscard]] bool exists(const std::string& name) const { return fs::exists(folder_ / name); }

  // Ends a run early by a limit on the size of files, resumes the run, and compares the result with that of an
  // undisturbed run.
  void check(const std::string& command, const std::string& undisturbed, const std::string& blocks = "4") const {
    const std::string out = " --resume -o out";
    ASSERT_EQ(run(command + undisturbed + " -o whole").exit_code, 0);
    const ProcessResult failed = cut(command + out, blocks);
    EXPECT_EQ(failed.exit_code, 1) << failed.err;
    EXPECT_NE(failed.err.find("repeat the command to go on"), std::string::npos) << failed.err;
    EXPECT_TRUE(exists("out.journal"));
    EXPECT_FALSE(exists("out"));
    const ProcessResult done = run(command + out);
    EXPECT_EQ(done.exit_code, 0) << done.err;
    EXPECT_NE(done.err.find("an earlier run has finished "), std::string::npos) << done.err;
    EXPECT_TRUE(file("out") == file("whole"));
    EXPECT_FALSE(exists("out.journal") || exists("out.partial"));
    fs::remove(folder_ / "out");
    EXPECT_EQ(run(command + out).exit_code, 0);
    EXPECT_TRUE(file("out") == file("whole"));
  }

  test::TemporaryFolder folder_;
};

constexpr const char* kSample = "sample 'w_*.obj' --times 0:0.125:8 --format npy";

TEST_F(Resume, samples_go_on_with_the_same_bytes) { check(kSample, ""); }

TEST_F(Resume, a_shard_of_samples_on_curves_goes_on_with_the_same_bytes) {
  check(std::string(kSample) + " --shard 2/2 --path catmull-rom", "");
}

TEST_F(Resume, comparisons_go_on_with_the_same_bytes) {
  check("compare 'w_*.obj' --elements vertices --json", " --no-times");
}

TEST_F(Resume, audits_go_on_with_the_same_bytes) { check("audit 'w_*.obj' --json", "", "12"); }

TEST_F(Resume, rows_that_are_not_in_the_file_are_written_anew) {
  ASSERT_EQ(run(std::string(kSample) + " -o whole").exit_code, 0);
  for (const char* const damage : {"truncate -s -300 out.partial", "truncate -s 0 out.partial", "rm out.partial",
                                   "printf x | dd of=out.partial bs=1 seek=700 conv=notrunc status=none",
                                   "truncate -s -3 out.journal", "head -c 500 /dev/zero >> out.partial"}) {
    fs::remove(folder_ / "out");
    ASSERT_EQ(cut(std::string(kSample) + " --resume -o out").exit_code, 1);
    ASSERT_EQ(run_shell(damage, folder_.path()).exit_code, 0) << damage;
    EXPECT_EQ(run(std::string(kSample) + " --resume -o out").exit_code, 0) << damage;
    EXPECT_TRUE(file("out") == file("whole")) << damage;
  }
}

TEST_F(Resume, a_journal_of_another_run_is_refused_with_what_differs) {
  const std::string command = std::string(kSample) + " --resume -o out";
  ASSERT_EQ(cut(command).exit_code, 1);
  const std::string journal = file("out.journal"), partial = file("out.partial");
  const ProcessResult weighted = run(command + " --weighting angle");
  EXPECT_EQ(weighted.exit_code, 2);
  EXPECT_NE(weighted.err.find("--weighting was 'area' in that run and is 'angle' now"), std::string::npos)
      << weighted.err;
  EXPECT_NE(run(command + " --length area").err.find("--length was 'unit'"), std::string::npos);
  EXPECT_NE(run("sample w_0.obj w_1.obj --times 0:0.125:1 --format npy --resume -o out").err.find("INPUT was"),
            std::string::npos);
  fs::last_write_time(folder_ / "w_3.obj", fs::last_write_time(folder_ / "w_3.obj") + std::chrono::hours(1));
  const ProcessResult changed = run(command);
  EXPECT_EQ(changed.exit_code, 2);
  EXPECT_NE(changed.err.find("file w_3.obj was"), std::string::npos) << changed.err;
  EXPECT_NE(changed.err.find("remove the journal"), std::string::npos) << changed.err;
  EXPECT_EQ(file("out.journal"), journal);
  EXPECT_EQ(file("out.partial"), partial);
  fs::remove(folder_ / "out.journal");
  EXPECT_EQ(run(command).exit_code, 0);  // starts again, and replaces what the unfinished run left
}

TEST_F(Resume, files_of_other_people_are_not_touched) {
  folder_.write("out.partial", "mine");
  EXPECT_EQ(run(std::string(kSample) + " --resume -o out").exit_code, 1);
  EXPECT_EQ(file("out.partial"), "mine");
  EXPECT_FALSE(exists("out.journal"));
  folder_.write("new.journal", "mine, too");
  EXPECT_EQ(run("audit 'w_*.obj' --resume -o new").exit_code, 1);
  EXPECT_EQ(file("new.journal"), "mine, too");
  folder_.write("old", "there before");
  EXPECT_EQ(run("audit 'w_*.obj' --resume -o old").exit_code, 1);
  EXPECT_EQ(file("old"), "there before");
  EXPECT_EQ(run("audit 'w_*.obj' --resume --force -o old").exit_code, 0);
}

TEST_F(Resume, a_run_that_has_done_nothing_leaves_nothing) {
  // The limit on the size of files is so small that the first write of each command fails. The first command writes a
  // row of its result, and the other commands write a record of their journals.
  for (const std::string command :
       {"sample --sample twist --times 0,1 --format npy", "compare --sample twist", "audit --sample twist"}) {
    const ProcessResult failed = cut(command + " --resume -o out", command.starts_with("sample") ? "4" : "2");
    EXPECT_EQ(failed.exit_code, 1) << command << failed.err;
    EXPECT_EQ(failed.err.find("repeat"), std::string::npos) << command << failed.err;
    EXPECT_FALSE(exists("out.journal") || exists("out.partial") || exists("out")) << command;
  }
}

TEST_F(Resume, what_cannot_go_on_is_refused_at_once) {
  folder_.write("t.obj", file("w_1.obj"));
  folder_.write("cache.xml", "<Autodesk_Cache_File/>");
  ASSERT_EQ(run_shell("mkfifo pipe.obj", folder_.path()).exit_code, 0);
  ASSERT_EQ(run("bake 'w_*.obj' -o m.glb").exit_code, 0);
  for (const char* const arguments :
       {"audit 'w_*.obj' --resume", "sample 'w_*.obj' --times 1 --resume -o n.npz",
        "sample 'w_*.obj' --times 1 --resume -o n.ply", "sample 'w_*.obj' --times 1 --resume --format npy -o -",
        "compare --each 'w_*.obj' --sample twist --resume -o x", "compare 'w_*.obj' --truth 2 --resume -o x",
        "compare 'w_*.obj' --resume --errors e.npz -o x", "audit 'w_*.obj' --resume --errors e.npz -o x",
        "audit --base w_0.obj t.obj --resume -o x", "compare --base w_0.obj t.obj --resume -o x",
        "compare --sample shapes --blend 5 --resume -o x", "audit w_0.obj - --resume -o x < t.obj",
        "audit w_0.obj pipe.obj --resume -o x", "audit w_0.obj cache.xml --resume -o x", "audit m.glb --resume -o x",
        "audit m.glb w_0.glb --resume -o x", "compare m.glb --resume -o x",
        "sample --base w_0.obj t.obj --weights 1 --resume --format npy -o x",
        "sample --sample bumps --weights 0.2 --resume --format npy -o x"}) {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << '\n' << result.err;
    EXPECT_FALSE(exists("x.journal")) << arguments;
  }
}

}  // namespace
}  // namespace chronormal::resume_cli_test
