// Checks that the memory of an audit or a bake, and the time of an audit, grow only linearly with the file, even if a
// small file repeats a part thousands of times.
#include <gtest/gtest.h>

#include <cstddef>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/bake.h"
#include "tests/support/allocation_counter.h"
#include "tests/support/audit_fixture.h"
#include "tests/support/cpu_time.h"
#include "tests/support/gltf_builder.h"

namespace chronormal::audit_growth_test {
namespace {

using test::GltfBuilder;

// Makes a triangle whose stored normals do not follow its target. The file has `targets` copies of this target.
GltfBuilder triangle(std::size_t targets) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions({0, 0, 0, 1, 0, 0, 0, 1, 0}),
                    lift = builder.add_positions({0, 0, 0, 0, 0, 0.5F, 0, 0, 0.25F}),
                    normals = builder.add_positions({0, 0, 1, 0, 0, 1, 0, 0, 1}),
                    corners = builder.add_indices<std::uint8_t>({0, 1, 2});
  GltfBuilder::Json primitive =
      GltfBuilder::primitive(base, corners, std::vector<GltfBuilder::Json>(targets, {{"POSITION", lift}}));
  primitive["attributes"]["NORMAL"] = normals;
  builder.add_node(builder.add_mesh(std::move(primitive)));
  return builder;
}

// Makes a file with `count` animations of two keys each, which share their arrays if are_shared.
GltfBuilder clips(std::size_t count, bool are_shared) {
  GltfBuilder builder = triangle(1);
  for (std::size_t i = 0; i < count; ++i) {
    if (i == 0 || !are_shared)
      builder.add_track<float>(builder.add_animation(""), 0, {0, 1}, {0, 1.0F + static_cast<float>(i)});
    else
      builder.add("animations", builder.json["animations"][0]);
  }
  return builder;
}

TEST(AuditGrowth, a_subject_takes_little_more_than_the_bins_that_it_fills) {
  if (!test::AllocationCounter::works()) GTEST_SKIP() << "operator new is a sanitizer's";
  constexpr std::size_t kMany = 400, kMostPerSubject = 6000;  // bytes; a whole histogram would take 36 kB
  for (const GltfBuilder& builder : {clips(kMany, true), clips(kMany, false), triangle(kMany)}) {
    const test::GltfFixture fixture(builder);
    ASSERT_TRUE(fixture.ok()) << fixture.error();
    const test::AllocationCounter counter;
    const Result<Audit> audited = audit(*fixture, {});
    ASSERT_TRUE(audited.ok());
    ASSERT_GE(audited.value().subjects.size(), kMany);
    EXPECT_LT(static_cast<std::size_t>(counter.bytes()) / audited.value().subjects.size(), kMostPerSubject);
    EXPECT_LT(counter.peak_bytes() / audited.value().subjects.size(), 2 * kMostPerSubject);
  }
}

TEST(AuditGrowth, a_bake_takes_little_memory_for_each_clip_that_shares_its_arrays) {
  if (!test::AllocationCounter::works()) GTEST_SKIP() << "operator new is a sanitizer's";
  const auto peak_bytes = [](std::size_t count) {
    const test::GltfFixture fixture(clips(count, true));
    GltfEdit edit(*fixture);
    const test::AllocationCounter counter;
    EXPECT_TRUE(bake(*fixture, {}, edit).ok());
    return counter.peak_bytes();
  };
  constexpr std::size_t kFew = 400, kMany = 1200, kMostPerClip = 30000;  // bytes of memory
  EXPECT_LT(peak_bytes(kMany), peak_bytes(kFew) + (kMany - kFew) * kMostPerClip);
}

// Eight times as many targets must take about eight times as long, and not 64 times.
TEST(AuditGrowth, time_is_linear_in_targets) {
  constexpr std::size_t kFew = 500, kMany = 4000;
  const test::GltfFixture few(triangle(kFew)), many(triangle(kMany));
  ASSERT_TRUE(few.ok() && many.ok());
  const auto audit_all = [](const test::GltfFixture& fixture, std::size_t targets) {
    EXPECT_EQ(audit(*fixture, {}).value().subjects.size(), targets);
  };
  test::expect_growth(
      16, 0, [&] { audit_all(few, kFew); }, [&] { audit_all(many, kMany); });
}

TEST(AuditGrowth, bins_count_as_a_map_does) {
  constexpr unsigned kSeed = 2305;
  SCOPED_TRACE(testing::Message() << "seed " << kSeed);
  std::mt19937 random(kSeed);
  for (int round = 0; round < 500; ++round) {
    std::map<std::size_t, std::size_t> expected;
    FineBins bins;
    for (int part = 0; part < 4; ++part) {
      FineBins more;
      for (std::size_t n = random() % 20; n > 0; --n) {
        const std::size_t bin = random() % 30 * 79 % kAuditFineBins, count = random() % 4;
        more.add(bin, count);
        if (count > 0) expected[bin] += count;
      }
      bins.add(more);
    }
    std::map<std::size_t, std::size_t> found;
    for (const FineBins::Bin& bin : bins.filled()) found[bin.number()] = bin.count();
    ASSERT_EQ(found, expected);
    ASSERT_EQ(bins.filled().size(), expected.size());
    for (std::size_t bin = 0; bin < kAuditFineBins; ++bin)
      ASSERT_EQ(bins[bin], expected.contains(bin) ? expected[bin] : 0);
  }
}

}  // namespace
}  // namespace chronormal::audit_growth_test
