// Audits of glTF files: targets one by one, and the weight tracks.
#include <algorithm>
#include <functional>
#include <map>
#include <utility>

#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/gltf_shading.h"
#include "io/gltf/gltf_weights.h"
#include "workflow/audit/audit_judge.h"

namespace chronormal {
namespace {

Vec3f vector_at(const std::vector<float>& values, std::size_t i) {
  const float* v = values.data() + 3 * i;
  return {v[0], v[1], v[2]};
}

// The primitive that a vertex of all parts together belongs to.
AuditPlace place_of(const GltfShading& shading, std::size_t vertex) {
  const auto after = std::upper_bound(shading.parts.begin(), shading.parts.end(), vertex,
                                      [](std::size_t v, const GltfPart& part) { return v < part.first_vertex; });
  const GltfPart& part = *(after - 1);
  return {part.mesh, part.primitive, vertex - part.first_vertex, 0, 0};
}

// The weights of all targets at t of a segment.
using Weights = std::function<void(std::size_t segment, double t, std::span<double> weights)>;
// The weight or the time that a person finds this by.
using Moment = std::function<double(std::size_t segment, double t)>;

// What a host makes of a mesh and its weights.
class BlendSource {
 public:
  static constexpr bool kNeedsEnds = false;

  BlendSource(const GltfShading& shading, const JudgedPart& part, AuditRule rule, Weights weights, Moment moment)
      : shading_(shading),
        part_(part),
        rule_(rule),
        weights_at_(std::move(weights)),
        moment_(std::move(moment)),
        moved_(shading.set.targets.size()) {
    std::vector<Vec3d> positions(part.vertices().size());
    place_base(positions);
    PartNormals normals;
    part.normals(positions, normals);
    base_normals_ = std::move(normals.elements);
  }

  bool place(std::size_t segment, double t, std::span<Vec3d> positions) {
    if (rule_ != AuditRule::kGltf) {
      start_ = weights(segment, 0);
      end_ = weights(segment, 1);
    }
    std::vector<double> now = weights(segment, t);
    const bool same = known_ && now == now_ && (rule_ == AuditRule::kGltf || start_ == end_);
    known_ = true;
    t_ = t;
    if (same) return false;
    now_ = std::move(now);
    place_base(positions);
    for (std::size_t k = 0; k < now_.size(); ++k) {
      if (now_[k] == 0) continue;
      for (const auto& [vertex, delta] : moved(k)) positions[vertex] = positions[vertex] + now_[k] * to_double(delta);
    }
    return true;
  }
  void forget() { known_ = false; }

  [[nodiscard]] Vec3f shown(const JudgedOutput& output) const {
    if (rule_ == AuditRule::kGltf) return to_float(unit(to_double(sum(output.vertex, now_))));
    return blend_stored(rule_, to_double(sum(output.vertex, start_)), to_double(sum(output.vertex, end_)), t_);
  }
  [[nodiscard]] Vec3d right(const JudgedOutput& output, const Vec3d& normal) const {
    const Vec3d stored = to_double(vector_at(shading_.normals, output.vertex));
    return shown_direction(stored, base_normals_[output.element], normal);
  }
  [[nodiscard]] AuditPlace at(std::size_t segment, double t, const JudgedOutput& output) const {
    AuditPlace place = place_of(shading_, output.vertex);
    place.segment = segment;
    place.at = moment_(segment, t);
    return place;
  }

 private:
  using Delta = std::pair<std::uint32_t, Vec3f>;

  [[nodiscard]] std::vector<double> weights(std::size_t segment, double t) const {
    std::vector<double> result(shading_.set.targets.size());
    weights_at_(segment, t, result);
    return result;
  }

  void place_base(std::span<Vec3d> positions) const {
    const auto vertices = part_.vertices();
    for (std::size_t i = 0; i < positions.size(); ++i)
      positions[i] = to_double(vector_at(shading_.set.base, vertices[i]));
  }

  // The deltas of a target, with vertices as the part numbers them.
  const std::vector<Delta>& moved(std::size_t k) {
    if (moved_[k]) return *moved_[k];
    std::vector<Delta>& result = moved_[k].emplace();
    const BlendTarget& target = shading_.set.targets[k];
    const auto vertices = part_.vertices();
    result.reserve(std::min(vertices.size(), target.vertices.size()));
    for (std::size_t i = 0, n = 0; i < vertices.size() && n < target.vertices.size();) {
      if (vertices[i] == target.vertices[n])
        result.emplace_back(static_cast<std::uint32_t>(i), vector_at(target.deltas, n));
      if (vertices[i] <= target.vertices[n])
        ++i;
      else
        ++n;
    }
    return result;
  }

