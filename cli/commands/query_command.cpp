// Defines the command `query`, which answers questions about whole intervals of time. Each question has its own file
// (cli/commands/query_question.h). This file has their common parts: the input, the span of time, and the output of the
// answer.

#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/io/output.h"
#include "cli/commands/query_question.h"
#include "cli/options/command.h"
#include "cli/options/outputs.h"
#include "cli/reports/query_report.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/text.h"
#include "core/nearest.h"
#include "io/bytes/expansion.h"
#include "workflow/json/json.h"

namespace chronormal::cli {
namespace {

struct QueryArguments {
  InputOptions input;
  CommonOptions common;
  std::string question;
  QuerySpan span;
  ElementArguments elements{"faces"};
  bool json = false;
  std::vector<Question> questions = {cones_question(), facing_question(), contain_question(), collapse_question(),
                                     shutter_question()};
};

// Returns true if the command line gave an option a value.
bool was_given(const Option& option) {
  return std::visit(
      [](const auto* target) {
        using Target = std::remove_const_t<std::remove_pointer_t<decltype(target)>>;
        if constexpr (std::is_same_v<Target, bool>)
          return *target;
        else if constexpr (requires { target->has_value(); })
          return target->has_value();
        else if constexpr (requires { target->empty(); })
          return !target->empty();
        else
          return *target != Target{};
      },
      option.target);
}

Result<Question> find_question(const QueryArguments& options) {
  const auto& questions = options.questions;
  std::string names;
  std::vector<std::string> list;
  for (const Question& question : questions) {
    names += (names.empty() ? "" : ", ") + question.name;
    list.push_back(question.name);
  }
  if (options.question.empty()) return misuse("QUESTION", "the question is missing; choose one of " + names);
  const auto found = std::find_if(questions.begin(), questions.end(),
                                  [&](const Question& question) { return question.name == options.question; });
  if (found == questions.end()) {
    const std::string nearest = nearest_name(options.question, list);
    return misuse(
        "QUESTION",
        formatted("there is no question '{}'{} {}", printable(options.question),
                  nearest.empty() ? "; choose one of" : formatted("; did you mean {}? Choose one of", nearest), names));
  }
  for (const Question& other : questions) {
    for (const Option& option : other.options)
      if (other.name != found->name && was_given(option))
        return misuse(option.spelling.substr(0, option.spelling.find(' ')),
                      "this option is only for query " + other.name + "; leave the option out");
  }
  return *found;
}

Result<int> run(const QueryArguments& options) {
  const Result<Question> question = find_question(options);
  if (!question) return question.error();
  const Result<Ask> ask = question.value().understand();
  if (!ask) return ask.error();
  const Result<ElementOptions> elements = options.elements.options();
  if (!elements) return elements.error();
  if (options.elements.asked && !question.value().takes_elements)
    return misuse("--elements",
                  formatted("query {} can only be asked of faces; leave --elements out", question.value().name));
  const std::string& output = options.common.output;
  const bool is_file = !options.json && output != "-";
  if (const Status status =
          is_file ? check_query_output(output, options.common.force) : check_output(output, options.common.force);
      !status)
    return status.error();
  std::vector<NamedFile> read = input_files(options.input);
  for (const Option& option : question.value().options) {
    const auto* const file = std::get_if<std::string*>(&option.target);
    if (option.spelling.starts_with("--points ") && file != nullptr) read.push_back({"--points", **file});
  }
  if (const Status distinct = check_distinct({{"OUT", output}}, read); !distinct) return distinct.error();

  Progress progress(options.common.quiet);
  InputOptions behind_skins = options.input;
  behind_skins.skins = true;
  Result<Input> input = open_input("query", behind_skins, progress);
  if (!input) return input.error();
  const Result<const Motion*> motion = input.value().motion();
  if (!motion) return motion.error();
  QuerySpan span = options.span;
  const Expansion allowed = input.value().expansion();
  span.expansion = &allowed;
  const std::string& name = input.value().name();
  const auto named = [&name](Error error) {
    if (error.code == ErrorCode::kInvalidInput) error.place = name + ", " + error.place;
    return error;
  };
  const Result<QueryAnswer> answer =
      ask.value()(*motion.value(), span, progress.callback(question.value().name), elements.value());
  progress.clear();
  if (!answer) return named(answer.error());
  const std::uint64_t bytes = options.json ? json_bytes_of_query(answer.value()) : bytes_of_query(answer.value());
  if (const Status status = allowed.check(bytes, "the answer"); !status) return named(status.error());
  const Status written =
      is_file ? write_query(answer.value(), output, options.common.force)
              : print_to(output, options.json ? query_json(name, answer.value()) : query_text(name, answer.value()),
                         options.common.force);
  if (!written) return written.error();
  std::size_t rows = 0;
  for (const QueryTable& table : answer.value().tables) rows += table.rows();
  say_written(options.common, formatted("{} of the answer", counted(rows, "row", "rows")));
  return kExitDone;
}

std::string footer(const std::vector<Question>& questions) {
  std::string text = "Questions:\n";
  for (const Question& question : questions) text += formatted("  {:<12}{}\n", question.name, question.summary);
  return text +
         "\nThe answer is a table, with --json a JSON object, and with -o OUT.npz arrays that have a row for each "
         "interval,\nface or vertex. Times t are fractions of a segment. docs/uses.md says what is guaranteed.\n"
         "\nExamples:\n"
         "  chronormal query collapse face.glb\n"
         "  chronormal query facing walk/ --eye 4,-5,2,5,-4,1 --silhouettes -o sides.npz\n"
         "  chronormal query shutter walk/ --elements vertices --from 1 --to 1.02 -o means.npz\n"
         "  chronormal query collapse walk/ --from 1 --to 2.5 --json\n"
         "  chronormal query collapse body.obj walk.pc2 -o collapses.npz\n"
         "  chronormal query contain balloon.glb --points dust.npy -o crossings.npz\n"
         "\nExit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input";
}

}  // namespace

Command query_command() {
  auto options = std::make_shared<QueryArguments>();
  // The command takes an interval of time instead of a range of keyframes, so --from and --to have another meaning
  // here.
  std::vector<Option> input = input_table(options->input, {{"--from", ""}, {"--to", ""}}), own;
  input.insert(input.begin(), {"QUESTION", &options->question, "answer this question (listed below)"});
  for (const Question& question : options->questions)
    for (Option option : question.options) {
      option.help = question.name + ": " + option.help;
      own.push_back(std::move(option));
    }
  for (Option& option : options->elements.table()) {
    option.help = "facing, shutter: " + option.help;
    own.push_back(std::move(option));
  }
  own.push_back(
      {"--from T", &options->span.from,
       "examine the motion from time T on, in seconds\nFor targets, T is a weight. The default is the beginning"});
  own.push_back({"--to T", &options->span.to,
                 "examine the motion up to time T, in seconds\nFor targets, T is a weight. The default is the end"});
  own.push_back({"--json", &options->json, "print the result as JSON, for programs"});
  return {"query",
          "Answer questions about normals over whole intervals of time",
          {std::move(input), std::move(own), options->common.table(false)},
          footer(options->questions),
          [options] { return run(*options); }};
}

}  // namespace chronormal::cli
