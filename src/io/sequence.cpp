#include "chronormal/io/sequence.h"

#include <glob.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <iterator>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/io/file.h"
#include "chronormal/io/obj.h"
#include "chronormal/io/ply.h"
#include "chronormal/io/readers.h"
#include "chronormal/motion/validate.h"

namespace chronormal {
namespace {

constexpr std::string_view kTopologyMustNotChange = ": topology must not change between keyframes";

bool is_digit(char c) { return c >= '0' && c <= '9'; }

// Takes the digits at the front of text, without leading zeros.
std::string_view take_number(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && is_digit(text[end])) ++end;
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  while (!number.empty() && number.front() == '0') number.remove_prefix(1);
  return number;
}

// Whether a stands before b when runs of digits count as numbers of any size; ties are broken by plain order.
bool stands_before(const std::string& a, const std::string& b) {
  std::string_view rest_a = a, rest_b = b;
  while (!rest_a.empty() && !rest_b.empty()) {
    if (is_digit(rest_a.front()) && is_digit(rest_b.front())) {
      const std::string_view number_a = take_number(rest_a), number_b = take_number(rest_b);
      if (number_a.size() != number_b.size()) return number_a.size() < number_b.size();
      if (number_a != number_b) return number_a < number_b;
      continue;
    }
    if (rest_a.front() != rest_b.front()) return rest_a.front() < rest_b.front();
    rest_a.remove_prefix(1);
    rest_b.remove_prefix(1);
  }
  if (rest_a.empty() != rest_b.empty()) return rest_a.empty();
  return a < b;
}

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

Result<std::vector<std::string>> match_pattern(const std::string& pattern) {
  glob_t matches{};
  const int code = ::glob(pattern.c_str(), GLOB_NOSORT, nullptr, &matches);
  std::vector<std::string> files;
  for (std::size_t i = 0; code == 0 && i < matches.gl_pathc; ++i) files.emplace_back(matches.gl_pathv[i]);
  ::globfree(&matches);
  if (files.empty()) return Error{ErrorCode::kFailed, pattern, "no file of this name, and none that matches it"};
  return files;
}

std::string file_name_of(const std::string& path) {
  return path == "-" ? "<stdin>" : std::filesystem::path(path).filename().string();
}

std::string frame_place(std::size_t k, const std::string& name) {
  return "frame " + std::to_string(k) + " (" + name + ")";
}

Result<MeshFrame> read_frame(const std::string& path, const std::string& place) {
  const Result<FileBytes> file = FileBytes::open(path);
  if (!file) {
    Error error = file.error();
    error.place = place;
    return error;
  }
  const std::string_view bytes = file.value().bytes();
  const Result<const MeshReader*> reader = choose_mesh_reader(bytes, file_name_of(path));
  if (!reader) return invalid_input(place, reader.error().message);
  return reader.value()->read(bytes, place);
}

Status check_same_topology(const Topology& first, const Topology& other, const std::string& place) {
  const auto counts_differ = [&](std::size_t count, std::size_t first_count, const char* what) {
    return invalid_input(place, "it has " + std::to_string(count) + " " + what + ", but frame 0 has " +
                                    std::to_string(first_count) + std::string(kTopologyMustNotChange));
  };
  if (other.vertex_count() != first.vertex_count())
    return counts_differ(other.vertex_count(), first.vertex_count(), "vertices");
  if (other.face_count() != first.face_count()) return counts_differ(other.face_count(), first.face_count(), "faces");
  if (other == first) return Success{};
  for (std::size_t f = 0; f < first.face_count(); ++f) {
    const auto a = first.face(f), b = other.face(f);
    if (!std::equal(a.begin(), a.end(), b.begin(), b.end()))
      return invalid_input(place,
                           "face " + std::to_string(f) + " differs from frame 0" + std::string(kTopologyMustNotChange));
  }
  return Success{};
}

// A name with a place for the number of the keyframe.
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
                     "the name must have one %d or %0Nd (N = 1 to 99) for the number of the keyframe"};
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
  std::vector<std::string> frames;
  bool has_stdin = false;
  for (const std::string& input : inputs) {
    if (input == "-") {
      if (has_stdin) return Error{ErrorCode::kUsage, input, "the standard input can be given only once"};
      has_stdin = true;
      frames.push_back(input);
      continue;
    }
    std::error_code code;
    const std::filesystem::file_status status = std::filesystem::status(input, code);
    const bool is_missing = status.type() == std::filesystem::file_type::not_found;
    if (std::filesystem::exists(status) && !std::filesystem::is_directory(status)) {
      frames.push_back(input);
      continue;
    }
    const bool is_pattern = input.find_first_of("*?[") != std::string::npos;
    if (!std::filesystem::exists(status) && !(is_missing && is_pattern))
      return Error{ErrorCode::kFailed, input, code ? code.message() : "no such file or folder"};
    Result<std::vector<std::string>> found = is_missing ? match_pattern(input) : list_folder(input);
    if (!found) return found.error();
    std::sort(found.value().begin(), found.value().end(), stands_before);
    std::move(found.value().begin(), found.value().end(), std::back_inserter(frames));
  }
  return frames;
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
    Result<MeshFrame> frame = read_frame(path, frame_place(k, name));
    if (!frame) return frame.error();
    if (k == 0) {
      motion.topology = std::move(frame.value().topology);
    } else if (Status status = check_same_topology(motion.topology, frame.value().topology, frame_place(k, name));
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

Status write_sequence(const Motion& motion, const std::string& pattern, bool force) {
  const Result<NamePattern> parts = parse_pattern(pattern);
  if (!parts) return parts.error();
  if (!parts.value().has_number && motion.keyframes.size() > 1)
    return Error{ErrorCode::kUsage, pattern,
                 "the motion has " + std::to_string(motion.keyframes.size()) +
                     " keyframes, a file each: the name must have a %d for their number"};
  const MeshReader* const format = find_mesh_reader(pattern);
  if (format == nullptr || (format->name != "obj" && format->name != "ply"))
    return Error{ErrorCode::kUsage, pattern, "the name must end in .obj or .ply"};

  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    if (Status status = check_output(parts.value().name(k), force); !status) return status;
  }
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    const std::vector<float>& coordinates = motion.keyframes[k].positions;
    assert(coordinates.size() == 3 * motion.topology.vertex_count());
    const auto positions = VectorView<const float>::packed(coordinates.data(), motion.topology.vertex_count());
    const std::string bytes = format->name == "obj"
                                  ? write_obj(motion.topology, positions)
                                  : write_ply(motion.topology, positions, PlyEncoding::kBinaryLittleEndian);
    if (Status status = write_output(parts.value().name(k), bytes, force); !status) return status;
  }
  return Success{};
}

}  // namespace chronormal
