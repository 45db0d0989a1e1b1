// A new file is a temporary sibling until it is whole; a stream takes bytes as they come.
#include "io/bytes/output_file.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>

#include "chronormal/io/output.h"
#include "core/charconv.h"
#include "io/bytes/descriptor.h"
#include "io/bytes/same_file.h"
#include "io/bytes/temporary_file.h"

namespace chronormal {
namespace {

// Writes the pieces in order, and joins small ones into one call. Returns false, with errno, on failure.
bool write_pieces(int descriptor, std::span<const std::string_view> pieces) {
  constexpr std::size_t kBlock = std::size_t{1} << 16;
  std::string block;
  for (const std::string_view piece : pieces) {
    if (block.size() + piece.size() > kBlock) {
      if (!write_bytes(descriptor, block)) return false;
      block.clear();
    }
    if (piece.size() < kBlock)
      block += piece;
    else if (!write_bytes(descriptor, piece))
      return false;
  }
  return write_bytes(descriptor, block);
}

// Writes all bytes at a position of a file. Returns false, with errno, on failure.
bool write_all_at(int descriptor, std::uint64_t at, std::string_view bytes) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(descriptor, bytes.data(), bytes.size(), static_cast<off_t>(at));
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return false;
    at += static_cast<std::uint64_t>(count);
    bytes.remove_prefix(static_cast<std::size_t>(count));
  }
  return true;
}

// Returns the descriptor of a path that names a stream of this process; nothing for other paths.
std::optional<int> stream_descriptor(std::string_view path) {
  if (path == "-" || path == "/dev/stdout") return STDOUT_FILENO;
  if (path == "/dev/stderr") return STDERR_FILENO;
  for (const std::string_view folder : {"/dev/fd/", "/proc/self/fd/"}) {
    if (!path.starts_with(folder)) continue;
    int number = -1;
    const char* const last = path.data() + path.size();
    const auto [end, code] = from_chars(path.data() + folder.size(), last, number);
    if (code == std::errc{} && end == last && number >= 0) return number;
  }
  return std::nullopt;
}

// Makes the rename last through a power cut. Errors are ignored, since some file systems cannot do it.
void flush_folder_of(const std::string& path) {
  const std::filesystem::path folder = std::filesystem::path(path).parent_path();
  const Descriptor descriptor(open_descriptor(folder.empty() ? "." : folder.string(), O_RDONLY | O_DIRECTORY));
  if (descriptor.is_open()) (void)::fsync(descriptor.number());
}

Error exists_already(const std::string& path) {
  return Error{ErrorCode::kFailed, path, "the file exists already; add --force to overwrite it"};
}

}  // namespace

// The output is one of three: a stream of this process, a device or a pipe of the file system, or a new file.
struct internal::OutputFile::State {
  std::string path;
  bool force = false;
  std::optional<int> stream = {};
  Descriptor device{-1};
  std::string target = {};  // the file behind the symbolic links of path
  bool replaces = false;    // whether target exists already, as:
  struct stat old {};
  std::unique_ptr<TemporaryFile> file = {};
  bool is_joined = false;  // whether another process gives the file its name
  bool is_sealed = false;
  std::string gathered = {};  // what a stream or a device gets when it is finished

  [[nodiscard]] int descriptor() const noexcept {
    return stream ? *stream : file != nullptr ? file->descriptor() : device.number();
  }
  [[nodiscard]] Error error() const { return failure(stream && path == "-" ? "<stdout>" : path, errno); }

  // Flushes the new file to disk, and closes it. Returns false, with errno, on failure.
  [[nodiscard]] bool seal() {
    if (std::exchange(is_sealed, true)) return true;
    if (replaces) {
      if (::fchown(file->descriptor(), old.st_uid, old.st_gid) != 0) errno = 0;  // only the owner or root may do that
      if (::fchmod(file->descriptor(), old.st_mode & 07777) != 0) return false;
    }
    if (::fsync(file->descriptor()) != 0 && errno != EINVAL && errno != EROFS) return false;
    return file->close();
  }
};

