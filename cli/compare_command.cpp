#include <fmt/core.h>

#include "chronormal/io/builtin_morphs.h"
#include "chronormal/io/file.h"
#include "chronormal/workflow/compare.h"
#include "cli/command.h"
#include "cli/compare_blend.h"
#include "cli/compare_report.h"

namespace chronormal::cli {
namespace {

constexpr std::size_t kMostSamples = 1000000;

struct Options {
  InputOptions input;
  CommonOptions common;
  std::vector<std::string> schemes;  // empty: those that are usual for the elements
  std::size_t samples = 21;
  ElementArguments elements{"faces"};
  std::string access = "random";
  bool each = false;
  bool json = false;
  bool csv = false;
  bool no_times = false;
  BlendArguments blend;
  bool elements_given = false;
  std::string of_schemes;  // an option that was given, which has no meaning with --blend
};

std::vector<std::string> split_at_commas(const std::string& list) {
  std::vector<std::string> parts;
  for (std::size_t first = 0;;) {
    const std::size_t comma = list.find(',', first);
    std::string part = list.substr(first, comma - first);
    part.erase(0, part.find_first_not_of(' '));
    part.erase(part.find_last_not_of(' ') + 1);
    parts.push_back(std::move(part));
    if (comma == std::string::npos) return parts;
    first = comma + 1;
  }
}

std::string footer() {
  std::string text = "Schemes:\n";
  for (const SchemeDescription& scheme : scheme_descriptions())
    text += fmt::format("  {:<24}{}\n", scheme.name, scheme.summary);
  return text +
         "\nExamples:\n"
         "  chronormal compare frames/\n"
         "  chronormal compare a.obj b.obj --schemes linear,slerp,circle:timed --json\n"
         "  chronormal compare --each walk/ run/ --sample twist\n"
         "  chronormal compare --base face.obj targets/\n"
         "  chronormal compare face.glb --elements vertices\n"
         "  chronormal compare face.glb --blend 100\n"
         "\nExit codes: 0 done, 1 failed, 2 usage, 3 input invalid";
}

Result<NamedComparison> compare_one(NamedMotion input, const Options& options, Progress& progress) {
  const CompareOptions compare_options{options.schemes, options.samples,
                                       options.access == "sequential" ? Access::kSequential : Access::kRandom,
                                       progress.callback("comparing"), options.elements.options().value()};
  auto comparison = compare(input.motion, compare_options);
  progress.clear();
  if (!comparison) return comparison.error();
  return NamedComparison{std::move(input.name), std::move(comparison).value()};
}

// One motion at a time is in memory.
Result<std::vector<NamedComparison>> compare_inputs(const Options& options, Progress& progress) {
  std::vector<InputOptions> inputs;
  if (options.each) {
    InputOptions one = options.input;
    one.samples.clear();
    for (const std::string& file : options.input.files) {
      one.files = {file};
      inputs.push_back(one);
    }
    one.files.clear();
    for (const std::string& sample : options.input.samples) {
      one.samples = {sample};
      inputs.push_back(one);
    }
    if (inputs.empty()) inputs.push_back(options.input);
  } else {
    inputs.push_back(options.input);
  }
  // Find out about all wrong inputs before the first is read.
  for (const InputOptions& input : inputs) {
    if (const Status status = check_input(input); options.each && !status) return status.error();
  }
  std::vector<NamedComparison> comparisons;
  for (const InputOptions& input : inputs) {
    auto motion = read_input(input, progress);
    if (!motion) {
      Error error = motion.error();
      const bool several = input.samples.size() + (input.files.empty() ? 0 : 1) > 1;
      if (options.each && !input.files.empty() && input.base.empty())
        error.place = input.files.front() + ": " + error.place;
      if (several) error.message += ", or --each to compare them side by side";
      return error;
    }
    if (options.each && !input.base.empty()) motion.value().name = input.files.front();  // the base is that of all
    auto comparison = compare_one(std::move(motion).value(), options, progress);
    if (!comparison) return comparison.error();
    comparisons.push_back(std::move(comparison).value());
  }
  return comparisons;
}

int run_blend(const Options& options) {
  if (!options.of_schemes.empty())
    return report("compare",
                  {ErrorCode::kUsage, options.of_schemes, "it is about schemes, and does not go with --blend"});
  if (const Status output = check_output(options.common.output, options.common.force); !output)
    return report("compare", output.error());
  Progress progress(options.common.quiet);
  const auto comparison =
      compare_blend_input(options.input, options.elements, options.elements_given, options.blend, progress);
  if (!comparison) return report("compare", comparison.error());
  const std::string text = options.json  ? blend_json(comparison.value())
                           : options.csv ? blend_csv(comparison.value())
                                         : blend_table(comparison.value());
  if (const Status written = write_output(options.common.output, text, options.common.force); !written)
    return report("compare", written.error());
  return kExitDone;
}

int run(const Options& options) {
  if (options.blend.rows) return run_blend(options);
  // Find out about wrong names before anything long begins.
  if (options.samples < 2 || options.samples > kMostSamples)
    return report("compare", {ErrorCode::kUsage, "--samples", "it must be a whole number from 2 to 1,000,000"});
  for (const std::string& name : options.schemes) {
    if (name.empty()) return report("compare", {ErrorCode::kUsage, "--schemes", "there is an empty name in the list"});
    if (const auto scheme = make_scheme(name); !scheme) return report("compare", scheme.error());
  }
  if (const auto elements = options.elements.options(); !elements) return report("compare", elements.error());
  if (const Status output = check_output(options.common.output, options.common.force); !output)
    return report("compare", output.error());

  Progress progress(options.common.quiet);
  const auto comparisons = compare_inputs(options, progress);
  if (!comparisons) return report("compare", comparisons.error());

  const bool with_times = !options.no_times;
  std::string text;
  if (options.json)
    text = compare_json(comparisons.value(), options.each, with_times);
  else if (options.csv)
    text = compare_csv(comparisons.value(), with_times);
  else if (options.each)
    text = compare_tables_side_by_side(comparisons.value());
  else
    text = compare_table(comparisons.value().front(), with_times);
  if (const Status written = write_output(options.common.output, text, options.common.force); !written)
    return report("compare", written.error());
  return kExitDone;
}

}  // namespace

void add_compare_command(CLI::App& program, int& exit_code) {
  CLI::App* command =
      program.add_subcommand("compare", "Hold ways to interpolate normals against the exact ones, on your mesh");
  command->group("Commands");
  auto options = std::make_shared<Options>();
  options->input.add_to(*command);
  command->add_flag("--each", options->each, "every INPUT and --sample is a motion of its own, side by side");
  command
      ->add_option_function<std::string>(
          "--schemes", [options](const std::string& list) { options->schemes = split_at_commas(list); },
          "which schemes, in which order (listed below)")
      ->type_name("A,B,...");
  command->add_option("--samples", options->samples, "samples per segment, ends included (default 21)")->type_name("N");
  options->elements.add_to(*command);
  command->add_option("--access", options->access, "random (default), or sequential: played step by step")
      ->type_name("KIND")
      ->check(CLI::IsMember({"random", "sequential"}).description(""));
  options->blend.add_to(*command);
  CLI::Option* json = command->add_flag("--json", options->json, "one JSON object");
  command->add_flag("--csv", options->csv, "comma-separated values, a line per scheme")->excludes(json);
  command->add_flag("--no-times", options->no_times, "leave out measured times: the same output on every run");
  options->common.add_to(*command, false);
  command->footer(footer());
  command->callback([options, command, &exit_code] {
    options->elements_given = command->count("--elements") > 0;
    for (const char* const name : {"--each", "--schemes", "--samples", "--access"})
      if (command->count(name) > 0) options->of_schemes = name;
    exit_code = run(*options);
  });
}

}  // namespace chronormal::cli
