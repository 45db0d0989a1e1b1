// Finds the files of an input in their order, and reads single meshes from files.
#include "io/input/input_files.h"

#include <algorithm>
#include <cstddef>
#include <filesystem>
#include <iterator>
#include <optional>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/text.h"
#include "core/twofold.h"
#include "io/bytes/file.h"
#include "io/bytes/scan.h"
#include "io/input/formats.h"
#include "io/mesh/far_origin.h"
#include "io/system/files.h"
#include "io/system/names.h"

namespace chronormal::inline internal {
namespace {

constexpr std::string_view kNoneMatches =
    "no file has this name or matches this pattern; check the name and the folder";
constexpr std::string_view kTopologyMustNotChange = "; give files that all have the same faces";

// Removes the digits at the beginning of the text, and returns them without their leading zeros.
std::string_view take_number(std::string_view& text) {
  std::size_t end = 0;
  while (end < text.size() && scan::is_digit(text[end])) ++end;
  std::string_view number = text.substr(0, end);
  text.remove_prefix(end);
  while (!number.empty() && number.front() == '0') number.remove_prefix(1);
  return number;
}

// Splits a file name at its placeholder for a number (%d or %0Nd) into the parts before and after the placeholder.
// Returns nothing if the name has no placeholder.
std::optional<std::pair<std::string, std::string>> around_number(const std::string& input) {
  const std::size_t percent = input.find('%', begin_of_name(input));
  if (percent == std::string::npos) return std::nullopt;
  std::string_view rest = std::string_view(input).substr(percent + 1);
  if (rest.starts_with('0')) (void)take_number(rest);
  if (!rest.starts_with('d')) return std::nullopt;
  return std::pair{input.substr(0, percent), std::string(rest.substr(1))};
}

// Finds the files whose names consist of `before`, digits, and `after`.
std::vector<std::string> match_numbered(const std::string& before, const std::string& after) {
  std::vector<std::string> files = match_pattern(before + "[0-9]*" + after, false);
  const auto is_other = [&](std::string_view file) {
    if (file.size() < before.size() + after.size() || !file.starts_with(before) || !file.ends_with(after)) return true;
    const std::string_view number = file.substr(before.size(), file.size() - before.size() - after.size());
    return !std::all_of(number.begin(), number.end(), scan::is_digit);
  };
  std::erase_if(files, is_other);
  return files;
}

}  // namespace

bool stands_before(const std::string& a, const std::string& b) {
  std::string_view rest_a = a, rest_b = b;
  while (!rest_a.empty() && !rest_b.empty()) {
    if (scan::is_digit(rest_a.front()) && scan::is_digit(rest_b.front())) {
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

Status sort_by_number(const std::string& /*input*/, std::vector<std::string>& files) {
  std::sort(files.begin(), files.end(), stands_before);
  return Success{};
}

Result<std::vector<std::string>> find_input_files(const InputOptions& options, const FolderLister& list_folder,
                                                  const FileSorter& sort) {
  if (options.resolve) return options.files;
  std::vector<std::string> files;
  bool has_stdin = false;
  for (const std::string& input : options.files) {
    if (input == "-") {
      if (has_stdin)
        return Error{ErrorCode::kUsage, input, "the standard input (-) can only be read once; give - once"};
      has_stdin = true;
      files.push_back(input);
      continue;
    }
    std::error_code code;
    const std::filesystem::file_status status = std::filesystem::status(path_of(input), code);
    const bool is_missing = status.type() == std::filesystem::file_type::not_found;
    if (std::filesystem::exists(status) && !std::filesystem::is_directory(status)) {
      files.push_back(input);
      continue;
    }
    const bool is_pattern = input.find_first_of("*?[") != std::string::npos;
    const auto numbered = is_missing && !is_pattern ? around_number(input) : std::nullopt;
    if (!std::filesystem::exists(status) && !(is_missing && is_pattern) && !numbered)
      return Error{ErrorCode::kFailed, input,
                   code ? code.message() : "there is no file or folder of this name; check the name"};
    Result<std::vector<std::string>> found = numbered     ? match_numbered(numbered->first, numbered->second)
                                             : is_missing ? match_pattern(input, true)
                                                          : list_folder(input);
    if (!found) return found.error();
    if (found.value().empty() && is_missing) return Error{ErrorCode::kFailed, input, std::string(kNoneMatches)};
    if (const Status sorted = sort(input, found.value()); !sorted) return sorted.error();
    std::move(found.value().begin(), found.value().end(), std::back_inserter(files));
  }
  return files;
}

std::string file_name_of(const std::string& path) { return path == "-" ? "<stdin>" : file_name(path); }

namespace {

// Returns far_origin(positions). If all vertices have the same position in float32, returns this position instead,
// because the mesh may be small and far from (0, 0, 0).
Origin far_origin_of_file(std::span<const float> positions) {
  const Origin origin = far_origin(positions);
  if (positions.size() < 3) return origin;
  for (std::size_t i = 3; i < positions.size() && origin == Origin{}; ++i)
    if (positions[i] != positions[i % 3]) return origin;
  return origin == Origin{} ? Origin{positions[0], positions[1], positions[2]} : origin;
}

// Reads a mesh and subtracts wanted.origin, which is at first only as exact as float32. As long as the resulting
// positions are far from (0, 0, 0), moves wanted.origin closer to the mesh and reads the mesh again.
Result<MeshFrame> read_around(std::string_view bytes, const std::string& file_name, const std::string& place,
                              WantedOfMesh& wanted) {
  constexpr int kMost = 4;  // float32 finds 24 bits of an origin at a time, and a double has 53
  Result<MeshFrame> mesh = read_mesh(bytes, file_name, place, wanted);
  for (int i = 0; i < kMost && mesh; ++i) {
    const Origin rest = far_origin_of_file(mesh.value().positions);
    if (rest == Origin{}) break;
    for (std::size_t axis = 0; axis < 3; ++axis) wanted.origin[axis] += rest[axis];
    mesh = read_mesh(bytes, file_name, place, wanted);
  }
  return mesh;
}

}  // namespace

Result<MeshFrame> read_mesh_from(std::string_view bytes, const std::string& file_name, const std::string& place,
                                 const WantedOfMesh& wanted) {
  Result<MeshFrame> mesh = read_mesh(bytes, file_name, place, wanted);
  if (!mesh || far_origin_of_file(mesh.value().positions) == Origin{}) return mesh;
  WantedOfMesh alone = wanted;
  alone.origin = {};
  if (wanted.origin != Origin{}) mesh = read_mesh(bytes, file_name, place, alone);
  if (!mesh) return mesh;
  alone.origin = far_origin_of_file(mesh.value().positions);
  Result<MeshFrame> shifted = alone.origin == Origin{} ? mesh : read_around(bytes, file_name, place, alone);
  if (!shifted) return shifted;
  if (shifted.value().has_more_digits)
    mesh = std::move(shifted);
  else
    alone.origin = {};
  std::vector<float>& positions = mesh.value().positions;
  std::vector<double> high(positions.size()), low(positions.size());
  for (std::size_t i = 0; i < positions.size(); ++i) {
    const Twofold sum =
        Twofold::sum(alone.origin[i % 3], -wanted.origin[i % 3]) + Twofold{static_cast<double>(positions[i]), 0};
    high[i] = sum.high;
    low[i] = sum.low;
  }
  Motion::Keyframe keyframe;
  keyframe.set_positions(high, low);
  positions = std::move(keyframe.positions);
  mesh.value().residuals = std::move(keyframe.residuals);
  return mesh;
}

Result<MeshFrame> read_mesh_file(const InputOptions& options, const std::string& path, const std::string& place,
                                 ReadMotion& read) {
  const Result<FileBytes> file = FileBytes::open(path, options.resolve);
  if (!file) {
    Error error = file.error();
    error.place = place;
    return error;
  }
  return read_next_mesh(options, file.value().bytes(), path, place, read);
}

Result<MeshFrame> read_next_mesh(const InputOptions& options, std::string_view bytes, const std::string& path,
                                 const std::string& place, ReadMotion& read) {
  read.bytes_read += bytes.size();
  const std::size_t k = read.motion.keyframes.size();
  std::vector<std::vector<float>>& normals = read.normals.of_keyframes;
  // If the normals of all keyframes are wanted, the normals of keyframe k are read only if every earlier keyframe had
  // normals.
  const bool of_all = options.shading == KeepShading::kAll || options.shading == KeepShading::kRead;
  const bool wanted = k == 0 ? options.shading != KeepShading::kNone : of_all && normals.size() == k;
  WantedOfMesh of_mesh{wanted, options.velocities, read.motion.origin};
  Result<MeshFrame> mesh = k == 0 ? read_mesh(bytes, file_name_of(path), place, of_mesh)
                                  : read_mesh_from(bytes, file_name_of(path), place, of_mesh);
  if (!mesh) return mesh;
  if (k == 0) {
    const std::span<const float> positions = mesh.value().positions;
    of_mesh.origin = far_origin_of_file(positions);
    if (of_mesh.origin != Origin{}) {
      Result<MeshFrame> shifted = read_around(bytes, file_name_of(path), place, of_mesh);
      if (!shifted) return shifted;
      const std::vector<float>& around = shifted.value().positions;
      const bool is_point = std::equal(around.begin() + 3, around.end(), around.begin());
      bool has_more_digits = !is_point && shifted.value().has_more_digits;
      for (std::size_t i = 0; i < read.other_files.size() && !has_more_digits && !is_point; ++i) {
        // Errors in the other files of a sequence are ignored here. The code that reads the files as keyframes reports
        // these errors.
        const Result<FileBytes> file = FileBytes::open(read.other_files[i], options.resolve);
        if (!file) continue;
        const Result<MeshFrame> other =
            read_mesh(file.value().bytes(), file_name_of(read.other_files[i]), place, {false, false, of_mesh.origin});
        has_more_digits = other && other.value().has_more_digits;
      }
      if (has_more_digits) {
        read.motion.origin = of_mesh.origin;
        mesh = std::move(shifted);
      } else if (std::string note = note_of_lost_digits(positions); !note.empty() && !is_point) {
        read.notes.push_back(std::move(note));
      }
    }
  }
  for (const std::string& note : mesh.value().notes) {
    if (options.strict) return invalid_input(place, note);
    read.notes.push_back(place + ": " + note);
  }
  if (!wanted) return mesh;
  if (k == 0) {
    const Format* const format = find_format(file_name_of(path), bytes);
    if (format != nullptr && format->read_shaded_mesh != nullptr) read.shaded_by = path == "-" ? "<stdin>" : path;
    read.group_of_face = std::move(mesh.value().group_of_face);
  }
  if (!mesh.value().normal_of_corner.empty())
    normals.push_back(std::move(mesh.value().normal_of_corner));
  else if (k > 0)
    normals.resize(1);
  return mesh;
}

Result<std::vector<std::size_t>> choose_frames(std::size_t count, const InputOptions& options) {
  const auto misuse = [](const char* place, std::string message) {
    return Error{ErrorCode::kUsage, place, std::move(message)};
  };
  const std::string range = "the keyframes are numbered from 0 to " + std::to_string(count - 1);
  if (options.every == 0) return misuse("--every", "the step must be at least 1");
  if (options.to && *options.to >= count)
    return misuse("--to", "there is no keyframe with this number; choose another, since " + range);
  const std::size_t last = options.to.value_or(count - 1);
  if (options.from >= count)
    return misuse("--from", "there is no keyframe with this number; choose another, since " + range);
  std::vector<std::size_t> frames;
  for (std::size_t k = options.from; k <= last; k += std::min(options.every, count)) frames.push_back(k);
  if (frames.size() < 2 && options.chooses_frames())
    return misuse(options.every > 1                   ? "--every"
                  : options.to                        ? "--to"
                  : options.loop && options.from == 0 ? "--loop"
                                                      : "--from",
                  "these options leave fewer than two keyframes, but a motion needs two; choose more, since " + range);
  if (options.loop) frames.push_back(frames.front());
  return frames;
}

double closing_time(std::span<const double> times, std::span<const std::size_t> frames) {
  const std::size_t count = frames.size() - 1;  // number of keyframes, without the repeated first one
  const double first = times[frames[0]], last = times[frames[count - 1]];
  return last + (last - first) / static_cast<double>(count - 1);
}

namespace {

// Sets the velocities at both ends of a loop to the velocities that the vertices have there on the closed curve.
Status set_loop_velocities(const InputOptions& options, std::size_t count,
                           const std::function<Result<std::vector<float>>(std::size_t k)>& read, Motion& chosen) {
  const Result<std::vector<std::size_t>> frames = choose_frames(count, options);
  if (!frames) return frames.error();
  const std::size_t round = chosen.keyframes.size() - 1;
  const double period = chosen.keyframes.back().time - chosen.keyframes.front().time;
  constexpr std::size_t kBeside = 3;  // velocities depend on this number of keyframes on each side
  std::vector<double> times;
  std::vector<std::size_t> which;
  for (std::size_t i = 0; i <= 2 * kBeside; ++i) {
    // The velocities need the kBeside keyframes before the start of the loop. Adding kBeside rounds of the loop keeps
    // the index `at` from being negative.
    const std::size_t rounds = kBeside, at = i + rounds * round - kBeside;
    times.push_back(chosen.keyframes[at % round].time +
                    (static_cast<double>(at / round) - static_cast<double>(rounds)) * period);
    which.push_back(frames.value()[at % round]);
  }
  const VelocityShares shares = velocity_shares(times, kBeside);
  std::vector<std::vector<float>> positions;
  for (std::size_t i = 0; i < shares.share.size(); ++i) {
    Result<std::vector<float>> found = read(which[shares.first + i]);
    if (!found) return found.error();
    positions.push_back(std::move(found).value());
  }
  const std::vector<float> velocities =
      shares.velocities(std::vector<std::span<const float>>(positions.begin(), positions.end()));
  chosen.keyframes.front().end_velocities = velocities;
  chosen.keyframes.back().end_velocities = velocities;
  return Success{};
}

}  // namespace

Status set_end_velocities(const InputOptions& options, std::span<const double> times,
                          const std::function<Result<std::vector<float>>(std::size_t k)>& read, Motion& chosen) {
  if (!options.is_curved() || !options.chooses_frames()) return Success{};
  if (options.loop) return set_loop_velocities(options, times.size(), read, chosen);
  // Every N-th keyframe was chosen, where N is options.every. The velocities at the ends are computed from the longer
  // sequence that takes every N-th keyframe from the beginning to the end of the files.
  const std::size_t start = options.from % options.every, first = options.from / options.every;
  std::vector<double> of_whole, of_part;
  for (std::size_t k = start; k < times.size(); k += std::min(options.every, times.size()))
    of_whole.push_back(times[k]);
  for (const Motion::Keyframe& keyframe : chosen.keyframes) of_part.push_back(keyframe.time);
  for (const std::size_t at : {std::size_t{0}, of_part.size() - 1}) {
    const VelocityShares whole = velocity_shares(of_whole, first + at), part = velocity_shares(of_part, at);
    if (whole.first == first + part.first && whole.share.size() == part.share.size()) continue;
    std::vector<std::vector<float>> positions;
    for (std::size_t i = 0; i < whole.share.size(); ++i) {
      Result<std::vector<float>> found = read(start + (whole.first + i) * options.every);
      if (!found) return found.error();
      positions.push_back(std::move(found).value());
    }
    chosen.keyframes[at].end_velocities =
        whole.velocities(std::vector<std::span<const float>>(positions.begin(), positions.end()));
  }
  return Success{};
}

Status check_same_topology(const Topology& first, const std::string& first_name, const Topology& other,
                           const std::string& place) {
  const auto counts_differ = [&](std::size_t count, std::size_t first_count, const char* one, const char* many) {
    return invalid_input(place, "this mesh has " + counted(count, one, many) + ", but " + first_name + " has " +
                                    grouped(first_count) + std::string(kTopologyMustNotChange));
  };
  if (other.vertex_count() != first.vertex_count())
    return counts_differ(other.vertex_count(), first.vertex_count(), "vertex", "vertices");
  if (other.face_count() != first.face_count())
    return counts_differ(other.face_count(), first.face_count(), "face", "faces");
  if (other == first) return Success{};
  for (std::size_t f = 0; f < first.face_count(); ++f) {
    const auto a = first.face(f), b = other.face(f);
    if (!std::equal(a.begin(), a.end(), b.begin(), b.end()))
      return invalid_input(
          place, "face " + std::to_string(f) + " differs from " + first_name + std::string(kTopologyMustNotChange));
  }
  return Success{};
}

}  // namespace chronormal::inline internal
