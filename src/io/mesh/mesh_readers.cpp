#include "io/mesh/mesh_readers.h"

#include <algorithm>
#include <array>

#include "io/bytes/extension.h"
#include "io/bytes/scan.h"
#include "io/mesh/obj.h"
#include "io/mesh/ply.h"

namespace chronormal {
namespace {

constexpr std::array<std::string_view, 1> kPlyExtensions = {".ply"};
constexpr std::array<std::string_view, 1> kObjExtensions = {".obj"};

bool is_ply(std::string_view first_bytes) {
  return first_bytes.starts_with("ply\n") || first_bytes.starts_with("ply\r");
}

// The first line that is neither empty nor a comment begins with a common word of OBJ.
bool is_obj(std::string_view first_bytes) {
  constexpr std::array<std::string_view, 12> kKeywords = {"v",      "vn", "vt", "f", "o",      "g",
                                                          "mtllib", "s",  "l",  "p", "usemtl", "vp"};
  if (first_bytes.starts_with("\xEF\xBB\xBF")) first_bytes.remove_prefix(3);
  scan::Lines lines(first_bytes, first_bytes.find('\n') == std::string_view::npos ? '\r' : '\n');
  bool has_comment = false;
  while (lines.next()) {
    std::string_view line = lines.line();
    const std::string_view keyword = scan::take_word(line);
    if (keyword.starts_with('#')) has_comment = true;
    if (keyword.empty() || keyword.starts_with('#')) continue;
    return std::find(kKeywords.begin(), kKeywords.end(), keyword) != kKeywords.end();
  }
  return has_comment;  // nothing but comments so far
}

constexpr std::array<MeshReader, 2> kReaders = {{
    {"ply", kPlyExtensions, is_ply, read_ply},
    {"obj", kObjExtensions, is_obj, read_obj},
}};

std::string readable_formats() {
  std::string text;
  for (const MeshReader& reader : kReaders) {
    if (!text.empty()) text += ", ";
    text += reader.name;
    for (const std::string_view extension : reader.extensions) text.append(" (").append(extension).append(")");
  }
  return text;
}

}  // namespace

std::span<const MeshReader> mesh_readers() noexcept { return kReaders; }

const MeshReader* find_mesh_reader(std::string_view file_name) noexcept {
  const std::string extension = lower_extension(file_name);
  for (const MeshReader& reader : kReaders) {
    if (std::find(reader.extensions.begin(), reader.extensions.end(), extension) != reader.extensions.end())
      return &reader;
  }
  return nullptr;
}

Result<const MeshReader*> choose_mesh_reader(std::string_view bytes, const std::string& file_name) {
  if (const MeshReader* reader = find_mesh_reader(file_name)) return reader;
  for (const MeshReader& reader : kReaders) {
    if (reader.recognises(bytes.substr(0, 512))) return &reader;
  }
  return invalid_input(file_name,
                       "neither the name nor the content tells the format; what can be read is " + readable_formats());
}

Result<MeshFrame> read_mesh(std::string_view bytes, const std::string& name) {
  const Result<const MeshReader*> reader = choose_mesh_reader(bytes, name);
  if (!reader) return reader.error();
  return reader.value()->read(bytes, name);
}

}  // namespace chronormal
