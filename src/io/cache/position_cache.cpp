// Makes a motion of a mesh and the samples of a cache, and gives the coordinates of keyframes to writers.
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
    return invalid_input(cache_name, "it has " + std::to_string(cache.vertex_count) +
                                         (cache.vertex_count == 1 ? " vertex" : " vertices") + ", but the mesh " +
                                         mesh_name + " has " + std::to_string(faces.vertex_count()));
  if (cache.samples.size() < 2)
    return invalid_input(cache_name,
                         "a motion needs two samples or more, but it has " + std::to_string(cache.samples.size()));
  for (std::size_t k = 1; k < cache.samples.size() && kind != MotionKind::kTargets; ++k) {
    const double before = cache.samples[k - 1].time, time = cache.samples[k].time;
    const bool is_jump = kind == MotionKind::kAnimation && before == time;
    if (!(before < time) && !is_jump)
      return invalid_input(cache_name + ", sample " + std::to_string(k),
                           "its time, " + rounded_text(time, {before}) + " s, is not after that of sample " +
                               std::to_string(k - 1) + ", " + rounded_text(before, {time}) + " s");
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
    return misuse("this format holds two keyframes or more, but the mesh does not move");
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
      return Error{ErrorCode::kUsage, "", "a keyframe has another number of coordinates than the vertices need"};
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
    return Error{ErrorCode::kUsage, "",
                 "this format holds one sequence of keyframes, but the motion is targets over a base; .npz holds them"};
  if (!motion.segments.empty() && motion.segments.size() + 1 != motion.keyframes.size())
    return Error{ErrorCode::kUsage, "",
                 "this format holds one sequence without jumps, but weights jump in the animation; .npz holds it"};
  return check_keyframes(motion);
}

}  // namespace chronormal::inline internal
