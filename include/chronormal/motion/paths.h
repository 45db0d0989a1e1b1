/// Vertices that do not move on straight lines: curves through the keyframes of a sequence, cut into straight pieces.
///
/// Everything in this library is exact for vertices on straight lines. A curve becomes a sequence with more keyframes,
/// after which all that takes a Motion applies to it:
///
///     keyframes            0           1                 2
///     catmull-rom          0--o--o--o--1--o--o--o--o--o--2         o: keyframes on the curves, at equal steps of time
///
/// The number of pieces that a segment gets follows from a bound, and not from samples. On each piece the cubic of a
/// vertex is its chord and a deviation s (1 - s) ((1 - s) a + s b) with s in [0, 1], where a and b follow from the
/// second derivatives at both ends. The products of edges and deviations bound how far the normal of a face, a vector,
/// is from that of the chords, and the Bernstein coefficients of the latter bound its length. A segment gets the fewest
/// pieces, of a ladder 1, 2, 3, 4, 6, 8, 12 ..., with which that ratio is at most the sine of the tolerance in every
/// face and piece. Since it bounds vectors, sums over the faces of a vertex or of a corner are as near, as far as these
/// faces look the same way.
///
/// The new keyframes are float32, and the rounding of their positions comes on top: a face whose normals deviate by no
/// more than that rounding is good enough, too. A face that all but vanishes between two keyframes may be within no
/// tolerance however many pieces there are: it counts as `beyond`, and decides nothing.
///
/// Units      positions: any length L; velocities L / s; tolerances in degrees.
/// Threads    pure. Cutting runs on all cores, with the same result on any number of them.
/// Source     Catmull and Rom, A class of local interpolating splines (1974), for uneven times.
#ifndef CHRONORMAL_MOTION_PATHS_H_
#define CHRONORMAL_MOTION_PATHS_H_

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

/// Tells how the vertices of a sequence move between its keyframes.
enum class PathKind {
  kLinear,      ///< straight, as players do
  kCatmullRom,  ///< on cubics whose velocities follow from the keyframes: CubicSegment
  kHermite,     ///< on cubics with the velocities of the keyframes, or those of kCatmullRom where a keyframe has none
};

/// The largest angle, in degrees, between normals of straight pieces and of the curve, if none is asked for.
inline constexpr double kPathTolerance = 0.01;

/// A path, and how near straight pieces have to be to it.
struct Path {
  PathKind kind = PathKind::kLinear;
  double tolerance = kPathTolerance;  ///< degrees, of normals

  [[nodiscard]] bool is_curved() const noexcept { return kind != PathKind::kLinear; }
};

/// Returns the name of a kind: "linear", "catmull-rom" or "hermite".
[[nodiscard]] std::string_view path_name(PathKind kind) noexcept;
/// Reads a path: the name of its kind, and after a colon the tolerance of a curve, "catmull-rom:0.1". Errors: kUsage
/// for another name, with all names, and for a tolerance that is no number above 0 and up to 45.
[[nodiscard]] Result<Path> make_path(std::string_view text);
/// Checks that a motion has such paths. Errors: kUsage for curves in a motion that is no sequence, and for kHermite
/// where no keyframe has velocities.
[[nodiscard]] Status check_path(const Motion& motion, PathKind kind);

/// The velocity at keyframe `at` as kCatmullRom has it: the sum of share[j] p(first + j) over the positions p of the
/// keyframes first, first + 1, ... from which it follows.
struct VelocityShares {
  std::size_t first = 0;
  std::vector<double> share;  ///< per second

  /// Adds up positions, (V, 3) each: one for each share, all of one size.
  [[nodiscard]] std::vector<float> velocities(std::span<const std::span<const float>> positions) const;
};
/// Computes the shares of keyframe `at`. The velocity there is that of the parabola through the keyframe and its two
/// neighbours, and at the first and the last keyframe that of the cubic through the nearest four, or through as many as
/// there are, so that between two keyframes the motion is straight. times must ascend; at < times.size()
[[nodiscard]] VelocityShares velocity_shares(std::span<const double> times, std::size_t at);

/// The cubics of all vertices from one keyframe to the next, in Bernstein form.
struct CubicSegment {
  std::array<std::vector<Vec3d>, 4> control;  ///< control[i][vertex]
  double start_time = 0, end_time = 1;        ///< seconds, at t = 0 and t = 1

