#include "normals/blend/blend_call.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>

#include "core/blocks.h"
#include "core/rounding.h"
#include "core/vector_area.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlockOfWords = 256;  // for a thread: 16,384 elements or faces
constexpr std::size_t kBlockOfVertices = 16384;

// Float32 terms promise 1e-6 rad where their bound is at most so many times |n(w)|: 14 x 2^-24, and what the rounding
// of the result adds.
constexpr double kMostBound = 14;
constexpr double kSmallestSquare = 0x1p-900, kLargestSquare = 0x1p900;

constexpr double kLargestAngle = 8e-7;  // of double, before the rounding of the result

// Nanoseconds, fitted to a face of 19,158 vertices with up to 102 targets, as quads and as triangles, on one core of
// the machine of docs/benchmarks.md.
constexpr double kCopiedElement = 0.35;   // of the base normals
constexpr double kTargetElement = 1.6;    // the terms of a target
constexpr double kPairElement = 2.1;      // the term of a pair
constexpr double kFinishedElement = 5.5;  // from the base to length 1
constexpr double kMovedVertex = 2.4;      // of a target, and back again
constexpr double kFace = 1.5, kTriangle = 1.9, kTermOfSum = 1.1, kSummedElement = 2.5;
constexpr double kRim = 1.04;  // a part of the elements has more faces than its share

// What of an ascending list lies inside a range of indices.
IndexRange part_of(std::span<const std::uint32_t> list, IndexRange range) {
  const auto place = [list](std::size_t index) {
    return static_cast<std::size_t>(std::lower_bound(list.begin(), list.end(), index) - list.begin());
  };
  const std::size_t first = range.first == 0 ? 0 : place(range.first);
  const std::size_t end = list.empty() || list.back() < range.end() ? list.size() : place(range.end());
  return {first, end - first};
}

// The weights of the four lanes of a coefficient.
std::array<double, kBlendLanes> lane_weights(double weight) { return {weight, weight, weight, std::fabs(weight)}; }

// Adds the terms of one target to the sums of the elements of a range.
void add_target(const StoredTerm& term, double weight, IndexRange range, double* sums) {
  const auto a = lane_weights(weight * term.scale), c = lane_weights(weight * weight * term.scale);
  const IndexRange part = part_of(term.elements, range);
  for (std::size_t i = part.first; i < part.end(); ++i) {
    const float* const lanes = term.lanes.data() + 2 * kBlendLanes * i;
    double* const sum = sums + kBlendLanes * term.elements[i];
    for (std::size_t k = 0; k < kBlendLanes; ++k)
      sum[k] += a[k] * static_cast<double>(lanes[k]) + c[k] * static_cast<double>(lanes[kBlendLanes + k]);
  }
}

void add_pair(const StoredTerm& term, double weight, IndexRange range, double* sums) {
  const auto c = lane_weights(weight * term.scale);
  const IndexRange part = part_of(term.elements, range);
  for (std::size_t i = part.first; i < part.end(); ++i) {
    const float* const lanes = term.lanes.data() + kBlendLanes * i;
    double* const sum = sums + kBlendLanes * term.elements[i];
    for (std::size_t k = 0; k < kBlendLanes; ++k) sum[k] += c[k] * static_cast<double>(lanes[k]);
  }
}

// Brings sums to length 1, a few at a time, and says which float32 could not carry.
class Finish {
 public:
  Finish(VectorView<float> result, std::span<std::uint64_t> again) : result_(result), again_(again) {}

  void add(std::size_t e, const double* sum) {
    elements_[count_] = e;
    x_[count_] = sum[0], y_[count_] = sum[1], z_[count_] = sum[2], bound_[count_] = sum[3];
    if (++count_ == kTile) flush();
  }

