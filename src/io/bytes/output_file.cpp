// Writes a new file under a temporary name in the folder of the target, and renames it when all bytes are written.
// Bytes for a stream are written to the stream at once.
#include "io/bytes/output_file.h"

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <optional>
#include <utility>

#include "chronormal/io/output.h"
#include "io/system/files.h"
#include "io/system/temporary_file.h"

namespace chronormal {
namespace {

// Writes the pieces in order, and joins small pieces into one call of the system. Returns false and sets errno on
// failure.
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

Error exists_already(const std::string& path) {
  return Error{ErrorCode::kFailed, path, "the file exists already; add --force to overwrite it"};
}

}  // namespace

// The state of an output. The output is a stream of this process, a device or a pipe that has a path, or a new file.
struct internal::OutputFile::State {
  std::string path;
  bool force = false;
  std::optional<int> stream = {};
  Descriptor device{-1};
  std::string target = {};  // the path with its symbolic links resolved
  bool replaces = false;    // true if the target already exists; `old` then describes it
  FileStatus old = {};
  std::unique_ptr<TemporaryFile> file = {};
  bool is_joined = false;  // true if another process will rename the file to its target
  bool is_sealed = false;
  std::string gathered = {};  // bytes that put() was given for a stream or a device; finish() writes them

  [[nodiscard]] int descriptor() const noexcept {
    return stream ? *stream : file != nullptr ? file->descriptor() : device.number();
  }
  [[nodiscard]] Status look_for_old() {
    const std::optional<FileStatus> found = status_of(path);
    if (!found && errno != ENOENT) return failure(path, errno);
    replaces = found.has_value();
    if (found) old = *found;
    return Success{};
  }

  [[nodiscard]] Error error() const { return failure(stream && path == "-" ? "<stdout>" : path, errno); }

  // Flushes the new file to disk, and closes it. Returns false and sets errno on failure.
  [[nodiscard]] bool seal() {
    if (std::exchange(is_sealed, true)) return true;
    if (replaces && !take_permissions(file->descriptor(), old)) return false;
    return flush_file(file->descriptor()) && file->close();
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
  state->stream = stream_of(path);
  if (state->stream) {
    // The program may have printed bytes that are still in a buffer. The buffered bytes must come before the bytes of
    // this output.
    (void)std::fflush(*state->stream == kStandardError ? stderr : stdout);
    return OutputFile(std::move(state));
  }
  if (Status status = check_output(path, force); !status) return status.error();
  if (const Status found = state->look_for_old(); !found) return found.error();
  if (state->replaces && !state->old.is_file()) {
    state->device = open_file(path, {.writes = true});
    if (!state->device.is_open()) return failure(path, errno);
    return OutputFile(std::move(state));
  }
  state->target = follow_links(path);
  // The new file is readable only by its owner until it gets the permissions of the file that it replaces.
  state->file = std::make_unique<TemporaryFile>(state->target, state->replaces);
  if (!state->file->is_open()) return TemporaryFile::not_opened(path);
  return OutputFile(std::move(state));
}

Result<OutputFile> OutputFile::go_on(const std::string& path, bool force, std::uint64_t kept) {
  if (is_stream(path))
    return Error{ErrorCode::kUsage, path,
                 "--resume cannot continue an output that is a pipe or the standard output; name a file with -o"};
  if (Status status = check_output(path, force); !status) return status.error();
  auto state = std::make_unique<State>();
  state->path = path;
  state->force = force;
  if (const Status found = state->look_for_old(); !found) return found.error();
  state->target = follow_links(path);
  const TemporaryFile::Kept partial{partial_name(path)};
  state->file = std::make_unique<TemporaryFile>(partial, state->replaces);
  if (!state->file->is_open() || !set_end(state->descriptor(), kept)) {
    Error error = failure(partial.name, errno);
    if (kept == 0) remove_file(partial.name.c_str());  // the file is empty, so a later run could not continue with it
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
    if (!write_at(state_->descriptor(), at, bytes)) return state_->error();
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
  if (stream_of(path)) return Success{};
  const std::optional<FileStatus> status = status_of(path);
  if (!status) return Success{};
  if (status->kind == FileStatus::Kind::kFolder)
    return Error{ErrorCode::kFailed, path, "this is a folder; name a file"};
  if (status->is_file() && !force) return exists_already(path);
  return Success{};
}

bool is_stream(const std::string& path) {
  if (stream_of(path)) return true;
  const std::optional<FileStatus> status = status_of(path);
  return status && !status->is_file() && status->kind != FileStatus::Kind::kFolder;
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
