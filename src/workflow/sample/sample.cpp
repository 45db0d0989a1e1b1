// Computes the normals of a motion at given moments, one moment after the other.
#include "chronormal/workflow/sample.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <utility>

#include "chronormal/core/parallel.h"
#include "chronormal/normals/mesh_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "core/blocks.h"
#include "core/text.h"
#include "core/twofold.h"
#include "motion/segment_end.h"
#include "normals/recompute/recompute.h"
#include "normals/weighting/shared_weighting.h"
#include "workflow/sample/scheme_normals.h"

namespace chronormal {
namespace {

constexpr std::size_t kBlock = 4096;
// The distance up to which a local t counts as equal to a step. The command line allows at most a million steps, so
// neighbouring steps are at least 1e-6 apart.
constexpr double kLargestStepError = 1e-7;
constexpr double kLargestFloat = std::numeric_limits<float>::max();

Error misuse(std::string message) { return Error{ErrorCode::kUsage, "", std::move(message)}; }

float clamped_to_float(double value) { return static_cast<float>(std::clamp(value, -kLargestFloat, kLargestFloat)); }

std::vector<float> positions_at(const Segment& segment, double t) {
  std::vector<float> positions(3 * segment.from.count);
  const auto result = VectorView<float>::packed(positions.data(), segment.from.count);
  const SegmentEnd from = SegmentEnd::from(segment), to = SegmentEnd::to(segment);
  parallel_each(segment.from.count, kBlock, [&](std::size_t v) { result.set(v, to_float(lerp(from[v], to[v], t))); });
  return positions;
}

// Makes a keyframe from computed positions. Returns an error if a position is too large for float32. The message of the
// error begins with `mover`.
Result<Motion::Keyframe> pose_of(const LongSums& positions, const std::string& mover) {
  for (std::size_t i = 0; i < positions.high().size(); ++i) {
    if (!(std::fabs(positions.high()[i]) <= kLargestFloat))
      return misuse(mover + " vertex " + std::to_string(i / 3) +
                    " so far that float32 cannot hold its position; use smaller weights");
  }
  Motion::Keyframe pose;
  pose.set_positions(positions.high(), positions.low());
  return pose;
}

std::vector<Vec3d> all_face_normals_at(const Segment& segment, const LocalTime& t) {
  std::vector<Vec3d> normals(segment.topology->face_count());
  parallel_blocks(normals.size(), kBlock, [&](IndexRange faces) {
    face_normals_at(segment, t, faces, std::span(normals).subspan(faces.first, faces.count));
  });
  return normals;
}

}  // namespace

Result<TargetWeight> internal::one_target_of(std::span<const double> weights) {
  TargetWeight own;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    if (weights[i] == 0) continue;
    if (own.weight != 0 || !(weights[i] > 0 && weights[i] <= 1))
      return misuse("with a scheme only one target may be active; give it a weight from 0 to 1, and all others 0");
    own = {i, weights[i]};
  }
  return own;
}

Result<Moments> step_moments(const Motion& motion, std::size_t steps) {
  if (motion.segments.empty()) return misuse("the mesh does not move, so there are no steps; leave the steps out");
  if (steps == 0) return misuse("the number of steps must be at least 1");
  Moments moments;
  const bool are_targets = motion.kind == MotionKind::kTargets;
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    const double start = motion.keyframes[motion.segments[s].from].time;
    const double end = motion.keyframes[motion.segments[s].to].time;
    const bool is_joined =
        !are_targets && s + 1 < motion.segments.size() && motion.keyframes[motion.segments[s + 1].from].time == end;
    for (std::size_t i = 0; i < steps + (is_joined ? 0U : 1U); ++i) {
      const double t = static_cast<double>(i) / static_cast<double>(steps);
      if (are_targets) {
        moments.weights.emplace_back(motion.segments.size(), 0.0)[s] = t;
      } else {
        moments.times.push_back(i == steps ? end : (1 - t) * start + t * end);
      }
    }
  }
  return moments;
}

Status check_weights(const Motion& motion, std::span<const double> weights) {
  if (motion.kind != MotionKind::kTargets)
    return misuse("weights are only for blend shapes; give times for this motion");
  const std::size_t targets = motion.segments.size();
  if (weights.size() != targets)
    return misuse("the input has " + counted(targets, "target", "targets") + ", but the pose has " +
                  counted(weights.size(), "weight", "weights") + "; give one weight for each target");
  for (std::size_t i = 0; i < targets; ++i) {
    if (!std::isfinite(weights[i]))
      return misuse("the weight of target " + std::to_string(i) + " is NaN or infinite; give finite weights");
  }
  return Success{};
}

