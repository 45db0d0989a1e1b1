#include "workflow/bake/terms.h"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/transform.h"
#include "chronormal/normals/weighting.h"

namespace chronormal::inline internal {
namespace {

std::vector<float> moved_positions(const BlendSet& set, std::size_t target) {
  std::vector<float> positions = set.base;
  const BlendTarget& moved = set.targets[target];
  for (std::size_t n = 0; n < moved.vertices.size(); ++n) {
    for (std::size_t c = 0; c < 3; ++c) positions[3 * std::size_t{moved.vertices[n]} + c] += moved.deltas[3 * n + c];
  }
  return positions;
}

}  // namespace

NormalTerms::NormalTerms(const GltfShading& shading, Weighting weighting)
    : shading_(shading), weighting_(weighting), by_area_(shading.set, shading.groups) {
  if (is_fitted()) fit_targets();
}

void NormalTerms::fit_targets() {
  const BlendSet& set = shading_.set;
  const std::size_t vertices = set.base.size() / 3;
  std::vector<bool> is_shown(shading_.groups.size(), false);
  for (const std::uint32_t e : shading_.element_of_vertex) {
    if (e != GltfShading::kNoElement) is_shown[e] = true;
  }
  fits_.resize(set.targets.size());
  for (std::size_t i = 0; i < set.targets.size(); ++i) {
    if (set.targets[i].vertices.empty()) continue;
    const std::vector<float> to = moved_positions(set, i);
    const Segment segment{&set.topology, VectorView<const float>::packed(set.base.data(), vertices),
                          VectorView<const float>::packed(to.data(), vertices)};
    const WeightingFit fit = fit_weighting(segment, shading_.groups, weighting_);
    if (base_.empty()) {
      for (const ControlNormals& normals : fit.normals) base_.push_back(normals.n0);
    }
    // Elements of faces that stand still have terms that are nothing but rounding.
    std::vector<std::uint32_t>& elements = fits_[i].elements;
    for (const std::uint32_t face : by_area_.faces(i)) {
      for (std::size_t c = 0; c < 3; ++c)
        elements.push_back(shading_.groups.element_of_corner()[3 * std::size_t{face} + c]);
    }
    std::sort(elements.begin(), elements.end());
    elements.erase(std::unique(elements.begin(), elements.end()), elements.end());
    for (const std::uint32_t e : elements) {
      const ControlNormals& n = fit.normals[e];
      fits_[i].linear.push_back(2.0 * (n.m - n.n0));
      fits_[i].square.push_back((n.n0 - n.m) + (n.n1 - n.m));
      if (is_shown[e]) fits_[i].bound = std::fmax(fits_[i].bound, fit.bounds[e]);
    }
  }
  if (base_.empty()) base_ = by_area_.base();
}

BlendTerm NormalTerms::linear(std::size_t i) const {
  if (is_fitted()) return {fits_[i].elements, fits_[i].linear, {}};
  BlendTerm term = by_area_.linear(i);
  term.noise = std::vector<double>();
  return term;
}

BlendTerm NormalTerms::pair(std::size_t i, std::size_t j) const {
  assert(i == j || !is_fitted());
  if (is_fitted()) return {fits_[i].elements, fits_[i].square, {}};
  BlendTerm term = by_area_.pair(i, j);
  term.noise = std::vector<double>();
  return term;
}

NormalTerms::Term NormalTerms::linear_by_element(std::size_t i) const {
  return is_fitted() ? Term(fits_[i].elements, fits_[i].linear) : Term(by_area_.linear_by_element(i));
}

NormalTerms::Term NormalTerms::pair_by_element(std::size_t i, std::size_t j) const {
  assert(i == j || !is_fitted());
  return is_fitted() ? Term(fits_[i].elements, fits_[i].square) : Term(by_area_.pair_by_element(i, j));
}

bool NormalTerms::Term::find(std::uint32_t element, Vec3d& value) const {
  if (by_area_) {
    value = (*by_area_)(element);
    return value != Vec3d{};
  }
  const auto found = std::lower_bound(elements_->begin(), elements_->end(), element);
  if (found == elements_->end() || *found != element) return false;
  value = (*values_)[static_cast<std::size_t>(found - elements_->begin())];
  return true;
}

bool NormalTerms::overlap(std::size_t i, std::size_t j) const {
  if (!is_fitted()) return by_area_.overlap(i, j);
  std::vector<std::uint32_t> common;
  std::set_intersection(fits_[i].elements.begin(), fits_[i].elements.end(), fits_[j].elements.begin(),
                        fits_[j].elements.end(), std::back_inserter(common));
  return !common.empty();
}

std::vector<Vec3d> NormalTerms::at(std::span<const double> weights) const {
  if (!is_fitted()) return normals_from_positions(shading_, weights);
  std::vector<Vec3d> normals = base_;
  for (std::size_t i = 0; i < weights.size(); ++i) {
    const Fit& fit = fits_[i];
    for (std::size_t n = 0; weights[i] != 0 && n < fit.elements.size(); ++n) {
      Vec3d& normal = normals[fit.elements[n]];
      normal = normal + weights[i] * fit.linear[n] + (weights[i] * weights[i]) * fit.square[n];
    }
  }
  return normals;
}

std::vector<Vec3d> NormalTerms::exact_at(std::span<const double> weights) const {
  if (!is_fitted()) return by_area_at(weights);
  const BlendSet& set = shading_.set;
  std::vector<double> blended(set.base.size());
  blend_positions(set, weights, blended);
  const std::vector<float> to(blended.begin(), blended.end());
  const std::size_t vertices = set.base.size() / 3;
  const Segment segment{&set.topology, VectorView<const float>::packed(set.base.data(), vertices),
                        VectorView<const float>::packed(to.data(), vertices)};
  return all_weighted_normals_at(segment, shading_.groups, weighting_, 1);
}

ControlNormals of_powers(const Vec3d& base, const Vec3d& linear, const Vec3d& square) noexcept {
  return {base, base + 0.5 * linear, base + linear + square};
}

ControlNormals normals_between(const ControlNormals& normals, double from, double to) noexcept {
  // The polar form of the quadratic.
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
    // An author who shows the other side means the other normal.
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
  // The line begins at the limit of the directions, but the file's at N.
  return length_ * (unit_normal_at(normals, 0).vector + delta - stored_);
}

Vec3d VertexTerms::fitted_delta(const Vec3d& delta) const noexcept {
  return (max_abs(base_) > 0 ? length_ : kLongest * length_) * turn(delta);
}

}  // namespace chronormal::inline internal
