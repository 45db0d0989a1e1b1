/// Goes once through the segments of a motion. The commands compare, audit, sample, inspect and query all use this
/// loop. A run decides which segments it handles, keeps their keyframes in memory, and passes results on. The commands
/// decide what to compute for a segment, and how to add up results.
///
///     SegmentRun run;                           // one process does everything; or:
///     run.shard = Shard{0, 8};                  // the first of eight shares, for --shard 1/8
///     run.peers = &peers;                       // mpirun: other processes have the other shares
///     run.begin(motion.segments.size());
///     run.over(stream, segment_keys(motion), run.share(), at_once, [&](IndexRange segments) -> Status { ... });
///
/// A RecordedRun also has a result for each segment. It skips segments for which an earlier run has kept a result
/// (--resume), passes each new result to the journal, and collects all results for the part of a shard.
///
/// Results are added up segment by segment in the order of the motion, so that their bits depend neither on the number
/// of threads nor on where a motion is divided.
///
/// Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_SEGMENTS_SEGMENT_RUN_H_
#define CHRONORMAL_WORKFLOW_SEGMENTS_SEGMENT_RUN_H_

#include <algorithm>
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/expansion.h"
#include "workflow/segments/shards.h"
#include "workflow/segments/task_checksums.h"

namespace chronormal::inline internal {

class Journal;

/// Returns a function that maps a segment of the motion to its keyframes, for SegmentRun::over(). The motion must
/// outlive the function.
[[nodiscard]] inline auto segment_keys(const Motion& motion) {
  return [&motion](std::size_t segment) { return motion.segments[segment]; };
}

struct SegmentRun {
  using Progress = std::function<void(std::size_t done, std::size_t total)>;

  /// The share of the work that this run does. Without a value, the run does all work, and writes no part for `merge`.
  std::optional<Shard> shard = {};
  /// The processes that have the other shares, or nullptr if this process does not communicate with others.
  const Peers* peers = nullptr;
  /// The limit on the memory of results, relative to the size of the motion's files.
  Expansion expansion = Expansion::unlimited();
  Progress progress = {};
  /// The journal for rows of samples. A RecordedRun has `keep` instead.
  Journal* journal = nullptr;
  /// The checksums of all data on which a shard depends. They are written into the part of the shard.
  TaskChecksums checksums = {};

  /// Begins a run over `segments` segments. In reports of progress, each segment counts as `steps` steps.
  void begin(std::size_t segments, std::size_t steps = 1) noexcept {
    total_ = segments;
    steps_ = steps;
    done_ = 0;
  }
  /// Counts `segments` segments as done, because an earlier run has computed them.
  void skip(std::size_t segments) noexcept { done_ += segments; }
  /// Returns the segments that this process computes.
  [[nodiscard]] IndexRange share() const noexcept { return share_of(total_); }
  /// Returns the range of items that belongs to this process, if there are `total` items in all.
  [[nodiscard]] IndexRange share_of(std::size_t total) const noexcept { return shard.value_or(Shard{}).of(total); }
  /// Returns the items that this process examines for facts about all items: all items or, if peers examine the others,
  /// the items of this process.
  [[nodiscard]] IndexRange looked_at(std::size_t total) const noexcept {
    return peers != nullptr ? share_of(total) : IndexRange{0, total};
  }
  /// Replaces each number by the largest number that any peer has at the same index.
  void maximize(std::span<double> numbers) const {
    if (peers != nullptr) peers->maximize(numbers);
  }

  /// Reports progress: `segments` more segments are done, and also `steps` steps of the next segment.
  void tell(std::size_t segments, std::size_t steps = 0) {
    done_ += segments;
    if (progress) progress(done_ * steps_ + steps, share().count * steps_);
  }

  /// Processes segments that are in memory, in order. Calls work(segments) for at most `at_once` segments at a time,
  /// and reports progress after each call. Errors: those of work.
  template <class Work>
  [[nodiscard]] Status over(IndexRange segments, std::size_t at_once, const Work& work) {
    return in_waves(segments, at_once, [&](IndexRange some) -> Status {
      Status status = work(some);
      if (status) tell(some.count);
      return status;
    });
  }
  /// Processes the segments of a stream, in order. Before each call of work, holds in memory all keyframes from the
  /// first to the last that keys(segment) returns for the segments of this call. Calls work(segments) for at most
  /// `at_once` segments at a time, and reports progress after each call. Errors: those of work and of the stream.
  template <class Keys, class Work>
  [[nodiscard]] Status over(MotionStream& stream, const Keys& keys, IndexRange segments, std::size_t at_once,
                            const Work& work) {
    return over(segments, at_once, [&](IndexRange some) -> Status {
      Status status = hold(stream, keys, some);
      return status ? work(some) : status;
    });
  }
  /// Processes the segments of a stream as over() does, but reports no progress. Commands call this function before the
  /// run, to find facts about all segments.
  template <class Keys, class Work>
  [[nodiscard]] static Status look_over(MotionStream& stream, const Keys& keys, IndexRange segments,
                                        std::size_t at_once, const Work& work) {
    return in_waves(segments, at_once, [&](IndexRange some) -> Status {
      Status status = hold(stream, keys, some);
      return status ? work(some) : status;
    });
  }

