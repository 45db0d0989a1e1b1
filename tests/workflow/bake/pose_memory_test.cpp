// Checks that a PoseMemory keeps the first poses for which it has room, and that normals do not depend on how often or
// in which order poses are requested.

#include "workflow/bake/poses/pose_memory.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/blocks.h"
#include "tests/support/bake_fixture.h"
#include "workflow/bake/deltas/terms.h"

namespace chronormal::pose_memory_test {
namespace {

using Pose = std::vector<double>;

std::vector<Vec3d> vectors_of(double seed) { return {{seed, 1, 2}, {3, seed, 4}}; }

TEST(PoseMemory, has_what_was_kept_first_and_nothing_else) {
  PoseMemory memory(1 << 20);
  EXPECT_EQ(memory.find(Pose{0.5, 1}), nullptr);
  memory.keep(Pose{0.5, 1}, vectors_of(7));
  const std::vector<Vec3d>* const kept = memory.find(Pose{0.5, 1});
  ASSERT_NE(kept, nullptr);
  for (int i = 0; i < 1000; ++i) memory.keep(Pose{0.001 * i, 1}, vectors_of(i));
  EXPECT_EQ(memory.find(Pose{0.5, 1}), kept);
  EXPECT_EQ(*kept, vectors_of(7));
  EXPECT_EQ(*memory.find(Pose{0.25, 1}), vectors_of(250));
  for (const Pose& other : {Pose{0.5, 2}, Pose{1, 0.5}, Pose{0.5}, Pose{0.5, 1, 0}, Pose{}})
    EXPECT_EQ(memory.find(other), nullptr);
}

TEST(PoseMemory, takes_no_more_than_it_may) {
  constexpr std::size_t kEach = 2 * sizeof(Vec3d) + 2 * sizeof(double);
  PoseMemory memory(3 * kEach + 1);
  for (int i = 0; i < 10; ++i) {
    memory.keep(Pose{0, 1.0 * i}, vectors_of(i));
    memory.keep(Pose{0, 0}, vectors_of(i));  // takes no additional memory, since this pose is kept already
  }
  for (int i = 0; i < 10; ++i) EXPECT_EQ(memory.find(Pose{0, 1.0 * i}) != nullptr, i < 3) << i;
  PoseMemory none(0);
  none.keep(Pose{1}, vectors_of(1));
  EXPECT_EQ(none.find(Pose{1}), nullptr);
}

TEST(PoseMemory, is_used_by_many_threads_at_once) {
  PoseMemory memory(1 << 20);
  std::atomic<std::size_t> wrong = 0;
  parallel_each(5000, 8, [&](std::size_t i) {
    const double number = static_cast<double>(i % 100);
    if (const std::vector<Vec3d>* kept = memory.find(Pose{number})) wrong += *kept == vectors_of(number) ? 0U : 1U;
    memory.keep(Pose{number}, vectors_of(number));
  });
  EXPECT_EQ(wrong, 0U);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(*memory.find(Pose{1.0 * i}), vectors_of(i));
}

TEST(PoseMemory, leaves_the_normals_of_poses_as_they_are) {
  constexpr std::size_t kTargets = 3;
  const test::GltfFixture file(test::still_hills_document(kTargets, 7));
  const GltfShading shading = read_gltf_shading(*file, 0).value();
  const AuthorTruth truth(shading, Weighting::kAngle);
  const NormalTerms terms(shading, truth);
  ASSERT_TRUE(terms.is_fitted());
  std::vector<std::uint32_t> all(shading.groups.size());
  std::iota(all.begin(), all.end(), 0U);
  const std::vector<std::uint32_t> few(all.begin() + 3, all.begin() + 5);
  std::vector<Pose> poses = {{0, 0, 0}, {1, 1, 1}, {1, 0, 0}, {0, 1, 0}, {0.5, 0.25, 1}, {1, 0.25, 0.5}};
  for (int round = 0; round < 3; ++round) {
    for (const Pose& pose : poses) {
      // Computes the expected normals by a new object, which has computed no pose before.
      const std::vector<Vec3d> right = NormalTerms(shading, truth).weighted_at(pose, all);
      EXPECT_EQ(terms.weighted_at(pose, few), (std::vector<Vec3d>{right[3], right[4]}));
      EXPECT_EQ(terms.weighted_at(pose, all), right);
      EXPECT_EQ(terms.exact_at(pose), right);
    }
    std::reverse(poses.begin(), poses.end());
  }
}

}  // namespace
}  // namespace chronormal::pose_memory_test
