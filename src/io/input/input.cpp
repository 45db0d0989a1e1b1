// Opens any input. open_input() tries the kinds of inputs in this order: a built-in morph, a base with its targets, a
// cache with its mesh, a single file that holds everything, the files of a sequence. The format of a file is found by
// its extension, or else by its content. No file is opened twice.
#include "chronormal/io/input.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <filesystem>
#include <memory>
#include <numeric>
#include <optional>
#include <span>
#include <string_view>
#include <system_error>
#include <utility>

#include "core/portable_math.h"
#include "io/bytes/expansion.h"
#include "io/bytes/file.h"
#include "io/bytes/known_kinds.h"
#include "io/cache/cache_layout.h"
#include "io/cache/maya_cache.h"
#include "io/gltf/gltf_motion.h"
#include "io/input/formats.h"
#include "io/input/input_files.h"
#include "io/input/numbering.h"
#include "io/input/sequence.h"
#include "io/input/targets.h"
#include "io/system/names.h"

namespace chronormal {

namespace {

Error misuse(std::string place, std::string message) {
  return Error{ErrorCode::kUsage, std::move(place), std::move(message)};
}

constexpr const char* kNoNodes =
    "--world is only for glTF files, whose nodes place meshes, and the input is not one; leave --world out";

Error not_animated(const std::string& input) {
  return misuse(input, "--animation is only for glTF files, and this file is not one; leave --animation out");
}

// Returns the error for options that choose keyframes (--from, --to, --every, --loop) of an input that is not a
// sequence.
Error chooses_nothing(const InputOptions& options) {
  return misuse(options.from > 0     ? "--from"
                : options.to         ? "--to"
                : options.every != 1 ? "--every"
                                     : "--loop",
                "this option is only for sequences of keyframes, and the input is not one; leave the option out");
}

// The result of opening an input: a document, a motion, or a mesh.
struct Opened {
  std::optional<GltfDocument> document;
  std::size_t file_size = 0;  // size of the file of the document in bytes
  ReadMotion read;            // motion and other data; for a document, empty until they are requested
};

// The next three functions return names for messages and tables: the name of a file, its name without folders, and one
// name for several files.
std::string name_of_file(const std::string& path) { return path == "-" ? "<stdin>" : path; }

std::string short_name(std::string path) {
  while (path.size() > 1 && is_separator(path.back())) path.pop_back();
  return file_name_of(path);
}

std::string name_of_files(const std::vector<std::string>& files) {
  return files.size() == 1 ? name_of_file(files.front())
                           : short_name(files.front()) + " ... " + short_name(files.back());
}

// The parts of an input that is a point cache: its file, the name of a channel after "#", and the format.
struct CacheInput {
  std::string path;
  std::string channel;
  const Format* format = nullptr;
};

std::optional<CacheInput> as_cache(const std::string& input) {
  const auto classify = [](std::string path, std::string channel) -> std::optional<CacheInput> {
    const Format* const format = find_format(path);
    if (format == nullptr || format->holds != Holds::kCache) return std::nullopt;
    return CacheInput{std::move(path), std::move(channel), format};
  };
  if (std::optional<CacheInput> whole = classify(input, "")) return whole;
  const std::size_t hash = input.rfind('#');
  if (hash == std::string::npos) return std::nullopt;
  return classify(input.substr(0, hash), input.substr(hash + 1));
}

Result<PositionCache> read_cache(const CacheInput& input, const CacheOptions& cache_options,
                                 const InputOptions& options) {
  if (input.format->read_cache == nullptr) return read_maya_cache(input.path, cache_options, options.resolve);
  const Result<FileBytes> file = FileBytes::open(input.path, options.resolve);
  if (!file) return file.error();
  const std::string_view bytes = file.value().bytes();
  const std::string name = file_name_of(input.path);
  if (const Status is_other = check_kind(bytes, name, input.format->name); !is_other) return is_other.error();
  return input.format->read_cache(bytes, name, cache_options);
}

std::vector<double> times_of(const Motion& motion) {
  std::vector<double> times;
  for (const Motion::Keyframe& keyframe : motion.keyframes) times.push_back(keyframe.time);
  return times;
}

// Removes all keyframes that the options do not choose from a motion that was read completely.
Status keep_chosen(const InputOptions& options, Motion& motion) {
  if (!options.chooses_frames()) return Success{};
  if (motion.kind == MotionKind::kTargets || motion.segments.empty()) return chooses_nothing(options);
  const Result<std::vector<std::size_t>> frames = choose_frames(motion.keyframes.size(), options);
  if (!frames) return frames.error();
  // If the chosen keyframes belong to several clips, between which the motion jumps, the motion stays of kind
  // kAnimation. Without a jump, the motion becomes an ordinary sequence (kSequence).
  const std::size_t last = options.to.value_or(motion.keyframes.size() - 1);
  bool jumps = false;
  for (std::size_t k = options.from + 1; k <= last && motion.kind == MotionKind::kAnimation; ++k)
    jumps = jumps || motion.keyframes[k - 1].time == motion.keyframes[k].time;
  if (jumps && (options.every != 1 || options.loop))
    return misuse(options.loop ? "--loop" : "--every",
                  "the chosen keyframes belong to several clips, between which the motion jumps; choose one clip with "
                  "--from and --to");
  std::vector<Motion::Keyframe> kept;
  for (const std::size_t k : frames.value()) {
    // The velocities at the ends of the chosen range are computed later, and may depend on this keyframe and on
    // keyframes that were not chosen. On curves and in loops, the keyframe is therefore copied and not moved.
    Motion::Keyframe& keyframe = motion.keyframes[k];
    kept.push_back(options.is_curved() || options.loop ? keyframe : std::move(keyframe));
  }
  const std::vector<double> times = times_of(motion);
  if (options.loop) kept.back().time = closing_time(times, frames.value());
  std::swap(motion.keyframes, kept);
  motion.connect(jumps ? MotionKind::kAnimation : MotionKind::kSequence);
  if (motion.segments.empty())
    return misuse(
        "--to",
        "nothing moves between the chosen keyframes, since the motion jumps there; choose others with --from and --to");
  const auto positions = [&kept](std::size_t k) -> Result<std::vector<float>> { return kept[k].positions; };
  return set_end_velocities(options, times, positions, motion);
}

// Makes a stream of the chosen keyframes of a motion whose positions are still in the file. The stream reads the file
// through its own descriptor, and does not map the file into memory.
Result<MotionStream> stream_samples(const InputOptions& options, Motion outline, PositionedFile file,
                                    CacheLayout layout, const std::string& name) {
  std::vector<std::size_t> frames(outline.keyframes.size());
  std::iota(frames.begin(), frames.end(), std::size_t{0});
  if (options.chooses_frames()) {
    Result<std::vector<std::size_t>> chosen = choose_frames(frames.size(), options);
    if (!chosen) return chosen.error();
    InputOptions without_ends = options;
    without_ends.path = path_name(PathKind::kLinear);
    const std::vector<double> times = times_of(outline);
    if (const Status status = keep_chosen(without_ends, outline); !status) return status.error();
    frames = std::move(chosen).value();
    const auto positions = [&](std::size_t k) -> Result<std::vector<float>> {
      std::vector<float> sample(3 * std::size_t{outline.topology.vertex_count()});
      if (Status status = read_sample(layout, file, name, k, sample); !status) return status.error();
      return sample;
    };
    if (const Status status = set_end_velocities(options, times, positions, outline); !status) return status.error();
  }
  layout.times = {};
  const auto shared = std::make_shared<const PositionedFile>(std::move(file));
  const auto read = [shared, layout, name, frames](const Motion&, std::size_t keyframe, std::span<float> positions) {
    return read_sample(layout, *shared, name, frames[keyframe], positions);
  };
  return MotionStream(std::move(outline), read, options.kept_bytes);
}

// Returns a cache that has the times of the samples of a layout, but no positions.
Result<PositionCache> outline_of(const CacheLayout& layout) {
  PositionCache cache{layout.vertex_count, {}, layout.origin};
  for (const double time : layout.times) cache.samples.push_back({time, {}});
  return cache;
}

// A cache file whose samples (the positions at one time) can be read one by one, and its layout. find_samples() returns
// nothing if the samples cannot be read one by one, or if the file has a fault. The reader of the whole file then
// reports the fault.
struct FoundSamples {
  PositionedFile file;
  CacheLayout layout;
};
std::optional<FoundSamples> find_samples(const CacheInput& input, const CacheOptions& cache_options,
                                         const InputOptions& options) {
  if (!options.stream || options.resolve || input.format->find_layout == nullptr) return std::nullopt;
  std::optional<PositionedFile> file = PositionedFile::open(input.path);
  if (!file) return std::nullopt;
  std::string start(static_cast<std::size_t>(std::min<std::uint64_t>(file->size(), kLayoutBytes)), '\0');
  if (!file->read(0, start)) return std::nullopt;
  Result<CacheLayout> layout = input.format->find_layout(start, file->size(), file_name_of(input.path), cache_options);
  if (!layout) return std::nullopt;
  return FoundSamples{std::move(*file), std::move(layout).value()};
}

// Adds a note if the positions in the file are float32 and so far from the origin that they have lost digits. `first`
// has the positions of the first keyframe.
void note_if_far(const Origin& origin, std::span<const float> first, ReadMotion& read) {
  if (origin != Origin{} || far_origin(first) == Origin{}) return;
  if (std::string note = note_of_lost_digits(first); !note.empty()) read.notes.push_back(std::move(note));
}

// Returns a warning if a cache seems to belong to another mesh, or to have the vertices of this mesh in another order.
// Otherwise returns an empty text.
//
// A motion usually keeps the lengths of edges, or changes them smoothly. If the vertices are in a wrong order, each
// edge connects two arbitrary points of the mesh, so edges become much longer in all but the smallest meshes. For small
// meshes, the coordinates are compared too, separately on each axis. If the cache has the same coordinates as the mesh
// in another order, its vertices are in another order.
std::string doubt_of_cache(const Topology& faces, const std::vector<float>& mesh, const std::vector<float>& first) {
  constexpr double kTolerance = 1e-4, kFarther = 2, kSpread = 0.15;
  // The largest number of coordinates that are sorted and compared. Sorting no more than this number takes little time.
  constexpr std::size_t kFewCoordinates = 1 << 20;
  const std::size_t vertices = faces.vertex_count();
  double size = 0, moved = 0, radius_of_mesh = 0, radius = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double low = mesh[axis], high = low, sum_of_mesh = 0, sum = 0;
    for (std::size_t v = 0; v < vertices; ++v) {
      const double a{mesh[3 * v + axis]}, b{first[3 * v + axis]};
      low = std::min(low, a);
      high = std::max(high, a);
      moved = std::max(moved, std::fabs(a - b));
      sum_of_mesh += a;
      sum += b;
    }
    size = std::max(size, high - low);
    for (std::size_t v = 0; v < vertices; ++v) {
      const double a = double{mesh[3 * v + axis]} - sum_of_mesh / static_cast<double>(vertices),
                   b = double{first[3 * v + axis]} - sum / static_cast<double>(vertices);
      radius_of_mesh += a * a;
      radius += b * b;
    }
  }
  if (!(size > 0) || moved <= kTolerance * size || !(radius > 0)) return "";
  std::vector<double> ratios;
  double sum_of_mesh = 0, sum = 0;
  for (std::size_t f = 0; f < faces.face_count(); ++f) {
    const auto face = faces.face(f);
    for (std::size_t c = 0; c < face.size(); ++c) {
      const std::size_t a = face[c], b = face[c + 1 < face.size() ? c + 1 : 0];
      const auto length = [&](const std::vector<float>& of) {
        const double x = double{of[3 * a]} - double{of[3 * b]}, y = double{of[3 * a + 1]} - double{of[3 * b + 1]},
                     z = double{of[3 * a + 2]} - double{of[3 * b + 2]};
        return std::sqrt(x * x + y * y + z * z);
      };
      const double in_mesh = length(mesh), in_cache = length(first);
      sum_of_mesh += in_mesh;
      sum += in_cache;
      if (in_mesh > 0 && in_cache > 0) ratios.push_back(portable::log(in_cache / in_mesh));
    }
  }
  const auto median = [](std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::nth_element(values.begin(), middle, values.end());
    return *middle;
  };
  if (ratios.empty() || !(sum_of_mesh > 0) || !(radius_of_mesh > 0)) return "";
  const double usual = median(ratios);
  for (double& ratio : ratios) ratio = std::fabs(ratio - usual);
  const double spread = median(ratios);
  if (spread <= kSpread) return "";
  bool is_shuffled = 3 * vertices <= kFewCoordinates;
  for (std::size_t axis = 0; axis < 3 && is_shuffled; ++axis) {
    std::vector<float> a, b;
    for (std::size_t v = 0; v < vertices; ++v) {
      a.push_back(mesh[3 * v + axis]);
      b.push_back(first[3 * v + axis]);
    }
    std::sort(a.begin(), a.end());
    std::sort(b.begin(), b.end());
    for (std::size_t v = 0; v < vertices; ++v)
      is_shuffled = is_shuffled && std::fabs(double{a[v]} - double{b[v]}) <= kTolerance * size;
  }
  if (is_shuffled)
    return "the cache has the vertices of this mesh in another order, so the result is wrong; export mesh and cache "
           "together, without reordering vertices";
  const double farther = sum / std::sqrt(radius) / (sum_of_mesh / std::sqrt(radius_of_mesh));
  if (farther < kFarther && farther > 1 / kFarther) return "";
  return "the cache does not seem to belong to this mesh, or has its vertices in another order, since the edges of its "
         "first frame, compared with the size of the model, are " +
         std::to_string(farther).substr(0, 4) + " times as long as those of the mesh; export mesh and cache together";
}

Result<ReadMotion> read_cache_over_mesh(const CacheInput& input, const std::string& mesh_input,
                                        const InputOptions& options) {
  InputOptions of_mesh = options;
  of_mesh.files = {mesh_input};
  const Result<std::vector<std::string>> meshes = find_frames(of_mesh);
  if (!meshes) return meshes.error();
  if (meshes.value().size() != 1)
    return misuse(mesh_input, "a cache needs exactly one mesh, but this input names " +
                                  std::to_string(meshes.value().size()) + " files; name a single file");
  const std::string& mesh_path = meshes.value().front();
  ReadMotion read;
  Result<FileBytes> file = FileBytes::open(mesh_path, options.resolve);
  if (!file) return file.error();
  Result<MeshFrame> mesh = read_next_mesh(options, file.value().bytes(), mesh_path, file_name_of(mesh_path), read);
  if (!mesh) return mesh.error();
  Topology faces = std::move(mesh.value().topology);
  if (options.progress) options.progress(1, 2);
  const CacheOptions cache_options{options.frames_per_second, faces.vertex_count(), input.channel};
  std::optional<FoundSamples> samples = find_samples(input, cache_options, options);
  Result<PositionCache> cache = samples ? outline_of(samples->layout) : read_cache(input, cache_options, options);
  if (!cache) return cache.error();
  const Origin of_mesh_origin = read.motion.origin, of_cache_origin = cache.value().origin;
  // A cache may consist of several files, so the total size is estimated from the number of positions.
  read.bytes_read += sizeof(float) * 3 * std::uint64_t{cache.value().vertex_count} * cache.value().samples.size();
  if (options.progress) options.progress(2, 2);
  Result<Motion> motion =
      motion_from_cache(std::move(faces), std::move(cache).value(), file_name_of(mesh_path), file_name_of(input.path));
  if (!motion) return motion.error();
  std::vector<float> first(mesh.value().positions.size());
  if (samples) {
    if (!read_sample(samples->layout, samples->file, file_name_of(input.path), 0, first))
      first = mesh.value().positions;
  } else {
    first = motion.value().keyframes.front().positions;
  }
  note_if_far(of_cache_origin, first, read);
  for (std::size_t i = 0; i < first.size(); ++i)
    first[i] = static_cast<float>(double{first[i]} + of_cache_origin[i % 3] - of_mesh_origin[i % 3]);
  if (std::string doubt = doubt_of_cache(motion.value().topology, mesh.value().positions, first); !doubt.empty())
    read.notes.push_back(std::move(doubt));
  if (samples) {
    Result<MotionStream> stream = stream_samples(options, std::move(motion).value(), std::move(samples->file),
                                                 std::move(samples->layout), file_name_of(input.path));
    if (!stream) return stream.error();
    read.stream = std::move(stream).value();
    return read;
  }
  read.motion = std::move(motion).value();
  if (Status status = keep_chosen(options, read.motion); !status) return status.error();
  return read;
}

// Reads a mesh without motion, as a motion of a single keyframe.
Result<ReadMotion> read_still_mesh(std::string_view bytes, const std::string& path, const InputOptions& options) {
  if (options.chooses_frames()) return chooses_nothing(options);
  ReadMotion read;
  Result<MeshFrame> mesh = read_next_mesh(options, bytes, path, file_name_of(path), read);
  if (!mesh) return mesh.error();
  read.motion.topology = std::move(mesh.value().topology);
  read.motion.keyframes.push_back({std::move(mesh.value().positions), 0, file_name_of(path)});
  return read;
}

// Returns true if an input is a single file that may hold everything: positions, faces and motion. Patterns and folders
// do not count. A mesh file counts only if meshes without motion are allowed.
bool may_be_whole(const std::string& input, const InputOptions& options) {
  const Format* const format = find_format(input);
  if (format != nullptr && format->holds == Holds::kMesh && !options.allow_mesh) return false;
  if (as_cache(input)) return false;
  if (input == "-" || options.resolve) return true;
  if (format != nullptr && format->holds != Holds::kMesh) return true;
  std::error_code code;
  const std::filesystem::file_status status = std::filesystem::status(path_of(input), code);
  return std::filesystem::exists(status) && !std::filesystem::is_directory(status);
}

Result<Opened> open_document(FileBytes file, const std::string& path, const InputOptions& options) {
  if (options.chooses_frames()) return chooses_nothing(options);
  std::optional<std::string> folder;
  if (path != "-") folder = folder_of(path);
  Opened opened;
  opened.file_size = file.bytes().size();
  Result<GltfDocument> document = GltfDocument::read(std::move(file), file_name_of(path), folder,
                                                     {.allow_external = options.allow_external,
                                                      .max_expansion = options.max_expansion,
                                                      .strict = options.strict,
                                                      .resolve = options.resolve});
  if (!document) return document.error();
  opened.document = std::move(document).value();
  return opened;
}

// Reads a file with a whole motion. If the positions at each time can be read one by one, leaves the positions in the
// file.
Status read_whole_motion(const Format& format, std::string_view bytes, const std::string& path,
                         const InputOptions& options, ReadMotion& read) {
  const std::string name = file_name_of(path);
  read.bytes_read = bytes.size();
  if (Status is_other = check_kind(bytes, name, format.name); !is_other) return is_other;
  std::optional<PositionedFile> file;
  if (options.stream && !options.resolve && format.read_outline != nullptr) file = PositionedFile::open(path);
  std::optional<CacheLayout> layout;
  Result<Motion> motion =
      file ? format.read_outline(bytes, name, options.frames_per_second, options.max_expansion, layout)
           : format.read_motion(bytes, name, options.frames_per_second, options.max_expansion);
  if (!motion) return motion.error();
  std::vector<float> first;
  if (!layout) {
    read.motion = std::move(motion).value();
    note_if_far(read.motion.origin, read.motion.keyframes.front().positions, read);
    return keep_chosen(options, read.motion);
  }
  // An error in the first sample is ignored here. The sample is read again later, and the error is reported then.
  first.resize(layout->coordinates());
  if (read_sample(*layout, *file, name, 0, first)) note_if_far(layout->origin, first, read);
  Result<MotionStream> stream =
      stream_samples(options, std::move(motion).value(), std::move(*file), std::move(*layout), name);
  if (!stream) return stream.error();
  read.stream = std::move(stream).value();
  return Success{};
}

Result<Opened> open_whole(const std::string& path, const InputOptions& options) {
  Result<FileBytes> file = FileBytes::open(path, options.resolve);
  if (!file) return file.error();
  const std::string_view bytes = file.value().bytes();
  if (std::string way = way_in(file_name_of(path), bytes); !way.empty())
    return invalid_input(file_name_of(path), std::move(way));
  const Format* const format = find_format(path, bytes);
  if (format != nullptr && format->holds == Holds::kGltf) return open_document(std::move(file).value(), path, options);
  if (!options.animation.empty()) return not_animated(path);
  Opened opened;
  if (format != nullptr && format->holds == Holds::kMotion) {
    const Status read = read_whole_motion(*format, bytes, path, options, opened.read);
    if (!read) return read.error();
  } else if (options.allow_mesh && format == nullptr) {
    return invalid_input(file_name_of(path), unknown_format(bytes, "in a format that can be read") + "; give " +
                                                 extensions_of({Holds::kGltf, Holds::kMotion, Holds::kMesh}) + ", or " +
                                                 extensions_of({Holds::kCache}) + " after a mesh, or " +
                                                 extensions_of({Holds::kTarget}) + " with --base");
  } else if (options.allow_mesh) {
    Result<ReadMotion> mesh = read_still_mesh(bytes, path, options);
    if (!mesh) return mesh.error();
    opened.read = std::move(mesh).value();
  } else {
    return invalid_input(file_name_of(path), unknown_format(bytes, "a motion") + "; give a file with a motion (" +
                                                 extensions_of({Holds::kGltf, Holds::kMotion}) +
                                                 "), or two or more files of a sequence (" +
                                                 extensions_of({Holds::kMesh}, " or ") + ")");
  }
  if (options.progress) options.progress(1, 1);
  return opened;
}

// Reads an input of several files: a cache with its mesh, or a sequence.
Result<ReadMotion> read_several(const InputOptions& options) {
  const std::vector<std::string>& inputs = options.files;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const std::optional<CacheInput> cache = as_cache(inputs[i]);
    if (!cache) continue;
    if (inputs.size() != 2 || as_cache(inputs[1 - i]))
      return misuse(inputs[i], "a cache has no faces; give it together with one mesh (" +
                                   extensions_of({Holds::kMesh}, " or ") + ")");
    if (!options.animation.empty()) return not_animated(inputs[i]);
    return read_cache_over_mesh(*cache, inputs[1 - i], options);
  }
  for (const std::string& input : inputs) {
    const Format* const format = find_format(input);
    if (format != nullptr && (format->holds == Holds::kGltf || format->holds == Holds::kMotion))
      return misuse(input, "this file holds a whole motion, so no other input can be given; leave the others out");
  }
  if (!options.animation.empty()) return not_animated(inputs.front());
  std::vector<std::string> notes;
  const Result<std::vector<std::string>> files = find_frames(options, &notes);
  if (!files) return files.error();
  if (files.value().size() > 1 || !options.allow_mesh) {
    Result<ReadMotion> read = options.stream && !options.resolve ? stream_sequence(files.value(), options)
                                                                 : read_sequence(files.value(), options);
    if (read) read.value().notes.insert(read.value().notes.begin(), notes.begin(), notes.end());
    return read;
  }
  const Result<FileBytes> file = FileBytes::open(files.value().front(), options.resolve);
  if (!file) return file.error();
  return read_still_mesh(file.value().bytes(), files.value().front(), options);
}

}  // namespace

