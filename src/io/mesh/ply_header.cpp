#include "io/mesh/ply_header.h"

#include <algorithm>
#include <array>
#include <optional>
#include <set>
#include <system_error>
#include <utility>

#include "core/charconv.h"
#include "io/bytes/scan.h"

namespace chronormal::inline internal::ply {
namespace {

constexpr std::size_t kNone = static_cast<std::size_t>(-1);

std::optional<Scalar> find_scalar(std::string_view word) {
  constexpr std::array<std::pair<std::string_view, Scalar>, 16> kNames = {{{"char", Scalar::kInt8},
                                                                           {"int8", Scalar::kInt8},
                                                                           {"uchar", Scalar::kUint8},
                                                                           {"uint8", Scalar::kUint8},
                                                                           {"short", Scalar::kInt16},
                                                                           {"int16", Scalar::kInt16},
                                                                           {"ushort", Scalar::kUint16},
                                                                           {"uint16", Scalar::kUint16},
                                                                           {"int", Scalar::kInt32},
                                                                           {"int32", Scalar::kInt32},
                                                                           {"uint", Scalar::kUint32},
                                                                           {"uint32", Scalar::kUint32},
                                                                           {"float", Scalar::kFloat32},
                                                                           {"float32", Scalar::kFloat32},
                                                                           {"double", Scalar::kFloat64},
                                                                           {"float64", Scalar::kFloat64}}};
  for (const auto& [name, type] : kNames) {
    if (name == word) return type;
  }
  return std::nullopt;
}

// Returns the character that ends lines. This character is CR if the first word is followed by a CR without LF, as in
// files of old Macintosh systems, and LF in all other files.
char find_separator(std::string_view bytes) {
  return bytes.size() > 4 && bytes[3] == '\r' && bytes[4] != '\n' ? '\r' : '\n';
}

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& name) : name_(name), lines_(bytes, find_separator(bytes)) {
    header_.separator = find_separator(bytes);
  }

  Result<Header> read();

 private:
  using Words = std::vector<std::string_view>;

  [[nodiscard]] Status read_statement(const Words& words);
  [[nodiscard]] Status read_format(const Words& words);
  [[nodiscard]] Status read_element(const Words& words);
  [[nodiscard]] Status read_property(const Words& words);
  [[nodiscard]] Status assign_role(Property& property);
  [[nodiscard]] Status check_elements();

  [[nodiscard]] Error error(std::string message) const {
    return invalid_input(name_ + ", line " + std::to_string(std::max<std::size_t>(lines_.number(), 1)),
                         std::move(message));
  }

  const std::string& name_;
  scan::Lines lines_;
  Header header_;
  bool has_format_ = false;
  std::set<std::string_view> element_names_;
  std::set<std::string_view> property_names_;  // names of the properties in the current element
};

Result<Header> HeaderReader::read() {
  Words words;
  const auto next_words = [&] {
    if (!lines_.next()) return false;
    words.clear();
    std::string_view rest = lines_.line();
    for (std::string_view word = scan::take_word(rest); !word.empty(); word = scan::take_word(rest))
      words.push_back(word);
    return true;
  };

  if (!next_words() || words.size() != 1 || words[0] != "ply")
    return error("this is not a PLY file, since its first line is not the word ply; export the file again");
  while (next_words()) {
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") {
      if (words.size() != 1) return error("the line end_header must have no other words; remove them");
      if (!has_format_) return error("the header has no line that begins with 'format'; export the file again");
      header_.body_begin = lines_.position();
      header_.line_count = lines_.number();
      if (Status status = check_elements(); !status) return status.error();
      return std::move(header_);
    }
    if (Status status = read_statement(words); !status) return status.error();
  }
  return error("the header does not end, since the line end_header is missing; export the file again");
}

Status HeaderReader::read_statement(const Words& words) {
  if (words[0] == "format") return read_format(words);
  if (!has_format_) return error("a line that begins with 'format' must come before " + scan::quoted(words[0]));
  if (words[0] == "element") return read_element(words);
  if (words[0] == "property") return read_property(words);
  return error(scan::quoted(words[0]) + " is not a keyword of a PLY header; export the file again");
}

Status HeaderReader::read_format(const Words& words) {
  if (has_format_) return error("the header has two lines that begin with format; remove one of them");
  if (words.size() != 3) return error("this line must have the form: format ENCODING 1.0");
  if (words[1] == "ascii") {
    header_.encoding = PlyEncoding::kAscii;
  } else if (words[1] == "binary_little_endian") {
    header_.encoding = PlyEncoding::kBinaryLittleEndian;
  } else if (words[1] == "binary_big_endian") {
    header_.encoding = PlyEncoding::kBinaryBigEndian;
  } else {
    return error("the encoding " + scan::quoted(words[1]) +
                 " cannot be read; it must be ascii, binary_little_endian or binary_big_endian");
  }
  if (words[2] != "1.0")
    return error("version " + scan::quoted(words[2]) + " of PLY cannot be read; export the file as version 1.0");
  has_format_ = true;
  return Success{};
}

Status HeaderReader::read_element(const Words& words) {
  if (words.size() != 3) return error("this line must have the form: element NAME COUNT");
  Element element;
  element.name = words[1];
  const char* const last = words[2].data() + words[2].size();
  const auto [end, code] = from_chars(words[2].data(), last, element.count);
  if (code != std::errc{} || end != last)
    return error(scan::quoted(words[2]) + " is not a valid number of " + scan::quoted(words[1]) +
                 " elements; correct it, or export the file again");
  if (!element_names_.insert(element.name).second)
    return error("the element " + scan::quoted(element.name) + " is declared twice; remove one of the two lines");
  property_names_.clear();
  header_.elements.push_back(std::move(element));
  return Success{};
}

