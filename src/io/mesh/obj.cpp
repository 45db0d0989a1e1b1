// Reads OBJ files statement by statement, with fast paths for plain numbers and corners.
#include "io/mesh/obj.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <utility>
#include <vector>

#include "core/text.h"
#include "io/bytes/scan.h"
#include "io/mesh/polygon_builder.h"

namespace chronormal::inline internal {
namespace {

using scan::NumberFault;

std::string_view without_byte_order_mark(std::string_view bytes) {
  if (bytes.starts_with("\xEF\xBB\xBF")) bytes.remove_prefix(3);
  return bytes;
}

// Removes and returns the next word of a statement. Returns an empty word at the end of the statement or before a
// comment. Inside a word, # does not begin a comment, because some programs write NaN as 1.#QNAN, which must not be
// read as 1.
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

// The shading of the faces that were read so far.
struct Shading {
  std::vector<float> normals;                   // three numbers for each "vn"
  std::vector<std::uint32_t> normal_of_corner;  // for each corner, the index of its normal plus 1, or 0 for none
  bool has_normals = false;                     // true if some corner has a normal
  std::map<std::string, std::uint32_t, std::less<>> groups;
  std::vector<std::uint32_t> group_of_face;
  std::uint32_t group = 0;  // smoothing group of the faces that follow
  bool has_groups = false;  // true if there was a statement "s"
  // The number of corners that refer to a normal which the file does not have, and the number of statements "s" without
  // a group.
  std::size_t unknown_normals = 0, nameless_groups = 0;

  [[nodiscard]] std::size_t normal_count() const { return normals.size() / 3; }
};

class ObjReader {
 public:
  /// Creates a reader. The reader skips statements of shading if `shading` is nullptr.
  ObjReader(std::string_view bytes, const std::string& name, const Origin& origin, Shading* shading)
      : name_(name),
        lines_(bytes, bytes.find('\n') == std::string_view::npos ? '\r' : '\n'),
        origin_(origin),
        is_far_(origin != Origin{}),
        shading_(shading) {}

  Result<MeshFrame> read();

 private:
  [[nodiscard]] std::string_view whole_statement();
  [[nodiscard]] Status read_statement(std::string_view line);
  [[nodiscard]] Status read_vertex(std::string_view numbers);
  [[nodiscard]] Status read_face(std::string_view corners);
  [[nodiscard]] Status read_corner(std::string_view word);
  [[nodiscard]] Status resolve(std::int64_t index, std::string_view word);
  [[nodiscard]] Status read_normal(std::string_view numbers);
  [[nodiscard]] Status read_group(std::string_view line);
  void resolve_normal(std::string_view word);
  [[nodiscard]] scan::NumberFault read_coordinate(std::string_view word, std::size_t axis, float& coordinate);

  [[nodiscard]] Error error(std::string message) const { return error_in_line(statement_line_, std::move(message)); }
  [[nodiscard]] Error error_in_line(std::size_t line, std::string message) const {
    return invalid_input(name_ + ", line " + std::to_string(line), std::move(message));
  }
  [[nodiscard]] static std::string corner_name(std::size_t face, std::size_t corner) {
    return "corner " + std::to_string(corner) + " of face " + std::to_string(face);
  }
  [[nodiscard]] std::string open_corner() const { return corner_name(faces_.face_count(), faces_.open_corners()); }
  [[nodiscard]] std::size_t vertex_count() const { return positions_.size() / 3; }
  [[nodiscard]] std::string unknown_vertex(std::int64_t index, const char* when = "") const {
    return " refers to vertex " + std::to_string(index) + ", but the file has " +
           counted(vertex_count(), "vertex", "vertices") + when + "; export the file again";
  }

