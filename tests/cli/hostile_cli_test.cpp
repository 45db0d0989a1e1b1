// Tests the program with hostile files and under hostile conditions: strange names of files, endless inputs, and files
// that declare more data than they have. Messages must say what is wrong.

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <system_error>
#include <vector>

#include "tests/support/cache_bytes.h"
#include "tests/support/gltf_documents.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/read_input.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::hostile_cli_test {
namespace {

using Json = nlohmann::json;

constexpr const char* kFirst = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
constexpr const char* kSecond = "v 0 0 0\nv 1 0 1\nv 0 1 0\nf 1 2 3\n";

class HostileCli : public testing::Test {
 protected:
  [[nodiscard]] ProcessResult run(const std::string& arguments, const std::string& before = "",
                                  const std::string& input = "") const {
    return run_shell(before + kProgram + " " + arguments, folder_.path(), input);
  }
  void expect(const ProcessResult& result, int exit_code, const std::vector<std::string>& words) const {
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    for (const std::string& word : words) EXPECT_NE(result.err.find(word), std::string::npos) << result.err;
  }

  test::TemporaryFolder folder_;
};

// Describes the first character of a text that would control a terminal, or returns "" if there is none.
std::string find_unsafe(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto c = static_cast<unsigned char>(text[i]);
    if ((c < 0x20 && c != '\n') || c == 0x7F || c >= 0xF8) return "byte " + std::to_string(c);
    const std::string_view rest = text.substr(i);
    if (rest.size() > 1 && c == 0xC2 && static_cast<unsigned char>(rest[1]) < 0xA0) return "a C1 control";
    for (const char* const turning : {"\u202e", "\u2066", "\u2028", "\ufeff"})
      if (rest.starts_with(turning)) return turning;
  }
  return "";
}

// Names of files that the file system accepts. The second name is not valid UTF-8.
const std::vector<std::string> kNames = {"esc\x1b[31m csi\u009b31m rtl\u202etxt two\nlines del\x7f", "raw\xff\x9b"};

TEST_F(HostileCli, names_of_files_are_printed_without_what_a_terminal_obeys) {
  const auto quoted = [](const std::string& text) { return "'" + text + "'"; };
  for (const std::string& name : kNames) {
    folder_.write(name + "_0.obj", kFirst);
    folder_.write(name + "_1.obj", kSecond);
    const std::string both = quoted(name + "_0.obj") + " " + quoted(name + "_1.obj");
    const std::string missing = quoted(name + ".obj"), two = quoted(name + "_0.obj");
    for (const std::string& arguments :
         {"inspect " + both,
          "inspect " + both + " --json",
          "compare " + both,
          "compare " + both + " --csv",
          "compare " + both + " --json",
          "compare --base " + both + " --blend 2",
          "compare --base " + both + " --blend 2 --csv",
          "compare --base " + both + " --blend 2 --json",
          "compare " + both + " --certify",
          "compare " + both + " --tolerance 0",
          "compare " + both + " --path catmull-rom",
          "audit " + both + " --path catmull-rom",
          "audit " + both + " --shard 1/1 --force -o " + quoted(name + ".part"),
          "merge " + quoted(name + ".part") + " --force -o " + quoted(name + ".json"),
          "merge " + quoted(name + ".json"),
          "merge " + missing,
          "query collapse " + both,
          "query cones " + both + " --json",
          "query facing " + both + " --direction 0,0,1 --force -o " + quoted(name + ".npz"),
          "query " + quoted(name) + " " + both,
          "query contain " + both + " --points " + missing,
          "report " + both + " --force -o " + quoted(name + ".bin"),
          "report " + both + " --template " + missing + " --force -o " + quoted(name + ".html"),
          "audit " + both,
          "audit " + both + " --json",
          "audit " + both + " --tolerance 0.1",
          "bake " + both + " --force -o " + quoted(name + ".glb"),
          "bake " + both + " -o out.glb --force --json",
          "sample " + both + " --times 9 -o x.npy",
          "sample " + both + " --elements corners --hard-edges groups --times 0 -o x.npy",
          "convert " + both + " -o " + quoted(name),
          "convert " + two + " -o " + quoted(name + "_0.obj"),
          "inspect " + missing,
          "compare " + two,
          "inspect " + quoted(name),
          "compare --schemes " + quoted(name) + " " + both,
          "compare --base " + two + " " + missing,
          quoted(name),
          "inspect --" + quoted(name),
          "audit " + both + " --rule " + quoted(name),
          "bake " + both + " -o x.glb --encode " + quoted(name),
          "inspect " + two + " --animation " + quoted(name),
          "sample " + both + " --times " + quoted(name) + " -o x.npy"}) {
      const ProcessResult result = run(arguments);
      EXPECT_LE(result.exit_code, 4) << arguments;
      EXPECT_EQ(find_unsafe(result.out), "") << arguments << "\n" << result.out;
      EXPECT_EQ(find_unsafe(result.err), "") << arguments << "\n" << result.err;
    }
    // A name that is valid UTF-8 must be in the JSON unchanged.
    if (name != kNames.back()) {
      EXPECT_EQ(Json::parse(run("inspect " + two + " --json").out)["input"]["name"], name + "_0.obj");
    }
  }
}

