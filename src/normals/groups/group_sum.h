/// Sums of the control normals of faces, and that of one element straight from positions: for the few that need
/// another look.
#ifndef CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_
#define CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_

#include <cstddef>
#include <cstdint>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "core/rounding.h"

namespace chronormal::inline internal {

/// A sum over faces, with zero for what is nothing but rounding.
class ControlNormalsSum {
 public:
  void add(const ControlNormals& face) noexcept {
    n0_.add(face.n0);
    m_.add(face.m);
    n1_.add(face.n1);
  }

  [[nodiscard]] ControlNormals without_rounding() const noexcept {
    return {n0_.without_rounding(), m_.without_rounding(), n1_.without_rounding()};
  }

 private:
  VectorSum n0_, m_, n1_;
};

/// As group_control_normals() has them, bit for bit. Pure: no allocation, no throw.
[[nodiscard]] inline ControlNormals control_normals_of_group(const Segment& segment, const NormalGroups& groups,
                                                             std::size_t element) noexcept {
  ControlNormalsSum sum;
  for (const std::uint32_t f : groups.faces(element)) {
    ControlNormals face;
    face_control_normals(segment, {f, 1}, {&face, 1});
    sum.add(face);
  }
  return sum.without_rounding();
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_
