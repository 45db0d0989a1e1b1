/// A mesh that deforms: keyframes of vertex positions over one topology, and the segments between them.
///
/// Inside a segment every vertex moves on a straight line, p(t) = (1 - t) p0 + t p1, with local t in [0, 1]. A sequence
/// of keyframes 0, 1, 2 has the segments from 0 to 1 and from 1 to 2; blend shapes with base 0 and targets 1, 2 have
/// segments from 0 to 1 and from 0 to 2. Both are a Motion, whose kind tells them apart: code that computes normals
/// need not know the kind, but messages for people mention times for a sequence and weights for targets.
///
/// find_instant() converts a time into a segment and its local t.
///
/// Positions are float32. The positions of a keyframe that was computed (targets of a glTF file, or an animation of
/// their weights) had to be rounded to float32, and the rounding error may be large compared with short edges at large
/// coordinates. Such a keyframe also keeps the remainders of the rounding, and all normals are those of the positions
/// before rounding.
///
/// Shapes     V = vertices; a keyframe has V positions, packed as (V, 3) float32.
/// Units      positions: any length; times: seconds, double; for targets, weights: 0 for the base, 1 for a target.
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
//     offsets   0       3       6         10   first corner of each face, and the end
//
// A mesh with only triangles has no offsets.

class Topology {
 public:
  Topology() = default;

  /// Builds polygons over the vertices 0 ... vertex_count - 1. `corners` has the vertex of each corner, face after
  /// face; `offsets` has the first corner of each face, and then the number of corners. Errors: a face of fewer than 3
  /// corners, a corner whose vertex does not exist, or offsets that do not ascend from 0 to the number of corners. The
  /// place is "face F" or "face F, corner C". O(corners).
  [[nodiscard]] static Result<Topology> polygons(std::size_t vertex_count, std::vector<std::uint32_t> offsets,
                                                 std::vector<std::uint32_t> corners);

  /// Builds triangles from three corners each, in O(corners). Errors: those of polygons().
  [[nodiscard]] static Result<Topology> triangles(std::size_t vertex_count, std::vector<std::uint32_t> corners);
  /// Builds triangles from an index buffer of 16 bits, which is copied.
  [[nodiscard]] static Result<Topology> triangles(std::size_t vertex_count, std::span<const std::uint16_t> corners);

  [[nodiscard]] std::size_t vertex_count() const noexcept { return vertex_count_; }
  [[nodiscard]] std::size_t corner_count() const noexcept { return corners_.size(); }
  [[nodiscard]] std::size_t face_count() const noexcept {
    return offsets_.empty() ? corners_.size() / 3 : offsets_.size() - 1;
  }
  /// Returns true if every face is a triangle.
  [[nodiscard]] bool all_triangles() const noexcept { return offsets_.empty(); }

  /// Returns the vertices of one face, in the order of its corners.
  [[nodiscard]] std::span<const std::uint32_t> face(std::size_t f) const noexcept {
    assert(f < face_count());
    if (offsets_.empty()) return {corners_.data() + 3 * f, 3};
    return {corners_.data() + offsets_[f], corners_.data() + offsets_[f + 1]};
  }

  [[nodiscard]] std::span<const std::uint32_t> corners() const noexcept { return corners_; }

  friend bool operator==(const Topology&, const Topology&) = default;

 private:
  std::size_t vertex_count_ = 0;
  // The index of the first corner of each face, and then the number of corners; empty if all faces are triangles.
  std::vector<std::uint32_t> offsets_;
  std::vector<std::uint32_t> corners_;
};

/// A view of one straight piece of a motion, from which control normals and schemes are prepared. The Motion must
/// outlive the segment.
struct Segment {
  const Topology* topology = nullptr;
  VectorView<const float> from;  ///< positions at t = 0, one for each vertex
  VectorView<const float> to;    ///< positions at t = 1, one for each vertex
  double start_time = 0;         ///< seconds at t = 0; for targets, the weight at t = 0
  double end_time = 1;           ///< seconds at t = 1; for targets, the weight at t = 1
  std::size_t index = 0;         ///< the number of the segment in its motion
  /// The remainders of rounding `from` and `to` to float32 (Motion::Keyframe). The exact position of a vertex is the
  /// sum of its position and its remainder. The views are empty if nothing was rounded.
  VectorView<const double> from_residuals = {}, to_residuals = {};
};

