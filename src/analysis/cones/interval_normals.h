/// Control normals of a part [t0, t1] of a segment, and how well they are known.
#ifndef CHRONORMAL_ANALYSIS_CONES_INTERVAL_NORMALS_H_
#define CHRONORMAL_ANALYSIS_CONES_INTERVAL_NORMALS_H_

#include <cstdint>
#include <span>

#include "analysis/cones/kernels/cones_of_three.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal::inline internal {

/// Three control normals, each of which is exactly zero or within `unknown` of its largest component from the exact
/// one.
struct IntervalNormals {
  ControlNormals normals;
  double unknown = kNormalShare;

  [[nodiscard]] bool is_known() const noexcept { return unknown <= kLargestUnknown; }
};

/// Those of an element whose control normals are within kNormalShare. Where they cancel, much of them is unknown.
[[nodiscard]] IntervalNormals part_of(const ControlNormals& normals, const Restriction& part) noexcept;

/// Those of a face, from integers.
[[nodiscard]] IntervalNormals exact_part_of(const Segment& segment, std::span<const std::uint32_t> face, double t0,
                                            double t1) noexcept;

/// The cone around those that are not zero.
[[nodiscard]] NormalCone cone_around(IntervalNormals part) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_CONES_INTERVAL_NORMALS_H_
