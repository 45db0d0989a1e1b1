#include "measure/oracle.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

namespace chronormal::bench {
namespace {

constexpr std::size_t kAllUpTo = 100000, kSample = 4096;
constexpr double kNoDirection = 1e-7;

Vector position(const Segment& segment, std::uint32_t v, double t) {
  const std::size_t i = v * segment.from.stride, j = v * segment.to.stride;
  const auto between = [t](float a, float b) { return (1 - t) * double{a} + t * double{b}; };
  return {between(segment.from.x[i], segment.to.x[j]), between(segment.from.y[i], segment.to.y[j]),
          between(segment.from.z[i], segment.to.z[j])};
}

Vector cross_of(const Vector& a, const Vector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

double length_of(const Vector& a) { return std::hypot(a[0], a[1], a[2]); }

}  // namespace

double angle(const Vector& a, const Vector& b) {
  const double scale = length_of(a) * length_of(b);
  if (!(scale > 0)) return std::numbers::pi;
  return std::atan2(length_of(cross_of(a, b)), a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
}

double Errors::mean() const {
  if (sorted.empty()) return 0;
  return std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size());
}

double Errors::quantile(double share) const {
  if (sorted.empty()) return 0;
  const double last = static_cast<double>(sorted.size() - 1);
  return sorted[static_cast<std::size_t>(std::ceil(share * last))];
}

Oracle::Oracle(const Segment& segment, Elements elements) : segment_(segment), kind_(elements) {
  const Topology& topology = *segment.topology;
  const std::size_t count = elements == Elements::kFaces ? topology.face_count() : topology.vertex_count();
  if (count <= kAllUpTo) {
    elements_.resize(count);
    std::iota(elements_.begin(), elements_.end(), 0u);
  } else {
    std::mt19937_64 random(3);
    for (std::size_t i = 0; i < kSample; ++i) elements_.push_back(static_cast<std::uint32_t>(random() % count));
    std::sort(elements_.begin(), elements_.end());
    elements_.erase(std::unique(elements_.begin(), elements_.end()), elements_.end());
  }
  areas_.resize(elements_.size());
  const auto add_areas = [this](std::size_t element, std::size_t face) {
    areas_[element] += length_of(face_normal(face, 0)) + length_of(face_normal(face, 1));
  };
  if (kind_ == Elements::kFaces) {
    for (std::size_t i = 0; i < elements_.size(); ++i) add_areas(i, elements_[i]);
    return;
  }
  constexpr std::uint32_t kNotKnown = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> known(count, kNotKnown);
  for (std::size_t i = 0; i < elements_.size(); ++i) known[elements_[i]] = static_cast<std::uint32_t>(i);
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    for (const std::uint32_t v : topology.face(f)) {
      if (known[v] != kNotKnown) terms_.emplace_back(known[v], static_cast<std::uint32_t>(f));
    }
  }
  for (const auto& [element, face] : terms_) add_areas(element, face);
}

Vector Oracle::face_normal(std::size_t face, double t) const {
  const std::span<const std::uint32_t> corners = segment_.topology->face(face);
  const Vector first = position(segment_, corners[0], t);
  const auto edge_to = [&](std::size_t c) {
    const Vector p = position(segment_, corners[c], t);
    return Vector{p[0] - first[0], p[1] - first[1], p[2] - first[2]};
  };
  Vector sum{};
  for (std::size_t c = 1; c + 1 < corners.size(); ++c) {
    const Vector n = cross_of(edge_to(c), edge_to(c + 1));
    for (std::size_t i = 0; i < 3; ++i) sum[i] += n[i];
  }
  return sum;
}

std::vector<Vector> Oracle::normals(double t, Rule rule) const {
  std::vector<Vector> result(elements_.size());
  if (kind_ == Elements::kFaces) {
    for (std::size_t i = 0; i < elements_.size(); ++i) result[i] = face_normal(elements_[i], t);
    return result;
  }
  for (const auto& [element, face] : terms_) {
    const Vector n = face_normal(face, t);
    const double size = length_of(n), weight = rule == Rule::kArea ? 1 : size > 0 ? 1 / size : 0;
    for (std::size_t i = 0; i < 3; ++i) result[element][i] += weight * n[i];
  }
  return result;
}

Errors Oracle::errors(double t, Rule rule, const std::function<Vector(std::size_t)>& normal_of) const {
  return errors(normals(t, rule), normal_of);
}

Errors Oracle::errors(std::span<const Vector> exact, const std::function<Vector(std::size_t)>& normal_of) const {
  Errors errors;
  for (std::size_t i = 0; i < exact.size(); ++i) {
    if (length_of(exact[i]) > kNoDirection * areas_[i])
      errors.sorted.push_back(angle(exact[i], normal_of(elements_[i])));
  }
  std::sort(errors.sorted.begin(), errors.sorted.end());
  return errors;
}

}  // namespace chronormal::bench
