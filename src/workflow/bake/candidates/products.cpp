// Makes a candidate with correction targets that products of weights drive (docs/theory.md, section 16).
//
// Each target of the mesh gets the delta to the true normal at its weight 1. Correction targets correct the errors
// between weight 0 and 1, and the errors of poses with several targets. Correction targets move no vertex, and their
// weights follow from the weights of the mesh's own targets:
//
//     turn      w_i            for a turn at weight 1 that is so large that a delta of unit length would not fit;
//                              two targets
//     self      4 w_i (1-w_i)  makes normals right at w_i = 1/2 as well
//     pair      s w_i w_j      makes normals right where both weights are strongest in the file; one target or two
//
// If lengths are not free, every correction leads from N to another unit normal. Its weight is from 0 to 1 if the
// weights of the file are in this range. Viewers that keep only the direction of N plus the delta, or 8 bits of it,
// then render the same normals.
//
// Corrections are made one after the other. Each correction is computed so that its sum with all earlier ones has the
// right direction in one pose. The result depends on their order for this reason. Not all corrections are kept. The
// worth of a correction target is the angle by which normals would turn without it, measured in poses of the file, and
// the targets with the smallest worth are removed.
#include "workflow/bake/candidates/makers.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "core/blocks.h"
#include "workflow/bake/candidates/cut_tracks.h"
#include "workflow/bake/deltas/unit_targets.h"
#include "workflow/bake/poses/tracks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kProductsBlock = 64;
// The lengths that are tried for a sum of unit normals: from kLongestSum down, each length is kNextSum times the length
// before.
constexpr double kLongestSum = 2.5, kNextSum = 0.9;
constexpr int kTriedSums = 31;  // the shortest sum has a length of a tenth
// Limits for the correction targets of a pair of targets. kPartOfPairs is the error that a single correction target may
// leave half-way to the pose of the pair, relative to the tolerance. kAsGood is the factor by which the squared error
// of one correction target may exceed the squared error of two.
constexpr double kPartOfPairs = 0.25, kAsGood = 1.1;
// The length of the shortest correction that is kept, relative to the stored normal N. Shorter corrections turn no
// normal by an angle that matters.
constexpr double kLeastCorrection = 1e-5;
// The error in radians below which a normal needs no correction.
constexpr double kRight = 1e-5;
// Limits for the length of the normal at weight 1, relative to n(0), if deltas may have any length.
constexpr double kShortestEnd = 1.0 / 1024, kLongestEnd = 1024;
// The product of both weights of a pair drives its correction target. If deltas must have unit lengths
// (Lengths::kUnit), the product is multiplied by a scale, so that its largest value in the file becomes kStrongest. The
// scale is at most kMostScale.
constexpr double kMostScale = 4, kStrongest = 0.95;
// The weight, or product of two weights, below which a pair of targets counts as not active.
constexpr double kLeastProduct = 1e-6;
// kMostActive is the largest number of targets whose pairs are all examined. kMostHarmlessPairs is the largest number
// of pairs that are kept. kMostHarmlessPoses limits the number of poses in which the worth of pairs is measured.
constexpr std::size_t kMostSampled = 400;
constexpr unsigned kRigSeed = 4;
constexpr std::size_t kMostActive = 512, kMostHarmlessPairs = 6000, kMostHarmlessPoses = 96, kMeasured = 6000000;

struct ProductLimits {
  Lengths lengths = Lengths::kUnit;
  std::size_t most_extras = 0;
  double tolerance = 0;  // degrees: the largest error that should be left
};

struct Products {
  std::vector<VertexVectors> own;    // deltas of each target of the mesh
  std::vector<ExtraWeight> weights;  // weights of the correction targets, without gains
  std::vector<VertexVectors> extras;
  std::size_t left_out = 0;
};

