// Compares the certified error bounds of every scheme with errors that are computed in integers of any size. Each
// element is tested at 64 times. No error may exceed the upper bound of the element; and at the time that the
// certificate names, the error may not be below the lower bound. The test has 600 elements from fixed seeds, or as many
// as the environment variable CHRONORMAL_FULL_CASES says, up to 200,000 (./test --full exact).

#include "chronormal/analysis/certify.h"
#include "chronormal/core/polynomial.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/normals/normal_groups.h"
#include "schemes/curve_scheme.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"
#include "tests/support/scheme_names.h"

namespace chronormal::certify_test {
namespace {

using test::IntegerNormals;
using test::IntegerTime;
using test::IntegerVector;

constexpr std::uint64_t kSeed = 8200;
constexpr std::size_t kTimes = 64;
constexpr double kOracle = 1e-12;  // the largest error of the angles that the oracle computes, in radians

const std::vector<std::string>& all_schemes() {
  static const std::vector<std::string> names = [] {
    std::vector<std::string> all = test::scheme_names();
    all.emplace_back("lagrange:12");
    return all;
  }();
  return names;
}

std::size_t wanted_elements() {
  const char* const full = std::getenv("CHRONORMAL_FULL_CASES");
  const std::size_t cases = full == nullptr ? 600 : static_cast<std::size_t>(std::strtoull(full, nullptr, 10));
  return std::clamp<std::size_t>(cases, 600, 200000);
}

// A scheme that is prepared for the faces of a segment, with the control normals of these faces and the bounds of the
// scheme's errors.
struct Prepared {
  std::unique_ptr<Scheme> scheme;
  std::vector<ControlNormals> normals;
  std::vector<ErrorBounds> bounds;

