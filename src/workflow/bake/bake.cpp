// Bakes a glTF file. A mesh goes through these steps, and each step uses the results of the steps before it:
//
//     read_gltf_shading     the vertices, and the faces that determine their true normals             shading/
//     plan_mesh             the encoding and, for exact, the pairs of targets that get corrections    plan
//     *_target_deltas       the terms of n(w) as arrays for each target                              terms, deltas
//     choose_candidate      for other encodings: the best candidate in the viewers                    chooser
//     MeshWriter            the arrays, and all lists with an item for each target, as edits of the file  write_mesh
//
// n(w) is the true normal at the weights w. A track of an animation may drive several meshes, so tracks are extended
// when all meshes are done.
#include "chronormal/workflow/bake.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <memory>
#include <utility>

#include "chronormal/analysis/quality.h"
#include "core/text.h"
#include "io/bytes/expansion.h"
#include "workflow/bake/candidates/chooser.h"
#include "workflow/bake/deltas/candidate.h"
#include "workflow/bake/deltas/deltas.h"
#include "workflow/bake/deltas/plan.h"
#include "workflow/bake/deltas/right_normals.h"
#include "workflow/bake/deltas/shared_parts.h"
#include "workflow/bake/deltas/tangents.h"
#include "workflow/bake/deltas/terms.h"
#include "workflow/bake/poses/mesh_skins.h"
#include "workflow/bake/poses/mesh_weights.h"
#include "workflow/bake/write/messages.h"
#include "workflow/bake/write/write_mesh.h"
#include "workflow/bake/write/write_tracks.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/shading/rig_poses.h"
#include "workflow/truth/author_truth.h"

namespace chronormal {
namespace {

// The results of the bake of one mesh, from which the file and the report are written.
struct MeshBake {
  BakedMesh report;
  std::vector<MeshWarning> warnings;
  GrownMesh grown;  // set if the mesh has correction targets
};

// Lists the meshes that may move: those in which some primitive with faces has a target with positions, or has normals
// and a target with normals. The arrays of these meshes, which are read later, tell which of them really move.
std::vector<std::size_t> candidate_meshes(const GltfDocument& document) {
  std::vector<std::size_t> result;
  for (std::size_t m = 0; m < document.meshes().size(); ++m) {
    const auto has_targets = [](const GltfPrimitive& primitive) {
      return primitive.has_faces() &&
             std::any_of(primitive.targets.begin(), primitive.targets.end(), [&](const auto& target) {
               return target.positions || (primitive.has_normals && target.normals);
             });
    };
    const auto& primitives = document.meshes()[m].primitives;
    if (std::any_of(primitives.begin(), primitives.end(), has_targets)) result.push_back(m);
  }
  return result;
}

// Returns true if a target changes the rendered image, because it moves vertices or changes normals.
bool changes(const GltfShading& shading, std::size_t target) { return moves(shading, target) || shading.turns[target]; }

bool any_changes(const GltfShading& shading) {
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i)
    if (changes(shading, i)) return true;
  return false;
}

bool any_shaded(const GltfShading& shading) {
  return std::any_of(shading.element_of_vertex.begin(), shading.element_of_vertex.end(),
                     [](std::uint32_t e) { return e != GltfShading::kNoElement; });
}

Status check_extras(const GltfDocument& document, const GltfEdit& edit, std::size_t mesh) {
  const std::string extras = std::string("/meshes/").append(std::to_string(mesh)).append("/extras");
  if (!edit.has(extras) || edit.text(extras).starts_with("{")) return Success{};
  return invalid_input(document.name() + ", " + extras,
                       "the extras are not a JSON object, so the bake cannot be recorded there; remove the extras, or "
                       "make them an object");
}

std::vector<bool> recomputed_parts(const GltfMesh& mesh, const GltfShading& shading, const BakeOptions& options) {
  std::vector<bool> result;
  for (const GltfPart& part : shading.parts)
    result.push_back(mesh.primitives[part.primitive].has_normals ? options.recompute_base : options.smooth);
  return result;
}

// Finds the true normals. If the options give a weighting, the true normals are sums by this weighting; otherwise they
// follow the normals of the author. If base normals are recomputed, the author's normals do not count, and faces are
// weighted by area unless the options give a weighting.
AuthorTruth truth_of(GltfShading& shading, const BakeOptions& options) {
  if (options.recompute_base) return {shading, options.weighting.value_or(Weighting::kArea)};
  return author_truth(shading, options.weighting);
}

// Splits the gaps between the keys of each track into pieces, so that the curves of correction weights can follow
// weights that are not quadratic within a gap. Long tracks are not split, because their gaps are short.
void cut_gaps(MeshWeights& weights) {
  constexpr std::size_t kNodes = 128, kMostPieces = 8;
  for (WeightTrack& track : weights.tracks)
    track.pieces_of_line = std::clamp<std::size_t>(kNodes / std::max<std::size_t>(1, track.size()), 1, kMostPieces);
}

void report_plan(const MeshPlan& plan, BakedMesh& report) {
  report.encoding = plan.encoding;
  report.elements = static_cast<std::size_t>(std::count(plan.is_shown.begin(), plan.is_shown.end(), true));
  if (plan.encoding == BakeEncoding::kExact)
    report.undriven = static_cast<std::size_t>(std::count(plan.is_line.begin(), plan.is_line.end(), true));
  report.fitted_elements = plan.lines.elements();
  report.resampling_error = plan.left_out;
}

// Returns the poses for which a mesh is baked if no animation drives the mesh, so that a program may set any pose.
RigPoses rig_of(const GltfMesh& mesh, const GltfShading& shading, PoseList given) {
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i)
    if (moves(shading, i)) moving.push_back(i);
  return {mesh.target_names, std::move(moving), mesh.target_count, std::move(given)};
}

