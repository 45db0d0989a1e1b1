// Certificates on curved paths against whole numbers of any size: at 40 exact times each, no error of any scheme is
// above its upper bound, and at the time that is named it is not below the lower one. 200 elements from fixed seeds.

#include <gtest/gtest.h>

#include <gmpxx.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <string>
#include <vector>

#include "chronormal/analysis/certify.h"
#include "chronormal/normals/elements.h"
#include "chronormal/normals/path_curves.h"
#include "chronormal/workflow/compare.h"
#include "tests/support/curved_motion.h"
#include "tests/support/fixtures.h"
#include "tests/support/integer_normal.h"
#include "tests/support/scheme_names.h"

namespace chronormal::certify_path_test {
namespace {

using test::IntegerTime;
using test::IntegerVector;

constexpr std::uint64_t kSeed = 8300;
constexpr double kOracle = 1e-12;  // radians
const std::string kPathCurves = "PathCurves";

const std::vector<std::string>& all_schemes() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = test::scheme_names();
    all.push_back(kPathCurves);
    return all;
  }();
  return names;
}

// A double as a whole number of 2^-400, which all control positions of these tests are.
mpz_class whole(double value) {
  int exponent = 0;
  mpz_class result(std::ldexp(std::frexp(value, &exponent), 53));
  const int shift = exponent - 53 + 400;
  EXPECT_GE(shift, 0);
  return result << static_cast<unsigned>(std::max(shift, 0));
}

// The exact normals of all faces of a cubic path at t, up to a common length.
std::vector<IntegerVector> exact_normals(const PolynomialSegment<3>& path, double time) {
  const IntegerTime t = IntegerTime::of(time);
  const mpz_class after = (mpz_class(1) << t.e) - t.t;
  const std::array<mpz_class, 4> weights = {after * after * after, 3 * after * after * t.t, 3 * after * t.t * t.t,
                                            t.t * t.t * t.t};
  std::vector<IntegerVector> positions(path.topology->vertex_count());
  for (std::size_t v = 0; v < positions.size(); ++v)
    for (std::size_t k = 0; k < 4; ++k) {
      const Vec3d& c = path.control[k][v];
      for (std::size_t i = 0; i < 3; ++i) positions[v][i] += weights[k] * whole(i == 0 ? c.x : i == 1 ? c.y : c.z);
    }
  std::vector<IntegerVector> normals(path.topology->face_count());
  for (std::size_t f = 0; f < normals.size(); ++f) {
    const auto face = path.topology->face(f);
    const auto edge = [&](std::size_t corner, std::size_t i) {
      return mpz_class(positions[face[corner]][i] - positions[face[0]][i]);
    };
    for (std::size_t i = 0; i < 3; ++i)
      normals[f][i] = edge(1, (i + 1) % 3) * edge(2, (i + 2) % 3) - edge(1, (i + 2) % 3) * edge(2, (i + 1) % 3);
  }
  return normals;
}

// What is shown of a segment by one of the schemes, or by PathCurves, and the bounds of its errors.
class Shown {
 public:
  Shown(const std::string& name, const Segment& segment, const PolynomialSegment<3>& path)
      : segment_(segment), normals_(segment.topology->face_count()), bounds_(normals_.size()) {
    const IndexRange faces{0, normals_.size()};
    const PathTruth truth = path_truth(path, faces);
    if (name == kPathCurves) {
      curves_ = PathCurves(truth.normals);
      certify_path_curves(truth, bounds_);
      return;
    }
    face_control_normals(segment_, faces, normals_);
    scheme_ = make_scheme(name).value();
    const ElementBlock block{&segment_, faces, normals_};
    scheme_->prepare(block);
    certify(*scheme_, block, truth, bounds_);
  }

  [[nodiscard]] std::vector<Vec3f> at(double t) const {
    std::vector<float> values(3 * normals_.size());
    const auto view = VectorView<float>::packed(values.data(), normals_.size());
    if (scheme_ != nullptr)
      scheme_->evaluate(t, view);
    else
      curves_.unit_normals(t, view);
    std::vector<Vec3f> result;
    for (std::size_t i = 0; i < normals_.size(); ++i) result.push_back(view[i]);
    return result;
  }
  [[nodiscard]] const std::vector<ErrorBounds>& bounds() const { return bounds_; }

 private:
  Segment segment_;
  std::vector<ControlNormals> normals_;
  std::vector<ErrorBounds> bounds_;
  std::unique_ptr<Scheme> scheme_;
  PathCurves curves_;
};

