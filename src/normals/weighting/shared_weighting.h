/// Computes weighted normals of elements around faces with many corners. The work for such a face is done once and kept
/// for all its elements. The caller passes the normals of the faces.
#ifndef CHRONORMAL_NORMALS_WEIGHTING_SHARED_WEIGHTING_H_
#define CHRONORMAL_NORMALS_WEIGHTING_SHARED_WEIGHTING_H_

#include <span>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/weighting.h"
#include "normals/control/shared_faces.h"

namespace chronormal::inline internal {

/// Writes the results of weighted_normals_at() of weighting.h for a range of elements. This function is for callers
/// that ask for one range after the other, since SharedFaces keeps the results for large faces.
void weighted_normals_at(const SharedFaces& shared, const NormalGroups& groups, Weighting weighting, const LocalTime& t,
                         std::span<const Vec3d> of_faces, IndexRange elements, std::span<Vec3d> result) noexcept;

/// Returns the weighted normals of all elements; uses all cores.
[[nodiscard]] std::vector<Vec3d> all_weighted_normals_at(const Segment& segment, const NormalGroups& groups,
                                                         Weighting weighting, const LocalTime& t,
                                                         std::span<const Vec3d> of_faces);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_WEIGHTING_SHARED_WEIGHTING_H_
