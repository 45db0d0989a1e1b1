/// The memory of BlendNormals besides its terms: the normals of the base, and the data that all elements share at some
/// weights.
#ifndef CHRONORMAL_NORMALS_BLEND_BLEND_SCRATCH_H_
#define CHRONORMAL_NORMALS_BLEND_BLEND_SCRATCH_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "core/memory.h"
#include "normals/blend/blend_normals.h"
#include "normals/blend/index_bits.h"

namespace chronormal::inline internal {

class BlendTerms;

struct BlendShape {
  std::size_t elements = 0, vertices = 0, targets = 0, large_faces = 0;
  bool in_float32 = false;  ///< true if points are also blended in float32
};

struct BlendBase {
  std::vector<double> sums;  ///< n_b and its error bound, in the unit of blend_storage.h; four numbers for each element
  std::vector<float> units;  ///< unit normals, three numbers for each element
  IndexBits zeros;           ///< elements whose unit normal in the base is (0, 0, 0)
  double reach = 0;          ///< the largest absolute coordinate of the base
};

[[nodiscard]] BlendBase make_blend_base(const BlendSet& set, const BlendTerms& terms);
[[nodiscard]] std::size_t base_bytes(const BlendShape& shape) noexcept;

/// The normal of a face at some weights, and a bound of its error.
struct BlendedFace {
  Vec3d normal;
  double noise = 0;
};

/// The current weights, and the points of the mesh at these weights.
struct BlendPose {
  BlendPose(const BlendSet& set, const BlendShape& shape);

  BlendChoice choice;
  std::vector<double> weights;
  double point_noise = 0;  ///< bound of the error of a point, in units of length
  /// True if `points` are the points of the mesh at the weights, false if they are the points of the base.
  bool has_points = false;
  std::vector<BlendedFace> large;     ///< the normals of the storage's large_faces(), if has_points is true
  std::vector<double> points;         ///< x, y, z and 0 for each vertex
  AlignedArray<float> float_points;   ///< x, y, z and 0 in float32 for each vertex; empty if not requested
  IndexBits touched;                  ///< elements that active targets touch
  IndexBits again;                    ///< elements that are computed from points
  std::vector<std::uint32_t> active;  ///< numbers of the targets with nonzero weights
  std::vector<bool> is_active;
};

[[nodiscard]] std::size_t pose_bytes(const BlendShape& shape) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_SCRATCH_H_
