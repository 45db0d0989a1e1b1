// Follows symbolic links and identifies files, in the same way on all systems.
#include "io/system/files.h"

#include <system_error>

#include "io/system/names.h"

namespace chronormal::inline internal {

std::string follow_links(const std::string& path) {
  constexpr int kLongestChain = 40;
  std::filesystem::path target = path_of(path);
  for (int i = 0; i < kLongestChain; ++i) {
    std::error_code error;
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) break;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return utf8_of(target);
}

std::optional<FileKey> key_of_file(const std::string& path) {
  if (const auto status = path == "-" ? status_of(kStandardOutput) : status_of(path)) {
    if (!status->is_file()) return std::nullopt;
    return FileKey{status->volume, status->number, ""};
  }
  if (path == "-") return std::nullopt;
  const std::string target = follow_links(path), folder = folder_of(target);
  const auto status = status_of(folder.empty() ? "." : folder);
  if (!status) return std::nullopt;
  return FileKey{status->volume, status->number, file_name(target)};
}

}  // namespace chronormal::inline internal