// Functions that compute the arrays of a mesh for one target at a time, so that not all arrays are in memory together.
struct MeshDeltas {
  std::function<std::optional<TargetDeltas>(std::size_t target)> own;  // returns nothing if the target keeps its deltas
  std::function<TargetDeltas(std::size_t extra)> extra;
  GrownMesh grown;
  bool is_new = true;          // false if the mesh stays as it is
  bool are_keys_right = true;  // true if normals are right at weight 1 of each target of the mesh
};

MeshDeltas exact_deltas(const DeltaSource& source) {
  return {[&source](std::size_t i) { return own_target_deltas(source, i); },
          [&source](std::size_t k) { return extra_target_deltas(source, source.plan.extras[k]); },
          {source.shading.mesh, {source.plan.extras, {}, {}, {}, {}}, false}};
}

// Returns true if a candidate renders the right normals, up to a degree, at weight 1 of each target of the mesh. Then an
// audit of the baked file can learn from these normals which rule the author's normals follow.
bool are_keys_right(const DeltaSource& source, const Candidate& candidate) {
  constexpr double kRight = 1;  // degrees
  const GltfShading& shading = source.shading;
  const RightNormals rights(shading, source.terms, source.base_normals, source.plan.largest);
  for (std::size_t k = 0; k < shading.own_targets(); ++k) {
    if (!changes(shading, k)) continue;
    std::vector<double> own(shading.set.targets.size());
    own[k] = 1;
    const std::vector<double> pose = candidate.drivers.with_extras(own);
    std::vector<Vec3d> shown(shading.element_of_vertex.size());
    for (std::size_t v = 0; v < shown.size(); ++v) shown[v] = rights.stored(v);
    const auto add = [&](const VertexVectors& column, double weight) {
      for (std::size_t n = 0; weight != 0 && n < column.vertices.size(); ++n)
        shown[column.vertices[n]] = shown[column.vertices[n]] + weight * to_double(column.vectors[n]);
    };
    add(candidate.own[k], 1);
    for (std::size_t x = 0; x < candidate.extras.size(); ++x) add(candidate.extras[x], pose[own.size() + x]);
    const std::vector<Vec3d> of_elements = rights.of_elements(own);
    for (std::size_t v = 0; v < shown.size(); ++v) {
      const std::uint32_t e = shading.element_of_vertex[v];
      if (e == GltfShading::kNoElement) continue;
      const Vec3d right = rights.of_vertex(v, of_elements[e]);
      if (right != Vec3d{} && angle_between(shown[v], right) * kDegreesPerRadian > kRight) return false;
    }
  }
  return true;
}

