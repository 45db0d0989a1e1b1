#include "chronormal/core/vec3.h"

#include "core/portable_math.h"

namespace chronormal {

double angle_between(const Vec3d& a, const Vec3d& b) noexcept {
  return portable::atan2(length(cross(a, b)), dot(a, b));
}

}  // namespace chronormal
