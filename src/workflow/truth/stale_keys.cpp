#include "workflow/truth/stale_keys.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "core/blocks.h"
#include "core/vector_area.h"
#include "workflow/truth/stored_keys.h"

namespace chronormal::inline internal {
namespace {

constexpr double kTurns = 1 / kDegreesPerRadian;  // radians: a smaller turn of a vertex does not show if a key is stale

double median_of(std::vector<float>& values) {
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return static_cast<double>(*middle);
}

// Finds the connected parts of the surface. Returns for each vertex the number of its part, and writes the number of
// parts to `count`.
std::vector<std::uint32_t> connected_parts(const GltfShading& shading, std::size_t& count) {
  std::vector<std::uint32_t> parent(shading.point_of_vertex.size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&parent](std::uint32_t p) {
    while (parent[p] != p) p = parent[p] = parent[parent[p]];
    return p;
  };
  const Topology& topology = shading.set.topology;
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    const std::uint32_t a = root(shading.point_of_vertex[face[0]]);
    for (const std::uint32_t v : face) parent[root(shading.point_of_vertex[v])] = a;
  }
  std::vector<std::uint32_t> number(parent.size(), GltfShading::kNoElement), result(parent.size());
  count = 0;
  for (std::uint32_t v = 0; v < result.size(); ++v) {
    std::uint32_t& mine = number[root(shading.point_of_vertex[v])];
    if (mine == GltfShading::kNoElement) mine = static_cast<std::uint32_t>(count++);
    result[v] = mine;
  }
  return result;
}

// Returns for each vertex the area-weighted sum of the normals of its faces.
std::vector<Vec3d> sums_of_vertices(const Topology& topology, const StoredKey& key) {
  std::vector<Vec3d> sums(topology.vertex_count());
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    const Vec3d n = twice_vector_area(3, [&](std::size_t c) { return key.position(face[c]); });
    for (const std::uint32_t v : face) sums[v] = sums[v] + n;
  }
  return sums;
}

// Returns for each vertex the sum of face normals of its element.
std::vector<Vec3d> sums_of_elements(const GltfShading& shading, const AuthorSums& sums, const StoredKey& key) {
  const std::vector<std::uint32_t> vertex_of = vertices_of_elements(shading);
  std::vector<Vec3d> of_elements(vertex_of.size()), result(shading.element_of_vertex.size());
  sums.for_all([&](std::uint32_t v) { return key.position(v); },
               [&](std::uint32_t e, const AuthorSum& sum) {
                 if (vertex_of[e] != GltfShading::kNoElement) of_elements[e] = sum.normal;
               });
  for (std::size_t v = 0; v < result.size(); ++v)
    if (shading.element_of_vertex[v] != GltfShading::kNoElement) result[v] = of_elements[shading.element_of_vertex[v]];
  return result;
}

// Measures of how a target turns one connected part of the mesh, over the vertices whose sums of face normals turn.
struct PartOfKey {
  std::vector<float> turned, off;  // radians: the turn of each vertex that turns, and the error of its normal
  double together = 0, of_surface = 0, of_stored = 0;

  [[nodiscard]] bool is_stale() {
    if (turned.empty()) return false;
    constexpr double kNoNearer = 0.75, kTogether = 0.5;
    if (median_of(off) < kNoNearer * median_of(turned)) return false;
    return together < kTogether * std::sqrt(of_surface * of_stored) || of_stored == 0;
  }
};

}  // namespace

StaleKeys::StaleKeys(const GltfShading& shading, const AuthorSums* sums)
    : stale_(shading.set.targets.size()), is_all_stale_(shading.set.targets.size()) {
  const std::vector<std::size_t> targets = targets_with_normals(shading);
  if (targets.empty()) return;
  std::size_t parts = 0;
  part_of_vertex_ = connected_parts(shading, parts);
  const StoredKey base(shading);
  const auto sums_at = [&](const StoredKey& key) {
    return sums == nullptr ? sums_of_vertices(shading.set.topology, key) : sums_of_elements(shading, *sums, key);
  };
  const std::vector<Vec3d> before = sums_at(base);
  for (const std::size_t k : targets) {
    const StoredKey key(shading, k);
    const std::vector<Vec3d> after = sums_at(key);
    std::vector<PartOfKey> found(parts);
    for (std::uint32_t v = 0; v < before.size(); ++v) {
      if (shading.element_of_vertex[v] == GltfShading::kNoElement || before[v] == after[v]) continue;
      const Vec3d z0 = unit(before[v]), z = unit(after[v]), s0 = unit(base.normal(v)), s = unit(key.normal(v));
      if (z0 == Vec3d{} || z == Vec3d{} || s0 == Vec3d{} || s == Vec3d{}) continue;
      const double turned = angle_between(z0, z);
      if (!(turned > kTurns)) continue;
      PartOfKey& part = found[part_of_vertex_[v]];
      part.turned.push_back(static_cast<float>(turned));
      part.off.push_back(static_cast<float>(angle_between(shown_direction(s0, z0, z), s)));
      const Vec3d of_surface = cross(z0, z), of_stored = cross(s0, s);
      part.together += dot(of_surface, of_stored);
      part.of_surface += dot(of_surface, of_surface);
      part.of_stored += dot(of_stored, of_stored);
    }
    StaleKey all{k, 0};
    is_all_stale_[k] = true;
    for (std::size_t p = 0; p < parts; ++p) {
      if (!found[p].is_stale()) {
        if (!found[p].turned.empty()) is_all_stale_[k] = false;
        continue;
      }
      stale_[k].resize(parts);
      stale_[k][p] = true;
      all.vertices += found[p].turned.size();
    }
    if (all.vertices > 0) list_.push_back(all);
  }
}

