// Joins into one array the arrays that shards of samples wrote, and finds missing rows.
#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "io/bytes/checksum.h"
#include "io/bytes/file.h"
#include "io/bytes/output_file.h"
#include "io/cache/npy.h"
#include "workflow/json/parts.h"
#include "workflow/sample/sample_part.h"

namespace chronormal::inline internal {
namespace {

// The file of one shard, with its rows and their position among the rows of all shards.
struct ShardRows {
  PositionedFile file;
  npy::Array array;
  SamplePart place;
  std::string name;

  [[nodiscard]] std::uint64_t end() const { return place.first + array.shape.front(); }

  // Returns true if the arrays of two shards have the same number of rows in all, and rows of the same shape. If the
  // checksums of the shards match, the result is false only if somebody forged the parts.
  [[nodiscard]] bool is_like(const ShardRows& other) const {
    return place.total == other.place.total &&
           std::equal(array.shape.begin() + 1, array.shape.end(), other.array.shape.begin() + 1);
  }
};

Result<ShardRows> open_rows(const std::string& path) {
  std::optional<PositionedFile> file = PositionedFile::open(path);
  if (!file)
    return Error{ErrorCode::kFailed, path,
                 "the file does not exist, or cannot be read; name the shards that sample wrote"};
  std::string start(static_cast<std::size_t>(std::min<std::uint64_t>(file->size(), npy::kLongestHeader + 12)), '\0');
  if (Status status = file->read(0, start); !status) return status.error();
  Result<npy::Array> array = npy::read_header(start, file->size(), path, true);
  if (!array) return array.error();
  const npy::Array& found = array.value();
  const std::uint64_t end = found.data_end();
  const bool is_array = !found.is_fortran && found.shape.size() == 3 && found.kind == npy::Kind::kFloat &&
                        found.item_size == sizeof(float) && found.order == std::endian::little;
  if (!is_array || end == file->size())
    return invalid_input(
        path, "this file was not written by sample --shard, since it is " + found.text() + "; give only shards");
  if (file->size() - end > kLongestEndOfPart) return invalid_input(path, std::string(kDamagedPart));
  std::string text(static_cast<std::size_t>(file->size() - end), '\0');
  if (Status status = file->read(end, text); !status) return status.error();
  Result<SamplePart> place = SamplePart::read(text, path);
  if (!place) return place.error();
  const auto [first, total] = std::pair(place.value().first, place.value().total);
  if (first > total || found.shape.front() > total - first)
    return invalid_input(
        path, "the file is damaged, since its rows lie beyond the end of the whole array; make this shard again");
  return ShardRows{std::move(*file), std::move(array).value(), std::move(place).value(), path};
}

// Checks that every row is in exactly one of the shards. The shards must be in the order of their rows.
Status check_rows(const std::vector<ShardRows>& all) {
  const std::uint64_t count = all.front().place.total;
  std::uint64_t next = 0;
  for (std::size_t i = 0; i <= all.size(); ++i) {
    const std::uint64_t first = i < all.size() ? all[i].place.first : count;
    if (first != next)
      return Error{ErrorCode::kUsage, "",
                   "row " + std::to_string(std::min(first, next)) +
                       (first < next ? " is in two of the files; give each file once"
                                     : " is missing; give the files of all shards")};
    if (i < all.size()) next = all[i].end();
  }
  return Success{};
}

}  // namespace

Status merge_arrays(std::span<const std::string> paths, const std::string& output, bool force) {
  std::vector<ShardRows> all;
  KnownParts known;
  for (const std::string& path : paths) {
    Result<ShardRows> rows = open_rows(path);
    if (!rows) return rows.error();
    if (const Status status = known.add(path, rows.value().place.checksums); !status) return status;
    if (!all.empty() && !rows.value().is_like(all.front()))
      return Error{
          ErrorCode::kUsage, path,
          "this file belongs to another array than " + all.front().name + "; give only the shards of one array"};
    all.push_back(std::move(rows).value());
  }
  std::stable_sort(all.begin(), all.end(), [](const ShardRows& a, const ShardRows& b) {
    return std::pair(a.place.first, a.end()) < std::pair(b.place.first, b.end());
  });
  if (Status status = check_rows(all); !status) return status;

  std::vector<std::uint64_t> shape = all.front().array.shape;
  shape.front() = all.front().place.total;
  Result<OutputFile> file = OutputFile::create(output, force);
  if (!file) return file.error();
  if (Status status = file.value().append(npy::write_header("<f4", shape)); !status) return status;
  std::string block(std::size_t{1} << 20, '\0');
  for (const ShardRows& rows : all) {
    std::uint32_t sum = 0;
    std::uint64_t at = 0;
    // Reads the bytes of a shard's file up to offset `end`. Copies them to the output if is_copied is true.
    const auto pass = [&](std::uint64_t end, bool is_copied) -> Status {
      while (at < end) {
        const auto size = static_cast<std::size_t>(std::min<std::uint64_t>(block.size(), end - at));
        if (Status status = rows.file.read(at, std::span(block).first(size)); !status) return status;
        const std::string_view bytes = std::string_view(block).substr(0, size);
        sum = checksum_of(bytes, sum);
        if (Status status = is_copied ? file.value().append(bytes) : Status(Success{}); !status) return status;
        at += size;
      }
      return Success{};
    };
    if (Status status = pass(rows.array.data_begin, false); !status) return status;
    if (Status status = pass(rows.array.data_end(), true); !status) return status;
    if (sum != rows.place.array) return invalid_input(rows.name, std::string(kDamagedPart));
  }
  return file.value().finish();
}

}  // namespace chronormal::inline internal