  Prepared(const std::string& name, const Segment& segment, IndexRange faces, const CertifyOptions& options = {})
      : scheme(make_scheme(name).value()), normals(faces.count), bounds(faces.count) {
    face_control_normals(segment, faces, normals);
    const ElementBlock block{&segment, faces, normals};
    scheme->prepare(block);
    certify(*scheme, block, bounds, options);
  }
  [[nodiscard]] std::vector<Vec3f> shown(double t) const {
    std::vector<float> values(3 * normals.size());
    const auto view = VectorView<float>::packed(values.data(), normals.size());
    scheme->evaluate(t, view);
    std::vector<Vec3f> result(normals.size());
    for (std::size_t i = 0; i < result.size(); ++i) result[i] = view[i];
    return result;
  }
};

double error_of(const Vec3f& shown, const IntegerVector& exact) {
  return test::angle_between(shown, test::direction_of(exact));
}

// Counts the elements of a scheme that violate their error bounds or have no bound, and measures how tight the bounds
// are.
struct Tally {
  std::size_t elements = 0, over = 0, under = 0, crossed = 0, unknown = 0;
  double largest_share = 0;  // largest ratio of a measured error to the upper bound
  double gap = 0;            // sum of upper bound minus lower bound in radians, over the elements with a bound
  std::string first;
};

void judge(const Segment& segment, const std::vector<double>& times, std::vector<Tally>& tallies) {
  const IndexRange faces{0, segment.topology->face_count()};
  std::vector<Prepared> prepared;
  for (const std::string& name : all_schemes()) prepared.emplace_back(name, segment, faces);
  const IntegerNormals oracle(segment);
  for (const double t : times) {
    const std::vector<IntegerVector> exact = oracle.at(IntegerTime::of(t < 0x1p-200 ? 0 : t));
    for (std::size_t s = 0; s < prepared.size(); ++s) {
      const std::vector<Vec3f> shown = prepared[s].shown(t);
      for (std::size_t f = 0; f < faces.count; ++f) {
        if (test::is_zero(exact[f])) continue;
        const double error = error_of(shown[f], exact[f]);
        const double upper = prepared[s].bounds[f].upper;
        if (upper > 0) tallies[s].largest_share = std::max(tallies[s].largest_share, error / upper);
        if (error <= upper + kOracle) continue;
        if (tallies[s].over++ == 0)
          tallies[s].first = std::to_string(error) + " rad at t = " + std::to_string(t) + ", face " +
                             std::to_string(f) + ", above " + std::to_string(upper);
      }
    }
  }
  for (std::size_t s = 0; s < prepared.size(); ++s) {
    Tally& tally = tallies[s];
    for (std::size_t f = 0; f < faces.count; ++f) {
      const ErrorBounds& bounds = prepared[s].bounds[f];
      ++tally.elements;
      if (!(0 <= bounds.lower && bounds.lower <= bounds.upper && bounds.from <= bounds.to)) ++tally.crossed;
      if (bounds.upper >= std::numbers::pi)
        ++tally.unknown;
      else
        tally.gap += bounds.upper - bounds.lower;
      if (bounds.lower == 0 || f % 16 != 0) continue;
      const Prepared alone(all_schemes()[s], segment, {f, 1});
      const IntegerVector exact = oracle.at(IntegerTime::of(bounds.at))[f];
      if (!(error_of(alone.shown(bounds.at)[0], exact) >= bounds.lower - kOracle)) ++tally.under;
    }
  }
}

std::vector<double> some_times(fixtures::Random& random) {
  std::vector<double> times = {0, 1, 0.5, 0x1p-30, 1 - 0x1p-30, 1e-3, 1 - 1e-3, 0x1p-60};
  while (times.size() < kTimes / 2) times.push_back(static_cast<double>(times.size()) / (kTimes / 2));
  while (times.size() < kTimes) times.push_back(random.uniform(0, 1));
  return times;
}

void expect_none_wrong(const std::vector<Tally>& tallies, const std::string& family) {
  for (std::size_t s = 0; s < tallies.size(); ++s) {
    const Tally& tally = tallies[s];
    EXPECT_EQ(tally.over, 0u) << family << ", " << all_schemes()[s] << ": " << tally.first;
    EXPECT_EQ(tally.under, 0u) << family << ", " << all_schemes()[s];
    EXPECT_EQ(tally.crossed, 0u) << family << ", " << all_schemes()[s];
  }
}

TEST(ExactCertificates, are_never_violated_by_hard_motions) {
  const std::size_t wanted = wanted_elements() / 2;
  const auto& families = test::hard_motions();
  for (std::size_t k = 0; k < families.size(); ++k) {
    fixtures::Random random(kSeed + k);
    std::vector<Tally> tallies(all_schemes().size());
    while (tallies[0].elements < wanted / families.size() + 1) {
      const Motion motion = families[k].make(random);
      judge(motion.segment(0), some_times(random), tallies);
    }
    expect_none_wrong(tallies, families[k].name);
  }
}

TEST(ExactCertificates, are_never_violated_by_soups) {
  const std::size_t each = std::max<std::size_t>(wanted_elements() / 10, 1);
  fixtures::Random random(kSeed);
  std::vector<Tally> tallies(all_schemes().size());
  for (const Motion& motion :
       {fixtures::moderate_soup(each), fixtures::large_soup(each), fixtures::needle_soup(each),
        fixtures::far_soup(each), fixtures::soup({.face_count = each, .seed = 9, .motion = 1e-6})}) {
    for (std::size_t first = 0; first < each; first += 400) {
      // Certifies the motion in parts of at most 400 faces. The time of the largest error differs from part to part, so
      // the test covers more times.
      Motion part = motion;
      part.topology = fixtures::make_soup(std::min<std::size_t>(400, each - first));
      for (Motion::Keyframe& keyframe : part.keyframes) {
        keyframe.positions.erase(keyframe.positions.begin(),
                                 keyframe.positions.begin() + static_cast<std::ptrdiff_t>(9 * first));
        keyframe.positions.resize(9 * part.topology.face_count());
      }
      judge(part.segment(0), some_times(random), tallies);
    }
  }
  expect_none_wrong(tallies, "soups");
  for (std::size_t s = 0; s < tallies.size(); ++s)
    std::cout << "  " << all_schemes()[s] << ": " << tallies[s].elements << " elements, " << tallies[s].unknown
              << " unknown, largest share of a bound " << tallies[s].largest_share << ", mean gap "
              << tallies[s].gap / static_cast<double>(tallies[s].elements - tallies[s].unknown) << " rad\n";
}

// If almost nothing moves, the exact error is nearly zero. The scheme of this test uses many slerps, and the error
// bound must contain the rounding errors of all of them.
TEST(ExactCertificates, include_the_rounding_of_many_slerps) {
  const Motion motion = fixtures::soup({.face_count = 150, .seed = 9, .motion = 1e-6});
  const Segment segment = motion.segment(0);
  const Prepared prepared("decasteljau:9", segment, {0, 150});
  const IntegerNormals oracle(segment);
  fixtures::Random random(kSeed);
  double largest = 0;
  for (const double t : some_times(random)) {
    const std::vector<Vec3f> shown = prepared.shown(t);
    const std::vector<IntegerVector> exact = oracle.at(IntegerTime::of(t));
    for (std::size_t f = 0; f < shown.size(); ++f) {
      const double error = error_of(shown[f], exact[f]);
      largest = std::max(largest, error);
      EXPECT_LE(error, prepared.bounds[f].upper) << f << ", t = " << t;
    }
  }
  EXPECT_GT(largest, 2e-7);
}

ErrorBounds bounds_of(const std::string& scheme, const Motion& motion, std::size_t face = 0) {
  return certify(scheme, motion.segment(0)).value()[face];
}

Motion moving(const std::array<fixtures::Point, 3>& from, const std::array<fixtures::Point, 3>& to) {
  return test::soup_of({{from, to}});
}

constexpr std::array<fixtures::Point, 3> kFlat{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}};
constexpr std::array<fixtures::Point, 3> kUpright{{{0, 0, 0}, {1, 0, 0}, {0, 0, 1}}};

TEST(Certificates, meet_an_error_that_is_known_by_hand) {
  // n(t) = (0, -3t, 1-t), and linear interpolation gives (0, -t, 1-t). The tangent of the angle between these two
  // vectors is 2 t (1-t) / ((1-t)^2 + 3 t^2). The tangent is largest at t = 1 / (1 + sqrt 3), where it is 1 / sqrt 3,
  // so the largest angle is 30 degrees.
  std::array<fixtures::Point, 3> long_upright = kUpright;
  long_upright[2][2] = 3;
  const ErrorBounds linear = bounds_of("linear", moving(kFlat, long_upright));
  const double right = std::numbers::pi / 6;
  EXPECT_LE(linear.lower, right + 1e-15);
  EXPECT_GE(linear.upper, right - 1e-15);
  EXPECT_LT(linear.upper - linear.lower, 1e-3 * right);
  EXPECT_NEAR(linear.at, 1 / (1 + std::sqrt(3)), 0.05);
  EXPECT_LE(linear.from, 1 / (1 + std::sqrt(3)) + 0.05);
  EXPECT_GE(linear.to, 1 / (1 + std::sqrt(3)) - 0.05);
  // The scheme linear:scaled chooses the length of one end normal so that the line between the end normals has the
  // directions of n(t). Only rounding errors remain.
  EXPECT_LT(bounds_of("linear:scaled", moving(kFlat, long_upright)).upper, 1e-5);
}

TEST(Certificates, are_half_a_turn_where_the_normal_vanishes_and_say_when) {
  std::array<fixtures::Point, 3> turned = kFlat;
  turned[2][1] = -3;  // the face turns over at t = 1/4
  for (const std::string& scheme : all_schemes()) {
    if (scheme == "recompute") continue;
    EXPECT_EQ(bounds_of(scheme, moving(kFlat, turned)).upper, std::numbers::pi) << scheme;
  }
  // The unit normals at both ends are opposite, so a weighted sum of them is zero at t = 1/2, and changes its direction
  // abruptly there. For the schemes below, the bound is largest at t = 1/4 instead, where n(t) changes its direction
  // abruptly.
  for (const char* const scheme : {"polynomial", "rational", "slerp", "quaternion:optimal", "circle"}) {
    const ErrorBounds bounds = bounds_of(scheme, moving(kFlat, turned));
    EXPECT_NEAR(bounds.from, 0.25, 1e-6) << scheme;
    EXPECT_NEAR(bounds.to, 0.25, 1e-6) << scheme;
  }
  // The scheme `recompute` computes the normal from positions at t, so its normals are accurate right up to the
  // collapse of the face.
  EXPECT_EQ(bounds_of("recompute", moving(kFlat, turned)).upper, 1e-6);
}

TEST(Certificates, are_half_a_turn_where_opposite_ends_cancel) {
  // Vertex c moves around the edge from a to b. The normal turns from +z through -y to -z and is never zero. But the
  // straight line between the normals at both ends passes through zero at t = 1/2.
  const std::vector<Vec3d> at{{0, 0, 1}, {0, -1, 0}, {0, 0, -1}};
  const ControlNormals turning{at[0], at[1], at[2]};
  const Motion still = moving(kFlat, kFlat);
  const Segment segment = still.segment(0);
  for (const char* const name : {"linear", "slerp"}) {
    const auto scheme = make_scheme(name).value();
    const ElementBlock block{&segment, {0, 1}, {&turning, 1}};
    scheme->prepare(block);
    std::vector<ErrorBounds> bounds(1);
    certify(*scheme, block, bounds);
    if (std::string(name) == "linear") {
      EXPECT_EQ(bounds[0].upper, std::numbers::pi);
      EXPECT_NEAR(bounds[0].from, 0.5, 1e-6);
      EXPECT_NEAR(bounds[0].to, 0.5, 1e-6);
    } else {
      // Slerp turns the normal about a fixed axis, perpendicular to the start normal, and does not pass through zero.
      EXPECT_LT(bounds[0].upper, std::numbers::pi);
    }
  }
}

TEST(Certificates, follow_the_limit_where_a_face_has_no_area_at_an_end) {
  std::array<fixtures::Point, 3> point{};  // the face grows out of a point, then keeps its direction
  for (const char* const scheme : {"linear", "slerp", "polynomial", "rational", "circle:timed"}) {
    EXPECT_LT(bounds_of(scheme, moving(point, kFlat)).upper, 1e-5) << scheme;
    EXPECT_LT(bounds_of(scheme, moving(kFlat, point)).upper, 1e-5) << scheme;
    EXPECT_EQ(bounds_of(scheme, moving(point, point)).upper, 0) << scheme;
  }
}

TEST(Certificates, are_close_on_ordinary_meshes) {
  const Motion twist = make_builtin_morph("twist").value();
  for (const char* const scheme : {"linear", "quadratic", "cubic", "slerp", "quaternion:matrix", "circle:timed"}) {
    const std::vector<ErrorBounds> all = certify(scheme, twist.segment(0), {}, Threads::kAll).value();
    for (const ErrorBounds& bounds : all)
      ASSERT_LE(bounds.upper - bounds.lower, 1e-3 * bounds.upper + 4e-6) << scheme << ", at " << bounds.at;
  }
}

TEST(Certificates, of_the_worst_alone_are_as_close_for_the_worst) {
  const Motion motion = fixtures::moderate_soup(100);
  const Segment segment = motion.segment(0);
  CertifyOptions options;
  options.only_worst = true;
  for (const std::string& scheme : all_schemes()) {
    const IndexRange faces{0, 100};
    const Prepared every(scheme, segment, faces), worst(scheme, segment, faces, options);
    const auto largest = [](const Prepared& p, double ErrorBounds::*member) {
      double value = 0;
      for (const ErrorBounds& bounds : p.bounds) value = std::max(value, bounds.*member);
      return value;
    };
    EXPECT_EQ(largest(every, &ErrorBounds::lower), largest(worst, &ErrorBounds::lower)) << scheme;
    EXPECT_LE(largest(worst, &ErrorBounds::upper), largest(every, &ErrorBounds::upper) * (1 + 1e-3) + 1e-5) << scheme;
    EXPECT_GE(largest(worst, &ErrorBounds::upper), largest(every, &ErrorBounds::lower)) << scheme;
  }
}

TEST(Certificates, take_errors_of_the_normals_that_are_given) {
  const Motion motion = fixtures::moderate_soup(50);
  const Segment segment = motion.segment(0);
  const Prepared prepared("slerp", segment, {0, 50});
  std::vector<ControlErrors> errors;
  for (const ControlNormals& c : prepared.normals)
    errors.push_back({1e-3 * max_abs(c.n0), 1e-3 * max_abs(c.m), 1e-3 * max_abs(c.n1)});
  std::vector<ErrorBounds> wider(50);
  certify(*prepared.scheme, {&segment, {0, 50}, prepared.normals}, wider, {}, errors);
  for (std::size_t f = 0; f < 50; ++f) {
    EXPECT_GE(wider[f].upper, prepared.bounds[f].lower + 5e-4) << f;
    EXPECT_LE(wider[f].lower, prepared.bounds[f].upper) << f;
  }
}

TEST(Certificates, give_the_same_bits_on_any_number_of_threads) {
  const Motion motion = fixtures::smooth_morph(40);
  const auto one = certify("circle:timed", motion.segment(0)).value();
  const auto all = certify("circle:timed", motion.segment(0), {}, Threads::kAll).value();
  ASSERT_EQ(one.size(), all.size());
  for (std::size_t f = 0; f < one.size(); ++f) {
    EXPECT_EQ(one[f].lower, all[f].lower);
    EXPECT_EQ(one[f].upper, all[f].upper);
  }
  EXPECT_EQ(certify("no such scheme", motion.segment(0)).error().code, ErrorCode::kUsage);
}

// ---- vertices whose face normals cancel -----------------------------------------------------------------------------

// If the normals of the faces cancel, their sum in double is only rounding error. The certificate must include this
// error, or the normals must be computed more precisely.
TEST(Certificates, are_never_violated_by_vertices_whose_faces_cancel) {
  std::size_t judged = 0, known = 0;
  for (std::uint64_t seed = 0; seed < 60; ++seed) {
    fixtures::Random random(kSeed + 400 + seed);
    const Motion motion = seed % 3 == 0 ? test::cancelling_fan(random) : test::cancelling_star(random);
    const Segment segment = motion.segment(0);
    const NormalGroups groups =
        NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
    const std::size_t count = groups.size();
    const std::vector<ControlNormals> of_faces = all_face_control_normals(segment);
    std::vector<ControlNormals> plain(count);
    group_control_normals(groups, of_faces, {0, count}, plain);
    std::vector<ControlErrors> plain_errors(count);
    for (std::size_t e = 0; e < count; ++e) {
      for (const std::uint32_t f : groups.faces(e)) {
        const ControlNormals& face = of_faces[f];
        const double share = 0x1p-26 + 0x1p-40;
        plain_errors[e][0] += share * max_abs(face.n0);
        plain_errors[e][1] += share * max_abs(face.m);
        plain_errors[e][2] += share * max_abs(face.n1);
      }
    }
    const IntegerNormals oracle(segment);
    for (const char* const name : {"polynomial", "linear", "cubic", "slerp"}) {
      for (const bool is_settled : {true, false}) {
        const std::vector<ControlNormals> normals = is_settled ? all_group_control_normals(segment, groups) : plain;
        const ElementBlock block{&segment, {0, count}, normals, false};
        const auto scheme = make_scheme(name).value();
        scheme->prepare(block);
        std::vector<ErrorBounds> bounds(count);
        certify(*scheme, block, bounds, {}, is_settled ? std::span<const ControlErrors>() : plain_errors);
        std::vector<float> shown(3 * count);
        for (const double t : {0.0, 1.0, 0.5, random.uniform(0, 1)}) {
          scheme->evaluate(t, VectorView<float>::packed(shown.data(), count));
          const std::vector<IntegerVector> exact = oracle.at(IntegerTime::of(t));
          for (std::size_t e = 0; e < count; ++e) {
            const IntegerVector n = test::sum_of(exact, groups.faces(e));
            if (test::is_zero(n)) continue;
            const Vec3f u{shown[3 * e], shown[3 * e + 1], shown[3 * e + 2]};
            const bool is_shown = u.x != 0 || u.y != 0 || u.z != 0;
            const double error = is_shown ? error_of(u, n) : std::numbers::pi;
            EXPECT_LE(error, bounds[e].upper + kOracle) << name << ", seed " << seed << ", vertex " << e << ", t " << t;
            ++judged;
            if (is_settled && name == std::string("polynomial") && bounds[e].upper < 1e-5) ++known;
          }
        }
      }
    }
  }
  EXPECT_GT(judged, 5000u);
  EXPECT_GT(known, 500u) << "control normals that were made of integers have small bounds";
}

// ---- schemes that are not part of the library -----------------------------------------------------------------------

// Eases t at both ends: returns 3 t^2 - 2 t^3.
double eased(double t) { return t * t * (3 - 2 * t); }

class EasedLine {
 public:
  [[nodiscard]] std::size_t plane_count() const { return 6; }
  [[nodiscard]] Formula formula() const { return Formula::kSumOf2; }
  void fit(ElementMotion& element, double* c) const {
    put_vector(c, 0, element.start().vector);
    put_vector(c, 1, element.end().vector);
  }
  void shared(double t, float* values) const {
    values[0] = static_cast<float>(1 - eased(t));
    values[1] = static_cast<float>(eased(t));
  }
};

class KnownEasedLine : public EasedLine {
 public:
  [[nodiscard]] WeightBasis basis() const { return {3, {{1, 1, 0, 0}, {0, 0, 1, 1}}}; }
};

// A scheme that is a sum of four vectors. Their weights are polynomials of degree 9 in t: the Bernstein polynomials of
// degree 3, taken at the eased time. No other scheme has such weights.
class LongSum {
 public:
  [[nodiscard]] std::size_t plane_count() const { return 12; }
  [[nodiscard]] Formula formula() const { return Formula::kSumOf4; }
  void fit(ElementMotion& element, double* c) const {
    for (std::size_t k = 0; k < 4; ++k) put_vector(c, k, element.node(static_cast<double>(k) / 3));
  }
  void shared(double t, float* values) const {
    const double x = eased(t), y = 1 - x;
    const double weights[] = {y * y * y, 3 * x * y * y, 3 * x * x * y, x * x * x};
    for (std::size_t k = 0; k < 4; ++k) values[k] = static_cast<float>(weights[k]);
  }
  [[nodiscard]] WeightBasis basis() const {
    const Bernstein<double, 3> x = {0, 0, 1, 1}, y = {1, 1, 0, 0};
    const auto product = [](const Bernstein<double, 3>& a, const Bernstein<double, 3>& b, const Bernstein<double, 3>& c,
                            double factor) {
      WeightBasis::Coefficients result{};
      for (std::size_t i = 0; i <= 3; ++i)
        for (std::size_t j = 0; j <= 3; ++j)
          for (std::size_t k = 0; k <= 3; ++k)
            result[i + j + k] +=
                factor * a[i] * b[j] * c[k] * binomial(3, i) * binomial(3, j) * binomial(3, k) / binomial(9, i + j + k);
      return result;
    };
    return {9, {product(y, y, y, 1), product(x, y, y, 3), product(x, x, y, 3), product(x, x, x, 1)}};
  }
};

// A scheme that follows a great arc, at the eased time. certify() knows no formula for this curve.
class EasedArc {
 public:
  [[nodiscard]] std::size_t plane_count() const { return 7; }
  [[nodiscard]] Formula formula() const { return Formula::kGreatArc; }
  void fit(ElementMotion& element, double* c) const {
    const Vec3d u0 = element.start().vector, u1 = element.end().vector, across = u1 - dot(u0, u1) * u0;
    put_vector(c, 0, u0);
    put_vector(c, 1, across == Vec3d{} ? u0 : unit(across));
    c[6] = angle_between(u0, u1);
  }
  void shared(double t, float* values) const { values[0] = static_cast<float>(eased(t)); }
};

// A scheme that does not use the framework of curve_scheme.h, and gives certify() no information about itself.
class Silent final : public Scheme {
 public:
  void prepare(const ElementBlock& block) override { count_ = block.elements.count; }
  std::size_t evaluate(double /*t*/, VectorView<float> result) const noexcept override {
    for (std::size_t i = 0; i < count_; ++i) result.set(i, {1, 0, 0});
    return 0;
  }
  [[nodiscard]] std::size_t fallback_count() const noexcept override { return 0; }
  [[nodiscard]] std::size_t bytes() const noexcept override { return 0; }
  [[nodiscard]] OperationCounts operations() const override { return {}; }

