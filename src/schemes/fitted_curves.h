/// The coefficients of a scheme for a block of elements, exactly as the scheme evaluates them. Certificates bound the
/// errors of these curves; samples of the curves would not be enough.
#ifndef CHRONORMAL_SCHEMES_FITTED_CURVES_H_
#define CHRONORMAL_SCHEMES_FITTED_CURVES_H_

#include <cstddef>
#include <optional>

#include "chronormal/core/vec3.h"
#include "schemes/kernels/curve_kernels.h"
#include "schemes/weight_basis.h"

namespace chronormal::inline internal {

/// The coefficients of one element in a block, indexed by plane.
struct ElementCoefficients {
  const float* first;

  float operator[](std::size_t plane) const { return first[plane * kBlock]; }
  /// Returns the vector that is stored in the planes 3k, 3k + 1, 3k + 2.
  [[nodiscard]] Vec3f vector(std::size_t k) const { return {(*this)[3 * k], (*this)[3 * k + 1], (*this)[3 * k + 2]}; }
};

[[nodiscard]] inline ElementCoefficients coefficients_of(const CoefficientBlocks& blocks, std::size_t i) noexcept {
  return {blocks.values + i / kBlock * kBlock * blocks.plane_count + i % kBlock};
}

/// The formula of a scheme, and the coefficients of a block, which are valid until the scheme is prepared again. If the
/// formula is a sum, `basis` has its weights. Other formulas are evaluated with their shared_values().
struct FittedCurves {
  Formula formula = Formula::kSum;
  CoefficientBlocks coefficients;
  std::optional<WeightBasis> basis;  ///< the weights of a sum, one for each vector, if they are known
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_FITTED_CURVES_H_
