// Tests the names and the costs of schemes, and all kinds of degenerate faces. oracle_test.cpp compares the accuracy
// with an independent oracle.

#include "chronormal/schemes/scheme.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <vector>

namespace chronormal::scheme_test {
namespace {

// Returns the name of every scheme, with a value for its parameter if it has one.
std::vector<std::string> all_schemes() {
  std::vector<std::string> names;
  for (const SchemeDescription& description : scheme_descriptions()) {
    std::string name(description.name);
    if (name == "lagrange:K") name = "lagrange:6";
    if (name == "decasteljau:K") name = "decasteljau:5";
    if (name == "quaternion:random:SEED") name = "quaternion:random:3";
    names.push_back(name);
  }
  return names;
}

struct Triangle {
  std::vector<float> from, to;
};

struct Prepared {
  Topology topology;
  Triangle triangle;
  Segment segment;
  std::vector<ControlNormals> normals;

  explicit Prepared(Triangle t)
      : topology(Topology::triangles(3, {0, 1, 2}).value()), triangle(std::move(t)), normals(1) {
    segment = {&topology,
               VectorView<const float>::packed(triangle.from.data(), 3),
               VectorView<const float>::packed(triangle.to.data(), 3),
               0,
               1,
               0};
    face_control_normals(segment, {0, 1}, normals);
  }
  Prepared(const Prepared&) = delete;
};

struct Evaluated {
  Vec3d normal;
  std::size_t zeros;
  std::size_t fallbacks;
};

Evaluated evaluate(const std::string& name, const Prepared& prepared, double t) {
  auto scheme = make_scheme(name);
  EXPECT_TRUE(scheme.ok()) << name;
  scheme.value()->prepare({&prepared.segment, {0, 1}, prepared.normals});
  float n[3] = {9, 9, 9};
  const std::size_t zeros = scheme.value()->evaluate(t, VectorView<float>::packed(n, 1));
  return {{n[0], n[1], n[2]}, zeros, scheme.value()->fallback_count()};
}

void expect_unit_for_all_schemes_and_times(const Prepared& prepared, const char* what) {
  for (const std::string& name : all_schemes()) {
    for (int i = 0; i <= 40; ++i) {
      const Evaluated e = evaluate(name, prepared, i / 40.0);
      EXPECT_NEAR(length(e.normal), 1, 2e-3) << what << ", " << name << ", t = " << i / 40.0;
      EXPECT_EQ(e.zeros, 0u) << what << ", " << name;
    }
  }
}

double angle(const Vec3d& a, const Vec3d& b) { return std::atan2(length(cross(a, b)), dot(a, b)); }

const std::vector<float> kFlat = {0, 0, 0, 1, 0, 0, 0, 1, 0};      // normal +z
const std::vector<float> kReversed = {0, 0, 0, 0, 1, 0, 1, 0, 0};  // normal -z
const std::vector<float> kUpright = {0, 0, 0, 0, 1, 0, 0, 0, 1};   // normal +x
const std::vector<float> kPoint = {2, 3, 4, 2, 3, 4, 2, 3, 4};
const std::vector<float> kLine = {0, 0, 0, 1, 1, 1, 2, 2, 2};

TEST(Schemes, every_described_scheme_can_be_made) {
  EXPECT_GE(all_schemes().size(), 17u);
  for (const std::string& name : all_schemes()) EXPECT_TRUE(make_scheme(name).ok()) << name;
  EXPECT_TRUE(make_scheme("lagrange:1").ok());
  EXPECT_TRUE(make_scheme("lagrange:64").ok());
  EXPECT_TRUE(make_scheme("decasteljau:32").ok());
  EXPECT_TRUE(make_scheme("quaternion:random:18446744073709551615").ok());
}

TEST(Schemes, a_name_that_is_not_there_is_a_usage_error_that_lists_what_is) {
  for (const char* name : {"", "nlerp", "Linear", "linear:", "quaternion", "quaternion:", "circle:", "slerp:2"}) {
    const auto scheme = make_scheme(name);
    ASSERT_FALSE(scheme.ok()) << name;
    EXPECT_EQ(scheme.error().code, ErrorCode::kUsage);
    EXPECT_NE(scheme.error().message.find("quaternion:optimal"), std::string::npos) << scheme.error().message;
  }
}

TEST(Schemes, a_parameter_out_of_range_is_a_usage_error_that_says_the_range) {
  for (const char* name : {"lagrange:0", "lagrange:65", "lagrange:", "lagrange:2x", "lagrange:-1", "lagrange: 2",
                           "decasteljau:1", "decasteljau:33", "quaternion:random:x", "quaternion:random:",
                           "quaternion:random:18446744073709551616", "lagrange:99999999999999999999"}) {
    const auto scheme = make_scheme(name);
    ASSERT_FALSE(scheme.ok()) << name;
    EXPECT_EQ(scheme.error().code, ErrorCode::kUsage);
    EXPECT_NE(scheme.error().message.find("whole number from"), std::string::npos) << scheme.error().message;
  }
}

TEST(Schemes, ends_are_met_by_every_scheme) {
  const Prepared turning({kFlat, kUpright});
  for (const std::string& name : all_schemes()) {
    EXPECT_LT(angle(evaluate(name, turning, 0).normal, {0, 0, 1}), 1e-6) << name;
    EXPECT_LT(angle(evaluate(name, turning, 1).normal, {1, 0, 0}), 1e-6) << name;
  }
}

TEST(Schemes, equal_ends_of_a_still_face_stay_where_they_are) {
  const Prepared still({kFlat, kFlat});
  for (const std::string& name : all_schemes()) {
    if (name.starts_with("quaternion:random")) continue;  // this scheme turns even if both ends are equal
    for (const double t : {0.0, 0.3, 1.0}) EXPECT_LT(angle(evaluate(name, still, t).normal, {0, 0, 1}), 1e-6) << name;
    EXPECT_EQ(evaluate(name, still, 0.5).fallbacks, 0u) << name;
  }
}

TEST(Schemes, equal_ends_with_motion_between_give_unit_normals) {
  // In both motions, the triangle turns by 180 degrees in its plane, which keeps its normal. In the first motion, two
  // corners also rise out of the plane, which tilts the normal at the end.
  expect_unit_for_all_schemes_and_times(Prepared({kFlat, {1, 1, 0, 0, 1, 0.5f, 1, 0, 0.25f}}), "moving");
  expect_unit_for_all_schemes_and_times(Prepared({kFlat, {1, 1, 0, 0, 1, 0, 1, 0, 0}}), "half a turn in the plane");
}

TEST(Schemes, antipodal_ends_give_unit_normals) {
  const Prepared flip({kFlat, {0, 0, 0, -1, 0, 0, 0, 1, 0}});
  EXPECT_NEAR(angle(unit_normal_at(flip.normals[0], 0).vector, unit_normal_at(flip.normals[0], 1).vector), 3.14159265,
              1e-8);
  expect_unit_for_all_schemes_and_times(flip, "antipodal");
  EXPECT_EQ(evaluate("slerp", flip, 0.5).fallbacks, 1u);
  EXPECT_NEAR(angle(evaluate("slerp", flip, 0.5).normal, {0, 0, 1}), 3.14159265 / 2, 1e-6);
}

TEST(Schemes, antipodal_ends_through_a_third_direction_are_met_by_the_circle) {
  // The triangle turns by 180 degrees about the x axis. The scheme circle:timed passes through the normal at t = 1/2,
  // which is perpendicular to the normals at both ends.
  const Prepared flip({{0, -1, 0, 1, -1, 0, 0, 1, 0}, {0, 1, 0, 1, 1, 0.01f, 0, -1, 0}});
  const Vec3d middle = unit_normal_at(flip.normals[0], 0.5).vector;
  EXPECT_LT(angle(evaluate("circle:timed", flip, 0.5).normal, middle), 1e-5);
  expect_unit_for_all_schemes_and_times(flip, "nearly antipodal");
}

TEST(Schemes, a_face_that_is_a_point_throughout_gives_zero_and_is_counted) {
  const Prepared nothing({kPoint, {5, 5, 5, 5, 5, 5, 5, 5, 5}});
  for (const std::string& name : all_schemes()) {
    for (const double t : {0.0, 0.4, 1.0}) {
      const Evaluated e = evaluate(name, nothing, t);
      EXPECT_EQ(e.normal, Vec3d{}) << name;
      EXPECT_EQ(e.zeros, 1u) << name;
    }
  }
}

TEST(Schemes, a_face_that_is_a_line_throughout_gives_zero_and_is_counted) {
  const Prepared nothing({kLine, {0, 0, 0, 2, 2, 2, 4, 4, 4}});
  for (const std::string& name : all_schemes()) EXPECT_EQ(evaluate(name, nothing, 0.5).zeros, 1u) << name;
}

TEST(Schemes, a_degenerate_start_takes_the_limit) {
  for (const auto& start : {kPoint, kLine}) {
    const Prepared growing({start, kUpright});
    const Vec3d limit = unit_normal_at(growing.normals[0], 0).vector;
    for (const std::string& name : all_schemes())
      EXPECT_LT(angle(evaluate(name, growing, 0).normal, limit), 1e-5) << name;
    expect_unit_for_all_schemes_and_times(growing, "degenerate start");
  }
}

TEST(Schemes, a_degenerate_end_takes_the_limit) {
  for (const auto& end : {kPoint, kLine}) {
    const Prepared shrinking({kUpright, end});
    const Vec3d limit = unit_normal_at(shrinking.normals[0], 1).vector;
    for (const std::string& name : all_schemes())
      EXPECT_LT(angle(evaluate(name, shrinking, 1).normal, limit), 1e-5) << name;
    expect_unit_for_all_schemes_and_times(shrinking, "degenerate end");
  }
}

TEST(Schemes, degenerate_ends_at_both_sides_of_a_face_that_opens_between_give_unit_normals) {
  expect_unit_for_all_schemes_and_times(Prepared({kLine, {0, 0, 0, 2, 0, 0, 1, 0, 0}}), "lines at both ends");
  expect_unit_for_all_schemes_and_times(Prepared({{0, 0, 0, 0, 0, 0, 1, 0, 0}, {0, 0, 0, 0, 1, 0, 0, 0, 0}}), "edges");
}

TEST(Schemes, a_singular_matrix_falls_back_to_slerp_and_is_counted) {
  const Prepared singular({kLine, {0, 0, 0, 1, 0, 0.5f, 0.25f, 1, 0}});
  const Vec3d slerp = evaluate("slerp", singular, 0.3).normal;
  for (const char* name : {"quaternion:matrix", "quaternion:polar"}) {
    const Evaluated e = evaluate(name, singular, 0.3);
    EXPECT_EQ(e.fallbacks, 1u) << name;
    EXPECT_LT(angle(e.normal, slerp), 1e-6) << name;
  }
}

TEST(Schemes, an_edge_without_length_takes_the_direction_in_which_it_grows) {
  const Prepared growing({{0, 0, 0, 0, 0, 0, 0, 1, 0}, {0, 0, 0, 1, 0, 0, 0, 1, 1}});
  EXPECT_EQ(evaluate("quaternion:edge", growing, 0.5).fallbacks, 0u);
  expect_unit_for_all_schemes_and_times(growing, "edge without length");
}

TEST(Schemes, a_collapse_inside_the_segment_gives_unit_normals) {
  // In the first motion, the face passes through a point: n(t) has a double zero at t = 1/2, and the direction does not
  // change. In the other motions, the face passes through a line at t = 1/2 or t = 1/3, where the direction jumps.
  expect_unit_for_all_schemes_and_times(Prepared({kFlat, {0, 0, 0, -1, 0, 0, 0, -1, 0}}), "through a point");
  expect_unit_for_all_schemes_and_times(Prepared({kFlat, kReversed}), "through a line");
  expect_unit_for_all_schemes_and_times(Prepared({kFlat, {0, 0, 0, 1, 0, 0, 0, -2, 0}}), "at one third");
}

TEST(Schemes, a_collapse_exactly_at_a_node_takes_the_side_before_and_is_counted) {
  // n(t) is zero at t = 1/2. Just before t = 1/2 and just after it, n(t) has opposite directions.
  const Prepared crossing({kFlat, {0, 0, 0, 1, 0, 0, 0, -1, 0}});
  for (const char* name : {"quadratic", "decasteljau:3", "circle", "circle:timed"}) {
    EXPECT_EQ(evaluate(name, crossing, 0.5).fallbacks, 1u) << name;
  }
  EXPECT_LT(angle(evaluate("quadratic", crossing, 0.5).normal, {0, 0, 1}), 1e-5);
  EXPECT_EQ(evaluate("cubic", crossing, 0.5).fallbacks, 0u);  // cubic has no node at t = 1/2
}

TEST(Schemes, linear_of_opposite_ends_is_the_start_where_it_vanishes) {
  const Prepared flip({kFlat, {0, 0, 0, -1, 0, 0, 0, 1, 0}});
  EXPECT_EQ(evaluate("linear", flip, 0.5).normal, (Vec3d{0, 0, 1}));
}

TEST(Schemes, no_input_makes_nan) {
  // The coordinates have all magnitudes, and many coordinates are equal, so all kinds of degenerate faces occur.
  const float values[] = {0, 0, 0, 1, -1, 1, 0.5f, 1e-38f, 1e-20f, -1e-7f, 1e7f, 1e18f, -3e38f, 1.0000001f};
  std::mt19937 random(7);
  for (int i = 0; i < 3000; ++i) {
    Triangle triangle{std::vector<float>(9), std::vector<float>(9)};
    for (auto* points : {&triangle.from, &triangle.to})
      for (float& value : *points) value = values[random() % std::size(values)];
    const Prepared prepared(std::move(triangle));
    for (const std::string& name : all_schemes()) {
      const Evaluated e = evaluate(name, prepared, static_cast<double>(random() % 21) / 20);
      ASSERT_TRUE(std::isfinite(e.normal.x) && std::isfinite(e.normal.y) && std::isfinite(e.normal.z)) << name << i;
      ASSERT_TRUE(e.zeros == 1 || std::fabs(length(e.normal) - 1) < 2e-3) << name << ", triangle " << i;
    }
  }
}

TEST(Schemes, polygons_work_with_every_scheme) {
  const Topology topology = Topology::polygons(5, {0, 5}, {0, 1, 2, 3, 4}).value();
  const float from[] = {0, 0, 0, 2, 0, 0, 3, 1, 0.5f, 1, 2, 0, -1, 1, 0.2f};
  const float to[] = {0, 0, 0, 2, 0, 1, 3, 1, 1.5f, 1, 2, 1, -1, 1, -1};
  const Segment segment{
      &topology, VectorView<const float>::packed(from, 5), VectorView<const float>::packed(to, 5), 0, 1, 0};
  std::vector<ControlNormals> normals(1);
  face_control_normals(segment, {0, 1}, normals);
  for (const std::string& name : all_schemes()) {
    auto scheme = make_scheme(name).value();
    scheme->prepare({&segment, {0, 1}, normals});
    float n[3];
    for (const double t : {0.0, 1.0}) {
      scheme->evaluate(t, VectorView<float>::packed(n, 1));
      EXPECT_LT(angle({n[0], n[1], n[2]}, unit_normal_at(normals[0], t).vector), 1e-6) << name << t;
    }
    scheme->evaluate(0.5, VectorView<float>::packed(n, 1));
    EXPECT_NEAR(length({n[0], n[1], n[2]}), 1, 1e-5) << name;
  }
}

TEST(Schemes, planes_and_packed_results_are_the_same_bits) {
  const Prepared turning({kFlat, {0, 0.2f, 0, 0.1f, 1, 0, 0.3f, 0, 1}});
  for (const std::string& name : all_schemes()) {
    auto scheme = make_scheme(name).value();
    scheme->prepare({&turning.segment, {0, 1}, turning.normals});
    float packed[3], x, y, z;
    scheme->evaluate(0.4, VectorView<float>::packed(packed, 1));
    scheme->evaluate(0.4, VectorView<float>::planes(&x, &y, &z, 1));
    EXPECT_EQ((Vec3f{packed[0], packed[1], packed[2]}), (Vec3f{x, y, z})) << name;
  }
}

TEST(Schemes, operations_are_those_of_the_formulas) {
  // Each row has the numbers of additions, products, quotients, roots and trigonometric functions. Of these, the
  // normalisation takes 2 additions, 6 products, a quotient and a root.
  const std::map<std::string, OperationCounts> expected = {
      {"linear", {5, 12, 1, 1, 0}},
      {"quadratic", {8, 15, 1, 1, 0}},
      {"cubic", {11, 18, 1, 1, 0}},
      {"polynomial", {8, 15, 1, 1, 0}},
      {"slerp", {3, 7, 0, 0, 1}},
      {"circle", {6, 7, 0, 0, 1}},
      {"circle:timed", {9, 9, 1, 0, 1}},
      {"rational", {10, 17, 1, 1, 0}},
      {"decasteljau:4", {68, 126, 7, 7, 12}},
      {"quaternion:matrix", {6, 7, 0, 0, 1}},
      {"quaternion:optimal", {6, 7, 0, 0, 1}},
  };
  for (const auto& [name, counts] : expected) {
    const OperationCounts actual = make_scheme(name).value()->operations();
    EXPECT_EQ(actual, counts) << name << ": " << actual.add << " " << actual.multiply << " " << actual.divide << " "
                              << actual.sqrt << " " << actual.trigonometric;
  }
  EXPECT_EQ(make_scheme("decasteljau:4").value()->operations().trigonometric, 12);  // 6 slerps with 2 functions each
}

TEST(Schemes, operations_of_a_step_are_those_of_differences_and_rotations) {
  // Each row has the numbers of additions, products, quotients, roots and trigonometric functions. A step adds vectors
  // and normalises the sum, or rotates a vector in a plane and computes the point on the arc.
  const std::map<std::string, OperationCounts> expected = {
      {"linear", {5, 6, 1, 1, 0}}, {"quadratic", {8, 6, 1, 1, 0}}, {"cubic", {11, 6, 1, 1, 0}},
      {"slerp", {5, 10, 0, 0, 0}}, {"circle", {8, 10, 0, 0, 0}},
  };
  for (const auto& [name, counts] : expected) {
    const auto actual = make_scheme(name).value()->sequential_operations();
    ASSERT_TRUE(actual) << name;
    EXPECT_EQ(*actual, counts) << name << ": " << actual->add << " " << actual->multiply;
  }
  for (const char* name : {"lagrange:4", "rational", "linear:scaled", "circle:timed", "decasteljau:4"})
    EXPECT_FALSE(make_scheme(name).value()->sequential_operations()) << name;
}

}  // namespace
}  // namespace chronormal::scheme_test
