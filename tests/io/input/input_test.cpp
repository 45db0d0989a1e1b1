#include "chronormal/io/input.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <fstream>
#include <map>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "chronormal/io/output.h"
#include "chronormal/motion/motion.h"
#include "tests/support/cache_bytes.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/random_mesh.h"
#include "tests/support/read_input.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::input_test {
namespace {

constexpr const char* kObj = "v 9 9 9\nv 8 8 8\nv 7 7 7\nf 1 2 3\n";

class OpenInput : public ::testing::Test {
 protected:
  OpenInput() {
    folder_.write("body.obj", kObj);
    folder_.write("walk.pc2", test::small_pc2(40, 2));
    folder_.write("walk.mdd", test::small_mdd(0, 0.5F));
    folder_.write("walk.npy",
                  test::npy(test::npy_header("<f4", "(2, 3, 3)"), test::raw(test::turning_elements<float>(false))));
    folder_.write("c.xml", test::maya_xml("OneFile", "mcx", 125, 250, 375));
    folder_.write("c.mcx", test::small_maya<double>(true));
    folder_.write("walk.npz", test::small_npz(true));
    folder_.write("imp.md2", test::small_md2());
    folder_.write("unnamed", test::small_npz(true));
  }
  [[nodiscard]] Result<Motion> read(const std::vector<std::string>& names, double frames_per_second = 1) const {
    std::vector<std::string> paths;
    for (const std::string& name : names) paths.push_back(folder_ / name);
    return test::read_motion(test::files(paths, frames_per_second));
  }
  void expect_turning(const std::vector<std::string>& names, double first, double second, double rate = 1) const {
    SCOPED_TRACE(names.front());
    const Result<Motion> motion = read(names, rate);
    ASSERT_TRUE(motion.ok()) << motion.error().text();
    EXPECT_TRUE(validate(motion.value()).ok());
    EXPECT_EQ(motion.value().topology, Topology::triangles(3, {0, 1, 2}).value());
    ASSERT_EQ(motion.value().keyframes.size(), 2U);
    EXPECT_EQ(motion.value().keyframes[0].time, first);
    EXPECT_EQ(motion.value().keyframes[1].time, second);
    EXPECT_EQ(motion.value().keyframes[0].positions, test::kTurning[0]);
    EXPECT_EQ(motion.value().keyframes[1].positions, test::kTurning[1]);
  }
  void expect_error(const std::vector<std::string>& names, ErrorCode code, const std::string& part) const {
    const Result<Motion> motion = read(names);
    ASSERT_FALSE(motion.ok()) << part;
    EXPECT_EQ(motion.error().code, code) << motion.error().text();
    EXPECT_NE(motion.error().text().find(part), std::string::npos) << motion.error().text();
  }

