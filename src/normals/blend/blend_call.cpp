#include "normals/blend/blend_call.h"

#include <algorithm>
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

constexpr std::size_t kBlockOfVertices = 16384, kBlockOfLargeFaces = 64;
// The number of elements that are computed together. The sums of this number of elements take 16 KiB on the stack.
constexpr std::size_t kTileWords = 8, kTileElements = kTileWords * kBitsOfWord;
constexpr std::size_t kSlicesOfWord = kBitsOfWord / kRingLanes;
constexpr std::size_t kMostRows = kMostRingPoints + 2;
constexpr std::size_t kNearVertices = 4096;  // points of this many vertices take 128 KiB in double

constexpr double kSmallestSquare = 0x1p-900, kLargestSquare = 0x1p900;
// The largest error in radians of a normal in double, before the normal is rounded to float32.
constexpr double kLargestAngle = 8e-7;
constexpr UnitLimits kLimitsOfPoints = {kSmallestSquare, kLargestSquare, kLargestAngle};
// The limits for terms in float32. A normal within these limits has an error of at most 1e-6 rad: the error of the
// terms is at most 14 times 2^-24 |n(w)|, and the rounding of the result to float32 is added.
constexpr UnitLimits kLimitsOfTerms = {kSmallestSquare, kLargestSquare, 14};

// The costs of the steps of an evaluation, in nanoseconds, by which the path of the computation (BlendPath) is chosen.
// They were fitted to a grid of 15,000 vertices with up to 100 targets, on one core of the machine epyc-zen3-2cores in
// docs/benchmarks.md. Only their ratios matter.
constexpr double kCopiedElement = 0.35;   // copying the base normal of an element
constexpr double kTargetElement = 3;      // adding the terms of a target to an element
constexpr double kPairElement = 1.4;      // adding the term of a pair of targets to an element
constexpr double kFinishedElement = 5.5;  // making the unit normal of an element from its base and its terms
constexpr double kMovedVertex = 1.7;      // moving a vertex by a target, and back again
constexpr double kPathPoint = 1.8;        // adding a point of the path around an element
constexpr double kWrittenElement = 5;     // writing the unit normal of an element from the sum over its path
constexpr double kWholeInFloat32 = 0.4;   // a factor: the time of the whole mesh in float32 divided by that in double

// Returns the part of an ascending list of indices that is inside a range, as a range of places in the list.
IndexRange part_of(std::span<const std::uint32_t> list, IndexRange range) {
  if (list.empty() || list.back() < range.first || list.front() >= range.end()) return {};
  const auto place = [list](std::size_t index) {
    return static_cast<std::size_t>(std::lower_bound(list.begin(), list.end(), index) - list.begin());
  };
  const std::size_t first = range.first == 0 ? 0 : place(range.first);
  const std::size_t end = list.back() < range.end() ? list.size() : place(range.end());
  return {first, end - first};
}

// Returns the number of elements that are computed from points. Elements are computed in groups of four on every
// machine, so an element that was not requested counts, too, if another element of its group was requested.
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

// Returns the weights for the four lanes of a coefficient. The last lane is a bound of an error, so its weight is the
// absolute value.
RowWeights row_weights(double weight) { return {weight, weight, weight, std::fabs(weight)}; }

// Calls body for ranges of vertices that are so short that their points stay in a cache near the core while all targets
// move them.
template <class Body>
void for_near(IndexRange vertices, const Body& body) {
  for (std::size_t first = vertices.first; first < vertices.end(); first += kNearVertices)
    body(IndexRange{first, std::min(kNearVertices, vertices.end() - first)});
}

// Calls body(i, target, part) for each active target i. `part` is the part of the target's list of vertices that is in
// the range `vertices`.
template <class Body>
void for_moved(const BlendSet& set, const BlendPose& pose, IndexRange vertices, const Body& body) {
  for (const std::uint32_t i : pose.active) {
    const BlendTarget& target = set.targets[i];
    body(i, target, part_of(target.vertices, vertices));
  }
}

void blend_float_points(const BlendInput& source, BlendPose& pose, Threads threads) {
  float* const points = pose.float_points.data();
  blocks_on(threads, source.set.topology.vertex_count(), kBlockOfVertices, [&](IndexRange all) {
    for_near(all, [&](IndexRange vertices) {
      reset_points(source.set.base, vertices, points);
      for_moved(source.set, pose, vertices, [&](std::size_t i, const BlendTarget& target, IndexRange part) {
        move_points(in(part, target.vertices), target.deltas.data() + 3 * part.first,
                    static_cast<float>(pose.weights[i]), points);
      });
    });
  });
}

