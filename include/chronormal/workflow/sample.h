/// The normals of a motion at chosen moments.
///
/// A moment is
///     a time     of a sequence, in its own seconds; there is no motion before its first and after its last
///     weights    of blend shapes, one for each target: the vertices are at base + sum of w (target - base). They may
///                be negative or more than 1, which extrapolates
///     neither    of a mesh that stands still: one keyframe and no segment
///
/// Area-weighted normals at times are exact: the control normals of a segment are made once and evaluated in float32
/// to 1e-6 rad (normals/normal_curves.h). Other weightings are no polynomials and are computed anew at each time, and so are
/// all normals of weights; both in double, from positions that are not rounded to float32 before.
///
/// Elements   faces, or groups of corners (normals/normal_groups.h); outputs are faces, vertices or corners, and those
///            that show the same element have the same bits.
/// Degenerate An element without a normal has (0, 0, 0). Where n(t) is zero at one time only, area-weighted unit
///            normals at times are the limit (Direction in normals/control_normals.h), and the others (0, 0, 0).
#ifndef CHRONORMAL_WORKFLOW_SAMPLE_H_
#define CHRONORMAL_WORKFLOW_SAMPLE_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "chronormal/workflow/elements.h"

namespace chronormal {

enum class NormalLength {
  kUnit,  ///< 1
  kArea,  ///< n itself: for a face, twice its area; for a vertex or corner, that of the sum
};

struct SampleOptions {
  ElementOptions elements = {ElementKind::kVertices};
  Weighting weighting = Weighting::kArea;
  NormalLength length = NormalLength::kUnit;  ///< kArea for the weighting kArea only
};

/// Whether a pose can have these weights. Errors: kUsage for a motion that is not blend shapes; where there is not one
/// weight for each target, or one that is not finite.
[[nodiscard]] Status check_weights(const Motion& motion, std::span<const double> weights);

/// A mesh at one moment.
struct Pose {
  std::vector<float> positions;  ///< (V, 3)
  std::vector<float> normals;    ///< (elements, 3)
};

class NormalSampler {
 public:
  /// The motion must be valid or stand still, and outlive the sampler.
  /// Errors: of make_groups(); kUsage for faces with another weighting than area, and for the length kArea with one.
  [[nodiscard]] static Result<NormalSampler> make(const Motion& motion, const SampleOptions& options);

  /// The pose at a time. Errors: of find_instant(). Cost: once per segment the control normals, as long as times of one
  /// segment follow each other; all faces anew for weightings other than area.
  [[nodiscard]] Result<Pose> at_time(double time);

  /// The pose of weights. Errors: of check_weights(); kUsage for weights with which a vertex leaves the range of
  /// float32.
  [[nodiscard]] Result<Pose> at_weights(std::span<const double> weights);

  /// The pose of keyframe 0: all there is of a mesh that stands still.
  [[nodiscard]] Pose at_rest() const;

  /// How many faces, vertices or corners there are.
  [[nodiscard]] std::size_t output_count() const noexcept;

  /// The element of each vertex or corner; empty for faces, which are the elements.
  [[nodiscard]] std::span<const std::uint32_t> element_of_output() const noexcept;

  /// The normals of a pose for every output: (outputs, 3).
  [[nodiscard]] std::vector<float> normals_of_outputs(const Pose& pose) const;

 private:
  NormalSampler(const Motion& motion, const SampleOptions& options) : motion_(&motion), options_(options) {}

  [[nodiscard]] bool are_faces() const noexcept { return options_.elements.kind == ElementKind::kFaces; }
  [[nodiscard]] std::size_t element_count() const noexcept;
  // By curves, which are kept for the next moment of the segment.
  [[nodiscard]] std::vector<float> area_normals(const Segment& segment, double t);
  // Anew.
  [[nodiscard]] std::vector<float> weighted_normals(const Segment& segment, double t) const;
  [[nodiscard]] Pose at(const Segment& segment, double t);

  const Motion* motion_;
  SampleOptions options_;
  NormalGroups groups_;                       // but for faces
  NormalCurves curves_;                       // of one segment
  std::optional<std::size_t> curve_segment_;  // which
};

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_H_
