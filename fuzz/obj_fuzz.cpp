// Fuzz target of the OBJ reader: for any bytes, the result is an error with a place, or a valid mesh that is no larger
// than the bytes can describe. If the shading is read too, it must belong to the same mesh.
#include "io/mesh/obj.h"
#include "mesh_invariants.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string_view bytes(reinterpret_cast<const char*>(data), size);
  const auto mesh = chronormal::read_obj(bytes, "fuzz.obj");
  chronormal::fuzz::check_mesh_invariants(mesh, size);
  const auto shading = chronormal::read_obj_shading(bytes, "fuzz.obj");
  if (!shading) {
    chronormal::fuzz::require(!shading.error().place.empty(), "an error has a place");
    return 0;
  }
  const chronormal::MeshFrame& frame = shading.value();
  const std::size_t faces = frame.topology.face_count(), corners = frame.topology.corner_count();
  chronormal::fuzz::require(
      mesh.ok() && frame.topology == mesh.value().topology && frame.positions == mesh.value().positions,
      "the shading is that of the mesh");
  chronormal::fuzz::require(frame.group_of_face.empty() || frame.group_of_face.size() == faces,
                            "each face has a group");
  chronormal::fuzz::require(frame.normal_of_corner.empty() || frame.normal_of_corner.size() == 3 * corners,
                            "each corner has a normal");
  return 0;
}
