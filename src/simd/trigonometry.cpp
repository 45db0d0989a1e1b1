#include "simd/trigonometry.h"

#include "simd/trigonometry-inl.h"

namespace chronormal::inline internal {

SinCos<float> sin_cos(float x) noexcept { return HWY_NAMESPACE::sin_cos<float>(x); }

float upper_angle(float y, float x) noexcept { return HWY_NAMESPACE::upper_angle<float>(y, x); }

}  // namespace chronormal::inline internal
