/// Control normals of one polygon, without vectors of lanes: what the kernels fall back to.
#ifndef CHRONORMAL_NORMALS_CONTROL_POLYGON_NORMALS_H_
#define CHRONORMAL_NORMALS_CONTROL_POLYGON_NORMALS_H_

#include <cstdint>
#include <span>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// Of the largest control normal: coefficients below it count as zero in degree(). Direction errors of 2^-28 stay far
/// below those of float32 evaluation.
inline constexpr double kDegreeTolerance = 0x1p-28;

/// The largest share of a control normal that the rounding of double may be; else it is made of integers.
inline constexpr double kLargestRounding = 0x1p-26;

struct PolygonNormals {
  ControlNormals normals;  ///< as face_control_normals() writes them
  double magnitude = 0;    ///< the largest sum of absolute products of any component, of both products in m
  double error = 0;        ///< how far any component may be from the exact one
};

/// face has the vertices of a polygon.
[[nodiscard]] PolygonNormals polygon_control_normals(const Segment& segment,
                                                     std::span<const std::uint32_t> face) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_POLYGON_NORMALS_H_
