#include "workflow/bake/deltas/tangents.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "chronormal/analysis/quality.h"
#include "chronormal/motion/motion.h"
#include "workflow/truth/stored_keys.h"

namespace chronormal::inline internal {
namespace {

constexpr double kStale = 1;            // degrees by which a tangent may lean more than in the base
constexpr double kThinnest = 1e-12;     // squared sine of the smallest angle between two edges that carry a tangent
constexpr double kLeastUpright = 1e-6;  // shortest part of a tangent across the normal, relative to the tangent

Vec3d tangent_of(const GltfShading& shading, std::size_t vertex) {
  const float* const t = shading.tangents.data() + 4 * vertex;
  return to_double(Vec3f{t[0], t[1], t[2]});
}

Vec3d normal_of(const DeltaSource& source, std::size_t vertex) {
  const float* const n = source.base_normals.data() + 3 * vertex;
  return to_double(Vec3f{n[0], n[1], n[2]});
}

// Returns the unit normals of the vertices as the file stores them at weight 1 of a target.
std::vector<Vec3d> stored_normals(const GltfShading& shading, std::size_t target) {
  const StoredKey key(shading, target);
  std::vector<Vec3d> result(shading.element_of_vertex.size());
  for (std::uint32_t v = 0; v < result.size(); ++v)
    if (const Vec3d normal = unit(key.normal(v)); is_finite(normal)) result[v] = normal;
  return result;
}

// Returns the true unit normals of the vertices at weight 1 of a target. A vertex without a normal gets (0, 0, 0).
std::vector<Vec3d> right_normals(const DeltaSource& source, std::size_t target) {
  const GltfShading& shading = source.shading;
  std::vector<double> weights(shading.set.targets.size(), 0.0);
  weights[target] = 1;
  const std::vector<Vec3d> of_elements = source.terms.exact_at(weights);
  std::vector<Vec3d> result(shading.element_of_vertex.size());
  for (std::size_t v = 0; v < result.size(); ++v) {
    const std::uint32_t element = shading.element_of_vertex[v];
    if (element == GltfShading::kNoElement) continue;
    const Vec3d stored = normal_of(source, v);
    const Vec3d shown = shown_direction(stored, source.terms.base_of(element), of_elements[element]);
    const double size = length(shown);
    if (size > 0 && std::isfinite(size)) result[v] = (1 / size) * shown;
  }
  return result;
}

// Moves a vector that lies in the plane of two edges. The edges change from `from` to `to`, and the vector keeps its
// coordinates in terms of the edges. Returns zero if the face between the edges is too thin.
Vec3d carried(const Vec3d& vector, const std::array<Vec3d, 2>& from, const std::array<Vec3d, 2>& to) {
  const double aa = dot(from[0], from[0]), ab = dot(from[0], from[1]), bb = dot(from[1], from[1]);
  const double determinant = aa * bb - ab * ab;
  if (!(determinant > kThinnest * aa * bb)) return {};
  const double a = dot(from[0], vector), b = dot(from[1], vector);
  return ((a * bb - b * ab) / determinant) * to[0] + ((b * aa - a * ab) / determinant) * to[1];
}

// Returns the tangents of all vertices at weight 1 of a target, after they have moved with their faces. The tangents
// have any length. If the target moves no face around a vertex, returns the tangent of the base for this vertex.
std::vector<Vec3d> carried_tangents(const GltfShading& shading, std::size_t target) {
  const std::size_t vertices = shading.element_of_vertex.size();
  std::vector<double> weights(shading.set.targets.size(), 0.0), after(3 * vertices);
  weights[target] = 1;
  blend_positions(shading.set, weights, after);
  std::vector<bool> is_moved(vertices, false), is_turned(vertices, false);
  for (const std::uint32_t v : shading.set.targets[target].vertices) is_moved[v] = true;
  const Topology& topology = shading.set.topology;
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    if (std::none_of(face.begin(), face.end(), [&](std::uint32_t v) { return is_moved[v]; })) continue;
    for (const std::uint32_t v : face) is_turned[v] = true;
  }
  std::vector<Vec3d> sums(vertices);
  const auto edges = [](const auto& positions, std::uint32_t from, std::uint32_t next, std::uint32_t last) {
    const auto at = [&](std::uint32_t v) {
      return Vec3d{positions[3 * std::size_t{v}], positions[3 * std::size_t{v} + 1], positions[3 * std::size_t{v} + 2]};
    };
    return std::array{at(next) - at(from), at(last) - at(from)};
  };
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (std::size_t c = 0; c < face.size(); ++c) {
      const std::uint32_t v = face[c];
      if (!is_turned[v]) continue;
      const std::uint32_t next = face[(c + 1) % face.size()], last = face[(c + face.size() - 1) % face.size()];
      const std::array<Vec3d, 2> before = edges(shading.set.base, v, next, last);
      sums[v] = sums[v] + angle_between(before[0], before[1]) *
                              carried(tangent_of(shading, v), before, edges(after, v, next, last));
    }
  }
  for (std::size_t v = 0; v < vertices; ++v)
    if (!is_turned[v]) sums[v] = tangent_of(shading, v);
  return sums;
}

