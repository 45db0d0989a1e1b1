// A target's own terms are always written; what has to be chosen are the pairs. Each pair of targets that some pose has
// active at once is a candidate for an extra target. It is measured by how far its lack would turn a normal at poses of
// the file, and those that turn least are left out until, all together, they might turn one by the tolerance.
#include "workflow/bake/plan.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <span>
#include <utility>

#include "chronormal/analysis/quality.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 1024;
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

// The extra target of a pair. That of a target with itself only takes away what its end point has too much on the way,
// so that weight 1 is right without it.
ExtraWeight extra_weight(std::size_t i, std::size_t j) { return i == j ? ExtraWeight{i, i, 1, -1} : ExtraWeight{i, j}; }

// One pair while it is weighed.
struct Candidate {
  ExtraWeight extra;
  BlendTerm term;    // only where it is shown; given back when it was measured
  double aside = 0;  // the largest part of it across a normal, in lengths of that normal
  double size = 0;   // the largest of all of it
  double turn = 0;   // radians: how far leaving it out turns a normal

  // What multiplies the term in a pose.
  [[nodiscard]] double weight(const std::vector<double>& pose) const {
    const double of_extra = extra.at(pose[extra.i], pose[extra.j]);
    return extra.i == extra.j ? -of_extra : of_extra;
  }
};

// What the file says about a mesh.
struct MeshUse {
  const GltfShading& shading;
  const NormalTerms& terms;
  const WeightUse& use;
  bool is_driven;

  // Without animations a host may do what it likes.
  [[nodiscard]] bool together(std::size_t i, std::size_t j) const { return !is_driven || use.together(i, j); }
  [[nodiscard]] double largest_weight(const ExtraWeight& extra) const {
    const auto largest = [this](std::size_t i) { return is_driven ? use.largest(i) : std::fmax(1, use.largest(i)); };
    if (extra.i != extra.j) return largest(extra.i) * largest(extra.j);
    const auto hump = [](double w) { return std::fabs(w * (1 - w)); };
    return std::fmax(0.25, std::fmax(hump(use.lowest(extra.i)), hump(use.highest(extra.i))));
  }
};

// Whether float32 can hold the products of weights, and deltas of any size that these multiply.
bool products_fit(const MeshUse& mesh) {
  constexpr double kLargestProduct = 1e30;
  double largest = 0;
  for (std::size_t i = 0; i < mesh.use.targets(); ++i)
    if (moves(mesh.shading, i)) largest = std::fmax(largest, mesh.use.largest(i));
  return largest * largest <= kLargestProduct;
}

