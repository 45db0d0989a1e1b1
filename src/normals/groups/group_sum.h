/// Sums of the control normals of faces, and that of one element straight from positions: for the few that need
/// another look.
#ifndef CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_
#define CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_

#include <array>
#include <cstddef>
#include <cstdint>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "core/rounding.h"
#include "normals/control/polygon_normals.h"

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
  [[nodiscard]] std::array<double, 3> errors() const noexcept { return {n0_.error(), m_.error(), n1_.error()}; }

 private:
  VectorSum n0_, m_, n1_;
};

/// The normals as group_control_normals() has them, bit for bit. Pure: no allocation, no throw.
[[nodiscard]] inline BoundedNormals control_normals_of_group(const Segment& segment, const NormalGroups& groups,
                                                             std::size_t element) noexcept {
  ControlNormalsSum sum;
  std::array<double, 3> of_faces{};
  for (const std::uint32_t f : groups.faces(element)) {
    const PolygonNormals face = polygon_control_normals(segment, segment.topology->face(f));
    sum.add(face.normals);
    for (std::size_t k = 0; k < 3; ++k) of_faces[k] += face.errors[k];
  }
  BoundedNormals result{sum.without_rounding(), sum.errors()};
  for (std::size_t k = 0; k < 3; ++k) result.errors[k] += of_faces[k];
  return result;
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_