bool has_tangents(const GltfShading& shading, const GltfPart& part) {
  if (shading.tangents.empty()) return false;
  const auto first = shading.tangents.begin() + static_cast<std::ptrdiff_t>(4 * part.first_vertex);
  return std::any_of(first, first + static_cast<std::ptrdiff_t>(4 * part.vertex_count),
                     [](float component) { return component != 0; });
}

}  // namespace

std::vector<bool> find_stale_tangents(const DeltaSource& source, std::span<const Viewer> viewers, bool keeps_normals) {
  const GltfShading& shading = source.shading;
  std::vector<bool> result(shading.set.targets.size(), false);
  if (shading.tangents.empty() ||
      std::none_of(viewers.begin(), viewers.end(), [](const Viewer& viewer) { return viewer.adds_tangents; }))
    return result;
  const auto lean = [](const Vec3d& a, const Vec3d& b) {
    return std::fabs(angle_between(a, b) * kDegreesPerRadian - 90);
  };
  for (std::size_t k = 0; k < shading.own_targets(); ++k) {
    if (!moves(shading, k)) continue;
    const std::vector<Vec3d> rights = keeps_normals ? stored_normals(shading, k) : right_normals(source, k);
    for (std::size_t v = 0; v < rights.size() && !result[k]; ++v) {
      const Vec3d before = tangent_of(shading, v), stored = normal_of(source, v);
      Vec3d after = before;
      if (!shading.tangent_deltas[k].empty()) {
        const float* const delta = shading.tangent_deltas[k].data() + 3 * v;
        after = after + to_double(Vec3f{delta[0], delta[1], delta[2]});
      }
      if (before == Vec3d{} || stored == Vec3d{} || rights[v] == Vec3d{}) continue;
      result[k] = after == Vec3d{} || lean(after, rights[v]) - lean(before, stored) > kStale;
    }
  }
  return result;
}

TargetDeltas tangent_deltas(const DeltaSource& source, std::size_t target, bool keeps_normals) {
  const GltfShading& shading = source.shading;
  const std::vector<Vec3d> rights = keeps_normals ? stored_normals(shading, target) : right_normals(source, target),
                           tangents = carried_tangents(shading, target);
  TargetDeltas result;
  for (const GltfPart& part : shading.parts) {
    std::vector<float>& deltas = result.of_parts.emplace_back();
    if (!has_tangents(shading, part)) continue;
    deltas.resize(3 * part.vertex_count, 0.0F);
    for (std::size_t i = 0; i < part.vertex_count; ++i) {
      const std::size_t v = part.first_vertex + i;
      const Vec3d before = tangent_of(shading, v), stored = normal_of(source, v);
      if (before == Vec3d{} || stored == Vec3d{} || rights[v] == Vec3d{}) continue;
      const auto upright = [&](const Vec3d& tangent) { return tangent - dot(tangent, rights[v]) * rights[v]; };
      Vec3d after = upright(tangents[v]);
      if (!(length(after) > kLeastUpright * length(tangents[v])))
        after = upright(ShownTurn(rights[v], (1 / length(stored)) * stored)(before));
      const double size = length(after);
      if (!(size > 0)) continue;
      const Vec3d delta = (1 / size) * after - before;
      deltas[3 * i] = static_cast<float>(delta.x);
      deltas[3 * i + 1] = static_cast<float>(delta.y);
      deltas[3 * i + 2] = static_cast<float>(delta.z);
    }
  }
  return result;
}

}  // namespace chronormal::inline internal
