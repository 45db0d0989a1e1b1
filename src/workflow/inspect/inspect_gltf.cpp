#include "chronormal/workflow/inspect.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <utility>

#include "chronormal/analysis/quality.h"
#include "chronormal/core/polynomial.h"
#include "chronormal/core/vec3.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {
namespace {

// The tolerance for the length of a normal. Signed bytes round a component by up to 1 / 254. This changes the length of
// a normal by up to sqrt(3) times as much.
constexpr double kLengthTolerance = 1.7320508075688772 / 254;

Status inspect_vertices(GltfGeometry geometry, GltfPrimitiveInspection& result) {
  const std::size_t vertex_count = geometry.positions.size() / 3;
  const auto normals = VectorView<const float>::packed(geometry.normals.data(), geometry.normals.size() / 3);
  for (std::size_t v = 0; v < normals.count; ++v) {
    if (!(std::fabs(length(to_double(normals[v])) - 1) <= kLengthTolerance)) ++result.off_length;
  }
  auto topology = Topology::triangles(vertex_count, std::move(geometry.corners));
  if (!topology) return topology.error();
  const Points points = weld_coincident({std::move(topology).value(), {{std::move(geometry.positions), 0, ""}}, {}});
  std::vector<std::size_t> first_vertex(points.count, vertex_count);
  for (std::size_t v = 0; v < vertex_count; ++v) {
    std::size_t& first = first_vertex[points.point_of_vertex[v]];
    if (first == vertex_count) {
      first = v;
      continue;
    }
    ++result.doubled;
    if (normals.count == 0) continue;
    const double angle = angle_between(to_double(normals[v]), to_double(normals[first]));
    if (angle * kDegreesPerRadian > kSplitNormalTolerance) ++result.split;
  }
  return Success{};
}

Result<GltfPrimitiveInspection> inspect_primitive(const GltfDocument& document, std::size_t mesh,
                                                  std::size_t primitive) {
  const GltfPrimitive& described = document.meshes()[mesh].primitives[primitive];
  GltfPrimitiveInspection result;
  result.mesh = mesh;
  result.primitive = primitive;
  for (const GltfPrimitive::Target& target : described.targets) {
    if (!target.positions) continue;
    ++result.moving;
    result.moving_normals += target.normals ? 1U : 0U;
    result.moving_tangents += target.tangents ? 1U : 0U;
  }
  auto geometry = document.geometry(mesh, primitive, {.shading = true, .targets = false});
  if (!geometry) return geometry.error();
  result.triangles = geometry.value().corners.size() / 3;
  if (Status status = inspect_vertices(std::move(geometry).value(), result); !status) return status.error();
  return result;
}

// Widens the range of a track's weights if the spline goes beyond this range between two keys.
void add_spline(const Bernstein<double, 3>& weight, GltfTrackInspection& result) {
  const auto [lowest, highest] = std::minmax_element(weight.begin(), weight.end());
  if (result.lowest <= *lowest && *highest <= result.highest) return;
  const Bernstein<double, 2> slope = {weight[1] - weight[0], weight[2] - weight[1], weight[3] - weight[2]};
  const Roots<2> turns = roots_in_unit_interval(slope);
  for (std::size_t i = 0; i < turns.count; ++i) {
    const double extreme = evaluate(weight, turns.t[i]);
    result.lowest = std::min(result.lowest, extreme);
    result.highest = std::max(result.highest, extreme);
  }
}

Result<GltfTrackInspection> inspect_track(const GltfDocument& document, std::size_t animation, std::size_t track) {
  const auto keys = document.keys(animation, track);
  if (!keys) return keys.error();
  GltfTrackInspection result;
  result.animation = animation;
  result.track = track;
  const std::vector<double>&times = keys.value().times, &values = keys.value().values;
  if (times.empty()) return result;
  result.first_time = times.front();
  result.last_time = times.back();
  // Takes only the middle one of the three rows that a cubic spline has for each key. The middle row has the weights,
  // and the other rows have tangents.
  const bool is_cubic = document.animations()[animation].tracks[track].interpolation == GltfInterpolation::kCubicSpline;
  const std::size_t rows = times.size() * (is_cubic ? 3 : 1), width = values.size() / rows;
  bool is_first = true;
  for (std::size_t row = is_cubic ? 1U : 0U; row < rows; row += is_cubic ? 3 : 1) {
    for (const double weight : std::span(values).subspan(row * width, width)) {
      result.lowest = is_first ? weight : std::min(result.lowest, weight);
      result.highest = is_first ? weight : std::max(result.highest, weight);
      is_first = false;
    }
  }
  for (std::size_t key = 0; is_cubic && key + 1 < times.size(); ++key) {
    const double third = (times[key + 1] - times[key]) / 3;
    for (std::size_t i = 0; i < width; ++i) {
      const auto row = [&](std::size_t r) { return values[(3 * key + r) * width + i]; };
      const double from = row(1), to = row(4);
      add_spline({from, from + third * row(2), to - third * row(3), to}, result);
    }
  }
  return result;
}

}  // namespace

Result<std::size_t> count_split_normals(const GltfDocument& document, const Motion& motion,
                                        std::span<const GltfPart> parts) {
  const Points points = weld_coincident(motion);
  std::vector<std::optional<Vec3d>> first_normal(points.count);
  std::size_t split = 0;
  for (const GltfPart& part : parts) {
    if (!document.meshes()[part.mesh].primitives[part.primitive].has_normals) continue;
    const auto geometry = document.geometry(part.mesh, part.primitive, {.shading = true, .targets = false});
    if (!geometry) return geometry.error();
    const auto normals =
        VectorView<const float>::packed(geometry.value().normals.data(), geometry.value().normals.size() / 3);
    for (std::size_t v = 0; v < normals.count; ++v) {
      std::optional<Vec3d>& first = first_normal[points.point_of_vertex[part.first_vertex + v]];
      const Vec3d normal = to_double(normals[v]);
      if (!first)
        first = normal;
      else if (angle_between(normal, *first) * kDegreesPerRadian > kSplitNormalTolerance)
        ++split;
    }
  }
  return split;
}

Result<GltfInspection> inspect(const GltfDocument& document) {
  GltfInspection result;
  const std::vector<GltfMesh>& meshes = document.meshes();
  result.instances.resize(meshes.size());
  for (const GltfNode& node : document.nodes()) {
    if (!node.mesh) continue;
    ++result.instances[*node.mesh];
    result.skinned_nodes += node.has_skin ? 1U : 0U;
  }
  for (std::size_t m = 0; m < meshes.size(); ++m) {
    for (std::size_t p = 0; p < meshes[m].primitives.size(); ++p) {
      if (!meshes[m].primitives[p].has_faces()) {
        ++result.without_faces;
        continue;
      }
      auto primitive = inspect_primitive(document, m, p);
      if (!primitive) return primitive.error();
      result.primitives.push_back(primitive.value());
    }
  }
  for (std::size_t a = 0; a < document.animations().size(); ++a) {
    for (std::size_t t = 0; t < document.animations()[a].tracks.size(); ++t) {
      auto track = inspect_track(document, a, t);
      if (!track) return track.error();
      result.tracks.push_back(track.value());
    }
  }
  return result;
}

}  // namespace chronormal
