/// Unit normals in the most straightforward way: a loop over plain arrays, and the same loop with Eigen.
///
/// Both loops first interpolate all positions, then add up face normals by area.
#ifndef BENCH_PATHS_LOOPS_H_
#define BENCH_PATHS_LOOPS_H_

#include <cstdint>
#include <span>
#include <string>

namespace chronormal::bench {

/// Arrays (V, 3) of positions at both ends, (F, 3) of corners, and (V, 3) of scratch memory.
struct LoopMesh {
  std::span<const float> from, to;
  std::span<const std::uint32_t> corners;
  std::span<float> positions;
};

/// Sets positions = (1 - t) from + t to, which every baseline must do first.
void interpolate(const LoopMesh& mesh, float t);

void plain_faces(const LoopMesh& mesh, float t, std::span<float> normals);     ///< (F, 3)
void plain_vertices(const LoopMesh& mesh, float t, std::span<float> normals);  ///< (V, 3)

#ifdef CHRONORMAL_HAVE_EIGEN
void eigen_faces(const LoopMesh& mesh, float t, std::span<float> normals);
void eigen_vertices(const LoopMesh& mesh, float t, std::span<float> normals);
[[nodiscard]] std::string eigen_version();
#endif

}  // namespace chronormal::bench

#endif  // BENCH_PATHS_LOOPS_H_
