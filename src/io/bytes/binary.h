/// Reads and writes numbers as bytes in either byte order, for all binary formats. Private to io.
#ifndef CHRONORMAL_IO_BYTES_BINARY_H_
#define CHRONORMAL_IO_BYTES_BINARY_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <span>
#include <string>
#include <string_view>

#include "core/bits.h"

namespace chronormal::inline internal::binary {

/// Returns the number whose first byte is at `at`.
template <class T>
[[nodiscard]] T load(const char* at, std::endian order) noexcept {
  std::array<char, sizeof(T)> raw{};
  std::memcpy(raw.data(), at, sizeof(T));
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  return bit_cast<T>(raw);
}

/// Writes the bytes of a number from `at` on.
template <class T>
void store(char* at, T value, std::endian order) noexcept {
  auto raw = bit_cast<std::array<char, sizeof(T)>>(value);
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  std::memcpy(at, raw.data(), raw.size());
}

template <class T>
void append(std::string& text, T value, std::endian order) {
  auto raw = bit_cast<std::array<char, sizeof(T)>>(value);
  if (order != std::endian::native) std::reverse(raw.begin(), raw.end());
  text.append(raw.data(), raw.size());
}

/// Returns the reason why float32 cannot hold a coordinate, or nullptr if float32 can hold it.
[[nodiscard]] inline const char* coordinate_fault(double value) noexcept {
  if (!std::isfinite(value)) return "the coordinate is NaN or infinite; export the file again";
  if (std::fabs(value) > std::numeric_limits<float>::max())
    return "the coordinate is too large for float32; scale the mesh down";
  return nullptr;
}

/// Reads up to `count` coordinates of type Real (float or double) from the bytes at `at`, subtracts the origin, and
/// rounds them to float32. Stops before the first coordinate that has a coordinate_fault(), and returns the number of
/// coordinates that were read. `first` is the index of the first coordinate in its list of positions (V, 3), so that
/// first % 3 tells its axis.
template <class Real>
[[nodiscard]] std::size_t load_coordinates(const char* at, std::size_t count, std::endian order, float* result,
                                           const std::array<double, 3>& origin = {}, std::size_t first = 0) noexcept {
  const bool is_far = origin != std::array<double, 3>{};
  for (std::size_t i = 0; i < count; ++i) {
    const Real value = load<Real>(at + i * sizeof(Real), order);
    if (coordinate_fault(double{value}) != nullptr) return i;
    result[i] = is_far ? static_cast<float>(double{value} - origin[(first + i) % 3]) : static_cast<float>(value);
  }
  return count;
}

/// Returns numbers as bytes in the given byte order. The result is a view of `values` if the machine has this byte
/// order, and otherwise a view of a copy in `storage`.
[[nodiscard]] inline std::string_view bytes_of(std::span<const float> values, std::endian order, std::string& storage) {
  if (order == std::endian::native) return {reinterpret_cast<const char*>(values.data()), values.size_bytes()};
  storage.resize(values.size_bytes());
  for (std::size_t i = 0; i < values.size(); ++i) store(storage.data() + i * sizeof(float), values[i], order);
  return storage;
}

/// Returns true if count items of item_size bytes fit into the bytes that are left.
[[nodiscard]] constexpr bool fits(std::uint64_t count, std::uint64_t item_size, std::uint64_t bytes_left) noexcept {
  return item_size == 0 || count <= bytes_left / item_size;
}

/// Returns the place of a byte for messages: "NAME, byte N".
[[nodiscard]] inline std::string place(const std::string& name, std::uint64_t at) {
  return name + ", byte " + std::to_string(at);
}

}  // namespace chronormal::inline internal::binary

#endif  // CHRONORMAL_IO_BYTES_BINARY_H_
