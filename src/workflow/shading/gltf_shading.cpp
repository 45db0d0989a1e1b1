#include "workflow/shading/gltf_shading.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <limits>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "chronormal/core/views.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "core/blocks.h"
#include "core/vector_area.h"
#include "normals/groups/sides.h"
#include "normals/groups/weld.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kChunk = 8192;

std::string mesh_place(const GltfDocument& document, std::size_t mesh) {
  return (document.name() + ", /meshes/").append(std::to_string(mesh));
}

// Appends an array of a primitive to the array of all primitives. The array has `width` numbers for each of `count`
// vertices. If the primitive has no values, appends zeros.
void append(std::vector<float> values, std::size_t first_vertex, std::size_t count, std::size_t width,
            std::vector<float>& all) {
  if (values.empty()) {
    if (!all.empty()) all.resize(width * (first_vertex + count));
    return;
  }
  if (first_vertex == 0) {
    all = std::move(values);
    return;
  }
  all.resize(width * first_vertex);
  all.insert(all.end(), values.begin(), values.end());
}

// Appends to a target the deltas of a primitive's vertices, except zeros.
void append_deltas(const std::vector<float>& deltas, std::size_t first_vertex, BlendTarget& target) {
  const auto is_moved = [&](std::size_t v) { return deltas[v] != 0 || deltas[v + 1] != 0 || deltas[v + 2] != 0; };
  std::size_t count = 0;
  for (std::size_t i = 0; i < deltas.size(); i += 3) count += is_moved(i) ? 1U : 0U;
  if (target.vertices.empty()) {
    target.vertices.reserve(count);
    target.deltas.reserve(3 * count);
  }
  for (std::size_t i = 0; i < deltas.size(); i += 3) {
    if (!is_moved(i)) continue;
    target.vertices.push_back(static_cast<std::uint32_t>(first_vertex + i / 3));
    target.deltas.insert(target.deltas.end(), {deltas[i], deltas[i + 1], deltas[i + 2]});
  }
}

// Removes the triangles that name a vertex twice, with which a long strip joins its parts. They never have an area, so
// they neither move normals nor show any. Keeps them if the primitive has no other triangles, since it must have faces.
void drop_stitches(std::vector<std::uint32_t>& corners) {
  const auto is_stitch = [&](std::size_t c) {
    return corners[c] == corners[c + 1] || corners[c + 1] == corners[c + 2] || corners[c + 2] == corners[c];
  };
  std::size_t kept = 0;
  for (std::size_t c = 0; c + 2 < corners.size(); c += 3) {
    if (is_stitch(c)) continue;
    for (std::size_t i = 0; i < 3; ++i) corners[kept + i] = corners[c + i];
    kept += 3;
  }
  if (kept > 0) corners.resize(kept);
}

