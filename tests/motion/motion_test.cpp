// Tests topologies, motions, the validation of data from outside, and the search for the segment of a time.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <limits>
#include <random>
#include <utility>

#include "chronormal/motion/motion.h"

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
  expect_refused(Topology::triangles(3, {0, 1, 2, 0, 1, 3}), "face 1, corner 2", "vertex 3, but the mesh has only 3");
  expect_refused(Topology::triangles(3, {0, 1, 0xFFFFFFFF}), "face 0, corner 2", "4294967295");
}

TEST(Topology, refuses_faces_of_fewer_than_three_corners) {
  expect_refused(Topology::polygons(4, {0, 2, 5}, {0, 1, 1, 2, 3}), "face 0", "at least three corners");
  expect_refused(Topology::polygons(4, {0, 5, 3, 6}, {0, 1, 2, 1, 2, 3}), "face 1", "at least three corners");
}

TEST(Topology, refuses_offsets_that_do_not_cover_the_corners) {
  expect_refused(Topology::polygons(4, {0, 3}, {0, 1, 2, 3}), "", "offsets");
  expect_refused(Topology::polygons(4, {}, {}), "", "offsets");
  expect_refused(Topology::triangles(4, {0, 1}), "", "multiple of 3");
}

TEST(Topology, refuses_more_vertices_than_32_bits_can_name) {
  if constexpr (sizeof(std::size_t) > 4) {
    expect_refused(Topology::triangles(static_cast<std::size_t>(std::uint64_t{1} << 32), {0, 1, 2}), "",
                   "more than 4,294,967,295 vertices or corners");
  }
  EXPECT_TRUE(Topology::triangles(0xFFFFFFFF, {0, 1, 2}).ok());
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
  motion = two_frames();
  motion.keyframes[1].time = std::numeric_limits<double>::infinity();
  expect_invalid(motion, "frame 1", "the time is NaN or infinite; times must be finite numbers");
}

TEST(Validate, refuses_frames_of_another_size) {
  Motion motion = two_frames();
  motion.keyframes[1].positions.resize(6);
  expect_invalid(motion, "frame 1", "6 coordinates");
}

TEST(Validate, refuses_bodies_of_another_number_of_vertices) {
  Motion motion = two_frames();
  motion.body_of_vertex = {0, 0};
  expect_invalid(motion, "",
                 "the list of bodies has 2 entries, but the mesh has 3 vertices; give one entry for each vertex");
}

TEST(Validate, refuses_segments_that_lead_nowhere) {
  Motion motion = two_frames();
  motion.segments[0].to = 2;
  expect_invalid(motion, "segment 0", "does not exist");
  motion = two_frames();
  motion.keyframes[1].time = 0;
  expect_invalid(motion, "segment 0", "must be later");
  motion.segments.clear();
  expect_invalid(motion, "", "two keyframes");
}

// Makes a motion with keyframes at 2 s, 3 s and 5 s.
Motion three_keyframes() {
  Motion motion = two_frames();
  motion.keyframes.push_back(motion.keyframes.back());
  for (std::size_t k = 0; k < 3; ++k) motion.keyframes[k].time = std::array{2, 3, 5}[k];
  motion.connect_as_sequence();
  return motion;
}

TEST(FindInstant, keyframe_belongs_to_the_segment_that_begins_there) {
  const Motion motion = three_keyframes();
  const auto at = [&motion](double time) {
    const Instant instant = find_instant(motion, time).value();
    return std::pair{instant.segment, instant.t.t};
  };
  EXPECT_EQ(at(2), (std::pair<std::size_t, double>{0, 0}));
  EXPECT_EQ(at(2.25), (std::pair<std::size_t, double>{0, 0.25}));
  EXPECT_EQ(at(3), (std::pair<std::size_t, double>{1, 0}));
  EXPECT_EQ(at(4), (std::pair<std::size_t, double>{1, 0.5}));
  EXPECT_EQ(at(5), (std::pair<std::size_t, double>{1, 1}));
}

