/// Finds the instants at which a face collapses, so that its normal vanishes; decided exactly.
///
/// n(t) vanishes for no t, at one or two instants, or in the whole segment. At a simple zero the face turns over: the
/// directions before and after are antipodal. At a double zero it does not: the face shrinks to nothing and comes back
/// as it was. Since positions in float32 are integers times a power of two, this is a question about integers, and it
/// is answered as one, without a threshold and without rounding.
///
///     const Collapses found = find_collapses(segment, face);
///     for (const Collapse& one : found.instants()) ...       // one.lower <= t <= one.upper
///
/// Certain    whether there is a collapse, how many, whether each turns the face over, and that its instant t lies in
///            [lower, upper]: equal where a double is t, else neighbours, but for t below 2^-200, which lie in [0,
///            2^-200]. The limit directions are within 1e-14 of their value.
/// Nearly     A face may come so close to a collapse that its direction is as good as discontinuous: what was made to
///            collapse, and then rounded. It does not count here; workflow/inspect.h counts both.
/// Units      t: fraction of the segment, in [0, 1].
/// Threads    pure; for one face without allocation or throw.
/// Source     docs/theory.md, section 3.
#ifndef CHRONORMAL_ANALYSIS_SIGNS_H_
#define CHRONORMAL_ANALYSIS_SIGNS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal {

/// One instant without a normal.
struct Collapse {
  double lower = 0, upper = 0;  ///< t lies between these
  bool turns_over = false;      ///< the direction after is opposed to that before; false at t = 0 and t = 1
  Vec3d before, after;          ///< the limits of n(t) / |n(t)|; (0, 0, 0) before t = 0 and after t = 1
};

struct Collapses {
  std::array<Collapse, 2> at;  ///< ascending in t
  std::size_t count = 0;
  bool always = false;  ///< n is zero in the whole segment; count is 0

  [[nodiscard]] std::span<const Collapse> instants() const& noexcept { return {at.data(), count}; }
  void instants() && = delete;  ///< a loop over a temporary would outlive it
};

/// Finds the collapses of one face, from its positions. Cost: three dot products for most faces; if they do not prove
/// that n(t) stays away from zero, a few microseconds of integers.
[[nodiscard]] Collapses find_collapses(const Segment& segment, std::size_t face) noexcept;

/// Finds them with control normals that the caller has already; they must be those of face_control_normals() for this
/// segment.
[[nodiscard]] Collapses find_collapses(const Segment& segment, std::size_t face,
                                       const ControlNormals& normals) noexcept;

struct FaceCollapses {
  std::size_t face = 0;
  Collapses collapses;
};

/// Finds the faces of a range that collapse, ascending; normals are the control normals of the range. Allocates the
/// result alone.
[[nodiscard]] std::vector<FaceCollapses> find_collapses(const Segment& segment, IndexRange faces,
                                                        std::span<const ControlNormals> normals);

// Finds the side from which a face is seen at every instant of a segment, for culling, silhouettes and visibility over
// a shutter.
//
// A face shows its front where
//     f(t) = n(t) . w(t) > 0,   w(t) the way to the viewer
// and its back where f(t) < 0. For a viewer infinitely far away w is a direction and f a quadratic; for an eye that
// stands still or moves on a straight line w(t) = eye(t) - a(t), with a the first corner of the face, and f is a
// cubic. So a face changes sides at most three times, and "back-facing at both ends" does not mean "back-facing
// between".
//
//     const Facing facing = find_facing(segment, face, View::of_eye({4, -5, 2}));
//     for (const FacingChange& change : facing.changes()) ...    // seen edge-on at a t in [change.lower, change.upper]
//
// Certain    the order of all sides, and that each root of f lies in its bracket and nowhere else: decided from the
//            positions and the viewer as given, by floating point with a proven bound, and where that is not
//            enough in integers. A bracket is about 1e-14 / (how fast f changes) wide and never more than
//            kWidestBracket, or two doubles beside each other, or one that is the root. Roots without a double between
//            them count as one. Below 2^-200 a root cannot be told from 0.
// Polygons   the side of a polygon that is not flat is that of its vector area, seen from its first corner.
// Units      t: fraction of the segment; directions: of any length but 0.
// Threads    pure; find_silhouettes() allocates, nothing else does or throws.
// Source     docs/theory.md, section 2; Munkberg, Akenine-Moller, Backface Culling for Motion Blur and Depth of Field
//            (2011), have the cubic and the test of its Bernstein coefficients, which is the first stage here.

/// The viewpoint of a question. Coordinates are doubles and count as they are; none may be beyond the range of float32.
struct View {
  bool is_eye = false;
  Vec3d from, to;  ///< the eye where its way begins and ends; of a direction both are the same
  /// The fractions of the eye's way at t = 0 and at t = 1, for a way that is longer than the segment.
  LocalTime start = 0.0, end = 1.0;

