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

/// Returns the eigenvectors of the `count` largest eigenvalues as the columns of a matrix (n, count), in descending
/// order of the eigenvalues. The columns are orthonormal; the last columns are zero if the rank of the matrix is below
/// count. An eigenvector whose eigenvalue is within a few per cent of the smallest returned eigenvalue may be mixed
/// with the last column. Cost: O(n^2 count) with a factor of 20, and O(count^3). Precondition: the matrix (n, n) is
/// symmetric, and has no negative eigenvalues except by rounding.
[[nodiscard]] std::vector<double> leading_vectors(std::span<const double> matrix, std::size_t n, std::size_t count);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_FITS_LEADING_VECTORS_H_
