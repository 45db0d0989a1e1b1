#include "normals/blend/blend_scratch.h"

#include <algorithm>
#include <cmath>

#include "core/rounding.h"
#include "normals/blend/blend_storage.h"
#include "normals/blend/blend_terms.h"
#include "normals/blend/kernels/blend_rows.h"

namespace chronormal::inline internal {
namespace {

std::size_t bits_bytes(std::size_t count) { return words_of(count) * sizeof(std::uint64_t); }

}  // namespace

BlendBase make_blend_base(const BlendSet& set, const BlendTerms& terms) {
  BlendBase base;
  const std::size_t count = terms.size();
  base.sums.resize(kBlendLanes * count);
  base.units.resize(3 * count);
  base.zeros = IndexBits(count);
  const BlendTerm normals = terms.base_term();
  for (std::size_t e = 0; e < count; ++e) {
    const Vec3d n = normals.values[e];
    double* const sum = base.sums.data() + kBlendLanes * e;
    sum[0] = n.x, sum[1] = n.y, sum[2] = n.z, sum[3] = normals.noise[e] / kFloatUnitRoundoff;
    const Vec3f u = to_float(unit(n));
    float* const to = base.units.data() + 3 * e;
    to[0] = u.x, to[1] = u.y, to[2] = u.z;
    if (n == Vec3d{}) base.zeros.set(e);
  }
  for (const float coordinate : set.base) base.reach = std::max(base.reach, std::fabs(static_cast<double>(coordinate)));
  return base;
}

std::size_t base_bytes(const BlendShape& shape) noexcept {
  return shape.elements * (kBlendLanes * sizeof(double) + 3 * sizeof(float)) + bits_bytes(shape.elements);
}

BlendPose::BlendPose(const BlendSet& set, const BlendShape& shape)
    : weights(shape.targets),
      large(shape.large_faces),
      points(kBlendLanes * shape.vertices),
      float_points(shape.in_float32 ? kBlendLanes * shape.vertices : 0),
      touched(shape.elements),
      again(shape.elements),
      is_active(shape.targets) {
  active.reserve(shape.targets);
  reset_points(set.base, {0, shape.vertices}, points.data());
}

std::size_t pose_bytes(const BlendShape& shape) noexcept {
  const std::size_t in_float32 = shape.in_float32 ? kBlendLanes * shape.vertices * sizeof(float) : 0;
  return in_float32 + (kBlendLanes * shape.vertices + shape.targets) * sizeof(double) + 2 * bits_bytes(shape.elements) +
         shape.large_faces * sizeof(BlendedFace) + shape.targets * sizeof(std::uint32_t) + bits_bytes(shape.targets);
}

}  // namespace chronormal::inline internal
