/// A skin for a morphing mesh, which can be written as JSON and bytes of a glTF file. The skin is also an oracle: it
/// computes its effect in long double, by loops that share no code with src/.
#ifndef CHRONORMAL_TESTS_SUPPORT_SKINNED_MESH_H_
#define CHRONORMAL_TESTS_SUPPORT_SKINNED_MESH_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/shaded_mesh.h"

namespace chronormal::test {

/// A matrix with three rows of four numbers, which maps the vector (x, y, z, 1) to a position.
struct Rows {
  std::array<std::array<Real, 4>, 3> m = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};

  [[nodiscard]] Vector of_place(const Vector& p) const {
    Vector result{};
    for (std::size_t r = 0; r < 3; ++r) result[r] = m[r][0] * p[0] + m[r][1] * p[1] + m[r][2] * p[2] + m[r][3];
    return result;
  }
  [[nodiscard]] Vector of_direction(const Vector& d) const {
    Vector result{};
    for (std::size_t r = 0; r < 3; ++r) result[r] = m[r][0] * d[0] + m[r][1] * d[1] + m[r][2] * d[2];
    return result;
  }
  [[nodiscard]] Real determinant() const {
    const auto row = [&](std::size_t r) { return Vector{m[r][0], m[r][1], m[r][2]}; };
    return dotted(row(0), crossed(row(1), row(2)));
  }
};

/// Returns the product of two matrices, which applies matrix b first, and then matrix a.
[[nodiscard]] inline Rows after(const Rows& a, const Rows& b) {
  Rows result;
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 4; ++c) {
      result.m[r][c] = c == 3 ? a.m[r][3] : 0;
      for (std::size_t k = 0; k < 3; ++k) result.m[r][c] += a.m[r][k] * b.m[k][c];
    }
  }
  return result;
}

/// A transform of a glTF node: translation, rotation and scale. The rotation is a quaternion x, y, z, w, whose length
/// need not be 1.
struct Trs {
  std::array<Real, 3> translation = {0, 0, 0};
  std::array<Real, 4> rotation = {0, 0, 0, 1};
  std::array<Real, 3> scale = {1, 1, 1};

  /// Returns the transform as a matrix. The rotation turns an axis v into v + 2 w (u x v) + 2 u x (u x v), where w and
  /// u = (x, y, z) are the parts of the unit quaternion.
  [[nodiscard]] Rows rows() const {
    Real length = 0;
    for (const Real c : rotation) length += c * c;
    length = std::sqrt(length);
    const Vector u = {rotation[0] / length, rotation[1] / length, rotation[2] / length};
    Rows result;
    for (std::size_t c = 0; c < 3; ++c) {
      Vector axis = {0, 0, 0};
      axis[c] = scale[c];
      const Vector once = crossed(u, axis);
      const Vector turned = plus(plus(axis, once, 2 * rotation[3] / length), crossed(u, once), 2);
      for (std::size_t r = 0; r < 3; ++r) result.m[r][c] = turned[r];
    }
    for (std::size_t r = 0; r < 3; ++r) result.m[r][3] = translation[r];
    return result;
  }
  [[nodiscard]] GltfBuilder::Json json() const {
    const auto list = [](const auto& numbers) {
      GltfBuilder::Json result = GltfBuilder::Json::array();
      for (const Real c : numbers) result.push_back(static_cast<double>(c));
      return result;
    };
    return {{"translation", list(translation)}, {"rotation", list(rotation)}, {"scale", list(scale)}};
  }
};

/// A skin: the joints and weights of each vertex, in sets of four, and the inverse bind matrices.
struct Skin {
  std::vector<std::array<float, 16>> inverse_binds;  ///< column by column; empty if the file has none
  std::vector<std::vector<std::uint8_t>> joints;     ///< for each set, four joints for each vertex
  std::vector<std::vector<float>> weights;           ///< with the same layout as `joints`

  /// Adds the skin to a file, with these nodes as joints. Node 0 and the first primitive of mesh 0 get the skin.
  void add_to(GltfBuilder& builder, const std::vector<std::size_t>& nodes) const {
    GltfBuilder::Json& attributes = builder.json["meshes"][0]["primitives"][0]["attributes"];
    for (std::size_t n = 0; n < joints.size(); ++n) {
      attributes["JOINTS_" + std::to_string(n)] = builder.add_accessor("VEC4", joints[n]);
      attributes["WEIGHTS_" + std::to_string(n)] = builder.add_accessor("VEC4", weights[n]);
    }
    GltfBuilder::Json skin = {{"joints", nodes}};
    if (!inverse_binds.empty()) {
      std::vector<float> numbers;
      for (const auto& matrix : inverse_binds) numbers.insert(numbers.end(), matrix.begin(), matrix.end());
      skin["inverseBindMatrices"] =
          builder.add_accessor_over(builder.add_view(bytes_of(numbers)), "MAT4", 5126, inverse_binds.size());
    }
    builder.json["nodes"][0]["skin"] = builder.add("skins", skin);
  }

