/// A morphing mesh with normals, which gltf_builder.h can write as a glTF file. The mesh is also an oracle: it computes
/// the rendered and the true normals in long double, and shares no code with src/.
#ifndef CHRONORMAL_TESTS_SUPPORT_SHADED_MESH_H_
#define CHRONORMAL_TESTS_SUPPORT_SHADED_MESH_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/fixtures.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/long_vectors.h"

namespace chronormal::test {

inline Vector plus(const Vector& a, const Vector& b, Real s = 1) {
  return {a[0] + s * b[0], a[1] + s * b[1], a[2] + s * b[2]};
}
inline Vector unit_of(const Vector& a) {
  const Real l = length_of(a);
  return {a[0] / l, a[1] / l, a[2] / l};
}
inline Vector vector_at(const std::vector<float>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

/// Turns v by the smallest rotation from the direction `from` to the direction `to`, both of length 1, by Rodrigues'
/// formula.
inline Vector rotated(const Vector& from, const Vector& to, const Vector& v) {
  const Vector axis = crossed(from, to);
  if (length_of(axis) == 0) return v;
  const Vector k = unit_of(axis);
  const Real angle = std::atan2(length_of(axis), dotted(from, to));
  Vector result = plus({0, 0, 0}, v, std::cos(angle));
  result = plus(result, crossed(k, v), std::sin(angle));
  return plus(result, k, dotted(k, v) * (1 - std::cos(angle)));
}

struct ShadedMesh {
  struct Target {
    std::vector<float> positions, normals, tangents;  ///< deltas; empty if the target has none
  };
  std::vector<std::uint32_t> corners;
  std::vector<float> positions, normals, tangents;
  std::vector<Target> targets;

  [[nodiscard]] std::size_t vertices() const { return positions.size() / 3; }

  /// Returns a glTF file in which node 0 has mesh 0, whose only primitive is this mesh.
  [[nodiscard]] GltfBuilder file() const {
    GltfBuilder builder;
    builder.add_node(builder.add_mesh(primitive(builder)));
    return builder;
  }
  [[nodiscard]] GltfBuilder::Json primitive(GltfBuilder& builder) const {
    std::vector<GltfBuilder::Json> list;
    for (const Target& target : targets) {
      GltfBuilder::Json item = GltfBuilder::Json::object();
      if (!target.positions.empty()) item["POSITION"] = builder.add_positions(target.positions);
      if (!target.normals.empty()) item["NORMAL"] = builder.add_positions(target.normals);
      if (!target.tangents.empty()) item["TANGENT"] = builder.add_positions(target.tangents);
      list.push_back(item);
    }
    const std::size_t base = builder.add_positions(positions), indices = builder.add_indices(corners);
    GltfBuilder::Json result = GltfBuilder::primitive(base, indices, list);
    if (!normals.empty()) result["attributes"]["NORMAL"] = builder.add_positions(normals);
    if (!tangents.empty()) result["attributes"]["TANGENT"] = builder.add_accessor("VEC4", tangents);
    return result;
  }

  /// Tells whether two vertices share a normal: they must have the same position, the same stored normal, and the same
  /// deltas of positions.
  [[nodiscard]] bool same_element(std::size_t a, std::size_t b) const {
    const auto same = [&](const std::vector<float>& v) {
      return v.empty() || (v[3 * a] == v[3 * b] && v[3 * a + 1] == v[3 * b + 1] && v[3 * a + 2] == v[3 * b + 2]);
    };
    bool result = same(positions) && same(normals);
    for (const Target& target : targets) result = result && same(target.positions);
    return result;
  }

  [[nodiscard]] Vector position(std::size_t v, const std::vector<double>& weights) const {
    Vector p = vector_at(positions, v);
    for (std::size_t k = 0; k < targets.size(); ++k)
      if (!targets[k].positions.empty()) p = plus(p, vector_at(targets[k].positions, v), weights[k]);
    return p;
  }

  /// Returns the sum of the cross products of all faces around vertex v, and around the vertices that share its normal,
  /// for these weights.
  [[nodiscard]] Vector normal(std::size_t v, const std::vector<double>& weights) const {
    Vector sum = {0, 0, 0};
    for (std::size_t c = 0; c < corners.size(); ++c) {
      if (!same_element(corners[c], v)) continue;
      const std::size_t f = c - c % 3;
      const Vector p = position(corners[f], weights);
      sum = plus(
          sum, crossed(plus(position(corners[f + 1], weights), p, -1), plus(position(corners[f + 2], weights), p, -1)));
    }
    return sum;
  }

  [[nodiscard]] Vector shown(std::size_t v, const std::vector<double>& weights) const {
    Vector n = vector_at(normals, v);
    for (std::size_t k = 0; k < targets.size(); ++k)
      if (!targets[k].normals.empty()) n = plus(n, vector_at(targets[k].normals, v), weights[k]);
    return n;
  }

  /// Returns the angle, in degrees, between the normal that a viewer renders at vertex v and the true normal.
  [[nodiscard]] Real error(std::size_t v, const std::vector<double>& weights) const {
    const Vector base = unit_of(normal(v, std::vector<double>(weights.size())));
    const Vector right = rotated(base, unit_of(vector_at(normals, v)), unit_of(normal(v, weights)));
    return degrees_between(shown(v, weights), right);
  }
};

/// Makes two triangles: 0 1 2 in the plane z = 0, and 2 1 3 beside it. A target folds the second triangle up by 90
/// degrees about the edge from 1 to 2. Both triangles are halves of squares, and all base normals are (0, 0, 1).
[[nodiscard]] inline ShadedMesh hinge() {
  ShadedMesh mesh;
  mesh.corners = {0, 1, 2, 2, 1, 3};
  mesh.positions = {-2, 0, 0, 0, -1, 0, 0, 1, 0, 2, 0, 0};
  mesh.normals = {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1};
  mesh.targets = {{{0, 0, 0, 0, 0, 0, 0, 0, 0, -2, 0, 2}, {}, {}}};
  return mesh;
}

/// Makes a bumpy sheet of n x n vertices, whose base normals are tilted by up to `tilt` radians from the normals of the
/// surface. The targets have random deltas of positions and normals.
[[nodiscard]] inline ShadedMesh random_sheet(std::uint64_t seed, std::size_t n, std::size_t target_count, double tilt) {
  fixtures::Random random(seed);
  ShadedMesh mesh;
  const auto push = [](std::vector<float>& values, double x, double y, double z) {
    for (const double c : {x, y, z}) values.push_back(static_cast<float>(c));
  };
  for (std::size_t j = 0; j < n; ++j)
    for (std::size_t i = 0; i < n; ++i)
      push(mesh.positions, static_cast<double>(i), static_cast<double>(j), random.uniform(-0.3, 0.3));
  for (std::size_t j = 0; j + 1 < n; ++j) {
    for (std::size_t i = 0; i + 1 < n; ++i) {
      const auto a = static_cast<std::uint32_t>(j * n + i), b = a + static_cast<std::uint32_t>(n);
      for (const std::uint32_t c : {a, a + 1, b + 1, a, b + 1, b}) mesh.corners.push_back(c);
    }
  }
  for (std::size_t k = 0; k < target_count; ++k) {
    ShadedMesh::Target& target = mesh.targets.emplace_back();
    for (std::size_t v = 0; v < n * n; ++v) {
      const bool moves = random.below(3) > 0;
      const double side = moves ? 0.35 : 0, up = moves ? 0.7 : 0;
      // Each number is drawn in its own statement, since the order in which the arguments of a function are evaluated
      // depends on the compiler.
      const double x = random.uniform(-side, side), y = random.uniform(-side, side);
      push(target.positions, x, y, random.uniform(-up, up));
      const double nx = random.uniform(-0.5, 0.5), ny = random.uniform(-0.5, 0.5);
      push(target.normals, nx, ny, random.uniform(-0.3, 0.3));
    }
  }
  const std::vector<double> none(target_count);
  std::vector<float> normals;  // set after the loop, since mesh.normal() compares stored normals
  for (std::size_t v = 0; v < n * n; ++v) {
    const Vector geometry = unit_of(mesh.normal(v, none));
    const Vector stored = unit_of(plus(geometry, {random.uniform(-tilt, tilt), random.uniform(-tilt, tilt), 0}));
    push(normals, static_cast<double>(stored[0]), static_cast<double>(stored[1]), static_cast<double>(stored[2]));
  }
  mesh.normals = std::move(normals);
  return mesh;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_SHADED_MESH_H_
