// Compares curves through keyframes with formulas from textbooks, and the straight pieces of the curves with the
// curves.
#include "chronormal/motion/paths.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "chronormal/core/parallel.h"
#include "tests/support/curved_motion.h"
#include "tests/support/fixtures.h"

namespace chronormal::paths_test {
namespace {

std::vector<const Motion::Keyframe*> keys_of(const Motion& motion) {
  std::vector<const Motion::Keyframe*> keys;
  for (const Motion::Keyframe& keyframe : motion.keyframes) keys.push_back(&keyframe);
  return keys;
}

Path curve(double tolerance = kPathTolerance) { return {PathKind::kCatmullRom, tolerance}; }

// ---- curves through keyframes ---------------------------------------------------------------------------------------

TEST(CubicSegment, is_the_curve_of_the_textbook_with_or_without_velocities) {
  Motion motion = test::curved_motion({0, 0.2, 0.5, 0.6, 1}, 2, 6, 4);
  for (Motion::Keyframe& key : motion.keyframes)
    for (const float p : key.positions) key.velocities.push_back(3 * p - 0.5F);
  motion.keyframes[2].velocities.clear();
  for (std::size_t s = 0; s < 4; ++s) {
    for (const double t : {0.0, 0.3, 0.75, 1.0}) {
      for (const PathKind kind : {PathKind::kCatmullRom, PathKind::kHermite}) {
        const auto right = test::on_curve(motion, s, t, kind == PathKind::kHermite);
        const std::vector<float> found = cubic_segment(keys_of(motion), s, kind).positions(t);
        for (std::size_t c = 0; c < found.size(); ++c)
          EXPECT_NEAR(found[c], static_cast<double>(right[c]), 1e-6) << s << ' ' << t << ' ' << path_name(kind);
      }
    }
  }
}

TEST(Path, is_read_from_its_name_and_its_tolerance) {
  for (const PathKind kind : {PathKind::kLinear, PathKind::kCatmullRom, PathKind::kHermite}) {
    EXPECT_EQ(make_path(path_name(kind)).value().kind, kind);
    EXPECT_EQ(make_path(path_name(kind)).value().tolerance, kPathTolerance);
  }
  EXPECT_EQ(make_path("hermite:0.25").value().tolerance, 0.25);
  for (const char* const wrong : {"hermit", "", ":1", "hermite:", "hermite:0", "hermite:-1", "hermite:46", "hermite:1 ",
                                  "hermite:nan", "linear:1", "catmull-rom:0.1:2"})
    EXPECT_EQ(make_path(wrong).error().code, ErrorCode::kUsage) << wrong;
}

TEST(Path, hermite_needs_a_velocity_and_curves_a_sequence) {
  Motion motion = test::curved_motion({0, 0.5, 1}, 1, 5, 3);
  EXPECT_TRUE(check_path(motion, PathKind::kLinear).ok());
  EXPECT_TRUE(check_path(motion, PathKind::kCatmullRom).ok());
  EXPECT_EQ(check_path(motion, PathKind::kHermite).error().code, ErrorCode::kUsage);
  motion.keyframes[1].velocities = motion.keyframes[1].positions;
  EXPECT_TRUE(check_path(motion, PathKind::kHermite).ok());
  motion.keyframes[1].velocities.pop_back();
  EXPECT_EQ(validate(motion).error().code, ErrorCode::kInvalidInput);
  motion.keyframes[1].velocities.push_back(std::nanf(""));
  EXPECT_EQ(validate(motion).error().code, ErrorCode::kInvalidInput);
  motion.keyframes[1].velocities.clear();
  for (Motion::Keyframe& key : motion.keyframes) key.time = key.time > 0 ? 1 : 0;
  motion.connect_as_targets();
  EXPECT_EQ(check_path(motion, PathKind::kCatmullRom).error().code, ErrorCode::kUsage);
  EXPECT_EQ(cut_into_segments(motion, curve()).error().code, ErrorCode::kUsage);
}

// ---- the straight pieces of curves ----------------------------------------------------------------------------------

// Compares the normals of the straight pieces with the normals of the curve, at times between the keyframes, for all
// faces or for all vertices. Returns the largest angle in degrees. Subtracts twice the angle that rounding positions to
// float32 may cause: once because the positions of the pieces are rounded, and once because the library accepts a piece
// if its error is no larger than a rounding error.
double largest_error(const Motion& motion, const Motion& pieces, bool of_vertices, bool given) {
  double largest = 0;
  for (std::size_t p = 0; p < pieces.segments.size(); ++p) {
    const Motion::Keyframe &from = pieces.keyframes[p], &to = pieces.keyframes[p + 1];
    for (const double part : {0.0, 0.21, 0.5, 0.79, 1.0}) {
      const double time = (1 - part) * from.time + part * to.time;
      std::size_t s = 0;
      while (s + 2 < motion.keyframes.size() && time >= motion.keyframes[s + 1].time) ++s;
      const long double start = motion.keyframes[s].time, end = motion.keyframes[s + 1].time;
      const auto right = test::on_curve(motion, s, (time - start) / (end - start), given);
      std::vector<long double> shown(right.size());
      for (std::size_t c = 0; c < shown.size(); ++c)
        shown[c] = (1 - static_cast<long double>(part)) * static_cast<long double>(from.positions[c]) +
                   static_cast<long double>(part) * static_cast<long double>(to.positions[c]);
      const auto exact = test::normals_of(motion, right, of_vertices),
                 found = test::normals_of(motion, shown, of_vertices);
      for (std::size_t e = 0; e < exact.size(); ++e) {
        double rounding = 0;
        for (std::size_t f = e; f < (of_vertices ? 0 : e + 1); ++f) {
          const auto face = motion.topology.face(f);
          double widest = 0, furthest = 0;
          for (const std::uint32_t v : face) {
            for (std::size_t c = 0; c < 3; ++c) {
              widest = std::max(widest, static_cast<double>(std::fabs(right[3 * v + c] - right[3 * face[0] + c])));
              furthest = std::max(furthest, static_cast<double>(std::fabs(right[3 * v + c])));
            }
          }
          const double size = static_cast<double>(
              std::sqrt(exact[e][0] * exact[e][0] + exact[e][1] * exact[e][1] + exact[e][2] * exact[e][2]));
          // A triangle contributes two edges to the rounding error, and a quad four. An edge is at most 1.8 times as
          // long as its largest component. The factors 16 and 1.2 include a safety margin.
          rounding = 2 * 57.3 * 0x1p-24 * 16 * static_cast<double>(face.size() - 2) * widest * 1.2 * furthest / size;
        }
        largest = std::max(largest, test::angle_of(exact[e], found[e]) * 57.29577951308232 - rounding);
      }
    }
  }
  return largest;
}

TEST(Pieces, have_the_normals_of_the_curve_within_the_tolerance) {
  Motion motion = test::curved_motion({0, 0.1, 0.25, 0.3, 0.5}, 2.5, 24, 12);
  for (const bool given : {false, true}) {
    std::size_t before = 0;
    for (const double tolerance : {1.0, 0.1, 0.01}) {
      const CutMotion cut =
          cut_into_segments(motion, {given ? PathKind::kHermite : PathKind::kCatmullRom, tolerance}).value();
      ASSERT_TRUE(validate(cut.motion).ok());
      EXPECT_EQ(cut.cut.segments, 4U);
      EXPECT_EQ(cut.cut.pieces, cut.motion.segments.size());
      EXPECT_EQ(cut.cut.beyond, 0U);
      EXPECT_GT(cut.cut.pieces, before) << "a smaller tolerance takes more";
      before = cut.cut.pieces;
      const double rounding = 2e-4;  // angle in degrees by which rounding positions may turn edges of length 0.1
      const double of_faces = largest_error(motion, cut.motion, false, given);
      EXPECT_LE(of_faces, tolerance + rounding);
      EXPECT_GT(of_faces, tolerance / 40) << "not many more pieces than it takes";
      EXPECT_LE(largest_error(motion, cut.motion, true, given), 1.2 * tolerance + rounding);
    }
    for (Motion::Keyframe& key : motion.keyframes)
      for (const float p : key.positions) key.velocities.push_back(2 * p + 0.3F);
  }
}

// The motions are random tetrahedra and quads that tumble, grow and wander. Some of the tetrahedra and quads are thin.
TEST(Pieces, of_random_motions_are_within_the_tolerance) {
  const std::uint64_t seed = 20261127;
  RecordProperty("seed", std::to_string(seed));
  fixtures::Random random(seed);
  std::size_t beyond = 0, pieces = 0, judged = 0;
  for (int trial = 0; trial < 60; ++trial) {
    Motion motion;
    const bool are_quads = trial % 3 == 0;
    motion.topology = are_quads ? Topology::polygons(8, {0, 4, 8, 12}, {0, 1, 2, 3, 3, 2, 5, 4, 4, 5, 6, 7}).value()
                                : Topology::triangles(6, {0, 1, 2, 0, 2, 3, 0, 3, 1, 3, 4, 5}).value();
    const std::size_t vertices = motion.topology.vertex_count();
    std::vector<std::array<double, 3>> start(vertices);
    for (auto& p : start)
      for (double& c : p) c = random.uniform(-1, 1);
    const double thin = std::pow(10.0, random.uniform(-3, 0)), far = random.uniform(0, 1) < 0.3 ? 50 : 0;
    const double turn = random.uniform(0.05, 0.9), swell = random.uniform(-0.1, 0.2);
    double time = random.uniform(-1, 1);
    for (std::size_t k = 0; k < 5; ++k, time += random.uniform(0.1, 1)) {
      Motion::Keyframe& key = motion.keyframes.emplace_back();
      key.time = time;
      const double angle = turn * static_cast<double>(k), c = std::cos(angle), s = std::sin(angle);
      for (const auto& [x, y, z] : start) {
        const double size = 1 + swell * static_cast<double>(k), wander = 0.02 * random.uniform(-1, 1);
        for (const double p : {far + size * (c * x + s * thin * z), size * y + wander, size * (c * thin * z - s * x)})
          key.positions.push_back(static_cast<float>(p));
      }
    }
    motion.connect_as_sequence();
    const double tolerance = std::pow(10.0, random.uniform(-2, 0.3));
    const CutMotion cut = cut_into_segments(motion, curve(tolerance)).value();
    pieces += cut.cut.pieces;
    beyond += cut.cut.beyond;
    if (cut.cut.beyond > 0) continue;
    EXPECT_LE(largest_error(motion, cut.motion, false, false), tolerance) << "trial " << trial;
    ++judged;
  }
  EXPECT_GT(pieces, 60U * 4);
  EXPECT_LT(beyond, 40U);
  EXPECT_GT(judged, 30U);
}

TEST(Pieces, of_straight_paths_and_of_two_keyframes_are_the_segments) {
  const Motion motion = test::curved_motion({0, 0.5, 1}, 1, 6, 4);
  EXPECT_EQ(cut_into_segments(motion, {PathKind::kLinear}).value().motion.keyframes.size(), 3U);
  const Motion two = test::curved_motion({0, 1}, 1, 6, 4);
  const CutMotion cut = cut_into_segments(two, curve(0.001)).value();
  EXPECT_EQ(cut.cut.pieces, 1U);
  for (std::size_t k = 0; k < 2; ++k) EXPECT_EQ(cut.motion.keyframes[k].positions, two.keyframes[k].positions);
}

TEST(Pieces, go_through_the_keyframes_at_equal_steps_of_time) {
  const Motion motion = test::curved_motion({0, 0.2, 1}, 2, 8, 5);
  const CutMotion cut = cut_into_segments(motion, curve(0.1)).value();
  std::size_t at = 0;
  for (const Motion::Keyframe& key : motion.keyframes) {
    while (at < cut.motion.keyframes.size() && cut.motion.keyframes[at].time < key.time) ++at;
    ASSERT_LT(at, cut.motion.keyframes.size());
    EXPECT_EQ(cut.motion.keyframes[at].time, key.time);
    EXPECT_EQ(cut.motion.keyframes[at].positions, key.positions);
  }
}

TEST(Pieces, are_no_more_than_was_allowed) {
  const Motion motion = test::curved_motion({0, 0.5, 1}, 2, 8, 5);
  const CutMotion few = cut_into_segments(motion, curve(0.001), 4).value();
  EXPECT_EQ(few.cut.pieces, 8U) << "and all of these";
  EXPECT_GT(few.cut.beyond, 0U) << "and it is said that this is not enough";
  EXPECT_EQ(cut_into_segments(motion, curve(), 0).value().cut.pieces, 2U);
}

// Between keyframes 1 and 2, vertex 2 passes close to the line through the other two vertices, so the face turns over
// quickly.
TEST(Pieces, a_face_that_turns_over_decides_nothing) {
  Motion motion;
  motion.topology = Topology::triangles(6, {0, 1, 2, 3, 4, 5}).value();
  for (const float k : {0.0F, 1.0F, 2.0F, 3.0F})
    motion.keyframes.push_back(
        {{0, 0, 0, 1, 0, 0, 0.3F, 1.5F - k, 0.1F * k * k, 5, 0, 0, 6, 0, 0, 5, 1, 0.1F * k * k}, k, ""});
  motion.connect_as_sequence();
  for (std::size_t i = 2; i < 3; ++i) {
    const CutMotion cut = cut_into_segments(motion, curve()).value();
    EXPECT_LE(cut.cut.beyond, 1U);
    EXPECT_TRUE(validate(cut.motion).ok());
  }
  // Moves vertex 2 exactly through the line through vertices 0 and 1.
  for (Motion::Keyframe& key : motion.keyframes)
    key.positions[8] = 0, key.positions[7] += static_cast<float>(0.01 * key.time * key.time);
  const CutMotion through = cut_into_segments(motion, curve()).value();
  EXPECT_EQ(through.cut.beyond, 1U);
  EXPECT_LT(through.cut.pieces, 60U) << "the other face needs no more";
}

TEST(Pieces, a_face_without_area_takes_part_in_nothing) {
  Motion motion = test::curved_motion({0, 0.5, 1}, 1, 6, 4);
  std::vector<std::uint32_t> corners(motion.topology.corners().begin(), motion.topology.corners().end());
  corners.insert(corners.end(), {0, 1, 1, 2, 2, 2});
  const std::size_t pieces = cut_into_segments(motion, curve()).value().cut.pieces;
  motion.topology = Topology::triangles(motion.topology.vertex_count(), corners).value();
  const CutMotion cut = cut_into_segments(motion, curve()).value();
  EXPECT_EQ(cut.cut.beyond, 0U);
  EXPECT_EQ(cut.cut.pieces, pieces);
}

TEST(Pieces, of_times_that_all_but_coincide_still_ascend) {
  Motion motion = test::curved_motion({0, 0.5, 1}, 2, 6, 4);
  motion.keyframes[0].time = 1;
  motion.keyframes[1].time = std::nextafter(1.0, 2.0);
  motion.keyframes[2].time = std::nextafter(motion.keyframes[1].time, 2.0);
  const Result<CutMotion> cut = cut_into_segments(motion, curve());
  ASSERT_TRUE(cut.ok());
  EXPECT_TRUE(validate(cut.value().motion).ok());
}

TEST(Pieces, have_the_same_bits_on_any_number_of_threads_and_in_a_stream) {
  const Motion motion = test::curved_motion({0, 0.2, 0.5, 0.6, 1}, 2);
  const CutMotion whole = cut_into_segments(motion, curve(0.1)).value();
  {
    const ThreadLimit one(1);
    const CutMotion again = cut_into_segments(motion, curve(0.1)).value();
    ASSERT_EQ(again.motion.keyframes.size(), whole.motion.keyframes.size());
    for (std::size_t k = 0; k < whole.motion.keyframes.size(); ++k)
      EXPECT_EQ(again.motion.keyframes[k].positions, whole.motion.keyframes[k].positions);
  }
  CutStream cut = cut_into_segments(MotionStream(motion), curve(0.1), kMostPieces, 0).value();
  for (const std::size_t k : {std::size_t{7}, std::size_t{0}, whole.motion.keyframes.size() - 1, std::size_t{3}}) {
    ASSERT_TRUE(cut.stream.hold(k, k).ok());
    EXPECT_EQ(cut.stream.motion().keyframes[k].positions, whole.motion.keyframes[k].positions);
    EXPECT_TRUE(cut.stream.motion().keyframes[k == 3 ? 7 : 3].positions.empty()) << "one at a time";
  }
}

// Between the keyframes, the curve of vertex 0 exceeds the largest float32 number.
TEST(Pieces, that_leave_float32_are_an_error) {
  Motion motion;
  motion.topology = Topology::triangles(3, {0, 1, 2}).value();
  for (const float k : {0.0F, 1.0F}) {
    motion.keyframes.push_back({{3.39e38F, 0, 0, 3.3e38F, 1e37F, 0, 3.3e38F, 0, 1e37F}, k, ""});
    motion.keyframes.back().velocities.assign(9, 0);
    motion.keyframes.back().velocities[0] = k == 0 ? 4e37F : -4e37F;
  }
  motion.connect_as_sequence();
  EXPECT_EQ(cut_into_segments(motion, {PathKind::kHermite, 1}).error().code, ErrorCode::kUsage);
}

// ---- the bend of paths ---------------------------------------------------------------------------------------------

TEST(Bend, of_a_rigid_turn_is_the_sine_of_half_its_angle) {
  Motion motion;
  motion.topology = Topology::triangles(3, {0, 1, 2}).value();
  for (int k = 0; k < 4; ++k) {
    const double c = std::cos(0.7 * k), s = std::sin(0.7 * k);
    Motion::Keyframe& key = motion.keyframes.emplace_back();
    key.time = k;
    for (const double size : {1.0, 2.0, 3.0})
      for (const double p : {size * c, 0.0, size * s}) key.positions.push_back(static_cast<float>(p));
  }
  motion.connect_as_sequence();
  MotionStream stream(motion);
  EXPECT_NEAR(bend_of(stream).value(), std::sin(0.35), 1e-6);
  EXPECT_EQ(bend_of(stream, 2).value(), 0) << "two keyframes are left";
  EXPECT_EQ(bend_of(stream).value(), cut_into_segments(motion, curve()).value().cut.bend);
  EXPECT_FALSE(is_too_sparse(0.5));
  EXPECT_TRUE(is_too_sparse(0.51));
}

}  // namespace
}  // namespace chronormal::paths_test
