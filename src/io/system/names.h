/// Names of files. All text of this project is UTF-8, names too; a system that has them in another form gets and gives
/// that here. Private to io, workflow and the program.
#ifndef CHRONORMAL_IO_SYSTEM_NAMES_H_
#define CHRONORMAL_IO_SYSTEM_NAMES_H_

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Converts a name to a path, and back. std::filesystem::path(name) and path.string() would take names for those of the
/// code page of Windows, so no other file calls them. Bytes that are not UTF-8 stay as they are on POSIX systems.
[[nodiscard]] std::filesystem::path path_of(std::string_view name);
[[nodiscard]] std::string utf8_of(const std::filesystem::path& path);

/// Returns the file name at the end of a path, and the folder before it; either may be empty.
[[nodiscard]] inline std::string file_name(std::string_view path) { return utf8_of(path_of(path).filename()); }
[[nodiscard]] inline std::string folder_of(std::string_view path) { return utf8_of(path_of(path).parent_path()); }

/// Tells whether a character stands between the folders of a path.
[[nodiscard]] constexpr bool is_separator(char c) noexcept {
#ifdef _WIN32
  return c == '/' || c == '\\';
#else
  return c == '/';
#endif
}

/// Returns where the file name begins in a path: behind the last separator.
[[nodiscard]] constexpr std::size_t begin_of_name(std::string_view path) noexcept {
  std::size_t begin = path.size();
  while (begin > 0 && !is_separator(path[begin - 1])) --begin;
  return begin;
}

/// Returns the arguments of the program, in UTF-8, from those that main() got. They live as long as the program.
[[nodiscard]] std::span<char*> arguments_of_program(int count, char** arguments);

/// Returns the file of the program, or nothing if the system does not tell it.
[[nodiscard]] std::optional<std::string> file_of_program();

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_SYSTEM_NAMES_H_