  /// Returns the position of a vertex at a local t.
  [[nodiscard]] Vec3d position(std::size_t vertex, double t) const noexcept;
  /// Returns the positions of all vertices, rounded to float32: (V, 3).
  [[nodiscard]] std::vector<float> positions(double t) const;
};
/// Returns the cubics from keys[i] to keys[i + 1], straight ones too, through their float32 positions: a curve is drawn
/// through keyframes of files, which have no residuals. A key that has end_velocities (motion/motion.h) keeps them.
/// keys must ascend in time, all with as many positions; i + 1 < keys.size(). Only keys from which the velocities
/// follow are looked at.
[[nodiscard]] CubicSegment cubic_segment(std::span<const Motion::Keyframe* const> keys, std::size_t i, PathKind kind);

/// Measures how far the paths through every `every`-th keyframe of a sequence are from straight. For every three
/// successive keyframes it is the second difference of a vertex, relative to the way that the vertex went; both are
/// added up over all vertices and keyframes. A rigid turn by an angle a from keyframe to keyframe has sin(a / 2). Three
/// keyframes are held at a time. Errors: those of the stream.
[[nodiscard]] Result<double> bend_of(MotionStream& stream, std::size_t every = 1);
/// Above this bend, a curve through the keyframes tells little about the motion.
inline constexpr double kTooSparse = 0.5;
/// Tells whether a bend is above kTooSparse by more than what the rounding of float32 positions may add to it: a rigid
/// turn by 60 degrees from keyframe to keyframe bends by the limit, and is not too sparse.
[[nodiscard]] constexpr bool is_too_sparse(double bend) noexcept { return bend > kTooSparse + 1e-6; }

/// Compares velocities with positions, to find out whether the velocities belong to the motion.
struct VelocityFit {
  /// The way that vertices would go from keyframe to keyframe at the mean of the speeds at both ends, as a multiple of
  /// the straight way that they go: 1 or somewhat more. It is 100 where velocities are 100 times too large, and 30
  /// where they are per second and keyframes without times count as seconds.
  double length = 1;
  /// The mean cosine of the angle between velocities and these ways, where long ones count more: -1 where velocities
  /// are reversed.
  double direction = 1;

  /// Returns true if a turn of up to about 200 degrees from keyframe to keyframe, or an acceleration from rest,
  /// explains both.
  [[nodiscard]] bool is_plausible() const noexcept { return length >= 1.0 / 3 && length <= 3 && direction >= 0; }
};
/// Looks at up to 64 segments, evenly spread, whose keyframes both have velocities. Where there is none, or where no
/// vertex moves, the result is as if all velocities fitted. Errors: those of the stream.
[[nodiscard]] Result<VelocityFit> velocity_fit(MotionStream& stream);

/// The result of cutting curves into pieces.
struct CutPath {
  Path path;
  std::size_t segments = 0;  ///< between the keyframes that there were
  std::size_t pieces = 0;    ///< of all of them
  std::size_t beyond = 0;    ///< faces that are within no tolerance, counted once for each segment
  double rounding = 0;       ///< L: a bound of what float32 makes of a coordinate
  double bend = 0;           ///< bend_of() the keyframes
  VelocityFit velocities;    ///< velocity_fit() of these, on kHermite
};

/// The largest number of pieces of one segment, where none is asked for.
inline constexpr std::size_t kMostPieces = 100;

/// The pieces of a motion, in memory. A motion on kLinear stays as it is.
struct CutMotion {
  Motion motion;
  CutPath cut;
};
[[nodiscard]] Result<CutMotion> cut_into_segments(const Motion& motion, const Path& path,
                                                  std::size_t most_pieces = kMostPieces);

/// The pieces of a stream. Its keyframes are read once to find out how many pieces there are, and again when pieces are
/// asked for, four at a time. Pieces that take no more bytes together than `kept` stay in memory once they were made.
struct CutStream {
  MotionStream stream;
  CutPath cut;
};
/// Cuts the curves of a stream. Errors: those of check_path() and of the stream; kUsage for a motion that stands still,
/// and for curves that leave the range of float32.
[[nodiscard]] Result<CutStream> cut_into_segments(MotionStream stream, const Path& path,
                                                  std::size_t most_pieces = kMostPieces,
                                                  std::size_t kept = MotionStream::kUsuallyKept);

}  // namespace chronormal

#endif  // CHRONORMAL_MOTION_PATHS_H_
