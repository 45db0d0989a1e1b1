// Checks that the memory for baking and auditing a large file has a limit that follows from the size of the file.
#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>

#include "chronormal/core/parallel.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/bake.h"
#include "tests/support/child_process.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::bake_large_test {
namespace {

using test::TemporaryFolder;

void append_word(std::string& text, std::uint32_t value) {
  for (int shift = 0; shift < 32; shift += 8) text += static_cast<char>((value >> shift) & 0xFF);
}
void append_float(std::string& text, float value) { append_word(text, std::bit_cast<std::uint32_t>(value)); }

// A GLB file of a bumpy grid with normals. Each of four targets lifts a quarter of the grid, so all vertices move, and
// an animation drives all four targets.
class MorphingGrid {
 public:
  explicit MorphingGrid(std::uint32_t side) : side_(side), count_(side * side) {
    const std::size_t normals = write_base(), indices = begin();
    write_faces();
    end(6 * (side_ - 1) * (side_ - 1), R"("componentType":5125,"type":"SCALAR")");
    std::string targets;
    for (std::uint32_t k = 0; k < kTargets; ++k) {
      const std::size_t target = write_target(k);
      targets.append(k > 0 ? "," : "").append(R"({"POSITION":)").append(std::to_string(target)).append("}");
    }
    const std::size_t times = begin();
    for (const float time : {0.0F, 1.0F}) append_float(bin_, time);
    end(2, R"("componentType":5126,"type":"SCALAR","min":[0],"max":[1])");
    const std::size_t weights = begin();
    for (std::uint32_t i = 0; i < 2 * kTargets; ++i) append_float(bin_, i < kTargets ? 0.0F : 1.0F);
    end(2 * kTargets, R"("componentType":5126,"type":"SCALAR")");
    json_ = R"({"asset":{"version":"2.0"},"buffers":[{"byteLength":)" + std::to_string(bin_.size()) +
            R"(}],"bufferViews":[)" + views_ + R"(],"accessors":[)" + accessors_ +
            R"(],"meshes":[{"primitives":[{"attributes":{"POSITION":0,"NORMAL":)" + std::to_string(normals) +
            R"(},"indices":)" + std::to_string(indices) + R"(,"targets":[)" + targets +
            R"(]}]}],"nodes":[{"mesh":0}],"scenes":[{"nodes":[0]}],"animations":[{"samplers":[{"input":)" +
            std::to_string(times) + R"(,"output":)" + std::to_string(weights) +
            R"(}],"channels":[{"sampler":0,"target":{"node":0,"path":"weights"}}]}]})";
  }

  void write(const std::string& path) {
    while (json_.size() % 4 != 0) json_ += ' ';
    std::string head = "glTF";
    append_word(head, 2);
    append_word(head, static_cast<std::uint32_t>(28 + json_.size() + bin_.size()));
    append_word(head, static_cast<std::uint32_t>(json_.size()));
    head += "JSON" + json_;
    append_word(head, static_cast<std::uint32_t>(bin_.size()));
    head += std::string("BIN\0", 4);
    std::ofstream(path, std::ios::binary) << head << bin_;
  }

 private:
  static constexpr std::uint32_t kTargets = 4;

  [[nodiscard]] static float bump(std::uint32_t i) { return static_cast<float>(i * 7919 % 101) / 300; }

  std::size_t begin() {
    first_ = bin_.size();
    return next_;
  }
  void end(std::uint32_t count, const std::string& rest) {
    const char* const comma = next_ > 0 ? "," : "";
    views_.append(comma).append(R"({"buffer":0,"byteOffset":)").append(std::to_string(first_));
    views_.append(R"(,"byteLength":)").append(std::to_string(bin_.size() - first_)).append("}");
    accessors_.append(comma).append(R"({"bufferView":)").append(std::to_string(next_)).append(R"(,"count":)");
    accessors_.append(std::to_string(count)).append(",").append(rest).append("}");
    ++next_;
  }

