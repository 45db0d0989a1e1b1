/// Reads the bits of a value as another type, like std::bit_cast. Some standard libraries do not have std::bit_cast yet
/// (libc++ 13).
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
