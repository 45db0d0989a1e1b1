// Compares the certificates that the kernel computes for sixteen elements at once with the certificates of single
// elements. A certificate tells whether float32 or double is accurate enough. The test elements are close to the limits
// of float32 and of double.

#include "normals/curves/kernels/certify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>

#include "chronormal/normals/normal_curves.h"
#include "core/rounding.h"
#include "normals/curves/certificate.h"
#include "normals/curves/kernels/flagged_normals.h"
#include "simd/targets.h"
#include "tests/support/fixtures.h"

namespace chronormal::certify_test {
namespace {

Vec3d vector(fixtures::Random& random) {
  const auto [x, y, z] = random.in_cube(1);
  return {x, y, z};
}

double decade(fixtures::Random& random, double low, double high) { return std::pow(10, random.uniform(low, high)); }

// Draws the control normals of a curve. Most curves come about as close to zero as the limits allow. Some curves are
// ordinary, and some are so hard that the kernel should decide nothing.
BoundedNormals element(fixtures::Random& random) {
  const Vec3d n0 = vector(random);
  BoundedNormals result;
  ControlNormals& c = result.normals;
  c = {n0, vector(random), vector(random)};
  if (random.below(4) != 0) {
    // The curve is (s - k t)^2 n0, where s = 1 - t, plus a small curve, which is in a plane in half of the cases. If k
    // + 1 is a power of two, bisection hits the zero exactly, so the proof must continue down to the smallest interval.
    const double halves[] = {1, 3, 7, 1.0 / 3};
    const double k = random.below(2) == 0 ? halves[random.below(4)] : decade(random, -3, 3);
    const double little = decade(random, -17, 0);
    const Vec3d beside = vector(random), elsewhere = random.below(2) == 0 ? vector(random) : 0.5 * beside;
    c.m = -k * n0 + little * beside;
    c.n1 = (k * k) * n0 + little * elsewhere;
  }
  switch (random.below(24)) {
    case 0:
      c.n0 = {};
      break;
    case 1:
      c = {};
      break;
    case 2:
      c.n1.y =
          random.below(2) == 0 ? std::numeric_limits<double>::infinity() : std::numeric_limits<double>::quiet_NaN();
      break;
    case 3:
      c.m = {0, 1e-200, 0};
      break;
    default:
      break;
  }
  const double scale = random.below(4) == 0 ? decade(random, -20, 20) : 1;
  c = {scale * c.n0, scale * c.m, scale * c.n1};
  if (random.below(2) == 0) {
    const Vec3d* const of[3] = {&c.n0, &c.m, &c.n1};
    for (std::size_t k = 0; k < 3; ++k) result.errors[k] = decade(random, -17, -8) * max_abs(*of[k]);
  }
  return result;
}

struct Decided {
  bool known = false;
  std::optional<Precision> precision;
  FlaggedNormals scaled;
  bool needs_exact = false;
};

Decided decided(const BoundedNormals& c, const PrecisionLimits& limits) {
  const double share = c.largest_share();
  const double largest = largest_component(c.normals), end = std::min(max_abs(c.normals.n0), max_abs(c.normals.n1));
  Decided result;
  bool is_finite = true;
  for (const Vec3d& v : {c.normals.n0, c.normals.m, c.normals.n1}) is_finite &= std::isfinite(sum_abs(v));
  result.known = is_finite && share <= kLargestShare && largest <= kLargestComponent && end >= kSmallestEnd;
  result.precision = precision_for(c.normals, limits);
  const double certain = smallest_certain(share);
  result.scaled = FlaggedNormals::scaled(c.normals, certain);
  result.needs_exact = !result.precision && !stays_certain(c.normals, certain);
  return result;
}

// Compares the certificates of one element with the expected ones. Describes the first fault, or returns "". `alone` is
// true if certificates were requested only for this element.
std::string fault(const TileCertificates& found, std::size_t lane, const Decided& expected, bool alone) {
  const auto has = [lane](std::uint32_t bits) { return (bits >> lane & 1) != 0; };
  if (has(found.known) != expected.known) return expected.known ? "not known" : "known";
  if (!expected.known) return has(found.flagged | found.needs_exact) ? "flagged, but not known" : "";
  if (has(found.flagged) != !expected.precision) return expected.precision ? "flagged" : "not flagged";
  if (has(found.needs_exact) != expected.needs_exact) return expected.needs_exact ? "needs nothing" : "needs exact";
  if (!expected.precision) {
    for (std::size_t k = 0; k < 3; ++k)
      if (found.scaled.limits[k][lane] != expected.scaled.limits[k]) return "certain from another limit on";
    if (found.exponents[lane] != expected.scaled.exponent) return "scaled by another power of two";
    if (!(element_of(found.scaled.normals, lane) == expected.scaled.normals)) return "scaled to something else";
  }
  if (alone && expected.precision && found.precision != *expected.precision) return "has another precision";
  return "";
}

TEST(CertifyTile, decides_as_for_one_element_on_every_target) {
  std::size_t flagged = 0, needing_exact = 0, unknown = 0, of_precision[4] = {};
  fixtures::Random random(20261125);
  for (int round = 0; round < 3000; ++round) {
    const double tolerances[] = {kExactTolerance, 1e-4, 1e-3, 1e-2, 0.1};
    const PrecisionLimits limits = PrecisionLimits::for_tolerance(tolerances[round % 5]);
    BoundedTile tile;
    Decided expected[kTile];
    Precision largest = Precision::k11;
    const auto asked = static_cast<std::uint32_t>(round % 3 == 0 ? 0xFFFF : random.below(0x10000));
    for (std::size_t lane = 0; lane < kTile; ++lane) {
      const BoundedNormals c = element(random);
      put(tile, lane, c);
      expected[lane] = decided(c, limits);
      if ((asked >> lane & 1) == 0) continue;
      unknown += expected[lane].known ? 0U : 1U;
      if (!expected[lane].known) continue;
      flagged += expected[lane].precision ? 0U : 1U;
      needing_exact += expected[lane].needs_exact ? 1U : 0U;
      if (!expected[lane].precision) continue;
      ++of_precision[static_cast<std::size_t>(*expected[lane].precision)];
      largest = std::max(largest, *expected[lane].precision);
    }
    for (const auto target : supported_targets()) {
      const ScopedTarget scope(target);
      TileCertificates all;
      certify_tile(tile, limits, asked, all);
      ASSERT_EQ((all.known | all.flagged | all.needs_exact) & ~asked, 0U);
      ASSERT_EQ(all.precision, largest);
      for (std::size_t lane = 0; lane < kTile; ++lane) {
        if ((asked >> lane & 1) == 0) continue;
        TileCertificates one;
        certify_tile(tile, limits, 1U << lane, one);
        ASSERT_EQ(fault(all, lane, expected[lane], false), "")
            << target_name(target) << " round " << round << " lane " << lane;
        ASSERT_EQ(fault(one, lane, expected[lane], true), "")
            << target_name(target) << " round " << round << " lane " << lane;
      }
    }
  }
  // Makes sure that every possible certificate has occurred often.
  EXPECT_GT(flagged, 3000U);
  EXPECT_GT(needing_exact, 1000U);
  EXPECT_GT(flagged - needing_exact, 1000U);
  EXPECT_GT(unknown, 3000U);
  for (const std::size_t count : of_precision) EXPECT_GT(count, 300U);
}

}  // namespace
}  // namespace chronormal::certify_test
