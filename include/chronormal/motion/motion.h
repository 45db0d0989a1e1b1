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
#include <cassert>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"

namespace chronormal {

// The faces of a mesh as lists of vertices: the part of a mesh that does not move.
//
// Faces are polygons of three or more corners, counter-clockwise seen from the side to which the normal points. Two
// triangles and a quad are kept as
//
//     corners   0 1 2   2 1 3   4 5 6 7        vertex of each corner, face after face
//     offsets   0       3       6         10   where each face begins, and the end
//
// A mesh of triangles alone keeps no offsets.

class Topology {
 public:
  Topology() = default;

  /// Builds polygons from corners and offsets (see above) over vertices 0 .. vertex_count - 1.
  /// Errors: a face of fewer than 3 corners, a corner that names no vertex, offsets that do not ascend from 0 to the
  /// number of corners; the place is "face F" or "face F, corner C". O(corners).
  [[nodiscard]] static Result<Topology> polygons(std::size_t vertex_count, std::vector<std::uint32_t> offsets,
                                                 std::vector<std::uint32_t> corners);

  /// Builds triangles from three corners each. Errors and cost as for polygons().
  [[nodiscard]] static Result<Topology> triangles(std::size_t vertex_count, std::vector<std::uint32_t> corners);
  /// Does the same for an index buffer of 16 bits, which is copied.
  [[nodiscard]] static Result<Topology> triangles(std::size_t vertex_count, std::span<const std::uint16_t> corners);

  [[nodiscard]] std::size_t vertex_count() const noexcept { return vertex_count_; }
  [[nodiscard]] std::size_t corner_count() const noexcept { return corners_.size(); }
  [[nodiscard]] std::size_t face_count() const noexcept {
    return offsets_.empty() ? corners_.size() / 3 : offsets_.size() - 1;
  }
  /// Returns true if every face is a triangle.
  [[nodiscard]] bool all_triangles() const noexcept { return offsets_.empty(); }

  /// Returns the vertices of one face, in order.
  [[nodiscard]] std::span<const std::uint32_t> face(std::size_t f) const noexcept {
    assert(f < face_count());
    if (offsets_.empty()) return {corners_.data() + 3 * f, 3};
    return {corners_.data() + offsets_[f], corners_.data() + offsets_[f + 1]};
  }

  [[nodiscard]] std::span<const std::uint32_t> corners() const noexcept { return corners_; }

  friend bool operator==(const Topology&, const Topology&) = default;

 private:
  std::size_t vertex_count_ = 0;
  std::vector<std::uint32_t> offsets_;  // empty where all faces are triangles
  std::vector<std::uint32_t> corners_;
};

/// One straight piece of a motion, as a view, from which control normals and schemes are prepared. The Motion that it
/// comes from must outlive it.
struct Segment {
  const Topology* topology = nullptr;
  VectorView<const float> from;  ///< positions at t = 0, one per vertex
  VectorView<const float> to;    ///< positions at t = 1
  double start_time = 0;         ///< seconds, at t = 0; of a target, its weight
  double end_time = 1;           ///< the same at t = 1
  std::size_t index = 0;         ///< the number of the segment in its motion
  /// Added to `from` and `to`, these give positions before they were rounded to float32 (Motion::Keyframe). Empty where
  /// nothing was rounded.
  VectorView<const double> from_residuals = {}, to_residuals = {};
};

/// Tells what the segments of a motion are.
enum class MotionKind {
  kSequence,   ///< keyframes that follow each other: one segment between every two neighbours
  kTargets,    ///< morph targets over a base: segment k leads from keyframe 0, the base, to keyframe k + 1
  kAnimation,  ///< weights of targets over time: as a sequence, but without a segment where weights jump
};

/// Returns "sequence", "targets" or "animation".
[[nodiscard]] std::string_view motion_kind_name(MotionKind kind) noexcept;

struct Motion {
  struct Keyframe {
    std::vector<float> positions;        ///< (V, 3)
    double time = 0;                     ///< seconds; of targets, the weight
    std::string name;                    ///< for messages: the file that it came from, or empty
    std::vector<float> velocities = {};  ///< (V, 3) per second, of a sequence whose file has them; or empty
    /// (V, 3) per second, for an end of a part of a sequence: the velocities that curves through the whole sequence
    /// have there (PathKind::kCatmullRom in motion/paths.h). Empty: velocities follow from the keyframes of the motion.
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
  /// (V), the number of the separate object that each vertex belongs to: vertices of two objects are never one point,
  /// wherever they are. Empty: all belong to one object.
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

/// Checks data from outside, once, for everything that computes. The rest of the library takes for granted: at least
/// one face and one segment; every keyframe with 3 x vertex_count finite coordinates, and as many velocities or none;
/// residuals of rounding to float32, as many or none; a body for each vertex or none; segments between keyframes that
/// exist; finite times that ascend along every segment; and segments as the kind of the motion has them. (A Topology
/// checks its own indices.)
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

/// The segment of a motion and the local t in it that a time stands for.
struct Instant {
  std::size_t segment = 0;
  LocalTime t;
};

/// Finds the segment and the local t of a time in seconds. A keyframe between two segments is the beginning of the
/// later one, and the end of the motion is the end of the last one. The motion must be valid, or stand still.
/// O(segments). Errors: kUsage for a time at which there is no motion, with the range; for targets, and for a mesh that
/// stands still.
[[nodiscard]] Result<Instant> find_instant(const Motion& motion, double time);

// A motion that is larger than memory: its keyframes are read when they are needed, and released after that.
//
//     MotionStream stream = ...;                      // from Input::stream() in io/input.h, or from a whole motion
//     for (std::size_t s = 0; s < stream.motion().segments.size(); ++s) {
//       if (const Status status = stream.hold_segment(s); !status) return status.error();
//       const Segment segment = stream.motion().segment(s);      // good until the next hold
//     }
//
// motion() is the whole motion except for the positions of keyframes that are not held: faces, segments, times and
// names are always there. So a function that takes a Motion takes the motion of a stream too, once the stream holds
// what the function looks at. Where keyframes are held one after the other, a thread of its own reads the next one
// ahead.
//
// Memory     the keyframes that are held, and one that is read ahead. Keyframes that take no more than `kept` bytes
//            together are read once and stay. A motion that was whole before takes nothing more.
// Threads    one stream belongs to one thread at a time; what is held may be read by many.

class MotionStream {
 public:
  /// Writes the 3 x vertex_count coordinates of a keyframe of the motion, all of them finite. It is called from one
  /// thread at a time, not always from the same.
  using Reader = std::function<Status(const Motion& motion, std::size_t keyframe, std::span<float> positions)>;

