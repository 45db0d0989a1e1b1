/// Measures the angles by which normals turn if the correction target of a pair of targets is left out, in poses of the
/// file. Private to workflow.
///
/// A pair with the term T turns the normal n(w) of an element by the angle between n(w) and n(w) - weight(w) T. Only
/// the largest angle over all elements and poses is needed. An angle is at most asin(|weight| |T| / |n|). Elements are
/// examined from the largest such bound down, so that most elements need not be examined.
///
/// Threads    Uses all cores. The results have the same bits on any number of cores.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_PAIR_TURNS_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_PAIR_TURNS_H_

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

/// A pair of two targets, or of one target with itself, and how its correction target turns normals.
struct MeasuredPair {
  ExtraWeight extra;  ///< the weight of the correction target, with its gain
  double size = 0;    ///< the largest length of the pair's term, relative to the normal of the element
  double turn = 0;    ///< radians: the largest turn of a normal without the pair, in the measured poses
};

/// The normals of elements in poses. Only the normals of a limited number of elements are in memory at a time.
class PosedNormals {
 public:
  struct Normal {
    Vec3d unit;
    double size = 0;
  };

  /// Creates an object that has no normals yet. All arguments must outlive the object.
  PosedNormals(const GltfShading& shading, const NormalTerms& terms, const PoseList& poses);

  [[nodiscard]] const PoseList& poses() const noexcept { return poses_; }
  /// Returns the number of elements whose normals are in memory at a time. hold(first) computes the normals of chunk()
  /// elements, from element `first` on.
  [[nodiscard]] std::size_t chunk() const noexcept { return chunk_; }
  /// Computes the normals of chunk() elements from `first` on, in all poses, unless they are in memory already.
  void hold(std::size_t first);
  /// Returns the normals of one element in all poses. The element must be in memory.
  [[nodiscard]] std::span<const Normal> of(std::uint32_t element) const {
    return std::span(normals_).subspan((element - first_) * poses_.size(), poses_.size());
  }

 private:
  const GltfShading& shading_;
  const NormalTerms& terms_;
  const PoseList& poses_;
  std::size_t chunk_, first_ = 0;
  std::vector<Normal> normals_;  // (elements, poses), the normals of the elements from first_ on
};

class PairMeter {
 public:
  using Pair = std::pair<std::size_t, std::size_t>;

  /// Creates a meter. is_shown tells for each element if some vertex shows it. `largest` has the length of the largest
  /// term that is known for each element. All arguments must outlive this object.
  PairMeter(const GltfShading& shading, const NormalTerms& terms, const PoseList& poses,
            const std::vector<bool>& is_shown, std::vector<double>& largest);

  /// Measures pairs (i, j) with i <= j, and leaves out pairs that have no term. If a term of a pair is longer than the
  /// entry of its element in `largest`, raises this entry to the length of the term.
  [[nodiscard]] std::vector<MeasuredPair> measure(std::span<const Pair> pairs);
  /// Returns the largest angle in radians by which a normal turns if all of these correction targets are left out.
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

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_PAIR_TURNS_H_
