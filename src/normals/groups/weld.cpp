// Finds vertices that coincide in all keyframes: it sorts them by place in one keyframe after the other.
#include "chronormal/normals/normal_groups.h"

#include <algorithm>
#include <array>
#include <numeric>

#include "core/bits.h"

namespace chronormal {
namespace {

// A total order of coordinates in which -0 and 0 are the same.
std::uint32_t key(float coordinate) { return bit_cast<std::uint32_t>(coordinate + 0.0F); }

// The place of a vertex in the total order; vertices of separate bodies are never equal.
using PlaceKey = std::array<std::uint32_t, 3>;

PlaceKey place_key(const Motion::Keyframe& keyframe, std::uint32_t vertex) {
  const float* const p = keyframe.positions.data() + 3 * std::size_t{vertex};
  return {key(p[0]), key(p[1]), key(p[2])};
}

// Sorts vertices from first to end by their places at a keyframe, and by their numbers where these are equal. Calls
// each(first, end) for those of one place.
template <class Each>
void split_by_place(const Motion::Keyframe& keyframe, std::span<std::uint32_t> vertices, const Each& each) {
  std::sort(vertices.begin(), vertices.end(), [&](std::uint32_t a, std::uint32_t b) {
    const PlaceKey p = place_key(keyframe, a), q = place_key(keyframe, b);
    return p != q ? p < q : a < b;
  });
  for (std::size_t first = 0, end = 0; first < vertices.size(); first = end) {
    const PlaceKey place = place_key(keyframe, vertices[first]);
    for (end = first + 1; end < vertices.size() && place_key(keyframe, vertices[end]) == place;) ++end;
    each(vertices.subspan(first, end - first));
  }
}

}  // namespace

Points separate_points(std::size_t vertex_count) {
  Points points{std::vector<std::uint32_t>(vertex_count), vertex_count};
  std::iota(points.point_of_vertex.begin(), points.point_of_vertex.end(), 0U);
  return points;
}

Result<Points> weld_coincident(MotionStream& stream) {
  const Motion& motion = stream.motion();
  std::vector<std::uint32_t> order = separate_points(motion.topology.vertex_count()).point_of_vertex;
  // Vertices that coincide in all keyframes so far are neighbours in the list; each further keyframe tells some of them
  // apart.
  using Coinciding = std::span<std::uint32_t>;
  std::vector<Coinciding> found = {order}, before;
  const auto keep = [&found](Coinciding vertices) {
    if (vertices.size() > 1) found.push_back(vertices);
  };
  if (const auto& bodies = motion.body_of_vertex; !bodies.empty()) {
    std::stable_sort(order.begin(), order.end(),
                     [&](std::uint32_t a, std::uint32_t b) { return bodies[a] < bodies[b]; });
    found.clear();
    for (std::size_t first = 0, end = 0; first < order.size(); first = end) {
      for (end = first + 1; end < order.size() && bodies[order[end]] == bodies[order[first]];) ++end;
      keep(Coinciding(order).subspan(first, end - first));
    }
  }
  for (std::size_t k = 0; k < motion.keyframes.size() && !found.empty(); ++k) {
    if (Status status = stream.hold(k, k); !status) return status.error();
    before.swap(found);
    found.clear();
    for (const Coinciding vertices : before) split_by_place(motion.keyframes[k], vertices, keep);
  }

  std::vector<std::uint32_t> first_vertex = separate_points(order.size()).point_of_vertex;
  for (const Coinciding vertices : found) {
    for (const std::uint32_t vertex : vertices) first_vertex[vertex] = vertices.front();
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

Points weld_coincident(const Motion& motion) {
  MotionStream stream(motion);
  return weld_coincident(stream).value();
}

}  // namespace chronormal
