/// Measures the error that the skin itself adds to true normals, compared with the surface that it makes. No target can
/// correct it. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_SKINNING_ERROR_H_
#define CHRONORMAL_WORKFLOW_AUDIT_SKINNING_ERROR_H_

#include <cstddef>

#include "chronormal/workflow/audit.h"
#include "workflow/audit/blend_source.h"
#include "workflow/audit/measure.h"

namespace chronormal::inline internal {

class SkinningErrors {
 public:
  /// Judges a sample that the source has placed: compares n(w), transformed by the skin and without the author's
  /// offset, with the sum over the faces of the skinned positions. Mirrored faces keep their outer side. A sample is
  /// left out if n(w), or its remainder relative to its size, is below kVanished of the largest.
  void add_sample(const BlendSource& source, const MeasuredSample& sample);

  /// Returns nothing if the source has no skin.
  [[nodiscard]] const std::optional<SkinningError>& all() const noexcept { return all_; }

 private:
  std::size_t placed_ = 0;  // source.placed() at the last sample
  SkinningError last_;      // the error of that sample
  std::optional<SkinningError> all_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_SKINNING_ERROR_H_