  // N + sum w D in float32, target after target, as hosts add.
  [[nodiscard]] Vec3f sum(std::size_t vertex, const std::vector<double>& weights) const {
    Vec3f normal = vector_at(shading_.normals, vertex);
    for (std::size_t k = 0; k < weights.size(); ++k) {
      if (weights[k] == 0 || shading_.normal_deltas[k].empty()) continue;
      normal = normal + static_cast<float>(weights[k]) * vector_at(shading_.normal_deltas[k], vertex);
    }
    return normal;
  }

  const GltfShading& shading_;
  const JudgedPart& part_;
  AuditRule rule_;
  Weights weights_at_;
  Moment moment_;
  std::vector<std::optional<std::vector<Delta>>> moved_;
  std::vector<Vec3d> base_normals_;  // of elements
  bool known_ = false;
  double t_ = 0;
  std::vector<double> now_, start_, end_;
};

// The vertices whose normal some targets move: by a face around them, or by a stored delta. Of the rule flat, their
// corners.
std::vector<JudgedOutput> moving_outputs(const GltfShading& shading, const std::vector<bool>& involved,
                                         AuditRule rule) {
  const Topology& topology = shading.set.topology;
  std::vector<bool> moves(topology.vertex_count()), element_moves(shading.groups.size());
  for (std::size_t k = 0; k < involved.size(); ++k) {
    if (!involved[k]) continue;
    for (const std::uint32_t v : shading.set.targets[k].vertices) moves[v] = true;
  }
  const auto corners = topology.corners();
  const auto element_of_vertex = shading.groups.element_of_output();
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (!moves[corners[c]]) continue;
    const std::size_t first = c - c % 3;
    for (std::size_t i = first; i < first + 3; ++i) element_moves[element_of_vertex[corners[i]]] = true;
  }
  const auto is_judged = [&](std::uint32_t v) {
    const std::uint32_t e = shading.element_of_vertex[v];
    if (e == GltfShading::kNoElement) return false;
    if (element_moves[e]) return true;
    for (std::size_t k = 0; k < involved.size(); ++k) {
      if (involved[k] && !shading.normal_deltas[k].empty() && vector_at(shading.normal_deltas[k], v) != Vec3f{})
        return true;
    }
    return false;
  };
  std::vector<JudgedOutput> outputs;
  if (rule == AuditRule::kFlat) {
    for (std::uint32_t c = 0; c < corners.size(); ++c)
      if (is_judged(corners[c])) outputs.push_back({corners[c], element_of_vertex[corners[c]], c / 3, c});
    return outputs;
  }
  std::size_t count = 0;
  for (std::uint32_t v = 0; v < shading.element_of_vertex.size(); ++v) count += is_judged(v) ? 1U : 0U;
  outputs.reserve(count);
  for (std::uint32_t v = 0; v < shading.element_of_vertex.size(); ++v) {
    if (!is_judged(v)) continue;
    const std::uint32_t e = shading.element_of_vertex[v];
    outputs.push_back({v, e, shading.groups.faces(e)[0], 0});
  }
  return outputs;
}

// All of one mesh.
class MeshAudit {
 public:
  MeshAudit(const GltfDocument& document, const AuditOptions& options, const GltfShading& shading,
            std::function<void()> progress, Audit& result)
      : document_(document), options_(options), shading_(shading), progress_(std::move(progress)), result_(result) {}

  void add_offset() {
    std::vector<JudgedOutput> outputs;
    for (std::uint32_t v = 0; v < shading_.element_of_vertex.size(); ++v)
      if (shading_.element_of_vertex[v] != GltfShading::kNoElement)
        outputs.push_back({v, shading_.element_of_vertex[v], 0, 0});
    if (outputs.empty()) return;
    const auto positions =
        VectorView<const float>::packed(shading_.set.base.data(), shading_.set.topology.vertex_count());
    AuthoredOffset offset = authored_offset(
        shading_.set.topology, positions, shading_.groups, result_.weighting, outputs,
        [&](const JudgedOutput& output) { return to_double(vector_at(shading_.normals, output.vertex)); });
    offset.mesh = shading_.mesh;
    offset.worst_at = place_of(shading_, offset.worst_at.vertex);
    result_.offsets.push_back(offset);
  }

