// Tests `--shard` and `merge`: results computed in shards on several machines and then merged must equal the result of
// one machine. Also tests how --from, --to and --every choose keyframes.
#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::merge_cli_test {
namespace {

class Merge : public testing::Test {
 protected:
  // Writes six keyframes of a strip of two triangles that folds.
  Merge() {
    for (int k = 0; k < 6; ++k) {
      const std::string height = std::to_string(0.1 * k * k);
      folder_.write("w_" + std::to_string(k) + ".obj",
                    "v 0 0 0\nv 1 0 0\nv 0 1 " + height + "\nv 1 1 0." + std::to_string(k) + "\nf 1 2 3\nf 2 4 3\n");
    }
  }
  [[nodiscard]] ProcessResult run(const std::string& arguments) const {
    return run_shell(std::string(kProgram) + " " + arguments, folder_.path());
  }
  [[nodiscard]] std::string file(const std::string& name) const { return test::read_whole(folder_ / name); }

  test::TemporaryFolder folder_;
};

TEST_F(Merge, parts_of_every_command_give_the_bytes_of_one_run) {
  const std::string compare = "compare 'w_*.obj' --elements vertices ", audit = "audit 'w_*.obj' --rule slerp ";
  const std::string sample = "sample 'w_*.obj' --times 0:0.125:5 ";
  for (const std::string shard : {"1/3", "2/3", "3/3"}) {
    const std::string take = " --shard " + shard + " -o ", name = shard.substr(0, 1);
    ASSERT_EQ(run(compare + take + "compare" + name + ".json").exit_code, 0);
    ASSERT_EQ(run(audit + "--tolerance 1" + take + "audit" + name + ".json").exit_code, 0);
    ASSERT_EQ(run(sample + take + "sample" + name + ".npy").exit_code, 0);
    ASSERT_EQ(run(sample + take + "part_%02d.ply").exit_code, 0);
  }
  ASSERT_EQ(run(compare + "--json --no-times -o one.json").exit_code, 0);
  EXPECT_EQ(run("merge compare3.json compare1.json compare2.json").out, file("one.json"));
  ASSERT_EQ(run(audit + "--json --tolerance 1 -o one_audit.json").exit_code, 4);
  const ProcessResult merged = run("merge audit1.json audit2.json audit3.json");
  EXPECT_EQ(merged.out, file("one_audit.json"));
  EXPECT_EQ(merged.exit_code, 4);
  EXPECT_NE(merged.err.find(
                "the result is not within the --tolerance with which the shards were made; its JSON has the errors"),
            std::string::npos);
  ASSERT_EQ(run(sample + "-o one.npy").exit_code, 0);
  // The command `merge` recognises the format of a shard by its content, not by its name.
  std::filesystem::rename(folder_ / "sample2.npy", folder_ / "sample2.part");
  ASSERT_EQ(run("merge sample3.npy sample1.npy sample2.part -o merged.npy").exit_code, 0);
  EXPECT_TRUE(file("merged.npy") == file("one.npy"));
  ASSERT_EQ(run(sample + "-o one_%02d.ply").exit_code, 0);
  EXPECT_TRUE(file("part_39.ply") == file("one_39.ply"));
  EXPECT_EQ(run("merge compare1.json compare2.json").exit_code, 2);
  ASSERT_EQ(run(audit + "--tolerance 2 --shard 3/3 -o other.json").exit_code, 0);
  const ProcessResult mixed = run("merge audit1.json audit2.json other.json");
  EXPECT_EQ(mixed.exit_code, 2);
  EXPECT_NE(mixed.err.find("other.json: this shard does not belong to audit1.json, since they differ in the tolerance"),
            std::string::npos)
      << mixed.err;
  EXPECT_EQ(run("merge sample1.npy sample3.npy -o x.npy").exit_code, 2);
  EXPECT_EQ(run("merge compare1.json w_0.obj").exit_code, 3);
  EXPECT_EQ(run("merge sample1.npy gone.npy -o x.npy").exit_code, 1);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.npy"));
}

// `merge` must refuse shards of two different inputs. First, the two inputs have the same names, sizes and times but
// different content. Then, one frame of an input changes between two shards.
TEST_F(Merge, parts_of_two_inputs_are_refused_with_the_names_of_both) {
  const std::string changed = "v 0 0 0\nv 1 0 0\nv 0 1 0.5\nv 1 1 0.25\nf 1 2 3\nf 2 4 3\n";
  const std::string before = file("w_3.obj");
  for (const std::string command :
       {"compare 'w_*.obj'", "compare 'w_*.obj' --elements vertices", "audit 'w_*.obj'",
        "sample 'w_*.obj' --times 0:0.5:5", "sample 'w_*.obj' --times 0.5,4.5 --elements faces"}) {
    const bool is_array = command.starts_with("sample");
    const std::string one = is_array ? "1.npy" : "1.json", two = is_array ? "2.npy" : "2.json";
    ASSERT_EQ(run(command + " --shard 1/2 --force -o " + one).exit_code, 0);
    folder_.write("w_3.obj", changed);
    ASSERT_EQ(run(command + " --shard 2/2 --force -o " + two).exit_code, 0);
    folder_.write("w_3.obj", before);
    const ProcessResult merged = run("merge " + one + " " + two + " -o merged");
    EXPECT_EQ(merged.exit_code, 2) << command;
    const std::string message = two + ": this shard does not belong to " + one + ", since they differ in keyframe 3";
    EXPECT_NE(merged.err.find(message), std::string::npos) << command << '\n' << merged.err;
    EXPECT_FALSE(std::filesystem::exists(folder_ / "merged"));
  }
}

TEST_F(Merge, shards_are_refused_where_they_divide_nothing) {
  ASSERT_EQ(run("bake 'w_*.obj' -o m.glb").exit_code, 0);
  for (const char* const arguments :
       {"compare 'w_*.obj' --shard 0/3", "compare 'w_*.obj' --shard 4/3", "compare 'w_*.obj' --shard 3",
        "compare 'w_*.obj' --shard 1/2x", "compare --each w_0.obj --shard 1/2",
        "compare 'w_*.obj' --shard 1/2 --errors e.npz", "compare 'w_*.obj' --truth 2 --shard 1/2",
        "audit 'w_*.obj' --shard 1/2 --errors e.npz", "audit --base w_0.obj w_1.obj --shard 1/2",
        "sample 'w_*.obj' --times 1 --shard 1/2 -o n.npz", "compare 'w_*.obj' --shard 1/2 --json",
        "compare 'w_*.obj' --shard 1/2 --csv", "audit 'w_*.obj' --shard 1/2 --json", "audit m.glb --shard 1/2",
        "merge"}) {
    const ProcessResult result = run(arguments);
    EXPECT_EQ(result.exit_code, 2) << arguments << '\n' << result.err;
    EXPECT_TRUE(result.out.empty()) << arguments;
  }
}

TEST_F(Merge, copies_that_know_nothing_of_each_other_do_not_all_do_the_same_work) {
  if (run("--version").out.find("with MPI") != std::string::npos) GTEST_SKIP() << "ranks know of each other";
  const auto run_copy = [&](const std::string& arguments) {
    return run_shell("OMPI_COMM_WORLD_SIZE=3 " + std::string(kProgram) + " " + arguments, folder_.path());
  };
  for (const char* const command : {"compare 'w_*.obj'", "audit 'w_*.obj'", "sample 'w_*.obj' --times 1 -o x.npy"}) {
    const ProcessResult result = run_copy(command);
    EXPECT_EQ(result.exit_code, 2) << command;
    EXPECT_NE(result.err.find("mpirun has started 3 copies of a program without MPI"), std::string::npos) << result.err;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "x.npy"));
  EXPECT_EQ(run_copy("sample 'w_*.obj' --times 1,2,3 --shard 2/3 -o x.npy").exit_code, 0);
  EXPECT_EQ(run_copy("convert 'w_*.obj' -o x.pc2").exit_code, 0);
}

TEST_F(Merge, chosen_keyframes_are_those_of_the_files_named_one_by_one) {
  ASSERT_EQ(run("convert 'w_*.obj' --from 1 --to 5 --every 2 -o chosen.npz").exit_code, 0);
  ASSERT_EQ(run("sample 'w_*.obj' --from 1 --to 5 --every 2 --times keys -o chosen.npy").exit_code, 0);
  ASSERT_EQ(run("sample w_1.obj w_3.obj w_5.obj --times 0,1,2 -o named.npy").exit_code, 0);
  EXPECT_TRUE(file("chosen.npy") == file("named.npy"));
  EXPECT_NE(run("sample chosen.npz --times 0.5 -o x.npy").err.find("from 1 to 5"), std::string::npos);
  EXPECT_EQ(run("inspect 'w_*.obj' --from 6").exit_code, 2);
  EXPECT_EQ(run("audit --sample bumps --every 2").exit_code, 2);
}

}  // namespace
}  // namespace chronormal::merge_cli_test
