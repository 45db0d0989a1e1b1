/// How a command divides its work, and goes on with it: --shard, --resume, and the ranks that mpirun starts. Commands
/// know of none of the three: a CommandRun makes a SegmentRun (workflow/segments/segment_run.h) of them.
///
///     const auto run = options.run.begin("compare", tables(options), options.input, options.common);
///     CompareRun segments;
///     run->prepare(input, motion, progress, segments, segment_part, read_compared_segment);
///     ... = compare(stream, how, segments);
///     run->join(compare_part(...), merge_compare_parts);         // on several ranks
///     run->finish(text);
///
/// With --resume, OUT.journal says what the run is (version, command, options, input files with their sizes and times
/// of change) and what is done. It stays where the run ends too early, for whatever reason, and is gone when OUT is
/// whole.
#ifndef CLI_OPTIONS_RUN_H_
#define CLI_OPTIONS_RUN_H_

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"
#include "cli/options/command.h"
#include "cli/options/options.h"
#include "cli/ranks/ranks.h"
#include "io/bytes/journal.h"
#include "workflow/json/parts.h"
#include "workflow/segments/segment_run.h"

namespace chronormal::cli {

/// One run of a command. Where a run with --resume is destroyed before finish(), it says how to go on, or removes the
/// journal where nothing was done; while it is there, so does the end by a signal.
class CommandRun {
 public:
  /// journal: nothing without --resume.
  CommandRun(std::string command, const CommonOptions& common, std::optional<Shard> shard,
             std::optional<Journal> journal);
  CommandRun(const CommandRun&) = delete;
  CommandRun& operator=(const CommandRun&) = delete;
  ~CommandRun();

  /// Makes a SegmentRun of the share of this process: its limits are those of the input, and each of the `things` that
  /// are done is shown. Errors: kUsage for --resume and an input that is no sequence of keyframes.
  [[nodiscard]] Status prepare(const Input& input, const Motion& motion, ProgressCallback progress,
                               const std::string& things, SegmentRun& run);
  /// The same with a result for each segment: read(text, name) is what write(result) has written into the journal.
  /// Errors: also those of read.
  template <class Found, class Read>
  [[nodiscard]] Status prepare(const Input& input, const Motion& motion, ProgressCallback progress,
                               RecordedRun<Found>& run, std::string (*write)(const Found&), const Read& read) {
    SegmentRun& base = run;
    if (Status status = prepare(input, motion, std::move(progress), "segments", base); !status || !journal_)
      return status;
    for (const std::string& record : journal_->records()) {
      Result<Found> segment = read(record, journal_->path());
      if (!segment) return segment.error();
      run.known.push_back(std::move(segment).value());
    }
    run.keep = [this, write](const Found& found) { return journal_->append(write(found)); };
    return Success{};
  }

  /// Puts together what several ranks have found: makes merge(parts) the whole on the first, which prints. Returns
  /// false on the others, where nothing is left to do. Errors: those of merge.
  template <class Whole, class Merge>
  [[nodiscard]] static Result<bool> join(const std::string& part, const Merge& merge, Whole& whole) {
    if (!has_ranks()) return true;
    const std::vector<Part> parts = gather(part);
    if (parts.empty()) return false;
    Result<Whole> all = merge(parts);
    if (!all) return all.error();
    whole = std::move(all).value();
    return true;
  }

  /// Whether OUT is a part for merge.
  [[nodiscard]] bool is_part() const noexcept { return shard_.has_value(); }
  /// Whether one process did all of the work without a break, so that times tell something.
  [[nodiscard]] bool is_timed() const noexcept { return !journal_ && !has_ranks(); }

  /// Writes the result to OUT, and removes the journal. An OUT that has this text already is as good: an earlier run
  /// ended between the two. Errors: those of print_to() and of the journal.
  [[nodiscard]] Status finish(std::string_view text);
  /// Removes the journal, where OUT is whole already.
  [[nodiscard]] Status finish();

 private:
  // What each rank has found, on the first rank.
  [[nodiscard]] static std::vector<Part> gather(const std::string& own);

  std::string command_;
  CommonOptions common_;
  std::optional<Shard> shard_;
  std::optional<Journal> journal_;
  bool is_finished_ = false;
};

struct RunArguments {
  std::optional<std::string> shard;
  bool resume = false;

  /// --shard and --resume; of_what ends the help of --shard: it says what is divided, and what OUT is then.
  [[nodiscard]] std::vector<Option> options(const std::string& of_what);

  /// Refuses what no ranks and no other shares can do. Errors: kUsage where there are several ranks, and --shard,
  /// --resume or `other`, an option that was given and divides no task; where several copies that know nothing of each
  /// other would do the same work; and for a --shard that is no share I/N.
  [[nodiscard]] Status check(const std::string& other = "") const;

  /// The share that --shard or the ranks give this process. check() must have passed.
  [[nodiscard]] std::optional<Shard> share() const;

  /// check_output(), but for an OUT that an interrupted run may have written just before its end. Errors: also kUsage
  /// for --resume without a file.
  [[nodiscard]] Status check_output(const CommonOptions& common) const;

  /// Begins a run, or goes on with one whose options are those of the tables. Errors: kUsage where the journal is of
  /// another run, with what differs, and for inputs that cannot be read again; those of the journal and of finding the
  /// files.
  [[nodiscard]] Result<std::unique_ptr<CommandRun>> begin(const std::string& command,
                                                          const std::vector<std::vector<Option>>& tables,
                                                          const InputOptions& input, const CommonOptions& common) const;

 private:
  [[nodiscard]] Result<std::optional<Shard>> read_shard() const;
};

/// Errors: kUsage where several ranks were started for a command, or an input, that one process looks at alone;
/// what says so: "it divides the segments of a sequence, and a glTF file is none".
[[nodiscard]] Status refuse_shares(const RunArguments& run, const char* what);

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_RUN_H_