Status check_input(const InputOptions& options) {
  if (!(options.frames_per_second >= 1e-9 && options.frames_per_second <= 1e9))
    return misuse("--fps", "the frame rate must be a number from 1e-9 to 1e9");
  if (const Result<Path> path = make_path(options.path); !path) return misuse("--path", path.error().message);
  if (options.world && (!options.base.empty() || !options.samples.empty() || options.files.size() > 1))
    return misuse("--world", kNoNodes);
  if (!options.animation.empty() && (!options.base.empty() || options.files.empty()))
    return misuse("--animation", "--animation is only for glTF files; name a glTF file as the input");
  if (!options.base.empty()) {
    if (!options.samples.empty())
      return misuse("--base", "--sample cannot be used with --base; give targets as .obj, .ply or .target files");
    if (options.files.empty()) return misuse("--base", "the targets of the base are missing; name their files");
    if (options.chooses_frames()) return chooses_nothing(options);
    if (options.frames_per_second != 1)
      return misuse("--fps",
                    "--fps has no meaning with --base, since targets have weights and no times; leave --fps out");
    return Success{};
  }
  if (options.files.empty() && options.samples.empty())
    return misuse("", "there is no input; name a file, a folder or several keyframes, or --sample NAME");
  if (options.samples.size() + (options.files.empty() ? 0 : 1) > 1)
    return misuse("", "--sample is an input of its own; give either files or one --sample");
  for (const std::string& file : options.files) {
    if (file.empty()) return misuse("", "the name of a file is empty; give the name of a file or folder");
    const Format* const format = find_format(file);
    if (format != nullptr && format->holds == Holds::kTarget)
      return misuse(file, "a target needs the mesh that it changes; name that mesh with --base FILE");
  }
  return Success{};
}

