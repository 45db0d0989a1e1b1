/// Sine, cosine and arc tangent in float32, from plain arithmetic.
///
/// The standard library's differ from machine to machine in the last bit; these give the same bits everywhere, have
/// no branch, and inline into loops. Polynomials: interpolation at Chebyshev nodes (own fit).
#ifndef CHRONORMAL_CORE_TRIGONOMETRY_H_
#define CHRONORMAL_CORE_TRIGONOMETRY_H_

namespace chronormal {

template <class S>
struct SinCos {
  S sin, cos;
};

/// Sine and cosine of x. Error below 1.2e-7 for |x| <= 8, the arcs that schemes need.
[[nodiscard]] inline SinCos<float> sin_cos(float x) noexcept {
  // Bring x to r in [-pi/4, pi/4] with x = quarter * pi/2 + r; pi/2 in three parts keeps r exact to its last bits.
  const float scaled = x * 0.636619772f;
  const int quarter = static_cast<int>(scaled + (scaled < 0 ? -0.5f : 0.5f));
  const float q = static_cast<float>(quarter);
  const float r = ((x - q * 1.5703125f) - q * 4.8375129699707e-4f) - q * 7.5497899548e-8f;

  const float z = r * r;
  const float s = r + r * z * (-0.16666664662f + z * (0.00833274827f + z * -0.00019587891f));
  const float c = 1.0f - 0.5f * z + z * z * (0.04166666466f + z * (-0.00138883030f + z * 2.454794e-5f));

  const bool swap = (quarter & 1) != 0;
  const float sin_sign = (quarter & 2) != 0 ? -1.0f : 1.0f;
  const float cos_sign = ((quarter + 1) & 2) != 0 ? -1.0f : 1.0f;
  return {sin_sign * (swap ? c : s), cos_sign * (swap ? s : c)};
}

/// The angle of the vector (x, y) with y >= 0, in [0, pi]; 0 for the zero vector. Error below 3e-7.
[[nodiscard]] inline float upper_angle(float y, float x) noexcept {
  // atan of a quotient in [0, 1], folded once more at tan(pi/8), then unfolded by octant.
  const float ax = x < 0 ? -x : x;
  const float larger = y > ax ? y : ax, smaller = y > ax ? ax : y;
  const bool fold = smaller > 0.41421357f * larger;
  const float numerator = fold ? smaller - larger : smaller;
  const float denominator = fold ? smaller + larger : larger;
  const float r = numerator / (denominator > 0 ? denominator : 1.0f);

  const float z = r * r;
  const float polynomial =
      r +
      r * z * (-0.3333333176f + z * (0.1999954048f + z * (-0.1426395560f + z * (0.1074373147f + z * -0.0645192816f))));
  const float octant = fold ? polynomial + 0.785398163f : polynomial;
  const float quadrant = y > ax ? 1.570796327f - octant : octant;
  return x < 0 ? 3.141592654f - quadrant : quadrant;
}

}  // namespace chronormal

#endif  // CHRONORMAL_CORE_TRIGONOMETRY_H_
