#include "io/bytes/expansion.h"

#include <algorithm>
#include <limits>

#include "core/text.h"

namespace chronormal::inline internal {

std::uint64_t Expansion::most() const noexcept {
  constexpr std::uint64_t kAll = std::numeric_limits<std::uint64_t>::max();
  if (times_ != 0 && read_ > kAll / times_) return kAll;
  return std::max(kAlways, read_ * times_);
}

Status Expansion::check(std::uint64_t bytes, const std::string& place) const {
  if (bytes <= most()) return Success{};
  const std::uint64_t times = read_ == 0 ? bytes : bytes / read_ + (bytes % read_ == 0 ? 0 : 1);
  return invalid_input(place, "an input of " + counted(read_, "byte", "bytes") + " would need " +
                                  counted(bytes, "byte", "bytes") +
                                  " of memory or output, which is more than the limit of " + grouped(most()) +
                                  "; if you trust the file, add --max-expansion " + std::to_string(times));
}

}  // namespace chronormal::inline internal
