/// Normals over an open shutter: the mean of n(t), and of the unit normal n(t) / |n(t)|, over an interval of time.
///
/// A renderer with motion blur sees every instant of [t0, t1] and shows their mean. What it should store as the normal
/// of a pixel, or shade with where it shades once, is the mean of the unit normal, and not the normal in the middle or
/// half way between the ends:
///
///     mean        1 / (t1 - t0) integral of n(t) dt             a third of the three control normals of [t0, t1], exactly
///     mean_unit   1 / (t1 - t0) integral of n(t) / |n(t)| dt    an elliptic integral; here to a bound that is proven
///
/// The first weighs instants by the area of the face at each (half of it is the mean vector area), the second does not.
/// The length of mean_unit says how far normals spread: 1 where they are all the same, 0 where they cancel.
///
/// Proof      Gauss's rule with 8 nodes on pieces in which |n(z)|^2 has no zero for complex z nearby, so that the unit
///            normal is analytic there and the error is known (docs/theory.md, section 21). Around an instant at which
///            n(t) = 0, pieces are halved until they are 2^-28 of the interval, and count as error.
/// Threads    pure, on the thread that calls: no allocation, no throw, the same bits everywhere.
#ifndef CHRONORMAL_ANALYSIS_SHUTTER_H_
#define CHRONORMAL_ANALYSIS_SHUTTER_H_

#include <span>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal {

struct ShutterNormal {
  Vec3d mean;       ///< of n(t); for triangles twice the mean vector area
  Vec3d mean_unit;  ///< of n(t) / |n(t)|; zero where n is zero all the time
  double error =
      0;  ///< the exact mean of the unit normal is within this of mean_unit; some 1e-7 where nothing collapses
};

/// Returns the means over [t0, t1]. Control normals are taken to be within 2^-26 of their length, and that is in the
/// error. Cost: about 0.2 microseconds where normals turn little, more where n(t) comes near zero.
/// 0 <= t0 <= t1 <= 1; where both are the same, the means are the normals at that instant
[[nodiscard]] ShutterNormal shutter_normal(const ControlNormals& normals, double t0, double t1) noexcept;

/// Writes the means of a range of faces over [t0, t1], from positions: where control normals of the interval cancel,
/// from integers. result must have faces.count elements; faces must lie inside the topology; 0 <= t0 <= t1 <= 1
void face_shutter_normals(const Segment& segment, IndexRange faces, double t0, double t1,
                          std::span<ShutterNormal> result) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_SHUTTER_H_