double error_of(const Vec3f& shown, const IntegerVector& exact) {
  return test::angle_between(shown, test::direction_of(exact));
}

void expect_no_violation(const Motion& motion, const std::string& family, std::uint64_t seed) {
  const PolynomialSegment<3> path = path_segment(motion, 0, PathKind::kHermite);
  const Segment segment = motion.segment(0);
  std::vector<Shown> shown;
  for (const std::string& name : all_schemes()) shown.emplace_back(name, segment, path);
  fixtures::Random random(seed);
  std::vector<double> times = {0, 1, 0.5, 0x1p-30, 1 - 0x1p-30, 1e-3, 1 - 1e-3};
  while (times.size() < 40) times.push_back(random.uniform(0, 1));
  for (const double t : times) {
    const std::vector<IntegerVector> exact = exact_normals(path, t);
    for (std::size_t s = 0; s < shown.size(); ++s) {
      const std::vector<Vec3f> normals = shown[s].at(t);
      for (std::size_t f = 0; f < exact.size(); ++f) {
        if (test::is_zero(exact[f])) continue;
        ASSERT_LE(error_of(normals[f], exact[f]), shown[s].bounds()[f].upper + kOracle)
            << family << ", " << all_schemes()[s] << ", face " << f << ", t = " << t << ", seed " << seed;
      }
    }
  }
  std::size_t known = 0, all = 0;
  for (std::size_t s = 0; s < shown.size(); ++s)
    for (std::size_t f = 0; f < path.topology->face_count(); ++f) {
      const ErrorBounds& bounds = shown[s].bounds()[f];
      ++all;
      if (bounds.upper < std::numbers::pi) ++known;
      EXPECT_LE(bounds.lower, bounds.upper);
      if (bounds.lower == 0) continue;
      EXPECT_GE(error_of(shown[s].at(bounds.at)[f], exact_normals(path, bounds.at)[f]), bounds.lower - kOracle)
          << family << ", " << all_schemes()[s] << ", face " << f;
    }
  std::cout << "  " << family << ": bounds below half a turn for " << known << " of " << all << '\n';
}

// Gives the two keyframes of a motion velocities: those of the straight line, and up to `size` more.
Motion with_velocities(Motion motion, double size, std::uint64_t seed) {
  fixtures::Random random(seed);
  const std::vector<float> from = motion.keyframes[0].positions, to = motion.keyframes[1].positions;
  for (Motion::Keyframe& key : motion.keyframes)
    for (std::size_t c = 0; c < from.size(); ++c)
      key.velocities.push_back(to[c] - from[c] + static_cast<float>(random.uniform(-size, size)));
  return motion;
}

TEST(PathCertificates, are_never_violated) {
  constexpr std::size_t kFaces = 40;
  const auto soup = [](double motion, double needle = 0, double offset = 0) {
    return fixtures::soup({.face_count = kFaces, .seed = kSeed, .motion = motion, .offset = offset, .needle = needle});
  };
  expect_no_violation(with_velocities(soup(0.2), 0.3, kSeed + 1), "moderate", kSeed + 2);
  expect_no_violation(with_velocities(soup(-1), 1, kSeed + 3), "large", kSeed + 4);
  expect_no_violation(with_velocities(soup(1e-6), 1e-6, kSeed + 5), "still", kSeed + 6);
  expect_no_violation(with_velocities(soup(0.01, 1e-4), 1e-3, kSeed + 7), "needles", kSeed + 8);
  expect_no_violation(with_velocities(soup(0.1, 0, 1000), 0.2, kSeed + 9), "far", kSeed + 10);
}

TEST(PathCertificates, are_never_violated_where_normals_vanish_at_ends) {
  fixtures::Random random(kSeed);
  Motion motion = fixtures::soup({.face_count = 30, .seed = kSeed + 20, .motion = 0.3});
  std::vector<float>&from = motion.keyframes[0].positions, &to = motion.keyframes[1].positions;
  for (std::size_t f = 0; f < 30; ++f)
    for (std::size_t c = 0; c < 9; ++c) {
      if (f % 3 != 1) from[9 * f + c] = from[9 * f + c % 3];                 // grows out of a point
      if (f % 3 == 1) to[9 * f + c] = to[9 * f + (c >= 3 ? 3 : 0) + c % 3];  // shrinks to a line
    }
  motion = with_velocities(motion, 0.2, kSeed + 21);
  for (std::size_t f = 2; f < 30; f += 3)  // all corners begin with one velocity: n(t) begins with t^4
    for (std::size_t c = 0; c < 9; ++c) {
      std::vector<float>& velocities = motion.keyframes[0].velocities;
      velocities[9 * f + c] = velocities[9 * f + c % 3];
    }
  expect_no_violation(motion, "vanishing", kSeed + 22);
}

