// Checks that a run processes each segment of its share once and in order, while the keyframes of the segment are in
// memory. Tests all divisions of the motion, all places at which an earlier run may have ended, and all numbers of
// segments at a time.
#include "workflow/segments/segment_run.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace chronormal::segment_run_test {
namespace {

constexpr unsigned kSeed = 20261127;

struct Numbered {
  std::size_t segment = 0;
  double value = 0;
};

// Makes a stream of a triangle with many keyframes. The keyframes are read on demand and then forgotten.
MotionStream stream_of(std::size_t keyframes, std::vector<std::size_t>& reads) {
  Motion outline;
  outline.topology = Topology::triangles(3, {0, 1, 2}).value();
  for (std::size_t k = 0; k < keyframes; ++k) outline.keyframes.push_back({{}, static_cast<double>(k), ""});
  outline.connect_as_sequence();
  reads.assign(keyframes, 0);
  const auto read = [&reads](const Motion&, std::size_t k, std::span<float> positions) {
    std::fill(positions.begin(), positions.end(), static_cast<float>(k));
    ++reads[k];
    return Status(Success{});
  };
  return MotionStream(std::move(outline), read, 0);
}

// Returns a number that depends on a segment. Fails unless the keyframes of the segment are in memory.
Numbered looked_at(const Motion& motion, std::size_t s) {
  const auto& [from, to] = motion.segments[s];
  if (motion.keyframes[from].positions.empty() || motion.keyframes[to].positions.empty()) {
    ADD_FAILURE() << "the keyframes of segment " << s << " are not held";
    return {s, 0};
  }
  return {s, 1.0 / (1 + motion.keyframes[from].positions[0] + 3 * motion.keyframes[to].positions[0])};
}

Status run_over(MotionStream& stream, std::size_t at_once, RecordedRun<Numbered>& run, std::vector<double>& sum) {
  const Motion& motion = stream.motion();
  const auto add = [&](const Numbered& one) { sum.push_back(one.value); };
  const Status begun = run.begin(
      motion.segments.size(), 1, "test", [](const Numbered&) { return true; }, add);
  if (!begun) return begun;
  return run.over(stream, segment_keys(motion), run.rest(), at_once, [&](IndexRange some) {
    EXPECT_LE(some.count, at_once);
    Status status = Success{};
    for (std::size_t s = some.first; status && s < some.end(); ++s) status = run.take(looked_at(motion, s), add);
    return status;
  });
}

TEST(SegmentRun, shares_that_were_interrupted_anywhere_find_together_what_one_run_finds) {
  std::mt19937 random(kSeed);
  const auto draw = [&](std::size_t first, std::size_t last) {
    return std::uniform_int_distribution<std::size_t>(first, last)(random);
  };
  for (int trial = 0; trial < 300; ++trial) {
    SCOPED_TRACE("seed " + std::to_string(kSeed) + ", trial " + std::to_string(trial));
    const std::size_t segments = draw(1, 12), shares = draw(1, 5);
    std::vector<double> expected;  // computed from the segments directly, without a run
    for (double s = 0; s < static_cast<double>(segments); ++s) expected.push_back(1 / (1 + s + 3 * (s + 1)));
    std::vector<ShardOf<int, Numbered>> all;
    for (std::size_t i = 0; i < shares; ++i) {
      std::vector<std::size_t> reads;
      MotionStream stream = stream_of(segments + 1, reads);
      RecordedRun<Numbered> first, second;
      first.shard = second.shard = Shard{i, shares};
      const std::size_t most = draw(0, segments);
      first.keep = [&](const Numbered& one) -> Status {
        if (second.known.size() == most) return Error{ErrorCode::kFailed, "", "the disk is full"};
        second.known.push_back(one);
        return Success{};
      };
      std::vector<double> of_first, of_second;
      const bool is_done = run_over(stream, draw(1, 4), first, of_first).ok();
      EXPECT_EQ(is_done, most >= first.share().count);
      std::size_t last_done = 0;
      second.progress = [&](std::size_t done, std::size_t total) {
        EXPECT_EQ(total, second.share().count);
        EXPECT_GT(done, last_done);
        last_done = done;
      };
      const std::size_t kept = second.known.size();
      ASSERT_TRUE(run_over(stream, draw(1, 4), second, of_second));
      EXPECT_EQ(last_done, kept < second.share().count ? second.share().count : 0);
      EXPECT_TRUE(std::equal(of_second.begin(), of_second.end(),
                             expected.begin() + static_cast<std::ptrdiff_t>(second.share().first)));
      all.push_back({0, second.found, {}});
    }
    std::shuffle(all.begin(), all.end(), random);
    const auto same = [](int, int) { return true; };
    const auto joined = join(all, segments, same, "tests");
    ASSERT_TRUE(joined) << joined.error().text();
    ASSERT_EQ(joined.value().size(), segments);
    for (std::size_t s = 0; s < segments; ++s) EXPECT_EQ(joined.value()[s].value, expected[s]);
  }
}

TEST(SegmentRun, every_keyframe_of_a_share_is_read_once_and_no_other) {
  std::vector<std::size_t> reads;
  MotionStream stream = stream_of(11, reads);
  RecordedRun<Numbered> run;
  run.shard = Shard{1, 3};  // segments 3, 4 and 5
  std::vector<double> sum;
  ASSERT_TRUE(run_over(stream, 2, run, sum));
  for (const std::size_t k : {3U, 4U, 5U, 6U}) EXPECT_EQ(reads[k], 1U) << k;
  // The stream may read keyframe 7 in advance, so its reads are not counted here.
  for (const std::size_t k : {0U, 1U, 2U, 8U, 9U, 10U}) EXPECT_EQ(reads[k], 0U) << k;
}

TEST(SegmentRun, what_is_known_must_be_the_first_segments_of_the_share) {
  std::vector<std::size_t> reads;
  MotionStream stream = stream_of(5, reads);
  std::vector<double> sum;
  for (const std::vector<Numbered>& known :
       {std::vector<Numbered>{{1, 0}}, {{0, 0}, {2, 0}}, std::vector<Numbered>(5)}) {
    RecordedRun<Numbered> run;
    run.known = known;
    const Status refused = run_over(stream, 1, run, sum);
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().text(),
              "the segments that were computed before belong to another test; compute all segments again");
  }
}

}  // namespace
}  // namespace chronormal::segment_run_test
