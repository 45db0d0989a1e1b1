/// Exact unit normals of blend shapes at any weights.
///
/// Engines add one normal delta per target, but the normal is a quadratic form in the weights (blend_terms.h): each
/// target has a linear and a square term, and two targets that move the same face have a common term. BlendNormals
/// stores these terms sparsely, and adds up the terms of the active targets; an element that no active target touches
/// keeps its base normal.
///
///     BlendNormals normals = BlendNormals::of_groups(set, groups);
///     const BlendEvaluation done = normals.unit_normals(weights, VectorView<float>::packed(xyz, normals.size()));
///     // done.path is the method, done.touched_elements the part of the mesh that was computed
///
/// Paths      If many targets overlap, recomputing normals from blended positions is cheaper, either for the touched
///            part or for the whole mesh. The cheapest path is chosen for each weight vector by a model of the costs,
///            which is a pure function of the set, the weights and the options. Its constants were measured on one core
///            of a machine in docs/benchmarks.md; only their ratios matter.
/// Speed      normals are recomputed in lanes of double, along rings of points around elements. If the lanes cannot
///            guarantee 1e-6 rad for an element, or if its ring has more than 64 points, the element is computed
///            separately, which takes about eight times as long.
/// Memory     Known in advance (predict_blend_cost()), and limited by max_bytes: if not all terms fit, the largest are
///            not kept, and their elements are computed from blended positions.
/// Accuracy   Within 1e-6 rad of the normals of the blended positions in exact arithmetic, on every path (except with
///            BlendNormalsOptions::in_float32). Terms are stored in float32, each with an error bound; an element whose
///            n(w) is small relative to the sum of its terms is computed in double from blended positions. If even
///            double cannot guarantee 1e-6 rad, the element is counted as uncertain.
/// Degenerate if n(w) is below its own rounding error, or an element has no faces, the result is (0, 0, 0), which is
/// counted. Weights that are not finite, or so large that n(w) overflows, give (0, 0, 0) at least for the elements that
/// they affect.
/// Ownership  the set and the groups are moved in and kept. A moved-from object may only be destroyed or assigned.
/// Threads    const functions may run at the same time. The same bits on any number of threads, in ranges of any size,
///            and on every instruction set.
#ifndef CHRONORMAL_NORMALS_BLEND_NORMALS_H_
#define CHRONORMAL_NORMALS_BLEND_NORMALS_H_

#include <cstddef>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

enum class BlendPath {
  kTerms,    ///< the terms of the active targets, for the elements that these targets touch
  kTouched,  ///< blended positions, and rings around these elements
  kWhole,    ///< blended positions, and rings around all elements
};

/// Returns "terms", "touched" or "whole".
[[nodiscard]] std::string_view name_of(BlendPath path) noexcept;

/// The default limit, a gigabyte. The terms of many dense targets take more, but then another path than kTerms is
/// usually cheaper.
inline constexpr std::size_t kUsualBlendBytes = std::size_t{1} << 30;

struct BlendNormalsOptions {
  /// The limit of BlendCost::bytes. It does not apply to the memory that is needed even without terms (least_bytes).
  std::size_t max_bytes = kUsualBlendBytes;
  /// Always takes this path, whatever its cost.
  std::optional<BlendPath> forced = {};
  /// On the path kWhole, blends positions and computes normals in float32, like FloatRecompute. This takes about half
  /// as long, so kWhole is chosen more often, but there is no guarantee: positions are wrong by a unit in the last
  /// place, which turns a normal by the ratio of that unit to an edge. This is enough for shading; the other paths are
  /// still exact. The option has no effect if an element has a ring of more than 64 points.
  bool in_float32 = false;
};

/// The cost of the normals of a set, computed from counts alone. Bytes are in addition to the set and the groups.
struct BlendCost {
  std::size_t target_elements = 0;    ///< elements that a target touches, summed over targets
  std::size_t overlapping_pairs = 0;  ///< pairs of targets that move a face in common
  std::size_t pair_elements = 0;      ///< elements of these faces, summed over pairs
  std::size_t stored_targets = 0;     ///< targets whose terms fit into max_bytes; small ones come first
  std::size_t stored_pairs = 0;       ///< pairs of stored targets whose terms fit; small ones come first
  std::size_t least_bytes = 0;        ///< bytes kept without any terms: base normals, lists, rings, scratch
  std::size_t bytes = 0;              ///< bytes kept with the stored terms, at most
  std::size_t peak_bytes = 0;         ///< bytes while terms are computed, at most

