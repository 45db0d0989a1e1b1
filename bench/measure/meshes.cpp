// Makes the torus meshes on which the benchmarks run, in the order of the grid and in random order.
#include "measure/meshes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

namespace chronormal::bench {
namespace {

constexpr double kTube = 0.4;  // radius of the tube, in multiples of the radius of the ring

struct Angle {
  double angle, cosine, sine;
};

std::vector<Angle> around(std::size_t count) {
  std::vector<Angle> angles;
  for (std::size_t i = 0; i < count; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(count);
    angles.push_back({angle, std::cos(angle), std::sin(angle)});
  }
  return angles;
}

// Returns the numbers below `count`, in random order if `shuffled` is true. The code is our own, since shuffles of the
// standard library differ between systems.
std::vector<std::uint32_t> shuffled_order(std::size_t count, bool shuffled, std::uint64_t seed) {
  std::vector<std::uint32_t> order(count);
  std::iota(order.begin(), order.end(), 0u);
  if (!shuffled) return order;
  std::mt19937_64 random(seed);
  for (std::size_t i = count; i > 1; --i) std::swap(order[i - 1], order[random() % i]);
  return order;
}

}  // namespace

Mesh::Mesh(Elements elements, std::size_t element_count, bool shuffled) {
  // Rows and columns are chosen so that quads are about as long as wide.
  const double vertices = static_cast<double>(element_count) / (elements == Elements::kFaces ? 2 : 1);
  const std::size_t rows = std::max<std::size_t>(3, static_cast<std::size_t>(std::lround(std::sqrt(vertices * kTube))));
  const std::size_t columns =
      std::max<std::size_t>(3, static_cast<std::size_t>(std::lround(vertices / static_cast<double>(rows))));
  const std::size_t vertex_count = rows * columns;

  const std::vector<std::uint32_t> place = shuffled_order(vertex_count, shuffled, 1);
  from_ = AlignedArray<float>(3 * vertex_count);
  to_ = AlignedArray<float>(3 * vertex_count);
  const std::vector<Angle> ring = around(columns), tube = around(rows);
  const double turn_cosine = 0.5, turn_sine = std::sqrt(0.75);
  for (std::size_t column = 0; column < columns; ++column) {
    const Angle& u = ring[column];
    const double ripple = 0.1 * std::sin(7 * u.angle);
    const double twist_cosine = std::cos(u.sine), twist_sine = std::sin(u.sine);
    for (std::size_t row = 0; row < rows; ++row) {
      const Angle& v = tube[row];
      const double tube_radius = kTube * (1 + ripple * v.cosine);
      const auto point = [&](double cosine, double sine) {
        const double out = 1 + tube_radius * cosine;
        return Vec3d{out * u.cosine, out * u.sine, tube_radius * sine};
      };
      const Vec3d a = point(v.cosine, v.sine);
      const Vec3d b =
          point(v.cosine * twist_cosine - v.sine * twist_sine, v.sine * twist_cosine + v.cosine * twist_sine);
      const Vec3d stretched{1.3 * b.x, 0.8 * b.y, 1.2 * b.z};
      const Vec3f p = to_float(a), q = to_float({stretched.x, turn_cosine * stretched.y - turn_sine * stretched.z,
                                                 turn_sine * stretched.y + turn_cosine * stretched.z});
      const std::size_t at = 3 * std::size_t{place[row * columns + column]};
      from_[at] = p.x, from_[at + 1] = p.y, from_[at + 2] = p.z;
      to_[at] = q.x, to_[at + 1] = q.y, to_[at + 2] = q.z;
    }
  }

  const std::vector<std::uint32_t> face_place = shuffled_order(2 * vertex_count, shuffled, 2);
  std::vector<std::uint32_t> corners(6 * vertex_count);
  const auto set_face = [&](std::size_t face, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
    const std::size_t at = 3 * std::size_t{face_place[face]};
    corners[at] = a, corners[at + 1] = b, corners[at + 2] = c;
  };
  for (std::size_t row = 0; row < rows; ++row) {
    const std::size_t here = row * columns, above = (row + 1) % rows * columns;
    for (std::size_t column = 0; column < columns; ++column) {
      const std::size_t next = (column + 1) % columns;
      const std::uint32_t a = place[here + column], b = place[here + next], c = place[above + next],
                          d = place[above + column];
      set_face(2 * (here + column), a, b, c);
      set_face(2 * (here + column) + 1, a, c, d);
    }
  }
  topology_ = Topology::triangles(vertex_count, std::move(corners)).value();
}

Mesh::Mesh(Topology topology, std::span<const float> from, std::span<const float> to)
    : topology_(std::move(topology)), from_(from.size()), to_(to.size()) {
  std::copy(from.begin(), from.end(), from_.data());
  std::copy(to.begin(), to.end(), to_.data());
}

Segment Mesh::segment() const noexcept {
  Segment segment;
  segment.topology = &topology_;
  segment.from = VectorView<const float>::packed(from_.data(), from_.size() / 3);
  segment.to = VectorView<const float>::packed(to_.data(), to_.size() / 3);
  return segment;
}

}  // namespace chronormal::bench
