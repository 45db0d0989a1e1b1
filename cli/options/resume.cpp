// Describes a run by its options and its files, and holds this against the journal.
#include "cli/options/resume.h"

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
#include "io/bytes/file.h"
#include "io/input/input_identity.h"

namespace chronormal::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string journal_name(const std::string& output) { return output + ".journal"; }

// The value of an option as a text; empty where it was not given.
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

// Everything that decides the result, as names and values.
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

// Returns what differs first between two runs, in words; the text is empty where nothing differs.
std::string difference(const Json& old, const Json& now) {
  if (!old.is_object()) return "it describes no run";
  std::vector<std::string> names;
  for (const auto& item : now.items()) names.push_back(item.key());
  for (const auto& item : old.items()) names.push_back(item.key());
  for (const std::string& name : names) {
    const std::string before = quoted_value(old, name), after = quoted_value(now, name);
    if (before != after) return formatted("{} was {} then, and is {} now", name, before, after);
  }
  return "";
}

Error of_another_run(const std::string& path, const std::string& what) {
  return misuse(path, formatted("this is the journal of another run: {}; repeat that run, or remove the journal to "
                                "begin anew",
                                what));
}

std::string as_file(std::string_view text) { return plain(text); }

}  // namespace

ResumedRun::ResumedRun(std::string command, std::string output, Journal journal)
    : command_(std::move(command)), output_(std::move(output)), journal_(std::move(journal)) {
  say_at_end("chronormal: what is done is kept beside the output; repeat the command to go on\n");
}

ResumedRun::~ResumedRun() {
  say_at_end(nullptr);
  if (is_finished_) return;
  if (journal_.is_empty() && journal_.remove()) return;
  say(command_, formatted("what is done is kept in {}; repeat the command to go on", journal_.path()), Tone::kWarning);
}

Status ResumedRun::finish(std::string_view text, bool force) {
  std::error_code error;
  bool is_there = false;
  if (!force && std::filesystem::is_regular_file(output_, error)) {
    const Result<FileBytes> file = FileBytes::open(output_);
    is_there = file && file.value().bytes() == as_file(text);
  }
  if (Status written = is_there ? Success{} : print_to(output_, text, force); !written) return written;
  return finish();
}

Status ResumedRun::finish() {
  Status removed = journal_.remove();
  is_finished_ = removed.ok();
  return removed;
}

Option ResumeArgument::option() {
  return {"--resume", &asked,
          "keep what is done in OUT.journal, and go on from there where an earlier run of this\n"
          "command was interrupted: the same bytes as without a break"};
}

Status ResumeArgument::check_output(const CommonOptions& common) const {
  if (!asked) return chronormal::check_output(common.output, common.force);
  if (is_stream(common.output)) return misuse("--resume", "it keeps its journal beside a file: add --output FILE");
  std::error_code error;
  const bool goes_on = std::filesystem::exists(journal_name(common.output), error);
  return chronormal::check_output(common.output, common.force || goes_on);
}

Result<std::unique_ptr<ResumedRun>> ResumeArgument::begin(const std::string& command,
                                                          const std::vector<std::vector<Option>>& tables,
                                                          const InputOptions& input,
                                                          const CommonOptions& common) const {
  if (!asked) return std::unique_ptr<ResumedRun>();
  if (!input.base.empty()) return misuse("--resume", "it goes on with sequences: targets of a base are judged at once");
  const Result<Json> run = describe(command, tables, input);
  if (!run) return run.error();
  const std::string text = run.value().dump(-1, ' ', false, Json::error_handler_t::replace);
  Result<Journal> journal = Journal::open(journal_name(common.output), text);
  if (!journal) return journal.error();
  if (journal.value().run() != text && journal.value().records().empty()) {
    // Nothing was done yet, so there is nothing to lose.
    if (const Status removed = journal.value().remove(); !removed) return removed.error();
    journal = Journal::open(journal_name(common.output), text);
    if (!journal) return journal.error();
  }
  if (journal.value().run() != text) {
    const Json old = Json::parse(journal.value().run(), nullptr, false);
    return of_another_run(journal.value().path(), difference(old, run.value()));
  }
  return std::make_unique<ResumedRun>(command, common.output, std::move(journal).value());
}

void say_goes_on(const std::string& command, std::size_t done, const std::string& what, bool quiet) {
  if (done > 0 && !quiet)
    say(command, formatted("goes on: the journal has {} {} of an earlier run", grouped(done), what), Tone::kWarning);
}

}  // namespace chronormal::cli
