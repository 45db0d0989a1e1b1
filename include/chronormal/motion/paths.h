/// Curved motion: curves through the keyframes of a sequence, cut into straight pieces.
///
/// Everything in this library is exact for vertices on straight lines. A curve is converted into a sequence with more
/// keyframes, which all functions for a Motion accept:
///
///     keyframes            0           1                 2
///     catmull-rom          0--o--o--o--1--o--o--o--o--o--2         o: keyframes on the curves, at equal steps of time
///
/// The number of pieces of a segment follows from a bound, not from samples. On each piece the cubic of a vertex is its
/// chord plus a deviation s (1 - s) ((1 - s) a + s b) with s in [0, 1], where a and b follow from the second
/// derivatives at both ends. The products of edges and deviations bound the distance between two normal vectors of a
/// face, one on the curves and one on the chords. The Bernstein coefficients of the normal on the chords bound its
/// length from below. A segment gets the fewest pieces of the series 1, 2, 3, 4, 6, 8, 12 ... for which the ratio of
/// these two bounds is at most the sine of the tolerance in every face and piece. The bound holds for
/// normal vectors, not only for their angles, so it also holds for their sum over the faces of a vertex or corner, if
/// these faces have similar directions.
///
/// The new keyframes are float32, and the rounding of their positions adds to the error; a face whose normals deviate
/// by no more than this rounding can cause is accepted, too. A face that nearly vanishes between two keyframes may miss
/// the tolerance with any number of pieces: such a face is counted in CutPath::beyond, and does not influence the
/// number of pieces.
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

/// The kind of path on which the vertices of a sequence move between its keyframes.
enum class PathKind {
  kLinear,      ///< vertices move on straight lines, as in programs that play motions
  kCatmullRom,  ///< vertices move on cubics whose velocities follow from the keyframes (CubicSegment)
  /// Vertices move on cubics with the velocities that the keyframes store. A keyframe without velocities gets the
  /// velocities of kCatmullRom.
  kHermite,
};

/// The default tolerance, in degrees: the largest angle between the normals on the straight pieces and the normals on
/// the curve.
inline constexpr double kPathTolerance = 0.01;

/// A kind of path, and the tolerance with which its curves are cut into straight pieces.
struct Path {
  PathKind kind = PathKind::kLinear;
  /// The largest angle, in degrees, between normals on the pieces and normals on the curve.
  double tolerance = kPathTolerance;

  [[nodiscard]] bool is_curved() const noexcept { return kind != PathKind::kLinear; }
};

/// Returns the name of a kind: "linear", "catmull-rom" or "hermite".
[[nodiscard]] std::string_view path_name(PathKind kind) noexcept;
/// Reads a path: the name of its kind, and after a colon the tolerance of a curve, "catmull-rom:0.1". Errors: kUsage
/// for another name, with all names, and for a tolerance that is not a number of degrees above 0 and at most 45.
[[nodiscard]] Result<Path> make_path(std::string_view text);
/// Checks that a motion can have paths of this kind. Errors: kUsage for curves in a motion that is not a sequence, and
/// for kHermite if no keyframe has velocities.
[[nodiscard]] Status check_path(const Motion& motion, PathKind kind);

/// The weights that give the velocity of a vertex at a keyframe for kCatmullRom. The velocity is the sum of share[j]
/// p(first + j) over the positions p of the keyframes first, first + 1, ...
struct VelocityShares {
  std::size_t first = 0;
  std::vector<double> share;  ///< one weight for each keyframe, in 1 / second

  /// Returns the velocities of all vertices, (V, 3): the sums of the positions at the keyframes, weighted by `share`.
  /// `positions` has one array for each share, all of the same size.
  [[nodiscard]] std::vector<float> velocities(std::span<const std::span<const float>> positions) const;
};
/// Computes the shares of keyframe `at`. The velocity there is that of the parabola through the keyframe and its two
/// neighbours. At the first and the last keyframe the velocity is that of the cubic through the nearest four keyframes,
/// or through all if there are fewer. With two keyframes the motion is straight. Preconditions: times ascend; at <
/// times.size().
[[nodiscard]] VelocityShares velocity_shares(std::span<const double> times, std::size_t at);

/// The cubics of all vertices from one keyframe to the next, in Bernstein form.
struct CubicSegment {
  std::array<std::vector<Vec3d>, 4> control;  ///< control[i][vertex] is the coefficient i of the cubic of a vertex
  double start_time = 0, end_time = 1;        ///< the times in seconds, at t = 0 and at t = 1

