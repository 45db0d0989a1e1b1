// Normals of sequences on curved paths for faces, vertices and corners, against positions by the formulas of textbooks.

#include "chronormal/normals/element_paths.h"

#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/support/curved_motion.h"

namespace chronormal::element_paths_test {
namespace {

const std::vector<double> kTimes = {0, 0.2, 0.5, 0.7, 1};

ElementPaths made(Motion motion, ElementKind kind, PathKind path, double crease = 180) {
  ElementPathsOptions options;
  options.elements.kind = kind;
  options.elements.crease_angle = crease;
  options.path = path;
  Result<ElementPaths> paths = ElementPaths::make(std::move(motion), options);
  EXPECT_TRUE(paths.ok()) << paths.error().text();
  return std::move(paths).value();
}

std::vector<float> shown(ElementPaths& paths, double time, Threads threads = Threads::kOne) {
  std::vector<float> normals(3 * paths.size());
  const auto zeros = paths.unit_normals(time, VectorView<float>::packed(normals.data(), paths.size()), threads);
  EXPECT_TRUE(zeros.ok());
  EXPECT_EQ(zeros.value(), 0U);
  return normals;
}

double largest_error(const std::vector<float>& normals, const std::vector<std::array<long double, 3>>& right) {
  double largest = 0;
  for (std::size_t i = 0; i < right.size(); ++i) largest = std::max(largest, test::angle_of(&normals[3 * i], right[i]));
  return largest;
}

TEST(ElementPaths, are_within_their_promise_in_every_segment_in_any_order_of_times) {
  Motion motion = test::curved_motion(kTimes, 1.5);
  for (Motion::Keyframe& key : motion.keyframes)
    for (std::size_t c = 0; c < key.positions.size(); ++c)
      key.velocities.push_back(key.positions[(c + 5) % key.positions.size()]);
  for (const bool given : {false, true}) {
    const PathKind path = given ? PathKind::kHermite : PathKind::kCatmullRom;
    ElementPaths faces = made(motion, ElementKind::kFaces, path), vertices = made(motion, ElementKind::kVertices, path);
    EXPECT_EQ(faces.bytes(), 0U);
    EXPECT_EQ(faces.size(), motion.topology.face_count());
    EXPECT_EQ(vertices.size(), motion.topology.vertex_count());
    for (const auto& [segment, time] : {std::pair{0, 0.05}, {2, 0.6}, {1, 0.2}, {3, 1.0}, {0, 0.0}}) {
      const auto s = static_cast<std::size_t>(segment);
      const long double t = (time - kTimes[s]) / (kTimes[s + 1] - kTimes[s]);
      const auto places = test::on_curve(motion, s, t, given);
      EXPECT_LT(largest_error(shown(faces, time), test::normals_of(motion, places, false)), 1.1 * kPathAngle) << time;
      EXPECT_LT(largest_error(shown(vertices, time), test::normals_of(motion, places, true)), 1.1 * kPathAngle) << time;
      EXPECT_EQ(shown(faces, time), shown(faces, time, Threads::kAll));
    }
    EXPECT_GT(faces.bytes(), 0U);
  }
}

TEST(ElementPaths, show_an_element_at_every_corner_that_has_it) {
  const Motion motion = test::curved_motion(kTimes, 1.5, 12, 6);
  ElementPaths vertices = made(motion, ElementKind::kVertices, PathKind::kCatmullRom),
               smooth = made(motion, ElementKind::kCorners, PathKind::kCatmullRom),
               faces = made(motion, ElementKind::kFaces, PathKind::kCatmullRom),
               hard = made(motion, ElementKind::kCorners, PathKind::kCatmullRom, 0);
  const auto of_vertices = shown(vertices, 0.4), of_smooth = shown(smooth, 0.4), of_faces = shown(faces, 0.4),
             of_hard = shown(hard, 0.4);
  const auto corners = motion.topology.corners();
  ASSERT_EQ(smooth.size(), corners.size());
  for (std::size_t i = 0; i < corners.size(); ++i)
    for (std::size_t c = 0; c < 3; ++c) {
      EXPECT_EQ(of_smooth[3 * i + c], of_vertices[3 * std::size_t{corners[i]} + c]);
      EXPECT_NEAR(of_hard[3 * i + c], of_faces[3 * (i / 3) + c], 2e-6);
    }
}

TEST(ElementPaths, count_what_has_no_normal_at_every_output) {
  Motion motion = test::curved_motion({0, 1, 2}, 0.5, 4, 2);
  for (Motion::Keyframe& key : motion.keyframes) std::fill(key.positions.begin(), key.positions.end(), 1.0F);
  ElementPathsOptions options;
  options.elements.weld = true;
  Result<ElementPaths> paths = ElementPaths::make(motion, options);
  std::vector<float> normals(3 * paths.value().size(), 7);
  const auto zeros = paths.value().unit_normals(0.5, VectorView<float>::packed(normals.data(), paths.value().size()));
  EXPECT_EQ(zeros.value(), motion.topology.vertex_count());
  EXPECT_EQ(normals, std::vector<float>(normals.size(), 0.0F));
}

TEST(ElementPaths, refuse_what_is_no_sequence_and_times_without_motion) {
  Motion motion = test::curved_motion(kTimes, 1.5, 6, 4);
  ElementPathsOptions options;
  options.path = PathKind::kHermite;
  EXPECT_EQ(ElementPaths::make(motion, options).error().code, ErrorCode::kUsage);
  ElementPaths paths = made(motion, ElementKind::kFaces, PathKind::kLinear);
  std::vector<float> normals(3 * paths.size());
  EXPECT_EQ(paths.unit_normals(2, VectorView<float>::packed(normals.data(), paths.size())).error().code,
            ErrorCode::kUsage);
  Motion targets = motion;
  for (std::size_t k = 1; k < targets.keyframes.size(); ++k) targets.keyframes[k].time = 1;
  targets.connect_as_targets();
  options.path = PathKind::kLinear;
  EXPECT_EQ(ElementPaths::make(targets, options).error().code, ErrorCode::kUsage);
  motion.keyframes[1].positions.pop_back();
  EXPECT_EQ(ElementPaths::make(motion, options).error().code, ErrorCode::kInvalidInput);
}

}  // namespace
}  // namespace chronormal::element_paths_test
