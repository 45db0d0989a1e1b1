// Executes the documents: runs every command in them, and compares the output with the document.
//
// A block ```console holds commands ("$ ./run ...") with their output; "..." alone on a line stands for any lines. A
// command that prints measured times uses --no-times, or its output is not shown. The output "?" is a placeholder that
// an update fills in. A block ```cpp or ```js under a line <!-- examples/NAME.cpp --> must be a copy of that file,
// which the tests run.
//
// If CHRONORMAL_UPDATE_DOCS=1, the blocks are rewritten instead (tools/update_docs).

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <tuple>
#include <vector>

#include "tests/support/cache_bytes.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/places.h"
#include "tests/support/process.h"
#include "tests/support/shaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::docs_test {
namespace {

namespace fs = std::filesystem;
using Lines = std::vector<std::string>;

const fs::path kRoot = kSourceFolder;

Lines lines_of(const std::string& text) {
  Lines lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

std::string read(const fs::path& path) {
  std::ostringstream text;
  text << std::ifstream(path, std::ios::binary).rdbuf();
  return text.str();
}

// Returns a document without its blocks of code, since "](" does not begin a link in code.
std::string without_code(const std::string& text) {
  std::string prose;
  bool inside_code = false;
  for (const std::string& line : lines_of(text)) {
    if (line.starts_with("```")) inside_code = !inside_code;
    if (!inside_code) prose += line + '\n';
  }
  return prose;
}

std::vector<fs::path> documents() {
  std::vector<fs::path> paths = {kRoot / "README.md", kRoot / "CONTRIBUTING.md"};
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "docs")) {
    if (entry.path().extension() == ".md") paths.push_back(entry.path());
  }
  std::sort(paths.begin(), paths.end());
  return paths;
}

bool updating() {
  const char* value = std::getenv("CHRONORMAL_UPDATE_DOCS");
  return value != nullptr && std::string(value) == "1";
}

std::string replaced(std::string text, const std::string& what, const std::string& with) {
  for (std::size_t at = 0; (at = text.find(what, at)) != std::string::npos; at += with.size())
    text.replace(at, what.size(), with);
  return text;
}

// Runs a command in the folder of the document, with the program and the examples that were built together with this
// test. Tables may have up to 128 columns, the width of a page.
ProcessResult run_documented(std::string command, const fs::path& folder) {
  command = replaced(command, "build/release", kBuildFolder);
  // If npm has not built the page of reports, a placeholder replaces it: the content of the page does not matter here.
  if (command.starts_with("./run report ") && command.find(".html") != std::string::npos) {
    std::ofstream(folder / "page.html") << "<!--chronormal-data-->";
    command += " --template page.html";
  }
  command = replaced(command, "./run ", std::string(kProgram) + " ");
  return run_shell("export COLUMNS=128; { " + command + "\n} 2>&1", folder.string());
}

// Returns the part of a line between the texts `before` and `after`, or "".
std::string between(const std::string& line, const std::string& before, const std::string& after) {
  const std::size_t first = line.find(before);
  if (first == std::string::npos) return "";
  const std::size_t last = line.find(after, first + before.size());
  return last == std::string::npos ? "" : line.substr(first + before.size(), last - first - before.size());
}

bool matches(const Lines& pattern, std::size_t p, const Lines& lines, std::size_t l) {
  if (p == pattern.size()) return l == lines.size();
  if (pattern[p] == "...") {
    for (std::size_t skip = l; skip <= lines.size(); ++skip) {
      if (matches(pattern, p + 1, lines, skip)) return true;
    }
    return false;
  }
  return l < lines.size() && pattern[p] == lines[l] && matches(pattern, p + 1, lines, l + 1);
}

std::string joined(const Lines& lines) {
  std::string text;
  for (const std::string& line : lines) text += line + '\n';
  return text;
}

