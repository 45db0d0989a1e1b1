// Fits correction targets with weights that are quadratic in the mesh's own weights, to the poses of a rig.
#include "workflow/bake/fits/quadratic_fit.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "analysis/fits/kernels/products.h"
#include "analysis/fits/leading_vectors.h"
#include "core/blocks.h"
#include "core/cholesky.h"
#include "workflow/bake/deltas/unit_targets.h"

namespace chronormal::inline internal {
namespace {

constexpr unsigned kFitSeed = 101, kTermSeed = 102;
constexpr std::size_t kQuadraticBlock = 16;
constexpr std::size_t kMostRows = 400, kBytes = std::size_t{500} << 20, kFewestRows = 48;
constexpr std::size_t kQuadraticPoints = 8000;
// The largest number of weights and products of two weights from which the weight of a correction target is made. A fit
// with more weights and products would take too long.
constexpr std::size_t kMostFeatures = 20000;
constexpr std::size_t kPosesOfTerms = 4000;
// Angles as parts of the tolerance. An error below kPartOfNeed needs no correction. An entry of a delta is left out if
// this turns a normal by at most kPartOfEntry.
constexpr double kPartOfNeed = 0.05, kPartOfEntry = 0.01;
// The shortest length of a normal in the fit, relative to n(0). Shorter normals count as if they had this length,
// because they can hardly be fitted.
constexpr float kLeastCounted = 0.1F;
// The part of the root mean square of a correction target's weight that may be lost because terms are left out.
constexpr double kPartOfTerms = 0.02;
constexpr double kRidgeOfTerms = 1e-5, kLeastRidge = 1e-12;

PoseList poses_to_fit(const RigPoses& rig, std::span<const std::vector<double>> standing, std::size_t points) {
  const std::size_t room = kBytes / (6 * sizeof(float) * std::max<std::size_t>(1, points));
  const std::size_t most = std::clamp(room, kFewestRows, kMostRows);
  PoseList poses;
  const auto take = [&](const std::vector<double>& pose) {
    const bool is_rest = std::all_of(pose.begin(), pose.end(), [](double w) { return w == 0; });
    if (!is_rest && poses.size() < most / 2) poses.push_back(pose);
  };
  for (const std::vector<double>& pose : standing) take(pose);
  for (const std::vector<double>& pose : rig.given()) take(pose);
  const PoseList drawn = rig.sample(most - poses.size(), kFitSeed);
  poses.insert(poses.end(), drawn.begin(), drawn.end());
  return poses;
}

// Returns the points whose base normal is long enough to divide by.
std::vector<PointVertices> points_to_fit(const DeltaSource& source, const RightNormals& rights,
                                         std::span<const std::uint32_t> vertices) {
  const GltfShading& shading = source.shading;
  std::vector<PointVertices> points = points_of(rights, vertices, shading.element_of_vertex);
  const auto has_no_base = [&](const PointVertices& point) {
    const std::uint32_t element = shading.element_of_vertex[point.front()];
    return !VertexTerms::has_base(source.terms.base_of(element), source.plan.largest[element]);
  };
  points.erase(std::remove_if(points.begin(), points.end(), has_no_base), points.end());
  return points;
}

VertexColumns columns_of_points(std::span<const PointVertices> points, const std::vector<VertexVectors>& own) {
  std::vector<std::uint32_t> first;
  first.reserve(points.size());
  for (const PointVertices& point : points) first.push_back(point.front());
  std::vector<const VertexVectors*> columns;
  columns.reserve(own.size());
  for (const VertexVectors& column : own) columns.push_back(&column);
  return by_vertex(columns, first);
}

struct PointsOfElements {
  PointsOfElements(std::span<const PointVertices> points, const GltfShading& shading)
      : first(shading.groups.size() + 1, 0), points_(points.size()) {
    const auto element_of = [&](std::size_t p) { return shading.element_of_vertex[points[p].front()]; };
    for (std::size_t p = 0; p < points.size(); ++p) ++first[element_of(p) + 1];
    std::partial_sum(first.begin(), first.end(), first.begin());
    std::vector<std::size_t> next(first.begin(), first.end() - 1);
    for (std::size_t p = 0; p < points.size(); ++p) points_[next[element_of(p)]++] = p;
  }
  [[nodiscard]] std::span<const std::size_t> of(std::uint32_t element) const {
    return std::span(points_).subspan(first[element], first[element + 1] - first[element]);
  }

