// Defines the command `audit`: its options, and the output of its result. A run with --shard writes only its part of
// the result.
#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <optional>
#include <utility>

#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "chronormal/normals/weighting.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/viewers.h"
#include "cli/options/command.h"
#include "cli/options/outputs.h"
#include "cli/options/run.h"
#include "cli/reports/audit/audit_files.h"
#include "cli/reports/audit/audit_report.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/table.h"
#include "cli/terminal/text.h"
#include "core/charconv.h"
#include "workflow/audit/watched_audit.h"
#include "workflow/json/json.h"

namespace chronormal::cli {
namespace {

struct AuditArguments {
  InputOptions input;
  CommonOptions common;
  std::string rule;  // if empty, the rule depends on the input
  JudgeArguments judge;
  std::optional<std::string> poses;  // "random", or the file of the poses
  std::optional<std::string> weights;
  AuditLimits limits;
  std::optional<std::string> errors;  // the file to which the error of every sample is written
  RunArguments run;
  bool no_weld = false;
  bool json = false;
};

// The message for the case that the user sets a limit (--tolerance or --tears) but nothing in the input moves. Such an
// input must not pass, because an export may have lost its animations.
constexpr const char* kNothingMoves =
    "nothing could be judged, since no morph target and no animation moves stored normals; export the model again, "
    "with normals, morph targets and animations";

constexpr const char* kDividesSequences =
    "only the work on a sequence of keyframes can be divided, and this input is a glTF file; run the command once, "
    "without --shard and mpirun";

// Quotes a word so that a shell reads the same word back.
std::string shell_word(const std::string& word) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-./,:@%+=";
  if (!word.empty() && word.find_first_not_of(kPlain) == std::string::npos) return word;
  std::string quoted = "'";
  for (const char c : word) quoted += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return printable(quoted + "'");
}

// Returns the words of a command line that name the input, select its keyframes, and choose the path of vertices. A
// recommended command contains these words.
std::string words_of(const InputOptions& input) {
  std::string words;
  constexpr std::size_t kMost = 4;
  for (std::size_t i = 0; i < input.files.size(); ++i) {
    if (i > 0) words += ' ';
    words += i == kMost ? "..." : shell_word(input.files[i]);
    if (i == kMost) break;
  }
  for (const std::string& sample : input.samples) words += "--sample " + sample;
  if (input.frames_per_second != 1) words += formatted(" --fps {}", input.frames_per_second);
  if (input.from > 0) words += formatted(" --from {}", input.from);
  if (input.to) words += formatted(" --to {}", *input.to);
  if (input.every != 1) words += formatted(" --every {}", input.every);
  if (input.loop) words += " --loop";
  if (input.is_curved()) words += formatted(" --path {}", input.path);
  return words;
}

const std::vector<RefusedOption> kRefusedByAudit = {
    {"--world",
     "errors do not depend on where nodes put a mesh, so audit judges each mesh in its own space; leave --world out"}};

std::vector<std::vector<Option>> tables(AuditArguments& options) {
  return {
      input_table(options.input, kRefusedByAudit),
      {{"--rule NAME",
        &options.rule,
        "judge normals as this rule interpolates them between keyframes\nNAME is gltf (default for glTF files), lerp, "
        "nlerp (default for all other inputs), slerp, step or flat",
        {.rare = true}}},
      options.judge.table("judge the normals that these viewers render"),
      {{"--tolerance DEG", &options.limits.degrees,
        "exit with code 4 if an error is larger than DEG degrees\nThe limit applies to each viewer that --for names. "
        "Without this option there is no limit"},
       {"--tears N",
        &options.limits.torn_edges,
        "exit with code 4 if more than N edges are torn at one moment\nAn edge of a glTF file is torn if errors jump "
        "by more than 10 degrees across it, which looks like a fold that the surface does not have. Without this "
        "option there is no limit",
        {.check = check_whole(0)}},
       {"--poses FILE|random", &options.poses,
        "also judge these poses of a glTF file\nFILE lists poses as JSON, such as [{\"jawOpen\": 0.7}, ...], with "
        "weights of morph targets by name. The word random stands for random poses"},
       {"--weights LO:HI",
        &options.weights,
        "judge each morph target alone from weight LO to weight HI\nThe default is 0:1",
        {.rare = true}},
       {"--errors FILE", &options.errors,
        "write the error of every vertex at every moment, in degrees\nA file whose name ends in .npz, for programs, "
        "has all errors. A file whose name ends in .ply, for MeshLab and Blender, has the largest error of each "
        "vertex, as the property quality"},
       {"--no-weld",
        &options.no_weld,
        "do not merge vertices that are at the same point at all times",
        {.rare = true}}},
      options.run.options("judge only share I of N equal shares of a sequence\nI is a number from 1 to N. OUT becomes "
                          "a shard, and chronormal merge puts the shards of all N runs together"),
      {{"--json", &options.json, "print the result as JSON, for programs"}},
      options.common.table(false)};
}

// Audits an input that is not a glTF file. If several ranks (processes of MPI) divide the work, the result is empty on
// all but the first, which alone prints.
Result<std::optional<Audit>> audit_motion(Input& input, const AuditArguments& options, const AuditOptions& how,
                                          CommandRun& run, AuditRun& segments) {
  const Result<MotionStream*> motion = input.stream();
  if (!motion) return motion.error();
  const Result<const StoredNormals*> normals = input.normals();
  if (!normals) return normals.error();
  const Status prepared =
      run.prepare(input, motion.value()->motion(), how.progress, segments, segment_part, read_measured_segment);
  if (!prepared) return prepared.error();
  Result<Audit> found = audit(*motion.value(), *normals.value(), how, segments);
  if (!found) return found.error();
  if (options.input.is_curved()) found.value().cut = input.cut_path();
  const Result<bool> prints = CommandRun::join(
      audit_part(input.name(), found.value(), segments, options.limits.degrees), merge_audit_parts, found.value());
  if (!prints) return prints.error();
  return prints.value() ? std::optional(std::move(found).value()) : std::nullopt;
}

Result<std::optional<Audited>> audit_input(const AuditArguments& options, const AuditOptions& how, Progress& progress,
                                           CommandRun& run, AuditRun& segments) {
  InputOptions wanted = options.input;
  wanted.shading = KeepShading::kAll;
  wanted.stream = true;
  Result<Input> opened = open_input("audit", std::move(wanted), progress);
  if (!opened) return opened.error();
  Input& input = opened.value();
  const GltfDocument* const document = input.document();
  if (const Status known = check_viewers(how.viewers, input); !known) return known.error();
  if (document == nullptr && options.poses)
    return misuse("--poses",
                  "poses can only be judged in a glTF file, and this input has another format; leave --poses out");
  if (document == nullptr && options.weights)
    return misuse("--weights",
                  "weights can only be chosen for a glTF file, and this input has another format; leave --weights out");
  if (document == nullptr && options.limits.torn_edges)
    return misuse(
        "--tears",
        "torn edges can only be counted in a glTF file, and this input has another format; leave --tears out");
  if (document != nullptr && options.run.resume)
    return misuse("--resume",
                  "--resume is only for sequences of keyframes, and this input is of another kind; leave --resume out");
  if (const Status status = document != nullptr ? refuse_shares(options.run, kDividesSequences) : Success{}; !status)
    return status.error();
  std::optional<Audit> found;
  if (document != nullptr) {
    Result<Audit> of_file = audit(*document, how);
    if (!of_file) return of_file.error();
    found = std::move(of_file).value();
  } else {
    Result<std::optional<Audit>> of_motion = audit_motion(input, options, how, run, segments);
    if (!of_motion) return of_motion.error();
    found = std::move(of_motion).value();
  }
  progress.clear();
  if (!found) return std::optional<Audited>();
  const bool can_be_baked = document != nullptr || input.stream().value()->motion().kind != MotionKind::kTargets;
  return std::optional(
      Audited{std::move(input), std::move(*found), options.limits, can_be_baked ? words_of(options.input) : ""});
}

Result<std::array<double, 2>> read_weights(const std::string& text) {
  const std::size_t colon = text.find(':');
  std::array<double, 2> range{};
  const auto is_number = [](std::string_view digits, double& value) {
    const auto [end, code] = from_chars(digits.data(), digits.data() + digits.size(), value);
    return code == std::errc{} && end == digits.data() + digits.size() && std::isfinite(value);
  };
  const std::string_view words = text;
  if (colon == std::string::npos || !is_number(words.substr(0, colon), range[0]) ||
      !is_number(words.substr(colon + 1), range[1]) || !(range[0] < range[1]) || !std::isfinite(range[1] - range[0]))
    return misuse(
        "--weights",
        formatted("'{}' is not a range of weights; write LO:HI, the smaller weight first, such as -1:1", text));
  return range;
}

Result<AuditOptions> understand(const AuditArguments& options, Progress& progress) {
  AuditOptions how;
  if (!options.rule.empty()) {
    const Result<AuditRule> rule = make_audit_rule(options.rule);
    if (!rule) return misuse("--rule", rule.error().message);
    how.rule = rule.value();
  }
  if (const Status named = options.judge.read("audit", how.weighting, how.viewers); !named) return named.error();
  if (!how.viewers.empty() && how.rule && *how.rule != AuditRule::kGltf)
    return misuse("--for", "viewers can only be chosen with the rule gltf; leave --rule or --for out");
  if (options.weights) {
    const Result<std::array<double, 2>> weights = read_weights(*options.weights);
    if (!weights) return weights.error();
    how.weights = weights.value();
  }
  how.is_posed = options.poses.has_value();
  if (options.poses && *options.poses != "random") {
    Result<std::vector<RigPose>> poses = read_poses_file(*options.poses);
    if (!poses) return poses.error();
    how.poses = std::move(poses).value();
  }
  if (options.limits.degrees && !(*options.limits.degrees >= 0 && std::isfinite(*options.limits.degrees)))
    return misuse("--tolerance", "the tolerance must be an angle of at least 0 degrees, such as 0.5");
  if (const Status status = check_input(options.input); !status) return status.error();
  if (options.errors) {
    if (const Status output = check_errors_output(*options.errors, options.common.force); !output)
      return output.error();
  }
  std::vector<NamedFile> outputs = {{"OUT", options.common.output}};
  if (options.errors) outputs.push_back({"--errors", *options.errors});
  std::vector<NamedFile> inputs = input_files(options.input);
  if (options.poses && *options.poses != "random") inputs.push_back({"--poses", *options.poses});
  if (const Status distinct = check_distinct(outputs, inputs); !distinct) return distinct.error();
  if (options.run.shard && options.errors)
    return misuse("--errors", "--errors and --shard cannot be used together; leave one of the two out");
  if (options.run.shard && options.json)
    return misuse(
        "--json",
        "a shard cannot be written as JSON; leave --json out, and combine the shards with 'chronormal merge', which "
        "writes JSON");
  if (options.run.resume && options.errors)
    return misuse("--errors", "--errors and --resume cannot be used together; leave one of the two out");
  how.keep_errors = options.errors.has_value();
  how.samples = options.judge.samples;
  how.animation = options.input.animation;
  how.weld = !options.no_weld;
  how.progress = progress.callback("auditing", "segments");
  return how;
}

// Returns the sentence for an input that does not pass because of errors at samples whose faces almost vanish. `place`
// names the worst of these samples, and ends the sentence.
std::string why_faint(const Audited& audited, const MotionError& error, const std::string& place) {
  return formatted("where faces almost vanish, the worst error is {}, beyond the tolerance of {}{}",
                   with_degrees(with_digits(error.faint_worst, 4)),
                   with_degrees(formatted("{:g}", *audited.limits.degrees)), place);
}

// Returns the sentence for an input that does not pass because more edges are torn at one moment than the limit allows.
std::string why_torn(const Audited& audited, const MotionError& error) {
  return formatted("{} at one moment, more than --tears allows ({})",
                   counted(error.most_torn, "edge is torn", "edges are torn"), grouped(*audited.limits.torn_edges));
}

// Returns the sentence for an input that does not pass because the normals around some vertices cancel.
std::string why_cancelled(const MotionError& error) {
  return formatted(
      "{} no true normal and cannot be judged, since the normals of the faces around the vertex cancel each other",
      counted(error.cancelled, "sample has", "samples have"));
}

// Returns the sentence that says which limit an input exceeds: the tolerance of errors, or else the number of torn
// edges. Each label names the place of one kind of error, and may be empty.
std::string why_beyond(const Audited& audited, const MotionError& error, const std::string& worst_label,
                       const std::string& unlit_label, const std::string& faint_label,
                       const std::string& cancelled_label) {
  const auto at = [](const std::string& label) { return label.empty() ? "" : ": " + label; };
  const std::optional<double> tolerance = audited.limits.degrees;
  if (tolerance && error.unlit > 0)
    return counted(error.unlit, "normal", "normals") +
           " of the file would be zero, infinite or NaN in a viewer, which no tolerance allows" + at(unlit_label);
  if (tolerance && error.worst > *tolerance)
    return formatted("the worst error is {}, beyond the tolerance of {}{}", with_degrees(with_digits(error.worst, 4)),
                     with_degrees(formatted("{:g}", *tolerance)), at(worst_label));
  if (tolerance && error.faint_worst > *tolerance) return why_faint(audited, error, at(faint_label));
  if (tolerance && error.cancelled > 0)
    return why_cancelled(error) + at(cancelled_label) + "; give each side of a sheet its own vertices";
  return why_torn(audited, error);
}

std::string why_beyond(const Audited& audited, const ViewerAudit& found) {
  if (found.beyond > 0 && audited.limits.degrees)
    return formatted("{}: a mesh has {} than this viewer supports; {}", found.viewer.title,
                     counted(found.beyond, "target more", "targets more"), found.viewer.beyond);
  return formatted("{}: {}", found.viewer.title,
                   why_beyond(audited, found.error, worst_label(audited, found), "", "", ""));
}

std::string why_beyond(const Audited& audited) {
  const MotionError& error = audited.audit.error;
  if (!audited.audit.is_judged() && error.cancelled == 0 && error.unlit == 0)
    return "nothing could be judged, since no face that moves has an area; run chronormal inspect to list faces "
           "without area";
  return why_beyond(audited, error, worst_label(audited), unlit_label(audited), faint_label(audited),
                    cancelled_label(audited));
}

// Prints the reason why an input does not pass, or nothing if it passes. `place` is the name of the input if there are
// several. Returns true if the input passes.
bool say_what_is_beyond(const Audited& audited, const std::string& place) {
  if (audited.passed()) return true;
  const std::vector<ViewerAudit>& viewers = audited.audit.viewers;
  if (viewers.empty() || !audited.audit.is_judged()) say("audit", place + why_beyond(audited), Tone::kError);
  for (const ViewerAudit& found : audited.audit.is_judged() ? viewers : std::vector<ViewerAudit>())
    if (!audited.passed(found)) say("audit", place + why_beyond(audited, found), Tone::kError);
  return false;
}

Result<int> run_one(const AuditArguments& options, const AuditOptions& how, Progress& progress) {
  AuditArguments same = options;
  const auto run = options.run.begin("audit", tables(same), options.input, options.common);
  if (!run) return run.error();
  AuditRun segments;
  Result<std::optional<Audited>> audited = audit_input(options, how, progress, *run.value(), segments);
  progress.clear();
  if (!audited) return audited.error();
  if (!audited.value()) return kExitDone;  // only the first rank prints
  Audited& found = *audited.value();
  if (options.errors) {
    const Status written = write_errors(found.audit.errors, *options.errors, options.common.force);
    if (!written) return written.error();
  }
  const bool is_part = run.value()->is_part();
  const std::string text = is_part        ? audit_part(found.name(), found.audit, segments, found.limits.degrees)
                           : options.json ? audit_json(found.name(), found.audit, found.limits)
                                          : audit_text(found);
  if (const Status written = run.value()->finish(text); !written) return written.error();
  if (is_part) return kExitDone;
  if (options.limits.any() && found.audit.subjects.empty()) {
    say("audit", kNothingMoves, Tone::kError);
    return kExitBeyond;
  }
  return say_what_is_beyond(found, "") ? kExitDone : kExitBeyond;
}

// Returns the exit code for two files, which is the worse of their exit codes. A file that cannot be judged is worse
// than a file that exceeds the tolerance.
int worse_exit(int a, int b) {
  constexpr std::array<int, 4> kWorstFirst = {static_cast<int>(ErrorCode::kFailed),
                                              static_cast<int>(ErrorCode::kInvalidInput), kExitBeyond, kExitDone};
  return *std::find_if(kWorstFirst.begin(), kWorstFirst.end(), [&](int code) { return code == a || code == b; });
}

// Judges files one by one. A file that cannot be read does not stop the others from being judged.
Result<int> run_several(const AuditArguments& options, const AuditOptions& how, const std::vector<std::string>& names,
                        Progress& progress) {
  if (options.run.resume)
    return misuse("--resume",
                  "--resume is only for one sequence of keyframes, not for several glTF files; leave --resume out");
  if (!options.input.animation.empty())
    return misuse("--animation",
                  "--animation is only for a single glTF file; name only one file, or leave --animation out");
  if (options.errors)
    return misuse("--errors", "--errors is only for a single input; name only one file, or leave --errors out");
  std::vector<AuditedFile> files;
  int exit = kExitDone;
  for (const std::string& name : names) {
    AuditArguments one = options;
    one.input.files = {name};
    CommandRun run("audit", one.common, {}, {});
    AuditRun segments;
    const Result<std::optional<Audited>> audited = audit_input(one, how, progress, run, segments);
    progress.clear();
    if (audited) {
      files.emplace_back(*audited.value());
      exit = worse_exit(exit, say_what_is_beyond(*audited.value(), name + ": ") ? kExitDone : kExitBeyond);
      continue;
    }
    if (audited.error().code == ErrorCode::kUsage) return audited.error();
    files.emplace_back(name, audited.error());
    say("audit", audited.error().text(), Tone::kError);
    exit = worse_exit(exit, static_cast<int>(audited.error().code));
  }
  const bool any_moves = std::any_of(files.begin(), files.end(), [](const AuditedFile& file) {
    return !file.error || file.error->judged + file.error->faint > 0;
  });
  if (options.limits.any() && !any_moves && exit == kExitDone) {
    say("audit", kNothingMoves, Tone::kError);
    exit = kExitBeyond;
  }
  const std::string text = options.json ? audit_files_json(std::move(files), options.limits) : audit_files_text(files);
  if (const Status written = print_to(options.common.output, text, options.common.force); !written)
    return written.error();
  return exit;
}

Result<int> run(const AuditArguments& options) {
  if (const Status status = options.run.check(options.errors ? "--errors" : ""); !status) return status.error();
  Progress progress(options.common.quiet);
  const Result<AuditOptions> how = understand(options, progress);
  if (!how) return how.error();
  if (const Status output = options.run.check_output(options.common); !output) return output.error();
  if (!options.input.base.empty() || !options.input.samples.empty()) return run_one(options, how.value(), progress);
  const Result<std::vector<std::string>> files = find_gltf_files(options.input.files);
  if (!files) return files.error();
  if (const Status status = files.value().empty() ? Success{} : refuse_shares(options.run, kDividesSequences); !status)
    return status.error();
  const bool is_one = files.value().empty() || files.value() == options.input.files;
  return is_one && files.value().size() < 2 ? run_one(options, how.value(), progress)
                                            : run_several(options, how.value(), files.value(), progress);
}

}  // namespace

Command audit_command() {
  auto options = std::make_shared<AuditArguments>();
  return {"audit",
          "Measure the errors of the normals that a viewer renders",
          tables(*options),
          "A viewer is a program that shows meshes, such as three.js or Godot. Without --animation, each target of "
          "a\nglTF file is judged alone, from weight 0 to 1, and then all animations. Your base normals count as true, "
          "so only\nwhat motion does to them is an error. Several glTF files, or a folder of them, are judged one by "
          "one, with a row\nfor each and the worst exit code.\n"
          "\nExamples:\n"
          "  chronormal audit face.glb\n"
          "  chronormal audit face.glb --tolerance 1 --quiet > /dev/null\n"
          "  chronormal audit models/ intro.glb --tolerance 1\n"
          "  chronormal audit face.glb --for three,godot,gltfpack\n"
          "  chronormal audit walk/ --rule slerp --json\n"
          "\nExit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input, 4 a limit was exceeded",
          [options] { return run(*options); },
          kRefusedByAudit,
          true};
}

}  // namespace chronormal::cli