TEST(PathCertificates, know_how_far_control_normals_are_off) {
  const auto rational = [](const Vec3d& v) { return std::array<mpq_class, 3>{mpq_class(v.x), v.y, v.z}; };
  double largest_share = 0;
  for (const double needle : {0.0, 1e-4, 1e-9}) {
    const Motion motion = with_velocities(
        fixtures::soup({.face_count = 40, .seed = kSeed, .motion = 0.01, .offset = 100, .needle = needle}), 1e-3,
        kSeed);
    const PolynomialSegment<3> path = path_segment(motion, 0, PathKind::kHermite);
    const PathTruth truth = path_truth(path, {0, 40});
    for (std::size_t f = 0; f < 40; ++f) {
      std::array<std::array<mpq_class, 3>, 7> exact{};
      const auto edge = [&](std::size_t corner, std::size_t k, std::size_t c) {
        return mpq_class(rational(path.control[k][3 * f + corner])[c] - rational(path.control[k][3 * f])[c]);
      };
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j)
          for (std::size_t c = 0; c < 3; ++c) {
            const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
            const mpq_class share(static_cast<long>(binomial(3, i) * binomial(3, j)),
                                  static_cast<long>(binomial(6, i + j)));
            exact[i + j][c] += share * (edge(1, i, d) * edge(2, j, e) - edge(1, i, e) * edge(2, j, d));
          }
      for (std::size_t k = 0; k < 7; ++k)
        for (std::size_t c = 0; c < 3; ++c) {
          const mpq_class off = abs(exact[k][c] - rational(truth.normals[f][k])[c]);
          ASSERT_LE(off, mpq_class(truth.errors[f][k])) << needle << ", face " << f << ", control normal " << k;
          largest_share = std::max(largest_share, mpq_class(off / mpq_class(truth.errors[f][k])).get_d());
        }
    }
  }
  EXPECT_GT(largest_share, 0.01) << "no bound that is far from what rounding does";
}

