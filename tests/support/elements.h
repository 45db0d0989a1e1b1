/// Functions for tests of vertices and corners: some convert motions for the oracle of reference_elements.h, and others
/// change meshes.
#ifndef CHRONORMAL_TESTS_SUPPORT_ELEMENTS_H_
#define CHRONORMAL_TESTS_SUPPORT_ELEMENTS_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <numeric>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "tests/support/fixtures.h"
#include "tests/support/reference_elements.h"

namespace chronormal::test {

[[nodiscard]] inline reference::Vector to_real(const Vec3d& v) { return {v.x, v.y, v.z}; }
[[nodiscard]] inline reference::Vector to_real(const Vec3f& v) { return {v.x, v.y, v.z}; }

/// Converts a segment into a mesh of the oracle in reference_elements.h.
[[nodiscard]] inline reference::Mesh reference_mesh(const Segment& segment) {
  reference::Mesh mesh;
  for (std::size_t f = 0; f < segment.topology->face_count(); ++f) {
    const auto face = segment.topology->face(f);
    mesh.faces.emplace_back(face.begin(), face.end());
  }
  for (std::size_t v = 0; v < segment.topology->vertex_count(); ++v) {
    mesh.from.push_back(to_real(segment.from[v]));
    mesh.to.push_back(to_real(segment.to[v]));
  }
  return mesh;
}

/// Returns the corners of every element for the oracle. Both NormalGroups and the oracle number corners face by face.
[[nodiscard]] inline std::vector<std::vector<reference::Corner>> reference_corners(const reference::Mesh& mesh,
                                                                                   const NormalGroups& groups) {
  const auto all = reference::corners_of(mesh);
  std::vector<std::vector<reference::Corner>> result(groups.size());
  for (std::size_t e = 0; e < groups.size(); ++e) {
    for (const std::uint32_t c : groups.corners(e)) result[e].push_back(all[c]);
  }
  return result;
}

/// Returns the motion with its faces in the given order, as polygons.
[[nodiscard]] inline Motion with_faces_in_order(const Motion& motion, const std::vector<std::size_t>& order) {
  std::vector<std::uint32_t> offsets = {0}, corners;
  for (const std::size_t f : order) {
    const auto face = motion.topology.face(f);
    corners.insert(corners.end(), face.begin(), face.end());
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  Motion result = motion;
  result.topology = fixtures::make_polygons(motion.topology.vertex_count(), std::move(offsets), std::move(corners));
  return result;
}

[[nodiscard]] inline std::vector<std::size_t> shuffled_order(std::size_t count, std::uint64_t seed) {
  std::vector<std::size_t> order(count);
  std::iota(order.begin(), order.end(), std::size_t{0});
  fixtures::Random random(seed);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random.below(i)]);
  return order;
}

/// Returns the motion with every position replaced by change(position).
[[nodiscard]] inline Motion with_positions(Motion motion,
                                           const std::function<fixtures::Point(const fixtures::Point&)>& change) {
  for (Motion::Keyframe& keyframe : motion.keyframes) {
    for (std::size_t i = 0; i < keyframe.positions.size(); i += 3) {
      float* const p = keyframe.positions.data() + i;
      const fixtures::Point moved = change({p[0], p[1], p[2]});
      for (std::size_t k = 0; k < 3; ++k) p[k] = static_cast<float>(moved[k]);
    }
  }
  return motion;
}

/// Returns the motion with a separate vertex for each corner, so every edge is a seam.
[[nodiscard]] inline Motion torn(const Motion& motion) {
  Motion result = motion;
  std::vector<std::uint32_t> offsets = {0}, corners;
  for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
    for (std::size_t i = 0; i < motion.topology.face(f).size(); ++i)
      corners.push_back(static_cast<std::uint32_t>(corners.size()));
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
  }
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    auto& positions = result.keyframes[k].positions;
    positions.clear();
    for (const std::uint32_t vertex : motion.topology.corners()) {
      const float* const p = motion.keyframes[k].positions.data() + 3 * std::size_t{vertex};
      positions.insert(positions.end(), p, p + 3);
    }
  }
  const std::size_t vertex_count = corners.size();
  result.topology = fixtures::make_polygons(vertex_count, std::move(offsets), std::move(corners));
  return result;
}

/// Makes a motion that stands still: both keyframes have the given points.
[[nodiscard]] inline Motion still(Topology topology, const std::vector<fixtures::Point>& points) {
  return fixtures::make_motion(std::move(topology), points, points);
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_ELEMENTS_H_
