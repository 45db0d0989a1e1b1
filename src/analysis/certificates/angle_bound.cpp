#include "analysis/certificates/angle_bound.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include "core/portable_math.h"
#include "core/rounding.h"

namespace chronormal::inline internal {
namespace {

constexpr double kHalfTurn = 3.14159265358979323846;

// The length of a vector below which the float32 formulas of schemes do not scale the vector to length 1, but use a
// fallback.
constexpr double kShortest = 1.1e-8;

// A bound of the rounding error of a sum of a few products, where each product is at most 1.
constexpr double kRounding = 32 * kUnitRoundoff;

// Entry [i][j] is the factor with which coefficient i of a polynomial of degree M, times coefficient j of a polynomial
// of degree N, enters coefficient i + j of the product of the two polynomials.
template <std::size_t M, std::size_t N>
constexpr auto kShares = [] {
  std::array<std::array<double, N + 1>, M + 1> shares{};
  for (std::size_t i = 0; i <= M; ++i) {
    for (std::size_t j = 0; j <= N; ++j) shares[i][j] = binomial(M, i) * binomial(N, j) / binomial(M + N, i + j);
  }
  return shares;
}();

// Returns an upper bound of asin(x) in radians. The bound is pi / 2 for x >= 1.
double arc_sine_bound(double x) {
  if (!(x < 1)) return kHalfTurn / 2;
  return x <= 0.5 ? x * (1 + 0.25 * x * x) : x * (kHalfTurn / 2);
}

// Returns p(1/2) of a quadratic in Bernstein form.
template <class T>
T in_the_middle(const Bernstein<T, 2>& p) {
  return 0.25 * (p[0] + p[2]) + 0.5 * p[1];
}
}  // namespace

double largest_angle(const CurvePiece& curve, const NormalPiece& normal) noexcept {
  constexpr std::size_t kDegree = 3 + 2;
  const auto& [p, radius, middle, middle_radius, angle] = curve;
  const auto& [n, error] = normal;
  Bernstein<Vec3d, kDegree> cross_products{};
  Bernstein<double, kDegree> dot_products{};
  for (std::size_t i = 0; i < p.size(); ++i) {
    for (std::size_t j = 0; j < n.size(); ++j) {
      const Vec3d shared = kShares<3, 2>[i][j] * p[i];
      cross_products[i + j] = cross_products[i + j] + cross(shared, n[j]);
      dot_products[i + j] += dot(shared, n[j]);
    }
  }
  Bernstein<double, 2 * kDegree> cross_squares{}, dot_squares{};
  for (std::size_t i = 0; i <= kDegree; ++i) {
    cross_squares[2 * i] += kShares<kDegree, kDegree>[i][i] * dot(cross_products[i], cross_products[i]);
    dot_squares[2 * i] += kShares<kDegree, kDegree>[i][i] * dot_products[i] * dot_products[i];
    for (std::size_t j = i + 1; j <= kDegree; ++j) {
      const double share = 2 * kShares<kDegree, kDegree>[i][j];
      cross_squares[i + j] += share * dot(cross_products[i], cross_products[j]);
      dot_squares[i + j] += share * dot_products[i] * dot_products[j];
    }
  }

  double p_square = 0, n_square = 0, largest_cross = 0, largest_dot = 0;
  for (const Vec3d& v : p) p_square = std::max(p_square, dot(v, v));
  for (const Vec3d& v : n) n_square = std::max(n_square, dot(v, v));
  for (const Vec3d& v : cross_products) largest_cross = std::max(largest_cross, dot(v, v));
  for (const double d : dot_products) largest_dot = std::max(largest_dot, std::fabs(d));
  const double p_length = std::sqrt(p_square), n_length = std::sqrt(n_square);
  if (!(p_length > 0 && n_length > 0 && std::isfinite(p_length))) return kHalfTurn;
  // The slacks bound the rounding errors of |S|^2 and of D^2, where S = p x n and D = p . n. The rounding of S and D
  // themselves counts as an error of p.
  const double cross_slack = kRounding * largest_cross, dot_slack = kRounding * largest_dot * largest_dot;
  const bool is_ahead = *std::min_element(dot_products.begin(), dot_products.end()) > kRounding * p_length * n_length;

  double smallest = std::numeric_limits<double>::infinity();
  // Bounds of the square of tan(angle), from above and from below.
  double steepest = 0, flattest = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k <= 2 * kDegree; ++k) {
    smallest = std::min(smallest, cross_squares[k] + dot_squares[k]);
    const double below = dot_squares[k] - dot_slack;
    steepest = std::max(steepest, below > 0 ? (std::max(cross_squares[k], 0.0) + cross_slack) / below
                                            : std::numeric_limits<double>::infinity());
    flattest =
        std::min(flattest, std::max(cross_squares[k] - cross_slack, 0.0) / (std::max(dot_squares[k], 0.0) + dot_slack));
  }
  smallest -= cross_slack + dot_slack;
  if (!(smallest > 0)) return kHalfTurn;
  const double shortest_product = std::sqrt(smallest), shortest_p = shortest_product / n_length,
               shortest_n = shortest_product / p_length;
  if (!(shortest_p - radius > kShortest)) return kHalfTurn;

  const double between =
      is_ahead ? portable::atan(std::sqrt(steepest)) : kHalfTurn - portable::atan(std::sqrt(flattest));
  const double of_normal = *std::max_element(error.begin(), error.end());
  const double turned =
      arc_sine_bound((radius + kRounding * p_length) / shortest_p) + arc_sine_bound(of_normal / shortest_n) + angle;
  return std::min(kHalfTurn, between * (1 + kRounding) + turned * (1 + kRounding));
}

MiddleAngle middle_angle(const CurvePiece& curve, const NormalPiece& normal) noexcept {
  const Vec3d n = in_the_middle(normal.n);
  const double error = in_the_middle(normal.error);
  const double p_length = std::sqrt(dot(curve.middle, curve.middle)), n_length = std::sqrt(dot(n, n));
  if (!(p_length - curve.middle_radius > kShortest) || !(n_length > error)) return {0, kHalfTurn};
  const double uncertainty = arc_sine_bound(curve.middle_radius / p_length + kRounding) +
                             arc_sine_bound(error / n_length + kRounding) + curve.angle;
  return {angle_between(curve.middle, n), std::min(kHalfTurn, uncertainty)};
}

}  // namespace chronormal::inline internal
