/// Adds up the normals that a viewer renders in many poses at once, and compares them with the true normals, in lanes
/// of float.
///
/// All functions return the same bits as the functions that compute one pose at a time: terms are added in their order,
/// and angles are those of portable::atan2().
#ifndef CHRONORMAL_ANALYSIS_QUALITY_KERNELS_BLENDED_NORMALS_H_
#define CHRONORMAL_ANALYSIS_QUALITY_KERNELS_BLENDED_NORMALS_H_

#include <array>
#include <cstddef>
#include <span>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// The padding of planes of sums and weights. The size of such a plane is a multiple of this number of poses, which is
/// the number of floats in the widest SIMD vector.
inline constexpr std::size_t kPosePadding = 16;

/// A finite vector, and its weight in each pose. The weights are zero outside [first, end).
struct WeightedVector {
  const float* weights = nullptr;  ///< a weight for each pose, padded to a multiple of kPosePadding
  std::size_t first = 0, end = 0;
  Vec3f vector;
};

/// Writes base + the sum of weight times vector over all terms, as three planes of `stride` floats. The stride is a
/// multiple of kPosePadding, and each list of weights has `stride` floats.
void add_weighted(const Vec3f& base, std::span<const WeightedVector> terms, float* sums, std::size_t stride) noexcept;

/// Compares rendered normals of any length with the true unit normals in as many poses as `degrees` has. Both are given
/// as planes of x, y and z, and (0, 0, 0) stands for an unknown true normal. Writes
///
///     degrees   the angles; 180 for a normal that cannot be lit, -1 where no true normal is known
///     errors    as planes, the rendered minus the true unit normal; minus twice the true normal if the rendered normal
///               cannot be lit, NaN where no true normal is known
///
/// Returns the largest length of an error.
[[nodiscard]] float compare_normals(const std::array<const float*, 3>& rendered,
                                    const std::array<const float*, 3>& right, std::span<float> degrees,
                                    const std::array<float*, 3>& errors) noexcept;

/// Returns the largest openness of pairs of vectors, which are given as planes. Openness is a number that grows with
/// the angle between two vectors. Openness is the squared sine up to a right angle, 2 minus the squared sine beyond,
/// and 0 if one of the vectors is zero. All planes have a multiple of kPosePadding finite floats.
[[nodiscard]] float largest_openness(const std::array<const float*, 3>& a, const std::array<const float*, 3>& b,
                                     std::size_t count) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_KERNELS_BLENDED_NORMALS_H_
