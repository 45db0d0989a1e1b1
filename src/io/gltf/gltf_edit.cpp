#include "chronormal/io/gltf_document.h"

#include <filesystem>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/io/output.h"
#include "io/bytes/expansion.h"
#include "io/bytes/extension.h"
#include "io/gltf/edit/gltf_edit_layout.h"
#include "io/gltf/glb/new_arrays.h"
#include "io/gltf/gltf_document_state.h"
#include "io/json/json.h"
#include "io/json/json_text.h"
#include "io/json/json_writer.h"
#include "io/system/names.h"

namespace chronormal {

struct GltfEdit::State {
  struct Change {
    std::string pointer, json;
    bool append = false;
  };

  explicit State(GltfDocument::State& opened)
      : document(opened), is_glb(opened.chunks.json_offset > 0), source(opened.chunks.json) {}

  [[nodiscard]] Status apply(const Change& change, JsonText& json) const;
  [[nodiscard]] Result<gltf::EditLayout> lay_out(gltf::LayoutTarget target);
  /// Describes the file that is to be made at `path`, for the layout. An empty path means the file of the source
  /// itself.
  [[nodiscard]] Result<gltf::LayoutTarget> target_of(const std::string& path) const;

  GltfDocument::State& document;
  bool is_glb;
  JsonText source;
  std::vector<Change> changes;
  gltf::NewArrays arrays;
  bool without_unused = false;
};

namespace {

bool is_same_folder(const std::string& a, const std::string& b) {
  std::error_code error;
  return std::filesystem::equivalent(path_of(a.empty() ? "." : a), path_of(b.empty() ? "." : b), error);
}

// Returns the reason why a text cannot become a JSON value at this level of nesting, or an empty text if the text is
// such a value.
std::string value_fault(const std::string& json, std::size_t level) {
  constexpr const char* kNone = "the new value is not valid JSON: ";
  // The parser would take a zero byte for the end of the text, and would skip a byte order mark.
  if (json.find('\0') != std::string::npos) return std::string(kNone).append("it has a zero byte; remove this byte");
  if (json.starts_with(kByteOrderMark))
    return std::string(kNone).append("it begins with a byte order mark; remove this mark");
  const Result<nlohmann::json> parsed = parse_json(json, "", 0, {"", [](std::size_t, const nlohmann::json&) {}});
  if (!parsed) return std::string(kNone).append(parsed.error().message);
  if (level + json_depth(json) > kDeepestJson)
    return "the new value is nested deeper than " + std::to_string(kDeepestJson) + " levels; nest it less";
  return "";
}

}  // namespace

Status GltfEdit::State::apply(const Change& change, JsonText& json) const {
  const auto error = [&](std::string message) {
    return invalid_input(document.bytes.place(change.pointer), std::move(message));
  };
  const auto tokens = split_json_pointer(change.pointer);
  if (!tokens) return error("this is not a JSON pointer; write one like /meshes/0/extras");
  if (tokens->size() == 1) {
    const std::string& name = tokens->front();
    if (name == "accessors" || name == "bufferViews" || name == "buffers")
      return error(
          "accessors, bufferViews and buffers cannot be changed as JSON; add a new array with add_vectors() or "
          "add_scalars()");
  }
  std::string fault = value_fault(change.json, tokens->size() + (change.append ? 1 : 0));
  for (const std::string& token : *tokens) {
    if (fault.empty()) fault = value_fault(quote_json(token), 0);
  }
  if (!fault.empty()) return error(std::move(fault));
  const Status done = change.append ? json.append(change.pointer, change.json) : json.set(change.pointer, change.json);
  return done ? done : error(done.error().message);
}

Result<gltf::EditLayout> GltfEdit::State::lay_out(gltf::LayoutTarget target) {
  std::string_view text = document.chunks.json;
  // A GLB has no byte order mark before its JSON (section 4.4.3.2 of the specification).
  if (target.glb && !is_glb && text.starts_with(kByteOrderMark)) text.remove_prefix(kByteOrderMark.size());
  JsonText json(text);
  for (const Change& change : changes) {
    if (Status status = apply(change, json); !status) return status.error();
  }
  gltf::EditLayout layout({document.model, document.bytes, document.chunks, is_glb, source, arrays, without_unused},
                          std::move(target), std::move(json));
  if (Status status = layout.run(); !status) return status.error();
  return layout;
}

Result<gltf::LayoutTarget> GltfEdit::State::target_of(const std::string& path) const {
  gltf::LayoutTarget target{path, is_glb, false, true};
  if (path.empty()) return target;
  const std::optional<std::string>& folder = document.bytes.origin().folder;
  if (is_stream(path)) {
    target.stands_alone = true;
    return target;
  }
  const std::string extension = lower_extension(path);
  if (!is_glb_extension(extension) && extension != ".gltf")
    return Error{ErrorCode::kUsage, path, "the name of a glTF file must end with .glb, .gltf or .vrm"};
  target.glb = is_glb_extension(extension);
  target.stands_alone = !folder || (target.glb && !is_glb) || !is_same_folder(folder_of(path), *folder);
  return target;
}

GltfEdit::GltfEdit(const GltfDocument& source) : state_(std::make_unique<State>(*source.state_)) {}
GltfEdit::GltfEdit(GltfEdit&&) noexcept = default;
GltfEdit& GltfEdit::operator=(GltfEdit&&) noexcept = default;
GltfEdit::~GltfEdit() = default;

void GltfEdit::set(std::string pointer, std::string json) {
  state_->changes.push_back({std::move(pointer), std::move(json), false});
}

void GltfEdit::append(std::string pointer, std::string json) {
  state_->changes.push_back({std::move(pointer), std::move(json), true});
}

bool GltfEdit::has(const std::string& pointer) const { return state_->source.find(pointer).has_value(); }

std::string GltfEdit::text(const std::string& pointer) const {
  return std::string(state_->source.find(pointer).value_or(""));
}

std::size_t GltfEdit::add_vectors(std::span<const float> vectors, const GltfVectors& options) {
  return state_->document.model.accessors.size() + state_->arrays.add(vectors, 3, options);
}

std::size_t GltfEdit::add_scalars(std::span<const float> scalars, const GltfVectors& options) {
  return state_->document.model.accessors.size() + state_->arrays.add(scalars, 1, options);
}

void GltfEdit::leave_out_unused() { state_->without_unused = true; }

Result<std::vector<std::string>> GltfEdit::pointers(const std::string& path) const {
  Result<gltf::LayoutTarget> target = state_->target_of(path);
  if (!target) return target.error();
  target.value().with_bytes = false;
  const Result<gltf::EditLayout> layout = state_->lay_out(std::move(target).value());
  if (!layout) return layout.error();
  return layout.value().json().pointers();
}

std::vector<std::string> GltfEdit::warnings(const std::string& path) const {
  Result<gltf::LayoutTarget> target = state_->target_of(path);
  if (!target) return {};
  target.value().with_bytes = false;
  const Result<gltf::EditLayout> layout = state_->lay_out(std::move(target).value());
  return layout ? layout.value().warnings() : std::vector<std::string>();
}

std::size_t GltfEdit::added_bytes() const noexcept { return addressable(state_->arrays.byte_count()); }

Result<std::size_t> GltfEdit::unused_bytes(const std::string& path) const {
  Result<gltf::LayoutTarget> target = state_->target_of(path);
  if (!target) return target.error();
  target.value().with_bytes = false;
  const Result<gltf::EditLayout> layout = state_->lay_out(std::move(target).value());
  if (!layout) return layout.error();
  return layout.value().unused_bytes();
}

Result<std::string> GltfEdit::bytes(const std::string& path) const {
  Result<gltf::LayoutTarget> target = state_->target_of(path);
  if (!target) return target.error();
  const Result<gltf::EditLayout> layout = state_->lay_out(std::move(target).value());
  if (!layout) return layout.error();
  const Result<GlbPieces> file = layout.value().file();
  if (!file) return file.error();
  return join(file.value().pieces);
}

Status GltfEdit::write(const std::string& path, bool force) const {
  Result<gltf::LayoutTarget> target = state_->target_of(path);
  if (!target) return target.error();
  const Result<gltf::EditLayout> layout = state_->lay_out(std::move(target).value());
  if (!layout) return layout.error();
  const Result<GlbPieces> file = layout.value().file();
  if (!file) return file.error();
  return write_output(path, file.value().pieces, force);
}

}  // namespace chronormal
