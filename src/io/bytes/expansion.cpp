#include "io/bytes/expansion.h"

#include <algorithm>
#include <limits>

namespace chronormal::inline internal {
namespace {

// Returns a number with commas between groups of three digits: "1,234,567".
std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (std::size_t i = digits.size(); i > 3;) {
    i -= 3;
    digits.insert(i, 1, ',');
  }
  return digits;
}

}  // namespace

std::uint64_t Expansion::most() const noexcept {
  constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();
  if (times_ != 0 && read_ > kAll / times_) return kAll;
  return std::max(kAlways, read_ * times_);
}

Status Expansion::check(std::uint64_t bytes, const std::string& place) const {
  if (bytes <= most()) return Success{};
  const std::uint64_t times = read_ == 0 ? bytes : bytes / read_ + (bytes % read_ == 0 ? 0 : 1);
  return invalid_input(place, "an input of " + grouped(read_) + " bytes would need " + grouped(bytes) +
                                  " bytes of memory or output, but the limit is " + grouped(most()) +
                                  "; if you trust the file, add --max-expansion " + std::to_string(times));
}

}  // namespace chronormal::inline internal
