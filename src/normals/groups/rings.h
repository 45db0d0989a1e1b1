/// The points around elements as paths, for sixteen elements at a time. Kernels follow the paths in lanes.
///
/// A normal is a sum over a path of points p around a centre c: n = sum (p[i] - c) x (p[i + 1] - c). The centre of a
/// polygon is its first corner, and its path consists of its other corners. The path of a vertex consists of its
/// neighbours in turn. Every second point p[i] occurs in two of these products, which can be joined into one:
///
///     (p[i - 1] - c) x (p[i] - c) + (p[i] - c) x (p[i + 1] - c) = (p[i] - c) x (p[i + 1] - p[i - 1])
///
/// so that kernels need half as many products. Pieces of a path that do not adjoin each other are connected through the
/// centre, which adds nothing. Shorter paths are filled up with the centre to the length of the longest of sixteen
/// paths, which adds nothing either. After the last element, slices repeat the last element:
///
///     slice    centres        of 16 elements, as indices of points
///              first points   of the paths
///              second ...     as many rows as the longest path has points
///
/// Paths depend only on the topology and the groups, and so does the order of every sum. Each corner of a large polygon
/// has a path around it, so the length of all paths together grows with the square of its corners. A caller that has
/// another way to compute the normals of such elements gives a limit. An element with more points than the limit gets a
/// path that adds nothing.
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

inline constexpr std::size_t kRingLanes = 16;  // number of elements of a slice

/// The paths around elements as kernels read them: slices of sixteen elements (see the top of this file), in rows of
/// kRingLanes indices. Slice s has the rows from first_row[s] to before first_row[s + 1], which are at least two.
struct RingSlices {
  const std::uint32_t* indices = nullptr;
  const std::size_t* first_row = nullptr;
  std::size_t count = 0;
};

class Rings {
 public:
  /// Creates an object without elements.
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
  /// Returns the elements with more points than most_points, in ascending order. The paths of these elements add
  /// nothing to sums.
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

/// The paths around the elements of some groups. The paths are made when they are first requested.
struct RingsOfGroups {
  std::once_flag once;
  Rings rings;
};

/// The largest number of points of a path in rings_around().
inline constexpr std::size_t kMostPathPoints = 64;

/// Returns the paths of up to kMostPathPoints points around the elements of groups. The groups and their copies keep
/// the paths. The paths take 4 bytes for each point of the longest of sixteen paths, which is 33 bytes per vertex of a
/// grid. Any number of threads may call this at the same time. Throws std::bad_alloc.
[[nodiscard]] const Rings& rings_around(const Topology& topology, const NormalGroups& groups);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_RINGS_H_
