// What audits of glTF files and of sequences share.
#include "chronormal/workflow/audit.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "chronormal/normals/weighting.h"
#include "core/blocks.h"
#include "core/rounding.h"
#include "core/vector_area.h"
#include "workflow/audit/audit_judge.h"

namespace chronormal {
namespace {

constexpr std::array<std::string_view, 6> kRules = {"gltf", "lerp", "nlerp", "slerp", "step", "flat"};

constexpr std::uint32_t kUnused = static_cast<std::uint32_t>(-1);

// Numbers those that are not kUnused in their order; returns them.
std::vector<std::uint32_t> number_used(std::vector<std::uint32_t>& marks) {
  std::vector<std::uint32_t> used;
  used.reserve(marks.size() - static_cast<std::size_t>(std::count(marks.begin(), marks.end(), kUnused)));
  for (std::size_t i = 0; i < marks.size(); ++i) {
    if (marks[i] == kUnused) continue;
    marks[i] = static_cast<std::uint32_t>(used.size());
    used.push_back(static_cast<std::uint32_t>(i));
  }
  return used;
}

}  // namespace

std::string_view audit_rule_name(AuditRule rule) noexcept { return kRules[static_cast<std::size_t>(rule)]; }

Result<AuditRule> make_audit_rule(std::string_view name) {
  for (std::size_t i = 0; i < kRules.size(); ++i)
    if (kRules[i] == name) return static_cast<AuditRule>(i);
  return Error{ErrorCode::kUsage, "",
               std::string("there is no rule '").append(name) + "'; there are gltf, lerp, nlerp, slerp, step, flat"};
}

void MotionError::add(double degrees, const AuditPlace& place) noexcept {
  ++judged;
  sum += degrees;
  sum_of_squares += degrees * degrees;
  const auto* const bin = std::upper_bound(kAuditBinEdges.begin(), kAuditBinEdges.end(), degrees);
  ++histogram[static_cast<std::size_t>(bin - kAuditBinEdges.begin())];
  if (degrees > worst) {
    worst = degrees;
    worst_at = place;
  }
}

void MotionError::add(const MotionError& other) noexcept {
  judged += other.judged;
  sum += other.sum;
  sum_of_squares += other.sum_of_squares;
  no_normal += other.no_normal;
  no_shown += other.no_shown;
  for (std::size_t bin = 0; bin < histogram.size(); ++bin) histogram[bin] += other.histogram[bin];
  if (other.worst > worst) {
    worst = other.worst;
    worst_at = other.worst_at;
  }
}

JudgedPart::JudgedPart(const Topology& topology, const NormalGroups& groups, Weighting weighting,
                       std::vector<JudgedOutput> outputs, bool needs_faces)
    : weighting_(weighting), keeps_faces_(needs_faces || weighting != Weighting::kArea), outputs_(std::move(outputs)) {
  std::vector<std::uint32_t> element(groups.size(), kUnused), face(topology.face_count(), kUnused);
  std::vector<std::uint32_t> vertex(topology.vertex_count(), kUnused);
  for (const JudgedOutput& output : outputs_) element[output.element] = 0;
  elements_ = number_used(element);
  for (const std::uint32_t e : elements_)
    for (const std::uint32_t f : groups.faces(e)) face[f] = 0;
  const std::vector<std::uint32_t> faces = number_used(face);
  for (const std::uint32_t f : faces)
    for (const std::uint32_t v : topology.face(f)) vertex[v] = 0;
  vertices_ = number_used(vertex);

  constexpr std::size_t kSmallFace = 4;
  std::size_t face_corners = 0, element_corners = 0;
  for (const std::uint32_t f : faces) {
    face_corners += topology.face(f).size();
    keeps_faces_ = keeps_faces_ || topology.face(f).size() > kSmallFace;
  }
  for (const std::uint32_t e : elements_) element_corners += groups.faces(e).size();
  const bool has_corners = weighting != Weighting::kArea;
  face_vertices_.reserve(face_corners);
  face_offsets_.reserve(faces.size() + 1);
  faces_of_element_.reserve(element_corners);
  element_offsets_.reserve(elements_.size() + 1);
  if (has_corners) corners_of_element_.reserve(element_corners);
  for (const std::uint32_t f : faces) {
    for (const std::uint32_t v : topology.face(f)) face_vertices_.push_back(vertex[v]);
    face_offsets_.push_back(static_cast<std::uint32_t>(face_vertices_.size()));
  }
  for (const std::uint32_t e : elements_) {
    for (std::size_t i = 0; i < groups.faces(e).size(); ++i) {
      const std::uint32_t f = groups.faces(e)[i];
      const auto first_corner = topology.face(f).data() - topology.corners().data();
      faces_of_element_.push_back(face[f]);
      if (has_corners) corners_of_element_.push_back(groups.corners(e)[i] - static_cast<std::uint32_t>(first_corner));
    }
    element_offsets_.push_back(static_cast<std::uint32_t>(faces_of_element_.size()));
  }
  for (JudgedOutput& output : outputs_) {
    output.element = element[output.element];
    output.face = face[output.face];
  }
}

void JudgedPart::normals(std::span<const Vec3d> positions, PartNormals& result) const {
  result.faces.resize(keeps_faces_ ? face_offsets_.size() - 1 : 0);
  result.elements.resize(elements_.size());
  numbered_blocks(result.faces.size(), kRange, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t f = first; f < last; ++f) result.faces[f] = face_normal(positions, f);
  });
  numbered_blocks(result.elements.size(), kRange, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) {
      Vec3d sum;
      double size = 0;  // of the terms
      for (std::uint32_t i = element_offsets_[e]; i < element_offsets_[e + 1]; ++i) {
        const std::uint32_t f = faces_of_element_[i];
        const Vec3d normal = keeps_faces_ ? result.faces[f] : face_normal(positions, f);
        const Vec3d added = corners_of_element_.empty() ? normal : term(positions, f, corners_of_element_[i], normal);
        sum = sum + added;
        size += max_abs(added);
      }
      // What is left of terms that cancel is their rounding, and no direction.
      constexpr double kRounding = 1e-13;
      result.elements[e] = without_rounding(sum, kRounding * size);
    }
  });
}

