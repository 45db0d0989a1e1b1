// Compares queries about the normals of vertices and corners with results that are computed in integers of any size,
// and with sums over many times.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <string>
#include <variant>
#include <vector>

#include "chronormal/analysis/signs.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/workflow/query.h"
#include "tests/support/fixtures.h"
#include "tests/support/whole_polynomial.h"

namespace chronormal::query_vertices_test {
namespace {

using test::Whole;
using test::WholePolynomial;
using test::WholeVector;

constexpr std::uint64_t kSeed = 20261127;
constexpr std::uint32_t kSide = 4;  // number of vertices along a side

// Makes a sheet of quads and triangles with three keyframes. The coordinates are small integers, so all exact
// coincidences occur: normals of faces that cancel, normals that are seen edge-on at a keyframe, and vertices at the
// eye. Two vertices coincide.
Motion small_sheet(fixtures::Random& random, int reach) {
  Motion motion;
  std::vector<std::uint32_t> offsets = {0}, corners;
  for (std::uint32_t y = 0; y + 1 < kSide; ++y) {
    for (std::uint32_t x = 0; x + 1 < kSide; ++x) {
      const std::uint32_t v = y * kSide + x;
      if (random.below(2) == 0) {
        corners.insert(corners.end(), {v, v + 1, v + kSide + 1, v + kSide});
        offsets.push_back(static_cast<std::uint32_t>(corners.size()));
        continue;
      }
      for (const std::uint32_t corner : {v, v + 1, v + kSide, v + 1, v + kSide + 1, v + kSide}) {
        corners.push_back(corner);
        if ((corners.size() - offsets.back()) == 3) offsets.push_back(static_cast<std::uint32_t>(corners.size()));
      }
    }
  }
  motion.topology = Topology::polygons(kSide * kSide + 1, offsets, corners).value();  // no face uses the last vertex
  for (int k = 0; k < 3; ++k) {
    Motion::Keyframe keyframe;
    keyframe.time = k;
    for (std::uint32_t c = 0; c < 3 * (kSide * kSide + 1); ++c)
      keyframe.positions.push_back(
          static_cast<float>(static_cast<int>(random.below(2 * std::size_t(reach) + 1)) - reach));
    for (std::uint32_t c = 0; c < 3; ++c) keyframe.positions[c] = keyframe.positions[3 * (kSide * kSide - 1) + c];
    motion.keyframes.push_back(keyframe);
  }
  motion.connect_as_sequence();
  return motion;
}

ElementOptions options_of(ElementKind kind) {
  ElementOptions options;
  options.kind = kind;
  options.weld = kind == ElementKind::kVertices;
  return options;
}

std::vector<std::int64_t> integers(const QueryTable& table, const std::string& name) {
  for (const QueryColumn& column : table.columns)
    if (column.name == name) return std::get<std::vector<std::int64_t>>(column.values);
  ADD_FAILURE() << "no column " << name;
  return {};
}
std::vector<double> numbers(const QueryTable& table, const std::string& name) {
  for (const QueryColumn& column : table.columns)
    if (column.name == name) return std::get<std::vector<double>>(column.values);
  ADD_FAILURE() << "no column " << name;
  return {};
}

// A vertex, a corner or a face, together with the faces whose normals add up to its normal. The faces are found from
// coordinates alone. A vertex has all faces with a vertex at the same point in all keyframes. A corner has only the
// faces at its vertex, since fans of corners that touch in a point are separate.
struct Output {
  std::uint32_t vertex = 0;
  std::vector<std::uint32_t> faces;
};
std::vector<Output> outputs_of(const Motion& motion, ElementKind kind) {
  const auto is_one_point = [&motion](std::uint32_t a, std::uint32_t b) {
    for (const auto& keyframe : motion.keyframes)
      for (std::size_t c = 0; c < 3; ++c)
        if (keyframe.positions[3 * a + c] != keyframe.positions[3 * b + c]) return false;
    return true;
  };
  std::vector<Output> outputs;
  const auto add = [&](std::uint32_t vertex) {
    Output output{vertex, {}};
    for (std::uint32_t f = 0; f < motion.topology.face_count(); ++f)
      for (const std::uint32_t corner : motion.topology.face(f))
        if (kind == ElementKind::kVertices ? is_one_point(corner, vertex) : corner == vertex) output.faces.push_back(f);
    outputs.push_back(output);
  };
  if (kind == ElementKind::kFaces)
    for (std::uint32_t f = 0; f < motion.topology.face_count(); ++f) outputs.push_back({0, {f}});
  else if (kind == ElementKind::kVertices)
    for (std::uint32_t v = 0; v < motion.topology.vertex_count(); ++v) add(v);
  else
    for (const std::uint32_t v : motion.topology.corners()) add(v);
  return outputs;
}

// Returns n . w of a vertex or corner in a segment as a polynomial that is multiplied by a positive number. The eye is
// at integer positions and moves over both segments.
WholePolynomial facing_polynomial(const Segment& segment, const Output& output, const View& view) {
  std::array<Whole, 4> values;
  for (long t = -1; t <= 2; ++t) {
    WholeVector normal;
    for (const std::uint32_t face : output.faces) {
      const WholeVector one = test::whole_normal(segment, segment.topology->face(face), t);
      for (std::size_t k = 0; k < 3; ++k) normal[k] += one[k];
    }
    const auto whole = [](const Vec3d& v) {
      return test::whole(Vec3f{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)});
    };
    const WholeVector from = whole(view.from), to = whole(view.to);
    const WholeVector place =
        test::on_line(test::whole(segment.from[output.vertex]), test::whole(segment.to[output.vertex]), t);
    WholeVector way;
    for (std::size_t k = 0; k < 3; ++k) {
      const Whole moved = 2 * from[k] + (static_cast<long>(segment.index) + t) * (to[k] - from[k]);
      way[k] = view.is_eye ? Whole(moved - 2 * place[k]) : from[k];
    }
    values[static_cast<std::size_t>(t + 1)] = test::dot_of(normal, way);
  }
  return WholePolynomial::through(values[0], values[1], values[2], values[3]);
}

TEST(QueryVertices, sides_are_those_of_whole_numbers_at_every_instant) {
  std::cout << "  from seed " << kSeed << '\n';
  fixtures::Random random(kSeed);
  std::size_t intervals = 0, edge_on = 0, touching = 0;
  for (int i = 0; i < 60; ++i) {
    const ElementKind kind = i % 3 == 2 ? ElementKind::kCorners : ElementKind::kVertices;
    const int reach = i % 2 == 0 ? 2 : 1000;
    const Motion motion = small_sheet(random, reach);
    const auto point = [&] {
      const auto one = [&] {
        return static_cast<double>(static_cast<int>(random.below(2 * std::size_t(reach) + 1)) - reach);
      };
      return Vec3d{one(), one(), one()};
    };
    Vec3d direction = point();
    if (direction == Vec3d{}) direction = {0, 0, 1};
    const Vec3d eye = point();
    const View view = i % 4 == 0   ? View::of_direction(direction)
                      : i % 4 == 1 ? View::of_eye(eye)
                                   : View::of_moving_eye(eye, point());
    const QueryAnswer answer = query_facing(motion, view, false, {}, {}, options_of(kind)).value();
    const QueryTable& table = answer.tables[0];
    const auto segments = integers(table, "segment"), rows = integers(table, std::string(one_element(kind)));
    const auto from = numbers(table, "from"), from_upper = numbers(table, "from_upper"),
               to_lower = numbers(table, "to_lower"), to = numbers(table, "to");
    const std::vector<Output> outputs = outputs_of(motion, kind);
    for (std::size_t s = 0; s < 2; ++s) {
      for (std::size_t o = 0; o < outputs.size(); ++o) {
        const WholePolynomial f = facing_polynomial(motion.segment(s), outputs[o], view);
        std::vector<std::size_t> own;
        for (std::size_t r = 0; r < rows.size(); ++r)
          if (std::size_t(segments[r]) == s && std::size_t(rows[r]) == o) own.push_back(r);
        if (outputs[o].faces.empty() || f.is_zero()) {
          EXPECT_TRUE(own.empty());
          ++edge_on;
          continue;
        }
        intervals += own.size();
        std::vector<double> instants;
        for (int k = 0; k <= 32; ++k) instants.push_back(k / 32.0);
        for (const std::size_t r : own) {
          instants.insert(instants.end(), {from[r], from_upper[r], to_lower[r], to[r]});
          for (const auto& [low, high] : {std::pair{from[r], from_upper[r]}, std::pair{to_lower[r], to[r]}}) {
            EXPECT_LE(high - low, kWidestBracket);
            if (low > 0) instants.push_back(std::nextafter(low, 0));
            if (high < 1) instants.push_back(std::nextafter(high, 1));
            const bool is_inside = 0 < high && low < 1;  // the bracket overlaps the segment
            if (is_inside && low < high) {
              EXPECT_GE(f.count_roots(low, high), 1U);
            }
            if (is_inside && low == high) {
              EXPECT_EQ(f.sign_at(low), 0);
            }
          }
        }
        for (const double t : instants) {
          const int sign = f.sign_at(t);
          touching += sign == 0 ? 1U : 0U;
          bool is_front = false, may_be_front = false;
          for (const std::size_t r : own) {
            is_front |= from_upper[r] < t && t < to_lower[r];
            may_be_front |= from[r] <= t && t <= to[r];
          }
          EXPECT_TRUE(sign <= 0 || may_be_front) << "motion " << i << ", output " << o << ", t = " << t;
          EXPECT_TRUE(sign >= 0 || !is_front) << "motion " << i << ", output " << o << ", t = " << t;
        }
      }
    }
  }
  std::cout << "  " << intervals << " intervals, " << edge_on << " without a side, " << touching
            << " instants edge-on\n";
  EXPECT_GT(intervals, 1000U);
  EXPECT_GT(edge_on, 50U);
  EXPECT_GT(touching, 100U);
}

// Returns n(t) of a vertex or corner, from positions in long double.
std::array<long double, 3> normal_at(const Segment& segment, const Output& output, long double t) {
  std::array<long double, 3> sum{};
  for (const std::uint32_t face : output.faces) {
    const auto vertices = segment.topology->face(face);
    const auto corner = [&](std::size_t c) {
      const Vec3f p = segment.from[vertices[c]], q = segment.to[vertices[c]];
      return std::array<long double, 3>{(1 - t) * p.x + t * q.x, (1 - t) * p.y + t * q.y, (1 - t) * p.z + t * q.z};
    };
    for (std::size_t c = 2; c < vertices.size(); ++c) {
      const auto a = corner(0), b = corner(c - 1), d = corner(c);
      for (std::size_t k = 0; k < 3; ++k) {
        const std::size_t l = (k + 1) % 3, m = (k + 2) % 3;
        sum[k] += (b[l] - a[l]) * (d[m] - a[m]) - (b[m] - a[m]) * (d[l] - a[l]);
      }
    }
  }
  return sum;
}

TEST(QueryVertices, means_over_a_shutter_are_those_of_dense_sums) {
  std::cout << "  from seed " << kSeed + 1 << '\n';
  fixtures::Random random(kSeed + 1);
  std::size_t held = 0;
  for (int i = 0; i < 12; ++i) {
    const ElementKind kind = i % 3 == 2 ? ElementKind::kCorners : ElementKind::kVertices;
    const Motion motion = small_sheet(random, i % 2 == 0 ? 3 : 1000);
    const double t0 = i % 4 == 0 ? 0 : 0.25, t1 = i % 4 == 0 ? 1 : 0.75;
    QuerySpan span;
    span.from = t0;
    span.to = t1;
    const QueryAnswer answer = query_shutter(motion, span, {}, options_of(kind)).value();
    const QueryTable& table = answer.tables[0];
    const auto rows = integers(table, std::string(one_element(kind))), segments = integers(table, "segment");
    const auto mean = numbers(table, "mean"), mean_unit = numbers(table, "mean_unit"), error = numbers(table, "error"),
               half_angle = numbers(table, "half_angle");
    const std::vector<Output> outputs = outputs_of(motion, kind);
    ASSERT_EQ(rows.size(), outputs.size());
    const Segment segment = motion.segment(0);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      EXPECT_EQ(segments[r], 0);
      const Output& output = outputs[std::size_t(rows[r])];
      // Simpson's rule is exact for the mean of n(t). For the mean of the unit normal, the rule is accurate only if
      // n(t) does not come close to zero.
      constexpr int kParts = 4000;
      std::array<long double, 3> sum{}, unit_sum{};
      long double shortest = 1e30L, longest = 0;
      for (int k = 0; k <= kParts; ++k) {
        const long double share = static_cast<long double>(k) / kParts;
        const auto n = normal_at(segment, output, t0 + share * (t1 - t0));
        const long double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        shortest = std::min(shortest, length);
        longest = std::max(longest, length);
        const long double weight = (k == 0 || k == kParts ? 1 : k % 2 == 0 ? 2 : 4) / (3.0L * kParts);
        for (std::size_t c = 0; c < 3; ++c) {
          sum[c] += weight * n[c];
          unit_sum[c] += length > 0 ? weight * n[c] / length : 0;
        }
      }
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(mean[3 * r + c], double(sum[c]), 1e-12 * double(longest)) << "motion " << i << ", row " << r;
      if (output.faces.empty() || shortest < 0.05L * longest) continue;
      ++held;
      EXPECT_LT(error[r], 1e-5);
      for (std::size_t c = 0; c < 3; ++c)
        EXPECT_NEAR(mean_unit[3 * r + c], double(unit_sum[c]), error[r] + 1e-9) << "motion " << i << ", row " << r;
      EXPECT_GT(half_angle[r], 0) << "a cone of normals that differ";
    }
  }
  std::cout << "  " << held << " means of unit normals\n";
  EXPECT_GT(held, 60U);
}

