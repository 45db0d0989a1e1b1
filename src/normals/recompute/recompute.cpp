// Recomputes normals tile by tile, and examines doubtful elements one by one.
#include "normals/recompute/recompute.h"

#include "simd/highway-inl.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <span>

#include "core/blocks.h"
#include "core/memory.h"
#include "core/rounding.h"
#include "core/vector_area.h"
#include "motion/coherence.h"
#include "motion/segment_end.h"
#include "normals/control/exact_curve.h"
#include "normals/control/local_time.h"
#include "normals/control/shared_faces.h"
#include "normals/curves/curve_elements.h"
#include "normals/groups/face_window.h"
#include "normals/recompute/kernels/recompute_tiles.h"
#include "normals/recompute/recompute_faces.h"

namespace chronormal {
namespace {

constexpr std::size_t kFaceBatch = 1024;  // number of doubtful faces for which there is room on the stack
constexpr std::size_t kFaceBlock = 16;
constexpr std::size_t kBlockOfVertices = 16384;
// The number of elements whose faces must be in the window of face normals (groups/face_window.h) at the same time.
constexpr std::size_t kGroupBatch = 256;
constexpr std::size_t kLargestWindow = std::size_t{1} << 14;  // normals of this many faces take 256 KiB
constexpr std::size_t kWindowSamples = 64;
constexpr std::size_t kSmallestPart = 4096;  // number of elements that are worth another thread
constexpr std::size_t kMostParts = 64;

// The vector n(t) of a face or element in double, and a bound of its error.
struct NormalAtTime {
  Vec3d n;
  double error = 0;
};

// Computes n(t) of a face with a bound of its error. The errors of the edges and of both products in a component come
// to at most 10 u times the absolute products, where u = 2^-53, and each triangle of a fan adds a rounding. The bound
// holds even if all roundings go in the same direction. Real errors are smaller: a search by hill climbing from 60
// triangles finds none above 3.4 u of these products.
NormalAtTime normal_at_time(const Segment& segment, std::size_t f, const LocalTime& time) {
  const auto face = segment.topology->face(f);
  const double s = time.rest, t = time.t;
  const SegmentEnd from = SegmentEnd::from(segment), to = SegmentEnd::to(segment);
  struct Edge {
    Vec3d at;
    double size;
  };
  const auto edge_to = [&](std::size_t c) {
    const Vec3d e0 = from.edge(face[0], face[c]), e1 = to.edge(face[0], face[c]);
    return Edge{s * e0 + t * e1, s * sum_abs(e0) + t * sum_abs(e1)};
  };
  NormalAtTime result;
  for_fan(face.size(), edge_to, [&result](const Edge& e, const Edge& g) {
    result.n = result.n + cross(e.at, g.at);
    result.error += e.size * g.size;
  });
  result.error *= kUnitRoundoff * static_cast<double>(10 + face.size());
  return result;
}

constexpr double kLargestNormal = 0x1p100;  // the largest length of a normal in float32 that leaves room for sums

FaceNormal rounded(const NormalAtTime& normal) {
  // The factor is slightly above 1, to cover the rounding of the bound itself.
  const double error = 1.01 * (length(normal.n) + normal.error / kFloatUnitRoundoff);
  if (!(error <= kLargestNormal)) return {0, 0, 0, std::numeric_limits<float>::infinity()};
  const Vec3f n = to_float(normal.n);
  return {n.x, n.y, n.z, static_cast<float>(error)};
}

// The normal of a triangle and its error bound, with the same bits as in the kernel.
struct QuickNormal {
  Vec3f n, unit;
  float error = 0;
  bool is_trusted = false;
};

bool in_range(float smallest, float largest) { return smallest >= 0x1p-100f && largest <= 0x1p100f; }

// Returns the normal of a thin triangle from exact edges, since edges in float32 are not precise enough for it. a and b
// are the squares A and B of quick_normal().
QuickNormal thin_normal(const Segment& segment, std::size_t f, const LocalTime& t, float a, float b) {
  const auto face = segment.topology->face(f);
  const auto edge_to = [&](std::size_t c) {
    return t.rest * (to_double(segment.from[face[c]]) - to_double(segment.from[face[0]])) +
           t.t * (to_double(segment.to[face[c]]) - to_double(segment.to[face[0]]));
  };
  const Vec3d exact = cross(edge_to(1), edge_to(2));
  if (!(max_abs(exact) <= kLargestNormal)) return {};
  const Vec3f n = to_float(exact);
  const float product = a * b, square = dot(n, n);
  if (!(product * (1 / kMaxThinProduct) <= square && in_range(std::min({square, a, b}), square))) return {};
  const double half_square = 0.5 * dot(exact, exact);
  double y = 1 / std::sqrt(square);
  for (int step = 0; step < 2; ++step) y = y * (1.5 - half_square * y * y);
  return {n, to_float(y * exact), 1.01f * (std::sqrt(square) + kThinError * std::sqrt(product)), true};
}

QuickNormal quick_normal(const Segment& segment, std::size_t f, const LocalTime& t) {
  const auto face = segment.topology->face(f);
  const auto edge = [face](const VectorView<const float>& points, std::size_t c) {
    return points[face[c]] - points[face[0]];
  };
  const auto at = [&t](const Vec3f& start, const Vec3f& end) {
    return t.rest * to_double(start) + t.t * to_double(end);
  };
  const Vec3f e0 = edge(segment.from, 1), e1 = edge(segment.to, 1), f0 = edge(segment.from, 2),
              f1 = edge(segment.to, 2);
  const Vec3d exact = cross(at(e0, e1), at(f0, f1));
  const float start_weight = static_cast<float>(t.rest), end_weight = static_cast<float>(t.t);
  const float a = start_weight * dot(e0, e0) + end_weight * dot(e1, e1);
  const float b = start_weight * dot(f0, f0) + end_weight * dot(f1, f1);
  if (max_abs(exact) <= kLargestNormal) {
    const Vec3f n = to_float(exact);
    const float product = a * b, square = dot(n, n);
    if (product <= kMostProduct * square && in_range(std::min({square, a, b}), square))
      return {n, normalized(n), 3.32f * std::sqrt(product), true};
  }
  return thin_normal(segment, f, t, a, b);
}

FaceNormal face_normal(const Segment& segment, std::size_t f, const LocalTime& t) {
  if (fits_lanes(segment)) {
    const QuickNormal quick = quick_normal(segment, f, t);
    if (quick.is_trusted) return {quick.n.x, quick.n.y, quick.n.z, quick.error};
  }
  return rounded(normal_at_time(segment, f, t));
}

// Returns the direction of a normal. If rounding turns the normal by at most 2^-23 = 1.2e-7 rad, the direction is
// computed in double, and otherwise from the exact curve that make_exact() returns.
template <class MakeExact>
UnitNormal unit_normal_of(const NormalAtTime& normal, const LocalTime& t, const MakeExact& make_exact) {
  constexpr double kLargestAngle = 0x1p-23;
  if (normal.error < kLargestAngle * max_abs(normal.n)) return {unit(normal.n), Direction::kRegular};
  return make_exact().unit_normal_at(t);
}

UnitNormal fine_unit_normal(const Segment& segment, std::size_t f, const LocalTime& t) {
  return unit_normal_of(normal_at_time(segment, f, t), t,
                        [&] { return ExactCurve::of_polygon(segment, segment.topology->face(f)); });
}

UnitNormal unit_normal_of_face(const Segment& segment, std::size_t f, const LocalTime& t) {
  if (fits_lanes(segment)) {
    const QuickNormal quick = quick_normal(segment, f, t);
    if (quick.is_trusted) return {to_double(quick.unit), Direction::kRegular};
  }
  return fine_unit_normal(segment, f, t);
}

// The values that all elements share in an evaluation at one t.
struct FacesAtTime {
  explicit FacesAtTime(const Segment& segment) : faces(segment) {}