Vec3d JudgedPart::face_normal(std::span<const Vec3d> positions, std::size_t face) const {
  const auto at = [&](std::size_t c) { return positions[face_vertices_[face_offsets_[face] + c]]; };
  const std::size_t corners = face_offsets_[face + 1] - face_offsets_[face];
  return twice_vector_area(corners, at);
}

Vec3d JudgedPart::term(std::span<const Vec3d> positions, std::size_t face, std::size_t corner,
                       const Vec3d& normal) const {
  if (weighting_ == Weighting::kUniform || normal == Vec3d{}) return unit(normal);
  const std::size_t first = face_offsets_[face], corners = face_offsets_[face + 1] - first;
  const auto at = [&](std::size_t c) { return positions[face_vertices_[first + c % corners]]; };
  const Vec3d e = at(corner + 1) - at(corner), f = at(corner + corners - 1) - at(corner);
  if (e == Vec3d{} || f == Vec3d{}) return {};
  if (weighting_ == Weighting::kMax) return (1 / (dot(e, e) * dot(f, f))) * cross(e, f);
  return angle_between(e, f) * (weighting_ == Weighting::kAngle ? unit(normal) : normal);
}

Vec3f blend_stored(AuditRule rule, const Vec3d& from, const Vec3d& to, double t) noexcept {
  if (rule == AuditRule::kStep) return to_float(unit(t < 1 ? from : to));
  if (rule == AuditRule::kLerp) return to_float(unit(lerp(from, to, t)));
  const Vec3d u0 = unit(from), u1 = unit(to);
  if (rule == AuditRule::kNlerp || u0 == Vec3d{} || u1 == Vec3d{}) return to_float(unit(lerp(u0, u1, t)));
  const double angle = angle_between(u0, u1), sine = std::sin(angle);
  constexpr double kStraight = 1e-9;  // near 0 and 180 degrees the arc is a line, or none
  if (sine < kStraight) return to_float(unit(lerp(u0, u1, t)));
  return to_float((std::sin((1 - t) * angle) / sine) * u0 + (std::sin(t * angle) / sine) * u1);
}

std::size_t samples_per_segment(const AuditOptions& options, std::size_t segments) noexcept {
  return options.samples.value_or(segments > kAuditManySegments ? kAuditFewSamples : kAuditSamples);
}

Status check_samples(const AuditOptions& options) {
  constexpr std::size_t kMost = 1000001;
  if (options.samples && (*options.samples < 2 || *options.samples > kMost))
    return Error{ErrorCode::kUsage, "", "there must be from 2 to 1,000,001 samples"};
  return Success{};
}

AuthoredOffset authored_offset(const Topology& topology, VectorView<const float> positions, const NormalGroups& groups,
                               Weighting weighting, std::span<const JudgedOutput> outputs,
                               const std::function<Vec3d(const JudgedOutput&)>& stored) {
  const Segment still{&topology, positions, positions, 0, 1, 0};
  AuthoredOffset result;
  for (const WeightingInfo& tried : kWeightings) {
    const std::vector<Vec3d> normals = all_weighted_normals_at(still, groups, tried.weighting, 0);
    double sum = 0, worst = 0;
    std::size_t count = 0, worst_vertex = 0;
    for (const JudgedOutput& output : outputs) {
      const Vec3d normal = stored(output);
      if (normal == Vec3d{} || normals[output.element] == Vec3d{}) continue;
      const double angle = angle_between(normal, normals[output.element]) * kDegreesPerRadian;
      ++count;
      sum += angle;
      if (angle > worst) {
        worst = angle;
        worst_vertex = output.vertex;
      }
    }
    const double mean = count > 0 ? sum / static_cast<double>(count) : 0;
    if (tried.weighting == weighting) {
      result.vertices = count;
      result.sum = sum;
      result.worst = worst;
      result.worst_at.vertex = worst_vertex;
    }
    if (tried.weighting == kWeightings[0].weighting || mean < result.closest_mean) {
      result.closest = tried.weighting;
      result.closest_mean = mean;
      result.closest_worst = worst;
    }
  }
  return result;
}

void finish(Audit& result) {
  for (std::size_t s = 0; s < result.subjects.size(); ++s) {
    if (result.subjects[s].error.worst > result.error.worst) result.worst = s;
    result.error.add(result.subjects[s].error);
  }
  std::stable_partition(result.findings.begin(), result.findings.end(),
                        [](const AuditFinding& finding) { return finding.is_fault(); });
}

}  // namespace chronormal
