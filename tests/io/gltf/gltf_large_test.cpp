// Checks that reading a part of a large file takes only the time and the memory that this part needs.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "io/gltf/gltf_motion.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::gltf_large_test {
namespace {

using test::TemporaryFolder;

void append_word(std::string& text, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>((value >> shift) & 0xFF);
}

// Writes a GLB of 180 MB with two meshes. The first mesh has 15 million vertices and does not morph; its data are a
// hole in the file, which takes no space on the disk. The second mesh is a grid of 64 x 64 vertices that morphs.
std::string write_large_glb(const TemporaryFolder& folder) {
  constexpr std::uint32_t kStill = 15'000'000, kSide = 64, kMoving = kSide * kSide;
  constexpr std::uint64_t kStillBytes = std::uint64_t{12} * kStill;
  std::string moving, indices;
  const auto append_float = [&](float value) { append_word(moving, std::bit_cast<std::uint32_t>(value)); };
  for (const float height : {0.0F, 1.0F}) {  // the height of the base, then that of the deltas
    for (std::uint32_t i = 0; i < kMoving; ++i) {
      append_float(height == 0 ? static_cast<float>(i % kSide) : 0);
      append_float(height == 0 ? static_cast<float>(i / kSide) : 0);
      append_float(height * static_cast<float>(i * 7 % 11));
    }
  }
  std::uint32_t index_count = 0;
  for (std::uint32_t row = 0; row + 1 < kSide; ++row) {
    for (std::uint32_t column = 0; column + 1 < kSide; ++column) {
      const std::uint32_t a = row * kSide + column;
      for (const std::uint32_t index : {a, a + 1, a + kSide, a + kSide, a + 1, a + kSide + 1}) {
        append_word(indices, index);
        ++index_count;
      }
    }
  }
  const auto number = [](std::uint64_t value) { return std::to_string(value); };
  const std::uint64_t delta_bytes = 12 * kMoving, bin_bytes = kStillBytes + moving.size() + indices.size();
  const auto view = [&](std::uint64_t offset, std::uint64_t length) {
    return R"({"buffer":0,"byteOffset":)" + number(offset) + R"(,"byteLength":)" + number(length) + "}";
  };
  const auto accessor = [&](int view_index, std::uint64_t count, const std::string& rest) {
    return R"({"bufferView":)" + std::to_string(view_index) + R"(,"count":)" + number(count) + "," + rest + "}";
  };
  const std::string vec3 = R"("componentType":5126,"type":"VEC3")", scalar = R"("componentType":5125,"type":"SCALAR")";
  std::string json =
      R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + number(bin_bytes) + R"(}],"bufferViews":[)" +
      view(0, kStillBytes) + "," + view(kStillBytes, delta_bytes) + "," + view(kStillBytes + delta_bytes, delta_bytes) +
      "," + view(kStillBytes + 2 * delta_bytes, indices.size()) + R"(],"accessors":[)" + accessor(0, kStill, vec3) +
      "," + accessor(1, kMoving, vec3) + "," + accessor(2, kMoving, vec3) + "," + accessor(3, index_count, scalar) +
      R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]},)"
      R"({"primitives":[{"attributes":{"POSITION":1},"indices":3,"targets":[{"POSITION":2}]}]}]})";
  while (json.size() % 4 != 0) json += ' ';

  std::string head = "glTF";
  append_word(head, 2);
  append_word(head, static_cast<std::uint32_t>(12 + 8 + json.size() + 8 + bin_bytes));
  append_word(head, static_cast<std::uint32_t>(json.size()));
  head += "JSON" + json;
  append_word(head, static_cast<std::uint32_t>(bin_bytes));
  head += std::string("BIN\0", 4);
  const std::string path = folder / "large.glb";
  std::ofstream file(path, std::ios::binary);
  file << head;
  file.seekp(static_cast<std::streamoff>(head.size() + kStillBytes));
  file << moving << indices;
  return path;
}
TEST(GltfLarge, memory_is_that_of_the_part_that_moves) {
  if (test::is_sanitized()) GTEST_SKIP() << "sanitizers take memory of their own";
  const TemporaryFolder folder;
  const std::string path = write_large_glb(folder);
  ASSERT_GT(std::filesystem::file_size(path), 180'000'000U);
  const auto read_moving = [&]() -> std::string {
    const Result<GltfDocument> document = GltfDocument::open(path);
    if (!document) return document.error().text();
    const Result<GltfMotion> motion = read_gltf_motion(document.value(), {});
    if (!motion) return motion.error().text();
    return std::to_string(motion.value().motion.topology.vertex_count()) + " vertices";
  };
  const test::ChildRun run = test::run_in_child(20, read_moving);
  ASSERT_TRUE(run.finished) << run.text;
  EXPECT_EQ(run.text, "4096 vertices");
  EXPECT_LT(run.peak_growth, std::size_t{8} << 20);
  RecordProperty("seconds", std::to_string(run.seconds));
}

TEST(GltfLarge, what_stands_still_is_read_when_it_is_asked_for) {
  if (test::is_sanitized()) GTEST_SKIP() << "sanitizers take memory of their own";
  const TemporaryFolder folder;
  const std::string path = write_large_glb(folder);
  const auto read_still = [&]() -> std::string {
    const Result<GltfDocument> document = GltfDocument::open(path);
    if (!document) return document.error().text();
    const Result<GltfGeometry> geometry = document.value().geometry(0, 0, {});
    if (!geometry) return geometry.error().text();
    return std::to_string(geometry.value().positions.size() / 3) + " vertices";
  };
  const test::ChildRun run = test::run_in_child(60, read_still);
  ASSERT_TRUE(run.finished) << run.text;
  EXPECT_EQ(run.text, "15000000 vertices");
  EXPECT_GT(run.peak_growth, std::size_t{180} << 20);  // this shows that the test above can see a whole file in memory
}

}  // namespace
}  // namespace chronormal::gltf_large_test