void blend_points(const BlendInput& source, BlendPose& pose, Threads threads) {
  blocks_on(threads, source.set.topology.vertex_count(), kBlockOfVertices, [&](IndexRange all) {
    for_near(all, [&](IndexRange vertices) {
      for_moved(source.set, pose, vertices, [&](std::size_t i, const BlendTarget& target, IndexRange part) {
        move_points(in(part, target.vertices), target.deltas.data() + 3 * part.first, pose.weights[i],
                    pose.points.data());
      });
    });
  });
  pose.has_points = true;
}

// Sets points back to the base after active targets have moved them. If many points were moved, it is faster to set all
// points in order.
void restore_points(const BlendInput& source, BlendPose& pose, Threads threads) {
  blocks_on(threads, source.set.topology.vertex_count(), kBlockOfVertices, [&](IndexRange vertices) {
    std::size_t moved = 0;
    for_moved(source.set, pose, vertices,
              [&moved](std::size_t, const BlendTarget&, IndexRange part) { moved += part.count; });
    if (moved >= vertices.count) return reset_points(source.set.base, vertices, pose.points.data());
    for_moved(source.set, pose, vertices, [&](std::size_t, const BlendTarget& target, IndexRange part) {
      for (const std::uint32_t v : in(part, target.vertices)) {
        for (std::size_t k = 0; k < 3; ++k)
          pose.points[kBlendLanes * v + k] = static_cast<double>(source.set.base[3 * std::size_t{v} + k]);
      }
    });
  });
  pose.has_points = false;
}

// One call of evaluate(), which computes the normals of a range of elements at the weights of a pose. A call writes
// only results, so several threads can share a pose.
class Call {
 public:
  Call(const BlendInput& source, const BlendPose& pose) : source_(source), pose_(pose) {}

  // Writes the normals of a range of elements to `result`. The index of the first element must be a multiple of
  // kBitsOfWord.
  BlendEvaluation run(IndexRange elements, VectorView<float> result) {
    if (pose_.choice.path == BlendPath::kWhole && source_.in_float32) {
      const IndexRange slices{elements.first / kRingLanes, (elements.count + kRingLanes - 1) / kRingLanes};
      if (elements.count > 0) {
        const RingSlices rings = rings_from(slices.first);
        done_.zeros = ring_unit_normals({pose_.float_points.data(), false}, rings, {0, slices.count}, result, false);
      }
      done_.recomputed_elements = elements.count;
      return done_;
    }
    for (std::size_t i = 0; i < elements.count; i += kTileElements) {
      const std::size_t count = std::min(kTileElements, elements.count - i);
      write_tile({elements.first + i, count}, result.part({i, count}));
    }
    return done_;
  }

