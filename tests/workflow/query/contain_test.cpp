// Checks that the crossings of points add up over all segments of whole motions.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "chronormal/analysis/containment.h"
#include "chronormal/workflow/query.h"
#include "tests/support/fixtures.h"
#include "tests/support/read_input.h"

namespace chronormal::contain_test {
namespace {

template <class T>
const std::vector<T>& column(const QueryAnswer& answer, const std::string& table, const std::string& name) {
  for (const QueryTable& of : answer.tables) {
    for (const QueryColumn& one : of.columns)
      if (of.name == table && one.name == name) return std::get<std::vector<T>>(one.values);
  }
  throw std::runtime_error("no column " + name);
}

// Makes points that move on straight lines through the bounding box of the motion.
PointPaths some_paths(const Motion& motion, std::size_t count) {
  std::vector<double> low(3, 1e30), high(3, -1e30);
  for (const Motion::Keyframe& keyframe : motion.keyframes) {
    for (std::size_t i = 0; i < keyframe.positions.size(); ++i) {
      low[i % 3] = std::min(low[i % 3], double{keyframe.positions[i]});
      high[i % 3] = std::max(high[i % 3], double{keyframe.positions[i]});
    }
  }
  fixtures::Random random(20232);
  PointPaths paths;
  for (std::size_t i = 0; i < 3 * count; ++i) {
    paths.from.push_back(random.uniform(low[i % 3], high[i % 3]));
    paths.to.push_back(random.uniform(low[i % 3], high[i % 3]));
  }
  return paths;
}

// Checks that the crossings lead from the points that are inside at the start to the points that are inside at the end.
// A query about the last instants finds the points that are inside at the end.
void expect_sums(const Motion& motion, const PointPaths& paths) {
  const QueryAnswer answer = query_contain(motion, paths).value();
  const auto& points = column<std::int64_t>(answer, "crossing", "point");
  const auto& inward = column<std::uint8_t>(answer, "crossing", "inward");
  const auto& times = column<double>(answer, "crossing", "time");
  const auto& inside = column<std::uint8_t>(answer, "", "inside");
  ASSERT_EQ(inside.size(), paths.count());
  EXPECT_GT(points.size(), paths.count() / 10);
  std::vector<int> winding(inside.begin(), inside.end());  // 0 or 1 at the start, as no mesh intersects itself then
  for (std::size_t i = 0; i < points.size(); ++i) {
    winding[static_cast<std::size_t>(points[i])] += inward[i] != 0 ? 1 : -1;
    if (i > 0 && points[i] == points[i - 1]) {
      EXPECT_LE(times[i - 1], times[i]) << i;
    }
  }
  const Segment last = motion.segment(motion.segments.size() - 1);
  const Containment containment = Containment::make(motion.topology, weld_coincident(motion), last.to).value();
  std::vector<float> ends(paths.to.begin(), paths.to.end());
  const auto at = VectorView<const float>::packed(ends.data(), paths.count());
  const std::vector<std::int32_t> expected = containment.winding_numbers(last, 1, at, at);
  for (std::size_t p = 0; p < winding.size(); ++p) ASSERT_EQ(winding[p], expected[p]) << p;
}

// Makes a double pyramid that tumbles over seven keyframes.
Motion tumbling() {
  Motion motion;
  motion.topology =
      fixtures::make_triangles(6, {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4, 2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5});
  fixtures::Random random(5);
  for (int k = 0; k < 7; ++k) {
    const auto shift = static_cast<float>(k);
    Motion::Keyframe keyframe{{2, 0, 0, -2, 0, 0, 0, 2, 0, 0, -2, 0, 0, 0, 2, 0, 0, -2}, 0.5 * k, {}};
    for (std::size_t i = 0; i < 18; ++i)
      keyframe.positions[i] += (i % 3 == 0 ? shift : 0) + static_cast<float>(random.uniform(-0.5, 0.5));
    motion.keyframes.push_back(keyframe);
  }
  motion.connect_as_sequence();
  return motion;
}

TEST(QueryContain, crossings_of_all_segments_add_up_to_what_is_inside_at_the_end) {
  const Motion motion = tumbling();
  expect_sums(motion, some_paths(motion, 500));
}

TEST(QueryContain, each_target_is_a_motion_of_its_own_by_weight) {
  Motion motion = tumbling();
  motion.keyframes.resize(3);
  for (std::size_t k = 0; k < 3; ++k) motion.keyframes[k].time = k == 0 ? 0 : 1;
  motion.connect_as_targets();
  const PointPaths paths = some_paths(motion, 200);
  const QueryAnswer both = query_contain(motion, paths).value();
  std::size_t count = 0;
  for (std::size_t k = 1; k < 3; ++k) {
    Motion one = motion;
    one.keyframes = {motion.keyframes[0], motion.keyframes[k]};
    one.connect_as_targets();
    count += column<std::int64_t>(query_contain(one, paths).value(), "crossing", "point").size();
  }
  EXPECT_EQ(column<std::int64_t>(both, "crossing", "point").size(), count);
}

// In the PC2 cache, the vertices are in another order than in the OBJ file of the mesh.
TEST(QueryContain, a_cache_by_other_people_keeps_the_sum_over_all_of_its_segments) {
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
  const std::filesystem::path folder = std::filesystem::path(data) / "caches/max_cache_box";
  Motion motion = test::read_motion(test::files({(folder / "max_cache_box.pc2").string(),
                                                 (folder / "max_cache_box_44.obj").string()}))
                      .value();
  std::ifstream permutation(folder / "obj_vertex_to_pc2_point.txt");
  std::vector<std::uint32_t> point_of(motion.topology.vertex_count()), corners;
  for (std::uint32_t& point : point_of) permutation >> point;
  for (const std::uint32_t v : motion.topology.corners()) corners.push_back(point_of[v]);
  motion.topology = fixtures::make_triangles(point_of.size(), std::move(corners));
  expect_sums(motion, some_paths(motion, 2000));
}

}  // namespace
}  // namespace chronormal::contain_test