  test::TemporaryFolder folder_;
};

TEST_F(OpenInput, caches_over_a_mesh_are_read_in_either_order) {
  expect_turning({"body.obj", "walk.pc2"}, 40, 42);
  expect_turning({"walk.pc2", "body.obj"}, 20, 21, 2);
  expect_turning({"body.obj", "walk.mdd"}, 0, 0.5, 2);
  expect_turning({"body.obj", "walk.npy"}, 0, 0.5, 2);
  expect_turning({"body.obj", "c.xml"}, 250.0 / 6000, 375.0 / 6000);
  expect_turning({"c.xml#body", "body.obj"}, 250.0 / 6000, 375.0 / 6000);
  expect_turning({"body.obj", "c.mcx"}, 250.0 / 6000, 375.0 / 6000);
  expect_turning({"body.obj", "c.mcx#body"}, 250.0 / 6000, 375.0 / 6000);
  expect_turning({"b*.obj", "walk.pc2"}, 40, 42);
}

TEST_F(OpenInput, whole_motions_are_read_by_name_and_by_content) {
  expect_turning({"walk.npz"}, 0.5, 2, 7);
  expect_turning({"unnamed"}, 0.5, 2);
  const Result<Motion> imp = read({"imp.md2"}, 10);
  ASSERT_TRUE(imp.ok()) << imp.error().text();
  EXPECT_EQ(imp.value().keyframes[1].time, 0.1);
}

TEST_F(OpenInput, everything_else_is_a_sequence) {
  folder_.write("body2.obj", kObj);
  EXPECT_TRUE(read({"body.obj", "body2.obj"}).ok());
  EXPECT_TRUE(read({"body*.obj"}).ok());
  expect_error({"body.obj"}, ErrorCode::kInvalidInput, "a sequence needs at least two keyframes");
  expect_error({"none.obj", "body.obj"}, ErrorCode::kFailed, "none.obj");
}

TEST_F(OpenInput, inputs_that_do_not_go_together_are_misuse) {
  expect_error({"walk.pc2"}, ErrorCode::kUsage, "give it together with one mesh");
  expect_error({"walk.pc2", "walk.mdd"}, ErrorCode::kUsage, "give it together with one mesh");
  expect_error({"body.obj", "walk.pc2", "body.obj"}, ErrorCode::kUsage, "give it together with one mesh");
  expect_error({"body.obj", "walk.npz"}, ErrorCode::kUsage, "leave the others out");
  folder_.write("body2.obj", kObj);
  expect_error({"body*.obj", "walk.pc2"}, ErrorCode::kUsage, "this input names 2 files");
  EXPECT_EQ(read({"walk.npz"}, 0).error().code, ErrorCode::kUsage);
}

TEST_F(OpenInput, a_cache_over_a_mesh_has_no_animations) {
  InputOptions options = test::files({folder_ / "body.obj", folder_ / "walk.pc2"});
  options.animation = "walk";
  const Result<Motion> motion = test::read_motion(options);
  ASSERT_FALSE(motion.ok());
  EXPECT_EQ(motion.error().code, ErrorCode::kUsage);
  EXPECT_NE(motion.error().text().find("walk.pc2"), std::string::npos) << motion.error().text();
  EXPECT_NE(motion.error().text().find("animation"), std::string::npos) << motion.error().text();
}

TEST_F(OpenInput, errors_name_the_file) {
  folder_.write("small.obj", "v 0 0 0\nf 1 1 1\n");
  expect_error({"small.obj", "walk.pc2"}, ErrorCode::kInvalidInput,
               "walk.pc2: the cache has 3 vertices, but the mesh small.obj has 1");
  folder_.write("cut.mdd", test::small_mdd(0, 1).substr(0, 40));
  expect_error({"body.obj", "cut.mdd"}, ErrorCode::kInvalidInput, "cut.mdd, byte 8: ");
  folder_.write("twice.mdd", test::small_mdd(1, 1));
  expect_error({"body.obj", "twice.mdd"}, ErrorCode::kInvalidInput,
               "twice.mdd, sample 1: the time of this sample, 1 s, is not later");
  folder_.write("text", "hello");
  expect_error({"text"}, ErrorCode::kInvalidInput, "text: the file is not");
  expect_error({"body.obj", "none.mdd"}, ErrorCode::kFailed, "none.mdd");
  expect_error({"none.npz"}, ErrorCode::kFailed, "none.npz");
}

TEST_F(OpenInput, progress_counts_files) {
  std::vector<std::size_t> calls;
  const auto progress = [&](std::size_t done, std::size_t total) { calls.push_back(10 * done + total); };
  for (const std::vector<std::string>& names :
       {std::vector{folder_ / "body.obj", folder_ / "walk.mdd"}, std::vector{folder_ / "walk.npz"}}) {
    InputOptions options = test::files(names);
    options.progress = progress;
    ASSERT_TRUE(open_input(options).ok());
  }
  EXPECT_EQ(calls, (std::vector<std::size_t>{12, 22, 11}));
}

TEST_F(OpenInput, what_was_written_reads_back) {
  const Motion motion = test::turning_motion(3, 5);
  for (const char* const name : {"out.npz", "out.PC2", "out.mdd"})
    ASSERT_TRUE(write_motion(motion, folder_ / name, false).ok()) << name;
  expect_turning({"out.npz"}, 3, 5);
  expect_turning({"body.obj", "out.PC2"}, 3, 5);
  expect_turning({"body.obj", "out.mdd"}, 3, 5);
  ASSERT_TRUE(write_motion(motion, folder_ / "out_%d.ply", false).ok());
  expect_turning({"out_*.ply"}, 0, 1);
}

TEST_F(OpenInput, nothing_is_overwritten_without_force_or_left_after_an_error) {
  Motion motion = test::turning_motion(3, 5);
  const Status status = write_motion(motion, folder_ / "walk.npz", false);
  ASSERT_FALSE(status.ok());
  EXPECT_NE(status.error().message.find("--force"), std::string::npos);
  EXPECT_TRUE(write_motion(motion, folder_ / "walk.npz", true).ok());
  motion.connect_as_targets();
  const std::size_t entries = folder_.entry_count();
  const Status refused = write_motion(motion, folder_ / "new.mdd", false);
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
  EXPECT_EQ(refused.error().place, folder_ / "new.mdd");
  EXPECT_EQ(folder_.entry_count(), entries);
}

// A set of pipes into which threads write files. A pipe can be read only once: a second reader would wait forever, or
// find nothing.
class Pipes {
 public:
  explicit Pipes(const test::TemporaryFolder& folder) : folder_(folder) {}
  Pipes(const Pipes&) = delete;
  Pipes& operator=(const Pipes&) = delete;
  ~Pipes() {
    for (std::thread& writer : writers_) writer.join();
  }
  std::string add(const std::string& name, const std::string& bytes) {
    std::string path = folder_ / name;
    EXPECT_EQ(::mkfifo(path.c_str(), 0600), 0);
    writers_.emplace_back([path, bytes] { std::ofstream(path, std::ios::binary) << bytes; });
    return path;
  }