 private:
  std::vector<std::size_t> first, points_;
};

}  // namespace

QuadraticFit::QuadraticFit(const DeltaSource& source, const RightNormals& rights,
                           std::span<const std::uint32_t> vertices, const std::vector<VertexVectors>& own,
                           const RigPoses& rig, std::span<const std::vector<double>> standing, std::size_t most_extras,
                           double tolerance)
    : rights_(rights),
      tolerance_(tolerance),
      points_(points_to_fit(source, rights, vertices)),
      missing_(rights, points_, source.shading.element_of_vertex, columns_of_points(points_, own),
               poses_to_fit(rig, standing, points_.size())) {
  missing_.keep_beyond(kPartOfNeed * tolerance);
  std::vector<PointVertices> kept;
  for (std::size_t p = 0; p < missing_.points(); ++p) kept.push_back(std::move(points_[missing_.number(p)]));
  points_ = std::move(kept);
  find_features(source);
  extras_ = std::min({most_extras, features_.size(), missing_.rows()});
  if (points_.empty() || features_.size() > kMostFeatures) extras_ = 0;
  if (extras_ == 0) return;
  padded_ = padded_to(extras_);

  importance_.assign(points_.size(), 0.0F);
  const std::size_t rows = missing_.rows(), stride = missing_.stride();
  parallel_each(points_.size(), kQuadraticBlock, [&](std::size_t p) {
    const float *shown = missing_.shown(p), *lack = missing_.missing(p);
    double sum = 0;
    for (std::size_t r = 0; r < rows; ++r) {
      float square = 0;
      for (std::size_t c = 0; c < 3; ++c) {
        const float right = shown[c * stride + r] + lack[c * stride + r];
        square += right * right;
      }
      if (square > 0) sum += 1 / static_cast<double>(std::fmax(square, kLeastCounted * kLeastCounted));
    }
    importance_[p] = static_cast<float>(std::sqrt(sum / static_cast<double>(rows)));
  });
  project(source, columns_of_points(points_, own),
          directions(leading_vectors(
              missing_.inner_products(importance_, std::max<std::size_t>(1, missing_.points() / kQuadraticPoints)),
              rows, extras_)));
  leave_out_small(rig);
  evaluate();
}

void QuadraticFit::find_features(const DeltaSource& source) {
  std::vector<std::size_t> moving;
  for (std::size_t i = 0; i < source.shading.set.targets.size(); ++i)
    if (moves(source.shading, i)) moving.push_back(i);
  for (const std::size_t i : moving) features_.push_back({i, i, true});
  for (std::size_t a = 0; a < moving.size() && features_.size() <= kMostFeatures; ++a)
    for (std::size_t b = a; b < moving.size(); ++b)
      if (a == b || source.terms.overlap(moving[a], moving[b])) features_.push_back({moving[a], moving[b], false});
}

// Returns for each point its missing normals, multiplied by `vectors` (rows, extras) and summed over the rows (poses).
// The result has the shape (points, 3, padded).
std::vector<float> QuadraticFit::directions(std::span<const double> vectors) const {
  std::vector<float> columns(missing_.rows() * padded_, 0.0F), result(3 * padded_ * points_.size(), 0.0F);
  for (std::size_t r = 0; r < missing_.rows(); ++r)
    for (std::size_t k = 0; k < extras_; ++k) columns[r * padded_ + k] = static_cast<float>(vectors[r * extras_ + k]);
  parallel_blocks(points_.size(), kQuadraticBlock, [&](IndexRange points) {
    const StridedMatrix a{missing_.missing(points.first), missing_.rows(), 3 * points.count, 1, missing_.stride()};
    add_products(a, {columns.data(), missing_.rows(), padded_, padded_, 1}, result.data() + 3 * padded_ * points.first,
                 padded_);
  });
  return result;
}

// Computes the terms of the weights s_k of correction targets. For this purpose, writes each term of n(w) as a sum of
// the deltas E_k, by least squares over all points.
void QuadraticFit::project(const DeltaSource& source, const VertexColumns& own, std::span<const float> directions) {
  const GltfShading& shading = source.shading;
  std::vector<double> matrix(extras_ * extras_, 0.0);
  const auto direction = [&](std::size_t p, std::size_t k) {
    const float* const of = directions.data() + 3 * padded_ * p;
    return to_double(Vec3f{of[k], of[padded_ + k], of[2 * padded_ + k]});
  };
  std::vector<VertexTerms> turned;
  std::vector<double> shares;  // for each point, the factor by which its terms count
  for (std::size_t p = 0; p < points_.size(); ++p) {
    const std::uint32_t v = points_[p].front(), e = shading.element_of_vertex[v];
    const double square = static_cast<double>(importance_[p]) * static_cast<double>(importance_[p]);
    turned.emplace_back(source.terms.base_of(e), source.plan.largest[e], rights_.stored(v));
    shares.push_back(square / BaseNormal(rights_.stored(v)).length);
    for (std::size_t i = 0; i < extras_; ++i)
      for (std::size_t j = 0; j <= i; ++j) matrix[i * extras_ + j] += square * dot(direction(p, i), direction(p, j));
  }
  double trace = 0;
  for (std::size_t i = 0; i < extras_; ++i) trace += matrix[i * extras_ + i];
  const double ridge = std::fmax(kLeastRidge * trace, 1e-300);
  for (std::size_t i = 0; i < extras_; ++i) matrix[i * extras_ + i] += ridge;
  const Cholesky factors(std::move(matrix), extras_, ridge);

  const PointsOfElements points(points_, shading);
  terms_.assign(features_.size() * extras_, 0.0);
  parallel_for(features_.size(), [&](std::size_t f) {
    const auto& [i, j, is_linear] = features_[f];
    const NormalTerms::Term term = is_linear ? source.terms.linear_by_element(i) : source.terms.pair_by_element(i, j);
    std::vector<Vec3d> sums(extras_);
    for (const std::uint32_t e : is_linear ? source.terms.elements(i) : source.terms.elements(i, j)) {
      if (points.of(e).empty()) continue;
      Vec3d value;
      const bool has_term = term.find(e, value);
      for (const std::size_t p : points.of(e)) {
        Vec3d lack = has_term ? turned[p](value) : Vec3d{};
        if (is_linear) {
          for (const auto& [column, delta] : own.of(p))
            if (column == i) lack = lack - to_double(delta);
        }
        if (lack == Vec3d{}) continue;
        lack = shares[p] * lack;
        for (std::size_t k = 0; k < extras_; ++k) sums[k].x += dot(lack, direction(p, k));
      }
    }
    factors.solve(sums);
    for (std::size_t k = 0; k < extras_; ++k) terms_[f * extras_ + k] = sums[k].x;
  });
}

// Drops the smallest terms of each correction target's weight. The size of a term is measured in poses of the rig.
void QuadraticFit::leave_out_small(const RigPoses& rig) {
  std::vector<double> squares(features_.size(), 0.0);
  for (const std::vector<double>& pose : rig.sample(kPosesOfTerms, kTermSeed)) {
    for (std::size_t f = 0; f < features_.size(); ++f) {
      const double value = features_[f].at(pose);
      squares[f] += value * value;
    }
  }
  for (std::size_t k = 0; k < extras_; ++k) {
    const auto share = [&](std::size_t f) {
      const double term = terms_[f * extras_ + k];
      return term * term * squares[f];
    };
    std::vector<std::size_t> order(features_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return share(a) < share(b); });
    double all = 0, left = 0;
    for (const std::size_t f : order) all += share(f);
    for (std::size_t n = 0; n < order.size(); ++n) {
      left += share(order[n]);
      if (left > kPartOfTerms * kPartOfTerms * all && order.size() - n <= kMostTerms) break;
      terms_[order[n] * extras_ + k] = 0;
    }
  }
}