/// The kind of a motion, which determines its segments.
enum class MotionKind {
  kSequence,   ///< keyframes in the order of time, with one segment between any two neighbours
  kTargets,    ///< morph targets over a base; segment k leads from keyframe 0, the base, to keyframe k + 1
  kAnimation,  ///< weights of targets over time; like a sequence, but without a segment where weights jump
};

/// Returns the name of a kind of motion: "sequence", "targets" or "animation".
[[nodiscard]] std::string_view motion_kind_name(MotionKind kind) noexcept;

struct Motion {
  struct Keyframe {
    std::vector<float> positions;  ///< the positions of the vertices, (V, 3), in units of length of the file
    double time = 0;               ///< the time in seconds; for targets, the weight
    std::string name;              ///< the file of the keyframe, for messages; or empty
    /// The velocities that the file of a sequence stores, (V, 3), in units of length per second; or empty.
    std::vector<float> velocities = {};
    /// The velocities of the vertices, (V, 3) in units of length per second, at the first or last keyframe of a part of
    /// a sequence. They are the velocities of curves through the whole sequence (PathKind::kCatmullRom in
    /// motion/paths.h). If the list is empty, velocities are computed from the keyframes of the motion.
    std::vector<float> end_velocities = {};
    /// The remainders of rounding positions to float32, (V, 3), or empty if nothing was rounded. The exact place of a
    /// vertex is the sum of its position and its residual. Files store only positions.
    std::vector<double> residuals = {};

    /// Sets each position to the coordinate high + low rounded to float32, and its residual to the remainder.
    /// Precondition: |low| is at most half a unit in the last place of `high`.
    void set_positions(std::span<const double> high, std::span<const double> low);
  };
  struct SegmentKeys {
    std::size_t from = 0;  ///< index of the keyframe at t = 0
    std::size_t to = 0;    ///< index of the keyframe at t = 1
  };

  Topology topology;
  std::vector<Keyframe> keyframes;
  std::vector<SegmentKeys> segments;
  /// The number of the object to which each vertex belongs, (V), in a mesh of separate objects. Vertices of different
  /// objects are never one point, even at the same place. If the list is empty, all vertices belong to one object.
  std::vector<std::uint32_t> body_of_vertex = {};
  MotionKind kind = MotionKind::kSequence;
  /// The vector that was subtracted from all positions of the file. The vector is nonzero only if a file has
  /// coordinates far from (0, 0, 0) with more digits than float32 keeps. Code that writes positions to files adds the
  /// vector again. Normals do not depend on it.
  std::array<double, 3> origin = {};

  /// Returns a view of segment i. Preconditions: the motion is valid (validate()), and i < segments.size().
  [[nodiscard]] Segment segment(std::size_t i) const noexcept;

  /// Sets the kind of the motion, and makes the segments that this kind needs from the keyframes. (In an animation, two
  /// neighbouring keyframes at the same time are a jump, and have no segment.)
  void connect(MotionKind as);
  void connect_as_sequence() { connect(MotionKind::kSequence); }
  void connect_as_targets() { connect(MotionKind::kTargets); }
};

/// Returns a keyframe as a segment without motion, from time 0 to 1. The topology and the keyframe must outlive the
/// segment.
[[nodiscard]] Segment still_segment(const Topology& topology, const Motion::Keyframe& keyframe) noexcept;

/// Checks data from outside once, so that computations need not check them. The rest of the library relies on all of
/// the following. There is at least one face and one segment. Every keyframe has 3 x vertex_count finite coordinates,
/// and as many velocities or none. Every keyframe has as many residuals, which are remainders of rounding to float32,
/// or none. There is a body for each vertex, or there are no bodies. Segments join existing keyframes, and are those
/// that the kind of the motion demands. Times are finite and ascend along every segment. (A Topology checks its own
/// indices.) Errors: the place names the keyframe (and its file, where known), and the vertex or segment. O(positions).
[[nodiscard]] Status validate(const Motion& motion);

