// Audits sequences in a viewer that interpolates normals between keyframes.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "chronormal/core/views.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/workflow/audit.h"
#include "core/blocks.h"
#include "core/float32.h"
#include "core/portable_math.h"
#include "core/text.h"
#include "io/bytes/checksum.h"
#include "motion/segment_end.h"
#include "workflow/audit/measure.h"
#include "workflow/audit/measure_blocks.h"
#include "workflow/audit/watched_audit.h"
#include "workflow/errors/error_rows.h"
#include "workflow/shading/authored_weighting.h"

namespace chronormal {
namespace {

Vec3d stored_normal(const StoredNormals& normals, std::size_t keyframe, const JudgedOutput& output) {
  const float* n = normals.of_keyframes[keyframe].data() + 3 * std::size_t{output.corner};
  return to_double(Vec3f{n[0], n[1], n[2]});
}

class SequenceSource {
 public:
  static constexpr bool kNeedsEnds = true;

  SequenceSource(const MotionStream& stream, const StoredNormals& normals, bool stored, const JudgedPart& part,
                 AuditRule rule, std::vector<Vec3d> first, std::span<const std::size_t> segments)
      : motion_(stream.motion()),
        normals_(normals),
        stored_(stored),
        part_(part),
        rule_(rule),
        first_(std::move(first)),
        segments_(segments) {}

  bool place(std::size_t segment, double t, std::span<Vec3d> positions) {
    if (known_ && segment == segment_ && t == t_) return false;
    known_ = true;
    segment_ = segment;
    t_ = t;
    const Segment s = motion_.segment(segments_[segment]);
    const auto vertices = part_.vertices();
    const SegmentEnd from = SegmentEnd::from(s), to = SegmentEnd::to(s);
    parallel_each(vertices.size(), kRange,
                  [&](std::size_t i) { positions[i] = lerp(from[vertices[i]], to[vertices[i]], t); });
    return true;
  }
  void forget() { known_ = false; }
  void show() {}
  static void turn(std::span<const Vec3d> /*positions*/, std::span<Vec3d> /*normals*/) {}

  void begin(std::vector<Vec3d> start, const std::vector<Vec3d>& end) {
    start_ = std::move(start);
    end_ = end;
  }

  void shown(std::size_t first, std::span<Vec3d> normals) const {
    for (std::size_t k = 0; k < normals.size(); ++k) normals[k] = to_double(shown(part_.outputs()[first + k]));
  }

  [[nodiscard]] static Vec3d seen(std::size_t /*i*/, const Vec3d& normal) noexcept { return normal; }
  [[nodiscard]] static bool hides(const JudgedOutput& /*output*/, const Vec3d& /*normal*/) noexcept { return false; }
  void right(std::size_t first, std::span<Vec3d> normals) const {
    for (std::size_t k = 0; k < normals.size(); ++k) normals[k] = right(part_.outputs()[first + k], normals[k]);
  }

  [[nodiscard]] AuditPlace at(std::size_t segment, double t, const JudgedOutput& output) const {
    const Segment s = motion_.segment(segments_[segment]);
    const double time = t == 0 ? s.start_time : t == 1 ? s.end_time : (1 - t) * s.start_time + t * s.end_time;
    return {std::nullopt, std::nullopt, output.vertex, segment, motion_.kind == MotionKind::kTargets ? t : time};
  }

 private:
  [[nodiscard]] Vec3f shown(const JudgedOutput& output) const {
    if (stored_) return blend_stored(rule_, stored_at(keys().from, output), stored_at(keys().to, output), t_);
    // The viewer computes normals at the keyframes and keeps them in float32.
    const auto computed = [](const Vec3d& normal) { return rounded_to_float(unit(normal)); };
    return blend_stored(rule_, computed(start_[output.element]), computed(end_[output.element]), t_);
  }
  [[nodiscard]] Vec3d right(const JudgedOutput& output, const Vec3d& normal) const {
    const Vec3d now = unit(normal);
    if (!stored_) return now;
    const Vec3d from = offset_by(keys().from, start_[output.element], output, now);
    const Vec3d to = offset_by(keys().to, end_[output.element], output, now);
    const Vec3d between = lerp(from, to, t_);
    return between == Vec3d{} ? now : between;
  }
  [[nodiscard]] const Motion::SegmentKeys& keys() const { return motion_.segments[segments_[segment_]]; }

