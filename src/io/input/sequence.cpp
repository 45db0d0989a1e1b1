// Reads sequences: mesh files in a certain order that all have the same topology.
#include "io/input/sequence.h"

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "chronormal/core/parallel.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/file.h"
#include "io/input/formats.h"
#include "io/input/numbering.h"
#include "io/mesh/obj.h"
#include "io/mesh/obj_faces.h"
#include "io/system/names.h"
#include "motion/outline.h"

namespace chronormal::inline internal {
namespace {

Result<std::vector<std::string>> list_folder(const std::string& folder) {
  std::error_code code;
  std::filesystem::directory_iterator entries(path_of(folder), code);
  std::vector<std::string> files;
  const Format* format = nullptr;
  while (!code && entries != std::filesystem::directory_iterator{}) {
    const std::filesystem::path path = entries->path();
    const std::string name = utf8_of(path.filename());
    const Format* const own = find_format(name);
    std::error_code ignored;  // a broken link does not count as a file
    if (own != nullptr && own->holds == Holds::kMesh && !name.starts_with('.') &&
        !std::filesystem::is_directory(path, ignored)) {
      if (format != nullptr && format != own)
        return invalid_input(folder, "the folder has both " + std::string(format->name) + " and " +
                                         std::string(own->name) + " files; choose one kind with a pattern such as '" +
                                         utf8_of(path_of(folder) / "*") + std::string(format->extensions.front()) +
                                         "'");
      format = own;
      files.push_back(utf8_of(path));
    }
    entries.increment(code);
  }
  if (code) return Error{ErrorCode::kFailed, folder, code.message()};
  if (files.empty())
    return invalid_input(folder, "the folder has no mesh files (" + extensions_of({Holds::kMesh}, " or ") +
                                     ") to be keyframes; name another folder, or a single file");
  return files;
}

std::string frame_name(std::size_t k) { return "frame " + std::to_string(k); }

std::string frame_place(std::size_t k, const std::string& name) { return frame_name(k) + " (" + name + ")"; }

Result<FileBytes> open_frame(const InputOptions& options, const std::string& path, const std::string& place) {
  Result<FileBytes> file = FileBytes::open(path, options.resolve);
  if (file) return file;
  Error error = file.error();
  error.place = place;
  return error;
}

// The data that read_frame() reads for a frame of a sequence other than the first frame.
struct ReadFrame {
  Result<std::vector<float>> positions = std::vector<float>();
  std::vector<double> residuals = {};
  std::vector<float> velocities = {};
  std::uint64_t bytes = 0;  // size of its file in bytes, or 0 if this size was already counted
};

// Reads a frame other than the first. of_first has the faces and the origin of the first frame. `faces` has the text of
// the faces of the first frame, or is nullptr if this text cannot be compared. `shaded` gets the normals of the frame
// if they are requested, and is nullptr otherwise.
ReadFrame read_frame(const InputOptions& options, const std::string& path, const std::string& place,
                     const ObjFaces* faces, ReadMotion* shaded, const Motion& of_first, const std::string& first_name) {
  const Result<FileBytes> file = open_frame(options, path, place);
  if (!file) return {file.error()};
  const std::string_view bytes = file.value().bytes();
  const std::uint64_t counted = shaded != nullptr ? 0 : bytes.size();
  if (faces != nullptr) {
    const Format* const format = find_format(file_name_of(path), bytes);
    if (format != nullptr && format->read_mesh == read_obj)
      if (std::optional<std::vector<float>> positions = faces->positions_of(bytes);
          positions && far_origin(std::span<const float>(*positions)) == Origin{} &&
          !std::equal(positions->begin() + 3, positions->end(), positions->begin()))
        return {std::move(*positions), {}, {}, counted};
  }
  Result<MeshFrame> mesh = shaded != nullptr ? read_next_mesh(options, bytes, path, place, *shaded)
                                             : read_mesh_from(bytes, file_name_of(path), place,
                                                              {false, options.velocities, of_first.origin});
  if (!mesh) return {mesh.error()};
  if (const Status same = check_same_topology(of_first.topology, first_name, mesh.value().topology, place); !same)
    return {same.error()};
  return {std::move(mesh.value().positions), std::move(mesh.value().residuals), std::move(mesh.value().velocities),
          counted};
}

// Returns the text of the faces of an OBJ file, with which the faces of other files are compared. Returns nothing for
// other formats.
std::optional<ObjFaces> faces_of(const std::string& path, std::string_view bytes, const std::vector<float>& positions) {
  const Format* const format = find_format(file_name_of(path), bytes);
  if (format == nullptr || format->read_mesh != read_obj) return std::nullopt;
  return ObjFaces(bytes, positions);
}

// Returns the total size of the files in bytes. Returns nothing if a file is missing, or cannot be read twice because
// it is, for example, a pipe.
std::optional<std::uint64_t> bytes_of(const std::vector<std::string>& files, const std::vector<std::size_t>& frames) {
  std::uint64_t bytes = 0;
  for (const std::size_t k : frames) {
    std::error_code code;
    if (files[k] == "-" || !std::filesystem::is_regular_file(files[k], code)) return std::nullopt;
    const std::uintmax_t size = std::filesystem::file_size(files[k], code);
    if (code) return std::nullopt;
    bytes += size;
  }
  return bytes;
}

}  // namespace

Result<std::vector<std::string>> find_frames(const InputOptions& options, std::vector<std::string>* notes) {
  Result<std::vector<std::string>> files = find_input_files(options, list_folder, sort_as_sequence);
  if (!files || files.value() != options.files || !sort_listed(files.value())) return files;
  if (notes != nullptr)
    notes->push_back("the files are read in the order of their numbers, not as they were listed: " +
                     file_name_of(files.value().front()) + " to " + file_name_of(files.value().back()));
  return files;
}

namespace {

// Returns the indices of the files that the options choose as keyframes.
Result<std::vector<std::size_t>> choose_files(const std::vector<std::string>& files, const InputOptions& options) {
  const std::size_t total = files.size();
  if (total < 2)
    return invalid_input(total == 0 ? "" : files.front(),
                         "a sequence needs at least two keyframes, but " + std::to_string(total) +
                             (total == 1 ? " was" : " were") + " found; give several " +
                             extensions_of({Holds::kMesh}, " or ") + " files, a quoted pattern or a folder");
  return choose_frames(total, options);
}

}  // namespace

namespace {

// Returns the times of all files in seconds, and adds a note if they are not evenly spaced.
Result<std::vector<double>> find_times(const std::vector<std::string>& files, const InputOptions& options,
                                       ReadMotion& read) {
  FileTimes found = times_of_files(files);
  read.series = found.series;
  if (found.series && found.series->are_seconds) {
    if (options.frames_per_second != 1)
      return Error{ErrorCode::kUsage, "--fps",
                   "the names of the files are times in seconds (" + file_name_of(files.front()) + " to " +
                       file_name_of(files.back()) + "), so --fps has no meaning; leave --fps out"};
    return std::move(found.times);
  }
  if (found.series && !found.series->is_even())
    read.notes.push_back("the numbers of the files (" + file_name_of(files.front()) + " to " +
                         file_name_of(files.back()) +
                         ") are not evenly spaced; the time of each keyframe follows its number");
  for (double& time : found.times) time /= options.frames_per_second;
  return std::move(found.times);
}

// Selects the files that are examined for coordinates with more digits than float32 holds, if the first file has no
// such coordinates. Selects the last file, because its mesh has most likely moved, and other files at even distances
// before the last one.
std::vector<std::string> files_that_tell_digits(const std::vector<std::string>& files,
                                                const std::vector<std::size_t>& frames) {
  constexpr std::size_t kMost = 32;
  std::vector<std::string> chosen;
  const std::size_t last = frames.size() - 1, count = std::min(kMost, last);
  for (std::size_t i = count; i > 0; --i)
    if (const std::string& file = files[frames[last * i / count]]; file != "-") chosen.push_back(file);
  return chosen;
}

Status set_ends(const std::vector<std::string>& files, const InputOptions& options, const std::vector<double>& times,
                Motion& motion) {
  const auto positions = [&](std::size_t k) {
    const std::string place = frame_place(k, file_name_of(files[k]));
    return read_frame(options, files[k], place, nullptr, nullptr, motion, "the others").positions;
  };
  return set_end_velocities(options, times, positions, motion);
}

}  // namespace

Result<ReadMotion> read_sequence(const std::vector<std::string>& files, const InputOptions& options) {
  const Result<std::vector<std::size_t>> frames = choose_files(files, options);
  if (!frames) return frames.error();
  ReadMotion read;
  const Result<std::vector<double>> times = find_times(files, options, read);
  if (!times) return times.error();
  Motion& motion = read.motion;
  const std::size_t total = frames.value().size();
  read.other_files = files_that_tell_digits(files, frames.value());
  motion.keyframes.reserve(total);
  const auto file_of = [&](std::size_t i) -> const std::string& { return files[frames.value()[i]]; };
  const auto place = [&](std::size_t i) { return frame_place(frames.value()[i], file_name_of(file_of(i))); };
  const auto keep = [&](std::vector<float> positions, std::vector<float> velocities, std::vector<double> residuals) {
    const std::size_t i = motion.keyframes.size();
    const bool closes = options.loop && i + 1 == total;
    const double time = closes ? closing_time(times.value(), frames.value()) : times.value()[frames.value()[i]];
    motion.keyframes.push_back({std::move(positions), time, file_name_of(file_of(i)), std::move(velocities)});
    motion.keyframes.back().residuals = std::move(residuals);
    if (options.progress) options.progress(i + 1, total);
  };

  const Result<FileBytes> first_file = open_frame(options, file_of(0), place(0));
  if (!first_file) return first_file.error();
  Result<MeshFrame> first = read_next_mesh(options, first_file.value().bytes(), file_of(0), place(0), read);
  if (!first) return first.error();
  motion.topology = std::move(first.value().topology);
  keep(std::move(first.value().positions), std::move(first.value().velocities), {});

  // Each thread reads one frame at a time. Frames are read one after the other in two cases: if a resolver of the
  // caller reads the files, because it may not be thread-safe, and if normals are kept, because the normals of a frame
  // are read only if the previous frame had normals.
  const bool of_all = options.shading == KeepShading::kAll || options.shading == KeepShading::kRead;
  const bool keeps_normals = of_all && !read.normals.of_keyframes.empty();
  const std::size_t at_once = options.resolve || keeps_normals ? 1 : thread_count();
  std::optional<ObjFaces> faces;
  // The text of the faces is compared with that of the first file instead of being parsed, but only if the normals of
  // the file are not needed and no origin is subtracted from positions.
  if (!keeps_normals && motion.origin == Origin{})
    faces = faces_of(file_of(0), first_file.value().bytes(), motion.keyframes[0].positions);
  while (motion.keyframes.size() < total) {
    const std::size_t begin = motion.keyframes.size(), count = std::min(at_once, total - begin);
    std::vector<ReadFrame> next(count);
    parallel_for(count, [&](std::size_t i) {
      next[i] = read_frame(options, file_of(begin + i), place(begin + i), faces ? &*faces : nullptr,
                           keeps_normals ? &read : nullptr, motion, frame_name(frames.value()[0]));
    });
    for (ReadFrame& frame : next) {
      if (!frame.positions) return frame.positions.error();
      read.bytes_read += frame.bytes;
      const bool has_velocities = !motion.keyframes[0].velocities.empty();
      if (frame.velocities.empty() == has_velocities)
        return invalid_input(place(motion.keyframes.size()),
                             (has_velocities ? "the file has no velocities, but " + place(0) + " has some"
                                             : "the file has velocities, but " + place(0) + " has none") +
                                 "; write velocities into all files of the sequence, or into none");
      keep(std::move(frame.positions).value(), std::move(frame.velocities), std::move(frame.residuals));
    }
  }
  motion.connect_as_sequence();
  if (Status status = set_ends(files, options, times.value(), motion); !status) return status.error();
  if (Status status = validate(motion); !status) return status.error();
  return read;
}

Result<ReadMotion> stream_sequence(const std::vector<std::string>& files, const InputOptions& options) {
  Result<std::vector<std::size_t>> chosen = choose_files(files, options);
  if (!chosen) return chosen.error();
  const std::vector<std::size_t> frames = std::move(chosen).value();
  const std::optional<std::uint64_t> bytes = bytes_of(files, frames);
  if (!bytes || *bytes <= options.kept_bytes) return read_sequence(files, options);

  ReadMotion read;
  read.other_files = files_that_tell_digits(files, frames);
  const Result<std::vector<double>> times = find_times(files, options, read);
  if (!times) return times.error();
  Motion outline;
  for (const std::size_t k : frames) outline.keyframes.push_back({{}, times.value()[k], file_name_of(files[k])});
  if (options.loop) outline.keyframes.back().time = closing_time(times.value(), frames);
  outline.connect_as_sequence();
  const std::string& first_path = files[frames[0]];
  const std::string place = frame_place(frames[0], outline.keyframes[0].name);
  Result<FileBytes> first_file = open_frame(options, first_path, place);
  if (!first_file) return first_file.error();
  Result<MeshFrame> first = read_next_mesh(options, first_file.value().bytes(), first_path, place, read);
  if (!first) return first.error();
  if (options.shading == KeepShading::kAll && !read.normals.of_keyframes.empty()) return read_sequence(files, options);
  if (!first.value().velocities.empty()) return read_sequence(files, options);
  read.normals.has_more = options.shading == KeepShading::kRead && !read.normals.of_keyframes.empty();
  read.bytes_read = *bytes;
  outline.topology = std::move(first.value().topology);
  outline.origin = read.motion.origin;
  std::vector<float>& positions = outline.keyframes[0].positions;
  positions = std::move(first.value().positions);
  if (Status status = set_ends(files, options, times.value(), outline); !status) return status.error();
  Status valid = validate_positions(outline, 0, positions);
  if (valid) valid = validate_outline(outline);
  if (!valid) return valid.error();

  // The first file stays mapped, so that the text of its faces can be compared with the other files.
  struct First {
    FileBytes file;
    std::optional<ObjFaces> faces;
  };
  const auto kept = std::make_shared<First>(First{std::move(first_file).value(), std::nullopt});
  if (outline.origin == Origin{}) kept->faces = faces_of(first_path, kept->file.bytes(), positions);
  const auto read_one = [files, frames, options, kept](const Motion& motion, std::size_t keyframe,
                                                       std::span<float> result) -> Status {
    const std::size_t k = frames[keyframe];
    const ReadFrame frame = read_frame(options, files[k], frame_place(k, motion.keyframes[keyframe].name),
                                       kept->faces ? &*kept->faces : nullptr, nullptr, motion, frame_name(frames[0]));
    if (!frame.positions) return frame.positions.error();
    if (!frame.velocities.empty())
      return invalid_input(frame_place(k, motion.keyframes[keyframe].name),
                           "the file has velocities, but " + frame_name(frames[0]) +
                               " has none; write velocities into all files of the sequence, or into none");
    const std::vector<float>& found = frame.positions.value();
    Status status = validate_positions(motion, keyframe, found);
    if (status) std::copy(found.begin(), found.end(), result.begin());
    return status;
  };
  if (read.normals.has_more)
    read.read_normals = [files, frames, options](std::size_t keyframe) -> Result<std::vector<float>> {
      const std::string& path = files[frames[keyframe]];
      ReadMotion alone;
      const Result<MeshFrame> mesh =
          read_mesh_file(options, path, frame_place(frames[keyframe], file_name_of(path)), alone);
      if (!mesh) return mesh.error();
      if (alone.normals.of_keyframes.empty()) return std::vector<float>();
      return std::move(alone.normals.of_keyframes.front());
    };
  read.stream.emplace(std::move(outline), read_one, options.kept_bytes);
  return read;
}

}  // namespace chronormal::inline internal
