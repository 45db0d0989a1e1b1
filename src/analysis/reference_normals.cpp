#include "chronormal/analysis/reference_normals.h"

#include <cassert>

namespace chronormal {
namespace {

// Two hundred thousand rounding errors: the direction of what is kept is right to 1e-5 rad at least.
constexpr double kZeroShare = 1e-10;

Vec3d vector_area_at(const Segment& segment, std::span<const std::uint32_t> face, double t) {
  // The first corner is the origin: differences of float32 positions are exact in double, or nearly so.
  const Vec3d origin = to_double(segment.from[face[0]]);
  const auto vertex_at = [&](std::uint32_t vertex) {
    return lerp(to_double(segment.from[vertex]) - origin, to_double(segment.to[vertex]) - origin, t);
  };
  const Vec3d a = vertex_at(face[0]);
  Vec3d n;
  double products = 0;
  Vec3d e = vertex_at(face[1]) - a;
  for (std::size_t c = 2; c < face.size(); ++c) {
    const Vec3d f = vertex_at(face[c]) - a;
    n = n + cross(e, f);
    products += max_abs(e) * max_abs(f);
    e = f;
  }
  return max_abs(n) > kZeroShare * products ? n : Vec3d{};
}

}  // namespace

void reference_normals(const Segment& segment, IndexRange faces, double t, std::span<Vec3d> result) noexcept {
  assert(result.size() == faces.count && faces.end() <= segment.topology->face_count());
  for (std::size_t i = 0; i < faces.count; ++i)
    result[i] = vector_area_at(segment, segment.topology->face(faces.first + i), t);
}

}  // namespace chronormal
