// Finds the faults of a glTF file that an audit reports, other than errors of normals.
#include "workflow/audit/gltf_findings.h"

#include <algorithm>
#include <cmath>

#include "chronormal/analysis/quality.h"
#include "workflow/audit/measure.h"

namespace chronormal::inline internal {
namespace {

using Kind = AuditFinding::Kind;

AuditFinding finding_of(Kind kind, std::optional<std::size_t> mesh) {
  AuditFinding finding{};
  finding.kind = kind;
  finding.mesh = mesh;
  return finding;
}

bool moves_vertices(const GltfShading& shading, std::size_t k, const GltfPart& part) {
  const std::vector<std::uint32_t>& moved = shading.set.targets[k].vertices;
  const auto first = std::lower_bound(moved.begin(), moved.end(), part.first_vertex);
  return first != moved.end() && *first < part.first_vertex + part.vertex_count;
}

// Finds stale tangents of target k. A tangent is stale if its angle to the true normal is farther from 90 degrees at
// weight 1 of the target than in the base.
std::optional<AuditFinding> stale_tangents(const GltfShading& shading, const AuthorTruth& truth, AuditRule rule,
                                           std::size_t k, const JudgedPart& part, std::span<const std::size_t> involved,
                                           const Weights& weights) {
  if (shading.tangents.empty() || shading.set.targets[k].vertices.empty()) return std::nullopt;
  BlendSource source(
      shading, truth, part, rule, {involved.begin(), involved.end()}, weights, [](std::size_t, double t) { return t; },
      0);
  std::vector<Vec3d> positions(part.vertices().size());
  PartNormals normals;
  source.place(0, 1, positions);
  source.show();
  part.normals(positions, normals);
  source.turn(positions, normals.elements);
  AuditFinding finding = finding_of(Kind::kStaleTangents, shading.mesh);
  finding.target = k;
  finding.degrees = kAuditFault;
  for (std::size_t i = 0; i < part.outputs().size(); ++i) {
    const JudgedOutput& output = part.outputs()[i];
    const float* t = shading.tangents.data() + 4 * std::size_t{output.vertex};
    const Vec3d before = to_double(Vec3f{t[0], t[1], t[2]});
    Vec3d after = before;
    if (!shading.tangent_deltas[k].empty())
      after = after + to_double(vector_at(shading.tangent_deltas[k], output.vertex));
    const Vec3d stored = to_double(vector_at(shading.normals, output.vertex));
    Vec3d right = normals.elements[output.element];
    source.right(i, std::span(&right, 1));
    if (before == Vec3d{} || after == Vec3d{} || stored == Vec3d{} || right == Vec3d{}) continue;
    const auto lean = [](const Vec3d& a, const Vec3d& b) {
      return std::fabs(angle_between(a, b) * kDegreesPerRadian - 90);
    };
    const double grown = lean(after, right) - lean(before, stored);
    finding.count += grown > kAuditFault ? 1U : 0U;
    if (grown > finding.degrees) {
      finding.degrees = grown;
      finding.worst_at = source.at(0, 1, output);
    }
  }
  if (!finding.worst_at) return std::nullopt;
  return finding;
}

}  // namespace

std::vector<AuditFinding> notes_of(const GltfDocument& document, const GltfShading& shading) {
  std::vector<AuditFinding> notes;
  const auto note = [&](Kind kind, std::size_t count) {
    notes.push_back(finding_of(kind, shading.mesh));
    notes.back().count = count;
  };
  const auto& primitives = document.meshes()[shading.mesh].primitives;
  const auto flat = std::count_if(shading.parts.begin(), shading.parts.end(),
                                  [&](const GltfPart& p) { return !primitives[p.primitive].has_normals; });
  if (flat > 0) note(Kind::kFlat, static_cast<std::size_t>(flat));
  if (shading.mark) note(Kind::kBaked, shading.mark->extras.size());
  if (shading.emptied > 0) note(Kind::kEmptied, shading.emptied);
  if (shading.mark && shading.mark->sequence) note(Kind::kSequenceTargets, shading.own_targets());
  return notes;
}

std::vector<AuditFinding> notes_of_skins(const GltfDocument& document, const GltfShading& shading,
                                         std::span<const AuditSubject> subjects,
                                         const std::map<std::size_t, Error>& unread) {
  std::vector<AuditFinding> notes;
  const auto skinned = std::count_if(document.nodes().begin(), document.nodes().end(), [&](const GltfNode& node) {
    return node.mesh && *node.mesh == shading.mesh && node.has_skin;
  });
  const std::size_t count = static_cast<std::size_t>(skinned) - unread.size();
  if (count > 0) {
    AuditFinding& note = notes.emplace_back(finding_of(Kind::kSkinned, shading.mesh));
    note.count = count;
    for (const AuditSubject& subject : subjects) {
      if (!subject.skinning || !(subject.skinning->worst > note.degrees)) continue;
      note.degrees = subject.skinning->worst;
      note.worst_at = subject.skinning->worst_at;
      note.target = subject.target;
      note.expression = subject.expression;
      note.animation = subject.animation;
      note.node = subject.node;
    }
  }
  if (!unread.empty()) {
    AuditFinding& note = notes.emplace_back(finding_of(Kind::kUnreadSkin, shading.mesh));
    note.count = unread.size();
    note.node = unread.begin()->first;
    note.reason = unread.begin()->second;
  }
  return notes;
}

std::vector<AuditFinding> limits_of(const GltfShading& shading, std::span<const Viewer> viewers) {
  std::vector<AuditFinding> notes;
  const std::size_t targets = shading.set.targets.size();
  for (const Viewer& viewer : viewers) {
    if (viewer.most_targets == 0 || targets <= viewer.most_targets) continue;
    AuditFinding& note = notes.emplace_back(finding_of(Kind::kBeyondViewer, shading.mesh));
    note.count = targets - viewer.most_targets;
    note.viewer = viewer;
  }
  return notes;
}

std::vector<AuditFinding> faults_of_target(const GltfDocument& document, const GltfShading& shading,
                                           const AuthorTruth& truth, AuditRule rule, const AuditSubject& subject,
                                           const JudgedPart& part, std::span<const std::size_t> involved,
                                           const Weights& weights) {
  const std::size_t k = *subject.target;
  const auto& primitives = document.meshes()[shading.mesh].primitives;
  const auto lacks_normals = [&](const GltfPart& p) {
    const GltfPrimitive& primitive = primitives[p.primitive];
    return primitive.has_normals && primitive.targets[k].positions && !primitive.targets[k].normals &&
           moves_vertices(shading, k, p);
  };
  const auto lacking = std::count_if(shading.parts.begin(), shading.parts.end(), lacks_normals);
  std::vector<AuditFinding> faults;
  if (lacking > 0 && subject.error.unlit == 0) {
    AuditFinding& finding = faults.emplace_back(finding_of(Kind::kMissingNormals, shading.mesh));
    finding.target = k;
    finding.count = static_cast<std::size_t>(lacking);
    finding.degrees = subject.error.worst;
    if (subject.error.worst > 0) finding.worst_at = subject.error.worst_at;
  } else if (std::optional<AuditFinding> wrong = find_wrong_normals(subject)) {
    faults.push_back(*wrong);
  }
  if (std::optional<AuditFinding> stale = stale_tangents(shading, truth, rule, k, part, involved, weights))
    faults.push_back(*stale);
  return faults;
}

std::optional<AuditFinding> fault_of_track(const AuditSubject& subject, bool are_targets_judged, double worst_target) {
  std::optional<AuditFinding> fault = find_wrong_normals(subject);
  if (!fault || fault->kind == Kind::kUnlit) return fault;
  // If a target that was judged alone has an error about as large, the findings of the targets already report the error
  // of the track.
  if (are_targets_judged && worst_target > kAuditFault && subject.error.worst <= worst_target + kAuditFault)
    return std::nullopt;
  if (are_targets_judged) fault->kind = Kind::kWrongTogether;
  fault->degrees = subject.error.worst;
  fault->worst_at = subject.error.worst_at;
  return fault;
}

std::vector<AuditFinding> notes_of_truth(const GltfShading& shading, const AuthorTruth& truth) {
  std::vector<AuditFinding> notes;
  for (const StaleKey& key : truth.stale()) {
    AuditFinding& note = notes.emplace_back(finding_of(Kind::kStaleKeys, shading.mesh));
    note.target = key.target;
    note.count = key.vertices;
  }
  if (truth.rule().telling > 0 && !truth.rule().is_followed) {
    AuditFinding& note = notes.emplace_back(finding_of(Kind::kUnknownRule, shading.mesh));
    note.count = truth.rule().telling;
    note.degrees = truth.rule().spread;
  }
  return notes;
}

std::optional<AuditFinding> fault_of_pose(const AuditSubject& subject) {
  std::optional<AuditFinding> fault = find_wrong_normals(subject);
  if (fault && fault->kind != Kind::kUnlit) fault->kind = Kind::kWrongPose;
  return fault;
}

}  // namespace chronormal::inline internal
