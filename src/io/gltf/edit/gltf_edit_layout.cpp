#include "io/gltf/edit/gltf_edit_layout.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <utility>

#include "io/gltf/model/gltf_uri.h"
#include "io/json/json_writer.h"

namespace chronormal::inline internal::gltf {
namespace {

constexpr std::string_view kZeros{"\0\0\0\0\0\0\0", 7};
// The alignment of bytes that are moved into the BIN chunk. A multiple of 8 suits numbers of every size.
constexpr std::size_t kViewAlignment = 8;

std::string item_pointer(const char* array, std::size_t index) {
  return std::string("/").append(array).append("/").append(std::to_string(index));
}

// Returns the media type of an image by its first bytes, or nullptr if glTF does not allow this type.
const char* media_type_of(std::string_view bytes) {
  if (bytes.starts_with("\x89PNG\r\n\x1A\n")) return "image/png";
  if (bytes.starts_with("\xFF\xD8\xFF")) return "image/jpeg";
  if (bytes.starts_with("RIFF") && bytes.substr(std::min<std::size_t>(8, bytes.size())).starts_with("WEBP"))
    return "image/webp";
  if (bytes.starts_with("\xABKTX 20\xBB\r\n\x1A\n")) return "image/ktx2";
  return nullptr;
}

// Appends the bytes of all pieces, one behind the other, as base64.
void append_base64(std::string& text, const std::vector<std::string_view>& pieces) {
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::size_t size = 0;
  for (const std::string_view piece : pieces) size += piece.size();
  text.reserve(text.size() + (size + 2) / 3 * 4 + 1);
  std::uint32_t bits = 0;
  int bit_count = 0;
  for (const std::string_view piece : pieces) {
    for (const char c : piece) {
      bits = bits << 8 | static_cast<unsigned char>(c);
      for (bit_count += 8; bit_count >= 6; bit_count -= 6) text += kDigits[bits >> (bit_count - 6) & 63];
    }
  }
  if (bit_count > 0) text += kDigits[bits << (6 - bit_count) & 63];
  text.append((3 - size % 3) % 3, '=');
}

// Adds `members` to an object, except the members whose names are in `without`.
void add_other_members(const std::vector<JsonMember>& members, std::initializer_list<std::string_view> without,
                       JsonObject& object) {
  for (const JsonMember& member : members) {
    if (std::find(without.begin(), without.end(), member.name) == without.end()) object.add(member.name, member.value);
  }
}

const JsonMember* find_last(const std::vector<JsonMember>& members, std::string_view name) {
  const auto found = std::find_if(members.rbegin(), members.rend(), [&](const auto& m) { return m.name == name; });
  return found == members.rend() ? nullptr : &*found;
}

// Returns the value of a member that is a whole number, also if it is written as 4.0. Returns nothing if the member is
// missing or is not such a number. Such members occur only in extensions that the reader does not know, because the
// reader has checked all other members.
std::optional<std::size_t> to_count(const JsonMember* member) {
  constexpr double kMost = 9007199254740992;  // 2^53
  if (member == nullptr) return std::nullopt;
  const nlohmann::json number = nlohmann::json::parse(member->value, nullptr, false);
  if (number.is_number_unsigned()) return number.get<std::size_t>();
  if (!number.is_number_float() || !(number.get<double>() >= 0 && number.get<double>() <= kMost)) return std::nullopt;
  return static_cast<std::size_t>(number.get<double>());
}

}  // namespace

bool EditLayout::is_bin(std::size_t buffer) const {
  return buffer == 0 && document_.chunks.bin && !document_.model.buffers[0].uri;
}

bool EditLayout::refers_to_file(std::size_t buffer) const {
  const std::optional<std::string>& uri = document_.model.buffers[buffer].uri;
  return uri && !is_data_uri(*uri);
}

Result<std::string_view> EditLayout::declared_bytes(std::size_t buffer) {
  const Result<std::string_view> bytes = document_.bytes.buffer(buffer);
  if (!bytes) return bytes.error();
  return bytes.value().substr(0, document_.model.buffers[buffer].byte_length);
}

std::size_t EditLayout::add_to_bin(std::string_view bytes, std::size_t alignment) {
  if (!bin_) bin_.emplace();
  const std::size_t padding = (alignment - bin_size_ % alignment) % alignment;
  bin_->push_back(kZeros.substr(0, padding));
  bin_->push_back(bytes);
  bin_size_ += padding + bytes.size();
  return bin_size_ - bytes.size();
}

Status EditLayout::set(const std::string& pointer, std::string json) {
  if (Status status = json_.set(pointer, std::move(json)); !status)
    return invalid_input(document_.bytes.place(pointer), status.error().message);
  return Success{};
}

Status EditLayout::append(const std::string& pointer, std::string json) {
  if (Status status = json_.append(pointer, std::move(json)); !status)
    return invalid_input(document_.bytes.place(pointer), status.error().message);
  return Success{};
}

std::string EditLayout::data_uri(std::string_view media_type, const std::vector<std::string_view>& pieces) const {
  std::string text = "\"data:";
  text.append(media_type).append(";base64,");
  if (target_.with_bytes) append_base64(text, pieces);
  text += '"';
  return text;
}

Status EditLayout::run() { return target_.glb ? lay_out_glb() : lay_out_gltf(); }

Result<GlbPieces> EditLayout::file() const {
  const std::vector<std::string_view> json = json_.pieces();
  if (!target_.glb) return GlbPieces{{}, json};
  return chronormal::lay_out_glb(json, bin_, document_.chunks.rest, target_.name);
}

// Finds the images that are in files beside the source, so that they can be moved into the result.
Status EditLayout::find_images() {
  const Origin& origin = document_.bytes.origin();
  const std::size_t count = document_.source.members("/images").size();
  for (std::size_t i = 0; i < count; ++i) {
    const std::string pointer = item_pointer("images", i), place = document_.bytes.place(pointer + "/uri");
    const std::optional<std::string_view> text = document_.source.find(pointer + "/uri");
    if (!text || text->front() != '"') continue;
    const std::string uri = decode_json_string(*text);
    if (is_data_uri(uri)) continue;
    const Result<std::string> path = origin.path_of(uri, place);
    if (!path) {
      warnings_.push_back(path.error().text() +
                          "; the image is not embedded, and the result still refers to that file");
      continue;
    }
    Result<FileBytes> file = origin.open(path.value(), place);
    if (!file) return file.error();
    const std::string_view bytes = files_.emplace_back(std::move(file).value()).bytes();
    const char* const media_type = media_type_of(bytes);
    if (media_type == nullptr)
      return invalid_input(place,
                           std::string("the image is not PNG, JPEG, WebP or KTX2, so it cannot be embedded; write ") +
                               (target_.glb ? "a .gltf file" : "the result") + " beside the input");
    images_.push_back({i, media_type, bytes});
  }
  return Success{};
}

// Adds the accessors of new arrays. The bytes of the arrays begin at byte `offset` of the buffer with the index
// `buffer`.
Status EditLayout::add_arrays(std::size_t buffer, std::size_t offset) {
  NewArrays::Json json = document_.arrays.json(buffer, offset, document_.model.views.size());
  for (std::string& view : json.views) {
    if (Status status = append("/bufferViews", std::move(view)); !status) return status;
  }
  for (std::string& accessor : json.accessors) {
    if (Status status = append("/accessors", std::move(accessor)); !status) return status;
  }
  return Success{};
}

// Finds the arrays that the source uses and the edited document does not, in the buffers for which holds(buffer) is
// true. The bytes of such buffers are in the result.
template <class Holds>
Status EditLayout::leave_out_unused(const Holds& holds) {
  if (!document_.without_unused) return Success{};
  std::vector<std::optional<std::size_t>> sizes;
  for (std::size_t i = 0; i < document_.model.buffers.size(); ++i) {
    const std::size_t size = is_bin(i) ? document_.chunks.bin->size() : document_.model.buffers[i].byte_length;
    sizes.push_back(holds(i) ? std::optional(size) : std::nullopt);
  }
  unused_ = find_unused_arrays(document_.model, sizes, document_.chunks.json, join(json_.pieces()));
  for (const auto& [pointer, value] : unused_.changes) {
    if (Status status = set(pointer, value); !status) return status;
  }
  return Success{};
}

Status EditLayout::lay_out_glb() {
  const std::vector<Buffer>& buffers = document_.model.buffers;
  if (document_.chunks.bin) {
    bin_.emplace(1, *document_.chunks.bin);
    bin_size_ = document_.chunks.bin->size();
  }
  bool any_file = false;
  for (std::size_t i = 0; i < buffers.size(); ++i) any_file = any_file || refers_to_file(i);
  if (target_.stands_alone) {
    if (Status status = find_images(); !status) return status;
  }
  const std::uint64_t array_bytes = document_.arrays.byte_count();
  const bool grows = array_bytes > 0 || !images_.empty();
  // A .gltf file that becomes a GLB gets a BIN chunk. A GLB keeps its buffers where they are if possible. If its BIN
  // chunk gets more bytes, however, this chunk must be buffer 0.
  const bool must_move =
      !buffers.empty() && (!document_.is_glb || (target_.stands_alone && any_file) || (grows && !is_bin(0)));
  const auto is_held = [&](std::size_t i) { return is_bin(i) || (must_move && buffers[i].uri); };
  if (Status status = leave_out_unused(is_held); !status) return status;
  if (!buffers.empty() && unused_.bytes_of(0) > 0 && is_bin(0)) {
    bin_ = unused_.kept(0, *document_.chunks.bin);
    bin_size_ -= unused_.bytes_of(0);
  }
  if (must_move) {
    if (Status status = move_buffers(); !status) return status;
  } else if (grows && !buffers.empty()) {
    const Result<std::string_view> bytes = declared_bytes(0);
    if (!bytes) return bytes.error();
  }
  std::size_t arrays_at = 0;
  if (array_bytes > 0) {
    arrays_at = add_to_bin("", 4);
    for (const std::string_view piece : document_.arrays.pieces()) (void)add_to_bin(piece, 1);
  }
  if (Status status = add_arrays(0, arrays_at); !status) return status;
  std::size_t view = document_.model.views.size() + document_.arrays.view_count();
  for (const Image& image : images_) {
    JsonObject of_image, of_view;
    of_view.add("buffer", 0).add("byteOffset", add_to_bin(image.bytes, kViewAlignment));
    of_view.add("byteLength", image.bytes.size());
    if (Status status = append("/bufferViews", of_view.text()); !status) return status;
    const std::string pointer = item_pointer("images", image.index);
    of_image.add("bufferView", view++).add("mimeType", quote_json(image.media_type));
    add_other_members(document_.source.members(pointer), {"uri", "bufferView", "mimeType"}, of_image);
    if (Status status = set(pointer, of_image.text()); !status) return status;
  }

  // Buffer 0 must have bytes, even if no buffer of the source has any.
  if (must_move && bin_size_ == 0) (void)add_to_bin(kZeros, 1);
  JsonObject buffer;
  buffer.add("byteLength", bin_size_);
  if (must_move) {
    add_other_members(first_buffer_, {"uri", "byteLength"}, buffer);
    return set("/buffers", std::string("[").append(buffer.text()).append(other_buffers_).append("]"));
  }
  if (!grows && !unused_.any()) return Success{};
  if (!buffers.empty()) return set("/buffers/0/byteLength", std::to_string(bin_size_));
  return append("/buffers", buffer.text());
}

// Moves all buffers that have bytes into the BIN chunk, which becomes buffer 0. Buffers without bytes come after buffer
// 0; compressed buffer views name such buffers as a fallback.
Status EditLayout::move_buffers() {
  const std::vector<Buffer>& buffers = document_.model.buffers;
  std::vector<Moved> moved;
  std::size_t others = 0;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::string pointer = item_pointer("buffers", i);
    if (!buffers[i].uri && !is_bin(i)) {
      other_buffers_.append(",").append(*document_.source.find(pointer));
      moved.push_back({++others, 0});
      continue;
    }
    const Result<std::string_view> bytes = declared_bytes(i);
    if (!bytes) return bytes.error();
    moved.push_back({0, is_bin(i) ? 0 : add_to_bin("", kViewAlignment)});
    if (!is_bin(i))
      for (const std::string_view piece : unused_.kept(i, bytes.value())) (void)add_to_bin(piece, 1);
    if (i == 0) first_buffer_ = document_.source.members(pointer);
  }
  for (std::size_t i = 0; i < document_.model.views.size(); ++i) {
    const std::string pointer = item_pointer("bufferViews", i);
    const auto offset = unused_.any() ? std::optional(unused_.view_offsets[i]) : std::nullopt;
    if (Status status = move_view(pointer, moved, offset); !status) return status;
    // EXT_meshopt_compression and its successors name the buffer of the compressed bytes in their JSON objects, so
    // these objects must be changed too.
    for (const JsonMember& extension : document_.source.members(pointer + "/extensions")) {
      if (!extension.value.starts_with('{')) continue;
      const std::string of_extension = with_json_token(pointer + "/extensions", extension.name);
      if (Status status = move_view(of_extension, moved, std::nullopt); !status) return status;
    }
  }
  return Success{};
}

