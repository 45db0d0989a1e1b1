/// Divides the work of a command among processes, or resumes it after an interruption: --shard, --resume, and the ranks
/// that mpirun starts. Commands need not know which of these is in use. A CommandRun sets up a SegmentRun
/// (workflow/segments/segment_run.h) accordingly.
///
///     const auto run = options.run.begin("compare", tables(options), options.input, options.common);
///     CompareRun segments;
///     run->prepare(input, motion, progress, segments, segment_part, read_compared_segment);
///     ... = compare(stream, how, segments);
///     run->join(compare_part(...), merge_compare_parts);         // on several ranks
///     run->finish(text);
///
/// If --resume is given, OUT.journal describes the run (version, command, options, input files with their sizes and
/// modification times) and records the results so far. The journal stays if the run ends early for any reason, and is
/// removed when OUT is complete.
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

/// A run of a command, with its share of the work and its journal. If a run with --resume is destroyed before finish(),
/// the destructor prints how to continue, or removes the journal if the journal has no results yet. A signal that ends
/// the program during the run has the same effect.
class CommandRun {
 public:
  /// Creates a run. Without --resume, `journal` must be empty.
  CommandRun(std::string command, const CommonOptions& common, std::optional<Shard> shard,
             std::optional<Journal> journal);
  CommandRun(const CommandRun&) = delete;
  CommandRun& operator=(const CommandRun&) = delete;
  ~CommandRun();

  /// Sets up `run`: the share of this process, the limit on memory (Input::expansion()), and the journal. `things` is
  /// the plural of what the progress bar counts, such as "segments". Errors: kUsage for --resume with an input that is
  /// not a sequence of keyframes.
  [[nodiscard]] Status prepare(const Input& input, const Motion& motion, ProgressCallback progress,
                               const std::string& things, SegmentRun& run);
  /// Sets up a `run` that records a result for each segment in the journal. write(result) returns the result as text,
  /// and read(text, name) reads this text in a later run. Errors: those of the prepare() without write and read, and
  /// those of read().
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

  /// Joins the results of several ranks. On the first rank, sets `whole` to merge(parts) and returns true, so that this
  /// rank prints the result. Returns false on the other ranks, whose work is done. Errors: those of merge().
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

  /// Returns true if OUT gets only the part of the result that --shard selects. The command `merge` joins such parts.
  [[nodiscard]] bool is_part() const noexcept { return shard_.has_value(); }
  /// Returns true if one process does all of the work without interruption, so that measured times are meaningful.
  [[nodiscard]] bool is_timed() const noexcept { return !journal_ && !has_ranks(); }

  /// Writes the result to OUT, and removes the journal. If OUT already has this text, an earlier run ended between
  /// these two steps, and OUT is not written again. Errors: those of print_to() and the journal.
  [[nodiscard]] Status finish(std::string_view text);
  /// Ends a run whose caller has already completed OUT: removes the journal.
  [[nodiscard]] Status finish();

 private:
  // Returns the parts of all ranks on the first rank, and an empty list on the other ranks.
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

  /// Returns the options --shard and --resume. `of_what` ends the help of --shard: it says which data are divided, and
  /// what OUT then contains.
  [[nodiscard]] std::vector<Option> options(const std::string& of_what);

  /// Checks that the options can be used with ranks and shares. `other` is a given option that cannot be used when the
  /// task is divided, or empty. Errors: kUsage for several ranks together with --shard, --resume or `other`; if several
  /// independent copies of the program would do the same work; and for a value of --shard that is not a share I/N.
  [[nodiscard]] Status check(const std::string& other = "") const;

  /// Returns the share of the work that --shard or the ranks give this process. check() must have succeeded before.
  [[nodiscard]] std::optional<Shard> share() const;

  /// Checks the output like check_output() of the library, but accepts an OUT that an interrupted run may have written
  /// just before its end. Errors: those of that function; kUsage for --resume without a file as OUT.
  [[nodiscard]] Status check_output(const CommonOptions& common) const;

  /// Begins a run, or resumes an earlier run with the same options, which are read from the tables. Errors: kUsage with
  /// the difference if the journal belongs to another run, and for inputs that cannot be read again; errors of the
  /// journal and of finding the files.
  [[nodiscard]] Result<std::unique_ptr<CommandRun>> begin(const std::string& command,
                                                          const std::vector<std::vector<Option>>& tables,
                                                          const InputOptions& input, const CommonOptions& common) const;

 private:
  [[nodiscard]] Result<std::optional<Shard>> read_shard() const;
};

/// Checks that no ranks or shares are used for a command or an input that a single process must handle. Errors: kUsage
/// with the reason `what`, for example "only a sequence of keyframes can be divided, not a glTF file".
[[nodiscard]] Status refuse_shares(const RunArguments& run, const char* what);

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_RUN_H_
