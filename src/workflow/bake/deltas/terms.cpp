// Computes the terms of a mesh. If normals are weighted by area, the terms are computed from products of positions. For
// other weightings, the terms are fitted to true normals at some weights.
#include "workflow/bake/deltas/terms.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kTermsBlock = 256;
// The number of weights from 1/8 to 1 at which the true normals of a target are computed. Terms are fitted at the
// weights 1/2 and 1, and the fit is checked at the other weights.
constexpr std::size_t kSamples = 8;

void add_deltas(const BlendTarget& moved, std::vector<float>& positions) {
  for (std::size_t n = 0; n < moved.vertices.size(); ++n) {
    for (std::size_t c = 0; c < 3; ++c) positions[3 * std::size_t{moved.vertices[n]} + c] += moved.deltas[3 * n + c];
  }
}

// Returns a function for the position of a vertex at t, on the straight line from its position in the base (t = 0) to
// its position in `to` (t = 1).
auto on_the_way(const BlendSet& set, const std::vector<float>& to, double t) {
  return [&set, &to, t](std::uint32_t v) {
    const float* const from = set.base.data() + 3 * std::size_t{v};
    const float* const end = to.data() + 3 * std::size_t{v};
    const Vec3d a{from[0], from[1], from[2]}, b{end[0], end[1], end[2]};
    return a + t * (b - a);
  };
}

auto placed(std::span<const double> positions) {
  return [positions](std::uint32_t v) {
    const double* const p = positions.data() + 3 * std::size_t{v};
    return Vec3d{p[0], p[1], p[2]};
  };
}

std::vector<std::uint32_t> common(const std::vector<std::uint32_t>& a, const std::vector<std::uint32_t>& b) {
  std::vector<std::uint32_t> result;
  std::set_intersection(a.begin(), a.end(), b.begin(), b.end(), std::back_inserter(result));
  return result;
}

}  // namespace

NormalTerms::NormalTerms(const GltfShading& shading, const AuthorTruth& truth)
    : shading_(shading), truth_(truth), by_area_(shading.set, shading.groups) {
  constexpr std::size_t kFewElements = 200000;
  if (is_fitted())
    fit_targets();
  else if (shading.groups.size() <= kFewElements)
    base_ = by_area_.base();
}

void NormalTerms::fit_targets() {
  const BlendSet& set = shading_.set;
  std::vector<bool> is_shown(shading_.groups.size(), false);
  for (const std::uint32_t e : shading_.element_of_vertex) {
    if (e != GltfShading::kNoElement) is_shown[e] = true;
  }
  const std::vector<double> at_rest(set.targets.size());
  base_ = sample_all(at_rest, std::vector<double>(set.base.begin(), set.base.end()));
  fits_.resize(set.targets.size());
  for (std::size_t i = 0; i < set.targets.size(); ++i) {
    Fit& fit = fits_[i];
    // Elements whose faces do not move are left out, because their terms would be only rounding errors.
    fit.elements = truth_.elements_of(i);
    if (fit.elements.empty()) continue;
    std::vector<float> to = set.base;
    add_deltas(set.targets[i], to);
    // The true normals at the weights 1/8, 2/8 and so on up to 1. Entry 0 is not used.
    std::array<std::vector<Vec3d>, kSamples + 1> right;
    for (std::size_t s = 1; s <= kSamples; ++s) {
      const double weight = static_cast<double>(s) / kSamples;
      right[s].resize(fit.elements.size());
      truth_.for_each(fit.elements, on_the_way(set, to, weight), truth_.pose_alone(i, weight),
                      [&](std::size_t n, const AuthorSum& truth) { right[s][n] = truth.with_area_length(); });
    }
    fit.linear.resize(fit.elements.size());
    fit.square.resize(fit.elements.size());
    const auto fit_element = [&](std::size_t n, double& error) {
      const std::uint32_t e = fit.elements[n];
      const Vec3d base = base_[e], half = right[kSamples / 2][n], end = right[kSamples][n];
      fit.linear[n] = 4.0 * half - 3.0 * base - end;
      fit.square[n] = 2.0 * (base + end) - 4.0 * half;
      for (std::size_t s = 1; s < kSamples && is_shown[e]; ++s) {
        const double t = static_cast<double>(s) / kSamples;
        const Vec3d fitted = base + t * fit.linear[n] + (t * t) * fit.square[n];
        if (right[s][n] != Vec3d{}) error = std::fmax(error, angle_between(fitted, right[s][n]));
      }
    };
    fit.error = parallel_fold<double>(fit.elements.size(), kTermsBlock, fit_element,
                                      [](double& all, double each) { all = std::fmax(all, each); });
  }
}

