/// Stores vectors that were computed for poses of a mesh. Such vectors are needed many times, because each viewer and
/// each candidate is judged in the same poses. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_POSES_POSE_MEMORY_H_
#define CHRONORMAL_WORKFLOW_BAKE_POSES_POSE_MEMORY_H_

#include <cstddef>
#include <map>
#include <mutex>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/core/vec3.h"

namespace chronormal::inline internal {

/// A store of vectors. New vectors are stored until the store takes most_bytes bytes. Poses come in the same order each
/// time, so if new vectors replaced the oldest ones, no vectors would be found again. Threads: all functions may run at
/// the same time.
class PoseMemory {
 public:
  explicit PoseMemory(std::size_t most_bytes) : room_(most_bytes) {}

  /// Returns the vectors that are stored for a pose, or nullptr if there are none. The result is valid as long as this
  /// object exists.
  [[nodiscard]] const std::vector<Vec3d>* find(std::span<const double> pose) const {
    const std::vector<double> key(pose.begin(), pose.end());
    const std::scoped_lock lock(mutex_);
    const auto found = kept_.find(key);
    return found == kept_.end() ? nullptr : &found->second;
  }

  /// Stores a copy of the vectors of a pose if enough of the most_bytes bytes are left.
  void keep(std::span<const double> pose, const std::vector<Vec3d>& vectors) {
    const std::size_t bytes = vectors.size() * sizeof(Vec3d) + pose.size() * sizeof(double);
    std::vector<double> key(pose.begin(), pose.end());
    const std::scoped_lock lock(mutex_);
    if (bytes > room_ || !kept_.try_emplace(std::move(key), vectors).second) return;
    room_ -= bytes;
  }

 private:
  mutable std::mutex mutex_;
  std::map<std::vector<double>, std::vector<Vec3d>> kept_;
  std::size_t room_;  // the number of bytes that may still be stored
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_POSES_POSE_MEMORY_H_