  void add_notes() {
    const auto& primitives = document_.meshes()[shading_.mesh].primitives;
    const auto flat = std::count_if(shading_.parts.begin(), shading_.parts.end(),
                                    [&](const GltfPart& p) { return !primitives[p.primitive].has_normals; });
    if (flat > 0) find(AuditFinding::Kind::kFlat).count = static_cast<std::size_t>(flat);
    if (shading_.mark) find(AuditFinding::Kind::kBaked).count = shading_.mark->extras.size();
    if (shading_.mark && shading_.mark->sequence)
      find(AuditFinding::Kind::kSequenceTargets).count = shading_.own_targets();
    std::size_t skinned = 0;
    for (const GltfNode& node : document_.nodes())
      skinned += node.mesh && *node.mesh == shading_.mesh && node.has_skin ? 1U : 0U;
    if (skinned > 0) find(AuditFinding::Kind::kSkinned).count = skinned;
  }

  void add_target(std::size_t k) {
    std::vector<bool> involved(shading_.set.targets.size());
    involved[k] = true;
    if (shading_.mark) {
      for (const GltfExtraTarget& extra : shading_.mark->extras) {
        if (extra.target == k) return;
        if (extra.i == k || extra.j == k) involved[extra.target] = true;
      }
    }
    AuditSubject subject;
    subject.kind = AuditSubject::Kind::kTarget;
    const std::vector<std::string>& names = document_.meshes()[shading_.mesh].target_names;
    if (!names.empty()) subject.name = names[k];
    subject.mesh = shading_.mesh;
    subject.target = k;
    subject.segments = 1;
    subject.samples = samples_per_segment(options_, 1);
    const auto weights = [&, k](std::size_t, double t, std::span<double> result) {
      std::fill(result.begin(), result.end(), 0.0);
      result[k] = t;
      fill_extra_weights(shading_, result);
    };
    const JudgedPart part(shading_.set.topology, shading_.groups, result_.weighting,
                          moving_outputs(shading_, involved, result_.rule), result_.rule == AuditRule::kFlat);
    if (!judge(
            part, weights, [](std::size_t, double t) { return t; }, subject))
      return;
    largest_alone_ = std::max(largest_alone_, subject.error.worst);
    find_target_faults(k, part, weights);
  }

  // Weights between two keys, and what of the mesh they move.
  Status add_track(std::size_t animation, std::size_t track_index) {
    const GltfTrack& track = document_.animations()[animation].tracks[track_index];
    const auto known = subject_of_curve_.find({animation, track.same_keys_as});
    if (known != subject_of_curve_.end()) {
      for (std::size_t s = 1; s < std::max<std::size_t>(2, track.key_count); ++s) progress_();
      if (known->second == kNoSubject) {
        ++result_.still;
        return Success{};
      }
      AuditSubject subject = result_.subjects[known->second];
      subject.track = track_index;
      subject.node = track.node;
      result_.subjects.push_back(std::move(subject));
      return Success{};
    }
    Result<GltfKeys> keys = document_.keys(animation, track_index);
    if (!keys) return keys.error();
    const std::vector<double> times = keys.value().times;
    const std::size_t width = shading_.set.targets.size();
    std::vector<bool> involved(width);
    for (std::size_t i = 0; i < keys.value().values.size(); ++i)
      if (keys.value().values[i] != 0) involved[i % width] = true;
    const gltf::WeightCurve curve(std::move(keys).value(), track.interpolation, width);
    AuditSubject subject;
    subject.kind = AuditSubject::Kind::kTrack;
    subject.name = document_.animations()[animation].name;
    subject.mesh = shading_.mesh;
    subject.animation = animation;
    subject.track = track_index;
    subject.node = track.node;
    const bool moves = times.size() > 1;
    subject.segments = moves ? times.size() - 1 : 1;
    subject.samples = moves ? samples_per_segment(options_, subject.segments) : 1;
    const auto moment = [&](std::size_t segment, double t) {
      if (!moves || t == 0) return times[segment];
      return t == 1 ? times[segment + 1] : (1 - t) * times[segment] + t * times[segment + 1];
    };
    const auto weights = [&](std::size_t segment, double t, std::span<double> result) {
      curve.at(moment(segment, t), moves && t == 1, result);
    };
    const JudgedPart part(shading_.set.topology, shading_.groups, result_.weighting,
                          moving_outputs(shading_, involved, result_.rule), result_.rule == AuditRule::kFlat);
    const bool judged = judge(part, weights, moment, subject);
    subject_of_curve_[{animation, track.same_keys_as}] = judged ? result_.subjects.size() - 1 : kNoSubject;
    if (judged) find_track_faults(result_.subjects.back());
    return Success{};
  }