  [[nodiscard]] Vec3d stored_at(std::size_t keyframe, const JudgedOutput& output) const {
    return stored_normal(normals_, keyframe, output);
  }

  // Turns a direction by the rotation from the normal of the geometry to the author's normal at a keyframe. If the
  // angle of this rotation is larger than in keyframe 0, turns the direction only by the angle in keyframe 0.
  [[nodiscard]] Vec3d offset_by(std::size_t keyframe, const Vec3d& geometry, const JudgedOutput& output,
                                const Vec3d& direction) const {
    const Vec3d from = unit(geometry), to = unit(stored_at(keyframe, output));
    const Vec3d first = first_[output.element], first_stored = stored_at(0, output);
    if (from == Vec3d{} || to == Vec3d{} || first == Vec3d{} || first_stored == Vec3d{}) return direction;
    const double offset = angle_between(from, to), allowed = angle_between(first, first_stored);
    if (offset <= allowed) return turned(from, to, direction);
    // Turns the direction by at most the allowed angle, along the arc from the normal of the geometry to the stored
    // normal.
    const Vec3d side = to - dot(from, to) * from;
    const Vec3d across = length(side) > kVanished ? unit(side) : any_perpendicular(from);
    return turned(from, portable::cos(allowed) * from + portable::sin(allowed) * across, direction);
  }