// A list for each element, with the vertices that show this element.
class VerticesOfElements {
 public:
  explicit VerticesOfElements(const GltfShading& shading) : first_(shading.groups.size() + 1) {
    const auto& elements = shading.element_of_vertex;
    for (const std::uint32_t e : elements)
      if (e != GltfShading::kNoElement) ++first_[e + 1];
    for (std::size_t e = 0; e + 1 < first_.size(); ++e) first_[e + 1] += first_[e];
    vertices_.resize(first_.back());
    std::vector<std::size_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t v = 0; v < elements.size(); ++v)
      if (elements[v] != GltfShading::kNoElement) vertices_[next[elements[v]]++] = v;
  }
  [[nodiscard]] std::span<const std::uint32_t> of(std::uint32_t element) const {
    return std::span(vertices_).subspan(first_[element], first_[element + 1] - first_[element]);
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::uint32_t> vertices_;
};

struct Asked {
  std::uint32_t vertex;
  Vec3d of_element;
};

// Returns the vertices of some elements, in ascending order, with the normals of their elements in `pose`.
std::vector<Asked> asked_vertices(const VerticesOfElements& shown, const RightNormals& rights,
                                  const std::vector<double>& pose, std::span<const std::uint32_t> elements) {
  const std::vector<Vec3d> normals = rights.of_elements(pose, elements);
  std::vector<Asked> result;
  for (std::size_t n = 0; n < elements.size(); ++n) {
    for (const std::uint32_t v : shown.of(elements[n])) result.push_back({v, normals[n]});
  }
  std::sort(result.begin(), result.end(), [](const Asked& a, const Asked& b) { return a.vertex < b.vertex; });
  return result;
}

// Collects the vectors that vector_of() returns for the vertices in `asked`, except zeros.
template <class VectorOf>
VertexVectors gather(std::span<const Asked> asked, const VectorOf& vector_of) {
  std::vector<Vec3f> all(asked.size());
  parallel_each(asked.size(), kProductsBlock, [&](std::size_t n) { all[n] = to_float(vector_of(asked[n])); });
  VertexVectors result;
  for (std::size_t n = 0; n < asked.size(); ++n) {
    if (all[n] == Vec3f{}) continue;
    result.vertices.push_back(asked[n].vertex);
    result.vectors.push_back(all[n]);
  }
  return result;
}

bool is_active(const std::vector<double>& pose, std::size_t i) { return std::fabs(pose[i]) > kLeastProduct; }

// Makes correction targets one after the other, and adds them to the Products.
class Corrector {
 public:
  Corrector(const GltfShading& shading, const NormalTerms& terms, const RightNormals& rights,
            std::vector<bool> needs_element, Lengths lengths, Products& form)
      : terms_(terms),
        rights_(rights),
        shown_(shading),
        needs_element_(std::move(needs_element)),
        lengths_(lengths),
        form_(form),
        of_target_(form.own.size()) {}

  // Adds a correction target with this weight. Its deltas give each normal the right direction in `pose`.
  void add(const ExtraWeight& weight, const std::vector<double>& pose) {
    const double t = weight.at(pose[weight.i], pose[weight.j]);
    const std::vector<std::uint32_t> elements = elements_of(weight);
    if (elements.empty() || t == 0) return;
    const std::vector<Asked> asked = asked_vertices(shown_, rights_, pose, elements);
    append(weight, gather(asked, [&](const Asked& of) { return correction(of, weight, pose, t); }));
  }

  // Adds two correction targets that complete a large turn of a target at weight 1. Both correction targets have the
  // weight of this target. The sum of all deltas then has length 1, so between weight 0 and 1 normals turn as evenly as
  // with deltas of any length.
  void add_turn(std::size_t i, const std::vector<double>& pose) {
    const ExtraWeight weight{i, i, 1, 0};
    const std::vector<std::uint32_t> elements = elements_of(weight);
    if (elements.empty()) return;
    const std::vector<Asked> asked = asked_vertices(shown_, rights_, pose, elements);
    std::vector<std::array<Vec3d, 2>> vectors(asked.size());
    parallel_each(asked.size(), kProductsBlock, [&](std::size_t n) {
      const Vec3d right = unit(rights_.of_vertex(asked[n].vertex, asked[n].of_element));
      const BaseNormal base(rights_.stored(asked[n].vertex));
      const Vec3d shown = (1 / base.length) * (base.stored + sum_of(i, asked[n].vertex, pose));
      if (right == Vec3d{} || (max_abs(shown) > 0 && angle_between(shown, right) < kRight)) return;
      if (const auto both = two_units(base.direction, right - shown)) {
        for (std::size_t part = 0; part < 2; ++part) vectors[n][part] = base.length * ((*both)[part] - base.direction);
      } else if (const auto u = turning_unit(base.direction, shown, right, 1)) {
        vectors[n][0] = base.length * (*u - base.direction);
      }
    });
    append_parts(weight, asked, vectors);
  }

