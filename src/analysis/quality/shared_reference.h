/// Computes the exact normals of analysis/quality.h for elements that share polygons with many corners. Private to the
/// library.
#ifndef CHRONORMAL_ANALYSIS_QUALITY_SHARED_REFERENCE_H_
#define CHRONORMAL_ANALYSIS_QUALITY_SHARED_REFERENCE_H_

#include <cstdint>
#include <span>

#include "chronormal/analysis/quality.h"
#include "normals/control/shared_faces.h"

namespace chronormal::inline internal {

/// Returns the exact normal of some faces at t, as reference_normal() of analysis/quality.h does. `areas` are the
/// results of reference_area() for the faces at t, so that faces which several elements share are computed once.
[[nodiscard]] Vec3d reference_normal(const SharedFaces& shared, std::span<const std::uint32_t> faces,
                                     std::span<const ReferenceArea> areas, double t) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_QUALITY_SHARED_REFERENCE_H_