struct Input::State {
  std::string name;
  Opened opened;
  Expansion expansion;       // limit of memory for all inputs except documents
  GltfMotionOptions chosen;  // the options with which the document is read
  bool allow_mesh = false, strict = false;
  Path path;
  std::size_t most_pieces = kMostPieces, kept_bytes = 0;
  std::optional<CutPath> cut, cut_of_skins;
  std::optional<Error> cut_error;
  // The next members are only used for a glTF document, and are set when they are first requested.
  bool has_motion = true, has_normals = true;
  std::vector<GltfPart> parts;
  double curve_error = 0;
  std::vector<double> key_times;

  [[nodiscard]] Status read_motion();
  [[nodiscard]] Status cut_motion();
};

Status Input::State::read_motion() {
  if (has_motion) return Success{};
  const GltfDocument& document = *opened.document;
  const bool is_mesh = allow_mesh && chosen.animation.empty() && !has_moving_targets(document);
  Result<GltfMotion> read = is_mesh ? read_gltf_mesh(document, chosen) : read_gltf_motion(document, chosen);
  if (!read) return read.error();
  for (const Error& fault : read.value().unread_skins) {
    if (strict) return fault;
    opened.read.notes.push_back(fault.text() + "; the mesh is moved without its skin");
  }
  opened.read.motion = std::move(read.value().motion);
  parts = std::move(read.value().parts);
  curve_error = read.value().curve_error;
  key_times = std::move(read.value().key_times);
  cut_of_skins = read.value().cut;
  has_motion = true;
  return Success{};
}

