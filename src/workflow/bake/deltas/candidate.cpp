#include "workflow/bake/deltas/candidate.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "workflow/bake/deltas/shared_parts.h"

namespace chronormal::inline internal {
namespace {

std::vector<std::vector<float>> of_parts(const GltfShading& shading, const std::vector<float>& all) {
  std::vector<std::vector<float>> result;
  for (const GltfPart& part : shading.parts) {
    const auto first = all.begin() + static_cast<std::ptrdiff_t>(3 * part.first_vertex);
    const auto last = first + static_cast<std::ptrdiff_t>(3 * part.vertex_count);
    const bool any = std::any_of(first, last, [](float c) { return c != 0; });
    result.push_back(any ? std::vector<float>(first, last) : std::vector<float>());
  }
  return result;
}

void set_vector(std::vector<float>& all, std::size_t vertex, const Vec3f& vector) {
  VectorView<float>::packed(all.data(), all.size() / 3).set(vertex, vector);
}

// Returns the number of bytes added to the animation tracks that drive the correction targets.
std::size_t bytes_of_tracks(const MeshWeights& weights, const ExtraDrivers& drivers) {
  std::size_t bytes = 0;
  for (std::size_t t = 0; t < weights.tracks.size() && drivers.size() > 0; ++t) {
    const WeightTrack& before = weights.tracks[t];
    const ExtendedTrack after = drivers.extended(weights.names[t], before, std::numeric_limits<double>::infinity());
    const std::size_t of_key = before.interpolation == GltfInterpolation::kCubicSpline ? 3 : 1;
    bytes += sizeof(float) * (after.values.size() + after.times.size() - of_key * before.targets * before.size());
  }
  return bytes;
}

}  // namespace

VertexColumns columns_of(const Candidate& candidate, std::span<const std::uint32_t> vertices) {
  std::vector<const VertexVectors*> columns;
  for (const VertexVectors& column : candidate.own) columns.push_back(&column);
  for (const VertexVectors& column : candidate.extras) columns.push_back(&column);
  return by_vertex(columns, vertices);
}

std::vector<VertexVectors> stored_deltas(const GltfShading& shading) {
  std::vector<VertexVectors> result(shading.normal_deltas.size());
  for (std::size_t k = 0; k < result.size(); ++k) {
    const std::vector<float>& deltas = shading.normal_deltas[k];
    for (std::size_t v = 0; 3 * v < deltas.size(); ++v) {
      const Vec3f delta = {deltas[3 * v], deltas[3 * v + 1], deltas[3 * v + 2]};
      if (shading.element_of_vertex[v] == GltfShading::kNoElement || delta == Vec3f{}) continue;
      result[k].vertices.push_back(static_cast<std::uint32_t>(v));
      result[k].vectors.push_back(delta);
    }
  }
  return result;
}

VertexVectors as_column(const GltfShading& shading, const TargetDeltas& deltas) {
  VertexVectors result;
  for (std::size_t p = 0; p < deltas.of_parts.size(); ++p) {
    const std::vector<float>& all = deltas.of_parts[p];
    for (std::size_t v = 0; 3 * v < all.size(); ++v) {
      const Vec3f delta = {all[3 * v], all[3 * v + 1], all[3 * v + 2]};
      if (delta == Vec3f{}) continue;
      result.vertices.push_back(static_cast<std::uint32_t>(shading.parts[p].first_vertex + v));
      result.vectors.push_back(delta);
    }
  }
  return result;
}

std::vector<std::uint32_t> judged_vertices(const DeltaSource& source, const std::vector<VertexVectors>& stored) {
  const GltfShading& shading = source.shading;
  std::vector<bool> element_moves(shading.groups.size(), false), is_judged(shading.element_of_vertex.size(), false);
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i) {
    if (!moves(shading, i)) continue;
    for (const std::uint32_t e : source.terms.elements(i)) element_moves[e] = true;
  }
  for (const VertexVectors& column : stored)
    for (const std::uint32_t v : column.vertices) is_judged[v] = true;
  std::vector<std::uint32_t> result;
  for (std::uint32_t v = 0; v < is_judged.size(); ++v) {
    const std::uint32_t e = shading.element_of_vertex[v];
    if (e != GltfShading::kNoElement && (is_judged[v] || element_moves[e])) result.push_back(v);
  }
  return result;
}

std::vector<std::vector<std::uint32_t>> numbers_of_targets(const DeltaSource& source,
                                                           const std::vector<VertexVectors>& stored,
                                                           std::span<const std::uint32_t> vertices) {
  const GltfShading& shading = source.shading;
  std::vector<std::vector<std::uint32_t>> result(shading.set.targets.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    std::vector<bool> element_moves(shading.groups.size(), false);
    if (moves(shading, i))
      for (const std::uint32_t e : source.terms.elements(i)) element_moves[e] = true;
    for (std::uint32_t n = 0; n < vertices.size(); ++n) {
      const bool is_turned = element_moves[shading.element_of_vertex[vertices[n]]];
      if (is_turned || stored[i].at(vertices[n]) != Vec3f{}) result[i].push_back(n);
    }
  }
  return result;
}

std::optional<TargetDeltas> own_deltas(const GltfShading& shading, const Candidate& candidate, std::size_t target) {
  const std::vector<float>& stored = shading.normal_deltas[target];
  std::vector<float> all = stored.empty() ? std::vector<float>(shading.normals.size()) : stored;
  for (std::size_t c = 0; c < all.size(); ++c) {
    const bool is_shown = shading.element_of_vertex[c / 3] != GltfShading::kNoElement;
    if (is_shown || !std::isfinite(all[c])) all[c] = 0;
  }
  const VertexVectors& own = candidate.own[target];
  for (std::size_t n = 0; n < own.vertices.size(); ++n) set_vector(all, own.vertices[n], own.vectors[n]);
  const bool is_as_it_was =
      stored.empty() ? std::all_of(all.begin(), all.end(), [](float c) { return c == 0; }) : all == stored;
  if (is_as_it_was) return std::nullopt;
  return TargetDeltas{of_parts(shading, all), 0};
}

TargetDeltas extra_deltas(const GltfShading& shading, const Candidate& candidate, std::size_t extra) {
  std::vector<float> all(shading.normals.size());
  const auto& [vertices, vectors] = candidate.extras[extra];
  for (std::size_t n = 0; n < vertices.size(); ++n) set_vector(all, vertices[n], vectors[n]);
  return {of_parts(shading, all), 0};
}

bool changes(const GltfShading& shading, const Candidate& candidate) {
  if (candidate.drivers.size() > 0) return true;
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i)
    if (own_deltas(shading, candidate, i)) return true;
  return false;
}

std::size_t bytes_of(const GltfShading& shading, const MeshWeights& weights, const Candidate& candidate) {
  constexpr std::size_t kTerm = 40;  // the bytes of a term, which is written to the mesh and to its node
  std::size_t total = bytes_of_tracks(weights, candidate.drivers);
  for (const GltfExtraTarget& sum : candidate.drivers.sums) total += kTerm * (sum.linear.size() + sum.quadratic.size());
  const SharedParts parts(shading);
  const auto add = [&](TargetDeltas deltas) {
    parts.join(deltas);
    total += parts.bytes_of(deltas);
  };
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i)
    if (std::optional<TargetDeltas> deltas = own_deltas(shading, candidate, i)) add(std::move(*deltas));
  for (std::size_t k = 0; k < candidate.extras.size(); ++k) add(extra_deltas(shading, candidate, k));
  return total;
}

}  // namespace chronormal::inline internal
