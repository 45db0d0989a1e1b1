/// Face normals as polynomials in time.
///
/// Inside one segment every vertex moves on a straight line, so the normal of the triangle (a, b, c)
///     n(t) = (b(t) - a(t)) x (c(t) - a(t))                                    (eq. 1 of docs/theory.md)
/// is a quadratic in each component. It is stored in Bernstein form,
///     n(t) = (1-t)^2 n0 + 2t(1-t) m + t^2 n1                                  (eq. 5)
/// by three control normals: n0 and n1 are the normals at the ends, and m is the middle control point, which is not the
/// normal in the middle. |n(t)| is twice the area of the face, so sums of n(t) are area-weighted. The vector area of a
/// polygon, planar or not, is half of such a sum over a fan of its triangles, and therefore a quadratic, too.
///
/// Units      positions: any length L; control normals: L^2; t: fraction of the segment, [0, 1].
/// Time       Here, and in all functions for unit normals of a segment: t outside [0, 1] is moved to the nearer end, t
///            below 2^-200 counts as 0, and if t is NaN every normal is (0, 0, 0), Direction::kNone.
/// Rounding   Results are defined for rounding to nearest, the default of every program. In other rounding modes the
///            errors of directions are up to twice as large as stated. Flushing subnormal numbers to zero changes no
///            bit, except that coordinates below 2^-126 = 1.2e-38 may count as 0. Modes belong to a thread: pool
///            threads, which Threads::kAll uses, have their own.
/// Threads    everything here is pure: no allocation, no throw, the same bits on every compiler.
#ifndef CHRONORMAL_NORMALS_CONTROL_NORMALS_H_
#define CHRONORMAL_NORMALS_CONTROL_NORMALS_H_

#include <array>
#include <cstddef>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

/// The control normals of an element: those of a face, or their sums over several faces.
struct ControlNormals {
  Vec3d n0, m, n1;

  friend ControlNormals operator+(const ControlNormals& a, const ControlNormals& b) {
    return {a.n0 + b.n0, a.m + b.m, a.n1 + b.n1};
  }
  friend bool operator==(const ControlNormals&, const ControlNormals&) = default;
};

/// Writes the control normals of a range of faces, in double. Cost: four cross products per triangle. The error of each
/// control normal is at most 2^-26 of its length, so rounding errors never determine its direction. If rounding in
/// double could exceed this bound, integer arithmetic computes the control normal. A control normal is exactly zero if
/// the corners are exactly collinear. Preconditions: result has faces.count elements; the faces exist in the topology.
void face_control_normals(const Segment& segment, IndexRange faces, std::span<ControlNormals> result) noexcept;

/// Returns the true degree of n(t) in t: 0, 1 or 2. The normal of a translated face has degree 0, and that of a face
/// with two vertices that move alike has at most degree 1. Other motions, such as a shear within the plane, have low
/// degrees, too, so this function tests the coefficients and not the motion. A coefficient below 2^-28 of the largest
/// control normal counts as zero. Leaving out such a coefficient turns no direction by more than 1e-8 rad times the
/// length of that control normal divided by |n(t)|. (A translation that was rounded to float32 is not exact, and may
/// have degree 1 or 2.)
[[nodiscard]] int degree(const ControlNormals& normals) noexcept;

/// Returns n(t), by eq. 5, without scaling it to length 1. n(t) is a convex combination of the control normals, so its
/// error is only a few rounding errors of the largest control normal.
[[nodiscard]] Vec3d normal_at(const ControlNormals& normals, double t) noexcept;

/// The kind of a direction, which tells how the direction follows from n(t).
enum class Direction {
  kRegular,  ///< n(t) is not zero
  /// n(t) = 0, but n / |n| has the same limit from both sides, or from the only side at an end of the segment.
  kLimit,
  /// n(t) = 0, and the limits of n / |n| from both sides are opposite. The result is then the limit from earlier times.
  kDiscontinuous,
  kNone,  ///< n is zero in the whole segment; the result is (0, 0, 0)
};

struct UnitNormal {
  Vec3d vector;
  Direction direction = Direction::kRegular;
};

