#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <stdexcept>

#include "peers/peers.h"

namespace chronormal::peers {
namespace {

using Mesh = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraitsDouble>;

Mesh make_mesh(const TriangleMesh& from) {
  Mesh mesh;
  mesh.request_face_normals();
  std::vector<Mesh::VertexHandle> vertices;
  for (std::size_t v = 0; v < from.vertex_count(); ++v) {
    const auto p = from.positions.subspan(3 * v, 3);
    vertices.push_back(mesh.add_vertex({p[0], p[1], p[2]}));
  }
  for (std::size_t f = 0; f < from.face_count(); ++f) {
    const auto c = from.corners.subspan(3 * f, 3);
    if (!mesh.add_face(vertices[c[0]], vertices[c[1]], vertices[c[2]]).is_valid())
      throw std::runtime_error("OpenMesh takes no such face");
  }
  mesh.update_face_normals();
  return mesh;
}

template <class Compute>
std::vector<Vec3d> each_vertex(const TriangleMesh& from, Compute compute) {
  const Mesh mesh = make_mesh(from);
  std::vector<Vec3d> result;
  for (const auto vertex : mesh.vertices()) {
    Mesh::Normal n;
    compute(mesh, vertex, n);
    result.push_back(unit(Vec3d{n[0], n[1], n[2]}));
  }
  return result;
}

std::vector<Vec3d> fast(const TriangleMesh& from) {
  return each_vertex(
      from, [](const Mesh& mesh, Mesh::VertexHandle v, Mesh::Normal& n) { mesh.calc_vertex_normal_fast(v, n); });
}

std::vector<Vec3d> correct(const TriangleMesh& from) {
  return each_vertex(
      from, [](const Mesh& mesh, Mesh::VertexHandle v, Mesh::Normal& n) { mesh.calc_vertex_normal_correct(v, n); });
}

std::vector<Vec3d> loop(const TriangleMesh& from) {
  return each_vertex(
      from, [](const Mesh& mesh, Mesh::VertexHandle v, Mesh::Normal& n) { mesh.calc_vertex_normal_loop(v, n); });
}

}  // namespace

std::vector<Method> openmesh_methods() {
  const std::string library =
      "OpenMesh " + std::to_string(OM_VERSION >> 16) + "." + std::to_string(OM_VERSION >> 8 & 255);
  return {{library, "calc_vertex_normal_fast", fast},
          {library, "calc_vertex_normal_correct", correct},
          {library, "calc_vertex_normal_loop", loop}};
}

}  // namespace chronormal::peers