// Changes the buffer and the start of a buffer view, or of its extension, as `moved` says. `offset` is the start if
// unused bytes are left out before it. Without an offset, the start in the source counts.
Status EditLayout::move_view(const std::string& pointer, const std::vector<Moved>& moved,
                             std::optional<std::size_t> offset) {
  const std::vector<JsonMember> members = document_.source.members(pointer);
  const std::optional<std::size_t> buffer = to_count(find_last(members, "buffer"));
  if (!buffer || *buffer >= moved.size()) return Success{};
  const auto& [to, by] = moved[*buffer];
  if (to != *buffer) {
    if (Status status = set(pointer + "/buffer", std::to_string(to)); !status) return status;
  }
  if (by == 0) return Success{};
  const std::size_t begin = offset ? *offset : to_count(find_last(members, "byteOffset")).value_or(0);
  return set(pointer + "/byteOffset", std::to_string(begin + by));
}

Status EditLayout::lay_out_gltf() {
  const std::vector<Buffer>& buffers = document_.model.buffers;
  constexpr const char* kBytes = "application/octet-stream";
  const auto is_taken_in = [&](std::size_t i) { return is_bin(i) || (target_.stands_alone && refers_to_file(i)); };
  const auto is_held = [&](std::size_t i) { return is_taken_in(i) || (buffers[i].uri && !refers_to_file(i)); };
  if (Status status = leave_out_unused(is_held); !status) return status;
  for (std::size_t i = 0; i < buffers.size(); ++i) {
    const std::size_t left_out = unused_.bytes_of(i);
    if (!is_taken_in(i) && left_out == 0) continue;
    const Result<std::string_view> bytes = declared_bytes(i);
    if (!bytes) return bytes.error();
    const std::string pointer = item_pointer("buffers", i);
    if (Status status = set(pointer + "/uri", data_uri(kBytes, unused_.kept(i, bytes.value()))); !status) return status;
    if (left_out == 0) continue;
    const std::size_t size = bytes.value().size() - left_out;
    if (Status status = set(pointer + "/byteLength", std::to_string(size)); !status) return status;
  }
  if (target_.stands_alone) {
    if (Status status = find_images(); !status) return status;
  }
  for (const Image& image : images_) {
    if (Status status = set(item_pointer("images", image.index) + "/uri", data_uri(image.media_type, {image.bytes}));
        !status)
      return status;
  }
  if (Status status = add_arrays(buffers.size(), 0); !status) return status;
  const std::uint64_t size = document_.arrays.byte_count();
  if (size == 0) return Success{};
  JsonObject buffer;
  buffer.add("byteLength", std::to_string(size)).add("uri", data_uri(kBytes, document_.arrays.pieces()));
  return append("/buffers", buffer.text());
}

}  // namespace chronormal::inline internal::gltf
