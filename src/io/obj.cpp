#include "chronormal/io/obj.h"

#include <array>
#include <cassert>
#include <cstdint>
#include <utility>
#include <vector>

#include "io/polygon_builder.h"
#include "io/scan.h"

namespace chronormal {
namespace {

using scan::NumberFault;

std::string_view without_byte_order_mark(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  return bytes;
}

// Takes the next word of a statement; empty at its end or where a comment begins. Inside a word, # is not a comment:
// 1.#QNAN is a number that some programs write, and must not be read as 1.
std::string_view take_word(std::string_view& line) {
  const std::string_view word = scan::take_word(line);
  if (!word.starts_with('#')) return word;
  line = {};
  return {};
}

bool has_comment(std::string_view line) {
  for (std::string_view word = scan::take_word(line); !word.empty(); word = scan::take_word(line)) {
    if (word.starts_with('#')) return true;
  }
  return false;
}

class ObjReader {
 public:
  ObjReader(std::string_view bytes, const std::string& name)
      : name_(name), lines_(bytes, bytes.find('\n') == std::string_view::npos ? '\r' : '\n') {}

  Result<MeshFrame> read();

 private:
  [[nodiscard]] std::string_view whole_statement();
  [[nodiscard]] Status read_statement(std::string_view line);
  [[nodiscard]] Status read_vertex(std::string_view numbers);
  [[nodiscard]] Status read_face(std::string_view corners);
  [[nodiscard]] Status read_corner(std::string_view word);
  [[nodiscard]] Status resolve(std::int64_t index, std::string_view word);

  [[nodiscard]] Error error(std::string message) const { return error_in_line(statement_line_, std::move(message)); }
  [[nodiscard]] Error error_in_line(std::size_t line, std::string message) const {
    return invalid_input(name_ + ", line " + std::to_string(line), std::move(message));
  }
  [[nodiscard]] static std::string corner_name(std::size_t face, std::size_t corner) {
    return "corner " + std::to_string(corner) + " of face " + std::to_string(face);
  }
  [[nodiscard]] std::string open_corner() const { return corner_name(faces_.face_count(), faces_.open_corners()); }
  [[nodiscard]] std::size_t vertex_count() const { return positions_.size() / 3; }
  [[nodiscard]] std::string unknown_vertex(std::int64_t index) const {
    return " names vertex " + std::to_string(index) + ", but the file has " + std::to_string(vertex_count()) +
           (vertex_count() == 1 ? " vertex" : " vertices");
  }

