/// Computes unit normals in the most straightforward way: by a loop over plain arrays, and by the same loop with Eigen.
///
/// Both loops first interpolate all positions, and then add up face normals by area.
#ifndef BENCH_PATHS_LOOPS_H_
#define BENCH_PATHS_LOOPS_H_

#include <cstdint>
#include <span>
#include <string>

namespace chronormal::bench {

/// The arrays of a mesh: positions at both ends (V, 3), corners (F, 3), and scratch memory for positions (V, 3).
struct LoopMesh {
  std::span<const float> from, to;
  std::span<const std::uint32_t> corners;
  std::span<float> positions;
};

/// Sets positions = (1 - t) from + t to. Every baseline must do this first.
void interpolate(const LoopMesh& mesh, float t);

void plain_faces(const LoopMesh& mesh, float t, std::span<float> normals);     ///< unit normals, (F, 3)
void plain_vertices(const LoopMesh& mesh, float t, std::span<float> normals);  ///< unit normals, (V, 3)

#ifdef CHRONORMAL_HAVE_EIGEN
void eigen_faces(const LoopMesh& mesh, float t, std::span<float> normals);
void eigen_vertices(const LoopMesh& mesh, float t, std::span<float> normals);
[[nodiscard]] std::string eigen_version();
#endif

}  // namespace chronormal::bench

#endif  // BENCH_PATHS_LOOPS_H_
