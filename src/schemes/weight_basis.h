/// The weights in a sum of vectors, as polynomials in t. Certificates need them in addition to the coefficients of a
/// scheme.
#ifndef CHRONORMAL_SCHEMES_WEIGHT_BASIS_H_
#define CHRONORMAL_SCHEMES_WEIGHT_BASIS_H_

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace chronormal::inline internal {

/// Restrict a polynomial, given by its Bernstein coefficients, to the part after t, or to the part before t. Both
/// functions change the coefficients in place, by de Casteljau's algorithm.
template <class T>
void keep_after(std::span<T> p, double t) {
  for (std::size_t level = 1; level < p.size(); ++level) {
    for (std::size_t k = 0; k + level < p.size(); ++k) p[k] = (1 - t) * p[k] + t * p[k + 1];
  }
}
template <class T>
void keep_before(std::span<T> p, double t) {
  for (std::size_t level = 1; level < p.size(); ++level) {
    for (std::size_t k = p.size() - 1; k >= level; --k) p[k] = (1 - t) * p[k - 1] + t * p[k];
  }
}
template <class T>
void restrict_in_place(std::span<T> p, double a, double b) {
  keep_before(p, b);
  if (a > 0) keep_after(p, a / b);
}

class WeightBasis {
 public:
  /// The largest degree of the weights. Lagrange weights of a higher degree are so large that results in float32 are
  /// nothing but rounding error.
  static constexpr std::size_t kMostDegree = 27;
  using Coefficients = std::array<double, kMostDegree + 1>;

  /// Creates a basis from the Bernstein coefficients of each weight. Two examples are the weights 1 - t and t, and the
  /// eased weights 1 - 3 t^2 + 2 t^3 and 3 t^2 - 2 t^3:
  ///     WeightBasis(1, {{1, 0}, {0, 1}})        WeightBasis(3, {{1, 1, 0, 0}, {0, 0, 1, 1}})
  /// Precondition: degree is in [1, kMostDegree].
  WeightBasis(std::size_t degree, std::vector<Coefficients> weights);
  /// Makes the basis of Lagrange polynomials at equidistant nodes. Weight k is 1 at node k and 0 at the other nodes.
  [[nodiscard]] static WeightBasis lagrange(std::size_t degree);

  [[nodiscard]] std::size_t degree() const noexcept { return degree_; }
  [[nodiscard]] std::size_t count() const noexcept { return weights_.size(); }
  [[nodiscard]] const Coefficients& weight(std::size_t k) const noexcept { return weights_[k]; }
  /// Returns a bound of the sum of |weights| at any t.
  [[nodiscard]] double most_weight() const noexcept { return most_weight_; }
  /// Returns a bound of the error that arises when the Bernstein coefficients of a curve through unit vectors are
  /// computed and split in double.
  [[nodiscard]] double conversion_error() const noexcept { return conversion_error_; }

 private:
  // Makes a basis whose weights may be the result of cancellation. largest_sum is the largest sum of |coefficients| of
  // all weights at one index, before anything cancels.
  WeightBasis(std::size_t degree, std::vector<Coefficients> weights, double largest_sum);

  std::size_t degree_;
  std::vector<Coefficients> weights_;
  double most_weight_ = 1, conversion_error_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_WEIGHT_BASIS_H_
