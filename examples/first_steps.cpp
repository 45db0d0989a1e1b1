#include <cstdio>
#include <vector>

#include "chronormal/chronormal.h"

int main() {
  using namespace chronormal;

  // A triangle that turns from facing up (+z) to facing sideways (+x), each vertex on a straight line.
  Motion motion;
  motion.topology = Topology::triangles(3, {0, 1, 2}).value();
  motion.keyframes = {{{0, 0, 0, 1, 0, 0, 0, 1, 0}, 0.0, "start"}, {{0, 0, 0, 0, 1, 0, 0, 0, 1}, 1.0, "end"}};
  motion.connect_as_sequence();
  if (const Status status = validate(motion); !status) {
    std::fprintf(stderr, "%s\n", status.error().text().c_str());
    return 1;
  }

  // Once per segment: three control normals per face, exact for every t between.
  const NormalCurves curves = NormalCurves::of_faces(motion.segment(0));

  // As often as you like: unit normals into your own memory, here packed as (faces, 3).
  std::vector<float> normals(3 * curves.size());
  for (const double t : {0.0, 0.5, 1.0}) {
    curves.unit_normals(t, VectorView<float>::packed(normals.data(), curves.size()));
    std::printf("t = %.1f   normal = (%.3f, %.3f, %.3f)\n", t, normals[0], normals[1], normals[2]);
  }

  // The easy way, for a time or two in seconds: one call, which finds the segment and keeps nothing.
  const std::vector<float> halfway = unit_normals_at(motion, 0.5).value();
  std::printf("0.5 s     normal = (%.3f, %.3f, %.3f)\n", halfway[0], halfway[1], halfway[2]);
}
