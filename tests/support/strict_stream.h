/// A stream that keeps in memory only the keyframes in use. The stream measures how many keyframes its user needs at
/// once.
#ifndef CHRONORMAL_TESTS_SUPPORT_STRICT_STREAM_H_
#define CHRONORMAL_TESTS_SUPPORT_STRICT_STREAM_H_

#include <algorithm>
#include <cstddef>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"

namespace chronormal::test {

/// Returns a stream of the keyframes of `source`. Sets most_held to the largest number of keyframes that were in memory
/// at once, including one that is being read. Both arguments must live longer than the stream.
inline MotionStream strict(MotionStream& source, std::size_t& most_held) {
  Motion outline = source.motion();
  for (auto& keyframe : outline.keyframes) keyframe.positions = {};
  return MotionStream(
      std::move(outline),
      [&source, &most_held](const Motion& motion, std::size_t k, std::span<float> positions) -> Status {
        std::size_t held = 1;
        for (const auto& keyframe : motion.keyframes) held += keyframe.positions.empty() ? 0U : 1U;
        most_held = std::max(most_held, held);
        if (const Status status = source.hold(k, k); !status) return status;
        const std::vector<float>& read = source.motion().keyframes[k].positions;
        std::copy(read.begin(), read.end(), positions.begin());
        return Success{};
      },
      0);
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_STRICT_STREAM_H_