/// A local t in [0, 1] that is kept as an exact quotient of times. For example, time 1 between keys at 0 and 3 is t =
/// 1/3, which no double represents. If n(t) is so small that rounding t to a double would change its direction, integer
/// arithmetic uses the exact quotient. A double converts to a LocalTime without change.
struct LocalTime {
  double t = 0;     ///< the local t, rounded to a double once
  double rest = 1;  ///< 1 - t, also rounded once; near t = 1 it has digits that t does not have
  /// The exact t is (time - start) / (end - start).
  double start = 0, time = 0, end = 1;

  LocalTime() = default;
  LocalTime(double local) noexcept : t(local), rest(1 - local), time(local) {}  // NOLINT(google-explicit-constructor)
  operator double() const noexcept { return t; }                                // NOLINT(google-explicit-constructor)

  /// Returns the local t of a time between two other times. A time before `start` or after `end` gets the t of the
  /// nearer end. Precondition: start < end, and both are finite.
  [[nodiscard]] static LocalTime between(double start, double time, double end) noexcept;

  [[nodiscard]] bool is_double() const noexcept { return start == 0 && end == 1; }
};

/// A time, given as a segment of a motion and the local t in this segment.
struct Instant {
  std::size_t segment = 0;
  LocalTime t;
};

/// Returns the time of a keyframe if that time was stored in float32 and `time` is its shortest decimal; otherwise
/// returns `time`. A file that stores 0.4 in float32 has a keyframe at 0.4000000059..., which a user calls 0.4.
/// O(keyframes).
[[nodiscard]] double time_of_keyframe_at(const Motion& motion, double time) noexcept;

/// Finds the segment and the local t of a time in seconds, as time_of_keyframe_at() returns it. A keyframe between two
/// segments is the beginning of the later one, and the end of the motion is the end of the last one. The motion must be
/// valid, or a mesh at rest. O(segments). Errors: kUsage for a time outside of the motion, with the valid range; for targets; and for a mesh at
/// rest.
[[nodiscard]] Result<Instant> find_instant(const Motion& motion, double time);

// A motion that may be larger than memory: its keyframes are read on demand, and released afterwards.
//
//     MotionStream stream = ...;                      // from Input::stream() in io/input.h, or from a whole motion
//     for (std::size_t s = 0; s < stream.motion().segments.size(); ++s) {
//       if (const Status status = stream.hold_segment(s); !status) return status.error();
//       const Segment segment = stream.motion().segment(s);      // valid until the next hold
//     }
//
// motion() is the whole motion except for the positions of keyframes that are not held: faces, segments, times and
// names are always available. So a function that takes a Motion can take the motion of a stream, if the stream holds
// the keyframes that the function reads. If keyframes are held in order, a separate thread reads the next one in
// advance.
//
// Memory     the keyframes that are held, and one that is read in advance. If all keyframes together take at most
//            `kept` bytes, each is read once and stays. A motion in memory takes no additional memory.
// Threads    a stream belongs to one thread at a time; many threads may read the keyframes that are held.

class MotionStream {
 public:
  /// A function that writes the 3 x vertex_count coordinates of a keyframe, all finite. It is called from one thread at
  /// a time, but not always from the same thread.
  using Reader = std::function<Status(const Motion& motion, std::size_t keyframe, std::span<float> positions)>;

  /// A function that is called with the positions of a keyframe, exactly as the reader has written them.
  using Watcher = std::function<Status(std::size_t keyframe, std::span<const float> positions)>;

  static constexpr std::size_t kUsuallyKept = std::size_t{64} << 20;

  /// Wraps a motion in memory, which must outlive the stream. The motion may be a mesh at rest.
  explicit MotionStream(const Motion& whole);

  /// Wraps a motion whose keyframes are read by `read` when they are needed. `outline` is the motion without positions,
  /// except perhaps those of the first keyframe; everything else in it must be valid (see validate()). If all keyframes
  /// together take at most `kept` bytes, they stay in memory once they were read.
  MotionStream(Motion outline, Reader read, std::size_t kept = kUsuallyKept);