// Returns the deltas for encodings other than exact, and adds facts about the chosen candidate to the report.
MeshDeltas chosen_deltas(const DeltaSource& source, const MeshWeights& weights, const BakeOptions& options,
                         std::size_t tangent_bytes, BakedMesh& report, bool& is_of_animations) {
  ChosenCandidate chosen = choose_candidate(source, weights, options, tangent_bytes);
  const auto candidate = std::make_shared<Candidate>(std::move(chosen.candidate));
  report.viewers = std::move(chosen.viewers);
  if (source.plan.encoding == BakeEncoding::kSmallest) report.candidates = std::move(chosen.candidates);
  report.left_out = candidate->left_out;
  report.resampling_error = candidate->track_error * kDegreesPerRadian;
  report.largest_error = candidate->fit_error * kDegreesPerRadian;
  is_of_animations = candidate->animations_only;
  return {[&source, candidate](std::size_t i) { return own_deltas(source.shading, *candidate, i); },
          [&source, candidate](std::size_t k) { return extra_deltas(source.shading, *candidate, k); },
          {source.shading.mesh, candidate->drivers, source.plan.encoding != BakeEncoding::kEndpoint},
          changes(source.shading, *candidate),
          !source.terms.follow_keys() || are_keys_right(source, *candidate)};
}

// Estimates the bytes that the deltas of new tangents take in the file.
std::size_t bytes_of_tangents(const DeltaSource& source, const std::vector<bool>& is_stale) {
  std::size_t bytes = 0;
  const SharedParts parts(source.shading);
  for (std::size_t i = 0; i < is_stale.size(); ++i) {
    if (!is_stale[i]) continue;
    TargetDeltas deltas = tangent_deltas(source, i, false);
    parts.join(deltas);
    bytes += parts.bytes_of(deltas);
  }
  return bytes;
}

// The progress of a bake, as the caller sees it. Each target of a mesh counts twice: once when the candidate for the
// mesh is chosen, and once when the target is written.
class Course {
 public:
  using Tell = std::function<void(std::size_t done, std::size_t total)>;

  Course(const GltfDocument& document, const std::vector<std::size_t>& meshes, Tell tell) : tell_(std::move(tell)) {
    for (const std::size_t mesh : meshes) total_ += 2 * document.meshes()[mesh].target_count;
  }
  void begin_mesh(std::size_t targets) {
    first_ = std::exchange(next_, next_ + 2 * targets);
    targets_ = targets;
    reach(first_);
  }
  [[nodiscard]] Tell of_choice() {
    return [this](std::size_t done, std::size_t total) { reach(first_ + targets_ * done / total); };
  }
  void write(std::size_t target) { reach(first_ + targets_ + target + 1); }

 private:
  void reach(std::size_t done) const {
    if (tell_) tell_(std::min(done, total_), total_);
  }

  Tell tell_;
  std::size_t total_ = 0, first_ = 0, next_ = 0, targets_ = 0;
};

