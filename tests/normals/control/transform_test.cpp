// Compares the transformed normals of a mesh that moves as a whole with the normals of the transformed mesh.

#include "chronormal/normals/control_normals.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "tests/support/fixtures.h"
#include "tests/support/reference.h"

namespace chronormal::transform_test {
namespace {

using fixtures::Random;

Vec3d vector(Random& random, double size = 1) {
  const auto p = random.in_cube(size);
  return {p[0], p[1], p[2]};
}

AffineTransform any_transform(Random& random) {
  return {{vector(random), vector(random), vector(random)}, vector(random, 10)};
}

double determinant(const AffineTransform& t) { return dot(t.columns[0], cross(t.columns[1], t.columns[2])); }

NodeTransform any_node(Random& random) {
  NodeTransform node;
  double squares = 0;
  for (double& q : node.rotation) q = random.uniform(-1, 1), squares += q * q;
  for (double& q : node.rotation) q /= std::sqrt(squares);
  node.translation = vector(random, 5);
  node.scale = {random.uniform(0.2, 2), random.uniform(0.2, 2), random.uniform(0.2, 2)};
  return node;
}

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance = 1e-12) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

TEST(Transform, normals_are_those_of_the_transformed_face_on_the_outer_side) {
  Random random(1);
  std::size_t mirrored = 0;
  for (int round = 0; round < 500; ++round) {
    const AffineTransform transform = any_transform(random);
    const NormalMatrix matrix = normal_matrix(transform);
    const Vec3d a = vector(random), b = vector(random), c = vector(random);
    const Vec3d before = cross(b - a, c - a);
    const Vec3d after = cross(transform(b) - transform(a), transform(c) - transform(a));
    EXPECT_EQ(matrix.mirrored, determinant(transform) < 0);
    expect_near(matrix(before), matrix.mirrored ? -after : after);
    mirrored += matrix.mirrored ? 1U : 0U;

    // A point on the front side of a face must be on the front side of the transformed face, too.
    const Vec3d above = a + before;
    EXPECT_GT(dot(matrix(before), transform(above) - transform(a)), 0);
  }
  EXPECT_GT(mirrored, 100u);
}

TEST(Transform, is_the_inverse_transpose_but_for_its_length) {
  Random random(2);
  for (int round = 0; round < 100; ++round) {
    const AffineTransform transform = any_transform(random);
    reference::Matrix<3> rows{};  // the transposed matrix: its rows are the columns of the transform
    for (std::size_t i = 0; i < 3; ++i)
      rows[i] = {transform.columns[i].x, transform.columns[i].y, transform.columns[i].z};
    const auto inverse = reference::inverse(rows);
    ASSERT_TRUE(inverse);
    const Vec3d n = vector(random);
    const auto expected = reference::multiply(*inverse, reference::Vector{n.x, n.y, n.z});
    const Vec3d found = normal_matrix(transform)(n);
    EXPECT_LT(reference::angle(reference::Vector{found.x, found.y, found.z}, expected), 1e-9L);
  }
}

TEST(Transform, a_rotation_is_its_own_normal_matrix_and_a_mirror_too) {
  Random random(3);
  NodeTransform node = any_node(random);
  node.scale = {1, 1, 1};
  const AffineTransform rotation = affine_transform(node);
  for (std::size_t i = 0; i < 3; ++i) expect_near(normal_matrix(rotation).columns[i], rotation.columns[i], 1e-14);
  const AffineTransform mirror{{Vec3d{-1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}, {}};
  EXPECT_TRUE(normal_matrix(mirror).mirrored);
  expect_near(normal_matrix(mirror)({1, 2, 3}), {-1, 2, 3}, 0);
}

TEST(Transform, a_mesh_flattened_to_a_plane_has_the_two_sides_of_it) {
  const AffineTransform flat{{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 0}}, {}};
  expect_near(normal_matrix(flat)({1, 2, 3}), {0, 0, 3}, 0);
  const std::vector<float> normals = {0, 0, 5, 1, 2, -3, 1, 0, 0};
  std::vector<float> result(9);
  EXPECT_EQ(transform_unit_normals(normal_matrix(flat), VectorView<const float>::packed(normals.data(), 3),
                                   VectorView<float>::packed(result.data(), 3)),
            1u);
  EXPECT_EQ(result, (std::vector<float>{0, 0, 1, 0, 0, -1, 0, 0, 0}));
}

TEST(Transform, a_curve_of_normals_is_transformed_by_its_control_normals) {
  Random random(4);
  const AffineTransform transform = any_transform(random);
  const NormalMatrix matrix = normal_matrix(transform);
  const ControlNormals normals{vector(random), vector(random), vector(random)};
  for (const double t : {0.0, 0.3, 1.0})
    expect_near(normal_at(transformed(matrix, normals), t), matrix(normal_at(normals, t)));
}

TEST(Transform, nodes_scale_then_rotate_then_move) {
  const double h = std::sqrt(0.5);
  const NodeTransform node{{10, 20, 30}, {0, 0, h, h}, {2, 3, 4}};  // a quarter turn about z
  expect_near(affine_transform(node)({1, 1, 1}), {10 - 3, 20 + 2, 30 + 4});
  const AffineTransform quarter = affine_transform({{}, {0, 0, h, h}, {1, 1, 1}});
  const AffineTransform moved{{Vec3d{1, 0, 0}, Vec3d{0, 1, 0}, Vec3d{0, 0, 1}}, {5, 0, 0}};
  expect_near(composed(moved, quarter)({1, 0, 0}), {5, 1, 0});
  expect_near(composed(quarter, moved)({1, 0, 0}), {0, 6, 0});
}

TEST(Transform, nodes_between_keyframes_turn_at_constant_speed_on_the_shorter_arc) {
  const auto about_z = [](double degrees, double sign = 1) {
    const double half = degrees * 0.008726646259971648;
    return NodeTransform{{}, {0, 0, sign * std::sin(half), sign * std::cos(half)}, {1, 1, 1}};
  };
  for (const double sign : {1.0, -1.0}) {
    for (const double t : {0.0, 0.25, 0.5, 1.0}) {
      const auto between = affine_transform(interpolated(about_z(10), about_z(110, sign), t));
      const auto expected = affine_transform(about_z(10 + 100 * t));
      for (std::size_t i = 0; i < 3; ++i) expect_near(between.columns[i], expected.columns[i], 1e-14);
    }
  }
  const NodeTransform same = interpolated(about_z(33), about_z(33), 0.7);
  EXPECT_NEAR(same.rotation[2], about_z(33).rotation[2], 1e-15);
  Random random(6);
  const NodeTransform a = any_node(random), b = any_node(random);
  expect_near(interpolated(a, b, 0.25).translation, 0.75 * a.translation + 0.25 * b.translation);
  expect_near(interpolated(a, b, 0.25).scale, 0.75 * a.scale + 0.25 * b.scale);
}

RC_GTEST_PROP(Transform, normals_under_a_moving_node_are_those_of_the_moved_mesh_at_every_t, ()) {
  Random random(*rc::gen::arbitrary<std::uint64_t>());
  NodeTransform from = any_node(random), to = any_node(random);
  if (random.below(2) == 0) from.scale.x *= -1, to.scale.x *= -1;  // a node that mirrors the mesh
  const double t = random.uniform(0, 1);
  const AffineTransform now = affine_transform(interpolated(from, to, t));
  const Vec3d a = vector(random), b = vector(random), c = vector(random);
  const Vec3d truth = cross(now(b) - now(a), now(c) - now(a));
  const Vec3d found = normal_matrix(now)(cross(b - a, c - a));
  RC_ASSERT(max_abs(found - (from.scale.x < 0 ? -truth : truth)) < 1e-12);
}

}  // namespace
}  // namespace chronormal::transform_test