  SharedFaces faces;
  LargeFaceValues<NormalAtTime> normals;
  LargeFaceValues<FaceNormal> rounded;
};

UnitNormal unit_normal_of_group(const FacesAtTime& shared, const NormalGroups& groups, std::size_t element,
                                const LocalTime& t) {
  const Segment& segment = shared.faces.segment();
  NormalAtTime sum;
  double magnitude = 0;
  for (const std::uint32_t f : groups.faces(element)) {
    const NormalAtTime normal = shared.normals.of(*segment.topology, f, [&] { return normal_at_time(segment, f, t); });
    sum.n = sum.n + normal.n;
    sum.error += normal.error;
    magnitude += sum_abs(normal.n);
  }
  // Each addition rounds by at most u = 2^-53 times the sum of the absolute values.
  sum.error += kUnitRoundoff * static_cast<double>(groups.faces(element).size()) * magnitude;
  return unit_normal_of(sum, t, [&] { return shared.faces.exact_sum(groups.faces(element)); });
}

// Returns the normal of an element with the same bits as those of the kernel. If the kernel would trust the sum of
// rounded face normals, this sum is used; otherwise the result is that of unit_normal_of_group().
UnitNormal quick_unit_normal_of_group(const FacesAtTime& shared, const NormalGroups& groups, std::size_t element,
                                      const LocalTime& t) {
  const Segment& segment = shared.faces.segment();
  Vec3d sum;
  double sum_of_errors = 0;
  for (const std::uint32_t f : groups.faces(element)) {
    const FaceNormal normal = shared.rounded.of(*segment.topology, f, [&] { return face_normal(segment, f, t); });
    sum = sum + to_double(Vec3f{normal.x, normal.y, normal.z});
    sum_of_errors += static_cast<double>(normal.error);
  }
  const Vec3f n = to_float(sum);
  const float error = static_cast<float>(sum_of_errors), square = dot(n, n);
  if (error * error <= 212 * square && in_range(square, square)) return {to_double(normalized(n)), Direction::kRegular};
  return unit_normal_of_group(shared, groups, element, t);
}

// Returns the faces of neighbouring elements, which are contiguous in NormalGroups.
std::span<const std::uint32_t> faces_of(const NormalGroups& groups, IndexRange elements) {
  const auto first = groups.faces(elements.first), last = groups.faces(elements.end() - 1);
  return {first.data(), last.data() + last.size()};
}

// Returns the smallest power of two for which a window of face normals can hold the faces around nine tenths of the
// examined batches of elements. Returns 0 if that window would be too large for the cache.
std::size_t window_for(const NormalGroups& groups) {
  std::array<std::size_t, kWindowSamples> counts{};
  const std::size_t batches = groups.size() / kGroupBatch;
  for (std::size_t i = 0; i < kWindowSamples && batches > 0; ++i) {
    const auto faces = faces_of(groups, {batches * i / kWindowSamples * kGroupBatch, kGroupBatch});
    if (!faces.empty()) counts[i] = range_of(faces).count;
  }
  std::sort(counts.begin(), counts.end());
  const std::size_t window =
      std::bit_ceil(std::max<std::size_t>(counts[kWindowSamples * 9 / 10] + 2 * kFaceBlock, 512));
  return window <= kLargestWindow ? window : 0;
}

bool is_packed(const VectorView<const float>& points) {
  return points.stride == 3 && points.y == points.x + 1 && points.z == points.x + 2;
}

// The memory that a NormalRecompute keeps for its calls.
struct Scratch {
  bool vertices_are_near = true;  // true if vertices of neighbouring faces are neighbours in memory
  AlignedArray<float> pairs;      // x y z _ of both ends of each vertex, one vertex after the other; or empty
  // The number of face normals in the window (groups/face_window.h), a power of two; 0 if all face normals are stored.
  std::size_t window = 0;
  AlignedBytes normals;  // normals of faces, from which those of groups are added up
};

// One call of NormalRecompute::unit_normals(), at one t.
class Call {
 public:
  // Evaluates faces, without scratch memory. The normal of element `first` is written to result[0].
  Call(const Segment& segment, const LocalTime& t, VectorView<float> result, std::size_t first)
      : segment_(segment), shared_(segment), t_(t), result_(result), first_(first) {
    const Topology& topology = *segment.topology;
    by_kernel_ = fits_lanes(segment) && is_packed(segment.from) && is_packed(segment.to);
    stream_ = (2 * segment.from.count + result.count) * 3 * sizeof(float) > kStreamFrom;
    triangles_.corners = topology.corners().data();
    triangles_.face_count = topology.face_count();
    triangles_.vertex_count = topology.vertex_count();
    triangles_.from = segment.from.x;
    triangles_.to = segment.to.x;
  }

