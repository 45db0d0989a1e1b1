/// Computes the normals of moving triangles, and the angles between true and rendered normals, for every vertex and
/// sample of an audit. Works in lanes of double.
///
/// All results have the same bits as those of scalar functions: sums from left to right, twice_vector_area() of
/// positions interpolated in double, and angle_between() of unit vectors by unit() and lerp() of core/vec3.h.
#ifndef CHRONORMAL_ANALYSIS_QUALITY_KERNELS_SHOWN_ANGLES_H_
#define CHRONORMAL_ANALYSIS_QUALITY_KERNELS_SHOWN_ANGLES_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"

namespace chronormal::inline internal {

/// Some triangles between two keyframes. Their positions are gathered once, so that each t costs one pass over
/// contiguous memory. An object can later gather other triangles in the same memory.
class TrianglesInMotion {
 public:
  /// Gathers triangles. `corners` has three vertices for each triangle.
  void gather(VectorView<const float> from, VectorView<const float> to, std::span<const std::uint32_t> corners);

  struct Normal {
    double x, y, z;
    double size;  ///< the largest absolute value of x, y and z
  };
  /// Writes the normals of all triangles at a t in [0, 1], one for each triangle.
  void normals(double t, std::vector<Normal>& result) const;

 private:
  std::size_t count_ = 0;
  // The positions of the corners at both keyframes: 18 values per triangle, in groups of eight triangles.
  std::vector<float> positions_;
};

/// Vectors as planes of x, y and z, and a fourth number w for each vector.
struct PlanesOf4 {
  std::vector<double> x, y, z, w;

  void resize(std::size_t count) {
    for (std::vector<double>* const plane : {&x, &y, &z, &w}) plane->resize(count);
  }
};

/// Adds up the normals of the faces around each element. `faces` are indices of normals, for one element after the
/// other; the faces of element e end before faces[ends[e]]. x, y and z of the result are the sums of normals, and w is
/// the sum of their sizes.
void sums_around(const std::vector<TrianglesInMotion::Normal>& normals, std::span<const std::uint32_t> faces,
                 std::span<const std::uint32_t> ends, PlanesOf4& sums);

/// The numbers that stand in place of an angle: kNotLit if the rendered normal has no direction, kNotJudged if the
/// element is not drawn or has no true normal.
inline constexpr double kNotLit = -1, kNotJudged = -2;

/// The rendered and the true normals of some elements at a sample between two keyframes.
struct ShownElements {
  /// Stored normals at t = 0, of any length; w is the shortest length at which a true normal counts.
  const PlanesOf4& from;
  const PlanesOf4& to;     ///< stored normals at t = 1, of any length; w is not used
  const PlanesOf4& right;  ///< true normals, of any length; w is the size of the terms whose sum the normal is
  double rounding = 0;     ///< the rounding error of `right` divided by its w
};

/// Writes, in degrees, the angles between unit(lerp(from, to, t)), rounded to float32, and the true normals. Writes
/// kNotLit instead if an element is drawn but its rendered normal has no direction, and kNotJudged if the element is
/// not drawn or has no true normal. Preconditions: all planes have as many elements as the result; no number is
/// infinite or NaN.
void shown_angles(const ShownElements& elements, double t, std::span<double> degrees) noexcept;

/// Writes the angles between pairs of vectors, which need not be unit vectors. `per_radian` is the number of units of
/// angle per radian: kDegreesPerRadian for degrees, or 1 for radians. The angle is 0 if one vector of a pair is zero.
/// Preconditions: all three spans have the same size; no number is infinite or NaN.
void angles_of_pairs(std::span<const Vec3d> a, std::span<const Vec3d> b, std::span<double> angles,
                     double per_radian = kDegreesPerRadian) noexcept;

/// Writes the angles between rendered and true normals like angles_of_pairs(), and the differences of the two unit
/// vectors in float. The zero vector stands for a normal that is not rendered or not known. A difference is minus twice
/// the true unit normal if nothing is rendered, and NaN if no true normal is known. A length within 1e-6 of 1 counts as
/// 1.
void errors_of_pairs(std::span<const Vec3d> rendered, std::span<const Vec3d> right, std::span<double> degrees,
                     std::span<Vec3f> differences) noexcept;

void lengths_of(std::span<const Vec3d> vectors, std::span<double> lengths) noexcept;

/// Replace each vector v by unit(v), or by unit(v) rounded to float.
void make_units(std::span<Vec3d> vectors) noexcept;
void make_rounded_units(std::span<Vec3d> vectors) noexcept;

/// Writes the angles of the vectors (x, y) in radians, like portable::atan2(), but NaN if both numbers are infinite.
/// Preconditions: all three spans have the same size; no y is below 0.
void upper_angles(std::span<const double> y, std::span<const double> x, std::span<double> radians) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_KERNELS_SHOWN_ANGLES_H_
