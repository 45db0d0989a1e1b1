#include "workflow/truth/author_sums.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace chronormal::inline internal {
namespace {

// Returns the vertices of the outline of some consecutive triangles. Returns an empty list if the triangles do not form
// a single polygon without a vertex inside.
std::vector<std::uint32_t> outline(const Topology& triangles, std::size_t first, std::size_t count) {
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  std::vector<Edge> edges;
  for (std::size_t t = first; t < first + count; ++t) {
    const auto face = triangles.face(t);
    for (std::size_t k = 0; k < 3; ++k) edges.emplace_back(face[k], face[(k + 1) % 3]);
  }
  std::sort(edges.begin(), edges.end());
  if (std::adjacent_find(edges.begin(), edges.end()) != edges.end()) return {};
  std::vector<Edge> border;
  for (const auto& [from, to] : edges)
    if (!std::binary_search(edges.begin(), edges.end(), Edge(to, from))) border.emplace_back(from, to);
  if (border.size() != count + 2) return {};
  // The outline begins at the first corner of the first triangle, if that corner lies on the outline.
  const std::uint32_t start = triangles.face(first)[0];
  const auto leaves = [&border](std::uint32_t from) {
    return std::lower_bound(border.begin(), border.end(), Edge(from, 0));
  };
  auto at = leaves(start);
  if (at == border.end() || at->first != start) at = border.begin();
  std::vector<std::uint32_t> loop;
  const std::uint32_t begin = at->first;
  do {
    if (loop.size() == border.size()) return {};
    loop.push_back(at->first);
    const std::uint32_t next = at->second;
    at = leaves(next);
    if (at == border.end() || at->first != next) return {};
    if (at + 1 != border.end() && (at + 1)->first == next) return {};  // the outline visits this vertex twice
  } while (at->first != begin);
  return loop.size() == count + 2 ? loop : std::vector<std::uint32_t>();
}

// Returns true if a vertex shows the normal of the back of a polygon. The polygon consists of `count` triangles from
// `first` on.
bool is_at_the_back(const GltfShading& shading, std::size_t first, std::size_t count, std::uint32_t vertex) {
  if (shading.at_the_back.empty()) return false;
  const auto corners = shading.set.topology.corners();
  for (std::size_t c = 3 * first; c < 3 * (first + count); ++c)
    if (corners[c] == vertex && shading.at_the_back[c]) return true;
  return false;
}

}  // namespace

Polygons::Polygons(const Topology& triangles) : triangles_(&triangles) {}

std::span<const std::uint32_t> Polygons::corners(std::size_t polygon) const noexcept {
  if (loop_of_.empty() || loop_of_[polygon] == GltfShading::kNoElement) return triangles_->face(polygon);
  return std::span(loops_).subspan(loop_of_[polygon], count_[polygon] + 2);
}

void Polygons::take_apart(std::size_t polygon) {
  if (count_[polygon] > 1) --joined_;
  for (std::size_t t = polygon, end = polygon + count_[polygon]; t < end; ++t) {
    first_[t] = static_cast<std::uint32_t>(t);
    count_[t] = 1;
    loop_of_[t] = GltfShading::kNoElement;
  }
}

bool Polygons::join(std::size_t first, std::size_t count) {
  std::vector<std::uint32_t> loop = outline(*triangles_, first, count);
  if (loop.empty()) return false;
  if (first_.empty()) {
    if (count == 1) return true;
    first_.resize(triangles_->face_count());
    std::iota(first_.begin(), first_.end(), 0U);
    count_.assign(first_.size(), 1);
    loop_of_.assign(first_.size(), GltfShading::kNoElement);
  }
  for (std::size_t t = first; t < first + count; ++t)
    if (count_[first_[t]] > 1) take_apart(first_[t]);
  if (count == 1) return true;
  for (std::size_t t = first; t < first + count; ++t) first_[t] = static_cast<std::uint32_t>(first);
  count_[first] = static_cast<std::uint32_t>(count);
  loop_of_[first] = static_cast<std::uint32_t>(loops_.size());
  loops_.insert(loops_.end(), loop.begin(), loop.end());
  ++joined_;
  return true;
}