  Call(const Segment& segment, const NormalGroups* groups, Scratch& scratch, const LocalTime& t,
       VectorView<float> result)
      : Call(segment, t, result, 0) {
    groups_ = groups;
    normals_ = reinterpret_cast<FaceNormal*>(scratch.normals.data());
    window_ = scratch.window;
    triangles_.is_coherent = scratch.vertices_are_near;
    if (scratch.pairs.size() > 0) {
      by_kernel_ = true;
      triangles_.from = scratch.pairs.data();
      triangles_.to = scratch.pairs.data() + 4;
      triangles_.is_paired = true;
    }
  }

  std::size_t faces(IndexRange faces) const noexcept {
    std::size_t zeros = 0;
    for (std::size_t f = faces.first; f < faces.end(); f += kFaceBatch)
      zeros += batch_of_faces({f, std::min(kFaceBatch, faces.end() - f)});
    finish();
    return zeros;
  }

  void write_all_normals(IndexRange faces) const noexcept { write_normals(faces, normals_ + faces.first); }

  // Evaluates elements in ascending order. Each part has a window of its own. Returns the number of normals that are
  // (0, 0, 0).
  std::size_t elements(IndexRange elements, std::size_t part) const noexcept {
    std::size_t zeros = 0;
    FaceNormal* const normals = normals_ + part * window_;
    FaceWindow window{window_};
    // The credit is the number of faces that may still be written to the window. If the faces of successive elements
    // are far apart, the credit limits the cost to a few times that of computing each face alone.
    std::size_t credit = 2 * window_;
    for (std::size_t e = elements.first; e < elements.end(); e += kGroupBatch) {
      const IndexRange batch{e, std::min(kGroupBatch, elements.end() - e)};
      if (window_ == 0) {
        zeros += batch_of_groups(batch, {normals_, ~std::size_t{0}, !triangles_.is_coherent});
        continue;
      }
      const auto around = faces_of(*groups_, batch);
      const IndexRange needed = around.empty() ? IndexRange{} : range_of(around);
      credit = std::min(credit + 4 * around.size(), 4 * window_);
      if (bring(needed, normals, window, credit))
        zeros += batch_of_groups(batch, {normals, window_ - 1, false});
      else
        zeros += scattered_groups(batch);
    }
    finish();
    return zeros;
  }

