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
#include <string>
#include <vector>

namespace chronormal::vtk {
namespace {

const char* const kFlags = vtkDataSetAttributes::GhostArrayName();
constexpr const char* kMeanwhile = "chronormal: ghosts";

// The cells beyond so many levels, marked as vtkPolyData::RemoveGhostCells() wants them.
vtkSmartPointer<vtkUnsignedCharArray> cells_beyond(vtkPolyData* piece, vtkUnsignedCharArray* ghosts, int levels) {
  const auto beyond = vtkSmartPointer<vtkUnsignedCharArray>::New();
  beyond->SetName(kFlags);
  beyond->SetNumberOfValues(piece->GetNumberOfCells());
  for (vtkIdType c = 0; c < piece->GetNumberOfCells(); ++c)
    beyond->SetValue(c, ghosts->GetValue(c) & vtkDataSetAttributes::DUPLICATECELL);

  // Each round reaches the cells that share a point with what was reached before.
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

  // RemoveGhostCells() drops flags and global ids: they go as plain arrays of other names meanwhile.
  struct Kept {
    vtkDataSetAttributes* of;
    std::string global_ids;
  };
  std::array<Kept, 2> kept = {Kept{piece->GetPointData(), {}}, Kept{piece->GetCellData(), {}}};
  for (Kept& k : kept) {
    if (vtkDataArray* const ids = k.of->GetGlobalIds(); ids != nullptr && ids->GetName() != nullptr) {
      k.global_ids = ids->GetName();
      k.of->SetActiveAttribute(-1, vtkDataSetAttributes::GLOBALIDS);
    }
    if (vtkDataArray* const flags = k.of->GetArray(kFlags)) {
      const auto copy = vtkSmartPointer<vtkDataArray>::Take(flags->NewInstance());
      copy->ShallowCopy(flags);
      copy->SetName(kMeanwhile);
      k.of->AddArray(copy);
    }
  }
  piece->GetCellData()->AddArray(beyond);
  piece->RemoveGhostCells();
  for (const Kept& k : kept) {
    if (!k.global_ids.empty()) k.of->SetActiveAttribute(k.global_ids.c_str(), vtkDataSetAttributes::GLOBALIDS);
    const vtkSmartPointer<vtkDataArray> flags = k.of->GetArray(kMeanwhile);
    k.of->RemoveArray(kMeanwhile);
    k.of->RemoveArray(kFlags);
    if (flags == nullptr || flags->GetRange()[1] == 0) continue;
    flags->SetName(kFlags);
    k.of->AddArray(flags);
  }
}

}  // namespace chronormal::vtk
