#include "workflow/bake/bake_plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "core/blocks.h"

namespace chronormal {
namespace {

constexpr std::size_t kChunk = 1024;
constexpr std::size_t kMostExtras = 10000;
// Poses to measure at: all of them on small meshes.
constexpr std::size_t kLeastSamples = 17, kMostSamples = 2000, kSampledCorners = 20000000;
// Terms that are held in memory at a time, to measure them.
constexpr std::size_t kHeldEntries = 2000000;
// Below this part of the terms that it is made of the direction of a normal is not judged.
constexpr double kLeastLength = 1e-4;

std::string place_of(const GltfDocument& document, std::size_t mesh) {
  return (document.name() + ", /meshes/").append(std::to_string(mesh));
}

// One pair while it is weighed.
struct Candidate {
  WeightProduct product;
  BlendTerm term;    // only where it is shown; given back when it was measured
  double aside = 0;  // the largest part of it across a normal, in lengths of that normal
  double size = 0;   // the largest of all of it
  double turn = 0;   // radians: what its lack turns
};

// The largest of some elements.
struct Worst {
  double aside = 0, size = 0, tangent = 0;
};

// The tangent of the angle between a unit vector and another one; infinity from a right angle on.
double tangent_between(const Vec3d& unit, const Vec3d& other) {
  const double along = dot(unit, other);
  return along > 0 ? length(cross(unit, other)) / along : std::numeric_limits<double>::infinity();
}

double angle_of_tangent(double tangent) { return std::isfinite(tangent) ? std::atan(tangent) : std::numbers::pi; }

class Planner {
 public:
  Planner(const GltfDocument& document, const GltfShading& shading, const NormalTerms& terms, const WeightUse& use,
          const BakeOptions& options, MeshPlan& plan)
      : document_(document), shading_(shading), terms_(terms), use_(use), options_(options), plan_(plan) {}

  Status run() {
    const std::size_t targets = shading_.set.targets.size();
    plan_.is_line.assign(targets, false);
    for (std::size_t i = 0; i < targets; ++i) plan_.ranges.push_back({use_.lowest(i), std::fmax(1, use_.highest(i))});
    plan_.is_shown.assign(shading_.groups.size(), false);
    for (const std::uint32_t e : shading_.element_of_vertex) {
      if (e != GltfShading::kNoElement) plan_.is_shown[e] = true;
    }
    plan_.largest.assign(shading_.groups.size(), 0.0);
    for (std::size_t i = 0; i < targets; ++i) {
      if (!moves(shading_, i)) continue;
      plan_.is_line[i] = plan_.encoding == BakeEncoding::kEndpoint || !together(i, i);
      const std::vector<std::uint32_t> elements = terms_.elements(i);
      note_lengths(elements, terms_.linear_by_element(i));
      if (plan_.is_line[i]) note_lengths(elements, terms_.pair_by_element(i, i));
    }
    if (plan_.encoding == BakeEncoding::kEndpoint) {
      if (plan_.is_driven) plan_.lines = FittedLines(shading_, terms_, use_, plan_.is_shown, plan_.largest);
      return Success{};
    }
    if (Status status = find_pairs(); !status) return status;
    if (!pairs_.empty()) find_longest_base();
    take_poses();
    std::size_t held = 0, first = 0;
    for (const auto& [i, j] : pairs_) {
      held += take_pair(i, j);
      if (held < kHeldEntries) continue;
      measure(first);
      first = candidates_.size();
      held = 0;
    }
    measure(first);
    choose();
    return Success{};
  }

 private:
  // Without animations a host may do what it likes.
  [[nodiscard]] bool together(std::size_t i, std::size_t j) const { return !plan_.is_driven || use_.together(i, j); }
  [[nodiscard]] double largest_weight(std::size_t i) const {
    return plan_.is_driven ? use_.largest(i) : std::fmax(1, use_.largest(i));
  }

  void note_length(std::uint32_t element, const Vec3d& value) {
    double& largest = plan_.largest[element];
    largest = std::fmax(largest, length(value));
  }
  void note_lengths(const std::vector<std::uint32_t>& elements, const NormalTerms::Term& term) {
    numbered_blocks(elements.size(), kChunk, [&](std::size_t, std::size_t first, std::size_t last) {
      for (std::size_t n = first; n < last; ++n) {
        Vec3d value;
        if (term.find(elements[n], value)) note_length(elements[n], value);
      }
    });
  }

  Status find_pairs() {
    for (std::size_t i = 0; i < use_.targets(); ++i) {
      if (!moves(shading_, i)) continue;
      for (std::size_t j = i; j < use_.targets(); ++j) {
        if (!moves(shading_, j) || !together(i, j) || (i != j && !terms_.overlap(i, j))) continue;
        if (i != j && terms_.is_fitted()) {
          return Error{ErrorCode::kUsage, place_of(document_, plan_.mesh),
                       "targets " + std::to_string(i) + " and " + std::to_string(j) +
                           " move the same normals at once, which only the weighting area can write exactly: "
                           "use --weighting area, or --encode endpoint"};
        }
        if (pairs_.size() == kMostExtras) {
          return invalid_input(place_of(document_, plan_.mesh),
                               "there are more than " + std::to_string(kMostExtras) +
                                   " pairs of targets that move the same normals at once: use --encode endpoint");
        }
        pairs_.emplace_back(i, j);
      }
    }
    return Success{};
  }