  MotionStream(MotionStream&& other) noexcept;
  MotionStream& operator=(MotionStream&& other) noexcept;
  ~MotionStream();

  [[nodiscard]] const Motion& motion() const noexcept;

  /// Makes the positions of the keyframes `first` to `last` available, and reads them if necessary. They stay available
  /// until the next call of a hold function. Errors: those of the reader. Preconditions: first <= last, and last is a
  /// keyframe.
  [[nodiscard]] Status hold(std::size_t first, std::size_t last);
  /// Holds the keyframes at both ends of the segments `first` to `last`.
  [[nodiscard]] Status hold_segments(std::size_t first, std::size_t last);
  [[nodiscard]] Status hold_segment(std::size_t segment) { return hold_segments(segment, segment); }
  /// Holds all keyframes, so that the whole motion is in memory.
  [[nodiscard]] Status hold_all();

  /// Calls the watcher immediately for every keyframe that is in memory. Later, calls it for each keyframe that is
  /// read, in the thread that reads the keyframe and before anyone else can use the keyframe. There is one watcher at a
  /// time; an empty function removes the watcher. Errors: those of the watcher, from this call and from each hold.
  [[nodiscard]] Status watch(Watcher watcher);

  /// Returns true if keyframes stay in memory once they were read, so that holding all of them costs no additional
  /// memory.
  [[nodiscard]] bool keeps_all() const noexcept;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

// Blend shapes: a base, and targets that move some of its vertices, which can be active together with any weights.
//
//     p(w) = base + sum_i w_i d_i                                            (section 14 of docs/theory.md)
//
// A target lists the vertices that it moves, in ascending order, and their deltas. Here target 0 lifts vertex 2, and
// target 1 shifts 0 and 2:
//
//     targets[0]   vertices 2      deltas  0 1 0
//     targets[1]   vertices 0 2    deltas  1 0 0   1 0 0
//
// Shapes     V = vertices, K = targets; base is (V, 3), deltas (n, 3) for n moved vertices, float32.
// Units      positions and deltas: any length; weights: any finite number, often in [0, 1].

struct BlendTarget {
  std::string name;                     ///< the name of the target, for messages; may be empty
  std::vector<std::uint32_t> vertices;  ///< indices of the vertices that the target moves, ascending
  std::vector<float> deltas;            ///< the displacement of each of these vertices at weight 1, (n, 3)

  /// Makes a target from a delta for every vertex, (V, 3). Keeps only the vertices whose deltas are not (0, 0, 0).
  [[nodiscard]] static BlendTarget from_dense(std::span<const float> deltas, std::string name = {});
};

struct BlendSet {
  Topology topology;
  std::vector<float> base;  ///< the positions of all vertices, (V, 3)
  std::vector<BlendTarget> targets;
};

/// Returns the blend shapes of a motion of targets (io/input.h): its base, and a target for each segment from keyframe
/// 0, with the name of the keyframe at its end. Deltas are differences of positions, rounded to float32. The motion
/// must be valid. Errors, with the place "target K": kUsage for a segment that does not begin at keyframe 0,
/// kInvalidInput for a delta beyond the range of float32.
[[nodiscard]] Result<BlendSet> blend_set_of(const Motion& star);

/// Checks the properties on which the rest of the library relies. There must be as many positions as the topology has
/// vertices, and all must be finite. Each target must list existing vertices in ascending order, with one finite delta
/// for each vertex. Errors: kInvalidInput with the place "base, vertex V" or "target K, entry N".
[[nodiscard]] Status validate(const BlendSet& set);

/// Checks a target that is to become target k of a set with this topology. Errors: those of validate() for a set.
[[nodiscard]] Status validate(const BlendTarget& target, const Topology& topology, std::size_t k);

/// Writes the blended positions at some weights, (V, 3) in double, without rounding to float32 in between. Targets of
/// weight 0 cost nothing. Preconditions: `weights` has one number for each target, and `result` has 3 V elements.
void blend_positions(const BlendSet& set, std::span<const double> weights, std::span<double> result) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_MOTION_MOTION_H_
