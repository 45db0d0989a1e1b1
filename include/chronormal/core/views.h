/// Views of memory that the caller owns.
///
/// VectorView names n vectors without copying them, in either of the two layouts that meshes come in:
///
///     planes   x0 x1 x2 ...   y0 y1 y2 ...   z0 z1 z2 ...      three arrays, stride 1
///     packed   x0 y0 z0  x1 y1 z1  x2 y2 z2 ...                one array of shape (n, 3), stride 3
///
/// Vector i has the components x[i * stride], y[i * stride], z[i * stride]. A view consists of pointers, a count and a
/// stride, and is passed by value. A function does not keep a view unless its comment says so.
#ifndef CHRONORMAL_CORE_VIEWS_H_
#define CHRONORMAL_CORE_VIEWS_H_

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <span>
#include <type_traits>

#include "chronormal/core/vec3.h"

namespace chronormal {

/// Returns `bytes` as a std::size_t, or the largest std::size_t if `bytes` exceeds it, which can happen on systems with
/// 32-bit addresses.
[[nodiscard]] constexpr std::size_t addressable(std::uint64_t bytes) noexcept {
  return bytes < static_cast<std::size_t>(-1) ? static_cast<std::size_t>(bytes) : static_cast<std::size_t>(-1);
}

/// A half-open range of element indices: first, first + 1, ..., first + count - 1.
struct IndexRange {
  std::size_t first = 0;
  std::size_t count = 0;

  [[nodiscard]] constexpr std::size_t end() const noexcept { return first + count; }
};

/// A view of n vectors of three scalars. T, the type of a scalar, is float, const float, double or const double.
template <class T>
struct VectorView {
  using Scalar = std::remove_const_t<T>;

  T* x = nullptr;
  T* y = nullptr;
  T* z = nullptr;
  std::size_t count = 0;
  std::size_t stride = 1;  ///< number of scalars from one vector to the next

  [[nodiscard]] static VectorView planes(T* x, T* y, T* z, std::size_t count) noexcept { return {x, y, z, count, 1}; }
  [[nodiscard]] static VectorView packed(T* xyz, std::size_t count) noexcept {
    if (count == 0) return {};
    return {xyz, xyz + 1, xyz + 2, count, 3};
  }
  /// Makes a view of all vectors of an array or std::vector that has three scalars for each vector.
  [[nodiscard]] static VectorView packed(std::span<T> xyz) noexcept {
    assert(xyz.size() % 3 == 0);
    return packed(xyz.data(), xyz.size() / 3);
  }

  /// Makes a view of vectors in records of `bytes` bytes each, as in a vertex buffer. `xyz` points to the first
  /// component of the first vector. Precondition: `bytes` is a multiple of the size of a scalar, and at least three
  /// times that size.
  [[nodiscard]] static VectorView strided(T* xyz, std::size_t count, std::size_t bytes) noexcept {
    if (count == 0) return {};
    assert(bytes % sizeof(T) == 0 && bytes >= 3 * sizeof(T));
    return {xyz, xyz + 1, xyz + 2, count, bytes / sizeof(T)};
  }

  [[nodiscard]] Vec3<Scalar> operator[](std::size_t i) const noexcept {
    assert(i < count);
    return {x[i * stride], y[i * stride], z[i * stride]};
  }

  void set(std::size_t i, const Vec3<Scalar>& value) const noexcept requires(!std::is_const_v<T>) {
    assert(i < count);
    x[i * stride] = value.x;
    y[i * stride] = value.y;
    z[i * stride] = value.z;
  }

  /// Returns true if the vectors are one array of shape (n, 3).
  [[nodiscard]] bool is_packed() const noexcept { return stride == 3 && y == x + 1 && z == x + 2; }

  /// Returns a view of the vectors of a range.
  [[nodiscard]] VectorView part(IndexRange range) const noexcept {
    assert(range.end() <= count);
    const std::size_t offset = range.first * stride;
    return {x + offset, y + offset, z + offset, range.count, stride};
  }

  operator VectorView<const T>() const noexcept  // NOLINT(google-explicit-constructor): adds const only
      requires(!std::is_const_v<T>) {
    return {x, y, z, count, stride};
  }
};

}  // namespace chronormal

#endif  // CHRONORMAL_CORE_VIEWS_H_