  void take_poses() {
    const std::size_t corners = std::max<std::size_t>(1, shading_.set.topology.corner_count());
    const std::size_t most = std::clamp(kSampledCorners / corners, kLeastSamples, kMostSamples);
    poses_ = use_.samples(most);
    sees_all_ = plan_.is_driven && use_.sample_count() <= most;
    for (std::size_t i = 0; !plan_.is_driven && i < use_.targets() && poses_.size() < most; ++i) {
      if (!moves(shading_, i)) continue;
      for (const double w : {0.25, 0.5, 0.75, 1.0}) {
        poses_.emplace_back(use_.targets(), 0.0);
        poses_.back()[i] = w;
      }
    }
  }

  // Keeps the term of a pair if it is not zero; returns its size.
  std::size_t take_pair(std::size_t i, std::size_t j) {
    Candidate candidate;
    candidate.product.i = i;
    candidate.product.j = j;
    candidate.term = terms_.pair(i, j);
    BlendTerm& term = candidate.term;
    std::size_t kept = 0;
    for (std::size_t n = 0; n < term.elements.size(); ++n) {
      if (!plan_.is_shown[term.elements[n]] || max_abs(term.values[n]) == 0) continue;
      term.elements[kept] = term.elements[n];
      term.values[kept++] = term.values[n];
    }
    if (kept == 0) return 0;
    term.elements.resize(kept);
    term.values.resize(kept);
    term.elements.shrink_to_fit();
    term.values.shrink_to_fit();
    for (std::size_t n = 0; n < kept; ++n) note_length(term.elements[n], term.values[n]);
    candidates_.push_back(std::move(candidate));
    return candidates_.back().term.elements.size();
  }

  // Whether the direction of a normal of this length is judged. Most are longer than any base asks for.
  [[nodiscard]] bool is_judged(std::uint32_t element, double size) const {
    if (size > kLeastLength * std::fmax(longest_base_, plan_.largest[element])) return true;
    return size > kLeastLength * std::fmax(length(terms_.base_of(element)), plan_.largest[element]);
  }

  void find_longest_base() {
    std::vector<double> longest(block_count(shading_.groups.size(), kChunk));
    numbered_blocks(shading_.groups.size(), kChunk, [&](std::size_t chunk, std::size_t first, std::size_t last) {
      for (std::size_t e = first; e < last; ++e)
        longest[chunk] = std::fmax(longest[chunk], length(terms_.base_of(static_cast<std::uint32_t>(e))));
    });
    for (const double of_chunk : longest) longest_base_ = std::fmax(longest_base_, of_chunk);
  }

  // The largest of what visit(n, unit, size, worst) finds for n of each element, scaled to length 1, and that length,
  // where its direction is judged.
  template <class Normal, class Visit>
  [[nodiscard]] Worst worst_of(const BlendTerm& term, const Normal& normal_of, const Visit& visit) const {
    std::vector<Worst> of_chunks(block_count(term.elements.size(), kChunk));
    numbered_blocks(term.elements.size(), kChunk, [&](std::size_t chunk, std::size_t first, std::size_t last) {
      for (std::size_t n = first; n < last; ++n) {
        const Vec3d normal = normal_of(term.elements[n]);
        const double size = length(normal);
        if (is_judged(term.elements[n], size)) visit(n, (1 / size) * normal, size, of_chunks[chunk]);
      }
    });
    Worst all;
    for (const Worst& each : of_chunks) {
      all.size = std::fmax(all.size, each.size);
      all.aside = std::fmax(all.aside, each.aside);
      all.tangent = std::fmax(all.tangent, each.tangent);
    }
    return all;
  }

  // Holds terms, from the first of them on, against the normals on the way.
  void measure(std::size_t first) {
    if (first == candidates_.size()) return;
    std::vector<double> tangents(candidates_.size(), 0.0);
    std::size_t entries = 0;
    for (std::size_t c = first; c < candidates_.size(); ++c) {
      entries += candidates_[c].term.elements.size();
    }
    // Where each element is asked for about once, its normal needs no place.
    const bool keep = terms_.is_fitted() || entries > 2 * shading_.groups.size();
    for (const std::vector<double>& pose : poses_) {
      const std::vector<Vec3d> normals = keep ? terms_.at(pose) : std::vector<Vec3d>();
      std::vector<double> positions(keep ? 0 : shading_.set.base.size());
      if (!keep) blend_positions(shading_.set, pose, positions);
      const auto normal_of = [&](std::uint32_t e) {
        return keep ? normals[e] : normal_from_positions(shading_, positions, e);
      };
      for (std::size_t c = first; c < candidates_.size(); ++c) {
        Candidate& candidate = candidates_[c];
        const double weight = pose[candidate.product.i] * pose[candidate.product.j];
        const auto look = [&](std::size_t n, const Vec3d& unit, double size, Worst& worst) {
          const Vec3d part = (1 / size) * candidate.term.values[n];
          worst.size = std::fmax(worst.size, length(part));
          worst.aside = std::fmax(worst.aside, length(cross(unit, part)));
          worst.tangent = std::fmax(worst.tangent, tangent_between(unit, unit - weight * part));
        };
        const Worst worst = worst_of(candidate.term, normal_of, look);
        candidate.size = std::fmax(candidate.size, worst.size);
        candidate.aside = std::fmax(candidate.aside, worst.aside);
        tangents[c] = std::fmax(tangents[c], worst.tangent);
      }
    }
    for (std::size_t c = first; c < candidates_.size(); ++c) {
      Candidate& candidate = candidates_[c];
      // Along the normal a small error turns nothing, but only as long as it is small.
      candidate.product.gain = 1.02 * candidate.aside + 1e-3 * candidate.size;
      candidate.turn = angle_of_tangent(tangents[c]);
      // Weights that no pose shows, such as one wink in a long animation, are bounded instead.
      if (!sees_all_)
        candidate.turn = candidate.size * largest_weight(candidate.product.i) * largest_weight(candidate.product.j);
      candidate.term = {};
    }
  }

