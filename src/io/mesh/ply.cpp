#include "io/mesh/ply.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <utility>
#include <vector>

#include "core/bits.h"
#include "core/text.h"
#include "io/bytes/scan.h"
#include "io/mesh/ply_header.h"
#include "io/mesh/polygon_builder.h"

namespace chronormal::inline internal {
namespace {

using ply::Element;
using ply::Header;
using ply::Property;
using ply::Role;
using ply::Scalar;

// A source of the values of an ascii file. A source returns the values behind the header in order, and each encoding
// has a class of its own for this. The functions of a source return false if a value is missing or malformed; message()
// and place() then describe the error and its place.

class AsciiSource {
 public:
  AsciiSource(std::string_view bytes, const Header& header)
      : left_(bytes.size() - header.body_begin),
        lines_(bytes.substr(header.body_begin), header.separator),
        header_lines_(header.line_count) {}

  // Returns the smallest number of bytes that a value can take: a digit and a separator. The last row may have no
  // separator at its end, so bytes_left() counts one byte more.
  [[nodiscard]] static std::size_t fewest_bytes(const Property& /*property*/) { return 2; }
  [[nodiscard]] std::size_t bytes_left() const { return left_ - lines_.position() + 1; }

  [[nodiscard]] bool begin_row() {
    do {
      if (!lines_.next()) return fail("the file is cut off here, before this row; copy or export it again");
      row_ = lines_.line();
      next_ = scan::take_word(row_);
    } while (next_.empty());
    return true;
  }
  [[nodiscard]] bool end_row() {
    if (!next_.empty())
      return fail(scan::quoted(next_) + " is one value more than the header declares for a row; export the file again");
    return true;
  }

  [[nodiscard]] bool skip(Scalar, std::uint64_t count) {
    for (; count > 0; --count) {
      if (take().empty()) return fail("the row has fewer values than the header declares; export the file again");
    }
    return true;
  }
  [[nodiscard]] bool integer(Scalar, std::int64_t& value) {
    const std::string_view word = take();
    return check(scan::parse_integer(word, value), word);
  }
  [[nodiscard]] bool coordinate(Scalar, float& value) {
    const std::string_view word = take();
    return check(scan::parse_float(word, value), word);
  }
  [[nodiscard]] bool coordinate(Scalar, double& value, double& last_digit) {
    const std::string_view word = take();
    return check(scan::parse_double(word, value, last_digit), word);
  }

  [[nodiscard]] std::string place() const {
    return "line " + std::to_string(header_lines_ + std::max<std::size_t>(lines_.number(), 1));
  }
  [[nodiscard]] const std::string& message() const { return message_; }

 private:
  // Removes and returns the next word. A row may continue in the next line.
  std::string_view take() {
    while (next_.empty() && lines_.next()) {
      row_ = lines_.line();
      next_ = scan::take_word(row_);
    }
    return std::exchange(next_, scan::take_word(row_));
  }
  bool check(scan::NumberFault fault, std::string_view word) {
    return fault == scan::NumberFault::kNone || fail(scan::describe(fault, word));
  }
  bool fail(std::string message) {
    message_ = std::move(message);
    return false;
  }

  std::size_t left_;
  scan::Lines lines_;
  std::size_t header_lines_;
  std::string_view row_;   // rest of the current line behind next_
  std::string_view next_;  // the word that take() returns next; empty at the end of the line
  std::string message_;
};

class BinarySource {
 public:
  BinarySource(std::string_view bytes, const Header& header)
      : bytes_(bytes),
        position_(header.body_begin),
        is_swapped_((header.encoding == PlyEncoding::kBinaryBigEndian) != (std::endian::native == std::endian::big)) {}

  [[nodiscard]] static std::size_t fewest_bytes(const Property& property) {
    return ply::byte_size(property.is_list ? property.count_type : property.type);
  }
  [[nodiscard]] std::size_t bytes_left() const { return bytes_.size() - position_; }

  [[nodiscard]] bool begin_row() { return true; }
  [[nodiscard]] bool end_row() { return true; }

