// Times unit normals of vertices, weighted by area if the library supports that: by plain loops, by libraries, and by
// chronormal.

#include <memory>
#include <optional>

#include "groups/groups.h"
#include "paths/rivals.h"

namespace chronormal::bench {

void run_vertices(Suite& suite, const Size& size) {
  const std::string group = "vertices";
  CaseList list(suite, group, size);
  suite.say(group + ", " + size.name + ", " + size.order() + ": mesh");
  const Mesh mesh(Elements::kVertices, size.elements, size.shuffled);
  const Oracle oracle(mesh.segment(), Elements::kVertices);
  const std::size_t faces = mesh.topology().face_count(), vertices = mesh.topology().vertex_count();
  const double limit = float_limit(mesh.count(Elements::kVertices));
  add_loops(list, mesh, Elements::kVertices, limit);
  add_libraries(list, mesh, Elements::kVertices);
  const NormalGroups groups = NormalGroups::of_vertices(mesh.topology(), separate_points(vertices));
  add_ours(list, mesh.segment(), &groups, size.shuffled ? 0 : 24 * vertices + 12 * faces, limit);
  suite.run(group, size, vertices, oracle, list.take());
}

}  // namespace chronormal::bench
