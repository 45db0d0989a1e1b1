/// Adds up the control normals of faces. If faces cancel so far that a sum is hardly more than rounding error, integers
/// compute the sum.
#ifndef CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_
#define CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "core/rounding.h"
#include "normals/control/polygon_normals.h"
#include "normals/control/shared_faces.h"

namespace chronormal::inline internal {

/// The sum of the control normals of faces. Components that are only rounding errors can be set to zero.
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

/// Adds up the control normals of the faces of an element. Also bounds the error of the sum, including the errors of
/// the faces. Threads: pure.
[[nodiscard]] inline BoundedNormals control_normals_of_group(const SharedFaces& faces, const NormalGroups& groups,
                                                             std::size_t element) noexcept {
  ControlNormalsSum sum;
  std::array<double, 3> of_faces{};
  for (const std::uint32_t f : groups.faces(element)) {
    const PolygonNormals face = faces.control_normals(f);
    sum.add(face.normals);
    for (std::size_t k = 0; k < 3; ++k) of_faces[k] += face.errors[k];
  }
  BoundedNormals result{sum.without_rounding(), sum.errors()};
  for (std::size_t k = 0; k < 3; ++k) result.errors[k] += of_faces[k];
  return result;
}

/// Returns the control normals of an element, and bounds of their errors. Each control normal has an error of at most
/// 2^-24 of its length, and is zero only if the exact control normal is zero. If faces cancel so far that the error in
/// double could exceed 2^-26 of the length, integers compute the control normals. Pure. Precondition: of_faces has the
/// result of face_control_normals() for all faces.
[[nodiscard]] inline BoundedNormals settled_group_normals(const SharedFaces& faces, const NormalGroups& groups,
                                                          std::span<const ControlNormals> of_faces,
                                                          std::size_t element) noexcept {
  // The error of each control normal of a face is at most 2^-26 (kLargestRounding) of its largest component. The
  // additions round far less than that.
  constexpr double kOfFace = kLargestRounding + 0x1p-40, kMostCancelled = 4;
  ControlNormalsSum sum;
  std::array<double, 3> sizes{};
  for (const std::uint32_t f : groups.faces(element)) {
    const ControlNormals& face = of_faces[f];
    sum.add(face);
    sizes = {sizes[0] + max_abs(face.n0), sizes[1] + max_abs(face.m), sizes[2] + max_abs(face.n1)};
  }
  BoundedNormals result{sum.without_rounding(), {kOfFace * sizes[0], kOfFace * sizes[1], kOfFace * sizes[2]}};
  if (result.largest_share() <= kMostCancelled * kOfFace) return result;
  result.errors = control_normals_of_group(faces, groups, element).errors;
  if (result.largest_share() <= kLargestRounding) return result;
  result.settle(faces.exact_sum(groups.faces(element)).rounded());
  return result;
}

/// Writes the results of group_control_normals() of normal_groups.h for a range of elements. This function is for
/// callers that ask for one range after the other, since SharedFaces keeps the results for large faces.
void group_control_normals(const SharedFaces& faces, const NormalGroups& groups,
                           std::span<const ControlNormals> of_faces, IndexRange elements,
                           std::span<ControlNormals> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_GROUP_SUM_H_