// Two corners rest, and the third goes up and down again.
Motion arch(float height) {
  Motion motion = fixtures::make_motion(fixtures::make_soup(1), {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                                        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  for (Motion::Keyframe& key : motion.keyframes)
    key.velocities = {0, 0, 0, 0, 0, 0, 0, 0, key.time == 0 ? 4 * height : -4 * height};
  return motion;
}

TEST(PathCertificates, meet_an_error_that_is_known_by_hand) {
  // z of the third corner is 4 h t (1 - t), so that n = (0, -z, 1), and all that looks at the ends alone shows (0, 0,
  // 1).
  const Motion motion = arch(1);
  const PolynomialSegment<3> path = path_segment(motion, 0, PathKind::kHermite);
  for (const char* const scheme : {"linear", "slerp", "polynomial", "recompute", "quaternion:optimal", "circle"}) {
    const ErrorBounds bounds = certify(scheme, motion.segment(0), path).value()[0];
    EXPECT_LE(bounds.lower, std::numbers::pi / 4 + 1e-6) << scheme;
    EXPECT_GE(bounds.upper, std::numbers::pi / 4 - 1e-12) << scheme;
    EXPECT_LT(bounds.upper - bounds.lower, 1e-3) << scheme;
    EXPECT_NEAR(bounds.at, 0.5, 0.05) << scheme;
  }
  EXPECT_EQ(certify("no such scheme", motion.segment(0), path).error().code, ErrorCode::kUsage);
}

TEST(PathCertificates, are_half_a_turn_where_the_normal_of_the_path_vanishes) {
  Motion motion = arch(1);
  motion.keyframes[0].velocities = {0, 0, 0, 0, 0, 0, 0, -8, 0};  // y goes from 1 to -1 and back
  motion.keyframes[1].velocities = {0, 0, 0, 0, 0, 0, 0, 8, 0};
  const PolynomialSegment<3> path = path_segment(motion, 0, PathKind::kHermite);
  for (const std::string& scheme : all_schemes()) {
    if (scheme == kPathCurves) continue;
    EXPECT_EQ(certify(scheme, motion.segment(0), path).value()[0].upper, std::numbers::pi) << scheme;
  }
  std::vector<ErrorBounds> bounds(1);
  certify_path_curves(path_truth(path, {0, 1}), bounds);
  EXPECT_EQ(bounds[0].upper, std::numbers::pi);
}

TEST(PathCertificates, follow_the_limit_where_a_face_has_no_area_at_an_end) {
  Motion motion = fixtures::make_motion(fixtures::make_soup(1), {{0, 0, 0}, {0, 0, 0}, {0, 0, 0}},
                                        {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
  for (Motion::Keyframe& key : motion.keyframes) key.velocities = {0, 0, 0, 1, 0, 0, 0, 1, 0};
  const PolynomialSegment<3> path = path_segment(motion, 0, PathKind::kHermite);
  for (const char* const scheme : {"linear", "slerp", "polynomial", "circle:timed"})
    EXPECT_LT(certify(scheme, motion.segment(0), path).value()[0].upper, 1e-5) << scheme;
}

TEST(PathCertificates, are_close_on_an_ordinary_mesh) {
  const Motion motion = test::curved_motion({0, 0.3, 0.7, 1}, 1.2, 16, 8);
  const PolynomialSegment<3> path = path_segment(motion, 1, PathKind::kCatmullRom);
  for (const char* const scheme : {"linear", "quadratic", "slerp", "quaternion:matrix", "circle:timed", "recompute"}) {
    const auto certified = certify(scheme, motion.segment(1), path, {}, Threads::kAll);
    ASSERT_TRUE(certified.ok());
    for (const ErrorBounds& bounds : certified.value())
      ASSERT_LE(bounds.upper - bounds.lower, 1e-3 * bounds.upper + 6e-6) << scheme << ", at " << bounds.at;
  }
  const PathTruth truth = path_truth(path, {0, motion.topology.face_count()});
  std::vector<ErrorBounds> bounds(truth.normals.size());
  certify_path_curves(truth, bounds);
  for (const ErrorBounds& each : bounds) ASSERT_LE(each.upper, 1.01 * kPathAngle);
}

// Two corners at one point make no area, for certain; of three on a line, rounding is all that is known.
TEST(PathCertificates, know_a_face_that_never_has_an_area_from_rounding) {
  Motion motion;
  motion.topology = Topology::triangles(5, {0, 1, 1, 0, 1, 2, 0, 1, 3, 0, 3, 4}).value();
  for (int k = 0; k < 4; ++k) {
    const float x = 0.125f * static_cast<float>(k), y = x * x + 0.3f;
    motion.keyframes.push_back(
        {{x, y, 0, 1 + x, y, x, 1 + x, y, x, 2 + x, y, x + x, 0, 1, 2}, static_cast<double>(k), ""});
  }
  motion.connect_as_sequence();
  const PolynomialSegment<3> path = path_segment(motion, 1, PathKind::kCatmullRom);
  const PathTruth truth = path_truth(path, {0, 4});
  std::vector<ErrorBounds> bounds(4);
  certify_path_curves(truth, bounds);
  EXPECT_EQ(bounds[0].upper, 0);
  EXPECT_EQ(bounds[1].upper, 0);
  EXPECT_EQ(bounds[2].upper, std::numbers::pi);
  EXPECT_LT(bounds[3].upper, 1e-5);
}

TEST(PathCertificates, of_a_comparison_hold_every_sample_of_faces_and_vertices) {
  const Motion motion = test::curved_motion({0, 0.3, 0.7, 1}, 1.2, 16, 8);
  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices}) {
    CompareOptions options;
    options.samples = 33;
    options.elements.kind = kind;
    options.path = PathKind::kCatmullRom;
    options.tolerance = 1e-3;
    const Result<Comparison> found = compare(motion, options);
    ASSERT_TRUE(found.ok()) << found.error().text();
    for (const SchemeComparison& row : found.value().schemes) {
      ASSERT_TRUE(row.certified) << row.scheme;
      EXPECT_LE(row.quality.max, row.certified->upper + kOracle) << row.scheme;
      EXPECT_LE(row.certified->upper, 1.1 * row.quality.max + 3e-6) << row.scheme;
      EXPECT_LE(row.certified->lower, row.certified->upper) << row.scheme;
    }
    ASSERT_TRUE(found.value().cheapest);
    EXPECT_EQ(found.value().schemes[*found.value().cheapest].scheme, "exact") << "no other is within 0.001 degrees";
  }
}

}  // namespace
}  // namespace chronormal::certify_path_test
