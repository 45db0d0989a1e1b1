/// Removes ghost cells, which are copies of cells of other pieces around a piece of a mesh.
#ifndef CHRONORMAL_VTK_GHOST_CELLS_H_
#define CHRONORMAL_VTK_GHOST_CELLS_H_

#include <vtkPolyData.h>

namespace chronormal::vtk {

/// Removes the ghost cells that are more than `levels` levels away from the cells of the piece, and the points that
/// only these cells use. A ghost cell is of level 1 if it shares a point with a cell of the piece, of level 2 if it
/// shares a point with a ghost cell of level 1, and so on. Cells that are hidden but are no copies stay. Takes
/// O(levels x corners) time.
void keep_ghost_levels(vtkPolyData* piece, int levels);

}  // namespace chronormal::vtk

#endif  // CHRONORMAL_VTK_GHOST_CELLS_H_