 private:
  std::size_t count_ = 0;
};

// Measures the errors of a scheme at 401 times and fails if an error exceeds its bound. Returns the largest error, in
// radians, over all elements with a bound below half a turn, and adds the number of these elements to `known`.
double held_against_samples(Scheme& scheme, std::size_t& known) {
  double largest = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Motion motion =
        fixtures::soup({.face_count = 24, .seed = kSeed + seed, .motion = 0.5 * static_cast<double>(seed)});
    const Segment segment = motion.segment(0);
    const std::size_t count = motion.topology.face_count();
    std::vector<ControlNormals> normals(count);
    face_control_normals(segment, {0, count}, normals);
    const ElementBlock block{&segment, {0, count}, normals};
    scheme.prepare(block);
    std::vector<ErrorBounds> bounds(count);
    certify(scheme, block, bounds);
    const IntegerNormals oracle(segment);
    std::vector<float> shown(3 * count);
    const auto view = VectorView<float>::packed(shown.data(), count);
    for (std::size_t f = 0; f < count; ++f) known += bounds[f].upper < std::numbers::pi ? 1U : 0U;
    for (int i = 0; i <= 400; ++i) {
      const double t = i / 400.0;
      scheme.evaluate(t, view);
      const std::vector<IntegerVector> exact = oracle.at(IntegerTime::of(t));
      for (std::size_t f = 0; f < count; ++f) {
        const double error = error_of(view[f], exact[f]);
        EXPECT_LE(error, bounds[f].upper + kOracle) << "face " << f << " of soup " << seed << " at " << t;
        if (bounds[f].upper < std::numbers::pi) largest = std::max(largest, error);
      }
    }
  }
  return largest;
}