// Reads the arrays of all primitives with faces, one primitive after the other. Targets are read one at a time, to save
// memory.
Status read_parts(const GltfDocument& document, bool keep_deltas, GltfShading& shading) {
  const GltfMesh& mesh = document.meshes()[shading.mesh];
  std::vector<std::uint32_t> corners;
  std::size_t vertices = 0;
  bool has_tangents = false;
  shading.set.targets.resize(mesh.target_count);
  shading.normal_deltas.resize(mesh.target_count);
  shading.turns.resize(mesh.target_count);
  shading.tangent_deltas.resize(mesh.target_count);
  for (std::size_t k = 0; k < mesh.target_count; ++k)
    shading.set.targets[k].name = mesh.target_names.empty() ? std::to_string(k) : mesh.target_names[k];
  for (std::size_t p = 0; p < mesh.primitives.size(); ++p) {
    if (!mesh.primitives[p].has_faces()) continue;
    Result<GltfGeometry> read = document.geometry(shading.mesh, p, {.shading = true, .targets = false});
    if (!read) return read.error();
    GltfGeometry& geometry = read.value();
    drop_stitches(geometry.corners);
    const std::size_t count = geometry.positions.size() / 3;
    if (vertices + count >= std::numeric_limits<std::uint32_t>::max() / 3)
      return invalid_input(mesh_place(document, shading.mesh),
                           "the mesh has more vertices than can be read; split the mesh");
    shading.parts.push_back(
        {std::nullopt, shading.mesh, p, vertices, count, corners.size() / 3, geometry.corners.size() / 3});
    if (vertices == 0) {
      corners = std::move(geometry.corners);
    } else {
      for (const std::uint32_t v : geometry.corners) corners.push_back(static_cast<std::uint32_t>(vertices) + v);
    }
    append(std::move(geometry.positions), vertices, count, 3, shading.set.base);
    shading.normals.resize(3 * vertices);
    append(std::move(geometry.normals), vertices, count, 3, shading.normals);
    if (keep_deltas) {
      has_tangents = has_tangents || !geometry.tangents.empty();
      append(std::move(geometry.tangents), vertices, count, 4, shading.tangents);
    }
    geometry = {};
    for (std::size_t k = 0; k < mesh.primitives[p].targets.size(); ++k) {
      Result<GltfGeometry::Target> target = document.target(shading.mesh, p, k, true);
      if (!target) return target.error();
      append_deltas(target.value().positions, vertices, shading.set.targets[k]);
      const std::vector<float>& normals = target.value().normals;
      if (mesh.primitives[p].has_normals && std::any_of(normals.begin(), normals.end(), [](float d) { return d != 0; }))
        shading.turns[k] = true;
      if (!keep_deltas) continue;
      append(std::move(target.value().normals), vertices, count, 3, shading.normal_deltas[k]);
      append(std::move(target.value().tangents), vertices, count, 3, shading.tangent_deltas[k]);
    }
    vertices += count;
  }
  if (shading.parts.empty())
    return invalid_input(mesh_place(document, shading.mesh),
                         "the mesh has no faces, so it has no normals; export a mesh with faces");
  shading.normals.resize(3 * vertices);
  if (has_tangents) shading.tangents.resize(4 * vertices);
  Result<Topology> topology = Topology::triangles(vertices, std::move(corners));
  if (!topology) return topology.error();
  shading.set.topology = std::move(topology).value();
  Status status = validate(shading.set);
  if (!status) return invalid_input(mesh_place(document, shading.mesh), status.error().text());
  return Success{};
}

// Makes points from classes of vertices: numbers the classes in the order of their first vertices. The numbers in
// class_of_vertex may have any order.
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

// Splits points. Vertices that coincide in the base but have different deltas in some target become separate points.
Points split_by_targets(Points points, const std::vector<BlendTarget>& targets) {
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
    std::size_t class_count = points.count;  // vertices of one class whose deltas are equal go to the same new class
    for (std::size_t n = 0; n < count; ++n) {
      if (n == 0 || key(order[n - 1]) < key(order[n])) ++class_count;
      classes[target.vertices[order[n]]] = static_cast<std::uint32_t>(class_count - 1);
    }
    points = to_points(classes, class_count);
  }
  return points;
}

// Makes each vertex that is set in `alone` a point of its own.
Points set_apart(const Points& points, const std::vector<bool>& alone) {
  std::vector<std::uint32_t> classes = points.point_of_vertex;
  std::size_t class_count = points.count;
  for (std::size_t v = 0; v < alone.size(); ++v)
    if (alone[v]) classes[v] = static_cast<std::uint32_t>(class_count++);
  return to_points(classes, class_count);
}