  /// Returns the position of a vertex at a local t.
  [[nodiscard]] Vec3d position(std::size_t vertex, double t) const noexcept;
  /// Returns the positions of all vertices at a local t, (V, 3), rounded to float32.
  [[nodiscard]] std::vector<float> positions(double t) const;
};
/// Returns the cubics from keys[i] to keys[i + 1]; for kLinear they are straight lines. Curves run only through
/// keyframes from files, which have no residuals, so residuals are ignored. If a key has end_velocities
/// (motion/motion.h), these are its velocities. Only the keys that determine the velocities are read. Preconditions:
/// keys ascend in time and have equally many positions; i + 1 < keys.size().
[[nodiscard]] CubicSegment cubic_segment(std::span<const Motion::Keyframe* const> keys, std::size_t i, PathKind kind);

/// Measures the bend of the paths through every `every`-th keyframe of a sequence. The bend is the sum of the second
/// differences of vertices over three successive keyframes, divided by the sum of the distances that the vertices move,
/// over all vertices and keyframes. A rigid turn by an angle a from keyframe to keyframe has a bend of sin(a / 2).
/// Three keyframes are held at a time. Errors: those of the stream.
[[nodiscard]] Result<double> bend_of(MotionStream& stream, std::size_t every = 1);
/// The bend, as bend_of() measures it, above which a curve through the keyframes says little about the real motion.
inline constexpr double kTooSparse = 0.5;
/// Returns true if a bend exceeds kTooSparse by more than rounding the positions to float32 could cause. A rigid turn
/// by 60 degrees from keyframe to keyframe has exactly the bend kTooSparse, and is not too sparse.
[[nodiscard]] constexpr bool is_too_sparse(double bend) noexcept { return bend > kTooSparse + 1e-6; }

/// A comparison of the velocities that a file stores with the motion of its positions, which shows whether the
/// velocities fit.
struct VelocityFit {
  /// The distance that vertices would move from keyframe to keyframe at the mean of the speeds at both ends, divided by
  /// the distance that they really move. The ratio is 1 or slightly more if velocities fit, and 100 if velocities are
  /// 100 times too large. The ratio is 30 if velocities are per second, while the file has 30 frames per second that
  /// are read as one second apart.
  double length = 1;
  /// The mean cosine of the angle between velocities and displacements, weighted by distance. The mean is -1 if all
  /// velocities are reversed.
  double direction = 1;

  /// Returns true if a turn of up to about 200 degrees from keyframe to keyframe, or an acceleration from rest, could
  /// explain `length` and `direction`.
  [[nodiscard]] bool is_plausible() const noexcept { return length >= 1.0 / 3 && length <= 3 && direction >= 0; }
};
/// Compares velocities with positions in up to 64 evenly distributed segments whose keyframes both have velocities. If
/// there are no such segments, or if no vertex moves, the result says that the velocities fit. Errors: those of the
/// stream.
[[nodiscard]] Result<VelocityFit> velocity_fit(MotionStream& stream);

/// The numbers that describe how curves were cut into pieces.
struct CutPath {
  Path path;
  bool skins = false;        ///< the paths are those of vertices behind the skins of a glTF file; then `path` is linear
  std::size_t segments = 0;  ///< number of segments between the original keyframes
  std::size_t pieces = 0;    ///< number of pieces of all segments
  /// The number of faces that miss the tolerance with any number of pieces, counted once for each segment.
  std::size_t beyond = 0;
  double rounding = 0;     ///< bound of the error of rounding a coordinate to float32, in units of length
  double bend = 0;         ///< bend_of() for the original keyframes
  VelocityFit velocities;  ///< velocity_fit() for the original keyframes, if the kind is kHermite
};

/// The default of the largest number of pieces into which one segment is cut.
inline constexpr std::size_t kMostPieces = 100;

/// A motion in memory whose curves have been cut into pieces. For kLinear, `motion` is the unchanged motion.
struct CutMotion {
  Motion motion;
  CutPath cut;
};
[[nodiscard]] Result<CutMotion> cut_into_segments(const Motion& motion, const Path& path,
                                                  std::size_t most_pieces = kMostPieces);

/// A stream of the pieces into which curves were cut. The original keyframes are read once to determine the number of
/// pieces, and again, four at a time, when pieces are needed. If all pieces together take at most `kept` bytes, they
/// stay in memory once they were computed.
struct CutStream {
  MotionStream stream;
  CutPath cut;
};
/// Cuts the curves of a stream. Errors: those of check_path() and of the stream; kUsage for a mesh at rest, and for
/// curves that leave the range of float32.
[[nodiscard]] Result<CutStream> cut_into_segments(MotionStream stream, const Path& path,
                                                  std::size_t most_pieces = kMostPieces,
                                                  std::size_t kept = MotionStream::kUsuallyKept);

}  // namespace chronormal

#endif  // CHRONORMAL_MOTION_PATHS_H_
