#include "chronormal/core/polynomial.h"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <cmath>
#include <vector>

#include "chronormal/core/vec3.h"

namespace chronormal::polynomial_test {
namespace {

// Evaluates a quartic in Bernstein form by the definition, term by term.
double bernstein_sum(const Bernstein<double, 4>& b, double t) {
  double sum = 0;
  for (int k = 0; k <= 4; ++k)
    sum += std::tgamma(5) / std::tgamma(k + 1) / std::tgamma(5 - k) * std::pow(1 - t, 4 - k) * std::pow(t, k) *
           b[static_cast<std::size_t>(k)];
  return sum;
}

Bernstein<double, 4> some_quartic() {
  const auto coefficient = [] { return 0.01 * *rc::gen::inRange(-1000, 1000); };
  return {coefficient(), coefficient(), coefficient(), coefficient(), coefficient()};
}

double some_t() { return *rc::gen::inRange(0, 1001) / 1000.0; }

RC_GTEST_PROP(Polynomial, evaluation_is_the_sum_of_its_bernstein_terms, ()) {
  const auto p = some_quartic();
  const double t = some_t();
  RC_ASSERT(std::fabs(evaluate(p, t) - bernstein_sum(p, t)) < 1e-12);
}

RC_GTEST_PROP(Polynomial, power_form_and_bernstein_form_are_the_same_curve, ()) {
  const auto p = some_quartic();
  const auto power = to_power(p);
  const double t = some_t();
  RC_ASSERT(std::fabs(evaluate(power, t) - bernstein_sum(p, t)) < 1e-11);
  const auto back = to_bernstein(power);
  for (std::size_t k = 0; k < 5; ++k) RC_ASSERT(std::fabs(back[k] - p[k]) < 1e-12);
}

RC_GTEST_PROP(Polynomial, restriction_reparametrises_the_same_curve, ()) {
  const auto p = some_quartic();
  const double t0 = *rc::gen::inRange(0, 500) / 1000.0, t1 = *rc::gen::inRange(501, 1001) / 1000.0, t = some_t();
  RC_ASSERT(std::fabs(evaluate(restrict_to(p, t0, t1), t) - bernstein_sum(p, t0 + t * (t1 - t0))) < 1e-12);
}

RC_GTEST_PROP(Polynomial, halves_meet_at_the_split, ()) {
  const auto p = some_quartic();
  const double t = some_t();
  const auto [before, after] = split(p, t);
  RC_ASSERT(before.back() == after.front());
  RC_ASSERT(before.front() == p.front());
  RC_ASSERT(after.back() == p.back());
}

TEST(Polynomial, ends_are_exact_and_vectors_work_too) {
  const Bernstein<Vec3d, 2> p = {Vec3d{1, 2, 3}, Vec3d{0, 7, 1}, Vec3d{-1, 0, 0.1}};
  EXPECT_EQ(evaluate(p, 0), p[0]);
  EXPECT_EQ(evaluate(p, 1), p[2]);
  EXPECT_EQ(evaluate(p, 0.5), (Vec3d{0, 4, 1.275}));
}

RC_GTEST_PROP(Polynomial, the_product_is_the_product_at_every_t, ()) {
  const auto p = some_quartic(), q = some_quartic();
  const double t = some_t();
  RC_ASSERT(std::fabs(evaluate(multiply(p, q), t) - bernstein_sum(p, t) * bernstein_sum(q, t)) < 1e-11);
}

TEST(Polynomial, vectors_multiply_by_their_dot_product) {
  const Bernstein<Vec3d, 1> p = {Vec3d{1, 0, 0}, Vec3d{0, 2, 0}}, q = {Vec3d{3, 1, 0}, Vec3d{0, 4, 5}};
  EXPECT_EQ(multiply(p, q, dot<double>), (Bernstein<double, 2>{3, 1, 8}));
}

Bernstein<double, 3> cubic_with_roots(double a, double b, double c) {
  return to_bernstein(Power<double, 3>{{-a * b * c, a * b + b * c + c * a, -(a + b + c), 1}});
}

RC_GTEST_PROP(Polynomial, roots_are_found_where_they_were_put, ()) {
  // The roots are at least 1e-2 apart, and some are outside of [0, 1].
  const int a = *rc::gen::inRange(-100, 30), b = *rc::gen::inRange(31, 60), c = *rc::gen::inRange(61, 200);
  std::vector<double> expected;
  for (const int r : {a, b, c}) {
    if (0 <= r && r <= 100) expected.push_back(r / 100.0);
  }
  const auto roots = roots_in_unit_interval(cubic_with_roots(a / 100.0, b / 100.0, c / 100.0));
  // Roots at 0 and 1 are skipped, since rounding decides whether they are inside the interval.
  RC_PRE(a != 0 && c != 100);
  RC_ASSERT(roots.count == expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) RC_ASSERT(std::fabs(roots.t[i] - expected[i]) < 1e-12);
}

TEST(Polynomial, roots_at_the_ends_are_roots) {
  const auto roots = roots_in_unit_interval(Bernstein<double, 2>{0, -1, 0});  // the polynomial -2 t (1 - t)
  ASSERT_EQ(roots.count, 2u);
  EXPECT_EQ(roots.t[0], 0);
  EXPECT_EQ(roots.t[1], 1);
}

TEST(Polynomial, a_root_on_a_subdivision_point_is_found_once) {
  const auto roots = roots_in_unit_interval(Bernstein<double, 1>{-1, 1});  // the polynomial 2 t - 1
  ASSERT_EQ(roots.count, 1u);
  EXPECT_NEAR(roots.t[0], 0.5, 1e-15);
}

TEST(Polynomial, zero_everywhere_has_no_single_root) {
  const auto roots = roots_in_unit_interval(Bernstein<double, 2>{0, 0, 0});
  EXPECT_TRUE(roots.everywhere);
  EXPECT_EQ(roots.count, 0u);
}

TEST(Polynomial, no_sign_change_means_no_root) {
  const auto roots = roots_in_unit_interval(Bernstein<double, 2>{1, -0.9, 1});  // its minimum is 0.05
  EXPECT_EQ(roots.count, 0u);
  EXPECT_FALSE(roots.everywhere);
}

}  // namespace
}  // namespace chronormal::polynomial_test
