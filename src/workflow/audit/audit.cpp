// Implements the functions that audits of glTF files and audits of sequences share.
#include "chronormal/workflow/audit.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <string>

#include "chronormal/normals/weighting.h"
#include "core/portable_math.h"
#include "workflow/audit/measure.h"
#include "workflow/audit/watched_audit.h"
#include "workflow/errors/error_rows.h"
#include "workflow/shading/surface_edges.h"

namespace chronormal {
namespace {

// Returns the upper end, in degrees, of a bin of the fine histogram of errors.
double end_of_fine_bin(std::size_t bin) noexcept {
  const int doubling = static_cast<int>(bin) / kAuditBinsOfDoubling,
            part = static_cast<int>(bin) % kAuditBinsOfDoubling;
  return std::ldexp(1 + part / static_cast<double>(kAuditBinsOfDoubling), kAuditLeastExponent + doubling);
}

constexpr std::array<std::string_view, 6> kRules = {"gltf", "lerp", "nlerp", "slerp", "step", "flat"};

// Returns true if two shards may belong to one audit: both shards judge the same vertices at the same samples by the
// same AuditRule.
bool are_of_one(const Audit& a, const Audit& b) {
  const auto same_subject = [](const AuditSubject& one, const AuditSubject& other) {
    return one.kind == other.kind && one.weighting == other.weighting && one.segments == other.segments &&
           one.samples == other.samples && one.vertices == other.vertices;
  };
  return a.rule == b.rule && a.stored == b.stored && a.still == b.still && a.span == b.span &&
         a.offsets.size() == b.offsets.size() &&
         std::equal(a.subjects.begin(), a.subjects.end(), b.subjects.begin(), b.subjects.end(), same_subject);
}

}  // namespace

Result<Audit> internal::merge(std::vector<AuditShard> shards) {
  const std::vector<AuditSubject>& subjects = shards.front().whole.subjects;
  const auto measured = join(shards, subjects.empty() ? 0 : subjects.front().segments, are_of_one, "audits");
  if (!measured) return measured.error();
  Audit all = std::move(shards.front().whole);
  if (all.subjects.empty()) return all;
  AuditSubject& subject = all.subjects.front();
  subject.error = subject.at_keys = all.error = {};
  for (const SegmentErrors& segment : measured.value()) {
    subject.error.add(segment.error);
    subject.at_keys.add(segment.at_keys);
  }
  all.worst = {};
  all.findings.clear();
  if (const std::optional<AuditFinding> fault = find_wrong_normals(subject)) all.findings.push_back(*fault);
  finish(all);
  return all;
}

const char* audit_subject_name(AuditSubject::Kind kind) noexcept {
  constexpr std::array<const char*, 6> kNames = {"target", "track", "sequence", "expression", "opening", "poses"};
  return kNames[static_cast<std::size_t>(kind)];
}

const char* audit_moment_name(AuditSubject::Kind kind) noexcept {
  if (kind == AuditSubject::Kind::kPoses) return "pose";
  return kind == AuditSubject::Kind::kTrack || kind == AuditSubject::Kind::kSequence ? "time" : "weight";
}

std::string_view audit_rule_name(AuditRule rule) noexcept { return kRules[static_cast<std::size_t>(rule)]; }

Result<AuditRule> make_audit_rule(std::string_view name) {
  for (std::size_t i = 0; i < kRules.size(); ++i)
    if (kRules[i] == name) return static_cast<AuditRule>(i);
  return Error{
      ErrorCode::kUsage, "",
      std::string("there is no rule '").append(name) + "'; choose one of gltf, lerp, nlerp, slerp, step, flat"};
}

MotionError error_of_mesh(const Audit& audit, std::size_t mesh) {
  MotionError error;
  for (const AuditSubject& subject : audit.subjects)
    if (subject.mesh == mesh) error.add(subject.error);
  return error;
}

WorseRespects find_worse(const MotionError& after, const MotionError& before) noexcept {
  // Tolerances for rounding errors, in degrees. A sum in float32 has an error of 1e-7 times the length of its terms,
  // and a normal may be a hundredth as long as the terms of its sum.
  constexpr double kWorst = 0.05, kMean = 0.001;
  // The average also grows if fewer samples are judged, for example because deltas that were only rounding errors have
  // been removed. For this reason the sum of all errors must grow as well.
  const bool is_farther =
      after.mean() > before.mean() + kMean && after.sum > before.sum + kMean * static_cast<double>(after.judged);
  // An edge is torn if the errors at its two vertices differ by more than 10 degrees. Rounding may tear edges that were
  // nearly torn before, so one more torn edge is allowed for each hundred torn edges.
  const bool is_torn = after.samples > 0 && before.samples > 0 && after.torn_edges() > 1.01 * before.torn_edges() + 0.5;
  return {after.unlit > before.unlit, is_farther, after.worst > before.worst + kWorst, is_torn};
}

std::size_t FineBins::operator[](std::size_t number) const noexcept {
  const auto at =
      std::partition_point(bins_.begin(), bins_.end(), [&](const Bin& bin) { return bin.number() < number; });
  return at != bins_.end() && at->number() == number ? at->count() : 0;
}

void FineBins::add(std::size_t number, std::uint64_t count) {
  if (count == 0) return;
  // Bins usually come in ascending order, so the new bin is usually the last one.
  if (bins_.empty() || bins_.back().number() < number) return bins_.push_back(Bin(number, count));
  const auto at =
      std::partition_point(bins_.begin(), bins_.end(), [&](const Bin& bin) { return bin.number() < number; });
  if (at != bins_.end() && at->number() == number)
    *at = Bin(number, at->count() + count);
  else
    bins_.insert(at, Bin(number, count));
}

void FineBins::add(const FineBins& other) {
  std::size_t before = bins_.size(), added = 0;
  for (std::size_t i = 0, j = 0; j < other.bins_.size(); ++j) {
    while (i < before && bins_[i].number() < other.bins_[j].number()) ++i;
    if (i == before || bins_[i].number() != other.bins_[j].number()) ++added;
  }
  if (added > 0) bins_.reserve(before + added);  // a vector that grows by itself would reserve more
  bins_.resize(before + added, Bin(0, 0));
  // Merging starts at the end, so that no bin is overwritten before it is read.
  for (std::size_t to = bins_.size(), from = other.bins_.size(); from > 0;) {
    const Bin& bin = other.bins_[from - 1];
    --to;
    if (before > 0 && bins_[before - 1].number() >= bin.number()) {
      bins_[to] = bins_[--before];
      if (bins_[to].number() != bin.number()) continue;
      bins_[to] = Bin(bin.number(), bins_[to].count() + bin.count());
    } else {
      bins_[to] = bin;
    }
    --from;
  }
}

void MotionError::add(double degrees, const AuditPlace& place) {
  ++judged;
  sum += degrees;
  sum_of_squares += degrees * degrees;
  ++histogram[bin_of(degrees)];
  counts.add(fine_bin_of(degrees), 1);
  if (degrees > worst) {
    worst = degrees;
    worst_at = place;
  }
}

void MotionError::add_unlit(const AuditPlace& place) {
  if (unlit++ == 0) unlit_at = place;
  add(180, place);
}

void MotionError::add(const MotionError& other) {
  if (unlit == 0) unlit_at = other.unlit_at;
  judged += other.judged;
  sum += other.sum;
  sum_of_squares += other.sum_of_squares;
  no_normal += other.no_normal;
  unlit += other.unlit;
  for (std::size_t bin = 0; bin < histogram.size(); ++bin) histogram[bin] += other.histogram[bin];
  counts.add(other.counts);
  if (other.worst > worst) {
    worst = other.worst;
    worst_at = other.worst_at;
  }
  faint += other.faint;
  if (other.faint_worst > faint_worst) {
    faint_worst = other.faint_worst;
    faint_at = other.faint_at;
  }
  if (cancelled == 0) cancelled_at = other.cancelled_at;
  cancelled += other.cancelled;
  for (std::size_t k = 0; k < torn.size(); ++k) torn[k] += other.torn[k];
  samples += other.samples;
  if (other.most_torn > most_torn) {
    most_torn = other.most_torn;
    most_torn_at = other.most_torn_at;
  }
}

double MotionError::percentile(double share) const noexcept {
  const double wanted = share * static_cast<double>(judged);
  std::size_t seen = 0;
  for (const FineBins::Bin& bin : counts.filled()) {
    seen += bin.count();
    if (static_cast<double>(seen) >= wanted) return std::min(end_of_fine_bin(bin.number()), worst);
  }
  return worst;
}

inline namespace internal {

double faint_degrees(const Vec3d& shown, const Vec3d& right, double length, double rounding) noexcept {
  if (!(length > rounding)) return kNotJudged;
  if (shown == Vec3d{}) return 180;
  const double explained = portable::asin(rounding / length);
  return std::max(0.0, angle_between(shown, right) - explained) * kDegreesPerRadian;
}

Vec3f blend_stored(AuditRule rule, const Vec3d& from, const Vec3d& to, double t) noexcept {
  if (rule == AuditRule::kStep) return to_float(unit(t < 1 ? from : to));
  if (rule == AuditRule::kLerp) return to_float(unit(lerp(from, to, t)));
  const Vec3d u0 = unit(from), u1 = unit(to);
  if (rule == AuditRule::kNlerp || u0 == Vec3d{} || u1 == Vec3d{}) return to_float(unit(lerp(u0, u1, t)));
  const double angle = angle_between(u0, u1), sine = portable::sin(angle);
  // The smallest sine of the angle between u0 and u1 for which the arc between them is computed. If the sine is
  // smaller, the arc is practically a straight line, or undefined because the ends are opposite.
  constexpr double kStraight = 1e-9;
  if (sine < kStraight) return to_float(unit(lerp(u0, u1, t)));
  return to_float((portable::sin((1 - t) * angle) / sine) * u0 + (portable::sin(t * angle) / sine) * u1);
}

void count_torn(const JudgedPart& part, std::span<const Vec3f> differences, const AuditPlace& at, MotionError& error) {
  constexpr std::size_t kEdgeBlock = 4096;
  // `differences` are the rendered normals minus the true normals. An edge is torn if the differences at its two ends
  // are too far apart. If both differences are shorter than half of the smallest limit, the edge is not torn. Most
  // edges need no other test.
  constexpr float kQuarter = 0.999F * TearCounts::kSquares[0] / 4;  // the factor leaves a margin for rounding
  std::vector<std::uint8_t> is_far(part.vertices_of_edges());
  std::size_t far = 0;
  for (std::size_t i = 0; i < differences.size(); ++i) {
    const Vec3f& d = differences[i];
    if (!(d.x * d.x + d.y * d.y + d.z * d.z > kQuarter)) continue;
    is_far[part.outputs()[i].vertex] = 1;
    ++far;
  }
  const Vec3f none;
  const auto difference_at = [&](std::uint32_t vertex) {
    const std::uint32_t output = part.output_of(vertex);
    return output < differences.size() ? &differences[output].x : &none.x;
  };
  const auto count_edge = [&](std::size_t e, TearCounts& counts) {
    const auto [a, b] = part.edges()[e];
    if ((is_far[a] | is_far[b]) != 0) counts.add(difference_at(a), difference_at(b), 1);
  };
  const TearCounts found = parallel_fold<TearCounts>(far > 0 ? part.edges().size() : 0, kEdgeBlock, count_edge,
                                                     [](TearCounts& to, const TearCounts& from) { to.add(from); });
  error.torn = found.beyond;
  error.samples = 1;
  error.most_torn = found.beyond[0];
  error.most_torn_at = at;
}

std::size_t samples_per_segment(const AuditOptions& options, std::size_t segments, std::size_t fewest) noexcept {
  if (options.samples) return *options.samples;
  // An odd number is chosen, so that one sample is in the middle of the segment.
  return std::clamp(kAuditSamplesOfAll / std::max<std::size_t>(1, segments) | 1U, fewest, kAuditSamples);
}

Status check_samples(const AuditOptions& options) {
  if (options.samples && (*options.samples < 2 || *options.samples > kMostAuditSamples))
    return Error{ErrorCode::kUsage, "", "the number of samples must be from 2 to " + std::to_string(kMostAuditSamples)};
  return Success{};
}

AuthoredOffset authored_offset(const AuthoredWeighting& authored, std::optional<Weighting> asked) {
  AuthoredOffset result;
  result.weighting = asked.value_or(authored.detected);
  result.is_detected = !asked;
  const WeightingDistance& distance = authored.of(result.weighting);
  result.vertices = distance.count;
  result.sum = distance.sum;
  result.worst = distance.worst;
  result.worst_at.vertex = distance.worst_at;
  result.area_mean = authored.of(Weighting::kArea).mean();
  const WeightingDistance* closest = authored.distances.data();
  for (const WeightingInfo& tried : kWeightings) {
    const WeightingDistance& of_tried = authored.of(tried.weighting);
    if (of_tried.mean() < closest->mean()) {
      closest = &of_tried;
      result.closest = tried.weighting;
    }
  }
  result.closest_mean = closest->mean();
  result.closest_worst = closest->worst;
  return result;
}

void keep_sample(const KeptErrors& kept, std::span<const JudgedOutput> outputs, std::span<const float> degrees,
                 bool is_weight, double at) {
  const std::span<float> row = add_row(*kept.table, kept.subject, is_weight, at);
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    float& worst = row[outputs[i].vertex];
    worst = std::fmax(worst, degrees[i]);  // fmax ignores NaN
  }
}

std::optional<AuditFinding> find_wrong_normals(const AuditSubject& subject) {
  if (!(subject.error.worst > kAuditFault)) return std::nullopt;
  const bool off_at_keys = subject.at_keys.worst > kAuditFault;
  const MotionError& error = off_at_keys ? subject.at_keys : subject.error;
  AuditFinding finding{};
  finding.kind = off_at_keys ? AuditFinding::Kind::kWrongAtKeys : AuditFinding::Kind::kWrongBetween;
  if (subject.error.unlit > 0) {
    finding.kind = AuditFinding::Kind::kUnlit;
    finding.count = subject.error.unlit;
  }
  finding.mesh = subject.mesh;
  finding.target = subject.target;
  finding.node = subject.node;
  finding.animation = subject.animation;
  finding.expression = subject.expression;
  finding.degrees = error.worst;
  finding.worst_at = error.worst_at;
  if (subject.error.unlit > 0) finding.worst_at = subject.error.unlit_at;
  return finding;
}

void finish(Audit& result) {
  for (std::size_t s = 0; s < result.subjects.size(); ++s) {
    if (result.subjects[s].error.worst > result.error.worst) result.worst = s;
    result.error.add(result.subjects[s].error);
    if (s == 0) result.weighting = result.subjects[s].weighting;
    if (result.weighting != result.subjects[s].weighting) result.weighting = std::nullopt;
  }
  std::stable_partition(result.findings.begin(), result.findings.end(),
                        [](const AuditFinding& finding) { return finding.is_fault(); });
}

}  // namespace internal
}  // namespace chronormal
