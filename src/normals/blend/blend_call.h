/// One evaluation of BlendNormals.
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

/// Which path the weights take. Leaves the active targets, the touched elements, and those without their terms in the
/// scratch.
BlendChoice choose_path(const BlendInput& input, std::span<const double> weights, BlendScratch& scratch) noexcept;

BlendEvaluation evaluate(const BlendInput& input, std::span<const double> weights, BlendScratch& scratch,
                         VectorView<float> result, Threads threads);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_CALL_H_