void StaleKeys::keep_common(const StaleKeys& others) {
  std::vector<StaleKey> kept;
  for (const StaleKey& key : list_) {
    std::vector<bool>& mine = stale_[key.target];
    const std::vector<bool>& other = others.stale_[key.target];
    for (std::size_t p = 0; p < mine.size(); ++p) mine[p] = mine[p] && !other.empty() && other[p];
    is_all_stale_[key.target] = is_all_stale_[key.target] && others.is_all_stale_[key.target];
    if (std::find(mine.begin(), mine.end(), true) != mine.end()) kept.push_back(key);
  }
  list_ = std::move(kept);
}

bool split_by_keys(GltfShading& shading) {
  const std::vector<std::size_t> targets = targets_with_normals(shading);
  if (targets.empty() || shading.groups.size() == 0) return false;
  const std::vector<std::uint32_t> vertex_of = vertices_of_elements(shading);
  // Only vertices that share an element with other vertices can be split off.
  std::vector<std::uint32_t> sharing;
  for (std::uint32_t v = 0; v < shading.element_of_vertex.size(); ++v) {
    const std::uint32_t e = shading.element_of_vertex[v];
    if (e != GltfShading::kNoElement && vertex_of[e] != v) sharing.push_back(v);
  }
  if (sharing.empty()) return false;
  const double chord = kSplitNormalTolerance / kDegreesPerRadian;
  std::optional<StaleKeys> stale;  // computed when it is first needed
  std::vector<std::uint32_t> classes(shading.groups.element_of_output().begin(),
                                     shading.groups.element_of_output().end());
  std::size_t count = shading.groups.size();
  // A class is a set of vertices that share an element. first_of has for each class the vertex with which the other
  // vertices of the class are compared.
  std::vector<std::uint32_t> first_of = vertex_of;
  for (const std::size_t k : targets) {
    const StoredKey key(shading, k);
    // Lists, for each class that this target splits, the first vertex of each new class.
    std::vector<std::vector<std::uint32_t>> apart;
    std::vector<std::uint32_t> apart_of;
    for (const std::uint32_t v : sharing) {
      const std::uint32_t mine = classes[v], first = first_of[mine];
      if (first == v || length(unit(key.normal(v)) - unit(key.normal(first))) <= chord) continue;
      if (!stale) stale.emplace(shading);
      if (stale->is_stale(k, v)) continue;
      if (apart_of.empty()) apart_of.assign(count, GltfShading::kNoElement);
      if (mine >= apart_of.size()) continue;
      if (apart_of[mine] == GltfShading::kNoElement) {
        apart_of[mine] = static_cast<std::uint32_t>(apart.size());
        apart.emplace_back();
      }
      std::vector<std::uint32_t>& begun = apart[apart_of[mine]];
      const auto same = std::find_if(begun.begin(), begun.end(), [&](std::uint32_t other) {
        return length(unit(key.normal(v)) - unit(key.normal(other))) <= chord;
      });
      if (same != begun.end()) {
        classes[v] = classes[*same];
        continue;
      }
      begun.push_back(v);
      classes[v] = static_cast<std::uint32_t>(count++);
      first_of.push_back(v);
    }
  }
  if (count == shading.groups.size()) return false;
  shading.groups = NormalGroups::of_vertices(shading.set.topology, {classes, count}, shading.at_the_back);
  for (std::uint32_t v = 0; v < classes.size(); ++v)
    if (shading.element_of_vertex[v] != GltfShading::kNoElement) shading.element_of_vertex[v] = classes[v];
  return true;
}

}  // namespace chronormal::inline internal
