/// What a viewer makes of the mesh of a glTF file and its weights: a source of measure.h. Private to workflow.
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

/// A vertex of all parts together, as the file counts.
[[nodiscard]] AuditPlace place_of(const GltfShading& shading, std::size_t vertex);

/// The weights of the targets that are involved in a motion at t of a segment.
using Weights = std::function<void(std::size_t segment, double t, std::span<double> weights)>;
/// The weight or the time that a person finds this by.
using Moment = std::function<double(std::size_t segment, double t)>;

class BlendSource {
 public:
  static constexpr bool kNeedsEnds = false;

  /// shading, truth and part must outlive this, and so must the skin through which the mesh is seen, if there is one;
  /// where its joints move, moment says when. Outputs are those of the part. involved are targets, ascending: weights
  /// are those of them alone, and the others have none at any time. A segment is placed at `samples` moments, one after
  /// the other.
  BlendSource(const GltfShading& shading, const AuthorTruth& truth, const JudgedPart& part, AuditRule rule,
              std::vector<std::size_t> involved, Weights weights, Moment moment, std::size_t samples,
              MeshSkin* skin = nullptr);

  bool place(std::size_t segment, double t, std::span<Vec3d> positions);
  /// Writes the positions at any weights, and leaves the moment that was placed as it is.
  void place_at(std::span<const double> weights, std::span<Vec3d> positions);
  /// The weights of the moment that was placed.
  [[nodiscard]] const std::vector<double>& now() const noexcept { return now_; }
  /// How often place() has placed anything.
  [[nodiscard]] std::size_t placed() const noexcept { return placed_; }
  void forget() { known_ = false; }
  [[nodiscard]] AuditRule rule() const noexcept { return rule_; }
  /// Makes the truths of sums at the moment that was placed, or at any weights: adds what the author added to them.
  void turn(std::span<const Vec3d> positions, std::span<Vec3d> normals) const { turn_at(now_, positions, normals); }
  void turn_at(std::span<const double> weights, std::span<const Vec3d> positions, std::span<Vec3d> normals) const;
  /// Adds up the normals that are shown at the moment that was placed, and finds what the skin does to them.
  void show();
  /// A normal of the i-th output, of any length, as it is seen: carried along by the skin, or else as it is.
  [[nodiscard]] Vec3d seen(std::size_t i, const Vec3d& normal, SkinRule rule = SkinRule::kBlended) const noexcept;
  /// Whether the skin leaves nothing of the right normal, so that no target could show any.
  [[nodiscard]] bool hides(const JudgedOutput& output, const Vec3d& normal, SkinRule rule = SkinRule::kBlended) const;
  [[nodiscard]] const MeshSkin* skin() const noexcept { return skin_; }
  [[nodiscard]] Vec3f shown(const JudgedOutput& output) const;
  [[nodiscard]] Vec3d right(const JudgedOutput& output, const Vec3d& normal, SkinRule rule = SkinRule::kBlended) const;
  [[nodiscard]] AuditPlace at(std::size_t segment, double t, const JudgedOutput& output) const;

 private:
  using Delta = std::pair<std::uint32_t, Vec3f>;
  // Weights and positions at both ends of a segment. Tracks are mostly straight in between, and so are the ways of
  // vertices then, so that the deltas of many targets are added up for the ends alone.
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
  std::vector<AffineTransform> carriers_;  // of outputs, where there is a skin
  std::size_t placed_ = 0;
  std::vector<std::optional<std::vector<Delta>>> moved_;  // of each involved target, once it was asked for
  std::vector<ShownTurn> turns_;                          // of outputs
  std::optional<SegmentEnds> ends_;
  bool known_ = false;
  std::size_t samples_, segment_ = 0;
  double t_ = 0;
  std::vector<double> now_, start_, end_;
  StoredSums sums_;
  std::span<const float> shown_now_, shown_start_, shown_end_;  // (outputs, 3)
};

/// The vertices whose normal some targets move: by a face around them, or by a stored delta. Of the rule flat, their
/// corners.
[[nodiscard]] std::vector<JudgedOutput> moving_outputs(const GltfShading& shading, const AuthorTruth& truth,
                                                       std::span<const std::size_t> involved, AuditRule rule);

/// The part of a mesh that judges some outputs by the truth.
[[nodiscard]] JudgedPart judged_part(const GltfShading& shading, const AuthorTruth& truth,
                                     std::vector<JudgedOutput> outputs, AuditRule rule);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_BLEND_SOURCE_H_
