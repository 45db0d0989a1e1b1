/// What BlendNormals keeps beside its terms: normals of the base, and what is the same for all elements at some
/// weights.
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
  bool in_float32 = false;  ///< whether points are blended in float32, too
};

struct BlendBase {
  std::vector<double> sums;  ///< n_b, and its bound in the unit of blend_storage.h: four for each element
  std::vector<float> units;  ///< of length 1, three for each element
  IndexBits zeros;           ///< elements whose unit is (0, 0, 0)
  double reach = 0;          ///< the largest absolute coordinate
};

[[nodiscard]] BlendBase make_blend_base(const BlendSet& set, const BlendTerms& terms);
[[nodiscard]] std::size_t base_bytes(const BlendShape& shape) noexcept;

/// The normal of a face at some weights, and how far it may be off.
struct BlendedFace {
  Vec3d normal;
  double noise = 0;
};

/// The weights that are set, and what they move.
struct BlendPose {
  BlendPose(const BlendSet& set, const BlendShape& shape);

  BlendChoice choice;
  std::vector<double> weights;
  double point_noise = 0;             ///< what a point may be off by
  bool has_points = false;            ///< whether points are those of the weights; else they are those of the base
  std::vector<BlendedFace> large;     ///< large_faces() of the storage, if has_points
  std::vector<double> points;         ///< rows of vertices
  AlignedArray<float> float_points;   ///< rows of vertices in float32; empty where nobody asks for them
  IndexBits touched;                  ///< elements that active targets touch
  IndexBits again;                    ///< elements that are made from positions
  std::vector<std::uint32_t> active;  ///< targets
  std::vector<bool> is_active;
};

[[nodiscard]] std::size_t pose_bytes(const BlendShape& shape) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_SCRATCH_H_