// Weights to measure at.
struct Poses {
  std::vector<std::vector<double>> weights;
  bool are_all = false;  // the file has no others
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

std::vector<bool> shown_elements(const GltfShading& shading) {
  std::vector<bool> is_shown(shading.groups.size(), false);
  for (const std::uint32_t e : shading.element_of_vertex) {
    if (e != GltfShading::kNoElement) is_shown[e] = true;
  }
  return is_shown;
}

std::vector<WeightRange> weight_ranges(const WeightUse& use) {
  std::vector<WeightRange> ranges;
  for (std::size_t i = 0; i < use.targets(); ++i) ranges.push_back({use.lowest(i), std::fmax(1, use.highest(i))});
  return ranges;
}

// The targets that get the best single delta: those that nothing drives, or all that move.
std::vector<bool> single_delta_targets(const MeshUse& mesh, BakeEncoding encoding) {
  std::vector<bool> result(mesh.use.targets(), false);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = moves(mesh.shading, i) && (encoding != BakeEncoding::kExact || !mesh.together(i, i));
  return result;
}

void note_length(const Vec3d& value, double& largest) { largest = std::fmax(largest, length(value)); }

// Of each element, the length of the largest term that targets have by themselves.
std::vector<double> largest_own_terms(const MeshUse& mesh, const std::vector<bool>& is_line) {
  std::vector<double> largest(mesh.shading.groups.size(), 0.0);
  const auto note_lengths = [&](const std::vector<std::uint32_t>& elements, const NormalTerms::Term& term) {
    parallel_each(elements.size(), kBlock, [&](std::size_t n) {
      Vec3d value;
      if (term.find(elements[n], value)) note_length(value, largest[elements[n]]);
    });
  };
  for (std::size_t i = 0; i < is_line.size(); ++i) {
    if (!moves(mesh.shading, i)) continue;
    const std::vector<std::uint32_t> elements = mesh.terms.elements(i);
    note_lengths(elements, mesh.terms.linear_by_element(i));
    if (is_line[i]) note_lengths(elements, mesh.terms.pair_by_element(i, i));
  }
  return largest;
}

using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

// The pairs of targets that move a normal at once.
Result<Pairs> find_pairs(const GltfDocument& document, const MeshUse& mesh) {
  Pairs pairs;
  for (std::size_t i = 0; i < mesh.use.targets(); ++i) {
    if (!moves(mesh.shading, i)) continue;
    for (std::size_t j = i; j < mesh.use.targets(); ++j) {
      if (!moves(mesh.shading, j) || !mesh.together(i, j) || (i != j && !mesh.terms.overlap(i, j))) continue;
      if (i != j && mesh.terms.is_fitted()) {
        return Error{ErrorCode::kUsage, place_of(document, mesh.shading.mesh),
                     "targets " + std::to_string(i) + " and " + std::to_string(j) +
                         " move the same normals at once, which only the weighting area can write exactly: "
                         "use --weighting area, or --encode endpoint"};
      }
      if (pairs.size() == kMostExtras) {
        return invalid_input(place_of(document, mesh.shading.mesh),
                             "there are more than " + std::to_string(kMostExtras) +
                                 " pairs of targets that move the same normals at once: use --encode endpoint");
      }
      pairs.emplace_back(i, j);
    }
  }
  return pairs;
}

Poses poses_to_measure_at(const MeshUse& mesh) {
  const std::size_t corners = std::max<std::size_t>(1, mesh.shading.set.topology.corner_count());
  const std::size_t most = std::clamp(kSampledCorners / corners, kLeastSamples, kMostSamples);
  Poses poses{mesh.use.samples(most), mesh.is_driven && mesh.use.sample_count() <= most};
  for (std::size_t i = 0; !mesh.is_driven && i < mesh.use.targets() && poses.weights.size() < most; ++i) {
    if (!moves(mesh.shading, i)) continue;
    for (const double w : {0.25, 0.5, 0.75, 1.0}) {
      poses.weights.emplace_back(mesh.use.targets(), 0.0);
      poses.weights.back()[i] = w;
    }
  }
  return poses;
}

// The term of a pair where it is shown and not zero.
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

double longest_base_normal(const MeshUse& mesh) {
  const auto look = [&](std::size_t e, double& longest) {
    longest = std::fmax(longest, length(mesh.terms.base_of(static_cast<std::uint32_t>(e))));
  };
  return parallel_fold<double>(mesh.shading.groups.size(), kBlock, look,
                               [](double& all, double each) { all = std::fmax(all, each); });
}

// Tells which normals are long enough for their direction to mean something.
class Yardstick {
 public:
  // largest is that of the plan and may still grow.
  Yardstick(const MeshUse& mesh, const std::vector<double>& largest)
      : terms_(mesh.terms), largest_(largest), longest_base_(longest_base_normal(mesh)) {}

  // Most are longer than any base asks for.
  [[nodiscard]] bool is_judged(std::uint32_t element, double size) const {
    if (size > kLeastLength * std::fmax(longest_base_, largest_[element])) return true;
    return size > kLeastLength * std::fmax(length(terms_.base_of(element)), largest_[element]);
  }

