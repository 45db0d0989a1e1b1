#include <cstdio>
#include "chronormal_core.h"

int main() {
  using namespace chronormal;
  const std::vector<float> start = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, end = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.5, 0.5, 1};
  const auto at = [](const std::vector<float>& xyz) { return VectorView<const float>::packed(xyz); };
  MeshNormals mesh = MeshNormals::make(Topology::triangles(4, {0, 1, 2, 1, 3, 2}).value()).value();
  if (!mesh.set_segment(at(start), at(end))) return 1;
  std::vector<float> n(3 * mesh.size());
  mesh.unit_normals(0.25, VectorView<float>::packed(n));
  for (std::size_t i = 0; i < n.size(); i += 3) std::printf("%.9g %.9g %.9g\n", n[i], n[i + 1], n[i + 2]);
}
