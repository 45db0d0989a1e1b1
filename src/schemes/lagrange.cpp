// Lagrange interpolation through the exact unit normals at K + 1 equidistant nodes, then normalised: linear is K = 1,
// quadratic 2, cubic 3 (section 2.2 of the paper).
//
// The weights L_k(t) are the same for all elements and are made once per t, in double; an element is a weighted sum.

#include <array>
#include <cmath>

#include "schemes/curve_scheme.h"
#include "schemes/makers.h"

namespace chronormal {
namespace {

class Lagrange {
 public:
  explicit Lagrange(std::size_t degree) : degree_(degree) {}

  [[nodiscard]] std::size_t plane_count() const { return 3 * (degree_ + 1); }

  void fit(ElementMotion& element, double* c) const {
    put_vector(c, 0, element.start().vector);
    for (std::size_t k = 1; k < degree_; ++k) put_vector(c, k, element.node(node_time(k)));
    put_vector(c, degree_, element.end().vector);
  }

  template <class S>
  [[nodiscard]] std::array<S, kMaxLagrangeDegree + 1> at(double t) const {
    std::array<S, kMaxLagrangeDegree + 1> weights;
    const double x = t * static_cast<double>(degree_);  // the nodes are 0, 1, ..., degree
    for (std::size_t k = 0; k <= degree_; ++k) {
      double weight = 1;
      for (std::size_t j = 0; j <= degree_; ++j) {
        if (j != k) weight *= (x - static_cast<double>(j)) / (static_cast<double>(k) - static_cast<double>(j));
      }
      weights[k] = S(static_cast<float>(weight));
    }
    return weights;
  }

  /// Where the sum vanishes (opposite ends meet in the middle) the result is the normal at t = 0.
  template <class S>
  [[nodiscard]] Vec3<S> evaluate(Coefficients<S> c, const std::array<S, kMaxLagrangeDegree + 1>& weights) const {
    Vec3<S> sum = weights[0] * c.vector(0);
    for (std::size_t k = 1; k <= degree_; ++k) sum = sum + weights[k] * c.vector(k);
    return normalized_or(sum, c.vector(0));
  }

 private:
  [[nodiscard]] double node_time(std::size_t k) const { return static_cast<double>(k) / static_cast<double>(degree_); }

  std::size_t degree_;
};

}  // namespace

std::unique_ptr<Scheme> make_lagrange(std::size_t degree) {
  return std::make_unique<CurveScheme<Lagrange>>(Lagrange(degree));
}

}  // namespace chronormal
