// docs/rigs.md is what its generator writes; of files that are not here, the rows must be there.

#include <gtest/gtest.h>

#include <string>

#include "chronormal/workflow/hosts.h"
#include "tests/support/child_process.h"
#include "tests/support/generated_page.h"
#include "tests/support/process.h"

namespace chronormal::rigs_page_test {
namespace {

TEST(RigsPage, is_what_the_generator_writes_but_for_what_is_measured_in_files) {
  const test::TemporaryFolder folder;
  const ProcessResult result = run_shell(
      "env -u CHRONORMAL_DATA " + std::string(kBuildFolder) + "/tools/rigs/chronormal_rigs --partial .", folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto without_measured = [](const std::string& page) {
    return test::without_blocks(test::without_blocks(page, "capture").page, "files");
  };
  const auto committed = without_measured(test::read_whole((test::kDocs / "rigs.md").string()));
  const auto generated = without_measured(test::read_whole(folder / "rigs.md"));
  EXPECT_EQ(committed.count, 1U);
  EXPECT_EQ(generated.count, 1U);
  test::expect_same_text(committed.page, generated.page, "docs/rigs.md");
}

TEST(RigsPage, has_the_sizes_of_every_file_and_its_errors_as_it_is_and_baked_in_every_host) {
  const std::string files = test::without_blocks(test::read_whole((test::kDocs / "rigs.md").string()), "files").inside;
  for (const Host& host : kHosts)
    EXPECT_NE(files.find(" " + std::string(host.title) + " "), std::string::npos) << host.title;
  for (const std::string file : {"AnimatedMorphCube.gltf", "AnimatedMorphSphere.gltf", "MorphPrimitivesTest.gltf",
                                 "MorphStressTest.gltf", "RobotExpressive.glb", "01_cs_morph.gltf",
                                 "01_morphed_cube.gltf", "blender_suzanne_two_keys.glb", "ict_capture.glb"}) {
    std::size_t rows = 0;
    for (std::size_t at = 0; (at = files.find("| `" + file + "` ", at)) != std::string::npos; ++at) ++rows;
    EXPECT_EQ(rows, 3U) << file << ": its sizes, and two states";
  }
}

}  // namespace
}  // namespace chronormal::rigs_page_test
