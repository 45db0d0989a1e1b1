#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>
#include <memory>
#include <stdexcept>

#include "peers/peers.h"

namespace chronormal::peers {
namespace {

using Mesh = OpenMesh::TriMesh_ArrayKernelT<OpenMesh::DefaultTraits>;

void fill(Mesh& mesh, const TriangleMesh& from) {
  mesh.reserve(from.vertex_count(), from.vertex_count() + from.face_count(), from.face_count());
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
  mesh.request_face_normals();
  mesh.update_face_normals();
}

struct KeptMesh : LibraryMesh {
  Mesh mesh;
};

Mesh& mesh_of(LibraryMesh& kept) { return static_cast<KeptMesh&>(kept).mesh; }

template <class Handle>
Vec3d kept_normal(const LibraryMesh& kept, std::size_t element) {
  const Mesh::Normal n = static_cast<const KeptMesh&>(kept).mesh.normal(Handle(static_cast<int>(element)));
  return unit(Vec3d{n[0], n[1], n[2]});
}

std::string version() { return std::to_string(OM_VERSION >> 16) + "." + std::to_string(OM_VERSION >> 8 & 255); }

}  // namespace

Library openmesh_library() {
  Library library{"OpenMesh", version(), {}, nullptr};
  library.make_mesh = [](const TriangleMesh& from) -> std::unique_ptr<LibraryMesh> {
    auto kept = std::make_unique<KeptMesh>();
    fill(kept->mesh, from);
    kept->mesh.request_vertex_normals();
    return kept;
  };
  Call faces{"update_face_normals"};
  faces.compute = [](LibraryMesh& kept) { mesh_of(kept).update_face_normals(); };
  faces.normal = kept_normal<Mesh::FaceHandle>;
  Call of_given_faces{"update_vertex_normals", true, Rule::kUniform};
  of_given_faces.note = "unit normals of faces are given";
  of_given_faces.compute = [](LibraryMesh& kept) { mesh_of(kept).update_vertex_normals(); };
  of_given_faces.normal = kept_normal<Mesh::VertexHandle>;
  Call both{"update_normals", true, Rule::kUniform};
  both.note = "of faces, then of vertices";
  both.compute = [](LibraryMesh& kept) { mesh_of(kept).update_normals(); };
  both.normal = kept_normal<Mesh::VertexHandle>;
  Call by_area{"calc_vertex_normal_correct", true, Rule::kArea};
  by_area.compute = [](LibraryMesh& kept) {
    Mesh& mesh = mesh_of(kept);
    for (const auto vertex : mesh.vertices()) {
      Mesh::Normal n;
      mesh.calc_vertex_normal_correct(vertex, n);
      mesh.set_normal(vertex, n.normalize_cond());
    }
  };
  by_area.normal = kept_normal<Mesh::VertexHandle>;
  library.calls = {faces, of_given_faces, both, by_area};
  return library;
}

}  // namespace chronormal::peers
