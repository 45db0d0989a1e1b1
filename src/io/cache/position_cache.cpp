// Combines a mesh and the samples of a cache into a motion, and passes the coordinates of keyframes to writers.
#include "io/cache/position_cache.h"

#include <utility>

#include "chronormal/motion/motion.h"
#include "core/text.h"
#include "io/bytes/binary.h"
#include "motion/outline.h"

namespace chronormal::inline internal {

Result<Motion> motion_from_cache(Topology faces, PositionCache cache, const std::string& mesh_name,
                                 const std::string& cache_name, MotionKind kind) {
  if (cache.vertex_count != faces.vertex_count())
    return invalid_input(cache_name, "the cache has " + counted(cache.vertex_count, "vertex", "vertices") +
                                         ", but the mesh " + mesh_name + " has " + grouped(faces.vertex_count()) +
                                         "; give the mesh that the cache was made for");
  if (cache.samples.size() < 2)
    return invalid_input(cache_name, "a motion needs at least two samples, but the cache has " +
                                         std::to_string(cache.samples.size()) + "; export more frames");
  for (std::size_t k = 1; k < cache.samples.size() && kind != MotionKind::kTargets; ++k) {
    const double before = cache.samples[k - 1].time, time = cache.samples[k].time;
    const bool is_jump = kind == MotionKind::kAnimation && before == time;
    if (!(before < time) && !is_jump)
      return invalid_input(cache_name + ", sample " + std::to_string(k),
                           "the time of this sample, " + rounded_text(time, {before}) + " s, is not later than " +
                               rounded_text(before, {time}) + " s, the time of sample " + std::to_string(k - 1) +
                               "; give each sample a later time than the one before");
  }

  Motion motion;
  motion.topology = std::move(faces);
  motion.origin = cache.origin;
  motion.keyframes.reserve(cache.samples.size());
  for (PositionCache::Sample& sample : cache.samples)
    motion.keyframes.push_back({std::move(sample.positions), sample.time, cache_name});
  motion.connect(kind);
  Status status = validate_outline(motion);
  for (std::size_t k = 0; status && k < motion.keyframes.size(); ++k) {
    const std::vector<float>& positions = motion.keyframes[k].positions;
    if (!positions.empty()) status = validate_positions(motion, k, positions);
  }
  if (!status) return invalid_input(cache_name + ", " + status.error().place, status.error().message);
  return motion;
}

Status check_keyframes(const Motion& motion) {
  const auto misuse = [](const char* message) { return Error{ErrorCode::kUsage, "", message}; };
  if (motion.keyframes.size() < 2 || motion.segments.empty())
    return misuse("the mesh does not move, but this format needs at least two keyframes; write .obj or .ply instead");
  return Success{};
}

Status each_keyframe(MotionStream& stream, std::endian order,
                     const std::function<Status(std::string_view bytes)>& each) {
  const Motion& motion = stream.motion();
  std::string storage;
  for (std::size_t k = 0; k < motion.keyframes.size(); ++k) {
    if (Status status = stream.hold(k, k); !status) return status;
    const std::vector<float>& positions = motion.keyframes[k].positions;
    if (positions.size() != 3 * motion.topology.vertex_count())
      return Error{ErrorCode::kUsage, "", "a keyframe must have three coordinates for each vertex of the mesh"};
    if (motion.origin == Origin{}) {
      if (Status status = each(binary::bytes_of(positions, order, storage)); !status) return status;
      continue;
    }
    std::vector<float> placed(positions.size());
    for (std::size_t i = 0; i < placed.size(); ++i)
      placed[i] = static_cast<float>(double{positions[i]} + motion.origin[i % 3]);
    if (Status status = each(binary::bytes_of(placed, order, storage)); !status) return status;
  }
  return Success{};
}

Status check_is_sequence(const Motion& motion) {
  if (motion.kind == MotionKind::kTargets)
    return Error{
        ErrorCode::kUsage, "",
        "this format cannot store targets over a base, only a sequence of keyframes; write .npz or .glb instead"};
  if (!motion.segments.empty() && motion.segments.size() + 1 != motion.keyframes.size())
    return Error{ErrorCode::kUsage, "", "this format cannot store an animation whose weights jump; write .npz instead"};
  return check_keyframes(motion);
}

}  // namespace chronormal::inline internal