 private:
  const NormalTerms& terms_;
  const std::vector<double>& largest_;
  double longest_base_;
};

// The largest of what visit(n, unit, size, worst) finds for n of each element, scaled to length 1, and that length,
// where its direction is judged.
template <class Normal, class Visit>
Worst worst_of(const BlendTerm& term, const Yardstick& yardstick, const Normal& normal_of, const Visit& visit) {
  const auto look = [&](std::size_t n, Worst& worst) {
    const Vec3d normal = normal_of(term.elements[n]);
    const double size = length(normal);
    if (yardstick.is_judged(term.elements[n], size)) visit(n, (1 / size) * normal, size, worst);
  };
  return parallel_fold<Worst>(term.elements.size(), kBlock, look, [](Worst& all, const Worst& each) {
    all.size = std::fmax(all.size, each.size);
    all.aside = std::fmax(all.aside, each.aside);
    all.tangent = std::fmax(all.tangent, each.tangent);
  });
}

// Holds terms against the normals on the way, and gives their memory back.
void measure(const MeshUse& mesh, const Poses& poses, const Yardstick& yardstick, std::span<Candidate> candidates) {
  if (candidates.empty()) return;
  std::vector<double> tangents(candidates.size(), 0.0);
  std::size_t entries = 0;
  for (const Candidate& candidate : candidates) entries += candidate.term.elements.size();
  // Where each element is asked for about once, its normal needs no place.
  const bool keep = mesh.terms.is_fitted() || entries > 2 * mesh.shading.groups.size();
  for (const std::vector<double>& pose : poses.weights) {
    const std::vector<Vec3d> normals = keep ? mesh.terms.at(pose) : std::vector<Vec3d>();
    std::vector<double> positions(keep ? 0 : mesh.shading.set.base.size());
    if (!keep) blend_positions(mesh.shading.set, pose, positions);
    const auto normal_of = [&](std::uint32_t e) {
      return keep ? normals[e] : normal_from_positions(mesh.shading, positions, e);
    };
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      Candidate& candidate = candidates[c];
      const double weight = candidate.weight(pose);
      const auto look = [&](std::size_t n, const Vec3d& unit, double size, Worst& worst) {
        const Vec3d part = (1 / size) * candidate.term.values[n];
        worst.size = std::fmax(worst.size, length(part));
        worst.aside = std::fmax(worst.aside, length(cross(unit, part)));
        worst.tangent = std::fmax(worst.tangent, tangent_between(unit, unit - weight * part));
      };
      const Worst worst = worst_of(candidate.term, yardstick, normal_of, look);
      candidate.size = std::fmax(candidate.size, worst.size);
      candidate.aside = std::fmax(candidate.aside, worst.aside);
      tangents[c] = std::fmax(tangents[c], worst.tangent);
    }
  }
  for (std::size_t c = 0; c < candidates.size(); ++c) {
    Candidate& candidate = candidates[c];
    // Along the normal a small error turns nothing, but only as long as it is small.
    candidate.extra.gain = 1.02 * candidate.aside + 1e-3 * candidate.size;
    candidate.turn = angle_of_tangent(tangents[c]);
    // Weights that no pose shows, such as one wink in a long animation, are bounded instead.
    if (!poses.are_all) candidate.turn = candidate.size * mesh.largest_weight(candidate.extra);
    candidate.term = {};
  }
}

// Takes the terms of all pairs and measures them, as many at a time as may be held. largest learns of their lengths.
std::vector<Candidate> measured_candidates(const MeshUse& mesh, const Pairs& pairs, const Poses& poses,
                                           const Yardstick& yardstick, const std::vector<bool>& is_shown,
                                           std::vector<double>& largest) {
  std::vector<Candidate> candidates;
  std::size_t held = 0, first = 0;
  const auto measure_held = [&] {
    measure(mesh, poses, yardstick, std::span(candidates).subspan(first));
    first = candidates.size();
    held = 0;
  };
  for (const auto& [i, j] : pairs) {
    BlendTerm term = shown_term(mesh.terms, i, j, is_shown);
    if (term.elements.empty()) continue;
    for (std::size_t n = 0; n < term.elements.size(); ++n) note_length(term.values[n], largest[term.elements[n]]);
    held += term.elements.size();
    Candidate& candidate = candidates.emplace_back();
    candidate.extra = extra_weight(i, j);
    candidate.term = std::move(term);
    if (held >= kHeldEntries) measure_held();
  }
  measure_held();
  return candidates;
}

