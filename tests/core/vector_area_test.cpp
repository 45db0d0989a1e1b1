#include "core/vector_area.h"

#include <gtest/gtest.h>

#include <vector>

#include "core/rounding.h"

namespace chronormal::vector_area_test {
namespace {

Vec3d normal_of(const std::vector<Vec3d>& polygon, std::size_t first = 0) {
  return twice_vector_area(polygon.size(), [&](std::size_t c) { return polygon[(first + c) % polygon.size()]; });
}

Vec3d rounded_normal_of(const std::vector<Vec3d>& polygon) {
  CrossSum sum;
  for_fan(
      polygon.size(), [&](std::size_t c) { return polygon[c] - polygon[0]; },
      [&sum](const Vec3d& e, const Vec3d& f) { sum.add(e, f); });
  return sum.without_rounding();
}

TEST(VectorArea, counts_what_a_fan_covers_outside_a_polygon_with_the_other_sign) {
  const std::vector<Vec3d> arrow{{0, 0, 0}, {4, -3, 0}, {1, 0, 0}, {4, 3, 0}};
  EXPECT_EQ(normal_of(arrow), (Vec3d{0, 0, 6}));
}

TEST(VectorArea, is_the_same_from_every_corner_of_a_polygon_that_is_not_flat) {
  const std::vector<Vec3d> crooked{{0, 0, 1}, {4, 0, -2}, {5, 3, 0}, {2, 6, 8}, {-1, 3, 2}};
  for (std::size_t first = 1; first < crooked.size(); ++first) EXPECT_EQ(normal_of(crooked, first), normal_of(crooked));
}

TEST(VectorArea, edge_to_each_corner_is_made_once) {
  std::vector<std::size_t> made;
  std::size_t triangles = 0;
  const auto edge_to = [&](std::size_t c) {
    made.push_back(c);
    return c;
  };
  for_fan(5, edge_to, [&](std::size_t e, std::size_t f) {
    EXPECT_EQ(f, e + 1);
    ++triangles;
  });
  EXPECT_EQ(made, (std::vector<std::size_t>{1, 2, 3, 4}));
  EXPECT_EQ(triangles, 3u);
}

TEST(Rounding, collinear_corners_have_no_normal) {
  const Vec3d step{0.1, 0.7, -1.3};
  const std::vector<Vec3d> line{{}, step, 3.0 * step, (1 / 3.0) * step};
  EXPECT_NE(normal_of(line), Vec3d{});
  EXPECT_EQ(rounded_normal_of(line), Vec3d{});
}

TEST(Rounding, terms_that_cancel_leave_nothing) {
  VectorSum sum;
  for (const double x : {0.1, 0.2, -0.3}) sum.add({x, x, 1});
  EXPECT_NE(0.1 + 0.2 - 0.3, 0.0);
  EXPECT_EQ(sum.without_rounding(), (Vec3d{0, 0, 3}));
}

TEST(Rounding, is_not_what_lies_above_the_error) {
  const Vec3d v{1e-9, -2e-9, 3e-9};
  EXPECT_EQ(without_rounding(v, 2e-9), v);
  EXPECT_EQ(without_rounding(v, 3e-9), Vec3d{});
  EXPECT_EQ(without_rounding(v, Vec3d{1e-9, 1e-9, 1e-9}), (Vec3d{0, -2e-9, 3e-9}));
}

}  // namespace
}  // namespace chronormal::vector_area_test