 private:
  static constexpr std::size_t kNoSubject = static_cast<std::size_t>(-1);

  AuditFinding& find(AuditFinding::Kind kind) {
    AuditFinding& finding = result_.findings.emplace_back();
    finding.kind = kind;
    finding.mesh = shading_.mesh;
    return finding;
  }

  // Adds the subject, if there is anything to judge.
  bool judge(const JudgedPart& part, const Weights& weights, const Moment& moment, AuditSubject& subject) {
    if (part.outputs().empty()) {
      ++result_.still;
      for (std::size_t s = 0; s < subject.segments; ++s) progress_();
      return false;
    }
    BlendSource source(shading_, part, result_.rule, weights, moment);
    Judge(source, part, result_.rule).run(subject, progress_);
    result_.subjects.push_back(subject);
    return true;
  }

  void find_target_faults(std::size_t k, const JudgedPart& part, const Weights& weights) {
    const AuditSubject& subject = result_.subjects.back();
    const auto& primitives = document_.meshes()[shading_.mesh].primitives;
    const auto lacks_normals = [&](const GltfPart& p) {
      const GltfPrimitive& primitive = primitives[p.primitive];
      return primitive.has_normals && primitive.targets[k].positions && !primitive.targets[k].normals &&
             moves_vertices(k, p);
    };
    const auto lacking = std::count_if(shading_.parts.begin(), shading_.parts.end(), lacks_normals);
    const bool off_at_end = subject.at_keys.worst > kAuditFault;
    if (lacking > 0) {
      AuditFinding& finding = find(AuditFinding::Kind::kMissingNormals);
      finding.target = k;
      finding.count = static_cast<std::size_t>(lacking);
      finding.degrees = subject.error.worst;
      if (subject.error.worst > 0) finding.worst_at = subject.error.worst_at;
    } else if (subject.error.worst > kAuditFault) {
      AuditFinding& finding = find(off_at_end ? AuditFinding::Kind::kWrongAtKeys : AuditFinding::Kind::kWrongBetween);
      finding.target = k;
      finding.degrees = off_at_end ? subject.at_keys.worst : subject.error.worst;
      finding.worst_at = off_at_end ? subject.at_keys.worst_at : subject.error.worst_at;
    }
    find_stale_tangents(k, part, weights);
  }

  [[nodiscard]] bool moves_vertices(std::size_t k, const GltfPart& part) const {
    const std::vector<std::uint32_t>& moved = shading_.set.targets[k].vertices;
    const auto first = std::lower_bound(moved.begin(), moved.end(), part.first_vertex);
    return first != moved.end() && *first < part.first_vertex + part.vertex_count;
  }

  // How far tangents are from perpendicular to the right normal at weight 1, beyond what they are in the base.
  void find_stale_tangents(std::size_t k, const JudgedPart& part, const Weights& weights) {
    if (shading_.tangents.empty() || shading_.set.targets[k].vertices.empty()) return;
    BlendSource source(shading_, part, result_.rule, weights, [](std::size_t, double t) { return t; });
    std::vector<Vec3d> positions(part.vertices().size());
    PartNormals normals;
    source.place(0, 1, positions);
    part.normals(positions, normals);
    double worst = kAuditFault;
    std::optional<AuditPlace> worst_at;
    std::size_t count = 0;
    for (const JudgedOutput& output : part.outputs()) {
      const float* t = shading_.tangents.data() + 4 * std::size_t{output.vertex};
      const Vec3d before = to_double(Vec3f{t[0], t[1], t[2]});
      Vec3d after = before;
      if (!shading_.tangent_deltas[k].empty())
        after = after + to_double(vector_at(shading_.tangent_deltas[k], output.vertex));
      const Vec3d stored = to_double(vector_at(shading_.normals, output.vertex));
      const Vec3d right = source.right(output, normals.elements[output.element]);
      if (before == Vec3d{} || after == Vec3d{} || stored == Vec3d{} || right == Vec3d{}) continue;
      const auto lean = [](const Vec3d& a, const Vec3d& b) {
        return std::fabs(angle_between(a, b) * kDegreesPerRadian - 90);
      };
      const double grown = lean(after, right) - lean(before, stored);
      count += grown > kAuditFault ? 1U : 0U;
      if (grown > worst) {
        worst = grown;
        worst_at = source.at(0, 1, output);
      }
    }
    if (!worst_at) return;
    AuditFinding& finding = find(AuditFinding::Kind::kStaleTangents);
    finding.target = k;
    finding.count = count;
    finding.degrees = worst;
    finding.worst_at = worst_at;
  }

