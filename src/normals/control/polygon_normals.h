/// Computes the control normals of one polygon without SIMD lanes, for cases that the kernels leave to this function.
#ifndef CHRONORMAL_NORMALS_CONTROL_POLYGON_NORMALS_H_
#define CHRONORMAL_NORMALS_CONTROL_POLYGON_NORMALS_H_

#include <array>
#include <cmath>
#include <cstdint>
#include <span>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// The size of a coefficient of n(t), relative to the largest control normal, below which it counts as zero in
/// degree(). Leaving the coefficient out changes the direction by about 2^-28 rad, far below the errors of an
/// evaluation in float32.
inline constexpr double kDegreeTolerance = 0x1p-28;

/// The largest rounding error of a control normal in double, relative to its length. A control normal whose error may
/// be larger is computed from integers.
inline constexpr double kLargestRounding = 0x1p-26;

/// Control normals in double, and for each of them a bound of the error of its components.
struct BoundedNormals {
  ControlNormals normals;
  std::array<double, 3> errors{};  ///< bounds of the errors of n0, of m and of n1

  /// Returns the largest error of a control normal, relative to the size of that control normal.
  [[nodiscard]] double largest_share() const noexcept {
    const auto share = [](double error, const Vec3d& v) { return error == 0 ? 0 : error / max_abs(v); };
    return maximum_number(share(errors[0], normals.n0),
                          maximum_number(share(errors[1], normals.m), share(errors[2], normals.n1)));
  }

  /// Replaces each control normal whose relative error may be more than kLargestRounding. Its new value comes from
  /// `exact`, which was computed in integers and then rounded.
  void settle(const ControlNormals& exact) noexcept {
    const auto take = [](const Vec3d& from, Vec3d& to, double& error) {
      constexpr double kExactError = 0x1p-50;
      if (error <= kLargestRounding * max_abs(to)) return;
      to = from;
      error = kExactError * max_abs(from);
    };
    take(exact.n0, normals.n0, errors[0]);
    take(exact.m, normals.m, errors[1]);
    take(exact.n1, normals.n1, errors[2]);
  }
};

struct PolygonNormals : BoundedNormals {  ///< `normals` are those that face_control_normals() writes
  /// The largest component of the sums of absolute products in n0, n1 and 2 m. For m, the products of both cross
  /// products are added.
  double magnitude = 0;
};

/// Returns the control normals of a polygon. `face` is the list of its vertices.
[[nodiscard]] PolygonNormals polygon_control_normals(const Segment& segment,
                                                     std::span<const std::uint32_t> face) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_POLYGON_NORMALS_H_
