// The schemes linear, quadratic, cubic and lagrange:K. They interpolate the exact unit normals at K + 1 equidistant
// nodes by a Lagrange polynomial of degree K, and then scale the result to length 1 (section 2.2 of the paper). K is 1
// for linear, 2 for quadratic and 3 for cubic.
//
// The weights L_k(t) are the same for all elements, and are computed once per t in double. The vector of an element is
// a sum with these weights.

#include <array>
#include <cmath>
#include <optional>

#include "schemes/curve_scheme.h"
#include "schemes/makers.h"

namespace chronormal::inline internal {
namespace {

class Lagrange {
 public:
  explicit Lagrange(std::size_t degree) : degree_(degree) {}

  [[nodiscard]] std::size_t plane_count() const { return 3 * (degree_ + 1); }

  [[nodiscard]] Formula formula() const {
    switch (degree_) {
      case 1:
        return Formula::kSumOf2;
      case 2:
        return Formula::kSumOf3;
      case 3:
        return Formula::kSumOf4;
      default:
        return Formula::kSum;
    }
  }

  void fit(ElementMotion& element, double* c) const {
    put_vector(c, 0, element.start().vector);
    for (std::size_t k = 1; k < degree_; ++k) put_vector(c, k, element.node(node_time(k)));
    put_vector(c, degree_, element.end().vector);
  }

  void shared(double t, float* values) const {
    const auto weights = weights_at(t);
    for (std::size_t k = 0; k <= degree_; ++k) values[k] = static_cast<float>(weights[k]);
  }
  [[nodiscard]] std::optional<WeightBasis> basis() const {
    if (degree_ > WeightBasis::kMostDegree) return std::nullopt;
    return WeightBasis::lagrange(degree_);
  }

  // Returns how many numbers the curve of an element needs to be played step by step, or 0 if it cannot be played.
  // Curves are played by forward differences, with K additions per component and step. This method works only up to
  // degree 3, since differences of higher order are smaller than the rounding of float32.
  [[nodiscard]] std::size_t state_planes() const { return degree_ <= 3 ? plane_count() : 0; }

  void anchor(ElementCoefficients c, double t, double step, double* state) const {
    std::array<Vec3d, kMaxLagrangeDegree + 1> differences;
    for (std::size_t j = 0; j <= degree_; ++j) {
      const auto weights = weights_at(t + static_cast<double>(j) * step);
      differences[j] = {};
      for (std::size_t k = 0; k <= degree_; ++k) differences[j] = differences[j] + weights[k] * to_double(c.vector(k));
    }
    for (std::size_t level = 0; level <= degree_; ++level) {
      put_vector(state, level, differences[0]);
      for (std::size_t j = 0; j + level < degree_; ++j) differences[j] = differences[j + 1] - differences[j];
    }
  }

 private:
  [[nodiscard]] std::array<double, kMaxLagrangeDegree + 1> weights_at(double t) const {
    std::array<double, kMaxLagrangeDegree + 1> weights;
    const double x = t * static_cast<double>(degree_);  // in units in which the nodes are 0, 1, ..., degree
    for (std::size_t k = 0; k <= degree_; ++k) {
      weights[k] = 1;
      for (std::size_t j = 0; j <= degree_; ++j) {
        if (j != k) weights[k] *= (x - static_cast<double>(j)) / (static_cast<double>(k) - static_cast<double>(j));
      }
    }
    return weights;
  }

  [[nodiscard]] double node_time(std::size_t k) const { return static_cast<double>(k) / static_cast<double>(degree_); }

  std::size_t degree_;
};

}  // namespace

std::unique_ptr<Scheme> make_lagrange(std::size_t degree) {
  return std::make_unique<CurveScheme<Lagrange>>(Lagrange(degree));
}

}  // namespace chronormal::inline internal