// Bakes one mesh. The mesh must have been read, must move, and must have normals.
Status bake_shading(const GltfDocument& document, const GltfShading& shading, const AuthorTruth& truth,
                    const BakeOptions& options, Course& course, ZeroVectors& zeros, GltfEdit& edit, MeshBake& baked) {
  const GltfMesh& mesh = document.meshes()[shading.mesh];
  if (Status status = check_extras(document, edit, shading.mesh); !status) return status;
  Result<MeshWeights> weights = read_weights(document, shading);
  if (!weights) return weights.error();
  const NormalTerms terms(shading, truth);
  if (terms.is_fitted()) cut_gaps(weights.value());
  const Result<MeshPlan> planned =
      plan_mesh(document, shading, terms, weights.value().use, weights.value().is_driven, options);
  if (!planned) return planned.error();
  const MeshPlan& plan = planned.value();
  report_plan(plan, baked.report);
  if (plan.encoding == BakeEncoding::kSmallest && !plan.is_driven && options.is_posed)
    weights.value().rig = rig_of(mesh, shading, poses_of_mesh(options.poses, mesh));

  const std::size_t bytes_before = edit.added_bytes();
  MeshWriter writer(document, shading, options.smooth, zeros, edit);
  const NewBaseNormals base = new_base_normals(shading, terms, recomputed_parts(mesh, shading, options));
  baked.report.rescaled = base.rescaled;
  if (Status status = writer.write_base(base.is_replaced, base.normals); !status) return status;

  const DeltaSource source{shading, terms, plan, base.normals.empty() ? shading.normals : base.normals};
  if (plan.encoding != BakeEncoding::kExact)
    read_skins(document, shading, judged_vertices(source, stored_deltas(shading)), weights.value());
  BakeOptions within = options;
  within.progress = course.of_choice();
  baked.report.has_lone_weight = find_lone_weight(document, shading.mesh, edit).has_value();
  baked.report.has_unread_track = find_unread_track(document, shading.mesh).has_value();
  if (baked.report.has_lone_weight || baked.report.has_unread_track) within.most_targets = mesh.target_count;
  const BaseFaults faults = find_base_faults(source);
  baked.report.without_base = faults.without_base;
  baked.report.without_stored = faults.without_stored;
  std::vector<bool> is_stale = find_stale_tangents(source, options.viewers, false);
  std::size_t tangent_bytes = bytes_of_tangents(source, is_stale);
  if (options.most_delta_bytes && tangent_bytes > *options.most_delta_bytes) {
    baked.report.left_tangents = static_cast<std::size_t>(std::count(is_stale.begin(), is_stale.end(), true));
    is_stale.assign(is_stale.size(), false);
    tangent_bytes = 0;
  }
  bool is_of_animations = false;
  MeshDeltas deltas =
      plan.encoding == BakeEncoding::kExact
          ? exact_deltas(source)
          : chosen_deltas(source, weights.value(), within, tangent_bytes, baked.report, is_of_animations);
  warn_of_choice(mesh, options, baked.report, baked.warnings);
  for (std::size_t k = 0; k < deltas.grown.drivers.size(); ++k)
    baked.report.extras.push_back(deltas.grown.drivers.as_target(k, mesh.target_count + k));

  const bool any_base = std::find(base.is_replaced.begin(), base.is_replaced.end(), true) != base.is_replaced.end();
  const bool any_new = deltas.is_new || any_base;
  if (!any_new && baked.report.left_tangents == 0)
    is_stale = find_stale_tangents(source, options.viewers, true);  // tangents then have to fit the normals that stay
  baked.report.new_tangents = static_cast<std::size_t>(std::count(is_stale.begin(), is_stale.end(), true));
  if (!any_new && baked.report.new_tangents == 0) return Success{};
  if (baked.report.new_tangents > 0) writer.add_tangents();

  const auto check_size = [&] { return document.expansion().check(edit.added_bytes(), document.name()); };
  for (std::size_t i = 0; i < mesh.target_count; ++i) {
    std::optional<TargetDeltas> of_target, tangents;
    if (any_new && changes(shading, i)) {
      of_target = deltas.own(i);
      if (!moves(shading, i) && of_target) ++baked.report.stilled;
      if (of_target)
        baked.report.largest_error = std::fmax(baked.report.largest_error, of_target->error * kDegreesPerRadian);
    }
    if (is_stale[i]) tangents = tangent_deltas(source, i, !any_new);
    writer.write_target(i, of_target, tangents);
    course.write(i);
    if (Status status = check_size(); !status) return status;
  }
  if (!any_new) {
    baked.report.bytes = edit.added_bytes() - bytes_before;
    return Success{};
  }
  for (std::size_t k = 0; k < deltas.grown.drivers.size(); ++k) {
    writer.append_target(deltas.extra(k));
    if (Status status = check_size(); !status) return status;
  }
  writer.append_weights(baked.report.extras, deltas.grown.drivers.rest);
  baked.report.unmarked_nodes = writer.set_mark({plan.encoding, false, baked.report.extras, is_of_animations,
                                                 truth.follows_keys() && !is_of_animations && deltas.are_keys_right});
  baked.report.bytes = edit.added_bytes() - bytes_before;

  baked.grown = std::move(deltas.grown);
  baked.grown.mesh = shading.mesh;
  warn_of_baked(mesh, shading, plan, options, baked.report, baked.warnings);
  return Success{};
}

