// Times unit normals of faces by plain loops, by libraries, and by chronormal.

#include <cmath>
#include <memory>

#include "groups/groups.h"
#include "paths/rivals.h"

namespace chronormal::bench {

void run_faces(Suite& suite, const Size& size) {
  const std::string group = "faces";
  CaseList list(suite, group, size);
  suite.say(group + ", " + size.name + ", " + size.order() + ": mesh");
  const Mesh mesh(Elements::kFaces, size.elements, size.shuffled);
  const Oracle oracle(mesh.segment(), Elements::kFaces);
  const std::size_t faces = mesh.topology().face_count(), vertices = mesh.topology().vertex_count();
  const double limit = float_limit(mesh.count(Elements::kFaces));
  add_loops(list, mesh, Elements::kFaces, limit);
  add_libraries(list, mesh, Elements::kFaces);
  // A recomputation reads the positions at both ends and the corners once, which is 24 bytes for each vertex and 12 for
  // each face. In random order, the same cache lines are loaded again and again, so the number of bytes is unknown.
  add_ours(list, mesh.segment(), nullptr, size.shuffled ? 0 : 24 * vertices + 12 * faces, limit);
  suite.run(group, size, faces, oracle, list.take());
}

}  // namespace chronormal::bench
