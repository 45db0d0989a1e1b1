// Makes every call of the program to the system fail once, and makes every allocation fail. After each fault, every
// output must be completely old or completely new, no other files may remain, and the exit code must be documented. A
// layer beneath the program (fault_layer.cpp) causes the faults; the program itself is unchanged.
//
// ./test --full slow runs a sample of the faults. `./test --full faults` (CHRONORMAL_FULL=1) runs all faults, except
// for some allocations. Before a command has read its arguments, it makes the table of all options, with about 8,000
// allocations that are the same for every command. In `help` and `usage`, each of these allocations fails once; in the
// other commands, one in 20. If a command such as `bake` allocates more than 3,000 times after that, about 3,000 of
// these allocations fail.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "chronormal/io/output.h"
#include "tests/support/cache_bytes.h"
#include "tests/support/gltf_documents.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/read_input.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::faults_test {
namespace {

namespace fs = std::filesystem;
using Files = std::map<std::string, std::string>;  // contents by name

constexpr const char* kOld = "what was there before\n";
constexpr std::size_t kStepInTable = 20, kMostPlaces = 3000;  // explained at the top of this file

struct Command {
  std::string name;                    // becomes the name of the test
  std::string arguments;               // no argument may contain blanks
  std::vector<std::string> old = {};   // outputs that exist before the run, and are replaced
  std::vector<std::string> kept = {};  // files that a failed run may leave for the next run

  friend void PrintTo(const Command& command, std::ostream* out) { *out << command.arguments; }
};

// The tested commands. Commands read their inputs from the folder in/, and write their outputs to the folder out/.
const std::vector<Command> kCommands = {
    {"help", "bake --help"},
    {"usage", "compare --no-such-option"},
    {"compare_json", "compare in/a.obj in/b.obj --json --no-times"},
    {"compare_file",
     "compare in/a.obj in/b.obj --no-times --schemes linear,polynomial -o out/table.txt --force",
     {"table.txt"}},
    {"compare_targets", "compare --base in/a.obj in/t.target.gz --blend 2 --csv"},
    {"convert_several", "convert in/a.obj in/b.obj -o out/new_%d.ply"},
    {"convert_one", "convert in/walk.npz -o out/old.npz --force", {"old.npz"}},
    {"convert_cache", "convert in/a.obj in/walk.pc2 -o out/new.mdd"},
    {"inspect_gltf", "inspect in/face.glb --json"},
    {"inspect_broken", "inspect in/broken.obj"},
    {"sample_times", "sample in/a.obj in/b.obj --times 0,0.5 -o out/new.npy"},
    {"sample_meshes", "sample in/a.obj in/b.obj --times 0,1 -o out/pose_%d.obj --force", {"pose_0.obj", "pose_1.obj"}},
    {"audit_gate", "audit in/a.obj in/b.obj --tolerance 0.0001 -o out/report.txt"},
    {"audit_gltf", "audit in/face.glb --json"},
    {"bake_gltf", "bake in/face.glb -o out/old.glb --force --encode exact", {"old.glb"}},
    {"bake_text", "bake in/face.glb -o out/new.gltf"},
    {"report_gltf", "report in/face.glb -o out/old.bin --force --no-plan", {"old.bin"}},
    {"bake_sequence", "bake in/a.obj in/b.obj in/c.obj -o out/new.glb --json"},
    {"bake_drivers",
     "bake in/face.glb -o out/old.glb --force --encode exact --no-audit --drivers out/old.json",
     {"old.glb", "old.json"}},
    {"compare_errors",
     "compare in/a.obj in/b.obj --no-times --schemes linear -o out/t.txt --force --errors out/e.npz",
     {"t.txt", "e.npz"}},
    {"audit_errors", "audit in/a.obj in/b.obj --json --errors out/e.ply"},
    {"query_json", "query collapse in/a.obj in/b.obj --json"},
    {"query_file", "query cones in/a.obj in/b.obj -o out/old.npz --force", {"old.npz"}},
    {"sample_file", "sample in/a.obj in/b.obj --times 0,1 -o out/new.npz"},
    {"sample_resumed",
     "sample in/a.obj in/b.obj --times 0,1 --resume -o out/new.npy",
     {},
     {"new.npy.partial", "new.npy.journal"}},
    {"merge_files", "merge in/part_1.json in/part_2.json -o out/old.json --force", {"old.json"}},
};

struct Streams {
  std::string out = "out.txt", err = "err.txt";  // "" closes the stream
};

struct Outcome {
  int exit_code = -1;  // 128 + signal if a signal ended the process
  std::string out, err;
  Files files;  // all files in the folder out
};

// Returns the step from one tested fault to the next: 1 if all faults are tested (CHRONORMAL_FULL), otherwise `many`.
std::size_t one_of(std::size_t many) { return std::getenv("CHRONORMAL_FULL") != nullptr ? 1 : many; }

// Tells whether the program is compiled with a sanitizer. The fault layer and the address sanitizer both replace
// malloc, so the tests of this file skip such a program.
bool is_sanitized_program() { return std::string(kProgram).ends_with("_sanitized"); }

class Faults : public testing::TestWithParam<Command> {
 protected:
  void SetUp() override {
    if (is_sanitized_program()) GTEST_SKIP() << "a sanitizer has a malloc of its own";
    make_inputs();
    if (HasFatalFailure()) return;
    expected_ = run("", {});
    ASSERT_LE(expected_.exit_code, 4) << expected_.err;
    std::ifstream counts(folder_ / "counts.txt");
    std::string kind;
    for (std::size_t count = 0; counts >> kind >> count;) counts_[kind] = count;
    ASSERT_GT(counts_["malloc"], 100U);
    ASSERT_GT(counts_["start"], 100U);
  }