// Checks the lines of one console block. Returns the block with the current output of its commands.
Lines check_console(const Lines& block, const fs::path& folder, const std::string& where) {
  Lines renewed;
  for (std::size_t i = 0; i < block.size();) {
    if (!block[i].starts_with("$ ")) {
      ADD_FAILURE() << where << ": a console block begins with '$ ': " << block[i];
      return block;
    }
    std::string command = block[i].substr(2);
    renewed.push_back(block[i++]);
    while (command.ends_with('\\') && i < block.size()) {
      command = command.substr(0, command.size() - 1) + block[i];
      renewed.push_back(block[i++]);
    }
    Lines shown;
    while (i < block.size() && !block[i].starts_with("$ ")) shown.push_back(block[i++]);

    const ProcessResult result = run_documented(command, folder);
    const Lines actual = lines_of(result.out);
    // A document may show a command that fails, but only together with its message.
    if (shown.empty()) {
      EXPECT_EQ(result.exit_code, 0) << where << ": " << command << "\n" << result.out;
    }
    const bool current = shown.empty() || matches(shown, 0, actual, 0);
    const bool has_gap = std::find(shown.begin(), shown.end(), "...") != shown.end();
    if (updating() && !has_gap && !shown.empty()) {
      shown = actual;
    } else {
      EXPECT_TRUE(current) << where << ": " << command << "\nprints\n"
                           << result.out << "but the document shows\n"
                           << joined(shown);
    }
    renewed.insert(renewed.end(), shown.begin(), shown.end());
  }
  return renewed;
}

// Makes one test for each document, so that documents can be tested in parallel. The name of a test is the path of its
// document in the repository.
class Commands : public testing::TestWithParam<std::string> {};

std::vector<std::string> documents_with_commands() {
  std::vector<std::string> names;
  for (const fs::path& path : documents()) {
    if (read(path).find("```console\n") != std::string::npos) names.push_back(fs::relative(path, kRoot).string());
  }
  return names;
}

TEST_P(Commands, run_and_print_what_is_shown) {
  const fs::path path = kRoot / GetParam();
  const test::TemporaryFolder folder;
  const Lines lines = lines_of(read(path));
  Lines renewed;
  for (std::size_t i = 0; i < lines.size();) {
    renewed.push_back(lines[i]);
    if (lines[i++] != "```console") continue;
    const std::string where = GetParam() + ":" + std::to_string(i);
    Lines block;
    while (i < lines.size() && lines[i] != "```") block.push_back(lines[i++]);
    const Lines checked = check_console(block, folder.path(), where);
    renewed.insert(renewed.end(), checked.begin(), checked.end());
  }
  if (updating() && renewed != lines) std::ofstream(path, std::ios::binary) << joined(renewed);
}

INSTANTIATE_TEST_SUITE_P(Documents, Commands, testing::ValuesIn(documents_with_commands()), [](const auto& tested) {
  std::string name = fs::path(tested.param).replace_extension().string();
  std::replace(name.begin(), name.end(), '/', '_');
  return name;
});

