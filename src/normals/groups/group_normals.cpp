#include "chronormal/normals/normal_groups.h"

#include <cassert>
#include <cstddef>

#include "core/blocks.h"
#include "normals/groups/group_sum.h"

namespace chronormal {
namespace {

constexpr std::size_t kBlock = 4096;

}  // namespace

void group_control_normals(const NormalGroups& groups, std::span<const ControlNormals> of_faces, IndexRange elements,
                           std::span<ControlNormals> result) noexcept {
  assert(result.size() == elements.count && elements.end() <= groups.size());
  for (std::size_t i = 0; i < elements.count; ++i) {
    ControlNormalsSum sum;
    for (const std::uint32_t f : groups.faces(elements.first + i)) {
      assert(f < of_faces.size());
      sum.add(of_faces[f]);
    }
    result[i] = sum.without_rounding();
  }
}

void group_control_normals(const Segment& segment, const NormalGroups& groups, std::span<const ControlNormals> of_faces,
                           IndexRange elements, std::span<ControlNormals> result) noexcept {
  group_control_normals(SharedFaces(segment), groups, of_faces, elements, result);
}

inline namespace internal {

void group_control_normals(const SharedFaces& faces, const NormalGroups& groups,
                           std::span<const ControlNormals> of_faces, IndexRange elements,
                           std::span<ControlNormals> result) noexcept {
  assert(result.size() == elements.count && elements.end() <= groups.size());
  for (std::size_t i = 0; i < elements.count; ++i)
    result[i] = settled_group_normals(faces, groups, of_faces, elements.first + i).normals;
}

}  // namespace internal

std::vector<ControlNormals> all_face_control_normals(const Segment& segment) {
  std::vector<ControlNormals> normals(segment.topology->face_count());
  parallel_blocks(normals.size(), kBlock, [&](IndexRange faces) {
    face_control_normals(segment, faces, std::span(normals).subspan(faces.first, faces.count));
  });
  return normals;
}

std::vector<ControlNormals> all_group_control_normals(const Segment& segment, const NormalGroups& groups) {
  const std::vector<ControlNormals> of_faces = all_face_control_normals(segment);
  const SharedFaces faces(segment);
  std::vector<ControlNormals> normals(groups.size());
  parallel_blocks(normals.size(), kBlock, [&](IndexRange elements) {
    group_control_normals(faces, groups, of_faces, elements,
                          std::span(normals).subspan(elements.first, elements.count));
  });
  return normals;
}

}  // namespace chronormal
