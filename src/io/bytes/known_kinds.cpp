// Lists the kinds of files that people pass to the program by mistake.
#include "io/bytes/known_kinds.h"

#include <algorithm>
#include <array>
#include <utility>

namespace chronormal::inline internal {
namespace {

using namespace std::string_view_literals;

struct KnownKind {
  /// The first bytes of a file of this kind. '?' stands for any byte. If this text begins with '<', a letter in lower
  /// case also stands for the letter in upper case.
  std::string_view begin;
  std::string_view name;
  std::string_view formats = {};  ///< the names of formats whose files are of this kind, each between blanks
};

constexpr std::array kKnownKinds = std::to_array<KnownKind>({
    {"\x89PNG\r\n\x1A\n"sv, "a PNG image"},
    {"\xFF\xD8\xFF"sv, "a JPEG image"},
    {"GIF8"sv, "a GIF image"},
    {"RIFF????WEBP"sv, "a WebP image"},
    {"RIFF"sv, "a RIFF file (sound or video)"},
    {"II*\0"sv, "a TIFF image"},
    {"MM\0*"sv, "a TIFF image"},
    {"#?RADIANCE"sv, "an HDR image"},
    {"v/1\x01"sv, "an OpenEXR image"},
    {"DDS "sv, "a DDS texture"},
    {"\xABKTX "sv, "a KTX texture"},
    {"8BPS"sv, "a Photoshop image"},
    {"????ftyp"sv, "a video or an image of the MPEG-4 family"},
    {"%PDF-"sv, "a PDF document"},
    {"PK\3\4"sv, "a ZIP archive", " npz "},
    {"PK\5\6"sv, "an empty ZIP archive", " npz "},
    {"\x1F\x8B"sv, "gzip data", " target "},
    {"BZh"sv, "bzip2 data"},
    {"\xFD"
     "7zXZ\0"sv,
     "xz data"},
    {"\x28\xB5\x2F\xFD"sv, "Zstandard data"},
    {"7z\xBC\xAF\x27\x1C"sv, "a 7-Zip archive"},
    {"Rar!\x1A\x07"sv, "a RAR archive"},
    {"Kaydara FBX Binary"sv, "an FBX file"},
    {"; FBX "sv, "an FBX file"},
    {"BLENDER"sv, "a Blender file"},
    {"PXR-USDC"sv, "a USD file"},
    {"#usda "sv, "a USD file"},
    {"Ogawa"sv, "an Alembic file"},
    {"\x89HDF\r\n\x1A\n"sv, "an HDF5 file (older Alembic, among others)"},
    {"# vtk DataFile"sv, "a VTK file"},
    {"<VTKFile"sv, "a VTK file"},
    {"solid "sv, "an STL file"},
    {"\x7F"
     "ELF"sv,
     "a program for Linux"},
    {"MZ\x90\0"sv, "a program for Windows"},
    {"\0asm"sv, "a WebAssembly module"},
    {"SQLite format 3\0"sv, "an SQLite database"},
    {"version https://git-lfs"sv, "a placeholder of Git LFS (run git lfs pull to get the file itself)"},
    {"\xFF\xFE"sv, "text in UTF-16"},
    {"\xFE\xFF"sv, "text in UTF-16"},
    {"<!doctype html"sv, "an HTML page"},
    {"<html"sv, "an HTML page"},
    {"<svg"sv, "an SVG image"},
    {"<collada"sv, "a COLLADA file"},
    {"<?xml"sv, "an XML file", " maya maya_xml "},
    {"glTF"sv, "a GLB file (glTF)", " gltf "},
    {"ply\n"sv, "a PLY file", " ply "},
    {"ply\r"sv, "a PLY file", " ply "},
    {"IDP2"sv, "an MD2 file", " md2 "},
    {"\x93NUMPY"sv, "an NPY array", " npy "},
    {"POINTCACHE2\0"sv, "a PC2 cache", " pc2 "},
    {"FOR4"sv, "a Maya cache", " maya "},
    {"FOR8"sv, "a Maya cache", " maya "},
});

bool begins_with(std::string_view bytes, std::string_view begin) noexcept {
  const bool is_markup = begin.front() == '<';
  const auto is_like = [is_markup](char expected, char found) {
    if (is_markup && found >= 'A' && found <= 'Z') found = static_cast<char>(found - 'A' + 'a');
    return expected == '?' || expected == found;
  };
  return bytes.size() >= begin.size() && std::equal(begin.begin(), begin.end(), bytes.begin(), is_like);
}

// Returns true if bytes are text in UTF-16 without a byte order mark: in the first letters, every second byte is zero.
bool is_plain_utf16(std::string_view bytes) noexcept {
  constexpr std::size_t kLetters = 8;
  if (bytes.size() < 2 * kLetters) return false;
  const auto has_text_at = [&](std::size_t first) {
    for (std::size_t i = 0; i < kLetters; ++i) {
      const char letter = bytes[2 * i + first], other = bytes[2 * i + 1 - first];
      const bool is_text = (letter >= ' ' && letter <= '~') || letter == '\t' || letter == '\r' || letter == '\n';
      if (!is_text || other != '\0') return false;
    }
    return true;
  };
  return has_text_at(0) || has_text_at(1);
}

const KnownKind* find_kind(std::string_view bytes) noexcept {
  static constexpr KnownKind kPlainUtf16 = {"", "text in UTF-16"};
  if (is_plain_utf16(bytes)) return &kPlainUtf16;
  // Markup may begin with a byte order mark or with blank lines.
  std::string_view text = bytes;
  if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
  text.remove_prefix(std::min(text.find_first_not_of(" \t\r\n"), text.size()));
  const auto found = std::find_if(kKnownKinds.begin(), kKnownKinds.end(), [&](const KnownKind& kind) {
    return begins_with(kind.begin.front() == '<' ? text : bytes, kind.begin);
  });
  return found == kKnownKinds.end() ? nullptr : found;
}

// Returns the title of a format: "glTF" for "gltf", "OBJ" for "obj".
std::string title_of(std::string_view format) {
  if (format == "gltf") return "glTF";
  if (format == "target") return "a MakeHuman target";
  if (format == "maya") return "a Maya cache";
  std::string title(format);
  for (char& c : title) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
  return title;
}

}  // namespace

std::string_view known_kind(std::string_view bytes) noexcept {
  const KnownKind* const kind = find_kind(bytes);
  return kind == nullptr ? std::string_view() : kind->name;
}

Status check_kind(std::string_view bytes, const std::string& place, std::string_view expected) {
  const KnownKind* const kind = find_kind(bytes);
  if (kind == nullptr || kind->formats.find(' ' + std::string(expected) + ' ') != std::string_view::npos)
    return Success{};
  return invalid_input(place, "this is " + std::string(kind->name) + ", not " + title_of(expected));
}

}  // namespace chronormal::inline internal
