#include <vtkCellArray.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataNormals.h>
#include <vtkTriangleMeshPointNormals.h>
#include <vtkVersion.h>

#include <stdexcept>

#include "peers/peers.h"

namespace chronormal::peers {
namespace {

vtkNew<vtkPolyData> make_mesh(const TriangleMesh& from) {
  vtkNew<vtkPoints> points;
  for (std::size_t v = 0; v < from.vertex_count(); ++v) points->InsertNextPoint(from.positions.data() + 3 * v);
  vtkNew<vtkCellArray> faces;
  for (std::size_t f = 0; f < from.face_count(); ++f) {
    const auto c = from.corners.subspan(3 * f, 3);
    faces->InsertNextCell({c[0], c[1], c[2]});
  }
  vtkNew<vtkPolyData> mesh;
  mesh->SetPoints(points);
  mesh->SetPolys(faces);
  return mesh;
}

template <class Filter>
std::vector<Vec3d> filtered(const TriangleMesh& from, Filter& filter) {
  const vtkNew<vtkPolyData> mesh = make_mesh(from);
  filter.SetInputData(mesh);
  filter.Update();
  vtkDataArray* const normals = filter.GetOutput()->GetPointData()->GetNormals();
  if (normals == nullptr || static_cast<std::size_t>(normals->GetNumberOfTuples()) != from.vertex_count())
    throw std::runtime_error("VTK gave other than one normal for each vertex");
  std::vector<Vec3d> result;
  for (vtkIdType v = 0; v < normals->GetNumberOfTuples(); ++v) {
    const double* const n = normals->GetTuple3(v);
    result.push_back(unit(Vec3d{n[0], n[1], n[2]}));
  }
  return result;
}

// As vertices are shaded smoothly: no vertex is split, no face turned round.
std::vector<Vec3d> poly_data_normals(const TriangleMesh& from) {
  vtkNew<vtkPolyDataNormals> filter;
  filter->SplittingOff();
  filter->ConsistencyOff();
  return filtered(from, *filter);
}

std::vector<Vec3d> triangle_mesh_point_normals(const TriangleMesh& from) {
  vtkNew<vtkTriangleMeshPointNormals> filter;
  return filtered(from, *filter);
}

}  // namespace

std::vector<Method> vtk_methods() {
  const std::string library = "VTK " + std::to_string(vtkVersion::GetVTKMajorVersion()) + "." +
                              std::to_string(vtkVersion::GetVTKMinorVersion());
  return {{library, "vtkPolyDataNormals", poly_data_normals},
          {library, "vtkTriangleMeshPointNormals", triangle_mesh_point_normals}};
}

}  // namespace chronormal::peers
