#include "core/float32.h"

namespace chronormal::inline internal {

double rounded_to_float(double value) noexcept {
  const volatile float kept = static_cast<float>(value);
  return double{kept};
}

Vec3d rounded_to_float(const Vec3d& vector) noexcept {
  return {rounded_to_float(vector.x), rounded_to_float(vector.y), rounded_to_float(vector.z)};
}

}  // namespace chronormal::inline internal
