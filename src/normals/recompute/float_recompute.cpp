// Interpolates all positions at t into rows that a vector loads at once, and then goes along the paths around sixteen
// elements at a time (kernels/rings.h). The paths are made once, from the topology alone.

#include "chronormal/normals/float_recompute.h"

#include <hwy/cache_control.h>

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
#include "normals/recompute/kernels/rings.h"

namespace chronormal {
namespace {

constexpr std::size_t kBlockOfPoints = 16384;
constexpr std::size_t kBlockOfElements = 4096;  // a multiple of kRingLanes
constexpr std::size_t kMostSearched = 64;       // pieces of a path; in longer paths, nothing looks for the next piece
using Path = std::vector<std::uint32_t>;        // the first point is the centre

// The paths around elements, one after the other.
class PathMaker {
 public:
  PathMaker(const Topology& topology, const NormalGroups& groups) : topology_(topology), groups_(groups) {}

  const Path& make(std::size_t element) {
    path_.clear();
    points_.clear();
    pieces_.clear();
    const auto corners = groups_.corners(element), faces = groups_.faces(element);
    path_.push_back(corners.empty() ? 0 : topology_.corners()[corners[0]]);
    for (std::size_t i = 0; i < corners.size(); ++i) add_piece(corners[i], topology_.face(faces[i]));
    if (pieces_.size() > kMostSearched) {
      for (const Piece& piece : pieces_) append(piece);
    } else {
      while (!pieces_.empty()) {
        const std::size_t next = next_piece();
        append(pieces_[next]);
        pieces_.erase(pieces_.begin() + static_cast<std::ptrdiff_t>(next));
      }
    }
    if (path_.size() == 1) path_.push_back(path_[0]);
    return path_;
  }

 private:
  struct Piece {
    std::size_t first, last;  // of points_
  };

  // The corners of a face that follow this one, or all of them back to it where this corner is not the centre.
  void add_piece(std::size_t corner, std::span<const std::uint32_t> face) {
    const std::size_t first = points_.size();
    const std::size_t at = corner - static_cast<std::size_t>(face.data() - topology_.corners().data());
    const bool is_centre = face[at] == path_[0];
    for (std::size_t i = is_centre ? 1 : 0; i < face.size() + (is_centre ? 0 : 1); ++i)
      points_.push_back(face[(at + i) % face.size()]);
    pieces_.push_back({first, points_.size() - 1});
  }

  // Adds a piece to the path; it goes through the centre where the piece does not join the last one.
  void append(const Piece& piece) {
    std::size_t from = piece.first;
    if (path_.size() > 1 && path_.back() == points_[from]) {
      ++from;
    } else if (path_.size() > 1) {
      path_.push_back(path_[0]);
    }
    for (; from <= piece.last; ++from) path_.push_back(points_[from]);
  }

  // Takes a piece that joins the last one, or else a piece that no other leads to, or else any.
  [[nodiscard]] std::size_t next_piece() const {
    const auto start = [this](std::size_t piece) { return points_[pieces_[piece].first]; };
    for (std::size_t i = 0; i < pieces_.size() && path_.size() > 1; ++i) {
      if (start(i) == path_.back()) return i;
    }
    for (std::size_t i = 0; i < pieces_.size(); ++i) {
      const auto leads_to = [&](const Piece& piece) { return points_[piece.last] == start(i); };
      if (std::none_of(pieces_.begin(), pieces_.end(), leads_to)) return i;
    }
    return 0;
  }

  const Topology& topology_;
  const NormalGroups& groups_;
  Path path_;
  std::vector<std::uint32_t> points_;
  std::vector<Piece> pieces_;
};

// The paths of groups in slices, as kernels read them.
struct Slices {
  std::vector<std::uint32_t> indices;
  std::vector<std::size_t> first_row = {0};

