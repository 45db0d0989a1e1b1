// Tests the fast search of the scheme quaternion:optimal on every instruction set, and which elements it leaves to the
// slow search. oracle_test.cpp compares the arcs that the searches find with a dense search.
#include "schemes/kernels/optimal_arcs.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <vector>

#include "schemes/mean_error.h"
#include "simd/targets.h"
#include "tests/support/fixtures.h"

namespace chronormal::optimal_arcs_test {
namespace {

Vec3d vector(fixtures::Random& random) {
  const fixtures::Point p = random.in_cube(1);
  return {p[0], p[1], p[2]};
}

// Makes elements whose normals turn by about `turn` radians. The path of a normal deviates from a straight line by
// about `bend` times the turn.
std::vector<ControlNormals> turning(fixtures::Random& random, double turn, double bend, std::size_t count) {
  std::vector<ControlNormals> normals;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3d n0 = vector(random), n1 = n0 + (turn * length(n0)) * vector(random);
    normals.push_back({n0, 0.5 * (n0 + n1) + (turn * bend * length(n0)) * vector(random), n1});
  }
  return normals;
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0;
}

TEST(OptimalArcs, have_the_same_bits_on_every_instruction_set_and_in_any_company) {
  fixtures::Random random(3);
  std::vector<ControlNormals> normals;
  for (const double turn : {1e-4, 0.05, 0.4, 1.0})
    for (const double bend : {0.0, 0.3, 2.0})
      for (const ControlNormals& n : turning(random, turn, bend, 21)) normals.push_back(n);
  std::vector<double> expected;
  for (const ControlNormals& n : normals) {
    double phi = 0;
    find_optimal_arcs({&n, 1}, {&phi, 1});
    expected.push_back(std::isnan(phi) ? -9 : phi);
  }
  for (const std::int64_t target : supported_targets()) {
    const ScopedTarget scoped(target);
    std::vector<double> phis(normals.size());
    find_optimal_arcs(normals, phis);
    for (double& phi : phis) phi = std::isnan(phi) ? -9 : phi;
    EXPECT_TRUE(same_bits(phis, expected)) << target_name(target);
  }
}

TEST(OptimalArcs, are_within_a_few_ten_thousandths_of_the_best_of_many) {
  fixtures::Random random(4);
  for (const double turn : {1e-3, 0.05, 0.4}) {
    std::size_t found = 0;
    const std::vector<ControlNormals> normals = turning(random, turn, 0.3, 200);
    std::vector<double> phis(normals.size());
    find_optimal_arcs(normals, phis);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      if (std::isnan(phis[i])) continue;
      ++found;
      const CircleFamily circles(unit_normal_at(normals[i], 0).vector, unit_normal_at(normals[i], 1).vector);
      const ExactSamples exact(normals[i]);
      const double error = exact.mean_error(circles.arc(phis[i]));
      double best = error;
      // The first samples cover the whole family of arcs. The second samples are close to the arc that the search
      // found.
      for (int k = -200; k <= 200; ++k) {
        best = std::min(best, exact.mean_error(circles.arc(k * kPi / 400)));
        best = std::min(best, exact.mean_error(circles.arc(phis[i] + 1e-4 * k)));
      }
      EXPECT_LE(error, 1.0003 * best + 1e-9) << "turn " << turn << ", element " << i;
    }
    EXPECT_GT(found, 150U) << turn;
  }
}

TEST(OptimalArcs, leave_what_is_not_mild_to_others) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  const std::vector<ControlNormals> normals = {
      {{}, {}, {}},                    // the normal is always zero
      {x, x, x},                       // no turn
      {x, x, -x},                      // the ends are opposite
      {x, x + y, y},                   // more than a radian
      {x, -0.98 * x, x + 0.1 * y},     // a fast turn in between
      {{}, x, y},                      // zero at t = 0
      {x, 0.5 * x + z, x + 1e-3 * y},  // a path that goes far out and back
  };
  std::vector<double> phis(normals.size());
  find_optimal_arcs(normals, phis);
  for (std::size_t i = 0; i < phis.size(); ++i) EXPECT_TRUE(std::isnan(phis[i])) << i;
}

}  // namespace
}  // namespace chronormal::optimal_arcs_test
