/// Measures how far normals turn if the correction target of a pair is left out, at poses of the file. Private to
/// workflow.
///
/// A pair with the term T turns the normal n(w) of an element by the angle between n(w) and n(w) - weight(w) T. Over
/// all elements and poses only the largest angle counts, and it is below asin(|weight| |T| / |n|): elements are
/// examined in the order of that bound, and most of them never.
///
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_EXACT_PAIR_TURNS_H_
#define CHRONORMAL_WORKFLOW_BAKE_EXACT_PAIR_TURNS_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "workflow/bake/deltas/terms.h"
#include "workflow/bake/poses/tracks.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

/// A pair of targets, or one with itself, and the effect of its correction target.
struct MeasuredPair {
  ExtraWeight extra;  ///< with its gain
  double size = 0;    ///< the largest length of its term, relative to the normals where it is
  double turn = 0;    ///< radians: the largest angle by which leaving it out turns a normal, in the measured poses
};

/// Normals of elements in poses, for as many elements at a time as may be held.
class PosedNormals {
 public:
  struct Normal {
    Vec3d unit;
    double size = 0;
  };

  /// Computes nothing yet. All arguments must outlive this.
  PosedNormals(const GltfShading& shading, const NormalTerms& terms, const PoseList& poses);

  [[nodiscard]] const PoseList& poses() const noexcept { return poses_; }
  /// Returns how many elements are held at once: hold(first) holds [first, first + chunk()).
  [[nodiscard]] std::size_t chunk() const noexcept { return chunk_; }
  /// Computes the normals of elements from `first` on, unless they are held already.
  void hold(std::size_t first);
  /// Returns the normals of one element in all poses.
  [[nodiscard]] std::span<const Normal> of(std::uint32_t element) const {
    return std::span(normals_).subspan((element - first_) * poses_.size(), poses_.size());
  }

 private:
  const GltfShading& shading_;
  const NormalTerms& terms_;
  const PoseList& poses_;
  std::size_t chunk_, first_ = 0;
  std::vector<Normal> normals_;  // (elements, poses)
};

class PairMeter {
 public:
  using Pair = std::pair<std::size_t, std::size_t>;

  /// is_shown tells of each element whether some vertex shows it; largest has the length of its largest term so far.
  /// All arguments must outlive this.
  PairMeter(const GltfShading& shading, const NormalTerms& terms, const PoseList& poses,
            const std::vector<bool>& is_shown, std::vector<double>& largest);

  /// Measures the pairs (i <= j) that have a term at all; `largest` is updated with their terms.
  [[nodiscard]] std::vector<MeasuredPair> measure(std::span<const Pair> pairs);
  /// Returns how far leaving out all of these together turns a normal, in radians.
  [[nodiscard]] double turn_without(std::span<const ExtraWeight> extras);

 private:
  struct Candidate;

  void measure(std::span<Candidate> candidates);
  void look(std::size_t first, std::span<const double> inverse, Candidate& candidate) const;
  [[nodiscard]] bool is_judged(std::uint32_t element, double size) const;

  const GltfShading& shading_;
  const NormalTerms& terms_;
  const std::vector<bool>& is_shown_;
  std::vector<double>& largest_;
  double longest_base_;
  PosedNormals normals_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_EXACT_PAIR_TURNS_H_
