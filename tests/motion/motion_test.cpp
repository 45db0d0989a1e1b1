// topology, motion, validate.

#include <gtest/gtest.h>

#include <limits>

#include "chronormal/motion/motion.h"
#include "chronormal/motion/topology.h"
#include "chronormal/motion/validate.h"

namespace chronormal::motion_test {
namespace {

TEST(Topology, mixes_triangles_and_polygons) {
  const auto topology = Topology::polygons(8, {0, 3, 6, 10}, {0, 1, 2, 2, 1, 3, 4, 5, 6, 7});
  ASSERT_TRUE(topology.ok());
  EXPECT_EQ(topology.value().face_count(), 3u);
  EXPECT_FALSE(topology.value().all_triangles());
  EXPECT_EQ(topology.value().face(1)[2], 3u);
  EXPECT_EQ(topology.value().face(2).size(), 4u);
}

TEST(Topology, polygons_that_are_all_triangles_are_triangles) {
  const auto a = Topology::polygons(4, {0, 3, 6}, {0, 1, 2, 0, 2, 3});
  const auto b = Topology::triangles(4, {0, 1, 2, 0, 2, 3});
  EXPECT_TRUE(a.value().all_triangles());
  EXPECT_EQ(a.value(), b.value());
}

void expect_refused(const Result<Topology>& topology, const std::string& place, const std::string& words) {
  ASSERT_FALSE(topology.ok());
  EXPECT_EQ(topology.error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(topology.error().place, place);
  EXPECT_NE(topology.error().message.find(words), std::string::npos) << topology.error().message;
}

TEST(Topology, refuses_a_corner_that_names_no_vertex) {
  expect_refused(Topology::triangles(3, {0, 1, 2, 0, 1, 3}), "face 1, corner 2", "vertex 3, but the mesh has 3");
  expect_refused(Topology::triangles(3, {0, 1, 0xFFFFFFFF}), "face 0, corner 2", "4294967295");
}

TEST(Topology, refuses_faces_of_fewer_than_three_corners) {
  expect_refused(Topology::polygons(4, {0, 2, 5}, {0, 1, 1, 2, 3}), "face 0", "three or more");
  expect_refused(Topology::polygons(4, {0, 5, 3, 6}, {0, 1, 2, 1, 2, 3}), "face 1", "three or more");
}

TEST(Topology, refuses_offsets_that_do_not_cover_the_corners) {
  expect_refused(Topology::polygons(4, {0, 3}, {0, 1, 2, 3}), "", "offsets");
  expect_refused(Topology::polygons(4, {}, {}), "", "offsets");
  expect_refused(Topology::triangles(4, {0, 1}), "", "threes");
}

Motion two_frames() {
  Motion motion;
  motion.topology = Topology::triangles(3, {0, 1, 2}).value();
  motion.keyframes = {{{0, 0, 0, 1, 0, 0, 0, 1, 0}, 0, "first.obj"}, {{0, 0, 1, 1, 0, 1, 0, 1, 1}, 1, ""}};
  motion.connect_as_sequence();
  return motion;
}

void expect_invalid(const Motion& motion, const std::string& place, const std::string& words) {
  const Status status = validate(motion);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.error().code, ErrorCode::kInvalidInput);
  EXPECT_EQ(status.error().place, place);
  EXPECT_NE(status.error().message.find(words), std::string::npos) << status.error().message;
}

TEST(Motion, segments_view_their_keyframes) {
  const Motion motion = two_frames();
  ASSERT_TRUE(validate(motion).ok());
  const Segment segment = motion.segment(0);
  EXPECT_EQ(segment.to[1], (Vec3f{1, 0, 1}));
  EXPECT_EQ(segment.from.count, 3u);
  EXPECT_EQ(segment.end_time, 1);
}

TEST(Validate, refuses_what_is_not_finite_and_says_where) {
  Motion motion = two_frames();
  motion.keyframes[0].positions[7] = std::numeric_limits<float>::quiet_NaN();
  expect_invalid(motion, "frame 0 (first.obj), vertex 2", "finite");
  motion = two_frames();
  motion.keyframes[1].positions[0] = std::numeric_limits<float>::infinity();
  expect_invalid(motion, "frame 1, vertex 0", "finite");
}

TEST(Validate, refuses_frames_of_another_size) {
  Motion motion = two_frames();
  motion.keyframes[1].positions.resize(6);
  expect_invalid(motion, "frame 1", "6 coordinates");
}

TEST(Validate, refuses_segments_that_lead_nowhere) {
  Motion motion = two_frames();
  motion.segments[0].to = 2;
  expect_invalid(motion, "segment 0", "does not exist");
  motion = two_frames();
  motion.keyframes[1].time = 0;
  expect_invalid(motion, "segment 0", "time");
  motion.segments.clear();
  expect_invalid(motion, "", "two keyframes");
}

TEST(Validate, refuses_a_mesh_without_faces) { expect_invalid(Motion{}, "", "no faces"); }

}  // namespace
}  // namespace chronormal::motion_test