  [[nodiscard]] RingSlices view() const { return {indices.data(), first_row.data(), first_row.size() - 1}; }
};

// path_of(element) gives the centre and the path of an element.
template <class PathOf>
Slices make_slices(std::size_t count, const PathOf& path_of) {
  Slices slices;
  for (std::size_t first = 0; first < count; first += kRingLanes) {
    const std::size_t begin = slices.indices.size();
    std::size_t rows = 0;
    for (std::size_t lane = 0; lane < kRingLanes; ++lane) {
      // Behind the last element, slices are filled up with a path that adds nothing.
      static const Path kNone = {0, 0};
      const Path& path = first + lane < count ? path_of(first + lane) : kNone;
      const auto row = [&](std::size_t r) { return &slices.indices[begin + kRingLanes * r]; };
      for (; rows < path.size(); ++rows) {
        slices.indices.resize(begin + kRingLanes * (rows + 1));
        if (rows > 0) std::copy_n(row(0), lane, row(rows));  // shorter paths repeat their last point
      }
      for (std::size_t r = 0; r < rows; ++r) row(r)[lane] = path[r < path.size() ? r : 0];
    }
    slices.first_row.push_back(slices.first_row.back() + rows);
  }
  slices.indices.shrink_to_fit();
  return slices;
}

}  // namespace

struct FloatRecompute::Parts {
  Parts(const Topology& of_topology, std::size_t count, Slices of_elements)
      : topology(of_topology), size(count), slices(std::move(of_elements)), points(4 * of_topology.vertex_count()) {
    fetch = 4 * sizeof(float) * topology.vertex_count() > kNearBytes && lines_per_face(topology) > kMostLinesPerFace;
  }

  std::size_t unit_normals(VectorView<const float> from, VectorView<const float> to, double t, VectorView<float> result,
                           Threads threads);

  const Topology& topology;
  std::size_t size;
  Slices slices;  // empty for faces that are all triangles
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
    if (slices.indices.empty()) {
      zeros += triangle_unit_normals(ring_points, topology.corners().data(), size, range, part, stream);
    } else {
      const IndexRange some{range.first / kRingLanes, (range.count + kRingLanes - 1) / kRingLanes};
      zeros += ring_unit_normals(ring_points, slices.view(), some, part, stream);
    }
    // Makes what was written past the caches visible to other threads.
    if (stream) hwy::FlushStream();
  });
  return zeros;
}

FloatRecompute::FloatRecompute() noexcept = default;
FloatRecompute::FloatRecompute(FloatRecompute&&) noexcept = default;
FloatRecompute& FloatRecompute::operator=(FloatRecompute&&) noexcept = default;
FloatRecompute::~FloatRecompute() = default;

FloatRecompute::FloatRecompute(const Topology& topology) {
  Slices slices;
  if (!topology.all_triangles()) {
    slices = make_slices(topology.face_count(), [&](std::size_t f) {
      const auto face = topology.face(f);  // the first corner is the centre, and the others are the path
      return Path(face.begin(), face.end());
    });
  }
  parts_ = std::make_unique<Parts>(topology, topology.face_count(), std::move(slices));
}

FloatRecompute::FloatRecompute(const Topology& topology, const NormalGroups& groups) {
  PathMaker paths(topology, groups);
  Slices slices = make_slices(groups.size(), [&paths](std::size_t e) -> const Path& { return paths.make(e); });
  parts_ = std::make_unique<Parts>(topology, groups.size(), std::move(slices));
}

std::size_t FloatRecompute::unit_normals(const Segment& segment, double t, VectorView<float> result, Threads threads) {
  assert(result.count == size());
  if (!parts_) return 0;
  if (!std::isnan(t)) return parts_->unit_normals(segment.from, segment.to, local_time(t), result, threads);
  for (std::size_t i = 0; i < result.count; ++i) result.set(i, {});  // there is no normal at a time that is none
  return result.count;
}

std::size_t FloatRecompute::unit_normals(VectorView<const float> positions, VectorView<float> result, Threads threads) {
  assert(result.count == size());
  return parts_ ? parts_->unit_normals(positions, positions, 0, result, threads) : 0;
}

std::size_t FloatRecompute::size() const noexcept { return parts_ ? parts_->size : 0; }

std::size_t FloatRecompute::bytes() const noexcept {
  if (!parts_) return 0;
  const Slices& slices = parts_->slices;
  return slices.indices.size() * sizeof(std::uint32_t) + slices.first_row.size() * sizeof(std::size_t) +
         parts_->points.size() * sizeof(float);
}

}  // namespace chronormal
