/// Proofs by Bernstein coefficients that n(t) stays long enough for float32 (docs/theory.md, section 5).
#ifndef CHRONORMAL_NORMALS_CURVES_CERTIFICATE_H_
#define CHRONORMAL_NORMALS_CURVES_CERTIFICATE_H_

#include <algorithm>

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

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_CERTIFICATE_H_
