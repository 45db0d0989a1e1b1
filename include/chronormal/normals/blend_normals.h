/// Exact unit normals of blend shapes at any weights.
///
/// Engines add one normal delta per target, but the normal is a quadratic form in the weights (blend_terms.h): each
/// target has a linear and a square term, and two targets that move the same face have one together. BlendNormals keeps
/// these terms, sparse, and adds up the terms of the active targets; an element that none of them touches keeps its
/// base normal.
///
///     BlendNormals normals = BlendNormals::of_groups(set, groups);
///     const BlendEvaluation done = normals.unit_normals(weights, VectorView<float>::packed(xyz, normals.size()));
///     // done.path says how, done.touched_elements how much of the mesh it took
///
/// Paths      Where many targets overlap, making normals anew from blended positions is cheaper: those of the touched
///            part, or of the whole mesh. Each weight vector goes the cheapest way by a model of their costs: a pure
///            function of the set, the weights and the options. Its constants were measured on one core of a machine
///            of docs/benchmarks.md, and only their ratios matter.
/// Speed      normals are made anew in lanes of double, along rings of points around elements. If the lanes do not
///            guarantee 1e-6 rad for an element, or its ring has more than 64 points, it is made by itself, which takes
///            some eight times as long.
/// Memory     Known before anything is multiplied (predict_blend_cost()), and limited by max_bytes: terms that do not
///            fit are not kept, the largest first, and their elements are made from blended positions.
/// Accuracy   Within 1e-6 rad of the normals of the blended positions in exact arithmetic, on every path (but see
///            BlendNormalsOptions::in_float32). Terms are
///            kept in float32 with a bound each; an element whose n(w) is small against the sum of its terms is made in
///            double from blended positions. Where even double does not promise 1e-6 rad it is counted as uncertain.
/// Degenerate n(w) below its own rounding error, and an element without faces, gives (0, 0, 0), which is counted.
///            Weights that are not finite, or so large that n(w) is not, give (0, 0, 0), at least where they act.
/// Ownership  the set and the groups are moved in, and are kept. What was moved from may only be destroyed or assigned.
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
  kTerms,    ///< the terms of the active targets, for the elements that these touch
  kTouched,  ///< blended positions, and rings around these elements
  kWhole,    ///< blended positions, and rings around all elements
};

/// Returns "terms", "touched" or "whole".
[[nodiscard]] std::string_view name_of(BlendPath path) noexcept;

/// The default limit, a gigabyte: the terms of many dense targets take more, and would hardly ever be the cheapest way.
inline constexpr std::size_t kUsualBlendBytes = std::size_t{1} << 30;

struct BlendNormalsOptions {
  /// The limit of BlendCost::bytes. What is kept beside the terms, least_bytes, is kept in any case.
  std::size_t max_bytes = kUsualBlendBytes;
  /// Takes this path whatever it costs.
  std::optional<BlendPath> forced = {};
  /// Blends positions and makes normals of them in float32 on the path kWhole, as FloatRecompute does. This takes about
  /// half as long, so that it is the cheapest way more often, but promises nothing: positions are wrong by a unit in
  /// their last place, which turns a normal by the ratio of that unit to an edge. It is enough for shading; the other
  /// paths are as exact as ever. It has no effect where an element has a ring of more than 64 points.
  bool in_float32 = false;
};

/// The cost of the normals of a set, from counts alone. Bytes come on top of the bytes of the set and the groups.
struct BlendCost {
  std::size_t target_elements = 0;    ///< elements that targets touch, added up over targets
  std::size_t overlapping_pairs = 0;  ///< pairs of targets that move a face in common
  std::size_t pair_elements = 0;      ///< elements of these faces, added up over pairs
  std::size_t stored_targets = 0;     ///< targets whose terms fit into max_bytes: small ones first
  std::size_t stored_pairs = 0;       ///< pairs of stored targets whose terms fit, likewise
  std::size_t least_bytes = 0;        ///< kept without any term: base normals, lists, rings, scratch
  std::size_t bytes = 0;              ///< kept with the stored terms, at most
  std::size_t peak_bytes = 0;         ///< while they are made, at most

  friend bool operator==(const BlendCost&, const BlendCost&) = default;
};

/// Predicts the cost from the faces of each target and the rings around elements, and makes nothing else. Pure. set
/// must be valid, and groups must be groups of its topology that keep their corners.
[[nodiscard]] BlendCost predict_blend_cost(const BlendSet& set, const BlendNormalsOptions& options = {});
[[nodiscard]] BlendCost predict_blend_cost(const BlendSet& set, const NormalGroups& groups,
                                           const BlendNormalsOptions& options = {});

/// The path by which the normals at some weights are made, and the expected costs that decide it.
struct BlendChoice {
  BlendPath path = BlendPath::kTerms;
  std::size_t active_targets = 0;     ///< of weight other than 0
  std::size_t touched_elements = 0;   ///< with a face that an active target moves
  std::size_t unstored_elements = 0;  ///< of these, with a term that is not kept: made from positions on any path
  double terms_ns = 0, touched_ns = 0, whole_ns = 0;  ///< the costs that the model expects of each path, in nanoseconds
};

struct BlendEvaluation : BlendChoice {
  std::size_t recomputed_elements = 0;  ///< made from blended positions
  std::size_t zeros = 0;                ///< (0, 0, 0) written, untouched elements included
  std::size_t uncertain_elements = 0;   ///< so near a collapse that 1e-6 rad is not promised
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

  /// Chooses the path of some weights, and moves points if the path needs them: the work that all elements share. On
  /// one thread it does not allocate or throw. At first all weights are 0.
  /// weights must have one for each target
  BlendChoice set_weights(std::span<const double> weights, Threads threads = Threads::kOne);
  /// Writes n(w) / |n(w)| of a range of elements at the weights that are set, and counts what it did. Does not
  /// allocate.
  /// elements.first must be a multiple of 64, result have as many elements as the range
  BlendEvaluation unit_normals(IndexRange elements, VectorView<float> result) const noexcept;

  /// Sets the weights and writes the normals of all elements. On one thread it does not allocate or throw.
  /// weights must have one for each target, result size() elements
  BlendEvaluation unit_normals(std::span<const double> weights, VectorView<float> result,
                               Threads threads = Threads::kOne);
  /// Writes the normals of many weight vectors, an animation: weights is (n, targets), and results[k] is for row k.
  /// With Threads::kAll the rows are divided among the threads; each thread beyond the first takes scratch of its own
  /// meanwhile, which cost() does not count.
  std::vector<BlendEvaluation> unit_normals(std::span<const double> weights, std::span<const VectorView<float>> results,
                                            Threads threads = Threads::kOne);
  /// Predicts the path that these weights take.
  [[nodiscard]] BlendChoice choose(std::span<const double> weights) const;

  /// Appends a target; makes its terms and the terms of its pairs, as far as max_bytes goes, and makes no other terms
  /// anew. Errors: those of validate(), with nothing changed.
  Status add_target(BlendTarget target);

  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] const BlendSet& set() const noexcept;
  /// Returns the cost of all targets, added ones included.
  [[nodiscard]] const BlendCost& cost() const noexcept;
  /// Returns the memory that is kept, in bytes: at most cost().bytes.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;
  explicit BlendNormals(std::unique_ptr<Parts> parts) noexcept;

  std::unique_ptr<Parts> parts_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_BLEND_NORMALS_H_