  void flush() {
    for (std::size_t i = 0; i < kTile; ++i) {
      const double square = x_[i] * x_[i] + y_[i] * y_[i] + z_[i] * z_[i];
      square_[i] = square;
      inverse_[i] = 1 / std::sqrt(square);
    }
    for (std::size_t i = 0; i < count_; ++i) {
      const std::size_t e = elements_[i];
      const bool is_good = square_[i] >= kSmallestSquare && square_[i] <= kLargestSquare &&
                           bound_[i] * bound_[i] <= kMostBound * kMostBound * square_[i];
      if (is_good)
        result_.set(e, to_float({inverse_[i] * x_[i], inverse_[i] * y_[i], inverse_[i] * z_[i]}));
      else
        again_[e / kBitsOfWord] |= std::uint64_t{1} << (e % kBitsOfWord);
    }
    count_ = 0;
  }

 private:
  static constexpr std::size_t kTile = 16;

  VectorView<float> result_;
  std::span<std::uint64_t> again_;
  std::size_t count_ = 0;
  std::array<std::size_t, kTile> elements_{};
  std::array<double, kTile> x_{}, y_{}, z_{}, bound_{}, square_{}, inverse_{};
};

class Call {
 public:
  Call(const BlendInput& source, std::span<const double> weights, BlendScratch& scratch, VectorView<float> result,
       Threads threads)
      : source_(source), weights_(weights), scratch_(scratch), result_(result), threads_(threads) {}

  BlendEvaluation run() {
    BlendEvaluation done{choose_path(source_, weights_, scratch_)};
    if (done.path == BlendPath::kWhole) {
      scratch_.again.fill(result_.count);
    } else {
      if (done.path == BlendPath::kTouched) scratch_.again.add(scratch_.touched);
      in_blocks(scratch_.touched.words().size(), kBlockOfWords, [this](IndexRange words) { add_terms(words); });
    }
    done.recomputed_elements = scratch_.again.count();
    if (done.recomputed_elements > 0) recompute(done.path);
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
      add_target(target.term, weights_[i], elements, sums);
      for (const StoredPair& pair : target.pairs) {
        if (scratch_.is_active[pair.other] && pair.term.is_stored)
          add_pair(pair.term, weights_[i] * weights_[pair.other], elements, sums);
      }
    }
    Finish finish(result_, again);
    for (std::size_t i = words.first; i < words.end(); ++i)
      for_bits(touched[i] & ~again[i], i, [&](std::size_t e) { finish.add(e, sums + kBlendLanes * e); });
    finish.flush();
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

  void recompute(BlendPath path) {
    blend_positions();
    if (path == BlendPath::kWhole) {
      in_blocks(scratch_.normals.size(), kBlockOfWords * kBitsOfWord, [this](IndexRange faces) {
        for (std::size_t f = faces.first; f < faces.end(); ++f) make_face(f);
      });
    } else {
      list_faces(path);
      in_blocks(scratch_.faces.words().size(), kBlockOfWords, [this](IndexRange words) {
        for_bits(scratch_.faces.words(), words, [this](std::size_t f) { make_face(f); });
      });
    }
    in_blocks(scratch_.again.words().size(), kBlockOfWords, [this](IndexRange words) {
      std::size_t zeros = 0, uncertain = 0;
      for_bits(scratch_.again.words(), words, [&](std::size_t e) { make_element(e, zeros, uncertain); });
      zeros_ += zeros;
      uncertain_ += uncertain;
    });
    restore_positions();
  }

  // The faces of the elements that are made again.
  void list_faces(BlendPath path) {
    scratch_.faces.clear();
    if (path == BlendPath::kTouched) {
      for (const std::uint32_t i : scratch_.active) scratch_.faces.add(source_.storage.targets()[i].faces);
      return;
    }
    for_bits(scratch_.again.words(), {0, scratch_.again.words().size()},
             [this](std::size_t e) { for_faces_of(e, [this](std::size_t f) { scratch_.faces.set(f); }); });
  }

