/// Reads the bits of a value as another type: std::bit_cast, also where the standard library has none yet (libc++ 13).
/// Private.
#ifndef CHRONORMAL_CORE_BITS_H_
#define CHRONORMAL_CORE_BITS_H_

#include <bit>

namespace chronormal::inline internal {

#ifdef __cpp_lib_bit_cast
using std::bit_cast;
#else
template <class To, class From>
[[nodiscard]] constexpr To bit_cast(const From& value) noexcept {
  static_assert(sizeof(To) == sizeof(From));
  return __builtin_bit_cast(To, value);
}
#endif

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_CORE_BITS_H_
