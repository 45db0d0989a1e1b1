// Reads parts of a regular file by its descriptor.
#include "io/bytes/positioned_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <utility>

namespace chronormal::inline internal {

std::optional<PositionedFile> PositionedFile::open(const std::string& path) {
  struct stat status {};
  // A pipe that is opened and closed again loses its writer, so the kind of the file is checked first.
  if (path == "-" || ::stat(path.c_str(), &status) != 0 || !S_ISREG(status.st_mode)) return std::nullopt;
  Descriptor descriptor(open_descriptor(path, O_RDONLY));
  if (!descriptor.is_open() || ::fstat(descriptor.number(), &status) != 0 || !S_ISREG(status.st_mode))
    return std::nullopt;
  return PositionedFile(path, std::move(descriptor), static_cast<std::uint64_t>(status.st_size));
}

Status PositionedFile::read(std::uint64_t at, std::span<char> bytes) const {
  const std::optional<std::span<char>> missing = read_at(descriptor_.number(), at, bytes);
  if (!missing) return failure(path_, errno);
  if (missing->empty()) return Success{};
  struct stat status {};
  const bool is_known = ::fstat(descriptor_.number(), &status) == 0;
  const std::uint64_t end =
      is_known ? static_cast<std::uint64_t>(status.st_size) : at + (bytes.size() - missing->size());
  return Error{ErrorCode::kFailed, path_,
               "another program has shortened the file from " + std::to_string(size_) + " to " + std::to_string(end) +
                   " bytes while it was read; run the command again"};
}

}  // namespace chronormal::inline internal
