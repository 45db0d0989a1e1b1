// Which t counts, at every door to the normals of a segment: what lies outside [0, 1] is moved to the nearer end, below
// 2^-200 is 0, and NaN is no time.

#include "normals/control/local_time.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "chronormal/normals/encodings.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/paths.h"
#include "chronormal/normals/recompute.h"
#include "chronormal/normals/segment_normals.h"
#include "chronormal/normals/weighting.h"
#include "tests/support/fixtures.h"

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

// A way to normals: writes those at t and returns how many are (0, 0, 0).
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
  all.push_back({"faces anew", faces, [=](double t, VectorView<float> result) {
                   return unit_normals_at(segment, {0, faces}, t, result);
                 }});
  all.push_back({"recomputed faces", faces,
                 [=](double t, VectorView<float> result) { return NormalRecompute(segment).unit_normals(t, result); }});
  all.push_back({"recomputed groups", groups.size(), [=, &groups](double t, VectorView<float> result) {
                   return NormalRecompute(segment, groups).unit_normals(t, result);
                 }});
  all.push_back({"the normals of a segment", faces,
                 [=](double t, VectorView<float> result) { return SegmentNormals(segment).unit_normals(t, result); }});
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
  const std::array<Vec3d, 5> path{Vec3d{1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}};
  EXPECT_EQ(unit_normal_at(path, 2).vector, path.back());
  EXPECT_EQ(unit_normal_at(path, kNan).direction, Direction::kNone);

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
