/// Normals of meshes that move as a whole: rigid and affine motion.
///
/// Positions go through x -> L x + offset; the vector area of a face then goes through the cofactor matrix of L, which
/// is det(L) times its inverse transpose, and is defined where L has no inverse. A mirrored L (det < 0) turns faces
/// inside out: the corners, in their order, are clockwise from where they were counter-clockwise, and the cofactors
/// give the normal of that order, inwards. What is wanted is the side that was outside before: |det L| times the
/// inverse transpose. That is what NormalMatrix is; for rotations it is L itself.
///
/// Units      a normal of length 2 x area stays one: areas are transformed with it. Directions alone may be normalised.
/// Threads    pure.
#ifndef CHRONORMAL_NORMALS_TRANSFORM_H_
#define CHRONORMAL_NORMALS_TRANSFORM_H_

#include <array>
#include <cstddef>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal {

/// x -> x.x columns[0] + x.y columns[1] + x.z columns[2] + offset.
struct AffineTransform {
  std::array<Vec3d, 3> columns = {Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}};
  Vec3d offset;

  [[nodiscard]] Vec3d operator()(const Vec3d& position) const noexcept {
    return position.x * columns[0] + position.y * columns[1] + position.z * columns[2] + offset;
  }
};

/// first, then second: x -> second(first(x)).
[[nodiscard]] AffineTransform composed(const AffineTransform& second, const AffineTransform& first) noexcept;

/// A node of glTF and its like: scaled, then rotated, then moved.
struct NodeTransform {
  Vec3d translation;
  std::array<double, 4> rotation = {0, 0, 0, 1};  ///< unit quaternion x, y, z, w
  Vec3d scale = {1, 1, 1};
};

[[nodiscard]] AffineTransform affine_transform(const NodeTransform& node) noexcept;

/// The node between two keyframes, as the LINEAR interpolation of glTF has it: translation and scale on straight lines,
/// rotation by quaternion slerp on the shorter arc (from q towards itself where the two are opposite to the last bit).
/// t in [0, 1]
[[nodiscard]] NodeTransform interpolated(const NodeTransform& from, const NodeTransform& to, double t) noexcept;

/// What takes normals along with a transform.
struct NormalMatrix {
  std::array<Vec3d, 3> columns;
  bool mirrored =
      false;  ///< whether det < 0: faces keep their outer side, but the order of their corners shows the other

  [[nodiscard]] Vec3d operator()(const Vec3d& normal) const noexcept {
    return normal.x * columns[0] + normal.y * columns[1] + normal.z * columns[2];
  }
};

/// |det| times the inverse transpose of the linear part, by cofactors: no division. Where det = 0 (flattened to a
/// plane) normals become the two sides of that plane, and those along it vanish.
[[nodiscard]] NormalMatrix normal_matrix(const AffineTransform& transform) noexcept;

/// A curve of normals under a transform that stands still: the matrix of each control normal.
[[nodiscard]] ControlNormals transformed(const NormalMatrix& matrix, const ControlNormals& normals) noexcept;

/// Writes the unit normals of a mesh under a transform: of each normal, of any length, its image scaled to length 1,
/// and (0, 0, 0) where that is zero; returns how many of those there are. normals and result may be the same memory.
/// result must have as many elements as normals
std::size_t transform_unit_normals(const NormalMatrix& matrix, VectorView<const float> normals,
                                   VectorView<float> result) noexcept;

/// Turns v by the smallest rotation that takes the unit vector `from` to the unit vector `to`; where these are opposite
/// there are many, and one half turn is chosen. What keeps a normal by hand apart from the geometry's, as the mesh
/// moves.
[[nodiscard]] Vec3d turned(const Vec3d& from, const Vec3d& to, const Vec3d& v) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_TRANSFORM_H_
