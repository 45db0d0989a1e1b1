/// The evaluation of BlendNormals. set_weights() computes the data that all elements share at some weights, and
/// evaluate() computes the normals of a range of elements.
#ifndef CHRONORMAL_NORMALS_BLEND_BLEND_CALL_H_
#define CHRONORMAL_NORMALS_BLEND_BLEND_CALL_H_

#include <cstddef>
#include <optional>
#include <span>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"
#include "normals/blend/blend_normals.h"
#include "normals/blend/blend_scratch.h"
#include "normals/blend/blend_storage.h"

namespace chronormal::inline internal {

/// References to the data that an evaluation of blend shapes reads.
struct BlendInput {
  const BlendSet& set;
  const NormalGroups* groups;  ///< nullptr if the elements are faces
  const BlendStorage& storage;
  const BlendBase& base;
  std::optional<BlendPath> forced;
  bool in_float32;  ///< true if the path kWhole works in float32
};

/// Chooses the path of the computation (BlendPath) that takes the least time at some weights. In the pose, sets only
/// the active targets, the elements that they touch, and the elements without stored terms.
BlendChoice choose_path(const BlendInput& input, std::span<const double> weights, BlendPose& pose) noexcept;

/// Sets the weights of a pose: chooses the path of the computation (BlendPath), and computes the data that all elements
/// share at these weights.
BlendChoice set_weights(const BlendInput& input, std::span<const double> weights, BlendPose& pose, Threads threads);

/// Writes the normals of a range of elements, and returns how many elements of this range were recomputed, are zero, or
/// are uncertain. Any thread may call this function. Preconditions: elements.first is a multiple of 64, and `result`
/// has as many elements as the range.
BlendEvaluation evaluate(const BlendInput& input, const BlendPose& pose, IndexRange elements,
                         VectorView<float> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_CALL_H_
