/// Finds the instants at which a face collapses, so that its normal vanishes. The result is exact.
///
/// n(t) vanishes for no t, at one or two instants, or in the whole segment. At a simple zero the face turns over: the
/// directions before and after are antipodal. At a double zero it does not turn over: the face shrinks to nothing and
/// grows again with the same direction. Positions in float32 are integers times a power of two, so collapses are
/// decided in integers, without a threshold and without rounding.
///
///     const Collapses found = find_collapses(segment, face);
///     for (const Collapse& one : found.instants()) ...       // one.lower <= t <= one.upper
///
/// Certain    the number of collapses, whether each turns the face over, and that its instant t is in [lower, upper].
///            The two bounds are equal if t is a double, and otherwise neighbouring doubles; only t below 2^-200 are
///            given as [0, 2^-200]. The limit directions are within 1e-14 of their value.
/// Nearly     A face that was made to collapse may, after its positions were rounded, only come very close to a
///            collapse. Its direction then changes almost at once. Such a face is not found here; workflow/inspect.h
///            counts such faces, too.
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

/// An instant at which a face has no normal.
struct Collapse {
  double lower = 0, upper = 0;  ///< bounds of the t of the collapse
  /// True if the normals before and after the collapse have opposite directions.
  bool turns_over = false;
  Vec3d before, after;  ///< the limits of n(t) / |n(t)| on both sides; (0, 0, 0) before t = 0 and after t = 1
};

struct Collapses {
  std::array<Collapse, 2> at;  ///< the collapses, in ascending order of t
  std::size_t count = 0;
  bool always = false;  ///< true if n is zero in the whole segment; count is then 0

  [[nodiscard]] std::span<const Collapse> instants() const& noexcept { return {at.data(), count}; }
  void instants() && = delete;  ///< forbidden, since a loop over a temporary would outlive it
};

/// Finds the collapses of one face from its positions. Most faces cost three dot products, which prove that n(t) stays
/// away from zero. Otherwise integer arithmetic takes a few microseconds.
[[nodiscard]] Collapses find_collapses(const Segment& segment, std::size_t face) noexcept;

/// Finds the collapses of a face whose control normals are known. `normals` must be those that face_control_normals()
/// gives for this segment.
[[nodiscard]] Collapses find_collapses(const Segment& segment, std::size_t face,
                                       const ControlNormals& normals) noexcept;

struct FaceCollapses {
  std::size_t face = 0;
  Collapses collapses;
};

/// Finds the faces of a range that collapse, in ascending order; `normals` are the control normals of the range.
/// Allocates only the result.
[[nodiscard]] std::vector<FaceCollapses> find_collapses(const Segment& segment, IndexRange faces,
                                                        std::span<const ControlNormals> normals);

// Finds the side from which a face is seen at every instant of a segment, for culling, silhouettes and visibility over
// a shutter.
//
// A face shows its front where
//     f(t) = n(t) . w(t) > 0,   where w(t) points to the viewer
// and its back where f(t) < 0. For a viewer infinitely far away, w is a direction and f is a quadratic. For an eye that
// rests or moves on a straight line, w(t) = eye(t) - a(t), where a is the first corner of the face, and f is a cubic.
// So a face changes sides at most three times, and "back-facing at both ends" does not mean "back-facing between".
//
//     const Facing facing = find_facing(segment, face, View::of_eye({4, -5, 2}));
//     for (const FacingChange& change : facing.changes()) ...    // seen edge-on at a t in [change.lower, change.upper]
//
// Certain    the sides in their order, and that each bracket contains its root of f and no root is outside of the
//            brackets. Sides and brackets are exact for the given positions and viewer: floating point with a proven
//            bound decides, or else integers. A bracket has a width of about 1e-14 divided by the slope of f, and at
//            most kWidestBracket; or it is two neighbouring doubles, or the root itself. Roots without a double between
//            them count as one. A root below 2^-200 is not distinguished from 0.
// Polygons   the side of a non-planar polygon is the side of its vector area, seen from its first corner.
// Units      t: fraction of the segment; directions: any nonzero length.
// Threads    pure. Only find_silhouettes() allocates memory and may throw.
// Source     docs/theory.md, section 2; Munkberg, Akenine-Moller, Backface Culling for Motion Blur and Depth of Field
//            (2011), have the cubic and the test of its Bernstein coefficients, which is the first stage here.

/// The viewpoint of a query. Coordinates are used exactly as given, and must be in the range of float32.
struct View {
  bool is_eye = false;
  /// The positions of the eye at the start and at the end of its path. If is_eye is false, both are the direction to
  /// the viewer.
  Vec3d from, to;
  /// The fractions of the eye's path at which the eye is at t = 0 and at t = 1. They differ from 0 and 1 if the path is
  /// longer than the segment.
  LocalTime start = 0.0, end = 1.0;

