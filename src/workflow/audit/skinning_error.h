/// How far the skin itself turns right normals from those of the surface that it makes, which no target can mend. Private
/// to workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_SKINNING_ERROR_H_
#define CHRONORMAL_WORKFLOW_AUDIT_SKINNING_ERROR_H_

#include <cstddef>

#include "chronormal/workflow/audit.h"
#include "workflow/audit/blend_source.h"
#include "workflow/audit/measure.h"

namespace chronormal::inline internal {

class SkinningErrors {
 public:
  /// Judges a sample that the source has placed: n(w) as the skin carries it, without a turn of the author's, against
  /// the same sum over the faces of the skinned positions. Mirrored faces keep their outer side. Pairs are left out where
  /// n(w), or what is left of it beside its size, is below kVanished of the largest.
  void add_sample(const BlendSource& source, const MeasuredSample& sample);

  /// Nothing where the source has no skin.
  [[nodiscard]] const std::optional<SkinningError>& all() const noexcept { return all_; }

 private:
  std::size_t placed_ = 0;  // as source.placed() was at the last sample
  SkinningError last_;      // of that
  std::optional<SkinningError> all_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_SKINNING_ERROR_H_
