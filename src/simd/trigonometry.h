/// Computes sine, cosine and arc tangent in float32, by plain arithmetic.
///
/// The results of the standard library differ from machine to machine in the last bit. The functions here give the same
/// bits everywhere and have no branch. src/simd/trigonometry-inl.h has the same formulas for vectors of lanes, with the
/// same bits. The polynomials were fitted for this project, by interpolation at Chebyshev nodes.
#ifndef CHRONORMAL_SIMD_TRIGONOMETRY_H_
#define CHRONORMAL_SIMD_TRIGONOMETRY_H_

namespace chronormal::inline internal {

template <class S>
struct SinCos {
  S sin, cos;
};

/// Returns the sine and the cosine of x, which is in radians. The error is below 1.2e-7 for |x| <= 8, which covers the
/// arcs that schemes need.
[[nodiscard]] SinCos<float> sin_cos(float x) noexcept;

/// Returns the angle in radians of the vector (x, y) with y >= 0, in [0, pi]. The angle of the zero vector is 0. The
/// error is below 3e-7.
[[nodiscard]] float upper_angle(float y, float x) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SIMD_TRIGONOMETRY_H_
