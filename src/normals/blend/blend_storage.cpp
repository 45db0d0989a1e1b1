// Lists the terms of a set of targets, decides which of them are worth their memory, and computes them.
#include "normals/blend/blend_storage.h"

#include <algorithm>
#include <cmath>
#include <tuple>
#include <utility>

#include "chronormal/core/parallel.h"
#include "core/rounding.h"
#include "normals/blend/blend_scratch.h"
#include "normals/blend/kernels/blend_rows.h"

namespace chronormal::inline internal {
namespace {

// Terms that are computed at the same time need at most 1 / kShareOfWork of the bytes of all terms. A single term may
// need more.
constexpr std::size_t kShareOfWork = 8;

// The number of bytes that an element takes in the terms of a target, and in the term of a pair of targets.
constexpr std::size_t kTargetBytes = sizeof(std::uint32_t) + 2 * kBlendLanes * sizeof(float);
constexpr std::size_t kPairBytes = sizeof(std::uint32_t) + kBlendLanes * sizeof(float);

// The factor by which error bounds are enlarged, so that they hold despite their own rounding to float32.
// kSmallestBound is added to each bound, for values near the lower end of the range of float32.
constexpr double kMargin = 1 + 0x1p-20, kSmallestBound = 0x1p-120;

std::size_t bytes_of(const StoredTerm& term) {
  return term.elements.capacity() * sizeof(std::uint32_t) + term.lanes.capacity() * sizeof(float);
}

std::size_t bytes_of_lists(const StoredTarget& target) {
  return target.elements.bytes() + target.pairs.capacity() * sizeof(StoredPair);
}

// Returns a power of two by which the largest value can be divided so that the quotient is below 1.
double scale_of(double largest) {
  int exponent = 0;
  std::frexp(largest, &exponent);
  return std::ldexp(1.0, exponent);
}

double largest_of(const BlendTerm& term) {
  double largest = 0;
  for (const Vec3d& value : term.values) largest = std::max(largest, max_abs(value));
  return largest;
}

void put(const Vec3d& value, double noise, double scale, float* lanes) {
  const double bound = (length(value) + noise / kFloatUnitRoundoff) / scale * kMargin + kSmallestBound;
  lanes[0] = static_cast<float>(value.x / scale);
  lanes[1] = static_cast<float>(value.y / scale);
  lanes[2] = static_cast<float>(value.z / scale);
  lanes[3] = static_cast<float>(bound);
}

// Copies the coefficients of a term to a stored term, which has `stride` lanes for each element. The four lanes of a
// coefficient begin at lane `first` of its element. All elements of `term` must be elements of `stored`.
void put_all(const BlendTerm& term, std::size_t first, std::size_t stride, StoredTerm& stored) {
  std::size_t e = 0;
  for (std::size_t i = 0; i < term.elements.size(); ++i) {
    while (stored.elements[e] != term.elements[i]) ++e;
    put(term.values[i], term.noise[i], stored.scale, stored.lanes.data() + stride * e + first);
  }
}

}  // namespace

// A term that may be stored if there is memory for it.
struct BlendStorage::Candidate {
  std::size_t bytes;
  std::size_t target;
  std::size_t pair;  // index into the target's pairs; kNone for the target's own term

