/// Proofs by Bernstein coefficients that n(t) stays long enough for float32, or for double (docs/theory.md, section 5).
#ifndef CHRONORMAL_NORMALS_CURVES_CERTIFICATE_H_
#define CHRONORMAL_NORMALS_CURVES_CERTIFICATE_H_

#include <algorithm>
#include <cstddef>

#include "chronormal/core/polynomial.h"
#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

inline constexpr int kCertificateDepth = 4;

/// Whether p >= 0 on [0, 1] can be shown by its Bernstein coefficients after a few subdivisions.
[[nodiscard]] inline bool certainly_not_negative(const Bernstein<double, 4>& p, int depth = kCertificateDepth) {
  if (std::all_of(p.begin(), p.end(), [](double b) { return b >= 0; })) return true;
  if (depth == 0 || p.front() < 0 || p.back() < 0) return false;
  const auto [before, after] = split(p, 0.5);
  return certainly_not_negative(before, depth - 1) && certainly_not_negative(after, depth - 1);
}

[[nodiscard]] inline double largest_component(const ControlNormals& c) {
  return std::max({max_abs(c.n0), max_abs(c.m), max_abs(c.n1)});
}

/// Whether ratio |n(t)| >= limit(t) for all t, where limit is a quadratic with these Bernstein coefficients.
[[nodiscard]] inline bool stays_above(const Bernstein<Vec3d, 2>& n, double ratio, const Bernstein<double, 2>& limit) {
  const Bernstein<double, 4> n_squared = multiply(n, n, dot<double>), limit_squared = multiply(limit, limit);
  Bernstein<double, 4> slack;
  for (std::size_t k = 0; k < slack.size(); ++k) slack[k] = ratio * ratio * n_squared[k] - limit_squared[k];
  return certainly_not_negative(slack);
}

/// How much an error in the control normals may turn n(t), beside what float32 does: 2^-25 = 3e-8 rad.
inline constexpr double kErrorShare = 0x1p-26;

/// n(t) in double has a direction where its largest component is above this share of sum w_k max_abs(c_k): seven
/// rounded operations turn it by less than 1.3e-7 rad then.
inline constexpr double kDoubleShare = 0x1p-26;

/// Whether such an error, of any component, is small at every t: where float32 suffices, which shows that
/// |n(t)| >= (1-t)^2 |n0| / 3 + t^2 |n1| / 3, at least a sixth of the shorter end.
[[nodiscard]] inline bool is_small_error(const ControlNormals& c, double error) {
  return error <= kErrorShare / 6 * std::min(max_abs(c.n0), max_abs(c.n1));
}

/// Whether double has the direction at every t, from control normals whose components are off by `error` at most. That
/// n(t) stays above 2^-20 of sum w_k |c_k|, where kDoubleShare is enough, leaves room for the rounding of the proof.
[[nodiscard]] inline bool double_suffices(const ControlNormals& c, double error) {
  constexpr double kShare = 0x1p-20;
  constexpr double kSmallest = 0x1p-400;  // of the largest, so that squares stay in range
  const double largest = largest_component(c);
  if (largest == 0) return error == 0;
  const double scale = 1 / largest;
  const Bernstein<Vec3d, 2> n = {scale * c.n0, scale * c.m, scale * c.n1};
  Bernstein<double, 2> limit;
  for (std::size_t k = 0; k < limit.size(); ++k) {
    const double size = length(n[k]);
    if (0 < size && size < kSmallest) return false;
    limit[k] = kShare * size + scale * error / kErrorShare;
  }
  return stays_above(n, 1, limit);
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_CERTIFICATE_H_
