/// A source for measure.h: the mesh of a glTF file as a viewer shows it at given weights. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_BLEND_SOURCE_H_
#define CHRONORMAL_WORKFLOW_AUDIT_BLEND_SOURCE_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/workflow/audit.h"
#include "workflow/audit/judged_part.h"
#include "workflow/audit/stored_sums.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/shading/mesh_skin.h"
#include "workflow/truth/author_truth.h"

namespace chronormal::inline internal {

[[nodiscard]] inline Vec3f vector_at(std::span<const float> values, std::size_t i) {
  const float* v = values.data() + 3 * i;
  return {v[0], v[1], v[2]};
}

/// Returns the place of a vertex in words of the file: `vertex` counts through all parts, and the place names the part
/// and the vertex in it.
[[nodiscard]] AuditPlace place_of(const GltfShading& shading, std::size_t vertex);

/// Writes the weights of the targets that are involved in a motion, at t of a segment.
using Weights = std::function<void(std::size_t segment, double t, std::span<double> weights)>;
/// A function that returns the weight or the time by which messages name a moment.
using Moment = std::function<double(std::size_t segment, double t)>;

class BlendSource {
 public:
  static constexpr bool kNeedsEnds = false;

  /// Creates a source. shading, truth, part, and the skin through which the mesh is seen (if there is one) must outlive
  /// it. Outputs are the outputs of the part. If the joints of the skin move, moment must return the time. `involved`
  /// lists targets in ascending order: `weights` has a value for each of them, and all other targets always have weight
  /// 0. Each segment is placed at `samples` moments, one after the other.
  BlendSource(const GltfShading& shading, const AuthorTruth& truth, const JudgedPart& part, AuditRule rule,
              std::vector<std::size_t> involved, Weights weights, Moment moment, std::size_t samples,
              MeshSkin* skin = nullptr);

  bool place(std::size_t segment, double t, std::span<Vec3d> positions);
  /// Writes the positions at any weights. Does not change the placed moment.
  void place_at(std::span<const double> weights, std::span<Vec3d> positions);
  /// Returns the weights of the placed moment.
  [[nodiscard]] const std::vector<double>& now() const noexcept { return now_; }
  /// Counts the calls of place() that changed anything.
  [[nodiscard]] std::size_t placed() const noexcept { return placed_; }
  void forget() { known_ = false; }
  [[nodiscard]] AuditRule rule() const noexcept { return rule_; }
  /// Turn sums of face normals into true normals by adding the author's own offset: at the placed moment, or at any
  /// weights.
  void turn(std::span<const Vec3d> positions, std::span<Vec3d> normals) const { turn_at(now_, positions, normals); }
  void turn_at(std::span<const double> weights, std::span<const Vec3d> positions, std::span<Vec3d> normals) const;
  /// Adds up the rendered normals at the placed moment, and finds how the skin transforms them.
  void show();
  /// Returns a normal of the i-th output as a person sees it, of any length: transformed by the skin, if there is one.
  [[nodiscard]] Vec3d seen(std::size_t i, const Vec3d& normal, SkinRule rule = SkinRule::kBlended) const noexcept;
  /// Returns true if the skin collapses the true normal, so that no target could render it.
  [[nodiscard]] bool hides(const JudgedOutput& output, const Vec3d& normal, SkinRule rule = SkinRule::kBlended) const;
  [[nodiscard]] const MeshSkin* skin() const noexcept { return skin_; }
  void shown(std::size_t first, std::span<Vec3d> normals) const;
  void right(std::size_t first, std::span<Vec3d> normals, SkinRule rule = SkinRule::kBlended) const;
  [[nodiscard]] AuditPlace at(std::size_t segment, double t, const JudgedOutput& output) const;

 private:
  using Delta = std::pair<std::uint32_t, Vec3f>;
  // Weights and positions at both ends of a segment. Most tracks are linear in between, and then vertices move on
  // straight lines. So the deltas of many targets need to be added up only at the ends.
  struct SegmentEnds {
    std::size_t segment = 0;
    std::vector<double> start, end;  // weights
    std::vector<Vec3d> from, to;
  };

  [[nodiscard]] std::vector<double> weights(std::size_t segment, double t) const;
  void place_ends(std::size_t segment);
  [[nodiscard]] bool is_between_ends(double t) const;
  void place_base(std::span<Vec3d> positions) const;
  const std::vector<Delta>& moved(std::size_t k);
  [[nodiscard]] std::size_t number(const JudgedOutput& output) const;
  [[nodiscard]] std::vector<std::vector<double>> now_and_next() const;

  const GltfShading& shading_;
  const AuthorTruth& truth_;
  const JudgedPart& part_;
  AuditRule rule_;
  std::vector<std::size_t> involved_;
  Weights weights_at_;
  Moment moment_;
  MeshSkin* skin_;
  std::vector<AffineTransform> carriers_;  // one transform for each output, if there is a skin
  std::size_t placed_ = 0;
  std::vector<std::optional<std::vector<Delta>>> moved_;  // deltas of each involved target, once requested
  std::vector<ShownTurn> turns_;                          // turns of outputs
  std::optional<SegmentEnds> ends_;
  bool known_ = false;
  std::size_t samples_, segment_ = 0;
  double t_ = 0;
  std::vector<double> now_, start_, end_;
  StoredSums sums_;
  std::span<const float> shown_now_, shown_start_, shown_end_;  // sums at the moment and both ends, (outputs, 3)
};

/// Finds the vertices whose normals some of the targets change, by moving a face around the vertex or by a stored
/// delta. For the rule flat, finds corners instead of vertices.
[[nodiscard]] std::vector<JudgedOutput> moving_outputs(const GltfShading& shading, const AuthorTruth& truth,
                                                       std::span<const std::size_t> involved, AuditRule rule);

/// Makes the part of a mesh that has these outputs, for an audit.
[[nodiscard]] JudgedPart judged_part(const GltfShading& shading, const AuthorTruth& truth,
                                     std::vector<JudgedOutput> outputs, AuditRule rule);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_BLEND_SOURCE_H_
