/// Proves by Bernstein coefficients that n(t) of one element stays long enough for float32, or for double
/// (docs/theory.md, section 5). kernels/certify.h proves the same for sixteen elements at a time, with the same
/// operations.
#ifndef CHRONORMAL_NORMALS_CURVES_CERTIFICATE_H_
#define CHRONORMAL_NORMALS_CURVES_CERTIFICATE_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <optional>

#include "chronormal/core/polynomial.h"
#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/pack.h"

namespace chronormal::inline internal {

inline constexpr int kCertificateDepth = 4;

/// Returns true if Bernstein coefficients prove that p >= 0 on [0, 1], after at most `depth` subdivisions.
template <std::size_t M>
[[nodiscard]] bool certainly_not_negative(const std::array<double, M>& p, int depth = kCertificateDepth) {
  if (std::all_of(p.begin(), p.end(), [](double b) { return b >= 0; })) return true;
  if (depth == 0 || p.front() < 0 || p.back() < 0) return false;
  const auto [before, after] = split(p, 0.5);
  return certainly_not_negative(before, depth - 1) && certainly_not_negative(after, depth - 1);
}

[[nodiscard]] inline double largest_component(const ControlNormals& c) {
  return std::max({max_abs(c.n0), max_abs(c.m), max_abs(c.n1)});
}

/// Returns true if it is proven that ratio |n(t)| >= limit(t) for all t. `limit` has the Bernstein coefficients of a
/// quadratic.
[[nodiscard]] inline bool stays_above(const Bernstein<Vec3d, 2>& n, double ratio, const Bernstein<double, 2>& limit) {
  const Bernstein<double, 4> n_squared = multiply(n, n, dot<double>), limit_squared = multiply(limit, limit);
  Bernstein<double, 4> slack;
  for (std::size_t k = 0; k < slack.size(); ++k) slack[k] = ratio * ratio * n_squared[k] - limit_squared[k];
  return certainly_not_negative(slack);
}

/// Returns the length of a vector that has been scaled to a size near 1, so that its square neither overflows nor
/// underflows.
[[nodiscard]] inline double scaled_length(const Vec3d& v) { return std::sqrt(dot(v, v)); }

/// The smallest size of control normals that are scaled by 1 / size before they are tested. Elements with smaller
/// control normals, which only tiny meshes have, are computed in double.
inline constexpr double kSmallestMesh = 0x1p-900;
/// The number that is added to the length of each control normal before kScaled16 is tested. In blocks of the kind
/// kScaled16, each control normal has its own exponent, and the range of these exponents is limited.
inline constexpr double kSmallestScale = 0x1p-30;

/// Returns the lowest precision that keeps an element within the tolerance at every t, or no value if double is needed.
[[nodiscard]] inline std::optional<Precision> precision_for(const ControlNormals& normals,
                                                            const PrecisionLimits& limits) {
  const double largest = largest_component(normals);
  if (!(largest >= kSmallestMesh)) return std::nullopt;
  const double scale = 1 / largest;
  const Bernstein<Vec3d, 2> n = {scale * normals.n0, scale * normals.m, scale * normals.n1};
  const Bernstein<double, 2> one = {1, 1, 1}, lengths = {scaled_length(n[0]), scaled_length(n[1]), scaled_length(n[2])};
  if (limits.largest_ratio16 > 0 && stays_above(n, limits.largest_ratio16, one))
    return stays_above(n, limits.largest_ratio11, one) ? Precision::k11 : Precision::k16;
  if (limits.sum_ratio_scaled16 > 0) {
    const Bernstein<double, 2> scales = {lengths[0] + kSmallestScale, lengths[1] + kSmallestScale,
                                         lengths[2] + kSmallestScale};
    if (stays_above(n, limits.sum_ratio_scaled16, scales)) return Precision::kScaled16;
  }
  if (stays_above(n, limits.sum_ratio32, lengths)) return Precision::k32;
  return std::nullopt;
}

/// The largest relative error that control normals in double may have. If the error is larger, integers compute the
/// control normals.
inline constexpr double kLargestShare = 0x1p-30;

/// Returns the smallest size of n(t) in double for which the direction of n(t) is certain, relative to sum w_k
/// max_abs(c_k). Above this size, the errors of the control normals, which are at most `share`, and ten roundings of
/// 2^-53 turn n(t) by less than 6e-7 rad.
[[nodiscard]] inline double smallest_certain(double share) { return std::max(0x1p-26, 0x1p22 * share); }

inline constexpr double kDeterminantRounding = 0x1p-44;
inline constexpr double kSmallestLength = 0x1p-400;  ///< squares of larger lengths neither overflow nor underflow
/// The smallest bound of |n(t)|, relative to the lengths of the control normals, that stays_certain() tries to prove by
/// Bernstein coefficients. The square of this bound is far above the rounding error of the proof.
inline constexpr double kSmallestProvenShare = 0x1p-20;

/// Returns true if it is proven that n(t) stays above the relative size `certain` at every t, so that double suffices.
/// One determinant usually suffices for the proof: n(t) never leaves the plane through the three control normals, and
/// is never nearer to zero than that plane.
[[nodiscard]] inline bool stays_certain(const ControlNormals& c, double certain) {
  const double largest = largest_component(c);
  if (largest == 0) return true;
  const double scale = 1 / largest, share = 4 * certain;  // 2 for the ratio between norms, and 2 for safety
  const Bernstein<Vec3d, 2> n = {scale * c.n0, scale * c.m, scale * c.n1};
  const double height = std::fabs(dot(n[0], cross(n[1], n[2])));
  if (height >= share * scaled_length(cross(n[1] - n[0], n[2] - n[0])) + kDeterminantRounding) return true;

  Bernstein<double, 2> limit;
  for (std::size_t k = 0; k < limit.size(); ++k) {
    const double size = scaled_length(n[k]);
    if (max_abs(n[k]) > 0 && size < kSmallestLength) return false;
    limit[k] = std::max(share, kSmallestProvenShare) * size;
  }
  return stays_above(n, 1, limit);
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_CERTIFICATE_H_
