/// Measures the error that a skin adds. The skin turns even true normals away from the normals of the skinned surface,
/// and no morph target can correct this error. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_SKINNING_ERROR_H_
#define CHRONORMAL_WORKFLOW_AUDIT_SKINNING_ERROR_H_

#include <cstddef>

#include "chronormal/workflow/audit.h"
#include "workflow/audit/blend_source.h"
#include "workflow/audit/measure.h"

namespace chronormal::inline internal {

class SkinningErrors {
 public:
  /// Measures the error of the skin at the moment at which the source is placed. Compares the true normal n(w),
  /// transformed by the skin and without the author's offset, with the sum of face normals of the skinned positions.
  /// Mirrored faces keep their outer side. Skips a vertex if |n(w)| is below kVanished times its largest length, or if
  /// the face normals of the skinned surface nearly cancel.
  void add_sample(const BlendSource& source, const MeasuredSample& sample);

  /// Returns the error over all samples that were added, or nothing if the source has no skin.
  [[nodiscard]] const std::optional<SkinningError>& all() const noexcept { return all_; }

 private:
  std::size_t placed_ = 0;  // source.placed() at the last sample
  SkinningError last_;      // the error at the last sample
  std::optional<SkinningError> all_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_SKINNING_ERROR_H_
