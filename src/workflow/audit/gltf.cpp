// Audits glTF files. For each mesh, the audit measures the angles between the author's normals and the geometry. The
// audit then measures the errors of each target alone, of each track of weights, and of each expression of an avatar.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <tuple>
#include <utility>

#include "chronormal/workflow/audit.h"
#include "io/bytes/expansion.h"
#include "io/gltf/gltf_weights.h"
#include "workflow/audit/blend_source.h"
#include "workflow/audit/gltf_findings.h"
#include "workflow/audit/measure.h"
#include "workflow/audit/skinning_error.h"
#include "workflow/audit/viewer_errors.h"
#include "workflow/audit/watched_audit.h"
#include "workflow/errors/error_rows.h"
#include "workflow/shading/authored_weighting.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/shading/mesh_skin.h"
#include "workflow/shading/rig_poses.h"
#include "workflow/shading/surface_edges.h"
#include "workflow/truth/author_truth.h"
#include "workflow/viewers/played_track.h"

namespace chronormal {
namespace {

// All inputs for the audit of one mesh.
struct MeshAudit {
  const GltfDocument& document;
  const AuditOptions& options;
  const GltfShading& shading;
  const AuthorTruth& truth;
  std::span<const SurfaceEdge> edges;
  AuditRule rule;
  std::function<void()> progress;
  ErrorTable* errors;  // nullptr if errors are not kept
  const AuditWatch& watch;
  MeshSkin* standing;                    // the skin for targets and expressions; nullptr if there is none
  std::map<std::size_t, Error>& unread;  // the reasons why skins of nodes cannot be read
};

// Reads the skin of a node, which must have a skin. If the skin cannot be read, returns nothing and adds the reason to
// `unread`.
std::optional<MeshSkin> read_skin(const GltfDocument& document, const GltfShading& shading, std::size_t node,
                                  std::optional<std::size_t> animation, std::map<std::size_t, Error>& unread) {
  Result<MeshSkin> skin = MeshSkin::read(document, shading, node, animation);
  if (skin) return std::move(skin).value();
  unread.emplace(node, skin.error());
  return std::nullopt;
}

// Reads the skin of the first node that has this mesh and a skin. The joints have the pose in which the file stores
// them.
std::optional<MeshSkin> standing_skin(const GltfDocument& document, const GltfShading& shading,
                                      std::map<std::size_t, Error>& unread) {
  const std::vector<GltfNode>& nodes = document.nodes();
  const auto found = std::find_if(nodes.begin(), nodes.end(),
                                  [&](const GltfNode& node) { return node.has_skin && node.mesh == shading.mesh; });
  if (found == nodes.end()) return std::nullopt;
  return read_skin(document, shading, static_cast<std::size_t>(found - nodes.begin()), std::nullopt, unread);
}

// A list of tracks. Each track is given by the index of its animation, and by its index in this animation.
using Tracks = std::vector<std::pair<std::size_t, std::size_t>>;

// Lists the tracks that drive a mesh: in all animations, or only in the requested animation.
Tracks tracks_of(const GltfDocument& document, std::size_t mesh, std::optional<std::size_t> only) {
  Tracks tracks;
  for (std::size_t a = 0; a < document.animations().size(); ++a) {
    if (only && a != *only) continue;
    for (std::size_t t = 0; t < document.animations()[a].tracks.size(); ++t)
      if (document.nodes()[document.animations()[a].tracks[t].node].mesh == mesh) tracks.emplace_back(a, t);
  }
  return tracks;
}

// Measures the angles between the stored base normals and the sums of face normals that `truth` has for the base. The
// side of the surface does not count, so an angle above 90 degrees is replaced by 180 degrees minus the angle.
void measure_by_truth(const GltfShading& shading, const AuthorTruth& truth, AuthoredOffset& offset) {
  const auto position = [&](std::uint32_t v) { return to_double(vector_at(shading.set.base, v)); };
  std::vector<Vec3d> sums(shading.groups.size());
  truth.sums().for_all(position, [&](std::uint32_t e, const AuthorSum& sum) { sums[e] = sum.normal; });
  offset.vertices = 0;
  offset.sum = offset.worst = 0;
  for (std::size_t v = 0; v < shading.element_of_vertex.size(); ++v) {
    const std::uint32_t e = shading.element_of_vertex[v];
    const Vec3d stored = to_double(vector_at(shading.normals, v));
    if (e == GltfShading::kNoElement || sums[e] == Vec3d{} || stored == Vec3d{}) continue;
    const double angle = angle_between(sums[e], stored) * kDegreesPerRadian, off = std::fmin(angle, 180 - angle);
    ++offset.vertices;
    offset.sum += off;
    if (off > offset.worst) {
      offset.worst = off;
      offset.worst_at.vertex = v;
    }
  }
}

// Adds to the result the angles between the stored base normals and the normals of the geometry. Adds nothing if no
// vertex has a base normal.
void note_offset(const GltfShading& shading, const AuthorTruth& truth, const AuthoredWeighting& authored,
                 std::optional<Weighting> asked, Audit& result) {
  const bool any_shaded = std::any_of(shading.element_of_vertex.begin(), shading.element_of_vertex.end(),
                                      [](std::uint32_t e) { return e != GltfShading::kNoElement; });
  AuthoredOffset offset = authored_offset(authored, truth.rule().weighting);
  offset.is_detected = !asked;
  if (!any_shaded) return;
  offset.mesh = shading.mesh;
  offset.of_polygons = truth.rule().any_polygons;
  if (!truth.rule().is_plain()) measure_by_truth(shading, truth, offset);
  offset.worst_at = place_of(shading, offset.worst_at.vertex);
  result.offsets.push_back(offset);
}

// Returns the mesh of the original file, from which the audited file was baked. Reuses the mesh of an earlier audit if
// that mesh has the same base normals as the audited mesh. Returns nothing if there is no original file, or if the mesh
// in this file has other base positions, the mark of a bake, or more targets than the audited mesh.
Result<std::shared_ptr<AuthorOfMesh>> original_of(const AuditOptions& options, const GltfShading& baked,
                                                  const KnownAuthors* known) {
  std::shared_ptr<AuthorOfMesh> author;
  if (options.author == nullptr || baked.mesh >= options.author->meshes().size()) return author;
  if (known != nullptr && known->contains(baked.mesh)) author = known->at(baked.mesh);
  if (author == nullptr || author->shading.normals != baked.normals) {
    Result<GltfShading> read = read_gltf_shading(*options.author, baked.mesh, {.weld = options.weld});
    if (!read) return read.error();
    author = std::make_shared<AuthorOfMesh>(std::move(read).value(), options.weighting);
  }
  const GltfShading& before = author->shading;
  const bool is_same =
      before.set.base == baked.set.base && !before.mark && before.set.targets.size() <= baked.set.targets.size();
  return is_same ? author : nullptr;
}

// The targets that take part in a motion, in ascending order.
using Involved = std::vector<std::size_t>;

JudgedPart part_of(const MeshAudit& mesh, const Involved& involved) {
  JudgedPart part =
      judged_part(mesh.shading, mesh.truth, moving_outputs(mesh.shading, mesh.truth, involved, mesh.rule), mesh.rule);
  if (mesh.rule != AuditRule::kFlat)
    // Flat shading intends folds between faces, so edges are not examined for tears.
    part.set_edges(mesh.edges, mesh.shading.element_of_vertex.size());
  return part;
}

// The functions that write the weights of a subject's targets: as the specification of glTF requires, and as each
// viewer plays them.
struct SubjectWeights {
  Weights specified;
  std::vector<Weights> played;
};

// A subject of the audit (a target, a track or a list of poses), with its errors in each viewer.
struct Measured {
  AuditSubject subject;
  std::vector<ViewerError> of_viewers;
};

// Returns the weights of all targets, given the weights of the involved targets. All other targets get weight 0.
std::vector<double> of_all_targets(std::span<const double> weights, const Involved& involved, std::size_t targets) {
  std::vector<double> all(targets);
  for (std::size_t i = 0; i < involved.size(); ++i) all[involved[i]] = weights[i];
  return all;
}

// Turns a function that writes the weights of all targets into a function that writes only the weights of involved
// targets.
Weights of_involved(const Involved& involved, std::size_t targets, Weights all_weights) {
  return [&involved, targets, all_weights = std::move(all_weights)](std::size_t segment, double t,
                                                                    std::span<double> weights) {
    std::vector<double> all(targets);
    all_weights(segment, t, all);
    for (std::size_t i = 0; i < involved.size(); ++i) weights[i] = all[involved[i]];
  };
}

// The segments of a track, or the one segment of a target. The segments are all in memory, so reading them cannot fail.
// In a long track, only every step-th segment is measured.
struct SegmentsOfTrack {
  std::size_t count, step;
  const std::function<void()>& progress;

