// Section 5: meshes that move as a whole.

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "weightings/sections.h"

namespace chronormal::weightings {
namespace {

constexpr std::size_t kSamples = 20;  // steps of time

struct Case {
  const char* name;
  NodeTransform from, to;
  double shear = 0;  // x += shear times y, before anything else
};

// A rotation about the axis (1, 2, 2) / 3.
std::array<double, 4> rotation(double degrees) {
  const double half = degrees / kDegreesPerRadian / 2, s = std::sin(half) / 3;
  return {s, 2 * s, 2 * s, std::cos(half)};
}

const std::vector<Case>& cases() {
  static const std::vector<Case> all = {
      {"rigid: turned by 140 degrees, moved",
       {{0, 0, 0}, rotation(0), {1, 1, 1}},
       {{5, -2, 1}, rotation(140), {1, 1, 1}}},
      {"and scaled to 3", {{0, 0, 0}, rotation(0), {1, 1, 1}}, {{5, -2, 1}, rotation(140), {3, 3, 3}}},
      {"and scaled to (3, 1, 0.5)", {{0, 0, 0}, rotation(0), {1, 1, 1}}, {{5, -2, 1}, rotation(140), {3, 1, 0.5}}},
      {"and sheared by 0.7", {{0, 0, 0}, rotation(0), {1, 1, 1}}, {{5, -2, 1}, rotation(140), {3, 1, 0.5}}, 0.7},
      {"mirrored: scaled from (-1, 1, 1) to (-3, 1, 0.5)",
       {{0, 0, 0}, rotation(0), {-1, 1, 1}},
       {{5, -2, 1}, rotation(140), {-3, 1, 0.5}}},
      {"flattened: scaled to (1, 1, 0.001)",
       {{0, 0, 0}, rotation(0), {1, 1, 1}},
       {{5, -2, 1}, rotation(140), {1, 1, 0.001}}},
  };
  return all;
}

using Normals = std::vector<Vec3d>;

// Sums over the faces around each vertex, by area or by angle, from positions in double.
Normals recomputed(const Topology& topology, const std::vector<Vec3d>& p, bool by_angle, bool turned_round) {
  Normals result(p.size());
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3d e = p[face[(c + 1) % 3]] - p[face[c]], g = p[face[(c + 2) % 3]] - p[face[c]];
      Vec3d n = cross(e, g);
      if (by_angle) n = angle_between(e, g) * unit(n);
      result[face[c]] = result[face[c]] + (turned_round ? -1.0 : 1.0) * n;
    }
  }
  return result;
}

struct Worst {
  double matrix = 0, linear_part = 0, by_angle = 0;  // degrees
  bool mirrored = false;
};

Worst measure(const Case& one, const Topology& topology, const std::vector<Vec3d>& rest) {
  Worst worst;
  const Normals by_area = recomputed(topology, rest, false, false), by_angle = recomputed(topology, rest, true, false);
  for (std::size_t i = 0; i <= kSamples; ++i) {
    const AffineTransform sheared{{Vec3d{1, 0, 0}, Vec3d{one.shear, 1, 0}, Vec3d{0, 0, 1}}, {}};
    const AffineTransform transform =
        composed(affine_transform(interpolated(one.from, one.to, static_cast<double>(i) / kSamples)), sheared);
    const NormalMatrix matrix = normal_matrix(transform);
    worst.mirrored = worst.mirrored || matrix.mirrored;
    std::vector<Vec3d> moved;
    for (const Vec3d& p : rest) moved.push_back(transform(p));
    // A mirror turns the order of corners round; the outer side is what counts.
    const Normals area_now = recomputed(topology, moved, false, matrix.mirrored);
    const Normals angle_now = recomputed(topology, moved, true, matrix.mirrored);
    for (std::size_t v = 0; v < rest.size(); ++v) {
      const auto degrees = [](const Vec3d& a, const Vec3d& b) { return angle_between(a, b) * kDegreesPerRadian; };
      worst.matrix = std::max(worst.matrix, degrees(matrix(by_area[v]), area_now[v]));
      worst.linear_part = std::max(worst.linear_part, degrees(transform(by_area[v]) - transform.offset, area_now[v]));
      worst.by_angle = std::max(worst.by_angle, degrees(matrix(by_angle[v]), angle_now[v]));
    }
  }
  return worst;
}

}  // namespace

void measure_transforms(Page& page) {
  const Motion motion = posed(make_builtin_morph("twist").value(), 0, 0.5);
  std::vector<Vec3d> rest;
  for (std::size_t v = 0; v < motion.topology.vertex_count(); ++v) rest.push_back(to_double(motion.segment(0).from[v]));
  std::vector<Cells> rows;
  for (const Case& one : cases()) {
    const Worst worst = measure(one, motion.topology, rest);
    rows.push_back({one.name, degrees(worst.matrix), degrees(worst.linear_part), degrees(worst.by_angle)});
    require(worst.matrix < 1e-9, "the inverse transpose is exact for area weights");
    const bool similarity = one.to.scale.x == one.to.scale.y && one.to.scale.y == one.to.scale.z && one.shear == 0;
    require(similarity == (worst.by_angle < 1e-9) && similarity == (worst.linear_part < 1e-9),
            "other weights, and the linear part, are right for similarities only");
  }
  page.table("transforms", {"motion", "inverse transpose", "linear part", "by angle"}, rows);
  page.set("transform_samples", grouped(kSamples + 1));
}

}  // namespace chronormal::weightings