TEST_F(HostileCli, names_in_a_gltf_file_are_printed_without_what_a_terminal_obeys) {
  const std::string& name = kNames.front();
  test::GltfBuilder builder = test::sparse_document();
  builder.json["meshes"][0]["name"] = name;
  builder.json["meshes"][0]["extras"]["targetNames"] = {name + "1", name + "2"};
  for (auto& node : builder.json["nodes"]) node["name"] = name;
  builder.json["animations"][0]["name"] = name;
  folder_.write("face.glb", builder.glb());
  for (const std::string arguments : {"inspect face.glb",
                                      "inspect face.glb --json",
                                      "inspect face.glb --animation 0",
                                      "inspect face.glb --animation no",
                                      "audit face.glb",
                                      "audit face.glb --json",
                                      "audit face.glb --animation 0 --tolerance 0",
                                      "audit face.glb --for all",
                                      "query cones face.glb",
                                      "query collapse face.glb --json",
                                      "report face.glb -o out.bin --force",
                                      "report face.glb -o out.bin --force --json",
                                      "compare face.glb --certify",
                                      "compare face.glb",
                                      "compare face.glb --csv",
                                      "compare face.glb --blend 2",
                                      "compare face.glb --blend 2 --csv",
                                      "compare face.glb --blend 2 --json --animation 0",
                                      "bake face.glb -o out.glb --force",
                                      "bake face.glb -o out.glb --force --json --encode endpoint",
                                      "sample face.glb --times 0 -o x.npy"}) {
    const ProcessResult result = run(arguments);
    EXPECT_LE(result.exit_code, 4) << arguments;
    EXPECT_EQ(find_unsafe(result.out), "") << arguments << "\n" << result.out;
    EXPECT_EQ(find_unsafe(result.err), "") << arguments << "\n" << result.err;
  }
}

TEST_F(HostileCli, devices_without_an_end_are_refused_before_they_are_read) {
  expect(run("inspect /dev/zero"), 1, {"/dev/zero: this is a device"});
  expect(run("inspect - < /dev/zero"), 1, {"<stdin>: this is a device"});
  folder_.write("x.obj", kFirst);
  expect(run("audit --base /dev/urandom x.obj"), 1, {"/dev/urandom: this is a device"});
}

TEST_F(HostileCli, writing_beyond_the_limit_of_the_shell_is_an_error_and_leaves_nothing) {
  folder_.write("a.obj", kFirst);
  folder_.write("old.npy", "old");
  const ProcessResult result = run("sample --sample twist --times 0:0.01:1 -o old.npy --force", "ulimit -f 100; ");
  expect(result, 1, {"old.npy: File too large"});
  EXPECT_EQ(test::read_whole(folder_ / "old.npy"), "old");
  EXPECT_EQ(folder_.entry_count(), 2U);
}

TEST_F(HostileCli, signals_that_are_ignored_stay_ignored) {
  // The program must not be ended by signals that its shell ignores: SIGINT in a background job, and SIGHUP if `trap`
  // says so. The command nohup ignores SIGHUP too.
  const ProcessResult result =
      run("sample --sample twist --times 0:0.001:1 -o out.npy & sleep 0.1; kill -INT $!; kill -HUP $!; wait $!",
          "trap '' HUP; ");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(std::filesystem::exists(folder_ / "out.npy"));
}