std::size_t Polygons::join_quads(std::span<const GltfPart> parts) {
  std::size_t quads = 0;
  for (const GltfPart& part : parts) {
    const std::size_t end = part.first_face + part.face_count;
    for (std::size_t t = part.first_face; t + 1 < end; ++t) {
      const auto a = triangles_->face(t), b = triangles_->face(t + 1);
      if (a[0] != b[0] || a[2] != b[1] || !join(t, 2)) continue;
      ++quads;
      ++t;
    }
  }
  return quads;
}

AuthorSums::AuthorSums(const GltfShading& shading, const Polygons& polygons, Weighting weighting,
                       const std::vector<bool>& whole_point, const std::vector<bool>& wanted)
    : weighting_(weighting) {
  constexpr std::uint32_t kNone = GltfShading::kNoElement;
  const std::size_t triangles = shading.set.topology.face_count(), elements = shading.groups.size();
  const auto is_wanted = [&](std::uint32_t e) { return e != kNone && (wanted.empty() || wanted[e]); };
  // Lists, for each point, the elements whose sums have all corners at this point.
  std::vector<std::vector<std::uint32_t>> whole_at;
  std::vector<std::uint32_t> list_of_point;
  if (std::find(whole_point.begin(), whole_point.end(), true) != whole_point.end()) {
    std::vector<bool> is_listed(elements);
    list_of_point.assign(shading.point_of_vertex.size(), kNone);
    for (const std::uint32_t v : shading.set.topology.corners()) {
      const std::uint32_t e = shading.element_of_vertex[v];
      if (!is_wanted(e) || !whole_point[e] || is_listed[e]) continue;
      is_listed[e] = true;
      std::uint32_t& list = list_of_point[shading.place_of(v)];
      if (list == kNone) {
        list = static_cast<std::uint32_t>(whole_at.size());
        whole_at.emplace_back();
      }
      whole_at[list].push_back(e);
    }
  }
  // Calls add(element, corner) for each corner of polygon t that counts in the sum of some element. Returns true if
  // there is such a corner.
  const auto for_corners = [&](std::size_t t, const auto& add) {
    const auto loop = polygons.corners(t);
    bool any = false;
    for (std::uint32_t c = 0; c < loop.size(); ++c) {
      if (is_at_the_back(shading, t, polygons.triangle_count(t), loop[c])) continue;
      const std::uint32_t e = shading.element_of_vertex[loop[c]];
      if (is_wanted(e) && (whole_at.empty() || !whole_point[e])) {
        any = true;
        add(e, c);
      }
      const std::uint32_t list = whole_at.empty() ? kNone : list_of_point[shading.place_of(loop[c])];
      if (list == kNone) continue;
      any = true;
      for (const std::uint32_t whole : whole_at[list]) add(whole, c);
    }
    return any;
  };
  offsets_.assign(elements + 1, 0);
  for (std::size_t t = 0; t < triangles; t += polygons.triangle_count(t)) {
    const auto loop = polygons.corners(t);
    if (!for_corners(t, [&](std::uint32_t e, std::uint32_t) { ++offsets_[e + 1]; })) continue;
    loops_.insert(loops_.end(), loop.begin(), loop.end());
    loop_offsets_.push_back(static_cast<std::uint32_t>(loops_.size()));
  }
  for (std::size_t e = 0; e < elements; ++e) offsets_[e + 1] += offsets_[e];
  sums_.resize(offsets_.back());
  std::vector<std::uint32_t> next(offsets_.begin(), offsets_.end() - 1);
  std::uint32_t number = 0;
  for (std::size_t t = 0; t < triangles; t += polygons.triangle_count(t))
    if (for_corners(t, [&](std::uint32_t e, std::uint32_t c) { sums_[next[e]++] = {number, c}; })) ++number;
}

std::vector<bool> AuthorSums::elements_around(const std::vector<bool>& vertices) const {
  std::vector<bool> polygon_moves(loop_offsets_.size() - 1), result(offsets_.size() - 1);
  for (std::uint32_t p = 0; p < polygon_moves.size(); ++p)
    for (const std::uint32_t v : polygon(p))
      if (vertices[v]) polygon_moves[p] = true;
  for (std::size_t e = 0; e < result.size(); ++e)
    for (std::uint32_t i = offsets_[e]; i < offsets_[e + 1]; ++i)
      if (polygon_moves[sums_[i].polygon]) result[e] = true;
  return result;
}

}  // namespace chronormal::inline internal
