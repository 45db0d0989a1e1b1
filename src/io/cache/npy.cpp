#include "io/cache/npy.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <system_error>
#include <utility>

#include "core/charconv.h"
#include "core/text.h"
#include "io/bytes/binary.h"
#include "io/bytes/scan.h"

namespace chronormal::inline internal::npy {
namespace {

// A reader of the few forms of Python syntax that occur in the header of a NumPy file.
class Python {
 public:
  explicit Python(std::string_view text) noexcept : text_(text) {}

  // Removes the character `c` if this is the next character after blanks. Returns false if another character comes
  // next.
  bool sign(char c) {
    while (!text_.empty() && (scan::is_blank(text_.front()) || text_.front() == '\n')) text_.remove_prefix(1);
    if (!text_.starts_with(c)) return false;
    text_.remove_prefix(1);
    return true;
  }
  [[nodiscard]] std::optional<std::string_view> string() {
    for (const char quote : {'\'', '"'}) {
      if (!sign(quote)) continue;
      const std::size_t end = text_.find(quote);
      if (end == std::string_view::npos) return std::nullopt;
      const std::string_view content = text_.substr(0, end);
      text_.remove_prefix(end + 1);
      return content.find('\\') == std::string_view::npos ? std::optional(content) : std::nullopt;
    }
    return std::nullopt;
  }
  [[nodiscard]] std::optional<bool> boolean() {
    (void)sign('\0');  // skips blanks
    for (const auto& [word, value] : {std::pair<std::string_view, bool>{"True", true}, {"False", false}}) {
      if (!text_.starts_with(word)) continue;
      text_.remove_prefix(word.size());
      return value;
    }
    return std::nullopt;
  }
  // Reads a tuple such as (), (2,) or (2, 3). Accepts the L that Python 2 writes after long numbers.
  [[nodiscard]] std::optional<std::vector<std::uint64_t>> tuple() {
    std::vector<std::uint64_t> numbers;
    if (!sign('(')) return std::nullopt;
    while (!sign(')')) {
      std::uint64_t number = 0;
      const auto [end, code] = from_chars(text_.data(), text_.data() + text_.size(), number);
      if (code != std::errc{} || numbers.size() == kMostDimensions) return std::nullopt;
      text_.remove_prefix(static_cast<std::size_t>(end - text_.data()));
      numbers.push_back(number);
      (void)sign('L');
      if (!sign(',')) {
        if (!sign(')')) return std::nullopt;
        break;
      }
    }
    return numbers;
  }
  [[nodiscard]] bool at_end() {
    (void)sign('\0');
    return text_.empty();
  }

 private:
  static constexpr std::size_t kMostDimensions = 32;  // the limit of NumPy

