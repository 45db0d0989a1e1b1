/// The points around elements as paths, sixteen elements at a time, for kernels that follow the paths in lanes.
///
/// A normal is a sum over a path of points p around a centre c: n = sum (p[i] - c) x (p[i + 1] - c). The centre of a
/// polygon is its first corner, and its path consists of the other corners; the path of a vertex consists of its
/// neighbours in turn. Every second point belongs to two of these products, which can be joined into one product:
///
///     (p[i - 1] - c) x (p[i] - c) + (p[i] - c) x (p[i + 1] - c) = (p[i] - c) x (p[i + 1] - p[i - 1])
///
/// so that kernels need half as many products. Pieces of a path that do not join are connected through the centre,
/// which adds nothing. Shorter paths are filled up to the longest of sixteen with the centre, which adds nothing
/// either. After the last element, slices repeat it:
///
///     slice    centres        of 16 elements, as indices of points
///              first points   of the paths
///              second ...     as many rows as the longest path has points
///
/// Paths follow from the topology and the groups alone, and so does the order of every sum. Each corner of a large
/// polygon has a path around it, so the paths together grow with the square of its corners. A caller that has another
/// way to compute the normals of such elements gives a limit, and gets a path without any area for each of them.
#ifndef CHRONORMAL_NORMALS_GROUPS_RINGS_H_
#define CHRONORMAL_NORMALS_GROUPS_RINGS_H_

#include <cstddef>
#include <cstdint>
#include <mutex>
#include <span>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kRingLanes = 16;  // elements of a slice

/// The slices as kernels read them: rows of kRingLanes indices. Slice s has the rows first_row[s] to first_row[s + 1];
/// there are at least two rows.
struct RingSlices {
  const std::uint32_t* indices = nullptr;
  const std::size_t* first_row = nullptr;
  std::size_t count = 0;
};

class Rings {
 public:
  /// Creates the rings of no elements.
  Rings() = default;
  /// Makes the paths of all faces. A face with more than most_points points gets a path that adds nothing. O(corners).
  [[nodiscard]] static Rings of_faces(const Topology& topology, std::size_t most_points = kUnlimited);
  /// Makes the paths of the elements of groups, which must belong to the topology and keep their corners. O(points of
  /// all paths), and up to 64 times more if faces around an element do not follow each other.
  [[nodiscard]] static Rings of_groups(const Topology& topology, const NormalGroups& groups,
                                       std::size_t most_points = kUnlimited);

  static constexpr std::size_t kUnlimited = ~std::size_t{0};

  [[nodiscard]] RingSlices view() const noexcept { return {indices_.data(), first_row_.data(), first_row_.size() - 1}; }
  [[nodiscard]] bool empty() const noexcept { return indices_.empty(); }
  [[nodiscard]] std::size_t row_count() const noexcept { return first_row_.back(); }
  /// Returns the elements with more points than the limit, in ascending order. Their paths add nothing.
  [[nodiscard]] std::span<const std::uint32_t> left_out() const noexcept { return left_out_; }
  [[nodiscard]] std::size_t bytes() const noexcept {
    return (indices_.capacity() + left_out_.capacity()) * sizeof(std::uint32_t) +
           first_row_.capacity() * sizeof(std::size_t);
  }

 private:
  template <class PathOf>
  Rings(std::size_t count, const PathOf& path_of);

  std::vector<std::uint32_t> indices_;
  std::vector<std::size_t> first_row_ = {0};
  std::vector<std::uint32_t> left_out_;
};

/// The paths around the elements of some groups, built when they are first requested.
struct RingsOfGroups {
  std::once_flag once;
  Rings rings;
};

/// The largest number of points of a path in rings_around().
inline constexpr std::size_t kMostPathPoints = 64;

/// Returns the paths of up to kMostPathPoints around the elements of groups. The groups and their copies keep the
/// paths, which take 4 bytes for each point of the longest of sixteen paths, or 33 bytes per vertex of a grid. Any
/// number of threads may request them. Throws std::bad_alloc.
[[nodiscard]] const Rings& rings_around(const Topology& topology, const NormalGroups& groups);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_RINGS_H_