 private:
  const test::TemporaryFolder& folder_;
  std::vector<std::thread> writers_;
};

constexpr const char* kShaded = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\ns 1\nf 1//1 2//1 3//1\n";

TEST_F(OpenInput, every_file_is_opened_once_with_the_normals_that_it_stores) {
  Pipes pipes(folder_);
  InputOptions options = test::files({pipes.add("a.obj", kShaded), pipes.add("b.obj", kShaded)});
  options.shading = KeepShading::kAll;
  Result<Input> input = open_input(options);
  ASSERT_TRUE(input.ok()) << input.error().text();
  EXPECT_EQ(input.value().normals().value()->of_keyframes.size(), 2U);
  EXPECT_EQ(input.value().normals().value()->of_keyframes[1], (std::vector<float>{0, 0, 1, 0, 0, 1, 0, 0, 1}));
  EXPECT_EQ(input.value().group_of_face().size(), 1U);
  EXPECT_EQ(input.value().shaded_by(), folder_ / "a.obj");

  options = test::files({pipes.add("mesh.obj", kShaded), pipes.add("pipe.mdd", test::small_mdd(0, 1))});
  options.shading = KeepShading::kAll;
  Result<Input> cache = open_input(options);
  ASSERT_TRUE(cache.ok()) << cache.error().text();
  EXPECT_EQ(cache.value().normals().value()->of_keyframes.size(), 1U);

  options = test::targets_over(pipes.add("base.obj", kShaded), {pipes.add("smile.obj", kShaded)});
  options.shading = KeepShading::kAll;
  Result<Input> targets = open_input(options);
  ASSERT_TRUE(targets.ok()) << targets.error().text();
  EXPECT_EQ(targets.value().normals().value()->of_keyframes.size(), 1U);

  for (const auto& [name, bytes] : {std::pair{std::string("unnamed_npz"), test::small_npz(true)},
                                    {std::string("unnamed_glb"), test::quad_document().glb()}}) {
    Result<Input> whole = open_input(test::files({pipes.add(name, bytes)}));
    ASSERT_TRUE(whole.ok()) << whole.error().text();
    EXPECT_EQ(whole.value().document() != nullptr, name == "unnamed_glb");
    EXPECT_TRUE(whole.value().motion().ok());
  }
}

TEST_F(OpenInput, normals_count_as_far_as_every_keyframe_has_some) {
  folder_.write("s0.obj", kShaded);
  folder_.write("s1.obj", kObj);
  folder_.write("s2.obj", kShaded);
  const auto count = [&](const std::vector<std::string>& names, KeepShading keep) {
    InputOptions options = test::files({});
    for (const std::string& name : names) options.files.push_back(folder_ / name);
    options.shading = keep;
    Result<Input> input = open_input(options);
    return input ? input.value().normals().value()->of_keyframes.size() : 99;
  };
  EXPECT_EQ(count({"s0.obj", "s2.obj", "s0.obj"}, KeepShading::kAll), 3U);
  EXPECT_EQ(count({"s0.obj", "s1.obj", "s2.obj"}, KeepShading::kAll), 1U);
  EXPECT_EQ(count({"s1.obj", "s2.obj", "s0.obj"}, KeepShading::kAll), 0U);
  EXPECT_EQ(count({"s0.obj", "s2.obj", "s0.obj"}, KeepShading::kFirst), 1U);
  EXPECT_EQ(count({"s0.obj", "s2.obj", "s0.obj"}, KeepShading::kNone), 0U);
}

TEST_F(OpenInput, bytes_in_memory_give_the_same_as_paths) {
  const test::GltfBuilder builder = test::quad_document();
  folder_.write("quad.glb", builder.glb());
  auto split = builder.json;
  split["buffers"] = {{{"uri", "quad%20data.bin"}, {"byteLength", builder.buffer.size()}}};
  folder_.write("split.gltf", split.dump());
  folder_.write("quad data.bin", builder.buffer);
  folder_.write("body2.obj", kShaded);
  folder_.write("lift.target", "0 0 0 1\n");

  std::set<std::string> asked;
  std::map<std::string, std::string> memory;
  const auto resolve = [&](const std::string& name) -> Result<std::string_view> {
    asked.insert(name);
    const auto found = memory.try_emplace(name, test::read_whole(folder_ / name)).first;
    return std::string_view(found->second);
  };
  const auto expect_same = [&](const std::string& base, const std::vector<std::string>& names) {
    SCOPED_TRACE(names.front());
    InputOptions by_name = test::targets_over(base, names), by_path = by_name;
    by_name.resolve = resolve;
    if (!base.empty()) by_path.base = folder_ / base;
    for (std::string& file : by_path.files) file = folder_ / file;
    const Result<Motion> motion = test::read_motion(by_name), expected = test::read_motion(by_path);
    ASSERT_TRUE(motion.ok()) << motion.error().text();
    ASSERT_TRUE(expected.ok()) << expected.error().text();
    EXPECT_EQ(motion.value().kind, expected.value().kind);
    EXPECT_EQ(motion.value().topology, expected.value().topology);
    ASSERT_EQ(motion.value().keyframes.size(), expected.value().keyframes.size());
    for (std::size_t k = 0; k < motion.value().keyframes.size(); ++k) {
      EXPECT_EQ(motion.value().keyframes[k].positions, expected.value().keyframes[k].positions);
      EXPECT_EQ(motion.value().keyframes[k].time, expected.value().keyframes[k].time);
      EXPECT_EQ(motion.value().keyframes[k].name, expected.value().keyframes[k].name);
    }
  };
  expect_same("", {"body.obj", "body2.obj"});
  expect_same("", {"body.obj", "walk.pc2"});
  expect_same("", {"body.obj", "c.xml#body"});
  expect_same("", {"walk.npz"});
  expect_same("", {"quad.glb"});
  expect_same("", {"split.gltf"});
  expect_same("body.obj", {"body2.obj", "lift.target", "body.obj"});
  EXPECT_TRUE(asked.contains("quad data.bin"));
  EXPECT_TRUE(asked.contains("c.mcx"));

  InputOptions without = test::files({"split.gltf"});
  without.resolve = [&resolve](const std::string& name) -> Result<std::string_view> {
    if (name == "quad data.bin") return Error{ErrorCode::kFailed, name, "it is not in the archive"};
    return resolve(name);
  };
  const Result<Motion> lacking = test::read_motion(without);
  ASSERT_FALSE(lacking.ok());
  EXPECT_EQ(lacking.error().text(), "split.gltf, /buffers/0/uri: quad data.bin: it is not in the archive");

  InputOptions outside = test::files({"split.gltf"});
  outside.resolve = resolve;
  memory["split.gltf"].replace(memory["split.gltf"].find("quad%20"), 7, "../quad%20");
  const Result<Motion> refused = test::read_motion(outside);
  ASSERT_FALSE(refused.ok());
  EXPECT_NE(refused.error().text().find("leads out of the folder"), std::string::npos) << refused.error().text();
}

TEST_F(OpenInput, motions_say_what_they_are_and_npz_keeps_it) {
  EXPECT_EQ(read({"body.obj", "walk.pc2"}).value().kind, MotionKind::kSequence);
  EXPECT_EQ(read({"walk.npz"}).value().kind, MotionKind::kSequence);
  folder_.write("quad.glb", test::quad_document().glb());
  EXPECT_EQ(read({"quad.glb"}).value().kind, MotionKind::kTargets);
  folder_.write("body2.obj", kShaded);

  // A base and one target have the kind kTargets, and are not a sequence of two keyframes.
  const Motion one = test::read_motion(test::targets_over(folder_ / "body.obj", {folder_ / "body2.obj"})).value();
  EXPECT_EQ(one.kind, MotionKind::kTargets);
  ASSERT_TRUE(write_motion(one, folder_ / "one.npz", false).ok());
  const Motion back = read({"one.npz"}).value();
  EXPECT_EQ(back.kind, MotionKind::kTargets);
  EXPECT_EQ(back.keyframes[1].positions, one.keyframes[1].positions);
  EXPECT_EQ(back.keyframes[1].name, "target 0");
  for (const char* const name : {"one.pc2", "one.mdd"}) {
    const Status refused = write_motion(one, folder_ / name, false);
    ASSERT_FALSE(refused.ok());
    EXPECT_EQ(refused.error().code, ErrorCode::kUsage);
    EXPECT_NE(refused.error().message.find(".npz"), std::string::npos) << refused.error().message;
  }

  // An animation that jumps at t = 1 s keeps this jump when it is written to a file and read again.
  Motion jumps = read({"body.obj", "walk.pc2"}).value();
  jumps.keyframes.insert(jumps.keyframes.end(), {jumps.keyframes[0], jumps.keyframes[1]});
  for (std::size_t k = 0; k < 4; ++k) jumps.keyframes[k].time = std::vector<double>{0, 1, 1, 2}[k];
  jumps.connect(MotionKind::kAnimation);
  ASSERT_EQ(jumps.segments.size(), 2U);
  ASSERT_TRUE(write_motion(jumps, folder_ / "jumps.npz", false).ok());
  const Motion same = read({"jumps.npz"}).value();
  EXPECT_EQ(same.kind, MotionKind::kAnimation);
  ASSERT_EQ(same.segments.size(), 2U);
  EXPECT_EQ(same.segments[1].from, 2U);
  EXPECT_FALSE(write_motion(jumps, folder_ / "jumps.mdd", false).ok());
}

TEST_F(OpenInput, targets_have_every_name_that_a_mesh_gives_them) {
  test::GltfBuilder builder = test::quad_document();
  builder.json["meshes"].push_back(builder.json["meshes"][0]);
  builder.json["meshes"][0]["extras"]["targetNames"] = {"smile", "blink"};
  builder.json["meshes"][1]["extras"]["targetNames"] = {"smile", "smile"};
  folder_.write("two.glb", builder.glb());
  Result<Input> input = open_input(test::files({folder_ / "two.glb"}));
  ASSERT_TRUE(input.ok()) << input.error().text();
  const TargetNames names = target_names(input.value()).value();
  EXPECT_EQ(names, (TargetNames{{"smile"}, {"blink", "smile"}}));
  EXPECT_EQ(find_target(names, "blink").value(), 1U);
  EXPECT_EQ(find_target(names, "0").value(), 0U);
  EXPECT_EQ(find_target(names, "smile").error().message,
            "targets 0 and 1 all have the name 'smile'; give the number of the target instead");
  EXPECT_EQ(target_label(names, 1), "1 (blink)");
  Result<Input> sequence = open_input(test::files({folder_ / "walk.npz"}));
  EXPECT_TRUE(target_names(sequence.value()).value().empty());
}

TEST_F(OpenInput, keyframes_are_handed_out_by_number) {
  Result<Input> input = open_input(test::files({folder_ / "walk.npz"}));
  ASSERT_TRUE(input.ok());
  ASSERT_EQ(input.value().keyframe_count().value(), 2U);
  EXPECT_EQ(input.value().keyframe(1).value()->positions, test::kTurning[1]);
  EXPECT_EQ(input.value().keyframe(0).value()->positions, test::kTurning[0]);
  EXPECT_EQ(input.value().name(), folder_ / "walk.npz");
}

}  // namespace
}  // namespace chronormal::input_test