// Returns true if a mesh was baked before and must not be baked again. A second bake would add correction targets to
// the correction targets of the first. A mesh without correction targets can be baked again in another encoding.
bool is_baked(const GltfShading& shading, const BakeOptions& options) {
  return shading.mark &&
         (shading.mark->sequence || !shading.mark->extras.empty() || shading.mark->encoding == encoding_of(options));
}

// Judges a mesh that an earlier bake wrote, so that the bake reports an error beyond the tolerance. In a mesh that was
// baked from a sequence, each target is one keyframe. Judging such targets takes long, so they are judged only if a
// tolerance is requested.
Status judge_again(const GltfDocument& document, const BakeOptions& options, GltfShading& shading, MeshBake& baked) {
  const bool is_asked = options.tolerance || options.plan || !shading.mark->sequence;
  if (encoding_of(options) != BakeEncoding::kSmallest || !is_asked || !any_changes(shading) || !any_shaded(shading))
    return Success{};
  const AuthorTruth truth = truth_of(shading, options);
  baked.report.weighting = truth.rule().weighting;
  Result<MeshWeights> weights = read_weights(document, shading);
  if (!weights) return weights.error();
  const NormalTerms terms(shading, truth);
  const Result<MeshPlan> plan =
      plan_mesh(document, shading, terms, weights.value().use, weights.value().is_driven, options);
  if (!plan) return plan.error();
  const DeltaSource source{shading, terms, plan.value(), shading.normals};
  read_skins(document, shading, judged_vertices(source, stored_deltas(shading)), weights.value());
  baked.report.candidates.push_back(judge_baked(source, weights.value(), options));
  warn_of_choice(document.meshes()[shading.mesh], options, baked.report, baked.warnings);
  return Success{};
}

// Bakes one mesh. Returns nothing if the mesh does not move.
Result<std::optional<MeshBake>> bake_mesh(const GltfDocument& document, std::size_t index, const BakeOptions& options,
                                          Course& course, ZeroVectors& zeros, GltfEdit& edit) {
  const GltfMesh& mesh = document.meshes()[index];
  course.begin_mesh(mesh.target_count);
  MeshBake baked;
  baked.report.mesh = index;
  baked.report.name = mesh.name;
  Result<GltfShading> shading =
      read_gltf_shading(document, index, {options.smooth, options.crease_angle, true, options.weld});
  if (!shading) return shading.error();
  if (is_baked(shading.value(), options)) {
    const GltfBakeMark& mark = *shading.value().mark;
    baked.report.already_baked = true;
    baked.report.encoding = mark.encoding;
    baked.report.extras = mark.extras;
    if (Status status = judge_again(document, options, shading.value(), baked); !status) return status.error();
    return std::optional(std::move(baked));
  }
  if (!any_changes(shading.value())) return std::optional<MeshBake>();
  const AuthorTruth truth = truth_of(shading.value(), options);
  baked.report.weighting = truth.rule().weighting;
  if (truth.is_plain()) {
    shading.value().groups.forget_corners();
    shading.value().point_of_vertex = {};  // only the truth needed these two lists
    shading.value().place_of_vertex = {};
  }
  for (const GltfPrimitive& primitive : mesh.primitives) {
    if (primitive.has_faces() && !primitive.has_normals && !options.smooth) ++baked.report.left_flat;
  }
  warn_of_flat(mesh, baked.report, baked.warnings);
  if (any_shaded(shading.value())) {
    if (Status status = bake_shading(document, shading.value(), truth, options, course, zeros, edit, baked); !status)
      return status.error();
  }
  return std::optional(std::move(baked));
}

}  // namespace