  const std::string& name_;
  scan::Lines lines_;
  std::size_t statement_line_ = 0;  // number of the line at which the current statement begins
  std::string joined_;              // text of a statement that extends over several lines
  std::vector<float> positions_;
  PolygonBuilder faces_;
  // The largest positive vertex index so far, and the place where it was used. A face may refer to a later vertex, so
  // only the end of the file shows if the vertex exists.
  struct Largest {
    std::int64_t index = 0;
    std::size_t line = 0;
    std::size_t face = 0;
    std::size_t corner = 0;
  };
  Largest largest_;
  Origin origin_;
  bool is_far_, has_more_digits_ = false;
  std::size_t dropped_faces_ = 0;
  Shading* shading_;
};

Result<MeshFrame> ObjReader::read() {
  while (lines_.next()) {
    statement_line_ = lines_.number();
    if (Status status = read_statement(whole_statement()); !status) return status.error();
  }
  const std::size_t last_line = lines_.number() == 0 ? 1 : lines_.number();
  if (positions_.empty())
    return error_in_line(last_line, "the file has no vertices (lines that begin with v); export a mesh");
  if (faces_.face_count() == 0)
    return error_in_line(last_line, "the file has no faces (lines that begin with f); export a mesh with faces");
  if (largest_.index > static_cast<std::int64_t>(vertex_count()))
    return error_in_line(largest_.line, corner_name(largest_.face, largest_.corner) + unknown_vertex(largest_.index));

  Result<Topology> topology = faces_.build(vertex_count());
  if (!topology) return error_in_line(last_line, topology.error().text());
  positions_.shrink_to_fit();
  MeshFrame mesh{std::move(topology).value(), std::move(positions_)};
  mesh.has_more_digits = has_more_digits_;
  const auto note = [&](std::size_t count, const char* one, const char* several) {
    if (count > 0) mesh.notes.push_back(std::to_string(count) + (count == 1 ? one : several));
  };
  note(dropped_faces_, " face has fewer than three corners and is left out",
       " faces have fewer than three corners and are left out");
  if (shading_ == nullptr) return mesh;
  // Normals may come after the faces that refer to them, so the indices of normals are checked at the end.
  for (std::uint32_t& index : shading_->normal_of_corner) {
    if (index > shading_->normal_count()) {
      index = 0;
      ++shading_->unknown_normals;
    }
    shading_->has_normals = shading_->has_normals || index > 0;
  }
  note(shading_->unknown_normals, " corner refers to a normal that the file does not have, so this normal is left out",
       " corners refer to normals that the file does not have, so these normals are left out");
  note(shading_->nameless_groups, " line begins with s but names no smoothing group, and is read as 's off'",
       " lines begin with s but name no smoothing group, and are read as 's off'");
  return mesh;
}

// Returns the current line, joined with the lines that continue it.
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
  if (shading_ == nullptr) return Success{};
  if (keyword == "vn") return read_normal(line);
  if (keyword == "s") return read_group(line);
  return Success{};
}

// Returns true if the rest of a statement has only blanks.
bool is_over(std::string_view rest) { return std::all_of(rest.begin(), rest.end(), scan::is_blank); }

Status ObjReader::read_vertex(std::string_view numbers) {
  std::array<float, 3> position{};
  std::string_view rest = numbers;
  if (!is_far_ && scan::take_plain_float(rest, position[0]) && scan::take_plain_float(rest, position[1]) &&
      scan::take_plain_float(rest, position[2]) && is_over(rest)) {
    positions_.insert(positions_.end(), position.begin(), position.end());
    return Success{};
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::string_view word = take_word(numbers);
    const NumberFault fault = read_coordinate(word, axis, position[axis]);
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

// Reads a coordinate and subtracts the origin from it. `axis` is 0, 1 or 2.
NumberFault ObjReader::read_coordinate(std::string_view word, std::size_t axis, float& coordinate) {
  if (!is_far_) return scan::parse_float(word, coordinate);
  double value = 0, last_digit = 0;
  const NumberFault fault = scan::parse_double(word, value, last_digit);
  has_more_digits_ = has_more_digits_ || loses_digits(value, last_digit);
  coordinate = static_cast<float>(value - origin_[axis]);
  return fault;
}

// Removes a corner from the front of the line and returns its index, if the corner is only the digits of a positive
// index. Otherwise returns 0 and leaves the line unchanged.
std::int64_t take_plain_corner(std::string_view& line) {
  constexpr std::ptrdiff_t kMostDigits = 9;
  const char* at = line.data();
  const char* const end = at + line.size();
  const auto is_digit = [](char c) { return c >= '0' && c <= '9'; };
  while (at != end && scan::is_blank(*at)) ++at;
  const char* const first = at;
  std::int64_t index = 0;
  for (; at != end && is_digit(*at) && at - first < kMostDigits; ++at) index = 10 * index + (*at - '0');
  for (int slashes = 0; at != first && at != end && *at == '/' && slashes < 2; ++slashes) {
    ++at;
    while (at != end && is_digit(*at)) ++at;
  }
  if (at != end && !scan::is_blank(*at)) return 0;
  if (index > 0) line.remove_prefix(static_cast<std::size_t>(at - line.data()));
  return index;
}

Status ObjReader::read_face(std::string_view corners) {
  if (shading_ == nullptr) {
    for (std::int64_t index = take_plain_corner(corners); index > 0; index = take_plain_corner(corners))
      if (Status status = resolve(index, {}); !status) return status;
  }
  for (std::string_view word = take_word(corners); !word.empty(); word = take_word(corners)) {
    if (Status status = read_corner(word); !status) return status;
  }
  if (faces_.open_corners() < 3) {
    if (shading_ != nullptr)
      shading_->normal_of_corner.resize(shading_->normal_of_corner.size() - faces_.open_corners());
    faces_.drop_face();
    ++dropped_faces_;
    return Success{};
  }
  faces_.end_face();
  if (shading_ != nullptr) shading_->group_of_face.push_back(shading_->group);
  return Success{};
}

// Reads a corner in one of the forms v, v/vt, v//vn, v/vt/vn.
Status ObjReader::read_corner(std::string_view word) {
  const std::size_t first_slash = word.find('/');
  std::int64_t index = 0;
  const std::string_view vertex = word.substr(0, first_slash);
  const NumberFault fault = scan::parse_integer(vertex, index);
  if (fault == NumberFault::kNotANumber)
    return error(open_corner() + ": " + scan::quoted(word) + " is not the index of a vertex; export the file again");
  if (fault == NumberFault::kTooLarge)
    return error(open_corner() + ": " + scan::quoted(vertex) +
                 " is a larger index than a mesh can have; export the file again");

  std::size_t slash = first_slash;
  std::string_view normal;
  for (int part = 0; slash != std::string_view::npos; ++part) {
    const std::size_t next = word.find('/', slash + 1);
    const std::string_view text = word.substr(slash + 1, next == std::string_view::npos ? next : next - slash - 1);
    std::int64_t unused = 0;
    if (part == 2 || (!text.empty() && scan::parse_integer(text, unused) == NumberFault::kNotANumber))
      return error(open_corner() + ": " + scan::quoted(word) + " must be written as v, v/vt, v//vn or v/vt/vn");
    if (part == 1) normal = text;
    slash = next;
  }
  if (shading_ != nullptr) resolve_normal(normal);
  return resolve(index, word);
}

Status ObjReader::resolve(std::int64_t index, std::string_view word) {
  const auto count = static_cast<std::int64_t>(vertex_count());
  if (index == 0)
    return error(open_corner() + ": " + scan::quoted(word) +
                 " is not allowed, since vertices are counted from 1; export the file again");
  if (index < -count) return error(open_corner() + unknown_vertex(index, " so far"));
  if (index > largest_.index) largest_ = {index, statement_line_, faces_.face_count(), faces_.open_corners()};
  const std::int64_t vertex = index < 0 ? count + index : index - 1;
  // An index that does not fit into 32 bits is larger than the number of vertices. The check of largest_ at the end of
  // the file reports such an index.
  if (!faces_.add_corner(static_cast<std::uint32_t>(vertex)))
    return error("the mesh has more than 4,294,967,295 corners; split the mesh");
  return Success{};
}

Status ObjReader::read_normal(std::string_view numbers) {
  for (const char axis : {'x', 'y', 'z'}) {
    const std::string_view word = take_word(numbers);
    float component = 0;
    const NumberFault fault = scan::parse_float(word, component);
    if (fault != NumberFault::kNone)
      return error(std::string(1, axis) + " of normal " + std::to_string(shading_->normal_count()) + ": " +
                   scan::describe(fault, word));
    shading_->normals.push_back(component);
  }
  return Success{};
}

// Reads the smoothing group of the next faces. Groups are told apart by their names, and numbers are compared by value,
// so 01 is the group 1.
Status ObjReader::read_group(std::string_view line) {
  const std::string_view word = take_word(line);
  shading_->has_groups = true;
  if (word.empty()) ++shading_->nameless_groups;
  std::int64_t number = 0;
  const bool is_number = scan::parse_integer(word, number) == NumberFault::kNone;
  if (word.empty() || word == "off" || (is_number && number == 0)) {
    shading_->group = 0;
    return Success{};
  }
  const auto next = static_cast<std::uint32_t>(shading_->groups.size() + 1);
  shading_->group =
      shading_->groups.try_emplace(is_number ? std::to_string(number) : std::string(word), next).first->second;
  return Success{};
}

// Sets the normal of the next corner. An empty word means that the corner has no normal. An index without a normal is
// found at the end of the file, because the normal may come after the face.
void ObjReader::resolve_normal(std::string_view word) {
  std::int64_t index = 0;
  if (!word.empty()) {
    constexpr auto kMost = std::int64_t{std::numeric_limits<std::uint32_t>::max()};
    const auto count = static_cast<std::int64_t>(shading_->normal_count());
    (void)scan::parse_integer(word, index);
    if (index < 0) index += count + 1;
    const bool is_known = index > 0 && index < kMost;
    if (!is_known) ++shading_->unknown_normals;
    if (!is_known) index = 0;
  }
  shading_->normal_of_corner.push_back(static_cast<std::uint32_t>(index));
}

void append_vectors(std::string& text, std::string_view keyword, VectorView<const float> vectors,
                    const Origin& origin = {}) {
  const bool is_far = origin != Origin{};
  for (std::size_t i = 0; i < vectors.count; ++i) {
    const Vec3f vector = vectors[i];
    text += keyword;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const float component = axis == 0 ? vector.x : axis == 1 ? vector.y : vector.z;
      text += ' ';
      if (is_far)
        scan::append_number(text, double{component} + origin[axis]);
      else
        scan::append_number(text, component);
    }
    text += '\n';
  }
}

// Appends the statements of all faces. If normal_of_corner is empty, corners have only vertices.
void append_faces(std::string& text, const Topology& topology, std::span<const std::uint32_t> normal_of_corner) {
  std::size_t corner = 0;
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    text += 'f';
    for (const std::uint32_t vertex : topology.face(f)) {
      text += ' ';
      scan::append_number(text, std::uint64_t{vertex} + 1);
      if (!normal_of_corner.empty()) {
        text += "//";
        scan::append_number(text, std::uint64_t{normal_of_corner[corner++]} + 1);
      }
    }
    text += '\n';
  }
}

}  // namespace

