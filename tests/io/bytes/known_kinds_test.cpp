// Checks the message about a file that has the extension of another format. If the first bytes of the file reveal its
// kind, the message must name that kind.
#include "io/bytes/known_kinds.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <iterator>
#include <random>
#include <string>
#include <vector>

#include "chronormal/io/input.h"
#include "io/input/formats.h"
#include "tests/support/cache_bytes.h"
#include "tests/support/places.h"
#include "tests/support/read_input.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::known_kinds_test {
namespace {

using namespace std::string_literals;

// A kind of file: the first bytes that its specification demands, and the words for this kind that a message about the
// file must contain.
struct Sample {
  std::string bytes, kind;
};
const std::vector<Sample> kSamples = {
    {"\x89PNG\r\n\x1A\n\0\0\0\rIHDR"s, "a PNG image"},
    {"\xFF\xD8\xFF\xE0\0\x10JFIF\0"s, "a JPEG image"},
    {"GIF89a\1\0\1\0", "a GIF image"},
    {"RIFF\x24\0\0\0WEBPVP8 "s, "a WebP image"},
    {"II*\0\x08\0\0\0"s, "a TIFF image"},
    {"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n", "an HDR image"},
    {"\xABKTX 20\xBB\r\n\x1A\n", "a KTX texture"},
    {"\0\0\0\x18"s + "ftypmp42", "MPEG-4"},
    {"%PDF-1.7\n%\xE2\xE3\n", "a PDF document"},
    {"\x1F\x8B\x08\0\0\0\0\0"s, "gzip data"},
    {"7z\xBC\xAF\x27\x1C\0\4"s, "a 7-Zip archive"},
    {"Kaydara FBX Binary  \0\x1A\0"s, "an FBX file"},
    {"; FBX 7.3.0 project file\n", "an FBX file"},
    {"BLENDER-v300", "a Blender file"},
    {"PXR-USDC\0\x08"s, "a USD file"},
    {"#usda 1.0\n(\n", "a USD file"},
    {"solid cube\nfacet normal 0 0 1\n", "an STL file"},
    {"version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 12345\n", "Git LFS"},
    {"\xFF\xFE{\0\n\0"s, "text in UTF-16"},
    {"<!DOCTYPE html>\n<html>", "an HTML page"},
    {"\xEF\xBB\xBF \n<HTML lang=en>", "an HTML page"},
    {"<?xml version=\"1.0\"?>\n<COLLADA>", "an XML file"},
    {"<svg xmlns=\"http://www.w3.org/2000/svg\">", "an SVG image"},
};

class KnownKinds : public ::testing::Test {
 protected:
  // Returns the message about a file with the given name and content. If the name has the extension of a point cache,
  // the file is read together with a mesh.
  std::string said(const std::string& name, const std::string& bytes) {
    folder_.write(name, bytes);
    folder_.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Format* const format = find_format(name);
    InputOptions options = test::files({folder_ / name});
    options.allow_mesh = true;
    if (format != nullptr && format->holds == Holds::kCache)
      options.files.insert(options.files.begin(), folder_ / "mesh.obj");
    if (format != nullptr && format->holds == Holds::kTarget) options.base = folder_ / "mesh.obj";
    const Result<Input> input = open_input(options);
    return input ? "" : input.error().text();
  }

  test::TemporaryFolder folder_;
};

TEST_F(KnownKinds, are_named_whatever_the_name_of_the_file_says) {
  for (const std::string name : {"a.glb", "a.gltf", "a.vrm", "a.obj", "a.ply", "a.npz", "a.md2", "a.pc2", "a.mdd",
                                 "a.npy", "a.target", "a.png", "a"}) {
    for (const auto& [bytes, kind] : kSamples) {
      if (name == "a.target" && kind == "gzip data") continue;  // a .target file may be compressed by gzip
      EXPECT_NE(said(name, bytes).find(kind), std::string::npos) << name << ' ' << kind << ": " << said(name, bytes);
    }
  }
  EXPECT_EQ(said("face.glb", kSamples.front().bytes), "face.glb, byte 0: this is a PNG image, not glTF");
  EXPECT_EQ(said("face.obj", kSamples.front().bytes).substr(8), ": this is a PNG image, not OBJ");
}

TEST_F(KnownKinds, are_our_own_formats_under_names_of_others) {
  const std::vector<std::pair<std::string, Sample>> own = {
      {".glb", {"glTF\2\0\0\0\x14\0\0\0\0\0\0\0JSON"s, "a GLB file"}},
      {".npz", {test::small_npz(true), "a ZIP archive"}},
      {".md2", {test::small_md2(), "an MD2 file"}},
      {".pc2", {test::small_pc2(40, 2), "a PC2 cache"}},
      {".ply", {"ply\nformat ascii 1.0\n", "a PLY file"}}};
  for (const auto& [extension, sample] : own) {
    for (const std::string name : {"a.glb", "a.obj", "a.ply", "a.npz", "a.md2", "a.pc2", "a.npy"}) {
      if (name.ends_with(extension)) continue;
      EXPECT_NE(said(name, sample.bytes).find("this is " + sample.kind), std::string::npos)
          << name << ' ' << sample.kind << ": " << said(name, sample.bytes);
    }
  }
}

TEST(KnownKindsOfBytes, are_no_files_of_ours_and_no_noise) {
  const std::vector<std::string> kShort = {"\xFF\xFE", "\xFE\xFF", "\x1F\x8B", "BZh", "\xFF\xD8\xFF"};
  std::mt19937 random(50);
  SCOPED_TRACE("seed 50");
  for (int round = 0; round < 20000; ++round) {
    std::string bytes(random() % 40, '\0');
    for (char& c : bytes) c = static_cast<char>(random() % 256);
    // The random text consists of parts that occur in text formats: numbers, words and brackets.
    std::string text;
    for (int word = 0; word < 6; ++word)
      text += std::vector<std::string>{"v ",  "f ",       "# ", "{\"asset\":", "1.5 ",   "\n",
                                       "-2 ", "o solid ", " <", "[",           "mtllib "}[random() % 11];
    EXPECT_EQ(known_kind(text), "") << text;
    // Some kinds of files are recognised by their first two or three bytes, and random bytes often begin with such
    // bytes.
    const bool may_be_one =
        std::any_of(kShort.begin(), kShort.end(), [&](const std::string& begin) { return bytes.starts_with(begin); });
    EXPECT_TRUE(may_be_one || known_kind(bytes).empty()) << known_kind(bytes);
  }
  EXPECT_EQ(known_kind(""), "");
}

TEST_F(KnownKinds, real_files_of_the_repository) {
  std::ifstream picture(std::string(kSourceFolder) + "/docs/pictures/head.png", std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(picture), {}};
  EXPECT_EQ(known_kind(bytes), "a PNG image");
  EXPECT_EQ(check_kind(bytes, "p", "json").error().text(), "p: this is a PNG image, not JSON");
}

}  // namespace
}  // namespace chronormal::known_kinds_test