Status HeaderReader::read_property(const Words& words) {
  if (header_.elements.empty())
    return error("a line that begins with property must come after a line that begins with element");
  const bool is_list = words.size() > 1 && words[1] == "list";
  if (words.size() != (is_list ? 5 : 3))
    return error("this line must have the form: property TYPE NAME, or property list COUNT_TYPE TYPE NAME");

  Property property;
  property.is_list = is_list;
  property.name = words.back();
  const std::string_view type_word = words[words.size() - 2];
  const std::optional<Scalar> type = find_scalar(type_word);
  if (!type) return error("the type " + scan::quoted(type_word) + " is not a type of PLY; export the file again");
  property.type = *type;
  if (is_list) {
    const std::optional<Scalar> count_type = find_scalar(words[2]);
    if (!count_type)
      return error("the type " + scan::quoted(words[2]) + " is not a type of PLY; export the file again");
    if (!is_integer(*count_type))
      return error("the length of a list must be an integer, but its type is " + scan::quoted(words[2]) +
                   "; export the file again");
    property.count_type = *count_type;
  }
  if (!property_names_.insert(property.name).second)
    return error("the property " + scan::quoted(property.name) + " is declared twice; remove one of the two lines");
  if (Status status = assign_role(property); !status) return status;
  header_.elements.back().properties.push_back(property);
  return Success{};
}

Status HeaderReader::assign_role(Property& property) {
  const Element& element = header_.elements.back();
  if (element.name == "vertex" && property.name.size() == 1 && property.name[0] >= 'x' && property.name[0] <= 'z') {
    if (property.is_list)
      return error("the coordinate " + scan::quoted(property.name) +
                   " is a list, but must be a number; export the file again");
    property.role = static_cast<Role>(property.name[0] - 'x');
  }
  if (element.name == "face" && (property.name == "vertex_indices" || property.name == "vertex_index")) {
    if (!property.is_list || !is_integer(property.type))
      return error("the property " + scan::quoted(property.name) +
                   " must be a list of integers; export the file again");
    for (const Property& other : element.properties) {
      if (other.role == Role::kIndices)
        return error("the faces have both vertex_indices and vertex_index; remove one of the two properties");
    }
    property.role = Role::kIndices;
  }
  return Success{};
}

// Checks that the file has the elements and properties that a mesh needs.
Status HeaderReader::check_elements() {
  header_.vertex_element = header_.face_element = kNone;
  bool has_strips = false;
  for (std::size_t e = 0; e < header_.elements.size(); ++e) {
    if (header_.elements[e].name == "vertex") header_.vertex_element = e;
    if (header_.elements[e].name == "face") header_.face_element = e;
    has_strips = has_strips || header_.elements[e].name == "tristrips";
  }
  const auto has_role = [&](std::size_t e, Role role) {
    const std::vector<Property>& properties = header_.elements[e].properties;
    return std::any_of(properties.begin(), properties.end(), [&](const Property& p) { return p.role == role; });
  };

  if (header_.vertex_element == kNone || header_.elements[header_.vertex_element].count == 0)
    return error("the file has no vertices; export a mesh");
  for (const Role role : {Role::kX, Role::kY, Role::kZ}) {
    if (!has_role(header_.vertex_element, role))
      return error(std::string("the vertices have no property ") + "xyz"[static_cast<std::size_t>(role)] +
                   "; export the file again");
  }
  if (header_.face_element == kNone || header_.elements[header_.face_element].count == 0) {
    if (has_strips) return error("the file has triangle strips, which cannot be read; export it with faces");
    return error("the file has no faces; export a mesh with faces");
  }
  if (!has_role(header_.face_element, Role::kIndices))
    return error("the faces have no property vertex_indices; export the file again");
  return Success{};
}

}  // namespace

Result<Header> read_header(std::string_view bytes, const std::string& name) {
  // The longest header in bytes. A limit is needed because a file that is not PLY may have no end of its header.
  constexpr std::size_t kLongest = std::size_t{16} << 20;
  return HeaderReader(bytes.substr(0, kLongest), name).read();
}

Result<bool> assign_velocities(Header& header, const std::string& name) {
  // The names of velocities. Programs for particles and simulations use vx, vy, vz; exporters of attributes append the
  // axis to "velocity".
  constexpr std::array<std::array<std::string_view, 3>, 2> kNames = {
      {{"vx", "vy", "vz"}, {"velocity_x", "velocity_y", "velocity_z"}}};
  std::vector<Property>& properties = header.elements[header.vertex_element].properties;
  for (const auto& names : kNames) {
    std::array<Property*, 3> found{};
    for (std::size_t c = 0; c < 3; ++c)
      for (Property& property : properties)
        if (property.name == names[c]) found[c] = &property;
    if (std::none_of(found.begin(), found.end(), [](const Property* property) { return property != nullptr; }))
      continue;
    for (std::size_t c = 0; c < 3; ++c) {
      if (found[c] == nullptr)
        return invalid_input(name + ", header",
                             "the velocity of the vertices is incomplete, since they have no property " +
                                 std::string(names[c]) + "; add it, or leave all velocities out");
      if (found[c]->is_list)
        return invalid_input(name + ", header", "the velocity " + std::string(names[c]) +
                                                    " is a list, but must be a number; export the file again");
      found[c]->role = static_cast<Role>(static_cast<std::size_t>(Role::kVelocityX) + c);
    }
    return true;
  }
  return false;
}

}  // namespace chronormal::inline internal::ply
