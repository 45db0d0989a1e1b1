/// Computes exact normals between two steps of a vtkPolyData.
///
/// Both steps have the same cells, and every point moves on a straight line between them, or on a curve through more
/// steps. The normal of a cell is the vector area of its polygon, or of the triangles of its strip. The normal of a
/// point is the sum over the faces that use the point, with area weights as in vtkTriangleMeshPointNormals. Vertices,
/// lines, and points without faces have (0, 0, 0).
///
/// Bits       The normal of a point follows from the faces around it alone, and not from the order of points and cells
///            or from the rest of the mesh. A piece therefore has the same bits as the whole mesh at every point
///            around which it has all faces.
/// Precision Positions in float go through the control normals of the library, which are exact where double is not
///            enough; positions of any other type are computed in double.
#ifndef CHRONORMAL_VTK_POLY_DATA_NORMALS_H_
#define CHRONORMAL_VTK_POLY_DATA_NORMALS_H_

#include <vtkDataArray.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>

#include "chronormal/core/result.h"
#include "point_curves.h"

namespace chronormal::vtk {

/// Checks that two steps are a motion: they must have the same cells over the same points, and the points must be
/// finite. Errors: kInvalidInput, with the place "cell C" or "point P" if only a part differs.
[[nodiscard]] Status check_motion(vtkPolyData* from, vtkPolyData* to);

/// Unit normals as arrays of three components, in double if the points are in double, otherwise in float.
struct MeshNormals {
  vtkSmartPointer<vtkDataArray> of_points;  ///< nullptr if not requested
  vtkSmartPointer<vtkDataArray> of_cells;
};
/// Computes the normals at t, which goes from 0 at the earlier step to 1 at the later one. Runs on all cores, except
/// when it makes the lists of the faces of each element. Precondition: check_motion() found no error.
[[nodiscard]] MeshNormals normals_between(vtkPolyData* from, vtkPolyData* to, double t, bool points, bool cells);
/// Computes the normals at t of a mesh whose points move on curves, from the positions of the points at t, in double.
[[nodiscard]] MeshNormals normals_on_curves(vtkPolyData* mesh, const PointCurves& curves, double t, bool points,
                                            bool cells);

}  // namespace chronormal::vtk

#endif  // CHRONORMAL_VTK_POLY_DATA_NORMALS_H_