  std::string_view text_;
};

// Reads the type of an array, such as "<f4" or, if allow_text is true, "<U7". Returns false for a type that is not
// supported.
bool read_type(std::string_view type, bool allow_text, Array& array) {
  if (allow_text && type.size() > 2 && (type[1] == 'U' || type[1] == 'S')) {
    std::uint32_t length = 0;
    const auto [end, code] = from_chars(type.data() + 2, type.data() + type.size(), length);
    array.order = type[0] == '>' ? std::endian::big : std::endian::little;
    array.kind = static_cast<Kind>(type[1]);
    array.item_size = std::size_t{length} * (array.kind == Kind::kText ? 4 : 1);
    return code == std::errc{} && end == type.data() + type.size() && length > 0;
  }
  if (type.size() != 3 || std::string_view("<>|=").find(type[0]) == std::string_view::npos) return false;
  if (type[0] != '=') array.order = type[0] == '>' ? std::endian::big : std::endian::little;
  if (type[0] == '=') array.order = std::endian::native;
  array.kind = static_cast<Kind>(type[1]);
  array.item_size = static_cast<std::size_t>(type[2] - '0');
  if (array.kind == Kind::kFloat) return array.item_size == 4 || array.item_size == 8;
  if (array.kind != Kind::kInteger && array.kind != Kind::kUnsigned) return false;
  return array.item_size == 1 || array.item_size == 2 || array.item_size == 4 || array.item_size == 8;
}

// Reads the header of an array of numbers. If allow_text is true, the array may also consist of text.
Result<Array> read_any_header(std::string_view start, std::uint64_t total_size, bool allow_text, bool more_may_follow,
                              const std::string& place) {
  const auto error = [&](std::string message) { return invalid_input(place, std::move(message)); };
  if (!start.starts_with(kFirstWord))
    return error(
        "this is not a NumPy array, since it does not begin with \\x93NUMPY; save it with numpy.save or numpy.savez");
  if (start.size() < 12) return error("the array is cut off inside its header; copy or save the file again");
  const auto version = static_cast<unsigned char>(start[6]);
  if (version < 1 || version > 3 || start[7] != '\0')
    return error("version " + std::to_string(version) + "." + std::to_string(static_cast<unsigned char>(start[7])) +
                 " of the array header cannot be read, only 1.0, 2.0 and 3.0; save the array again with numpy.save or "
                 "numpy.savez");
  const std::size_t text_begin = version == 1 ? 10 : 12;
  const std::size_t text_size = version == 1 ? binary::load<std::uint16_t>(start.data() + 8, std::endian::little)
                                             : binary::load<std::uint32_t>(start.data() + 8, std::endian::little);
  if (text_size > kLongestHeader)
    return error("the array header is longer than 65,536 bytes; save the array again with numpy.save or numpy.savez");
  if (text_size > start.size() - text_begin)
    return error("the array is cut off inside its header; copy or save the file again");

  Array array;
  array.data_begin = text_begin + text_size;
  bool has_type = false, has_order = false, has_shape = false;
  Python header(start.substr(text_begin, text_size));
  const auto broken = [&] {
    return error("the array header is not as NumPy writes it; save the array with numpy.save or numpy.savez");
  };
  if (!header.sign('{')) return broken();
  while (!header.sign('}')) {
    const std::optional<std::string_view> key = header.string();
    if (!key || !header.sign(':')) return broken();
    if (*key == "descr" && !has_type) {
      const std::optional<std::string_view> type = header.string();
      if (!type) return error("the array has records instead of numbers; save it as float32, float64 or integers");
      if (!read_type(*type, allow_text, array))
        return error(
            "elements of the type " + scan::quoted(*type) +
            " cannot be read; save it as float32 or float64, or if it holds faces, as integers of up to 64 bits");
      has_type = true;
    } else if (*key == "fortran_order" && !has_order) {
      const std::optional<bool> is_fortran = header.boolean();
      if (!is_fortran) return broken();
      array.is_fortran = *is_fortran;
      has_order = true;
    } else if (*key == "shape" && !has_shape) {
      std::optional<std::vector<std::uint64_t>> shape = header.tuple();
      if (!shape) return broken();
      array.shape = *std::move(shape);
      has_shape = true;
    } else {
      return broken();
    }
    if (!header.sign(',')) {
      if (!header.sign('}')) return broken();
      break;
    }
  }
  if (!header.at_end() || !has_type || !has_order || !has_shape) return broken();

  const std::uint64_t left = total_size - array.data_begin;
  std::uint64_t size = array.item_size;
  bool fits = true;
  if (std::find(array.shape.begin(), array.shape.end(), 0U) != array.shape.end()) size = 0;
  for (const std::uint64_t length : array.shape) {
    fits = fits && binary::fits(length, size, left);
    if (fits) size *= length;
  }
  if (!fits || (size != left && !more_may_follow))
    return error("the array should be " + array.text() + ", but has " + counted(left, "byte", "bytes") +
                 "; copy or save the file again");
  return array;
}

}  // namespace

double Array::real(std::size_t item) const noexcept {
  const char* const at = data.data() + item * item_size;
  return item_size == 4 ? double{binary::load<float>(at, order)} : binary::load<double>(at, order);
}

std::int64_t Array::integer(std::size_t item) const noexcept {
  const char* const at = data.data() + item * item_size;
  switch (item_size) {
    case 1:
      return binary::load<std::int8_t>(at, order);
    case 2:
      return binary::load<std::int16_t>(at, order);
    case 4:
      return binary::load<std::int32_t>(at, order);
    default:
      return binary::load<std::int64_t>(at, order);
  }
}

std::uint64_t Array::vertex(std::size_t item) const noexcept {
  if (kind == Kind::kInteger) {
    const std::int64_t value = integer(item);
    return value < 0 ? std::numeric_limits<std::uint64_t>::max() : static_cast<std::uint64_t>(value);
  }
  const char* const at = data.data() + item * item_size;
  switch (item_size) {
    case 1:
      return binary::load<std::uint8_t>(at, order);
    case 2:
      return binary::load<std::uint16_t>(at, order);
    case 4:
      return binary::load<std::uint32_t>(at, order);
    default:
      return binary::load<std::uint64_t>(at, order);
  }
}

std::string Array::text() const {
  std::string result = "(";
  for (std::size_t d = 0; d < shape.size(); ++d) result += (d == 0 ? "" : ", ") + std::to_string(shape[d]);
  result += shape.size() == 1 ? ",) of '" : ") of '";
  if (item_size > 1) result += order == std::endian::big ? '>' : '<';
  result += static_cast<char>(kind);
  return result + std::to_string(item_size) + "'";
}

Result<Array> read_header(std::string_view start, std::uint64_t total_size, const std::string& place,
                          bool more_may_follow) {
  return read_any_header(start, total_size, false, more_may_follow, place);
}

Result<std::string> read_text(std::string_view bytes, const std::string& place) {
  const Result<Array> array = read_any_header(bytes, bytes.size(), true, false, place);
  if (!array) return array.error();
  const Array& found = array.value();
  const std::size_t step = found.kind == Kind::kText ? 4 : 1;
  if ((found.kind != Kind::kText && found.kind != Kind::kBytes) || found.element_count() != 1)
    return invalid_input(place, "the array must be a single text, but is " + found.text() + "; save it as a string");
  std::string text;
  for (std::size_t at = found.data_begin; at < bytes.size(); at += step) {
    const std::uint32_t c =
        step == 4 ? binary::load<std::uint32_t>(bytes.data() + at, found.order) : static_cast<unsigned char>(bytes[at]);
    if (c > 127) return invalid_input(place, "the text must be ASCII; save it again without other characters");
    text += static_cast<char>(c);
  }
  // NumPy pads a short string with zero bytes at its end.
  while (text.ends_with('\0')) text.pop_back();
  return text;
}

std::string write_text(std::string_view text) {
  std::string bytes = write_header("<U" + std::to_string(text.size()), {});
  for (const char c : text) binary::append(bytes, static_cast<std::uint32_t>(c), std::endian::little);
  return bytes;
}

std::string write_header(std::string_view type, const std::vector<std::uint64_t>& shape) {
  std::string text = "{'descr': '" + std::string(type) + "', 'fortran_order': False, 'shape': (";
  for (const std::uint64_t length : shape) text += std::to_string(length) + ", ";
  if (!shape.empty()) text.pop_back();
  // A tuple of one number keeps its comma, as in (5,).
  if (shape.size() > 1) text.pop_back();
  text += "), }";
  while ((10 + text.size() + 1) % 64 != 0) text += ' ';
  text += '\n';

  std::string header(kFirstWord);
  header.append("\1\0", 2);
  binary::append(header, static_cast<std::uint16_t>(text.size()), std::endian::little);
  return header + text;
}

}  // namespace chronormal::inline internal::npy