  [[nodiscard]] bool skip(Scalar type, std::uint64_t count) {
    if (count > bytes_left() / ply::byte_size(type)) return fail_at_end();
    position_ += static_cast<std::size_t>(count) * ply::byte_size(type);
    return true;
  }
  [[nodiscard]] bool integer(Scalar type, std::int64_t& value) {
    double unused = 0;
    return load(type, value, unused);
  }
  [[nodiscard]] bool coordinate(Scalar type, float& value) {
    std::int64_t whole = 0;
    double real = 0;
    if (!load(type, whole, real)) return false;
    if (ply::is_integer(type)) {
      value = static_cast<float>(whole);
      return true;
    }
    if (!std::isfinite(real)) return fail("the coordinate is NaN or infinite; export the file again", type);
    if (std::fabs(real) > std::numeric_limits<float>::max())
      return fail("the coordinate is too large for float32; scale the mesh down", type);
    value = static_cast<float>(real);
    return true;
  }

  [[nodiscard]] bool coordinate(Scalar type, double& value, double& last_digit) {
    std::int64_t whole = 0;
    if (!load(type, whole, value)) return false;
    if (ply::is_integer(type)) {
      value = static_cast<double>(whole);
      last_digit = 1;
      return true;
    }
    if (!std::isfinite(value)) return fail("the coordinate is NaN or infinite; export the file again", type);
    if (std::fabs(value) > std::numeric_limits<float>::max())
      return fail("the coordinate is too large for float32; scale the mesh down", type);
    // A binary number has no decimal digits. 0 means that any rounding to float32 counts as a loss of digits.
    last_digit = 0;
    return true;
  }

  [[nodiscard]] std::string place() const { return "byte " + std::to_string(position_); }
  [[nodiscard]] const std::string& message() const { return message_; }

 private:
  template <class T>
  [[nodiscard]] T take() {
    std::array<char, sizeof(T)> raw{};
    std::memcpy(raw.data(), bytes_.data() + position_, sizeof(T));
    if (is_swapped_) std::reverse(raw.begin(), raw.end());
    position_ += sizeof(T);
    return bit_cast<T>(raw);
  }

  // Reads a value of an integer type into `whole`, or of a floating-point type into `real`.
  [[nodiscard]] bool load(Scalar type, std::int64_t& whole, double& real) {
    if (ply::byte_size(type) > bytes_left()) return fail_at_end();
    switch (type) {
      case Scalar::kInt8:
        whole = std::int64_t{take<std::int8_t>()};
        break;
      case Scalar::kUint8:
        whole = take<std::uint8_t>();
        break;
      case Scalar::kInt16:
        whole = take<std::int16_t>();
        break;
      case Scalar::kUint16:
        whole = take<std::uint16_t>();
        break;
      case Scalar::kInt32:
        whole = take<std::int32_t>();
        break;
      case Scalar::kUint32:
        whole = take<std::uint32_t>();
        break;
      case Scalar::kFloat32:
        real = take<float>();
        break;
      case Scalar::kFloat64:
        real = take<double>();
        break;
    }
    return true;
  }
  bool fail_at_end() {
    message_ = "the file is cut off, since only " + counted(bytes_left(), "byte is", "bytes are") +
               " left for this row; copy or export it again";
    return false;
  }
  // Reports an error at the value that was read last. Returns false.
  bool fail(std::string message, Scalar type) {
    message_ = std::move(message);
    position_ -= ply::byte_size(type);
    return false;
  }

  std::string_view bytes_;
  std::size_t position_;
  bool is_swapped_;
  std::string message_;
};

template <class Source>
class BodyReader {
 public:
  BodyReader(std::string_view bytes, const std::string& name, const Header& header, bool has_velocities,
             const Origin& origin)
      : name_(name),
        header_(header),
        source_(bytes, header),
        has_velocities_(has_velocities),
        origin_(origin),
        is_far_(origin != Origin{}) {}

