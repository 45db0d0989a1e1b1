// Defines the command `sample`: its options, and the files of normals that it writes.
#include <memory>
#include <utility>

#include "chronormal/io/output.h"
#include "chronormal/workflow/sample.h"
#include "cli/options/command.h"
#include "cli/options/moments.h"
#include "cli/options/outputs.h"
#include "cli/options/run.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/table.h"
#include "core/text.h"
#include "workflow/sample/continued_samples.h"
#include "workflow/sample/scheme_normals.h"

namespace chronormal::cli {
namespace {

struct SampleArguments {
  InputOptions input;
  CommonOptions common;
  MomentArguments moments;
  ElementArguments elements = {"vertices"};
  std::string weighting = "area";
  std::string length = "unit";
  std::string scheme;      // if empty, exact normals
  std::string hard_edges;  // if empty, hard edges follow the crease angle
  std::string format;      // if empty, the extension of OUT decides
  RunArguments run;
};

std::string sample_footer() {
  std::string text = "Weightings:\n";
  for (const WeightingInfo& weighting : kAllWeightings)
    text += formatted("  {:<15}{}\n", weighting.name, weighting.summary);
  text += "\nSchemes:\n";
  for (const SchemeDescription& scheme : scheme_descriptions())
    text += formatted("  {:<24}{}\n", scheme.name, scheme.summary);
  return text +
         "\nThe name of OUT chooses the format: .npy is an array (times, elements, 3) of float32; .npz has normals, "
         "times,\npositions and faces; .ply or .obj is the mesh with its normals, a file for each time, with %d in the "
         "name for\nits number. An element without a normal gets (0, 0, 0).\n"
         "\nExamples:\n"
         "  chronormal sample walk/ --times 0:0.25:12 -o normals.npy\n"
         "  chronormal sample body.obj walk.pc2 --times 1.5 --elements corners --crease 60 -o shaded.obj\n"
         "  chronormal sample face.glb --weights jawOpen=0.5,smile=1 -o talking.npz\n"
         "  chronormal sample face.glb --animation Smile --times keys -o keys.npz\n"
         "  chronormal sample face.glb --weights 1,0,0 --weights 0.5,0.5,0 --weighting angle -o 'face_%d.ply'\n"
         "  chronormal sample walk/ --scheme quaternion:matrix --elements faces --times 0:0.1:12 -o matrix.npz\n"
         "  chronormal sample walk/ --scheme quadratic --step 100 -o played.npy\n"
         "  chronormal sample maya.obj --elements corners --weighting area-angle --hard-edges groups -o same.obj\n"
         "\nExit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input";
}

std::vector<std::vector<Option>> tables(SampleArguments& options) {
  return {
      input_table(options.input),
      options.moments.table(),
      options.elements.table(),
      {{"--weighting NAME", &options.weighting, "choose how much each face counts in a vertex normal (listed below)"},
       {"--length KIND",
        &options.length,
        "set the length of normals: unit (default) or area\nWith unit, the length is 1. With area, the normal of a "
        "face is as long as twice its area, and the normal of a vertex is the sum of the normals of its faces; "
        "--weighting must be area",
        {.rare = true}},
       {"--scheme NAME", &options.scheme,
        "interpolate normals instead of computing exact normals\nThe scheme interpolates in each segment, as in "
        "compare. The schemes are listed below"}},
      {{"--hard-edges KIND", &options.hard_edges,
        "take hard edges from the file: groups or normals\nNeeds --elements corners. With groups, edges between "
        "smoothing groups are hard; with normals, edges at which stored normals differ. Groups and normals are read "
        "from the first .obj, the base or a glTF file"},
       {"--format NAME",
        &options.format,
        "write OUT in this format: npy, npz, ply or obj\nThe default is the format that the name of OUT ends in, and "
        "npy for the standard output (-)",
        {.rare = true}}},
      options.run.options(
          "write only share I of N equal shares of the times\nI is a number from 1 to N. chronormal merge puts .npy "
          "shards together. .ply and .obj files are numbered as they would be without --shard"),
      options.common.table(true)};
}

struct Request {
  SampleOptions sample;
  AskedMoments asked;
  SampleOutput output;
  SegmentRun run;
};

Result<SampleOptions> sample_options(const SampleArguments& options) {
  Result<ElementOptions> elements = options.elements.options();
  if (!elements) return elements.error();
  const ElementKind kind = elements.value().kind;
  const auto weighting = make_weighting(options.weighting);
  if (!weighting) return misuse("--weighting", weighting.error().message);
  if (options.length != "unit" && options.length != "area")
    return misuse("--length", "the length must be unit (1) or area (twice the area of a face)");
  const bool by_area = weighting.value() == Weighting::kArea;
  if (options.length == "area" && !by_area)
    return misuse("--length", "--length area needs --weighting area; leave --length or --weighting out");
  if (kind == ElementKind::kFaces && !by_area)
    return misuse("--weighting", "a weighting has no meaning for normals of faces; add --elements vertices or corners");
  if (!options.scheme.empty()) {
    if (!by_area)
      return misuse("--weighting", "a scheme can only be used with --weighting area; leave --weighting out");
    if (options.length == "area")
      return misuse("--length", "a scheme can only be used with --length unit; leave --length out");
    if (const auto scheme = scheme_for(options.scheme, kind); !scheme)
      return misuse("--scheme", scheme.error().message);
  } else if (!options.moments.step.empty()) {
    return misuse("--step", "--step needs a scheme; name a scheme with --scheme");
  }
  if (!options.hard_edges.empty()) {
    if (options.hard_edges != "groups" && options.hard_edges != "normals")
      return misuse("--hard-edges", "the kind of hard edges must be groups or normals");
    if (kind != ElementKind::kCorners)
      return misuse("--hard-edges", "only corners can have hard edges; add --elements corners");
    if (options.elements.crease_angle != 180)
      return misuse("--hard-edges", "--hard-edges and --crease cannot be used together; leave one of the two out");
    if (!options.input.samples.empty())
      return misuse("--hard-edges",
                    "a built-in morph has no hard edges; give an OBJ or glTF file, or leave --hard-edges out");
  }
  return SampleOptions{elements.value(), weighting.value(),
                       options.length == "area" ? NormalLength::kArea : NormalLength::kUnit, options.scheme};
}

Result<SampleFormat> format_of(const SampleArguments& options) {
  if (!options.format.empty()) {
    auto format = make_sample_format(options.format);
    if (!format) return misuse("--format", format.error().message);
    return format;
  }
  if (options.common.output == "-") return SampleFormat::kNpy;
  if (const auto format = find_sample_format(options.common.output)) return *format;
  return misuse(
      options.common.output,
      "the format of the output is unknown; choose a name that ends in .npy, .npz, .ply or .obj, or add --format");
}

Result<Request> understand(const SampleArguments& options) {
  Result<SampleOptions> sample = sample_options(options);
  if (!sample) return sample.error();
  const Result<SampleFormat> format = format_of(options);
  if (!format) return format.error();
  Result<AskedMoments> asked = understand(options.moments);
  if (!asked) return asked.error();
  sample.value().stepping = asked.value().stepping;
  if (sample.value().stepping && !make_scheme(options.scheme).value()->sequential_operations())
    return misuse("--step", options.scheme +
                                " cannot be played step by step, since this scheme computes each normal alone; give "
                                "--times instead of --step");
  if (const Status status = options.run.check(); !status) return status.error();
  Request request{
      sample.value(), std::move(asked).value(), {options.common.output, format.value(), options.common.force}, {}};
  request.run.shard = options.run.share();
  request.run.peers = ranks_as_peers();
  if (const Status status = check_input(options.input); !status) return status.error();
  if (options.run.resume) {
    if (request.sample.stepping)
      return misuse("--resume", "--resume cannot be used with --step; leave one of the two out");
    if (format.value() != SampleFormat::kNpy)
      return misuse("--resume",
                    "--resume needs a .npy file as the output; write .npy, or divide the times among several runs");
    if (const Status output = options.run.check_output(options.common); !output) return output.error();
    const Status distinct = check_distinct({{"OUT", options.common.output}}, input_files(options.input));
    if (!distinct) return distinct.error();
    // A run with --resume may find that OUT exists already, because an interrupted run may have written it just before
    // its end. write_samples() detects this case.
    return request;
  }
  const auto files = sample_files(request.output, request.sample.elements.kind, request.asked.count(), request.run);
  if (!files) return files.error();
  std::vector<NamedFile> outputs;
  for (const std::string& file : files.value()) outputs.push_back({"OUT", file});
  if (const Status distinct = check_distinct(outputs, input_files(options.input)); !distinct) return distinct.error();
  return request;
}

// Sets the hard edges of `elements` by the smoothing groups of the input if `what` is "groups", or else by its normals.
Status take_hard_edges(Input& input, const std::string& what, ElementOptions& elements) {
  const std::string& file = input.shaded_by();
  if (file.empty())
    return misuse("--hard-edges",
                  input.name() +
                      " has neither normals nor smoothing groups; give an OBJ or glTF file, or leave --hard-edges out");
  if (what == "groups") {
    if (input.document() != nullptr)
      return misuse("--hard-edges", "a glTF file has no smoothing groups; give --hard-edges normals");
    if (input.group_of_face().empty())
      return invalid_input(
          file, "the file has no smoothing groups (lines that begin with s); try --hard-edges normals or --crease");
    elements.group_of_face = input.group_of_face();
    return Success{};
  }
  const Result<const StoredNormals*> normals = input.normals();
  if (!normals) return normals.error();
  if (normals.value()->of_keyframes.empty())
    return invalid_input(file,
                         input.document() != nullptr
                             ? "the file has no normals; try --crease"
                             : "the file has no normals (faces written as v//vn); try --hard-edges groups or --crease");
  const std::vector<float>& first = normals.value()->of_keyframes.front();
  elements.normal_of_corner = VectorView<const float>::packed(first.data(), first.size() / 3);
  return Success{};
}

// Prints a warning if the result will have 1 GB or more. Such a result is not refused.
void announce(const Topology& topology, ElementKind kind, std::size_t moments) {
  constexpr double kMuch = 1e9;
  const std::size_t elements = kind == ElementKind::kFaces     ? topology.face_count()
                               : kind == ElementKind::kCorners ? topology.corner_count()
                                                               : topology.vertex_count();
  const double bytes = 3.0 * sizeof(float) * static_cast<double>(elements) * static_cast<double>(moments);
  if (bytes >= kMuch)
    say("sample",
        formatted("the result will have {:.1f} GB, for {} with {} each{}", bytes / 1e9,
                  counted(moments, "moment", "moments"), counted(elements, "normal", "normals"),
                  moments > 1 ? "; to make the result smaller, give fewer moments" : ""),
        Tone::kWarning);
}

Result<int> run(const SampleArguments& options) {
  Result<Request> understood = understand(options);
  if (!understood) return understood.error();
  Request& request = understood.value();
  Progress progress(options.common.quiet);
  InputOptions wanted = options.input;
  wanted.allow_mesh = true;
  wanted.stream = true;
  if (!options.hard_edges.empty()) wanted.shading = KeepShading::kFirst;
  Result<Input> input = open_input("sample", std::move(wanted), progress);
  if (!input) return input.error();
  const Result<MotionStream*> read = input.value().stream();
  if (!read) return read.error();
  const Motion& motion = read.value()->motion();
  const Result<Moments> moments = moments_of(input.value(), request.asked);
  if (!moments) return moments.error();
  if (!options.common.quiet) announce(motion.topology, request.sample.elements.kind, moments.value().count());
  if (!options.hard_edges.empty()) {
    const Status status = take_hard_edges(input.value(), options.hard_edges, request.sample.elements);
    if (!status) return status.error();
  }
  SampleArguments same = options;
  const auto begun = options.run.begin("sample", tables(same), options.input, options.common);
  if (!begun) return begun.error();
  CommandRun& run = *begun.value();
  const Status prepared =
      run.prepare(input.value(), motion, progress.callback("sampling", "times"), "times", request.run);
  if (!prepared) return prepared.error();
  const auto written = write_samples(*read.value(), request.sample, moments.value(), request.output, request.run);
  progress.clear();
  if (!written) return written.error();
  if (const Status done = run.finish(); !done) return done.error();
  if (written.value().zeros > 0)
    say("sample",
        formatted("of {} of {}, {} written as (0, 0, 0), since the faces there have no area or their normals cancel "
                  "each other",
                  counted(written.value().normals, "normal", "normals"), options.elements.kind(),
                  counted(written.value().zeros, "is", "are")),
        Tone::kWarning);
  if (request.sample.stepping && !options.common.quiet) {
    const Drift& drift = written.value().drift;
    say_text(formatted("scheme {} played step by step drifts from its curve by up to {}, at {} {} and time {}\n",
                       options.scheme, with_degrees(with_digits(drift.largest * kDegreesPerRadian, 3)),
                       one_element(request.sample.elements.kind), grouped(drift.output), with_digits(drift.time, 6)));
  }
  say_written(options.common, counted(written.value().normals, "normal", "normals"));
  return kExitDone;
}

}  // namespace

Command sample_command() {
  auto options = std::make_shared<SampleArguments>();
  return {"sample",
          "Write the normals of a motion at chosen times, or of targets at chosen weights",
          tables(*options),
          sample_footer(),
          [options] { return run(*options); },
          {},
          true};
}

}  // namespace chronormal::cli
