// Verifies the file that an interrupted run of `sample` left: compares the header, and the checksum of each row.
#include "workflow/sample/continued_samples.h"

#include <algorithm>
#include <optional>
#include <system_error>

#include "core/charconv.h"
#include "io/bytes/checksum.h"
#include "io/bytes/file.h"
#include "io/bytes/output_file.h"
#include "workflow/sample/sample_part.h"

namespace chronormal::inline internal {
namespace {

// Reads a record of the journal: the checksum of a row, and the number of its normals that are zero.
std::optional<WrittenRow> read_row(std::string_view text) {
  WrittenRow row;
  const char* const last = text.data() + text.size();
  const auto checksum = from_chars(text.data(), last, row.checksum);
  if (checksum.ec != std::errc{} || checksum.ptr == last || *checksum.ptr != ' ') return std::nullopt;
  const auto zeros = from_chars(checksum.ptr + 1, last, row.zeros);
  return zeros.ec == std::errc{} && zeros.ptr == last ? std::optional(row) : std::nullopt;
}

// Returns true if the file has the bytes of a row from offset `at` on, judged by the checksum of the row.
Result<bool> has_row(const PositionedFile& file, std::uint64_t at, std::size_t row_bytes, const WrittenRow& row,
                     std::string& block) {
  if (file.size() < at + row_bytes) return false;
  std::uint32_t sum = 0;
  for (std::size_t done = 0; done < row_bytes; done += block.size()) {
    const auto part = std::span(block).first(std::min(block.size(), row_bytes - done));
    if (const Status status = file.read(at + done, part); !status) return status.error();
    sum = checksum_of({part.data(), part.size()}, sum);
  }
  return sum == row.checksum;
}

}  // namespace

WrittenRow WrittenRow::of(std::string_view bytes, std::size_t zeros) { return {checksum_of(bytes), zeros}; }

std::string WrittenRow::text() const { return std::to_string(checksum) + " " + std::to_string(zeros); }

Result<WrittenRows> find_written_rows(const std::string& output, std::string_view header, std::size_t row_bytes,
                                      std::size_t count, Journal& journal) {
  WrittenRows found;
  const std::string partial = OutputFile::partial_name(output);
  std::optional<PositionedFile> file = PositionedFile::open(partial);
  const bool is_partial = file.has_value();
  if (!is_partial && !journal.records().empty()) file = PositionedFile::open(output);
  if (file) {
    std::string start(static_cast<std::size_t>(std::min<std::uint64_t>(header.size(), file->size())), '\0');
    if (const Status status = file->read(0, start); !status) return status.error();
    const bool is_ours = header.starts_with(start);
    if (is_partial && !is_ours)
      return Error{
          ErrorCode::kFailed, partial,
          "this file was not written by an interrupted run of this command; remove the file, or choose another output"};
    std::string block(std::size_t{1} << 20, '\0');
    for (const std::string& record : journal.records()) {
      const std::optional<WrittenRow> row = read_row(record);
      if (!row || !is_ours || found.rows.size() == count) break;
      const std::uint64_t at = header.size() + std::uint64_t{row_bytes} * found.rows.size();
      const Result<bool> is_there = has_row(*file, at, row_bytes, *row, block);
      if (!is_there) return is_there.error();
      if (!is_there.value()) break;
      found.rows.push_back(*row);
    }
    if (!is_partial) {
      const std::uint64_t rows_end = header.size() + std::uint64_t{row_bytes} * count;
      if (found.rows.size() == count && file->size() - rows_end <= kLongestEndOfPart) {
        found.end.emplace(static_cast<std::size_t>(file->size() - rows_end), '\0');
        if (const Status status = file->read(rows_end, *found.end); !status) return status.error();
      } else {
        found.rows.clear();
      }
    }
  }
  if (const Status status = journal.keep_first(found.rows.size()); !status) return status.error();
  return found;
}

}  // namespace chronormal::inline internal