  Result<MeshFrame> read() {
    if (Status status = check_counts(); !status) return status.error();
    for (std::size_t e = 0; e < header_.elements.size(); ++e) {
      if (Status status = read_element(e); !status) return status.error();
    }
    if (faces_.face_count() == 0)
      return invalid_input(name_ + ", " + source_.place(),
                           "no face has three or more corners, so the mesh has no normals; export a mesh with faces");
    Result<Topology> topology = faces_.build(vertex_count());
    if (!topology) return invalid_input(name_ + ", " + source_.place(), topology.error().text());
    MeshFrame mesh{std::move(topology).value(), std::move(positions_)};
    mesh.velocities = std::move(velocities_);
    mesh.has_more_digits = has_more_digits_;
    if (dropped_faces_ > 0)
      mesh.notes.push_back(std::to_string(dropped_faces_) +
                           (dropped_faces_ == 1 ? " face has fewer than three corners and is left out"
                                                : " faces have fewer than three corners and are left out"));
    return mesh;
  }

 private:
  [[nodiscard]] std::size_t vertex_count() const {
    return static_cast<std::size_t>(header_.elements[header_.vertex_element].count);
  }

  [[nodiscard]] Status read_element(std::size_t e) {
    const Element& element = header_.elements[e];
    // An element without properties takes no bytes, however large its count is, so its rows are skipped at once.
    if (element.properties.empty()) return Success{};
    // The counts have been checked against the size of the file, so a small file cannot ask for much memory here.
    if (e == header_.vertex_element) positions_.reserve(3 * static_cast<std::size_t>(element.count));
    if (e == header_.face_element) faces_.reserve_triangles(static_cast<std::size_t>(element.count));
    for (std::uint64_t row = 0; row < element.count; ++row) {
      if (!read_row(e))
        return invalid_input(name_ + ", " + source_.place() + ", " + row_name(element, row),
                             message_.empty() ? source_.message() : message_);
    }
    return Success{};
  }

  // Checks that the file is large enough for all elements, before the first one is read.
  [[nodiscard]] Status check_counts() const {
    std::uint64_t left = source_.bytes_left();
    for (const Element& element : header_.elements) {
      if (element.properties.empty()) continue;
      std::uint64_t row_bytes = 0;
      for (const Property& property : element.properties) row_bytes += Source::fewest_bytes(property);
      if (element.count > left / row_bytes)
        return invalid_input(name_ + ", " + source_.place(),
                             "the file is too short for the " + counted(element.count, "element", "elements") + " " +
                                 scan::quoted(element.name) + " in its header; copy or export it again");
      left -= element.count * row_bytes;
    }
    return Success{};
  }

  [[nodiscard]] bool read_row(std::size_t e) {
    std::array<float, 6> vertex{};  // the position and the velocity
    if (!source_.begin_row()) return false;
    for (const Property& property : header_.elements[e].properties) {
      switch (property.role) {
        case Role::kX:
        case Role::kY:
        case Role::kZ:
          if (!read_coordinate(property, vertex[static_cast<std::size_t>(property.role)])) return false;
          break;
        case Role::kVelocityX:
        case Role::kVelocityY:
        case Role::kVelocityZ:
          if (!source_.coordinate(property.type, vertex[static_cast<std::size_t>(property.role)])) return false;
          break;
        case Role::kIndices:
          if (!read_face(property)) return false;
          break;
        case Role::kOther:
          if (!skip(property)) return false;
          break;
      }
    }
    if (!source_.end_row()) return false;
    if (e != header_.vertex_element) return true;
    positions_.insert(positions_.end(), vertex.begin(), vertex.begin() + 3);
    if (has_velocities_) velocities_.insert(velocities_.end(), vertex.begin() + 3, vertex.end());
    return true;
  }

  // Reads a coordinate and subtracts the origin from it.
  [[nodiscard]] bool read_coordinate(const Property& property, float& coordinate) {
    if (!is_far_) return source_.coordinate(property.type, coordinate);
    double value = 0, last_digit = 0;
    if (!source_.coordinate(property.type, value, last_digit)) return false;
    has_more_digits_ = has_more_digits_ || loses_digits(value, last_digit);
    coordinate = static_cast<float>(value - origin_[static_cast<std::size_t>(property.role)]);
    return true;
  }

