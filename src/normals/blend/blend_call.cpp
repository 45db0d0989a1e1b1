#include "normals/blend/blend_call.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/blocks.h"
#include "core/rounding.h"
#include "core/vector_area.h"
#include "normals/blend/kernels/blend_rows.h"
#include "normals/recompute/kernels/float_rings.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlockOfWords = 256;  // for a thread: 16,384 elements
constexpr std::size_t kBlockOfVertices = 16384, kBlockOfLargeFaces = 64, kBlockOfSlices = 256;
constexpr std::size_t kNearVertices = 4096;  // 128 KiB of points in double

constexpr double kSmallestSquare = 0x1p-900, kLargestSquare = 0x1p900;
constexpr double kLargestAngle = 8e-7;  // of double, before the rounding of the result
constexpr UnitLimits kLimitsOfPoints = {kSmallestSquare, kLargestSquare, kLargestAngle};
// Float32 terms promise 1e-6 rad where their bound is at most so many times |n(w)|: 14 x 2^-24, and what the rounding
// of the result adds.
constexpr UnitLimits kLimitsOfTerms = {kSmallestSquare, kLargestSquare, 14};

// Nanoseconds, fitted to a grid of 15,000 vertices with up to 100 targets, on one core of epyc-zen3-2cores of
// docs/benchmarks.md. Only their ratios matter.
constexpr double kCopiedElement = 0.35;   // of the base normals
constexpr double kTargetElement = 3;      // the terms of a target
constexpr double kPairElement = 1.4;      // the term of a pair
constexpr double kFinishedElement = 5.5;  // from the base to length 1
constexpr double kMovedVertex = 1.7;      // of a target, and back again
constexpr double kPathPoint = 1.8;        // of the path around an element
constexpr double kWrittenElement = 5;     // from the sum over its path
constexpr double kWholeInFloat32 = 0.4;   // of the time that the whole mesh takes in double

// What of an ascending list lies inside a range of indices.
IndexRange part_of(std::span<const std::uint32_t> list, IndexRange range) {
  const auto place = [list](std::size_t index) {
    return static_cast<std::size_t>(std::lower_bound(list.begin(), list.end(), index) - list.begin());
  };
  const std::size_t first = range.first == 0 ? 0 : place(range.first);
  const std::size_t end = list.empty() || list.back() < range.end() ? list.size() : place(range.end());
  return {first, end - first};
}

// How many elements are made from points where they are made four at a time, as if every machine did so: those that
// nobody asked for are included.
std::size_t lanes_of(const IndexBits& elements) {
  std::size_t count = 0;
  for (const std::uint64_t word : elements.words()) {
    const std::uint64_t pairs = word | word >> 1U;
    count += 4 * static_cast<std::size_t>(std::popcount((pairs | pairs >> 2U) & 0x1111111111111111U));
  }
  return count;
}

std::span<const std::uint32_t> in(IndexRange part, std::span<const std::uint32_t> list) {
  return list.subspan(part.first, part.count);
}

// The weights of the four lanes of a coefficient, of which the last is a bound.
RowWeights row_weights(double weight) { return {weight, weight, weight, std::fabs(weight)}; }

class Call {
 public:
  Call(const BlendInput& source, std::span<const double> weights, BlendScratch& scratch, VectorView<float> result,
       Threads threads)
      : source_(source), weights_(weights), scratch_(scratch), result_(result), threads_(threads) {}

  BlendEvaluation run() {
    BlendEvaluation done{choose_path(source_, weights_, scratch_)};
    if (done.path == BlendPath::kWhole && source_.in_float32) {
      recompute_in_float32();
      done.recomputed_elements = result_.count;
      done.zeros = zeros_;
      return done;
    }
    if (done.path == BlendPath::kWhole) {
      scratch_.again.fill(result_.count);
    } else {
      if (done.path == BlendPath::kTouched) scratch_.again.add(scratch_.touched);
      in_blocks(scratch_.touched.words().size(), kBlockOfWords, [this](IndexRange words) { add_terms(words); });
    }
    done.recomputed_elements = scratch_.again.count();
    if (done.recomputed_elements > 0) recompute();
    done.zeros = zeros_;
    done.uncertain_elements = uncertain_;
    return done;
  }

 private:
  template <class Body>
  void in_blocks(std::size_t count, std::size_t block, const Body& body) const {
    blocks_on(threads_, count, block, body);
  }

