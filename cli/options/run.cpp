// Describes a run by its options and its files, compares this description with the one in the journal of an interrupted
// run, and finds which share of the work this process does.
#include "cli/options/run.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <variant>

#include "chronormal/io/output.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/process.h"
#include "cli/terminal/screen.h"
#include "cli/terminal/table.h"
#include "cli/terminal/version.h"
#include "core/charconv.h"
#include "io/bytes/expansion.h"
#include "io/bytes/file.h"
#include "io/input/input_identity.h"
#include "io/system/names.h"

namespace chronormal::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string journal_name(const std::string& output) { return output + ".journal"; }

// Converts the value of an option to text, which is empty if the option was not given.
struct ValueText {
  std::string operator()(const bool* value) const { return *value ? "given" : ""; }
  std::string operator()(const std::string* value) const { return *value; }
  std::string operator()(const double* value) const { return Json(*value).dump(); }
  std::string operator()(const std::size_t* value) const { return formatted("{}", *value); }
  std::string operator()(const std::vector<std::string>* values) const {
    std::string text;
    for (const std::string& value : *values) text += (text.empty() ? "" : " ") + value;
    return text;
  }
  template <class T>
  std::string operator()(const std::optional<T>* value) const {
    return *value ? (*this)(&**value) : "";
  }
};

// Returns all facts that determine the result of a run, as names and values.
Result<Json> describe(const std::string& command, const std::vector<std::vector<Option>>& tables,
                      const InputOptions& input) {
  Json run = {{"chronormal", kVersion}, {"command", command}};
  for (const std::vector<Option>& table : tables) {
    for (const Option& option : table) {
      const std::string name = option.spelling.substr(0, option.spelling.find(' '));
      if (name == "-o,--output" || name == "--force" || name == "-q,--quiet" || name == "--resume") continue;
      if (std::string value = std::visit(ValueText{}, option.target); !value.empty()) run[name] = std::move(value);
    }
  }
  if (!input.samples.empty()) return run;
  const Result<std::vector<FileIdentity>> files = identify_files(input);
  if (!files) return files.error();
  for (const FileIdentity& file : files.value()) run["file " + file.path] = file.text();
  return run;
}

std::string quoted_value(const Json& run, const std::string& name) {
  return run.contains(name) && run[name].is_string() ? formatted("'{}'", run[name].get<std::string>()) : "not given";
}

// Returns the first difference between two descriptions of runs in words, or an empty text if they are equal.
std::string difference(const Json& old, const Json& now) {
  if (!old.is_object()) return "its first line is damaged";
  std::vector<std::string> names;
  for (const auto& item : now.items()) names.push_back(item.key());
  for (const auto& item : old.items()) names.push_back(item.key());
  for (const std::string& name : names) {
    const std::string before = quoted_value(old, name), after = quoted_value(now, name);
    if (before != after) return formatted("{} was {} in that run and is {} now", name, before, after);
  }
  return "";
}

Error of_another_run(const std::string& path, const std::string& what) {
  return misuse(path, formatted("this journal belongs to another run ({}); repeat that run, or remove the journal to "
                                "start this run from the beginning",
                                what));
}

std::string as_file(std::string_view text) { return plain(text); }

}  // namespace

CommandRun::CommandRun(std::string command, const CommonOptions& common, std::optional<Shard> shard,
                       std::optional<Journal> journal)
    : command_(std::move(command)), common_(common), shard_(shard), journal_(std::move(journal)) {
  if (journal_) say_at_end("chronormal: the finished part is kept beside the output; repeat the command to go on\n");
}

CommandRun::~CommandRun() {
  if (!journal_) return;
  say_at_end(nullptr);
  if (is_finished_) return;
  if (journal_->is_empty() && journal_->remove()) return;
  say(command_, formatted("the finished part is kept in {}; repeat the command to go on", journal_->path()),
      Tone::kWarning);
}

Status CommandRun::prepare(const Input& input, const Motion& motion, ProgressCallback progress,
                           const std::string& things, SegmentRun& run) {
  run.shard = has_ranks() ? std::optional(own_shard()) : shard_;
  run.peers = ranks_as_peers();
  run.expansion = input.expansion();
  run.progress = watching_ranks(std::move(progress));
  if (!journal_) return Success{};
  if (input.document() != nullptr || motion.kind != MotionKind::kSequence)
    return misuse("--resume",
                  "--resume is only for sequences of keyframes, and this input is of another kind; leave --resume out");
  run.journal = &*journal_;
  const std::size_t done = journal_->records().size();
  if (done > 0 && !common_.quiet)
    say(command_,
        formatted("an earlier run has finished {} of the {}; this run computes the others", grouped(done), things),
        Tone::kWarning);
  return Success{};
}

