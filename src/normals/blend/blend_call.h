/// Evaluation of BlendNormals: one part is computed once for some weights, the other for each range of elements.
#ifndef CHRONORMAL_NORMALS_BLEND_BLEND_CALL_H_
#define CHRONORMAL_NORMALS_BLEND_BLEND_CALL_H_

#include <cstddef>
#include <optional>
#include <span>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"
#include "chronormal/normals/blend_normals.h"
#include "normals/blend/blend_scratch.h"
#include "normals/blend/blend_storage.h"

namespace chronormal::inline internal {

/// The data that an evaluation reads.
struct BlendInput {
  const BlendSet& set;
  const NormalGroups* groups;  ///< nullptr: the elements are faces
  const BlendStorage& storage;
  const BlendBase& base;
  std::optional<BlendPath> forced;
  bool in_float32;  ///< whether the path kWhole works in float32
};

/// Chooses the path for some weights. Leaves in the pose only the active targets, the touched elements, and the
/// elements without terms.
BlendChoice choose_path(const BlendInput& input, std::span<const double> weights, BlendPose& pose) noexcept;

/// Makes everything that all elements need at these weights.
BlendChoice set_weights(const BlendInput& input, std::span<const double> weights, BlendPose& pose, Threads threads);

/// Writes the normals of a range of elements, and returns the counts of this range. Any thread may call it.
/// elements.first must be a multiple of 64, and `result` must have as many elements as the range
BlendEvaluation evaluate(const BlendInput& input, const BlendPose& pose, IndexRange elements,
                         VectorView<float> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_CALL_H_
