#include "chronormal/analysis/surface.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <tuple>

#include "chronormal/core/parallel.h"

namespace chronormal {
namespace {

// Calls with_group(first, last) for every run of equal elements in a sorted range.
template <class Iterator, class Equal, class WithGroup>
void for_each_group(Iterator first, Iterator last, Equal equal, WithGroup with_group) {
  while (first != last) {
    Iterator next = first;
    while (next != last && equal(*first, *next)) ++next;
    with_group(first, next);
    first = next;
  }
}

// Items sorted into buckets. Bucket b has items[offsets[b]] ... items[offsets[b + 1] - 1], in the order in which put()
// added them.
template <class Item>
struct Buckets {
  std::vector<std::size_t> offsets;
  std::vector<Item> items;

  // Fills `count` buckets. visit(put) is called twice, and must call put(bucket, item) for the same items each time.
  template <class Visit>
  Buckets(std::size_t count, Visit visit) : offsets(count + 1, 0) {
    visit([this](std::size_t bucket, const Item&) { ++offsets[bucket + 1]; });
    std::partial_sum(offsets.begin(), offsets.end(), offsets.begin());
    items.resize(offsets.back());
    std::vector<std::size_t> next(offsets.begin(), offsets.end() - 1);
    visit([this, &next](std::size_t bucket, const Item& item) { items[next[bucket]++] = item; });
  }
};

// A use of an edge by a face. The edge goes from its lower point, whose bucket contains this use, to its higher point
// `far`.
struct EdgeUse {
  std::uint32_t far = 0;
  std::uint32_t face = 0;
  std::uint32_t near_vertex = 0, far_vertex = 0;  // the face's vertices at the lower and the higher point
  // True if the face passes the edge from the lower point to the higher point.
  bool is_forward = false;
};

// Counts the open, non-manifold, turned and seam edges of a mesh (analysis/surface.h). is_copy tells for each face
// whether a face with a lower index has the same outline and winding. An edge that only a face and its copy have is not
// counted as turned, although both faces pass it in the same direction.
void survey_edges(const Topology& topology, const Points& points, const std::vector<bool>& is_copy, Surface& surface) {
  Buckets<EdgeUse> uses(points.count, [&](auto put) {
    for (std::size_t f = 0; f < topology.face_count(); ++f) {
      const auto face = topology.face(f);
      for (std::size_t c = 0; c < face.size(); ++c) {
        const std::uint32_t a = face[c], b = face[c + 1 == face.size() ? 0 : c + 1];
        const std::uint32_t p = points.point_of_vertex[a], q = points.point_of_vertex[b];
        if (p < q) put(p, EdgeUse{q, static_cast<std::uint32_t>(f), a, b, true});
        if (p > q) put(q, EdgeUse{p, static_cast<std::uint32_t>(f), b, a, false});
      }
    }
  });
  const auto same_edge = [](const EdgeUse& a, const EdgeUse& b) { return a.far == b.far; };
  for (std::size_t near = 0; near < points.count; ++near) {
    const auto begin = uses.items.begin() + static_cast<std::ptrdiff_t>(uses.offsets[near]);
    const auto end = uses.items.begin() + static_cast<std::ptrdiff_t>(uses.offsets[near + 1]);
    std::sort(begin, end, [](const EdgeUse& a, const EdgeUse& b) {
      return std::tie(a.far, a.face, a.is_forward) < std::tie(b.far, b.face, b.is_forward);
    });
    for_each_group(begin, end, same_edge, [&](auto first, auto last) {
      ++surface.edges;
      std::size_t faces = 0;  // a face that names a point twice may use an edge more than once
      for (auto use = first; use != last; ++use) faces += use == first || use->face != (use - 1)->face ? 1U : 0U;
      if (faces == 1) surface.open_edges.add(first->face);
      if (faces > 2) surface.non_manifold_edges.add(first->face);
      if (faces != 2 || last - first != 2) return;
      const EdgeUse &a = *first, &b = *(first + 1);
      if (a.is_forward == b.is_forward && !is_copy[b.face]) surface.turned_edges.add(a.face);
      if (a.near_vertex != b.near_vertex || a.far_vertex != b.far_vertex) surface.seam_edges.add(a.face);
    });
  }
}

// Returns true if `outline`, the points of a face, names a point twice. `sorted` is scratch memory.
bool has_twice(std::span<const std::uint32_t> outline, std::vector<std::uint32_t>& sorted) {
  if (outline.size() == 3) return outline[0] == outline[1] || outline[1] == outline[2] || outline[2] == outline[0];
  sorted.assign(outline.begin(), outline.end());
  std::sort(sorted.begin(), sorted.end());
  return std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end();
}

// Rotates the points of a face, which are all different, so that the lowest point comes first. Then reverses the other
// points if necessary, so that the lower of the two neighbours of the first point comes second. Faces with the same
// outline are then equal. Returns true if the points were not reversed; faces with equal outlines and equal results
// have the same winding.
bool make_canonical(std::span<std::uint32_t> outline) {
  std::rotate(outline.begin(), std::min_element(outline.begin(), outline.end()), outline.end());
  if (outline[1] < outline.back()) return true;
  std::reverse(outline.begin() + 1, outline.end());
  return false;
}

void survey_faces(const Topology& topology, const Points& points, std::vector<bool>& is_copy, Surface& surface) {
  // `corners` has the outlines of all faces as make_canonical() leaves them, and `starts` the place where each outline
  // begins.
  std::vector<std::uint32_t> corners;
  corners.reserve(topology.corner_count());
  std::vector<std::size_t> starts = {0};
  starts.reserve(topology.face_count() + 1);
  std::vector<bool> repeats(topology.face_count()), starts_low(topology.face_count());
  std::vector<std::uint32_t> sorted;
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (const std::uint32_t vertex : face) corners.push_back(points.point_of_vertex[vertex]);
    const std::span<std::uint32_t> outline = std::span(corners).subspan(starts.back());
    if (has_twice(outline, sorted)) {
      repeats[f] = true;
      surface.repeating_faces.add(f);
    } else {
      starts_low[f] = make_canonical(outline);
    }
    starts.push_back(corners.size());
    surface.triangles += face.size() == 3 ? 1U : 0U;
    surface.most_corners = std::max(surface.most_corners, face.size());
  }
  const auto outline_of = [&](std::uint32_t f) {
    return std::span<const std::uint32_t>(corners).subspan(starts[f], starts[f + 1] - starts[f]);
  };
  const auto same_outline = [&](std::uint32_t a, std::uint32_t b) {
    return std::equal(outline_of(a).begin(), outline_of(a).end(), outline_of(b).begin(), outline_of(b).end());
  };