 private:
  // Makes results that bypassed the caches visible to other threads. Call this function at the end of an evaluation.
  void finish() const {
    if (stream_) hwy::FlushStream();
  }

  [[nodiscard]] VectorView<float> part(IndexRange elements) const {
    return result_.part({elements.first - first_, elements.count});
  }

  std::size_t put(std::size_t element, const UnitNormal& u) const {
    result_.set(element - first_, to_float(u.vector));
    return u.direction == Direction::kNone ? 1 : 0;
  }

  std::size_t batch_of_faces(IndexRange faces) const {
    std::size_t zeros = 0;
    if (!by_kernel_) {
      for (std::size_t f = faces.first; f < faces.end(); ++f) zeros += put(f, unit_normal_of_face(segment_, f, t_));
      return zeros;
    }
    std::array<std::uint32_t, kFaceBatch> doubtful;
    const std::size_t count = recompute_unit_normals(triangles_, faces, t_, part(faces), stream_, doubtful.data());
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t f = faces.first + doubtful[i];
      zeros += put(f, fine_unit_normal(segment_, f, t_));
    }
    return zeros;
  }

  void write_normals(IndexRange faces, FaceNormal* normals) const {
    for (std::size_t i = 0; i < faces.count; i += kFaceBatch) {
      const IndexRange batch{faces.first + i, std::min(kFaceBatch, faces.count - i)};
      if (!by_kernel_) {
        for (std::size_t k = 0; k < batch.count; ++k) normals[i + k] = face_normal(segment_, batch.first + k, t_);
        continue;
      }
      std::array<std::uint32_t, kFaceBatch> doubtful;
      const std::size_t count = recompute_face_normals(triangles_, batch, t_, normals + i, doubtful.data());
      for (std::size_t k = 0; k < count; ++k)
        normals[i + doubtful[k]] = rounded(normal_at_time(segment_, batch.first + doubtful[k], t_));
    }
  }

