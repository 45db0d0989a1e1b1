#include "workflow/audit/viewer_errors.h"

#include <algorithm>

#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

bool keep_alike(const Viewer& a, const Viewer& b, bool is_skinned) noexcept {
  if (is_skinned && a.skins != b.skins) return false;
  return a.normals == b.normals && a.bits == b.bits && a.by_frame == b.by_frame &&
         a.octahedral_base == b.octahedral_base;
}

// Returns true if a viewer adds up normals in float32 and renders them by the specification. BlendSource has already
// computed the normals of such a viewer.
bool adds_as_specified(const Viewer& viewer, bool is_skinned) noexcept {
  return viewer.normals == NormalRule::kSum && viewer.bits == 32 && (!is_skinned || viewer.skins == SkinRule::kBlended);
}

// The source of an audit with the skin rule of one viewer. It has only those functions of a source (measure.h) that
// error_at() calls.
struct SeenByViewer {
  const BlendSource& source;
  SkinRule rule;

  void right(std::size_t first, std::span<Vec3d> normals) const { source.right(first, normals, rule); }
  [[nodiscard]] bool hides(const JudgedOutput& output, const Vec3d& normal) const {
    return source.hides(output, normal, rule);
  }
  [[nodiscard]] AuditPlace at(std::size_t segment, double t, const JudgedOutput& output) const {
    return source.at(segment, t, output);
  }
};

// Returns the length of the diagonal of the box around the base positions.
double size_of(const GltfShading& shading) noexcept {
  Vec3d low, high;
  for (std::size_t v = 0; v < shading.set.topology.vertex_count(); ++v) {
    const Vec3d p = to_double(vector_at(shading.set.base, v));
    if (v == 0) low = high = p;
    low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
    high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
  }
  return length(high - low);
}

// Returns the largest distance between the positions of the same vertex in two lists.
double largest_distance(std::span<const Vec3d> a, std::span<const Vec3d> b) noexcept {
  double largest = 0;
  for (std::size_t i = 0; i < a.size(); ++i) largest = std::max(largest, length(a[i] - b[i]));
  return largest;
}

}  // namespace

ViewerErrors::ViewerErrors(const GltfShading& shading, const JudgedPart& part, std::span<const Viewer> viewers,
                           std::vector<Weights> weights, std::span<const std::size_t> involved, bool is_skinned)
    : part_(part),
      is_skinned_(is_skinned),
      weights_(std::move(weights)),
      size_(size_of(shading)),
      now_(viewers.size(), std::vector<double>(involved.size())),
      last_(viewers.size()),
      errors_(viewers.size()) {
  for (const Viewer& viewer : viewers) {
    const auto known = std::find_if(kept_.begin(), kept_.end(), [&](const StoredSums& kept) {
      return keep_alike(kept.viewer(), viewer, is_skinned);
    });
    kept_by_.push_back(static_cast<std::size_t>(known - kept_.begin()));
    if (known == kept_.end())
      kept_.emplace_back(shading, part.outputs(), std::vector<std::size_t>(involved.begin(), involved.end()), viewer);
  }
}

void ViewerErrors::add_sample(BlendSource& source, const MeasuredSample& sample) {
  const bool is_still = source.placed() == placed_;
  std::vector<bool> is_judged(weights_.size());
  for (std::size_t h = 0; h < weights_.size(); ++h) {
    std::vector<double> now(now_[h].size());
    weights_[h](sample.segment, sample.t, now);
    is_judged[h] = is_still && now == now_[h];  // true if the error at the last sample is also the error at this sample
    now_[h] = std::move(now);
  }
  placed_ = source.placed();
  for (std::size_t h = 0; h < weights_.size(); ++h) {
    if (is_judged[h]) continue;
    const PlacedPart* where = &sample.placed;
    // For each entry of kept_, the error if it was already measured, or nullptr. Viewers that play the same weights and
    // store normals in the same way render the same normals, so only the first of such viewers is judged.
    std::vector<const MotionError*> of_kept(kept_.size());
    std::optional<SkinRule> is_right_for;  // the rule for which right_ was computed
    double displaced = 0;
    if (now_[h] != source.now()) {
      if (!elsewhere_) elsewhere_.emplace(part_);
      source.place_at(now_[h], elsewhere_->positions);
      part_.normals(elsewhere_->positions, elsewhere_->normals);
      source.turn_at(now_[h], elsewhere_->positions, elsewhere_->normals.elements);
      where = &*elsewhere_;
      if (size_ > 0) displaced = largest_distance(sample.placed.positions, elsewhere_->positions) / size_;
    } else if (source.rule() == AuditRule::kGltf) {
      for (std::size_t k = 0; k < kept_.size(); ++k)
        if (adds_as_specified(kept_[k].viewer(), is_skinned_)) of_kept[k] = &sample.error;
    }
    for (std::size_t other = h; other < weights_.size(); ++other) {
      if (is_judged[other] || now_[other] != now_[h]) continue;
      is_judged[other] = true;
      const MotionError*& known = of_kept[kept_by_[other]];
      if (known != nullptr) {
        last_[other] = {*known, displaced};
        continue;
      }
      StoredSums& kept = kept_[kept_by_[other]];
      const SeenByViewer by_viewer{source, kept.viewer().skins};
      const RightOutputs* right = &sample.right;
      if (where != &sample.placed || (is_skinned_ && by_viewer.rule != SkinRule::kBlended)) {
        if (!is_right_for || (is_skinned_ && *is_right_for != by_viewer.rule))
          find_right(by_viewer, *where, sample.largest, right_);
        is_right_for = by_viewer.rule;
        right = &right_;
      }
      if (kept.find(now_[other]).empty()) kept.add_up(now_and_next(other, sample));
      const std::span<const float> sums = kept.find(now_[other]);
      const auto shown_at = [&](std::size_t first, std::span<Vec3d> normals) {
        kept.shown(sums, first, normals);
        if (is_skinned_)
          for (std::size_t k = 0; k < normals.size(); ++k)
            normals[k] = source.seen(first + k, normals[k], by_viewer.rule);
      };
      last_[other] = {error_at(by_viewer, *where, false, sample.segment, sample.t, shown_at, *right), displaced};
      known = &last_[other].error;
    }
  }
  for (std::size_t h = 0; h < weights_.size(); ++h) {
    errors_[h].error.add(last_[h].error);
    errors_[h].displaced = std::max(errors_[h].displaced, last_[h].displaced);
  }
}

std::vector<std::vector<double>> ViewerErrors::now_and_next(std::size_t viewer, const MeasuredSample& sample) const {
  std::vector<std::vector<double>> result = {now_[viewer]};
  for (const double t : sample.next.first(std::min(sample.next.size(), StoredSums::kAtOnce - 1))) {
    result.push_back(now_[viewer]);
    weights_[viewer](sample.segment, t, result.back());
  }
  return result;
}

}  // namespace chronormal::inline internal