  friend bool operator==(const BlendCost&, const BlendCost&) = default;
};

/// Predicts the cost from the faces of each target and the rings around elements, without computing terms. Pure. The
/// set must be valid, and groups must be groups of its topology that keep their corners.
[[nodiscard]] BlendCost predict_blend_cost(const BlendSet& set, const BlendNormalsOptions& options = {});
[[nodiscard]] BlendCost predict_blend_cost(const BlendSet& set, const NormalGroups& groups,
                                           const BlendNormalsOptions& options = {});

/// The path for some weights, and the expected costs by which it was chosen.
struct BlendChoice {
  BlendPath path = BlendPath::kTerms;
  std::size_t active_targets = 0;    ///< targets with nonzero weights
  std::size_t touched_elements = 0;  ///< elements with a face that an active target moves
  /// Touched elements with a term that is not kept, which are computed from positions on every path.
  std::size_t unstored_elements = 0;
  double terms_ns = 0, touched_ns = 0, whole_ns = 0;  ///< the costs that the model expects of each path, in nanoseconds
};

struct BlendEvaluation : BlendChoice {
  std::size_t recomputed_elements = 0;  ///< elements computed from blended positions
  std::size_t zeros = 0;                ///< number of (0, 0, 0), including untouched elements
  std::size_t uncertain_elements = 0;   ///< elements so close to a collapse that 1e-6 rad is not guaranteed
};

class BlendNormals {
 public:
  /// Prepares the normals of the faces of a set, or of the elements of groups. The set must be valid (motion/motion.h),
  /// and the groups must be groups of its topology that keep their corners. Throws std::bad_alloc only.
  [[nodiscard]] static BlendNormals of_faces(BlendSet set, const BlendNormalsOptions& options = {});
  [[nodiscard]] static BlendNormals of_groups(BlendSet set, NormalGroups groups,
                                              const BlendNormalsOptions& options = {});
  BlendNormals(BlendNormals&&) noexcept;
  BlendNormals& operator=(BlendNormals&&) noexcept;
  ~BlendNormals();

  /// Sets the weights, chooses their path, and blends positions if the path needs them: the work that all elements have
  /// in common. With one thread it does not allocate or throw. Initially all weights are 0. `weights` must have one for
  /// each target
  BlendChoice set_weights(std::span<const double> weights, Threads threads = Threads::kOne);
  /// Writes n(w) / |n(w)| of a range of elements at the current weights, and returns counts. Does not allocate.
  /// elements.first must be a multiple of 64, and result must have as many elements as the range
  BlendEvaluation unit_normals(IndexRange elements, VectorView<float> result) const noexcept;

  /// Sets the weights and writes the normals of all elements. With one thread it does not allocate or throw. weights
  /// must have one for each target, result size() elements
  BlendEvaluation unit_normals(std::span<const double> weights, VectorView<float> result,
                               Threads threads = Threads::kOne);
  /// Writes the normals for many weight vectors, as in an animation: `weights` is (n, targets), and results[k] is for
  /// row k. With Threads::kAll the rows are divided among the threads; each thread except the first allocates its own
  /// scratch memory during the call, which cost() does not count.
  std::vector<BlendEvaluation> unit_normals(std::span<const double> weights, std::span<const VectorView<float>> results,
                                            Threads threads = Threads::kOne);
  /// Predicts the path for these weights.
  [[nodiscard]] BlendChoice choose(std::span<const double> weights) const;

  /// Appends a target. Computes its terms and those of its pairs with other targets, as far as max_bytes allows;
  /// existing terms are kept. Errors: those of validate(), after which nothing has changed.
  Status add_target(BlendTarget target);

  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] const BlendSet& set() const noexcept;
  /// Returns the cost of all targets, including added ones.
  [[nodiscard]] const BlendCost& cost() const noexcept;
  /// Returns the memory in use, in bytes: at most cost().bytes.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;
  explicit BlendNormals(std::unique_ptr<Parts> parts) noexcept;

  std::unique_ptr<Parts> parts_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_BLEND_NORMALS_H_
