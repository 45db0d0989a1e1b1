// Computes in rational numbers when the faces of a whole motion show their front, and compares queries with the result.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <iostream>
#include <variant>
#include <vector>

#include "chronormal/analysis/signs.h"
#include "chronormal/workflow/query.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"

namespace chronormal::query_facing_test {
namespace {

using exact::Rational;

// Returns n . w of a face at local time t of segment s, where w points to the eye. The eye moves from the first to the
// last time of the motion.
Rational front_at(const Motion& motion, std::size_t s, std::size_t face, const View& view, double t) {
  const Segment segment = motion.segment(s);
  exact::Triangle triangle;
  for (std::size_t c = 0; c < 3; ++c) {
    const Vec3f a = segment.from[segment.topology->face(face)[c]], b = segment.to[segment.topology->face(face)[c]];
    triangle.from[c] = exact::vector(a.x, a.y, a.z);
    triangle.to[c] = exact::vector(b.x, b.y, b.z);
  }
  const Rational local(t), first(motion.keyframes.front().time), last(motion.keyframes.back().time),
      start(segment.start_time), end(segment.end_time);
  const Rational on_way = (start + local * (end - start) - first) / (last - first);
  const exact::Vector from = exact::vector(view.from.x, view.from.y, view.from.z),
                      to = exact::vector(view.to.x, view.to.y, view.to.z);
  exact::Vector way;
  for (std::size_t k = 0; k < 3; ++k)
    way[k] =
        from[k] + on_way * (to[k] - from[k]) - triangle.from[0][k] - local * (triangle.to[0][k] - triangle.from[0][k]);
  return exact::dot(exact::normal_at(triangle, local), way);
}

TEST(QueryFacing, every_change_lies_in_its_bracket_for_the_eye_that_was_asked_for) {
  constexpr std::uint64_t kSeed = 20261129;
  std::cout << "  from seed " << kSeed << '\n';
  fixtures::Random random(kSeed);
  std::size_t changes = 0;
  for (int i = 0; i < 40; ++i) {
    // Every second motion is slow, so n . w changes little in a segment and the brackets of zeros must be narrowed.
    const bool is_slow = i % 2 == 0;
    const std::size_t face_count = is_slow ? 3000 : 40;
    Motion motion = fixtures::large_soup(face_count, static_cast<std::uint64_t>(i));
    const Motion more = fixtures::large_soup(face_count, static_cast<std::uint64_t>(i) + 1000);
    for (const auto& keyframe : more.keyframes) motion.keyframes.push_back(keyframe);
    for (std::size_t k = 1; k < motion.keyframes.size() && is_slow; ++k)
      for (std::size_t c = 0; c < motion.keyframes[k].positions.size(); ++c)
        motion.keyframes[k].positions[c] = motion.keyframes[0].positions[c] + 1e-3F * motion.keyframes[k].positions[c];
    double time = 0;
    for (auto& keyframe : motion.keyframes) keyframe.time = time += 1 + static_cast<double>(random.below(9));
    motion.connect_as_sequence();
    const auto point = [&random, i] {
      const auto p = random.in_cube(i % 4 == 0 ? 1e4 : 3);
      return Vec3d{p[0], p[1], p[2]};
    };
    const Vec3d from = point();
    const Vec3d to = is_slow ? from + 1e-3 * point() : point();
    const View view = i % 3 == 0 ? View::of_eye(from) : View::of_moving_eye(from, to);
    const QueryAnswer answer = query_facing(motion, view, false, {}).value();
    const auto column = [&answer](const char* name) {
      for (const QueryColumn& one : answer.tables[0].columns)
        if (one.name == name) return one;
      return QueryColumn{};
    };
    const auto segments = std::get<std::vector<std::int64_t>>(column("segment").values),
               faces = std::get<std::vector<std::int64_t>>(column("face").values);
    for (const auto& [lower, upper] : {std::array{"from", "from_upper"}, std::array{"to_lower", "to"}}) {
      const auto low = std::get<std::vector<double>>(column(lower).values),
                 high = std::get<std::vector<double>>(column(upper).values);
      for (std::size_t r = 0; r < low.size(); ++r) {
        if (low[r] == high[r]) continue;
        const auto f = [&](double t) {
          return sgn(
              front_at(motion, static_cast<std::size_t>(segments[r]), static_cast<std::size_t>(faces[r]), view, t));
        };
        EXPECT_LT(f(low[r]) * f(high[r]), 0) << "motion " << i << ", row " << r;
        EXPECT_LE(high[r] - low[r], kWidestBracket);
        ++changes;
      }
    }
  }
  std::cout << "  " << changes << " changes\n";
  EXPECT_GT(changes, 1000u);
}

}  // namespace
}  // namespace chronormal::query_facing_test
