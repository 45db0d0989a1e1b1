/// Exact unit normals of blend shapes at any weights. Private to the library; MeshNormals is its public interface.
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
/// Memory     Limited by max_bytes, and counted before terms are computed (BlendCost): if not all terms fit, those of
///            the targets and pairs with the most terms are not stored, and elements that need them are computed from
///            blended positions.
/// Accuracy   Within 1e-6 rad of the normals of the blended positions in exact arithmetic, on every path (except with
///            BlendNormalsOptions::in_float32). Terms are stored in float32, each with an error bound; an element whose
///            n(w) is small relative to the sum of its terms is computed in double from blended positions. If even
///            double cannot guarantee 1e-6 rad, the element is counted as uncertain.
/// Degenerate if n(w) is below its own rounding error, or an element has no faces, the result is (0, 0, 0), which is
///            counted. Weights that are not finite, or so large that n(w) overflows, give (0, 0, 0) at least for the
///            elements that they affect.
/// Ownership  the set and the groups are moved in and kept. A moved-from object may only be destroyed or assigned.
/// Threads    const functions may run at the same time. Results have the same bits on any number of threads, in ranges
///            of any size, and on every instruction set.
#ifndef CHRONORMAL_NORMALS_BLEND_BLEND_NORMALS_H_
#define CHRONORMAL_NORMALS_BLEND_BLEND_NORMALS_H_

#include <cstddef>
#include <memory>
#include <optional>
#include <span>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

enum class BlendPath {
  kTerms,    ///< add the terms of the active targets, for the elements that these targets touch
  kTouched,  ///< blend positions, and recompute the elements that the active targets touch from the points around them
  kWhole,    ///< blend positions, and recompute all elements
};

struct BlendNormalsOptions {
  /// The limit of BlendCost::bytes. The limit does not apply to least_bytes, the memory that is needed even if no terms
  /// are stored. The terms of many dense targets take more than the default, but then another path than kTerms is
  /// usually cheaper.
  std::size_t max_bytes = std::size_t{1} << 30;
  /// The path that is always taken, whatever its cost.
  std::optional<BlendPath> forced = {};
  /// True to blend positions and compute normals in float32 on the path kWhole, like FloatRecompute. This takes about
  /// half as long, so kWhole is chosen more often. There is then no guarantee for the normals of this path: positions
  /// have an error of a unit in the last place, which turns a normal by the ratio of that unit to the length of an
  /// edge. This accuracy is enough for shading. The other paths stay exact. The option has no effect if an element has
  /// a ring of more than 64 points.
  bool in_float32 = false;
};

/// The memory that the normals of a set need, and the counts from which it follows. Bytes do not include those of the
/// set and the groups.
struct BlendCost {
  std::size_t target_elements = 0;    ///< number of elements that a target touches, summed over targets
  std::size_t overlapping_pairs = 0;  ///< number of pairs of targets that both move some face
  /// Number of elements that touch a face which both targets of a pair move, summed over pairs.
  std::size_t pair_elements = 0;
  /// Number of targets whose terms fit into max_bytes; the targets with the fewest terms are stored first.
  std::size_t stored_targets = 0;
  /// Number of pairs of stored targets whose terms fit; the pairs with the fewest terms are stored first.
  std::size_t stored_pairs = 0;
  std::size_t least_bytes = 0;  ///< bytes that are needed without any terms: base normals, lists, rings, scratch
  std::size_t bytes = 0;        ///< bytes that are needed with the stored terms, at most
  std::size_t peak_bytes = 0;   ///< bytes that are needed while terms are computed, at most

  friend bool operator==(const BlendCost&, const BlendCost&) = default;
};

/// The path that is chosen for some weights, and the expected costs that led to this choice.
struct BlendChoice {
  BlendPath path = BlendPath::kTerms;
  std::size_t active_targets = 0;    ///< number of targets with nonzero weights
  std::size_t touched_elements = 0;  ///< number of elements with a face that an active target moves
  /// The number of touched elements that need a term which is not stored. These elements are computed from blended
  /// positions on every path.
  std::size_t unstored_elements = 0;
  double terms_ns = 0, touched_ns = 0, whole_ns = 0;  ///< the costs that the model expects of each path, in nanoseconds
};

struct BlendEvaluation : BlendChoice {
  std::size_t recomputed_elements = 0;  ///< number of elements that were computed from blended positions
  std::size_t zeros = 0;                ///< number of normals that are (0, 0, 0), including those of untouched elements
  /// Number of elements so close to a collapse that an error of at most 1e-6 rad is not guaranteed for them.
  std::size_t uncertain_elements = 0;
};

class BlendNormals {
 public:
  /// Prepare the normals of the faces of a set, or of the elements of groups. The set must be valid (motion/motion.h).
  /// The groups must be groups of the set's topology, and forget_corners() must not have been called. Throw only
  /// std::bad_alloc.
  [[nodiscard]] static BlendNormals of_faces(BlendSet set, const BlendNormalsOptions& options = {});
  [[nodiscard]] static BlendNormals of_groups(BlendSet set, NormalGroups groups,
                                              const BlendNormalsOptions& options = {});
  BlendNormals(BlendNormals&&) noexcept;
  BlendNormals& operator=(BlendNormals&&) noexcept;
  ~BlendNormals();

  /// Sets the weights, chooses the path for them, and blends positions if that path needs them. The call does the work
  /// that all elements have in common, and with one thread does not allocate or throw. Initially all weights are 0.
  /// Precondition: `weights` has one number for each target.
  BlendChoice set_weights(std::span<const double> weights, Threads threads = Threads::kOne);
  /// Writes the unit normals of a range of elements at the current weights, and returns counts. Does not allocate.
  /// Preconditions: elements.first is a multiple of 64, and result has as many elements as the range.
  BlendEvaluation unit_normals(IndexRange elements, VectorView<float> result) const noexcept;

  /// Sets the weights and writes the normals of all elements. With one thread, the call does not allocate or throw.
  /// Preconditions: weights has one number for each target, and result has size() elements.
  BlendEvaluation unit_normals(std::span<const double> weights, VectorView<float> result,
                               Threads threads = Threads::kOne);

  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] const BlendSet& set() const noexcept;
  /// Returns the memory that all targets need, and the counts from which it follows.
  [[nodiscard]] const BlendCost& cost() const noexcept;
  /// Returns the number of bytes of memory in use, which is at most cost().bytes.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;
  explicit BlendNormals(std::unique_ptr<Parts> parts) noexcept;

  std::unique_ptr<Parts> parts_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_NORMALS_H_
