// Computes checksums of keyframes while a stream reads them, and of all data of a motion except its positions.
#include "workflow/segments/task_checksums.h"

#include <limits>
#include <utility>

#include "io/bytes/checksum.h"
#include "io/gltf/glb/glb_builder.h"

namespace chronormal::inline internal {
namespace {

constexpr std::string_view kKeyframe = "keyframe ";

// Adds the checksums of all data of a motion except its positions.
void add_outline(const Motion& motion, TaskChecksums& result) {
  NumberChecksum program, faces, times, velocities;
  program.add(generator_name());
  const Topology& topology = motion.topology;
  faces.add(std::uint64_t{topology.vertex_count()});
  faces.add(std::uint64_t{topology.face_count()});
  faces.add(topology.corners());
  for (std::size_t f = 0; f < topology.face_count() && !topology.all_triangles(); ++f)
    faces.add(std::uint64_t{topology.face(f).size()});
  faces.add(std::span<const std::uint32_t>(motion.body_of_vertex));
  times.add(static_cast<std::uint64_t>(motion.kind));
  times.add(std::uint64_t{motion.keyframes.size()});
  for (const Motion::Keyframe& keyframe : motion.keyframes) {
    times.add(keyframe.time);
    velocities.add(std::span<const float>(keyframe.velocities));
    velocities.add(std::span<const float>(keyframe.end_velocities));
  }
  for (const Motion::SegmentKeys& segment : motion.segments) {
    times.add(std::uint64_t{segment.from});
    times.add(std::uint64_t{segment.to});
  }
  result["the version of the program"] = program.value();
  result["the faces"] = faces.value();
  result["the times of the keyframes"] = times.value();
  result["the velocities"] = velocities.value();
}

}  // namespace

std::set<std::size_t> keyframes_of_shard(const Motion& motion, const Shard& shard) {
  std::set<std::size_t> keyframes;
  const IndexRange share = shard.of(motion.segments.size());
  if (share.count > 0) {
    const std::size_t last = motion.segments[share.end() - 1].to;
    for (std::size_t k = motion.segments[share.first].from; k <= last; ++k) keyframes.insert(k);
  }
  if (share.end() < motion.segments.size()) keyframes.insert(motion.segments[share.end()].from);
  return keyframes;
}

Status KeyframeChecksums::begin() {
  return stream_.watch(
      [this](std::size_t keyframe, std::span<const float> positions) { return take(keyframe, positions); });
}

Status KeyframeChecksums::take(std::size_t keyframe, std::span<const float> positions) {
  NumberChecksum sum;
  sum.add(positions);
  for (const double residual : stream_.motion().keyframes[keyframe].residuals) sum.add(residual);
  const std::lock_guard lock(mutex_);
  const auto [known, is_new] = of_keyframe_.emplace(keyframe, sum.value());
  if (is_new || known->second == sum.value()) return Success{};
  return Error{
      ErrorCode::kFailed, stream_.motion().keyframes[keyframe].name,
      std::string(kKeyframe) + std::to_string(keyframe) + " has changed while it was read; run the command again"};
}

Status KeyframeChecksums::finish(std::set<std::size_t> needed, TaskChecksums& result) {
  const Motion& motion = stream_.motion();
  const std::size_t count = motion.keyframes.size();
  needed.insert({0, count - 1});
  for (std::size_t k = 0; k < count && stream_.keeps_all(); ++k) needed.insert(k);
  for (const std::size_t k : needed) {
    const auto is_known = [&] {
      const std::lock_guard lock(mutex_);
      return of_keyframe_.contains(k);
    };
    if (is_known()) continue;
    if (Status status = stream_.hold(k, k); !status) return status;
  }
  if (Status status = stream_.watch({}); !status) return status;
  for (const std::size_t k : needed) result[std::string(kKeyframe) + std::to_string(k)] = of_keyframe_.at(k);
  add_outline(motion, result);
  return Success{};
}

void check_part_version(const JsonView& part) {
  if (part.required_count("chronormal_part", std::numeric_limits<std::size_t>::max() >> 1U) != kPartVersion)
    part.complain("chronormal_part", "another version of chronormal wrote this shard; run all shards with one version");
}

TaskChecksums read_task_checksums(const JsonView& part) {
  TaskChecksums checksums;
  const std::optional<JsonView> object = part.object("checksums");
  if (!object) part.complain("checksums", "the shard has no checksums; make the shard again");
  for (const std::string& name : object ? object->keys() : std::vector<std::string>())
    checksums[name] = static_cast<std::uint32_t>(object->required_count(name.c_str(), 0xFFFFFFFF));
  return checksums;
}

Status KnownParts::add(const std::string& part, const TaskChecksums& checksums) {
  parts_.push_back(part);
  std::optional<Error> keyframe;  // returned only if there is no other error, since other errors are more helpful
  for (const auto& [name, checksum] : checksums) {
    const auto [known, is_new] = first_.try_emplace(name, checksum, parts_.size() - 1);
    if (is_new || known->second.first == checksum) continue;
    Error error{ErrorCode::kUsage, part,
                "this shard does not belong to " + parts_[known->second.second] + ", since they differ in " + name +
                    "; merge only shards of one run"};
    if (!name.starts_with(kKeyframe)) return error;
    if (!keyframe) keyframe = std::move(error);
  }
  if (keyframe) return *keyframe;
  return Success{};
}

}  // namespace chronormal::inline internal
