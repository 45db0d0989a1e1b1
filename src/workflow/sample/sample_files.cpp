// Chooses the names of sample files, and writes each pose into a file as soon as it is computed.
#include "chronormal/workflow/sample.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <filesystem>
#include <memory>
#include <system_error>
#include <utility>

#include "chronormal/io/output.h"
#include "core/bits.h"
#include "core/charconv.h"
#include "io/bytes/binary.h"
#include "io/bytes/checksum.h"
#include "io/bytes/output_file.h"
#include "io/cache/npy.h"
#include "io/cache/npz.h"
#include "io/mesh/obj.h"
#include "io/mesh/ply.h"
#include "io/system/names.h"
#include "workflow/sample/continued_samples.h"
#include "workflow/sample/sample_part.h"
#include "workflow/sample/scheme_normals.h"

namespace chronormal {
namespace {

struct FormatName {
  SampleFormat format;
  std::string_view name, extension;
};

constexpr std::array<FormatName, 4> kFormats = {{
    {SampleFormat::kNpy, "npy", ".npy"},
    {SampleFormat::kNpz, "npz", ".npz"},
    {SampleFormat::kPly, "ply", ".ply"},
    {SampleFormat::kObj, "obj", ".obj"},
}};

bool is_array(SampleFormat format) { return format == SampleFormat::kNpy || format == SampleFormat::kNpz; }

Result<Pose> pose_of(NormalSampler& sampler, MotionStream& stream, const Moments& moments, std::size_t i) {
  if (!moments.times.empty()) return sampler.at_time(moments.times[i]);
  if (!moments.weights.empty()) return sampler.at_weights(moments.weights[i]);
  if (const Status status = stream.hold(0, 0); !status) return status.error();
  return sampler.at_rest();
}

// Checks the moments of a sampling before any normal is computed, as far as possible.
Status check_moments(const Motion& motion, const SampleOptions& options, const Moments& moments) {
  assert(moments.times.empty() || moments.weights.empty());
  for (const double time : moments.times) {
    if (const Result<Instant> instant = find_instant(motion, time); !instant) return instant.error();
  }
  for (const auto& weights : moments.weights) {
    if (Status status = check_weights(motion, weights); !status) return status;
    if (options.scheme.empty()) continue;
    if (const Result<TargetWeight> own = one_target_of(weights); !own) return own.error();
  }
  return Success{};
}

VectorView<const float> packed(const std::vector<float>& values) {
  return VectorView<const float>::packed(values.data(), values.size() / 3);
}

std::size_t count_zeros(const std::vector<float>& normals) {
  std::size_t zeros = 0;
  for (std::size_t i = 0; i < normals.size(); i += 3)
    zeros += normals[i] == 0 && normals[i + 1] == 0 && normals[i + 2] == 0 ? 1U : 0U;
  return zeros;
}

bool is_first_process(const SegmentRun& run) { return !run.shard || run.shard->index == 0; }

// A .npy or .npz file that grows row by row.
class ArrayFile {
 public:
  ArrayFile(OutputFile file, SampleFormat format) : file_(std::make_unique<OutputFile>(std::move(file))) {
    if (format == SampleFormat::kNpz) npz_.emplace(*file_);
  }