  // Adds a correction for a pair of targets. The correction makes normals right in `pose`, and as good as possible
  // half-way to this pose. The correction consists of two correction targets with the same weight. Only a single
  // correction target is used if its error is nearly as small as the error of two, or is a small part of `tolerance`
  // (radians).
  void add_pair(const ExtraWeight& weight, const std::vector<double>& pose, double tolerance) {
    const double t = weight.at(pose[weight.i], pose[weight.j]);
    const std::vector<std::uint32_t> elements = elements_of(weight);
    if (elements.empty() || t == 0) return;
    std::vector<double> half = pose;
    for (double& w : half) w /= 2;
    const std::vector<Asked> asked = asked_vertices(shown_, rights_, pose, elements);
    const std::vector<Asked> on_the_way = asked_vertices(shown_, rights_, half, elements);
    std::vector<PairCorrection> vectors(asked.size());
    parallel_each(asked.size(), kProductsBlock, [&](std::size_t n) {
      vectors[n] = pair_correction(asked[n], on_the_way[n].of_element, weight, pose, half);
    });
    double of_one = 0, of_two = 0, enough = 0;
    for (const PairCorrection& of : vectors) {
      of_one += of.error_of_one * of.error_of_one;
      of_two += of.error_of_two * of.error_of_two;
      enough += kPartOfPairs * tolerance * kPartOfPairs * tolerance;
    }
    std::vector<std::array<Vec3d, 2>> parts(vectors.size());
    const bool is_one = of_one <= std::fmax(kAsGood * of_two, enough);
    for (std::size_t n = 0; n < vectors.size(); ++n)
      parts[n] = is_one ? std::array<Vec3d, 2>{vectors[n].one, Vec3d{}} : vectors[n].two;
    append_parts(weight, asked, parts);
  }

 private:
  // Returns the elements that need a correction and that both targets of a product of weights move.
  [[nodiscard]] std::vector<std::uint32_t> elements_of(const ExtraWeight& weight) const {
    std::vector<std::uint32_t> elements = terms_.elements(weight.i);
    if (weight.i != weight.j) {
      const std::vector<std::uint32_t> others = terms_.elements(weight.j);
      std::vector<std::uint32_t> common;
      std::set_intersection(elements.begin(), elements.end(), others.begin(), others.end(), std::back_inserter(common));
      elements = std::move(common);
    }
    elements.erase(
        std::remove_if(elements.begin(), elements.end(), [&](std::uint32_t e) { return !needs_element_[e]; }),
        elements.end());
    return elements;
  }

  void append(const ExtraWeight& weight, VertexVectors vectors) {
    if (vectors.vertices.empty()) return;
    if (weight.i == weight.j) of_target_[weight.i].push_back(form_.extras.size());
    form_.weights.push_back(weight);
    form_.extras.push_back(std::move(vectors));
  }

  // Appends two correction targets: the first has the first vector of each vertex, and the second has the second
  // vector. Leaves out a correction target that has only zeros.
  void append_parts(const ExtraWeight& weight, std::span<const Asked> asked,
                    const std::vector<std::array<Vec3d, 2>>& vectors) {
    for (const std::size_t part : {std::size_t{0}, std::size_t{1}}) {
      append(weight, gather(asked, [&](const Asked& of) {
               return vectors[static_cast<std::size_t>(&of - asked.data())][part];
             }));
    }
  }

  struct PairCorrection {
    Vec3d one;
    std::array<Vec3d, 2> two;
    double error_of_one = 0, error_of_two = 0;  // radians: errors half-way to the pose
  };

