/// A hierarchy of boxes around the triangles of a mesh that deforms.
///
/// A box is given by its limits at both ends of a segment. Between the ends the limits move on straight lines, like
/// everything inside the box. For a point that also moves, six linear inequalities give the times at which the point is
/// inside. So a fast mesh does not need large boxes. The tree of triangles, split at medians, is computed once; every
/// segment has its own boxes around the nodes of the tree.
///
/// Threads    const functions may run at the same time.
/// Source     Gruenschloss et al., MSBVH: an efficient acceleration data structure for ray traced motion blur (2011).
#ifndef CHRONORMAL_ANALYSIS_CONTAINMENT_MOVING_BOXES_H_
#define CHRONORMAL_ANALYSIS_CONTAINMENT_MOVING_BOXES_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "analysis/containment/crossing_signs.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// A node of the tree. The two children of a node follow each other in the list.
struct BoxNode {
  std::uint32_t first = 0;  ///< the number of the first child, or of the first triangle
  std::uint32_t count = 0;  ///< number of triangles in a leaf; 0 if the node has two children
};

struct BoxTree {
  /// The nodes of the tree: the root is first, and parents come before their children.
  std::vector<BoxNode> nodes;
  std::vector<std::uint32_t> order;  ///< numbers of the triangles, ordered so that those of a node are consecutive
};

/// Builds a tree of triangles, in which triangles that are near each other at `positions` are in the same nodes.
/// `corners` has three vertices for each triangle. O(n log n).
[[nodiscard]] BoxTree build_box_tree(VectorView<const float> positions, std::span<const std::uint32_t> corners);

/// A box that moves, given by its limits at both ends of a segment. Points on a limit are inside.
struct MovingBox {
  std::array<float, 3> low_from, low_to, high_from, high_to;

  /// Returns true if the point is inside the box at some time in the segment.
  [[nodiscard]] bool meets(const MovingPoint& point) const noexcept {
    double begin = 0, end = 1;
    return cut(low_from[0], low_to[0], point.from.x, point.to.x, 1, begin, end) &&
           cut(high_from[0], high_to[0], point.from.x, point.to.x, -1, begin, end) &&
           cut(low_from[1], low_to[1], point.from.y, point.to.y, 1, begin, end) &&
           cut(high_from[1], high_to[1], point.from.y, point.to.y, -1, begin, end) &&
           cut(low_from[2], low_to[2], point.from.z, point.to.z, 1, begin, end) &&
           cut(high_from[2], high_to[2], point.from.z, point.to.z, -1, begin, end);
  }

  /// Returns true if the half-line upwards (along +z) from the point meets the box at t.
  [[nodiscard]] bool is_above(const MovingPoint& point, double t) const noexcept {
    return reaches(low_from[0], low_to[0], point.from.x, point.to.x, 1, t) &&
           reaches(high_from[0], high_to[0], point.from.x, point.to.x, -1, t) &&
           reaches(low_from[1], low_to[1], point.from.y, point.to.y, 1, t) &&
           reaches(high_from[1], high_to[1], point.from.y, point.to.y, -1, t) &&
           reaches(high_from[2], high_to[2], point.from.z, point.to.z, -1, t);
  }

 private:
  // Restricts [begin, end] to the times at which the point is above a limit that moves, or below the limit if the sign
  // is -1. Returns false if there are no such times.
  static bool cut(float from, float to, float point_from, float point_to, double sign, double& begin,
                  double& end) noexcept {
    const double at_from = sign * (double{point_from} - from), at_to = sign * (double{point_to} - to);
    if (at_from < 0 && at_to < 0) return false;
    if (at_from < 0) begin = std::max(begin, at_from / (at_from - at_to));
    if (at_to < 0) end = std::min(end, at_from / (at_from - at_to));
    return begin <= end + kSlack;
  }
  static bool reaches(float from, float to, float point_from, float point_to, double sign, double t) noexcept {
    const double at_from = double{point_from} - from, at_to = double{point_to} - to;
    return sign * ((1 - t) * at_from + t * at_to) >= -kSlack * (std::fabs(at_from) + std::fabs(at_to));
  }

  static constexpr double kSlack = 1e-14;  // a relative error, larger than that of four roundings
};

/// Returns the boxes of all nodes for a segment. The topology of the segment must have the triangles in the order of
/// the tree. O(n).
[[nodiscard]] std::vector<MovingBox> moving_boxes(std::span<const BoxNode> nodes, const Segment& segment);

/// Calls visit(triangle) for the triangles of each leaf whose box passes the test, if the boxes of all nodes above the
/// leaf pass the test, too.
template <class Test, class Visit>
void visit_boxes(std::span<const BoxNode> nodes, std::span<const MovingBox> boxes, const Test& test,
                 const Visit& visit) {
  std::array<std::uint32_t, 64> open{};  // a tree split at medians has at most 32 levels
  std::size_t count = 1;
  while (count > 0) {
    const std::uint32_t n = open[--count];
    if (!test(boxes[n])) continue;
    const BoxNode& node = nodes[n];
    if (node.count == 0) {
      open[count++] = node.first + 1;
      open[count++] = node.first;
    }
    for (std::uint32_t i = 0; i < node.count; ++i) visit(node.first + i);
  }
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CONTAINMENT_MOVING_BOXES_H_