 private:
  template <class Work>
  [[nodiscard]] static Status in_waves(IndexRange segments, std::size_t at_once, const Work& work) {
    for (std::size_t first = segments.first; first < segments.end(); first += at_once)
      if (Status status = work(IndexRange{first, std::min(at_once, segments.end() - first)}); !status) return status;
    return Success{};
  }
  template <class Keys>
  [[nodiscard]] static Status hold(MotionStream& stream, const Keys& keys, IndexRange some) {
    Motion::SegmentKeys held = keys(some.first);
    for (std::size_t s = some.first + 1; s < some.end(); ++s)
      held = {std::min(held.from, keys(s).from), std::max(held.to, keys(s).to)};
    return stream.hold(held.from, held.to);
  }

  std::size_t total_ = 0, steps_ = 1, done_ = 0;
};

/// A run that keeps a result for each segment. The type Found must have a member `segment`, the index of its segment.
template <class Found>
struct RecordedRun : SegmentRun {
  /// The results of the first segments of the share, as an earlier run has kept them.
  std::vector<Found> known = {};
  /// A function that is called for each computed segment, in order; may be empty. The function stores the result, so
  /// that a later run can have the result among `known`. An error that the function returns ends the run.
  std::function<Status(const Found&)> keep = {};
  /// The results of all segments of a shard. Results that an earlier run has kept are among them.
  std::vector<Found> found = {};

  /// Returns true if this run never has the data of all segments together. Commands then refuse options that need such
  /// data.
  [[nodiscard]] bool is_divided() const noexcept { return shard || keep || !known.empty(); }

  /// Begins as SegmentRun does, and calls add(result) for each known segment. Errors: kUsage if the known segments are
  /// not the first of the share, or if fits(result) is false for one of them. The message of an error names the task,
  /// for example "audit".
  template <class Fits, class Add>
  [[nodiscard]] Status begin(std::size_t segments, std::size_t steps, const char* task, const Fits& fits,
                             const Add& add) {
    SegmentRun::begin(segments, steps);
    const IndexRange own = share();
    bool are_first = known.size() <= own.count;
    for (std::size_t i = 0; i < known.size(); ++i)
      are_first = are_first && known[i].segment == own.first + i && fits(known[i]);
    if (!are_first)
      return Error{ErrorCode::kUsage, "",
                   std::string("the segments that were computed before belong to another ") + task +
                       "; compute all segments again"};
    for (const Found& one : known) {
      add(one);
      if (shard) found.push_back(one);
    }
    skip(known.size());
    return Success{};
  }
  /// Returns the segments of the share whose results no earlier run has kept.
  [[nodiscard]] IndexRange rest() const noexcept {
    const IndexRange own = share();
    return {own.first + known.size(), own.count - known.size()};
  }

  /// Takes the result of the next segment, and passes it to the function `keep` and to add(). Errors: those of `keep`.
  template <class Add>
  [[nodiscard]] Status take(Found result, const Add& add) {
    if (Status kept = keep ? keep(result) : Success{}; !kept) return kept;
    add(std::as_const(result));
    if (shard) found.push_back(std::move(result));
    return Success{};
  }
};

/// The result of one shard: the sums over its segments, the result of each segment, and the checksums of its data.
template <class Whole, class Found>
struct ShardOf {
  Whole whole;
  std::vector<Found> found;
  TaskChecksums checksums;
};

/// Sorts the results of all segments into the order of the motion. The shards may be in any order, and the motion has
/// total(whole) segments. Errors: kUsage if are_of_one(a, b) is false, because the two shards then belong to different
/// tasks; kUsage if a segment is not in exactly one shard. Messages name the tasks by the plural `tasks`.
template <class Whole, class Found, class AreOfOne>
[[nodiscard]] Result<std::vector<Found>> join(std::vector<ShardOf<Whole, Found>>& shards, std::size_t total,
                                              const AreOfOne& are_of_one, const char* tasks) {
  KnownParts parts;
  std::vector<Found> all;
  for (std::size_t i = 0; i < shards.size(); ++i) {
    ShardOf<Whole, Found>& shard = shards[i];
    if (const Status known = parts.add("shard " + std::to_string(i), shard.checksums); !known) return known.error();
    if (!are_of_one(shard.whole, shards.front().whole))
      return Error{ErrorCode::kUsage, "",
                   std::string("the shards belong to two different ") + tasks + "; merge each of them separately"};
    std::move(shard.found.begin(), shard.found.end(), std::back_inserter(all));
  }
  std::stable_sort(all.begin(), all.end(), [](const Found& a, const Found& b) { return a.segment < b.segment; });
  for (std::size_t s = 0; s < std::max(total, all.size()); ++s) {
    if (s < all.size() && all[s].segment == s) continue;
    const bool is_twice = s < all.size() && all[s].segment < s;
    return Error{
        ErrorCode::kUsage, "",
        "segment " + std::to_string(is_twice ? all[s].segment : s) +
            (is_twice ? " is in two of the files; give each file once" : " is missing; give the files of all shards")};
  }
  return all;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SEGMENTS_SEGMENT_RUN_H_