using Direction = std::array<long double, 3>;

Direction unit_of(const Direction& n) {
  const long double length = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
  return {n[0] / length, n[1] / length, n[2] / length};
}
long double degrees_between(const Direction& a, const Direction& b) {
  const Direction u = unit_of(a), v = unit_of(b);
  long double sum = 0, difference = 0;
  for (std::size_t c = 0; c < 3; ++c) {
    sum += (u[c] + v[c]) * (u[c] + v[c]);
    difference += (u[c] - v[c]) * (u[c] - v[c]);
  }
  return 2 * std::atan2(std::sqrt(difference), std::sqrt(sum)) * 57.295779513082320877L;
}

// Tests a shutter that is open from a time in the first segment to a time in the second segment: the bisector of the
// normals at the ends, and the cones, for the part in each segment and for the whole time.
TEST(QueryVertices, ends_and_cones_of_a_shutter_are_those_of_the_normals_that_it_sees) {
  std::cout << "  from seed " << kSeed + 3 << '\n';
  fixtures::Random random(kSeed + 3);
  std::size_t judged = 0;
  for (int i = 0; i < 18; ++i) {
    const ElementKind kind = i % 3 == 0   ? ElementKind::kFaces
                             : i % 3 == 1 ? ElementKind::kVertices
                                          : ElementKind::kCorners;
    const Motion motion = small_sheet(random, i % 2 == 0 ? 3 : 1000);
    const double first = static_cast<double>(random.below(4)) / 4,
                 last = 1.25 + static_cast<double>(random.below(4)) / 4;
    QuerySpan span;
    span.from = first;
    span.to = last;
    const QueryAnswer answer = query_shutter(motion, span, {}, options_of(kind)).value();
    const std::vector<Output> outputs = outputs_of(motion, kind);
    ASSERT_EQ(answer.tables.size(), 2U);
    // Tests the rows of a table after the first `skipped` rows. The tested rows have one row for each output, in order.
    const auto test_rows = [&](const QueryTable& table, std::size_t skipped, double from, double to) {
      const auto mean = numbers(table, "mean"), mean_unit = numbers(table, "mean_unit"), ends = numbers(table, "ends"),
                 off = numbers(table, "ends_off"), half_angle = numbers(table, "half_angle");
      ASSERT_GE(off.size(), skipped + outputs.size());
      for (std::size_t o = 0; o < outputs.size(); ++o) {
        if (outputs[o].faces.empty()) continue;
        const std::size_t row = skipped + o;
        const auto at = [&](std::size_t k, long double time) {
          return normal_at(motion.segment(k), outputs[o], time - static_cast<long double>(k));
        };
        // Simpson's rule is exact in each segment, where n(t) is quadratic.
        Direction sum{};
        long double longest = 0;
        std::vector<Direction> seen;
        for (const std::size_t k : {0U, 1U}) {
          const long double start = std::max<long double>(from, k), end = std::min<long double>(to, k + 1.0L);
          if (start >= end) continue;
          for (const long double share : {0.0L, 0.25L, 0.5L, 0.75L, 1.0L}) {
            seen.push_back(at(k, start + share * (end - start)));
            const long double weight = share == 0.5L ? 4 : share == 0 || share == 1 ? 1 : 0;
            for (std::size_t c = 0; c < 3; ++c) {
              sum[c] += weight / 6 * (end - start) / (to - from) * seen.back()[c];
              longest = std::max(longest, std::fabs(seen.back()[c]));
            }
          }
        }
        for (std::size_t c = 0; c < 3; ++c)
          EXPECT_NEAR(mean[3 * row + c], double(sum[c]), 1e-12 * double(longest)) << "motion " << i << ", row " << row;
        const auto is_zero = [](const Direction& n) { return n == Direction{}; };
        if (std::any_of(seen.begin(), seen.end(), is_zero)) continue;
        for (const Direction& n : seen)
          EXPECT_LE(double(degrees_between(n, seen[0])), 2 * half_angle[row] + 1e-9)
              << "motion " << i << ", row " << row;
        if (degrees_between(seen.front(), seen.back()) > 175) continue;  // the bisector is not certain
        ++judged;
        const Direction a = unit_of(seen.front()), b = unit_of(seen.back());
        const Direction between = unit_of({a[0] + b[0], a[1] + b[1], a[2] + b[2]});
        for (std::size_t c = 0; c < 3; ++c)
          EXPECT_NEAR(ends[3 * row + c], double(between[c]), 1e-9) << "motion " << i << ", row " << row;
        const Direction average = {mean_unit[3 * row], mean_unit[3 * row + 1], mean_unit[3 * row + 2]};
        EXPECT_NEAR(off[row], double(degrees_between(average, between)), 1e-6) << "motion " << i << ", row " << row;
      }
    };
    test_rows(answer.tables[0], 0, first, 1);
    test_rows(answer.tables[0], outputs.size(), 1, last);
    test_rows(answer.tables[1], 0, first, last);
  }
  std::cout << "  " << judged << " bisectors\n";
  EXPECT_GT(judged, 500U);
}

TEST(QueryVertices, silhouettes_are_of_faces_and_a_vertex_without_a_face_has_no_row) {
  fixtures::Random random(kSeed + 2);
  const Motion motion = small_sheet(random, 3);
  const auto refused =
      query_facing(motion, View::of_direction({0, 0, 1}), true, {}, {}, options_of(ElementKind::kVertices));
  ASSERT_FALSE(refused.ok());
  EXPECT_EQ(refused.error().place, "--silhouettes");
  const QueryAnswer answer =
      query_facing(motion, View::of_direction({0, 0, 1}), false, {}, {}, options_of(ElementKind::kVertices)).value();
  EXPECT_EQ(answer.facts[1].name, "vertices");
  EXPECT_EQ(answer.facts[1].value, kSide * kSide);
}

}  // namespace
}  // namespace chronormal::query_vertices_test
