// Defines the command `compare`: its options, and the output of its result. A run with --shard writes only its part of
// the result.
#include <cmath>
#include <memory>
#include <optional>

#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "chronormal/workflow/compare.h"
#include "cli/commands/compare_blend.h"
#include "cli/commands/compare_truth.h"
#include "cli/options/command.h"
#include "cli/options/outputs.h"
#include "cli/options/run.h"
#include "cli/reports/compare_report.h"
#include "cli/reports/figure_report.h"
#include "cli/reports/truth_report.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/text.h"
#include "core/charconv.h"
#include "workflow/compare/compared.h"
#include "workflow/compare/face_figure.h"
#include "workflow/json/json.h"

namespace chronormal::cli {
namespace {

constexpr std::size_t kMostSamples = 1000000;

struct CompareArguments {
  InputOptions input;
  CommonOptions common;
  std::optional<std::string> schemes;  // names between commas; the default depends on the elements
  std::optional<std::size_t> samples;
  ElementArguments elements{"faces"};
  std::string weighting;            // if empty, area
  std::string access;               // if empty, random
  std::string table;                // if empty, text for people
  std::optional<std::string> face;  // N or N:SEGMENT
  bool each = false;
  bool json = false;
  bool csv = false;
  bool no_times = false;
  bool certify = false;
  std::optional<double> tolerance;    // degrees
  std::optional<std::string> errors;  // the file to which the error of every sample is written
  RunArguments run;
  BlendArguments blend;
  TruthArguments truth;

