#include "chronormal/core/vec3.h"

#include "core/portable_math.h"

namespace chronormal {

double angle_between(const Vec3d& a, const Vec3d& b) noexcept {
  // Adding 0.0 turns -0 into 0. The dot product is -0 if one vector is zero and all components of the other are
  // negative.
  return portable::atan2(length(cross(a, b)), dot(a, b) + 0.0);
}

}  // namespace chronormal
