/// Exact normals between two steps of a vtkPolyData.
///
/// Both steps have the same cells, and every point moves on a straight line between them. A cell has the vector area of
/// its polygon, or of the triangles of its strip, as normal; a point has the sum over the faces that use it: area
/// weights, as vtkTriangleMeshPointNormals has them. Vertices, lines, and points without faces have (0, 0, 0).
///
/// Bits       The normal of a point follows from the faces around it alone, and not from the order of points and cells
///            or from what else is in the mesh. So a piece has the bits of the whole, wherever it has all these faces.
/// Precision  Positions in float go through the control normals of the library, which are exact where double is not
///            enough; positions of any other type are computed in double.
#ifndef CHRONORMAL_VTK_POLY_DATA_NORMALS_H_
#define CHRONORMAL_VTK_POLY_DATA_NORMALS_H_

#include <vtkDataArray.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "chronormal/core/result.h"

namespace chronormal::vtk {

/// Whether two steps are a motion: the same cells over the same points, which are all there and finite.
/// Errors: kInvalidInput, with the place "cell C" or "point P" where only some of it differs.
[[nodiscard]] Status check_motion(vtkPolyData* from, vtkPolyData* to);

/// Unit normals as arrays of three components, of double where the points are, else of float.
struct MeshNormals {
  vtkSmartPointer<vtkDataArray> of_points;  ///< nothing where not asked for
  vtkSmartPointer<vtkDataArray> of_cells;
};
/// The normals at t, from the earlier step, 0, to the later one, 1. On all cores, but for the lists of who has which face.
/// Precondition: check_motion() found no error.
[[nodiscard]] MeshNormals normals_between(vtkPolyData* from, vtkPolyData* to, double t, bool points, bool cells);

}  // namespace chronormal::vtk

#endif  // CHRONORMAL_VTK_POLY_DATA_NORMALS_H_
