// Finds the files of an input, and gets their sizes and times from the system.
#include "io/input/input_identity.h"

#include <sys/stat.h>

#include <cerrno>
#include <filesystem>
#include <system_error>

#include "io/bytes/descriptor.h"
#include "io/input/sequence.h"

namespace chronormal::inline internal {
namespace {

// Returns the file of a cache that is named with its channel, "cache.mcx#shape".
std::string without_channel(const std::string& input) {
  const std::size_t hash = input.rfind('#');
  std::error_code ignored;
  return hash == std::string::npos || std::filesystem::exists(input, ignored) ? input : input.substr(0, hash);
}

}  // namespace

std::string FileIdentity::text() const {
  constexpr std::int64_t kBillion = 1000000000;
  const std::string part = std::to_string(kBillion + changed % kBillion).substr(1);
  return std::to_string(size) + " bytes, changed at " + std::to_string(changed / kBillion) + "." + part + " s";
}

Result<std::vector<FileIdentity>> identify_files(const InputOptions& options) {
  InputOptions of_files = options;
  for (std::string& input : of_files.files) input = without_channel(input);
  const Result<std::vector<std::string>> paths = find_frames(of_files);
  if (!paths) return paths.error();
  std::vector<FileIdentity> files;
  for (const std::string& path : paths.value()) {
    struct stat status {};
    if (path == "-")
      return Error{ErrorCode::kUsage, path, "the standard input cannot be read again by a later run; name a file"};
    if (::stat(path.c_str(), &status) != 0) return failure(path, errno);
    if (!S_ISREG(status.st_mode))
      return Error{ErrorCode::kUsage, path, "a pipe or a device cannot be read again by a later run; name a file"};
    if (path.ends_with(".xml"))
      return Error{ErrorCode::kUsage, path,
                   "changes of the other files of this cache would not be noticed; name the .mcx or .mc file"};
    files.push_back({path, static_cast<std::uint64_t>(status.st_size),
                     std::int64_t{status.st_mtim.tv_sec} * 1000000000 + status.st_mtim.tv_nsec});
  }
  return files;
}

}  // namespace chronormal::inline internal
