#include <cstdio>
#include <vector>

#include "chronormal/chronormal.h"

int main() {
  using namespace chronormal;

  // What you have: the triangles of a mesh, and where its vertices are at two moments. Here a square folds along its
  // diagonal: vertex 3 goes from the plane up. In between, every vertex is on a straight line.
  const Topology topology = Topology::triangles(4, {0, 1, 2, 1, 3, 2}).value();
  const std::vector<float> start = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, end = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.5, 0.5, 1};

  // Once: the normals of all vertices, exact for every t between. Options choose faces, corners with hard edges,
  // another weighting. What can be wrong with the data is told here, with its place.
  Result<ElementCurves> made =
      ElementCurves::make(topology, VectorView<const float>::packed(start), VectorView<const float>::packed(end));
  if (!made) {
    std::fprintf(stderr, "%s\n", made.error().text().c_str());
    return 1;
  }
  ElementCurves& curves = made.value();

  // As often as you like: unit normals into your own memory, three floats for each vertex.
  std::vector<float> normals(3 * curves.size());
  for (const double t : {0.0, 0.5, 1.0}) {
    curves.unit_normals(t, VectorView<float>::packed(normals));
    std::printf("t = %.1f   normal of vertex 0 = (%.3f, %.3f, %.3f), of vertex 1 = (%.3f, %.3f, %.3f)\n", t, normals[0],
                normals[1], normals[2], normals[3], normals[4], normals[5]);
  }

  // Many keyframes with times in seconds are a Motion, which open_input() reads from files, too. For a time or two
  // there is one call, which finds the segment and keeps nothing: here the normals of faces.
  Motion motion;
  motion.topology = topology;
  motion.keyframes = {{start, 0.0, "start"}, {end, 2.0, "end"}, {start, 3.0, "start again"}};
  motion.connect_as_sequence();
  const Result<std::vector<float>> faces = unit_normals_at(motion, 2.5);
  if (!faces) {
    std::fprintf(stderr, "%s\n", faces.error().text().c_str());
    return 1;
  }
  const std::vector<float>& n = faces.value();
  std::printf("2.5 s     normal of face 1 = (%.3f, %.3f, %.3f)\n", n[3], n[4], n[5]);
}