  [[nodiscard]] IndexRange elements_of(IndexRange words) const {
    const std::size_t first = words.first * kBitsOfWord, end = std::min(words.end() * kBitsOfWord, result_.count);
    return {first, end - first};
  }

  // Everything but what is to be made again.
  void add_terms(IndexRange words) {
    const IndexRange elements = elements_of(words);
    copy_base(elements);
    const auto touched = scratch_.touched.words(), again = scratch_.again.words();
    const auto base_zeros = source_.base.zeros.words();
    std::size_t zeros = 0, left = 0;
    for (std::size_t i = words.first; i < words.end(); ++i) {
      zeros += static_cast<std::size_t>(std::popcount(base_zeros[i] & ~touched[i]));
      left += static_cast<std::size_t>(std::popcount(touched[i] & ~again[i]));
    }
    zeros_ += zeros;
    if (left == 0) return;
    double* const sums = scratch_.sums.data();
    for_bits(touched, words, [&](std::size_t e) {
      std::memcpy(sums + kBlendLanes * e, source_.base.sums.data() + kBlendLanes * e, kBlendLanes * sizeof(double));
    });
    for (const std::uint32_t i : scratch_.active) {
      const StoredTarget& target = source_.storage.targets()[i];
      if (!target.term.is_stored) continue;
      const double weight = weights_[i];
      const double linear = weight * target.term.scale, square = weight * weight * target.term.scale;
      IndexRange part = part_of(target.term.elements, elements);
      add_target_rows(in(part, target.term.elements), target.term.lanes.data() + 2 * kBlendLanes * part.first,
                      row_weights(linear), row_weights(square), sums);
      for (const StoredPair& pair : target.pairs) {
        if (!scratch_.is_active[pair.other] || !pair.term.is_stored) continue;
        part = part_of(pair.term.elements, elements);
        add_pair_rows(in(part, pair.term.elements), pair.term.lanes.data() + kBlendLanes * part.first,
                      row_weights(weight * weights_[pair.other] * pair.term.scale), sums);
      }
    }
    for (std::size_t i = words.first; i < words.end(); ++i)
      again[i] |= unit_normals_of_rows(touched[i] & ~again[i], i, sums, kLimitsOfTerms, result_);
  }

  void copy_base(IndexRange elements) const {
    const float* const units = source_.base.units.data();
    if (result_.is_packed()) {
      std::memcpy(result_.x + 3 * elements.first, units + 3 * elements.first, 3 * sizeof(float) * elements.count);
      return;
    }
    for (std::size_t e = elements.first; e < elements.end(); ++e)
      result_.set(e, {units[3 * e], units[3 * e + 1], units[3 * e + 2]});
  }

  void recompute() {
    blend_points();
    const auto large = source_.storage.large_faces();
    in_blocks(large.size(), kBlockOfLargeFaces, [this, large](IndexRange faces) {
      for (std::size_t i = faces.first; i < faces.end(); ++i) scratch_.large[i] = make_face(large[i]);
    });
    const RingSlices rings = source_.storage.rings().view();
    in_blocks(scratch_.again.words().size(), kBlockOfWords, [this, rings](IndexRange words) {
      std::size_t zeros = 0, uncertain = 0;
      for (std::size_t i = words.first; i < words.end(); ++i) {
        const std::uint64_t doubtful = unit_normals_of_rings(
            rings, scratch_.again.words()[i], i, scratch_.points.data(), 4 * point_noise_, kLimitsOfPoints, result_);
        for_bits(doubtful, i, [&](std::size_t e) { make_element(e, zeros, uncertain); });
      }
      zeros_ += zeros;
      uncertain_ += uncertain;
    });
    restore_points();
  }

  void recompute_in_float32() {
    float* const points = scratch_.float_points.data();
    in_blocks(source_.set.topology.vertex_count(), kBlockOfVertices, [this, points](IndexRange all) {
      for_near(all, [this, points](IndexRange vertices) {
        reset_points(source_.set.base, vertices, points);
        for_moved(vertices, [this, points](std::size_t i, const BlendTarget& target, IndexRange part) {
          move_points(in(part, target.vertices), target.deltas.data() + 3 * part.first, static_cast<float>(weights_[i]),
                      points);
        });
      });
    });
    const RingSlices rings = source_.storage.rings().view();
    in_blocks(rings.count, kBlockOfSlices, [this, points, rings](IndexRange slices) {
      const std::size_t first = kRingLanes * slices.first, end = std::min(kRingLanes * slices.end(), result_.count);
      zeros_ += ring_unit_normals({points, false}, rings, slices, result_.part({first, end - first}), false);
    });
  }