// How far leaving out these pairs, all together, turns a normal, in radians.
double turn_without(const MeshUse& mesh, const std::vector<Candidate>& candidates,
                    const std::vector<std::size_t>& pairs, const Poses& poses, const Yardstick& yardstick,
                    const std::vector<bool>& is_shown) {
  double tangent = 0;
  std::vector<BlendTerm> terms;
  terms.reserve(pairs.size());
  for (const std::size_t n : pairs) terms.push_back(mesh.terms.pair(candidates[n].extra.i, candidates[n].extra.j));
  for (const std::vector<double>& pose : poses.weights) {
    const std::vector<Vec3d> normals = mesh.terms.at(pose);
    std::vector<Vec3d> without = normals;
    for (std::size_t t = 0; t < terms.size(); ++t) {
      const double weight = candidates[pairs[t]].weight(pose);
      for (std::size_t n = 0; weight != 0 && n < terms[t].elements.size(); ++n) {
        Vec3d& normal = without[terms[t].elements[n]];
        normal = normal - weight * terms[t].values[n];
      }
    }
    for (const BlendTerm& term : terms) {
      const auto look = [&](std::size_t n, const Vec3d& unit, double size, Worst& worst) {
        if (is_shown[term.elements[n]])
          worst.tangent = std::fmax(worst.tangent, tangent_between(unit, (1 / size) * without[term.elements[n]]));
      };
      const auto normal_of = [&](std::uint32_t e) { return normals[e]; };
      tangent = std::fmax(tangent, worst_of(term, yardstick, normal_of, look).tangent);
    }
  }
  return angle_of_tangent(tangent);
}

// Leaves out what turns least, until together that may turn a normal by the tolerance; the rest gets extra targets.
void choose_extras(const MeshUse& mesh, const std::vector<Candidate>& candidates, const Poses& poses,
                   const Yardstick& yardstick, double tolerance, MeshPlan& plan) {
  std::vector<std::size_t> order(candidates.size());
  for (std::size_t n = 0; n < order.size(); ++n) order[n] = n;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return candidates[a].turn < candidates[b].turn; });
  std::size_t count = 0;
  double turn = 0;
  while (count < order.size() && (turn + candidates[order[count]].turn) * kDegreesPerRadian <= tolerance)
    turn += candidates[order[count++]].turn;
  order.resize(count);
  // Terms along a normal turn nothing one by one; together they may be longer than it is.
  while (!order.empty() && poses.are_all) {
    turn = turn_without(mesh, candidates, order, poses, yardstick, plan.is_shown);
    if (turn * kDegreesPerRadian <= tolerance) break;
    order.resize(order.size() / 2);
    turn = 0;
  }
  plan.left_out = turn * kDegreesPerRadian;
  std::vector<bool> leave_out(candidates.size(), false);
  for (const std::size_t n : order) leave_out[n] = true;
  for (std::size_t n = 0; n < candidates.size(); ++n) {
    if (!leave_out[n]) plan.extras.push_back(candidates[n].extra);
  }
}

}  // namespace

Result<MeshPlan> plan_mesh(const GltfDocument& document, const GltfShading& shading, const NormalTerms& terms,
                           const WeightUse& use, bool is_driven, const BakeOptions& options) {
  const MeshUse mesh{shading, terms, use, is_driven};
  MeshPlan plan;
  plan.is_driven = is_driven;
  plan.products_fit = products_fit(mesh);
  plan.encoding = options.encoding.value_or(BakeEncoding::kHarmless);
  plan.ranges = weight_ranges(use);
  plan.is_shown = shown_elements(shading);
  plan.is_line = single_delta_targets(mesh, plan.encoding);
  plan.largest = largest_own_terms(mesh, plan.is_line);
  if (plan.encoding != BakeEncoding::kExact) {
    if (is_driven && plan.encoding == BakeEncoding::kEndpoint)
      plan.lines = FittedLines(shading, terms, use, plan.is_shown, plan.largest);
    return plan;
  }
  const Result<Pairs> pairs = find_pairs(document, mesh);
  if (!pairs) return pairs.error();
  if (pairs.value().empty()) return plan;
  const Poses poses = poses_to_measure_at(mesh);
  const Yardstick yardstick(mesh, plan.largest);
  const std::vector<Candidate> candidates =
      measured_candidates(mesh, pairs.value(), poses, yardstick, plan.is_shown, plan.largest);
  choose_extras(mesh, candidates, poses, yardstick, options.tolerance.value_or(kExactBakeTolerance), plan);
  return plan;
}

}  // namespace chronormal::inline internal
