#include "paths/loops.h"

#include <algorithm>
#include <cmath>

namespace chronormal::bench {
namespace {

struct Vector {
  float x, y, z;
};

Vector load(const float* p) { return {p[0], p[1], p[2]}; }
Vector minus(Vector a, Vector b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Vector cross(Vector a, Vector b) { return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x}; }

Vector face_normal(const LoopMesh& mesh, std::size_t f) {
  const std::uint32_t* const corner = mesh.corners.data() + 3 * f;
  const Vector a = load(mesh.positions.data() + 3 * std::size_t{corner[0]});
  const Vector b = load(mesh.positions.data() + 3 * std::size_t{corner[1]});
  const Vector c = load(mesh.positions.data() + 3 * std::size_t{corner[2]});
  return cross(minus(b, a), minus(c, a));
}

void store_normalised(Vector n, float* to) {
  const float scale = 1 / std::sqrt(n.x * n.x + n.y * n.y + n.z * n.z);
  to[0] = scale * n.x;
  to[1] = scale * n.y;
  to[2] = scale * n.z;
}

}  // namespace

void interpolate(const LoopMesh& mesh, float t) {
  for (std::size_t i = 0; i < mesh.from.size(); ++i) mesh.positions[i] = (1 - t) * mesh.from[i] + t * mesh.to[i];
}

void plain_faces(const LoopMesh& mesh, float t, std::span<float> normals) {
  interpolate(mesh, t);
  for (std::size_t f = 0; f < mesh.corners.size() / 3; ++f)
    store_normalised(face_normal(mesh, f), normals.data() + 3 * f);
}

void plain_vertices(const LoopMesh& mesh, float t, std::span<float> normals) {
  interpolate(mesh, t);
  std::fill(normals.begin(), normals.end(), 0.0f);
  for (std::size_t f = 0; f < mesh.corners.size() / 3; ++f) {
    const Vector n = face_normal(mesh, f);
    for (std::size_t c = 0; c < 3; ++c) {
      float* const sum = normals.data() + 3 * std::size_t{mesh.corners[3 * f + c]};
      sum[0] += n.x;
      sum[1] += n.y;
      sum[2] += n.z;
    }
  }
  for (std::size_t v = 0; v < normals.size() / 3; ++v)
    store_normalised(load(normals.data() + 3 * v), normals.data() + 3 * v);
}

}  // namespace chronormal::bench
