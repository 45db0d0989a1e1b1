/// Solves linear systems with a symmetric positive definite matrix, such as normal equations with a ridge (a small
/// number added to the diagonal).
#ifndef CHRONORMAL_CORE_CHOLESKY_H_
#define CHRONORMAL_CORE_CHOLESKY_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// The lower Cholesky factor of a matrix. The constructor costs O(n^3), each solve() O(n^2).
class Cholesky {
 public:
  Cholesky() = default;
  /// Factors a matrix (n, n), of which only the lower half is read. Rounding could make a squared pivot negative, so
  /// squared pivots smaller than `least` are replaced by `least`, which must be positive.
  Cholesky(std::vector<double> matrix, std::size_t n, double least) : lower_(std::move(matrix)), n_(n) {
    // The product of each column with itself is at once subtracted from everything to the right of the column, so that
    // inner loops go along rows.
    std::vector<double> column(n_);
    for (std::size_t k = 0; k < n_; ++k) {
      const double pivot = std::sqrt(std::max(lower_[k * n_ + k], least));
      lower_[k * n_ + k] = column[k] = pivot;
      for (std::size_t i = k + 1; i < n_; ++i) {
        double* const row = lower_.data() + i * n_;
        const double factor = row[k] / pivot;
        row[k] = column[i] = factor;
        for (std::size_t j = k + 1; j <= i; ++j) row[j] -= factor * column[j];
      }
    }
  }

  /// Replaces right-hand sides by their solutions. Precondition: `values` has n elements.
  void solve(std::span<Vec3d> values) const {
    for (std::size_t i = 0; i < n_; ++i) {
      for (std::size_t k = 0; k < i; ++k) values[i] = values[i] - at(i, k) * values[k];
      values[i] = (1 / at(i, i)) * values[i];
    }
    for (std::size_t i = n_; i-- > 0;) {
      for (std::size_t k = i + 1; k < n_; ++k) values[i] = values[i] - at(k, i) * values[k];
      values[i] = (1 / at(i, i)) * values[i];
    }
  }

 private:
  [[nodiscard]] double at(std::size_t i, std::size_t j) const { return lower_[i * n_ + j]; }

  std::vector<double> lower_;
  std::size_t n_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_CHOLESKY_H_
