// Reads files of other projects. The tests are skipped unless the environment variable CHRONORMAL_DATA names their
// folder.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "io/bytes/file.h"
#include "io/input/formats.h"
#include "tests/support/cpu_time.h"
#include "tests/support/read_input.h"

namespace chronormal::real_data_test {
namespace {

namespace fs = std::filesystem;

bool is_mesh(const fs::path& path) {
  const Format* const format = find_format(path.string());
  return format != nullptr && format->holds == Holds::kMesh;
}

class RealData : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("CHRONORMAL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
    data_ = folder;
  }

  [[nodiscard]] std::vector<fs::path> meshes_under(const std::string& folder) const {
    std::vector<fs::path> files;
    for (const fs::directory_entry& entry : fs::recursive_directory_iterator(data_ / folder)) {
      if (entry.is_regular_file() && is_mesh(entry.path())) files.push_back(entry.path());
    }
    EXPECT_FALSE(files.empty()) << data_ / folder;
    return files;
  }

  static Result<MeshFrame> read(const fs::path& path) {
    const Result<FileBytes> file = FileBytes::open(path.string());
    if (!file) return file.error();
    const std::string name = path.filename().string();
    return read_mesh(file.value().bytes(), name, name);
  }

  fs::path data_;
};

TEST_F(RealData, meshes_of_other_programs_are_read) {
  for (const char* const folder : {"sequences", "golden"}) {
    for (const fs::path& path : meshes_under(folder)) {
      const Result<MeshFrame> mesh = read(path);
      EXPECT_TRUE(mesh.ok()) << mesh.error().text();
    }
  }
}

TEST_F(RealData, sequences_of_other_programs_are_motions) {
  const Result<Motion> rumba = test::read_motion(test::files({(data_ / "sequences/rumba_13").string()}));
  ASSERT_TRUE(rumba.ok()) << rumba.error().text();
  EXPECT_EQ(rumba.value().topology.vertex_count(), 12811U);
  EXPECT_EQ(rumba.value().topology.face_count(), 25472U);
  EXPECT_EQ(rumba.value().keyframes.size(), 13U);
  const Result<Motion> cloth = test::read_motion(test::files({(data_ / "sequences/thick_cloth/*.ply").string()}));
  ASSERT_TRUE(cloth.ok()) << cloth.error().text();
  EXPECT_EQ(cloth.value().topology.vertex_count(), 233U);
  EXPECT_EQ(cloth.value().topology.face_count(), 404U);
}

TEST_F(RealData, hostile_files_are_meshes_or_clear_errors_within_a_second) {
  for (const fs::path& path : meshes_under("hostile")) {
    SCOPED_TRACE(path);
    const test::CpuClock clock;
    const Result<MeshFrame> mesh = read(path);
    EXPECT_LT(clock.seconds(), 1.0);
    if (!mesh) {
      EXPECT_EQ(mesh.error().code, ErrorCode::kInvalidInput);
      EXPECT_TRUE(mesh.error().place.starts_with(path.filename().string() + ", ")) << mesh.error().text();
      EXPECT_FALSE(mesh.error().message.empty());
    }
    if (std::getenv("CHRONORMAL_VERBOSE") != nullptr)
      std::printf("%-60s %s\n", path.lexically_relative(data_).c_str(), mesh ? "mesh" : mesh.error().text().c_str());
  }
}

TEST_F(RealData, files_that_break_the_ply_grammar_are_refused) {
  for (const fs::path& path : meshes_under("hostile/magnum_ply")) {
    const std::string name = path.filename().string();
    const bool is_good = name == "ascii.ply" || name == "crlf.ply";  // empty.ply is a valid PLY file, but has no faces
    EXPECT_EQ(read(path).ok(), is_good) << name;
  }
}

}  // namespace
}  // namespace chronormal::real_data_test
