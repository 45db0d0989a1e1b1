#include <SMP/Common/vtkSMPToolsAPI.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataNormals.h>
#include <vtkSelectEnclosedPoints.h>
#include <vtkTriangleMeshPointNormals.h>
#include <vtkVersion.h>

#include <memory>

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

struct KeptMesh : LibraryMesh {
  explicit KeptMesh(const TriangleMesh& from) : mesh(make_mesh(from)) {
    // This call does the work of vtkSMPTools::Initialize(), whose header does not compile as C++20.
    vtk::detail::smp::vtkSMPToolsAPI::GetInstance().Initialize(1);
    for (vtkPolyDataNormals* const filter : {of_faces.Get(), of_vertices.Get()}) {
      filter->SetInputData(mesh);
      filter->SplittingOff();
      filter->ConsistencyOff();
    }
    of_faces->ComputePointNormalsOff();
    of_faces->ComputeCellNormalsOn();
    by_area->SetInputData(mesh);
  }

  vtkNew<vtkPolyData> mesh;
  vtkNew<vtkPolyDataNormals> of_faces, of_vertices;
  vtkNew<vtkTriangleMeshPointNormals> by_area;
};

// Marks the points as moved, so that the filter computes its normals again.
template <class Filter>
void run_again(LibraryMesh& kept, Filter& filter) {
  static_cast<KeptMesh&>(kept).mesh->GetPoints()->Modified();
  filter.Modified();
  filter.Update();
}

Vec3d tuple(vtkDataArray* normals, std::size_t element) {
  const double* const n = normals->GetTuple3(static_cast<vtkIdType>(element));
  return unit(Vec3d{n[0], n[1], n[2]});
}

std::string version() {
  return std::to_string(vtkVersion::GetVTKMajorVersion()) + "." + std::to_string(vtkVersion::GetVTKMinorVersion());
}

}  // namespace

std::vector<bool> vtk_enclosed(const TriangleMesh& mesh, std::span<const float> points) {
  vtkNew<vtkPoints> places;
  for (std::size_t p = 0; p < points.size(); p += 3) places->InsertNextPoint(points.data() + p);
  vtkNew<vtkPolyData> cloud;
  cloud->SetPoints(places);
  vtkNew<vtkSelectEnclosedPoints> filter;
  filter->SetInputData(cloud);
  filter->SetSurfaceData(make_mesh(mesh));
  filter->SetTolerance(0);
  filter->Update();
  std::vector<bool> result;
  for (std::size_t p = 0; 3 * p < points.size(); ++p)
    result.push_back(filter->IsInside(static_cast<vtkIdType>(p)) != 0);
  return result;
}

Library vtk_library() {
  Library library{"VTK", version(), {}, nullptr};
  library.make_mesh = [](const TriangleMesh& from) -> std::unique_ptr<LibraryMesh> {
    return std::make_unique<KeptMesh>(from);
  };
  Call faces{"vtkPolyDataNormals"};
  faces.compute = [](LibraryMesh& kept) { run_again(kept, *static_cast<KeptMesh&>(kept).of_faces); };
  faces.normal = [](const LibraryMesh& kept, std::size_t f) {
    return tuple(static_cast<const KeptMesh&>(kept).of_faces->GetOutput()->GetCellData()->GetNormals(), f);
  };
  Call vertices{"vtkPolyDataNormals", true, Rule::kUniform};
  vertices.compute = [](LibraryMesh& kept) { run_again(kept, *static_cast<KeptMesh&>(kept).of_vertices); };
  vertices.normal = [](const LibraryMesh& kept, std::size_t v) {
    return tuple(static_cast<const KeptMesh&>(kept).of_vertices->GetOutput()->GetPointData()->GetNormals(), v);
  };
  Call by_area{"vtkTriangleMeshPointNormals", true, Rule::kArea};
  by_area.compute = [](LibraryMesh& kept) { run_again(kept, *static_cast<KeptMesh&>(kept).by_area); };
  by_area.normal = [](const LibraryMesh& kept, std::size_t v) {
    return tuple(static_cast<const KeptMesh&>(kept).by_area->GetOutput()->GetPointData()->GetNormals(), v);
  };
  library.calls = {faces, vertices, by_area};
  return library;
}

}  // namespace chronormal::peers
