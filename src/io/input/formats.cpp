// Lists all file formats with the functions that read and write them. No other file lists formats.
#include "io/input/formats.h"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "io/bytes/extension.h"
#include "io/bytes/known_kinds.h"
#include "io/bytes/scan.h"
#include "io/cache/maya_cache.h"
#include "io/cache/md2.h"
#include "io/cache/mdd.h"
#include "io/cache/npz.h"
#include "io/cache/pc2.h"
#include "io/mesh/obj.h"
#include "io/mesh/ply.h"

namespace chronormal::inline internal {
namespace {

using Extension = std::string_view;

constexpr std::array<Extension, 1> kObj = {".obj"}, kPly = {".ply"}, kNpz = {".npz"}, kMd2 = {".md2"}, kPc2 = {".pc2"},
                                   kMdd = {".mdd"}, kNpy = {".npy"}, kMayaDescription = {".xml"};
constexpr std::array<Extension, 2> kMaya = {".mc", ".mcx"}, kTarget = {".target", ".target.gz"};
constexpr std::array<Extension, 3> kGltf = {".gltf", ".glb", ".vrm"};

// Returns true if the first line that is neither empty nor a comment begins with a common keyword of OBJ.
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
  // If the first bytes contain nothing but comments, the rest of the file may be OBJ statements.
  return has_comment;
}

bool is_ply(std::string_view first_bytes) {
  return first_bytes.starts_with("ply\n") || first_bytes.starts_with("ply\r");
}

bool is_gltf(std::string_view first_bytes) { return GltfDocument::recognises(first_bytes); }
bool is_zip(std::string_view first_bytes) { return first_bytes.starts_with("PK\3\4"); }
bool is_md2(std::string_view first_bytes) { return first_bytes.starts_with("IDP2"); }

std::string write_binary_ply(const Topology& topology, VectorView<const float> positions, const Origin& origin) {
  return write_ply(topology, positions, PlyEncoding::kBinaryLittleEndian, origin);
}

std::string write_plain_obj(const Topology& topology, VectorView<const float> positions, const Origin& origin) {
  return write_obj(topology, positions, origin);
}

// Reads an MD2 file. No count in MD2 can be larger than the file, so max_expansion is not needed.
Result<Motion> read_whole_md2(std::string_view bytes, const std::string& name, double frames_per_second,
                              std::size_t /*max_expansion*/) {
  return read_md2(bytes, name, frames_per_second);
}

constexpr std::array<Format, 11> kFormats = {{
    {.name = "obj",
     .holds = Holds::kMesh,
     .extensions = kObj,
     .recognises = is_obj,
     .read_mesh = read_obj,
     .read_shaded_mesh = read_obj_shading,
     .write_mesh = write_plain_obj},
    {.name = "ply",
     .holds = Holds::kMesh,
     .extensions = kPly,
     .recognises = is_ply,
     .read_mesh = read_ply,
     .read_moving_mesh = read_moving_ply,
     .write_mesh = write_binary_ply},
    {.name = "gltf", .holds = Holds::kGltf, .extensions = kGltf, .recognises = is_gltf},
    {.name = "npz",
     .holds = Holds::kMotion,
     .extensions = kNpz,
     .recognises = is_zip,
     .read_motion = read_npz,
     .read_outline = read_npz_outline,
     .write_motion = write_npz},
    {.name = "md2", .holds = Holds::kMotion, .extensions = kMd2, .recognises = is_md2, .read_motion = read_whole_md2},
    {.name = "pc2",
     .holds = Holds::kCache,
     .extensions = kPc2,
     .read_cache = read_pc2,
     .find_layout = find_pc2_layout,
     .write_motion = write_pc2},
    {.name = "mdd",
     .holds = Holds::kCache,
     .extensions = kMdd,
     .read_cache = read_mdd,
     .find_layout = find_mdd_layout,
     .write_motion = write_mdd},
    {.name = "npy", .holds = Holds::kCache, .extensions = kNpy, .read_cache = read_npy, .find_layout = find_npy_layout},
    {.name = "maya", .holds = Holds::kCache, .extensions = kMaya, .read_cache = read_maya_points},
    {.name = "maya_xml", .holds = Holds::kCache, .extensions = kMayaDescription},
    {.name = "target", .holds = Holds::kTarget, .extensions = kTarget},
}};

}  // namespace

std::span<const Format> formats() noexcept { return kFormats; }

