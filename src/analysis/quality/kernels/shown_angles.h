/// Computes for every vertex and sample of an audit, in lanes of double, the normals of moving triangles, and the
/// angles between the true normals and the rendered ones.
///
/// All results have the same bits as the scalar functions: sums from left to right, twice_vector_area() of positions
/// interpolated in double, and angle_between() of the results of unit() and lerp() of core/vec3.h.
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

/// Some triangles between two keyframes. Positions are gathered once, so that each t costs one pass over contiguous
/// memory. An object can be reused for other triangles, and keeps its memory.
class TrianglesInMotion {
 public:
  /// Gathers triangles; corners has three vertices for each.
  void gather(VectorView<const float> from, VectorView<const float> to, std::span<const std::uint32_t> corners);

  struct Normal {
    double x, y, z;
    double size;  ///< the largest component
  };
  /// Writes the normals at t in [0, 1], one for each triangle.
  void normals(double t, std::vector<Normal>& result) const;

 private:
  std::size_t count_ = 0;
  std::vector<float> positions_;  // in groups of lanes, 18 values per triangle
};

/// Vectors as planes, with a fourth number w for each.
struct PlanesOf4 {
  std::vector<double> x, y, z, w;

  void resize(std::size_t count) {
    for (std::vector<double>* const plane : {&x, &y, &z, &w}) plane->resize(count);
  }
};

/// Adds up the normals of the faces around elements. `faces` are indices of normals, for one element after the other;
/// ends[e] is where the faces of element e end. x, y and z are the sums of normals, and w is the sum of their sizes.
void sums_around(const std::vector<TrianglesInMotion::Normal>& normals, std::span<const std::uint32_t> faces,
                 std::span<const std::uint32_t> ends, PlanesOf4& sums);

/// The values that stand for an error that does not exist.
inline constexpr double kNotLit = -1, kNotJudged = -2;

/// The rendered and the true normals of some elements at a sample between two keyframes.
struct ShownElements {
  const PlanesOf4& from;   ///< stored normals, of any length; w is the least length of a true normal
  const PlanesOf4& to;     ///< w is not used
  const PlanesOf4& right;  ///< true normals, of any length; w is the size of the terms that they are sums of
  double rounding = 0;     ///< the rounding error of `right`, as a share of its w
};

/// Writes, in degrees, the angles between unit(lerp(from, to, t)), rounded to float32, and the true normals: kNotLit if
/// an element is drawn but has no direction, or else kNotJudged if it is not drawn or has no true normal.
/// All planes must have as many elements as the result; no number may be infinite or NaN.
void shown_angles(const ShownElements& elements, double t, std::span<double> degrees) noexcept;

/// Writes the angles between pairs of vectors, which need not be unit vectors, times a factor: degrees per radian, or 1
/// for radians. The angle is 0 if one vector is zero. All three must have the same size; no number may be infinite or
/// NaN.
void angles_of_pairs(std::span<const Vec3d> a, std::span<const Vec3d> b, std::span<double> angles,
                     double per_radian = kDegreesPerRadian) noexcept;

/// Does what angles_of_pairs() does for rendered and true normals, and writes the differences of the unit vectors in
/// float: minus twice the true one if nothing is rendered, NaN if no true normal is known; zero vectors stand for both.
/// A length within 1e-6 of 1 counts as 1.
void errors_of_pairs(std::span<const Vec3d> rendered, std::span<const Vec3d> right, std::span<double> degrees,
                     std::span<Vec3f> differences) noexcept;

/// Writes the lengths of vectors.
void lengths_of(std::span<const Vec3d> vectors, std::span<double> lengths) noexcept;

/// Replace vectors by unit(v), or by unit(v) rounded to float.
void make_units(std::span<Vec3d> vectors) noexcept;
void make_rounded_units(std::span<Vec3d> vectors) noexcept;

/// Writes, in radians, the angles of the vectors (x, y), as portable::atan2() does, but NaN if both are infinite. All
/// three must have the same size; no y may be below 0.
void upper_angles(std::span<const double> y, std::span<const double> x, std::span<double> radians) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_KERNELS_SHOWN_ANGLES_H_
