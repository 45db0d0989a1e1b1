#include <CGAL/Polygon_mesh_processing/compute_normal.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>

#include <stdexcept>

#include "peers/peers.h"

namespace chronormal::peers {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

std::vector<Vec3d> compute_vertex_normals(const TriangleMesh& from) {
  Mesh mesh;
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
  const auto normals = mesh.add_property_map<Mesh::Vertex_index, Kernel::Vector_3>("v:normal", CGAL::NULL_VECTOR).first;
  CGAL::Polygon_mesh_processing::compute_vertex_normals(mesh, normals);
  std::vector<Vec3d> result;
  for (const Mesh::Vertex_index v : mesh.vertices())
    result.push_back(unit(Vec3d{normals[v].x(), normals[v].y(), normals[v].z()}));
  return result;
}

}  // namespace

std::vector<Method> cgal_methods() {
  // The third number is that of a patch.
  const std::string version = CGAL_VERSION_STR;
  return {{"CGAL " + version.substr(0, version.rfind('.')), "compute_vertex_normals", compute_vertex_normals}};
}

}  // namespace chronormal::peers