inline namespace internal {

OutputFile::OutputFile(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
OutputFile::OutputFile(OutputFile&&) noexcept = default;
OutputFile& OutputFile::operator=(OutputFile&&) noexcept = default;
OutputFile::~OutputFile() = default;

Result<OutputFile> OutputFile::create(const std::string& path, bool force) {
  auto state = std::make_unique<State>();
  state->path = path;
  state->force = force;
  state->stream = stream_descriptor(path);
  if (state->stream) {
    // The bytes that the program printed before are still in a buffer, and must come first.
    (void)std::fflush(*state->stream == STDERR_FILENO ? stderr : stdout);
    return OutputFile(std::move(state));
  }
  if (Status status = check_output(path, force); !status) return status.error();
  state->replaces = ::stat(path.c_str(), &state->old) == 0;
  if (!state->replaces && errno != ENOENT) return failure(path, errno);
  if (state->replaces && !S_ISREG(state->old.st_mode)) {
    state->device = Descriptor(open_descriptor(path, O_WRONLY));
    if (!state->device.is_open()) return failure(path, errno);
    return OutputFile(std::move(state));
  }
  state->target = follow_links(path);
  // Nobody else may read the new file until it has the permissions of the file that it replaces.
  state->file = std::make_unique<TemporaryFile>(state->target, state->replaces ? 0600 : 0666);
  if (!state->file->is_open()) return TemporaryFile::not_opened(path);
  return OutputFile(std::move(state));
}

Result<OutputFile> OutputFile::go_on(const std::string& path, bool force, std::uint64_t kept) {
  if (is_stream(path)) return Error{ErrorCode::kUsage, path, "a later run cannot go on with a stream; name a file"};
  if (Status status = check_output(path, force); !status) return status.error();
  auto state = std::make_unique<State>();
  state->path = path;
  state->force = force;
  state->replaces = ::stat(path.c_str(), &state->old) == 0;
  if (!state->replaces && errno != ENOENT) return failure(path, errno);
  state->target = follow_links(path);
  const TemporaryFile::Kept partial{partial_name(path)};
  state->file = std::make_unique<TemporaryFile>(partial, state->replaces ? 0600 : 0666);
  const auto size = static_cast<off_t>(kept);
  if (!state->file->is_open() || ::ftruncate(state->descriptor(), size) != 0 ||
      ::lseek(state->descriptor(), size, SEEK_SET) != size) {
    Error error = failure(partial.name, errno);
    if (kept == 0) (void)::unlink(partial.name.c_str());  // it holds nothing that a later run could go on with
    return error;
  }
  return OutputFile(std::move(state));
}

std::string OutputFile::partial_name(const std::string& path) { return follow_links(path) + ".partial"; }

Result<OutputFile> OutputFile::join(const std::string& path, const std::string& name) {
  auto state = std::make_unique<State>();
  state->path = path;
  state->is_joined = true;
  state->file = TemporaryFile::of_peer(name);
  if (state->file->is_open()) return OutputFile(std::move(state));
  Error error = failure(path, errno);
  error.message = "the output that the first process has begun cannot be opened: " + error.message;
  return error;
}

Result<Spool> OutputFile::spool() const {
  return state_->file == nullptr ? Spool() : Spool::beside(state_->target, state_->path);
}

std::string OutputFile::temporary_name() const { return state_->file == nullptr ? "" : state_->file->name(); }

Status OutputFile::append(std::span<const std::string_view> pieces) {
  if (!write_pieces(state_->descriptor(), pieces)) return state_->error();
  return Success{};
}

Status OutputFile::put(std::uint64_t at, std::string_view bytes) {
  if (state_->file != nullptr) {
    if (!write_all_at(state_->descriptor(), at, bytes)) return state_->error();
    return Success{};
  }
  std::string& gathered = state_->gathered;
  const auto begin = static_cast<std::size_t>(at);
  if (gathered.size() < begin + bytes.size()) gathered.resize(begin + bytes.size());
  std::copy(bytes.begin(), bytes.end(), gathered.begin() + static_cast<std::ptrdiff_t>(begin));
  return Success{};
}

Status OutputFile::seal() {
  if (state_->file != nullptr && !state_->seal()) return failure(state_->path, errno);
  return Success{};
}

Status OutputFile::finish() {
  State& state = *state_;
  if (state.file == nullptr) {
    const bool closed =
        write_bytes(state.descriptor(), std::string_view(state.gathered)) && (state.stream || state.device.close());
    if (!closed) return state.error();
    return Success{};
  }
  if (state.is_joined) {
    if (Status status = seal(); !status) return status;
    state.file->forget();
    return Success{};
  }
  if (!state.seal() || !state.file->rename_to(state.target, state.force)) {
    const int system_error = errno;
    if (system_error == EEXIST && !state.force) return exists_already(state.path);
    return failure(state.path, system_error);
  }
  flush_folder_of(state.target);
  return Success{};
}

}  // namespace internal

Status check_output(const std::string& path, bool force) {
  if (path.empty()) return Error{ErrorCode::kUsage, "", "the name of the output is empty; name a file"};
  if (stream_descriptor(path)) return Success{};
  struct stat status {};
  if (::stat(path.c_str(), &status) != 0) return Success{};
  if (S_ISDIR(status.st_mode)) return Error{ErrorCode::kFailed, path, "this is a folder; name a file"};
  if (S_ISREG(status.st_mode) && !force) return exists_already(path);
  return Success{};
}

bool is_stream(const std::string& path) {
  if (stream_descriptor(path)) return true;
  struct stat status {};
  return ::stat(path.c_str(), &status) == 0 && !S_ISREG(status.st_mode) && !S_ISDIR(status.st_mode);
}

Status write_output(const std::string& path, std::string_view bytes, bool force) {
  return write_output(path, std::span(&bytes, 1), force);
}

Status write_output(const std::string& path, std::span<const std::string_view> pieces, bool force) {
  Result<OutputFile> file = OutputFile::create(path, force);
  if (!file) return file.error();
  if (Status status = file.value().append(pieces); !status) return status;
  return file.value().finish();
}

}  // namespace chronormal