Result<MeshFrame> read_obj(std::string_view bytes, const std::string& name, const Origin& origin) {
  if (Status text = scan::check_text(bytes, name); !text) return text.error();
  return ObjReader(without_byte_order_mark(bytes), name, origin, nullptr).read();
}

Result<MeshFrame> read_obj_shading(std::string_view bytes, const std::string& name, const Origin& origin) {
  if (Status text = scan::check_text(bytes, name); !text) return text.error();
  Shading read;
  Result<MeshFrame> mesh = ObjReader(without_byte_order_mark(bytes), name, origin, &read).read();
  if (!mesh) return mesh;
  MeshFrame& shading = mesh.value();
  if (read.has_groups) shading.group_of_face = std::move(read.group_of_face);
  if (read.has_normals) {
    shading.normal_of_corner.reserve(3 * read.normal_of_corner.size());
    for (const std::uint32_t index : read.normal_of_corner) {
      for (std::size_t k = 0; k < 3; ++k)
        shading.normal_of_corner.push_back(index == 0 ? 0.0F : read.normals[3 * (std::size_t{index} - 1) + k]);
    }
  }
  return mesh;
}

std::string write_obj(const Topology& topology, VectorView<const float> positions, const Origin& origin) {
  assert(positions.count == topology.vertex_count());
  std::string text;
  text.reserve(32 * positions.count + 8 * topology.corner_count());
  append_vectors(text, "v", positions, origin);
  append_faces(text, topology, {});
  return text;
}

std::string write_obj(const Topology& topology, VectorView<const float> positions, VectorView<const float> normals,
                      std::span<const std::uint32_t> normal_of_corner, const Origin& origin) {
  assert(positions.count == topology.vertex_count() && normal_of_corner.size() == topology.corner_count());
  std::string text;
  text.reserve(32 * (positions.count + normals.count) + 16 * topology.corner_count());
  append_vectors(text, "v", positions, origin);
  append_vectors(text, "vn", normals);
  append_faces(text, topology, normal_of_corner);
  return text;
}

}  // namespace chronormal::inline internal
