// Implements what all queries use: the parts of segments in a span of time, and answers as files.

#include "chronormal/workflow/query.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <utility>

#include "chronormal/io/output.h"
#include "core/text.h"
#include "io/cache/npz.h"
#include "io/system/names.h"

namespace chronormal {
namespace {

std::string npy_of(const QueryColumn& column) {
  std::vector<std::uint64_t> shape = {column.rows()};
  if (column.width != 1) shape.push_back(column.width);
  if (const auto* const values = std::get_if<std::vector<float>>(&column.values)) {
    NpyBytes array(shape);
    array.append(*values);
    return std::move(array).bytes();
  }
  if (const auto* const values = std::get_if<std::vector<double>>(&column.values))
    return NpyBytes(shape, *values).bytes();
  if (const auto* const values = std::get_if<std::vector<std::int64_t>>(&column.values))
    return NpyBytes(shape, *values).bytes();
  return NpyBytes(shape, std::get<std::vector<std::uint8_t>>(column.values)).bytes();
}

// Converts a time to t in a segment. If t is not exactly a double, rounds it towards `end`, so that the part of the
// segment contains the whole span of time.
double t_towards(const Segment& segment, double time, double end) {
  const LocalTime t = LocalTime::between(segment.start_time, time, segment.end_time);
  return t.is_double() ? t.t : std::nextafter(t.t, end);
}

Error no_motion(const char* option, double time, double first, double last) {
  return Error{ErrorCode::kUsage, option,
               "the motion has nothing " + std::string(option == std::string("--from") ? "after " : "before ") +
                   rounded_text(time, {first, last}) + "; the motion goes from " + rounded_text(first, {time, last}) +
                   " to " + rounded_text(last, {time, first}) + "; choose a time in between"};
}

}  // namespace

std::size_t QueryColumn::rows() const noexcept {
  return std::visit([](const auto& list) { return list.size(); }, values) / width;
}

Result<std::vector<SegmentPart>> segment_parts(const Motion& motion, const QuerySpan& span) {
  constexpr double kEndless = std::numeric_limits<double>::infinity();
  const double from = span.from ? time_of_keyframe_at(motion, *span.from) : -kEndless,
               to = span.to ? time_of_keyframe_at(motion, *span.to) : kEndless;
  if (!(from < to)) return Error{ErrorCode::kUsage, "--to", "the last time must be later than the first"};
  std::vector<SegmentPart> parts;
  double first = kEndless, last = -kEndless;
  for (std::size_t s = 0; s < motion.segments.size(); ++s) {
    const Segment segment = motion.segment(s);
    first = std::min(first, segment.start_time);
    last = std::max(last, segment.end_time);
    const double t0 = t_towards(segment, from, 0), t1 = t_towards(segment, to, 1);
    if (t0 < t1) parts.push_back({s, t0, t1});
  }
  if (!parts.empty()) return parts;
  return from >= last ? no_motion("--from", from, first, last) : no_motion("--to", to, first, last);
}

std::uint64_t bytes_of_query(const QueryAnswer& answer) noexcept {
  std::uint64_t bytes = 0;
  for (const QueryTable& table : answer.tables) {
    for (const QueryColumn& column : table.columns)
      bytes += std::visit([](const auto& values) { return std::uint64_t{sizeof(values[0])} * values.size(); },
                          column.values);
  }
  return bytes;
}

std::uint64_t json_bytes_of_query(const QueryAnswer& answer) noexcept {
  constexpr std::uint64_t kLongestNumber = 25;  // the bytes of the longest text, as in "-1.2345678901234567e-300,"
  std::uint64_t numbers = 0;
  for (const QueryTable& table : answer.tables) {
    for (const QueryColumn& column : table.columns) numbers += std::uint64_t{column.rows()} * column.width;
  }
  return kLongestNumber * numbers;
}

Status check_query_output(const std::string& path, bool force) {
  if (path_of(path).extension() != ".npz")
    return Error{ErrorCode::kUsage, path,
                 "the name of a file of arrays must end in .npz; leave -o out for a table, or add --json for JSON"};
  return check_output(path, force);
}

Status write_query(const QueryAnswer& answer, const std::string& path, bool force) {
  if (const Status status = check_query_output(path, force); !status) return status.error();
  std::vector<std::pair<std::string, std::string>> arrays;
  for (const QueryTable& table : answer.tables) {
    const std::string prefix = table.name.empty() ? "" : table.name + '_';
    for (const QueryColumn& column : table.columns) arrays.emplace_back(prefix + column.name, npy_of(column));
  }
  std::vector<NpzMember> members;
  members.reserve(arrays.size());
  for (const auto& [name, bytes] : arrays) members.push_back({name, bytes});
  return write_output(path, write_npz(members), force);
}

}  // namespace chronormal
