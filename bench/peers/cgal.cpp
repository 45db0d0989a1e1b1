#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include <memory>
#include <stdexcept>

#include "peers/peers.h"

namespace chronormal::peers {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

Mesh make_mesh(const TriangleMesh& from) {
  Mesh mesh;
  const auto vertices = static_cast<Mesh::size_type>(from.vertex_count());
  const auto faces = static_cast<Mesh::size_type>(from.face_count());
  mesh.reserve(vertices, vertices + faces, faces);
  for (std::size_t v = 0; v < from.vertex_count(); ++v) {
    const auto p = from.positions.subspan(3 * v, 3);
    mesh.add_vertex({p[0], p[1], p[2]});
  }
  for (std::size_t f = 0; f < from.face_count(); ++f) {
    const auto c = from.corners.subspan(3 * f, 3);
    if (mesh.add_face(Mesh::Vertex_index(c[0]), Mesh::Vertex_index(c[1]), Mesh::Vertex_index(c[2])) ==
        Mesh::null_face())
      throw std::runtime_error("CGAL takes no such face");
  }
  return mesh;
}

template <class Index>
using Normals = Mesh::Property_map<Index, Kernel::Vector_3>;
using VertexNormals = Normals<Mesh::Vertex_index>;
using FaceNormals = Normals<Mesh::Face_index>;

Vec3d unit_of(const Kernel::Vector_3& n) { return unit(Vec3d{n.x(), n.y(), n.z()}); }

struct KeptMesh : LibraryMesh {
  explicit KeptMesh(const TriangleMesh& from) : mesh(make_mesh(from)) {}

  Mesh mesh;
  VertexNormals of_vertices;
  FaceNormals of_faces;
};

std::string version() {
  // The third number of the version only counts patches, so it is not printed.
  const std::string all = CGAL_VERSION_STR;
  return all.substr(0, all.rfind('.'));
}

}  // namespace

Library cgal_library() {
  Library library{"CGAL", version(), {}, nullptr};
  library.make_mesh = [](const TriangleMesh& from) -> std::unique_ptr<LibraryMesh> {
    return std::make_unique<KeptMesh>(from);
  };
  Call faces{"compute_face_normals"};
  faces.compute = [](LibraryMesh& kept) {
    auto& [mesh, of_vertices, of_faces] = static_cast<KeptMesh&>(kept);
    if (!of_faces) of_faces = mesh.add_property_map<Mesh::Face_index, Kernel::Vector_3>("f:normal").first;
    CGAL::Polygon_mesh_processing::compute_face_normals(mesh, of_faces);
  };
  faces.normal = [](const LibraryMesh& kept, std::size_t f) {
    return unit_of(static_cast<const KeptMesh&>(kept).of_faces[Mesh::Face_index(static_cast<Mesh::size_type>(f))]);
  };
  Call vertices{"compute_vertex_normals", true, Rule::kOther};
  vertices.note = "another normal than a sum";
  vertices.slow_in_random_order = true;
  vertices.compute = [](LibraryMesh& kept) {
    auto& [mesh, of_vertices, of_faces] = static_cast<KeptMesh&>(kept);
    if (!of_vertices) of_vertices = mesh.add_property_map<Mesh::Vertex_index, Kernel::Vector_3>("v:normal").first;
    CGAL::Polygon_mesh_processing::compute_vertex_normals(mesh, of_vertices);
  };
  vertices.normal = [](const LibraryMesh& kept, std::size_t v) {
    return unit_of(static_cast<const KeptMesh&>(kept).of_vertices[Mesh::Vertex_index(static_cast<Mesh::size_type>(v))]);
  };
  library.calls = {faces, vertices};
  return library;
}

}  // namespace chronormal::peers