// Groups vertices without stored normals by the crease angle. The vertices of each point of the result share a normal.
// All other vertices stay alone. `split` counts the vertices that a crease would split.
Result<Points> smooth_points(const Motion& base, const Points& points, const std::vector<bool>& has_normal,
                             double crease_angle, std::size_t& split) {
  const Result<NormalGroups> groups = NormalGroups::by_crease_angle(base, set_apart(points, has_normal), crease_angle);
  if (!groups) return groups.error();
  // Joins all elements at the corners of a vertex, because a vertex of a glTF file has one normal.
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

// Takes the points of vertices with stored normals from `stored`, and the points of all other vertices from `smooth`.
Points joined(const Points& stored, const Points& smooth, const std::vector<bool>& has_normal) {
  std::vector<std::uint32_t> classes = stored.point_of_vertex;
  for (std::size_t v = 0; v < classes.size(); ++v)
    if (!has_normal[v]) classes[v] = static_cast<std::uint32_t>(stored.count) + smooth.point_of_vertex[v];
  return to_points(classes, stored.count + smooth.count);
}

// Groups vertices into points. The vertices of a point are at the same place, and may share a normal.
Result<Points> shading_points(const GltfShadingOptions& options, const std::vector<bool>& has_normal,
                              GltfShading& shading) {
  Motion base;  // the mesh at rest; borrows the arrays of `shading` until the end
  base.topology = std::move(shading.set.topology);
  base.keyframes.push_back({std::move(shading.set.base), 0, ""});
  Points points = separate_points(has_normal.size());
  if (options.weld) {
    MotionStream stream(base);
    Points places = weld_from_start(stream, false).value().always;
    points = places;
    keep_sides_apart(base.topology, points);
    const bool any_sides = points.count != places.count;
    points = split_by_targets(std::move(points), shading.set.targets);
    if (any_sides) shading.place_of_vertex = split_by_targets(std::move(places), shading.set.targets).point_of_vertex;
  }
  shading.point_of_vertex = points.point_of_vertex;
  Result<Points> all = Points{};
  if (std::find(has_normal.begin(), has_normal.end(), false) == has_normal.end()) {
    all = std::move(points);
  } else {
    std::vector<bool> has_none = has_normal;
    has_none.flip();
    Result<Points> smooth = set_apart(points, has_none);
    if (options.smooth) smooth = smooth_points(base, points, has_normal, options.crease_angle, shading.split_by_crease);
    // Keeps vertices with a stored normal apart from vertices without one, even at the same place.
    if (smooth)
      all = joined(set_apart(points, has_none), smooth.value(), has_normal);
    else
      all = smooth.error();
  }
  shading.set.base = std::move(base.keyframes[0].positions);
  shading.set.topology = std::move(base.topology);
  return all;
}

// Splits points whose vertices have different stored normals. Uses the code of NormalGroups, which splits points by the
// normals of face corners. For this purpose, each vertex that shares its point and has a face gets an invented face
// with all corners at that vertex.
Result<Points> split_by_normals(const Topology& topology, Points points, const std::vector<float>& normals) {
  std::vector<bool> has_face(points.point_of_vertex.size()), is_shared(points.count), is_taken(points.count);
  for (const std::uint32_t v : topology.corners()) has_face[v] = true;
  for (std::size_t v = 0; v < has_face.size(); ++v) {
    if (!has_face[v]) continue;
    const std::uint32_t p = points.point_of_vertex[v];
    if (is_taken[p]) is_shared[p] = true;
    is_taken[p] = true;
  }
  std::vector<std::uint32_t> sharing;
  for (std::uint32_t v = 0; v < has_face.size(); ++v)
    if (has_face[v] && is_shared[points.point_of_vertex[v]]) sharing.push_back(v);
  if (sharing.empty()) return points;
  std::vector<std::uint32_t> made_up;
  std::vector<float> of_corner;
  made_up.reserve(3 * sharing.size());
  of_corner.reserve(9 * sharing.size());
  for (const std::uint32_t v : sharing) {
    const float* const normal = normals.data() + 3 * std::size_t{v};
    for (std::size_t corner = 0; corner < 3; ++corner) {
      made_up.push_back(v);
      of_corner.insert(of_corner.end(), normal, normal + 3);
    }
  }
  const Result<Topology> faces = Topology::triangles(topology.vertex_count(), made_up);
  if (!faces) return faces.error();
  const Result<NormalGroups> groups = NormalGroups::by_split_normals(
      faces.value(), points, VectorView<const float>::packed(of_corner.data(), made_up.size()));
  if (!groups) return groups.error();
  for (std::size_t n = 0; n < sharing.size(); ++n) {
    points.point_of_vertex[sharing[n]] =
        static_cast<std::uint32_t>(points.count) + groups.value().element_of_corner()[3 * n];
  }
  points.count += groups.value().size();
  return points;
}

// Numbers points in the order of their first corners. Points without faces come last.
void number_by_corners(const Topology& topology, Points& points) {
  constexpr std::uint32_t kNone = GltfShading::kNoElement;
  std::vector<std::uint32_t> number(points.count, kNone);
  std::uint32_t count = 0;
  const auto take = [&](std::uint32_t vertex) {
    std::uint32_t& mine = number[points.point_of_vertex[vertex]];
    if (mine == kNone) mine = count++;
  };
  for (const std::uint32_t v : topology.corners()) take(v);
  for (std::uint32_t v = 0; v < points.point_of_vertex.size(); ++v) take(v);
  for (std::uint32_t& point : points.point_of_vertex) point = number[point];
  points.count = count;
}

// The pairs of polygons that lie back to back: they have the same vertices and face opposite sides. A polygon is a
// single triangle, or two consecutive triangles that were cut from a quad.
struct Backs {
  std::vector<std::uint32_t> polygon;  // the polygon of each triangle, named by the first triangle of the polygon
  std::vector<std::uint32_t> back;     // for each triangle, the polygon on its back, or kNoFace

  [[nodiscard]] bool are_apart(std::uint32_t a, std::uint32_t b) const {
    return back[a] != kNoFace && back[a] == polygon[b];
  }
};

std::optional<Backs> backs_of_triangles(const GltfShading& shading) {
  const Topology& topology = shading.set.topology;
  const std::size_t count = topology.face_count();
  const auto point = [&](std::uint32_t v) { return shading.point_of_vertex[v]; };
  const std::vector<BackToBack> triangles = find_backs(count, [&](std::uint32_t f, auto& loop) {
    for (const std::uint32_t v : topology.face(f)) loop.push_back(point(v));
  });
  // Finds quads that lie back to back. A quad is named by the index of its first triangle.
  const std::vector<BackToBack> quads = find_backs(count, [&](std::uint32_t f, auto& loop) {
    if (f + 1 == count) return;
    const auto a = topology.face(f), b = topology.face(f + 1);
    if (a[0] == b[0] && a[2] == b[1]) loop.assign({point(a[0]), point(a[1]), point(a[2]), point(b[2])});
  });
  if (triangles.empty() && quads.empty()) return std::nullopt;
  Backs backs{std::vector<std::uint32_t>(count), std::vector<std::uint32_t>(count, kNoFace)};
  std::iota(backs.polygon.begin(), backs.polygon.end(), 0U);
  for (const auto& [face, back] : triangles) {
    backs.back[face] = back;
    backs.back[back] = face;
  }
  const auto is_free = [&](std::uint32_t f) { return backs.back[f] == kNoFace && backs.back[f + 1] == kNoFace; };
  for (const auto& [face, back] : quads) {
    if (!is_free(face) || !is_free(back)) continue;
    backs.back[face] = backs.back[face + 1] = backs.polygon[back] = backs.polygon[back + 1] = back;
    backs.back[back] = backs.back[back + 1] = backs.polygon[face] = backs.polygon[face + 1] = face;
  }
  return backs;
}

// Finds corners whose face belongs to one side of a sheet, but whose vertex has a stored normal that faces the other
// side. Returns one value for each corner, or an empty list if there are no such corners.
std::vector<bool> corners_at_the_back(const GltfShading& shading, const Points& points) {
  const Topology& topology = shading.set.topology;
  const auto corners = topology.corners();
  const std::optional<Backs> found = backs_of_triangles(shading);
  std::vector<bool> result;
  if (!found) return result;
  const Backs& backs = *found;
  // Collects the corners of each point at which polygons lie back to back.
  std::vector<bool> may_be(points.count);
  for (std::uint32_t c = 0; c < corners.size(); ++c)
    if (backs.back[c / 3] != kNoFace) may_be[points.point_of_vertex[corners[c]]] = true;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> of_classes;
  for (std::uint32_t c = 0; c < corners.size(); ++c)
    if (may_be[points.point_of_vertex[corners[c]]]) of_classes.emplace_back(points.point_of_vertex[corners[c]], c);
  std::sort(of_classes.begin(), of_classes.end());
  for (std::size_t first = 0, end = 0; first < of_classes.size(); first = end) {
    for (end = first + 1; end < of_classes.size() && of_classes[end].first == of_classes[first].first;) ++end;
    const auto here = std::span(of_classes).subspan(first, end - first);
    std::vector<SideEdge> edges;
    std::vector<std::pair<std::uint32_t, std::uint32_t>> apart;
    const auto has_back = [&](const auto& corner) { return backs.back[corner.second / 3] != kNoFace; };
    if (!std::all_of(here.begin(), here.end(), has_back)) continue;
    for (std::uint32_t n = 0; n < here.size(); ++n) {
      const std::uint32_t c = here[n].second, f = c / 3;
      const auto face = topology.face(f);
      edges.push_back({n, shading.point_of_vertex[face[(c + 1) % 3]], true});
      edges.push_back({n, shading.point_of_vertex[face[(c + 2) % 3]], false});
      for (std::uint32_t m = 0; m < n; ++m)
        if (backs.are_apart(here[m].second / 3, f)) apart.emplace_back(m, n);
    }
    if (apart.empty()) continue;
    const std::vector<std::uint32_t> side = split_sides(here.size(), std::move(edges), apart);
    const std::uint32_t sides = *std::max_element(side.begin(), side.end()) + 1;
    // Finds out to which side the stored normals of the vertices at this point face.
    std::vector<double> along(sides);
    for (std::size_t n = 0; n < here.size(); ++n) {
      const std::uint32_t c = here[n].second;
      const auto face = topology.face(c / 3);
      const auto at = [](const std::vector<float>& vectors, std::uint32_t v) {
        const float* const p = vectors.data() + 3 * std::size_t{v};
        return Vec3d{p[0], p[1], p[2]};
      };
      const Vec3d normal = twice_vector_area(3, [&](std::size_t i) { return at(shading.set.base, face[i]); });
      along[side[n]] += dot(normal, at(shading.normals, corners[c]));
    }
    const auto shown = static_cast<std::uint32_t>(std::max_element(along.begin(), along.end()) - along.begin());
    for (std::size_t n = 0; n < here.size(); ++n) {
      const bool is_apart = std::any_of(apart.begin(), apart.end(), [&](const auto& pair) {
        const std::uint32_t a = side[pair.first], b = side[pair.second];
        return (a == side[n] && b == shown) || (b == side[n] && a == shown);
      });
      if (!is_apart) continue;
      if (result.empty()) result.resize(corners.size());
      result[here[n].second] = true;
    }
  }
  return result;
}

Status find_elements(const GltfDocument& document, const GltfShadingOptions& options, GltfShading& shading) {
  const auto& primitives = document.meshes()[shading.mesh].primitives;
  const std::size_t vertices = shading.set.topology.vertex_count();
  std::vector<bool> has_normal(vertices);
  for (const GltfPart& part : shading.parts) {
    if (!primitives[part.primitive].has_normals) continue;
    for (std::size_t v = part.first_vertex; v < part.first_vertex + part.vertex_count; ++v) has_normal[v] = true;
  }
  Result<Points> points = shading_points(options, has_normal, shading);
  if (!points) return points.error();
  points = split_by_normals(shading.set.topology, std::move(points).value(), shading.normals);
  if (!points) return invalid_input(mesh_place(document, shading.mesh), points.error().text());
  number_by_corners(shading.set.topology, points.value());
  shading.at_the_back = corners_at_the_back(shading, points.value());
  shading.groups = NormalGroups::of_vertices(shading.set.topology, points.value(), shading.at_the_back);
  shading.element_of_vertex.assign(vertices, GltfShading::kNoElement);
  for (const std::uint32_t v : shading.set.topology.corners())
    if (has_normal[v] || options.smooth) shading.element_of_vertex[v] = points.value().point_of_vertex[v];
  return Success{};
}

Status check_mark(const GltfDocument& document, const GltfShading& shading) {
  if (!shading.mark) return Success{};
  for (std::size_t n = 0; n < shading.mark->extras.size(); ++n) {
    if (!shading.set.targets[shading.mark->extras[n].target].vertices.empty())
      return invalid_input(
          mesh_place(document, shading.mesh) + "/extras/chronormal/extras/" + std::to_string(n) + "/target",
          "a correction target must not move vertices, but this one does; another program has changed the file, so "
          "bake the original again");
  }
  return Success{};
}

// Removes the mark of a bake if it is no longer true. Programs that compute new normals for every target keep the names
// of correction targets, but not their deltas. A bake never writes a correction target without deltas, so a target
// without deltas shows that such a program has changed the file.
void drop_mark_of_emptied_targets(GltfShading& shading) {
  if (!shading.mark || shading.mark->extras.empty()) return;
  for (const GltfExtraTarget& extra : shading.mark->extras)
    if (shading.turns[extra.target]) return;
  shading.emptied = shading.mark->extras.size();
  shading.mark.reset();
}

}  // namespace

