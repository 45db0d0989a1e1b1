/// The terms of the quadratic form in the weights that gives the normals (blend_terms.h), as BlendNormals stores them.
/// The terms are in float32 and sparse, and only as many terms are stored as fit into memory.
#ifndef CHRONORMAL_NORMALS_BLEND_BLEND_STORAGE_H_
#define CHRONORMAL_NORMALS_BLEND_BLEND_STORAGE_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "normals/blend/blend_normals.h"
#include "normals/blend/blend_terms.h"
#include "normals/blend/index_bits.h"
#include "normals/groups/rings.h"

namespace chronormal::inline internal {

/// The largest number of points of a path around an element (groups/rings.h) that SIMD lanes can process.
inline constexpr std::size_t kMostRingPoints = 64;

/// The coefficients of n(w) (blend_terms.h) at some elements: A and C_ii for a target, or C_ij for a pair of targets. A
/// coefficient is stored as four lanes, which must be multiplied by `scale`: x, y, z and a bound. The length of the
/// error of (x, y, z) is at most kFloatUnitRoundoff times the bound; all bounds are in this unit.
struct StoredTerm {
  bool is_stored = false;
  double scale = 1;
  std::vector<std::uint32_t> elements;  ///< numbers of the elements, ascending
  std::vector<float> lanes;             ///< four numbers for each coefficient of each element
};

struct StoredPair {
  std::uint32_t other = 0;  ///< the number of the other target of the pair, which is the larger number
  /// The number of elements that touch a face which both targets move. The term has at most this many elements.
  std::uint32_t elements = 0;
  StoredTerm term;
};

struct StoredTarget {
  SparseBits elements;  ///< elements that the target touches
  std::size_t element_count = 0;
  std::size_t moved_faces = 0, moved_corners = 0;
  double reach = 0;  ///< the largest absolute component of the target's deltas
  StoredTerm term;
  std::vector<StoredPair> pairs;  ///< the pairs of this target with later targets, in the order of these targets
};

class BlendStorage {
 public:
  /// Counts the terms, and decides which of them to store, but does not compute them. If groups is nullptr, the
  /// elements are faces. The set and the groups must outlive the object.
  BlendStorage(const BlendSet& set, const NormalGroups* groups, std::size_t max_bytes);

  /// Computes the terms that are to be stored.
  void fill();

  [[nodiscard]] std::span<const StoredTarget> targets() const noexcept { return targets_; }
  [[nodiscard]] const BlendTerms& terms() const noexcept { return terms_; }
  /// Returns the paths around all elements (groups/rings.h). A path that would have more than kMostRingPoints points is
  /// replaced by a path that adds nothing to the normal.
  [[nodiscard]] const Rings& rings() const noexcept { return rings_; }
  /// Returns the faces of more than kMostRingPoints corners in ascending order. Elements that touch such a face have no
  /// path.
  [[nodiscard]] std::span<const std::uint32_t> large_faces() const noexcept { return large_faces_; }
  [[nodiscard]] const BlendCost& cost() const noexcept { return cost_; }
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Candidate;
  struct ListedTerm;

  [[nodiscard]] StoredTarget listed(std::size_t i) const;
  [[nodiscard]] std::size_t list_bytes() const noexcept;
  void choose(std::vector<Candidate> candidates);
  [[nodiscard]] std::size_t work_of(const StoredTarget& target) const;
  [[nodiscard]] std::size_t work_of(const StoredTarget& target, const StoredPair& pair) const;
  void fill_target(std::size_t i);
  void fill_pair(std::size_t i, StoredPair& pair);
  void update_cost();

  const BlendSet& set_;
  std::size_t max_bytes_;
  BlendTerms terms_;
  Rings rings_;
  std::vector<std::uint32_t> large_faces_;
  std::vector<StoredTarget> targets_;
  BlendCost cost_;
  std::size_t work_together_ = 0;  // the largest number of bytes of terms that are computed at once
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_BLEND_BLEND_STORAGE_H_
