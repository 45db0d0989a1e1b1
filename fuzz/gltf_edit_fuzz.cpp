// Fuzz target of edits of glTF files. An input has lines of changes, an empty line, and a document, which is JSON or
// GLB:
//
//     set /meshes/0/weights [0, 1]
//     append /extras/list null
//
// A document that is not a glTF file becomes the extras of a small glTF file. An edit must either be refused, or give
// JSON that differs from the source only in the values at the edited pointers. The last change must be in the result.
#include "chronormal/io/gltf_document.h"

#include <algorithm>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cache_invariants.h"
#include "json_tokens.h"
#include "mesh_invariants.h"

namespace {

using chronormal::fuzz::JsonTokens;
using chronormal::fuzz::require;

struct Change {
  bool append = false;
  std::string pointer, value;
};

std::string_view take_line(std::string_view& text) {
  const std::string_view line = text.substr(0, text.find('\n'));
  text.remove_prefix(std::min(text.size(), line.size() + 1));
  return line;
}

// Returns the JSON of a file. For a GLB, this is the first chunk without the padding at its end, since an edit may
// change the padding.
std::string_view json_of(std::string_view file) {
  if (!file.starts_with("glTF")) return file;
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < 4; ++i) size |= std::uint32_t{static_cast<unsigned char>(file[12 + i])} << (8 * i);
  file = file.substr(20, size);
  return file.substr(0, file.find_last_not_of(" \t\r\n") + 1);
}

void check(const std::string& source, const std::vector<Change>& changes, const std::string& prefix) {
  const auto document = chronormal::GltfDocument::read(source, "fuzz.gltf");
  // The reader ends the JSON at a zero byte and ignores the rest, so documents with a zero byte are skipped.
  if (!document || json_of(source).find('\0') != std::string_view::npos) return;
  // Removes impossible changes from the list and makes the other changes one after the other.
  std::vector<Change> possible;
  std::string result;
  for (const Change& change : changes) {
    possible.push_back(change);
    chronormal::GltfEdit edit(document.value());
    for (const auto& [append, pointer, value] : possible)
      append ? edit.append(prefix + pointer, value) : edit.set(prefix + pointer, value);
    const auto bytes = edit.bytes("");
    if (!bytes) {
      chronormal::fuzz::check_error(bytes.error());
      possible.pop_back();
      continue;
    }
    const JsonTokens before(json_of(source)), after(json_of(bytes.value()));
    const std::string difference = difference_beside(before, after, edit.pointers().value());
    require(difference.empty(), difference.c_str());
    if (!change.append) {
      const std::string text = " " + change.value + " ";
      const JsonTokens put(text);
      require(after.value(prefix + change.pointer) == put.value(""), "the value is where it was set");
    }
    require(prefix.empty() || chronormal::GltfDocument::read(bytes.value(), "x").ok(), "the result can be read");
  }
  chronormal::GltfEdit edit(document.value());
  (void)edit.add_vectors(std::vector<float>{1, 2, 3}, {true, false});
  const auto bytes = edit.bytes("");
  if (!bytes) return chronormal::fuzz::check_error(bytes.error());
  const std::string difference =
      difference_beside(JsonTokens(json_of(source)), JsonTokens(json_of(bytes.value())), edit.pointers().value());
  require(difference.empty(), difference.c_str());
  require(chronormal::GltfDocument::read(bytes.value(), "x").ok(), "a file with a new array can be read");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  std::string_view text(reinterpret_cast<const char*>(data), size);
  std::vector<Change> changes;
  for (std::string_view line = take_line(text); !line.empty() && changes.size() < 8; line = take_line(text)) {
    Change change;
    change.append = line.starts_with('a');
    line.remove_prefix(std::min(line.size(), line.find(' ') + 1));
    const std::size_t end = std::min(line.find(' '), line.size());
    change.pointer = line.substr(0, end);
    change.value = line.substr(std::min(end + 1, line.size()));
    changes.push_back(std::move(change));
  }
  check(std::string(text), changes, "");
  std::string wrapped = R"({"asset":{"version":"2.0"},"extras":)";
  check(wrapped.append(text).append("}"), changes, "/extras");
  return 0;
}
