/// The exact normals that every scheme is held against.
///
/// They are computed as the paper writes them, by the cross product (eq. 1) of vertices interpolated at t, in double
/// and from nothing but positions: no control normals and no scheme, so that an error of those cannot hide here.
#ifndef CHRONORMAL_ANALYSIS_REFERENCE_NORMALS_H_
#define CHRONORMAL_ANALYSIS_REFERENCE_NORMALS_H_

#include <cstdint>
#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

/// Writes n(t) of a range of faces, and (0, 0, 0) where n(t) is zero: where it is so small against the positions that
/// it is made of (below 1e-10 of their products) that rounding would decide its direction. Threads: pure.
/// result must have faces.count elements; t in [0, 1]
void reference_normals(const Segment& segment, IndexRange faces, double t, std::span<Vec3d> result) noexcept;

/// n(t) of a vertex or corner: the sum of those of the faces that it belongs to, and (0, 0, 0) where that is below
/// 1e-10 of their lengths. Threads: pure. t in [0, 1]
[[nodiscard]] Vec3d reference_normal(const Segment& segment, std::span<const std::uint32_t> faces, double t) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_REFERENCE_NORMALS_H_
