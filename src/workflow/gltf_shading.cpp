#include "chronormal/workflow/gltf_shading.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <numeric>
#include <tuple>
#include <utility>

#include "chronormal/core/parallel.h"
#include "chronormal/core/views.h"
#include "chronormal/normals/transform.h"
#include "chronormal/normals/weld.h"

namespace chronormal {
namespace {

constexpr std::size_t kChunk = 8192;

std::string mesh_place(const GltfDocument& document, std::size_t mesh) {
  return (document.name() + ", /meshes/").append(std::to_string(mesh));
}

// Appends count vertices of `width` numbers each, zeros where values has none, at the end of all vertices before.
void append(const std::vector<float>& values, std::size_t first_vertex, std::size_t count, std::size_t width,
            std::vector<float>& all) {
  if (values.empty()) {
    if (!all.empty()) all.resize(width * (first_vertex + count));
    return;
  }
  all.resize(width * first_vertex);
  all.insert(all.end(), values.begin(), values.end());
}

// Adds deltas of some vertices to a target, without those that are zero.
void append_deltas(const std::vector<float>& deltas, std::size_t first_vertex, BlendTarget& target) {
  const BlendTarget moved = BlendTarget::from_dense(deltas);
  for (const std::uint32_t v : moved.vertices) target.vertices.push_back(static_cast<std::uint32_t>(first_vertex) + v);
  target.deltas.insert(target.deltas.end(), moved.deltas.begin(), moved.deltas.end());
}

// The arrays of all primitives with faces, one after the other.
Status read_parts(const GltfDocument& document, GltfShading& shading) {
  const GltfMesh& mesh = document.meshes()[shading.mesh];
  std::vector<std::uint32_t> corners;
  std::size_t vertices = 0;
  bool has_tangents = false;
  shading.set.targets.resize(mesh.target_count);
  shading.normal_deltas.resize(mesh.target_count);
  shading.tangent_deltas.resize(mesh.target_count);
  for (std::size_t k = 0; k < mesh.target_count; ++k)
    shading.set.targets[k].name = mesh.target_names.empty() ? std::to_string(k) : mesh.target_names[k];
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    if (!mesh.primitives[p].has_faces()) continue;
    const Result<GltfGeometry> read = document.geometry(shading.mesh, p, {.shading = true, .targets = true});
    if (!read) return read.error();
    const GltfGeometry& geometry = read.value();
    const std::size_t count = geometry.positions.size() / 3;
    if (vertices + count >= std::numeric_limits<std::uint32_t>::max() / 3)
      return invalid_input(mesh_place(document, shading.mesh), "indices of 32 bits cannot name so many vertices");
    shading.parts.push_back(
        {std::nullopt, shading.mesh, p, vertices, count, corners.size() / 3, geometry.corners.size() / 3});
    for (const std::uint32_t v : geometry.corners) corners.push_back(static_cast<std::uint32_t>(vertices) + v);
    append(geometry.positions, vertices, count, 3, shading.set.base);
    shading.normals.resize(3 * vertices);
    append(geometry.normals, vertices, count, 3, shading.normals);
    append(geometry.tangents, vertices, count, 4, shading.tangents);
    has_tangents = has_tangents || !geometry.tangents.empty();
    for (std::size_t k = 0; k < geometry.targets.size(); ++k) {
      append_deltas(geometry.targets[k].positions, vertices, shading.set.targets[k]);
      append(geometry.targets[k].normals, vertices, count, 3, shading.normal_deltas[k]);
      append(geometry.targets[k].tangents, vertices, count, 3, shading.tangent_deltas[k]);
    }
    vertices += count;
  }
  if (shading.parts.empty())
    return invalid_input(mesh_place(document, shading.mesh), "the mesh has no primitive with faces");
  shading.normals.resize(3 * vertices);
  if (has_tangents) shading.tangents.resize(4 * vertices);
  Result<Topology> topology = Topology::triangles(vertices, std::move(corners));
  if (!topology) return topology.error();
  shading.set.topology = std::move(topology).value();
  Status status = validate(shading.set);
  if (!status) return invalid_input(mesh_place(document, shading.mesh), status.error().text());
  return Success{};
}

// Numbers classes of vertices, named by anything, in the order of their first vertices.
Points to_points(const std::vector<std::uint32_t>& class_of_vertex, std::size_t class_count) {
  constexpr std::uint32_t kNone = GltfShading::kNoElement;
  std::vector<std::uint32_t> number(class_count, kNone);
  Points points{std::vector<std::uint32_t>(class_of_vertex.size()), 0};
  for (std::size_t v = 0; v < class_of_vertex.size(); ++v) {
    std::uint32_t& mine = number[class_of_vertex[v]];
    if (mine == kNone) mine = static_cast<std::uint32_t>(points.count++);
    points.point_of_vertex[v] = mine;
  }
  return points;
}

// Vertices that are at one place in the base and move alike in every target: classes of the base, which each target
// takes apart. The motion is the base alone.
Points weld(const Motion& base, const std::vector<BlendTarget>& targets) {
  Points points = weld_coincident(base);
  for (const BlendTarget& target : targets) {
    const std::size_t count = target.vertices.size();
    std::vector<std::uint32_t> order(count);
    std::iota(order.begin(), order.end(), 0U);
    const auto key = [&](std::uint32_t n) {
      const float* d = target.deltas.data() + 3 * std::size_t{n};
      return std::tuple(points.point_of_vertex[target.vertices[n]], d[0], d[1], d[2]);
    };
    std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return key(a) < key(b); });
    std::vector<std::uint32_t> classes = points.point_of_vertex;
    std::size_t class_count = points.count;  // moved vertices leave their class together
    for (std::size_t n = 0; n < count; ++n) {
      if (n == 0 || key(order[n - 1]) < key(order[n])) ++class_count;
      classes[target.vertices[order[n]]] = static_cast<std::uint32_t>(class_count - 1);
    }
    points = to_points(classes, class_count);
  }
  return points;
}