  /// Receives the positions of a keyframe, as the reader has written them.
  using Watcher = std::function<Status(std::size_t keyframe, std::span<const float> positions)>;

  static constexpr std::size_t kUsuallyKept = std::size_t{64} << 20;

  /// Wraps a motion that is in memory and stays there; it must outlive the stream, and it may stand still.
  explicit MotionStream(const Motion& whole);

  /// Wraps a motion whose keyframes have no positions yet; the first one may have some. Everything else of the outline
  /// must be valid (motion/motion.h).
  MotionStream(Motion outline, Reader read, std::size_t kept = kUsuallyKept);

  MotionStream(MotionStream&& other) noexcept;
  MotionStream& operator=(MotionStream&& other) noexcept;
  ~MotionStream();

  [[nodiscard]] const Motion& motion() const noexcept;

  /// Makes sure that the positions of keyframes first to last are there, until the next hold. Errors: those of the
  /// reader.
  /// first <= last, and last must be a keyframe
  [[nodiscard]] Status hold(std::size_t first, std::size_t last);
  /// Holds both ends of segments first to last.
  [[nodiscard]] Status hold_segments(std::size_t first, std::size_t last);
  [[nodiscard]] Status hold_segment(std::size_t segment) { return hold_segments(segment, segment); }
  /// Holds all keyframes: the motion is in memory then.
  [[nodiscard]] Status hold_all();

  /// Tells the watcher at once of every keyframe that is there, and from now on of each one that is read, before
  /// anybody else sees it and by the thread that reads it. There is one watcher at a time; an empty one ends this.
  /// Errors: those of the watcher, here and for each hold.
  [[nodiscard]] Status watch(Watcher watcher);

  /// Returns true if keyframes stay in memory once they were held: to hold all costs no more memory than to read them.
  [[nodiscard]] bool keeps_all() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Blend shapes: a base and targets that move some of its vertices, with any weights at once.
//
//     p(w) = base + sum_i w_i d_i                                            (section 14 of docs/theory.md)
//
// A target lists the vertices that it moves, ascending, and how: target 0 lifts vertex 2, target 1 shifts 0 and 2:
//
//     targets[0]   vertices 2      deltas  0 1 0
//     targets[1]   vertices 0 2    deltas  1 0 0   1 0 0
//
// Shapes     V = vertices, K = targets; base is (V, 3), deltas (n, 3) for n moved vertices, float32.
// Units      positions and deltas: any length; weights: any finite number, often in [0, 1].

struct BlendTarget {
  std::string name;                     ///< for messages; may be empty
  std::vector<std::uint32_t> vertices;  ///< ascending
  std::vector<float> deltas;            ///< (n, 3)

  /// Keeps the vertices of dense deltas, (V, 3), that are not (0, 0, 0).
  [[nodiscard]] static BlendTarget from_dense(std::span<const float> deltas, std::string name = {});
};

struct BlendSet {
  Topology topology;
  std::vector<float> base;  ///< (V, 3)
  std::vector<BlendTarget> targets;
};

/// Returns the blend shapes of a star of segments (targets in io/input.h): its base, and a target for each segment from
/// keyframe 0, named as the keyframe at its end. Deltas are differences of positions, rounded to float32. The motion
/// must be valid. Errors, with the place "target K": kUsage for a segment that does not begin at keyframe 0,
/// kInvalidInput for a delta beyond the range of float32.
[[nodiscard]] Result<BlendSet> blend_set_of(const Motion& star);

/// Checks what the rest of the library relies on: as many positions as the topology has vertices, all finite, and in
/// each target vertices that ascend and exist, with one finite delta each.
/// Errors: kInvalidInput with the place "base, vertex V" or "target K, entry N".
[[nodiscard]] Status validate(const BlendSet& set);

/// Checks one target that is to become number k of a set over this topology.
[[nodiscard]] Status validate(const BlendTarget& target, const Topology& topology, std::size_t k);

/// Writes the positions at some weights, (V, 3) in double, without a rounding to float32 in between.
/// weights must have one for each target, result 3 V; targets of weight 0 cost nothing
void blend_positions(const BlendSet& set, std::span<const double> weights, std::span<double> result) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_MOTION_MOTION_H_
