#include <cstdio>
#include <vector>

#include "chronormal/chronormal.h"

using namespace chronormal;

int failed(const Error& error) {
  std::fprintf(stderr, "%s\n", error.text().c_str());
  return 1;
}

int main() {
  // Take the triangles of a mesh, and the positions of its vertices at two moments. Here a square folds along its
  // diagonal: vertex 3 rises from the plane. In between, every vertex moves on a straight line.
  const Topology topology = Topology::triangles(4, {0, 1, 2, 1, 3, 2}).value();
  const std::vector<float> start = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, end = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.5, 0.5, 1};

  // Prepare the normals of all vertices once; they are exact for every t in between. Options choose faces, corners with
  // hard edges, or another weighting. Faults of the data are reported here, with their place.
  Result<MeshNormals> made = MeshNormals::make(topology);
  if (!made) return failed(made.error());
  MeshNormals& mesh = made.value();
  if (const Status status =
          mesh.set_segment(VectorView<const float>::packed(start), VectorView<const float>::packed(end));
      !status)
    return failed(status.error());

  // Write unit normals into your own memory as often as you like, three floats for each vertex.
  std::vector<float> normals(3 * mesh.size());
  for (const double t : {0.0, 0.5, 1.0}) {
    mesh.unit_normals(t, VectorView<float>::packed(normals));
    std::printf("t = %.1f   normal of vertex 0 = (%.3f, %.3f, %.3f), of vertex 1 = (%.3f, %.3f, %.3f)\n", t, normals[0],
                normals[1], normals[2], normals[3], normals[4], normals[5]);
  }

  // A Motion has many keyframes with times in seconds; open_input() also reads it from files. find_instant() finds the
  // segment in which a time lies, and the t in this segment. Here the normals are those of faces.
  Motion motion;
  motion.topology = topology;
  motion.keyframes = {{start, 0.0, "start"}, {end, 2.0, "end"}, {start, 3.0, "start again"}};
  motion.connect_as_sequence();
  const Result<Instant> instant = find_instant(motion, 2.5);
  if (!instant) return failed(instant.error());
  MeshNormals faces = MeshNormals::make(motion, {.elements = {ElementKind::kFaces}}).value();
  if (const Status status = faces.set_segment(motion.segment(instant.value().segment)); !status)
    return failed(status.error());
  std::vector<float> n(3 * faces.size());
  faces.unit_normals(instant.value().t, VectorView<float>::packed(n));
  std::printf("2.5 s     normal of face 1 = (%.3f, %.3f, %.3f)\n", n[3], n[4], n[5]);
}