  static constexpr std::size_t kNone = ~std::size_t{0};
};

// A term that has been chosen and is to be computed.
struct BlendStorage::ListedTerm {
  std::size_t target;
  StoredPair* pair;  // nullptr for the target's own term
  std::size_t work;  // number of bytes that the computation takes
};

BlendStorage::BlendStorage(const BlendSet& set, const NormalGroups* groups, std::size_t max_bytes)
    : set_(set),
      max_bytes_(max_bytes),
      terms_(groups ? BlendTerms(set, *groups) : BlendTerms(set)),
      rings_(groups ? Rings::of_groups(set.topology, *groups, kMostRingPoints)
                    : Rings::of_faces(set.topology, kMostRingPoints)) {
  for (std::size_t f = 0; f < set.topology.face_count(); ++f)
    if (set.topology.face(f).size() > kMostRingPoints) large_faces_.push_back(static_cast<std::uint32_t>(f));
  large_faces_.shrink_to_fit();
  targets_.reserve(set.targets.size());
  for (std::size_t i = 0; i < set.targets.size(); ++i) targets_.push_back(listed(i));
  const auto counts = terms_.pair_elements();
  std::size_t count = targets_.size();
  for (const auto& of_target : counts) count += of_target.size();
  std::vector<Candidate> candidates;
  candidates.reserve(count);
  for (std::size_t i = 0; i < counts.size(); ++i) {
    candidates.push_back({kTargetBytes * targets_[i].element_count, i, Candidate::kNone});
    targets_[i].pairs.reserve(counts[i].size());
    for (const auto& [other, elements] : counts[i]) {
      candidates.push_back({kPairBytes * elements, i, targets_[i].pairs.size()});
      targets_[i].pairs.push_back({other, elements, {}});
    }
  }
  choose(std::move(candidates));
}

StoredTarget BlendStorage::listed(std::size_t i) const {
  StoredTarget target;
  const std::vector<std::uint32_t> elements = terms_.elements(i);
  IndexBits touched(terms_.size());
  for (const std::uint32_t e : elements) touched.set(e);
  target.elements = touched.sparse();
  target.element_count = elements.size();
  target.moved_faces = terms_.faces(i).size();
  for (const std::uint32_t f : terms_.faces(i)) target.moved_corners += set_.topology.face(f).size();
  for (const float d : set_.targets[i].deltas) target.reach = std::max(target.reach, std::fabs(static_cast<double>(d)));
  return target;
}

// Chooses the terms to be stored, the smallest ones first: those of targets, and then those of pairs of stored targets.
void BlendStorage::choose(std::vector<Candidate> candidates) {
  std::sort(candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
    const bool a_is_pair = a.pair != Candidate::kNone, b_is_pair = b.pair != Candidate::kNone;
    return std::tuple(a_is_pair, a.bytes, a.target, a.pair) < std::tuple(b_is_pair, b.bytes, b.target, b.pair);
  });
  update_cost();
  std::size_t bytes = cost_.bytes;
  for (const Candidate& candidate : candidates) {
    if (bytes > max_bytes_ || candidate.bytes > max_bytes_ - bytes) continue;
    StoredTarget& target = targets_[candidate.target];
    if (candidate.pair == Candidate::kNone) {
      target.term.is_stored = true;
    } else {
      StoredPair& pair = target.pairs[candidate.pair];
      if (!target.term.is_stored || !targets_[pair.other].term.is_stored) continue;
      pair.term.is_stored = true;
    }
    bytes += candidate.bytes;
  }
  update_cost();
}

// Computes the chosen terms, many at once, since a term with few elements does not keep several threads busy. Together,
// the terms that are computed at once take at most work_together_ bytes.
void BlendStorage::fill() {
  std::vector<ListedTerm> terms;
  terms.reserve(cost_.stored_targets + cost_.stored_pairs);
  for (std::size_t i = 0; i < targets_.size(); ++i) {
    if (targets_[i].term.is_stored) terms.push_back({i, nullptr, work_of(targets_[i])});
    for (StoredPair& pair : targets_[i].pairs)
      if (pair.term.is_stored) terms.push_back({i, &pair, work_of(targets_[i], pair)});
  }
  for (std::size_t first = 0; first < terms.size();) {
    std::size_t end = first, work = 0;
    while (end < terms.size() && (end == first || work + terms[end].work <= work_together_)) work += terms[end++].work;
    parallel_for(end - first, [&](std::size_t k) {
      const ListedTerm& term = terms[first + k];
      if (term.pair == nullptr)
        fill_target(term.target);
      else
        fill_pair(term.target, *term.pair);
    });
    first = end;
  }
}

