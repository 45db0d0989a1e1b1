#include "chronormal/motion/motion.h"

#include <limits>
#include <string>

#include "core/text.h"

namespace chronormal {
namespace {

constexpr std::size_t kMaxCount = std::numeric_limits<std::uint32_t>::max();

Status check_corners(std::size_t vertex_count, std::span<const std::uint32_t> offsets,
                     std::span<const std::uint32_t> corners) {
  if (vertex_count > kMaxCount || corners.size() > kMaxCount)
    return invalid_input("", "the mesh has more than 4,294,967,295 vertices or corners; split the mesh");
  const std::size_t face_count = offsets.empty() ? corners.size() / 3 : offsets.size() - 1;
  for (std::size_t f = 0; f < face_count; ++f) {
    const std::size_t first = offsets.empty() ? 3 * f : offsets[f];
    const std::size_t end = offsets.empty() ? 3 * f + 3 : offsets[f + 1];
    if (end > corners.size() || end < first || end - first < 3)
      return invalid_input("face " + std::to_string(f), "a face must have at least three corners; leave this face out");
    for (std::size_t c = first; c < end; ++c) {
      if (corners[c] >= vertex_count)
        return invalid_input("face " + std::to_string(f) + ", corner " + std::to_string(c - first),
                             "the corner refers to vertex " + std::to_string(corners[c]) + ", but the mesh has only " +
                                 counted(vertex_count, "vertex", "vertices") + "; correct the corner");
    }
  }
  return Success{};
}

}  // namespace

Result<Topology> Topology::polygons(std::size_t vertex_count, std::vector<std::uint32_t> offsets,
                                    std::vector<std::uint32_t> corners) {
  if (offsets.empty() || offsets.front() != 0 || offsets.back() != corners.size())
    return invalid_input("", "the offsets of the faces must begin with 0 and end with the number of corners");
  if (Status status = check_corners(vertex_count, offsets, corners); !status) return status.error();

  Topology topology;
  topology.vertex_count_ = vertex_count;
  bool all_triangles = true;
  for (std::size_t f = 0; f + 1 < offsets.size(); ++f) all_triangles &= offsets[f + 1] - offsets[f] == 3;
  if (!all_triangles) topology.offsets_ = std::move(offsets);
  topology.corners_ = std::move(corners);
  return topology;
}

Result<Topology> Topology::triangles(std::size_t vertex_count, std::vector<std::uint32_t> corners) {
  if (corners.size() % 3 != 0)
    return invalid_input("", "the number of corners of a mesh of triangles must be a multiple of 3");
  if (Status status = check_corners(vertex_count, {}, corners); !status) return status.error();

  Topology topology;
  topology.vertex_count_ = vertex_count;
  topology.corners_ = std::move(corners);
  return topology;
}

Result<Topology> Topology::triangles(std::size_t vertex_count, std::span<const std::uint16_t> corners) {
  return triangles(vertex_count, std::vector<std::uint32_t>(corners.begin(), corners.end()));
}

}  // namespace chronormal