  // Writes the positions and the normals of the base. Returns the accessor of the normals.
  std::size_t write_base() {
    const std::string vec3 = R"("componentType":5126,"type":"VEC3")", last = std::to_string(side_ - 1);
    for (std::uint32_t v = 0; v < count_; ++v) {
      append_float(bin_, static_cast<float>(v % side_));
      append_float(bin_, static_cast<float>(v / side_));
      append_float(bin_, bump(v));
    }
    end(count_, vec3 + R"(,"min":[0,0,0],"max":[)" + last + "," + last + ",1]");
    const std::size_t normals = begin();
    for (std::uint32_t v = 0; v < count_; ++v) {
      for (const float n : {0.0F, 0.0F, 1.0F}) append_float(bin_, n);
    }
    end(count_, vec3);
    return normals;
  }
  void write_faces() {
    for (std::uint32_t row = 0; row + 1 < side_; ++row) {
      for (std::uint32_t column = 0; column + 1 < side_; ++column) {
        const std::uint32_t a = row * side_ + column;
        for (const std::uint32_t index : {a, a + 1, a + side_, a + side_, a + 1, a + side_ + 1})
          append_word(bin_, index);
      }
    }
  }
  std::size_t write_target(std::uint32_t k) {
    const std::size_t target = begin();
    for (std::uint32_t v = 0; v < count_; ++v) {
      const bool moves = v / (count_ / kTargets + 1) == k;
      for (std::uint32_t c = 0; c < 3; ++c) append_float(bin_, moves ? bump(3 * v + c + 1) + 0.01F : 0.0F);
    }
    end(count_, R"("componentType":5126,"type":"VEC3","min":[0,0,0],"max":[1,1,1])");
    return target;
  }

  std::uint32_t side_, count_;
  std::string bin_, views_, accessors_, json_;
  std::size_t next_ = 0, first_ = 0;
};

std::string write_grid(const TemporaryFolder& folder, std::uint32_t side) {
  std::string path = folder / "grid.glb";
  MorphingGrid(side).write(path);
  return path;
}

constexpr unsigned kLimit = 600;      // in seconds, enough on a busy machine
constexpr std::uint32_t kSide = 600;  // 34.5 MB, much more than the program itself

TEST(BakeLarge, memory_of_exact_is_below_twice_the_file_where_all_of_it_morphs) {
  if (test::is_sanitized()) GTEST_SKIP() << "sanitizers take memory of their own";
  const TemporaryFolder folder;
  const std::string path = write_grid(folder, kSide), output = folder / "baked.glb";
  const std::string small = folder / "small.glb";
  MorphingGrid(8).write(small);
  const auto bake_file = [&](const std::string& input) -> std::string {
    const ThreadLimit one(1);
    const Result<GltfDocument> document = GltfDocument::open(input);
    if (!document) return document.error().text();
    GltfEdit edit(document.value());
    const Result<GltfBake> baked = bake(document.value(), {.encoding = BakeEncoding::kExact}, edit);
    if (!baked) return baked.error().text();
    if (const Status written = edit.write(output, true); !written) return written.error().text();
    return std::to_string(baked.value().added_targets) + " targets";
  };
  // Bakes a small file first, so that memory that every bake needs does not count for the large file.
  const test::ChildRun run = test::run_in_child(
      kLimit, [&] { return bake_file(path); }, [&] { (void)bake_file(small); });
  ASSERT_TRUE(run.finished) << run.text;
  EXPECT_EQ(run.text, "7 targets");  // four squares, and three products of quarters that overlap
  const std::size_t size = std::filesystem::file_size(path);
  EXPECT_GT(std::filesystem::file_size(output), size);
  EXPECT_LT(run.peak_growth, 2 * size);
  RecordProperty("per_cent_of_file", std::to_string(100 * run.peak_growth / size));
}

TEST(BakeLarge, an_audit_takes_memory_below_four_and_a_half_times_the_file) {
  if (test::is_sanitized()) GTEST_SKIP() << "sanitizers take memory of their own";
  const TemporaryFolder folder;
  const std::string path = write_grid(folder, kSide);
  const auto audit_it = [&]() -> std::string {
    const ThreadLimit one(1);
    const Result<GltfDocument> document = GltfDocument::open(path);
    if (!document) return document.error().text();
    const Result<Audit> found = audit(document.value(), {});
    if (!found) return found.error().text();
    return std::to_string(found.value().subjects.size()) + " subjects";
  };
  const test::ChildRun run = test::run_in_child(kLimit, audit_it);
  ASSERT_TRUE(run.finished) << run.text;
  EXPECT_EQ(run.text, "5 subjects");
  EXPECT_LT(2 * run.peak_growth, 9 * std::filesystem::file_size(path));
  RecordProperty("per_cent_of_file", std::to_string(100 * run.peak_growth / std::filesystem::file_size(path)));
}

}  // namespace
}  // namespace chronormal::bake_large_test
