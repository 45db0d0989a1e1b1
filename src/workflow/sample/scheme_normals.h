/// Computes the normals that a scheme gives for all elements of a segment, at any t or in steps of playback. Private to
/// workflow.
#ifndef CHRONORMAL_WORKFLOW_SAMPLE_SCHEME_NORMALS_H_
#define CHRONORMAL_WORKFLOW_SAMPLE_SCHEME_NORMALS_H_

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/schemes/scheme.h"

namespace chronormal::inline internal {

/// Returns the scheme with this name. Errors: kUsage if no scheme has this name, or if the scheme needs the edges of
/// faces and the elements are not faces.
[[nodiscard]] Result<std::unique_ptr<Scheme>> scheme_for(const std::string& name, ElementKind kind);

/// The target that a segment leads to, and the weight of this target in a pose.
struct TargetWeight {
  std::size_t target = 0;
  double weight = 0;
};

/// Returns the only target that has a weight in a pose, or the first target if all weights are 0. Errors: kUsage if
/// several targets have a weight, or if the weight is outside [0, 1].
[[nodiscard]] Result<TargetWeight> one_target_of(std::span<const double> weights);

class SchemeNormals {
 public:
  /// Prepares the scheme for all elements of a segment, on all cores. groups is nullptr if the elements are faces. A
  /// scheme with this name must exist. The positions, the topology and the groups must outlive the object.
  SchemeNormals(const Segment& segment, const NormalGroups* groups, const std::string& name);
  SchemeNormals(const SchemeNormals&) = delete;
  SchemeNormals& operator=(const SchemeNormals&) = delete;

  /// Writes the unit normals at t in [0, 1]. result must have as many elements as the segment.
  void unit_normals(double t, VectorView<float> result) const;

  /// Writes the unit normals at t = index / steps, as playback reaches them in `index` steps from t = 0. Every
  /// anchor_interval-th step is recomputed from t; if anchor_interval is 0, no step is recomputed. The scheme must have
  /// a sequential form. If index is smaller than in the last call, starts again at t = 0.
  void played_normals(std::size_t index, std::size_t steps, std::size_t anchor_interval, VectorView<float> result);

 private:
  struct Block {
    IndexRange elements;
    std::unique_ptr<Scheme> scheme;
    std::unique_ptr<SchemePlayback> playback;
  };

  Segment segment_;
  std::vector<ControlNormals> control_normals_;
  std::vector<Block> blocks_;
  std::size_t played_ = 0;  // the number of steps that the playbacks have made; 0 if there are no playbacks
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_SCHEME_NORMALS_H_