TEST_F(HostileCli, a_closed_stream_is_not_taken_for_the_output) {
  ASSERT_EQ(run("convert --sample twist -o right.npz").exit_code, 0);
  for (const char* const closed : {" <&-", " >&-", " 2>&-", " <&- >&- 2>&-"}) {
    EXPECT_EQ(run("convert --sample twist --force -o out.npz" + std::string(closed)).exit_code, 0) << closed;
    EXPECT_EQ(test::read_whole(folder_ / "out.npz"), test::read_whole(folder_ / "right.npz")) << closed;
  }
  // The program has a note about zero normals but cannot print it, since standard error is closed. The note must not
  // end up in the output file instead.
  folder_.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n");
  EXPECT_EQ(run("sample flat.obj -o flat.npy 2>&-").exit_code, 0);
  EXPECT_EQ(test::read_whole(folder_ / "flat.npy").find("chronormal"), std::string::npos);
}

TEST_F(HostileCli, a_pipe_holds_a_whole_motion_for_every_command) {
  const std::string npz = test::small_npz(true);
  for (const char* const arguments : {"inspect -", "compare -", "audit -", "bake - -o out.glb",
                                      "sample - --times 1 -o out.npy", "convert - -o out.mdd"}) {
    const ProcessResult piped = run(arguments, "cat | ", npz),
                        redirected = run(std::string(arguments) + " --force", "", npz);
    EXPECT_EQ(piped.exit_code, 0) << arguments << ": " << piped.err;
    EXPECT_EQ(redirected.exit_code, 0) << arguments << ": " << redirected.err;
    EXPECT_EQ(redirected.out.substr(0, 9), piped.out.substr(0, 9)) << arguments;
  }
}

TEST_F(HostileCli, small_files_that_ask_for_much_are_refused_with_the_option_that_allows_it) {
  using test::npy, test::npy_header;
  const std::string positions = npy(npy_header("<f4", "(2, 1000000, 3)"), std::string(24000000, '\0'));
  const std::string faces = npy(npy_header("<i4", "(1, 3)"), test::raw<std::int32_t>({0, 1, 2}));
  folder_.write("bomb.npz", test::zip({{"positions.npy", positions, true}, {"faces.npy", faces}}));
  for (const std::string arguments :
       {"inspect bomb.npz", "bake bomb.npz -o out.glb", "compare bomb.npz", "audit bomb.npz",
        "convert bomb.npz -o out.npz", "sample bomb.npz --times 0 -o out.npy"})
    expect(run(arguments), 3, {"bomb.npz, positions: ", "--max-expansion "});
  EXPECT_EQ(folder_.entry_count(), 1U);
  EXPECT_EQ(run("sample bomb.npz --times 0 -o out.npy --max-expansion 3000").exit_code, 0);
}

TEST_F(HostileCli, what_the_user_asks_for_is_announced_and_not_refused) {
  const std::string arguments = "sample --sample twist --times 0:0.00005:1 -o no/folder_%d.ply";
  const ProcessResult result = run(arguments);
  expect(result, 1,
         {"chronormal sample: the result will have 1.8 GB, for 20,001 moments with 7,700 normals each; to make the "
          "result smaller, give fewer moments\n",
          "cannot be written to"});
  EXPECT_EQ(run(arguments + " --quiet").err.find("GB"), std::string::npos);
}

TEST_F(HostileCli, messages_say_what_is_the_matter) {
  folder_.write("a.obj", kFirst);
  folder_.write("b.obj", kSecond);
  folder_.write("f.fbx", "Kaydara FBX Binary");
  folder_.write("text.glb", "hello");
  folder_.write("other.npz", test::zip({{"points.npy", "x"}, {"faces.npy", "y"}}));
  expect(run("inspect f.fbx"), 3, {".obj, ", ".glb", ".npz", ".md2", ".pc2", ".target.gz"});
  expect(run("inspect text.glb"), 3, {"text.glb, byte 0: this is not a glTF file"});
  expect(run("inspect other.npz"), 3, {"positions: the file has no array of this name, only points, faces"});
  const ProcessResult gltf = run("convert a.obj b.obj -o r.glb");
  expect(gltf, 2, {"r.glb: ", "bake"});
  EXPECT_EQ(gltf.err.find("%d"), std::string::npos);
  for (const char* const samples : {"-5", "1", "1e3", "x", "1000002", "''"}) {
    for (const char* const command : {"audit", "compare"})
      expect(run(std::string(command) + " a.obj b.obj --samples " + samples), 2,
             {"--samples: the value must be a whole number from 2 to 1,000,00"});
  }
  expect(run("inspect a.obj --max-expansion -1"), 2,
         {"--max-expansion: the value must be a whole number of at least 0"});
}