  // Begins the file, so that the row of the first moment of this process's share comes next. With peers, all processes
  // write to the same file. `header` is the header of a .npy file.
  [[nodiscard]] Status begin(const Motion& motion, const Moments& moments, const SegmentRun& run, std::size_t outputs,
                             std::string_view header) {
    const IndexRange share = run.share();
    const bool is_first = is_first_process(run);
    const std::vector<std::uint64_t> shape = {run.peers ? moments.count() : share.count, outputs, 3};
    // The number of bytes in the rows before the share of this process.
    const std::uint64_t before = std::uint64_t{share.first} * 3 * sizeof(float);
    if (!npz_) {
      checksum_ = checksum_of(header);
      if (run.peers == nullptr) return file_->append(header);
      at_ = header.size() + before * outputs;
      return is_first ? file_->put(0, header) : Status(Success{});
    }
    std::vector<double> values = moments.times;
    std::vector<std::uint64_t> when_shape = {moments.count()};
    if (moments.weights.empty() && values.empty()) values = {motion.keyframes[0].time};
    if (!moments.weights.empty()) when_shape.push_back(motion.segments.size());
    for (const auto& weights : moments.weights) values.insert(values.end(), weights.begin(), weights.end());
    const NpyBytes when(when_shape, values);
    const Result<std::string> faces = write_npy_faces(motion.topology);
    normals_ = npz_->add_growing("normals", shape);
    npz_->add({moments.weights.empty() ? "times" : "weights", when.bytes()});
    origin_ = motion.origin;
    positions_ = npz_->add_growing("positions", {moments.count(), motion.topology.vertex_count(), 3}, is_far());
    if (faces) npz_->add({"faces", faces.value()});
    if (run.peers == nullptr || is_first) return npz_->begin();
    npz_->join();
    npz_->skip(normals_, before * outputs);
    npz_->skip(positions_, (is_far() ? 2 : 1) * before * motion.topology.vertex_count());
    return Success{};
  }

  // Appends the row of one moment. If there is a journal, a row of a .npy file also gets a record in the journal.
  [[nodiscard]] Status append(const std::vector<float>& normals, const Pose& pose, std::size_t zeros,
                              Journal* journal) {
    if (!npz_) {
      const std::string_view bytes = bytes_of(normals);
      if (at_) return file_->put(std::exchange(*at_, *at_ + bytes.size()), bytes);
      checksum_ = checksum_of(bytes, checksum_);
      if (Status status = file_->append(bytes); !status || journal == nullptr) return status;
      return journal->append(WrittenRow::of(bytes, zeros).text());
    }
    const Status status = npz_->append(normals_, bytes_of(normals));
    if (!status) return status;
    return is_far() ? npz_->append(positions_, placed_bytes(pose.positions, origin_))
                    : npz_->append(positions_, bytes_of(pose.positions));
  }

  // Continues the .npy file of an earlier run. `checksum` is the checksum of the bytes that the file already has.
  void go_on(std::uint32_t checksum) { checksum_ = checksum; }
  [[nodiscard]] std::uint32_t checksum() const { return checksum_; }
  // Appends the text with which the file of a shard ends, after the last row.
  [[nodiscard]] Status append_end(std::string_view text) { return file_->append(text); }

  // Returns the checksums of the rows that this process wrote. To end the file, the first process needs the checksums
  // of all other processes.
  [[nodiscard]] std::array<std::uint32_t, 2> checksums() const {
    if (!npz_) return {};
    return {npz_->checksum(normals_), npz_->checksum(positions_)};
  }
  void add(const std::array<std::uint32_t, 2>& checksums, std::uint64_t normals, std::uint64_t positions) {
    if (!npz_) return;
    npz_->add_checksum(normals_, checksums[0], normals * 3 * sizeof(float));
    npz_->add_checksum(positions_, checksums[1], positions * 3 * (is_far() ? sizeof(double) : sizeof(float)));
  }

  // Ends the work on the shared file. All processes except the first call this function.
  [[nodiscard]] Status seal() { return file_->seal(); }
  [[nodiscard]] Status finish_joined() { return file_->finish(); }

  [[nodiscard]] Status finish() {
    const Status status = npz_ ? npz_->finish() : Status(Success{});
    return status ? file_->finish() : status;
  }

 private:
  [[nodiscard]] bool is_far() const { return origin_ != Origin{}; }
  [[nodiscard]] std::string_view bytes_of(const std::vector<float>& values) {
    return binary::bytes_of(values, std::endian::little, storage_);
  }

