#include "io/bytes/same_file.h"

#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <system_error>

namespace chronormal::inline internal {
std::string follow_links(const std::string& path) {
  constexpr int kLongestChain = 40;
  std::filesystem::path target = path;
  for (int i = 0; i < kLongestChain; ++i) {
    std::error_code error;
    const std::filesystem::path next = std::filesystem::read_symlink(target, error);
    if (error) break;
    target = next.is_absolute() ? next : target.parent_path() / next;
  }
  return target.string();
}

std::optional<FileKey> key_of_file(const std::string& path) {
  struct stat status {};
  if (path == "-" ? ::fstat(STDOUT_FILENO, &status) == 0 : ::stat(path.c_str(), &status) == 0) {
    if (!S_ISREG(status.st_mode)) return std::nullopt;
    return FileKey{status.st_dev, status.st_ino, ""};
  }
  const std::filesystem::path target = follow_links(path);
  const std::string folder = target.has_parent_path() ? target.parent_path().string() : ".";
  if (path == "-" || ::stat(folder.c_str(), &status) != 0) return std::nullopt;
  return FileKey{status.st_dev, status.st_ino, target.filename().string()};
}

}  // namespace chronormal::inline internal
