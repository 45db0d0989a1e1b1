// Tests that only src/io/system/ calls the operating system. On Linux, the compiler does not complain about POSIX names
// elsewhere, so this test searches the text of the files for such names.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/places.h"

namespace chronormal::system_room_test {
namespace {

namespace fs = std::filesystem;

const std::string kRoom = "src/io/system/";

// Files of the core that may call Linux and POSIX threads directly, inside #if blocks. The core cannot include
// src/io/system/.
const std::array<std::string, 2> kCore = {"src/core/memory.cpp", "src/core/parallel.cpp"};

constexpr std::string_view kHeaders[] = {"unistd.h",   "fcntl.h",   "glob.h",    "poll.h",    "dirent.h", "termios.h",
                                         "sched.h",    "pthread.h", "dlfcn.h",   "pwd.h",     "io.h",     "malloc.h",
                                         "langinfo.h", "direct.h",  "process.h", "windows.h", "sys/"};

// Names that only src/io/system/ may use: names of POSIX, some of which are macros on macOS; functions of the standard
// library that read the name of a file in the code page of Windows; and functions that libc++ has only in part
// (core/charconv.h).
constexpr std::string_view kWords[] = {
    "STDIN_FILENO", "STDOUT_FILENO", "STDERR_FILENO", "ssize_t",        "off_t",         "mode_t",
    "pid_t",        "dev_t",         "ino_t",         "timespec",       "pollfd",        "winsize",
    "st_mode",      "st_size",       "st_mtim",       "st_ino",         "st_dev",        "st_nlink",
    "S_ISREG",      "S_ISDIR",       "O_RDONLY",      "O_WRONLY",       "O_RDWR",        "O_CREAT",
    "SIGHUP",       "SIGQUIT",       "SIGBUS",        "SIGPIPE",        "SIGXFSZ",       "SIGXCPU",
    "isatty",       "sigfillset",    "strdup",        "std::ifstream",  "std::ofstream", "std::fopen",
    "fopen",        "std::rename",   "std::to_chars", "std::from_chars"};

// Text that only the files of src/io/system/ may contain: paths of Linux, and conversions between paths and text.
constexpr std::string_view kParts[] = {"\"/proc/",
                                       "\"/sys/",
                                       "filesystem::path(",
                                       "fs::path(",
                                       "path().string()",
                                       "path.string()",
                                       "filename().string()",
                                       "stem().string()",
                                       "extension().string()"};

bool is_letter(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

bool has_word(std::string_view line, std::string_view word) {
  for (std::size_t at = 0; (at = line.find(word, at)) != std::string_view::npos; ++at) {
    const std::size_t end = at + word.size();
    if ((at == 0 || (!is_letter(line[at - 1]) && line[at - 1] != ':')) && (end == line.size() || !is_letter(line[end])))
      return true;
  }
  return false;
}

// Tells whether a line calls a function of the global namespace, such as "::open(". Functions of zlib are permitted.
bool calls_global(std::string_view line) {
  for (std::size_t at = 0; (at = line.find("::", at)) != std::string_view::npos; at += 2) {
    if (at > 0 && (is_letter(line[at - 1]) || line[at - 1] == '>')) continue;
    if (line.substr(0, at).ends_with("decltype(f)")) continue;
    std::size_t end = at + 2;
    while (end < line.size() && is_letter(line[end])) ++end;
    const std::string_view name = line.substr(at + 2, end - at - 2);
    if (end < line.size() && line[end] == '(' && !name.empty() && !name.starts_with("inflate") &&
        !name.starts_with("crc32"))
      return true;
  }
  return false;
}

bool includes_system(std::string_view line) {
  constexpr std::string_view kInclude = "#include <";
  return line.starts_with(kInclude) &&
         std::any_of(std::begin(kHeaders), std::end(kHeaders),
                     [&](std::string_view header) { return line.substr(kInclude.size()).starts_with(header); });
}

// Returns the lines of a file that use what only src/io/system/ may use. Ignores comments.
std::vector<std::string> refused(const std::string& path, const std::string& text) {
  const bool is_core = std::find(kCore.begin(), kCore.end(), path) != kCore.end();
  std::vector<std::string> found;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::string code = line.substr(0, line.find("//"));
    // fs::path() makes an empty path and converts no text, so this call is permitted everywhere.
    for (std::size_t at = 0; (at = code.find("fs::path()")) != std::string::npos;) code.erase(at, 10);
    const bool has =
        std::any_of(std::begin(kWords), std::end(kWords), [&](auto word) { return has_word(code, word); }) ||
        std::any_of(std::begin(kParts), std::end(kParts),
                    [&](auto part) { return code.find(part) != std::string::npos; });
    if (has || (!is_core && (includes_system(code) || calls_global(code)))) found.push_back(path + ": " + line);
  }
  return found;
}

TEST(SystemRoom, planted_names_are_found) {
  for (const char* line :
       {"#include <unistd.h>", "#include <sys/stat.h>", "  if (::fstat(file, &status) != 0) {",
        "  (void)sigfillset(&action.sa_mask);", "  write(STDOUT_FILENO, text);", "  const off_t end = 0;",
        "  status.st_mtim.tv_sec", "  read(\"/proc/self/exe\");", "  const fs::path a = fs::path(name);",
        "  return path.filename().string();", "  std::ifstream file(name);", "  install(SIGPIPE, ignore);",
        "  const auto [end, code] = std::from_chars(a, b, number);"})
    EXPECT_EQ(refused("src/io/bytes/x.cpp", line).size(), 1U) << line;
  for (const char* line :
       {"// as ::fstat() has it", "  const int code = ::inflate(&stream, 0);", "  fs::path found = fs::path();",
        "  gltf::read(bytes);", "  path_of(name)", "  static_cast<z_off_t>(size)"})
    EXPECT_TRUE(refused("src/io/bytes/x.cpp", line).empty()) << line;
  EXPECT_TRUE(refused("src/core/memory.cpp", "#include <sys/mman.h>").empty());
}

TEST(SystemRoom, only_it_calls_the_operating_system) {
  std::size_t count = 0, own = 0;
  for (const char* folder : {"include", "src", "cli", "capi"}) {
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(kSourceFolder) / folder)) {
      const std::string path = fs::relative(entry.path(), kSourceFolder).string();
      if (!path.ends_with(".h") && !path.ends_with(".cpp")) continue;
      std::ifstream file(entry.path(), std::ios::binary);
      const std::string text((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
      const std::vector<std::string> lines = refused(path, text);
      ++count;
      if (path.starts_with(kRoom) || path == "src/core/charconv.h") {
        own += lines.size();
        continue;
      }
      for (const std::string& line : lines) ADD_FAILURE() << line;
    }
  }
  EXPECT_GT(count, 300U);
  EXPECT_GT(own, 50U) << "the room is empty";
}

}  // namespace
}  // namespace chronormal::system_room_test
