/// Disjoint sets of corners that can be joined, and the lists of corners around each point.
#ifndef CHRONORMAL_NORMALS_GROUPS_CORNER_SETS_H_
#define CHRONORMAL_NORMALS_GROUPS_CORNER_SETS_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal::inline internal {

/// Returns the first corner of a face, as an index into Topology::corners().
[[nodiscard]] inline std::size_t first_corner(const Topology& topology, std::size_t f) noexcept {
  return static_cast<std::size_t>(topology.face(f).data() - topology.corners().data());
}

[[nodiscard]] inline std::vector<std::uint32_t> face_of_each_corner(const Topology& topology) {
  std::vector<std::uint32_t> faces;
  faces.reserve(topology.corner_count());
  for (std::size_t f = 0; f < topology.face_count(); ++f)
    faces.insert(faces.end(), topology.face(f).size(), static_cast<std::uint32_t>(f));
  return faces;
}

/// Disjoint sets of corners, by union-find with path halving. The smaller of two indices becomes the root, so that
/// roots do not depend on the order in which sets were joined.
class CornerSets {
 public:
  explicit CornerSets(std::size_t count) : parent_(count) { std::iota(parent_.begin(), parent_.end(), 0U); }

  [[nodiscard]] std::uint32_t root(std::uint32_t corner) noexcept {
    while (parent_[corner] != corner) corner = parent_[corner] = parent_[parent_[corner]];
    return corner;
  }

  void join(std::uint32_t a, std::uint32_t b) noexcept {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

  /// Returns the root of each corner, which names the set of the corner.
  [[nodiscard]] std::vector<std::uint32_t> roots() && {
    for (std::uint32_t c = 0; c < parent_.size(); ++c) parent_[c] = root(c);
    return std::move(parent_);
  }

 private:
  std::vector<std::uint32_t> parent_;
};

/// A list of items for each owner. The lists are stored one after the other, with offsets, like the faces of a
/// Topology.
struct Listing {
  std::vector<std::uint32_t> offsets, items;

  [[nodiscard]] std::span<const std::uint32_t> of(std::size_t owner) const noexcept {
    return {items.data() + offsets[owner], items.data() + offsets[owner + 1]};
  }
};

/// Returns the corners around each point, in ascending order.
[[nodiscard]] inline Listing corners_of_points(const Topology& topology, const Points& points) {
  Listing listing{std::vector<std::uint32_t>(points.count + 1), std::vector<std::uint32_t>(topology.corner_count())};
  for (const std::uint32_t vertex : topology.corners()) ++listing.offsets[points.point_of_vertex[vertex] + 1];
  std::partial_sum(listing.offsets.begin(), listing.offsets.end(), listing.offsets.begin());
  std::vector<std::uint32_t> next = listing.offsets;
  for (std::uint32_t c = 0; c < topology.corner_count(); ++c)
    listing.items[next[points.point_of_vertex[topology.corners()[c]]]++] = c;
  return listing;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_CORNER_SETS_H_
