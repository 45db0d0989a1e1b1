// Counts the levels of ghost cells outward from the cells of a piece, since VTK 9 marks ghost cells without their
// levels.
#include "ghost_cells.h"

#include <vtkCellData.h>
#include <vtkDataSetAttributes.h>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

namespace chronormal::vtk {
namespace {

const char* const kFlags = vtkDataSetAttributes::GhostArrayName();
constexpr const char* kMeanwhile = "chronormal: ghosts";

// Marks the cells beyond the given number of levels, as vtkPolyData::RemoveGhostCells() expects.
vtkSmartPointer<vtkUnsignedCharArray> cells_beyond(vtkPolyData* piece, vtkUnsignedCharArray* ghosts, int levels) {
  const auto beyond = vtkSmartPointer<vtkUnsignedCharArray>::New();
  beyond->SetName(kFlags);
  beyond->SetNumberOfValues(piece->GetNumberOfCells());
  for (vtkIdType c = 0; c < piece->GetNumberOfCells(); ++c)
    beyond->SetValue(c, ghosts->GetValue(c) & vtkDataSetAttributes::DUPLICATECELL);

  // Each round reaches the cells that share a point with cells that were reached before.
  std::vector<bool> reached(static_cast<std::size_t>(piece->GetNumberOfPoints()), false);
  const auto is_reached = [&reached](vtkIdType point) { return reached[static_cast<std::size_t>(point)]; };
  vtkNew<vtkIdList> points;
  std::vector<vtkIdType> next;
  for (int level = 0; level <= levels; ++level) {
    next.clear();
    for (vtkIdType c = 0; c < piece->GetNumberOfCells(); ++c) {
      piece->GetCellPoints(c, points);
      if (beyond->GetValue(c) == 0 || (level > 0 && std::any_of(points->begin(), points->end(), is_reached)))
        next.push_back(c);
    }
    for (const vtkIdType c : next) {
      beyond->SetValue(c, 0);
      piece->GetCellPoints(c, points);
      for (const vtkIdType point : *points) reached[static_cast<std::size_t>(point)] = true;
    }
  }
  return beyond;
}

}  // namespace

void keep_ghost_levels(vtkPolyData* piece, int levels) {
  vtkUnsignedCharArray* const ghosts = piece->GetCellGhostArray();
  if (ghosts == nullptr) return;
  const vtkSmartPointer<vtkUnsignedCharArray> beyond = cells_beyond(piece, ghosts, levels);

  // RemoveGhostCells() also drops the ghost flags of the cells that stay. The flags therefore get another name until
  // the call is done.
  const std::array<vtkDataSetAttributes*, 2> all = {piece->GetPointData(), piece->GetCellData()};
  for (vtkDataSetAttributes* const attributes : all) {
    vtkDataArray* const flags = attributes->GetArray(kFlags);
    if (flags == nullptr) continue;
    const auto kept = vtkSmartPointer<vtkDataArray>::Take(flags->NewInstance());
    kept->ShallowCopy(flags);
    kept->SetName(kMeanwhile);
    attributes->AddArray(kept);
  }
  piece->GetCellData()->AddArray(beyond);
  piece->RemoveGhostCells();
  for (vtkDataSetAttributes* const attributes : all) {
    const vtkSmartPointer<vtkDataArray> flags = attributes->GetArray(kMeanwhile);
    attributes->RemoveArray(kMeanwhile);
    attributes->RemoveArray(kFlags);
    if (flags == nullptr || flags->GetRange()[1] == 0) continue;
    flags->SetName(kFlags);
    attributes->AddArray(flags);
  }
}

}  // namespace chronormal::vtk
