/// Computes the curves of points through time steps, which are Catmull-Rom cubics.
#ifndef CHRONORMAL_VTK_POINT_CURVES_H_
#define CHRONORMAL_VTK_POINT_CURVES_H_

#include <vtkPointSet.h>
#include <vtkPoints.h>
#include <vtkSmartPointer.h>

#include <array>
#include <cstddef>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"

namespace chronormal::vtk {

/// The four control positions of the cubic of every point: controls[k][point].
using PointCurves = std::array<std::vector<Vec3d>, 4>;

/// The steps that determine the curve between two neighbouring steps: the two steps and one more on either side, or the
/// nearest four steps at the ends of the sequence. `first` is the index of the first of these steps.
struct NearSteps {
  std::size_t first = 0, count = 0;
};
/// Finds the steps that determine the curve of a segment in a sequence of `steps` steps. Precondition: segment + 1 <
/// steps.
[[nodiscard]] NearSteps steps_near(std::size_t segment, std::size_t steps);

/// Returns the curves from steps[segment] to the next step, in double. The velocity of a point at an inner step is the
/// derivative of the parabola through the step and its two neighbours. At the first and the last step, the velocity is
/// the derivative of the cubic through the nearest four steps, or through as many as there are. `times` must ascend,
/// and all steps must have equally many points.
[[nodiscard]] PointCurves curves_through(std::span<vtkPointSet* const> steps, std::span<const double> times,
                                         std::size_t segment);

/// Returns the positions of all points at t in [0, 1], as numbers of a type of VTK (VTK_FLOAT, VTK_DOUBLE).
[[nodiscard]] vtkSmartPointer<vtkPoints> points_at(const PointCurves& curves, double t, int type);

}  // namespace chronormal::vtk

#endif  // CHRONORMAL_VTK_POINT_CURVES_H_