// Return the number of bytes that the computation of a target's terms, or of the term of a pair, takes. For a target
// the bytes of a term count twice, since its linear term stays in memory while the square term is computed.
std::size_t BlendStorage::work_of(const StoredTarget& target) const {
  return 2 * terms_.term_bytes(target.moved_faces, target.moved_corners);
}
std::size_t BlendStorage::work_of(const StoredTarget& target, const StoredPair& pair) const {
  const StoredTarget& other = targets_[pair.other];
  return terms_.term_bytes(std::min(target.moved_faces, other.moved_faces),
                           std::min(target.moved_corners, other.moved_corners));
}

void BlendStorage::fill_target(std::size_t i) {
  StoredTerm& stored = targets_[i].term;
  stored.elements.reserve(targets_[i].element_count);
  for (std::size_t k = 0; k < targets_[i].elements.places.size(); ++k) {
    for_bits(targets_[i].elements.masks[k], targets_[i].elements.places[k],
             [&](std::size_t e) { stored.elements.push_back(static_cast<std::uint32_t>(e)); });
  }
  const BlendTerm linear = terms_.linear(i), square = terms_.pair(i, i);
  stored.scale = scale_of(std::max(largest_of(linear), largest_of(square)));
  stored.lanes.resize(2 * kBlendLanes * stored.elements.size());
  put_all(linear, 0, 2 * kBlendLanes, stored);
  put_all(square, kBlendLanes, 2 * kBlendLanes, stored);
}

void BlendStorage::fill_pair(std::size_t i, StoredPair& pair) {
  const BlendTerm term = terms_.pair(i, pair.other);
  StoredTerm& stored = pair.term;
  stored.elements.assign(term.elements.begin(), term.elements.end());
  stored.scale = scale_of(largest_of(term));
  stored.lanes.resize(kBlendLanes * stored.elements.size());
  put_all(term, 0, kBlendLanes, stored);
}

std::size_t BlendStorage::list_bytes() const noexcept {
  std::size_t bytes = terms_.bytes() + rings_.bytes() + large_faces_.capacity() * sizeof(std::uint32_t) +
                      targets_.capacity() * sizeof(StoredTarget);
  for (const StoredTarget& target : targets_) bytes += bytes_of_lists(target);
  return bytes;
}

std::size_t BlendStorage::bytes() const noexcept {
  std::size_t bytes = list_bytes();
  for (const StoredTarget& target : targets_) {
    bytes += bytes_of(target.term);
    for (const StoredPair& pair : target.pairs) bytes += bytes_of(pair.term);
  }
  return bytes;
}

void BlendStorage::update_cost() {
  cost_ = {};
  const BlendShape shape = {terms_.size(), set_.topology.vertex_count(), set_.targets.size(), large_faces_.size()};
  std::size_t terms = 0, largest_work = 0, all_work = 0;
  const auto add_work = [&](std::size_t bytes) {
    largest_work = std::max(largest_work, bytes);
    all_work += bytes;
  };
  for (const StoredTarget& target : targets_) {
    cost_.target_elements += target.element_count;
    if (target.term.is_stored) {
      ++cost_.stored_targets;
      terms += kTargetBytes * target.element_count;
      add_work(work_of(target));
    }
    for (const StoredPair& pair : target.pairs) {
      ++cost_.overlapping_pairs;
      cost_.pair_elements += pair.elements;
      if (!pair.term.is_stored) continue;
      ++cost_.stored_pairs;
      terms += kPairBytes * pair.elements;
      add_work(work_of(target, pair));
    }
  }
  cost_.least_bytes = list_bytes() + base_bytes(shape) + pose_bytes(shape);
  cost_.bytes = cost_.least_bytes + terms;
  const std::size_t counting =
      terms_.counting_bytes(cost_.overlapping_pairs) + (cost_.overlapping_pairs + targets_.size()) * sizeof(Candidate);
  work_together_ = std::max(largest_work, std::min(all_work, terms / kShareOfWork));
  const std::size_t work = work_together_ + (cost_.stored_targets + cost_.stored_pairs) * sizeof(ListedTerm);
  cost_.peak_bytes = std::max(cost_.bytes + work, cost_.least_bytes + std::max(terms_.base_bytes(), counting));
}

}  // namespace chronormal::inline internal
