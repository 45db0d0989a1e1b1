#include "chronormal/io/sequence.h"

#include <cassert>
#include <cmath>
#include <filesystem>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/io/file.h"
#include "chronormal/motion/motion.h"
#include "io/input/input_files.h"
#include "io/mesh/mesh_readers.h"
#include "io/mesh/obj.h"
#include "io/mesh/ply.h"

namespace chronormal {
namespace {

bool is_digit(char c) { return c >= '0' && c <= '9'; }

Result<std::vector<std::string>> list_folder(const std::string& folder) {
  std::error_code code;
  std::filesystem::directory_iterator entries(folder, code);
  std::vector<std::string> files;
  const MeshReader* format = nullptr;
  while (!code && entries != std::filesystem::directory_iterator{}) {
    const std::filesystem::path path = entries->path();
    const std::string name = path.filename().string();
    const MeshReader* const reader = find_mesh_reader(name);
    std::error_code ignored;  // a link to nowhere is no file
    if (reader != nullptr && !name.starts_with('.') && !std::filesystem::is_directory(path, ignored)) {
      if (format != nullptr && format != reader)
        return invalid_input(folder, "the folder has both " + std::string(format->name) + " and " +
                                         std::string(reader->name) + " files; use a pattern such as '" +
                                         (std::filesystem::path(folder) / "*").string() +
                                         std::string(format->extensions.front()) + "'");
      format = reader;
      files.push_back(path.string());
    }
    entries.increment(code);
  }
  if (code) return Error{ErrorCode::kFailed, folder, code.message()};
  if (files.empty()) return invalid_input(folder, "the folder has no mesh files (.obj or .ply)");
  return files;
}

std::string frame_place(std::size_t k, const std::string& name) {
  return "frame " + std::to_string(k) + " (" + name + ")";
}

// A name with a place for a number.
struct NamePattern {
  std::string before, after;
  bool has_number = false;
  std::size_t width = 0;  // of the number, filled up with zeros

  [[nodiscard]] std::string name(std::size_t k) const {
    if (!has_number) return before;
    std::string number = std::to_string(k);
    if (number.size() < width) number.insert(0, width - number.size(), '0');
    return before + number + after;
  }
};

Result<NamePattern> parse_pattern(const std::string& pattern) {
  const Error misuse{ErrorCode::kUsage, pattern,
                     "the name must have one %d or %0Nd (N = 1 to 99) for the number of the file"};
  NamePattern parts;
  const std::size_t slash = pattern.rfind('/');
  const std::size_t percent = pattern.find('%', slash == std::string::npos ? 0 : slash);
  parts.before = pattern.substr(0, percent);
  if (percent == std::string::npos) return parts;

  std::string_view rest = std::string_view(pattern).substr(percent + 1);
  if (rest.starts_with('0')) {
    rest.remove_prefix(1);
    std::size_t digits = 0;
    for (; digits < 2 && digits < rest.size() && is_digit(rest[digits]); ++digits)
      parts.width = 10 * parts.width + static_cast<std::size_t>(rest[digits] - '0');
    if (parts.width == 0) return misuse;
    rest.remove_prefix(digits);
  }
  if (!rest.starts_with('d') || rest.find('%') != std::string_view::npos) return misuse;
  parts.after = rest.substr(1);
  parts.has_number = true;
  return parts;
}

}  // namespace

Result<std::vector<std::string>> find_frames(std::span<const std::string> inputs) {
  return find_input_files(inputs, list_folder);
}

Result<Motion> read_sequence(std::span<const std::string> inputs, const SequenceOptions& options,
                             const std::function<void(std::size_t done, std::size_t total)>& progress) {
  if (!(options.frames_per_second >= 1e-9 && options.frames_per_second <= 1e9))
    return Error{ErrorCode::kUsage, "", "the frame rate (--fps) must be a number from 1e-9 to 1e9"};
  const Result<std::vector<std::string>> files = find_frames(inputs);
  if (!files) return files.error();
  const std::size_t total = files.value().size();
  if (total < 2)
    return invalid_input(total == 0 ? "" : files.value().front(),
                         "a sequence needs two frames or more, but " + std::to_string(total) +
                             (total == 1 ? " was" : " were") +
                             " found; give several .obj or .ply files, a quoted pattern or a folder");

  Motion motion;
  motion.keyframes.reserve(total);
  for (std::size_t k = 0; k < total; ++k) {
    const std::string& path = files.value()[k];
    const std::string name = file_name_of(path);
    Result<MeshFrame> frame = read_mesh_file(path, frame_place(k, name));
    if (!frame) return frame.error();
    if (k == 0) {
      motion.topology = std::move(frame.value().topology);
    } else if (Status status =
                   check_same_topology(motion.topology, "frame 0", frame.value().topology, frame_place(k, name));
               !status) {
      return status.error();
    }
    const double time = static_cast<double>(k) / options.frames_per_second;
    motion.keyframes.push_back({std::move(frame.value().positions), time, name});
    if (progress) progress(k + 1, total);
  }
  motion.connect_as_sequence();
  if (Status status = validate(motion); !status) return status.error();
  return motion;
}

Result<std::vector<std::string>> numbered_names(const std::string& pattern, std::size_t count) {
  const Result<NamePattern> parts = parse_pattern(pattern);
  if (!parts) return parts.error();
  if (!parts.value().has_number && count > 1)
    return Error{ErrorCode::kUsage, pattern,
                 "there are " + std::to_string(count) + " files to write: the name must have a %d for their number"};
  std::vector<std::string> names;
  for (std::size_t k = 0; k < count; ++k) names.push_back(parts.value().name(k));
  return names;
}

Status write_sequence(const Motion& motion, const std::string& pattern, bool force) {
  const Result<std::vector<std::string>> names = numbered_names(pattern, motion.keyframes.size());
  if (!names) return names.error();
  const MeshReader* const format = find_mesh_reader(pattern);
  if (format == nullptr || (format->name != "obj" && format->name != "ply"))
    return Error{ErrorCode::kUsage, pattern, "the name must end in .obj or .ply"};

  for (const std::string& name : names.value()) {
    if (Status status = check_output(name, force); !status) return status;
  }
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    const std::vector<float>& coordinates = motion.keyframes[k].positions;
    assert(coordinates.size() == 3 * motion.topology.vertex_count());
    const auto positions = VectorView<const float>::packed(coordinates.data(), motion.topology.vertex_count());
    const std::string bytes = format->name == "obj"
                                  ? write_obj(motion.topology, positions)
                                  : write_ply(motion.topology, positions, PlyEncoding::kBinaryLittleEndian);
    if (Status status = write_output(names.value()[k], bytes, force); !status) return status;
  }
  return Success{};
}

}  // namespace chronormal