// Each vertex that `alone` names becomes a point of its own.
Points set_apart(const Points& points, const std::vector<bool>& alone) {
  std::vector<std::uint32_t> classes = points.point_of_vertex;
  std::size_t class_count = points.count;
  for (std::size_t v = 0; v < alone.size(); ++v)
    if (alone[v]) classes[v] = static_cast<std::uint32_t>(class_count++);
  return to_points(classes, class_count);
}

// Vertices without stored normals, as the crease angle joins and splits their points: a class for each normal. Others
// are alone.
Result<Points> smooth_points(const Motion& base, const Points& points, const std::vector<bool>& has_normal,
                             double crease_angle, std::size_t& split) {
  const Result<NormalGroups> groups = NormalGroups::by_crease_angle(base, set_apart(points, has_normal), crease_angle);
  if (!groups) return groups.error();
  // A vertex has one normal: its elements are joined.
  const auto corners = base.topology.corners();
  const auto element_of_corner = groups.value().element_of_corner();
  std::vector<std::uint32_t> parent(groups.value().size());
  std::iota(parent.begin(), parent.end(), 0U);
  const auto root = [&parent](std::uint32_t e) {
    while (parent[e] != e) e = parent[e] = parent[parent[e]];
    return e;
  };
  constexpr std::uint32_t kNone = GltfShading::kNoElement;
  std::vector<std::uint32_t> first_element(has_normal.size(), kNone);
  std::vector<bool> is_split(has_normal.size());
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (has_normal[corners[c]]) continue;
    std::uint32_t& first = first_element[corners[c]];
    if (first == kNone) first = element_of_corner[c];
    if (first != element_of_corner[c]) is_split[corners[c]] = true;
    const std::uint32_t a = root(first), b = root(element_of_corner[c]);
    parent[std::max(a, b)] = std::min(a, b);
  }
  split = static_cast<std::size_t>(std::count(is_split.begin(), is_split.end(), true));
  std::vector<std::uint32_t> classes(has_normal.size());
  std::size_t class_count = parent.size();
  for (std::size_t v = 0; v < classes.size(); ++v) {
    const bool alone = has_normal[v] || first_element[v] == kNone;
    classes[v] = alone ? static_cast<std::uint32_t>(class_count++) : root(first_element[v]);
  }
  return to_points(classes, class_count);
}

// Points of vertices with stored normals from one, and of those without from another.
Points joined(const Points& stored, const Points& smooth, const std::vector<bool>& has_normal) {
  std::vector<std::uint32_t> classes = stored.point_of_vertex;
  for (std::size_t v = 0; v < classes.size(); ++v)
    if (!has_normal[v]) classes[v] = static_cast<std::uint32_t>(stored.count) + smooth.point_of_vertex[v];
  return to_points(classes, stored.count + smooth.count);
}