const Format* find_format(std::string_view file_name) noexcept {
  const auto ends_with = [file_name](Extension extension) {
    const auto same = [](char a, char b) { return (a >= 'A' && a <= 'Z' ? static_cast<char>(a - 'A' + 'a') : a) == b; };
    return file_name.size() >= extension.size() &&
           std::equal(file_name.end() - static_cast<std::ptrdiff_t>(extension.size()), file_name.end(),
                      extension.begin(), same);
  };
  for (const Format& format : kFormats)
    if (std::any_of(format.extensions.begin(), format.extensions.end(), ends_with)) return &format;
  return nullptr;
}

const Format* find_format(std::string_view file_name, std::string_view bytes) noexcept {
  if (const Format* const format = find_format(file_name)) return format;
  const std::string_view first_bytes = bytes.substr(0, 512);
  for (const Format& format : kFormats)
    if (format.recognises != nullptr && format.recognises(first_bytes)) return &format;
  return nullptr;
}

std::string unknown_format(std::string_view bytes, std::string_view what) {
  const std::string_view kind = known_kind(bytes);
  return kind.empty() ? "the file is not " + std::string(what) + ", by its name and its content"
                      : "this is " + std::string(kind);
}

std::string way_in(std::string_view file_name, std::string_view bytes) {
  struct Foreign {
    // The kind of the file in the words that known_kind() returns, such as "an FBX file".
    std::string_view kind;
    std::array<std::string_view, 4> extensions;
    std::string_view way;
  };
  static constexpr std::string_view kSection = " (docs/formats.md#from-fbx-alembic-and-openusd)";
  static constexpr auto kForeign = std::to_array<Foreign>({
      {"an FBX file", {".fbx"}, "convert it to glTF with Blender or fbx2gltf first"},
      {"an Alembic file", {".abc"}, "export it as OBJ with PC2 or MDD first"},
      {"a USD file", {".usd", ".usda", ".usdc", ".usdz"}, "export it as OBJ with PC2 or MDD first"},
      {"a Blender file", {".blend"}, "export it as glTF, or as OBJ with PC2, first"},
      {"a VTK file", {".vtp", ".vtu", ".vtk"}, "export it as PLY or OBJ, or as .npz with positions and faces, first"},
  });
  if (find_format(file_name) != nullptr) return "";
  const std::string extension = lower_extension(file_name);
  const std::string_view kind = known_kind(bytes);
  for (const Foreign& foreign : kForeign) {
    const bool has_extension = !extension.empty() && std::find(foreign.extensions.begin(), foreign.extensions.end(),
                                                               extension) != foreign.extensions.end();
    if (kind != foreign.kind && !has_extension) continue;
    return "this is " + std::string(foreign.kind) + ", which cannot be read; " + std::string(foreign.way) +
           std::string(kSection) + ". These formats can be read: " +
           extensions_of({Holds::kGltf, Holds::kMotion, Holds::kMesh, Holds::kCache, Holds::kTarget});
  }
  return "";
}

std::string extensions_of(std::initializer_list<Holds> kinds, std::string_view last) {
  std::vector<Extension> found;
  for (const Format& format : kFormats) {
    if (std::find(kinds.begin(), kinds.end(), format.holds) != kinds.end())
      found.insert(found.end(), format.extensions.begin(), format.extensions.end());
  }
  std::string text;
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (i > 0) text += i + 1 == found.size() ? last : ", ";
    text += found[i];
  }
  return text;
}

Result<MeshFrame> read_mesh(std::string_view bytes, const std::string& file_name, const std::string& place,
                            WantedOfMesh wanted) {
  const Format* const format = find_format(file_name, bytes);
  if (std::string way = way_in(file_name, bytes); !way.empty()) return invalid_input(place, std::move(way));
  if (format == nullptr || format->holds != Holds::kMesh)
    return invalid_input(place,
                         (format == nullptr ? unknown_format(bytes, "in a known format") : "this is not a mesh") +
                             "; give a mesh as " + extensions_of({Holds::kMesh}, " or "));
  if (const Status is_other = check_kind(bytes, place, format->name); !is_other) return is_other.error();
  if (wanted.velocities && format->read_moving_mesh != nullptr)
    return format->read_moving_mesh(bytes, place, wanted.origin);
  return (wanted.shading && format->read_shaded_mesh != nullptr ? format->read_shaded_mesh : format->read_mesh)(
      bytes, place, wanted.origin);
}

}  // namespace chronormal::inline internal
