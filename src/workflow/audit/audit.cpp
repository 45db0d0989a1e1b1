// What audits of glTF files and of sequences share.
#include "chronormal/workflow/audit.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "chronormal/normals/weighting.h"
#include "workflow/audit/measure.h"

namespace chronormal {
namespace {

constexpr std::array<std::string_view, 6> kRules = {"gltf", "lerp", "nlerp", "slerp", "step", "flat"};

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

inline namespace internal {

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
  if (options.samples && (*options.samples < 2 || *options.samples > kMostAuditSamples))
    return Error{ErrorCode::kUsage, "", "there must be from 2 to " + std::to_string(kMostAuditSamples) + " samples"};
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

std::optional<AuditFinding> find_wrong_normals(const AuditSubject& subject) {
  if (!(subject.error.worst > kAuditFault)) return std::nullopt;
  const bool off_at_keys = subject.at_keys.worst > kAuditFault;
  const MotionError& error = off_at_keys ? subject.at_keys : subject.error;
  AuditFinding finding{};
  finding.kind = off_at_keys ? AuditFinding::Kind::kWrongAtKeys : AuditFinding::Kind::kWrongBetween;
  finding.mesh = subject.mesh;
  finding.target = subject.target;
  finding.node = subject.node;
  finding.animation = subject.animation;
  finding.degrees = error.worst;
  finding.worst_at = error.worst_at;
  return finding;
}

void finish(Audit& result) {
  for (std::size_t s = 0; s < result.subjects.size(); ++s) {
    if (result.subjects[s].error.worst > result.error.worst) result.worst = s;
    result.error.add(result.subjects[s].error);
  }
  std::stable_partition(result.findings.begin(), result.findings.end(),
                        [](const AuditFinding& finding) { return finding.is_fault(); });
}

}  // namespace internal
}  // namespace chronormal
