#include <cstdio>
#include <vector>

#include "chronormal/chronormal.h"

// Tests the package with a triangle that turns by 90 degrees about the x axis. Half way, its normal is (0, -1, 1),
// scaled to length 1.
int main() {
  using namespace chronormal;
  const Topology topology = Topology::triangles(3, {0, 1, 2}).value();
  const std::vector<float> start = {0, 0, 0, 1, 0, 0, 0, 1, 0}, end = {0, 0, 0, 1, 0, 0, 0, 0, 1};
  Result<MeshNormals> mesh = MeshNormals::make(topology);
  if (!mesh) return 1;
  if (!mesh.value().set_segment(VectorView<const float>::packed(start), VectorView<const float>::packed(end))) return 1;
  std::vector<float> normals(3 * mesh.value().size());
  mesh.value().unit_normals(0.5, VectorView<float>::packed(normals));
  std::printf("%.6f %.6f %.6f\n", normals[0], normals[1], normals[2]);
  return normals[1] < -0.7071F && normals[1] > -0.7072F && normals[2] > 0.7071F ? 0 : 1;
}