  // Leaves out what turns least, until together that may turn a normal by the tolerance.
  void choose() {
    std::vector<std::size_t> order(candidates_.size());
    for (std::size_t n = 0; n < order.size(); ++n) order[n] = n;
    std::stable_sort(order.begin(), order.end(),
                     [this](std::size_t a, std::size_t b) { return candidates_[a].turn < candidates_[b].turn; });
    std::size_t count = 0;
    double turn = 0;
    while (count < order.size() && (turn + candidates_[order[count]].turn) * kDegreesPerRadian <= options_.tolerance)
      turn += candidates_[order[count++]].turn;
    order.resize(count);
    // Terms along a normal turn nothing one by one; together they may be longer than it is.
    while (!order.empty() && sees_all_) {
      turn = turn_without(order);
      if (turn * kDegreesPerRadian <= options_.tolerance) break;
      order.resize(order.size() / 2);
      turn = 0;
    }
    plan_.left_out = turn * kDegreesPerRadian;
    std::vector<bool> leave_out(candidates_.size(), false);
    for (const std::size_t n : order) leave_out[n] = true;
    for (std::size_t n = 0; n < candidates_.size(); ++n) {
      if (!leave_out[n]) plan_.extras.push_back(candidates_[n].product);
    }
  }

  // What the lack of some pairs turns, all together.
  [[nodiscard]] double turn_without(const std::vector<std::size_t>& pairs) const {
    double tangent = 0;
    std::vector<BlendTerm> terms;
    terms.reserve(pairs.size());
    for (const std::size_t n : pairs) {
      terms.push_back(terms_.pair(candidates_[n].product.i, candidates_[n].product.j));
    }
    for (const std::vector<double>& pose : poses_) {
      const std::vector<Vec3d> normals = terms_.at(pose);
      std::vector<Vec3d> without = normals;
      for (std::size_t t = 0; t < terms.size(); ++t) {
        const WeightProduct& product = candidates_[pairs[t]].product;
        const double weight = pose[product.i] * pose[product.j];
        for (std::size_t n = 0; weight != 0 && n < terms[t].elements.size(); ++n) {
          Vec3d& normal = without[terms[t].elements[n]];
          normal = normal - weight * terms[t].values[n];
        }
      }
      for (std::size_t t = 0; t < terms.size(); ++t) {
        const BlendTerm& term = terms[t];
        const auto look = [&](std::size_t n, const Vec3d& unit, double size, Worst& worst) {
          if (plan_.is_shown[term.elements[n]])
            worst.tangent = std::fmax(worst.tangent, tangent_between(unit, (1 / size) * without[term.elements[n]]));
        };
        const auto normal_of = [&](std::uint32_t e) { return normals[e]; };
        tangent = std::fmax(tangent, worst_of(term, normal_of, look).tangent);
      }
    }
    return angle_of_tangent(tangent);
  }

  const GltfDocument& document_;
  const GltfShading& shading_;
  const NormalTerms& terms_;
  const WeightUse& use_;
  const BakeOptions& options_;
  MeshPlan& plan_;
  std::vector<std::pair<std::size_t, std::size_t>> pairs_;
  std::vector<Candidate> candidates_;
  std::vector<std::vector<double>> poses_;  // to measure at
  double longest_base_ = 0;                 // of all elements
  bool sees_all_ = false;                   // these are all that the weights pass through
};

}  // namespace

Result<MeshPlan> plan_mesh(const GltfDocument& document, const GltfShading& shading, const NormalTerms& terms,
                           const WeightUse& use, bool is_driven, const BakeOptions& options) {
  MeshPlan plan;
  plan.mesh = shading.mesh;
  plan.is_driven = is_driven;
  plan.encoding = options.encoding.value_or(is_driven ? BakeEncoding::kExact : BakeEncoding::kEndpoint);
  if (const Status status = Planner(document, shading, terms, use, options, plan).run(); !status) return status.error();
  return plan;
}

}  // namespace chronormal
