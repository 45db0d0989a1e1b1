/// The positions and normals that a viewer shows for a mesh of a glTF file at given weights, as a source for the loop
/// of the audit (measure.h). Private to workflow.
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

/// Returns the part and the vertex by which messages name a vertex. `vertex` is an index among the vertices of all
/// parts. The result has the index of the part, and the index of the vertex in this part.
[[nodiscard]] AuditPlace place_of(const GltfShading& shading, std::size_t vertex);

/// A function that writes the weights of the involved targets at position t of a segment, with t from 0 to 1.
using Weights = std::function<void(std::size_t segment, double t, std::span<double> weights)>;
/// A function that returns the number by which messages name position t of a segment: a time in seconds, a weight, or
/// the index of a pose.
using Moment = std::function<double(std::size_t segment, double t)>;

class BlendSource {
 public:
  static constexpr bool kNeedsEnds = false;

  /// Creates a source. shading, truth, part, and the skin through which the mesh is seen (if there is one) must outlive
  /// the source. The outputs of the source, which are vertices or corners, are the outputs of the part. If the joints
  /// of the skin move, moment must return the time in seconds. `involved` lists targets in ascending order. `weights`
  /// writes a value for each of these targets, and all other targets always have weight 0. The caller places the source
  /// at `samples` moments of each segment, in ascending order. If joints jump at the end of a segment, their pose
  /// before the jump is used, but after the last of `segments` segments the pose after the jump, which viewers keep
  /// showing.
  BlendSource(const GltfShading& shading, const AuthorTruth& truth, const JudgedPart& part, AuditRule rule,
              std::vector<std::size_t> involved, Weights weights, Moment moment, std::size_t samples,
              MeshSkin* skin = nullptr, std::size_t segments = 1);

  bool place(std::size_t segment, double t, std::span<Vec3d> positions);
  /// Writes the positions of the part at the given weights. Does not change the moment at which the source is placed.
  void place_at(std::span<const double> weights, std::span<Vec3d> positions);
  /// Returns the weights at the moment of the last place().
  [[nodiscard]] const std::vector<double>& now() const noexcept { return now_; }
  /// Returns the number of calls of place() that have changed positions.
  [[nodiscard]] std::size_t placed() const noexcept { return placed_; }
  void forget() { known_ = false; }
  [[nodiscard]] AuditRule rule() const noexcept { return rule_; }
  /// Turn sums of face normals into true normals, at the placed moment or at the given weights. Both functions rotate
  /// each sum as the author's normal is rotated from the normal of the geometry.
  void turn(std::span<const Vec3d> positions, std::span<Vec3d> normals) const { turn_at(now_, positions, normals); }
  void turn_at(std::span<const double> weights, std::span<const Vec3d> positions, std::span<Vec3d> normals) const;
  /// Adds up the stored normals for the moment of the last place() as they are rendered, and finds how the skin
  /// transforms them.
  void show();
  /// Returns a normal of the i-th output as the screen shows it: transformed by the skin, if there is one. The result
  /// may have any length.
  [[nodiscard]] Vec3d seen(std::size_t i, const Vec3d& normal, SkinRule rule = SkinRule::kBlended) const noexcept;
  /// Returns true if the skin collapses the true normal, so that it is seen as zero or as not finite. No target could
  /// correct such a normal.
  [[nodiscard]] bool hides(const JudgedOutput& output, const Vec3d& normal, SkinRule rule = SkinRule::kBlended) const;
  [[nodiscard]] const MeshSkin* skin() const noexcept { return skin_; }
  void shown(std::size_t first, std::span<Vec3d> normals) const;
  void right(std::size_t first, std::span<Vec3d> normals, SkinRule rule = SkinRule::kBlended) const;
  [[nodiscard]] AuditPlace at(std::size_t segment, double t, const JudgedOutput& output) const;

 private:
  using Delta = std::pair<std::uint32_t, Vec3f>;
  // Weights and positions at both ends of a segment. Most tracks of weights are linear between two keyframes, and then
  // vertices move on straight lines. For such tracks, the deltas of many targets need to be added up only at the ends.
  struct SegmentEnds {
    std::size_t segment = 0;
    std::vector<double> start, end;  // the weights of the involved targets at both ends
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
  std::vector<AffineTransform> carriers_;  // the transform of each output by the skin; empty if there is no skin
  std::size_t placed_ = 0;
  // For each involved target, the deltas by which it moves vertices of the part. An entry is nullopt until it is
  // needed.
  std::vector<std::optional<std::vector<Delta>>> moved_;
  std::vector<ShownTurn> turns_;  // for each output, how the author's normal is rotated from the geometry's
  std::optional<SegmentEnds> ends_;
  bool known_ = false;
  std::size_t samples_, segments_, segment_ = 0;
  double t_ = 0;
  std::vector<double> now_, start_, end_;
  StoredSums sums_;
  // The sums of stored normals and their weighted deltas: at the moment of the last place(), and at the start and the
  // end of the segment of this moment. Each sum is an array (outputs, 3).
  std::span<const float> shown_now_, shown_start_, shown_end_;
};

/// Lists the vertices whose normals change with the involved targets, because such a target moves a face around the
/// vertex or has a delta for its stored normal. Leaves out vertices whose faces all have two corners at one place. For
/// the rule flat, lists corners instead of vertices.
[[nodiscard]] std::vector<JudgedOutput> moving_outputs(const GltfShading& shading, const AuthorTruth& truth,
                                                       std::span<const std::size_t> involved, AuditRule rule);

/// Returns the part of a mesh that is needed to judge these outputs: their elements, and the faces around them.
[[nodiscard]] JudgedPart judged_part(const GltfShading& shading, const AuthorTruth& truth,
                                     std::vector<JudgedOutput> outputs, AuditRule rule);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_BLEND_SOURCE_H_
