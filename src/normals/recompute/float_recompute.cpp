// Implements FloatRecompute. All positions are interpolated at t and written as rows that one vector load reads. Then
// the paths around sixteen elements at a time are followed (groups/rings.h). The paths are made once, from the topology
// and the groups.

#include "chronormal/normals/float_recompute.h"

#include "simd/highway-inl.h"

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "core/blocks.h"
#include "core/memory.h"
#include "motion/coherence.h"
#include "normals/control/local_time.h"
#include "normals/groups/rings.h"
#include "normals/recompute/kernels/float_rings.h"

namespace chronormal {
namespace {

constexpr std::size_t kBlockOfPoints = 16384;
// Number of elements that a thread computes at a time; a multiple of kRingLanes.
constexpr std::size_t kBlockOfElements = 4096;

}  // namespace

struct FloatRecompute::Parts {
  Parts(const Topology& of_topology, std::size_t count, Rings of_elements)
      : topology(of_topology), size(count), rings(std::move(of_elements)), points(4 * of_topology.vertex_count()) {
    fetch = 4 * sizeof(float) * topology.vertex_count() > kNearBytes && lines_per_face(topology) > kMostLinesPerFace;
  }

  std::size_t unit_normals(VectorView<const float> from, VectorView<const float> to, double t, VectorView<float> result,
                           Threads threads);

  const Topology& topology;
  std::size_t size;
  Rings rings;  // the paths around elements (groups/rings.h); empty for faces that are all triangles
  AlignedArray<float> points;
  bool fetch = false;
};

std::size_t FloatRecompute::Parts::unit_normals(VectorView<const float> from, VectorView<const float> to, double t,
                                                VectorView<float> result, Threads threads) {
  if (size == 0) return 0;
  const auto start = static_cast<float>(1 - t), end = static_cast<float>(t);
  blocks_on(threads, topology.vertex_count(), kBlockOfPoints, [&](IndexRange range) {
    interpolate_points(from, to, start, end, range, points.data() + 4 * range.first);
  });
  const bool stream = (2 * topology.vertex_count() + size) * 3 * sizeof(float) > kStreamFrom;
  const RingPoints ring_points{points.data(), fetch};
  std::atomic<std::size_t> zeros = 0;
  blocks_on(threads, size, kBlockOfElements, [&](IndexRange range) {
    const VectorView<float> part = result.part(range);
    if (rings.empty()) {
      zeros += triangle_unit_normals(ring_points, topology.corners().data(), size, range, part, stream);
    } else {
      const IndexRange some{range.first / kRingLanes, (range.count + kRingLanes - 1) / kRingLanes};
      zeros += ring_unit_normals(ring_points, rings.view(), some, part, stream);
    }
    // FlushStream() makes results that bypassed the caches visible to other threads.
    if (stream) hwy::FlushStream();
  });
  return zeros;
}

FloatRecompute::FloatRecompute() noexcept = default;
FloatRecompute::FloatRecompute(FloatRecompute&&) noexcept = default;
FloatRecompute& FloatRecompute::operator=(FloatRecompute&&) noexcept = default;
FloatRecompute::~FloatRecompute() = default;

FloatRecompute::FloatRecompute(const Topology& topology)
    : parts_(std::make_unique<Parts>(topology, topology.face_count(),
                                     topology.all_triangles() ? Rings() : Rings::of_faces(topology))) {}

FloatRecompute::FloatRecompute(const Topology& topology, const NormalGroups& groups)
    : parts_(std::make_unique<Parts>(topology, groups.size(), Rings::of_groups(topology, groups))) {}

std::size_t FloatRecompute::unit_normals(const Segment& segment, double t, VectorView<float> result, Threads threads) {
  assert(result.count == size());
  if (!parts_) return 0;
  if (!std::isnan(t)) return parts_->unit_normals(segment.from, segment.to, local_time(t), result, threads);
  for (std::size_t i = 0; i < result.count; ++i) result.set(i, {});  // the time is NaN, so there are no normals
  return result.count;
}

std::size_t FloatRecompute::unit_normals(VectorView<const float> positions, VectorView<float> result, Threads threads) {
  assert(result.count == size());
  return parts_ ? parts_->unit_normals(positions, positions, 0, result, threads) : 0;
}

std::size_t FloatRecompute::size() const noexcept { return parts_ ? parts_->size : 0; }

std::size_t FloatRecompute::bytes() const noexcept {
  if (!parts_) return 0;
  return parts_->rings.bytes() + parts_->points.size() * sizeof(float);
}

}  // namespace chronormal