  [[nodiscard]] PairCorrection pair_correction(const Asked& asked, const Vec3d& half_of_element,
                                               const ExtraWeight& weight, const std::vector<double>& pose,
                                               const std::vector<double>& half) const {
    PairCorrection result;
    const Vec3d right = unit(rights_.of_vertex(asked.vertex, asked.of_element));
    const Vec3d right_half = unit(rights_.of_vertex(asked.vertex, half_of_element));
    if (right == Vec3d{}) return result;
    const double t = weight.at(pose[weight.i], pose[weight.j]), t_half = weight.at(half[weight.i], half[weight.j]);
    const BaseNormal base(rights_.stored(asked.vertex));
    const auto shown_at = [&](const std::vector<double>& at) {
      const Vec3d sum = base.stored + sum_of(weight.i, asked.vertex, at) + sum_of(weight.j, asked.vertex, at);
      return (1 / base.length) * sum;
    };
    const Vec3d shown = shown_at(pose), shown_half = shown_at(half);
    const auto error_with = [&](const Vec3d& vector) {
      const Vec3d now = shown_half + t_half * vector;
      if (right_half == Vec3d{}) return 0.0;
      return max_abs(now) > 0 ? angle_between(now, right_half) : std::numbers::pi;
    };
    // A normal that needs no correction in the pose keeps its direction in this pose.
    const bool is_right = max_abs(shown) > 0 && angle_between(shown, right) < kRight;
    result.error_of_one = result.error_of_two = error_with({});
    if (is_right && result.error_of_two < kRight) return result;
    if (!is_right) {
      result.error_of_two = std::numbers::pi;
      const auto u = turning_unit(base.direction, shown, right, t);
      if (u) result.one = base.length * (*u - base.direction);
      result.error_of_one = error_with((1 / base.length) * result.one);
    }
    // Tries lengths of the corrected normal in the pose, up to the length that two unit vectors can reach. Chooses the
    // length with the smallest error half-way to the pose.
    std::optional<Vec3d> best;
    double size = kLongestSum;
    for (int n = 0; n < kTriedSums; ++n, size *= kNextSum) {
      const Vec3d vector = (1 / t) * (size * right - shown), middle = base.direction + 0.5 * vector;
      const double error = dot(middle, middle) <= 1 ? error_with(vector) : std::numbers::pi;
      if (!(error < result.error_of_two)) continue;
      result.error_of_two = error;
      best = vector;
    }
    const auto both = best ? two_units(base.direction, *best) : std::nullopt;
    if (both) {
      for (std::size_t part = 0; part < 2; ++part) result.two[part] = base.length * ((*both)[part] - base.direction);
    } else {
      result.two = {result.one, Vec3d{}};
      result.error_of_two = result.error_of_one;
    }
    return result;
  }

  [[nodiscard]] Vec3d correction(const Asked& asked, const ExtraWeight& weight, const std::vector<double>& pose,
                                 double t) const {
    const Vec3d right = rights_.of_vertex(asked.vertex, asked.of_element);
    if (right == Vec3d{}) return {};
    const BaseNormal base(rights_.stored(asked.vertex));
    Vec3d shown = sum_of(weight.i, asked.vertex, pose) + base.stored;
    if (weight.i != weight.j) shown = shown + sum_of(weight.j, asked.vertex, pose);
    Vec3d vector;
    if (lengths_ != Lengths::kUnit) {
      vector = (1 / t) * (base.length * right - shown);
    } else if (max_abs(shown) == 0 || angle_between(shown, right) > kRight) {
      const auto u = turning_unit(base.direction, (1 / base.length) * shown, unit(right), t);
      if (u) vector = base.length * (*u - base.direction);
    }
    return max_abs(vector) > kLeastCorrection * base.length ? vector : Vec3d{};
  }

  // Returns the sum of the weighted deltas of one vertex in a pose, over target i and the correction targets that
  // target i alone drives.
  [[nodiscard]] Vec3d sum_of(std::size_t i, std::size_t vertex, const std::vector<double>& pose) const {
    Vec3d sum = pose[i] * to_double(form_.own[i].at(vertex));
    for (const std::size_t k : of_target_[i])
      sum = sum + form_.weights[k].at(pose[i], pose[i]) * to_double(form_.extras[k].at(vertex));
    return sum;
  }