  Buckets<std::uint32_t> faces(points.count, [&](auto put) {
    for (std::size_t f = 0; f < topology.face_count(); ++f) {
      if (!repeats[f]) put(corners[starts[f]], static_cast<std::uint32_t>(f));
    }
  });
  for (std::size_t lowest = 0; lowest < points.count; ++lowest) {
    const auto begin = faces.items.begin() + static_cast<std::ptrdiff_t>(faces.offsets[lowest]);
    const auto end = faces.items.begin() + static_cast<std::ptrdiff_t>(faces.offsets[lowest + 1]);
    std::sort(begin, end, [&](std::uint32_t a, std::uint32_t b) {
      const auto p = outline_of(a), q = outline_of(b);
      if (!same_outline(a, b)) return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
      return a < b;
    });
    for_each_group(begin, end, same_outline, [&](auto first, auto last) {
      std::array<std::size_t, 2> seen{};  // number of faces so far, by winding
      for (auto f = first; f != last; ++f) {
        std::size_t& alike = seen[starts_low[*f] ? 1 : 0];
        if (alike++ == 0) continue;
        surface.doubled_faces.add(*f);
        is_copy[*f] = true;
      }
      if (const std::size_t pairs = std::min(seen[0], seen[1]); pairs > 0) surface.back_to_back.add(*first, pairs);
    });
  }
}

void survey_pieces(const Topology& topology, const Points& points, Surface& surface) {
  std::vector<std::uint32_t> parent(points.count);
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root_of = [&parent](std::uint32_t p) {
    while (parent[p] != p) {
      parent[p] = parent[parent[p]];
      p = parent[p];
    }
    return p;
  };
  std::vector<bool> is_referenced(topology.vertex_count()), has_face(points.count);
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (const std::uint32_t vertex : face) {
      is_referenced[vertex] = true;
      has_face[points.point_of_vertex[vertex]] = true;
      const std::uint32_t a = root_of(points.point_of_vertex[face[0]]), b = root_of(points.point_of_vertex[vertex]);
      parent[std::max(a, b)] = std::min(a, b);
    }
  }
  for (std::size_t p = 0; p < points.count; ++p) surface.pieces += has_face[p] && parent[p] == p ? 1U : 0U;
  for (std::size_t v = 0; v < is_referenced.size(); ++v) {
    if (!is_referenced[v]) surface.unreferenced.add(v);
  }
}

}  // namespace

Found find_copies(const Points& points) {
  Found copies;
  std::uint32_t next = 0;  // points are numbered in the order of their first vertices
  for (std::size_t v = 0; v < points.point_of_vertex.size(); ++v) {
    if (points.point_of_vertex[v] == next)
      ++next;
    else
      copies.add(v);
  }
  return copies;
}

Surface survey(const Topology& topology, const Points& points) {
  assert(points.point_of_vertex.size() == topology.vertex_count());
  Surface surface;
  std::vector<bool> is_copy(topology.face_count());
  // Faces and connected pieces are surveyed at the same time, since the two functions write different members. The
  // edges are surveyed later, because they need the copies among the faces.
  parallel_for(2, [&](std::size_t i) {
    if (i == 0)
      survey_faces(topology, points, is_copy, surface);
    else
      survey_pieces(topology, points, surface);
  });
  survey_edges(topology, points, is_copy, surface);
  return surface;
}

}  // namespace chronormal