  std::unique_ptr<OutputFile> file_;  // on the heap, because npz_ keeps its address
  std::optional<NpzOutput> npz_;
  std::size_t normals_ = 0, positions_ = 0;  // the indices of arrays in npz_
  Origin origin_ = {};                       // the origin to which the positions are relative
  std::optional<std::uint64_t> at_;          // the offset of the next row in the .npy file that all peers share
  std::uint32_t checksum_ = 0;               // the checksum of all bytes so far of a .npy file that no peers share
  std::string storage_;
};

// A guard that removes a partial output at the end of the run if the output has no rows. A later run would find nothing
// to continue in such a file.
struct EmptyPartial {
  EmptyPartial() = default;
  EmptyPartial(const EmptyPartial&) = delete;
  EmptyPartial& operator=(const EmptyPartial&) = delete;
  ~EmptyPartial() {
    std::error_code ignored;
    if (!name.empty() && journal->is_empty()) std::filesystem::remove(path_of(name), ignored);
  }

  std::string name;  // the path of the partial output; empty if there is none
  const Journal* journal = nullptr;
};

// Returns the text of a .ply or .obj file with the mesh at one moment.
std::string mesh_file(const Motion& motion, const NormalSampler& sampler, const Pose& pose,
                      const std::vector<float>& normals, ElementKind kind, SampleFormat format) {
  const Topology& topology = motion.topology;
  const Origin& origin = motion.origin;
  if (format == SampleFormat::kPly) {
    PlyProperties properties;
    (kind == ElementKind::kFaces ? properties.of_faces : properties.of_vertices) = packed(normals);
    return write_ply(topology, packed(pose.positions), properties, PlyEncoding::kBinaryLittleEndian, origin);
  }
  if (kind == ElementKind::kVertices)
    return write_obj(topology, packed(pose.positions), packed(normals), topology.corners(), origin);
  if (kind == ElementKind::kCorners)
    return write_obj(topology, packed(pose.positions), packed(pose.normals), sampler.element_of_output(), origin);
  std::vector<std::uint32_t> face_of_corner;
  for (std::size_t f = 0; f < topology.face_count(); ++f)
    face_of_corner.insert(face_of_corner.end(), topology.face(f).size(), static_cast<std::uint32_t>(f));
  return write_obj(topology, packed(pose.positions), packed(normals), face_of_corner, origin);
}

// Begins the output file. If there are peers, the first process creates the file, and all other processes open it.
Result<OutputFile> begin_file(const SampleOutput& output, const SegmentRun& run) {
  if (run.peers != nullptr && !is_first_process(run)) return OutputFile::join(output.path, run.peers->broadcast(""));
  Result<OutputFile> file = OutputFile::create(output.path, output.force);
  if (file && run.peers != nullptr) (void)run.peers->broadcast(file.value().temporary_name());
  return file;
}

Status finish_all(std::vector<OutputFile>& meshes) {
  for (OutputFile& mesh : meshes) {
    if (Status status = mesh.finish(); !status) return status;
  }
  return Success{};
}

// The message that a process sends to the first process after it has written all of its rows.
struct Written {
  SampleSummary summary;
  std::uint64_t positions = 0;
  std::array<std::uint32_t, 2> checksums{};