/// Returns n(t) / |n(t)| in double; Direction defines the result where n(t) = 0. The limit is taken from later times at
/// t = 0, and from earlier times elsewhere. Inside a segment n(t) counts as zero if |n(t)| is below 8 times the
/// rounding error of its control normals. Callers that have positions and need an exact decision use MeshNormals or
/// NormalCurves.
[[nodiscard]] UnitNormal unit_normal_at(const ControlNormals& normals, double t) noexcept;

// Normals of meshes that move as a whole: rigid and affine motion.
//
// If positions are transformed by x -> L x + offset, the vector area of a face is multiplied by the cofactor matrix of
// L. This matrix is det(L) times the inverse transpose of L, but is also defined if L has no inverse. A mirroring L
// (det < 0) turns faces inside out: corners that were counter-clockwise become clockwise, and the cofactors give the
// normal of that order, which points inwards. A renderer needs the side that was outside before: |det L| times the
// inverse transpose. NormalMatrix is this matrix; for rotations it is L itself.
//
// Units      a normal of length 2 x area keeps this property, since areas are transformed, too. Pure directions may be
//            normalised.
// Threads    pure.

/// The affine map x -> x.x columns[0] + x.y columns[1] + x.z columns[2] + offset.
struct AffineTransform {
  std::array<Vec3d, 3> columns = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  Vec3d offset;

  [[nodiscard]] Vec3d operator()(const Vec3d& position) const noexcept {
    return position.x * columns[0] + position.y * columns[1] + position.z * columns[2] + offset;
  }
};

/// Returns the transform that applies `first` and then `second`: x -> second(first(x)).
[[nodiscard]] AffineTransform composed(const AffineTransform& second, const AffineTransform& first) noexcept;

/// The transform of a node of glTF or of a similar format: it scales, then rotates, then translates.
struct NodeTransform {
  Vec3d translation;
  std::array<double, 4> rotation = {0, 0, 0, 1};  ///< a unit quaternion x, y, z, w
  Vec3d scale = {1, 1, 1};
};

[[nodiscard]] AffineTransform affine_transform(const NodeTransform& node) noexcept;

/// Returns the node between two keyframes by glTF's LINEAR interpolation. Translation and scale are interpolated on
/// straight lines, the rotation by quaternion slerp on the shorter arc. (If the two quaternions are exactly opposite,
/// the rotation does not change.) Precondition: t is in [0, 1].
[[nodiscard]] NodeTransform interpolated(const NodeTransform& from, const NodeTransform& to, double t) noexcept;

/// The matrix that transforms normals if an affine transform moves the positions.
struct NormalMatrix {
  std::array<Vec3d, 3> columns;
  /// True if the determinant of the transform is negative. Normals still point outwards, but corners are
  /// counter-clockwise if seen from inside.
  bool mirrored = false;

  [[nodiscard]] Vec3d operator()(const Vec3d& normal) const noexcept {
    return normal.x * columns[0] + normal.y * columns[1] + normal.z * columns[2];
  }
};

/// Returns |det| times the inverse transpose of the linear part of a transform, computed from cofactors without a
/// division. If det = 0, the transform flattens space to a plane: the image of a normal is then perpendicular to that
/// plane, or zero.
[[nodiscard]] NormalMatrix normal_matrix(const AffineTransform& transform) noexcept;

/// Transforms a curve of normals by a constant matrix, which is applied to each control normal.
[[nodiscard]] ControlNormals transformed(const NormalMatrix& matrix, const ControlNormals& normals) noexcept;

/// Writes the unit normals of a mesh under a transform. The image of each normal, which need not be a unit vector, is
/// scaled to length 1. If the image is zero, the result is (0, 0, 0). Returns the number of such zeros. `normals` and
/// `result` may be the same memory. Precondition: result has as many elements as normals.
std::size_t transform_unit_normals(const NormalMatrix& matrix, VectorView<const float> normals,
                                   VectorView<float> result) noexcept;

/// Returns v turned by the smallest rotation that takes the unit vector `from` to the unit vector `to`. If the two are
/// opposite, one of many half turns is chosen. Callers use this function to keep the angle between an author's normal
/// and the geometric normal while the mesh moves.
[[nodiscard]] Vec3d turned(const Vec3d& from, const Vec3d& to, const Vec3d& v) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_CONTROL_NORMALS_H_