// Replaces a motion along curves by straight segments. Later calls do nothing.
Status Input::State::cut_motion() {
  if (cut) return Success{};
  if (cut_error) return *cut_error;
  Status status = opened.document && path.is_curved()
                      ? misuse("",
                               "--path is only for sequences of keyframes, since weights move the vertices of a glTF "
                               "file; leave --path out")
                      : check_path(opened.read.stream->motion(), path.kind);
  if (status) {
    Result<CutStream> made = cut_into_segments(std::move(*opened.read.stream), path, most_pieces, kept_bytes);
    if (made) {
      cut = cut_of_skins ? cut_of_skins : made.value().cut;
      opened.read.stream = std::move(made.value().stream);
      return Success{};
    }
    cut_error = made.error();
  } else {
    cut_error = status.error();
  }
  if (cut_error->place.empty()) cut_error->place = "--path";
  return *cut_error;
}

Input::Input(std::unique_ptr<State> state) noexcept : state_(std::move(state)) {}
Input::Input(Input&&) noexcept = default;
Input& Input::operator=(Input&&) noexcept = default;
Input::~Input() = default;

const std::string& Input::name() const noexcept { return state_->name; }
Expansion Input::expansion() const { return document() != nullptr ? document()->expansion() : state_->expansion; }
std::size_t Input::file_size() const noexcept { return state_->opened.file_size; }
const GltfDocument* Input::document() const noexcept {
  return state_->opened.document ? &*state_->opened.document : nullptr;
}
std::span<const std::uint32_t> Input::group_of_face() const noexcept { return state_->opened.read.group_of_face; }
std::vector<std::string> Input::notes() const {
  std::vector<std::string> notes = state_->opened.read.notes;
  if (document() != nullptr)
    for (const Error& note : document()->notes()) notes.push_back(note.text());
  return notes;
}
const std::optional<FileSeries>& Input::series() const noexcept { return state_->opened.read.series; }
const std::string& Input::shaded_by() const noexcept { return state_->opened.read.shaded_by; }
std::span<const GltfPart> Input::parts() const noexcept { return state_->parts; }
double Input::curve_error() const noexcept { return state_->curve_error; }
const CutPath& Input::cut_path() const noexcept {
  static const CutPath kNone;
  return state_->cut ? *state_->cut : kNone;
}