TEST_F(HostileCli, a_sentence_that_holds_for_several_meshes_is_said_once) {
  test::GltfBuilder builder = test::sparse_document();
  const auto mesh = builder.json["meshes"][0];
  for (const char* const name : {"one", "two", "three"}) {
    builder.json["meshes"].push_back(mesh);
    builder.json["meshes"].back()["name"] = name;
  }
  builder.json.erase("animations");
  folder_.write("four.glb", builder.glb());
  const ProcessResult result = run("bake four.glb -o out.glb --encode exact");
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("quad, one, two, three: --encode exact"), std::string::npos) << result.err;
  const std::size_t first = result.err.find("by --encode exact");
  EXPECT_EQ(result.err.find("by --encode exact", first + 1), std::string::npos) << result.err;
}

// An output must never replace an input or another output, even if the command names one file by two different paths.
TEST_F(HostileCli, two_outputs_and_what_is_read_are_different_files_by_any_name) {
  folder_.write("a.obj", kFirst);
  folder_.write("b.obj", kSecond);
  folder_.write("moving.glb", test::sparse_document().glb());
  folder_.write("same.npz", "old");
  folder_.write("drivers.glb", "old");
  folder_.write("part.json", "{}");
  folder_.write("poses.glb", R"([{"a": 1}])");
  std::filesystem::create_symlink("new.npz", folder_ / "link.npz");
  std::filesystem::create_hard_link(folder_ / "a.obj", folder_ / "hard.txt");
  std::filesystem::create_directory(folder_ / "sub");
  for (const std::string arguments :
       {"audit a.obj b.obj --errors ./same.npz -o same.npz", "audit a.obj b.obj --errors ./new.npz -o new.npz",
        "audit a.obj b.obj --errors link.npz -o sub/../new.npz", "audit a.obj b.obj --errors same.npz > same.npz",
        "audit a.obj b.obj -o hard.txt", "audit moving.glb -o ./moving.glb",
        "compare a.obj b.obj --errors ./same.npz -o same.npz", "compare a.obj b.obj -o ./b.obj",
        "compare --each --base a.obj ./b.obj -o b.obj", "compare --base a.obj b.obj --blend 2 -o a.obj",
        "bake moving.glb -o drivers.glb --drivers ./drivers.glb", "bake moving.glb -o out.glb --drivers ./moving.glb",
        "bake moving.glb -o poses.glb --poses ./poses.glb", "bake moving.glb -o same.npz.glb > same.npz.glb",
        "query collapse a.obj b.obj -o ./a.obj --json", "sample a.obj b.obj --times 0 -o ./a.obj",
        "inspect a.obj b.obj -o ./a.obj", "merge part.json -o ./part.json",
        "report moving.glb -o p.bin --no-plan > p.bin"}) {
    const std::vector<std::string> inputs = {"a.obj", "b.obj", "moving.glb"};
    std::vector<std::string> before;
    for (const std::string& name : inputs) before.push_back(test::read_whole(folder_ / name));
    const auto words = arguments.find(" >") == std::string::npos
                           ? arguments + " --force"
                           : std::string(arguments).insert(arguments.find(" >"), " --force");
    expect(run(words), 2, {"choose another name"});
    for (std::size_t i = 0; i < inputs.size(); ++i)
      EXPECT_EQ(test::read_whole(folder_ / inputs[i]), before[i]) << arguments;
  }
  // A bake may replace its own input: a new file with the complete content replaces the old file.
  EXPECT_EQ(run("bake moving.glb -o ./moving.glb --force -q").exit_code, 0);
  EXPECT_EQ(run("audit a.obj b.obj --errors /dev/null -o /dev/null").exit_code, 2);  // no extension of an archive
  EXPECT_EQ(run("audit a.obj b.obj --errors sub/new.npz -o new.npz").exit_code, 0);
}

