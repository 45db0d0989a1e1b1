/// Measures how well the order of vertices and faces in memory suits the caches of the processor. Looks only at evenly
/// spaced samples of the faces of a mesh.
#ifndef CHRONORMAL_MOTION_COHERENCE_H_
#define CHRONORMAL_MOTION_COHERENCE_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// A set of a few numbers below 2^32 - 1.
class SmallSet {
 public:
  SmallSet() { slots_.fill(kEmpty); }

  /// Adds a number. Returns true if the set did not have the number before. Precondition: the set has fewer than kMost
  /// numbers.
  bool add(std::uint32_t number) {
    for (std::size_t slot = number * 2654435761U >> 22;; slot = (slot + 1) % slots_.size()) {
      if (slots_[slot] == number) return false;
      if (slots_[slot] != kEmpty) continue;
      slots_[slot] = number;
      return true;
    }
  }

  static constexpr std::size_t kMost = 512;

 private:
  static constexpr std::uint32_t kEmpty = 0xFFFFFFFF;
  std::array<std::uint32_t, 2 * kMost> slots_;
};

/// The largest size of positions, in bytes, at which the order of reading does not matter, since they fit into a cache
/// near the core.
inline constexpr std::size_t kNearBytes = std::size_t{1} << 20;

/// The largest result of lines_per_face() at which vertices are read without prefetching, because their order already
/// suits the caches.
inline constexpr double kMostLinesPerFace = 1;

/// Returns the number of cache lines of packed positions that a face reads and that the faces before it did not read,
/// on average. The number is about 0.2 on a mesh in grid order, and 3 if vertices are in random order. The result is a
/// pure function of the topology. Cost: less than 0.02 ms.
[[nodiscard]] inline double lines_per_face(const Topology& topology) {
  constexpr std::size_t kSamples = 16, kRun = 64, kVerticesOfLine = 5;
  const std::size_t count = topology.face_count();
  if (count == 0) return 0;
  std::size_t lines = 0, faces = 0;
  for (std::size_t i = 0; i < kSamples; ++i) {
    const std::size_t first = count / kSamples * i, end = std::min(first + kRun, count);
    SmallSet seen;
    std::size_t corners = 0;
    for (std::size_t f = first; f < end && corners < SmallSet::kMost; ++f, ++faces) {
      for (const std::uint32_t vertex : topology.face(f)) {
        if (corners++ < SmallSet::kMost && seen.add(vertex / kVerticesOfLine)) ++lines;
      }
    }
  }
  return static_cast<double>(lines) / static_cast<double>(faces);
}

/// The result of lines_per_face() above which neighbours in the mesh are not neighbours in memory. Curves are then
/// prepared from a copy of the positions at both ends of the segment, which takes kScatteredBytes per vertex.
inline constexpr double kScatteredLines = 1;
inline constexpr std::size_t kScatteredBytes = 8 * sizeof(float);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_MOTION_COHERENCE_H_