Result<GltfShading> read_gltf_shading(const GltfDocument& document, std::size_t mesh,
                                      const GltfShadingOptions& options) {
  assert(mesh < document.meshes().size());
  if (const std::optional<Error>& fault = document.meshes()[mesh].mark_fault) return *fault;
  GltfShading shading;
  shading.mesh = mesh;
  shading.mark = document.meshes()[mesh].mark;
  if (Status status = read_parts(document, options.keep_deltas, shading); !status) return status.error();
  if (Status status = check_mark(document, shading); !status) return status.error();
  drop_mark_of_emptied_targets(shading);
  if (Status status = find_elements(document, options, shading); !status) return status.error();
  return shading;
}

Vec3d normal_from_positions(const GltfShading& shading, std::span<const double> positions,
                            std::size_t element) noexcept {
  const Topology& topology = shading.set.topology;
  Vec3d result;
  for (const std::uint32_t f : shading.groups.faces(element)) {
    const auto at = [&](std::size_t c) {
      const double* p = positions.data() + 3 * std::size_t{topology.face(f)[c]};
      return Vec3d{p[0], p[1], p[2]};
    };
    result = result + twice_vector_area(3, at);
  }
  return result;
}

std::vector<Vec3d> normals_from_positions(const GltfShading& shading, std::span<const double> weights) {
  std::vector<double> positions(shading.set.base.size());
  blend_positions(shading.set, weights, positions);
  std::vector<Vec3d> result(shading.groups.size());
  numbered_blocks(result.size(), kChunk, [&](std::size_t, std::size_t first, std::size_t last) {
    for (std::size_t e = first; e < last; ++e) result[e] = normal_from_positions(shading, positions, e);
  });
  return result;
}

Vec3d shown_direction(const Vec3d& stored, const Vec3d& base_normal, const Vec3d& normal) noexcept {
  const Vec3d from = unit(base_normal), to = unit(stored), now = unit(normal);
  if (from == Vec3d{} || to == Vec3d{}) return now;
  return dot(from, to) < 0 ? turned(-from, to, -now) : turned(from, to, now);
}

ShownTurn::ShownTurn(const Vec3d& stored, const Vec3d& base_normal) noexcept {
  const Vec3d from = unit(base_normal), to = unit(stored);
  if (from == Vec3d{} || to == Vec3d{}) return;
  const double along = dot(from, to), side = std::copysign(1.0, along);
  axis_ = side * cross(from, to);
  cosine_ = along;
}

void fill_extra_weights(const GltfShading& shading, std::span<double> weights) noexcept {
  assert(weights.size() == shading.set.targets.size());
  if (!shading.mark) return;
  for (const GltfExtraTarget& extra : shading.mark->extras) weights[extra.target] = extra.weight(weights);
}

}  // namespace chronormal::inline internal