  // Returns the normal of a large face. The normal is computed once and stored, because the elements at all corners of
  // the face need it.
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
    // The loop below also bounds the error of the sum over the fan. The errors of the edges and of both products in a
    // component come to at most 10 u times the absolute products, where u = 2^-53. Each triangle adds a rounding, and
    // points have an error of their own.
    BlendedFace result;
    double products = 0, edges = edge_to(1).size;
    for_fan(face.size(), edge_to, [&](const Edge& e, const Edge& g) {
      result.normal = result.normal + cross(e.vector, g.vector);
      products += e.size * g.size;
      edges += 2 * g.size;
    });
    const auto corners = static_cast<double>(face.size());
    const double moved = 4 * pose_.point_noise;
    result.noise = kUnitRoundoff * (10 + corners) * products + moved * (edges + corners * moved);
    return result;
  }

 private:
  [[nodiscard]] RingSlices rings_from(std::size_t slice) const {
    const RingSlices all = source_.storage.rings().view();
    return {all.indices, all.first_row + slice, all.count - slice};
  }

  void write_tile(IndexRange elements, const VectorView<float>& result) {
    const IndexRange words{elements.first / kBitsOfWord, words_of(elements.count)};
    const auto touched = pose_.touched.words().subspan(words.first, words.count);
    std::uint64_t again[kTileWords];
    std::copy_n(pose_.again.words().begin() + static_cast<std::ptrdiff_t>(words.first), words.count, again);
    if (pose_.choice.path != BlendPath::kWhole) add_terms(elements, words, touched, again, result);
    for (std::size_t i = 0; i < words.count; ++i) {
      if (i + 1 == words.count && elements.count % kBitsOfWord != 0)  // the range may end within a word
        again[i] &= (std::uint64_t{1} << (elements.count % kBitsOfWord)) - 1;
      if (again[i] == 0) continue;
      done_.recomputed_elements += static_cast<std::size_t>(std::popcount(again[i]));
      const std::uint64_t doubtful =
          pose_.has_points ? unit_normals_of_rings(rings_from(words.first * kSlicesOfWord), again[i], i,
                                                   pose_.points.data(), 4 * pose_.point_noise, kLimitsOfPoints, result)
                           : make_rings(again[i], words.first, i, result);
      for_bits(doubtful, i, [&](std::size_t e) { make_element(elements.first + e, e, result); });
    }
  }

  // Writes the normals of elements from stored terms, except for the elements in `again`. If terms in float32 do not
  // guarantee the accuracy of an element, adds the element to `again` instead.
  void add_terms(IndexRange elements, IndexRange words, std::span<const std::uint64_t> touched, std::uint64_t* again,
                 const VectorView<float>& result) {
    copy_base(elements, result);
    const auto base_zeros = source_.base.zeros.words().subspan(words.first, words.count);
    std::size_t left = 0;
    for (std::size_t i = 0; i < words.count; ++i) {
      const std::size_t behind = std::min(kBitsOfWord, elements.count - i * kBitsOfWord);
      const std::uint64_t inside = behind == kBitsOfWord ? ~std::uint64_t{0} : (std::uint64_t{1} << behind) - 1;
      done_.zeros += static_cast<std::size_t>(std::popcount(base_zeros[i] & ~touched[i] & inside));
      left += static_cast<std::size_t>(std::popcount(touched[i] & ~again[i] & inside));
    }
    if (left == 0) return;
    alignas(64) double sums[kBlendLanes * kTileElements];
    const std::size_t first = elements.first;
    std::memcpy(sums, source_.base.sums.data() + kBlendLanes * first, kBlendLanes * elements.count * sizeof(double));
    for (const std::uint32_t i : pose_.active) {
      const StoredTarget& target = source_.storage.targets()[i];
      if (!target.term.is_stored) continue;
      const double weight = pose_.weights[i];
      const double linear = weight * target.term.scale, square = weight * weight * target.term.scale;
      IndexRange part = part_of(target.term.elements, elements);
      // The list of a target has all elements that touch a face which the target moves. So the list also has all
      // elements of the stored pairs of the target. If a part of the list is empty, the pairs have nothing to add
      // either.
      if (part.count == 0) continue;
      add_target_rows(in(part, target.term.elements), target.term.lanes.data() + 2 * kBlendLanes * part.first,
                      row_weights(linear), row_weights(square), first, sums);
      for (const StoredPair& pair : target.pairs) {
        if (!pose_.is_active[pair.other] || !pair.term.is_stored) continue;
        part = part_of(pair.term.elements, elements);
        if (part.count == 0) continue;
        add_pair_rows(in(part, pair.term.elements), pair.term.lanes.data() + kBlendLanes * part.first,
                      row_weights(weight * pose_.weights[pair.other] * pair.term.scale), first, sums);
      }
    }
    for (std::size_t i = 0; i < words.count; ++i) {
      std::uint64_t wanted = touched[i] & ~again[i];
      if (i + 1 == words.count && elements.count % kBitsOfWord != 0)
        wanted &= (std::uint64_t{1} << (elements.count % kBitsOfWord)) - 1;
      again[i] |= unit_normals_of_rows(wanted, i, sums, kLimitsOfTerms, result);
    }
  }

  void copy_base(IndexRange elements, const VectorView<float>& result) const {
    const float* const units = source_.base.units.data() + 3 * elements.first;
    if (result.is_packed()) {
      std::memcpy(result.x, units, 3 * sizeof(float) * elements.count);
      return;
    }
    for (std::size_t i = 0; i < elements.count; ++i) result.set(i, {units[3 * i], units[3 * i + 1], units[3 * i + 2]});
  }

  // Computes the normals of a few elements whose points are not blended yet, as unit_normals_of_rings() would. Blends
  // only the points of the paths around these elements, for four elements at a time, in the layout that the kernel
  // needs.
  std::uint64_t make_rings(std::uint64_t elements, std::size_t first_word, std::size_t word,
                           const VectorView<float>& result) const {
    constexpr std::size_t kLanes = 4;
    const RingSlices rings = rings_from((first_word + word) * kSlicesOfWord);
    std::uint64_t doubtful = 0;
    for (std::size_t lane = 0; lane < kBitsOfWord; lane += kLanes) {
      const std::uint64_t some = elements & (std::uint64_t{(1U << kLanes) - 1} << lane);
      if (some == 0) continue;
      const std::size_t slice = lane / kRingLanes, row_count = rings.first_row[slice + 1] - rings.first_row[slice];
      if (row_count > kMostRows) {
        doubtful |= some;
        continue;
      }
      alignas(64) double points[kBlendLanes * kLanes * kMostRows];
      alignas(64) std::uint32_t indices[kRingLanes * kMostRows] = {};
      for (std::size_t r = 0; r < row_count; ++r) {
        for (std::size_t k = 0; k < kLanes; ++k) {
          const std::size_t column = lane % kRingLanes + k, local = r * kLanes + k;
          const std::uint32_t vertex = rings.indices[kRingLanes * (rings.first_row[slice] + r) + column];
          indices[kRingLanes * r + column] = static_cast<std::uint32_t>(local);
          const Vec3d p = point(vertex);
          double* const row = points + kBlendLanes * local;
          row[0] = p.x, row[1] = p.y, row[2] = p.z, row[3] = 0;
        }
      }
      // The kernel expects the offsets of all slices of the tile, which have sixteen elements each. All slices except
      // the slice of these elements are described as empty.
      std::size_t first_row[kTileElements / kRingLanes + 1] = {};
      std::fill(std::begin(first_row) + static_cast<std::ptrdiff_t>(word * kSlicesOfWord + slice) + 1,
                std::end(first_row), row_count);
      doubtful |= unit_normals_of_rings({indices, first_row, kTileElements / kRingLanes}, some, word, points,
                                        4 * pose_.point_noise, kLimitsOfPoints, result);
    }
    return doubtful;
  }

  [[nodiscard]] Vec3d point(std::uint32_t v) const {
    const double* const p = pose_.points.data() + kBlendLanes * std::size_t{v};
    Vec3d result{p[0], p[1], p[2]};
    if (pose_.has_points) return result;
    for (const std::uint32_t i : pose_.active) {  // in the same order as in move_points(), for the same bits
      const BlendTarget& target = source_.set.targets[i];
      const auto at = std::lower_bound(target.vertices.begin(), target.vertices.end(), v);
      if (at == target.vertices.end() || *at != v) continue;
      const float* const delta = target.deltas.data() + 3 * (at - target.vertices.begin());
      result = result + pose_.weights[i] * to_double(Vec3f{delta[0], delta[1], delta[2]});
    }
    return result;
  }

  [[nodiscard]] BlendedFace face_at(std::size_t f) const {
    if (source_.set.topology.face(f).size() <= kMostRingPoints) return make_face(f);
    const auto large = source_.storage.large_faces();
    return pose_.large[static_cast<std::size_t>(std::lower_bound(large.begin(), large.end(), f) - large.begin())];
  }

  template <class Body>
  void for_faces_of(std::size_t e, const Body& body) const {
    if (source_.groups == nullptr) return body(e);
    for (const std::uint32_t f : source_.groups->faces(e)) body(f);
  }

  // Computes the normal of an element for which lanes do not guarantee the accuracy. The error bound is tighter than
  // that of the lanes, because each face of the element has an error bound of its own.
  void make_element(std::size_t e, std::size_t place, const VectorView<float>& result) {
    Vec3d n;
    double noise = 0, count = 0;
    for_faces_of(e, [&](std::size_t f) {
      const BlendedFace face = face_at(f);
      n = n + face.normal;
      noise += face.noise;
      ++count;
    });
    // Each of the `count` additions has an error of at most u = 2^-53 times the sum of the absolute normals. This sum
    // is at most twice the products in make_face(), and the noise of a face is at least 13 u times its products. An
    // addition thus adds at most 2/13 of the noise.
    noise *= 1 + count / 6;
    const double square = dot(n, n);
    if (square >= kSmallestSquare && square <= kLargestSquare && square > noise * noise) {
      result.set(place, to_float(1 / std::sqrt(square) * n));
      if (noise * noise > kLargestAngle * kLargestAngle * square) ++done_.uncertain_elements;
      return;
    }
    // This code is reached if the normal is very small, very large, only rounding error, or not finite.
    const double largest = max_abs(n);
    if (sum_abs(n) <= std::numeric_limits<double>::max() && largest > noise) {
      result.set(place, to_float(unit(n)));
      if (noise > kLargestAngle * largest) ++done_.uncertain_elements;
      return;
    }
    result.set(place, {});
    ++done_.zeros;
  }

  const BlendInput& source_;
  const BlendPose& pose_;
  BlendEvaluation done_{};
};

}  // namespace

