/// Judges the normals that viewers render, at the same samples as the audit by the specification. Private to workflow.
///
/// Viewers that play the same weights have the same positions and true normals, which are computed once. If they also
/// store normals and deltas in the same way, they render the same normals.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_VIEWER_ERRORS_H_
#define CHRONORMAL_WORKFLOW_AUDIT_VIEWER_ERRORS_H_

#include <cstddef>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/viewers.h"
#include "workflow/audit/blend_source.h"
#include "workflow/audit/measure.h"
#include "workflow/audit/stored_sums.h"

namespace chronormal::inline internal {

/// The error of a viewer in one subject of the audit.
struct ViewerError {
  MotionError error;
  double displaced = 0;  ///< as in ViewerAudit
};

class ViewerErrors {
 public:
  /// Creates the object. `weights` has a function for each viewer, which writes the weights that this viewer plays for
  /// the involved targets. shading and part must outlive the object. is_skinned is true if a skin moves the part, since
  /// viewers apply skins in different ways.
  ViewerErrors(const GltfShading& shading, const JudgedPart& part, std::span<const Viewer> viewers,
               std::vector<Weights> weights, std::span<const std::size_t> involved, bool is_skinned = false);

  /// Measures the error in every viewer at the moment at which the source is placed. A viewer that renders the same
  /// normals as the source gets the error of the source.
  void add_sample(BlendSource& source, const MeasuredSample& sample);

  /// Returns the weights that each viewer played at the last sample.
  [[nodiscard]] std::span<const std::vector<double>> now() const noexcept { return now_; }

  /// Moves the errors of all viewers out of the object.
  [[nodiscard]] std::vector<ViewerError> take() { return std::move(errors_); }

 private:
  // Returns the weights that a viewer plays at a sample, and at the samples that follow in its segment.
  [[nodiscard]] std::vector<std::vector<double>> now_and_next(std::size_t viewer, const MeasuredSample& sample) const;

  const JudgedPart& part_;
  bool is_skinned_;
  std::vector<Weights> weights_;
  // The sums of stored normals and deltas: one entry for each way in which viewers store normals and deltas.
  std::vector<StoredSums> kept_;
  std::vector<std::size_t> kept_by_;        // for each viewer, its index in kept_
  RightOutputs right_;                      // true normals of outputs, as viewers with another skin rule show them
  double size_ = 0;                         // the diagonal of the box around the mesh at rest
  std::optional<PlacedPart> elsewhere_;     // the part at weights other than the specified ones; empty until needed
  std::size_t placed_ = 0;                  // source.placed() at the last sample; 0 before the first
  std::vector<std::vector<double>> now_;    // for each viewer, the weights of the last sample
  std::vector<ViewerError> last_, errors_;  // one for each viewer: at the last sample, and over all samples
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_VIEWER_ERRORS_H_
