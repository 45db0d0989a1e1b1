#include "normals/groups/sides.h"

#include <algorithm>
#include <numeric>

#include "normals/groups/corner_sets.h"

namespace chronormal::inline internal {
namespace {

// Returns a hash of a set of points that does not depend on their order.
std::uint32_t set_number(std::span<const std::uint32_t> points) {
  std::uint64_t sum = 0;
  for (const std::uint32_t p : points) {
    std::uint64_t h = p + 0x9E3779B97F4A7C15U;
    h = (h ^ (h >> 30)) * 0xBF58476D1CE4E5B9U;
    h = (h ^ (h >> 27)) * 0x94D049BB133111EBU;
    sum += h ^ (h >> 31);
  }
  return static_cast<std::uint32_t>(sum >> 32);
}

bool is_back(std::span<const std::uint32_t> a, std::span<const std::uint32_t> b) {
  if (a.size() != b.size()) return false;
  const auto start = std::find(b.begin(), b.end(), a[0]);
  if (start == b.end()) return false;
  const auto s = static_cast<std::size_t>(start - b.begin());
  for (std::size_t i = 0; i < a.size(); ++i)
    if (a[i] != b[(s + a.size() - i) % a.size()]) return false;
  return true;
}

bool has_twice(std::span<const std::uint32_t> loop) {
  for (std::size_t i = 0; i < loop.size(); ++i)
    if (std::find(loop.begin(), loop.begin() + static_cast<std::ptrdiff_t>(i), loop[i]) !=
        loop.begin() + static_cast<std::ptrdiff_t>(i))
      return true;
  return false;
}

// Disjoint sets of nodes. Two sets are not joined if two of their nodes must stay apart.
class JoinedNodes {
 public:
  JoinedNodes(std::size_t nodes, std::span<const std::pair<std::uint32_t, std::uint32_t>> apart)
      : parent_(nodes), apart_(apart) {
    std::iota(parent_.begin(), parent_.end(), 0U);
  }