// If nobody reads a pipe, messages to the pipe are lost and the exit code does not change. If data should go to the
// pipe, the program ends as other programs do when `head` reads only some of their lines.
TEST_F(HostileCli, a_reader_that_is_gone_ends_only_what_was_to_be_read) {
  folder_.write("a.obj", kFirst);
  folder_.write("b.obj", kSecond);
  const auto run_into_closed_pipe = [&](const std::string& arguments, const std::string& redirected) {
    return run_shell("exec 4>code; mkfifo -m 600 pipe; exec 3<>pipe 5>pipe; exec 3>&-; " + std::string(kProgram) + ' ' +
                         arguments + ' ' + redirected + "; echo $? >&4; rm pipe",
                     folder_.path());
  };
  const auto code = [&] { return test::read_whole(folder_ / "code"); };
  (void)run_into_closed_pipe("audit a.obj b.obj", "2>&5 >out.txt");
  EXPECT_EQ(code(), "0\n");
  (void)run_into_closed_pipe("audit a.obj b.obj --tolerance 0", "2>&5 >out.txt");
  EXPECT_EQ(code(), "4\n");
  (void)run_into_closed_pipe("audit a.obj missing.obj", "2>&5 >out.txt");
  EXPECT_EQ(code(), "1\n");
  (void)run_into_closed_pipe("audit a.obj b.obj --no-such", "2>&5 >out.txt");
  EXPECT_EQ(code(), "2\n");
  (void)run_into_closed_pipe("audit a.obj b.obj", ">&5 2>err.txt");
  EXPECT_EQ(code(), "141\n");
  EXPECT_EQ(test::read_whole(folder_ / "err.txt"), "");
}

// A library that is loaded into the process may set another rounding mode before the program starts. The output must
// not change.
TEST_F(HostileCli, the_rounding_mode_of_a_viewer_changes_no_byte) {
  if (std::string(kProgram).ends_with("_sanitized"))
    GTEST_SKIP() << "the layer would replace the malloc of a sanitizer";
  folder_.write("a.obj", kFirst);
  folder_.write("b.obj", kSecond);
  folder_.write("moving.glb", test::sparse_document().glb());
  for (const std::string arguments :
       {"audit a.obj b.obj --json", "audit moving.glb --json", "compare a.obj b.obj --json --no-times",
        "sample a.obj b.obj --times 0.3 -o -", "query cones a.obj b.obj --json",
        "bake moving.glb -o out.glb --force --encode exact --json", "report moving.glb -o out.bin --force --json"}) {
    const ProcessResult usual = run(arguments);
    for (const std::string mode : {"down", "up", "zero"}) {
      const ProcessResult other =
          run(arguments, "LD_PRELOAD=" + std::string(kFaultLayer) + " CHRONORMAL_ROUNDING=" + mode + " ");
      EXPECT_EQ(other.exit_code, 0) << arguments << ", " << mode;
      EXPECT_EQ(other.out, usual.out) << arguments << ", " << mode;
    }
  }
}

// Makes a GLB with mesh_count meshes, all of which share a grid of 3,600 vertices and its targets.
std::string grid_of_targets(int mesh_count, int target_count) {
  test::GltfBuilder builder;
  std::vector<float> positions, lift;
  std::vector<std::uint16_t> corners;
  constexpr std::uint16_t kSide = 60;
  for (std::uint16_t y = 0; y < kSide; ++y) {
    for (std::uint16_t x = 0; x < kSide; ++x) {
      positions.insert(positions.end(), {static_cast<float>(x), static_cast<float>(y), 0.0F});
      lift.insert(lift.end(), {0.0F, 0.0F, static_cast<float>(x * y % 7)});
      if (x == 0 || y == 0) continue;
      const int v = y * kSide + x;
      for (const int corner : {v, v - 1, v - kSide, v - 1, v - kSide - 1, v - kSide})
        corners.push_back(static_cast<std::uint16_t>(corner));
    }
  }
  const std::size_t base = builder.add_positions(positions), indices = builder.add_indices(corners);
  const std::size_t delta = builder.add_positions(lift);
  Json targets = Json::array();
  for (int k = 0; k < target_count; ++k) targets.push_back({{"POSITION", delta}});
  for (int m = 0; m < mesh_count; ++m)
    builder.add_node(
        builder.add_mesh({{"attributes", {{"POSITION", base}}}, {"indices", indices}, {"targets", targets}}));
  return builder.glb();
}

// The result of the command has a row for every face of every target, so a file of 127 kB would give a result of 455
// MB.
TEST_F(HostileCli, an_answer_for_every_face_of_many_targets_needs_max_expansion) {
  folder_.write("many.glb", grid_of_targets(1, 150));
  for (const std::string arguments :
       {"query cones many.glb", "query shutter many.glb -o s.npz", "query cones many.glb --json",
        "compare many.glb --schemes linear --errors e.npz"}) {
    expect(run(arguments), 3, {"of memory or output", "--max-expansion"});
  }
  EXPECT_EQ(run("query cones many.glb --max-expansion 10000").exit_code, 0);
}