  // Calls body for vertices whose points stay in a cache near the core while all targets move them.
  template <class Body>
  static void for_near(IndexRange vertices, const Body& body) {
    for (std::size_t first = vertices.first; first < vertices.end(); first += kNearVertices)
      body(IndexRange{first, std::min(kNearVertices, vertices.end() - first)});
  }

  // Points at the weights, with the rounding of each in point_noise_.
  void blend_points() {
    double reach = source_.base.reach;
    for (const std::uint32_t i : scratch_.active) reach += std::fabs(weights_[i]) * source_.storage.targets()[i].reach;
    point_noise_ = kUnitRoundoff * static_cast<double>(1 + 2 * scratch_.active.size()) * reach;
    in_blocks(source_.set.topology.vertex_count(), kBlockOfVertices, [this](IndexRange all) {
      for_near(all, [this](IndexRange vertices) {
        for_moved(vertices, [this](std::size_t i, const BlendTarget& target, IndexRange part) {
          move_points(in(part, target.vertices), target.deltas.data() + 3 * part.first, weights_[i],
                      scratch_.points.data());
        });
      });
    });
  }

  // Points that many targets moved are put back faster in order.
  void restore_points() {
    in_blocks(source_.set.topology.vertex_count(), kBlockOfVertices, [this](IndexRange vertices) {
      std::size_t moved = 0;
      for_moved(vertices, [&moved](std::size_t, const BlendTarget&, IndexRange part) { moved += part.count; });
      if (moved >= vertices.count) return reset_points(source_.set.base, vertices, scratch_.points.data());
      for_moved(vertices, [this](std::size_t, const BlendTarget& target, IndexRange part) {
        for (const std::uint32_t v : in(part, target.vertices)) {
          for (std::size_t k = 0; k < 3; ++k)
            scratch_.points[kBlendLanes * v + k] = static_cast<double>(source_.set.base[3 * std::size_t{v} + k]);
        }
      });
    });
  }

  // Calls body(i, target, part) for the part of each active target in a range of vertices.
  template <class Body>
  void for_moved(IndexRange vertices, const Body& body) const {
    for (const std::uint32_t i : scratch_.active) {
      const BlendTarget& target = source_.set.targets[i];
      body(i, target, part_of(target.vertices, vertices));
    }
  }

  [[nodiscard]] Vec3d point(std::uint32_t v) const {
    const double* const p = scratch_.points.data() + kBlendLanes * std::size_t{v};
    return {p[0], p[1], p[2]};
  }

  // The vector area over a fan. Edges and both products of a component are within 10 u of the absolute products,
  // each triangle adds a rounding, and points bring their own.
  [[nodiscard]] BlendedFace make_face(std::size_t f) const {
    const auto face = source_.set.topology.face(f);
    struct Edge {
      Vec3d vector;
      double size;
    };
    const Vec3d a = point(face[0]);
    const auto edge_to = [&](std::size_t c) {
      const Vec3d edge = point(face[c]) - a;
      return Edge{edge, sum_abs(edge)};
    };
    BlendedFace result;
    double products = 0, edges = edge_to(1).size;
    for_fan(face.size(), edge_to, [&](const Edge& e, const Edge& g) {
      result.normal = result.normal + cross(e.vector, g.vector);
      products += e.size * g.size;
      edges += 2 * g.size;
    });
    const auto corners = static_cast<double>(face.size());
    const double moved = 4 * point_noise_;
    result.noise = kUnitRoundoff * (10 + corners) * products + moved * (edges + corners * moved);
    return result;
  }

  // Each corner of a large face asks for it.
  [[nodiscard]] BlendedFace face_at(std::size_t f) const {
    if (source_.set.topology.face(f).size() <= kMostRingPoints) return make_face(f);
    const auto large = source_.storage.large_faces();
    return scratch_.large[static_cast<std::size_t>(std::lower_bound(large.begin(), large.end(), f) - large.begin())];
  }

  template <class Body>
  void for_faces_of(std::size_t e, const Body& body) const {
    if (source_.groups == nullptr) return body(e);
    for (const std::uint32_t f : source_.groups->faces(e)) body(f);
  }

