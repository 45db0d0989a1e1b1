// Plans a bake. The terms of each single target are always written, and only pairs of targets are chosen. Each pair
// that is active at the same time in some pose may get a correction target. The worth of a pair is the angle by which
// normals turn without its correction target, in poses of the file. The pairs with the smallest worth are left out, as
// many as together turn a normal by at most the tolerance.
#include "workflow/bake/deltas/plan.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/blocks.h"
#include "workflow/bake/deltas/pair_turns.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kPlanBlock = 1024;
constexpr std::size_t kMostExtras = 10000;
// Limits for the number of poses in which pairs of targets are measured. There are so many poses that about
// kSampledCorners corners are measured in all poses together, but at least kLeastSamples and at most kMostSamples
// poses.
constexpr std::size_t kLeastSamples = 17, kMostSamples = 2000, kSampledCorners = 20000000;

std::string place_of(const GltfDocument& document, std::size_t mesh) {
  return (document.name() + ", /meshes/").append(std::to_string(mesh));
}

// The data of the file that tell which targets of a mesh are active at the same time.
struct MeshUse {
  const GltfShading& shading;
  const NormalTerms& terms;
  const WeightUse& use;
  bool is_driven;

  // Returns true if targets i and j may be active together. If there are no animations, a program may set any weights,
  // so the result is true for all targets.
  [[nodiscard]] bool together(std::size_t i, std::size_t j) const { return !is_driven || use.together(i, j); }
  [[nodiscard]] double largest_weight(const ExtraWeight& extra) const {
    const auto largest = [this](std::size_t i) { return is_driven ? use.largest(i) : std::fmax(1, use.largest(i)); };
    if (extra.i != extra.j) return largest(extra.i) * largest(extra.j);
    const auto hump = [](double w) { return std::fabs(w * (1 - w)); };
    return std::fmax(0.25, std::fmax(hump(use.lowest(extra.i)), hump(use.highest(extra.i))));
  }
};

// Returns true if float32 can hold the products of two weights of the mesh, even if a delta multiplies them.
bool products_fit(const MeshUse& mesh) {
  constexpr double kLargestProduct = 1e30;
  double largest = 0;
  for (std::size_t i = 0; i < mesh.use.targets(); ++i)
    if (moves(mesh.shading, i)) largest = std::fmax(largest, mesh.use.largest(i));
  return largest * largest <= kLargestProduct;
}

// The poses of the file in which pairs of targets are measured.
struct Poses {
  std::vector<std::vector<double>> weights;
  bool are_all = false;  // true if these are all poses of the file
};

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

// Tells for each target if it gets the best single delta, instead of a linear and a square term. For the encoding
// exact, a target gets this delta if it moves vertices but no animation drives it. For other encodings, every target
// that moves vertices gets this delta.
std::vector<bool> single_delta_targets(const MeshUse& mesh, BakeEncoding encoding) {
  std::vector<bool> result(mesh.use.targets(), false);
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = moves(mesh.shading, i) && (encoding != BakeEncoding::kExact || !mesh.together(i, i));
  return result;
}

void note_length(const Vec3d& value, double& largest) { largest = std::fmax(largest, length(value)); }

// Returns for each element the length of its largest linear or square term. Does not include the terms of pairs of
// different targets.
std::vector<double> largest_own_terms(const MeshUse& mesh, const std::vector<bool>& is_line) {
  std::vector<double> largest(mesh.shading.groups.size(), 0.0);
  const auto note_lengths = [&](const std::vector<std::uint32_t>& elements, const NormalTerms::Term& term) {
    parallel_each(elements.size(), kPlanBlock, [&](std::size_t n) {
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

using Pairs = std::vector<PairMeter::Pair>;

// Lists the pairs of targets that can move the same normal at the same time, in some pose.
Result<Pairs> find_pairs(const GltfDocument& document, const MeshUse& mesh) {
  Pairs pairs;
  for (std::size_t i = 0; i < mesh.use.targets(); ++i) {
    if (!moves(mesh.shading, i)) continue;
    for (std::size_t j = i; j < mesh.use.targets(); ++j) {
      if (!moves(mesh.shading, j) || !mesh.together(i, j) || (i != j && !mesh.terms.overlap(i, j))) continue;
      if (pairs.size() == kMostExtras) {
        return invalid_input(
            place_of(document, mesh.shading.mesh),
            "the result would need more than " + std::to_string(kMostExtras) +
                " correction targets, one for each two targets that move the same normals; use --encode endpoint");
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

// Leaves out the pairs that turn normals least, as many as together turn a normal by at most the tolerance. All other
// pairs get correction targets.
void choose_extras(const MeshUse& mesh, std::vector<MeasuredPair> candidates, const Poses& poses, PairMeter& meter,
                   double tolerance, MeshPlan& plan) {
  // If the file has more poses than were measured, a short movement in a long animation, such as a wink, may have been
  // missed. For this reason the turn of a pair is then replaced by a bound: the size of its term times its largest
  // weight in the file.
  for (MeasuredPair& candidate : candidates)
    if (!poses.are_all) candidate.turn = candidate.size * mesh.largest_weight(candidate.extra);
  std::vector<std::size_t> order(candidates.size());
  for (std::size_t n = 0; n < order.size(); ++n) order[n] = n;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return candidates[a].turn < candidates[b].turn; });
  std::size_t count = 0;
  double turn = 0;
  while (count < order.size() && (turn + candidates[order[count]].turn) * kDegreesPerRadian <= tolerance)
    turn += candidates[order[count++]].turn;
  order.resize(count);
  // Leaves out fewer pairs if their terms together turn a normal too far. A single term along a normal does not turn
  // this normal, but the sum of several such terms may be longer than the normal and turn it. The number of pairs that
  // are left out is halved until they turn no normal by more than the tolerance.
  while (!order.empty() && poses.are_all) {
    std::vector<ExtraWeight> left_out;
    left_out.reserve(order.size());
    for (const std::size_t n : order) left_out.push_back(candidates[n].extra);
    turn = meter.turn_without(left_out);
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
  plan.encoding = encoding_of(options);
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
  PairMeter meter(shading, terms, poses.weights, plan.is_shown, plan.largest);
  choose_extras(mesh, meter.measure(pairs.value()), poses, meter, options.tolerance.value_or(kExactBakeTolerance),
                plan);
  return plan;
}

}  // namespace chronormal::inline internal