void QuadraticFit::evaluate() {
  weights_.assign(missing_.rows() * padded_, 0.0F);
  parallel_each(missing_.rows(), kQuadraticBlock, [&](std::size_t r) {
    std::vector<double> sums(extras_, 0.0);
    for (std::size_t f = 0; f < features_.size(); ++f) {
      const double value = features_[f].at(missing_.poses()[r]);
      if (value == 0) continue;
      for (std::size_t k = 0; k < extras_; ++k) sums[k] += value * terms_[f * extras_ + k];
    }
    for (std::size_t k = 0; k < extras_; ++k) weights_[r * padded_ + k] = static_cast<float>(sums[k]);
  });
}

QuadraticFit::Extras QuadraticFit::best(std::size_t count, bool keeps_lengths) const {
  const std::size_t rows = missing_.rows(), stride = missing_.stride();
  std::vector<float> largest(count, 0.0F);
  for (std::size_t r = 0; r < rows; ++r)
    for (std::size_t k = 0; k < count; ++k) largest[k] = std::fmax(largest[k], std::fabs(weights_[r * padded_ + k]));

  // Fits the deltas of each point by least squares. Rows in which the normal of the point is shorter count more.
  std::vector<Vec3f> deltas(points_.size() * count);
  const double least = kPartOfEntry * tolerance_ / kDegreesPerRadian;
  parallel_blocks(points_.size(), kQuadraticBlock, [&](IndexRange points) {
    std::vector<float> counted(rows * padded_), products(count * padded_), of_axes(3 * padded_), wanted(3 * stride);
    for (std::size_t p = points.first; p < points.first + points.count; ++p) {
      const float *shown = missing_.shown(p), *lack = missing_.missing(p);
      std::copy(lack, lack + 3 * stride, wanted.begin());
      float most = 0;  // the largest `share` of any row
      for (std::size_t r = 0; r < rows; ++r) {
        const Vec3f now = {shown[r], shown[stride + r], shown[2 * stride + r]};
        const Vec3f right = now + Vec3f{lack[r], lack[stride + r], lack[2 * stride + r]};
        float square = dot(right, right);
        if (!keeps_lengths && square > 0) {
          const float along = std::fmax(dot(now, right) / square, 0.0F);
          wanted[r] = along * right.x - now.x;
          wanted[stride + r] = along * right.y - now.y;
          wanted[2 * stride + r] = along * right.z - now.z;
          square = dot(now, now);
        }
        const float share = square > 0 ? 1 / std::fmax(square, kLeastCounted * kLeastCounted) : 0;
        most = std::fmax(most, share);
        for (std::size_t k = 0; k < padded_; ++k) counted[r * padded_ + k] = share * weights_[r * padded_ + k];
      }
      std::fill(products.begin(), products.end(), 0.0F);
      std::fill(of_axes.begin(), of_axes.end(), 0.0F);
      add_products({counted.data(), rows, count, padded_, 1}, {weights_.data(), rows, padded_, padded_, 1},
                   products.data(), padded_);
      add_products({wanted.data(), rows, 3, 1, stride}, {counted.data(), rows, padded_, padded_, 1}, of_axes.data(),
                   padded_);
      std::vector<double> matrix(count * count);
      double trace = 0;
      for (std::size_t i = 0; i < count; ++i) {
        for (std::size_t j = 0; j <= i; ++j) matrix[i * count + j] = static_cast<double>(products[i * padded_ + j]);
        trace += matrix[i * count + i];
      }
      const double ridge = std::fmax(kRidgeOfTerms * trace / static_cast<double>(count), 1e-300);
      std::vector<Vec3d> unknown(count);
      for (std::size_t k = 0; k < count; ++k) {
        matrix[k * count + k] += ridge;
        unknown[k] = to_double(Vec3f{of_axes[k], of_axes[padded_ + k], of_axes[2 * padded_ + k]});
      }
      Cholesky(std::move(matrix), count, ridge).solve(unknown);
      for (std::size_t k = 0; k < count; ++k) {
        const Vec3f delta = to_float(static_cast<double>(largest[k]) * unknown[k]);
        if (std::sqrt(static_cast<double>(most)) * length(to_double(delta)) > least) deltas[p * count + k] = delta;
      }
    }
  });

  struct Shown {
    std::uint32_t vertex;
    std::size_t point;
  };
  std::vector<Shown> all;
  for (std::size_t p = 0; p < points_.size(); ++p)
    for (const std::uint32_t v : points_[p]) all.push_back({v, p});
  std::sort(all.begin(), all.end(), [](const Shown& a, const Shown& b) { return a.vertex < b.vertex; });
  Extras result;
  for (std::size_t k = 0; k < count; ++k) {
    VertexVectors column;
    for (const auto& [vertex, p] : all) {
      const Vec3f delta = deltas[p * count + k];
      if (delta == Vec3f{}) continue;
      column.vertices.push_back(vertex);
      column.vectors.push_back(static_cast<float>(BaseNormal(rights_.stored(vertex)).length) * delta);
    }
    if (column.vertices.empty()) continue;
    GltfExtraTarget weight;
    for (std::size_t f = 0; f < features_.size(); ++f) {
      const auto& [i, j, is_linear] = features_[f];
      const double term = terms_[f * extras_ + k] / static_cast<double>(largest[k]);
      if (term == 0) continue;
      if (is_linear)
        weight.linear.push_back({i, term});
      else
        weight.quadratic.push_back({i, j, term});
    }
    result.weights.push_back(std::move(weight));
    result.vectors.push_back(std::move(column));
  }
  return result;
}

}  // namespace chronormal::inline internal
