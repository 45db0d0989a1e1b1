// Compares normals between keyframes with the normals of keyframes that were left out, for motions whose true normals
// are known. The test computes the expected figures from positions alone. Also tests requests that are refused.
#include "chronormal/workflow/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "chronormal/io/input.h"

namespace chronormal::truth_test {
namespace {

constexpr double kPi = 3.14159265358979323846;

// Makes a round body at these times. Because of bumps, all normals are different. The body has more than one block of
// elements.
Motion body_at(const std::vector<double>& times, const std::function<Vec3d(const Vec3d&, double)>& moved) {
  constexpr std::size_t kAround = 48, kUp = 24;
  std::vector<Vec3d> places;
  std::vector<std::uint32_t> corners;
  for (std::size_t i = 0; i <= kUp; ++i) {
    for (std::size_t j = 0; j < kAround; ++j) {
      const double up = kPi * (0.1 + 0.8 * static_cast<double>(i) / kUp),
                   around = 2 * kPi * static_cast<double>(j) / kAround;
      const double radius = 1 + 0.2 * std::cos(3 * around + up);
      places.push_back(
          {radius * std::sin(up) * std::cos(around), std::cos(up), radius * std::sin(up) * std::sin(around)});
      if (i == kUp) continue;
      const std::size_t a = i * kAround + j, b = i * kAround + (j + 1) % kAround;
      for (const std::size_t corner : {a, b, a + kAround, b, b + kAround, a + kAround})
        corners.push_back(static_cast<std::uint32_t>(corner));
    }
  }
  Motion motion;
  motion.topology = Topology::triangles(places.size(), corners).value();
  for (const double time : times) {
    Motion::Keyframe& keyframe = motion.keyframes.emplace_back();
    keyframe.time = time;
    for (const Vec3d& place : places) {
      const Vec3d p = moved(place, time);
      for (const double c : {p.x, p.y, p.z}) keyframe.positions.push_back(static_cast<float>(c));
    }
  }
  motion.connect_as_sequence();
  return motion;
}

std::vector<double> even_times(std::size_t count) {
  std::vector<double> times;
  for (std::size_t i = 0; i < count; ++i) times.push_back(static_cast<double>(i) / static_cast<double>(count - 1));
  return times;
}

Vec3d turned(const Vec3d& p, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return {c * p.x + s * p.z, p.y, c * p.z - s * p.x};
}

TruthComparison compared(const Motion& motion, std::size_t every, ElementKind kind = ElementKind::kVertices) {
  TruthOptions options;
  options.every = every;
  options.schemes = {"linear", "polynomial"};
  options.elements.kind = kind;
  Result<TruthComparison> result = compare_with_truth(motion, options);
  EXPECT_TRUE(result.ok()) << result.error().text();
  return result.ok() ? std::move(result).value() : TruthComparison();
}

const Quality& row(const TruthComparison& comparison, const std::string& scheme) {
  for (const TruthRow& one : comparison.rows)
    if (one.scheme == scheme) return one.quality;
  ADD_FAILURE() << scheme;
  return comparison.rows.front().quality;
}

// The average errors of the faces, in radians, computed independently. The normals by nlerp between two keyframes, and
// the cross products of interpolated positions, are compared with the normals of the keyframe that was left out.
struct Means {
  double linear = 0, polynomial = 0;
};
Means means_by_hand(const Motion& motion, std::size_t every) {
  using Vector = std::array<double, 3>;
  const auto normal = [&](const std::vector<double>& p, std::size_t f) {
    const auto face = motion.topology.face(f);
    Vector e, g;
    for (std::size_t c = 0; c < 3; ++c) {
      e[c] = p[3 * face[1] + c] - p[3 * face[0] + c];
      g[c] = p[3 * face[2] + c] - p[3 * face[0] + c];
    }
    Vector n = {e[1] * g[2] - e[2] * g[1], e[2] * g[0] - e[0] * g[2], e[0] * g[1] - e[1] * g[0]};
    const double size = std::sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (double& c : n) c /= size;
    return n;
  };
  const auto positions = [&](std::size_t key) {
    return std::vector<double>(motion.keyframes[key].positions.begin(), motion.keyframes[key].positions.end());
  };
  const auto angle = [](const Vector& a, const Vector& b) {
    const double x = a[1] * b[2] - a[2] * b[1], y = a[2] * b[0] - a[0] * b[2], z = a[0] * b[1] - a[1] * b[0];
    return std::atan2(std::sqrt(x * x + y * y + z * z), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
  };
  Means sum;
  std::size_t count = 0;
  for (std::size_t first = 0; first + every < motion.keyframes.size(); first += every) {
    const std::vector<double> from = positions(first), to = positions(first + every);
    for (std::size_t key = first + 1; key < first + every; ++key) {
      const double t = (motion.keyframes[key].time - motion.keyframes[first].time) /
                       (motion.keyframes[first + every].time - motion.keyframes[first].time);
      std::vector<double> between(from.size());
      for (std::size_t i = 0; i < between.size(); ++i) between[i] = (1 - t) * from[i] + t * to[i];
      const std::vector<double> right = positions(key);
      for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
        const Vector a = normal(from, f), b = normal(to, f);
        Vector mixed;
        for (std::size_t c = 0; c < 3; ++c) mixed[c] = (1 - t) * a[c] + t * b[c];
        sum.linear += angle(mixed, normal(right, f));
        sum.polynomial += angle(normal(between, f), normal(right, f));
        ++count;
      }
    }
  }
  return {sum.linear / static_cast<double>(count), sum.polynomial / static_cast<double>(count)};
}

TEST(Truth, rows_have_the_means_of_a_computation_by_hand_at_uneven_times) {
  const std::vector<double> times = {0, 0.1, 0.35, 0.5, 0.6, 1.2, 1.3, 1.9};
  const Motion motion = body_at(times, [](const Vec3d& p, double t) { return turned(p, t * (1 + 0.3 * p.y)); });
  const TruthComparison comparison = compared(motion, 3, ElementKind::kFaces);
  const Means means = means_by_hand(motion, 3);
  EXPECT_EQ(comparison.kept, 3U);
  EXPECT_EQ(comparison.left_out, 4U) << "the last of eight is neither kept nor looked at";
  EXPECT_NEAR(row(comparison, "linear").mean(), means.linear, 1e-6);
  EXPECT_NEAR(row(comparison, "polynomial").mean(), means.polynomial, 1e-6);
  EXPECT_GT(means.linear, 0.01);
  EXPECT_EQ(row(comparison, "linear").count, 4 * motion.topology.face_count());
}

TEST(Truth, curves_follow_a_motion_of_constant_acceleration_exactly_at_any_times) {
  const auto fall = [](const Vec3d& p, double t) {
    const Vec3d sideways = {p.y, p.z * p.x, 0.3 * p.y * p.z};
    return p + (0.5 * t) * Vec3d{p.z, p.x, p.y} + (0.4 * t * t) * sideways;
  };
  const Motion motion = body_at({0, 0.2, 0.5, 0.6, 1.1, 1.15, 1.6, 1.8, 2.0}, fall);
  const TruthComparison comparison = compared(motion, 2);
  EXPECT_LT(row(comparison, "exact").max, 1e-4) << "radians: what the rounding of positions turns small faces";
  EXPECT_GT(row(comparison, "polynomial").mean(), 1e-3) << "else this says nothing";
}

TEST(Truth, curves_gain_5_and_10_times_on_a_turn_of_120_degrees_in_4_and_8_segments) {
  constexpr std::size_t kInEach = 8;
  const auto turn = [](const Vec3d& p, double t) { return turned(p, 2 * kPi / 3 * t); };
  for (const auto& [segments, gain] : {std::pair<std::size_t, double>{4, 5}, {8, 10}}) {
    const TruthComparison comparison = compared(body_at(even_times(segments * kInEach + 1), turn), kInEach);
    EXPECT_GT(row(comparison, "linear").mean(), gain * row(comparison, "exact").mean()) << segments;
    EXPECT_NEAR(comparison.bend, std::sin(kPi / 3 / static_cast<double>(segments)), 1e-5);
  }
}

TEST(Truth, a_twist_is_no_farther_off_on_curves_than_by_linear_from_4_segments_on) {
  constexpr std::size_t kInEach = 8;
  const auto twist = [](const Vec3d& p, double t) { return turned(p, 2 * kPi / 3 * t * (p.y + 1) / 2); };
  for (const std::size_t segments : {4U, 8U}) {
    const TruthComparison comparison = compared(body_at(even_times(segments * kInEach + 1), twist), kInEach);
    EXPECT_LE(row(comparison, "exact").mean(), row(comparison, "linear").mean()) << segments;
  }
}

TEST(Truth, two_kept_keyframes_have_no_curve) {
  const TruthComparison comparison =
      compared(body_at(even_times(5), [](const Vec3d& p, double t) { return turned(p, t); }), 4);
  EXPECT_EQ(comparison.kept, 2U);
  EXPECT_EQ(comparison.left_out, 3U);
  EXPECT_EQ(comparison.rows.size(), 2U);
  EXPECT_EQ(comparison.bend, 0);
}

TEST(Truth, refuses_what_has_no_other_truth_and_what_leaves_nothing_to_compare) {
  const Motion turn = body_at(even_times(4), [](const Vec3d& p, double t) { return turned(p, t); });
  const auto refusal = [](const Motion& motion, const TruthOptions& options) {
    const Result<TruthComparison> result = compare_with_truth(motion, options);
    if (result) return std::string("compared");
    EXPECT_EQ(result.error().code, ErrorCode::kUsage);
    return result.error().message;
  };
  TruthOptions options;
  EXPECT_NE(refusal(make_builtin_morph("bumps").value(), options).find("only for a sequence of keyframes"),
            std::string::npos);
  options.every = 1;
  EXPECT_NE(refusal(turn, options).find("no keyframe would be left out"), std::string::npos);
  options.every = 4;
  EXPECT_NE(refusal(turn, options).find("4 keyframes"), std::string::npos);
  options.every = 3;
  EXPECT_EQ(refusal(turn, options), "compared");
  options.schemes = {"no scheme"};
  EXPECT_NE(refusal(turn, options), "compared");
  options.schemes = {"quaternion:matrix"};
  options.elements.kind = ElementKind::kVertices;
  EXPECT_NE(refusal(turn, options).find("edges of faces"), std::string::npos);
}

}  // namespace
}  // namespace chronormal::truth_test
