/// Memory of BlendNormals in addition to its terms: the normals of the base, and data at some weights that all elements
/// share.
#ifndef CHRONORMAL_NORMALS_BLEND_BLEND_SCRATCH_H_
#define CHRONORMAL_NORMALS_BLEND_BLEND_SCRATCH_H_

#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/blend_normals.h"
#include "core/memory.h"
#include "normals/blend/index_bits.h"

namespace chronormal::inline internal {

class BlendTerms;

struct BlendShape {
  std::size_t elements = 0, vertices = 0, targets = 0, large_faces = 0;
  bool in_float32 = false;  ///< whether points are also blended in float32
};

struct BlendBase {
  std::vector<double> sums;  ///< n_b and its bound in the unit of blend_storage.h: four numbers for each element
  std::vector<float> units;  ///< unit normals, three numbers for each element
  IndexBits zeros;           ///< elements whose unit normal is (0, 0, 0)
  double reach = 0;          ///< the largest absolute coordinate
};

[[nodiscard]] BlendBase make_blend_base(const BlendSet& set, const BlendTerms& terms);
[[nodiscard]] std::size_t base_bytes(const BlendShape& shape) noexcept;

/// The normal of a face at some weights, and a bound of its error.
struct BlendedFace {
  Vec3d normal;
  double noise = 0;
};

/// The current weights, and the points that they move.
struct BlendPose {
  BlendPose(const BlendSet& set, const BlendShape& shape);

  BlendChoice choice;
  std::vector<double> weights;
  double point_noise = 0;             ///< bound of the error of a point
  bool has_points = false;            ///< whether points are at the weights; otherwise they are at the base
  std::vector<BlendedFace> large;     ///< large_faces() of the storage, if has_points
  std::vector<double> points;         ///< rows of vertices
  AlignedArray<float> float_points;   ///< rows of vertices in float32; empty if not requested
  IndexBits touched;                  ///< elements that active targets touch
  IndexBits again;                    ///< elements that are computed from positions
  std::vector<std::uint32_t> active;  ///< targets
  std::vector<bool> is_active;
};

[[nodiscard]] std::size_t pose_bytes(const BlendShape& shape) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_SCRATCH_H_