  [[nodiscard]] std::size_t sample_count() const { return samples.value_or(21); }
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

std::vector<std::string> scheme_names(const CompareArguments& options) {
  return options.schemes ? split_at_commas(*options.schemes) : std::vector<std::string>();
}

// Returns the first given option that has no effect together with --blend, or an empty text.
std::string option_of_schemes(const CompareArguments& options) {
  if (!options.access.empty()) return "--access";
  if (options.samples) return "--samples";
  if (options.schemes) return "--schemes";
  if (options.errors) return "--errors";
  if (options.run.shard) return "--shard";
  if (options.run.resume) return "--resume";
  if (options.certify) return "--certify";
  if (options.tolerance) return "--tolerance";
  if (options.input.is_curved()) return "--path";
  if (!options.weighting.empty()) return "--weighting";
  if (!options.table.empty()) return "--table";
  return options.each ? "--each" : "";
}

std::string compare_footer() {
  std::string text = "Schemes:\n";
  for (const SchemeDescription& scheme : scheme_descriptions())
    text += formatted("  {:<24}{}\n", scheme.name, scheme.summary);
  return text +
         "\nExamples:\n"
         "  chronormal compare frames/\n"
         "  chronormal compare a.obj b.obj --schemes linear,slerp,circle:timed --json\n"
         "  chronormal compare --each walk/ run/ --sample twist\n"
         "  chronormal compare --base face.obj targets/\n"
         "  chronormal compare face.glb --elements vertices\n"
         "  chronormal compare --each walk/ run/ --table latex -o tables.tex\n"
         "  chronormal compare walk/ --tolerance 0.5\n"
         "  chronormal compare face.glb --blend 100\n"
         "  chronormal compare walk/ --truth 2\n"
         "  chronormal compare a.obj b.obj --face 12 --schemes linear,quaternion:matrix\n"
         "\nExit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input, 4 no scheme is within the tolerance";
}

std::vector<std::vector<Option>> tables(CompareArguments& options) {
  const auto check_access = [](const std::string& value) {
    return value == "random" || value == "sequential" ? "" : "the access must be random or sequential";
  };
  const auto check_table = [](const std::string& value) {
    return value == "text" || value == "operations" || value == "latex" ? ""
                                                                        : "the table must be text, operations or latex";
  };
  return {
      input_table(options.input),
      {{"--each", &options.each,
        "compare several motions side by side\nEvery INPUT and every --sample is a motion of its own"},
       {"--schemes A,B,...", &options.schemes, "compare these schemes, in this order (listed below)"},
       {"--samples N",
        &options.samples,
        "compare at N moments of each segment\nBoth ends of the segment are included. The default is 21",
        {.check = check_whole(2, kMostSamples), .rare = true}}},
      options.elements.table(),
      {{"--weighting NAME",
        &options.weighting,
        "choose how much each face counts in a vertex normal\nNeeds --elements vertices or corners. The default is "
        "area, and sample --help lists the others",
        {.rare = true}},
       {"--access KIND",
        &options.access,
        "choose how moments are computed: random or sequential\nWith random (default), each moment is computed alone. "
        "With sequential, each moment is computed from the moment before",
        {.check = check_access, .rare = true}}},
      {{"--certify",
        &options.certify,
        "bound the largest error of each scheme at any time\nThe bound is in degrees, is proven, and includes errors "
        "of rounding, so no sample exceeds the bound",
        {.rare = true}},
       {"--tolerance DEG", &options.tolerance,
        "find the cheapest scheme whose error never exceeds DEG degrees\nThe errors are bounded as with --certify. If "
        "there is no such scheme, the exit code is 4"}},
      options.blend.table(),
      options.truth.table(),
      {{"--face N",
        &options.face,
        "show the normals that each scheme makes for face N, counted from 0\nThe face is taken in segment 0, or in "
        "segment S if N:S is given. With --json, the output has all data of Figures 1 to 3 of the paper",
        {.rare = true}},
       {"--errors FILE",
        &options.errors,
        "write the error of every face (or what --elements says) at every moment, in degrees\nA file whose name ends "
        "in .npz, for programs, has all errors. A file whose name ends in .ply, for MeshLab and Blender, has the "
        "largest error of each face as the property quality, and is for one scheme",
        {.rare = true}}},
      options.run.options("compare only share I of N equal shares of the segments\nI is a number from 1 to N. OUT "
                          "becomes a shard, and chronormal merge puts the shards of all N runs together"),
      {{"--json", &options.json, "print the result as JSON, for programs"},
       {"--csv",
        &options.csv,
        "print the result as comma-separated values, with a line for each scheme",
        {.excludes = "--json"}},
       {"--table KIND",
        &options.table,
        "print another kind of table\nKIND is text (default), operations, which adds the cost of an evaluation, or "
        "latex, which has both tables of the paper for your meshes",
        {.excludes = "--json", .check = check_table, .rare = true}},
       {"--no-times",
        &options.no_times,
        "leave measured times out, so that each run prints the same text",
        {.rare = true}}},
      options.common.table(false)};
}

// Compares one motion. If several ranks (processes of MPI) divide the work, the result is empty on all but the first,
// which alone prints.
Result<std::optional<NamedComparison>> compare_one(Input& input, const CompareArguments& options, Progress& progress,
                                                   CommandRun& run, CompareRun& segments) {
  const Result<MotionStream*> motion = input.stream();
  if (!motion) return motion.error();
  CompareOptions compare_options{scheme_names(options),
                                 options.sample_count(),
                                 options.access == "sequential" ? Access::kSequential : Access::kRandom,
                                 {},
                                 options.elements.options().value()};
  compare_options.keep_errors = options.errors.has_value();
  if (!options.weighting.empty()) compare_options.weighting = make_weighting(options.weighting).value();
  compare_options.certify = options.certify;
  compare_options.tolerance = options.tolerance;
  const Motion& outline = motion.value()->motion();
  const std::size_t count = options.run.share().value_or(Shard{}).of(outline.segments.size()).count;
  const Status prepared = run.prepare(input, outline, progress.callback("comparing", "segments", count), segments,
                                      segment_part, read_compared_segment);
  if (!prepared) return prepared.error();
  Result<Comparison> comparison = compare(*motion.value(), compare_options, segments);
  progress.clear();
  if (!comparison) return comparison.error();
  if (options.input.is_curved()) comparison.value().cut = input.cut_path();
  NamedComparison named{input.name(), std::move(comparison).value(), target_names(input).value()};
  const Result<bool> prints = CommandRun::join(
      compare_part(named, segments),
      [&](std::span<const Part> parts) -> Result<NamedComparison> {
        Result<NamedComparison> all = merge_compare_parts(parts);
        if (all) all.value().targets = named.targets;
        return all;
      },
      named);
  if (!prints) return prints.error();
  return prints.value() ? std::optional(std::move(named)) : std::nullopt;
}

// Returns the first given option that is not supported when several ranks divide one motion, or an empty text.
std::string option_of_one_process(const CompareArguments& options) {
  if (options.errors) return "--errors";
  if (options.face) return "--face";
  if (options.blend.rows) return "--blend";
  if (options.truth.every) return "--truth";
  return options.each ? "--each" : "";
}

// Compares the inputs one after the other, with only one motion in memory. The result is empty on all ranks but the
// first.
Result<std::vector<NamedComparison>> compare_inputs(const CompareArguments& options, Progress& progress,
                                                    CommandRun& run, CompareRun& segments) {
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
  // Wrong options of all inputs are reported before the first input is read.
  for (const InputOptions& input : inputs) {
    if (const Status status = check_input(input); options.each && !status) return status.error();
  }
  std::vector<NamedComparison> comparisons;
  for (InputOptions& wanted : inputs) {
    wanted.stream = true;
    Result<Input> input = open_input("compare", wanted, progress);
    Result<std::optional<NamedComparison>> comparison =
        input ? compare_one(input.value(), options, progress, run, segments)
              : Result<std::optional<NamedComparison>>(input.error());
    if (!comparison) {
      Error error = comparison.error();
      const bool several = wanted.samples.size() + (wanted.files.empty() ? 0 : 1) > 1;
      if (options.each && !wanted.files.empty() && wanted.base.empty())
        error.place = wanted.files.front() + ": " + error.place;
      if (several) error.message += ", or --each to compare them side by side";
      return error;
    }
    if (!comparison.value()) break;
    comparisons.push_back(std::move(*comparison.value()));
    if (options.each && !wanted.base.empty())
      // All inputs of --each have the same base, so the name of the target tells them apart.
      comparisons.back().name = wanted.files.front();
  }
  return comparisons;
}

// Checks that no output replaces another output or an input.
Status check_files(const CompareArguments& options) {
  std::vector<NamedFile> outputs = {{"OUT", options.common.output}}, read = input_files(options.input);
  if (options.errors) outputs.push_back({"--errors", *options.errors});
  for (const std::string& file : options.each ? options.input.files : std::vector<std::string>()) {
    InputOptions one = options.input;
    one.files = {file};
    for (NamedFile& found : input_files(one)) read.push_back(std::move(found));
  }
  return check_distinct(outputs, read);
}

Result<int> run_blend(const CompareArguments& options) {
  if (const std::string option = option_of_schemes(options); !option.empty())
    return misuse(option, "this option cannot be used with --blend; leave this option or --blend out");
  if (const Status output = check_output(options.common.output, options.common.force); !output) return output.error();
  if (const Status distinct = check_files(options); !distinct) return distinct.error();
  Progress progress(options.common.quiet);
  const auto comparison = compare_blend_input(options.input, options.elements, options.blend, progress);
  if (!comparison) return comparison.error();
  const std::string text = options.json  ? blend_json(comparison.value())
                           : options.csv ? blend_csv(comparison.value())
                                         : blend_table(comparison.value());
  if (const Status written = print_to(options.common.output, text, options.common.force); !written)
    return written.error();
  return kExitDone;
}

// Returns the first given option that has no effect together with --truth, or an empty text.
std::string option_of_samples(const CompareArguments& options) {
  if (!options.access.empty()) return "--access";
  if (options.samples) return "--samples";
  if (options.certify) return "--certify";
  if (options.tolerance) return "--tolerance";
  if (options.errors) return "--errors";
  if (options.run.shard) return "--shard";
  if (options.run.resume) return "--resume";
  if (options.input.is_curved()) return "--path";
  if (!options.weighting.empty()) return "--weighting";
  if (!options.table.empty()) return "--table";
  return options.each ? "--each" : "";
}

Result<int> run_truth(const CompareArguments& options) {
  if (const std::string option = option_of_samples(options); !option.empty())
    return misuse(option, "this option cannot be used with --truth; leave this option or --truth out");
  if (const Status output = check_output(options.common.output, options.common.force); !output) return output.error();
  Progress progress(options.common.quiet);
  const auto comparison =
      compare_input_with_truth(options.input, options.elements, options.truth, scheme_names(options), progress);
  if (!comparison) return comparison.error();
  const std::string text = options.json  ? truth_json(comparison.value())
                           : options.csv ? truth_csv(comparison.value())
                                         : truth_table(comparison.value());
  if (const Status written = print_to(options.common.output, text, options.common.force); !written)
    return written.error();
  return kExitDone;
}

// Returns the first given option that has no effect together with --face, or an empty text.
std::string option_of_all_faces(const CompareArguments& options) {
  if (!options.access.empty()) return "--access";
  if (options.certify) return "--certify";
  if (options.tolerance) return "--tolerance";
  if (options.blend.rows) return "--blend";
  if (options.truth.every) return "--truth";
  if (options.errors) return "--errors";
  if (options.run.shard) return "--shard";
  if (options.run.resume) return "--resume";
  if (options.csv) return "--csv";
  if (!options.table.empty()) return "--table";
  if (!options.weighting.empty()) return "--weighting";
  return options.each ? "--each" : "";
}

Result<FaceFigureOptions> figure_options(const CompareArguments& options) {
  FaceFigureOptions result{0, 0, scheme_names(options), options.sample_count()};
  const std::string_view text = *options.face;
  const char* const end = text.data() + text.size();
  auto read = from_chars(text.data(), end, result.face);
  if (read.ec == std::errc{} && read.ptr != end && *read.ptr == ':')
    read = from_chars(read.ptr + 1, end, result.segment);
  if (read.ec != std::errc{} || read.ptr != end)
    return misuse("--face", "the value must be the number of a face, or FACE:SEGMENT, both counted from 0");
  return result;
}

Result<int> run_face(const CompareArguments& options) {
  if (const std::string option = option_of_all_faces(options); !option.empty())
    return misuse(option, "this option cannot be used with --face; leave this option or --face out");
  if (const auto elements = options.elements.options(); !elements || elements.value().kind != ElementKind::kFaces)
    return misuse("--elements", "this option cannot be used with --face; leave this option or --face out");
  const Result<FaceFigureOptions> how = figure_options(options);
  if (!how) return how.error();
  if (const Status distinct = check_files(options); !distinct) return distinct.error();
  if (const Status output = check_output(options.common.output, options.common.force); !output) return output.error();
  Progress progress(options.common.quiet);
  Result<Input> input = open_input("compare", options.input, progress);
  if (!input) return input.error();
  const Result<const Motion*> motion = input.value().motion();
  progress.clear();
  if (!motion) return motion.error();
  const Result<FaceFigure> figure = face_figure(*motion.value(), how.value());
  if (!figure) return misuse("--face", figure.error().message);
  const std::string text = options.json ? face_figure_json(input.value().name(), figure.value())
                                        : figure_table(input.value().name(), figure.value());
  if (const Status written = print_to(options.common.output, text, options.common.force); !written)
    return written.error();
  return kExitDone;
}

Result<int> run(const CompareArguments& options) {
  if (const Status status = options.run.check(option_of_one_process(options)); !status) return status.error();
  if (!options.face && options.blend.rows && options.truth.every)
    return misuse("--truth", "--truth is for sequences and --blend for blend shapes; leave one of the two out");
  if (!options.face && options.blend.rows) return run_blend(options);
  // Wrong names of schemes are reported before any long computation.
  for (const std::string& name : scheme_names(options)) {
    if (name.empty()) return misuse("--schemes", "the list has an empty name; remove the extra comma");
    if (const auto scheme = make_scheme(name); !scheme) return scheme.error();
  }
  if (const auto elements = options.elements.options(); !elements) return elements.error();
  if (options.face) return run_face(options);
  if (!options.weighting.empty()) {
    const auto weighting = make_weighting(options.weighting);
    if (!weighting) return misuse("--weighting", weighting.error().message);
    const bool by_area = weighting.value() == Weighting::kArea;
    if (!by_area && options.elements.options().value().kind == ElementKind::kFaces)
      return misuse("--weighting",
                    "a weighting has no meaning for normals of faces; add --elements vertices or corners");
    if (!by_area && (options.certify || options.tolerance))
      return misuse(options.certify ? "--certify" : "--tolerance",
                    "errors can only be bounded with --weighting area; leave this option or --weighting out");
  }
  if (const Status distinct = check_files(options); !distinct) return distinct.error();
  if (options.truth.every) return run_truth(options);
  if (options.tolerance && !(*options.tolerance >= 0 && std::isfinite(*options.tolerance)))
    return misuse("--tolerance", "the tolerance must be an angle of at least 0 degrees, such as 0.5");
  if (options.access == "sequential" && (options.certify || options.tolerance))
    return misuse(options.certify ? "--certify" : "--tolerance",
                  "errors can only be bounded for random access; leave this option or --access out");
  if (const Status output = options.run.check_output(options.common); !output) return output.error();

  if (options.run.shard && options.each)
    return misuse("--shard", "--shard divides the work on a single motion; leave --each or --shard out");
  if (options.run.shard && options.errors)
    return misuse("--errors", "--errors and --shard cannot be used together; leave one of the two out");
  if (options.run.shard && (options.json || options.csv))
    return misuse(options.json ? "--json" : "--csv",
                  "a shard cannot be written in this format; leave this option out, and combine the shards with "
                  "'chronormal merge', which writes JSON");
  if (!options.table.empty() && (options.csv || options.run.shard))
    return misuse("--table", options.csv ? "--table and --csv cannot be used together; leave one of the two out"
                                         : "a shard cannot be printed as a table; leave --table out");
  if (options.run.resume && (options.each || options.errors))
    return misuse("--resume",
                  "--resume cannot be used with --each or --errors, since --resume keeps only the sums of errors of "
                  "one motion; leave --resume out");
  if (options.errors) {
    if (options.each) return misuse("--errors", "--errors is only for a single motion; leave --each out");
    if (const Status output = check_errors_output(*options.errors, options.common.force); !output)
      return output.error();
  }

  Progress progress(options.common.quiet);
  CompareArguments same = options;
  const auto run = options.run.begin("compare", tables(same), options.input, options.common);
  if (!run) return run.error();
  CompareRun segments;
  auto comparisons = compare_inputs(options, progress, *run.value(), segments);
  if (!comparisons) return comparisons.error();
  if (comparisons.value().empty()) return kExitDone;  // only the first rank prints

  if (options.errors) {
    const Status written =
        write_errors(comparisons.value().front().comparison.errors, *options.errors, options.common.force);
    if (!written) return written.error();
  }
  const bool with_times = !options.no_times && run.value()->is_timed();
  std::string text;
  if (options.run.shard)
    text = compare_part(comparisons.value().front(), segments);
  else if (options.json)
    text = compare_json(comparisons.value(), options.each, with_times);
  else if (options.csv)
    text = compare_csv(comparisons.value(), with_times);
  else if (options.table == "latex")
    text = compare_latex(comparisons.value());
  else if (options.each)
    text = compare_tables_side_by_side(comparisons.value());
  else
    text = compare_table(comparisons.value().front(), {with_times, options.table == "operations"});
  if (const Status written = run.value()->finish(text); !written) return written.error();
  int exit = kExitDone;
  for (const NamedComparison& input : comparisons.value()) {
    if (!options.tolerance || input.comparison.cheapest || options.run.shard) continue;
    const std::vector<SchemeComparison>& schemes = input.comparison.schemes;
    const bool is_judged = std::any_of(schemes.begin(), schemes.end(),
                                       [](const SchemeComparison& scheme) { return scheme.quality.count > 0; });
    say("compare",
        is_judged ? formatted("{}: no scheme is always within the tolerance of {}; compare more schemes with "
                              "--schemes, or allow a larger --tolerance",
                              printable(input.name), with_degrees(with_digits(*options.tolerance, 6)))
                  : formatted("{}: no scheme could be judged, since no face has an area at any sample; run chronormal "
                              "inspect to list faces without area",
                              printable(input.name)),
        Tone::kError);
    exit = kExitBeyond;
  }
  return exit;
}

}  // namespace

Command compare_command() {
  auto options = std::make_shared<CompareArguments>();
  return {"compare",
          "Compare ways to interpolate normals with the exact normals, on your mesh",
          tables(*options),
          compare_footer(),
          [options] { return run(*options); },
          {},
          true};
}

}  // namespace chronormal::cli