Result<NormalSampler> NormalSampler::make(const Motion& motion, const SampleOptions& options) {
  auto whole = std::make_unique<MotionStream>(motion);
  Result<NormalSampler> sampler = make(*whole, options);
  if (sampler) sampler.value().whole_ = std::move(whole);
  return sampler;
}

Result<NormalSampler> NormalSampler::make(MotionStream& stream, const SampleOptions& options) {
  assert(!stream.motion().keyframes.empty());
  const bool by_area = options.weighting == Weighting::kArea;
  if (options.length == NormalLength::kArea && !by_area)
    return misuse(
        "the length 'area', which is twice the area of the faces, needs the weighting 'area'; choose this weighting, "
        "or "
        "the length 'unit'");
  if (options.stepping && options.scheme.empty()) return misuse("steps need a scheme; name a scheme");
  if (!options.scheme.empty()) {
    const auto scheme = scheme_for(options.scheme, options.elements.kind);
    if (!scheme) return scheme.error();
    if (options.length == NormalLength::kArea || !by_area)
      return misuse(
          "a scheme can only be used with the weighting area and the length unit; choose these, or leave the scheme "
          "out");
    if (stream.motion().segments.empty())
      return misuse("the mesh does not move, so a scheme has nothing to interpolate; leave the scheme out");
    if (options.stepping && options.stepping->steps == 0) return misuse("the number of steps must be at least 1");
    if (options.stepping && !scheme.value()->sequential_operations())
      return misuse(options.scheme +
                    " cannot go step by step, since it computes every normal on its own; leave the steps out");
  }
  NormalSampler sampler(stream, options);
  if (options.elements.kind == ElementKind::kFaces) {
    if (!by_area) return misuse("a weighting has no meaning for normals of faces; choose vertices or corners");
    return sampler;
  }
  Result<NormalGroups> groups = make_groups(stream, options.elements);
  if (!groups) return groups.error();
  sampler.groups_ = std::make_unique<const NormalGroups>(std::move(groups).value());
  return sampler;
}

std::size_t NormalSampler::element_count() const noexcept {
  return are_faces() ? motion_->topology.face_count() : groups_->size();
}

std::size_t NormalSampler::output_count() const noexcept {
  return are_faces() ? motion_->topology.face_count() : groups_->element_of_output().size();
}

std::span<const std::uint32_t> NormalSampler::element_of_output() const noexcept {
  return are_faces() ? std::span<const std::uint32_t>() : groups_->element_of_output();
}

std::vector<float> NormalSampler::normals_of_outputs(const Pose& pose) const {
  assert(pose.normals.size() == 3 * element_count());
  if (are_faces()) return pose.normals;
  std::vector<float> normals(3 * output_count());
  groups_->copy_to_outputs(VectorView<const float>::packed(pose.normals.data(), element_count()),
                           VectorView<float>::packed(normals.data(), output_count()));
  return normals;
}

std::vector<float> NormalSampler::unit_normals(const Segment& segment, const LocalTime& t) {
  if (segment_ != segment.index) {
    curves_ = are_faces() ? NormalCurves::of_faces(segment, {}, Threads::kAll, &curves_)
                          : NormalCurves::of_groups(segment, *groups_, {}, Threads::kAll, &curves_);
    segment_ = segment.index;
  }
  std::vector<float> normals(3 * element_count());
  // Does not count normals without a direction, because the code that writes the normals counts them.
  curves_.unit_normals(t, VectorView<float>::packed(normals.data(), element_count()), Threads::kAll);
  return normals;
}

Result<std::vector<float>> NormalSampler::scheme_normals(const Segment& segment, double t, double time) {
  if (!scheme_normals_ || segment_ != segment.index) {
    scheme_normals_.reset();  // frees memory before the next object is created
    scheme_normals_ = std::make_shared<SchemeNormals>(segment, groups_.get(), options_.scheme);
    segment_ = segment.index;
  }
  std::vector<float> normals(3 * element_count());
  const auto result = VectorView<float>::packed(normals.data(), element_count());
  if (!options_.stepping) {
    scheme_normals_->unit_normals(t, result);
    return normals;
  }
  const auto& [steps, anchor_interval] = *options_.stepping;
  const auto index = static_cast<std::size_t>(std::llround(t * static_cast<double>(steps)));
  if (!(std::fabs(t - static_cast<double>(index) / static_cast<double>(steps)) <= kLargestStepError))
    return misuse("the steps do not include t = " + rounded_text(time, {0, 1}) + "; choose a time at which a step is");
  std::vector<float> at_random(normals.size());
  const auto expected = VectorView<float>::packed(at_random.data(), element_count());
  scheme_normals_->unit_normals(static_cast<double>(index) * (1 / static_cast<double>(steps)), expected);
  scheme_normals_->played_normals(index, steps, anchor_interval, result);
  // The worst drift of an element so far. Drift is never negative, so the search can begin with drift 0 at the first
  // element.
  struct Worst {
    double angle = 0;
    std::size_t element = 0;
  };
  const Worst worst = parallel_fold<Worst>(
      element_count(), kBlock,
      [&](std::size_t i, Worst& of_block) {
        const double angle = angle_between(to_double(expected[i]), to_double(result[i]));
        if (angle > of_block.angle) of_block = {angle, i};
      },
      [](Worst& all, const Worst& of_block) {
        if (of_block.angle > all.angle) all = of_block;
      });
  if (worst.angle > drift_.largest) {
    const auto outputs = element_of_output();
    const auto first = std::find(outputs.begin(), outputs.end(), worst.element) - outputs.begin();
    drift_ = {worst.angle, are_faces() ? worst.element : static_cast<std::size_t>(first), time};
  }
  return normals;
}