  [[nodiscard]] bool read_length(const Property& property, std::int64_t& length) {
    if (!source_.integer(property.count_type, length)) return false;
    return length >= 0 || fail("a list has a negative length, " + std::to_string(length) + "; export the file again");
  }

  [[nodiscard]] bool skip(const Property& property) {
    if (!property.is_list) return source_.skip(property.type, 1);
    std::int64_t length = 0;
    return read_length(property, length) && source_.skip(property.type, static_cast<std::uint64_t>(length));
  }

  [[nodiscard]] bool read_face(const Property& property) {
    std::int64_t corner_count = 0;
    if (!read_length(property, corner_count)) return false;
    for (std::int64_t c = 0; c < corner_count; ++c) {
      std::int64_t vertex = 0;
      if (!source_.integer(property.type, vertex)) return false;
      if (vertex < 0 || static_cast<std::uint64_t>(vertex) >= vertex_count())
        return fail("corner " + std::to_string(c) + " refers to vertex " + std::to_string(vertex) +
                    ", but the file has " + counted(vertex_count(), "vertex", "vertices") + "; export the file again");
      if (!faces_.add_corner(static_cast<std::uint32_t>(vertex)))
        return fail("the mesh has more than 4,294,967,295 corners; split the mesh");
    }
    if (corner_count < 3) {
      faces_.drop_face();
      ++dropped_faces_;
      return true;
    }
    faces_.end_face();
    return true;
  }

  [[nodiscard]] static std::string row_name(const Element& element, std::uint64_t row) {
    const bool is_ours = element.name == "vertex" || element.name == "face";
    return (is_ours ? std::string(element.name) : scan::quoted(element.name)) + " " + std::to_string(row);
  }
  bool fail(std::string message) {
    message_ = std::move(message);
    return false;
  }

  const std::string& name_;
  const Header& header_;
  Source source_;
  std::string message_;  // message of an error that source_ did not report
  bool has_velocities_;
  Origin origin_;
  bool is_far_, has_more_digits_ = false;
  std::size_t dropped_faces_ = 0;
  std::vector<float> positions_, velocities_;
  PolygonBuilder faces_;
};

Result<MeshFrame> read_body(std::string_view bytes, const std::string& name, const Header& header, bool has_velocities,
                            const Origin& origin) {
  if (header.encoding == PlyEncoding::kAscii) {
    if (Status text = scan::check_text(bytes, name); !text) return text.error();
    return BodyReader<AsciiSource>(bytes, name, header, has_velocities, origin).read();
  }
  return BodyReader<BinarySource>(bytes, name, header, has_velocities, origin).read();
}

// Appends the numbers of a file one after the other, in one of the encodings.
class RowWriter {
 public:
  RowWriter(std::string& bytes, PlyEncoding encoding)
      : bytes_(bytes),
        is_ascii_(encoding == PlyEncoding::kAscii),
        swap_((encoding == PlyEncoding::kBinaryBigEndian) != (std::endian::native == std::endian::big)) {}

  template <class T>
  void add(T value) {
    if (is_ascii_) {
      scan::append_number(bytes_, value);
      bytes_ += ' ';
      return;
    }
    auto raw = bit_cast<std::array<char, sizeof(T)>>(value);
    if (swap_) std::reverse(raw.begin(), raw.end());
    bytes_.append(raw.data(), raw.size());
  }
  void add(const Vec3f& vector) {
    for (const float component : {vector.x, vector.y, vector.z}) add(component);
  }
  void end_row() {
    if (is_ascii_) bytes_.back() = '\n';
  }