  /// Makes a viewer infinitely far away in the direction `to_viewer`. This viewer sees the front of each face whose
  /// normal points in that direction.
  [[nodiscard]] static View of_direction(const Vec3d& to_viewer) noexcept { return {false, to_viewer, to_viewer}; }
  [[nodiscard]] static View of_eye(const Vec3d& eye) noexcept { return {true, eye, eye}; }
  [[nodiscard]] static View of_moving_eye(const Vec3d& from, const Vec3d& to, const LocalTime& start = 0.0,
                                          const LocalTime& end = 1.0) noexcept {
    return {true, from, to, start, end};
  }
};

/// The largest width, in t, of an interval that brackets a change of sides.
inline constexpr double kWidestBracket = 0x1p-40;  // 9.1e-13

enum class Side : std::int8_t {
  kBack = -1,
  kNone = 0,  ///< the face is edge-on or has no area; also the side before t = 0 and after t = 1
  kFront = 1,
};

/// A change of sides: at an instant in [lower, upper] a face is seen edge-on. The sides before and after the instant
/// may be equal.
struct FacingChange {
  double lower = 0, upper = 0;
  Side before = Side::kNone, after = Side::kNone;
};

struct Facing {
  std::array<FacingChange, 3> at;  ///< the changes, in ascending order of t
  std::size_t count = 0;
  /// The side that is seen in the whole segment, if count is 0; kNone if the face is always edge-on or without area.
  Side side = Side::kNone;

  [[nodiscard]] std::span<const FacingChange> changes() const& noexcept { return {at.data(), count}; }
  void changes() && = delete;  ///< forbidden, since a loop over a temporary would outlive it
  /// Return the side before the first change, and the side after the last change.
  [[nodiscard]] Side first() const noexcept { return count == 0 ? side : at[0].before; }
  [[nodiscard]] Side last() const noexcept { return count == 0 ? side : at[count - 1].after; }
};

/// Finds for each face of a range which side `view` sees, and when this side changes. `normals` are the control normals
/// of these faces, from face_control_normals() for this segment; result has an element for each face. Cost: about as
/// much as unit_normal_at() for each face. A face that changes sides twice or more takes several times as long. A face
/// that is edge-on without changing sides, or edge-on at t = 0, 1/2 or 1, takes some microseconds more, for integer
/// arithmetic.
void find_facings(const Segment& segment, IndexRange faces, std::span<const ControlNormals> normals, const View& view,
                  std::span<Facing> result) noexcept;

/// Decides the sides of a single face, which takes several times as long per face as a call for many faces.
[[nodiscard]] Facing find_facing(const Segment& segment, std::size_t face, const View& view) noexcept;
[[nodiscard]] Facing find_facing(const Segment& segment, std::size_t face, const ControlNormals& normals,
                                 const View& view) noexcept;

/// Decides the sides of a vertex or corner, whose normal n(t) is the sum of the normals of the faces around it
/// (NormalGroups::faces()). The side at t is the sign of f(t) = n(t) . w(t), where w(t) points from the vertex to the
/// viewer. The result is as certain as for faces, even if the normals of the faces nearly cancel. Cost: up to a
/// microsecond for each face, and some tens of microseconds if integers decide. Allocates nothing. Precondition: the
/// vertex and the faces exist in the topology.
[[nodiscard]] Facing find_vertex_facing(const Segment& segment, std::uint32_t vertex,
                                        std::span<const std::uint32_t> faces, const View& view) noexcept;

/// The sides of a face that may be seen while a shutter is open over [t0, t1].
enum class ShutterSide : std::int8_t {
  kBack = -1,  ///< the viewer never sees the front, so the face may be culled
  kBoth = 0,
  kFront = 1,  ///< the viewer never sees the back
};

/// Decides the ShutterSide of a range of faces. kBack and kFront are always certain. kBoth is certain unless the face
/// changes sides within a bracket that contains t0 or t1. A face that is edge-on or without area throughout is kBack.
/// `normals` are the control normals of the range. Cost: for most faces, that of find_facings() for a face that changes
/// sides at most once. Preconditions: result has an element for each face; 0 <= t0 <= t1 <= 1.
void sides_over(const Segment& segment, IndexRange faces, std::span<const ControlNormals> normals, const View& view,
                double t0, double t1, std::span<ShutterSide> result) noexcept;

/// An interval of t in which the two faces at an edge show different sides. It begins at an instant in the bracket
/// `from` and ends at an instant in the bracket `to`. Both numbers of `from` are 0 if the interval begins with the
/// segment; both numbers of `to` are 1 if it ends with the segment.
struct Silhouette {
  std::array<std::uint32_t, 2> vertices{}, faces{};
  std::array<double, 2> from{}, to{};
};

/// Finds all silhouette edges over time, among the edges that exactly two faces share, ordered by vertices and then by
/// time. If the two faces change sides so close to each other that their brackets meet, both changes count as one.
/// `normals` are the control normals of all faces. Memory: 88 bytes per face, 12 per corner, and the result.
[[nodiscard]] std::vector<Silhouette> find_silhouettes(const Segment& segment, std::span<const ControlNormals> normals,
                                                       const View& view);

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_SIGNS_H_
