/// Vertices that do not move on straight lines: normals as polynomials of higher degree.
///
/// Inside a segment every vertex moves as a polynomial of degree K in t, given by K + 1 control positions in Bernstein
/// form; edges have the same degree, and a normal, their cross product, has degree 2 K:
///
///     K = 2   position, velocity and acceleration of one keyframe           2 K = 4: five control normals
///     K = 3   position and velocity of two keyframes (cubic Hermite)         2 K = 6: seven
///     K = 1   the straight lines of Segment                                  2 K = 2: three, ControlNormals
///
/// As with those, areas add up: the area-weighted normal of a vertex is the sum of the control normals of its faces,
/// exact at every t. The other way is to cut the motion into straight pieces; cut_into_segments() does that to a stated
/// error, after which everything that takes a Motion applies.
///
/// Units      positions: any length L; velocities L / s; accelerations L / s^2; control normals L^2; t in [0, 1].
/// Threads    pure.
#ifndef CHRONORMAL_NORMALS_PATHS_H_
#define CHRONORMAL_NORMALS_PATHS_H_

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "chronormal/core/polynomial.h"
#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/motion/motion_stream.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

/// One piece of a motion of degree K. The topology must outlive it.
template <std::size_t K>
struct PolynomialSegment {
  const Topology* topology = nullptr;
  std::array<std::vector<Vec3d>, K + 1> control;  ///< control positions: control[i][vertex]
  double start_time = 0;                          ///< seconds, at t = 0
  double end_time = 1;                            ///< seconds, at t = 1
};

/// The control normals of one element of a motion of degree K.
template <std::size_t K>
using PolynomialNormals = Bernstein<Vec3d, 2 * K>;

/// p + v s + a s^2 / 2 with s = seconds since start_time. Where the next keyframe is somewhere else, the motion jumps.
/// All views must have as many elements as the topology has vertices
[[nodiscard]] PolynomialSegment<2> accelerated_segment(const Topology& topology, VectorView<const float> positions,
                                                       VectorView<const float> velocities,
                                                       VectorView<const float> accelerations, double start_time,
                                                       double end_time);

/// The cubic with the given positions and velocities at both ends: the CUBICSPLINE of glTF.
/// All views must have as many elements as the topology has vertices
[[nodiscard]] PolynomialSegment<3> hermite_segment(const Topology& topology, VectorView<const float> from,
                                                   VectorView<const float> from_velocities, VectorView<const float> to,
                                                   VectorView<const float> to_velocities, double start_time,
                                                   double end_time);

/// How the vertices of a sequence move between its keyframes.
enum class PathKind {
  kLinear,      ///< straight, as players do
  kCatmullRom,  ///< on cubics whose velocities follow from the keyframes: catmull_rom_segment()
  kHermite,     ///< on cubics with the velocities of the keyframes, or those of kCatmullRom where a keyframe has none
};

/// The name of a path: "linear", "catmull-rom" or "hermite".
[[nodiscard]] std::string_view path_name(PathKind kind) noexcept;
/// Finds a path by its name. Errors: kUsage, with all names.
[[nodiscard]] Result<PathKind> make_path(std::string_view name);
/// The velocities that a path takes from a keyframe itself: on kHermite those of its file, where it has some, and on
/// curves else its end_velocities. Empty: they follow from the positions of the keyframe and its neighbours.
[[nodiscard]] const std::vector<float>& given_velocities(const Motion::Keyframe& keyframe, PathKind kind) noexcept;
/// Checks that a motion has such paths. Errors: kUsage for curves in a motion that is no sequence, and for kHermite
/// where no keyframe has velocities.
[[nodiscard]] Status check_path(const Motion& motion, PathKind kind);

/// The cubic from keys[i] to keys[i + 1], through their float32 positions: a curve is drawn through keyframes of files,
/// which have no residuals; motions that are blended are straight, and have no curves. The velocity at a key is that of
/// the parabola through it and its two neighbours (Catmull and Rom, for uneven times), and at the first and the last
/// key that of the cubic through the nearest four: of as many as there are, so that between two keys the motion is
/// straight. A key that has end_velocities has these.
/// keys must ascend in time, each with as many positions as the topology has vertices; i + 1 < keys.size()
[[nodiscard]] PolynomialSegment<3> catmull_rom_segment(const Topology& topology,
                                                       std::span<const Motion::Keyframe* const> keys, std::size_t i);

/// The path from keys[i] to keys[i + 1] as a cubic, straight paths too. Preconditions: those of catmull_rom_segment()
[[nodiscard]] PolynomialSegment<3> path_segment(const Topology& topology, std::span<const Motion::Keyframe* const> keys,
                                                std::size_t i, PathKind kind);
