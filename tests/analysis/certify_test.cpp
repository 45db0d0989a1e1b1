// Certificates of every scheme against whole numbers of any size: at 64 exact times each, nothing is above the upper
// bound, and at the time that is named the error is not below the lower one. 4,000 elements from fixed seeds, and as many
// as CHRONORMAL_FULL_CASES asks for, 200,000 at most (./test --full exact).

#include "chronormal/analysis/certify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <numbers>
#include <string>
#include <vector>

#include "chronormal/io/builtin_morphs.h"
#include "chronormal/normals/normal_groups.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"

namespace chronormal::certify_test {
namespace {

using test::IntegerNormals;
using test::IntegerTime;
using test::IntegerVector;

constexpr std::uint64_t kSeed = 8200;
constexpr std::size_t kTimes = 64;
constexpr double kOracle = 1e-12;  // radians

const std::vector<std::string>& all_schemes() {
  static const std::vector<std::string> names = {"recompute",
                                                 "polynomial",
                                                 "rational",
                                                 "linear",
                                                 "quadratic",
                                                 "cubic",
                                                 "lagrange:5",
                                                 "lagrange:12",
                                                 "linear:scaled",
                                                 "slerp",
                                                 "decasteljau:4",
                                                 "quaternion:matrix",
                                                 "quaternion:edge",
                                                 "quaternion:polar",
                                                 "quaternion:random:3",
                                                 "quaternion:optimal",
                                                 "circle",
                                                 "circle:timed"};
  return names;
}

std::size_t wanted_elements() {
  const char* const full = std::getenv("CHRONORMAL_FULL_CASES");
  const std::size_t cases = full == nullptr ? 4000 : static_cast<std::size_t>(std::strtoull(full, nullptr, 10));
  return std::clamp<std::size_t>(cases, 4000, 200000);
}

// A scheme on the faces of a segment.
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

// What was found of one scheme.
struct Tally {
  std::size_t elements = 0, over = 0, under = 0, crossed = 0, unknown = 0;
  double largest_share = 0;  // of an upper bound that a sample came to
  double gap = 0;            // summed, of those that are known
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
  for (const Motion& motion : {fixtures::moderate_soup(each), fixtures::large_soup(each), fixtures::needle_soup(each),
                               fixtures::far_soup(each), fixtures::graded_soup(each)}) {
    for (std::size_t first = 0; first < each; first += 400) {
      // In parts, so that the times differ.
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

}  // namespace
}  // namespace chronormal::certify_test