  const std::string& name_;
  scan::Lines lines_;
  std::size_t statement_line_ = 0;  // where the statement begins that is being read
  std::string joined_;              // a statement of several lines
  std::vector<float> positions_;
  PolygonBuilder faces_;
  // The largest positive index so far: whether it names a vertex is known only at the end.
  struct Largest {
    std::int64_t index = 0;
    std::size_t line = 0;
    std::size_t face = 0;
    std::size_t corner = 0;
  };
  Largest largest_;
};

Result<MeshFrame> ObjReader::read() {
  while (lines_.next()) {
    statement_line_ = lines_.number();
    if (Status status = read_statement(whole_statement()); !status) return status.error();
  }
  const std::size_t last_line = lines_.number() == 0 ? 1 : lines_.number();
  if (positions_.empty()) return error_in_line(last_line, "the file ends without a vertex (a line that begins with v)");
  if (faces_.face_count() == 0)
    return error_in_line(last_line, "the file ends without a face (a line that begins with f)");
  if (largest_.index > static_cast<std::int64_t>(vertex_count()))
    return error_in_line(largest_.line, corner_name(largest_.face, largest_.corner) + unknown_vertex(largest_.index));

  Result<Topology> topology = faces_.build(vertex_count());
  if (!topology) return error_in_line(last_line, topology.error().text());
  positions_.shrink_to_fit();
  return MeshFrame{std::move(topology).value(), std::move(positions_)};
}

// The current line, and those that continue it.
std::string_view ObjReader::whole_statement() {
  const auto is_continued = [](std::string_view& line) {
    std::string_view body = line;
    while (!body.empty() && body.back() == '\r') body.remove_suffix(1);
    if (!body.ends_with('\\') || has_comment(body)) return false;
    body.remove_suffix(1);
    line = body;
    return true;
  };

  std::string_view line = lines_.line();
  if (!is_continued(line)) return line;
  joined_ = line;
  bool continued = true;
  while (continued && lines_.next()) {
    line = lines_.line();
    continued = is_continued(line);
    joined_ += ' ';
    joined_ += line;
  }
  return joined_;
}

Status ObjReader::read_statement(std::string_view line) {
  const std::string_view keyword = take_word(line);
  if (keyword == "v") return read_vertex(line);
  if (keyword == "f") return read_face(line);
  return Success{};
}

Status ObjReader::read_vertex(std::string_view numbers) {
  std::array<float, 3> position{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view word = take_word(numbers);
    const NumberFault fault = scan::parse_float(word, position[axis]);
    if (fault != NumberFault::kNone)
      return error(std::string(1, "xyz"[axis]) + " of vertex " + std::to_string(vertex_count()) + ": " +
                   scan::describe(fault, word));
  }
  for (std::string_view word = take_word(numbers); !word.empty(); word = take_word(numbers)) {
    float unused = 0;
    const NumberFault fault = scan::parse_float(word, unused);
    if (fault == NumberFault::kNotANumber)
      return error("after the position of vertex " + std::to_string(vertex_count()) + ": " +
                   scan::describe(fault, word));
  }
  positions_.insert(positions_.end(), position.begin(), position.end());
  return Success{};
}

Status ObjReader::read_face(std::string_view corners) {
  for (std::string_view word = take_word(corners); !word.empty(); word = take_word(corners)) {
    if (Status status = read_corner(word); !status) return status;
  }
  if (faces_.open_corners() < 3)
    return error("face " + std::to_string(faces_.face_count()) + " has " + std::to_string(faces_.open_corners()) +
                 " corners, but a face needs three or more");
  faces_.end_face();
  return Success{};
}

// One of v, v/vt, v//vn, v/vt/vn.
Status ObjReader::read_corner(std::string_view word) {
  const std::size_t first_slash = word.find('/');
  std::int64_t index = 0;
  const std::string_view vertex = word.substr(0, first_slash);
  const NumberFault fault = scan::parse_integer(vertex, index);
  if (fault == NumberFault::kNotANumber) return error(open_corner() + ": " + scan::quoted(word) + " is not an index");
  if (fault == NumberFault::kTooLarge)
    return error(open_corner() + ": " + scan::quoted(vertex) + " is more than a mesh can have");

  std::size_t slash = first_slash;
  for (int part = 0; slash != std::string_view::npos; ++part) {
    const std::size_t next = word.find('/', slash + 1);
    const std::string_view text = word.substr(slash + 1, next == std::string_view::npos ? next : next - slash - 1);
    std::int64_t unused = 0;
    if (part == 2 || (!text.empty() && scan::parse_integer(text, unused) == NumberFault::kNotANumber))
      return error(open_corner() + ": " + scan::quoted(word) + " is not of the form v, v/vt, v//vn or v/vt/vn");
    slash = next;
  }
  return resolve(index, word);
}

Status ObjReader::resolve(std::int64_t index, std::string_view word) {
  const auto count = static_cast<std::int64_t>(vertex_count());
  if (index == 0) return error(open_corner() + ": " + scan::quoted(word) + ": vertices are counted from 1, not from 0");
  if (index < -count) return error(open_corner() + unknown_vertex(index) + " so far");
  if (index > largest_.index) largest_ = {index, statement_line_, faces_.face_count(), faces_.open_corners()};
  const std::int64_t vertex = index < 0 ? count + index : index - 1;
  // What does not fit in 32 bits is refused at the end, by largest_.
  if (!faces_.add_corner(static_cast<std::uint32_t>(vertex)))
    return error("the mesh has more than 4,294,967,295 corners");
  return Success{};
}

}  // namespace

Result<MeshFrame> read_obj(std::string_view bytes, const std::string& name) {
  return ObjReader(without_byte_order_mark(bytes), name).read();
}

std::string write_obj(const Topology& topology, VectorView<const float> positions) {
  assert(positions.count == topology.vertex_count());
  std::string text;
  text.reserve(32 * positions.count + 8 * topology.corner_count());
  for (std::size_t v = 0; v < positions.count; ++v) {
    const Vec3f position = positions[v];
    text += 'v';
    for (const float coordinate : {position.x, position.y, position.z}) {
      text += ' ';
      scan::append_number(text, coordinate);
    }
    text += '\n';
  }
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    text += 'f';
    for (const std::uint32_t vertex : topology.face(f)) {
      text += ' ';
      scan::append_number(text, std::uint64_t{vertex} + 1);
    }
    text += '\n';
  }
  return text;
}

}  // namespace chronormal