  template <class Look>
  [[nodiscard]] Status look_over(const Look& look) const {
    for (std::size_t s = 0; s < count; s += step) look(s);
    return Success{};
  }
  static void maximize(std::span<double> /*numbers*/) {}
  template <class Work>
  [[nodiscard]] Status over(AuditSubject& subject, const Work& work) const {
    return look_over([&](std::size_t s) {
      add_segment(work(s), subject);
      progress();
    });
  }
};

// Measures the errors of a subject. `index` is the index that the subject will have in the list of the audit. Returns
// nothing if no output can be judged.
std::optional<Measured> measure_part(const MeshAudit& mesh, const JudgedPart& part, const Involved& involved,
                                     const SubjectWeights& weights, const Moment& moment, MeshSkin* skin,
                                     AuditSubject subject, std::size_t index) {
  if (part.outputs().empty()) {
    for (std::size_t s = 0; s < subject.segments; ++s) mesh.progress();
    return std::nullopt;
  }
  BlendSource source(mesh.shading, mesh.truth, part, mesh.rule, involved, weights.specified, moment, subject.samples,
                     skin, subject.segments);
  ViewerErrors viewers(mesh.shading, part, mesh.options.viewers, weights.played, involved, skin != nullptr);
  SkinningErrors skinning;
  const auto judge_viewers = [&](const MeasuredSample& sample) {
    viewers.add_sample(source, sample);
    skinning.add_sample(source, sample);
    if (!mesh.watch) return;
    const std::size_t targets = mesh.shading.set.targets.size();
    std::vector<std::vector<double>> played;
    for (const std::vector<double>& now : viewers.now()) played.push_back(of_all_targets(now, involved, targets));
    mesh.watch({index, subject, sample.segment, sample.t, moment(sample.segment, sample.t), part, sample.largest,
                sample.error, sample.each, of_all_targets(source.now(), involved, targets), played});
  };
  const bool are_watched = static_cast<bool>(mesh.watch);
  SegmentsOfTrack segments{subject.segments, 1, mesh.progress};
  if (subject.kind == AuditSubject::Kind::kTrack && mesh.options.most_segments > 0)
    segments.step = block_count(std::max<std::size_t>(1, subject.segments), mesh.options.most_segments);
  const KeptErrors kept{mesh.errors, index, are_watched};
  (void)measure(source, segments, part, mesh.rule, subject, kept, judge_viewers);
  subject.skinning = skinning.all();
  return Measured{std::move(subject), viewers.take()};
}

// Scales the numbers of samples of an error by a factor. Counts of samples that could not be judged or lit stay.
void weigh(MotionError& error, double factor) {
  // Rounds the sum of all counts so far, so that the rounding errors of many small counts do not add up.
  double due = 0;
  std::size_t given = 0;
  const auto scaled = [&](std::size_t count) {
    due += factor * static_cast<double>(count);
    const auto all = static_cast<std::size_t>(std::llround(due));
    return all - std::exchange(given, all);
  };
  for (std::size_t& count : error.histogram) count = scaled(count);
  due = 0, given = 0;
  FineBins counts;
  for (const FineBins::Bin& bin : error.counts.filled()) counts.add(bin.number(), scaled(bin.count()));
  error.counts = std::move(counts);
  error.judged = given;
  error.sum *= factor;
  error.sum_of_squares *= factor;
  for (std::size_t& torn : error.torn)
    torn = static_cast<std::size_t>(std::llround(factor * static_cast<double>(torn)));
  error.samples = static_cast<std::size_t>(std::llround(factor * static_cast<double>(error.samples)));
}

// Gives the errors of a motion the weight in averages that the motion has in an earlier audit.
void weigh_like(const Audit& earlier, Measured& measured) {
  const AuditSubject& subject = measured.subject;
  const auto same = std::find_if(earlier.subjects.begin(), earlier.subjects.end(), [&](const AuditSubject& other) {
    return std::tie(other.kind, other.mesh, other.target, other.animation, other.track, other.node, other.expression) ==
           std::tie(subject.kind, subject.mesh, subject.target, subject.animation, subject.track, subject.node,
                    subject.expression);
  });
  if (same == earlier.subjects.end() || same->error.judged == 0 || subject.error.judged == 0) return;
  const double factor = static_cast<double>(same->error.judged) / static_cast<double>(subject.error.judged);
  if (factor == 1) return;
  weigh(measured.subject.error, factor);
  for (ViewerError& of_viewer : measured.of_viewers) weigh(of_viewer.error, factor);
}

void add_subject(const MeshAudit& mesh, Measured measured, Audit& result) {
  if (mesh.options.weighed_like != nullptr) weigh_like(*mesh.options.weighed_like, measured);
  for (std::size_t h = 0; h < measured.of_viewers.size(); ++h) {
    ViewerAudit& viewer = result.viewers[h];
    const ViewerError& found = measured.of_viewers[h];
    if (found.error.worst > viewer.error.worst) viewer.worst = result.subjects.size();
    viewer.error.add(found.error);
    viewer.displaced = std::max(viewer.displaced, found.displaced);
  }
  result.subjects.push_back(std::move(measured.subject));
}

// Returns true if a bake made the correction targets of a mesh for its animations, so that nothing drives them when
// somebody moves a slider. (The encodings harmless and exact are also for programs that drive correction targets.)
bool are_extras_of_tracks(const MeshAudit& mesh) {
  if (!mesh.shading.mark || mesh.shading.mark->encoding != BakeEncoding::kSmallest) return false;
  const Tracks tracks = tracks_of(mesh.document, mesh.shading.mesh, std::nullopt);
  return std::any_of(tracks.begin(), tracks.end(), [&](const auto& track) {
    const Result<GltfKeys> keys = mesh.document.keys(track.first, track.second);
    return keys && std::any_of(keys.value().values.begin(), keys.value().values.end(), [](float w) { return w != 0; });
  });
}

// Audits target k alone, from the lowest to the highest of the weights that the options give. Correction targets that a
// bake has added get the weights that follow from the weight of target k, or 0 if only animations drive them.
void audit_target(const MeshAudit& mesh, std::size_t k, Audit& result) {
  const GltfShading& shading = mesh.shading;
  Involved involved = {k};
  const bool are_driven = shading.mark && !are_extras_of_tracks(mesh);
  if (shading.mark) {
    for (const GltfExtraTarget& extra : shading.mark->extras) {
      if (extra.target == k) return;
      if (are_driven && extra.follows(k)) involved.push_back(extra.target);
    }
  }
  std::sort(involved.begin(), involved.end());
  involved.erase(std::unique(involved.begin(), involved.end()), involved.end());
  AuditSubject subject;
  subject.kind = AuditSubject::Kind::kTarget;
  const std::vector<std::string>& names = mesh.document.meshes()[shading.mesh].target_names;
  if (!names.empty()) subject.name = names[k];
  subject.mesh = shading.mesh;
  subject.weighting = mesh.truth.rule().weighting;
  subject.target = k;
  subject.segments = 1;
  subject.samples = samples_per_segment(mesh.options, mesh.shading.set.targets.size(), kAuditFewSamplesOfTarget);
  SubjectWeights weights;
  const auto weight_at = [&](double t) {
    const auto [least, most] = mesh.options.weights;
    return t == 1 ? most : least + t * (most - least);
  };
  const auto with_extras = [&](std::size_t, double t, std::span<double> of_targets) {
    of_targets[k] = weight_at(t);
    fill_extra_weights(shading, of_targets);
  };
  // A mesh may have thousands of targets, so an array of all weights is only made if correction targets need it.
  weights.specified = [&](std::size_t, double t, std::span<double> alone) { alone[0] = weight_at(t); };
  if (are_driven) weights.specified = of_involved(involved, shading.set.targets.size(), with_extras);
  for (const Viewer& viewer : mesh.options.viewers) {
    weights.played.emplace_back([&](std::size_t segment, double t, std::span<double> played) {
      weights.specified(segment, t, played);
      drop_weights(viewer, played, involved);
    });
  }
  const auto moment = [&](std::size_t, double t) { return weight_at(t); };
  const JudgedPart part = part_of(mesh, involved);
  std::optional<Measured> measured =
      measure_part(mesh, part, involved, weights, moment, mesh.standing, std::move(subject), result.subjects.size());
  if (!measured) {
    ++result.still;
    return;
  }
  for (const AuditFinding& fault : faults_of_target(mesh.document, shading, mesh.truth, mesh.rule, measured->subject,
                                                    part, involved, weights.specified))
    result.findings.push_back(fault);
  add_subject(mesh, std::move(*measured), result);
}

// Audits a track at its keys and between them. Judges the part of the mesh that the track moves. Returns nothing for a
// track that moves no vertex.
Result<std::optional<Measured>> audit_track(const MeshAudit& mesh, std::size_t animation, std::size_t index,
                                            std::size_t subject_index) {
  const GltfTrack& track = mesh.document.animations()[animation].tracks[index];
  Result<GltfKeys> keys = mesh.document.keys(animation, index);
  if (!keys) return keys.error();
  Result<TimeRange> range = TimeRange();
  if (!mesh.options.viewers.empty()) range = weight_time_range(mesh.document, animation);
  if (!range) return range.error();
  const std::vector<double> times = keys.value().times;
  const std::size_t width = mesh.shading.set.targets.size();
  std::vector<bool> is_involved(width);
  for (std::size_t i = 0; i < keys.value().values.size(); ++i)
    if (keys.value().values[i] != 0) is_involved[i % width] = true;
  Involved involved;
  for (std::size_t k = 0; k < width; ++k)
    if (is_involved[k]) involved.push_back(k);
  std::vector<PlayedTrack> played;
  for (const Viewer& viewer : mesh.options.viewers)
    played.emplace_back(viewer, keys.value(), track.interpolation, width, range.value());
  const gltf::WeightCurve curve(std::move(keys).value(), track.interpolation, width);
  AuditSubject subject;
  subject.kind = AuditSubject::Kind::kTrack;
  subject.name = mesh.document.animations()[animation].name;
  subject.mesh = mesh.shading.mesh;
  subject.weighting = mesh.truth.rule().weighting;
  subject.animation = animation;
  subject.track = index;
  subject.node = track.node;
  subject.driven = involved;
  const bool moves = times.size() > 1;
  subject.segments = moves ? times.size() - 1 : 1;
  subject.samples = moves ? samples_per_segment(mesh.options, subject.segments) : 1;
  const auto moment = [&](std::size_t segment, double t) {
    if (!moves || t == 0) return times[segment];
    return t == 1 ? times[segment + 1] : (1 - t) * times[segment] + t * times[segment + 1];
  };
  // Weights that jump at a key are judged just before the jump at the end of a segment, and after the jump at the
  // beginning of the next segment. At the end of the last segment, the weights are judged after the jump, because
  // viewers keep showing this pose. Rules that interpolate normals between the ends of a segment need the weights
  // before the jump.
  const bool shows_last = mesh.rule == AuditRule::kGltf;
  const auto just_before = [last = subject.segments - 1, shows_last](std::size_t segment, double t) {
    return t == 1 && (segment < last || !shows_last);
  };
  SubjectWeights weights;
  weights.specified = of_involved(involved, width, [&](std::size_t segment, double t, std::span<double> of_targets) {
    curve.at(moment(segment, t), just_before(segment, t), of_targets);
  });
  for (const PlayedTrack& by_viewer : played) {
    weights.played.push_back(of_involved(involved, width, [&](std::size_t segment, double t, std::span<double> all) {
      by_viewer.at(moment(segment, t), just_before(segment, t), all);
    }));
  }
  std::optional<MeshSkin> skin;
  if (mesh.options.skins && mesh.document.nodes()[track.node].has_skin)
    skin = read_skin(mesh.document, mesh.shading, track.node, animation, mesh.unread);
  return measure_part(mesh, part_of(mesh, involved), involved, weights, moment, skin ? &*skin : nullptr,
                      std::move(subject), subject_index);
}

// Audits all tracks of a mesh. Tracks with the same keys are measured once, but each track becomes a subject of the
// result.
Status audit_tracks(const MeshAudit& mesh, const Tracks& tracks, bool are_targets_judged, double worst_target,
                    Audit& result) {
  // The key under which the result of a track is stored: the index of the animation, the index of its first track with
  // the same keys (same_keys_as), and the skin of the node. Tracks with the same key have the same result.
  using Curve = std::tuple<std::size_t, std::size_t, bool, std::optional<std::uint32_t>>;
  std::map<Curve, std::optional<Measured>> of_curves;
  for (const auto& [animation, index] : tracks) {
    const GltfTrack& track = mesh.document.animations()[animation].tracks[index];
    const GltfNode& node = mesh.document.nodes()[track.node];
    const auto [known, is_new] = of_curves.try_emplace({animation, track.same_keys_as, node.has_skin, node.skin});
    if (is_new) {
      Result<std::optional<Measured>> measured = audit_track(mesh, animation, index, result.subjects.size());
      if (!measured) return measured.error();
      known->second = std::move(measured).value();
    } else {
      for (std::size_t s = 1; s < std::max<std::size_t>(2, track.key_count); ++s) mesh.progress();
    }
    if (!known->second) {
      ++result.still;
      continue;
    }
    Measured measured = *known->second;
    measured.subject.track = index;
    measured.subject.node = track.node;
    if (is_new) {
      if (const auto fault = fault_of_track(measured.subject, are_targets_judged, worst_target))
        result.findings.push_back(*fault);
    }
    add_subject(mesh, std::move(measured), result);
  }
  return Success{};
}

// Audits static poses, and returns the measured subject. Each pose becomes a segment from the pose to the base. Only
// the pose is judged; the base is needed to tell which normals are too short to be judged.
std::optional<Measured> measure_poses(const MeshAudit& mesh, const PoseList& poses, MeshSkin* skin,
                                      AuditSubject subject, std::size_t index) {
  const std::size_t targets = mesh.shading.set.targets.size();
  std::vector<bool> is_involved(targets);
  for (const std::vector<double>& pose : poses)
    for (std::size_t k = 0; k < targets; ++k)
      if (pose[k] != 0) is_involved[k] = true;
  Involved involved;
  for (std::size_t k = 0; k < targets; ++k)
    if (is_involved[k]) involved.push_back(k);
  subject.mesh = mesh.shading.mesh;
  subject.weighting = mesh.truth.rule().weighting;
  subject.segments = poses.size();
  subject.samples = 1;
  const bool is_numbered = subject.kind == AuditSubject::Kind::kPoses;
  const auto moment = [&](std::size_t segment, double t) { return is_numbered ? static_cast<double>(segment) : 1 - t; };
  SubjectWeights weights;
  weights.specified = [&](std::size_t segment, double t, std::span<double> now) {
    for (std::size_t i = 0; i < involved.size(); ++i) now[i] = (1 - t) * poses[segment][involved[i]];
  };
  for (const Viewer& viewer : mesh.options.viewers) {
    weights.played.emplace_back([&](std::size_t segment, double t, std::span<double> played) {
      weights.specified(segment, t, played);
      drop_weights(viewer, played, involved);
    });
  }
  return measure_part(mesh, part_of(mesh, involved), involved, weights, moment, skin, std::move(subject), index);
}

// Audits an expression of an avatar at full strength. Correction targets get the weights that follow from the weights
// of the expression.
void audit_expression(const MeshAudit& mesh, std::size_t index, double worst_target, Audit& result) {
  const GltfExpression& expression = mesh.document.meshes()[mesh.shading.mesh].expressions[index];
  std::vector<double> full = expression.weights;
  fill_extra_weights(mesh.shading, full);
  AuditSubject subject;
  subject.kind = AuditSubject::Kind::kExpression;
  subject.name = expression.name;
  subject.expression = index;
  std::optional<Measured> measured =
      measure_poses(mesh, {std::move(full)}, mesh.standing, std::move(subject), result.subjects.size());
  if (!measured) {
    ++result.still;
    return;
  }
  if (const auto fault = fault_of_track(measured->subject, true, worst_target)) result.findings.push_back(*fault);
  add_subject(mesh, std::move(*measured), result);
}

// Lists the distinct sets of weights that a mesh has when the file is opened, except sets of zeros. Each set has the
// index of the first node that shows the mesh with these weights.
std::vector<std::pair<std::vector<double>, std::optional<std::size_t>>> opening_poses(const GltfDocument& document,
                                                                                      std::size_t mesh) {
  std::vector<std::pair<std::vector<double>, std::optional<std::size_t>>> poses;
  const auto add = [&](const std::vector<double>& weights, std::optional<std::size_t> node) {
    if (std::all_of(weights.begin(), weights.end(), [](double w) { return w == 0; })) return;
    if (std::none_of(poses.begin(), poses.end(), [&](const auto& pose) { return pose.first == weights; }))
      poses.emplace_back(weights, node);
  };
  const std::vector<double>& of_mesh = document.meshes()[mesh].weights;
  bool is_shown = false;
  for (std::size_t n = 0; n < document.nodes().size(); ++n) {
    const GltfNode& node = document.nodes()[n];
    if (node.mesh != mesh) continue;
    is_shown = true;
    add(node.weights.empty() ? of_mesh : node.weights, n);
  }
  if (!is_shown) add(of_mesh, std::nullopt);
  return poses;
}

void add_poses(const MeshAudit& mesh, std::optional<Measured> measured, Audit& result) {
  if (!measured) {
    ++result.still;
    return;
  }
  if (std::optional<AuditFinding> fault = fault_of_pose(measured->subject)) result.findings.push_back(*fault);
  add_subject(mesh, std::move(*measured), result);
}

// Audits the poses that a mesh has when a viewer opens the file.
void audit_openings(const MeshAudit& mesh, Audit& result) {
  for (const auto& [weights, node] : opening_poses(mesh.document, mesh.shading.mesh)) {
    AuditSubject subject;
    subject.kind = AuditSubject::Kind::kOpening;
    subject.node = node;
    std::optional<MeshSkin> skin;
    if (node && mesh.options.skins && mesh.document.nodes()[*node].has_skin)
      skin = read_skin(mesh.document, mesh.shading, *node, std::nullopt, mesh.unread);
    add_poses(mesh, measure_poses(mesh, {weights}, skin ? &*skin : nullptr, std::move(subject), result.subjects.size()),
              result);
  }
}

// Returns the poses of the mesh that the options request: a given list of poses, or random poses.
PoseList asked_poses(const GltfDocument& document, const AuditOptions& options, std::size_t mesh) {
  constexpr unsigned kSeed = 51;
  const GltfMesh& of_mesh = document.meshes()[mesh];
  if (!options.is_posed || !options.poses.empty()) return poses_of_mesh(options.poses, of_mesh);
  std::vector<bool> is_extra(of_mesh.target_count);
  if (of_mesh.mark)
    for (const GltfExtraTarget& extra : of_mesh.mark->extras)
      if (extra.target < is_extra.size()) is_extra[extra.target] = true;
  std::vector<std::size_t> targets;
  for (std::size_t k = 0; k < is_extra.size(); ++k)
    if (!is_extra[k]) targets.push_back(k);
  return RigPoses(of_mesh.target_names, std::move(targets), of_mesh.target_count, {}).sample(kRandomPoses, kSeed);
}

void audit_asked_poses(const MeshAudit& mesh, Audit& result) {
  PoseList poses = asked_poses(mesh.document, mesh.options, mesh.shading.mesh);
  if (poses.empty()) return;
  for (std::vector<double>& pose : poses) fill_extra_weights(mesh.shading, pose);
  AuditSubject subject;
  subject.kind = AuditSubject::Kind::kPoses;
  add_poses(mesh, measure_poses(mesh, poses, mesh.standing, std::move(subject), result.subjects.size()), result);
}

// Counts the segments of all subjects, for reports of progress.
std::size_t count_segments(const GltfDocument& document, const AuditOptions& options, std::optional<std::size_t> only) {
  std::size_t total = 0;
  for (std::size_t m = 0; m < document.meshes().size(); ++m) {
    if (!only)
      total += document.meshes()[m].target_count + document.meshes()[m].expressions.size() +
               opening_poses(document, m).size() + asked_poses(document, options, m).size();
    for (const auto& [a, t] : tracks_of(document, m, only))
      total += std::max<std::size_t>(1, document.animations()[a].tracks[t].key_count - 1);
  }
  return total;
}

// Returns an upper bound of the number of samples in all subjects of a mesh.
std::size_t count_rows(const GltfDocument& document, std::size_t mesh, const Tracks& tracks, bool only_tracks,
                       const AuditOptions& options) {
  const GltfMesh& of_mesh = document.meshes()[mesh];
  std::size_t rows = 0;
  if (!only_tracks)
    rows = of_mesh.target_count * samples_per_segment(options, 1) + of_mesh.expressions.size() +
           opening_poses(document, mesh).size() + asked_poses(document, options, mesh).size();
  for (const auto& [a, t] : tracks) {
    const std::size_t keys = document.animations()[a].tracks[t].key_count,
                      segments = std::max<std::size_t>(keys, 2) - 1;
    rows += segments * samples_per_segment(options, segments);
  }
  return rows;
}

// Returns an error table with the vertices of a mesh, and with no rows yet.
ErrorTable table_of(const GltfShading& shading) {
  ErrorTable table{"mesh" + std::to_string(shading.mesh), ElementKind::kVertices, shading.set.topology,
                   shading.set.base};
  for (std::size_t v = 0; v < shading.set.topology.vertex_count(); ++v) {
    const AuditPlace place = place_of(shading, v);
    table.primitives.push_back(static_cast<std::int64_t>(*place.primitive));
    table.vertices.push_back(static_cast<std::int64_t>(place.vertex));
  }
  return table;
}

bool has_targets(const GltfMesh& mesh) {
  return mesh.target_count > 0 && std::any_of(mesh.primitives.begin(), mesh.primitives.end(),
                                              [](const GltfPrimitive& p) { return p.has_faces(); });
}

}  // namespace

Result<Audit> audit(const GltfDocument& document, const AuditOptions& options) {
  return watched_audit(document, options, {});
}

Result<Audit> internal::audit(const GltfDocument& document, const AuditOptions& options, KnownAuthors& known) {
  return watched_audit(document, options, {}, &known);
}

Result<Audit> internal::watched_audit(const GltfDocument& document, const AuditOptions& options,
                                      const AuditWatch& watch, KnownAuthors* known) {
  if (const Status status = check_samples(options); !status) return status.error();
  if (!(options.weights[0] < options.weights[1] && std::isfinite(options.weights[1] - options.weights[0])))
    return Error{ErrorCode::kUsage, "", "the second weight must be larger than the first, such as 0:1"};
  if (const Status status = check_poses(options.poses, document); !status) return status.error();
  std::optional<std::size_t> only;
  if (!options.animation.empty()) {
    const Result<std::size_t> animation = document.find_animation(options.animation);
    if (!animation) return animation.error();
    only = animation.value();
  }
  Audit result;
  result.weighting = options.weighting.value_or(Weighting::kArea);
  result.rule = options.rule.value_or(AuditRule::kGltf);
  if (!options.viewers.empty() && result.rule != AuditRule::kGltf)
    return Error{ErrorCode::kUsage, "",
                 "viewers can only be chosen with the rule gltf; choose this rule, or leave the viewers out"};
  for (const Viewer& viewer : options.viewers) result.viewers.emplace_back().viewer = viewer;
  for (const Error& note : document.notes()) result.notes.push_back(note.text());
  const std::size_t total = count_segments(document, options, only);
  std::size_t done = 0;
  const auto progress = [&] {
    ++done;
    if (options.progress) options.progress(std::min(done, total), total);
  };
  std::uint64_t error_bytes = 0;  // the bytes that the tables of all meshes take
  for (std::size_t m = 0; m < document.meshes().size(); ++m) {
    const Tracks tracks = tracks_of(document, m, only);
    if (!has_targets(document.meshes()[m]) || (only && tracks.empty())) continue;
    Result<GltfShading> read = read_gltf_shading(document, m, {.weld = options.weld});
    if (!read) return read.error();
    Result<std::shared_ptr<AuthorOfMesh>> original = original_of(options, read.value(), known);
    if (!original) return original.error();
    std::shared_ptr<AuthorOfMesh> author = original.value();
    const bool is_baked = author != nullptr;
    if (!is_baked) {
      author = std::make_shared<AuthorOfMesh>(std::move(read).value(), options.weighting);
      if (known != nullptr && options.author == nullptr) (*known)[m] = author;
    }
    GltfShading& shading = is_baked ? read.value() : author->shading;
    const AuthorTruth& truth = author->truth;
    if (is_baked) {
      shading.groups = author->shading.groups;
      shading.element_of_vertex = author->shading.element_of_vertex;
    }
    const bool is_known = shading.normals == author->shading.normals;
    note_offset(shading, truth, is_known ? author->weighting : find_authored_weighting(shading), options.weighting,
                result);
    if (truth.rule().weighting == Weighting::kArea) shading.groups.forget_corners();
    for (const AuditFinding& note : notes_of(document, shading)) result.findings.push_back(note);
    for (const AuditFinding& note : notes_of_truth(shading, truth)) result.findings.push_back(note);
    for (const AuditFinding& note : limits_of(shading, options.viewers)) result.findings.push_back(note);
    for (ViewerAudit& viewer : result.viewers) {
      const std::size_t most = viewer.viewer.most_targets, targets = shading.set.targets.size();
      if (most > 0 && targets > most) viewer.beyond = std::max(viewer.beyond, targets - most);
    }

    ErrorTable table;
    if (options.keep_errors) {
      table = table_of(shading);
      const std::size_t rows = count_rows(document, m, tracks, only.has_value(), options);
      if (const Status status = reserve_rows(table, rows, document.expansion(), error_bytes); !status)
        return status.error();
    }
    std::map<std::size_t, Error> unread;
    std::optional<MeshSkin> standing;
    if (options.skins && !only) standing = standing_skin(document, shading, unread);
    const std::vector<SurfaceEdge> edges = surface_edges(shading);
    const MeshAudit mesh{document, options,
                         shading,  truth,
                         edges,    result.rule,
                         progress, options.keep_errors ? &table : nullptr,
                         watch,    standing ? &*standing : nullptr,
                         unread};
    const bool are_targets_judged = !only && !(shading.mark && shading.mark->sequence);
    const std::size_t first = result.subjects.size();
    for (std::size_t k = 0; k < document.meshes()[m].target_count && are_targets_judged; ++k)
      audit_target(mesh, k, result);
    double worst_target = 0;
    for (std::size_t s = first; s < result.subjects.size(); ++s)
      worst_target = std::max(worst_target, result.subjects[s].error.worst);
    for (std::size_t k = 0; k < document.meshes()[m].expressions.size() && are_targets_judged; ++k)
      audit_expression(mesh, k, worst_target, result);
    if (!only) {
      audit_openings(mesh, result);
      audit_asked_poses(mesh, result);
    }
    if (Status status = audit_tracks(mesh, tracks, are_targets_judged, worst_target, result); !status)
      return status.error();
    if (options.skins) {
      const std::span<const AuditSubject> of_mesh = std::span(result.subjects).subspan(first);
      for (const AuditFinding& note : notes_of_skins(document, shading, of_mesh, unread))
        result.findings.push_back(note);
    }
    if (table.rows() > 0) result.errors.push_back(std::move(table));
  }
  finish(result);
  return result;
}

}  // namespace chronormal
