// Tests the container of GLB files: its header and its chunks.
#include "io/gltf/glb/glb.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace chronormal::glb_test {
namespace {

std::string word(std::uint32_t value) {
  std::string bytes;
  for (int shift = 0; shift < 32; shift += 8) bytes += static_cast<char>((value >> shift) & 0xFF);
  return bytes;
}

std::string chunk(const std::string& type, const std::string& content) {
  return word(static_cast<std::uint32_t>(content.size())) + type + content;
}

std::string glb(const std::string& chunks) {
  return "glTF" + word(2) + word(static_cast<std::uint32_t>(12 + chunks.size())) + chunks;
}

std::string error_of(const std::string& bytes) {
  const Result<GlbChunks> chunks = read_glb(bytes, "a.glb");
  return chunks ? "" : chunks.error().text();
}

const std::string kBin("BIN\0", 4);

TEST(ReadGlb, finds_the_chunks_and_what_follows_them) {
  const std::string bytes = glb(chunk("JSON", "{}  ") + chunk(kBin, "12345678") + chunk("more", ""));
  const Result<GlbChunks> chunks = read_glb(bytes, "a.glb");
  ASSERT_TRUE(chunks.ok()) << chunks.error().text();
  EXPECT_EQ(chunks.value().json, "{}  ");
  EXPECT_EQ(chunks.value().json_offset, 20U);
  EXPECT_EQ(chunks.value().bin, "12345678");
  EXPECT_EQ(chunks.value().rest, chunk("more", ""));
}

TEST(ReadGlb, errors_say_where_and_what) {
  const std::string json = chunk("JSON", "{}  ");
  EXPECT_EQ(error_of("{\"asset\": {\"version\": \"2.0\"}}"),
            "a.glb, byte 0: this is not a GLB file, since it does not begin with the word glTF; export the file again");
  EXPECT_EQ(error_of(glb("")),
            "a.glb, byte 12: the file is cut off inside its header of 20 bytes; copy or export it again");
  EXPECT_EQ(error_of(glb(json + "1234")),
            "a.glb, byte 24: the file is cut off inside the header of a chunk; copy or export it again");
  EXPECT_EQ(error_of(glb(json + word(9) + kBin)),
            "a.glb, byte 24: chunk 1 should have 9 bytes, but only 0 are left in the file; copy or export it again");
  EXPECT_EQ(error_of(glb(chunk("JSON", "{} ") + " ")),
            "a.glb, byte 12: the length of chunk 0 must be a multiple of 4; export the file again");
  EXPECT_EQ(error_of(glb(chunk(kBin, "") + json)),
            "a.glb, byte 16: the first chunk must be JSON, but has another type; export the file again");
  EXPECT_EQ(error_of(glb(json + json)),
            "a.glb, byte 28: the file has a second JSON chunk, but may have only one; export it again");
  EXPECT_EQ(error_of(glb(json + chunk("more", "") + chunk(kBin, ""))),
            "a.glb, byte 36: the BIN chunk must be the second chunk, right after JSON; export the file again");
}

}  // namespace
}  // namespace chronormal::glb_test
