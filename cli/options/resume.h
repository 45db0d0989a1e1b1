/// The option --resume: work of hours that goes on where it was interrupted.
///
/// OUT.journal says what the run is (version, command, options, input files with their sizes and times of change) and
/// what is done. It stays where the run ends too early, for whatever reason, and is gone when OUT is whole.
#ifndef CLI_OPTIONS_RESUME_H_
#define CLI_OPTIONS_RESUME_H_

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"
#include "cli/options/command.h"
#include "cli/options/options.h"
#include "io/bytes/journal.h"

namespace chronormal::cli {

/// A run with --resume. Where the object is destroyed before finish(), it says how to go on, or removes the
/// journal where nothing was done; while it is there, so does
/// the end by a signal.
class ResumedRun {
 public:
  ResumedRun(std::string command, std::string output, Journal journal);
  ResumedRun(const ResumedRun&) = delete;
  ResumedRun& operator=(const ResumedRun&) = delete;
  ~ResumedRun();

  [[nodiscard]] Journal& journal() noexcept { return journal_; }

  /// Writes the result to OUT and removes the journal. An OUT that has this text already is as good: an earlier run
  /// ended between the two. Errors: those of print_to() and of the journal.
  [[nodiscard]] Status finish(std::string_view text, bool force);
  /// Removes the journal, where OUT is whole already.
  [[nodiscard]] Status finish();

 private:
  std::string command_, output_;
  Journal journal_;
  bool is_finished_ = false;
};

struct ResumeArgument {
  bool asked = false;

  [[nodiscard]] Option option();

  /// check_output(), but for an OUT that an interrupted run may have written just before its end. Errors: also kUsage
  /// for --resume without a file.
  [[nodiscard]] Status check_output(const CommonOptions& common) const;

  /// Begins a run or goes on with one, whose options are those of the tables; nullptr where nobody asked. Errors:
  /// kUsage where the journal is of another run, with what differs, and for inputs that cannot be read again; those of
  /// the journal and of finding the files.
  [[nodiscard]] Result<std::unique_ptr<ResumedRun>> begin(const std::string& command,
                                                          const std::vector<std::vector<Option>>& tables,
                                                          const InputOptions& input, const CommonOptions& common) const;
};

/// Says that a run goes on, unless it is quiet or begins.
void say_goes_on(const std::string& command, std::size_t done, const std::string& what, bool quiet);

}  // namespace chronormal::cli

#endif  // CLI_OPTIONS_RESUME_H_
