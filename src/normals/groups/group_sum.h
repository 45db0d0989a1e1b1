/// The control normals of one element of a group, straight from positions: for the few that need another look.
#ifndef CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_
#define CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "core/noise.h"

namespace chronormal {

/// As group_control_normals() has them, bit for bit. Pure: no allocation, no throw.
[[nodiscard]] inline ControlNormals control_normals_of_group(const Segment& segment, const NormalGroups& groups,
                                                             std::size_t element) noexcept {
  VectorSum n0, m, n1;
  for (const std::uint32_t f : groups.faces(element)) {
    ControlNormals face;
    face_control_normals(segment, {f, 1}, {&face, 1});
    n0.add(face.n0);
    m.add(face.m);
    n1.add(face.n1);
  }
  return {n0.without_noise(), m.without_noise(), n1.without_noise()};
}

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_