  // Positions at the weights, with the rounding of each in position_noise_.
  void blend_positions() {
    double reach = source_.base.reach;
    for (const std::uint32_t i : scratch_.active) reach += std::fabs(weights_[i]) * source_.storage.targets()[i].reach;
    position_noise_ = kUnitRoundoff * static_cast<double>(1 + 2 * scratch_.active.size()) * reach;
    for_moved([this](std::size_t i, const BlendTarget& target, IndexRange part) {
      const double weight = weights_[i];
      for (std::size_t n = part.first; n < part.end(); ++n) {
        double* const p = scratch_.positions.data() + 3 * std::size_t{target.vertices[n]};
        const float* const d = target.deltas.data() + 3 * n;
        for (std::size_t k = 0; k < 3; ++k) p[k] += weight * static_cast<double>(d[k]);
      }
    });
  }

  void restore_positions() {
    for_moved([this](std::size_t, const BlendTarget& target, IndexRange part) {
      for (std::size_t n = part.first; n < part.end(); ++n) {
        const std::size_t first = 3 * std::size_t{target.vertices[n]};
        for (std::size_t k = first; k < first + 3; ++k)
          scratch_.positions[k] = static_cast<double>(source_.set.base[k]);
      }
    });
  }

  // Calls body(i, target, part) for the part of each active target in a block of vertices.
  template <class Body>
  void for_moved(const Body& body) const {
    in_blocks(source_.set.topology.vertex_count(), kBlockOfVertices, [&](IndexRange vertices) {
      for (const std::uint32_t i : scratch_.active) {
        const BlendTarget& target = source_.set.targets[i];
        body(i, target, part_of(target.vertices, vertices));
      }
    });
  }

  [[nodiscard]] Vec3d position(std::uint32_t v) const {
    const double* const p = scratch_.positions.data() + 3 * std::size_t{v};
    return {p[0], p[1], p[2]};
  }

  // The vector area over a fan. Edges and both products of a component are within 10 u of the absolute products,
  // each triangle adds a rounding, and positions bring their own.
  void make_face(std::size_t f) {
    const auto face = source_.set.topology.face(f);
    struct Edge {
      Vec3d vector;
      double size;
    };
    const Vec3d a = position(face[0]);
    const auto edge_to = [&](std::size_t c) {
      const Vec3d edge = position(face[c]) - a;
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
    const double moved = 4 * position_noise_;
    result.noise = kUnitRoundoff * (10 + corners) * products + moved * (edges + corners * moved);
    scratch_.normals[f] = result;
  }

  template <class Body>
  void for_faces_of(std::size_t e, const Body& body) const {
    if (source_.groups == nullptr) return body(e);
    for (const std::uint32_t f : source_.groups->faces(e)) body(f);
  }

  void make_element(std::size_t e, std::size_t& zeros, std::size_t& uncertain) {
    Vec3d n;
    double noise = 0, count = 0;
    for_faces_of(e, [&](std::size_t f) {
      const BlendedFace& face = scratch_.normals[f];
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
  double position_noise_ = 0;
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

  const Topology& topology = source.set.topology;
  const auto of = [](std::size_t count) { return static_cast<double>(count); };
  const double elements = of(source.storage.terms().size()), faces = of(topology.face_count());
  const double corners = of(topology.corner_count());
  choice.whole_ns = kFace * faces + kTriangle * (corners - 2 * faces) +
                    kTermOfSum * (source.groups == nullptr ? faces : corners) + kSummedElement * elements;
  const double copied = kCopiedElement * elements, moved = kMovedVertex * of(moved_vertices);
  const double anew = elements > 0 ? kRim * choice.whole_ns / elements : 0;  // an element from positions
  choice.terms_ns = copied + kTargetElement * of(target_elements) + kPairElement * of(pair_elements) +
                    kFinishedElement * of(choice.touched_elements - choice.unstored_elements);
  if (choice.unstored_elements > 0) choice.terms_ns += moved + anew * of(choice.unstored_elements);
  choice.touched_ns = copied + moved + anew * of(choice.touched_elements);
  choice.whole_ns += moved;
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