  const NormalTerms& terms_;
  const RightNormals& rights_;
  VerticesOfElements shown_;
  std::vector<bool> needs_element_;
  Lengths lengths_;
  Products& form_;
  std::vector<std::vector<std::size_t>> of_target_;  // for each target, the correction targets that it alone drives
};

// Two targets, their largest product of weights in the file, and the pose with this product.
struct Pair {
  std::size_t i = 0, j = 0;
  double product = 0;
  std::size_t pose = 0;
};

// Returns the targets that are active in some pose, in ascending order. If more than kMostActive targets are active,
// returns those with the largest weights.
std::vector<std::size_t> active_targets(std::size_t targets, const PoseList& poses) {
  std::vector<double> largest(targets, 0.0);
  for (const std::vector<double>& pose : poses)
    for (std::size_t i = 0; i < targets; ++i) largest[i] = std::fmax(largest[i], std::fabs(pose[i]));
  std::vector<std::size_t> result;
  for (std::size_t i = 0; i < targets; ++i)
    if (largest[i] > kLeastProduct) result.push_back(i);
  std::stable_sort(result.begin(), result.end(), [&](std::size_t a, std::size_t b) { return largest[a] > largest[b]; });
  if (result.size() > kMostActive) result.resize(kMostActive);
  std::sort(result.begin(), result.end());
  return result;
}

std::vector<Pair> active_pairs(std::size_t all_targets, const PoseList& poses) {
  const std::vector<std::size_t> of = active_targets(all_targets, poses);
  const std::size_t targets = of.size();
  std::vector<Pair> of_all(targets * targets);
  for (std::size_t p = 0; p < poses.size(); ++p) {
    std::vector<std::size_t> active;
    for (std::size_t n = 0; n < targets; ++n)
      if (is_active(poses[p], of[n])) active.push_back(n);
    for (std::size_t a = 0; a < active.size(); ++a) {
      for (std::size_t b = a + 1; b < active.size(); ++b) {
        Pair& pair = of_all[active[a] * targets + active[b]];
        const double product = std::fabs(poses[p][of[active[a]]] * poses[p][of[active[b]]]);
        if (product > pair.product) pair = {of[active[a]], of[active[b]], product, p};
      }
    }
  }
  of_all.erase(std::remove_if(of_all.begin(), of_all.end(), [](const Pair& p) { return p.product < kLeastProduct; }),
               of_all.end());
  std::stable_sort(of_all.begin(), of_all.end(), [](const Pair& a, const Pair& b) { return a.product > b.product; });
  if (of_all.size() > kMostHarmlessPairs) of_all.resize(kMostHarmlessPairs);
  return of_all;
}

// The angles by which a correction target turns normals.
struct Worth {
  double squares = 0;  // the sum of squared angles over vertices and poses
  double worst = 0;    // the largest angle in degrees
};

