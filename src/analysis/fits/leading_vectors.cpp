// Finds eigenvectors by subspace iteration (Halko, Martinsson and Tropp, Finding Structure with Randomness, 2011,
// algorithm 4.4). A block of random columns is repeatedly multiplied by the matrix and made orthonormal. In the space
// that the columns of this block span, the matrix acts like a small matrix. Jacobi rotations find the eigenvectors of
// the small matrix. Their components are the factors that combine the columns of the block to eigenvectors of the large
// matrix.
#include "analysis/fits/leading_vectors.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMore = 8;  // number of additional columns, with which the iteration converges faster
constexpr int kIterations = 16, kMostSweeps = 30;
constexpr double kNothing = 1e-12;  // a share of the largest eigenvalue; smaller eigenvalues are rounding errors
constexpr double kDiagonal = 1e-13;

// The columns of a matrix, each an array of n numbers.
using Columns = std::vector<std::vector<double>>;

double dot(std::span<const double> a, std::span<const double> b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += a[i] * b[i];
  return sum;
}

void add(std::span<double> to, double factor, std::span<const double> what) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += factor * what[i];
}

// Returns columns of pseudo-random numbers around zero. The numbers do not depend on the standard library.
Columns some_columns(std::size_t n, std::size_t count) {
  Columns columns(count, std::vector<double>(n));
  std::uint64_t state = 1;
  for (std::vector<double>& column : columns) {
    for (double& number : column) {
      state = state * 6364136223846793005U + 1442695040888963407U;
      number = static_cast<double>(state >> 40U) / static_cast<double>(1U << 24U) - 0.5;
    }
  }
  return columns;
}

// Makes columns orthonormal. A column that depends linearly on earlier columns becomes zero. Two passes are enough
// (Kahan and Parlett).
void make_orthonormal(Columns& columns) {
  for (std::size_t c = 0; c < columns.size(); ++c) {
    const double before = std::sqrt(dot(columns[c], columns[c]));
    for (int pass = 0; pass < 2; ++pass)
      for (std::size_t b = 0; b < c; ++b) add(columns[c], -dot(columns[b], columns[c]), columns[b]);
    const double length = std::sqrt(dot(columns[c], columns[c]));
    const double factor = length > kNothing * before ? 1 / length : 0;
    for (double& number : columns[c]) number *= factor;
  }
}

Columns multiplied(std::span<const double> matrix, const Columns& columns) {
  Columns result;
  for (const std::vector<double>& column : columns) {
    std::vector<double>& product = result.emplace_back(column.size(), 0.0);
    // The matrix is symmetric, so row r is also column r.
    for (std::size_t r = 0; r < column.size(); ++r)
      if (column[r] != 0) add(product, column[r], matrix.subspan(r * column.size(), column.size()));
  }
  return result;
}

// Replaces a small symmetric matrix by a diagonal matrix of its eigenvalues, and returns its eigenvectors, one per row.
// Uses Jacobi's rotations.
Columns diagonalize(Columns& matrix) {
  const std::size_t n = matrix.size();
  Columns vectors(n, std::vector<double>(n, 0.0));
  for (std::size_t i = 0; i < n; ++i) vectors[i][i] = 1;
  for (int sweep = 0; sweep < kMostSweeps; ++sweep) {
    double beside = 0, all = 0;
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = 0; q < n; ++q) {
        all += matrix[p][q] * matrix[p][q];
        if (p != q) beside += matrix[p][q] * matrix[p][q];
      }
    }
    if (beside <= kDiagonal * kDiagonal * all) break;
    for (std::size_t p = 0; p < n; ++p) {
      for (std::size_t q = p + 1; q < n; ++q) {
        if (matrix[p][q] == 0) continue;
        const double theta = (matrix[q][q] - matrix[p][p]) / (2 * matrix[p][q]);
        const double t = std::copysign(1.0, theta) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        const auto rotate = [&](double& a, double& b) {
          const double old = a;
          a = c * old - s * b;
          b = s * old + c * b;
        };
        for (std::size_t k = 0; k < n; ++k) rotate(matrix[k][p], matrix[k][q]);
        for (std::size_t k = 0; k < n; ++k) rotate(matrix[p][k], matrix[q][k]);
        for (std::size_t k = 0; k < n; ++k) rotate(vectors[p][k], vectors[q][k]);
      }
    }
  }
  return vectors;
}

}  // namespace

std::vector<double> leading_vectors(std::span<const double> matrix, std::size_t n, std::size_t count) {
  Columns block = some_columns(n, std::min(n, count + kMore));
  make_orthonormal(block);
  for (int round = 0; round < kIterations; ++round) {
    block = multiplied(matrix, block);
    make_orthonormal(block);
  }
  const Columns images = multiplied(matrix, block);
  Columns small(block.size(), std::vector<double>(block.size()));
  for (std::size_t i = 0; i < block.size(); ++i)
    for (std::size_t j = 0; j < block.size(); ++j) small[i][j] = dot(block[std::min(i, j)], images[std::max(i, j)]);
  const Columns turns = diagonalize(small);
  std::vector<std::pair<double, std::size_t>> order;
  for (std::size_t i = 0; i < block.size(); ++i) order.emplace_back(-small[i][i], i);
  std::sort(order.begin(), order.end());

  std::vector<double> result(n * count, 0.0);
  for (std::size_t k = 0; k < std::min(count, order.size()); ++k) {
    if (!(-order[k].first > -kNothing * order[0].first)) break;
    std::vector<double> vector(n, 0.0);
    for (std::size_t i = 0; i < block.size(); ++i) add(vector, turns[order[k].second][i], block[i]);
    for (std::size_t r = 0; r < n; ++r) result[r * count + k] = vector[r];
  }
  return result;
}

}  // namespace chronormal::inline internal