  /// Makes a viewer infinitely far away in this direction; it sees the front of a face whose normal points that way.
  [[nodiscard]] static View of_direction(const Vec3d& to_viewer) noexcept { return {false, to_viewer, to_viewer}; }
  [[nodiscard]] static View of_eye(const Vec3d& eye) noexcept { return {true, eye, eye}; }
  [[nodiscard]] static View of_moving_eye(const Vec3d& from, const Vec3d& to, const LocalTime& start = 0.0,
                                          const LocalTime& end = 1.0) noexcept {
    return {true, from, to, start, end};
  }
};

/// No bracket of an instant is wider than this.
inline constexpr double kWidestBracket = 0x1p-40;  // 9.1e-13

enum class Side : std::int8_t {
  kBack = -1,
  kNone = 0,  ///< edge-on, or without area; before t = 0 and after t = 1
  kFront = 1,
};

/// An instant in [lower, upper] at which a face is seen edge-on. The sides beside it may be the same.
struct FacingChange {
  double lower = 0, upper = 0;
  Side before = Side::kNone, after = Side::kNone;
};

struct Facing {
  std::array<FacingChange, 3> at;  ///< ascending
  std::size_t count = 0;
  Side side = Side::kNone;  ///< where count is 0: throughout; kNone: edge-on or without area throughout

  [[nodiscard]] std::span<const FacingChange> changes() const& noexcept { return {at.data(), count}; }
  void changes() && = delete;  ///< a loop over a temporary would outlive it
  /// Returns the side before the first change, and last() the side after the last one.
  [[nodiscard]] Side first() const noexcept { return count == 0 ? side : at[0].before; }
  [[nodiscard]] Side last() const noexcept { return count == 0 ? side : at[count - 1].after; }
};

/// Decides the sides for a range of faces. normals are the control normals of these faces, as face_control_normals()
/// makes them of this segment; result has an element for each face.
/// Cost: about as much as unit_normal_at() for each face; several times as much if it changes sides twice or more, and
/// some microseconds of integers if it touches edge-on, or is edge-on at 0, 1/2 or 1.
void find_facings(const Segment& segment, IndexRange faces, std::span<const ControlNormals> normals, const View& view,
                  std::span<Facing> result) noexcept;

/// Decides the sides of one face, which costs several times what it costs among others.
[[nodiscard]] Facing find_facing(const Segment& segment, std::size_t face, const View& view) noexcept;
[[nodiscard]] Facing find_facing(const Segment& segment, std::size_t face, const ControlNormals& normals,
                                 const View& view) noexcept;

/// Decides for the normal of a vertex or corner, the sum of n(t) over the faces around it (NormalGroups::faces()), seen
/// from the vertex: f(t) = n(t) . w(t) with w(t) the way from the vertex to the viewer. As certain as for faces,
/// however far these cancel. Cost: up to a microsecond for each face, and some tens of them where integers decide.
/// Allocates nothing. vertex and faces must lie inside the topology
[[nodiscard]] Facing find_vertex_facing(const Segment& segment, std::uint32_t vertex,
                                        std::span<const std::uint32_t> faces, const View& view) noexcept;

/// Says which sides of a face may be seen while a shutter is open over [t0, t1].
enum class ShutterSide : std::int8_t {
  kBack = -1,  ///< never its front: it may be culled
  kBoth = 0,
  kFront = 1,  ///< never its back
};

/// Decides the ShutterSide for a range of faces: kBack and kFront are certain, and kBoth is right except for changes
/// within a bracket of t0 and t1. A face that is edge-on or without area throughout is kBack. normals are those of the
/// range. Cost: that of find_facings(), and nearly always its cheap case. result has an element for each face; 0 <= t0
/// <= t1 <= 1
void sides_over(const Segment& segment, IndexRange faces, std::span<const ControlNormals> normals, const View& view,
                double t0, double t1, std::span<ShutterSide> result) noexcept;

/// A part of the segment in which the two faces at an edge show different sides: from an instant in the first bracket
/// to one in the second. Both ends of a bracket are 0 or 1 where it begins or ends with the segment.
struct Silhouette {
  std::array<std::uint32_t, 2> vertices{}, faces{};
  std::array<double, 2> from{}, to{};
};

/// Finds all silhouette edges over time, among the edges that exactly two faces share, ordered by vertices and then by
/// time. If the two faces change so close to each other that their brackets meet, both changes count as one. normals
/// are those of all faces. Memory: 88 bytes a face, 12 a corner, and the result.
[[nodiscard]] std::vector<Silhouette> find_silhouettes(const Segment& segment, std::span<const ControlNormals> normals,
                                                       const View& view);

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_H_