Result<MotionStream*> Input::stream() {
  if (const Status status = state_->read_motion(); !status) return status.error();
  ReadMotion& read = state_->opened.read;
  if (!read.stream) read.stream.emplace(read.motion);
  if (const Status status = state_->cut_motion(); !status) return status.error();
  return &*read.stream;
}

Result<const Motion*> Input::motion() {
  const Result<MotionStream*> read = stream();
  if (!read) return read.error();
  if (const Status status = read.value()->hold_all(); !status) return status.error();
  return &read.value()->motion();
}

Result<std::size_t> Input::keyframe_count() {
  const Result<MotionStream*> read = stream();
  if (!read) return read.error();
  return read.value()->motion().keyframes.size();
}

Result<const Motion::Keyframe*> Input::keyframe(std::size_t k) {
  const Result<MotionStream*> read = stream();
  if (!read) return read.error();
  assert(k < read.value()->motion().keyframes.size());
  if (const Status status = read.value()->hold(k, k); !status) return status.error();
  return &read.value()->motion().keyframes[k];
}

Result<std::vector<double>> Input::key_times() {
  const Result<MotionStream*> read = stream();
  if (!read) return read.error();
  if (!state_->key_times.empty()) return state_->key_times;
  std::vector<double> times;
  for (const Motion::Keyframe& keyframe : read.value()->motion().keyframes) times.push_back(keyframe.time);
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

Result<const StoredNormals*> Input::normals() {
  StoredNormals& normals = state_->opened.read.normals;
  if (!state_->has_normals) {
    const Result<const Motion*> read = motion();
    if (!read) return read.error();
    Result<std::vector<float>> of_corners = read_gltf_corner_normals(*document(), *read.value(), state_->parts);
    if (!of_corners) return of_corners.error();
    if (!of_corners.value().empty()) normals.of_keyframes.push_back(std::move(of_corners).value());
    state_->has_normals = true;
  }
  return &normals;
}

Result<std::vector<float>> Input::normals_of(std::size_t k) {
  const Result<const StoredNormals*> kept = normals();
  if (!kept) return kept.error();
  const std::vector<std::vector<float>>& of_keyframes = kept.value()->of_keyframes;
  if (k < of_keyframes.size()) return of_keyframes[k];
  const ReadMotion& read = state_->opened.read;
  if (!read.read_normals || state_->path.is_curved()) return std::vector<float>();
  return read.read_normals(k);
}

Result<Input> open_input(const InputOptions& asked) {
  if (const Status status = check_input(asked); !status) return status.error();
  auto state = std::make_unique<Input::State>();
  state->path = make_path(asked.path).value();
  state->most_pieces = asked.max_expansion;
  state->kept_bytes = asked.kept_bytes;
  InputOptions options = asked;
  options.velocities = asked.velocities || state->path.kind == PathKind::kHermite;
  const auto keep = [&](std::string name, Result<ReadMotion> read) -> Result<Input> {
    if (!read) return read.error();
    state->name = std::move(name);
    state->opened.read = std::move(read).value();
    StoredNormals& normals = state->opened.read.normals;
    if (state->path.is_curved() && normals.of_keyframes.size() > 1) normals.of_keyframes.resize(1);
    state->expansion = Expansion(options.max_expansion, state->opened.read.bytes_read);
    return Input(std::move(state));
  };
  if (!options.samples.empty()) {
    Result<Motion> motion = make_builtin_morph(options.samples.front());
    if (!motion) return motion.error();
    if (const Status status = keep_chosen(options, motion.value()); !status) return status.error();
    ReadMotion read;
    read.motion = std::move(motion).value();
    Result<Input> input = keep(options.samples.front(), std::move(read));
    input.value().state_->expansion = Expansion::unlimited();
    return input;
  }
  if (!options.base.empty()) return keep(name_of_file(options.base), read_targets(options));
  if (options.files.size() > 1 || !may_be_whole(options.files.front(), options)) {
    std::vector<std::string> files = options.files;
    (void)sort_listed(files);  // in the same order as find_frames()
    return keep(name_of_files(files), read_several(options));
  }

  Result<Opened> opened = open_whole(options.files.front(), options);
  if (!opened) return opened.error();
  if (!opened.value().document) {
    if (options.world) return misuse("--world", kNoNodes);
    return keep(name_of_files(options.files), std::move(opened.value().read));
  }
  if (options.frames_per_second != 1)
    return misuse("--fps",
                  "--fps has no meaning for a glTF file, whose animations have times in seconds; leave --fps out");
  state->name = name_of_files(options.files);
  state->opened = std::move(opened).value();
  state->expansion = Expansion(options.max_expansion, state->opened.read.bytes_read);
  if (state->opened.document) {
    state->chosen.animation = options.animation;
    state->chosen.world = options.world;
    state->chosen.skins = options.skins;
    state->chosen.most_pieces = options.max_expansion;
    state->allow_mesh = options.allow_mesh;
    state->strict = options.strict;
    state->has_motion = state->has_normals = false;
    state->opened.read.shaded_by = state->name;
  }
  return Input(std::move(state));
}

}  // namespace chronormal
