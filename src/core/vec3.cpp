#include "chronormal/core/vec3.h"

#include "core/portable_math.h"

namespace chronormal {

double angle_between(const Vec3d& a, const Vec3d& b) noexcept {
  // 0.0 turns -0, which a zero vector gives beside one whose components are all negative, into 0.
  return portable::atan2(length(cross(a, b)), dot(a, b) + 0.0);
}

}  // namespace chronormal
