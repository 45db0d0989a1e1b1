#include "io/mesh/make_human_target.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <new>
#include <utility>

#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/bytes/extension.h"
#include "io/bytes/scan.h"

namespace chronormal::inline internal {
namespace {

using scan::NumberFault;

// A stream of zlib. inflateInit2() initialises it, and the destructor calls inflateEnd().
struct Inflater {
  z_stream stream{};
  bool is_ready = ::inflateInit2(&stream, 16 + MAX_WBITS) == Z_OK;  // adding 16 means that only gzip is accepted

  Inflater() = default;
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;
  ~Inflater() {
    if (is_ready) (void)::inflateEnd(&stream);
  }
};

// Unpacks all members of a gzip file, but no more than `most` bytes. The memory in use grows with the result, not with
// `most`.
Result<std::string> unpack_gzip(std::string_view packed, std::size_t most, const std::string& name) {
  constexpr std::size_t kMostAtOnce = std::numeric_limits<uInt>::max(), kFirstRoom = 16384;
  Inflater inflater;
  if (!inflater.is_ready) throw std::bad_alloc();
  z_stream& stream = inflater.stream;
  std::string text;
  std::size_t done = 0, handed_over = 0;
  const auto error = [&](std::string message) {
    return invalid_input(binary::place(name, handed_over - stream.avail_in), std::move(message));
  };

  for (;;) {
    if (stream.avail_in == 0) {
      const std::string_view part = packed.substr(handed_over, kMostAtOnce);
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(part.data()));  // zlib only reads these bytes
      stream.avail_in = static_cast<uInt>(part.size());
      handed_over += part.size();
    }
    // The buffer may become one byte longer than allowed, so that a result which is too long is noticed.
    if (done == text.size()) text.resize(std::min(most + 1, std::max(kFirstRoom, 2 * done)));
    const auto room = static_cast<uInt>(std::min(text.size() - done, kMostAtOnce));
    stream.next_out = reinterpret_cast<Bytef*>(text.data() + done);
    stream.avail_out = room;
    const int code = ::inflate(&stream, Z_NO_FLUSH);
    done += room - stream.avail_out;

    if (done > most)
      return error("the file unpacks to more than " + counted(most, "byte", "bytes") +
                   ", which is more than a target of this base can need; give the base that the target was made for");
    if (code == Z_OK) continue;
    if (code == Z_MEM_ERROR) throw std::bad_alloc();
    if (code == Z_BUF_ERROR)
      // zlib still has room in the buffer, so it is waiting for more input.
      return error("the gzip data are cut off; copy the file again");
    if (code != Z_STREAM_END) {
      std::string message = "the gzip data are damaged; copy the file again";
      if (stream.msg != nullptr) message.append(" (").append(stream.msg).append(")");
      return error(std::move(message));
    }
    if (stream.avail_in == 0 && handed_over == packed.size()) break;
    (void)::inflateReset(&stream);  // prepares for another member
  }
  text.resize(done);
  return text;
}

class TargetReader {
 public:
  TargetReader(std::string_view text, const std::string& name, VectorView<const float> base)
      : name_(name), lines_(text, text.find('\n') == std::string_view::npos ? '\r' : '\n'), base_(base) {}

  Result<MakeHumanTarget> read() {
    has_delta_.assign(base_.count, false);
    while (lines_.next()) {
      if (Status status = read_line(lines_.line()); !status) return status.error();
    }
    return std::move(target_);
  }

 private:
  [[nodiscard]] Status read_line(std::string_view line);
  [[nodiscard]] Result<std::uint32_t> read_vertex(std::string_view word);
  [[nodiscard]] Error error(std::string message) const {
    return invalid_input(name_ + ", line " + std::to_string(lines_.number()), std::move(message));
  }

  const std::string& name_;
  scan::Lines lines_;
  VectorView<const float> base_;
  std::vector<bool> has_delta_;  // true for each vertex that has a delta
  MakeHumanTarget target_;
};

Status TargetReader::read_line(std::string_view line) {
  const std::string_view first = scan::take_word(line);
  if (first.empty() || first.starts_with('#')) return Success{};
  const Result<std::uint32_t> vertex = read_vertex(first);
  if (!vertex) return vertex.error();

  const Vec3f position = base_[vertex.value()];
  const std::array<float, 3> from = {position.x, position.y, position.z};
  std::array<float, 3> delta{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto axis_error = [&](const std::string& message) {
      return error(std::string(1, "xyz"[axis]) + " of vertex " + std::to_string(vertex.value()) + ": " + message);
    };
    std::string_view word = scan::take_word(line);
    if (word.starts_with('#')) word = {};
    const NumberFault fault = scan::parse_float(word, delta[axis]);
    if (fault != NumberFault::kNone) return axis_error(scan::describe(fault, word));
    if (!std::isfinite(from[axis] + delta[axis]))
      return axis_error("the sum of base and delta is too large for float32; scale the mesh down");
  }
  const std::string_view rest = scan::take_word(line);
  if (!rest.empty() && !rest.starts_with('#'))
    return error("the line has " + scan::quoted(rest) + " after the delta of vertex " + std::to_string(vertex.value()) +
                 ", but must have only an index and three numbers");

  has_delta_[vertex.value()] = true;
  target_.vertices.push_back(vertex.value());
  target_.deltas.insert(target_.deltas.end(), delta.begin(), delta.end());
  return Success{};
}

Result<std::uint32_t> TargetReader::read_vertex(std::string_view word) {
  std::int64_t index = 0;
  const NumberFault fault = scan::parse_integer(word, index);
  if (fault == NumberFault::kNotANumber)
    return error(scan::quoted(word) + " is not the index of a vertex; a line must have an index and three numbers");
  const bool is_vertex =
      fault == NumberFault::kNone && index >= 0 && static_cast<std::uint64_t>(index) < std::uint64_t{base_.count};
  if (!is_vertex)
    return error(scan::quoted(word) + " is not a vertex of the base, whose " +
                 counted(base_.count, "vertex is", "vertices are") +
                 " counted from 0; give the base that the target was made for");
  const auto vertex = static_cast<std::uint32_t>(index);
  if (has_delta_[vertex])
    return error("vertex " + std::to_string(vertex) + " has two deltas in this file; remove one of them");
  return vertex;
}

}  // namespace

bool is_make_human_target(std::string_view file_name) {
  if (lower_extension(file_name) == ".gz") file_name.remove_suffix(3);
  return lower_extension(file_name) == ".target";
}

Result<MakeHumanTarget> read_make_human_target(std::string_view bytes, const std::string& name,
                                               VectorView<const float> base) {
  if (bytes.empty()) return invalid_input(name + ", line 1", "the file is empty; copy or export it again");
  std::string unpacked;
  if (bytes.starts_with("\x1F\x8B")) {
    Result<std::string> text = unpack_gzip(bytes, most_target_bytes(base.count), name);
    if (!text) return text.error();
    unpacked = std::move(text).value();
    bytes = unpacked;
  }
  if (Status text = scan::check_text(bytes, name); !text) return text.error();
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  return TargetReader(bytes, name, base).read();
}

}  // namespace chronormal::inline internal