std::vector<float> NormalSampler::normals_anew(const Segment& segment, const LocalTime& t) const {
  if (are_exact_units()) {
    std::vector<float> normals(3 * element_count());
    NormalRecompute recompute = are_faces() ? NormalRecompute(segment) : NormalRecompute(segment, *groups_);
    recompute.unit_normals(t, VectorView<float>::packed(normals.data(), element_count()), Threads::kAll);
    return normals;
  }
  const std::vector<Vec3d> exact =
      are_faces() ? all_face_normals_at(segment, t) : all_weighted_normals_at(segment, *groups_, options_.weighting, t);
  return as_asked(exact);
}

std::vector<float> NormalSampler::as_asked(std::span<const Vec3d> exact) const {
  std::vector<float> normals(3 * exact.size());
  const auto result = VectorView<float>::packed(normals.data(), exact.size());
  parallel_each(exact.size(), kBlock, [&](std::size_t i) {
    const Vec3d scaled = options_.length == NormalLength::kArea ? exact[i] : unit(exact[i]);
    result.set(i, {clamped_to_float(scaled.x), clamped_to_float(scaled.y), clamped_to_float(scaled.z)});
  });
  return normals;
}

Result<Pose> NormalSampler::at_time(double time) {
  const Result<Instant> instant = find_instant(*motion_, time);
  if (!instant) return instant.error();
  const LocalTime t = instant.value().t;
  const std::size_t here = instant.value().segment;
  if (const Status status = stream_->hold_segment(here); !status) return status.error();
  const Segment segment = motion_->segment(here);
  if (!options_.scheme.empty()) {
    Result<std::vector<float>> normals = scheme_normals(segment, t, time);
    if (!normals) return normals.error();
    return Pose{positions_at(segment, t), std::move(normals).value()};
  }
  return Pose{positions_at(segment, t), are_exact_units() ? unit_normals(segment, t) : normals_anew(segment, t)};
}

Result<Pose> NormalSampler::at_weights(std::span<const double> weights) {
  if (Status status = check_weights(*motion_, weights); !status) return status.error();
  const Result<TargetWeight> own = options_.scheme.empty() ? TargetWeight{} : one_target_of(weights);
  if (!own) return own.error();
  if (Status status = stream_->hold_all(); !status) return status.error();
  // Computes base + sum of w (target - base). To lose no digits if base and targets are far apart, the base gets the
  // factor 1 - sum of w, which is exactly zero for a single target of weight 1.
  Twofold rest{1, 0};
  for (const double weight : weights) rest = rest + Twofold{-weight, 0};
  LongSums positions(3 * motion_->topology.vertex_count());
  const auto add = [&](double weight, const Motion::Keyframe& keyframe) {
    if (weight == 0) return;
    positions.add(weight, keyframe.positions);
    if (!keyframe.residuals.empty()) positions.add(weight, keyframe.residuals);
  };
  add(rest.high, motion_->keyframes[0]);
  add(rest.low, motion_->keyframes[0]);
  for (std::size_t k = 0; k < weights.size(); ++k) add(weights[k], motion_->keyframes[k + 1]);
  positions.settle();

  Result<Motion::Keyframe> pose = pose_of(positions, "these weights move");
  if (!pose) return pose.error();
  if (!options_.scheme.empty()) {
    const auto [target, weight] = own.value();
    Result<std::vector<float>> normals = scheme_normals(motion_->segment(target), weight, weight);
    if (!normals) return normals.error();
    return Pose{std::move(pose.value().positions), std::move(normals).value()};
  }
  const std::vector<float> normals = normals_anew(still_segment(motion_->topology, pose.value()), 0.0);
  return Pose{std::move(pose.value().positions), normals};
}

Pose NormalSampler::at_rest() const {
  return {motion_->keyframes[0].positions, normals_anew(still_segment(motion_->topology, motion_->keyframes[0]), 0.0)};
}

}  // namespace chronormal
