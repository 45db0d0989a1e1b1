// Finds silhouette edges over time from the changes of side of both faces at an edge, in the order of time. Changes
// whose brackets touch count as one change, so that the order of all changes is certain.

#include <algorithm>
#include <cassert>

#include "chronormal/analysis/signs.h"

namespace chronormal {
namespace {

struct EdgeOfFace {
  std::uint32_t a = 0, b = 0, face = 0;  // the points of the edge, with a < b, and a face that has the edge

  friend auto operator<=>(const EdgeOfFace&, const EdgeOfFace&) = default;
};

std::vector<EdgeOfFace> edges_of(const Topology& topology) {
  std::vector<EdgeOfFace> edges;
  edges.reserve(topology.corner_count());
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    std::uint32_t from = face.back();
    for (const std::uint32_t to : face) {
      edges.push_back({std::min(from, to), std::max(from, to), static_cast<std::uint32_t>(f)});
      from = to;
    }
  }
  std::sort(edges.begin(), edges.end());
  return edges;
}

// A change of the side that one of the two faces at an edge shows.
struct Event {
  FacingChange change;
  std::size_t face = 0;  // 0 for the first face at the edge, 1 for the second
};

void add_silhouettes(const Silhouette& edge, const std::array<const Facing*, 2>& faces,
                     std::vector<Silhouette>& result) {
  const auto before = [](const Event& p, const Event& q) { return p.change.lower < q.change.lower; };
  std::array<std::array<Event, 3>, 2> of_face;
  std::array<Side, 2> sides{};
  for (std::size_t i = 0; i < 2; ++i) {
    sides[i] = faces[i]->first();
    for (std::size_t k = 0; k < faces[i]->count; ++k) of_face[i][k] = {faces[i]->at[k], i};
  }
  std::array<Event, 6> events;
  const auto end_of = [&](std::size_t i) { return of_face[i].begin() + static_cast<std::ptrdiff_t>(faces[i]->count); };
  std::merge(of_face[0].begin(), end_of(0), of_face[1].begin(), end_of(1), events.begin(), before);
  const std::size_t count = faces[0]->count + faces[1]->count;
  const auto differ = [&sides] { return static_cast<int>(sides[0]) * static_cast<int>(sides[1]) < 0; };
  Silhouette open = edge;
  bool is_open = differ();
  for (std::size_t i = 0; i < count;) {
    std::array<double, 2> bracket{events[i].change.lower, events[i].change.upper};
    for (; i < count && events[i].change.lower <= bracket[1]; ++i) {
      bracket[1] = std::max(bracket[1], events[i].change.upper);
      sides[events[i].face] = events[i].change.after;
    }
    if (differ() == is_open) continue;
    is_open = !is_open;
    (is_open ? open.from : open.to) = bracket;
    if (!is_open) result.push_back(open);
  }
  if (!is_open) return;
  open.to = {1, 1};
  result.push_back(open);
}

}  // namespace

std::vector<Silhouette> find_silhouettes(const Segment& segment, std::span<const ControlNormals> normals,
                                         const View& view) {
  assert(normals.size() == segment.topology->face_count());
  std::vector<Facing> facing(normals.size());
  find_facings(segment, {0, normals.size()}, normals, view, facing);
  const std::vector<EdgeOfFace> edges = edges_of(*segment.topology);
  std::vector<Silhouette> result;
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    const auto& [a, b, face] = edges[first];
    while (end < edges.size() && edges[end].a == a && edges[end].b == b) ++end;
    if (end - first != 2) continue;
    const std::uint32_t other = edges[first + 1].face;
    add_silhouettes({{a, b}, {face, other}, {}, {}}, {&facing[face], &facing[other]}, result);
  }
  return result;
}

}  // namespace chronormal