 private:
  std::string& bytes_;
  bool is_ascii_, swap_;
};

}  // namespace

Result<MeshFrame> read_ply(std::string_view bytes, const std::string& name, const Origin& origin) {
  const Result<Header> header = ply::read_header(bytes, name);
  if (!header) return header.error();
  return read_body(bytes, name, header.value(), false, origin);
}

Result<MeshFrame> read_moving_ply(std::string_view bytes, const std::string& name, const Origin& origin) {
  Result<Header> header = ply::read_header(bytes, name);
  if (!header) return header.error();
  const Result<bool> has_velocities = ply::assign_velocities(header.value(), name);
  if (!has_velocities) return has_velocities.error();
  return read_body(bytes, name, header.value(), has_velocities.value(), origin);
}

std::string write_ply(const Topology& topology, VectorView<const float> positions, PlyEncoding encoding,
                      const Origin& origin) {
  return write_ply(topology, positions, PlyProperties{}, encoding, origin);
}

std::string write_ply(const Topology& topology, VectorView<const float> positions, const PlyProperties& properties,
                      PlyEncoding encoding, const Origin& origin) {
  const bool is_far = origin != Origin{};
  const std::string coordinate_type = is_far ? "double" : "float";
  const bool has_vertex_normals = properties.of_vertices.count > 0, has_face_normals = properties.of_faces.count > 0;
  assert(positions.count == topology.vertex_count());
  assert(!has_vertex_normals || properties.of_vertices.count == topology.vertex_count());
  assert(!has_face_normals || properties.of_faces.count == topology.face_count());
  const bool has_vertex_quality = !properties.quality_of_vertices.empty(),
             has_face_quality = !properties.quality_of_faces.empty();
  assert(!has_vertex_quality || properties.quality_of_vertices.size() == topology.vertex_count());
  assert(!has_face_quality || properties.quality_of_faces.size() == topology.face_count());
  std::size_t most_corners = 0;
  for (std::size_t f = 0; f < topology.face_count(); ++f)
    most_corners = std::max(most_corners, topology.face(f).size());
  // The number of corners of each face is stored as uchar, the usual type, if no face has more than 255 corners.
  const bool is_short = most_corners <= 255;
  const char* const index_type = positions.count <= 0x80000000U ? "int" : "uint";
  const char* const encoding_name = encoding == PlyEncoding::kAscii                ? "ascii"
                                    : encoding == PlyEncoding::kBinaryLittleEndian ? "binary_little_endian"
                                                                                   : "binary_big_endian";
  const char* const normal_properties = "\nproperty float nx\nproperty float ny\nproperty float nz";
  const char* const quality_property = "\nproperty float quality";

  std::string bytes =
      std::string("ply\nformat ") + encoding_name + " 1.0\nelement vertex " + std::to_string(positions.count) +
      "\nproperty " + coordinate_type + " x\nproperty " + coordinate_type + " y\nproperty " + coordinate_type + " z" +
      (has_vertex_normals ? normal_properties : "") + (has_vertex_quality ? quality_property : "") + "\nelement face " +
      std::to_string(topology.face_count()) + "\nproperty list " + (is_short ? "uchar " : "uint ") + index_type +
      " vertex_indices" + (has_face_normals ? normal_properties : "") + (has_face_quality ? quality_property : "") +
      "\nend_header\n";
  if (encoding != PlyEncoding::kAscii)
    bytes.reserve(bytes.size() + 12 * (positions.count + properties.of_vertices.count + properties.of_faces.count) +
                  4 * (topology.corner_count() + topology.face_count()));

  RowWriter row(bytes, encoding);
  for (std::size_t v = 0; v < positions.count; ++v) {
    if (is_far) {
      const Vec3f position = positions[v];
      row.add(double{position.x} + origin[0]);
      row.add(double{position.y} + origin[1]);
      row.add(double{position.z} + origin[2]);
    } else {
      row.add(positions[v]);
    }
    if (has_vertex_normals) row.add(properties.of_vertices[v]);
    if (has_vertex_quality) row.add(properties.quality_of_vertices[v]);
    row.end_row();
  }
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    if (is_short && encoding != PlyEncoding::kAscii) {
      row.add(static_cast<std::uint8_t>(face.size()));
    } else {
      row.add(static_cast<std::uint32_t>(face.size()));
    }
    for (const std::uint32_t vertex : face) row.add(vertex);
    if (has_face_normals) row.add(properties.of_faces[f]);
    if (has_face_quality) row.add(properties.quality_of_faces[f]);
    row.end_row();
  }
  return bytes;
}

}  // namespace chronormal::inline internal
