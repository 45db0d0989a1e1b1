/// The kernel of dense linear algebra. Adds up outer products of the rows of two matrices.
///
/// Every sum is over the rows in order, and each operation is rounded separately, so the result has the same bits on
/// every instruction set.
#ifndef CHRONORMAL_ANALYSIS_FITS_KERNELS_PRODUCTS_H_
#define CHRONORMAL_ANALYSIS_FITS_KERNELS_PRODUCTS_H_

#include <cstddef>

namespace chronormal::inline internal {

/// A matrix in memory that the caller owns. Element (row, column) is data[row * row_stride + column *
/// column_stride].
struct StridedMatrix {
  const float* data = nullptr;
  std::size_t rows = 0, columns = 0, row_stride = 0, column_stride = 1;
};

/// Adds the product of the transpose of `a` with `b` to the matrix `sums`, which is (a.columns, b.columns) and has
/// `stride` floats from one row to the next:
///
///     sums[i][j] += sum over r of a[r][i] b[r][j]
///
/// Preconditions: `a` and `b` have equally many rows, the elements of a row of `b` are contiguous, and `sums` overlaps
/// neither of them. Cost: one multiplication and one addition for each a[r][i] b[r][j].
void add_products(const StridedMatrix& a, const StridedMatrix& b, float* sums, std::size_t stride) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_ANALYSIS_FITS_KERNELS_PRODUCTS_H_
