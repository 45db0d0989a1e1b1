// Fits correction targets of low rank: finds the leading singular vectors, and fits deltas to angles by least squares.
#include "workflow/bake/fits/low_rank_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>

#include "analysis/fits/kernels/products.h"
#include "analysis/fits/leading_vectors.h"
#include "analysis/quality/kernels/blended_normals.h"
#include "core/blocks.h"
#include "core/cholesky.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kPointBlock = 16;  // the number of points that one task handles
constexpr std::size_t kSampledPoints = 1500;
// A point (vertices with the same normal) has the weight 1 / length in the fit. The length is the 2 % quantile of the
// lengths of its normals, but at least kShortest, and at least kPartOfLack times the length of its missing vectors
// (right normals minus shown normals). Without the two limits, a few points with very short normals would dominate all
// others.
constexpr double kShortQuantile = 0.02;
constexpr float kShortest = 1e-3F, kPartOfLack = 0.1F;
constexpr int kFitRounds = 3;
// Errors as parts of the tolerance. Points with an error beyond kPartThatCounts count more. Points with an error beyond
// kPartToRefit get a fit of their own, in which an instant with the error kPartOfBad counts twice as much as an instant
// without error.
constexpr double kPartThatCounts = 0.6, kPartToRefit = 0.4, kPartOfBad = 0.3;
constexpr std::size_t kMostRefitted = 1500;
// The limit of multiplications in the fits of all single points. If there are many correction targets, each fit takes
// more multiplications, so fewer points are fitted.
constexpr double kRefitWork = 1e10;
// The length below which a normal is not used in a fit of directions, relative to n(0).
constexpr float kLeastLength = 1e-3F;
constexpr int kRefits = 4;
// A dip is a place between nodes where a normal is much shorter than at the nodes. A piece is searched for dips in
// kDipSteps steps if the squared length at one of its nodes is below kNearDip, relative to n(0). A dip counts if its
// squared length is below kDip times the squared length at the nodes.
constexpr int kDipSteps = 32;
constexpr double kNearDip = 0.25, kDip = 0.5;
constexpr double kRidgeOfRefit = 1e-4, kLeastSquare = 1e-6;

// Returns the place at t, from 0 to 1, in a piece of a curve. `nodes` are the rows at t = 0, 1/2 and 1.
PlaceOfRows place_at(const std::array<std::size_t, 3>& nodes, double t) {
  return {nodes, {(1 - t) * (1 - 2 * t), 4 * t * (1 - t), t * (2 * t - 1)}};
}

// Returns the value at a place between rows, interpolated from the values of its three rows.
float at_place(const PlaceOfRows& place, const float* of_rows) {
  double sum = 0;
  for (std::size_t n = 0; n < 3; ++n) sum += place.factors[n] * static_cast<double>(of_rows[place.nodes[n]]);
  return static_cast<float>(sum);
}

float quantile(std::vector<float>& errors, double part) {
  if (errors.empty()) return 0;
  const auto at = errors.begin() + static_cast<std::ptrdiff_t>(part * static_cast<double>(errors.size() - 1));
  std::nth_element(errors.begin(), at, errors.end());
  return *at;
}

}  // namespace

LowRankFit::LowRankFit(const MissingNormals& missing, std::span<const PlaceOfRows> places,
                       std::span<const PlaceOfRows> unseen)
    : missing_(missing),
      places_(places),
      unseen_(unseen),
      importance_(missing.points(), 1.0F),
      errors_(missing.points(), 0.0F) {
  set_first_importance();
}

void LowRankFit::set_first_importance() {
  parallel_blocks(missing_.points(), kPointBlock, [&](IndexRange points) {
    std::vector<float> lengths;
    const std::size_t stride = missing_.stride();
    for (std::size_t p = points.first; p < points.first + points.count; ++p) {
      const float *shown = missing_.shown(p), *lack = missing_.missing(p);
      lengths.clear();
      float most = kShortest;
      for (std::size_t r = 0; r < missing_.rows(); ++r) {
        float square = 0, of_lack = 0;
        for (std::size_t c = 0; c < 3; ++c) {
          const float right = shown[c * stride + r] + lack[c * stride + r];
          square += right * right;
          of_lack += lack[c * stride + r] * lack[c * stride + r];
        }
        if (square > 0) lengths.push_back(std::sqrt(square));
        most = std::fmax(most, kPartOfLack * std::sqrt(of_lack));
      }
      importance_[p] = 1 / std::fmax(quantile(lengths, kShortQuantile), most);
    }
  });
}