BlendChoice choose_path(const BlendInput& source, std::span<const double> weights, BlendPose& pose) noexcept {
  const auto targets = source.storage.targets();
  pose.active.clear();
  pose.touched.clear();
  pose.again.clear();
  for (std::size_t i = 0; i < targets.size(); ++i) {
    pose.is_active[i] = weights[i] != 0;
    if (weights[i] != 0) pose.active.push_back(static_cast<std::uint32_t>(i));
  }
  BlendChoice choice;
  choice.active_targets = pose.active.size();
  std::size_t target_elements = 0, pair_elements = 0, moved_vertices = 0;
  for (const std::uint32_t i : pose.active) {
    const StoredTarget& target = targets[i];
    moved_vertices += source.set.targets[i].vertices.size();
    pose.touched.add(target.elements);
    if (!target.term.is_stored) {
      pose.again.add(target.elements);
      continue;
    }
    target_elements += target.element_count;
    for (const StoredPair& pair : target.pairs) {
      if (!pose.is_active[pair.other]) continue;
      if (pair.term.is_stored)
        pair_elements += pair.term.elements.size();
      else
        pose.again.add_common(target.elements, targets[pair.other].elements);
    }
  }
  choice.touched_elements = pose.touched.count();
  choice.unstored_elements = pose.again.count();

  const auto of = [](std::size_t count) { return static_cast<double>(count); };
  const Rings& rings = source.storage.rings();
  const std::size_t elements = source.storage.terms().size();
  const double whole = kPathPoint * of(kRingLanes * rings.row_count()) + kWrittenElement * of(elements);
  // The average cost in nanoseconds of computing an element from points.
  const double anew = elements > 0 ? whole / of(elements) : 0;
  const double copied = kCopiedElement * of(elements), moved = kMovedVertex * of(moved_vertices);
  choice.terms_ns = copied + kTargetElement * of(target_elements) + kPairElement * of(pair_elements) +
                    kFinishedElement * of(choice.touched_elements - choice.unstored_elements);
  if (choice.unstored_elements > 0) choice.terms_ns += moved + anew * of(lanes_of(pose.again));
  choice.touched_ns = copied + moved + anew * of(lanes_of(pose.touched));
  choice.whole_ns = (source.in_float32 ? kWholeInFloat32 : 1) * (moved + whole);
  if (source.forced)
    choice.path = *source.forced;
  else if (choice.terms_ns <= std::min(choice.touched_ns, choice.whole_ns))
    choice.path = BlendPath::kTerms;
  else
    choice.path = choice.touched_ns <= choice.whole_ns ? BlendPath::kTouched : BlendPath::kWhole;
  return choice;
}