  /// Returns the matrix by which a joint moves vertices: its world matrix times its inverse bind matrix.
  [[nodiscard]] Rows of_joint(std::size_t joint, const std::vector<Rows>& world) const {
    Rows bind;
    for (std::size_t k = 0; k < 12 && !inverse_binds.empty(); ++k)
      bind.m[k % 3][k / 3] = inverse_binds[joint][4 * (k / 3) + k % 3];
    return after(world[joint], bind);
  }

  /// Returns the weighted sum of the joint matrices of a vertex, for joints with these world matrices.
  [[nodiscard]] Rows blended(std::size_t vertex, const std::vector<Rows>& world) const {
    Real sum = 0;
    for (const auto& of_set : weights)
      for (std::size_t i = 0; i < 4; ++i) sum += of_set[4 * vertex + i];
    Rows result;
    result.m = {};
    for (std::size_t n = 0; n < joints.size(); ++n) {
      for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t joint = joints[n][4 * vertex + i];
        if (weights[n][4 * vertex + i] == 0) continue;
        const Rows matrix = of_joint(joint, world);
        for (std::size_t r = 0; r < 3; ++r)
          for (std::size_t c = 0; c < 4; ++c) result.m[r][c] += weights[n][4 * vertex + i] / sum * matrix.m[r][c];
      }
    }
    return result;
  }
};

/// The ways in which viewers transform the normal of a skinned vertex: by the blended matrix, by the inverse transpose
/// of the blended matrix, or by the cofactors of the matrix of each joint.
enum class Carry { kBlended, kInverseTranspose, kByJoint };

[[nodiscard]] inline Vector by_cofactors(const Rows& matrix, const Vector& n) {
  const auto column = [&](std::size_t c) { return Vector{matrix.m[0][c], matrix.m[1][c], matrix.m[2][c]}; };
  const Vector a = column(0), b = column(1), c = column(2);
  return plus(plus(plus({0, 0, 0}, crossed(b, c), n[0]), crossed(c, a), n[1]), crossed(a, b), n[2]);
}
[[nodiscard]] inline Vector carried(Carry rule, const Skin& skin, const std::vector<Rows>& world, std::size_t v,
                                    const Vector& n) {
  const Rows blended = skin.blended(v, world);
  if (rule == Carry::kBlended) return blended.of_direction(n);
  if (rule == Carry::kInverseTranspose) return plus({0, 0, 0}, by_cofactors(blended, n), 1 / blended.determinant());
  Vector sum = {0, 0, 0};
  for (std::size_t set = 0; set < skin.joints.size(); ++set)
    for (std::size_t i = 4 * v; i < 4 * v + 4; ++i)
      if (skin.weights[set][i] != 0)
        sum = plus(sum, unit_of(by_cofactors(skin.of_joint(skin.joints[set][i], world), n)), skin.weights[set][i]);
  return sum;
}

/// The errors on the screen, in degrees. `shown` is the angle between the rendered and the true normal of a vertex
/// after both were transformed in the same way. `skinning` is the angle between the normal of the surface before
/// skinning, transformed by the blended matrix, and the normal of the skinned surface.
struct SeenErrors {
  double shown = 0, skinning = 0;
};
[[nodiscard]] inline SeenErrors seen_errors(const ShadedMesh& mesh, const Skin& skin, const std::vector<Rows>& world,
                                            std::size_t v, const std::vector<double>& weights,
                                            Carry rule = Carry::kBlended) {
  const Rows matrix = skin.blended(v, world);
  const Vector base = unit_of(mesh.normal(v, std::vector<double>(weights.size())));
  const Vector normal = unit_of(mesh.normal(v, weights));
  const Vector right = rotated(base, unit_of(vector_at(mesh.normals, v)), normal);
  Vector around = {0, 0, 0};
  for (std::size_t c = 0; c < mesh.corners.size(); ++c) {
    if (!mesh.same_element(mesh.corners[c], v)) continue;
    const std::size_t f = c - c % 3;
    std::array<Vector, 3> p;
    for (std::size_t k = 0; k < 3; ++k)
      p[k] = skin.blended(mesh.corners[f + k], world).of_place(mesh.position(mesh.corners[f + k], weights));
    around = plus(around, crossed(plus(p[1], p[0], -1), plus(p[2], p[0], -1)));
  }
  if (matrix.determinant() < 0) around = {-around[0], -around[1], -around[2]};
  const auto seen = [&](const Vector& n) { return carried(rule, skin, world, v, n); };
  return {degrees_between(seen(mesh.shown(v, weights)), seen(right)),
          degrees_between(matrix.of_direction(normal), around)};
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_SKINNED_MESH_H_
