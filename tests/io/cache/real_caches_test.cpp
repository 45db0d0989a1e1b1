// Reads caches and models from other projects. The tests are skipped unless the environment variable CHRONORMAL_DATA
// names the folder of these files.
#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "io/bytes/file.h"
#include "io/cache/maya_cache.h"
#include "io/cache/pc2.h"
#include "io/mesh/obj.h"
#include "tests/support/cpu_time.h"
#include "tests/support/read_input.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::real_caches_test {
namespace {

namespace fs = std::filesystem;

class RealCaches : public ::testing::Test {
 protected:
  void SetUp() override {
    const char* const folder = std::getenv("CHRONORMAL_DATA");
    if (folder == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
    data_ = folder;
  }

  // Reads the Maya cache in a folder as a motion, together with a mesh that has one triangle and as many points as the
  // cache. Compares the number of samples, and the first and last time, with the expected values.
  void expect_maya(const std::string& folder, std::size_t samples, double first, double last) const {
    SCOPED_TRACE(folder);
    std::string obj;
    for (int v = 0; v < 36; ++v) obj += "v 0 0 0\n";
    const test::TemporaryFolder temporary;
    const std::string mesh = temporary.write("mesh.obj", obj + "f 1 2 3\n");
    const std::string xml = (data_ / "caches" / folder / "cache.xml").string();
    const Result<Motion> ambiguous = test::read_motion(test::files({mesh, xml}));
    ASSERT_FALSE(ambiguous.ok());  // both channels have 36 points, so the reader cannot choose one
    EXPECT_NE(ambiguous.error().message.find("'pCubeShape1' (36), 'pCubeShape2' (36)"), std::string::npos);
    for (const char* const channel : {"#pCubeShape1", "#pCubeShape2"}) {
      const Result<Motion> motion = test::read_motion(test::files({mesh, xml + channel}));
      ASSERT_TRUE(motion.ok()) << motion.error().text();
      EXPECT_EQ(motion.value().keyframes.size(), samples);
      EXPECT_NEAR(motion.value().keyframes.front().time, first / 24, 1e-15);
      EXPECT_NEAR(motion.value().keyframes.back().time, last / 24, 1e-15);
    }
  }

  fs::path data_;
};

TEST_F(RealCaches, maya_caches_of_every_kind_are_read) {
  expect_maya("sine_mxsf_regular", 30, 1, 30);
  expect_maya("sine_mcsd_oversample", 59, 1, 30);
  expect_maya("sine_mcmf_undersample", 15, 1, 29);
  expect_maya("sine_mxmd_oversample", 34, 10, 19.9);
}

// Four caches store one animation in different ways. Their samples at frame 11 must be equal.
TEST_F(RealCaches, maya_caches_of_one_animation_agree) {
  const auto at_frame_11 = [&](const std::string& folder) -> std::vector<float> {
    const auto cache = read_maya_cache((data_ / "caches" / folder / "cache.xml").string(), {1, 0, "pCubeShape1"});
    EXPECT_TRUE(cache.ok());
    for (const auto& sample : cache.value().samples) {
      if (sample.time == 13.0 / 24) return sample.positions;
    }
    return {};
  };
  const std::vector<float> expected = at_frame_11("sine_mxsf_regular");
  ASSERT_EQ(expected.size(), 108U);
  for (const char* const folder : {"sine_mcsd_oversample", "sine_mcmf_undersample", "sine_mxmd_oversample"}) {
    const std::vector<float> positions = at_frame_11(folder);
    ASSERT_EQ(positions.size(), expected.size()) << folder;
    for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(positions[i], expected[i], 1e-6) << folder;
  }
}

TEST_F(RealCaches, maya_description_full_of_entities_is_read_and_its_missing_frames_are_named) {
  const fs::path folder = data_ / "caches/sine_xml_parse";
  const Result<PositionCache> cache = read_maya_cache((folder / "cache.xml").string(), {1, 0, "pCubeShape1"});
  ASSERT_FALSE(cache.ok());
  EXPECT_EQ(cache.error().text(),
            "cache.xml: the sample at tick 500 is missing in the cache; copy its file into the folder of the .xml "
            "file; its name should be cacheFrame2.mc");
  const Result<FileBytes> xml = FileBytes::open((folder / "cache.xml").string());
  const Result<MayaCacheDescription> description = read_maya_description(xml.value().bytes(), "cache.xml");
  ASSERT_TRUE(description.ok()) << description.error().text();
  ASSERT_EQ(description.value().channels.size(), 2U);
  EXPECT_EQ(description.value().channels[0].interpretation, "<![CDATA[<positions>]]>");
  const Result<FileBytes> points = FileBytes::open((folder / "cacheFrame1.mc").string());
  EXPECT_TRUE(read_maya_points(points.value().bytes(), "cacheFrame1.mc", {1, 36, "pCubeShape2"}).ok());
}

// Sample 4 of the cache has the positions of the mesh, except that the vertices are in another order and translated.
TEST_F(RealCaches, pc2_of_3ds_max_is_read_and_fits_its_mesh_through_the_permutation) {
  const fs::path folder = data_ / "caches/max_cache_box";
  const Result<FileBytes> file = FileBytes::open((folder / "max_cache_box.pc2").string());
  const Result<PositionCache> cache = read_pc2(file.value().bytes(), "max_cache_box.pc2");
  ASSERT_TRUE(cache.ok()) << cache.error().text();
  EXPECT_EQ(cache.value().vertex_count, 770U);
  ASSERT_EQ(cache.value().samples.size(), 11U);
  for (std::size_t k = 0; k < 11; ++k) EXPECT_EQ(cache.value().samples[k].time, 40.0 + static_cast<double>(k));

  const Result<FileBytes> obj = FileBytes::open((folder / "max_cache_box_44.obj").string());
  const Result<MeshFrame> mesh = read_obj(obj.value().bytes(), "max_cache_box_44.obj");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  std::ifstream permutation(folder / "obj_vertex_to_pc2_point.txt");
  const std::vector<float>& sample = cache.value().samples[4].positions;
  const double translation[3] = {0, -0.0017, 10};
  double worst_sum = 0, worst_difference = 0;
  for (std::size_t v = 0; v < 770; ++v) {
    std::size_t point = 770;
    permutation >> point;
    ASSERT_LT(point, 770U);
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double a = mesh.value().positions[3 * v + axis], b = sample[3 * point + axis];
      worst_sum = std::max(worst_sum, std::abs(a - b - translation[axis]));
      worst_difference = std::max(worst_difference, std::abs(b - a - translation[axis]));
    }
  }
  EXPECT_LT(std::min(worst_sum, worst_difference), 2e-4) << worst_sum << " " << worst_difference;

