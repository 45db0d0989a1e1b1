// Compares the text of the faces of an OBJ file with that of the first file of a sequence. If both are equal, parses
// only the positions before the faces.
#include "io/mesh/obj_faces.h"

#include <algorithm>
#include <array>

#include "io/bytes/scan.h"

namespace chronormal::inline internal {
namespace {

// The part of an OBJ file before its first face.
struct Head {
  std::vector<float> positions;
  std::size_t end = 0;  // offset of the line of the first face
};

std::optional<Head> read_head(std::string_view bytes, std::size_t expected) {
  if (!scan::check_text(bytes, "") || bytes.find('\n') == std::string_view::npos || bytes.starts_with("\xEF\xBB\xBF"))
    return std::nullopt;
  Head head;
  head.positions.reserve(expected);
  for (scan::Lines lines(bytes, '\n'); lines.next(); head.end = lines.position()) {
    std::string_view line = lines.line();
    while (line.ends_with('\r')) line.remove_suffix(1);
    if (line.ends_with('\\')) return std::nullopt;
    const std::string_view keyword = scan::take_word(line);
    if (keyword == "f") return head;
    if (keyword != "v") continue;
    std::array<float, 3> position{};
    for (float& coordinate : position)
      if (!scan::take_plain_float(line, coordinate)) return std::nullopt;
    if (!std::all_of(line.begin(), line.end(), scan::is_blank)) return std::nullopt;
    head.positions.insert(head.positions.end(), position.begin(), position.end());
  }
  return std::nullopt;
}

}  // namespace

ObjFaces::ObjFaces(std::string_view bytes, const std::vector<float>& positions) {
  const std::optional<Head> head = read_head(bytes, 0);
  if (!head || head->positions.size() > positions.size()) return;
  text_ = bytes.substr(head->end);
  before_ = head->positions.size();
  further_.assign(positions.begin() + static_cast<std::ptrdiff_t>(before_), positions.end());
}

std::optional<std::vector<float>> ObjFaces::positions_of(std::string_view bytes) const {
  if (text_.empty() || !bytes.ends_with(text_)) return std::nullopt;
  std::optional<Head> head = read_head(bytes, before_ + further_.size());
  if (!head || head->positions.size() != before_ || head->end != bytes.size() - text_.size()) return std::nullopt;
  head->positions.insert(head->positions.end(), further_.begin(), further_.end());
  return std::move(head->positions);
}

}  // namespace chronormal::inline internal
