// Tests how all functions for normals of a segment treat the local time t. A t outside of [0, 1] is moved to the nearer
// end, a t below 2^-200 becomes 0, and if t is NaN there is no normal.

#include "normals/control/local_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <iostream>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/normals/mesh_normals.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "normals/recompute/recompute.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"

namespace chronormal::local_time_test {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();

TEST(LocalTime, is_moved_into_the_segment) {
  for (const double t : {0.0, 0x1p-200, 0.3, 1 - 0x1p-53, 1.0}) EXPECT_EQ(local_time(t), t);
  for (const double t : {-0.0, -1.0, -kInfinity, 1e-300, -1e-300}) {
    EXPECT_EQ(local_time(t), 0);
    EXPECT_FALSE(std::signbit(local_time(t)));
  }
  for (const double t : {1 + 0x1p-52, 2.0, kInfinity}) EXPECT_EQ(local_time(t), 1);
  EXPECT_TRUE(std::isnan(local_time(kNan)));
}

// A time between two keys. The time and both keys are doubles. The differences between the time and the keys are small
// integers times powers of two, so local times are exactly known fractions.
struct Times {
  double start, time, end;
  double before, after;  // time - start and end - time, as multiples of the same unit
};

Times random_times(fixtures::Random& random) {
  const auto small = [&random] { return 1 + static_cast<double>(random.below(random.below(2) == 0 ? 12 : 4096)); };
  const auto power = [&random](int low, int high) {
    return std::ldexp(1.0, low + static_cast<int>(random.below(static_cast<std::uint64_t>(high - low + 1))));
  };
  Times t{0, 0, 0, small(), small()};
  const std::uint64_t kind = random.below(4);
  if (kind == 1) t.before *= power(0, 90);  // close to one of the two keys
  if (kind == 2) t.after *= power(0, 90);
  t.time = kind == 0 ? static_cast<double>(random.below(1U << 30)) - 1e8 : 0;
  t.start = t.time - t.before;
  t.end = t.time + t.after;
  const double unit =
      kind == 3 ? std::ldexp(1.0, 1011) : power(-900, 900);  // the duration may exceed the range of double
  for (double* one : {&t.start, &t.time, &t.end}) *one *= unit;
  return t;
}

// Makes a fan of triangles around vertex 0. One component of the second edge of each triangle is zero exactly at
// `times.time`. The other components are so small that a rounding error of t would outweigh them.
Motion edge_on_at(const Times& times, fixtures::Random& random) {
  Motion motion;
  std::vector<std::uint32_t> corners;
  Motion::Keyframe& from = motion.keyframes.emplace_back();
  from.positions = {0, 0, 0};
  Motion::Keyframe to = from;
  from.time = times.start;
  to.time = times.end;
  const auto whole = [&random] { return static_cast<float>(static_cast<int>(random.below(7)) - 3); };
  const std::uint64_t faces = 1 + random.below(4);
  const std::size_t axis = random.below(3);
  const float tiny = static_cast<float>(test::random_decade(random, -26, -4)), size = 1 + whole() * whole();
  for (std::uint32_t f = 0; f < faces; ++f) {
    for (auto* end : {&from.positions, &to.positions}) {
      for (int k = 0; k < 3; ++k) end->push_back(whole());
      const double crossing = end == &from.positions ? times.before : -times.after;
      for (std::size_t k = 0; k < 3; ++k)
        end->push_back(k == axis ? static_cast<float>(crossing) * size * static_cast<float>(f + 1) : tiny * whole());
    }
    corners.insert(corners.end(), {0, 2 * f + 1, 2 * f + 2});
  }
  motion.keyframes.push_back(std::move(to));
  motion.topology = Topology::triangles(2 * faces + 1, corners).value();
  motion.connect_as_sequence();
  return motion;
}

// Returns the exact sum of the normals of some faces at times.time, in rational numbers. If this sum is zero, returns
// the sum at a slightly earlier time.
exact::Vector exact_direction(const Segment& segment, std::span<const std::uint32_t> faces, const Times& times) {
  const exact::Rational start(times.start), time(times.time), end(times.end);
  const auto sum_at = [&](const exact::Rational& t) { return exact::sum_of_faces_at(segment, faces, t); };
  const exact::Rational t = (time - start) / (end - start);
  const exact::Vector n = sum_at(t);
  exact::Rational moment = 1;
  mpq_div_2exp(moment.get_mpq_t(), moment.get_mpq_t(), 3000);
  return exact::is_zero(n) ? sum_at(t - moment) : n;
}

TEST(LocalTime, is_a_quotient_without_rounding) {
  constexpr std::uint64_t kSeed = 20261126;
  fixtures::Random random(kSeed);
  std::cout << "  from seed " << kSeed << '\n';
  std::size_t no_doubles = 0;
  double worst = 0;
  for (int i = 0; i < 400; ++i) {
    const Times times = random_times(random);
    const Motion motion = edge_on_at(times, random);
    const Segment segment = motion.segment(0);
    const LocalTime t = find_instant(motion, times.time).value().t;
    if (!t.is_double()) ++no_doubles;
    const NormalGroups groups =
        NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
    std::vector<std::vector<std::uint32_t>> all_faces, all_groups;
    for (std::uint32_t f = 0; f < motion.topology.face_count(); ++f) all_faces.push_back({f});
    for (std::size_t e = 0; e < groups.size(); ++e) {
      const auto faces = groups.faces(e);
      all_groups.emplace_back(faces.begin(), faces.end());
    }
    const auto expect = [&](const char* door, const auto& elements, const auto& make, bool has_limits = true,
                            double most = 1e-6) {
      std::vector<float> normals(3 * elements.size());
      make(VectorView<float>::packed(normals.data(), elements.size()));
      for (std::size_t e = 0; e < elements.size(); ++e) {
        const float* const u = &normals[3 * e];
        const exact::Vector right = exact_direction(segment, elements[e], times);
        const bool is_zero = u[0] == 0 && u[1] == 0 && u[2] == 0;
        if (exact::is_zero(right) || (is_zero && !has_limits)) {
          EXPECT_TRUE(is_zero) << door << ", case " << i << ", element " << e;
          continue;
        }
        const double angle = exact::angle(u[0], u[1], u[2], right);
        EXPECT_LT(angle, most) << door << ", case " << i << ", element " << e << ", t = " << t.t;
        if (most == 1e-6) worst = std::max(worst, angle);
      }
    };
    using View = VectorView<float>;
    for (const double tolerance : {kExactTolerance, kCompactTolerance}) {
      expect(
          "curves of faces", all_faces,
          [&](View view) { NormalCurves::of_faces(segment, {tolerance}).unit_normals(t, view); }, true, tolerance);
      expect(
          "curves of groups", all_groups,
          [&](View view) { NormalCurves::of_groups(segment, groups, {tolerance}).unit_normals(t, view); }, true,
          tolerance);
    }
    expect("recomputed faces", all_faces, [&](View view) { NormalRecompute(segment).unit_normals(t, view); });
    expect("recomputed groups", all_groups, [&](View view) { NormalRecompute(segment, groups).unit_normals(t, view); });
    expect("a motion and a time", all_groups, [&](View view) {
      std::vector<float> of_vertices(3 * motion.topology.vertex_count());
      MeshNormals normals = MeshNormals::make(motion).value();
      const Instant instant = find_instant(motion, times.time).value();
      ASSERT_TRUE(normals.set_segment(motion.segment(instant.segment)));
      normals.unit_normals(instant.t, View::packed(of_vertices));
      for (std::size_t v = 0; v < groups.element_of_output().size(); ++v)
        view.set(groups.element_of_output()[v], {of_vertices[3 * v], of_vertices[3 * v + 1], of_vertices[3 * v + 2]});
    });
    const auto as_units = [](const std::vector<Vec3d>& normals, View view) {
      for (std::size_t e = 0; e < normals.size(); ++e) view.set(e, to_float(unit(normals[e])));
    };
    expect(
        "areas of faces", all_faces,
        [&](View view) {
          std::vector<Vec3d> normals(view.count);
          face_normals_at(segment, t, {0, view.count}, normals);
          as_units(normals, view);
        },
        false);
    expect(
        "areas of groups", all_groups,
        [&](View view) { as_units(all_weighted_normals_at(segment, groups, Weighting::kArea, t), view); }, false);
  }
  std::cout << "  " << no_doubles << " of 400 times are no doubles; at most " << worst << " rad\n";
  EXPECT_GT(no_doubles, 200u);
}

TEST(LocalTime, that_is_a_double_keeps_its_bits) {
  EXPECT_TRUE(LocalTime::between(0, 1, 4).is_double());
  EXPECT_EQ(LocalTime::between(2, 5, 8).t, 0.5);
  EXPECT_TRUE(LocalTime::between(2, 5, 8).is_double());
  const LocalTime third = LocalTime::between(0, 1, 3);
  EXPECT_FALSE(third.is_double());
  EXPECT_EQ(third.t, 1.0 / 3);
  EXPECT_EQ(third.rest, 2.0 / 3);
  EXPECT_EQ(LocalTime::between(-1, 0, 0x1p-60).rest, 0x1p-60);
  EXPECT_EQ(LocalTime::between(-1e308, 0, 1e308).t, 0.5);
  EXPECT_EQ(LocalTime::between(0, 0x1p-1074, 0x3p-1074).rest, 2.0 / 3);
  EXPECT_FALSE(LocalTime::between(0, 0x1p-1074, 0x3p-1074).is_double());
  EXPECT_EQ(LocalTime::between(1, 0, 2).t, 0);
  EXPECT_EQ(LocalTime::between(1, 3, 2).t, 1);
  EXPECT_TRUE(std::isnan(LocalTime::between(1, kNan, 2).t));
}

// A function of the library that writes the normals of `size` elements at t, and returns how many of the normals are
// (0, 0, 0).
struct Door {
  std::string name;
  std::size_t size;
  std::function<std::size_t(double, VectorView<float>)> normals;
};

std::vector<Door> doors(const Motion& motion, const NormalGroups& groups) {
  const Segment segment = motion.segment(0);
  const std::size_t faces = motion.topology.face_count();
  std::vector<Door> all;
  for (const double tolerance : {kExactTolerance, kCompactTolerance}) {
    all.push_back({"curves of faces", faces, [=](double t, VectorView<float> result) {
                     return NormalCurves::of_faces(segment, {tolerance}).unit_normals(t, result);
                   }});
    all.push_back({"curves of groups, many times", groups.size(), [=, &groups](double t, VectorView<float> result) {
                     const double times[] = {t};
                     const VectorView<float> results[] = {result};
                     return NormalCurves::of_groups(segment, groups, {tolerance}).unit_normals(times, results);
                   }});
  }
  all.push_back({"recomputed faces", faces,
                 [=](double t, VectorView<float> result) { return NormalRecompute(segment).unit_normals(t, result); }});
  all.push_back({"recomputed groups", groups.size(), [=, &groups](double t, VectorView<float> result) {
                   return NormalRecompute(segment, groups).unit_normals(t, result);
                 }});
  all.push_back({"the normals of a mesh", faces, [=](double t, VectorView<float> result) {
                   MeshNormals normals = MeshNormals::make(*segment.topology, {{ElementKind::kFaces}}).value();
                   EXPECT_TRUE(normals.set_segment(segment));
                   return normals.unit_normals(t, result);
                 }});
  return all;
}

TEST(LocalTime, is_the_nearer_end_at_every_door) {
  const Motion motion = fixtures::large_soup(40);
  const NormalGroups groups =
      NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
  for (const Door& door : doors(motion, groups)) {
    SCOPED_TRACE(door.name);
    const auto at = [&door](double t, std::size_t zeros = 0) {
      std::vector<float> normals(3 * door.size, 7.0F);
      EXPECT_EQ(door.normals(t, VectorView<float>::packed(normals.data(), door.size)), zeros) << t;
      return normals;
    };
    const std::vector<float> start = at(0), end = at(1);
    EXPECT_NE(start, end);
    for (const double t : {-1e-9, -3.0, -kInfinity, 1e-300}) EXPECT_EQ(at(t), start) << t;
    for (const double t : {1 + 1e-9, 3.0, kInfinity}) EXPECT_EQ(at(t), end) << t;
    EXPECT_EQ(at(kNan, door.size), std::vector<float>(3 * door.size, 0.0F));
  }
}

TEST(LocalTime, of_lengths_and_four_bytes_is_no_other) {
  const Motion motion = fixtures::large_soup(40);
  const NormalCurves curves = NormalCurves::of_faces(motion.segment(0));
  std::vector<float> lengths(120), end(120);
  curves.normals(2, VectorView<float>::packed(lengths.data(), 40));
  curves.normals(1, VectorView<float>::packed(end.data(), 40));
  EXPECT_EQ(lengths, end);
  curves.normals(kNan, VectorView<float>::packed(lengths.data(), 40));
  EXPECT_EQ(lengths, std::vector<float>(120, 0.0F));

  std::vector<Rgb10A2> rgb(40, Rgb10A2{7});
  EXPECT_EQ(curves.unit_normals(kNan, rgb), 40u);
  EXPECT_EQ(rgb, std::vector<Rgb10A2>(40));
  std::vector<Octahedral> octahedral(40, Octahedral{7});
  EXPECT_EQ(curves.unit_normals(kNan, octahedral), 40u);
  EXPECT_EQ(octahedral, std::vector<Octahedral>(40, encode_octahedral({})));
}

TEST(LocalTime, in_double_is_no_other) {
  const ControlNormals c{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_EQ(unit_normal_at(c, -1).vector, c.n0);
  EXPECT_EQ(unit_normal_at(c, 2).vector, c.n1);
  EXPECT_EQ(unit_normal_at(c, kNan).vector, Vec3d{});
  EXPECT_EQ(unit_normal_at(c, kNan).direction, Direction::kNone);

  const Motion motion = fixtures::large_soup(4);
  std::vector<Vec3d> late(4), end(4);
  face_normals_at(motion.segment(0), 5, {0, 4}, late);
  face_normals_at(motion.segment(0), 1, {0, 4}, end);
  EXPECT_EQ(late, end);
  face_normals_at(motion.segment(0), kNan, {0, 4}, late);
  EXPECT_EQ(late, std::vector<Vec3d>(4));
}

}  // namespace
}  // namespace chronormal::local_time_test