BlendTerm NormalTerms::linear(std::size_t i) const {
  if (is_fitted()) return {fits_[i].elements, fits_[i].linear, {}};
  BlendTerm term = by_area_.linear(i);
  term.noise = std::vector<double>();
  return term;
}

BlendTerm NormalTerms::pair(std::size_t i, std::size_t j) const {
  if (!is_fitted()) {
    BlendTerm term = by_area_.pair(i, j);
    term.noise = std::vector<double>();
    return term;
  }
  if (i == j) return {fits_[i].elements, fits_[i].square, {}};
  // The term of the pair is the true normal with both targets at weight 1, minus the base normal, and minus the terms
  // of the single targets.
  std::vector<float> to = shading_.set.base;
  add_deltas(shading_.set.targets[i], to);
  add_deltas(shading_.set.targets[j], to);
  std::vector<double> both(shading_.set.targets.size());
  both[i] = both[j] = 1;
  const AuthorTruth::Pose pose = truth_.pose(both);
  const NormalTerms::Term linear_i = linear_by_element(i), linear_j = linear_by_element(j);
  const NormalTerms::Term square_i = pair_by_element(i, i), square_j = pair_by_element(j, j);
  BlendTerm term{common(fits_[i].elements, fits_[j].elements), {}, {}};
  term.values.resize(term.elements.size());
  truth_.for_each(term.elements, on_the_way(shading_.set, to, 1), pose, [&](std::size_t n, const AuthorSum& truth) {
    const std::uint32_t e = term.elements[n];
    Vec3d value = truth.with_area_length() - base_[e];
    for (const NormalTerms::Term* own : {&linear_i, &linear_j, &square_i, &square_j}) {
      Vec3d part;
      if (own->find(e, part)) value = value - part;
    }
    term.values[n] = value;
  });
  return term;
}

NormalTerms::Term NormalTerms::linear_by_element(std::size_t i) const {
  return is_fitted() ? Term(linear(i)) : Term(by_area_.linear_by_element(i));
}

NormalTerms::Term NormalTerms::pair_by_element(std::size_t i, std::size_t j) const {
  return is_fitted() ? Term(pair(i, j)) : Term(by_area_.pair_by_element(i, j));
}

bool NormalTerms::Term::find(std::uint32_t element, Vec3d& value) const {
  if (by_area_) {
    value = (*by_area_)(element);
    return value != Vec3d{};
  }
  const auto found = std::lower_bound(fitted_.elements.begin(), fitted_.elements.end(), element);
  if (found == fitted_.elements.end() || *found != element) return false;
  value = fitted_.values[static_cast<std::size_t>(found - fitted_.elements.begin())];
  return true;
}

std::vector<std::uint32_t> NormalTerms::elements(std::size_t i, std::size_t j) const {
  if (!is_fitted()) return by_area_.elements(i, j);
  return i == j ? fits_[i].elements : common(fits_[i].elements, fits_[j].elements);
}

bool NormalTerms::overlap(std::size_t i, std::size_t j) const {
  return is_fitted() ? !common(fits_[i].elements, fits_[j].elements).empty() : by_area_.overlap(i, j);
}

