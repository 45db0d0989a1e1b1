// Maps regular files into memory, and reads pipes and terminals to their end. PositionedFile reads parts of a regular
// file without a mapping.
#include "io/bytes/file.h"

#include <algorithm>
#include <cerrno>
#include <utility>

#include "core/text.h"
#include "io/bytes/expansion.h"

namespace chronormal {
namespace {

// Reads to the end of the file, or until `bytes` has more than `most` bytes. If `waits` is true, waits for bytes that a
// pipe does not have yet. Returns false and sets errno on failure. `expected` is the present size of the file in bytes.
bool read_all(int descriptor, bool waits, std::size_t expected, std::size_t most, std::string& bytes) {
  const std::size_t first_block = std::max(std::size_t{1} << 16, expected + 1);
  std::size_t size = 0;
  while (size <= most) {
    if (size == bytes.size()) bytes.resize(std::min(size == 0 ? first_block : 2 * size, most + 1));
    const std::optional<std::size_t> count = read_some(descriptor, std::span(bytes).subspan(size), waits);
    if (!count) return false;
    if (*count == 0) break;
    size += *count;
  }
  bytes.resize(size);
  bytes.shrink_to_fit();
  return true;
}

// Refuses a large sparse file. Such a file takes far less space on the disk than its size says, but in memory it would
// take its whole size.
Status check_holes(int descriptor, std::uint64_t size, const std::string& place) {
  constexpr std::uint64_t kLarge = std::uint64_t{1} << 30;
  if (size <= kLarge) return Success{};
  const std::uint64_t enough = size / Expansion::kUsual, written = written_bytes(descriptor, size, enough);
  if (written >= enough) return Success{};
  return invalid_input(place, "the file is almost empty, since only " + grouped(written) + " of its " +
                                  counted(size, "byte was", "bytes were") +
                                  " ever written; copy or download the file again");
}

}  // namespace

Result<FileBytes> FileBytes::open(const std::string& path, std::size_t most_of_stream) {
  const bool is_stdin = path == "-";
  const Descriptor opened = is_stdin ? Descriptor(-1) : open_file(path, {.reads = true});
  if (!is_stdin && !opened.is_open()) return failure(path, errno);
  const int descriptor = is_stdin ? kStandardInput : opened.number();
  const std::string place = is_stdin ? "<stdin>" : path;

  const std::optional<FileStatus> status = status_of(descriptor);
  if (!status) return failure(place, errno);
  if (status->kind == FileStatus::Kind::kFolder)
    return Error{ErrorCode::kFailed, place, "this is a folder; name a file"};
  // A device such as /dev/zero may have no end. A terminal is accepted, because the user can end its input with a key.
  if (status->kind == FileStatus::Kind::kDevice)
    return Error{ErrorCode::kFailed, place, "this is a device, whose data may never end; name a regular file"};

  FileBytes file;
  // The kernel's own files, as in /proc, report size 0. Most of these files have an end, but reading the kernel's log
  // waits for more messages.
  const bool has_no_size = !is_stdin && status->is_file() && status->size == 0;
  if (has_no_size) never_wait(descriptor);
  if (!is_stdin && status->is_file() && !has_no_size) {
    const auto size = static_cast<std::size_t>(status->size);
    if (Status status_of_holes = check_holes(descriptor, size, place); !status_of_holes) return status_of_holes.error();
    if (const char* const mapping = map_file(descriptor, size)) {
      file.view_ = {mapping, size};
      file.is_mapped_ = true;
      return file;
    }
  }
  if (!read_all(descriptor, !has_no_size, status->is_file() ? status->size : 0, most_of_stream, file.owned_)) {
    if (has_no_size && errno == EAGAIN)
      return Error{ErrorCode::kFailed, place,
                   "this is a file of the system whose data may never end; name another file"};
    return failure(place, errno);
  }
  if (file.owned_.size() > most_of_stream)
    return Error{ErrorCode::kFailed, place,
                 "the stream is longer than " + counted(most_of_stream, "byte", "bytes") +
                     "; save its data to a file, and name that file"};
  return file;
}

Result<FileBytes> FileBytes::open(const std::string& path,
                                  const std::function<Result<std::string_view>(const std::string& name)>& resolve) {
  if (!resolve) return open(path);
  const Result<std::string_view> bytes = resolve(path);
  if (!bytes) return bytes.error();
  FileBytes file;
  file.view_ = bytes.value();
  return file;
}

FileBytes::FileBytes(FileBytes&& other) noexcept
    : view_(std::exchange(other.view_, {})),
      is_mapped_(std::exchange(other.is_mapped_, false)),
      owned_(std::exchange(other.owned_, {})) {}

FileBytes& FileBytes::operator=(FileBytes&& other) noexcept {
  std::swap(view_, other.view_);
  std::swap(is_mapped_, other.is_mapped_);
  std::swap(owned_, other.owned_);
  return *this;
}

void FileBytes::release() const noexcept {
  if (is_mapped_) release_mapping(view_.data(), view_.size());
}

FileBytes::~FileBytes() {
  if (is_mapped_) unmap(view_.data(), view_.size());
}

std::optional<PositionedFile> PositionedFile::open(const std::string& path) {
  // Opening a pipe and closing it again would cut off the program that writes to it, so the kind of the file is checked
  // before the file is opened.
  if (path == "-") return std::nullopt;
  if (const auto status = status_of(path); !status || !status->is_file()) return std::nullopt;
  Descriptor descriptor = open_file(path, {.reads = true});
  if (!descriptor.is_open()) return std::nullopt;
  const auto status = status_of(descriptor.number());
  if (!status || !status->is_file()) return std::nullopt;
  return PositionedFile(path, std::move(descriptor), status->size);
}

Status PositionedFile::read(std::uint64_t at, std::span<char> bytes) const {
  const std::optional<std::span<char>> missing = read_at(descriptor_.number(), at, bytes);
  if (!missing) return failure(path_, errno);
  if (missing->empty()) return Success{};
  const auto status = status_of(descriptor_.number());
  const std::uint64_t end = status ? status->size : at + (bytes.size() - missing->size());
  return Error{ErrorCode::kFailed, path_,
               "another program has shortened the file from " + grouped(size_) + " to " +
                   counted(end, "byte", "bytes") + " while it was read; run the command again"};
}

}  // namespace chronormal