void LowRankFit::take_weights(std::span<const double> vectors, std::size_t columns, std::size_t extras) {
  extras_ = extras;
  padded_ = padded_to(extras);
  weights_.assign(missing_.rows() * padded_, 0.0F);
  for (std::size_t r = 0; r < missing_.rows(); ++r)
    for (std::size_t k = 0; k < extras; ++k) weights_[r * padded_ + k] = static_cast<float>(vectors[r * columns + k]);
}

// Computes the deltas of all points. The columns of weights are orthonormal, so each delta is the inner product of the
// missing normals with a column.
void LowRankFit::project() {
  deltas_.assign(missing_.points() * 3 * padded_, 0.0F);
  parallel_blocks(missing_.points(), kPointBlock, [&](IndexRange points) {
    const StridedMatrix a{missing_.missing(points.first), missing_.rows(), 3 * points.count, 1, missing_.stride()};
    const StridedMatrix b{weights_.data(), missing_.rows(), padded_, padded_, 1};
    add_products(a, b, deltas_.data() + 3 * padded_ * points.first, padded_);
  });
}

std::vector<double> LowRankFit::errors_with(std::span<const std::size_t> counts) {
  const std::size_t most = std::min(counts.back(), missing_.rows());
  const std::vector<double> vectors = leading_vectors(missing_.inner_products(importance_), missing_.rows(), most);
  take_weights(vectors, most, most);
  project();
  const std::size_t rows = missing_.rows(), stride = missing_.stride(), points = missing_.points();
  const std::size_t step = std::max<std::size_t>(1, points / kSampledPoints), sampled = block_count(points, step);
  std::vector<std::vector<float>> errors(counts.size(), std::vector<float>(sampled * rows));
  parallel_each(sampled, kPointBlock, [&](std::size_t n) {
    const std::size_t p = n * step;
    const float *shown = missing_.shown(p), *lack = missing_.missing(p);
    std::vector<float> now(shown, shown + 3 * stride);
    std::size_t added = 0;
    for (std::size_t c = 0; c < counts.size(); ++c) {
      for (; added < std::min(counts[c], most); ++added) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const float delta = deltas(p)[axis * padded_ + added];
          for (std::size_t r = 0; r < rows; ++r) now[axis * stride + r] += weights_[r * padded_ + added] * delta;
        }
      }
      for (std::size_t r = 0; r < rows; ++r) {
        const Vec3f is = {now[r], now[stride + r], now[2 * stride + r]};
        const Vec3f should = {shown[r] + lack[r], shown[stride + r] + lack[stride + r],
                              shown[2 * stride + r] + lack[2 * stride + r]};
        const bool is_known = dot(should, should) > kLeastLength * kLeastLength;
        errors[c][n * rows + r] = is_known ? openness(is, should) : 0;
      }
    }
  });
  std::vector<double> result;
  result.reserve(errors.size());
  for (std::vector<float>& of_count : errors) result.push_back(degrees_of(quantile(of_count, 0.999)));
  return result;
}

LowRankFit::Basis LowRankFit::basis_of(std::span<const float> own_weights, std::span<const PlaceOfRows> places) const {
  Basis basis;
  basis.columns = own_targets_ + extras_;
  basis.padded = padded_to(basis.columns);
  basis.instants = missing_.rows() + places.size();
  basis.stride = padded_to(basis.instants);
  basis.by_instant.assign(basis.instants * basis.padded, 0.0F);
  basis.by_column.assign(basis.columns * basis.stride, 0.0F);
  for (std::size_t c = 0; c < basis.columns; ++c) {
    std::vector<float> of_rows(missing_.rows());
    for (std::size_t r = 0; r < of_rows.size(); ++r)
      of_rows[r] = c < own_targets_ ? own_weights[r * own_targets_ + c] : weights_[r * padded_ + c - own_targets_];
    for (std::size_t n = 0; n < basis.instants; ++n) {
      const float value = n < of_rows.size() ? of_rows[n] : at_place(places[n - of_rows.size()], of_rows.data());
      basis.by_instant[n * basis.padded + c] = basis.by_column[c * basis.stride + n] = value;
    }
  }
  return basis;
}