BlendChoice set_weights(const BlendInput& source, std::span<const double> weights, BlendPose& pose, Threads threads) {
  if (pose.has_points) restore_points(source, pose, threads);
  pose.choice = choose_path(source, weights, pose);
  std::copy(weights.begin(), weights.end(), pose.weights.begin());
  double reach = source.base.reach;
  for (const std::uint32_t i : pose.active) reach += std::fabs(weights[i]) * source.storage.targets()[i].reach;
  pose.point_noise = kUnitRoundoff * static_cast<double>(1 + 2 * pose.active.size()) * reach;
  const BlendPath path = pose.choice.path;
  if (path == BlendPath::kWhole && source.in_float32) {
    blend_float_points(source, pose, threads);
    return pose.choice;
  }
  if (path == BlendPath::kWhole) pose.again.fill(source.storage.terms().size());
  if (path == BlendPath::kTouched) pose.again.add(pose.touched);
  const auto large = source.storage.large_faces();
  if (path == BlendPath::kTerms && pose.choice.unstored_elements == 0 && large.empty()) return pose.choice;
  blend_points(source, pose, threads);
  blocks_on(threads, large.size(), kBlockOfLargeFaces, [&](IndexRange faces) {
    for (std::size_t i = faces.first; i < faces.end(); ++i) pose.large[i] = Call(source, pose).make_face(large[i]);
  });
  return pose.choice;
}

BlendEvaluation evaluate(const BlendInput& source, const BlendPose& pose, IndexRange elements,
                         VectorView<float> result) noexcept {
  BlendEvaluation done = Call(source, pose).run(elements, result);
  static_cast<BlendChoice&>(done) = pose.choice;
  return done;
}

}  // namespace chronormal::inline internal