std::vector<Vec3d> NormalTerms::exact_at(std::span<const double> weights) const {
  if (!is_fitted()) return by_area_at(weights);
  if (const std::vector<Vec3d>* kept = sampled_.find(weights)) return *kept;
  std::vector<double> blended(shading_.set.base.size());
  blend_positions(shading_.set, weights, blended);
  return sample_all(weights, blended);
}

std::vector<Vec3d> NormalTerms::sample_all(std::span<const double> weights, std::span<const double> positions) const {
  const AuthorTruth::Pose pose = truth_.pose(weights);
  std::vector<Vec3d> all(shading_.groups.size());
  truth_.for_all(placed(positions), pose,
                 [&](std::uint32_t e, const AuthorSum& truth) { all[e] = truth.with_area_length(); });
  sampled_.keep(weights, all);
  return all;
}

std::vector<Vec3d> NormalTerms::weighted_at(std::span<const double> weights,
                                            std::span<const std::uint32_t> elements) const {
  std::vector<Vec3d> result(elements.size());
  const auto take = [&](const std::vector<Vec3d>& all) {
    for (std::size_t n = 0; n < elements.size(); ++n) result[n] = all[elements[n]];
    return result;
  };
  if (const std::vector<Vec3d>* kept = sampled_.find(weights)) return take(*kept);
  std::vector<double> positions(shading_.set.base.size());
  blend_positions(shading_.set, weights, positions);
  // If more than a quarter of all elements are requested, computes all elements, and stores them for later calls.
  if (4 * elements.size() > shading_.groups.size()) return take(sample_all(weights, positions));
  const AuthorTruth::Pose pose = truth_.pose(weights);
  truth_.for_each(elements, placed(positions), pose,
                  [&](std::size_t n, const AuthorSum& truth) { result[n] = truth.with_area_length(); });
  return result;
}

ControlNormals of_powers(const Vec3d& base, const Vec3d& linear, const Vec3d& square) noexcept {
  return {base, base + 0.5 * linear, base + linear + square};
}

ControlNormals normals_between(const ControlNormals& normals, double from, double to) noexcept {
  // The polar form of the quadratic n(t). Its values are the control normals of n(t) between `from` and `to`.
  const auto at = [&normals](double s, double t) {
    return ((1 - s) * (1 - t)) * normals.n0 + ((1 - s) * t + s * (1 - t)) * normals.m + (s * t) * normals.n1;
  };
  return {at(from, from), at(from, to), at(to, to)};
}

VertexTerms::VertexTerms(const Vec3d& base, double largest, const Vec3d& stored) noexcept
    : base_(unit(base)), stored_(unit(stored)) {
  if (max_abs(stored) > 0) length_ = length(stored);
  const double of_base = length(base);
  if (has_base(base, largest)) {
    scale_ = of_base > 0 ? length_ / of_base : 0;
    // If the author's normal points to the other side of the surface, the true normal is the opposite of n(w).
    if (dot(base_, stored_) < 0) {
      base_ = -base_;
      side_ = -1;
    }
  } else {
    scale_ = kLongest * length_ / largest;
  }
}

Vec3d VertexTerms::turn(const Vec3d& v) const noexcept {
  if (max_abs(base_) == 0 || max_abs(stored_) == 0) return v;
  return turned(base_, stored_, side_ * v);
}

Vec3d VertexTerms::end_delta(const Vec3d& delta, const ControlNormals& normals) const noexcept {
  if (max_abs(base_) > 0) return length_ * turn(delta);
  // The best single delta starts from the limit of the true direction at weight 0, but a delta in the file starts from
  // the stored normal N.
  return length_ * (unit_normal_at(normals, 0).vector + delta - stored_);
}

Vec3d VertexTerms::fitted_delta(const Vec3d& delta) const noexcept {
  return (max_abs(base_) > 0 ? length_ : kLongest * length_) * turn(delta);
}

}  // namespace chronormal::inline internal
