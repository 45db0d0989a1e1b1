// docs/hosts.md is what its generator writes; of files that are not here, the rows must be there.

#include <gtest/gtest.h>

#include <string>

#include "chronormal/workflow/hosts.h"
#include "tests/support/child_process.h"
#include "tests/support/generated_page.h"
#include "tests/support/process.h"

namespace chronormal::hosts_page_test {
namespace {

TEST(HostsPage, is_what_the_generator_writes_but_for_what_is_measured_in_files) {
  const test::TemporaryFolder folder;
  const ProcessResult result =
      run_shell("env -u CHRONORMAL_DATA " + std::string(kBuildFolder) + "/tools/hosts/chronormal_hosts --partial .",
                folder.path());
  ASSERT_EQ(result.exit_code, 0) << result.err;
  const auto committed = test::without_blocks(test::read_whole((test::kDocs / "hosts.md").string()), "files");
  const auto generated = test::without_blocks(test::read_whole(folder / "hosts.md"), "files");
  EXPECT_EQ(committed.count, 1U);
  EXPECT_EQ(generated.count, 1U);
  test::expect_same_text(committed.page, generated.page, "docs/hosts.md");
}

TEST(HostsPage, has_a_row_for_every_file_as_it_is_and_baked_and_a_column_for_every_host) {
  const std::string files = test::without_blocks(test::read_whole((test::kDocs / "hosts.md").string()), "files").inside;
  for (const Host& host : kHosts)
    EXPECT_NE(files.find(" " + std::string(host.title) + " |"), std::string::npos) << host.title;
  for (const std::string file :
       {"AnimatedMorphCube.gltf", "AnimatedMorphSphere.gltf", "MorphPrimitivesTest.gltf", "MorphStressTest.gltf",
        "RobotExpressive.glb", "01_cs_morph.gltf", "01_morphed_cube.gltf", "blender_suzanne_two_keys.glb"}) {
    std::size_t rows = 0;
    for (std::size_t at = 0; (at = files.find("| `" + file + "` ", at)) != std::string::npos; ++at) ++rows;
    EXPECT_EQ(rows, 12U) << file << ": four states in three tables";
  }
}

}  // namespace
}  // namespace chronormal::hosts_page_test
