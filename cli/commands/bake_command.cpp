// Defines the command `bake`: its options, the file that it writes, and its report.
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <memory>
#include <optional>
#include <string_view>
#include <utility>
#include "chronormal/io/input.h"
#include "chronormal/io/output.h"
#include "chronormal/motion/paths.h"
#include "chronormal/workflow/audit.h"
#include "cli/options/command.h"
#include "cli/options/outputs.h"
#include "cli/reports/bake_report.h"
#include "cli/terminal/format.h"
#include "cli/terminal/print.h"
#include "cli/terminal/process.h"
#include "core/text.h"
#include "io/bytes/expansion.h"
#include "io/system/names.h"
#include "io/system/process.h"
#include "workflow/audit/watched_audit.h"

namespace chronormal::cli {
namespace {

// The largest file, in bytes, that is audited after a bake: the input if it is a glTF file, otherwise the result. An
// audit judges every target, so for a larger file the user would wait too long for the one line that the audit adds to
// the report.
constexpr std::size_t kMostAudited = std::size_t{64} << 20;

struct BakeArguments {
  InputOptions input;
  CommonOptions common;
  std::string encode;     // if empty, the encoding depends on what drives the weights
  std::string weighting;  // if empty, the stored base normals suggest the weighting
  double crease_angle = 180;
  bool recompute_base = false, smooth = false, dense_zeros = false;
  std::optional<std::size_t> most_bytes;
  std::string viewers;                // if empty, the default viewers
  std::optional<std::string> output;  // the output, if -o names it
  std::optional<double> tolerance;
  std::optional<std::size_t> most_targets;
  bool animations_only = false, plan = false;
  // The file to which the drivers of the correction targets are written, beside the result.
  std::optional<std::string> drivers;
  std::optional<std::string> poses;  // the file of the poses for which the rig is baked
  bool json = false, no_audit = false, no_weld = false;
};

std::string viewer_names() {
  std::string names;
  for (const Viewer& viewer : kViewers) names.append(names.empty() ? "" : ", ").append(viewer.name);
  return names;
}

Result<BakeOptions> understand(const BakeArguments& options) {
  BakeOptions how;
  if (!options.encode.empty()) {
    how.encoding = find_bake_encoding(options.encode);
    if (!how.encoding)
      return misuse("--encode",
                    "the encoding must be smallest, harmless, exact or endpoint for a glTF file, and harmless, exact, "
                    "endpoint or keys for a sequence");
  }
  if (!options.viewers.empty()) {
    Result<std::vector<Viewer>> viewers = find_viewers(options.viewers);
    if (!viewers) return misuse("--for", viewers.error().message);
    how.viewers = std::move(viewers).value();
  }
  how = with_viewers(std::move(how));
  if (!options.weighting.empty()) {
    const Result<Weighting> weighting = make_weighting(options.weighting);
    if (!weighting) return misuse("--weighting", weighting.error().message);
    how.weighting = weighting.value();
  }
  if (!(options.crease_angle >= 0 && options.crease_angle <= 180))
    return misuse("--crease", "the angle of hard edges must be from 0 to 180 degrees");
  if (options.tolerance && !(*options.tolerance >= 0 && *options.tolerance <= 90))
    return misuse("--tolerance", "the tolerance must be an angle from 0 to 90 degrees");
  how.crease_angle = options.crease_angle;
  how.recompute_base = options.recompute_base;
  how.smooth = options.smooth;
  how.dense_zeros = options.dense_zeros;
  how.most_bytes = options.most_bytes;
  how.tolerance = options.tolerance;
  how.most_targets = options.most_targets;
  how.animations_only = options.animations_only;
  how.plan = options.plan;
  if (how.encoding.value_or(BakeEncoding::kSmallest) != BakeEncoding::kSmallest) {
    constexpr const char* kNeedsSmallest =
        "this option can only be used with --encode smallest; leave this option or --encode out";
    if (options.most_targets) return misuse("--max-targets", kNeedsSmallest);
    if (options.animations_only) return misuse("--animations-only", kNeedsSmallest);
    if (options.plan) return misuse("--plan", kNeedsSmallest);
    if (options.poses) return misuse("--poses", kNeedsSmallest);
  }
  if (options.json && !options.plan && is_stream(options.common.output))
    return misuse("--json", "JSON and the result cannot both go to the standard output; write the result to a file");
  if (options.drivers) {
    if (options.drivers->empty() || *options.drivers == "-")
      return misuse("--drivers",
                    "the drivers need a file of their own, not the standard output; name a file with --drivers FILE");
  }
  if (const Status status = check_input(options.input); !status) return status.error();
  how.is_posed = options.poses.has_value();
  how.weld = !options.no_weld;
  if (options.poses && *options.poses != "random") {
    Result<std::vector<RigPose>> poses = read_poses_file(*options.poses);
    if (!poses) return poses.error();
    how.poses = std::move(poses).value();
  }
  return how;
}

// Returns true if the user gave a limit, and the bake of a mesh exceeds this limit or leaves tangents that do not fit
// the new normals.
bool is_beyond(const BakeArguments& options, const BakeOptions& how, const GltfBake& bake,
               const GltfDocument& document) {
  if (!options.tolerance && !options.most_targets && !options.most_bytes) return false;
  return std::any_of(bake.meshes.begin(), bake.meshes.end(), [&](const BakedMesh& mesh) {
    const std::size_t targets = document.meshes()[mesh.mesh].target_count;
    return mesh.left_tangents > 0 || (options.most_targets && targets > *options.most_targets) ||
           std::any_of(mesh.candidates.begin(), mesh.candidates.end(), [&](const auto& choice) {
             return choice.chosen && (!choice.within || is_beyond_by_rounding(choice, how));
           });
  });
}

// Prints the report on stdout, or on stderr if the result goes to stdout.
Result<int> report(const BakeArguments& options, const std::string& text, const std::string& json) {
  const bool is_aside = is_stream(options.common.output) && !options.json;
  if (is_aside && !options.common.quiet) say_text(text);
  if (is_aside) return kExitDone;
  const Status printed = print(options.json ? json : text);
  if (!printed) return printed.error();
  return kExitDone;
}

void warn(const std::vector<std::string>& warnings) {
  for (const std::string& warning : warnings) say("bake", warning, Tone::kWarning);
}

void warn_if_worse(const BakeReport& report, bool of_animations) {
  if (report.audit && report.audit->is_worse()) warn({worse_text(*report.audit, of_animations)});
}

// Audits the input (by calling audit_before) and the written file, both against the true normals of the original glTF
// file.
//
// Tracks of the result have more keys than tracks of the input. An audit of the result therefore has more samples, and
// may find errors that the input also has at these moments. The result is called worse only after the input was audited
// at equally many samples. Returns nothing if an audit can judge neither file. Errors: kFailed if the written file
// cannot be read.
template <class AuditBefore>
Result<std::optional<BeforeAndAfter>> audit_both(const BakeOptions& how, const BakeArguments& options,
                                                 const GltfDocument* author, const AuditBefore& audit_before) {
  std::optional<BeforeAndAfter> result;
  if (options.no_audit || is_stream(options.common.output)) return result;
  // While an object of this class lives, a user who interrupts the program is told that the output file is complete.
  struct Stands {
    Stands() {
      say_at_end(
          "chronormal: the output is complete; only the comparison of errors was stopped (--no-audit leaves this "
          "comparison out)\n");
    }
    Stands(const Stands&) = delete;
    Stands& operator=(const Stands&) = delete;
    ~Stands() { say_at_end(nullptr); }
  } stands;
  AuditOptions audited;
  audited.weld = how.weld;
  audited.weighting = how.weighting;
  constexpr std::size_t kEnoughSegments = 120;
  audited.most_segments = kEnoughSegments;
  // The audit takes viewers and poses only for a glTF file, not for a motion.
  if (author != nullptr) {
    audited.viewers = how.viewers;
    audited.viewers.insert(audited.viewers.end(), how.spared.begin(), how.spared.end());
    audited.is_posed = how.is_posed;
    audited.poses = how.poses;
  }
  const GltfOptions gltf{.allow_external = options.input.allow_external, .max_expansion = options.input.max_expansion};
  const Result<GltfDocument> after = GltfDocument::open(options.common.output, gltf);
  if (!after) return after.error();
  AuditOptions audited_after = audited;
  audited_after.author = how.recompute_base ? nullptr : author;
  KnownAuthors known;
  Result<Audit> first = audit_before(audited, known);
  if (first && author != nullptr) audited_after.weighed_like = &first.value();
  Result<Audit> second = audit(after.value(), audited_after, known);
  constexpr std::size_t kSamplesToCompare = 81;
  if (first && second && is_worse(second.value().error, first.value().error)) {
    audited.samples = kSamplesToCompare;
    audited.viewers.clear();
    const Result<Audit> closer = audit_before(audited, known);
    if (closer) first.value().error.worst = std::max(first.value().error.worst, closer.value().error.worst);
  }
  if (!first && first.error().code == ErrorCode::kFailed) return first.error();
  if (!second) return second.error();  // the written file must be readable
  if (first && second && !first.value().subjects.empty())
    result = BeforeAndAfter{std::move(first).value(), std::move(second).value()};
  return result;
}

// Returns true if the audit found no normal of the result that is zero, infinite or NaN, so that a viewer can light
// every normal. Otherwise returns false, and prints a message if the user gave a tolerance.
bool is_lit(const BakeArguments& options, const BakeReport& report) {
  const std::size_t unlit = report.audit ? report.audit->after.error.unlit : 0;
  if (!options.tolerance || unlit == 0) return true;
  say("bake",
      formatted("{} of the result would be zero, infinite or NaN in a viewer, which no tolerance allows; run "
                "chronormal audit on the result to see where",
                counted(unlit, "normal", "normals")),
      Tone::kError);
  return false;
}

Result<int> run_gltf(const BakeArguments& options, BakeOptions how, const Input& input, Progress& progress) {
  const std::string& output = options.common.output;
  const GltfDocument& document = *input.document();
  if (options.crease_angle != 180 && !options.smooth)
    return misuse("--crease",
                  "in a glTF file, --crease only affects primitives without normals, and only if --smooth is given; "
                  "add --smooth");
  if (how.encoding.value_or(BakeEncoding::kSmallest) == BakeEncoding::kSmallest)
    how.most_delta_bytes = std::exchange(how.most_bytes, std::nullopt);
  how.progress = progress.callback("baking");
  GltfEdit edit(document);
  Result<GltfBake> baked = bake(document, how, edit);
  progress.clear();
  if (!baked) return baked.error();
  give_back_free_memory();  // returns the freed memory of the bake to the system
  const int code = is_beyond(options, how, baked.value(), document) ? kExitBeyond : kExitDone;
  BakeReport told{input.name(), output, options.drivers, std::nullopt, input.notes()};
  if (options.plan) {
    warn(baked.value().warnings);
    const Status printed = print(options.json ? plan_json(baked.value(), told) : plan_text(baked.value(), told));
    if (!printed) return printed.error();
    return code;
  }
  // If the output is in another folder, its references to other files need new paths.
  Result<std::vector<std::string>> pointers = edit.pointers(output);
  if (!pointers) return pointers.error();
  baked.value().pointers = std::move(pointers).value();
  const Result<std::size_t> left_out = edit.unused_bytes(output);
  if (!left_out) return left_out.error();
  baked.value().left_out_bytes = left_out.value();
  std::vector<std::string> warnings = baked.value().warnings;
  for (std::string& warning : edit.warnings(output)) warnings.push_back(std::move(warning));
  // The result is written last, because it may replace the input. If an earlier write fails, nothing is lost.
  if (options.drivers) {
    if (const Status written = write_output(*options.drivers, baked.value().drivers, options.common.force); !written)
      return written.error();
  }
  if (const Status written = edit.write(output, options.common.force); !written) return written.error();
  warn(warnings);
  if (baked.value().changed && input.file_size() <= kMostAudited) {
    auto audited = audit_both(how, options, &document, [&](const AuditOptions& asked, KnownAuthors& known) {
      return audit(document, asked, known);
    });
    if (!audited) return audited.error();
    told.audit = std::move(audited).value();
  }
  warn_if_worse(told, any_of_animations(baked.value()));
  const Result<int> reported = report(options, bake_text(baked.value(), told), bake_json(baked.value(), told));
  if (!reported) return reported.error();
  return is_lit(options, told) ? code : kExitBeyond;
}

// Opens the input again, with the normals of all keyframes, because the audit needs these normals.
Result<Input> open_whole(const BakeArguments& options, Progress& progress) {
  InputOptions wanted = options.input;
  wanted.shading = KeepShading::kAll;
  return open_input("bake", std::move(wanted), progress);
}

Result<int> run_sequence(const BakeArguments& options, BakeOptions how, Input& input, Progress& progress) {
  const std::string& output = options.common.output;
  constexpr const char* kNotOfSequences =
      "this option is only for glTF files, and the input is a sequence; leave the option out";
  if (options.most_targets) return misuse("--max-targets", kNotOfSequences);
  if (options.animations_only) return misuse("--animations-only", kNotOfSequences);
  if (options.plan) return misuse("--plan", kNotOfSequences);
  if (options.poses) return misuse("--poses", kNotOfSequences);
  if (options.drivers)
    return misuse("--drivers",
                  "this option is not for sequences, whose animation drives all targets; leave --drivers out");
  const bool adds_up = std::all_of(how.viewers.begin(), how.viewers.end(),
                                   [](const Viewer& viewer) { return viewer.normals == NormalRule::kSum; });
  if (!how.encoding && !options.viewers.empty() && how.viewers != find_viewers("all").value() && !adds_up)
    how.encoding = BakeEncoding::kHarmless;
  if (how.encoding == BakeEncoding::kSmallest)
    return misuse(
        "--encode",
        "the encoding of a sequence must be harmless, exact, endpoint or keys; give one of these with --encode");
  if (how.encoding == BakeEncoding::kKeys && how.tolerance.value_or(kHarmlessTolerance) < kLeastKeyTolerance)
    return misuse("--tolerance",
                  "with --encode keys, the tolerance must be at least 0.001 degrees; give a larger --tolerance");
  if (how.encoding == BakeEncoding::kKeys && options.input.is_curved()) {
    // The user's tolerance limits the error against the curves. Cutting the curves into straight pieces uses up a part
    // of this tolerance.
    const double asked = how.tolerance.value_or(kHarmlessTolerance),
                 pieces = make_path(options.input.path).value().tolerance;
    how.tolerance = asked - pieces;
    if (*how.tolerance < kLeastKeyTolerance)
      return misuse(
          "--path",
          formatted("cutting the curves into straight pieces causes an error of {}, which uses up the tolerance of "
                    "{:g} degrees; give a larger --tolerance, or a smaller angle with --path NAME:DEG",
                    with_degrees(with_digits(pieces, 6)), asked));
  }
  if (options.smooth)
    return misuse("--smooth", "--smooth is only for glTF files, and the input is a sequence; leave --smooth out");
  if (options.recompute_base)
    return misuse("--recompute-base",
                  "--recompute-base is only for glTF files, and the input is a sequence; leave --recompute-base out");
  const std::string extension = utf8_of(path_of(output).extension());
  if (!is_stream(output) && extension != ".glb" && extension != ".GLB")
    return misuse(output, "a sequence can only be written as .glb; choose a name that ends in .glb");
  MotionStream& stream = *input.stream().value();
  const Motion& motion = stream.motion();
  if (motion.kind == MotionKind::kTargets)
    return invalid_input(input.name(),
                         "the input is a base with targets, not a sequence; write both as a .glb with chronormal "
                         "convert first, and bake that file");
  if (motion.segments.size() + 1 != motion.keyframes.size())
    return invalid_input(input.name(),
                         "the weights of this animation jump, so the animation cannot be baked as a sequence; bake the "
                         "glTF file itself");
  // By default, hard edges follow the stored normals of the file.
  const StoredNormals& stored = *input.normals().value();
  if (!stored.of_keyframes.empty()) {
    const std::vector<float>& first = stored.of_keyframes.front();
    how.normal_of_corner = VectorView<const float>::packed(first.data(), first.size() / 3);
    how.normals_of_keyframe = [&input](std::size_t k) { return input.normals_of(k); };
  }
  how.progress = progress.callback("baking");
  const Expansion allowed = input.expansion();
  how.expansion = &allowed;
  Result<SequenceBake> baked = bake_sequence(stream, how, output, options.common.force);
  progress.clear();
  if (!baked) return baked.error();
  if (options.input.is_curved()) baked.value().cut = input.cut_path();
  warn(baked.value().warnings);
  BakeReport told{input.name(), output, std::nullopt, std::nullopt, input.notes()};
  // An audit judges the triangles of the written file. The normals of these triangles differ from the normals of larger
  // polygons, so a mesh with such polygons is not audited.
  if (baked.value().bytes <= kMostAudited && motion.topology.all_triangles()) {
    std::optional<Input> whole;
    auto audited = audit_both(how, options, nullptr, [&](AuditOptions asked, KnownAuthors&) -> Result<Audit> {
      asked.rule = AuditRule::kNlerp;
      if (!stored.has_more) return audit(stream, stored, asked);
      if (!whole) {
        Result<Input> again = open_whole(options, progress);
        if (!again) return again.error();
        whole = std::move(again).value();
      }
      return audit(*whole->stream().value(), *whole->normals().value(), asked);
    });
    if (!audited) return audited.error();
    told.audit = std::move(audited).value();
  }
  warn_if_worse(told, false);
  const BakeEncoding encoding = how.encoding.value_or(BakeEncoding::kExact);
  const Result<int> reported =
      report(options, bake_text(baked.value(), encoding, told), bake_json(baked.value(), encoding, told));
  if (!reported) return reported.error();
  const SequenceBake& result = baked.value();
  const bool is_above = options.tolerance && result.largest_error > *options.tolerance;
  if (is_above)
    say("bake",
        formatted(
            "the error of up to {} is beyond the tolerance of {}; choose another --encode or a larger --tolerance",
            with_degrees(with_digits(result.largest_error, 4)), with_degrees(with_digits(*options.tolerance, 4))),
        Tone::kWarning);
  const bool is_beyond_tolerance = is_above || (result.keys && result.keys->beyond > 0);
  return is_beyond_tolerance || !is_lit(options, told) ? kExitBeyond : kExitDone;
}

// Finds the name of the output file. Without -o, the last of several files is the output, as in `bake IN OUT`, if bake
// can write files with its extension.
Status take_output(BakeArguments& options) {
  std::vector<std::string>& files = options.input.files;
  if (options.output) {
    options.common.output = *options.output;
    return Success{};
  }
  if (options.plan && files.size() < 2) return Success{};
  const std::string extension = files.size() < 2 ? "" : utf8_of(path_of(files.back()).extension());
  if (extension != ".glb" && extension != ".gltf" && extension != ".vrm" && extension != ".GLB")
    return misuse("-o,--output", "the output is missing; give it last (bake IN OUT), or with -o OUT");
  options.common.output = files.back();
  files.pop_back();
  return Success{};
}

// Checks that no output replaces another output or an input. Only OUT may be the same file as INPUT, because the result
// keeps all content of INPUT.
Status check_files(const BakeArguments& options) {
  std::vector<NamedFile> poses;
  if (options.poses && *options.poses != "random") poses.push_back({"--poses", *options.poses});
  std::vector<NamedFile> others = {{"standard output", "-"}}, read = input_files(options.input);
  if (options.drivers) others.push_back({"--drivers", *options.drivers});
  read.insert(read.end(), poses.begin(), poses.end());
  if (Status distinct = check_distinct(others, read); !distinct || options.plan) return distinct;
  if (!is_stream(options.common.output)) others.insert(others.begin(), {"OUT", options.common.output});
  return check_distinct(others, poses);
}

Result<int> run(BakeArguments options) {
  if (const Status status = take_output(options); !status) return status.error();
  Progress progress(options.common.quiet);
  const Result<BakeOptions> how = understand(options);
  if (!how) return how.error();
  // An output with an extension that bake cannot write is refused before the input is read. Other errors in the name of
  // the output depend on the input.
  const bool writes = !options.plan;
  if (writes && !is_stream(options.common.output) && is_motion_file(options.common.output))
    return misuse(options.common.output, "bake can only write glTF; choose a name that ends in .glb, .gltf or .vrm");
  if (writes) {
    if (const Status output = check_output(options.common.output, options.common.force); !output) return output.error();
  }
  if (options.drivers && writes) {
    if (const Status output = check_output(*options.drivers, options.common.force); !output) return output.error();
  }
  if (const Status distinct = check_files(options); !distinct) return distinct.error();
  InputOptions wanted = options.input;
  wanted.stream = true;
  if (options.crease_angle == 180) wanted.shading = KeepShading::kRead;
  Result<Input> input = open_input("bake", std::move(wanted), progress);
  if (!input) return input.error();
  return input.value().document() != nullptr ? run_gltf(options, how.value(), input.value(), progress)
                                             : run_sequence(options, how.value(), input.value(), progress);
}

// Returns the options that all commands share, but makes OUT optional.
std::vector<Option> with_output(std::vector<Option> table, std::optional<std::string>& output) {
  table.front() = {"-o,--output OUT", &output, "the file to write (default: the last INPUT, if there are several)"};
  return table;
}

}  // namespace

Command bake_command() {
  auto options = std::make_shared<BakeArguments>();
  const std::vector<RefusedOption> refused = {
      {"--base",
       "bake reads targets only from a glTF file; write the base and its targets as a .glb with chronormal convert, "
       "and bake that file"},
      {"--animation", "bake corrects all animations of a glTF file at once; leave --animation out"},
      {"--world", "bake writes normals in the space of each mesh; leave --world out"}};
  return {
      "bake",
      "Correct the normals of a glTF file, or make a glTF file from a sequence",
      {input_table(options->input, refused),
       {{"--for VIEWER,...",
         &options->viewers,
         "make the result for these viewers, such as three,godot\nViewers and compressors are " + viewer_names() +
             "; the word all stands for every viewer. The default is three, babylon, playcanvas and bevy. Where "
             "possible, the result is no worse in the other viewers",
         {.check = check_viewers_given()}},
        {"--encode HOW", &options->encode,
         "choose how the new normals are stored (default for glTF: smallest)\nFor a sequence, the default is exact, or "
         "harmless if a viewer that --for names does not add up targets. smallest: the smallest errors in a file of at "
         "most 2.5 times the size, or with --tolerance the fewest bytes whose errors stay within it. harmless: unit "
         "normals that "
         "look the same in every viewer and after any compression. exact: correction targets that make normals "
         "exact in viewers that add up targets as glTF says. endpoint: the best single delta for each target, "
         "without correction targets. keys, only for sequences: the fewest keys that stay within the tolerance at "
         "every instant"},
        {"--weighting NAME",
         &options->weighting,
         "choose how much each face counts in a vertex normal\nNAME is area, angle, uniform, area-angle, max, "
         "inverse-edges or inverse-roots. Corrections are exact with area, and fitted with all others. The default is "
         "the weighting that the base normals of each mesh follow, or area if they follow none",
         {.rare = true}},
        {"--crease DEG",
         &options->crease_angle,
         "treat edges sharper than DEG degrees as hard\nA glTF file also needs --smooth. The default is 180, which "
         "makes no edge hard",
         {.rare = true}},
        {"--recompute-base",
         &options->recompute_base,
         "also replace the base normals by new ones that are computed from the geometry",
         {.rare = true}},
        {"--smooth", &options->smooth, "give smooth normals to primitives that have no normals"},
        {"--max-bytes N",
         &options->most_bytes,
         "spend at most N bytes on the normals of each mesh\nFor a sequence, and with an --encode other than smallest, "
         "the limit applies to all new arrays together, and the command fails if they are larger. By default, only "
         "--encode smallest has a limit",
         {.check = check_whole(0)}},
        {"--max-targets N",
         &options->most_targets,
         "write at most N morph targets for each mesh\nCorrection targets count, too. The default is the number that "
         "the viewers can show. Needs --encode smallest",
         {.check = check_whole(0)}},
        {"--animations-only", &options->animations_only,
         "correct only the animations, not single sliders\nA slider is the weight of one morph target. Normals are "
         "fitted to the animations of the file, and may look wrong if a slider is moved by hand. Needs --encode "
         "smallest"},
        {"--poses FILE|random", &options->poses,
         "correct the poses that a program sets\nFILE lists poses as JSON, such as [{\"smile\": 1, \"jaw\": 0.5}, "
         "...]; the word random stands for random poses. Meshes that no animation drives then get correction targets, "
         "which the program has to drive as the extras in the result say. Needs --encode smallest"},
        {"--plan", &options->plan,
         "list the candidates for the result with their errors, and write no file\nNeeds --encode smallest"},
        {"--dense-zeros",
         &options->dense_zeros,
         "write deltas of zero in full, without sparse accessors\nThis is for programs that cannot read sparse "
         "accessors, such as Assimp",
         {.rare = true}},
        {"--tolerance DEG", &options->tolerance,
         "set the largest error allowed along the animations, in degrees\nWith harmless and exact, correction targets "
         "that turn no normal by more than DEG degrees are left out. The default is 0.5, and 0.001 with exact"},
        {"--drivers FILE",
         &options->drivers,
         "also write to FILE, as JSON, how a program drives the correction targets\nThe extras of the meshes in the "
         "result say the same",
         {.rare = true}},
        {"--no-weld",
         &options->no_weld,
         "do not merge vertices that are at the same point at all times",
         {.rare = true}},
        {"--no-audit",
         &options->no_audit,
         "do not compare the errors before and after the bake, to save time",
         {.rare = true}},
        {"--json", &options->json, "print the result as JSON, for programs"}},
       with_output(options->common.table(true), options->output)},
      "Your base normals stay as they are, and so do all bytes that have nothing to do with the normals of "
      "targets.\nWith --force, OUT may be the same file as INPUT.\n"
      "\nExamples:\n"
      "  chronormal bake face.glb face.right.glb\n"
      "  chronormal bake avatar.vrm -o avatar.right.vrm\n"
      "  chronormal bake face.glb -o face.glb --force --encode endpoint\n"
      "  chronormal bake 'frames/*.obj' --fps 24 -o dance.glb\n"
      "\nExit codes: 0 done, 1 failed, 2 wrong usage, 3 invalid input, 4 written, but beyond --tolerance,\n"
      "--max-targets or --max-bytes",
      [options] { return run(*options); },
      refused};
}

}  // namespace chronormal::cli