  [[nodiscard]] std::uint32_t root(std::uint32_t n) {
    while (parent_[n] != n) n = parent_[n] = parent_[parent_[n]];
    return n;
  }
  bool join(std::uint32_t a, std::uint32_t b) {
    const std::uint32_t from = root(a), to = root(b);
    if (from == to) return true;
    for (const auto& [x, y] : apart_) {
      const std::uint32_t p = root(x), q = root(y);
      if ((p == from && q == to) || (p == to && q == from)) return false;
    }
    parent_[std::max(from, to)] = std::min(from, to);
    return true;
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::span<const std::pair<std::uint32_t, std::uint32_t>> apart_;
};

// A corner at a point where the sides of a sheet may meet.
struct PointCorner {
  // `next` and `previous` are the neighbours in the face, as points.
  std::uint32_t point = 0, vertex = 0, face = 0, next = 0, previous = 0;
};

}  // namespace

std::vector<BackToBack> find_backs(std::size_t count, const LoopOf& loop_of) {
  // Few polygons share their set of points with another polygon. Only these polygons are examined.
  std::vector<std::uint32_t> loop, numbers(count), sorted;
  for (std::uint32_t i = 0; i < count; ++i) {
    loop.clear();
    loop_of(i, loop);
    numbers[i] = loop.empty() ? i : set_number(loop);
  }
  sorted = numbers;
  std::sort(sorted.begin(), sorted.end());
  struct Candidate {
    std::uint32_t number, polygon;
    std::vector<std::uint32_t> loop;
  };
  std::vector<Candidate> candidates;
  for (std::uint32_t i = 0; i < count; ++i) {
    const auto [first, last] = std::equal_range(sorted.begin(), sorted.end(), numbers[i]);
    if (last - first < 2) continue;
    loop.clear();
    loop_of(i, loop);
    if (!loop.empty() && !has_twice(loop)) candidates.push_back({numbers[i], i, loop});
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const Candidate& a, const Candidate& b) { return a.number < b.number; });
  std::vector<BackToBack> result;
  std::vector<bool> is_taken(candidates.size());
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    for (std::size_t j = i + 1; !is_taken[i] && j < candidates.size() && candidates[j].number == candidates[i].number;
         ++j) {
      if (is_taken[j] || !is_back(candidates[i].loop, candidates[j].loop)) continue;
      is_taken[i] = is_taken[j] = true;
      result.emplace_back(candidates[i].polygon, candidates[j].polygon);
    }
  }
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<std::uint32_t> split_sides(std::size_t nodes, std::vector<SideEdge> edges,
                                       std::span<const std::pair<std::uint32_t, std::uint32_t>> apart) {
  JoinedNodes joined(nodes, apart);
  std::sort(edges.begin(), edges.end(), [](const SideEdge& a, const SideEdge& b) {
    return a.neighbour != b.neighbour ? a.neighbour < b.neighbour : a.node < b.node;
  });
  for (std::size_t first = 0, end = 0; first < edges.size(); first = end) {
    for (end = first + 1; end < edges.size() && edges[end].neighbour == edges[first].neighbour;) ++end;
    for (std::size_t i = first; i < end; ++i)
      for (std::size_t j = i + 1; j < end; ++j)
        if (edges[i].leaves != edges[j].leaves) (void)joined.join(edges[i].node, edges[j].node);
  }
  for (std::uint32_t n = 1; n < nodes; ++n) {
    if (joined.root(n) != n) continue;
    for (std::uint32_t m = 0; m < n; ++m)
      if (joined.root(m) == m && joined.join(m, n)) break;
  }
  std::vector<std::uint32_t> number(nodes, kNoFace), result(nodes);
  std::uint32_t count = 0;
  for (std::uint32_t n = 0; n < nodes; ++n) {
    std::uint32_t& mine = number[joined.root(n)];
    if (mine == kNoFace) mine = count++;
    result[n] = mine;
  }
  return result;
}

void keep_sides_apart(const Topology& topology, Points& points) {
  const std::vector<std::uint32_t>& point_of = points.point_of_vertex;
  std::vector<bool> is_taken(points.count), is_shared(points.count);
  bool any = false;
  for (const std::uint32_t p : point_of) {
    any = any || is_taken[p];
    is_shared[p] = is_taken[p];
    is_taken[p] = true;
  }
  if (!any) return;
  // A sheet consists of pairs of faces that share all their points.
  const std::vector<BackToBack> found = find_backs(topology.face_count(), [&](std::uint32_t f, auto& loop) {
    for (const std::uint32_t v : topology.face(f)) {
      loop.push_back(point_of[v]);
      if (is_shared[point_of[v]]) continue;
      loop.clear();
      return;
    }
  });
  if (found.empty()) return;
  std::vector<std::uint32_t> back_of(topology.face_count(), kNoFace);
  std::vector<bool> may_meet(points.count);
  for (const auto& [face, back] : found) {
    back_of[face] = back;
    back_of[back] = face;
    for (const std::uint32_t v : topology.face(face)) may_meet[point_of[v]] = true;
  }

  std::vector<PointCorner> corners;
  for (std::uint32_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (std::size_t c = 0; c < face.size(); ++c) {
      const std::uint32_t p = point_of[face[c]];
      if (!may_meet[p]) continue;
      corners.push_back(
          {p, face[c], f, point_of[face[(c + 1) % face.size()]], point_of[face[(c + face.size() - 1) % face.size()]]});
    }
  }
  std::sort(corners.begin(), corners.end(), [](const PointCorner& a, const PointCorner& b) {
    if (a.point != b.point) return a.point < b.point;
    return a.vertex != b.vertex ? a.vertex < b.vertex : a.face < b.face;
  });
  std::vector<std::uint32_t> classes = point_of;
  std::size_t class_count = points.count;
  for (std::size_t first = 0, end = 0; first < corners.size(); first = end) {
    for (end = first + 1; end < corners.size() && corners[end].point == corners[first].point;) ++end;
    const std::span<const PointCorner> here = std::span(corners).subspan(first, end - first);
    // The nodes (SideEdge::node) at this point are its vertices.
    std::vector<std::uint32_t> vertices;
    std::vector<SideEdge> edges;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> of_faces, apart;
    for (const PointCorner& corner : here) {
      if (vertices.empty() || vertices.back() != corner.vertex) vertices.push_back(corner.vertex);
      const auto node = static_cast<std::uint32_t>(vertices.size() - 1);
      edges.push_back({node, corner.next, true});
      edges.push_back({node, corner.previous, false});
      of_faces.emplace_back(corner.face, node);
    }
    const auto has_back = [&](const auto& of_face) { return back_of[of_face.first] != kNoFace; };
    if (vertices.size() < 2 || !std::all_of(of_faces.begin(), of_faces.end(), has_back)) continue;
    std::sort(of_faces.begin(), of_faces.end());
    for (const auto& [face, node] : of_faces) {
      if (back_of[face] < face) continue;
      const auto other = std::lower_bound(of_faces.begin(), of_faces.end(), std::pair(back_of[face], 0U));
      if (other != of_faces.end() && other->first == back_of[face] && other->second != node)
        apart.emplace_back(node, other->second);
    }
    if (apart.empty()) continue;
    const std::vector<std::uint32_t> side = split_sides(vertices.size(), std::move(edges), apart);
    for (std::size_t n = 0; n < vertices.size(); ++n)
      if (side[n] > 0) classes[vertices[n]] = static_cast<std::uint32_t>(class_count + side[n] - 1);
    class_count += *std::max_element(side.begin(), side.end());
  }
  std::vector<std::uint32_t> number(class_count, kNoFace);
  points.count = 0;
  for (std::size_t v = 0; v < classes.size(); ++v) {
    std::uint32_t& mine = number[classes[v]];
    if (mine == kNoFace) mine = static_cast<std::uint32_t>(points.count++);
    points.point_of_vertex[v] = mine;
  }
}

void take_sides_apart(const Topology& topology, const Points& points, std::vector<std::uint32_t>& set_of_corner) {
  const std::vector<std::uint32_t>& point_of = points.point_of_vertex;
  const std::vector<BackToBack> found = find_backs(topology.face_count(), [&](std::uint32_t f, auto& loop) {
    for (const std::uint32_t v : topology.face(f)) loop.push_back(point_of[v]);
  });
  if (found.empty()) return;
  std::vector<std::uint32_t> back_of(topology.face_count(), kNoFace);
  for (const auto& [face, back] : found) {
    back_of[face] = back;
    back_of[back] = face;
  }
  std::vector<bool> may_have_sides(topology.corner_count());
  const auto corners = topology.corners();
  const std::vector<std::uint32_t> face_of = face_of_each_corner(topology);
  for (std::uint32_t c = 0; c < corners.size(); ++c)
    if (back_of[face_of[c]] != kNoFace) may_have_sides[set_of_corner[c]] = true;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_sets;
  for (std::uint32_t c = 0; c < corners.size(); ++c)
    if (may_have_sides[set_of_corner[c]]) of_sets.emplace_back(set_of_corner[c], c);
  std::sort(of_sets.begin(), of_sets.end());
  for (std::size_t first = 0, end = 0; first < of_sets.size(); first = end) {
    for (end = first + 1; end < of_sets.size() && of_sets[end].first == of_sets[first].first;) ++end;
    const auto here = std::span(of_sets).subspan(first, end - first);
    std::vector<SideEdge> edges;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> of_faces, apart;
    bool have_all = true;
    for (std::uint32_t n = 0; n < here.size(); ++n) {
      const std::uint32_t c = here[n].second, f = face_of[c];
      have_all = have_all && back_of[f] != kNoFace;
      const std::size_t start = first_corner(topology, f), size = topology.face(f).size(), place = c - start;
      edges.push_back({n, point_of[corners[start + (place + 1) % size]], true});
      edges.push_back({n, point_of[corners[start + (place + size - 1) % size]], false});
      of_faces.emplace_back(f, n);
    }
    if (!have_all) continue;
    std::sort(of_faces.begin(), of_faces.end());
    for (const auto& [face, node] : of_faces) {
      if (back_of[face] < face) continue;
      const auto other = std::lower_bound(of_faces.begin(), of_faces.end(), std::pair(back_of[face], 0U));
      if (other != of_faces.end() && other->first == back_of[face]) apart.emplace_back(node, other->second);
    }
    if (apart.empty()) continue;
    const std::vector<std::uint32_t> side = split_sides(here.size(), std::move(edges), apart);
    std::vector<std::uint32_t> names;
    for (std::size_t n = 0; n < side.size(); ++n) {
      if (side[n] == names.size()) names.push_back(here[n].second);
      set_of_corner[here[n].second] = names[side[n]];
    }
  }
}

}  // namespace chronormal::inline internal