Status find_elements(const GltfDocument& document, const GltfShadingOptions& options, GltfShading& shading) {
  const auto& primitives = document.meshes()[shading.mesh].primitives;
  const std::size_t vertices = shading.set.topology.vertex_count();
  std::vector<bool> has_normal(vertices), has_none(vertices, true);
  for (const GltfPart& part : shading.parts) {
    if (!primitives[part.primitive].has_normals) continue;
    for (std::size_t v = part.first_vertex; v < part.first_vertex + part.vertex_count; ++v) {
      has_normal[v] = true;
      has_none[v] = false;
    }
  }
  Motion base;  // borrows the arrays for a while
  base.topology = std::move(shading.set.topology);
  base.keyframes.push_back({std::move(shading.set.base), 0, ""});
  const Points points = weld(base, shading.set.targets);
  Result<Points> smooth = set_apart(points, has_none);
  if (options.smooth) smooth = smooth_points(base, points, has_normal, options.crease_angle, shading.split_by_crease);
  shading.set.base = std::move(base.keyframes[0].positions);
  shading.set.topology = std::move(base.topology);
  if (!smooth) return smooth.error();
  // Apart from each other where both kinds are at one place.
  const Points all = joined(set_apart(points, has_none), smooth.value(), has_normal);

  const auto corners = shading.set.topology.corners();
  std::vector<float> normal_of_corner(3 * corners.size());
  for (std::size_t c = 0; c < corners.size(); ++c)
    std::copy_n(shading.normals.begin() + 3 * static_cast<std::ptrdiff_t>(corners[c]), 3,
                normal_of_corner.begin() + 3 * static_cast<std::ptrdiff_t>(c));
  Result<NormalGroups> groups = NormalGroups::by_split_normals(
      shading.set.topology, all, VectorView<const float>::packed(normal_of_corner.data(), corners.size()));
  if (!groups) return invalid_input(mesh_place(document, shading.mesh), groups.error().text());
  shading.groups = std::move(groups).value();
  shading.element_of_vertex.assign(vertices, GltfShading::kNoElement);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    if (has_normal[corners[c]] || options.smooth)
      shading.element_of_vertex[corners[c]] = shading.groups.element_of_corner()[c];
  }
  return Success{};
}

Status check_mark(const GltfDocument& document, const GltfShading& shading) {
  if (!shading.mark) return Success{};
  for (std::size_t n = 0; n < shading.mark->extras.size(); ++n) {
    if (!shading.set.targets[shading.mark->extras[n].target].vertices.empty())
      return invalid_input(
          mesh_place(document, shading.mesh) + "/extras/chronormal/extras/" + std::to_string(n) + "/target",
          "an extra target moves no vertex, but this one does");
  }
  return Success{};
}

// Calls body with ranges of [0, count), on all cores.
template <class Body>
void in_chunks(std::size_t count, const Body& body) {
  parallel_for((count + kChunk - 1) / kChunk,
               [&](std::size_t i) { body(i * kChunk, std::min(count, (i + 1) * kChunk)); });
}

}  // namespace

Result<GltfShading> read_gltf_shading(const GltfDocument& document, std::size_t mesh,
                                      const GltfShadingOptions& options) {
  assert(mesh < document.meshes().size());
  if (const std::optional<Error>& fault = document.meshes()[mesh].mark_fault) return *fault;
  GltfShading shading;
  shading.mesh = mesh;
  shading.mark = document.meshes()[mesh].mark;
  if (Status status = read_parts(document, shading); !status) return status.error();
  if (Status status = check_mark(document, shading); !status) return status.error();
  if (Status status = find_elements(document, options, shading); !status) return status.error();
  return shading;
}

std::vector<Vec3d> normals_from_positions(const GltfShading& shading, std::span<const double> weights) {
  const Topology& topology = shading.set.topology;
  std::vector<double> positions(shading.set.base.size());
  blend_positions(shading.set, weights, positions);
  std::vector<Vec3d> of_faces(topology.face_count());
  in_chunks(of_faces.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t f = first; f < last; ++f) {
      const auto at = [&](std::size_t c) {
        const double* p = positions.data() + 3 * std::size_t{topology.face(f)[c]};
        return Vec3d{p[0], p[1], p[2]};
      };
      of_faces[f] = cross(at(1) - at(0), at(2) - at(0));
    }
  });
  std::vector<Vec3d> result(shading.groups.size());
  in_chunks(result.size(), [&](std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e)
      for (const std::uint32_t f : shading.groups.faces(e)) result[e] = result[e] + of_faces[f];
  });
  return result;
}

Vec3d shown_direction(const Vec3d& stored, const Vec3d& base_normal, const Vec3d& normal) noexcept {
  const Vec3d from = unit(base_normal), to = unit(stored), now = unit(normal);
  if (from == Vec3d{} || to == Vec3d{}) return now;
  return turned(from, to, now);
}

void fill_extra_weights(const GltfShading& shading, std::span<double> weights) noexcept {
  assert(weights.size() == shading.set.targets.size());
  if (!shading.mark) return;
  const std::vector<GltfExtraTarget>& extras = shading.mark->extras;
  double base = 1;  // 1 - all weights of the mesh's own targets
  for (std::size_t k = 0, next = 0; k < weights.size(); ++k) {
    if (next < extras.size() && extras[next].target == k)
      ++next;
    else
      base -= weights[k];
  }
  const auto factor = [&](std::size_t i) { return i == GltfExtraTarget::kBase ? base : weights[i]; };
  for (const GltfExtraTarget& extra : extras) weights[extra.target] = factor(extra.i) * factor(extra.j);
}

}  // namespace chronormal