std::vector<Part> CommandRun::gather(const std::string& own) {
  std::vector<Part> parts;
  for (std::string& text : gather_texts(own))
    parts.push_back({formatted("the result of MPI process {}", parts.size()), std::move(text)});
  return parts;
}

Status CommandRun::finish(std::string_view text) {
  std::error_code error;
  bool is_there = false;
  if (journal_ && !common_.force && std::filesystem::is_regular_file(path_of(common_.output), error)) {
    const Result<FileBytes> file = FileBytes::open(common_.output);
    is_there = file && file.value().bytes() == as_file(text);
  }
  if (Status written = is_there ? Success{} : print_to(common_.output, text, common_.force); !written) return written;
  return finish();
}

Status CommandRun::finish() {
  Status removed = journal_ ? journal_->remove() : Success{};
  is_finished_ = removed.ok();
  return removed;
}

std::vector<Option> RunArguments::options(const std::string& of_what) {
  return {{"--shard I/N", &shard, of_what, {.rare = true}},
          {"--resume",
           &resume,
           "go on where an interrupted run of this command ended\nFinished work is kept in the file OUT.journal. The "
           "result has the same bytes as that of a run without a break",
           {.rare = true}}};
}

Result<std::optional<Shard>> RunArguments::read_shard() const {
  if (!shard) return std::optional<Shard>();
  const std::string_view words = *shard;
  const std::size_t slash = words.find('/');
  std::size_t index = 0, count = 0;
  const auto is_number = [](std::string_view digits, std::size_t& value) {
    const auto [end, code] = from_chars(digits.data(), digits.data() + digits.size(), value);
    return code == std::errc{} && end == digits.data() + digits.size();
  };
  const bool is_share = slash != std::string_view::npos && is_number(words.substr(0, slash), index) &&
                        is_number(words.substr(slash + 1), count) && index >= 1 && index <= count;
  if (!is_share)
    return misuse(
        "--shard",
        formatted("'{}' is not a share; write I/N with I from 1 to N, such as 1/8 for the first of 8 shares", *shard));
  return std::optional(Shard{index - 1, count});
}

Status RunArguments::check(const std::string& other) const {
  const std::string option = shard ? "--shard" : resume ? "--resume" : other;
  if (const std::size_t copies = count_of_copies(); copies > 1 && !shard)
    return misuse("mpirun",
                  formatted("mpirun has started {} copies of a program without MPI, and each would do all of the work; "
                            "build the program with -DCHRONORMAL_MPI=ON, or give each copy its own --shard",
                            copies));
  if (has_ranks() && !option.empty())
    return misuse(option,
                  "this option cannot be used with mpirun; leave the option out, or run the command without mpirun");
  const Result<std::optional<Shard>> read = read_shard();
  return read ? Status(Success{}) : Status(read.error());
}

std::optional<Shard> RunArguments::share() const { return has_ranks() ? own_shard() : read_shard().value(); }

Status RunArguments::check_output(const CommonOptions& common) const {
  if (!resume) return chronormal::check_output(common.output, common.force);
  if (is_stream(common.output))
    return misuse("--resume", "--resume needs an output file, beside which it keeps its journal; add --output FILE");
  std::error_code error;
  const bool goes_on = std::filesystem::exists(path_of(journal_name(common.output)), error);
  return chronormal::check_output(common.output, common.force || goes_on);
}

Result<std::unique_ptr<CommandRun>> RunArguments::begin(const std::string& command,
                                                        const std::vector<std::vector<Option>>& tables,
                                                        const InputOptions& input, const CommonOptions& common) const {
  const auto begun = [&](std::optional<Journal> journal) {
    return std::make_unique<CommandRun>(command, common, read_shard().value(), std::move(journal));
  };
  if (!resume) return begun({});
  if (!input.base.empty())
    return misuse("--resume", "--resume is only for sequences of keyframes; leave --resume out with --base");
  const Result<Json> run = describe(command, tables, input);
  if (!run) return run.error();
  const std::string text = run.value().dump(-1, ' ', false, Json::error_handler_t::replace);
  Result<Journal> journal = Journal::open(journal_name(common.output), text);
  if (!journal) return journal.error();
  if (journal.value().run() != text && journal.value().records().empty()) {
    // The old run has recorded no result yet, so removing its journal loses nothing.
    if (const Status removed = journal.value().remove(); !removed) return removed.error();
    journal = Journal::open(journal_name(common.output), text);
    if (!journal) return journal.error();
  }
  if (journal.value().run() != text) {
    const Json old = Json::parse(journal.value().run(), nullptr, false);
    return of_another_run(journal.value().path(), difference(old, run.value()));
  }
  return begun(std::move(journal).value());
}

Status refuse_shares(const RunArguments& run, const char* what) {
  if (!has_ranks() && !run.shard) return Success{};
  return misuse(has_ranks() ? "mpirun" : "--shard", what);
}

}  // namespace chronormal::cli
