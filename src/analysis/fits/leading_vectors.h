/// Finds the leading eigenvectors of a matrix of inner products of vectors, which are the leading singular vectors of
/// the set of vectors.
///
/// Threads    pure: the same bits everywhere
#ifndef CHRONORMAL_ANALYSIS_FITS_LEADING_VECTORS_H_
#define CHRONORMAL_ANALYSIS_FITS_LEADING_VECTORS_H_

#include <cstddef>
#include <span>
#include <vector>

namespace chronormal::inline internal {

/// Finds the eigenvectors (n, count) of the largest eigenvalues, in descending order of the eigenvalues. The columns
/// are orthonormal; the last ones are zero if the rank of the matrix is below count. Vectors with eigenvalues within a
/// few per cent of the last column's may be mixed with it. The matrix (n, n) must be symmetric, with no negative
/// eigenvalues except by rounding. O(n^2 count) with a factor of 20, and O(count^3)
[[nodiscard]] std::vector<double> leading_vectors(std::span<const double> matrix, std::size_t n, std::size_t count);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_FITS_LEADING_VECTORS_H_