  // Moves the window so that it contains the needed faces. Returns false if the faces do not fit, or if moving the
  // window would cost more than `credit`.
  bool bring(IndexRange needed, FaceNormal* normals, FaceWindow& window, std::size_t& credit) const {
    if (needed.count == 0 || window.holds(needed)) return true;
    const bool follows = window.begin <= needed.first && needed.first <= window.end;
    const std::size_t first = follows ? window.end : needed.first / kFaceBlock * kFaceBlock;
    const std::size_t end =
        std::min((needed.end() + kFaceBlock - 1) / kFaceBlock * kFaceBlock, segment_.topology->face_count());
    if (end - needed.first > window.capacity || end - first > credit) return false;
    credit -= end - first;
    if (!follows) window.start_at(first);
    window.extend(end, [&](IndexRange faces, std::size_t place) { write_normals(faces, normals + place); });
    return true;
  }

  std::size_t batch_of_groups(IndexRange elements, const NormalWindow& window) const {
    std::array<std::uint32_t, kGroupBatch> doubtful;
    const std::size_t count =
        recompute_group_normals(*groups_, elements, window, part(elements), stream_, doubtful.data());
    std::size_t zeros = 0;
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t e = elements.first + doubtful[i];
      zeros += put(e, unit_normal_of_group(shared_, *groups_, e, t_));
    }
    return zeros;
  }

  // Evaluates one by one the elements whose faces are too far apart for the window.
  std::size_t scattered_groups(IndexRange elements) const {
    std::size_t zeros = 0;
    for (std::size_t e = elements.first; e < elements.end(); ++e)
      zeros += put(e, quick_unit_normal_of_group(shared_, *groups_, e, t_));
    return zeros;
  }

  const Segment& segment_;
  FacesAtTime shared_;
  const NormalGroups* groups_ = nullptr;
  LocalTime t_;
  VectorView<float> result_;
  std::size_t first_;
  bool by_kernel_;  // true if kernels evaluate the elements; false if they are evaluated one by one
  bool stream_;
  MovingTriangles triangles_;
  FaceNormal* normals_ = nullptr;
  std::size_t window_ = 0;
};

// Writes (0, 0, 0) as all normals, for a time that is NaN, and returns the number of normals.
std::size_t write_zeros(VectorView<float> result) {
  for (std::size_t i = 0; i < result.count; ++i) result.set(i, {});
  return result.count;
}

}  // namespace

std::size_t internal::unit_normals_at(const Segment& segment, IndexRange faces, double t,
                                      VectorView<float> result) noexcept {
  assert(result.count == faces.count && faces.end() <= segment.topology->face_count());
  if (std::isnan(t)) return write_zeros(result);
  return Call(segment, local_time(t), result, faces.first).faces(faces);
}

struct NormalRecompute::Parts {
  explicit Parts(const Segment& of_segment, const NormalGroups* of_groups = nullptr);

  [[nodiscard]] std::size_t size() const noexcept {
    return groups == nullptr ? segment.topology->face_count() : groups->size();
  }
  std::size_t unit_normals(const LocalTime& t, VectorView<float> result, Threads threads);

  Segment segment;
  const NormalGroups* groups;  // nullptr if the elements are faces
  Scratch scratch;
};