TEST(FindInstant, a_decimal_means_the_keyframe_that_float32_stores) {
  constexpr unsigned kSeed = 1132;
  std::cout << "  seed " << kSeed << "\n";
  std::mt19937 random(kSeed);
  for (int i = 0; i < 300; ++i) {
    Motion motion = three_keyframes();
    const int steps = 1 + static_cast<int>(random() % 40);
    const double step = std::array{0.1, 0.04, 0.001}[random() % 3], first = step * steps, last = first + 7 * step;
    motion.keyframes[0].time = 0;
    motion.keyframes[1].time = static_cast<double>(static_cast<float>(first));
    motion.keyframes[2].time = static_cast<double>(static_cast<float>(last));
    const Result<Instant> middle = find_instant(motion, first), end = find_instant(motion, last);
    ASSERT_TRUE(middle.ok() && end.ok()) << first << " and " << last;
    EXPECT_EQ(middle.value().segment, 1U) << first;
    EXPECT_EQ(middle.value().t.t, 0) << first;
    EXPECT_EQ(end.value().t.t, 1) << last;
    // Another time that is as near stays what it is.
    const double near = motion.keyframes[1].time * (1 + 0x1p-26);
    if (std::fabs(near - first) > 1e-12) {
      EXPECT_NE(time_of_keyframe_at(motion, near), motion.keyframes[1].time) << first;
    }
  }
}

TEST(FindInstant, time_without_motion_is_a_usage_error_with_the_range) {
  const Motion motion = three_keyframes();
  for (const double time : {1.999, 5.001, -3.0, std::nan("")}) {
    const auto instant = find_instant(motion, time);
    ASSERT_FALSE(instant.ok()) << time;
    EXPECT_EQ(instant.error().code, ErrorCode::kUsage);
    EXPECT_NE(instant.error().message.find("from 2 to 5"), std::string::npos) << instant.error().message;
  }
  Motion gap = motion;
  gap.keyframes.push_back(gap.keyframes.back());
  gap.keyframes[2].time = 4;
  gap.keyframes.push_back(gap.keyframes.back());
  gap.keyframes[4].time = 7;
  gap.segments = {{0, 1}, {3, 4}};
  EXPECT_TRUE(find_instant(gap, 6).ok());
  EXPECT_FALSE(find_instant(gap, 3.5).ok());
}

TEST(FindInstant, blend_shapes_and_still_meshes_have_no_times) {
  Motion star = three_keyframes();
  star.connect_as_targets();
  EXPECT_EQ(find_instant(star, 2.5).error().code, ErrorCode::kUsage);
  Motion still = three_keyframes();
  still.segments.clear();
  EXPECT_EQ(find_instant(still, 2).error().code, ErrorCode::kUsage);
}

TEST(Motion, kinds_make_segments_of_keyframes) {
  Motion motion = three_keyframes();
  EXPECT_EQ(motion.kind, MotionKind::kSequence);
  motion.connect_as_targets();
  EXPECT_EQ(motion.kind, MotionKind::kTargets);
  ASSERT_EQ(motion.segments.size(), 2U);
  EXPECT_EQ(motion.segments[1].from, 0U);
  EXPECT_EQ(motion.segments[1].to, 2U);
  // Between two keyframes at the same time, the animation jumps.
  motion.keyframes.push_back(motion.keyframes.back());
  motion.keyframes[1].time = motion.keyframes[2].time = 3;
  motion.connect(MotionKind::kAnimation);
  ASSERT_EQ(motion.segments.size(), 2U);
  EXPECT_EQ(motion.segments[1].from, 2U);
  EXPECT_TRUE(validate(motion).ok());
}

TEST(Validate, refuses_segments_that_the_kind_does_not_have) {
  Motion motion = three_keyframes();
  motion.segments = {{0, 1}, {0, 2}};
  expect_invalid(motion, "segment 1", "from keyframe k to keyframe k + 1");
  motion.kind = MotionKind::kTargets;
  EXPECT_TRUE(validate(motion).ok());
  motion.connect_as_sequence();
  motion.kind = MotionKind::kTargets;
  expect_invalid(motion, "segment 1", "from keyframe 0 to keyframe k + 1");
  motion.segments = {{0, 1}};
  expect_invalid(motion, "", "1 segment, but must have one fewer than its 3 keyframes");
  motion.kind = MotionKind::kAnimation;
  motion.segments = {{0, 2}};
  expect_invalid(motion, "segment 0", "from a keyframe k to keyframe k + 1");
}

TEST(Validate, refuses_a_mesh_without_faces) { expect_invalid(Motion{}, "", "no faces"); }

}  // namespace
}  // namespace chronormal::motion_test
