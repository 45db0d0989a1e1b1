/// Unit normals in double, a few at a time: for the elements that float32 cannot carry. What double cannot carry either
/// it hands back.
#ifndef CHRONORMAL_NORMALS_CURVES_KERNELS_FLAGGED_NORMALS_H_
#define CHRONORMAL_NORMALS_CURVES_KERNELS_FLAGGED_NORMALS_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

struct FlaggedNormals {
  ControlNormals normals;
  double certain = 0;  ///< the share of sum w_k max_abs(c_k) above which n(t) has a direction (certificate.h)
};

/// Writes n(t) / |n(t)| rounded to float32, and into `doubtful` the places of those for which n(t) is not certain;
/// returns how many those are.
/// t in [0, 1]; result and doubtful must have as many places as normals
std::size_t flagged_unit_normals(std::span<const FlaggedNormals> normals, double t, std::span<Vec3f> result,
                                 std::span<std::uint32_t> doubtful) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_KERNELS_FLAGGED_NORMALS_H_