LowRankFit::Course LowRankFit::course_of(std::size_t point, std::span<const PlaceOfRows> places) const {
  const std::size_t rows = missing_.rows(), stride = missing_.stride(), instants = rows + places.size();
  const std::size_t plane = padded_to(instants);
  Course course{std::vector<float>(3 * plane), std::vector<float>(3 * plane), std::vector<char>(instants, 0)};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const float *shown = missing_.shown(point) + axis * stride, *lack = missing_.missing(point) + axis * stride;
    float *to_shown = course.shown.data() + axis * plane, *to_right = course.right.data() + axis * plane;
    for (std::size_t r = 0; r < rows; ++r) {
      to_shown[r] = shown[r];
      to_right[r] = shown[r] + lack[r];
    }
    for (std::size_t n = rows; n < instants; ++n) {
      to_shown[n] = at_place(places[n - rows], to_shown);
      to_right[n] = at_place(places[n - rows], to_right);
    }
  }
  for (std::size_t r = 0; r < rows; ++r) {
    const Vec3f right = {course.right[r], course.right[plane + r], course.right[2 * plane + r]};
    course.is_known[r] = static_cast<char>(dot(right, right) > kLeastLength * kLeastLength);
  }
  for (std::size_t n = rows; n < instants; ++n) {
    const auto& nodes = places[n - rows].nodes;
    course.is_known[n] = static_cast<char>(course.is_known[nodes[0]] != 0 && course.is_known[nodes[1]] != 0 &&
                                           course.is_known[nodes[2]] != 0);
  }
  return course;
}

// Measures for each point its largest error over all rows (fitted instants), in degrees.
void LowRankFit::measure_rows() {
  const Basis basis = basis_of({}, {});
  parallel_each(missing_.points(), kPointBlock, [&](std::size_t p) { errors_[p] = error_of(p, basis, {}); });
}

// Measures the largest error of each listed point, in degrees, over the rows, the fitted and the unseen places between
// rows, and the dips. If the own deltas of the mesh are corrected as well, own_weights has the weights by which these
// corrections are multiplied.
void LowRankFit::measure(std::span<const float> own_weights, std::span<const std::size_t> points) {
  std::vector<PlaceOfRows> places(places_.begin(), places_.end());
  places.insert(places.end(), unseen_.begin(), unseen_.end());
  const Basis basis = basis_of(own_weights, places);
  parallel_each(points.size(), kPointBlock, [&](std::size_t n) {
    const std::size_t p = points[n];
    std::vector<PlaceOfRows> of_point = dips_of(p);
    if (of_point.empty()) {
      errors_[p] = error_of(p, basis, places);
      return;
    }
    of_point.insert(of_point.begin(), places.begin(), places.end());
    errors_[p] = error_of(p, basis_of(own_weights, of_point), of_point);
  });
}

float LowRankFit::error_of(std::size_t point, const Basis& basis, std::span<const PlaceOfRows> places) const {
  std::vector<float> x(3 * basis.padded);
  Course course = course_of(point, places);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < own_targets_; ++i)
      x[axis * basis.padded + i] = own_deltas_[(3 * point + axis) * own_targets_ + i];
    for (std::size_t k = 0; k < extras_; ++k)
      x[axis * basis.padded + own_targets_ + k] = deltas(point)[axis * padded_ + k];
  }
  const StridedMatrix a{x.data(), basis.columns, 3, 1, basis.padded};
  const StridedMatrix b{basis.by_column.data(), basis.columns, basis.stride, basis.stride, 1};
  add_products(a, b, course.shown.data(), basis.stride);
  for (std::size_t n = 0; n < basis.instants; ++n)
    if (course.is_known[n] == 0)
      for (std::size_t axis = 0; axis < 3; ++axis) course.right[axis * basis.stride + n] = 0;
  const auto planes = [&](const std::vector<float>& of) {
    return std::array<const float*, 3>{of.data(), of.data() + basis.stride, of.data() + 2 * basis.stride};
  };
  return static_cast<float>(degrees_of(largest_openness(planes(course.shown), planes(course.right), basis.stride)));
}

