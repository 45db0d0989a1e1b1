/// Converts names of files between UTF-8, which this project uses for all text, and the form that the system needs.
/// Private to io, workflow and the program.
#ifndef CHRONORMAL_IO_SYSTEM_NAMES_H_
#define CHRONORMAL_IO_SYSTEM_NAMES_H_

#include <cstddef>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>

namespace chronormal::inline internal {

/// Convert a name to a path, and a path to a name. No other file calls std::filesystem::path(name) or path.string(),
/// because these use the code page of Windows and not UTF-8. On POSIX systems, bytes that are not UTF-8 stay as they
/// are.
[[nodiscard]] std::filesystem::path path_of(std::string_view name);
[[nodiscard]] std::string utf8_of(const std::filesystem::path& path);

/// Return the file name at the end of a path, or the folder before it. Either may be empty.
[[nodiscard]] inline std::string file_name(std::string_view path) { return utf8_of(path_of(path).filename()); }
[[nodiscard]] inline std::string folder_of(std::string_view path) { return utf8_of(path_of(path).parent_path()); }

/// Returns true if the system uses a character to separate the folders of a path.
[[nodiscard]] constexpr bool is_separator(char c) noexcept {
#ifdef _WIN32
  return c == '/' || c == '\\';
#else
  return c == '/';
#endif
}

/// Returns the offset at which the file name begins in a path, which is behind the last separator.
[[nodiscard]] constexpr std::size_t begin_of_name(std::string_view path) noexcept {
  std::size_t begin = path.size();
  while (begin > 0 && !is_separator(path[begin - 1])) --begin;
  return begin;
}

/// Returns the arguments of the program in UTF-8, from the arguments of main(). The arguments are valid as long as the
/// program runs.
[[nodiscard]] std::span<char*> arguments_of_program(int count, char** arguments);

/// Returns the path of the program's own file, or nothing if the system does not know it.
[[nodiscard]] std::optional<std::string> file_of_program();

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_SYSTEM_NAMES_H_
