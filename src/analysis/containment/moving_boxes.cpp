#include "analysis/containment/moving_boxes.h"

namespace chronormal::inline internal {
namespace {

constexpr std::uint32_t kLeafSize = 3;

struct Middle {
  std::array<float, 3> at;
  std::uint32_t triangle;
};

struct Range {
  std::uint32_t node, first, count;
};

// Returns the axis along which the centres of triangles are farthest apart.
std::size_t longest_axis(const Middle* begin, const Middle* end) {
  std::size_t longest = 0;
  float most = -1;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto [low, high] =
        std::minmax_element(begin, end, [k](const Middle& a, const Middle& b) { return a.at[k] < b.at[k]; });
    if (high->at[k] - low->at[k] > most) {
      most = high->at[k] - low->at[k];
      longest = k;
    }
  }
  return longest;
}

// Extends a box to include some coordinates. If the coordinates were rounded, the box is extended to their neighbours
// in float32.
void enclose(std::array<float, 3>& low, std::array<float, 3>& high, const std::array<float, 3>& least,
             const std::array<float, 3>& most, bool are_rounded = false) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = std::min(low[k], are_rounded ? std::nextafter(least[k], -kInfinity) : least[k]);
    high[k] = std::max(high[k], are_rounded ? std::nextafter(most[k], kInfinity) : most[k]);
  }
}

}  // namespace

BoxTree build_box_tree(VectorView<const float> positions, std::span<const std::uint32_t> corners) {
  std::vector<Middle> middles(corners.size() / 3);
  for (std::size_t i = 0; i < middles.size(); ++i) {
    const auto v = corners.subspan(3 * i, 3);
    // A third of each position is added, since the sum of three positions could overflow.
    const Vec3f middle = (1.0F / 3) * positions[v[0]] + (1.0F / 3) * positions[v[1]] + (1.0F / 3) * positions[v[2]];
    middles[i] = {{middle.x, middle.y, middle.z}, static_cast<std::uint32_t>(i)};
  }
  BoxTree tree{std::vector<BoxNode>(1), {}};
  std::vector<Range> open{{0, 0, static_cast<std::uint32_t>(middles.size())}};
  while (!open.empty()) {
    const Range range = open.back();
    open.pop_back();
    if (range.count <= kLeafSize) {
      tree.nodes[range.node] = {range.first, range.count};
      continue;
    }
    Middle* const begin = middles.data() + range.first;
    const std::uint32_t half = range.count / 2;
    const std::size_t axis = longest_axis(begin, begin + range.count);
    std::nth_element(begin, begin + half, begin + range.count, [axis](const Middle& a, const Middle& b) {
      return a.at[axis] < b.at[axis] || (a.at[axis] == b.at[axis] && a.triangle < b.triangle);
    });
    const auto child = static_cast<std::uint32_t>(tree.nodes.size());
    tree.nodes[range.node] = {child, 0};
    tree.nodes.resize(tree.nodes.size() + 2);
    open.push_back({child, range.first, half});
    open.push_back({child + 1, range.first + half, range.count - half});
  }
  for (const Middle& middle : middles) tree.order.push_back(middle.triangle);
  return tree;
}

std::vector<MovingBox> moving_boxes(std::span<const BoxNode> nodes, const Segment& segment) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  constexpr std::array<float, 3> kLow{kInfinity, kInfinity, kInfinity}, kHigh{-kInfinity, -kInfinity, -kInfinity};
  std::vector<MovingBox> boxes(nodes.size(), {kLow, kLow, kHigh, kHigh});
  // Nodes are visited from last to first, since children come after their parents in the list.
  for (std::size_t n = nodes.size(); n-- > 0;) {
    const BoxNode& node = nodes[n];
    MovingBox& box = boxes[n];
    if (node.count == 0) {
      for (const MovingBox& child : {boxes[node.first], boxes[node.first + 1]}) {
        enclose(box.low_from, box.high_from, child.low_from, child.high_from);
        enclose(box.low_to, box.high_to, child.low_to, child.high_to);
      }
    }
    for (std::uint32_t i = 0; i < node.count; ++i) {
      for (const std::uint32_t v : segment.topology->face(node.first + i)) {
        const Vec3f a = segment.from[v], b = segment.to[v];
        const std::array<float, 3> from{a.x, a.y, a.z}, to{b.x, b.y, b.z};
        enclose(box.low_from, box.high_from, from, from, segment.from_residuals.count > 0);
        enclose(box.low_to, box.high_to, to, to, segment.to_residuals.count > 0);
      }
    }
  }
  return boxes;
}

}  // namespace chronormal::inline internal
