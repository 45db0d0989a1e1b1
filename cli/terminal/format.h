/// Formats text with numbers. All other files of the program use these functions.
///
/// A number may be infinite or NaN, for example if a file has weights of 3e38 or no sample was judged. Readers of
/// tables, CSV and messages have no use for "nan" or "-nan", so such a number is written as "-". (In JSON it becomes
/// null; see workflow/json/json.h.) fmt::format would print "nan", so no other code in cli/ calls fmt::format.
#ifndef CLI_TERMINAL_FORMAT_H_
#define CLI_TERMINAL_FORMAT_H_

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>

namespace chronormal::cli {

/// A floating-point argument of formatted(). The fmt::formatter of this type prints a number that is not finite as "-".
struct Number {
  double value = 0;
};

/// Returns an argument of formatted() as it is passed to fmt::format(): a Number for floating-point types, and the
/// argument itself for other types.
template <class T>
[[nodiscard]] const T& as_argument(const T& value) noexcept {
  return value;
}
template <std::floating_point T>
[[nodiscard]] Number as_argument(const T& value) noexcept {
  return {static_cast<double>(value)};
}
template <class T>
using Argument = decltype(as_argument(std::declval<const T&>()));

/// Formats text like fmt::format(), but prints numbers that are not finite as "-".
template <class... Args>
[[nodiscard]] std::string formatted(fmt::format_string<Argument<Args>...> text, const Args&... args) {
  return fmt::format(text, as_argument(args)...);
}

/// Rounds a share of 0 or more up to hundredths, so that a share slightly above a limit is not printed as the limit
/// itself. An excess of a millionth or less counts as a rounding error and is dropped.
[[nodiscard]] inline double up_to_hundredths(double share) noexcept {
  return std::max(std::ceil(100 * share - 1e-4), 0.0) / 100;
}

}  // namespace chronormal::cli

template <>
struct fmt::formatter<chronormal::cli::Number> {
  template <class Context>
  constexpr auto parse(Context& context) {
    // Checks the format if the compiler evaluates this call.
    if (std::is_constant_evaluated()) return fmt::formatter<double>().parse(context);
    const auto end = std::find(context.begin(), context.end(), '}');
    form_ = std::string_view(context.begin(), static_cast<std::size_t>(end - context.begin()));
    return end;
  }

  template <class Context>
  auto format(const chronormal::cli::Number& number, Context& context) const {
    const std::string form = std::isfinite(number.value) ? "{:" + std::string(form_) + '}' : "-";
    return fmt::vformat_to(context.out(), form, fmt::make_format_args(number.value));
  }

 private:
  std::string_view form_;  // the format of the number, such as ".2f"
};

#endif  // CLI_TERMINAL_FORMAT_H_
