/// Normals of vertices and corners: sums of the control normals of faces.
///
/// The length of a face normal is twice the area of the face, so the area-weighted normal of a vertex is the plain sum
/// of the n(t) around it: a sum of quadratics, hence a quadratic, exact at every t. The control normals are added once;
/// after that vertices and corners are elements like any other, for NormalCurves and for every scheme that takes
/// control normals, without a look at the connectivity. No other weighting has this property (normals/weighting.h).
///
/// Order      The terms of an element are added in the order that NormalGroups keeps: shuffling the faces of the mesh
///            gives the same bits, and so does any number of threads.
/// Degenerate An element without corners, or whose faces all have no area, has zero control normals; its unit normal is
///            (0, 0, 0), which NormalCurves counts. A face without area adds nothing; a duplicate face adds its normal
///            twice, and two of opposite orientation cancel. A component of the sum that is smaller than the rounding
///            error of its own terms is written as exactly zero.
#ifndef CHRONORMAL_NORMALS_GROUP_NORMALS_H_
#define CHRONORMAL_NORMALS_GROUP_NORMALS_H_

#include <span>
#include <vector>

#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

/// Writes the control normals of a range of elements: nine additions per corner. Pure: no allocation, no throw.
/// of_faces must have the control normals of all faces, result as many elements as the range
void group_control_normals(const NormalGroups& groups, std::span<const ControlNormals> of_faces, IndexRange elements,
                           std::span<ControlNormals> result) noexcept;

/// The control normals of all faces of a segment, and of all elements. On all cores.
[[nodiscard]] std::vector<ControlNormals> all_face_control_normals(const Segment& segment);
[[nodiscard]] std::vector<ControlNormals> all_group_control_normals(const Segment& segment, const NormalGroups& groups);

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_GROUP_NORMALS_H_