// Writes small files with the names that the indented commands of README.md and of the pages use.
void write_files_of_commands(const test::TemporaryFolder& folder) {
  const std::string faces = "f 1 2 3\nf 1 3 4\n";
  const std::string still = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n" + faces;
  const std::string moved = "v 0 0 0\nv 1 0 0\nv 1 1 1\nv 0 1 0.5\n" + faces;
  for (const char* const name : {"frames", "walk", "run", "targets", "models"}) fs::create_directory(folder / name);
  for (const char* const name : {"frames/1.obj", "frames/3.obj", "walk/1.obj", "run/1.obj", "start.obj", "face.obj"})
    folder.write(name, still);
  for (const char* const name : {"frames/2.obj", "walk/2.obj", "run/2.obj", "end.obj", "targets/smile.obj"})
    folder.write(name, moved);
  folder.write("body.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  folder.write("walk.pc2", test::small_pc2(0, 1));
  test::GltfBuilder face = test::random_sheet(1, 5, 2, 0.2).file();
  face.add_track<float>(face.add_animation("smile"), 0, {0, 1}, {1, 0, 0, 1});
  for (const char* const name : {"face.glb", "intro.glb", "models/head.glb"}) folder.write(name, face.glb());
}

// Runs the indented commands of a page. The page does not show their output, which depends on the files of the reader.
void run_indented_commands(const std::string& page, std::size_t at_least) {
  const test::TemporaryFolder folder;
  write_files_of_commands(folder);
  std::size_t commands = 0;
  for (const std::string& line : lines_of(read(kRoot / page))) {
    if (!line.starts_with("    ./run ")) continue;
    ++commands;
    const std::string command = line.substr(4, line.find(" # ") - 4);
    const ProcessResult result = run_documented(command, folder.path());
    EXPECT_EQ(result.exit_code, 0) << page << ": " << command << "\n" << result.out;
  }
  EXPECT_GE(commands, at_least) << page;
}

TEST(Documents, every_indented_command_of_README_runs) { run_indented_commands("README.md", 4); }

TEST(Documents, every_indented_command_of_the_command_line_runs) { run_indented_commands("docs/cli.md", 14); }

TEST(Documents, every_indented_command_for_artists_runs) { run_indented_commands("docs/artists.md", 4); }

TEST(Documents, every_indented_command_for_simulation_runs) { run_indented_commands("docs/simulation.md", 5); }

// Compares the table rows about human faces in docs/cpp.md with the output of `compare --blend`.
class RealFaces : public testing::TestWithParam<std::tuple<const char*, const char*, std::size_t>> {};

TEST_P(RealFaces, have_the_rows_that_the_page_shows) {
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
  const auto& [name, files, mesh] = GetParam();
  const ProcessResult result = run_shell(std::string(kProgram) + " compare " + files + " --blend 1000 --json", data);
  ASSERT_EQ(result.exit_code, 0) << result.err;
  Lines expected;
  const nlohmann::json json = nlohmann::json::parse(result.out);
  for (const auto& one : json["meshes"]) {
    if (one.contains("mesh") && one["mesh"] != mesh) continue;
    for (const auto& errors : one["errors"]) {
      std::map<std::string, std::string> cell = {{"file", "-"}};
      for (const auto& deltas : errors["deltas"]) {
        char text[64];
        const bool exact = deltas["deltas"] == "exact";
        std::snprintf(text, sizeof text, exact ? "%.0e / %.0e" : "%.2f / %.1f", deltas["mean_degrees"].get<double>(),
                      deltas["max_degrees"].get<double>());
        cell[deltas["deltas"]] = text;
      }
      expected.push_back("|" + std::to_string(errors["active"].get<int>()) + "|" + cell["file"] + "|" +
                         cell["end point"] + "|" + cell["least squares"] + "|" + cell["exact"] + "|");
    }
  }
  // On the page, cells have no trailing blanks, and only the first row of a group shows the name of the group.
  Lines shown;
  std::string last;
  for (const std::string& line : lines_of(read(kRoot / "docs/cpp.md"))) {
    if (!line.starts_with("| ")) continue;
    std::string row = line;
    while (row.find("  ") != std::string::npos) row = replaced(row, "  ", " ");
    row = replaced(replaced(row, "| ", "|"), " |", "|");
    const std::size_t end = row.find('|', 1);
    if (end > 1) last = row.substr(1, end - 1);
    const std::size_t digits = row.find_first_not_of("0123456789", end + 1);
    if (last == name && digits != end + 1 && std::count(row.begin(), row.end(), '/') >= 3)
      shown.push_back(row.substr(end));
  }
  EXPECT_EQ(shown, expected);
}

INSTANTIATE_TEST_SUITE_P(Documents, RealFaces,
                         testing::Values(std::tuple{"face", "--base face_mpfb2/base.obj face_mpfb2/targets/", 0},
                                         std::tuple{"RobotExpressive", "gltf/RobotExpressive/RobotExpressive.glb", 5}),
                         [](const auto& tested) { return std::string(std::get<0>(tested.param)); });

TEST(Documents, with_commands_are_found) { EXPECT_GE(documents_with_commands().size(), 5u); }

TEST(Documents, quoted_code_is_the_example_that_is_built_and_run) {
  std::map<std::string, int> quotes;  // number of quoted files by language
  for (const fs::path& path : documents()) {
    const Lines lines = lines_of(read(path));
    for (std::size_t i = 0; i < lines.size(); ++i) {
      const std::string example = i == 0 ? "" : between(lines[i - 1], "<!-- ", " -->");
      const std::string language = lines[i].starts_with("```") ? lines[i].substr(3) : "";
      // A block in C or Python may quote only a part of an example, which other tests run.
      const bool may_be_a_part = language == "c" || language == "python";
      if (language != "cpp" && language != "js" && !(may_be_a_part && example.starts_with("examples/"))) continue;
      EXPECT_TRUE(example.starts_with("examples/"))
          << path << ":" << i + 1 << ": code without <!-- examples/NAME --> above it";
      ++quotes[language];
      Lines block;
      while (++i < lines.size() && lines[i] != "```") block.push_back(lines[i]);
      EXPECT_EQ(joined(block), read(kRoot / example)) << path;
    }
  }
  for (const char* const language : {"cpp", "js", "c", "python"}) EXPECT_GT(quotes[language], 0) << language;
}

// Returns the anchors of a document's headings, as GitHub and the site make them: letters, digits and dashes.
std::set<std::string> anchors_of(const fs::path& path) {
  std::set<std::string> anchors;
  for (const std::string& line : lines_of(without_code(read(path)))) {
    const std::size_t level = line.find_first_not_of('#');
    if (level == 0 || level == std::string::npos || line[level] != ' ') continue;
    std::string anchor;
    for (const char c : line.substr(level + 1)) {
      const auto byte = static_cast<unsigned char>(c);
      if (c == ' ') anchor += '-';
      if (std::isalnum(byte) || c == '-' || c == '_' || byte >= 0x80) anchor += static_cast<char>(std::tolower(byte));
    }
    anchors.insert(anchor);
  }
  return anchors;
}

TEST(Documents, links_lead_to_files_and_headings) {
  int links = 0, anchors = 0;
  for (const fs::path& path : documents()) {
    const std::string text = without_code(read(path));
    for (std::size_t at = 0; (at = text.find("](", at)) != std::string::npos; at += 2) {
      const std::string link = between(text.substr(at), "](", ")");
      if (link.empty() || link.find("://") != std::string::npos) continue;
      const std::size_t hash = link.find('#');
      const std::string name = link.substr(0, hash);
      const fs::path target = name.empty() ? path : path.parent_path() / name;
      ++links;
      EXPECT_TRUE(fs::exists(target)) << path << " links to " << link;
      if (hash == std::string::npos || target.extension() != ".md") continue;
      ++anchors;
      EXPECT_TRUE(anchors_of(target).contains(link.substr(hash + 1))) << path << " links to " << link;
    }
  }
  EXPECT_GT(links, 5);
  EXPECT_GT(anchors, 5);
}

// Comments, messages and help texts mention pages, some with a heading or a section of docs/theory.md. All mentioned
// pages, headings and sections must exist.
TEST(Documents, that_sources_name_are_there) {
  static const std::regex kPage("docs/[a-z][a-z-]*[.]md(#[a-z0-9-]+)?(, section ([0-9]+))?");
  const std::string theory = read(kRoot / "docs/theory.md");
  int pages = 0, sections = 0;
  for (const char* const folder :
       {"blender", "capi", "cli", "examples", "include", "src", "tests", "tools", "vtk", "js", "python", "web"}) {
    for (auto entry = fs::recursive_directory_iterator(kRoot / folder); entry != fs::end(entry); ++entry) {
      if (entry->path().filename() == "node_modules" || entry->path().filename() == "build")
        entry.disable_recursion_pending();
      if (!entry->is_regular_file() || entry->path() == kRoot / "tests/docs/docs_test.cpp") continue;
      const std::string text = read(entry->path());
      if (text.find("docs/") == std::string::npos) continue;
      for (std::sregex_iterator match(text.begin(), text.end(), kPage), end; match != end; ++match) {
        const std::string page = match->str().substr(0, match->str().find_first_of("#,"));
        ++pages;
        ASSERT_TRUE(fs::exists(kRoot / page)) << entry->path() << " names " << page;
        if ((*match)[1].matched) {
          EXPECT_TRUE(anchors_of(kRoot / page).contains((*match)[1].str().substr(1)))
              << entry->path() << " names " << match->str();
        }
        if (!(*match)[3].matched || page != "docs/theory.md") continue;
        ++sections;
        EXPECT_NE(theory.find("\n## " + (*match)[3].str() + " "), std::string::npos)
            << entry->path() << " names " << match->str();
      }
    }
  }
  EXPECT_GT(pages, 50);
  EXPECT_GT(sections, 10);
}

TEST(Documents, the_changelog_and_the_citation_know_the_version) {
  EXPECT_NE(read(kRoot / "CHANGELOG.md").find(std::string("## ") + kVersion), std::string::npos);
  EXPECT_NE(read(kRoot / "CITATION.cff").find(std::string("\nversion: ") + kVersion + '\n'), std::string::npos);
}

}  // namespace
}  // namespace chronormal::docs_test
