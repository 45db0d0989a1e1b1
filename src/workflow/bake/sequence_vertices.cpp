#include "workflow/bake/sequence_vertices.h"

#include <algorithm>

#include "chronormal/core/views.h"

namespace chronormal {

SequenceVertices sequence_vertices(const Topology& topology, const NormalGroups& groups) {
  const std::span<const std::uint32_t> corners = topology.corners();
  SequenceVertices result;
  result.vertex.resize(topology.vertex_count());
  for (std::size_t v = 0; v < result.vertex.size(); ++v) result.vertex[v] = static_cast<std::uint32_t>(v);
  if (groups.outputs_are_vertices()) {
    result.element.assign(groups.element_of_output().begin(), groups.element_of_output().end());
    result.of_corner.assign(corners.begin(), corners.end());
    return result;
  }
  result.element.assign(topology.vertex_count(), SequenceVertices::kNone);
  std::vector<std::uint32_t> next_copy(topology.vertex_count(), SequenceVertices::kNone);
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const std::uint32_t element = groups.element_of_corner()[c];
    std::uint32_t at = corners[c];
    if (result.element[at] == SequenceVertices::kNone) result.element[at] = element;
    while (result.element[at] != element) {
      if (next_copy[at] == SequenceVertices::kNone) {
        next_copy[at] = static_cast<std::uint32_t>(result.vertex.size());
        result.vertex.push_back(corners[c]);
        result.element.push_back(element);
        next_copy.push_back(SequenceVertices::kNone);
      }
      at = next_copy[at];
    }
    result.of_corner.push_back(at);
  }
  return result;
}

std::vector<float> SequenceVertices::positions(std::span<const float> of_motion) const {
  std::vector<float> result(3 * size());
  for (std::size_t i = 0; i < size(); ++i)
    std::copy_n(of_motion.begin() + 3 * std::ptrdiff_t{vertex[i]}, 3,
                result.begin() + 3 * static_cast<std::ptrdiff_t>(i));
  return result;
}

std::vector<float> SequenceVertices::vectors(std::span<const Vec3d> of_elements, const Vec3d& none) const {
  std::vector<float> result(3 * size());
  const auto view = VectorView<float>::packed(result.data(), size());
  for (std::size_t i = 0; i < size(); ++i) view.set(i, to_float(element[i] == kNone ? none : of_elements[element[i]]));
  return result;
}

std::vector<std::uint32_t> fan_triangles(const Topology& topology, std::span<const std::uint32_t> vertex_of_corner) {
  std::vector<std::uint32_t> triangles;
  std::size_t first = 0;
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const std::size_t corners = topology.face(f).size();
    for (std::size_t c = 2; c < corners; ++c)
      triangles.insert(triangles.end(),
                       {vertex_of_corner[first], vertex_of_corner[first + c - 1], vertex_of_corner[first + c]});
    first += corners;
  }
  return triangles;
}

std::size_t count_not_convex(const Topology& topology, const std::vector<float>& positions) {
  const auto at = [&](std::uint32_t v) {
    return to_double(VectorView<const float>::packed(positions.data(), topology.vertex_count())[v]);
  };
  std::size_t count = 0;
  for (std::size_t f = 0; f < topology.face_count() && !topology.all_triangles(); ++f) {
    const auto face = topology.face(f);
    std::vector<Vec3d> triangles;
    Vec3d normal;
    for (std::size_t c = 2; c < face.size(); ++c) {
      triangles.push_back(cross(at(face[c - 1]) - at(face[0]), at(face[c]) - at(face[0])));
      normal = normal + triangles.back();
    }
    const bool turns =
        std::any_of(triangles.begin(), triangles.end(), [&](const Vec3d& n) { return dot(n, normal) < 0; });
    count += turns ? 1 : 0;
  }
  return count;
}

}  // namespace chronormal
