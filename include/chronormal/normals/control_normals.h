/// Face normals as polynomials in time.
///
/// Inside one segment every vertex moves on a straight line, so the normal of the triangle (a, b, c)
///     n(t) = (b(t) - a(t)) x (c(t) - a(t))                                    (eq. 1 of docs/theory.md)
/// is a quadratic in each component. It is kept in Bernstein form,
///     n(t) = (1-t)^2 n0 + 2t(1-t) m + t^2 n1                                  (eq. 5)
/// by three control normals: n0 and n1 are the normals at the ends, m is not the normal in the middle but the middle
/// control point. |n(t)| is twice the area of the face, so sums of n(t) are area-weighted; the vector area of a
/// polygon, planar or not, is such a sum over a fan of its triangles, and a quadratic too.
///
/// Units      positions: any length L; control normals: L^2; t: fraction of the segment, [0, 1].
/// Time       Here, and wherever unit normals are made of a segment: t outside [0, 1] is moved to the nearer end, below
///            2^-200 it counts as 0, and where t is NaN every normal is (0, 0, 0), Direction::kNone.
/// Rounding   Results are defined for rounding to nearest, which is how a program starts. In other rounding modes the
///            errors of directions are up to twice as large as promised. Flushing subnormal numbers to zero changes no
///            bit, except that coordinates below 2^-126 = 1.2e-38 may count as 0. Modes belong to a thread: the threads
///            that calls with Threads::kAll borrow have their own.
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

/// The control normals of one element: a face now, a sum of faces later.
struct ControlNormals {
  Vec3d n0, m, n1;

  friend ControlNormals operator+(const ControlNormals& a, const ControlNormals& b) {
    return {a.n0 + b.n0, a.m + b.m, a.n1 + b.n1};
  }
  friend bool operator==(const ControlNormals&, const ControlNormals&) = default;
};

/// Writes the control normals of a range of faces, in double. Cost: four cross products per triangle.
/// Each is within 2^-26 of its length of the exact one, so that no direction is made of noise: where the rounding of
/// double could be more than that, it is computed in integers. It is exactly zero where corners are exactly collinear.
/// result must have faces.count elements; faces must lie inside the topology
void face_control_normals(const Segment& segment, IndexRange faces, std::span<ControlNormals> result) noexcept;

/// Returns the true degree of n(t) in t: 0, 1 or 2. A translated face has degree 0, and a face of which two vertices
/// move alike has at most 1, but so have others (shear within the plane): therefore the coefficients are tested, not
/// the motion. A coefficient below 2^-28 of the largest control normal counts as zero: leaving it out turns no
/// direction by more than 1e-8 rad times that control normal / |n(t)|. (A translation that float32 had to round is not
/// exactly one, and may have degree 1 or 2.)
[[nodiscard]] int degree(const ControlNormals& normals) noexcept;

/// Returns n(t) itself, by eq. 5. It is a convex combination: its error is a few rounding errors of the largest control
/// normal.
[[nodiscard]] Vec3d normal_at(const ControlNormals& normals, double t) noexcept;

/// Tells whether a direction could be given, and how.
enum class Direction {
  kRegular,        ///< n(t) is not zero
  kLimit,          ///< n(t) = 0, and both sides (or the only side, at an end) agree on the limit
  kDiscontinuous,  ///< n(t) = 0, and the two sides are antipodal: the limit from before is given, a stated fallback
  kNone,           ///< n is zero in the whole segment: (0, 0, 0) is given
};

struct UnitNormal {
  Vec3d vector;
  Direction direction = Direction::kRegular;
};

/// Returns n(t) / |n(t)| in double; Direction names how every degenerate case is defined. At t = 0 the limit is taken
/// from after, elsewhere from before. Inside a segment n(t) counts as zero below 8 rounding errors of its control
/// normals. Callers who have positions and must know better ask MeshNormals or NormalCurves, which decide it exactly.
[[nodiscard]] UnitNormal unit_normal_at(const ControlNormals& normals, double t) noexcept;

// Normals of meshes that move as a whole: rigid and affine motion.
//
// Positions go through x -> L x + offset; the vector area of a face then goes through the cofactor matrix of L, which
// is det(L) times its inverse transpose, and is defined where L has no inverse. A mirrored L (det < 0) turns faces
// inside out: the corners, in their order, are clockwise from where they were counter-clockwise, and the cofactors
// give the normal of that order, inwards. What is wanted is the side that was outside before: |det L| times the
// inverse transpose. That is what NormalMatrix is; for rotations it is L itself.
//
// Units      a normal of length 2 x area stays one: areas are transformed with it. Directions alone may be normalised.
// Threads    pure.

/// The affine map x -> x.x columns[0] + x.y columns[1] + x.z columns[2] + offset.
struct AffineTransform {
  std::array<Vec3d, 3> columns = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  Vec3d offset;

  [[nodiscard]] Vec3d operator()(const Vec3d& position) const noexcept {
    return position.x * columns[0] + position.y * columns[1] + position.z * columns[2] + offset;
  }
};

/// Applies first, then second: x -> second(first(x)).
[[nodiscard]] AffineTransform composed(const AffineTransform& second, const AffineTransform& first) noexcept;

/// A node of glTF or of a similar format: scaled, then rotated, then moved.
struct NodeTransform {
  Vec3d translation;
  std::array<double, 4> rotation = {0, 0, 0, 1};  ///< unit quaternion x, y, z, w
  Vec3d scale = {1, 1, 1};
};

[[nodiscard]] AffineTransform affine_transform(const NodeTransform& node) noexcept;

/// Returns the node between two keyframes by the LINEAR interpolation of glTF: translation and scale on straight lines,
/// rotation by quaternion slerp on the shorter arc (from q towards itself if the two are opposite to the last bit).
/// t in [0, 1]
[[nodiscard]] NodeTransform interpolated(const NodeTransform& from, const NodeTransform& to, double t) noexcept;

/// The matrix that takes normals along with a transform.
struct NormalMatrix {
  std::array<Vec3d, 3> columns;
  bool mirrored =
      false;  ///< whether det < 0: faces keep their outer side, but the order of their corners shows the other

  [[nodiscard]] Vec3d operator()(const Vec3d& normal) const noexcept {
    return normal.x * columns[0] + normal.y * columns[1] + normal.z * columns[2];
  }
};

/// Returns |det| times the inverse transpose of the linear part, by cofactors, without a division. If det = 0
/// (flattened to a plane), normals become the two sides of that plane, and normals along it vanish.
[[nodiscard]] NormalMatrix normal_matrix(const AffineTransform& transform) noexcept;

/// Transforms a curve of normals by a transform that stands still: applies the matrix to each control normal.
[[nodiscard]] ControlNormals transformed(const NormalMatrix& matrix, const ControlNormals& normals) noexcept;

/// Writes the unit normals of a mesh under a transform. The image of each normal, which may have any length, is scaled
/// to length 1; it is (0, 0, 0) if the image is zero, and the number of such zeros is returned. normals and result may
/// be the same memory.
/// result must have as many elements as normals
std::size_t transform_unit_normals(const NormalMatrix& matrix, VectorView<const float> normals,
                                   VectorView<float> result) noexcept;

/// Turns v by the smallest rotation that takes the unit vector `from` to the unit vector `to`; if the two are opposite,
/// one of many half turns is chosen. It keeps the offset of an author's normal from the geometry's as the mesh moves.
[[nodiscard]] Vec3d turned(const Vec3d& from, const Vec3d& to, const Vec3d& v) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_CONTROL_NORMALS_H_
