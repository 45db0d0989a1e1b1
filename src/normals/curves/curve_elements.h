/// The formulas for one element of a curve of normals, as templates on the scalar type. With a scalar that counts
/// operations, the formulas count the operations that the kernels execute for each element.
#ifndef CHRONORMAL_NORMALS_CURVES_CURVE_ELEMENTS_H_
#define CHRONORMAL_NORMALS_CURVES_CURVE_ELEMENTS_H_

#include <cmath>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// The weights of n0, m, n1 in eq. 5, which all elements share at one t. The weights are computed in double and rounded
/// to float32.
template <class S>
struct QuadraticWeights {
  S w0, w1, w2;

  [[nodiscard]] static QuadraticWeights at(double t) {
    const double s = 1 - t;
    return {S(static_cast<float>(s * s)), S(static_cast<float>(2 * t * s)), S(static_cast<float>(t * t))};
  }
};

template <class S>
[[nodiscard]] Vec3<S> quadratic_normal(const Vec3<S>& n0, const Vec3<S>& m, const Vec3<S>& n1,
                                       const QuadraticWeights<S>& w) {
  return w.w0 * n0 + w.w1 * m + w.w2 * n1;
}

/// A quadratic at one of several equidistant t, with its first and second forward differences.
template <class S>
struct QuadraticState {
  Vec3<S> n, first, second;

  /// Returns the state at the next t, which takes two additions per component.
  [[nodiscard]] QuadraticState next() const { return {n + first, first + second, second}; }
};

/// Returns v scaled to length 1. Preconditions: v is not zero, and |v|^2 neither overflows nor underflows.
template <class S>
[[nodiscard]] Vec3<S> normalized(const Vec3<S>& v) {
  using std::sqrt;
  const S scale = S(1) / sqrt(dot(v, v));
  return scale * v;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_CURVE_ELEMENTS_H_
