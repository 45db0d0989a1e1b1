// The folder is the layer: a file includes only its own folder and those above it in the list. Checked by the path.

#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <vector>

namespace {

namespace fs = std::filesystem;

const std::vector<std::string> kLayers = {"core", "motion", "normals", "schemes", "analysis", "io", "workflow", "cli"};

const fs::path kRoot = CHRONORMAL_SOURCE_DIR;

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

// The layer of a path below the root, "" for one outside: include/chronormal/LAYER/..., src/LAYER/..., cli/...
std::string layer_of(std::string path) {
  for (const std::string prefix : {"include/chronormal/", "src/", "chronormal/"}) {
    if (path.starts_with(prefix)) {
      path.erase(0, prefix.size());
      break;
    }
  }
  const std::size_t slash = path.find('/');
  return slash == std::string::npos ? "" : path.substr(0, slash);
}

// What a line includes in quotes, "" if it does not.
std::string included_by(const std::string& line) {
  const std::size_t hash = line.find_first_not_of(" \t");
  if (hash == std::string::npos || line[hash] != '#' || line.find("include", hash) == std::string::npos) return "";
  const std::size_t first = line.find('"');
  const std::size_t last = line.find('"', first + 1);
  return last == std::string::npos ? "" : line.substr(first + 1, last - first - 1);
}

std::optional<std::size_t> rank_of(const std::string& layer) {
  const auto found = std::find(kLayers.begin(), kLayers.end(), layer);
  if (found == kLayers.end()) return std::nullopt;
  return static_cast<std::size_t>(found - kLayers.begin());
}

// What is wrong with the includes of one file; empty if nothing is.
std::vector<std::string> violations(const std::string& path, const std::string& text) {
  std::vector<std::string> found;
  const auto own = rank_of(layer_of(path));
  if (!own) return {path + ": the folder is no layer"};
  for (const std::string& line : lines_of(text)) {
    const std::string included = included_by(line);
    if (included.empty()) continue;
    const auto other = rank_of(layer_of(included));
    if (!other)
      found.push_back(path + " includes " + included + ", which is in no layer");
    else if (*other > *own)
      found.push_back(path + " includes " + included + ", from a layer below it");
  }
  return found;
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

TEST(Layers, a_planted_violation_is_found) {
  EXPECT_EQ(violations("src/normals/x.cpp", "#include \"chronormal/schemes/scheme.h\"\n").size(), 1u);
  EXPECT_EQ(violations("include/chronormal/core/x.h", "  #include \"chronormal/motion/motion.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/io/x.cpp", "#include \"workflow/x.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/schemes/x.cpp", "#include \"tests/support/reference.h\"\n").size(), 1u);
  EXPECT_EQ(violations("src/stray/x.cpp", "").size(), 1u);
  EXPECT_TRUE(violations("src/schemes/x.cpp", "#include \"schemes/arc.h\"\n#include <vector>\n").empty());
}

TEST(Layers, every_file_includes_only_its_own_folder_and_those_above) {
  const auto files = product_files();
  EXPECT_GT(files.size(), 40u);
  for (const fs::path& file : files) {
    if (file == "include/chronormal/chronormal.h") continue;
    for (const std::string& violation : violations(file.string(), read(kRoot / file))) ADD_FAILURE() << violation;
  }
}

TEST(Layers, the_reference_includes_no_scheme_and_no_control_normals) {
  for (const char* file : {"include/chronormal/analysis/reference_normals.h", "src/analysis/reference_normals.cpp",
                           "include/chronormal/analysis/quality.h", "src/analysis/quality.cpp"}) {
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

TEST(Layers, the_umbrella_header_lists_every_public_header_in_the_order_of_the_layers) {
  std::vector<std::string> listed;
  for (const std::string& line : lines_of(read(kRoot / "include/chronormal/chronormal.h"))) {
    if (const std::string included = included_by(line); !included.empty()) listed.push_back(included);
  }
  for (std::size_t i = 1; i < listed.size(); ++i)
    EXPECT_LE(*rank_of(layer_of(listed[i - 1])), *rank_of(layer_of(listed[i]))) << listed[i];

  std::vector<std::string> there;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "include")) {
    const std::string path = fs::relative(entry.path(), kRoot / "include").string();
    if (entry.is_regular_file() && path != "chronormal/chronormal.h") there.push_back(path);
  }
  std::sort(listed.begin(), listed.end());
  std::sort(there.begin(), there.end());
  EXPECT_EQ(listed, there);
}

TEST(Layers, files_can_be_seen_at_a_glance) {
  for (const fs::path& file : product_files()) {
    const std::size_t limit = file.string().starts_with("include/") ? 250 : 500;
    EXPECT_LE(lines_of(read(kRoot / file)).size(), limit) << file;
  }
}

}  // namespace
