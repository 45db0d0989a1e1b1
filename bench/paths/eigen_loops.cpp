#ifdef CHRONORMAL_HAVE_EIGEN

#include <Eigen/Core>
#include <Eigen/Geometry>

#include "paths/loops.h"

namespace chronormal::bench {
namespace {

using Positions = Eigen::Map<Eigen::Matrix3Xf>;
using ConstPositions = Eigen::Map<const Eigen::Matrix3Xf>;
using Corners = Eigen::Map<const Eigen::Matrix<std::uint32_t, 3, Eigen::Dynamic>>;

Positions mapped(std::span<float> values) { return {values.data(), 3, static_cast<Eigen::Index>(values.size() / 3)}; }
ConstPositions mapped(std::span<const float> values) {
  return {values.data(), 3, static_cast<Eigen::Index>(values.size() / 3)};
}

Positions interpolated(const LoopMesh& mesh, float t) {
  Positions positions = mapped(mesh.positions);
  positions = (1 - t) * mapped(mesh.from) + t * mapped(mesh.to);
  return positions;
}

Corners corners_of(const LoopMesh& mesh) {
  return {mesh.corners.data(), 3, static_cast<Eigen::Index>(mesh.corners.size() / 3)};
}

}  // namespace

void eigen_faces(const LoopMesh& mesh, float t, std::span<float> normals) {
  const Positions p = interpolated(mesh, t);
  const Corners corners = corners_of(mesh);
  Positions result = mapped(normals);
  for (Eigen::Index f = 0; f < corners.cols(); ++f) {
    const auto a = p.col(corners(0, f)), b = p.col(corners(1, f)), c = p.col(corners(2, f));
    result.col(f) = (b - a).cross(c - a).normalized();
  }
}

void eigen_vertices(const LoopMesh& mesh, float t, std::span<float> normals) {
  const Positions p = interpolated(mesh, t);
  const Corners corners = corners_of(mesh);
  Positions result = mapped(normals);
  result.setZero();
  for (Eigen::Index f = 0; f < corners.cols(); ++f) {
    const auto a = p.col(corners(0, f)), b = p.col(corners(1, f)), c = p.col(corners(2, f));
    const Eigen::Vector3f n = (b - a).cross(c - a);
    for (Eigen::Index corner = 0; corner < 3; ++corner) result.col(corners(corner, f)) += n;
  }
  result.colwise().normalize();
}

std::string eigen_version() {
  return std::to_string(EIGEN_WORLD_VERSION) + "." + std::to_string(EIGEN_MAJOR_VERSION) + "." +
         std::to_string(EIGEN_MINOR_VERSION);
}

}  // namespace chronormal::bench

#endif  // CHRONORMAL_HAVE_EIGEN
