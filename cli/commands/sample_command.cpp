#include <charconv>
#include <cmath>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>

#include "chronormal/io/output.h"
#include "chronormal/workflow/sample.h"
#include "cli/options/command.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/table.h"

namespace chronormal::cli {
namespace {

constexpr std::size_t kMostTimes = 1000000;

struct Options {
  InputOptions input;
  CommonOptions common;
  std::string times;                 // as written; empty: none
  std::vector<std::string> weights;  // a list per pose
  ElementArguments elements = {"vertices"};
  std::string weighting = "area";
  std::string length = "unit";
  std::string hard_edges;  // empty: by the crease angle
  std::string format;      // empty: by the extension
};

std::string footer() {
  std::string text = "Weightings:\n";
  for (const WeightingInfo& weighting : kWeightings)
    text += formatted("  {:<12}{}\n", weighting.name, weighting.summary);
  return text +
         "\nOUT is chosen by its extension: .npy, an array (times, elements, 3) of float32; .npz, normals with times,\n"
         "positions and faces; .ply or .obj, the mesh with its normals, a file per time, where %d in the name stands\n"
         "for the number. An element without a normal has (0, 0, 0).\n"
         "\nExamples:\n"
         "  chronormal sample walk/ --times 0:0.25:12 -o normals.npy\n"
         "  chronormal sample body.obj walk.pc2 --times 1.5 --elements corners --crease 60 -o shaded.obj\n"
         "  chronormal sample face.glb --weights 1,0,0 --weights 0.5,0.5,0 --weighting angle -o 'face_%d.ply'\n"
         "  chronormal sample maya.obj --elements corners --weighting area-angle --hard-edges groups -o same.obj\n"
         "\nExit codes: 0 done, 1 failed, 2 usage, 3 input invalid";
}

// The parts of a list between separators.
std::vector<std::string_view> split(std::string_view list, char separator) {
  std::vector<std::string_view> parts;
  for (std::size_t first = 0;;) {
    const std::size_t end = list.find(separator, first);
    parts.push_back(list.substr(first, end == std::string_view::npos ? end : end - first));
    if (end == std::string_view::npos) return parts;
    first = end + 1;
  }
}

Result<double> parse_number(const std::string& option, std::string_view word) {
  std::string_view digits = word;
  while (digits.starts_with(' ')) digits.remove_prefix(1);
  while (digits.ends_with(' ')) digits.remove_suffix(1);
  if (digits.size() > 1 && digits.starts_with('+') && digits[1] != '-') digits.remove_prefix(1);
  double value = 0;
  const auto [end, code] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
  if (digits.empty() || code != std::errc{} || end != digits.data() + digits.size() || !std::isfinite(value))
    return misuse(option, formatted("'{}' is not a number", word));
  return value;
}

// The times of A:STEP:B, of which the last is B itself if the steps lead there.
Status append_range(const std::vector<std::string_view>& ends, std::string_view text, std::vector<double>& times) {
  const auto wrong = [&](const char* why) { return misuse("--times", formatted("'{}': {}", text, why)); };
  if (ends.size() != 3) return wrong("a range is FIRST:STEP:LAST");
  double numbers[3] = {};
  for (std::size_t i = 0; i < 3; ++i) {
    const Result<double> number = parse_number("--times", ends[i]);
    if (!number) return number.error();
    numbers[i] = number.value();
  }
  const auto [first, step, last] = numbers;
  if (!(step > 0) || !(first <= last)) return wrong("the step must be positive, and the range ascend");
  const double steps = (last - first) / step;
  if (!(steps + static_cast<double>(times.size()) < static_cast<double>(kMostTimes)))
    return wrong("these are more than 1,000,000 times");
  const double rounded = std::round(steps);
  const bool reaches = std::fabs(steps - rounded) <= 1e-9 * std::fmax(1, steps);
  const auto count = static_cast<std::size_t>(reaches ? rounded : std::floor(steps));
  for (std::size_t i = 0; i <= count; ++i)
    times.push_back(reaches && i == count ? last : first + static_cast<double>(i) * step);
  return Success{};
}

Result<std::vector<double>> parse_times(const std::string& list) {
  std::vector<double> times;
  for (const std::string_view part : split(list, ',')) {
    const std::vector<std::string_view> ends = split(part, ':');
    if (ends.size() > 1) {
      if (Status status = append_range(ends, part, times); !status) return status.error();
      continue;
    }
    const Result<double> time = parse_number("--times", part);
    if (!time) return time.error();
    times.push_back(time.value());
  }
  if (times.size() > kMostTimes) return misuse("--times", "these are more than 1,000,000 times");
  return times;
}

Result<std::vector<double>> parse_weights(const std::string& list) {
  std::vector<double> weights;
  for (const std::string_view part : split(list, ',')) {
    const Result<double> weight = parse_number("--weights", part);
    if (!weight) return weight.error();
    weights.push_back(weight.value());
  }
  return weights;
}

// What was asked for, after the words were understood.
struct Request {
  SampleOptions sample;
  Moments moments;
  SampleOutput output;
};

Result<SampleOptions> sample_options(const Options& options) {
  Result<ElementOptions> elements = options.elements.options();
  if (!elements) return elements.error();
  const ElementKind kind = elements.value().kind;
  const auto weighting = make_weighting(options.weighting);
  if (!weighting) return misuse("--weighting", weighting.error().message);
  if (options.length != "unit" && options.length != "area") return misuse("--length", "it must be unit or area");
  const bool by_area = weighting.value() == Weighting::kArea;
  if (options.length == "area" && !by_area)
    return misuse("--length", "only --weighting area has a length that means something");
  if (kind == ElementKind::kFaces && !by_area)
    return misuse("--weighting", "faces are not weighted: it goes with vertices or corners");
  if (!options.hard_edges.empty()) {
    if (options.hard_edges != "groups" && options.hard_edges != "normals")
      return misuse("--hard-edges", "it must be groups or normals");
    if (kind != ElementKind::kCorners) return misuse("--hard-edges", "only --elements corners can have hard edges");
    if (options.elements.crease_angle != 180)
      return misuse("--hard-edges", "edges are hard by the file or by --crease, not both");
    if (!options.input.samples.empty())
      return misuse("--hard-edges", "a built-in morph stores no hard edges: give an OBJ or glTF file");
  }
  return SampleOptions{elements.value(), weighting.value(),
                       options.length == "area" ? NormalLength::kArea : NormalLength::kUnit};
}

Result<SampleFormat> format_of(const Options& options) {
  if (!options.format.empty()) {
    auto format = make_sample_format(options.format);
    if (!format) return misuse("--format", format.error().message);
    return format;
  }
  if (options.common.output == "-") return SampleFormat::kNpy;
  if (const auto format = find_sample_format(options.common.output)) return *format;
  return misuse(options.common.output, "the name must end in .npy, .npz, .ply or .obj, or --format say what it is");
}

Result<Request> understand(const Options& options) {
  Result<SampleOptions> sample = sample_options(options);
  if (!sample) return sample.error();
  const Result<SampleFormat> format = format_of(options);
  if (!format) return format.error();
  Request request{sample.value(), {}, {options.common.output, format.value(), options.common.force}};
  if (!options.times.empty() && !options.weights.empty())
    return misuse("--weights", "a motion has times, or targets with weights, not both");
  if (!options.times.empty()) {
    Result<std::vector<double>> times = parse_times(options.times);
    if (!times) return times.error();
    request.moments.times = std::move(times).value();
  }
  for (const std::string& list : options.weights) {
    Result<std::vector<double>> weights = parse_weights(list);
    if (!weights) return weights.error();
    request.moments.weights.push_back(std::move(weights).value());
  }
  if (const Status status = check_input(options.input); !status) return status.error();
  if (const auto files = sample_files(request.output, request.sample.elements.kind, request.moments.count()); !files)
    return files.error();
  return request;
}

std::string range_of(const Motion& motion) {
  double first = motion.keyframes.front().time, last = first;
  for (const auto& keyframe : motion.keyframes) {
    first = std::fmin(first, keyframe.time);
    last = std::fmax(last, keyframe.time);
  }
  return formatted("{} to {}", first, last);
}

// Whether the moments go with the motion. Those of a mesh that stands still become none.
Status fit_moments(const Motion& motion, Moments& moments) {
  if (motion.segments.empty()) {
    if (!moments.weights.empty()) return misuse("--weights", "the mesh has no targets");
    for (const double time : moments.times) {
      if (time != 0) return misuse("--times", "the mesh does not move: leave it out, or give 0");
    }
    if (moments.times.size() > 1) return misuse("--times", "the mesh does not move: one time is enough");
    moments.times.clear();
    return Success{};
  }
  if (motion.kind == MotionKind::kTargets) {
    const std::size_t count = motion.segments.size();
    const std::string how = formatted("give --weights, {} number{} for each pose", count, count == 1 ? "" : "s");
    if (!moments.times.empty()) return misuse("--times", "blend shapes have no times: " + how);
    if (moments.weights.empty()) return misuse("--weights", "the input is blend shapes: " + how);
    return Success{};
  }
  if (!moments.weights.empty())
    return misuse("--weights", "only blend shapes have weights; this motion has --times from " + range_of(motion));
  if (moments.times.empty()) return misuse("--times", "say at which times: the motion goes from " + range_of(motion));
  return Success{};
}

// Takes the hard edges from where the input stores them: its smoothing groups, or its normals.
Status take_hard_edges(Input& input, const std::string& what, ElementOptions& elements) {
  const std::string& file = input.shaded_by();
  if (file.empty())
    return misuse("--hard-edges",
                  input.name() + " stores neither normals nor smoothing groups: give an OBJ or glTF file");
  if (what == "groups") {
    if (input.document() != nullptr) return misuse("--hard-edges", "a glTF file has no smoothing groups: give normals");
    if (input.group_of_face().empty())
      return invalid_input(file, "the file has no smoothing groups (lines that begin with s)");
    elements.group_of_face = input.group_of_face();
    return Success{};
  }
  const Result<const StoredNormals*> normals = input.normals();
  if (!normals) return normals.error();
  if (normals.value()->of_keyframes.empty())
    return invalid_input(file, input.document() != nullptr ? "no primitive of the motion has normals"
                                                           : "the file has no normals (faces of the form v//vn)");
  const std::vector<float>& first = normals.value()->of_keyframes.front();
  elements.normal_of_corner = VectorView<const float>::packed(first.data(), first.size() / 3);
  return Success{};
}

// Says how much was asked for, where that is much: it is not refused.
void announce(const Topology& topology, const Request& request) {
  constexpr double kMuch = 1e9;
  const ElementKind kind = request.sample.elements.kind;
  const std::size_t elements = kind == ElementKind::kFaces     ? topology.face_count()
                               : kind == ElementKind::kCorners ? topology.corner_count()
                                                               : topology.vertex_count();
  const double bytes =
      3.0 * sizeof(float) * static_cast<double>(elements) * static_cast<double>(request.moments.count());
  if (bytes >= kMuch)
    say("sample", formatted("the normals of {} times {} elements are {:.1f} GB", grouped(request.moments.count()),
                            grouped(elements), bytes / 1e9));
}

Result<int> run(const Options& options) {
  Result<Request> understood = understand(options);
  if (!understood) return understood.error();
  Request& request = understood.value();
  Progress progress(options.common.quiet);
  InputOptions wanted = options.input;
  wanted.allow_mesh = true;
  if (!options.hard_edges.empty()) wanted.shading = KeepShading::kFirst;
  Result<Input> input = open_input(std::move(wanted), progress);
  if (!input) return input.error();
  const Result<const Motion*> read = input.value().motion();
  if (!read) return read.error();
  const Motion& motion = *read.value();
  if (const Status status = fit_moments(motion, request.moments); !status) return status.error();
  if (!options.common.quiet) announce(motion.topology, request);
  if (!options.hard_edges.empty()) {
    const Status status = take_hard_edges(input.value(), options.hard_edges, request.sample.elements);
    if (!status) return status.error();
  }
  const auto written =
      write_samples(motion, request.sample, request.moments, request.output, progress.callback("sampling"));
  progress.clear();
  if (!written) return written.error();
  if (written.value().zeros > 0)
    say("sample", formatted("{} of {} normals of {} are (0, 0, 0): there is no area to give them one",
                            written.value().zeros, written.value().normals, options.elements.kind()));
  return kExitDone;
}

}  // namespace

Command sample_command() {
  auto options = std::make_shared<Options>();
  return {"sample",
          "Write the normals of a motion at chosen times",
          {input_table(options->input),
           {{"--times LIST", &options->times,
             "in seconds of the motion: 0,0.5,1 or FIRST:STEP:LAST; none where\n"
             "a mesh does not move"},
            {"--weights W1,W2,...", &options->weights,
             "a pose of blend shapes: one weight for each target; repeat it\n"
             "for more poses"}},
           options->elements.table(),
           {{"--weighting NAME", &options->weighting, "how the faces around a vertex count (listed below)"},
            {"--length KIND", &options->length, "unit (default), or area: of weighting area, n itself"},
            {"--hard-edges KIND", &options->hard_edges,
             "corners: hard edges as the first .obj, the base or a glTF file has them, by its\n"
             "smoothing groups (s) or by its own normals (vn): groups, normals"},
            {"--format NAME", &options->format, "of OUT: npy (default for -), npz, ply, obj"}},
           options->common.table(true)},
          footer(),
          [options] { return run(*options); }};
}

}  // namespace chronormal::cli
