/// The leading eigenvectors of a matrix of inner products, and so the leading singular vectors of what it was made of.
///
/// Threads    pure: the same bits everywhere
#ifndef CHRONORMAL_ANALYSIS_FITS_LEADING_VECTORS_H_
#define CHRONORMAL_ANALYSIS_FITS_LEADING_VECTORS_H_

#include <cstddef>
#include <span>
#include <vector>

namespace chronormal::inline internal {

/// Finds the eigenvectors (n, count) of the largest eigenvalues, in descending order of these: orthonormal columns, the
/// last of which are zero where the rank of the matrix is below count. Eigenvalues that are within a few per cent of
/// that of the last column may be mixed with it. The matrix (n, n) must be symmetric without negative eigenvalues but
/// for rounding. O(n^2 count) with a factor of 20, and O(count^3)
[[nodiscard]] std::vector<double> leading_vectors(std::span<const double> matrix, std::size_t n, std::size_t count);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_FITS_LEADING_VECTORS_H_
