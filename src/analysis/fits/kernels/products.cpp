// A tile of sums, four rows by two SIMD vectors, stays in registers while the loop runs over the rows of both matrices.
// The loop then needs only six loads for each eight additions.
#include "analysis/fits/kernels/products.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/fits/kernels/products.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include "simd/lanes-inl.h"

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

// Adds products of columns to `sums`: kRows columns of `a`, from column i on, times the columns of `b` in one or two
// SIMD vectors, from column j on.
template <std::size_t kRows, std::size_t kVectors>
HWY_INLINE void AddTile(const StridedMatrix& a, const StridedMatrix& b, std::size_t i, std::size_t j, float* sums,
                        std::size_t stride) {
  Floats tile[kRows][kVectors];
  for (std::size_t r = 0; r < kRows; ++r)
    for (std::size_t v = 0; v < kVectors; ++v)
      tile[r][v] = hn::LoadU(kFloats, sums + (i + r) * stride + j + v * kLanes);
  const float* of_a = a.data + i * a.column_stride;
  const float* of_b = b.data + j;
  for (std::size_t row = 0; row < a.rows; ++row, of_a += a.row_stride, of_b += b.row_stride) {
    Floats right[kVectors];
    for (std::size_t v = 0; v < kVectors; ++v) right[v] = hn::LoadU(kFloats, of_b + v * kLanes);
    for (std::size_t r = 0; r < kRows; ++r) {
      const Floats left = hn::Set(kFloats, of_a[r * a.column_stride]);
      for (std::size_t v = 0; v < kVectors; ++v) tile[r][v] = hn::Add(tile[r][v], hn::Mul(left, right[v]));
    }
  }
  for (std::size_t r = 0; r < kRows; ++r)
    for (std::size_t v = 0; v < kVectors; ++v)
      hn::StoreU(tile[r][v], kFloats, sums + (i + r) * stride + j + v * kLanes);
}

template <std::size_t kRows>
HWY_INLINE void AddRows(const StridedMatrix& a, const StridedMatrix& b, std::size_t i, float* sums,
                        std::size_t stride) {
  std::size_t j = 0;
  for (; j + 2 * kLanes <= b.columns; j += 2 * kLanes) AddTile<kRows, 2>(a, b, i, j, sums, stride);
  for (; j + kLanes <= b.columns; j += kLanes) AddTile<kRows, 1>(a, b, i, j, sums, stride);
  for (; j < b.columns; ++j) {
    for (std::size_t r = 0; r < kRows; ++r) {
      float sum = sums[(i + r) * stride + j];
      for (std::size_t row = 0; row < a.rows; ++row)
        sum += a.data[row * a.row_stride + (i + r) * a.column_stride] * b.data[row * b.row_stride + j];
      sums[(i + r) * stride + j] = sum;
    }
  }
}

void AddProducts(const StridedMatrix& a, const StridedMatrix& b, float* sums, std::size_t stride) {
  std::size_t i = 0;
  for (; i + 4 <= a.columns; i += 4) AddRows<4>(a, b, i, sums, stride);
  for (; i < a.columns; ++i) AddRows<1>(a, b, i, sums, stride);
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(AddProducts);

void add_products(const StridedMatrix& a, const StridedMatrix& b, float* sums, std::size_t stride) noexcept {
  HWY_DYNAMIC_DISPATCH(AddProducts)(a, b, sums, stride);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
