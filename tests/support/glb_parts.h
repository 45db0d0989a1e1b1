/// Splits GLB files that GltfEdit wrote into JSON and binary data, without chronormal's reader.
#ifndef CHRONORMAL_TESTS_SUPPORT_GLB_PARTS_H_
#define CHRONORMAL_TESTS_SUPPORT_GLB_PARTS_H_

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>

#include "chronormal/io/gltf_document.h"

namespace chronormal::test {

struct GlbParts {
  std::string json, bin, rest;  ///< contents of the chunks; `rest` has further chunks with their headers
};

[[nodiscard]] inline GlbParts take_apart(const std::string& bytes) {
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return std::size_t{value};
  };
  GlbParts result;
  if (bytes.size() < 20 || bytes.substr(0, 4) != "glTF" || word(4) != 2 || word(8) != bytes.size() ||
      bytes.substr(16, 4) != "JSON" || word(12) % 4 != 0) {
    ADD_FAILURE() << "this is no GLB file";
    return result;
  }
  result.json = bytes.substr(20, word(12));
  std::size_t at = 20 + word(12);
  if (at < bytes.size() && bytes.substr(at + 4, 4) == std::string("BIN\0", 4)) {
    EXPECT_EQ(word(at) % 4, 0U);
    result.bin = bytes.substr(at + 8, word(at));
    at += 8 + word(at);
  }
  result.rest = bytes.substr(std::min(at, bytes.size()));
  return result;
}

/// Returns the bytes of the file that an edit makes, or the text of its error.
[[nodiscard]] inline std::string bytes_or_error(const GltfEdit& edit, const std::string& path = "") {
  const Result<std::string> bytes = edit.bytes(path);
  return bytes ? bytes.value() : bytes.error().text();
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_GLB_PARTS_H_
