// Appends bytes to a file, or to a list of blocks in memory, and reads them back.
#include "io/bytes/spool.h"

#include <algorithm>
#include <cassert>
#include <cerrno>
#include <span>
#include <utility>

#include "io/system/temporary_file.h"

namespace chronormal::inline internal {

Result<Spool> Spool::beside(const std::string& target, const std::string& place) {
  Spool spool;
  spool.file_ = TemporaryFile::nameless(target);
  spool.place_ = place;
  if (!spool.file_->is_open()) return TemporaryFile::not_opened(place);
  return spool;
}

void Spool::add(std::string bytes) {
  if (file_) return append(bytes);
  if (bytes.empty()) return;
  const std::uint64_t at = size_;
  size_ += bytes.size();
  blocks_.push_back({at, std::move(bytes)});
}

void Spool::append(std::string_view bytes) {
  if (!file_) return add(std::string(bytes));
  if (bytes.empty() || !status_) return;
  if (!write_at(file_->number(), std::exchange(size_, size_ + bytes.size()), bytes)) status_ = failure(place_, errno);
}

void Spool::clear() {
  size_ = 0;
  blocks_.clear();
  if (!file_ || !status_) return;
  if (!set_end(file_->number(), 0)) status_ = failure(place_, errno);
}

Status Spool::hand_over(std::uint64_t at, std::uint64_t size, const Take& take) const {
  // The most bytes that are handed over at once. A part of this size fits into a cache of the processor.
  constexpr std::uint64_t kPart = std::uint64_t{1} << 18;
  if (!status_) return status_;
  assert(at <= size_ && size <= size_ - at);
  std::string part;
  if (file_) part.resize(static_cast<std::size_t>(std::min(size, kPart)));
  auto block = std::upper_bound(blocks_.begin(), blocks_.end(), at,
                                [](std::uint64_t place, const Block& later) { return place < later.at; });
  for (const std::uint64_t end = at + size; at < end;) {
    std::string_view bytes;
    if (file_) {
      const auto wanted = std::span(part).first(static_cast<std::size_t>(std::min(end - at, kPart)));
      const std::optional<std::span<char>> missing = read_at(file_->number(), at, wanted);
      // The file has all bytes that were added. A read that returns too few bytes therefore means that another program
      // shortened the file.
      if (!missing || !missing->empty()) return failure(place_, missing ? EIO : errno);
      bytes = {wanted.data(), wanted.size()};
    } else {
      const Block& here = *(block++ - 1);
      bytes = std::string_view(here.bytes).substr(static_cast<std::size_t>(at - here.at));
      bytes = bytes.substr(0, static_cast<std::size_t>(std::min<std::uint64_t>(bytes.size(), end - at)));
    }
    if (Status status = take(bytes); !status) return status;
    at += bytes.size();
  }
  return Success{};
}

Status Spool::give_away(std::uint64_t at, std::uint64_t size, const Take& take) {
  // The most bytes that one call to the system frees. If this number is large, few calls are needed.
  constexpr std::uint64_t kForgotten = std::uint64_t{8} << 20;
  for (std::uint64_t given = 0; given < size;) {
    const std::uint64_t part = std::min(size - given, kForgotten);
    if (Status status = hand_over(at + given, part, take); !status) return status;
    if (file_) forget_bytes(file_->number(), at + given, part);
    given += part;
  }
  return status_;
}

bool Spool::has(std::uint64_t at, std::string_view bytes) {
  bool are_same = true;
  Status status = hand_over(at, bytes.size(), [&](std::string_view part) -> Status {
    are_same = are_same && bytes.starts_with(part);
    bytes.remove_prefix(part.size());
    return Success{};
  });
  if (!status) status_ = std::move(status);
  return are_same && status_;
}

}  // namespace chronormal::inline internal