TEST(Certificates, claim_nothing_of_a_scheme_that_says_too_little_of_itself) {
  CurveScheme<EasedLine> line{EasedLine{}};
  CurveScheme<EasedArc> arc{EasedArc{}};
  Silent silent;
  for (Scheme* const scheme :
       {static_cast<Scheme*>(&line), static_cast<Scheme*>(&arc), static_cast<Scheme*>(&silent)}) {
    std::size_t known = 0;
    (void)held_against_samples(*scheme, known);
    EXPECT_EQ(known, 0u);
  }
}

TEST(Certificates, hold_for_a_scheme_that_brings_its_own_weights) {
  CurveScheme<KnownEasedLine> line{KnownEasedLine{}};
  CurveScheme<LongSum> long_sum{LongSum{}};
  for (Scheme* const scheme : {static_cast<Scheme*>(&line), static_cast<Scheme*>(&long_sum)}) {
    std::size_t known = 0;
    EXPECT_GT(held_against_samples(*scheme, known), 0.05);
    EXPECT_GT(known, 40u);
  }
}

// If a scheme is a weighted sum, each weight must equal the polynomial that the scheme states for it.
TEST(Certificates, know_the_weights_of_all_sums) {
  const auto weight_at = [](const WeightBasis& basis, std::size_t k, double t) {
    double value = 0;
    for (std::size_t i = 0; i <= basis.degree(); ++i)
      value += binomial(basis.degree(), i) * std::pow(1 - t, basis.degree() - i) * std::pow(t, i) * basis.weight(k)[i];
    return value;
  };
  std::size_t sums = 0;
  const Motion motion = fixtures::soup({.face_count = 3, .seed = 5, .motion = 0.3});
  const Segment segment = motion.segment(0);
  for (const std::string& name : all_schemes()) {
    const Prepared prepared(name, segment, {0, 3});
    const auto fitted = prepared.scheme->fitted_curves();
    EXPECT_EQ(fitted == nullptr, prepared.scheme->is_exact()) << name;
    if (fitted == nullptr || !fitted->basis) continue;
    ++sums;
    const WeightBasis& basis = *fitted->basis;
    ASSERT_EQ(3 * basis.count(), fitted->coefficients.plane_count) << name;
    for (const double t : {0.0, 0.2, 0.37, 0.5, 1.0}) {
      const std::vector<Vec3f> shown = prepared.shown(t);
      for (std::size_t f = 0; f < 3; ++f) {
        Vec3d sum;
        for (std::size_t k = 0; k < basis.count(); ++k)
          sum = sum + weight_at(basis, k, t) * to_double(coefficients_of(fitted->coefficients, f).vector(k));
        EXPECT_LT(angle_between(sum, to_double(shown[f])), 2e-6 * basis.most_weight()) << name << " at " << t;
      }
    }
  }
  EXPECT_GE(sums, 9u);
}

}  // namespace
}  // namespace chronormal::certify_test