// Returns the dips of a point. A dip is an instant between nodes at which the right normal is much shorter than at the
// nodes, but still has a direction. The normal turns fastest at a dip, so errors are largest there.
std::vector<PlaceOfRows> LowRankFit::dips_of(std::size_t point) const {
  const std::size_t stride = missing_.stride();
  const float *const shown = missing_.shown(point), *const lack = missing_.missing(point);
  const auto right_at = [&](std::size_t row) {
    return to_double(Vec3f{shown[row] + lack[row], shown[stride + row] + lack[stride + row],
                           shown[2 * stride + row] + lack[2 * stride + row]});
  };
  std::vector<PlaceOfRows> result;
  for (std::size_t i = 0; i < places_.size(); i += 2) {  // each piece has two places
    const std::array<std::size_t, 3>& nodes = places_[i].nodes;
    const std::array<Vec3d, 3> normals = {right_at(nodes[0]), right_at(nodes[1]), right_at(nodes[2])};
    double shortest = dot(normals[0], normals[0]);
    for (const Vec3d& normal : normals) shortest = std::fmin(shortest, dot(normal, normal));
    if (shortest > kNearDip) continue;
    double least = kDip * shortest;
    PlaceOfRows dip;
    for (int step = 1; step < kDipSteps; ++step) {
      const PlaceOfRows place = place_at(nodes, static_cast<double>(step) / kDipSteps);
      Vec3d normal;
      for (std::size_t n = 0; n < 3; ++n) normal = normal + place.factors[n] * normals[n];
      const double square = dot(normal, normal);
      if (square >= least) continue;
      least = square;
      dip = place;
    }
    if (least < kDip * shortest && least > static_cast<double>(kLeastLength * kLeastLength)) result.push_back(dip);
  }
  return result;
}

// Fits the deltas x of one point. Minimizes the sum of |(I - u u^T) (shown + basis x)|^2 over the instants, where u is
// the right direction. Instants with larger errors count more, and a ridge pulls x towards the singular vectors. Keeps
// the best x of all rounds.
void LowRankFit::refit(std::size_t point, const Basis& basis, std::span<const PlaceOfRows> places, double tolerance) {
  const std::size_t columns = basis.columns, size = 3 * columns, instants = basis.instants, plane = basis.stride;
  const Course course = course_of(point, places);
  std::vector<float> x(3 * basis.padded, 0.0F);
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t k = 0; k < extras_; ++k)
      x[axis * basis.padded + own_targets_ + k] = deltas(point)[axis * padded_ + k];
  const std::vector<float> first = x;
  std::vector<float> best = x;
  float least = std::numeric_limits<float>::infinity();
  std::vector<float> weighted(instants * basis.padded), block(columns * basis.padded);
  std::vector<double> matrix(size * size);
  for (int round = 0;; ++round) {
    std::vector<float> shown = course.shown;
    const StridedMatrix a{x.data(), columns, 3, 1, basis.padded};
    const StridedMatrix b{basis.by_column.data(), columns, plane, plane, 1};
    add_products(a, b, shown.data(), plane);
    std::vector<Vec3d> directions(instants);
    std::vector<double> counts(instants, 0.0);
    float worst = 0;
    for (std::size_t n = 0; n < instants; ++n) {
      if (course.is_known[n] == 0) continue;
      const Vec3f is = {shown[n], shown[plane + n], shown[2 * plane + n]};
      const Vec3f should = {course.right[n], course.right[plane + n], course.right[2 * plane + n]};
      directions[n] = unit(to_double(should));
      const float open = openness(is, should);
      worst = std::max(worst, open);
      const double part = kDegreesPerRadian * std::sqrt(static_cast<double>(open)) / (kPartOfBad * tolerance);
      counts[n] = (1 + part * part) / std::fmax(static_cast<double>(dot(is, is)), kLeastSquare);
    }
    if (worst < least) {
      least = worst;
      best = x;
    }
    if (round == kRefits) break;
    std::vector<double> right_side(size, 0.0);
    const auto axis_of = [](const Vec3d& v, std::size_t axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; };
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t d = c; d < 3; ++d) {
        for (std::size_t n = 0; n < instants; ++n) {
          const double across = (c == d ? 1.0 : 0.0) - axis_of(directions[n], c) * axis_of(directions[n], d);
          const auto factor = static_cast<float>(counts[n] * across);
          const float* const from = basis.by_instant.data() + n * basis.padded;
          float* const to = weighted.data() + n * basis.padded;
          for (std::size_t k = 0; k < basis.padded; ++k) to[k] = factor * from[k];
        }
        std::fill(block.begin(), block.end(), 0.0F);
        add_products({weighted.data(), instants, columns, basis.padded, 1},
                     {basis.by_instant.data(), instants, basis.padded, basis.padded, 1}, block.data(), basis.padded);
        for (std::size_t i = 0; i < columns; ++i) {
          for (std::size_t j = 0; j < columns; ++j) {
            const auto value = static_cast<double>(block[i * basis.padded + j]);
            matrix[(c * columns + i) * size + d * columns + j] = value;
            matrix[(d * columns + j) * size + c * columns + i] = value;
          }
        }
        for (std::size_t n = 0; n < instants; ++n) {
          const float* const row = weighted.data() + n * basis.padded;
          const auto of_c = static_cast<double>(course.shown[c * plane + n]);
          const auto of_d = static_cast<double>(course.shown[d * plane + n]);
          for (std::size_t i = 0; i < columns; ++i) {
            right_side[c * columns + i] -= static_cast<double>(row[i]) * of_d;
            if (c != d) right_side[d * columns + i] -= static_cast<double>(row[i]) * of_c;
          }
        }
      }
    }
    double trace = 0;
    for (std::size_t i = 0; i < size; ++i) trace += matrix[i * size + i];
    const double ridge = kRidgeOfRefit * trace / static_cast<double>(size);
    if (!(ridge > 0) || !std::isfinite(ridge)) break;
    std::vector<Vec3d> unknown(size);
    for (std::size_t i = 0; i < size; ++i) {
      matrix[i * size + i] += ridge;
      unknown[i].x = right_side[i] + ridge * static_cast<double>(first[i / columns * basis.padded + i % columns]);
    }
    Cholesky(matrix, size, ridge).solve(unknown);
    for (std::size_t i = 0; i < size; ++i)
      x[i / columns * basis.padded + i % columns] = static_cast<float>(unknown[i].x);
  }
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t k = 0; k < extras_; ++k)
      deltas_[(3 * point + axis) * padded_ + k] = best[axis * basis.padded + own_targets_ + k];
    for (std::size_t i = 0; i < own_targets_; ++i)
      own_deltas_[(3 * point + axis) * own_targets_ + i] = best[axis * basis.padded + i];
  }
}

