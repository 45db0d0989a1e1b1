/// The weighted normal of one element at one t, and the length that it would have with weights by area. Fits are
/// computed from such samples.
#ifndef CHRONORMAL_NORMALS_WEIGHTING_SAMPLED_NORMAL_H_
#define CHRONORMAL_NORMALS_WEIGHTING_SAMPLED_NORMAL_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "core/rounding.h"
#include "normals/weighting/corner_terms.h"

namespace chronormal::inline internal {

struct SampledNormal {
  Vec3d normal;
  /// The factor that scales `normal` to the length that it would have with weights by area: the sum of the lengths |n|
  /// of the face normals over the corners, divided by the sum of the lengths of the terms of the corners.
  double to_area = 0;

  [[nodiscard]] Vec3d with_area_length() const noexcept { return to_area * normal; }
};

/// Returns the weighted normal of the element that has the given corners. Precondition: normal_of_face(f) returns the
/// result of face_normals_at() for a face of the element at this t.
template <class NormalOfFace>
[[nodiscard]] SampledNormal sample_normal(const Segment& segment, const NormalOfFace& normal_of_face,
                                          std::span<const std::uint32_t> corners, std::span<const std::uint32_t> faces,
                                          Weighting weighting, double t) {
  SampledNormal result;
  double terms = 0, areas = 0;
  for (std::size_t c = 0; c < corners.size(); ++c) {
    const Vec3d n = normal_of_face(faces[c]);
    if (n == Vec3d{}) continue;
    const Vec3d term = corner_term(segment, corner_vertices(*segment.topology, corners[c], faces[c]), n, weighting, t);
    result.normal = result.normal + term;
    terms += length(term);
    areas += length(n);
  }
  result.normal = without_rounding(result.normal, kCrossError * terms);
  result.to_area = terms > 0 ? areas / terms : 0;
  return result;
}

/// Returns the quadratic that has the given values at t = 0, 1/2 and 1. The values are weighted normals with the
/// lengths of weights by area (SampledNormal::with_area_length()).
[[nodiscard]] inline ControlNormals quadratic_through(const Vec3d& start, const Vec3d& middle,
                                                      const Vec3d& end) noexcept {
  return {start, 2.0 * middle - 0.5 * (start + end), end};
}

/// Returns the weighted normal of an element at t, computed from positions alone.
[[nodiscard]] inline SampledNormal sample_normal(const Segment& segment, const NormalGroups& groups,
                                                 std::size_t element, Weighting weighting, double t) {
  const auto normal_of_face = [&](std::uint32_t f) {
    Vec3d n;
    face_normals_at(segment, t, {f, 1}, {&n, 1});
    return n;
  };
  return sample_normal(segment, normal_of_face, groups.corners(element), groups.faces(element), weighting, t);
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_WEIGHTING_SAMPLED_NORMAL_H_
