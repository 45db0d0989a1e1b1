#include "chronormal/normals/normal_groups.h"

#include <algorithm>
#include <numeric>

#include "core/bits.h"

namespace chronormal {
namespace {

// A total order of coordinates in which -0 and 0 are the same.
std::uint32_t key(float coordinate) { return bit_cast<std::uint32_t>(coordinate + 0.0F); }

// Negative where vertex a comes first, 0 where the two are of one body and coincide in all keyframes.
int compare(const Motion& motion, std::uint32_t a, std::uint32_t b) {
  if (const auto& bodies = motion.body_of_vertex; !bodies.empty() && bodies[a] != bodies[b])
    return bodies[a] < bodies[b] ? -1 : 1;
  for (const Motion::Keyframe& keyframe : motion.keyframes) {
    const float* const p = keyframe.positions.data() + 3 * std::size_t{a};
    const float* const q = keyframe.positions.data() + 3 * std::size_t{b};
    for (std::size_t i = 0; i < 3; ++i) {
      if (key(p[i]) != key(q[i])) return key(p[i]) < key(q[i]) ? -1 : 1;
    }
  }
  return 0;
}

}  // namespace

Points separate_points(std::size_t vertex_count) {
  Points points{std::vector<std::uint32_t>(vertex_count), vertex_count};
  std::iota(points.point_of_vertex.begin(), points.point_of_vertex.end(), 0U);
  return points;
}

Points weld_coincident(const Motion& motion) {
  std::vector<std::uint32_t> order = separate_points(motion.topology.vertex_count()).point_of_vertex;
  std::sort(order.begin(), order.end(), [&motion](std::uint32_t a, std::uint32_t b) {
    const int comparison = compare(motion, a, b);
    return comparison != 0 ? comparison < 0 : a < b;
  });

  // Copies stand side by side now, the first vertex of each point before its copies.
  std::vector<std::uint32_t> first_vertex(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool copy = i > 0 && compare(motion, order[i - 1], order[i]) == 0;
    first_vertex[order[i]] = copy ? first_vertex[order[i - 1]] : order[i];
  }

  Points points;
  points.point_of_vertex.resize(order.size());
  for (std::size_t v = 0; v < order.size(); ++v) {
    const bool first = first_vertex[v] == v;
    points.point_of_vertex[v] =
        first ? static_cast<std::uint32_t>(points.count++) : points.point_of_vertex[first_vertex[v]];
  }
  return points;
}

}  // namespace chronormal
