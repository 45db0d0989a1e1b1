// Finds the files of an input, and asks the system for their sizes and times.
#include "io/input/input_identity.h"

#include <cerrno>
#include <filesystem>
#include <optional>
#include <system_error>

#include "io/input/sequence.h"
#include "io/system/files.h"
#include "io/system/names.h"

namespace chronormal::inline internal {
namespace {

// Removes the channel from the name of a cache: "cache.mcx" for "cache.mcx#shape".
std::string without_channel(const std::string& input) {
  const std::size_t hash = input.rfind('#');
  std::error_code ignored;
  return hash == std::string::npos || std::filesystem::exists(path_of(input), ignored) ? input : input.substr(0, hash);
}

}  // namespace

std::string FileIdentity::text() const {
  constexpr std::int64_t kBillion = 1000000000;
  const std::string part = std::to_string(kBillion + changed % kBillion).substr(1);
  return std::to_string(size) + (size == 1 ? " byte" : " bytes") + ", changed at " +
         std::to_string(changed / kBillion) + "." + part + " s";
}

Result<std::vector<FileIdentity>> identify_files(const InputOptions& options) {
  InputOptions of_files = options;
  for (std::string& input : of_files.files) input = without_channel(input);
  const Result<std::vector<std::string>> paths = find_frames(of_files);
  if (!paths) return paths.error();
  std::vector<FileIdentity> files;
  for (const std::string& path : paths.value()) {
    if (path == "-")
      return Error{ErrorCode::kUsage, path,
                   "the standard input cannot be read again by a later run, as --resume needs; name a file"};
    const std::optional<FileStatus> status = status_of(path);
    if (!status) return failure(path, errno);
    if (!status->is_file())
      return Error{ErrorCode::kUsage, path,
                   "a pipe or a device cannot be read again by a later run, as --resume needs; name a file"};
    if (path.ends_with(".xml"))
      return Error{ErrorCode::kUsage, path,
                   "a later run could not notice changes of the files that this .xml file names; name the .mcx or .mc "
                   "file itself"};
    files.push_back({path, status->size, status->changed});
  }
  return files;
}

}  // namespace chronormal::inline internal
