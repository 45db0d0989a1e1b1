/// Curves of points through time steps: cubics, as Catmull and Rom have them.
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

/// The steps that the curve between two neighbours follows from, in a sequence of so many: these two and the ones
/// beside them, at both ends of the sequence the nearest four.
struct NearSteps {
  std::size_t first = 0, count = 0;
};
/// segment + 1 < steps
[[nodiscard]] NearSteps steps_near(std::size_t segment, std::size_t steps);

/// The curves from steps[segment] to the next one, in double. The velocity of a point at a step is that of the
/// parabola through it and its two neighbours, and at the first and the last step that of the cubic through the nearest
/// four, or as many as there are. times must ascend, and all steps have as many points.
[[nodiscard]] PointCurves curves_through(std::span<vtkPointSet* const> steps, std::span<const double> times,
                                         std::size_t segment);

/// The places of all points at t in [0, 1], in a type of VTK (VTK_FLOAT, VTK_DOUBLE).
[[nodiscard]] vtkSmartPointer<vtkPoints> points_at(const PointCurves& curves, double t, int type);

}  // namespace chronormal::vtk

#endif  // CHRONORMAL_VTK_POINT_CURVES_H_