BakeOptions with_viewers(BakeOptions options) {
  if (!options.viewers.empty()) return options;
  for (const Viewer& viewer : kViewers) {
    if (viewer.normals == NormalRule::kSum) options.viewers.push_back(viewer);
    if (viewer.normals == NormalRule::kUnit) options.spared.push_back(viewer);
  }
  return options;
}

Result<GltfBake> bake(const GltfDocument& document, const BakeOptions& asked, GltfEdit& edit) {
  BakeOptions options = with_viewers(asked);
  if (options.bytes_of_file == 0) options.bytes_of_file = document.expansion().bytes_read();
  assert(options.tolerance.value_or(0) >= 0 && options.crease_angle >= 0 && options.crease_angle <= 180);
  if (options.encoding == BakeEncoding::kKeys)
    return Error{ErrorCode::kUsage, "",
                 "the encoding keys is only for sequences of keyframes, not for glTF files; choose another --encode"};
  if (const Status poses = check_poses(options.poses, document); !poses) return poses.error();
  const std::vector<std::size_t> candidates = candidate_meshes(document);
  Course course(document, candidates, options.progress);

  GltfBake result;
  result.bytes_of_file = options.bytes_of_file;
  ZeroVectors zeros(edit, options.dense_zeros);
  std::vector<GrownMesh> grown;
  std::vector<std::size_t> report_of_grown;
  std::vector<MeshWarning> warnings;
  for (const std::size_t mesh : candidates) {
    Result<std::optional<MeshBake>> baked = bake_mesh(document, mesh, options, course, zeros, edit);
    if (!baked) return baked.error();
    if (!baked.value()) continue;
    MeshBake& of_mesh = *baked.value();
    if (!of_mesh.grown.drivers.formulas.empty()) {
      grown.push_back(std::move(of_mesh.grown));
      report_of_grown.push_back(result.meshes.size());
    }
    if (!of_mesh.report.already_baked) result.added_targets += of_mesh.report.extras.size();
    result.meshes.push_back(std::move(of_mesh.report));
    std::move(of_mesh.warnings.begin(), of_mesh.warnings.end(), std::back_inserter(warnings));
  }
  const Result<WrittenTracks> tracks =
      write_tracks(document, grown, options.tolerance.value_or(kExactBakeTolerance) / kDegreesPerRadian, edit);
  if (!tracks) return tracks.error();
  for (std::size_t n = 0; n < grown.size(); ++n) {
    BakedMesh& report = result.meshes[report_of_grown[n]];
    report.resampling_error += tracks.value().errors[n] * kDegreesPerRadian;
    report.bytes += tracks.value().bytes[n];
    warn_of_track(document.meshes()[report.mesh], report, tracks.value().errors[n], warnings);
  }
  result.converted_tracks = tracks.value().converted;

  edit.leave_out_unused();
  const Result<std::size_t> left_out = edit.unused_bytes();
  if (!left_out) return left_out.error();
  result.left_out_bytes = left_out.value();
  Result<std::vector<std::string>> pointers = edit.pointers();
  if (!pointers) return pointers.error();
  result.pointers = std::move(pointers).value();
  result.changed = !result.pointers.empty();
  result.added_bytes = edit.added_bytes();
  if (options.most_bytes && result.added_bytes > *options.most_bytes) {
    return invalid_input(document.name(), "the new normals need " + counted(result.added_bytes, "byte", "bytes") +
                                              ", but --max-bytes allows only " + grouped(*options.most_bytes) +
                                              "; raise --max-bytes");
  }
  result.warnings = said_once(warnings);
  result.drivers = drivers_file(document, result.meshes);
  return result;
}

}  // namespace chronormal
