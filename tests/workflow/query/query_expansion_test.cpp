// Checks the limit on the results of queries, whose size is not known in advance. A query must stop while its results
// grow beyond the limit, and not only when all rows are in memory.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/workflow/query.h"
#include "io/bytes/expansion.h"
#include "tests/support/fixtures.h"

namespace chronormal::query_expansion_test {
namespace {

using fixtures::Point;

constexpr std::size_t kSegments = 400;

// Makes a motion that goes back and forth between two shapes many times.
Motion to_and_fro(Topology topology, const std::vector<Point>& from, const std::vector<Point>& to) {
  Motion motion = fixtures::make_motion(std::move(topology), from, to);
  for (std::size_t k = 2; k <= kSegments; ++k) {
    motion.keyframes.push_back(motion.keyframes[k - 2]);
    motion.keyframes.back().time = static_cast<double>(k);
    motion.segments.push_back({static_cast<std::uint32_t>(k - 1), static_cast<std::uint32_t>(k)});
  }
  return motion;
}

// Makes a strip of random triangles in a plane. Each triangle turns over in every segment, and collapses to a line on
// the way. Every segment therefore has a collapse and a change of side for every triangle.
Motion turning_triangles() {
  constexpr std::size_t kFaces = 4'000;
  fixtures::Random random(20261125);
  std::vector<Point> from, to;
  std::vector<std::uint32_t> corners;
  for (std::uint32_t f = 0; f < kFaces; ++f) corners.insert(corners.end(), {f, f + 1, f + 2});
  for (std::size_t v = 0; v < kFaces + 2; ++v) {
    const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
    from.push_back({x, y, 0});
    to.push_back({x, -0.75 * y, 0});
  }
  return to_and_fro(fixtures::make_triangles(from.size(), std::move(corners)), from, to);
}

// Makes a tetrahedron that moves through the unit cube.
Motion sweeping_tetrahedron() {
  const std::vector<Point> from{{-2, -9, -9}, {-2, 20, -9}, {-2, -9, 20}, {-1, 0.5, 0.5}};
  std::vector<Point> to = from;
  for (Point& point : to) point[0] += 5;
  return to_and_fro(fixtures::make_triangles(4, {0, 1, 2, 0, 3, 1, 1, 3, 2, 2, 3, 0}), from, to);
}

// Calls ask(span, progress) with the usual limit and without a limit. With the limit, the query must end long before
// the last segment, with an error that names --max-expansion. Without a limit, the query must find more rows than the
// limit permits.
template <class Ask>
void expect_bounded(const Ask& ask) {
  QuerySpan span;
  std::size_t last = 0;
  const QueryProgress progress = [&last](std::size_t done, std::size_t) { last = done; };
  const Expansion allowed;
  span.expansion = &allowed;
  const Result<QueryAnswer> bounded = ask(span, progress);
  ASSERT_FALSE(bounded);
  EXPECT_EQ(bounded.error().code, ErrorCode::kInvalidInput);
  EXPECT_NE(bounded.error().text().find(" of 400 segments: "), std::string::npos) << bounded.error().text();
  EXPECT_NE(bounded.error().text().find("--max-expansion"), std::string::npos) << bounded.error().text();
  EXPECT_GT(last, 0);
  EXPECT_LT(last, kSegments / 2);

  // The query ended after `last` segments. The results of these segments must be within the limit, and more than 9/10
  // of it, so the query did not stop too early.
  span.to = static_cast<double>(last);
  const Result<QueryAnswer> within = ask(span, {});
  ASSERT_TRUE(within) << within.error().text();
  EXPECT_LE(bytes_of_query(within.value()), Expansion::kAlways);
  EXPECT_GT(bytes_of_query(within.value()), Expansion::kAlways * 9 / 10);
}

TEST(QueryExpansion, bounds_collapses_while_they_are_found) {
  const Motion motion = turning_triangles();
  expect_bounded(
      [&](const QuerySpan& span, const QueryProgress& progress) { return query_collapse(motion, span, progress); });
}

TEST(QueryExpansion, bounds_fronts_while_they_are_found) {
  const Motion motion = turning_triangles();
  const View view{false, {0, 0, 1}, {0, 0, 1}};
  expect_bounded([&](const QuerySpan& span, const QueryProgress& progress) {
    return query_facing(motion, view, false, span, progress);
  });
}

TEST(QueryExpansion, bounds_silhouettes_while_they_are_found) {
  const Motion motion = turning_triangles();
  const View view{false, {0, 0, 1}, {0, 0, 1}};
  expect_bounded([&](const QuerySpan& span, const QueryProgress& progress) {
    return query_facing(motion, view, true, span, progress);
  });
}

TEST(QueryExpansion, bounds_crossings_while_they_are_found) {
  const Motion motion = sweeping_tetrahedron();
  fixtures::Random random(4711);
  PointPaths points;
  for (std::size_t i = 0; i < 3 * 2'000; ++i) points.from.push_back(random.uniform(0, 1));
  points.to = points.from;
  expect_bounded([&](const QuerySpan& span, const QueryProgress& progress) {
    return query_contain(motion, points, span, progress);
  });
}

}  // namespace
}  // namespace chronormal::query_expansion_test