  void find_track_faults(const AuditSubject& subject) {
    using Kind = AuditFinding::Kind;
    if (!(subject.error.worst > kAuditFault)) return;
    const bool targets_known = options_.animation.empty() && !(shading_.mark && shading_.mark->sequence);
    if (targets_known && largest_alone_ > kAuditFault) return;  // said of the targets already
    const bool off_at_keys = subject.at_keys.worst > kAuditFault;
    AuditFinding& finding = find(targets_known ? Kind::kWrongTogether
                                 : off_at_keys ? Kind::kWrongAtKeys
                                               : Kind::kWrongBetween);
    finding.animation = subject.animation;
    finding.node = subject.node;
    finding.degrees = subject.error.worst;
    finding.worst_at = subject.error.worst_at;
  }

  const GltfDocument& document_;
  const AuditOptions& options_;
  const GltfShading& shading_;
  std::function<void()> progress_;
  Audit& result_;
  std::map<std::pair<std::size_t, std::size_t>, std::size_t> subject_of_curve_;  // by animation and same_keys_as
  double largest_alone_ = 0;
};

// The tracks that drive a mesh, in the animations that are asked for.
std::vector<std::pair<std::size_t, std::size_t>> tracks_of(const GltfDocument& document, std::size_t mesh,
                                                           std::optional<std::size_t> only) {
  std::vector<std::pair<std::size_t, std::size_t>> tracks;
  for (std::size_t a = 0; a < document.animations().size(); ++a) {
    if (only && a != *only) continue;
    for (std::size_t t = 0; t < document.animations()[a].tracks.size(); ++t)
      if (document.nodes()[document.animations()[a].tracks[t].node].mesh == mesh) tracks.emplace_back(a, t);
  }
  return tracks;
}

}  // namespace

Result<Audit> audit(const GltfDocument& document, const AuditOptions& options) {
  if (const Status status = check_samples(options); !status) return status.error();
  std::optional<std::size_t> only;
  if (!options.animation.empty()) {
    const Result<std::size_t> animation = document.find_animation(options.animation);
    if (!animation) return animation.error();
    only = animation.value();
  }
  Audit result;
  result.weighting = options.weighting;
  result.rule = options.rule.value_or(AuditRule::kGltf);
  const std::vector<GltfMesh>& meshes = document.meshes();
  std::size_t total = 0, done = 0;
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    total += only ? 0 : meshes[m].target_count;
    for (const auto& [a, t] : tracks_of(document, m, only))
      total += std::max<std::size_t>(1, document.animations()[a].tracks[t].key_count - 1);
  }
  const auto progress = [&] {
    ++done;
    if (options.progress) options.progress(std::min(done, total), total);
  };
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    const auto tracks = tracks_of(document, m, only);
    const bool has_faces = std::any_of(meshes[m].primitives.begin(), meshes[m].primitives.end(),
                                       [](const GltfPrimitive& p) { return p.has_faces(); });
    if (meshes[m].target_count == 0 || !has_faces || (only && tracks.empty())) continue;
    Result<GltfShading> shading = read_gltf_shading(document, m);
    if (!shading) return shading.error();
    MeshAudit mesh(document, options, shading.value(), progress, result);
    mesh.add_offset();
    if (result.weighting == Weighting::kArea) shading.value().groups.forget_corners();
    mesh.add_notes();
    const bool is_sequence = shading.value().mark && shading.value().mark->sequence;
    for (std::size_t k = 0; k < meshes[m].target_count && !only && !is_sequence; ++k) mesh.add_target(k);
    for (const auto& [a, t] : tracks)
      if (const Status status = mesh.add_track(a, t); !status) return status.error();
  }
  finish(result);
  return result;
}

}  // namespace chronormal
