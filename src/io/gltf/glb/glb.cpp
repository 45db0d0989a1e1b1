#include "io/gltf/glb/glb.h"

#include <bit>
#include <cstdint>
#include <utility>

#include "core/text.h"
#include "io/bytes/binary.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kHeaderSize = 12, kChunkHeaderSize = 8;
constexpr std::uint32_t kJson = 0x4E4F534A, kBin = 0x004E4942;

}  // namespace

Result<GlbChunks> read_glb(std::string_view bytes, const std::string& name) {
  const auto error = [&](std::size_t at, std::string message) {
    return invalid_input(binary::place(name, at), std::move(message));
  };
  const auto word = [&](std::size_t at) { return binary::load<std::uint32_t>(bytes.data() + at, std::endian::little); };
  if (!is_glb(bytes))
    return error(0, "this is not a GLB file, since it does not begin with the word glTF; export the file again");
  if (bytes.size() < kHeaderSize + kChunkHeaderSize)
    return error(bytes.size(), "the file is cut off inside its header of 20 bytes; copy or export it again");
  if (word(4) != 2)
    return error(4, "version " + std::to_string(word(4)) + " of GLB cannot be read; export the file as glTF 2.0");
  if (word(8) != bytes.size())
    return error(8, "the header says that the file has " + counted(word(8), "byte", "bytes") + ", but it has " +
                        grouped(bytes.size()) + "; copy or export it again");

  GlbChunks chunks;
  for (std::size_t at = kHeaderSize, chunk = 0; at < bytes.size(); ++chunk) {
    if (bytes.size() - at < kChunkHeaderSize)
      return error(at, "the file is cut off inside the header of a chunk; copy or export it again");
    const std::size_t size = word(at), begin = at + kChunkHeaderSize;
    const std::uint32_t type = word(at + 4);
    if (size > bytes.size() - begin)
      return error(at, "chunk " + std::to_string(chunk) + " should have " + counted(size, "byte", "bytes") +
                           ", but only " + counted(bytes.size() - begin, "is left", "are left") +
                           " in the file; copy or export it again");
    if (size % 4 != 0)
      return error(at,
                   "the length of chunk " + std::to_string(chunk) + " must be a multiple of 4; export the file again");
    if ((chunk == 0) != (type == kJson))
      return error(at + 4, chunk == 0 ? "the first chunk must be JSON, but has another type; export the file again"
                                      : "the file has a second JSON chunk, but may have only one; export it again");
    if (type == kJson) {
      chunks.json = bytes.substr(begin, size);
      chunks.json_offset = begin;
      chunks.rest = bytes.substr(begin + size);
    } else if (type == kBin) {
      if (chunk != 1)
        return error(at + 4, "the BIN chunk must be the second chunk, right after JSON; export the file again");
      chunks.bin = bytes.substr(begin, size);
      chunks.rest = bytes.substr(begin + size);
    }
    at = begin + size;
  }
  return chunks;
}

Result<GlbFrame> frame_glb(std::uint64_t json_size, std::optional<std::uint64_t> bin_size, std::uint64_t rest_size,
                           const std::string& name) {
  const auto padding_of = [](std::uint64_t size) { return static_cast<std::size_t>((4 - size % 4) % 4); };
  const std::size_t json_padding = padding_of(json_size), bin_padding = padding_of(bin_size.value_or(0));
  GlbFrame frame;
  frame.size = kHeaderSize + kChunkHeaderSize + json_size + json_padding +
               (bin_size ? kChunkHeaderSize + *bin_size + bin_padding : 0) + rest_size;
  if (frame.size > ~std::uint32_t{0})
    return invalid_input(name, "the result would have " + counted(frame.size, "byte", "bytes") +
                                   ", but a GLB file can have at most 4,294,967,295; write a .gltf file instead");
  const auto add_word = [](std::string& bytes, std::uint64_t word) {
    binary::append(bytes, static_cast<std::uint32_t>(word), std::endian::little);
  };
  frame.before_json = "glTF";
  add_word(frame.before_json, 2);
  add_word(frame.before_json, frame.size);
  add_word(frame.before_json, json_size + json_padding);
  add_word(frame.before_json, kJson);
  frame.behind_json.assign(json_padding, ' ');
  if (bin_size) {
    add_word(frame.behind_json, *bin_size + bin_padding);
    add_word(frame.behind_json, kBin);
  }
  frame.behind_bin.assign(bin_padding, '\0');
  return frame;
}

Result<GlbPieces> lay_out_glb(std::span<const std::string_view> json,
                              const std::optional<std::vector<std::string_view>>& bin, std::string_view rest,
                              const std::string& name) {
  const auto size_of = [](std::span<const std::string_view> pieces) {
    std::uint64_t size = 0;
    for (const std::string_view piece : pieces) size += piece.size();
    return size;
  };
  Result<GlbFrame> frame =
      frame_glb(size_of(json), bin ? std::optional(size_of(*bin)) : std::nullopt, rest.size(), name);
  if (!frame) return frame.error();
  GlbPieces result;
  result.frame = std::make_unique<const GlbFrame>(std::move(frame).value());
  result.pieces.push_back(result.frame->before_json);
  result.pieces.insert(result.pieces.end(), json.begin(), json.end());
  result.pieces.push_back(result.frame->behind_json);
  if (bin) result.pieces.insert(result.pieces.end(), bin->begin(), bin->end());
  result.pieces.push_back(result.frame->behind_bin);
  result.pieces.push_back(rest);
  return result;
}

}  // namespace chronormal::inline internal