  void make_inputs() const {
    fs::remove_all(folder_ / "in");
    fs::create_directory(folder_ / "in");
    folder_.write("in/a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
    folder_.write("in/b.obj", "v 0 0 0\nv 1 0 1\nv 0 1 0\nv 1 1 2\nf 1 2 3\nf 2 4 3\n");
    folder_.write("in/c.obj", "v 0 0 0\nv 1 0 0\nv 0 1 1\nv 1 1 3\nf 1 2 3\nf 2 4 3\n");
    folder_.write("in/broken.obj", "v 0 0 0\nv 1 0 zero\n");
    folder_.write("in/t.target", "1 0 0 1\n3 0 0.5 0\n");
    gzFile const packed = gzopen((folder_ / "in/t.target.gz").c_str(), "wb");
    gzputs(packed, "1 0 0 1\n3 0 0.5 0\n");
    gzclose(packed);
    folder_.write("in/walk.npz", test::small_npz(true));
    const Result<Motion> motion = test::read_motion(test::files({folder_ / "in/a.obj", folder_ / "in/b.obj"}));
    ASSERT_TRUE(motion && write_motion(motion.value(), folder_ / "in/walk.pc2", true));
    folder_.write("in/face.glb", test::sparse_document().glb());
    if (GetParam().name != "merge_files") return;
    for (const std::string part : {"1", "2"})
      ASSERT_EQ(run_shell(std::string(kProgram) + " compare a.obj b.obj c.obj --shard " + part + "/2 -o part_" + part +
                              ".json",
                          folder_ / "in")
                    .exit_code,
                0);
  }

  // Runs the command with a fault. Before that, writes the old content of existing outputs again, so that the command
  // replaces them.
  [[nodiscard]] Outcome run(const std::string& fault, const Streams& streams) const {
    fs::remove_all(folder_ / "out");
    fs::create_directory(folder_ / "out");
    for (const std::string& name : GetParam().old) folder_.write("out/" + name, kOld);
    const pid_t child = ::fork();
    if (child == 0) become_program(fault, streams);
    int status = 0;
    ::waitpid(child, &status, 0);
    Outcome run;
    run.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    if (streams.out == "out.txt") run.out = test::read_whole(folder_ / "out.txt");
    if (streams.err == "err.txt") run.err = test::read_whole(folder_ / "err.txt");
    for (const auto& entry : fs::recursive_directory_iterator(folder_ / "out"))
      run.files[entry.path().filename().string()] = test::read_whole(entry.path().string());
    return run;
  }

  [[noreturn]] void become_program(const std::string& fault, const Streams& streams) const {
    ::alarm(60);  // ends the process if it hangs
    // Restores the default action of signals, which the caller of the test may have set to be ignored.
    for (const int signal : {SIGTERM, SIGINT, SIGHUP}) (void)std::signal(signal, SIG_DFL);
    if (::chdir(folder_.path().c_str()) != 0) ::_exit(99);
    const auto redirect = [](int stream, const std::string& name) {
      ::close(stream);
      if (!name.empty() && ::open(name.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600) != stream) ::_exit(99);
    };
    ::close(STDIN_FILENO);
    if (::open("/dev/null", O_RDONLY) != STDIN_FILENO) ::_exit(99);
    redirect(STDOUT_FILENO, streams.out.empty() ? "/dev/null" : streams.out);
    redirect(STDERR_FILENO, streams.err);
    if (streams.out.empty()) ::close(STDOUT_FILENO);
    ::setenv("LD_PRELOAD", kFaultLayer, 1);
    if (fault.empty())
      ::setenv("CHRONORMAL_FAULT_COUNTS", "counts.txt", 1);
    else
      ::setenv("CHRONORMAL_FAULT", fault.c_str(), 1);
    std::istringstream words(std::string(kProgram) + " " + GetParam().arguments);
    std::vector<std::string> arguments;
    for (std::string word; words >> word;) arguments.push_back(word);
    std::vector<char*> pointers;
    for (std::string& argument : arguments) pointers.push_back(argument.data());
    pointers.push_back(nullptr);
    ::execv(kProgram, pointers.data());
    ::_exit(98);
  }

  // Tells whether a failed run may keep a file for the next run. Such a file is useful only together with the journal,
  // which is the last file in the list `kept`.
  [[nodiscard]] static bool is_kept(const std::string& name) {
    const std::vector<std::string>& kept = GetParam().kept;
    return std::find(kept.begin(), kept.end(), name) != kept.end();
  }

  // Checks that each output has its old or its new content, and that there are no other files. After a success, all
  // outputs must be new.
  void check_files(const Outcome& run, const std::string& what) const {
    for (const auto& [name, bytes] : run.files) {
      const auto wanted = expected_.files.find(name);
      if (is_kept(name))
        EXPECT_EQ(run.files.count(GetParam().kept.back()), 1U) << what << ": " << name << " is left alone";
      else if (wanted == expected_.files.end())
        ADD_FAILURE() << what << ": " << name << " is left";
      else
        EXPECT_TRUE(bytes == wanted->second || bytes == kOld) << what << ": " << name << " is neither old nor new";
    }
    for (const std::string& name : GetParam().old) EXPECT_EQ(run.files.count(name), 1U) << what << ": " << name;
    if (run.exit_code == expected_.exit_code) {
      EXPECT_EQ(run.files, expected_.files) << what;
    }
  }

  // Checks a run with a fault. The run must either fail with exit code 1 and a message, or do everything that was
  // requested.
  void check(const Outcome& run, const std::string& what) const {
    check_files(run, what);
    if (run.exit_code == expected_.exit_code) {
      EXPECT_EQ(run.out, expected_.out) << what;
      return;
    }
    EXPECT_EQ(run.exit_code, 1) << what << ": " << run.err;
    if (what.find("write:") == std::string::npos) {
      EXPECT_NE(run.err, "") << what;
    }
  }

  // Returns the number of allocations before a command reads its arguments. For `help` and `usage`, of which all
  // allocations are tested, returns 0.
  [[nodiscard]] std::size_t mallocs_of_table() {
    constexpr std::size_t kMostOfArguments = 500;
    const std::size_t start = counts_["start"];
    const bool is_whole = GetParam().name == "help" || GetParam().name == "usage";
    return is_whole || start < kMostOfArguments ? 0 : start - kMostOfArguments;
  }

  // Runs the command many times. In each run, another call of the given kind fails. Unless CHRONORMAL_FULL is set,
  // tests at most one in `many` of these calls. If is_harmless is true, the faults must not change the exit code.
  void check_each(const std::string& kind, const std::string& how, std::size_t many, bool is_harmless = false) {
    const std::size_t table = kind == "malloc" ? mallocs_of_table() : 0;
    const std::size_t most = table > 0 ? kMostPlaces : counts_[kind];
    const std::size_t step = std::max(one_of(many), (counts_[kind] - table) / (most + 1) + 1);
    for (std::size_t n = 1 + next_++ % step; n <= counts_[kind]; n += n < table ? std::max(step, kStepInTable) : step) {
      const std::string fault = kind + ":" + std::to_string(n) + ":" + how;
      const Outcome failed = run(fault, {});
      check(failed, fault);
      if (is_harmless) {
        EXPECT_EQ(failed.exit_code, expected_.exit_code) << fault << ": " << failed.err;
      }
      if (HasFailure()) return;
    }
  }

  test::TemporaryFolder folder_;
  Outcome expected_;
  std::map<std::string, std::size_t> counts_;
  std::size_t next_ = 0;
};

std::string code(int number) { return std::to_string(number); }

TEST_P(Faults, memory_that_is_refused_ends_in_exit_1_and_no_trace) {
  check_each("malloc", code(ENOMEM), 300);
  check_each("malloc", code(ENOMEM) + "+", 300);
}

TEST_P(Faults, calls_that_fail_end_in_exit_1_and_no_trace) {
  for (const int error : {ENOSPC, EIO})
    for (const char* const kind : {"write", "fsync", "close", "rename", "change", "truncate", "seek", "unlink"})
      check_each(kind, code(error), 2);
  for (const int error : {ENOSPC, EIO}) check_each("write", code(error) + "+", 2);
  for (const int error : {EIO, EACCES, EMFILE})
    for (const char* const kind : {"open", "stat"}) check_each(kind, code(error), 3);
  check_each("read", code(EIO), 2);
  check_each("mmap", code(ENOMEM), 2);
  check_each("lock", code(ENOLCK), 1, true);  // some file systems do not support locks
  check_each("lock", code(EWOULDBLOCK), 1);
}

// After a power cut, too, an output must be the old or the new file. The program therefore flushes a new file before it
// renames the file, and flushes the folder afterwards. Some file systems cannot flush a folder, so only the flush of
// the file must succeed.
TEST_P(Faults, every_output_and_its_folder_are_flushed) {
  const std::size_t of_journal = GetParam().kept.empty() ? 0 : 2;
  EXPECT_EQ(counts_["fsync"], 2 * expected_.files.size() + of_journal);
  if (expected_.files.size() != 1 || of_journal > 0) return;
  const Outcome file = run("fsync:1:" + code(EIO), {}), folder = run("fsync:2:" + code(EIO), {});
  check(file, "the file");
  EXPECT_EQ(file.exit_code, 1) << file.err;
  check(folder, "the folder");
  EXPECT_EQ(folder.exit_code, expected_.exit_code) << folder.err;
  for (const int error : {EINVAL, EROFS}) {  // errors of fsync() on pipes, and on file systems without it
    const Outcome none = run("fsync:1:" + code(error), {});
    EXPECT_EQ(none.exit_code, expected_.exit_code) << none.err;
  }
}

TEST_P(Faults, calls_that_do_half_or_are_interrupted_are_gone_on_with) {
  check_each("write", "short", 2, true);
  check_each("read", "short", 2, true);
  for (const char* const kind : {"write", "read", "open", "close"}) check_each(kind, code(EINTR), 2, true);
}

TEST_P(Faults, threads_that_cannot_be_had_are_done_without) {
  const Outcome failed = run("thread:1:" + code(EAGAIN) + "+", {});
  check(failed, "no threads");
  EXPECT_EQ(failed.exit_code, expected_.exit_code) << failed.err;
}

TEST_P(Faults, signals_at_any_call_leave_no_trace) {
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) {
    const std::size_t step = one_of(12);
    for (std::size_t n = 1 + next_++ % step; n <= counts_["any"]; n += step) {
      const std::string fault = "any:" + std::to_string(n) + ":signal" + std::to_string(signal);
      const Outcome ended = run(fault, {});
      check_files(ended, fault);
      EXPECT_EQ(ended.exit_code, 128 + signal) << fault << ": " << ended.err;
      EXPECT_NE(ended.err.find("(SIG"), std::string::npos) << fault << ": " << ended.err;
      if (HasFailure()) return;
    }
  }
  const Outcome shrunk = run("any:1:signal" + std::to_string(SIGBUS), {});
  check_files(shrunk, "SIGBUS");
  EXPECT_EQ(shrunk.exit_code, 1);
}

TEST_P(Faults, inputs_that_become_shorter_while_they_are_read_end_in_exit_1) {
  for (std::size_t n = 1; n <= counts_["mmap"]; ++n) {
    const std::string fault = "mmap:" + std::to_string(n) + ":short";
    const Outcome shrunk = run(fault, {});
    // The run may also succeed: the file that becomes shorter may be a result that is read again to judge it, or a file
    // in memory, whose length does not change.
    EXPECT_TRUE(shrunk.exit_code == 1 || shrunk.exit_code == expected_.exit_code) << fault << ": " << shrunk.err;
    for (const auto& [name, bytes] : shrunk.files)
      EXPECT_TRUE(expected_.files.count(name) == 1 || is_kept(name)) << fault << ": " << name;
    make_inputs();
  }
}

TEST_P(Faults, streams_that_are_full_or_closed_change_exit_codes_only_where_data_were_asked_for) {
  const int without_data = expected_.out.empty() ? expected_.exit_code : 1;
  for (const char* const lost : {"/dev/full", ""}) {
    const Outcome no_out = run("", {lost, "err.txt"});
    check_files(no_out, "stdout");
    EXPECT_EQ(no_out.exit_code, without_data) << no_out.err;
    const Outcome no_err = run("", {"out.txt", lost});
    check(no_err, "stderr");
    EXPECT_EQ(no_err.exit_code, expected_.exit_code);
    const Outcome neither = run("", {lost, lost});
    check_files(neither, "both");
    EXPECT_EQ(neither.exit_code, without_data);
  }
}

// First, each call fails while standard error accepts no output. Then, two calls fail in one run.
TEST_P(Faults, pairs_of_failures_leave_no_trace) {
  std::vector<std::string> single;
  for (const char* const kind : {"write", "fsync", "close", "rename", "open", "change", "truncate", "seek", "unlink"})
    for (std::size_t n = 1; n <= counts_[kind]; ++n)
      single.push_back(kind + (":" + std::to_string(n) + ":") + code(EIO));
  const std::size_t step = one_of(500);
  std::size_t number = GetParam().name.size();
  for (std::size_t i = 0; i < single.size() && !HasFailure(); ++i) {
    for (const char* const lost : {"/dev/full", ""}) {
      if (number++ % step != 0) continue;
      const Outcome no_err = run(single[i], {"out.txt", lost});
      check_files(no_err, single[i]);
      EXPECT_TRUE(no_err.exit_code == 1 || no_err.exit_code == expected_.exit_code) << single[i];
    }
    for (std::size_t j = i + 1; j < single.size() && !HasFailure(); ++j)
      if (number++ % step == 0) check(run(single[i] + "," + single[j], {}), single[i] + "," + single[j]);
  }
}

INSTANTIATE_TEST_SUITE_P(Command, Faults, testing::ValuesIn(kCommands),
                         [](const testing::TestParamInfo<Command>& tested) { return tested.param.name; });

}  // namespace
}  // namespace chronormal::faults_test
