// Measures how the correction target of each pair of targets turns normals. An entry of a term, which belongs to one
// element, turns the normal of this element by at most a bound. The bound is the length of the entry divided by the
// shortest normal of the element in any pose. A heap returns the entries from the largest bound down. The search ends
// when the bound is below the largest turn that was found. Angles are compared by their tangents, and only the largest
// tangent is converted to an angle.
#include "workflow/bake/deltas/pair_turns.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "core/blocks.h"
#include "core/portable_math.h"

namespace chronormal::inline internal {
namespace {

// kHeldNormals is the largest number of normals in memory at a time. If all elements have more normals than this in all
// poses together, only kSomeElements elements are in memory at a time.
constexpr std::size_t kHeldNormals = std::size_t{1} << 22, kSomeElements = std::size_t{1} << 12;
// The number of entries of terms that are in memory at a time.
constexpr std::size_t kHeldEntries = 1000000;
// The smallest length of a normal whose direction is judged, relative to the largest term of its element.
constexpr double kLeastLength = 1e-4;
// The factor by which bounds are multiplied. It is larger than any rounding error, so rounding cannot make a bound too
// small.
constexpr double kSlack = 1 + 1e-9;
constexpr std::size_t kPairBlock = 1024, kElements = 16;

// Returns the weight of the correction target for targets i and j. If i = j, this weight is 0 where target i has weight
// 1, and the correction target removes the part by which the square term is too large between the weights 0 and 1.
ExtraWeight extra_weight(std::size_t i, std::size_t j) { return i == j ? ExtraWeight{i, i, 1, -1} : ExtraWeight{i, j}; }

// Returns the factor by which the term of a correction target is multiplied in a pose.
double weight_of_term(const ExtraWeight& extra, const std::vector<double>& pose) {
  const double of_extra = extra.at(pose[extra.i], pose[extra.j]);
  return extra.i == extra.j ? -of_extra : of_extra;
}

// Returns the tangent of the angle between a unit vector and another vector. Returns infinity for a right angle and
// larger angles.
double tangent_between(const Vec3d& unit, const Vec3d& other) {
  const double along = dot(unit, other);
  return along > 0 ? length(cross(unit, other)) / along : std::numeric_limits<double>::infinity();
}

// Returns a bound of the tangent of the angle between a unit vector and another vector. `difference` is the distance
// between the ends of the two vectors.
double tangent_bound(double difference) {
  return difference < 1 ? difference / std::sqrt(1 - difference * difference) : std::numeric_limits<double>::infinity();
}

double angle_of_tangent(double tangent) { return std::isfinite(tangent) ? portable::atan(tangent) : std::numbers::pi; }

// Returns the term of the pair (i, j). Leaves out zeros, and elements that no vertex shows.
BlendTerm shown_term(const NormalTerms& terms, std::size_t i, std::size_t j, const std::vector<bool>& is_shown) {
  BlendTerm term = terms.pair(i, j);
  std::size_t kept = 0;
  for (std::size_t n = 0; n < term.elements.size(); ++n) {
    if (!is_shown[term.elements[n]] || max_abs(term.values[n]) == 0) continue;
    term.elements[kept] = term.elements[n];
    term.values[kept++] = term.values[n];
  }
  term.elements.resize(kept);
  term.values.resize(kept);
  term.elements.shrink_to_fit();
  term.values.shrink_to_fit();
  return term;
}

// The entries of a term that belong to a range of elements, as indices from `begin` up to `end`, without `end`.
struct Entries {
  std::size_t begin = 0, end = 0;
};

Entries entries_of(const BlendTerm& term, std::size_t first, std::size_t last) {
  const auto begin = std::lower_bound(term.elements.begin(), term.elements.end(), first);
  const auto end = std::lower_bound(begin, term.elements.end(), last);
  return {static_cast<std::size_t>(begin - term.elements.begin()),
          static_cast<std::size_t>(end - term.elements.begin())};
}

double longest_base_normal(const GltfShading& shading, const NormalTerms& terms) {
  const auto look = [&](std::size_t e, double& longest) {
    longest = std::fmax(longest, length(terms.base_of(static_cast<std::uint32_t>(e))));
  };
  return parallel_fold<double>(shading.groups.size(), kPairBlock, look,
                               [](double& all, double each) { all = std::fmax(all, each); });
}

}  // namespace

PosedNormals::PosedNormals(const GltfShading& shading, const NormalTerms& terms, const PoseList& poses)
    : shading_(shading),
      terms_(terms),
      poses_(poses),
      chunk_(shading.groups.size() <= kHeldNormals / (poses.size() + 1) ? shading.groups.size() + 1 : kSomeElements) {}

void PosedNormals::hold(std::size_t first) {
  if (!normals_.empty() && first_ == first) return;
  first_ = first;
  const std::size_t count = std::min(chunk_, shading_.groups.size() - first), poses = poses_.size();
  normals_.resize(count * poses);
  parallel_for(poses, [&](std::size_t p) {
    std::vector<Vec3d> all;
    std::vector<double> positions;
    if (terms_.is_fitted()) {
      all = terms_.at(poses_[p]);
    } else {
      positions.resize(shading_.set.base.size());
      blend_positions(shading_.set, poses_[p], positions);
    }
    for (std::size_t e = 0; e < count; ++e) {
      const Vec3d normal = all.empty() ? normal_from_positions(shading_, positions, first + e) : all[first + e];
      const double size = length(normal);
      normals_[e * poses + p] = {size > 0 ? (1 / size) * normal : Vec3d{}, size};
    }
  });
}

// A pair of targets that is being measured.
struct PairMeter::Candidate {
  ExtraWeight extra;
  BlendTerm term;      // without elements that no vertex shows; freed after the measurement
  double aside = 0;    // length of the largest part of the term across a normal, relative to the normal
  double size = 0;     // length of the largest value of the term, relative to the normal
  double tangent = 0;  // the tangent of the largest angle by which a normal turns without the term
  // For each pose, the factor by which the term is multiplied, and the index of the pose; the largest factors come
  // first.
  std::vector<std::pair<double, std::uint32_t>> poses;
};

PairMeter::PairMeter(const GltfShading& shading, const NormalTerms& terms, const PoseList& poses,
                     const std::vector<bool>& is_shown, std::vector<double>& largest)
    : shading_(shading),
      terms_(terms),
      is_shown_(is_shown),
      largest_(largest),
      longest_base_(longest_base_normal(shading, terms)),
      normals_(shading, terms, poses) {}

// Returns true if a normal of this length is long enough for its direction to be judged. The first test takes less
// time, and decides for most normals. Its limit is at least as high as that of the second test, so a normal that passes
// the first test would also pass the second test.
bool PairMeter::is_judged(std::uint32_t element, double size) const {
  if (size > kLeastLength * std::fmax(longest_base_, largest_[element])) return true;
  return size > kLeastLength * std::fmax(length(terms_.base_of(element)), largest_[element]);
}

void PairMeter::look(std::size_t first, std::span<const double> inverse, Candidate& candidate) const {
  struct Bounded {
    double most;
    std::size_t entry;
    bool operator<(const Bounded& other) const { return most < other.most; }
  };
  const BlendTerm& term = candidate.term;
  std::vector<Bounded> heap;
  const auto [begin, end] = entries_of(term, first, first + inverse.size());
  for (std::size_t n = begin; n < end; ++n) {
    const double most = kSlack * length(term.values[n]) * inverse[term.elements[n] - first];
    if (most > 0) heap.push_back({most, n});
  }
  std::make_heap(heap.begin(), heap.end());
  if (!heap.empty()) candidate.size = std::fmax(candidate.size, heap.front().most);
  const double strongest = candidate.poses.empty() ? 0 : std::fabs(candidate.poses.front().first);
  while (!heap.empty()) {
    const auto [most, n] = heap.front();
    const bool may_be_aside = most > candidate.aside, may_turn = tangent_bound(strongest * most) > candidate.tangent;
    if (!may_be_aside && !may_turn) break;
    std::pop_heap(heap.begin(), heap.end());
    heap.pop_back();
    const std::uint32_t e = term.elements[n];
    const std::span<const PosedNormals::Normal> normals = normals_.of(e);
    if (may_be_aside) {
      for (const auto& [unit, size] : normals)
        if (is_judged(e, size))
          candidate.aside = std::fmax(candidate.aside, (1 / size) * length(cross(unit, term.values[n])));
    }
    for (const auto& [weight, pose] : candidate.poses) {
      if (!(tangent_bound(std::fabs(weight) * most) > candidate.tangent)) break;
      const auto& [unit, size] = normals[pose];
      if (is_judged(e, size))
        candidate.tangent =
            std::fmax(candidate.tangent, tangent_between(unit, unit - (weight / size) * term.values[n]));
    }
  }
}

void PairMeter::measure(std::span<Candidate> candidates) {
  const std::size_t elements = shading_.groups.size();
  for (Candidate& candidate : candidates) {
    for (std::size_t p = 0; p < normals_.poses().size(); ++p) {
      const double weight = weight_of_term(candidate.extra, normals_.poses()[p]);
      if (weight != 0) candidate.poses.emplace_back(weight, static_cast<std::uint32_t>(p));
    }
    std::stable_sort(candidate.poses.begin(), candidate.poses.end(),
                     [](const auto& a, const auto& b) { return std::fabs(a.first) > std::fabs(b.first); });
  }
  for (std::size_t first = 0; first < elements && !candidates.empty(); first += normals_.chunk()) {
    normals_.hold(first);
    // Finds for each element the inverse length of its shortest normal that is judged.
    std::vector<double> inverse(std::min(normals_.chunk(), elements - first), 0.0);
    parallel_each(inverse.size(), kElements, [&](std::size_t n) {
      const auto e = static_cast<std::uint32_t>(first + n);
      for (const auto& [unit, size] : normals_.of(e))
        if (is_judged(e, size)) inverse[n] = std::fmax(inverse[n], 1 / size);
    });
    parallel_for(candidates.size(), [&](std::size_t c) { look(first, inverse, candidates[c]); });
  }
  for (Candidate& candidate : candidates) {
    candidate.term = {};
    candidate.poses = {};
  }
}

std::vector<MeasuredPair> PairMeter::measure(std::span<const Pair> pairs) {
  std::vector<Candidate> candidates;
  std::size_t held = 0, first = 0;
  const auto measure_held = [&] {
    measure(std::span(candidates).subspan(first));
    first = candidates.size();
    held = 0;
  };
  for (const auto& [i, j] : pairs) {
    BlendTerm term = shown_term(terms_, i, j, is_shown_);
    if (term.elements.empty()) continue;
    for (std::size_t n = 0; n < term.elements.size(); ++n) {
      double& largest = largest_[term.elements[n]];
      largest = std::fmax(largest, length(term.values[n]));
    }
    held += term.elements.size();
    candidates.push_back({extra_weight(i, j), std::move(term), 0, 0, 0, {}});
    if (held >= kHeldEntries) measure_held();
  }
  measure_held();
  std::vector<MeasuredPair> result;
  for (Candidate& candidate : candidates) {
    // The part of an error along the normal turns the normal only together with other errors, so this part counts
    // little.
    candidate.extra.gain = 1.02 * candidate.aside + 1e-3 * candidate.size;
    result.push_back({candidate.extra, candidate.size, angle_of_tangent(candidate.tangent)});
  }
  return result;
}

double PairMeter::turn_without(std::span<const ExtraWeight> extras) {
  const std::size_t elements = shading_.groups.size(), poses = normals_.poses().size();
  std::vector<BlendTerm> terms;
  std::vector<double> weights;  // (extras, poses), the weight of each correction target
  for (const ExtraWeight& extra : extras) {
    terms.push_back(shown_term(terms_, extra.i, extra.j, is_shown_));
    for (const std::vector<double>& pose : normals_.poses()) weights.push_back(weight_of_term(extra, pose));
  }
  double tangent = 0;
  for (std::size_t first = 0; first < elements; first += normals_.chunk()) {
    normals_.hold(first);
    const std::size_t count = std::min(normals_.chunk(), elements - first);
    std::vector<double> tangents(count, 0.0);
    parallel_blocks(count, kElements, [&](IndexRange range) {
      // The vectors by which the normals of the elements in the range change if the terms are left out, as an array
      // (elements, poses).
      std::vector<Vec3d> left(range.count * poses);
      std::vector<bool> is_touched(range.count, false);
      const std::size_t begin = first + range.first;
      for (std::size_t t = 0; t < terms.size(); ++t) {
        const Entries entries = entries_of(terms[t], begin, begin + range.count);
        for (std::size_t n = entries.begin; n < entries.end; ++n) {
          const std::size_t at = terms[t].elements[n] - begin;
          is_touched[at] = true;
          for (std::size_t p = 0; p < poses; ++p)
            left[at * poses + p] = left[at * poses + p] - weights[t * poses + p] * terms[t].values[n];
        }
      }
      for (std::size_t at = 0; at < range.count; ++at) {
        const auto e = static_cast<std::uint32_t>(begin + at);
        const std::span<const PosedNormals::Normal> normals = normals_.of(e);
        for (std::size_t p = 0; p < poses && is_touched[at]; ++p) {
          const auto& [unit, size] = normals[p];
          if (!is_judged(e, size)) continue;
          double& most = tangents[range.first + at];
          most = std::fmax(most, tangent_between(unit, unit + (1 / size) * left[at * poses + p]));
        }
      }
    });
    for (const double of_element : tangents) tangent = std::fmax(tangent, of_element);
  }
  return angle_of_tangent(tangent);
}

}  // namespace chronormal::inline internal
