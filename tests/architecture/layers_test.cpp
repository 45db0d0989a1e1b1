// Tests which files include which others. A floor is a folder, a room is a folder in a floor, and a room may contain
// smaller rooms. A file may include only its own room, the rooms before its own on its floor or in its room, and the
// floors before its own. Paths alone decide, so this test needs no list of files. docs/architecture.md describes the
// order.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/places.h"

namespace chronormal::layers_test {
namespace {

namespace fs = std::filesystem;

struct Room {
  Room(const char* of_room, std::vector<std::string> inside = {}) : name(of_room), rooms(std::move(inside)) {}

  std::string name;
  std::vector<std::string> rooms;  // the rooms inside this room, in order; files directly in this room come after them
};
struct Floor {
  std::string name;
  std::vector<Room> rooms;
};

const std::vector<Floor> kFloors = {
    {"core", {}},
    {"simd", {}},
    {"motion", {}},
    {"normals", {"control", "groups", "curves", "recompute", "blend", "weighting", "elements"}},
    {"schemes", {}},
    {"analysis", {"fits", "quality", "certificates", "signs", "cones", "containment"}},
    {"io", {"system", "bytes", "json", "mesh", "cache", {"gltf", {"model", "decode", "glb", "edit"}}, "input"}},
    {"workflow",
     {"segments",
      "viewers",
      "shading",
      "truth",
      "sample",
      "inspect",
      "errors",
      "audit",
      "compare",
      {"bake", {"poses", "deltas", "judge", "fits", "candidates", "write", "sequence"}},
      "query",
      "json",
      "report"}},
    {"cli", {"terminal", "ranks", "options", {"reports", {"audit"}}, "commands"}},
};

const fs::path kRoot = chronormal::kSourceFolder;

std::string read(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  std::ostringstream text;
  text << file.rdbuf();
  return text.str();
}

std::vector<std::string> lines_of(const std::string& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

// Splits a path into the names of its folders and of its file.
std::vector<std::string> parts_of(const std::string& path) {
  std::vector<std::string> parts;
  for (const fs::path& part : fs::path(path)) parts.push_back(part.string());
  return parts;
}

// The place of a file in the order: the numbers of its floor, of its room on this floor, and of the room inside this
// room. Room 0 stands for the files that lie directly in the folder of the floor, which come before its rooms.
// main.cpp, in which the program begins, comes after the rooms of its floor. A public header comes before the rooms
// inside its room, and a private file of the room itself after them.
struct Place {
  std::size_t floor = 0;
  std::size_t room = 0;
  std::size_t inside = 0;

  auto operator<=>(const Place&) const = default;
};

// Returns the room of a public header: the room of its source src/FLOOR/ROOM/STEM.cpp, or the floor itself if there is
// no such source.
std::string room_of_public_header(const std::string& floor, const fs::path& header) {
  for (const auto& [name, rooms] : kFloors) {
    if (name != floor) continue;
    for (const Room& room : rooms) {
      if (fs::exists(kRoot / "src" / floor / room.name / header.stem().concat(".cpp"))) return room.name;
    }
  }
  return "";
}

// Returns the place of a file. `path` is the path of the file, or the text by which others include it:
// include/chronormal/FLOOR/STEM.h, src/FLOOR/ROOM/..., or cli/... Returns nothing if the path is on no floor, or in a
// folder that is not a room.
std::optional<Place> place_of(const std::string& path) {
  std::vector<std::string> parts = parts_of(path);
  if (!parts.empty() && (parts[0] == "include" || parts[0] == "src")) parts.erase(parts.begin());
  const bool is_public = !parts.empty() && parts[0] == "chronormal";
  if (is_public) parts.erase(parts.begin());
  if (parts.size() < 2) return std::nullopt;

  for (std::size_t f = 0; f < kFloors.size(); ++f) {
    const auto& [name, rooms] = kFloors[f];
    if (name != parts[0]) continue;
    if (name == "cli" && parts[1] == "main.cpp") return Place{f, rooms.size() + 1, 0};
    std::string room;
    if (is_public)
      room = room_of_public_header(name, parts[1]);
    else if (parts.size() > 2 && parts[1] != "kernels")
      room = parts[1];
    if (room.empty()) return Place{f, 0, 0};
    const auto found = std::find_if(rooms.begin(), rooms.end(), [&](const Room& r) { return r.name == room; });
    if (found == rooms.end()) return std::nullopt;
    Place place{f, static_cast<std::size_t>(found - rooms.begin()) + 1, 0};
    if (is_public) return place;
    if (parts.size() == 3 || parts[2] == "kernels") {
      place.inside = found->rooms.size() + 1;
      return place;
    }
    const auto inner = std::find(found->rooms.begin(), found->rooms.end(), parts[2]);
    if (inner == found->rooms.end()) return std::nullopt;
    place.inside = static_cast<std::size_t>(inner - found->rooms.begin()) + 1;
    return place;
  }
  return std::nullopt;
}

// Returns the path that a line includes in quotes, or "".
std::string included_by(const std::string& line) {
  const std::size_t hash = line.find_first_not_of(" \t");
  if (hash == std::string::npos || line[hash] != '#' || line.find("include", hash) == std::string::npos) return "";
  const std::size_t first = line.find('"');
  const std::size_t last = line.find('"', first + 1);
  return last == std::string::npos ? "" : line.substr(first + 1, last - first - 1);
}

// Describes each #include in a file that breaks the order of floors and rooms.
std::vector<std::string> violations(const std::string& path, const std::string& text) {
  std::vector<std::string> found;
  const auto own = place_of(path);
  if (!own) return {path + ": the folder is neither a layer nor a room"};
  for (const std::string& line : lines_of(text)) {
    const std::string included = included_by(line);
    if (included.empty()) continue;
    const auto other = place_of(included);
    if (!other)
      found.push_back(path + " includes " + included + ", which is in no layer");
    else if (*other > *own)
      found.push_back(path + " includes " + included + ", from a layer or room below it");
  }
  return found;
}

bool is_umbrella(const fs::path& file) {
  return file == "include/chronormal/chronormal.h" || file == "include/chronormal/chronormal_io.h";
}

std::vector<fs::path> product_files() {
  std::vector<fs::path> files;
  for (const char* folder : {"include/chronormal", "src", "cli"}) {
    for (const auto& entry : fs::recursive_directory_iterator(kRoot / folder)) {
      const auto extension = entry.path().extension();
      if (extension == ".h" || extension == ".cpp") files.push_back(fs::relative(entry.path(), kRoot));
    }
  }
  std::sort(files.begin(), files.end());
  return files;
}

// Returns the lines of a file that use an instruction set directly. Code must use Highway instead.
std::vector<std::string> raw_intrinsics(const std::string& path, const std::string& text) {
  std::vector<std::string> found;
  for (const std::string& line : lines_of(text)) {
    for (const char* mark : {"_mm_", "_mm256_", "_mm512_", "__m128", "__m256", "__m512", "__mmask", "intrin.h",
                             "arm_neon.h", "wasm_simd128.h"}) {
      if (line.find(mark) == std::string::npos) continue;
      found.push_back(path + ": " + line);
      break;
    }
  }
  return found;
}

TEST(Layers, a_planted_violation_is_found) {
  EXPECT_EQ(violations("src/normals/x.cpp", "#include \"chronormal/schemes/scheme.h\"\n").size(), 1u);
  EXPECT_EQ(violations("include/chronormal/core/x.h", "  #include \"chronormal/motion/motion.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/io/x.cpp", "#include \"workflow/x.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/schemes/x.cpp", "#include \"tests/support/reference.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/stray/x.cpp", "").size(), 1u);
  EXPECT_EQ(violations("src/normals/stray/x.cpp", "").size(), 1u);
  EXPECT_EQ(violations("src/normals/groups/x.cpp", "#include \"normals/curves/outputs.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/normals/groups/kernels/x.cpp", "#include \"normals/curves/kernels/pack.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/normals/groups/x.cpp", "#include \"chronormal/normals/mesh_normals.h\"\n").size(), 1u);
  EXPECT_EQ(
      violations("include/chronormal/normals/normal_groups.h", "#include \"chronormal/normals/normal_curves.h\"\n")
          .size(),
      1u);
  EXPECT_EQ(violations("src/io/json/x.cpp", "#include \"io/gltf/glb.h\"\n").size(), 1u);
  EXPECT_EQ(violations("cli/terminal/x.cpp", "#include \"cli/options/help.h\"\n").size(), 1u);
  EXPECT_EQ(violations("cli/reports/x.cpp", "#include \"cli/commands/compare_blend.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/io/gltf/glb/x.h", "#include \"io/gltf/edit/x.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/io/gltf/edit/x.h", "#include \"io/gltf/gltf_skin.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/io/gltf/stray/x.cpp", "").size(), 1u);
  EXPECT_EQ(violations("cli/reports/audit/x.cpp", "#include \"cli/reports/x.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/workflow/bake/judge/x.cpp", "#include \"workflow/bake/fits/x.h\"\n").size(), 1u);
  EXPECT_TRUE(violations("src/workflow/bake/judge/x.cpp", "#include \"workflow/bake/deltas/x.h\"\n").empty());
  EXPECT_TRUE(violations("src/io/gltf/x.cpp", "#include \"io/gltf/edit/x.h\"\n").empty());
  EXPECT_TRUE(violations("src/io/gltf/edit/x.cpp", "#include \"chronormal/io/gltf_edit.h\"\n").empty());
  EXPECT_TRUE(violations("cli/main.cpp", "#include \"cli/options/command.h\"\n").empty());
  EXPECT_TRUE(violations("src/schemes/x.cpp", "#include \"schemes/arc.h\"\n#include <vector>\n").empty());
  EXPECT_TRUE(violations("src/normals/curves/x.cpp", "#include \"normals/groups/corner_sets.h\"\n").empty());
}

TEST(Layers, every_file_includes_only_its_own_room_and_those_above) {
  const auto files = product_files();
  EXPECT_GT(files.size(), 40u);
  for (const fs::path& file : files) {
    if (is_umbrella(file)) continue;
    for (const std::string& violation : violations(file.string(), read(kRoot / file))) ADD_FAILURE() << violation;
  }
}

TEST(Layers, public_headers_include_only_public_headers) {
  for (const fs::path& file : product_files()) {
    if (!file.string().starts_with("include/")) continue;
    for (const std::string& line : lines_of(read(kRoot / file))) {
      const std::string included = included_by(line);
      EXPECT_TRUE(included.empty() || included.starts_with("chronormal/")) << file << " includes " << included;
    }
  }
}

// Only the library chronormal uses Highway. chronormal_io and the program are built without Highway's headers, also for
// wasm. Only src/simd/ includes these headers.
TEST(Layers, kernels_stand_in_the_library_that_has_highway) {
  std::size_t kernels = 0;
  for (const fs::path& file : product_files()) {
    const std::string path = file.string();
    const bool has_highway =
        !path.starts_with("src/io/") && !path.starts_with("src/workflow/") && !path.starts_with("cli/");
    for (const std::string& line : lines_of(read(kRoot / file))) {
      EXPECT_TRUE(path.starts_with("src/simd/") || line.find("#include <hwy/") == std::string::npos) << file << line;
      if (line.find("simd/highway-inl.h\"") == std::string::npos) continue;
      EXPECT_TRUE(has_highway) << file << " includes Highway";
      ++kernels;
    }
  }
  EXPECT_GT(kernels, 20U);
}

TEST(Layers, the_reference_includes_no_scheme_and_no_control_normals) {
  for (const char* file : {"src/analysis/quality/reference_normals.cpp", "include/chronormal/analysis/quality.h",
                           "src/analysis/quality/quality.cpp"}) {
    const std::string text = read(kRoot / file);
    EXPECT_FALSE(text.empty()) << file;
    EXPECT_EQ(text.find("/schemes/"), std::string::npos) << file;
    EXPECT_EQ(text.find("/normals/"), std::string::npos) << file;
  }
}

TEST(Layers, the_oracle_shares_no_code_with_the_product) {
  const std::string text = read(kRoot / "tests/support/reference.h");
  EXPECT_FALSE(text.empty());
  EXPECT_EQ(text.find("#include \"chronormal"), std::string::npos);
}

// Returns the headers that an umbrella header (chronormal.h or chronormal_io.h) includes.
std::vector<std::string> listed_by(const std::string& umbrella) {
  std::vector<std::string> listed;
  for (const std::string& line : lines_of(read(kRoot / "include/chronormal" / umbrella))) {
    const std::string included = included_by(line);
    if (!included.empty() && included != "chronormal/chronormal.h") listed.push_back(included);
  }
  return listed;
}

// Programs must be able to use chronormal.h with the library chronormal alone, which lacks the symbols of io and
// workflow.
TEST(Layers, the_umbrella_headers_list_every_public_header_in_the_order_of_the_layers) {
  const std::vector<std::string> core = listed_by("chronormal.h"), io = listed_by("chronormal_io.h");
  const auto is_io = [](const std::string& header) {
    return header.starts_with("chronormal/io/") || header.starts_with("chronormal/workflow/");
  };
  EXPECT_TRUE(std::none_of(core.begin(), core.end(), is_io));
  EXPECT_TRUE(std::all_of(io.begin(), io.end(), is_io));
  std::vector<std::string> listed = core;
  listed.insert(listed.end(), io.begin(), io.end());
  for (std::size_t i = 1; i < listed.size(); ++i)
    EXPECT_LE(place_of(listed[i - 1])->floor, place_of(listed[i])->floor) << listed[i];

  std::vector<std::string> there;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "include")) {
    const std::string path = fs::relative(entry.path(), kRoot / "include").string();
    if (path == "chronormal_c.h") continue;  // the header for C is in no umbrella header
    if (entry.is_regular_file() && !is_umbrella("include/" + path)) there.push_back(path);
  }
  EXPECT_LE(there.size(), 32U) << "fewer doors: merge headers that are one idea";
  std::sort(listed.begin(), listed.end());
  std::sort(there.begin(), there.end());
  EXPECT_EQ(listed, there);
}

TEST(Layers, raw_intrinsics_stand_in_two_files) {
  const std::string planted = "  __m512 v = _mm512_loadu_ps(p);\n#include <immintrin.h>\n#include <arm_neon.h>\n";
  EXPECT_EQ(raw_intrinsics("src/normals/x.cpp", planted).size(), 3u);

  const fs::path homes[] = {"src/simd/intrinsics-inl.h", "src/simd/plain_lanes.h"};
  for (const fs::path& home : homes) EXPECT_FALSE(raw_intrinsics(home.string(), read(kRoot / home)).empty()) << home;
  for (const fs::path& file : product_files()) {
    if (std::find(std::begin(homes), std::end(homes), file) != std::end(homes)) continue;
    for (const std::string& line : raw_intrinsics(file.string(), read(kRoot / file))) ADD_FAILURE() << line;
  }
}

// Returns the lines in which a private header declares names in the public namespace. Private names must be in an
// inline namespace. The compiler and the linker then keep private names and public names apart, but code of the library
// can use private names without naming the namespace.
std::vector<std::string> public_names(const std::string& path, const std::string& text) {
  std::vector<std::string> found;
  for (const std::string& line : lines_of(text)) {
    if (line.starts_with("namespace chronormal") && !line.starts_with("namespace chronormal::inline internal"))
      found.push_back(path + ": " + line);
  }
  return found;
}

TEST(Layers, private_headers_declare_internal_names) {
  EXPECT_EQ(public_names("src/normals/x.h", "namespace chronormal {\nnamespace chronormal::gltf {\n").size(), 2u);
  EXPECT_TRUE(public_names("src/normals/x.h", "namespace chronormal::inline internal::gltf {\n").empty());

  const fs::path state_of_public_class = "src/io/gltf/gltf_document_state.h";
  for (const fs::path& file : product_files()) {
    if (!file.string().starts_with("src/") || file.extension() != ".h" || file == state_of_public_class) continue;
    for (const std::string& line : public_names(file.string(), read(kRoot / file))) ADD_FAILURE() << line;
  }
}

// If the include guard of a header has the name of another header, one of the two is ignored in files that include
// both.
TEST(Layers, guards_of_headers_have_the_names_of_their_files) {
  for (const fs::path& file : product_files()) {
    if (file.extension() != ".h" || file.string().ends_with("-inl.h")) continue;
    const fs::path inside = file.lexically_relative(file.string().starts_with("include/") ? "include" : ".");
    std::string guard =
        inside.string().starts_with("src/") ? "chronormal/" + inside.string().substr(4) : inside.string();
    for (char& letter : guard)
      letter = letter == '/' || letter == '.' || letter == '-' ? '_' : static_cast<char>(std::toupper(letter));
    EXPECT_NE(read(kRoot / file).find("#ifndef " + guard + "_\n"), std::string::npos) << file << ": " << guard << '_';
  }
}

// A file should hold one idea, so it may be neither too short nor too long.
TEST(Layers, files_hold_one_idea) {
  for (const fs::path& file : product_files()) {
    const std::size_t limit = file.string().starts_with("include/") ? 400 : 1200;
    EXPECT_LE(lines_of(read(kRoot / file)).size(), limit) << file;
  }
}

// Several test files are compiled as one source (CHRONORMAL_UNITY), so each test file needs its own namespace.
TEST(Layers, every_test_file_has_a_namespace_of_its_own) {
  std::size_t count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "tests")) {
    if (!entry.path().filename().string().ends_with("_test.cpp")) continue;
    ++count;
    const std::string own = "namespace chronormal::" + entry.path().stem().string() + " {\n";
    EXPECT_NE(read(entry.path()).find(own), std::string::npos) << entry.path() << " lacks " << own;
  }
  EXPECT_GT(count, 90u);
}

}  // namespace
}  // namespace chronormal::layers_test
