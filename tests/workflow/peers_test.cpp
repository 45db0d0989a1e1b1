// Tests peers, which are processes that share a task; in this test, threads play the processes. The samples of all
// peers form one output with the same bytes as from a single process. The output appears only when all peers are done.
// Audits of peers also have the same bytes as from a single process, although each peer processes only its own
// segments.
#include <gtest/gtest.h>

#include <algorithm>
#include <condition_variable>
#include <cstddef>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <span>
#include <string>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "io/bytes/checksum.h"
#include "tests/support/fixtures.h"
#include "tests/support/temporary_folder.h"
#include "workflow/json/parts.h"
#include "workflow/sample/continued_samples.h"
#include "workflow/segments/segment_run.h"

namespace chronormal::peers_test {
namespace {

using test::TemporaryFolder;

// A meeting at which threads exchange texts. Each thread calls the function of its peer with a text. The calls return
// the list of all texts when all threads have called.
class Meeting {
 public:
  explicit Meeting(std::size_t count) : count_(count), calls_(count) {}

  [[nodiscard]] Peers peers(std::size_t self) {
    return {[this, self](const std::string& own) {
              const std::vector<std::string> all = meet(self, own);
              return self == 0 ? all : std::vector<std::string>();
            },
            [this, self](const std::string& of_first) { return meet(self, of_first).front(); },
            [this, self](std::span<double> numbers) {
              const std::string own(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
              for (const std::string& text : meet(self, own)) {
                std::vector<double> others(numbers.size());
                std::memcpy(others.data(), text.data(), text.size());
                for (std::size_t i = 0; i < numbers.size(); ++i) numbers[i] = std::max(numbers[i], others[i]);
              }
            }};
  }

 private:
  std::vector<std::string> meet(std::size_t self, const std::string& own) {
    std::unique_lock lock(mutex_);
    const std::size_t call = calls_[self]++;
    if (texts_.size() <= call) texts_.resize(call + 1, std::vector<std::string>(count_));
    if (arrived_.size() <= call) arrived_.resize(call + 1);
    texts_[call][self] = own;
    ++arrived_[call];
    changed_.notify_all();
    changed_.wait(lock, [&] { return arrived_[call] == count_; });
    return texts_[call];
  }

  std::mutex mutex_;
  std::condition_variable changed_;
  std::size_t count_;
  std::vector<std::size_t> calls_, arrived_;
  std::vector<std::vector<std::string>> texts_;
};

Result<SampleSummary> write_share(MotionStream& stream, const SampleOptions& options, const Moments& moments,
                                  const SampleOutput& output, const Shard& shard, const Peers& peers) {
  SegmentRun run;
  run.shard = shard;
  run.peers = &peers;
  return write_samples(stream, options, moments, output, run);
}

Result<SampleSummary> write_share(const Motion& motion, const SampleOptions& options, const Moments& moments,
                                  const SampleOutput& output, const Shard& shard, const Peers& peers) {
  MotionStream stream(motion);
  return write_share(stream, options, moments, output, shard, peers);
}

// Lets every peer write its share in a separate thread. Returns the results of all peers.
std::vector<SampleSummary> write_together(const Motion& motion, const SampleOptions& options, const Moments& moments,
                                          const SampleOutput& output, std::size_t count) {
  Meeting meeting(count);
  std::vector<SampleSummary> found(count);
  std::vector<std::thread> threads;
  for (std::size_t i = 0; i < count; ++i) {
    threads.emplace_back([&, i] {
      const Peers peers = meeting.peers(i);
      const Result<SampleSummary> summary = write_share(motion, options, moments, output, {i, count}, peers);
      if (summary)
        found[i] = summary.value();
      else
        ADD_FAILURE() << summary.error().text();
    });
  }
  for (std::thread& thread : threads) thread.join();
  return found;
}

SampleOptions of_vertices() {
  SampleOptions options;
  options.elements.kind = ElementKind::kVertices;
  return options;
}

TEST(SamplesOfPeers, arrays_have_the_bytes_of_one_process) {
  const TemporaryFolder folder;
  const Motion motion = fixtures::smooth_morph(5);
  const Moments moments{{0, 0.125, 0.25, 0.25, 0.75, 1, 0.5}, {}};
  for (const SampleFormat format : {SampleFormat::kNpy, SampleFormat::kNpz}) {
    ASSERT_TRUE(write_samples(motion, of_vertices(), moments, {folder / "one", format, true}).ok());
    for (const std::size_t count : {1U, 2U, 3U, 7U, 10U}) {
      const auto found = write_together(motion, of_vertices(), moments, {folder / "all", format, true}, count);
      EXPECT_EQ(found.front().normals, 7 * motion.topology.vertex_count());
      EXPECT_TRUE(test::read_whole(folder / "all") == test::read_whole(folder / "one")) << count;
      EXPECT_EQ(folder.entry_count(), 2U);
    }
  }
}

TEST(SamplesOfPeers, meshes_have_the_bytes_of_one_process) {
  const TemporaryFolder folder;
  const Motion motion = fixtures::smooth_morph(4);
  const Moments moments{{0, 0.5, 1}, {}};
  ASSERT_TRUE(write_samples(motion, of_vertices(), moments, {folder / "one_%d.ply", SampleFormat::kPly}).ok());
  write_together(motion, of_vertices(), moments, {folder / "all_%d.ply", SampleFormat::kPly}, 2);
  EXPECT_EQ(folder.entry_count(), 6U);
  for (const std::string number : {"0", "1", "2"})
    EXPECT_TRUE(test::read_whole(folder / ("all_" + number + ".ply")) ==
                test::read_whole(folder / ("one_" + number + ".ply")));
}

TEST(SamplesOfPeers, normals_without_a_direction_are_counted_over_all) {
  const TemporaryFolder folder;
  Motion motion = fixtures::smooth_morph(3);
  for (Motion::Keyframe& keyframe : motion.keyframes)
    std::fill(keyframe.positions.begin(), keyframe.positions.end(), 0.0F);
  const auto found =
      write_together(motion, of_vertices(), {{0, 0.5, 1}, {}}, {folder / "n.npy", SampleFormat::kNpy}, 2);
  EXPECT_EQ(found[0].zeros, 3 * motion.topology.vertex_count());
  EXPECT_EQ(found[0].normals, found[0].zeros);
}

// The test plays the first of two peers itself, and communicates with the second peer, which is a thread.
TEST(SamplesOfPeers, no_name_is_given_before_all_are_done) {
  for (const SampleFormat format : {SampleFormat::kNpy, SampleFormat::kNpz, SampleFormat::kObj}) {
    const TemporaryFolder folder;
    const std::string path = folder / (format == SampleFormat::kObj ? "n_1.obj" : "n");
    const std::string started = folder.write("started", "");
    std::vector<std::string> calls;
    const Peers peers{[&](const std::string&) {
                        calls.push_back(std::filesystem::exists(path) ? "gather with the file" : "gather");
                        return std::vector<std::string>();
                      },
                      [&](const std::string&) {
                        calls.push_back(std::filesystem::exists(path) ? "broadcast with the file" : "broadcast");
                        return started;
                      }};
    const SampleOutput output{format == SampleFormat::kObj ? folder / "n_%d.obj" : path, format};
    ASSERT_TRUE(write_share(fixtures::smooth_morph(3), of_vertices(), {{0, 1}, {}}, output, {1, 2}, peers).ok());
    const std::vector<std::string> of_arrays = {"broadcast", "gather", "broadcast", "gather"};
    const std::vector<std::string> of_meshes = {"gather", "broadcast", "gather with the file"};
    EXPECT_EQ(calls, format == SampleFormat::kObj ? of_meshes : of_arrays);
    EXPECT_TRUE(std::filesystem::exists(started)) << "the first process gives it its name";
  }
}

TEST(SamplesOfPeers, a_peer_that_fails_removes_what_was_begun) {
  const TemporaryFolder folder;
  const std::string started = folder.write("started", "");
  bool has_joined = false;
  const Peers peers{[](const std::string&) { return std::vector<std::string>(); },
                    [&](const std::string&) {
                      has_joined = true;
                      return started;
                    }};
  const Motion morph = fixtures::smooth_morph(3);
  Motion motion = morph;
  for (std::size_t k = 2; k < 6; ++k) {
    motion.keyframes.push_back(motion.keyframes.back());
    motion.keyframes.back().time = static_cast<double>(k);
  }
  motion.connect_as_sequence();
  for (Motion::Keyframe& keyframe : motion.keyframes) keyframe.positions.clear();
  const auto read = [&](const Motion&, std::size_t keyframe, std::span<float> positions) {
    if (has_joined) return Status(Error{ErrorCode::kFailed, "", "the disk is gone"});
    const std::vector<float>& all = morph.keyframes[std::min<std::size_t>(keyframe, 1)].positions;
    std::copy(all.begin(), all.end(), positions.begin());
    return Status(Success{});
  };
  MotionStream stream(std::move(motion), read, 0);
  const auto written = write_share(stream, of_vertices(), {{0, 1, 2.5}, {}}, {folder / "n.npy"}, {1, 2}, peers);
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().message, "the disk is gone");
  EXPECT_EQ(folder.entry_count(), 0U);
}

TEST(SamplesOfPeers, a_file_that_a_peer_cannot_see_and_a_stream_are_refused) {
  const TemporaryFolder folder;
  const Peers peers{[](const std::string&) { return std::vector<std::string>(); },
                    [&](const std::string&) { return folder / "elsewhere"; }};
  const Motion motion = fixtures::smooth_morph(3);
  const auto written = write_share(motion, of_vertices(), {{0, 1}, {}}, {folder / "n.npy"}, {1, 2}, peers);
  ASSERT_FALSE(written.ok());
  EXPECT_EQ(written.error().code, ErrorCode::kFailed);
  EXPECT_NE(written.error().text().find("that the first process has begun"), std::string::npos);
  const auto stream = write_share(motion, of_vertices(), {{0, 1}, {}}, {"-"}, {1, 2}, peers);
  ASSERT_FALSE(stream.ok());
  EXPECT_EQ(stream.error().code, ErrorCode::kUsage);
}

// Makes a sheet whose first half moves only in the first segment, in which it becomes large. The second half moves only
// in the last segment.
Motion moving_by_turns() {
  Motion motion = fixtures::smooth_morph(6);
  motion.keyframes.resize(1);
  const std::vector<float> base = motion.keyframes[0].positions;
  for (std::size_t k = 1; k < 6; ++k) {
    Motion::Keyframe keyframe{k == 1 ? base : motion.keyframes.back().positions, static_cast<double>(k), ""};
    const std::size_t half = base.size() / 6 * 3;
    if (k == 1)
      for (std::size_t i = 0; i < half; ++i) keyframe.positions[i] *= 1000 + static_cast<float>(i % 7);
    if (k == 2) keyframe.positions = base;
    if (k == 5)
      for (std::size_t i = half; i + 9 < base.size(); ++i)
        keyframe.positions[i] *= 0x1p-40F * static_cast<float>(i % 5);
    motion.keyframes.push_back(std::move(keyframe));
  }
  motion.connect_as_sequence();
  return motion;
}

TEST(AuditOfPeers, shards_of_their_own_segments_give_the_bytes_of_one_process) {
  const Motion motion = moving_by_turns();
  // Tests both ways in which audits measure: by nlerp in blocks of faces, and by slerp one vertex after the other.
  for (const AuditRule rule : {AuditRule::kNlerp, AuditRule::kSlerp}) {
    AuditOptions options;
    options.rule = rule;
    options.samples = 5;
    options.weld = false;
    const std::string whole = audit_json("m", audit(motion, {}, options).value(), {1});
    for (const std::size_t count : {1U, 2U, 3U, 5U, 8U}) {
      Meeting meeting(count);
      std::vector<Part> parts(count);
      std::vector<std::vector<bool>> was_read(count, std::vector<bool>(motion.keyframes.size()));
      std::vector<std::thread> threads;
      for (std::size_t i = 0; i < count; ++i) {
        threads.emplace_back([&, i] {
          const Peers peers = meeting.peers(i);
          AuditRun run;
          run.shard = Shard{i, count};
          run.peers = &peers;
          Motion outline = motion;
          for (Motion::Keyframe& keyframe : outline.keyframes) keyframe.positions.clear();
          const auto read = [&](const Motion&, std::size_t keyframe, std::span<float> positions) {
            was_read[i][keyframe] = true;
            const std::vector<float>& all = motion.keyframes[keyframe].positions;
            std::copy(all.begin(), all.end(), positions.begin());
            return Status(Success{});
          };
          MotionStream stream(std::move(outline), read, 0);
          const Result<Audit> found = audit(stream, {}, options, run);
          parts[i] = {"part", audit_part("m", found.value(), run, 1)};
        });
      }
      for (std::thread& thread : threads) thread.join();
      EXPECT_EQ(merge_parts(parts).value().json, whole) << count;
      // The last shard reads the first keyframe and the keyframes of its own segments. With fewer than three peers, a
      // segment of the last shard uses keyframe 2.
      EXPECT_EQ(was_read.back()[2], count < 3) << count;
    }
  }
}

TEST(Checksum, joined_checksums_are_those_of_the_whole) {
  const std::string text = "the quick brown fox jumps over the lazy dog";
  for (std::size_t cut = 0; cut <= text.size(); ++cut) {
    const std::string_view first = std::string_view(text).substr(0, cut), second = std::string_view(text).substr(cut);
    EXPECT_EQ(joined_checksum(checksum_of(first), checksum_of(second), second.size()), checksum_of(text));
  }
}

}  // namespace
}  // namespace chronormal::peers_test
