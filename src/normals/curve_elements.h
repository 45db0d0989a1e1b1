/// One element of a curve of normals, over any scalar: the code that the loops of evaluate.cpp run, and that a counting
/// scalar counts.
#ifndef CHRONORMAL_NORMALS_CURVE_ELEMENTS_H_
#define CHRONORMAL_NORMALS_CURVE_ELEMENTS_H_

#include <cmath>
#include <cstddef>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"

namespace chronormal {

/// The weights of n0, m, n1 in eq. 5, shared by all elements at one t. Made in double: each is right to half a bit.
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

/// A quadratic at one of equidistant t, with its first and second forward difference.
template <class S>
struct QuadraticState {
  Vec3<S> n, first, second;

  /// To the next t: two additions per component.
  [[nodiscard]] QuadraticState next() const { return {n + first, first + second, second}; }
};

/// v scaled to length 1. Precondition: v is not zero and |v|^2 neither overflows nor underflows.
template <class S>
[[nodiscard]] Vec3<S> normalized(const Vec3<S>& v) {
  using std::sqrt;
  const S scale = S(1) / sqrt(dot(v, v));
  return scale * v;
}

/// The vectors of three neighbouring planes, as control normals of a run are kept.
template <class T>
[[nodiscard]] VectorView<T> three_planes(T* first, std::size_t count) {
  return VectorView<T>::planes(first, first + count, first + 2 * count, count);
}

/// Writes element(i) to every result[i]. Separate loops for the two layouts, so that the compiler can vectorise the one
/// over planes.
template <class Element>
void fill(VectorView<float> result, Element element) {
  if (result.stride == 1) {
    for (std::size_t i = 0; i < result.count; ++i) {
      const Vec3f v = element(i);
      result.x[i] = v.x;
      result.y[i] = v.y;
      result.z[i] = v.z;
    }
  } else {
    for (std::size_t i = 0; i < result.count; ++i) result.set(i, element(i));
  }
}

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_CURVE_ELEMENTS_H_