// Measures by which angles correction targets turn normals, in some of the poses, at vertices that need corrections.
std::vector<Worth> worths(const RightNormals& rights, const Products& form, std::span<const std::uint32_t> vertices,
                          const PoseList& all_poses) {
  const std::size_t most = std::clamp(kMeasured / (vertices.size() + 1), std::size_t{8}, kMostHarmlessPoses);
  PoseList poses;
  const std::size_t count = std::min(most, all_poses.size());
  for (std::size_t n = 0; n < count; ++n) poses.push_back(all_poses[n * all_poses.size() / count]);
  std::vector<float> weights(form.weights.size() * count);
  for (std::size_t k = 0; k < form.weights.size(); ++k) {
    const ExtraWeight& extra = form.weights[k];
    for (std::size_t p = 0; p < count; ++p)
      weights[k * count + p] = static_cast<float>(extra.at(poses[p][extra.i], poses[p][extra.j]));
  }
  std::vector<const VertexVectors*> own_columns, extra_columns;
  for (const VertexVectors& column : form.own) own_columns.push_back(&column);
  for (const VertexVectors& column : form.extras) extra_columns.push_back(&column);
  const VertexColumns own = by_vertex(own_columns, vertices), extra = by_vertex(extra_columns, vertices);
  // For each entry of `extra`, the sum of squared angles and the largest angle. Threads write these numbers, which are
  // added up afterwards in a fixed order, so that the result does not depend on the threads.
  std::vector<std::pair<float, float>> of_entries(extra.entries.size());
  rights.for_each(vertices, poses, [&](std::size_t n, std::size_t first, std::span<const Vec3f> right) {
    const Vec3f normal = to_float(rights.stored(vertices[n]));
    thread_local std::vector<float> inverse;
    inverse.assign(right.size(), 0.0F);
    for (std::size_t p = 0; p < right.size(); ++p) {
      if (right[p] == Vec3f{}) continue;
      Vec3f shown = normal;
      for (const auto& [column, delta] : own.of(n))
        shown = shown + static_cast<float>(poses[first + p][column]) * delta;
      inverse[p] = 1 / std::fmax(std::sqrt(dot(shown, shown)), 1e-2F);
    }
    for (std::size_t k = extra.first[n]; k < extra.first[n + 1]; ++k) {
      const auto& [column, delta] = extra.entries[k];
      auto& [squares, worst] = of_entries[k];
      for (std::size_t p = 0; p < right.size(); ++p) {
        const float w = weights[column * count + first + p] * inverse[p];
        if (w == 0) continue;
        const Vec3f aside = cross(right[p], delta);
        const float square = std::fmin(w * w * dot(aside, aside), 10.0F);
        squares += square;
        worst = std::fmax(worst, square);
      }
    }
  });
  std::vector<Worth> result(form.weights.size());
  for (std::size_t k = 0; k < of_entries.size(); ++k) {
    Worth& worth = result[extra.entries[k].column];
    worth.squares += static_cast<double>(of_entries[k].first);
    worth.worst = std::fmax(worth.worst, kDegreesPerRadian * std::sqrt(static_cast<double>(of_entries[k].second)));
  }
  return result;
}

// Removes the correction targets that turn normals least: first as many as together turn a normal by at most half the
// tolerance, and then as many as the limit requires.
void keep_the_worthiest(const std::vector<Worth>& worths, const ProductLimits& limits, Products& form) {
  std::vector<std::size_t> order(worths.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return worths[a].worst < worths[b].worst; });
  std::size_t dropped = 0;
  for (double turn = 0; dropped < order.size(); ++dropped) {
    turn += worths[order[dropped]].worst;
    if (turn > limits.tolerance / 2) break;
  }
  order.erase(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(dropped));
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return worths[a].squares > worths[b].squares; });
  if (order.size() > limits.most_extras) {
    form.left_out = order.size() - limits.most_extras;
    order.resize(limits.most_extras);
  }
  std::sort(order.begin(), order.end());
  Products kept;
  for (const std::size_t k : order) {
    kept.weights.push_back(form.weights[k]);
    kept.extras.push_back(std::move(form.extras[k]));
  }
  form.weights = std::move(kept.weights);
  form.extras = std::move(kept.extras);
}

// Adds correction targets that correct normals in some poses. Only vertices that need corrections get deltas; `worst`
// has the error of each vertex in degrees.
void add_corrections(const GltfShading& shading, const NormalTerms& terms, const RightNormals& rights,
                     const PoseList& poses, std::span<const std::uint32_t> vertices, std::span<const float> worst,
                     const ProductLimits& limits, Products& form) {
  std::vector<std::uint32_t> needy;
  std::vector<bool> needs_element(shading.groups.size(), false);
  for (std::size_t n = 0; n < vertices.size(); ++n)
    if (2 * static_cast<double>(worst[n]) > limits.tolerance)
      needs_element[shading.element_of_vertex[vertices[n]]] = true;
  for (const std::uint32_t v : vertices)
    if (needs_element[shading.element_of_vertex[v]]) needy.push_back(v);
  if (needy.empty() || limits.most_extras == 0) return;

  const std::size_t targets = form.own.size();
  const bool is_unit = limits.lengths == Lengths::kUnit;
  Corrector corrector(shading, terms, rights, std::move(needs_element), limits.lengths, form);
  for (std::size_t i = 0; i < targets; ++i) {
    const bool is_used = std::any_of(poses.begin(), poses.end(), [&](const auto& pose) { return is_active(pose, i); });
    if (!is_used || form.own[i].vertices.empty()) continue;
    std::vector<double> pose(targets, 0.0);
    pose[i] = 1;
    if (is_unit) corrector.add_turn(i, pose);
    pose[i] = 0.5;
    const double scale = is_unit ? 4 : 1;
    corrector.add({i, i, scale, -scale}, pose);
  }
  for (const Pair& pair : active_pairs(targets, poses)) {
    if (form.own[pair.i].vertices.empty() || form.own[pair.j].vertices.empty()) continue;
    std::vector<double> pose(targets, 0.0);
    pose[pair.i] = poses[pair.pose][pair.i];
    pose[pair.j] = poses[pair.pose][pair.j];
    const double scale = is_unit ? std::clamp(kStrongest / pair.product, 1.0, kMostScale) : 1;
    if (!is_unit)
      corrector.add({pair.i, pair.j, 0, scale}, pose);
    else
      corrector.add_pair({pair.i, pair.j, 0, scale}, pose, limits.tolerance / kDegreesPerRadian);
  }
  keep_the_worthiest(worths(rights, form, needy, poses), limits, form);
  const double factor = weight_factor(limits.lengths);
  for (std::size_t k = 0; k < form.extras.size(); ++k) {
    form.weights[k].linear *= factor;
    form.weights[k].quadratic *= factor;
    for (Vec3f& vector : form.extras[k].vectors) vector = static_cast<float>(1 / factor) * vector;
  }
}

}  // namespace

