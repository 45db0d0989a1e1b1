/// A mesh that deforms: keyframes of vertex positions over one topology, and the segments between them.
///
/// Inside a segment every vertex moves on a straight line, p(t) = (1 - t) p0 + t p1, with local t in [0, 1]. A
/// sequence of keyframes 0, 1, 2 has the segments 0 -> 1 and 1 -> 2; blend shapes with base 0 and targets 1, 2 have
/// 0 -> 1 and 0 -> 2. Both are a Motion, whose kind says which it is: what computes normals need not ask, but what
/// speaks to people says times of the one and weights of the other.
///
/// find_instant() says which segment, and which t in it, belong to a time.
///
/// Positions are float32. Those of a keyframe that was computed (the targets of a glTF file, or its animation of their
/// weights) had to be rounded to that, by far more than the length of a short edge beside large coordinates allows for.
/// Such a keyframe keeps what the rounding left out, and all normals are those of the positions before it.
///
/// Shapes     V = vertices; a keyframe has V positions, packed as (V, 3) float32.
/// Units      positions: any length; times: seconds, double; of targets, weights: 0 for the base, 1 for a target.
#ifndef CHRONORMAL_MOTION_MOTION_H_
#define CHRONORMAL_MOTION_MOTION_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/topology.h"

namespace chronormal {

/// One straight piece of a motion, as a view: what control normals and schemes are prepared from.
/// The Motion that it comes from must outlive it.
struct Segment {
  const Topology* topology = nullptr;
  VectorView<const float> from;  ///< positions at t = 0, one per vertex
  VectorView<const float> to;    ///< positions at t = 1
  double start_time = 0;         ///< seconds, at t = 0; of a target, its weight
  double end_time = 1;           ///< the same at t = 1
  std::size_t index = 0;         ///< which segment of its motion it is
  /// Added to `from` and `to`, these give positions before they were rounded to float32 (Motion::Keyframe). Empty where
  /// nothing was rounded.
  VectorView<const double> from_residuals = {}, to_residuals = {};
};

/// What the segments of a motion are.
enum class MotionKind {
  kSequence,   ///< keyframes that follow each other: one segment between every two neighbours
  kTargets,    ///< morph targets over a base: segment k leads from keyframe 0, the base, to keyframe k + 1
  kAnimation,  ///< weights of targets over time: as a sequence, but without a segment where weights jump
};

/// "sequence", "targets" or "animation".
[[nodiscard]] std::string_view motion_kind_name(MotionKind kind) noexcept;

struct Motion {
  struct Keyframe {
    std::vector<float> positions;        ///< (V, 3)
    double time = 0;                     ///< seconds; of targets, the weight
    std::string name;                    ///< for messages: the file that it came from, or empty
    std::vector<float> velocities = {};  ///< (V, 3) per second, of a sequence whose file has them; or empty
    /// (V, 3) per second, of an end of a part of a sequence: the velocities that curves through the whole sequence have
    /// there (PathKind::kCatmullRom in motion/paths.h). Empty: they follow from the keyframes of the motion.
    std::vector<float> end_velocities = {};
    /// (V, 3), or empty where nothing was rounded: a vertex is at its position and its residual, added up. Files hold
    /// positions alone.
    std::vector<double> residuals = {};

    /// Sets the positions to these coordinates rounded to float32, and the residuals to the rest of them.
    /// low must have the digits of each coordinate that high has not, below half a unit in its last place
    void set_positions(std::span<const double> high, std::span<const double> low);
  };
  struct SegmentKeys {
    std::size_t from = 0;  ///< index of the keyframe at t = 0
    std::size_t to = 0;    ///< index of the keyframe at t = 1
  };

  Topology topology;
  std::vector<Keyframe> keyframes;
  std::vector<SegmentKeys> segments;
  /// (V), which of several separate objects each vertex belongs to: those of two are never one point, wherever they
  /// are. Empty: all are one.
  std::vector<std::uint32_t> body_of_vertex = {};
  MotionKind kind = MotionKind::kSequence;
  /// The point that positions count from, the same at all keyframes: (0, 0, 0) but where a file has coordinates far
  /// from the origin in more digits than float32 keeps. Writers of positions add it. Normals do not depend on it.
  std::array<double, 3> origin = {};

  /// Returns a view of one segment. Precondition: the motion is valid (validate()) and i < segments.size().
  [[nodiscard]] Segment segment(std::size_t i) const noexcept;

  /// Sets the kind and makes the segments that a motion of this kind has, from its keyframes. (In an animation, two
  /// neighbours at one time are a jump, and no segment joins them.)
  void connect(MotionKind as);
  void connect_as_sequence() { connect(MotionKind::kSequence); }
  void connect_as_targets() { connect(MotionKind::kTargets); }
};

/// Returns a keyframe as a segment that does not move, from time 0 to 1. Both must outlive it.
[[nodiscard]] Segment still_segment(const Topology& topology, const Motion::Keyframe& keyframe) noexcept;

/// The one check between data from outside and everything that computes. Checks what the rest of the library takes for
/// granted: at least one face and one segment; every keyframe with 3 x vertex_count finite coordinates, and as many
/// velocities or none; residuals of rounding to float32, as many or none; a body for each vertex or none; segments
/// between keyframes that exist; finite times that ascend along every segment; and segments as the kind of the motion
/// has them. (A Topology checks its own indices.)
/// Errors: the place names the keyframe (and its file, where known), and the vertex or segment. O(positions).
[[nodiscard]] Status validate(const Motion& motion);

/// A local t in [0, 1], as exact as a time was: with keys at 0 and 3, time 1 is t = 1/3, which no double is. Where n(t)
/// is so small that the rounding of t would turn it, integers take the quotient itself. A double is one as it is.
struct LocalTime {
  double t = 0;     ///< rounded once
  double rest = 1;  ///< 1 - t, rounded once as well: near t = 1 it has digits that t has not
  /// t is (time - start) / (end - start) without any rounding.
  double start = 0, time = 0, end = 1;

  LocalTime() = default;
  LocalTime(double local) noexcept : t(local), rest(1 - local), time(local) {}  // NOLINT(google-explicit-constructor)
  operator double() const noexcept { return t; }                                // NOLINT(google-explicit-constructor)

  /// Returns where a time lies between two others. Precondition: start < end, and both are finite. Outside, t is
  /// that of the nearer end.
  [[nodiscard]] static LocalTime between(double start, double time, double end) noexcept;

  [[nodiscard]] bool is_double() const noexcept { return start == 0 && end == 1; }
};

/// Where a time lies in a motion.
struct Instant {
  std::size_t segment = 0;
  LocalTime t;
};

/// Finds the segment and the local t of a time in seconds. A keyframe between two segments is the beginning of the
/// later one, and the end of the motion is the end of the last one. The motion must be valid, or stand still.
/// O(segments). Errors: kUsage for a time at which there is no motion, with the range; for targets, and for a mesh that
/// stands still.
[[nodiscard]] Result<Instant> find_instant(const Motion& motion, double time);

}  // namespace chronormal

#endif  // CHRONORMAL_MOTION_MOTION_H_
