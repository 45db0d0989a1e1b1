// Checks the leading eigenvectors of matrices that are built from known eigenvectors.
#include "analysis/fits/leading_vectors.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

namespace chronormal::leading_vectors_test {
namespace {

// A matrix with given eigenvalues. `vectors` has its eigenvectors as rows, which are made by reflections and are
// therefore orthonormal.
struct Known {
  std::vector<std::vector<double>> vectors;
  std::vector<double> matrix;
};

Known matrix_with(const std::vector<double>& eigenvalues, unsigned seed) {
  const std::size_t n = eigenvalues.size();
  std::mt19937 random(seed);
  Known known;
  known.vectors.assign(n, std::vector<double>(n, 0.0));
  for (std::size_t i = 0; i < n; ++i) known.vectors[i][i] = 1;
  for (int reflection = 0; reflection < 5; ++reflection) {
    std::vector<double> mirror(n);
    double square = 0;
    for (double& x : mirror) {
      x = static_cast<double>(random()) / 4294967296.0 - 0.5;
      square += x * x;
    }
    for (std::vector<double>& row : known.vectors) {
      double along = 0;
      for (std::size_t i = 0; i < n; ++i) along += row[i] * mirror[i];
      for (std::size_t i = 0; i < n; ++i) row[i] -= 2 * along / square * mirror[i];
    }
  }
  known.matrix.assign(n * n, 0.0);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t i = 0; i < n; ++i)
      for (std::size_t j = 0; j < n; ++j)
        known.matrix[i * n + j] += eigenvalues[k] * known.vectors[k][i] * known.vectors[k][j];
  return known;
}

TEST(LeadingVectors, are_the_eigenvectors_of_the_largest_eigenvalues_in_their_order) {
  std::vector<double> eigenvalues;
  for (int k = 0; k < 40; ++k) eigenvalues.push_back(100 * std::pow(0.7, k));
  const Known known = matrix_with(eigenvalues, 3);
  constexpr std::size_t kCount = 12;
  const std::vector<double> found = leading_vectors(known.matrix, 40, kCount);
  for (std::size_t k = 0; k < kCount; ++k) {
    double along = 0;
    for (std::size_t i = 0; i < 40; ++i) along += known.vectors[k][i] * found[i * kCount + k];
    EXPECT_NEAR(std::fabs(along), 1, 1e-9) << "vector " << k;
  }
}

TEST(LeadingVectors, beyond_the_rank_are_zero) {
  std::vector<double> eigenvalues(20, 0.0);
  eigenvalues[0] = 3;
  eigenvalues[1] = 1;
  const std::vector<double> found = leading_vectors(matrix_with(eigenvalues, 4).matrix, 20, 6);
  for (std::size_t i = 0; i < 20; ++i)
    for (std::size_t k = 2; k < 6; ++k) EXPECT_EQ(found[i * 6 + k], 0) << i << ", " << k;
}

TEST(LeadingVectors, of_a_zero_matrix_are_zero_and_of_more_columns_than_it_has_the_rest_is) {
  for (const double number : leading_vectors(std::vector<double>(9, 0.0), 3, 2)) EXPECT_EQ(number, 0);
  const std::vector<double> found = leading_vectors(matrix_with({4, 2, 1}, 5).matrix, 3, 5);
  for (std::size_t k = 0; k < 5; ++k) {
    double square = 0;
    for (std::size_t i = 0; i < 3; ++i) square += found[i * 5 + k] * found[i * 5 + k];
    EXPECT_NEAR(square, k < 3 ? 1 : 0, 1e-12);
  }
}

}  // namespace
}  // namespace chronormal::leading_vectors_test