  const Result<Motion> motion = test::read_motion(
      test::files({(folder / "max_cache_box.pc2").string(), (folder / "max_cache_box_44.obj").string()}));
  EXPECT_TRUE(motion.ok()) << motion.error().text();
}

TEST_F(RealCaches, md2_model_is_read_and_its_faces_point_outwards) {
  const Result<Motion> result = test::read_motion(test::files({(data_ / "sequences/md2_faerie/faerie.md2").string()}));
  ASSERT_TRUE(result.ok()) << result.error().text();
  const Motion& motion = result.value();
  EXPECT_EQ(motion.topology.vertex_count(), 366U);
  EXPECT_EQ(motion.topology.face_count(), 654U);
  ASSERT_EQ(motion.keyframes.size(), 198U);
  double volume = 0;  // six times the signed volume
  const std::vector<float>& p = motion.keyframes[0].positions;
  for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
    const auto face = motion.topology.face(f);
    const auto at = [&](std::size_t c) { return Vec3<double>{p[3 * face[c]], p[3 * face[c] + 1], p[3 * face[c] + 2]}; };
    volume += dot(at(0), cross(at(1), at(2)));
  }
  EXPECT_GT(volume, 0);
}

TEST_F(RealCaches, hostile_maya_files_are_caches_or_clear_errors_within_a_second) {
  std::size_t files = 0, caches = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(data_ / "hostile/ufbx_mcx_fuzz")) {
    SCOPED_TRACE(entry.path());
    ++files;
    const std::string name = entry.path().filename().string();
    const Result<FileBytes> file = FileBytes::open(entry.path().string());
    ASSERT_TRUE(file.ok());
    const test::CpuClock clock;
    const Result<PositionCache> cache = read_maya_points(file.value().bytes(), name);
    EXPECT_LT(clock.seconds(), 1.0);
    caches += cache.ok() ? 1U : 0U;
    if (!cache) {
      EXPECT_EQ(cache.error().code, ErrorCode::kInvalidInput);
      EXPECT_TRUE(cache.error().place.starts_with(name + ", ")) << cache.error().text();
      EXPECT_FALSE(cache.error().message.empty());
    }
    if (std::getenv("CHRONORMAL_VERBOSE") != nullptr)
      std::printf("%-20s %s\n", name.c_str(), cache ? "cache" : cache.error().text().c_str());
  }
  EXPECT_EQ(files, 100U);
  std::printf("%zu of %zu hostile files are caches\n", caches, files);
}

}  // namespace
}  // namespace chronormal::real_caches_test