  const Motion& motion_;
  const StoredNormals& normals_;
  bool stored_;
  const JudgedPart& part_;
  AuditRule rule_;
  std::vector<Vec3d> first_;  // normals of the geometry in keyframe 0
  std::span<const std::size_t> segments_;
  bool known_ = false;
  std::size_t segment_ = 0;
  double t_ = 0;
  std::vector<Vec3d> start_, end_;
};

std::uint32_t checksum_of_options(const AuditOptions& options, AuditRule rule, bool stored) {
  NumberChecksum sum;
  for (const std::uint64_t number :
       {static_cast<std::uint64_t>(rule), std::uint64_t{options.samples.value_or(kAuditSamples)},
        std::uint64_t{options.weighting.has_value()},
        static_cast<std::uint64_t>(options.weighting.value_or(Weighting::kArea)), std::uint64_t{options.weld},
        std::uint64_t{stored}})
    sum.add(number);
  return sum.value();
}

std::uint32_t checksum_of_normals(const StoredNormals& normals) {
  NumberChecksum sum;
  for (const std::vector<float>& of_keyframe : normals.of_keyframes) sum.add(std::span<const float>(of_keyframe));
  return sum.value();
}

std::uint32_t checksum_of_flags(const std::vector<bool>& flags) {
  NumberChecksum sum;
  sum.add(std::string(flags.begin(), flags.end()));
  return sum.value();
}

Status check_normals(const Motion& motion, const StoredNormals& normals) {
  const std::size_t count = normals.of_keyframes.size(), corners = motion.topology.corner_count();
  if (count > 1 && count != motion.keyframes.size())
    return invalid_input("", "the normals belong to " + counted(count, "keyframe", "keyframes") +
                                 ", but the motion has " + grouped(motion.keyframes.size()) +
                                 "; give normals for one keyframe or for all");
  for (std::size_t k = 0; k < count; ++k) {
    const std::vector<float>& values = normals.of_keyframes[k];
    const std::string place = "keyframe " + std::to_string(k);
    if (values.size() != 3 * corners)
      return invalid_input(
          place, "the keyframe must have one normal for each of its " + counted(corners, "corner", "corners"));
    if (!std::all_of(values.begin(), values.end(), [](float v) { return std::isfinite(v); }))
      return invalid_input(place, "a normal is NaN or infinite; export the file again");
  }
  return Success{};
}

// Lists each vertex once for each of its normals. Corners of one element with the same stored normals share one output.
std::vector<JudgedOutput> find_outputs(const Motion& motion, const NormalGroups& groups, const StoredNormals& normals,
                                       const std::vector<bool>& moves, AuditRule rule, bool stored) {
  const auto corners = motion.topology.corners();
  const auto same = [&](std::uint32_t a, std::uint32_t b) {
    if (corners[a] != corners[b]) return false;
    if (rule == AuditRule::kFlat) return a == b;
    if (!stored) return true;
    return std::all_of(normals.of_keyframes.begin(), normals.of_keyframes.end(), [&](const std::vector<float>& values) {
      const float* first = values.data() + 3 * std::size_t{a};
      return std::equal(first, first + 3, values.data() + 3 * std::size_t{b});
    });
  };
  std::vector<JudgedOutput> outputs;
  for (std::uint32_t e = 0; e < groups.size(); ++e) {
    const std::size_t first = outputs.size();
    const auto of_element = groups.corners(e);
    const auto faces = groups.faces(e);
    const bool moving = std::any_of(faces.begin(), faces.end(), [&](std::uint32_t f) {
      const auto face = motion.topology.face(f);
      return std::any_of(face.begin(), face.end(), [&](std::uint32_t v) { return moves[v]; });
    });
    for (std::size_t i = 0; i < of_element.size() && moving; ++i) {
      const std::uint32_t c = of_element[i];
      const bool known = std::any_of(outputs.begin() + static_cast<std::ptrdiff_t>(first), outputs.end(),
                                     [&](const JudgedOutput& output) { return same(output.corner, c); });
      if (!known) outputs.push_back({corners[c], e, faces[i], c});
    }
  }
  return outputs;
}

// Finds the vertices that move in some segment. If peer processes examine the other segments, examines only the
// segments of this process, and asks the peers which vertices move in theirs.
Result<std::vector<bool>> moving_vertices(const SegmentsOfRun& segments) {
  const Motion& motion = segments.stream.motion();
  std::vector<bool> moves(motion.topology.vertex_count());
  std::size_t still = moves.size();
  const IndexRange looked_at = segments.looked_at();
  for (const std::size_t s : segments.of_motion.subspan(looked_at.first, looked_at.count)) {
    if (still == 0) break;
    if (const Status status = segments.stream.hold_segment(s); !status) return status.error();
    const Segment segment = motion.segment(s);
    const SegmentEnd from = SegmentEnd::from(segment), to = SegmentEnd::to(segment);
    for (std::size_t v = 0; v < moves.size(); ++v) {
      if (moves[v] || to.way_from(from, v, v) == Vec3d{}) continue;
      moves[v] = true;
      --still;
    }
  }
  if (segments.run.peers == nullptr) return moves;
  std::vector<double> of_all(moves.begin(), moves.end());
  segments.maximize(of_all);
  std::transform(of_all.begin(), of_all.end(), moves.begin(), [](double one) { return one != 0; });
  return moves;
}

// Groups the segments by subject. All segments of a sequence are one subject, but each morph target is a subject of its
// own.
std::vector<std::vector<std::size_t>> segments_of_subjects(const Motion& motion) {
  const bool is_targets = motion.kind == MotionKind::kTargets;
  std::vector<std::vector<std::size_t>> subjects(is_targets ? motion.segments.size() : 1);
  for (std::size_t s = 0; s < motion.segments.size(); ++s) subjects[is_targets ? s : 0].push_back(s);
  return subjects;
}

std::vector<Vec3d> normals_at_first_keyframe(const JudgedPart& part, const Motion& motion) {
  const Segment still = still_segment(motion.topology, motion.keyframes[0]);
  const SegmentEnd base = SegmentEnd::from(still);
  std::vector<Vec3d> positions;
  for (const std::uint32_t v : part.vertices()) positions.push_back(base[v]);
  PartNormals normals;
  part.normals(positions, normals);
  return std::move(normals.elements);
}

}  // namespace

Result<NormalGroups> internal::audited_groups(MotionStream& stream, const StoredNormals& normals, bool weld) {
  const Topology& topology = stream.motion().topology;
  const Result<Points> welded =
      weld ? weld_coincident(stream) : Result<Points>(separate_points(topology.vertex_count()));
  if (!welded) return welded.error();
  const Points& points = welded.value();
  if (normals.of_keyframes.empty()) return NormalGroups::of_vertices(topology, points);
  const auto of_corners = VectorView<const float>::packed(normals.of_keyframes[0].data(), topology.corner_count());
  return NormalGroups::by_split_normals(topology, points, of_corners);
}

Result<Audit> audit(const Motion& motion, const StoredNormals& normals, const AuditOptions& options) {
  MotionStream stream(motion);
  return audit(stream, normals, options);
}

Result<Audit> audit(MotionStream& stream, const StoredNormals& normals, const AuditOptions& options) {
  AuditRun run;
  run.progress = options.progress;
  return audit(stream, normals, options, run);
}

Result<Audit> internal::audit(MotionStream& stream, const StoredNormals& normals, const AuditOptions& options,
                              AuditRun& run) {
  return watched_audit(stream, normals, options, run, {});
}

Result<Audit> internal::watched_audit(MotionStream& stream, const StoredNormals& normals, const AuditOptions& options,
                                      AuditRun& run, const AuditWatch& watch) {
  const Motion& motion = stream.motion();
  if (const Status status = check_samples(options); !status) return status.error();
  Audit result;
  result.weighting = options.weighting.value_or(Weighting::kArea);
  result.rule = options.rule.value_or(AuditRule::kNlerp);
  if (result.rule == AuditRule::kGltf)
    return Error{ErrorCode::kUsage, "",
                 "the rule gltf is only for glTF files, and this input is not one; choose another --rule"};
  if (!options.viewers.empty())
    return Error{ErrorCode::kUsage, "",
                 "viewers can only be chosen for glTF files, and this input is not one; leave --for out"};
  if (const Status status = check_normals(motion, normals); !status) return status.error();
  result.span = {motion.keyframes.front().time, motion.keyframes.back().time};
  if (run.is_divided() && (motion.kind == MotionKind::kTargets || options.keep_errors))
    return Error{ErrorCode::kUsage, "",
                 "a run with --shard or --resume needs a sequence of keyframes, and cannot keep the error of every "
                 "sample; leave both options out"};
  result.stored = normals.of_keyframes.size() == motion.keyframes.size();
  KeyframeChecksums seen(stream);
  if (run.shard) {
    run.checksums["the options"] = checksum_of_options(options, result.rule, result.stored);
    run.checksums["the stored normals"] = checksum_of_normals(normals);
    if (const Status status = seen.begin(); !status) return status.error();
  }
  Result<NormalGroups> groups = audited_groups(stream, normals, options.weld);
  if (!groups) return groups.error();
  const auto outputs_of = [&](const std::vector<bool>& moves) {
    return find_outputs(motion, groups.value(), normals, moves, result.rule, result.stored);
  };

  const Topology& topology = motion.topology;
  if (const Status status = stream.hold(0, 0); !status) return status.error();
  // If some keyframe has no stored normals, the viewer computes all normals itself and weights faces by area, even if
  // the file of keyframe 0 stores normals with another weighting.
  const std::optional<Weighting> asked =
      result.stored || options.weighting ? options.weighting : std::optional(Weighting::kArea);
  Weighting weighting = asked.value_or(Weighting::kArea);
  if (!normals.of_keyframes.empty()) {
    const std::vector<JudgedOutput> outputs = outputs_of(std::vector<bool>(topology.vertex_count(), true));
    const auto read = [&](std::size_t k) -> std::optional<ShadedKeyframe> {
      if (k >= normals.of_keyframes.size() || !stream.hold(k, k)) return std::nullopt;
      std::vector<StoredNormal> stored;
      for (const JudgedOutput& output : outputs) {
        const Vec3d normal = stored_normal(normals, k, output);
        if (normal != Vec3d{}) stored.push_back({output.vertex, output.element, normal});
      }
      const std::vector<float>& positions = motion.keyframes[k].positions;
      return ShadedKeyframe{VectorView<const float>::packed(positions.data(), positions.size() / 3), std::move(stored)};
    };
    const AuthoredWeighting authored = find_authored_weighting(topology, groups.value(), motion.keyframes.size(), read);
    if (const Status status = stream.hold(0, 0); !status) return status.error();
    result.offsets.push_back(authored_offset(authored, asked));
    weighting = result.offsets.back().weighting;
  }

  if (options.keep_errors) {
    result.errors.push_back({"", ElementKind::kVertices, topology, motion.keyframes[0].positions});
    const std::size_t rows = motion.segments.size() * options.samples.value_or(kAuditSamples);
    if (const Status status = reserve_rows(result.errors[0], rows, run.expansion); !status) return status.error();
  }
  SegmentErrors of_known;
  const Status begun = run.begin(
      motion.segments.size(), 1, "audit", [](const SegmentErrors&) { return true; },
      [&](const SegmentErrors& known) {
        of_known.error.add(known.error);
        of_known.at_keys.add(known.at_keys);
      });
  if (!begun) return begun.error();
  const bool is_targets = motion.kind == MotionKind::kTargets;
  const bool has_residuals = std::any_of(motion.keyframes.begin(), motion.keyframes.end(),
                                         [](const Motion::Keyframe& keyframe) { return !keyframe.residuals.empty(); });
  for (const std::vector<std::size_t>& segments : segments_of_subjects(motion)) {
    AuditSubject subject;
    subject.kind = is_targets ? AuditSubject::Kind::kTarget : AuditSubject::Kind::kSequence;
    if (is_targets) {
      subject.target = segments[0];
      subject.name = motion.keyframes[motion.segments[segments[0]].to].name;
    }
    subject.weighting = weighting;
    subject.segments = segments.size();
    subject.samples = options.samples.value_or(kAuditSamples);
    add_segment(of_known, subject);
    const SegmentsOfRun own{stream, segments, run};
    const Result<std::vector<bool>> moves = moving_vertices(own);
    if (!moves) return moves.error();
    if (run.shard) {
      NumberChecksum sharing;
      sharing.add(groups.value().element_of_output());
      run.checksums["the hard edges"] = sharing.value();
      run.checksums["the vertices that move"] = checksum_of_flags(moves.value());
    }
    const JudgedPart part(topology, groups.value(), weighting, outputs_of(moves.value()));
    if (!is_targets) groups = NormalGroups();  // frees the groups, since the part has its own copy
    if (part.outputs().empty()) {
      ++result.still;
      run.tell(own.rest().count);
      continue;
    }
    if (const Status status = stream.hold(0, 0); !status) return status.error();
    SequenceSource source(stream, normals, result.stored, part, result.rule, normals_at_first_keyframe(part, motion),
                          segments);
    const KeptErrors kept{options.keep_errors ? result.errors.data() : nullptr, result.subjects.size(),
                          static_cast<bool>(watch)};
    const auto tell = [&](const MeasuredSample& sample) {
      if (!watch) return;
      const double at = source.at(sample.segment, sample.t, part.outputs().front()).at;
      watch({kept.subject,
             subject,
             segments[sample.segment],
             sample.t,
             at,
             part,
             sample.largest,
             sample.error,
             sample.each,
             {},
             {}});
    };
    const bool in_blocks = !kept.any() && !result.stored && !has_residuals &&
                           can_measure_blocks(part, result.rule, weighting, subject.samples);
    const auto at = [&](std::size_t segment, double t, const JudgedOutput& output) {
      return source.at(segment, t, output);
    };
    const Status measured = in_blocks ? measure_blocks(own, part, result.rule, at, subject)
                                      : measure(source, own, part, result.rule, subject, kept, tell);
    if (!measured) return measured.error();
    if (const std::optional<AuditFinding> fault = find_wrong_normals(subject)) result.findings.push_back(*fault);
    result.subjects.push_back(std::move(subject));
  }
  if (result.subjects.empty()) result.errors.clear();
  if (run.shard) {
    // If this shard has peers, it reads only its own keyframes, and the checksums cover only these keyframes. Without
    // peers, it reads all keyframes, to find facts about the whole motion.
    const Shard read = run.peers != nullptr ? *run.shard : Shard{};
    const Status status = seen.finish(keyframes_of_shard(motion, read), run.checksums);
    if (!status) return status.error();
  }
  finish(result);
  return result;
}

}  // namespace chronormal
