// Makes the cubic path of each point from its positions at up to four time steps.
#include "point_curves.h"

#include <algorithm>

#include "chronormal/core/polynomial.h"
#include "chronormal/motion/paths.h"

namespace chronormal::vtk {

NearSteps steps_near(std::size_t segment, std::size_t steps) {
  const std::size_t last = steps - 1, before = segment - std::min<std::size_t>(segment, 1);
  const std::size_t first = std::min(before, last - std::min<std::size_t>(last, 3));
  return {first, std::min(std::max<std::size_t>(segment + 2, 3), last) - first + 1};
}

PointCurves curves_through(std::span<vtkPointSet* const> steps, std::span<const double> times, std::size_t segment) {
  const auto count = static_cast<std::size_t>(steps[segment]->GetNumberOfPoints());
  const auto place = [](vtkPointSet* step, std::size_t point) {
    std::array<double, 3> x{};
    step->GetPoint(static_cast<vtkIdType>(point), x.data());
    return Vec3d{x[0], x[1], x[2]};
  };
  const double third = (times[segment + 1] - times[segment]) / 3;
  const VelocityShares start = velocity_shares(times, segment), end = velocity_shares(times, segment + 1);
  const auto velocity = [&](const VelocityShares& shares, std::size_t point) {
    Vec3d sum;
    for (std::size_t k = 0; k < shares.share.size(); ++k)
      sum = sum + shares.share[k] * place(steps[shares.first + k], point);
    return sum;
  };
  PointCurves curves;
  for (auto& controls : curves) controls.resize(count);
  for (std::size_t p = 0; p < count; ++p) {
    curves[0][p] = place(steps[segment], p);
    curves[3][p] = place(steps[segment + 1], p);
    curves[1][p] = curves[0][p] + third * velocity(start, p);
    curves[2][p] = curves[3][p] - third * velocity(end, p);
  }
  return curves;
}

vtkSmartPointer<vtkPoints> points_at(const PointCurves& curves, double t, int type) {
  const auto points = vtkSmartPointer<vtkPoints>::New();
  points->SetDataType(type);
  points->SetNumberOfPoints(static_cast<vtkIdType>(curves[0].size()));
  for (std::size_t p = 0; p < curves[0].size(); ++p) {
    const Vec3d x = evaluate(Bernstein<Vec3d, 3>{curves[0][p], curves[1][p], curves[2][p], curves[3][p]}, t);
    points->SetPoint(static_cast<vtkIdType>(p), x.x, x.y, x.z);
  }
  return points;
}

}  // namespace chronormal::vtk