  [[nodiscard]] std::string text() const {
    std::string numbers;
    for (const std::uint64_t number :
         {std::uint64_t{summary.normals}, std::uint64_t{summary.zeros}, positions, std::uint64_t{checksums[0]},
          std::uint64_t{checksums[1]}, bit_cast<std::uint64_t>(summary.drift.largest),
          std::uint64_t{summary.drift.output}, bit_cast<std::uint64_t>(summary.drift.time)})
      numbers += std::to_string(number) + ' ';
    return numbers;
  }
  [[nodiscard]] static Written read(const std::string& text) {
    std::array<std::uint64_t, 8> numbers{};
    const char* at = text.data();
    for (std::uint64_t& number : numbers) at = from_chars(at, text.data() + text.size(), number).ptr + 1;
    const Drift drift{bit_cast<double>(numbers[5]), static_cast<std::size_t>(numbers[6]), bit_cast<double>(numbers[7])};
    return {{static_cast<std::size_t>(numbers[0]), static_cast<std::size_t>(numbers[1]), drift},
            numbers[2],
            {static_cast<std::uint32_t>(numbers[3]), static_cast<std::uint32_t>(numbers[4])}};
  }
};

// Waits until all processes have written their files, and then gives the files their names. The first process returns
// after all other processes have named their files.
Result<SampleSummary> finish_with_peers(const SegmentRun& run, Written own, ArrayFile* arrays,
                                        std::vector<OutputFile>& meshes) {
  const bool is_first = is_first_process(run);
  if (arrays != nullptr) {
    own.checksums = arrays->checksums();
    if (Status status = is_first ? Status(Success{}) : arrays->seal(); !status) return status.error();
  }
  const std::vector<std::string> all = run.peers->gather(own.text());
  for (std::size_t i = 1; i < all.size(); ++i) {
    const Written other = Written::read(all[i]);
    own.summary.normals += other.summary.normals;
    own.summary.zeros += other.summary.zeros;
    if (other.summary.drift.largest > own.summary.drift.largest) own.summary.drift = other.summary.drift;
    if (arrays != nullptr) arrays->add(other.checksums, other.summary.normals, other.positions);
  }
  if (arrays != nullptr && is_first) {
    if (Status status = arrays->finish(); !status) return status.error();
  }
  (void)run.peers->broadcast("");
  if (Status status = finish_all(meshes); !status) return status.error();
  if (arrays != nullptr && !is_first) {
    if (Status status = arrays->finish_joined(); !status) return status.error();
  }
  (void)run.peers->gather("");
  return own.summary;
}

// Returns the text at the end of the file of a shard. `array` is the checksum of all bytes before this text.
Result<std::string> end_of_part(const Motion& motion, const SampleOptions& options, const Moments& moments,
                                const SegmentRun& run, const NormalSampler& sampler, std::uint32_t array,
                                KeyframeChecksums& seen) {
  SamplePart part{run.share().first, moments.count(), array};
  NumberChecksum sharing;
  sharing.add(sampler.element_of_output());
  part.checksums["the options"] = checksum_of_options(options, moments);
  part.checksums["the hard edges"] = sharing.value();
  const Status status = seen.finish(keyframes_of_moments(motion, moments, *run.shard), part.checksums);
  if (!status) return status.error();
  return part.text();
}

}  // namespace

Result<SampleSummary> internal::write_samples(MotionStream& stream, const SampleOptions& options,
                                              const Moments& moments, const SampleOutput& output, SegmentRun& run) {
  Journal* const journal = run.journal;
  if (journal != nullptr && output.format != SampleFormat::kNpy)
    return Error{ErrorCode::kUsage, output.path,
                 "an interrupted run can only be continued if the output is a .npy file; choose this format"};
  const Motion& motion = stream.motion();
  const std::size_t count = moments.count(), vertices = motion.topology.vertex_count();
  const ElementKind kind = options.elements.kind;
  SampleOutput checked = output;
  if (journal != nullptr) checked.force = true;  // an interrupted run may have written OUT just before it ended
  const Result<std::vector<std::string>> names = sample_files(checked, kind, count, run);
  if (!names) return names.error();
  if (Status status = check_moments(motion, options, moments); !status) return status.error();
  const bool is_part = output.format == SampleFormat::kNpy && run.peers == nullptr && run.shard && !run.shard->is_all();
  KeyframeChecksums seen(stream);
  if (Status status = is_part ? seen.begin() : Success{}; !status) return status.error();
  Result<NormalSampler> made = NormalSampler::make(stream, options);
  if (!made) return made.error();
  NormalSampler& sampler = made.value();

  run.begin(count);
  const IndexRange share = run.share();
  EmptyPartial partial;
  std::optional<ArrayFile> arrays;
  SampleSummary summary;
  std::size_t written = 0;        // the number of rows that an earlier run wrote
  std::uint32_t written_sum = 0;  // the checksum of the header and of these rows
  const auto end = [&](std::uint32_t array) {
    return is_part ? end_of_part(motion, options, moments, run, sampler, array, seen) : std::string();
  };
  if (is_array(output.format)) {
    const std::size_t per_moment = sampler.output_count() + vertices;
    const bool is_gathered = output.format == SampleFormat::kNpz && is_stream(output.path);
    if (is_gathered && count > kMostSampleBytes / sizeof(float) / 3 / per_moment)
      return Error{ErrorCode::kUsage, output.path,
                   "the arrays are too large for a stream (more than 4 GiB); write to a file"};
    const std::size_t outputs = sampler.output_count(), row_bytes = 3 * sizeof(float) * outputs;
    const std::string header = npy::write_header("<f4", {run.peers != nullptr ? count : share.count, outputs, 3});
    if (journal != nullptr) {
      const auto found = find_written_rows(output.path, header, row_bytes, share.count, *journal);
      if (!found) return found.error();
      written_sum = checksum_of(header);
      for (const WrittenRow& row : found.value().rows) {
        written_sum = joined_checksum(written_sum, row.checksum, row_bytes);
        summary.zeros += row.zeros;
      }
      written = found.value().rows.size();
      summary.normals = written * outputs;
      if (found.value().end) {
        const Result<std::string> wanted = end(written_sum);
        if (!wanted) return wanted.error();
        if (*found.value().end == wanted.value()) return summary;
        if (Status status = journal->keep_first(0); !status) return status.error();
        written = 0;
        summary = {};
      }
    }
    const std::uint64_t kept = written > 0 ? header.size() + std::uint64_t{row_bytes} * written : 0;
    Result<OutputFile> file =
        journal != nullptr ? OutputFile::go_on(output.path, output.force, kept) : begin_file(output, run);
    if (!file) return file.error();
    if (journal != nullptr) {
      partial.journal = journal;
      partial.name = OutputFile::partial_name(output.path);
    }
    arrays.emplace(std::move(file).value(), output.format);
    if (kept > 0) arrays->go_on(written_sum);
    if (Status status = kept > 0 ? Success{} : arrays->begin(motion, moments, run, outputs, header); !status)
      return status.error();
  }

  // Files that are complete but do not have their names yet. The files get their names only at the end, since such a
  // name may be the name of a file from which keyframes are still read.
  std::vector<OutputFile> meshes;
  run.skip(written);
  const auto keys = [&](std::size_t i) {
    return moments.times.empty() ? Motion::SegmentKeys{}
                                 : motion.segments[find_instant(motion, moments.times[i]).value().segment];
  };
  const IndexRange rest{share.first + written, share.count - written};
  const Status computed = run.over(stream, keys, rest, 1, [&](IndexRange one) -> Status {
    const std::size_t i = one.first;
    const Result<Pose> pose = pose_of(sampler, stream, moments, i);
    if (!pose) return pose.error();
    const std::vector<float> normals = sampler.normals_of_outputs(pose.value());
    summary.normals += normals.size() / 3;
    const std::size_t zeros = count_zeros(normals);
    summary.zeros += zeros;
    if (arrays) {
      if (Status status = arrays->append(normals, pose.value(), zeros, journal); !status) return status.error();
    } else {
      const std::string bytes = mesh_file(motion, sampler, pose.value(), normals, kind, output.format);
      Result<OutputFile> file = OutputFile::create(names.value()[i], output.force);
      if (!file) return file.error();
      if (Status status = file.value().append(bytes); !status) return status.error();
      if (Status status = file.value().seal(); !status) return status.error();
      meshes.push_back(std::move(file).value());
    }
    return Success{};
  });
  if (!computed) return computed.error();
  summary.drift = sampler.drift();
  if (run.peers != nullptr) {
    const Written own{summary, std::uint64_t{share.count} * vertices, {}};
    return finish_with_peers(run, own, arrays ? &*arrays : nullptr, meshes);
  }
  if (Status status = finish_all(meshes); !status) return status.error();
  if (is_part) {
    const Result<std::string> text = end(arrays->checksum());
    if (!text) return text.error();
    if (Status status = arrays->append_end(text.value()); !status) return status.error();
  }
  if (Status status = arrays ? arrays->finish() : Status(Success{}); !status) return status.error();
  return summary;
}

Result<SampleFormat> make_sample_format(std::string_view name) {
  std::string names;
  for (const FormatName& format : kFormats) {
    if (format.name == name) return format.format;
    if (!names.empty()) names += ", ";
    names += format.name;
  }
  return Error{ErrorCode::kUsage, "",
               std::string("there is no format '").append(name).append("'; choose one of ").append(names)};
}

std::optional<SampleFormat> find_sample_format(std::string_view path) {
  std::string extension(path.substr(path.size() - std::min<std::size_t>(4, path.size())));
  for (char& c : extension) {
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  }
  for (const FormatName& format : kFormats) {
    if (format.extension == extension) return format.format;
  }
  return std::nullopt;
}

Result<std::vector<std::string>> sample_files(const SampleOutput& output, ElementKind kind, std::size_t count) {
  return sample_files(output, kind, count, {});
}

Result<std::vector<std::string>> internal::sample_files(const SampleOutput& output, ElementKind kind, std::size_t count,
                                                        const SegmentRun& run) {
  if (output.format == SampleFormat::kPly && kind == ElementKind::kCorners)
    return Error{ErrorCode::kUsage, output.path,
                 "PLY cannot store normals of corners; write .obj, .npy or .npz instead"};
  if (output.format == SampleFormat::kNpz && run.shard && !run.shard->is_all() && run.peers == nullptr)
    return Error{ErrorCode::kUsage, output.path,
                 "a shard can only be written as .npy, .ply or .obj; choose one of these formats"};
  if (run.peers != nullptr && is_stream(output.path))
    return Error{ErrorCode::kUsage, output.path, "several processes cannot write to one stream; name a file"};
  std::vector<std::string> names = {output.path};
  if (!is_array(output.format) && output.path != "-") {
    Result<std::vector<std::string>> numbered = numbered_names(output.path, count);
    if (!numbered) return numbered.error();
    names = std::move(numbered).value();
  } else if (!is_array(output.format) && count > 1) {
    return Error{ErrorCode::kUsage, output.path,
                 "the result is " + std::to_string(count) +
                     " meshes, but the standard output can only take one; name numbered files with -o, such as "
                     "mesh_%d.obj"};
  }
  // Checks only the files of this shard, because files of other shards may exist.
  const IndexRange own = names.size() == count ? run.share_of(count) : IndexRange{0, names.size()};
  for (std::size_t i = own.first; i < own.end(); ++i) {
    if (Status status = check_output(names[i], output.force); !status) return status.error();
  }
  return names;
}

Result<SampleSummary> write_samples(const Motion& motion, const SampleOptions& options, const Moments& moments,
                                    const SampleOutput& output,
                                    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  MotionStream stream(motion);
  return write_samples(stream, options, moments, output, progress);
}

Result<SampleSummary> write_samples(MotionStream& stream, const SampleOptions& options, const Moments& moments,
                                    const SampleOutput& output,
                                    const std::function<void(std::size_t done, std::size_t total)>& progress) {
  SegmentRun run;
  run.progress = progress;
  return write_samples(stream, options, moments, output, run);
}

}  // namespace chronormal