/// The same for segment i of a sequence.
[[nodiscard]] PolynomialSegment<3> path_segment(const Motion& motion, std::size_t i, PathKind kind);

/// The velocity at keyframe `at` as kCatmullRom has it: the sum of share[j] p(first + j) over the positions p of the
/// keyframes first, first + 1, ... from which it follows.
struct VelocityShares {
  std::size_t first = 0;
  std::vector<double> share;  ///< per second
};
/// times must ascend; at < times.size()
[[nodiscard]] VelocityShares velocity_shares(std::span<const double> times, std::size_t at);

/// How far the paths through a sequence of keyframes, or through every `every`-th of them, are from straight: for every
/// three successive keyframes the second difference of a vertex, relative to the way that it went, where both are added
/// up over all vertices and keyframes. A rigid turn by an angle a from keyframe to keyframe has sin(a / 2).
[[nodiscard]] double bend_of(const Motion& motion, std::size_t every = 1);
/// The same for a stream, of which three keyframes are held at a time. Errors: those of the stream.
[[nodiscard]] Result<double> bend_of(MotionStream& stream, std::size_t every = 1);
/// Above this bend, a curve through the keyframes tells little about the motion.
inline constexpr double kTooSparse = 0.5;
/// Whether a bend is above kTooSparse by more than what the rounding of float32 positions may add to it: a rigid turn
/// by 60 degrees from keyframe to keyframe bends by the limit, and is not too sparse.
[[nodiscard]] constexpr bool is_too_sparse(double bend) noexcept { return bend > kTooSparse + 1e-6; }

/// Velocities against positions, to find out whether the velocities are those of the motion.
struct VelocityFit {
  /// The way that vertices would go from keyframe to keyframe at the mean of the speeds at both ends, as a multiple of
  /// the straight way that they go: 1 or somewhat more. It is 100 where velocities are 100 times too large, and 30
  /// where they are per second and keyframes without times count as seconds.
  double length = 1;
  /// The mean cosine of the angle between velocities and these ways, where long ones count more: -1 where velocities
  /// are reversed.
  double direction = 1;

  /// Whether a turn of up to about 200 degrees from keyframe to keyframe, or an acceleration from rest, explains both.
  [[nodiscard]] bool is_plausible() const noexcept { return length >= 1.0 / 3 && length <= 3 && direction >= 0; }
};
/// Looks at up to 64 segments, evenly spread, whose keyframes both have velocities. Where there is none, or where no
/// vertex moves, the result is as if all velocities fitted. Errors: those of the stream.
[[nodiscard]] Result<VelocityFit> velocity_fit(MotionStream& stream);

/// Where the vertices are at a local t.
template <std::size_t K>
[[nodiscard]] std::vector<Vec3d> positions_at(const PolynomialSegment<K>& segment, double t);

/// Writes the control normals of a range of faces; (K + 1)^2 cross products per triangle. K = 1, 2 or 3.
/// result must have faces.count elements
template <std::size_t K>
void polynomial_face_normals(const PolynomialSegment<K>& segment, IndexRange faces,
                             std::span<PolynomialNormals<K>> result) noexcept;

/// The normals of a range of faces at t, from the positions there: cross products of edges, without control normals. A
/// result that is nothing but rounding is zero. result must have faces.count elements
template <std::size_t K>
void polynomial_face_normals_at(const PolynomialSegment<K>& segment, double t, IndexRange faces,
                                std::span<Vec3d> result) noexcept;

/// Writes the control normals of a range of elements, sums of those of the faces, in the order of NormalGroups.
/// of_faces must have those of all faces, result as many elements as the range
template <std::size_t K>
void polynomial_group_normals(const NormalGroups& groups, std::span<const PolynomialNormals<K>> of_faces,
                              IndexRange elements, std::span<PolynomialNormals<K>> result) noexcept;

/// n(t) / |n(t)| in double, with the degenerate cases of unit_normal_at() in control_normals.h: where n(t) = 0 the
/// limit from before (at t = 0 from after), and whether that from the other side agrees.
template <std::size_t N>
[[nodiscard]] UnitNormal unit_normal_at(const std::array<Vec3d, N>& normals, double t) noexcept;

/// Cuts the motion into equally long straight pieces, as few as prove that no vertex is anywhere further than
/// `distance` from its curve: as many as the root of the largest second difference asks for. Keyframes are float32:
/// their rounding, 2^-24 of the coordinates, comes on top.
/// Errors: kUsage for a distance that is not positive, and where it would take more than most_pieces.
template <std::size_t K>
[[nodiscard]] Result<Motion> cut_into_segments(const PolynomialSegment<K>& segment, double distance,
                                               std::size_t most_pieces = 10000);

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_PATHS_H_
