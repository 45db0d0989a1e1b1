#include "analysis/fits/delta_fit.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

namespace chronormal::delta_fit_test {
namespace {

// Makes deltas for three elements: target 0 moves all three, target 1 the last two, and target 2 only the last.
DeltaNormals some_deltas(std::mt19937& random) {
  std::uniform_real_distribution<float> number(-1, 1);
  DeltaNormals result;
  for (int i = 0; i < 9; ++i) result.base.push_back(number(random));
  for (std::uint32_t first = 0; first < 3; ++first) {
    BlendTarget target;
    for (std::uint32_t e = first; e < 3; ++e) {
      target.vertices.push_back(e);
      for (int c = 0; c < 3; ++c) target.deltas.push_back(number(random));
    }
    result.deltas.push_back(target);
  }
  return result;
}

// Adds a pose with the given weights to the fit. The fit must come close to the normals that the deltas `wanted` give
// in this pose.
void ask_for(const DeltaNormals& wanted, const std::vector<double>& weights, DeltaFit& fit) {
  std::vector<Vec3d> shown(3), missing(3);
  shown_normals(fit.deltas(), weights, shown);
  shown_normals(wanted, weights, missing);
  for (std::size_t e = 0; e < 3; ++e) missing[e] = missing[e] - shown[e];
  fit.add(weights, missing);
}

double largest_difference(const DeltaNormals& a, const DeltaNormals& b, std::size_t target) {
  double largest = 0;
  for (std::size_t i = 0; i < a.deltas[target].deltas.size(); ++i)
    largest = std::max(largest, std::fabs(double{a.deltas[target].deltas[i]} - double{b.deltas[target].deltas[i]}));
  return largest;
}

TEST(DeltaFit, finds_the_deltas_that_were_asked_for) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    DeltaNormals wanted = some_deltas(random), start = some_deltas(random);
    start.base = wanted.base;
    DeltaFit fit(start);
    std::uniform_real_distribution<double> weight(-1, 2);
    for (int row = 0; row < 8; ++row) ask_for(wanted, {weight(random), weight(random), weight(random)}, fit);
    fit.solve();
    for (std::size_t k = 0; k < 3; ++k) EXPECT_LT(largest_difference(fit.deltas(), wanted, k), 1e-5);
  }
}

TEST(DeltaFit, what_no_row_tells_stays_as_it_was) {
  std::mt19937 random(1);
  DeltaNormals wanted = some_deltas(random), start = some_deltas(random);
  start.base = wanted.base;
  DeltaFit fit(start);
  for (const double w : {0.25, 0.5, 1.0}) ask_for(wanted, {w, 0, 0}, fit);
  fit.solve();
  EXPECT_LT(largest_difference(fit.deltas(), wanted, 0), 1e-5);
  EXPECT_EQ(fit.deltas().deltas[1].deltas, start.deltas[1].deltas);
  EXPECT_EQ(fit.deltas().deltas[2].deltas, start.deltas[2].deltas);
  // solve() uses up the rows that add() has added, so a second solve() changes nothing.
  fit.solve();
  EXPECT_LT(largest_difference(fit.deltas(), wanted, 0), 1e-5);
}

TEST(DeltaFit, leaves_the_smallest_sum_of_squares) {
  // A linear function of w cannot equal w^2. The best linear fit at w = 1/2 and w = 1 is (sum w^3 / sum w^2) w = 0.9 w.
  DeltaNormals start;
  start.base = {0, 0, 1};
  start.deltas.push_back({"", {0}, {0, 0, 0}});
  DeltaFit fit(start);
  for (const double w : {0.5, 1.0}) fit.add(std::vector<double>{w}, std::vector<Vec3d>{{w * w, 0, 0}});
  fit.solve();
  EXPECT_NEAR(fit.deltas().deltas[0].deltas[0], 0.9, 1e-6);
}

}  // namespace
}  // namespace chronormal::delta_fit_test