// The table of errors of one mesh is small enough, but the tables of all meshes together are too large.
TEST_F(HostileCli, errors_of_many_meshes_need_max_expansion) {
  folder_.write("many.glb", grid_of_targets(60, 5));
  expect(run("audit many.glb --samples 9 --errors e.npz"), 3, {"the errors of every sample", "--max-expansion"});
  // --max-expansion 10000 permits the table. The run still fails, since the file has no normals that could be judged.
  expect(run("audit many.glb --samples 9 --errors e.npz --max-expansion 10000"), 3, {"nothing could be judged"});
}

TEST_F(HostileCli, a_file_of_the_kernel_is_read_unless_it_has_no_end) {
  expect(run("inspect /proc/self/mounts", "timeout 20 "), 3, {"mounts"});
  // Only root can open the log of the kernel, /proc/kmsg.
  if (::access("/proc/kmsg", R_OK) == 0) expect(run("inspect /proc/kmsg", "timeout 20 "), 1, {"kmsg", "never end"});
}

// The program runs on a stack of 256 kB, since it keeps large arrays on the heap.
TEST_F(HostileCli, a_small_stack_is_enough) {
  if (std::string(kProgram).ends_with("_sanitized")) GTEST_SKIP() << "a sanitizer needs more";
  folder_.write("a.obj", kFirst);
  folder_.write("b.obj", kSecond);
  folder_.write("moving.glb", test::sparse_document().glb());
  for (const std::string arguments :
       {"audit a.obj b.obj", "audit moving.glb --for all", "bake moving.glb -o out.glb", "bake a.obj b.obj -o s.glb",
        "report moving.glb -o out.bin", "compare a.obj b.obj", "query cones a.obj b.obj", "inspect moving.glb"}) {
    const ProcessResult result = run(arguments, "ulimit -s 256; ");
    EXPECT_EQ(result.exit_code, 0) << arguments << ": " << result.err;
  }
}

// The headers of the files promise up to a terabyte of data, but almost no data was written to the disk. Only p.ply and
// q.ply are as long as their headers say.
TEST_F(HostileCli, sparse_files_are_refused_at_once_and_whole) {
  folder_.write("mesh.obj", kFirst);
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\n";
  const auto binary = [](const std::string& vertices, const std::string& faces) {
    return "ply\nformat binary_little_endian 1.0\nelement vertex " + vertices +
           "\nproperty float x\nproperty float y\nproperty float z\nelement face " + faces +
           "\nproperty list uchar int vertex_indices\nend_header\n";
  };
  struct File {
    std::string name, begin, arguments;
  };
  const std::vector<File> files = {{"a.obj", "", "inspect a.obj"},
                                   {"b.obj", kFirst, "inspect b.obj"},
                                   {"c.ply", "", "inspect c.ply"},
                                   {"d.ply", header, "inspect d.ply"},
                                   {"e.ply", header + "end_header\n0 0 0\n1 0", "inspect e.ply"},
                                   {"f.gltf", "", "audit f.gltf"},
                                   {"g.gltf", R"({"asset":{"version":"2.0"},)", "audit g.gltf"},
                                   {"h.json", R"({"asset":")", "inspect h.json"},
                                   {"i.target", "", "inspect --base mesh.obj i.target"},
                                   {"j.target", "0 0 0 1\n", "inspect --base mesh.obj j.target"},
                                   {"k.glb", "glTF", "audit k.glb"},
                                   {"l.mdd", "", "inspect mesh.obj l.mdd"},
                                   {"m.pc2", "", "inspect mesh.obj m.pc2"},
                                   {"n.npz", "PK\3\4", "inspect n.npz"},
                                   {"o.mcx", "FOR4", "inspect mesh.obj o.mcx"},
                                   {"p.ply", binary("4000000000", "1"), "inspect p.ply"},
                                   {"q.ply", binary("3", "80000000000"), "inspect q.ply"}};
  for (const File& file : files) {
    folder_.write(file.name, file.begin);
    std::error_code error;
    std::filesystem::resize_file(folder_ / file.name, std::uintmax_t{1} << 40U, error);
    if (error) GTEST_SKIP() << "there are no sparse files here: " << error.message();
    const ProcessResult result = run(file.arguments, "ulimit -t 10; ");
    expect(result, 3, {file.name});
  }
}

}  // namespace
}  // namespace chronormal::hostile_cli_test