void LowRankFit::fit(std::size_t extras, double tolerance, std::span<const float> own_weights,
                     std::size_t own_targets) {
  set_first_importance();
  own_targets_ = 0;
  for (int round = 0; round < kFitRounds; ++round) {
    take_weights(leading_vectors(missing_.inner_products(importance_), missing_.rows(), extras), extras, extras);
    project();
    if (round + 1 == kFitRounds) break;
    measure_rows();
    for (std::size_t p = 0; p < errors_.size(); ++p) {
      const float beyond = errors_[p] / static_cast<float>(kPartThatCounts * tolerance);
      importance_[p] *= std::sqrt(std::clamp(beyond, 0.5F, 4.0F));
    }
  }
  std::vector<std::size_t> all(missing_.points());
  std::iota(all.begin(), all.end(), std::size_t{0});
  measure({}, all);
  own_targets_ = own_targets;
  own_deltas_.assign(missing_.points() * 3 * own_targets, 0.0F);
  std::vector<std::size_t> bad;
  for (std::size_t p = 0; p < errors_.size(); ++p)
    if (static_cast<double>(errors_[p]) > kPartToRefit * tolerance) bad.push_back(p);
  std::stable_sort(bad.begin(), bad.end(), [&](std::size_t a, std::size_t b) { return errors_[a] > errors_[b]; });
  const Basis basis = basis_of(own_weights, places_);
  const double size = 3 * static_cast<double>(basis.columns);
  const auto most = static_cast<std::size_t>(std::fmin(kMostRefitted, kRefitWork / (size * size * size)));
  if (bad.size() > most) bad.resize(most);
  parallel_each(bad.size(), 1, [&](std::size_t n) {
    std::vector<PlaceOfRows> of_point = dips_of(bad[n]);
    if (of_point.empty()) return refit(bad[n], basis, places_, tolerance);
    of_point.insert(of_point.begin(), places_.begin(), places_.end());
    refit(bad[n], basis_of(own_weights, of_point), of_point, tolerance);
  });
  measure(own_weights, bad);  // all other points have the same errors as before
}

double LowRankFit::worst() const {
  return errors_.empty() ? 0 : static_cast<double>(*std::max_element(errors_.begin(), errors_.end()));
}

}  // namespace chronormal::inline internal