std::vector<VertexVectors> end_deltas(const GltfShading& shading, const NormalTerms& terms, const RightNormals& rights,
                                      Lengths lengths) {
  const VerticesOfElements shown(shading);
  std::vector<VertexVectors> own;
  for (std::size_t i = 0; i < shading.set.targets.size(); ++i) {
    if (shading.set.targets[i].vertices.empty()) {
      own.emplace_back();
      continue;
    }
    std::vector<double> pose(shading.set.targets.size(), 0.0);
    pose[i] = 1;
    const std::vector<Asked> asked = asked_vertices(shown, rights, pose, terms.elements(i));
    own.push_back(gather(asked, [&](const Asked& of) {
      const Vec3d right = rights.of_vertex(of.vertex, of.of_element);
      const BaseNormal base(rights.stored(of.vertex));
      if (right == Vec3d{}) return Vec3d{};
      if (lengths == Lengths::kUnit) return base.length * farthest_that_fits(base.direction, unit(right)) - base.stored;
      if (lengths == Lengths::kShort) return base.length * unit(right) - base.stored;
      return base.length * std::clamp(length(right), kShortestEnd, kLongestEnd) * unit(right) - base.stored;
    }));
  }
  return own;
}

std::size_t count_products(const Making& making, std::size_t most) {
  const DeltaSource& source = making.source;
  std::size_t count = 0;
  for (std::size_t i = 0; i < making.targets(); ++i) {
    if (!moves(source.shading, i)) continue;
    for (std::size_t j = i; j < making.targets() && count <= most; ++j) {
      if (!moves(source.shading, j) || (i != j && !source.terms.overlap(i, j))) continue;
      if (making.weights.rig || making.weights.use.together(i, j)) ++count;
    }
  }
  return count;
}

Candidate products_candidate(const Making& making) {
  const GltfShading& shading = making.source.shading;
  Products form;
  form.own = end_deltas(shading, making.source.terms, making.rights, making.lengths);
  const PoseList poses = making.weights.rig ? making.weights.rig->sample(kMostSampled, kRigSeed)
                                            : making.weights.use.samples_with_keys(kMostSampled);
  Candidate result;
  result.name = "products";
  result.own = form.own;
  const std::vector<float> worst = making.judge.worst(columns_of(result, making.judge.vertices()), poses);
  add_corrections(shading, making.source.terms, making.rights, poses, making.judge.vertices(), worst,
                  {making.lengths, making.most_extras, making.tolerance}, form);
  result.extras = std::move(form.extras);
  result.left_out = form.left_out;
  result.drivers.formulas = std::move(form.weights);
  cut_tracks(making.rights, making.weights, making.viewers, making.judge.vertices(),
             kPartOfTracks * making.tolerance / kDegreesPerRadian, result);
  return result;
}

}  // namespace chronormal::inline internal
