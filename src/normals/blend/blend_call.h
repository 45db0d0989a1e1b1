/// Evaluation of BlendNormals: what is done once for some weights, and what is done for each range of elements.
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

/// What an evaluation reads.
struct BlendInput {
  const BlendSet& set;
  const NormalGroups* groups;  ///< nothing: faces
  const BlendStorage& storage;
  const BlendBase& base;
  std::optional<BlendPath> forced;
  bool in_float32;  ///< whether the path kWhole is one in float32
};

/// Chooses the path of some weights. Leaves the active targets, the touched elements, and those without their terms in
/// the pose, and nothing else.
BlendChoice choose_path(const BlendInput& input, std::span<const double> weights, BlendPose& pose) noexcept;

/// Makes everything that all elements need at these weights.
BlendChoice set_weights(const BlendInput& input, std::span<const double> weights, BlendPose& pose, Threads threads);

/// Writes the normals of a range of elements; what the evaluation counts is that of the range. Any thread may do this.
/// elements.first must be a multiple of 64, result must have as many as the range
BlendEvaluation evaluate(const BlendInput& input, const BlendPose& pose, IndexRange elements,
                         VectorView<float> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_CALL_H_