NormalRecompute::Parts::Parts(const Segment& of_segment, const NormalGroups* of_groups)
    : segment(of_segment), groups(of_groups) {
  const Topology& topology = *segment.topology;
  const std::size_t faces = topology.face_count(), vertices = topology.vertex_count();
  if (fits_lanes(segment) && faces > 0) {
    scratch.vertices_are_near =
        vertices * 6 * sizeof(float) <= kNearBytes || lines_per_face(topology) <= kMostLinesPerFace;
    if (!scratch.vertices_are_near || !is_packed(segment.from) || !is_packed(segment.to))
      scratch.pairs = AlignedArray<float>(8 * vertices);
  }
  if (groups == nullptr) return;
  scratch.window = window_for(*groups);
  const std::size_t parts = std::clamp<std::size_t>(groups->size() / kSmallestPart, 1, kMostParts);
  scratch.normals = AlignedBytes((scratch.window == 0 ? faces : parts * scratch.window) * sizeof(FaceNormal));
}

std::size_t NormalRecompute::Parts::unit_normals(const LocalTime& t, VectorView<float> result, Threads threads) {
  if (size() == 0) return 0;
  // One thread gets a single block. For several threads, the blocks do not depend on the number of threads.
  const auto in_blocks = [threads](std::size_t count, std::size_t block, const auto& body) {
    if (threads == Threads::kOne || count <= block)
      body(IndexRange{0, count});
    else
      parallel_blocks(count, block, body);
  };
  if (scratch.pairs.size() > 0) {
    in_blocks(segment.topology->vertex_count(), kBlockOfVertices, [this](IndexRange vertices) {
      float* pair = scratch.pairs.data() + 8 * vertices.first;
      for (std::size_t v = vertices.first; v < vertices.end(); ++v, pair += 8) {
        const Vec3f from = segment.from[v], to = segment.to[v];
        pair[0] = from.x, pair[1] = from.y, pair[2] = from.z, pair[3] = 0;
        pair[4] = to.x, pair[5] = to.y, pair[6] = to.z, pair[7] = 0;
      }
    });
  }
  const Call call(segment, groups, scratch, t, result);
  std::atomic<std::size_t> zeros = 0;
  if (groups == nullptr) {
    in_blocks(size(), kSmallestPart, [&](IndexRange faces) { zeros += call.faces(faces); });
    return zeros;
  }
  if (scratch.window == 0)
    in_blocks(segment.topology->face_count(), kSmallestPart, [&](IndexRange faces) { call.write_all_normals(faces); });
  const std::size_t parts =
      scratch.window == 0 ? kMostParts : scratch.normals.size() / sizeof(FaceNormal) / scratch.window;
  const std::size_t part = std::max((size() / parts + kGroupBatch) / kGroupBatch * kGroupBatch, kSmallestPart);
  in_blocks(size(), part, [&](IndexRange elements) { zeros += call.elements(elements, elements.first / part); });
  return zeros;
}

NormalRecompute::NormalRecompute() noexcept = default;
NormalRecompute::NormalRecompute(NormalRecompute&&) noexcept = default;
NormalRecompute& NormalRecompute::operator=(NormalRecompute&&) noexcept = default;
NormalRecompute::~NormalRecompute() = default;

NormalRecompute::NormalRecompute(const Segment& segment) : parts_(std::make_unique<Parts>(segment)) {}
NormalRecompute::NormalRecompute(const Segment& segment, const NormalGroups& groups)
    : parts_(std::make_unique<Parts>(segment, &groups)) {}

std::size_t NormalRecompute::unit_normals(const LocalTime& t, VectorView<float> result, Threads threads) {
  assert(result.count == size());
  if (!parts_) return 0;
  return std::isnan(t.t) ? write_zeros(result) : parts_->unit_normals(local_time(t), result, threads);
}

std::size_t NormalRecompute::size() const noexcept { return parts_ ? parts_->size() : 0; }

std::size_t NormalRecompute::bytes() const noexcept {
  return parts_ ? parts_->scratch.pairs.size() * sizeof(float) + parts_->scratch.normals.size() : 0;
}

}  // namespace chronormal
