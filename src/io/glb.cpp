#include "io/glb.h"

#include <bit>
#include <cstdint>

#include "io/binary.h"

namespace chronormal {
namespace {

constexpr std::size_t kHeaderSize = 12, kChunkHeaderSize = 8;
constexpr std::uint32_t kJson = 0x4E4F534A, kBin = 0x004E4942;

}  // namespace

Result<GlbChunks> read_glb(std::string_view bytes, const std::string& name) {
  const auto error = [&](std::size_t at, std::string message) {
    return invalid_input(binary::place(name, at), std::move(message));
  };
  const auto word = [&](std::size_t at) { return binary::load<std::uint32_t>(bytes.data() + at, std::endian::little); };
  if (!is_glb(bytes)) return error(0, "this is not a GLB file: its first word is not glTF");
  if (bytes.size() < kHeaderSize + kChunkHeaderSize)
    return error(bytes.size(), "the file ends inside its header of 20 bytes");
  if (word(4) != 2) return error(4, "version " + std::to_string(word(4)) + " of GLB is unknown; there is only 2");
  if (word(8) != bytes.size())
    return error(8, "the header declares " + std::to_string(word(8)) + " bytes, but the file has " +
                        std::to_string(bytes.size()));

  GlbChunks chunks;
  for (std::size_t at = kHeaderSize, chunk = 0; at < bytes.size(); ++chunk) {
    if (bytes.size() - at < kChunkHeaderSize) return error(at, "the file ends inside the header of a chunk");
    const std::size_t size = word(at), begin = at + kChunkHeaderSize;
    const std::uint32_t type = word(at + 4);
    if (size > bytes.size() - begin)
      return error(at, "chunk " + std::to_string(chunk) + " declares " + std::to_string(size) + " bytes, but only " +
                           std::to_string(bytes.size() - begin) + " are left");
    if (size % 4 != 0) return error(at, "the length of chunk " + std::to_string(chunk) + " is no multiple of 4");
    if ((chunk == 0) != (type == kJson))
      return error(at + 4, chunk == 0 ? "the first chunk is not JSON" : "there is a second JSON chunk");
    if (type == kJson) {
      chunks.json = bytes.substr(begin, size);
      chunks.json_offset = begin;
    } else if (type == kBin) {
      if (chunk != 1) return error(at + 4, "the BIN chunk must be the second");
      chunks.bin = bytes.substr(begin, size);
    }
    at = begin + size;
  }
  return chunks;
}

}  // namespace chronormal