  // An element that lanes promise nothing of, with a bound of its own for each face.
  void make_element(std::size_t e, std::size_t& zeros, std::size_t& uncertain) {
    Vec3d n;
    double noise = 0, count = 0;
    for_faces_of(e, [&](std::size_t f) {
      const BlendedFace face = face_at(f);
      n = n + face.normal;
      noise += face.noise;
      ++count;
    });
    // Each addition is within u of the sum of absolute normals, which are at most twice the products that
    // make_face() counts 13 times.
    noise *= 1 + count / 6;
    const double square = dot(n, n);
    if (square >= kSmallestSquare && square <= kLargestSquare && square > noise * noise) {
      result_.set(e, to_float(1 / std::sqrt(square) * n));
      if (noise * noise > kLargestAngle * kLargestAngle * square) ++uncertain;
      return;
    }
    // Very small, very large, nothing but rounding, or not finite.
    const double largest = max_abs(n);
    if (sum_abs(n) <= std::numeric_limits<double>::max() && largest > noise) {
      result_.set(e, to_float(unit(n)));
      if (noise > kLargestAngle * largest) ++uncertain;
      return;
    }
    result_.set(e, {});
    ++zeros;
  }

  const BlendInput& source_;
  std::span<const double> weights_;
  BlendScratch& scratch_;
  VectorView<float> result_;
  Threads threads_;
  double point_noise_ = 0;
  std::atomic<std::size_t> zeros_ = 0, uncertain_ = 0;
};

}  // namespace

BlendChoice choose_path(const BlendInput& source, std::span<const double> weights, BlendScratch& scratch) noexcept {
  const auto targets = source.storage.targets();
  scratch.active.clear();
  scratch.touched.clear();
  scratch.again.clear();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    scratch.is_active[i] = weights[i] != 0;
    if (weights[i] != 0) scratch.active.push_back(static_cast<std::uint32_t>(i));
  }
  BlendChoice choice;
  choice.active_targets = scratch.active.size();
  std::size_t target_elements = 0, pair_elements = 0, moved_vertices = 0;
  for (const std::uint32_t i : scratch.active) {
    const StoredTarget& target = targets[i];
    moved_vertices += source.set.targets[i].vertices.size();
    scratch.touched.add(target.elements);
    if (!target.term.is_stored) {
      scratch.again.add(target.elements);
      continue;
    }
    target_elements += target.element_count;
    for (const StoredPair& pair : target.pairs) {
      if (!scratch.is_active[pair.other]) continue;
      if (pair.term.is_stored)
        pair_elements += pair.term.elements.size();
      else
        scratch.again.add_common(target.elements, targets[pair.other].elements);
    }
  }
  choice.touched_elements = scratch.touched.count();
  choice.unstored_elements = scratch.again.count();

  const auto of = [](std::size_t count) { return static_cast<double>(count); };
  const Rings& rings = source.storage.rings();
  const std::size_t elements = source.storage.terms().size();
  const double whole = kPathPoint * of(kRingLanes * rings.row_count()) + kWrittenElement * of(elements);
  const double anew = elements > 0 ? whole / of(elements) : 0;  // an element from points
  const double copied = kCopiedElement * of(elements), moved = kMovedVertex * of(moved_vertices);
  choice.terms_ns = copied + kTargetElement * of(target_elements) + kPairElement * of(pair_elements) +
                    kFinishedElement * of(choice.touched_elements - choice.unstored_elements);
  if (choice.unstored_elements > 0) choice.terms_ns += moved + anew * of(lanes_of(scratch.again));
  choice.touched_ns = copied + moved + anew * of(lanes_of(scratch.touched));
  choice.whole_ns = (source.in_float32 ? kWholeInFloat32 : 1) * (moved + whole);
  if (source.forced)
    choice.path = *source.forced;
  else if (choice.terms_ns <= std::min(choice.touched_ns, choice.whole_ns))
    choice.path = BlendPath::kTerms;
  else
    choice.path = choice.touched_ns <= choice.whole_ns ? BlendPath::kTouched : BlendPath::kWhole;
  return choice;
}

BlendEvaluation evaluate(const BlendInput& source, std::span<const double> weights, BlendScratch& scratch,
                         VectorView<float> result, Threads threads) {
  return Call(source, weights, scratch, result, threads).run();
}

}  // namespace chronormal::inline internal
