#include "chronormal/analysis/quality.h"

#include <cassert>

namespace chronormal {
namespace {

// Some 500,000 rounding errors: the direction of what is kept is right to 1e-5 rad at least.
constexpr double kZeroShare = 1e-10;

// A vector between two others, and the size of what it was made of: its error is a rounding of that size.
struct Interpolated {
  Vec3d vector;
  double size;

  friend Interpolated operator-(const Interpolated& a, const Interpolated& b) {
    return {a.vector - b.vector, a.size + b.size};
  }
};

Vec3d vector_area_at(const Segment& segment, std::span<const std::uint32_t> face, double t) {
  // The first corner is the origin: differences of float32 positions are exact in double, or nearly so.
  const Vec3d origin = to_double(segment.from[face[0]]);
  const auto vertex_at = [&](std::uint32_t vertex) {
    const Vec3d from = to_double(segment.from[vertex]) - origin, to = to_double(segment.to[vertex]) - origin;
    return Interpolated{lerp(from, to, t), (1 - t) * max_abs(from) + t * max_abs(to)};
  };
  const Interpolated a = vertex_at(face[0]);
  Vec3d n;
  double products = 0;
  Interpolated e = vertex_at(face[1]) - a;
  for (std::size_t c = 2; c < face.size(); ++c) {
    const Interpolated f = vertex_at(face[c]) - a;
    n = n + cross(e.vector, f.vector);
    products += e.size * max_abs(f.vector) + f.size * max_abs(e.vector);
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

Vec3d reference_normal(const Segment& segment, std::span<const std::uint32_t> faces, double t) noexcept {
  Vec3d sum;
  double size = 0;
  for (const std::uint32_t face : faces) {
    const Vec3d n = vector_area_at(segment, segment.topology->face(face), t);
    sum = sum + n;
    size += max_abs(n);
  }
  return max_abs(sum) > kZeroShare * size ? sum : Vec3d{};
}

}  // namespace chronormal
