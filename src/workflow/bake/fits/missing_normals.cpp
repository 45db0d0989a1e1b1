// Computes the missing normals at the instants of a file.
#include "workflow/bake/fits/missing_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <utility>

#include "analysis/fits/kernels/products.h"
#include "chronormal/core/parallel.h"
#include "core/blocks.h"
#include "core/portable_math.h"
#include "workflow/bake/deltas/unit_targets.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kMissingBlock = 64;
constexpr std::size_t kPosesAtOnce = 16;    // the number of poses whose normals are in memory at a time
constexpr std::size_t kStridePadding = 16;  // the number of floats in the widest SIMD vector

// Returns a vector with the true direction that differs from `sum` only by a vector perpendicular to `base`. If such a
// vector would be too long, returns the true normal itself.
Vec3d reached_across(const Vec3d& base, const Vec3d& sum, const Vec3d& right) {
  constexpr double kLeastAlong = 0.2;
  const Vec3d u = unit(right);
  const double of_sum = dot(base, sum), of_right = dot(base, u);
  return of_sum > kLeastAlong && of_right > kLeastAlong ? (of_sum / of_right) * u : right;
}

}  // namespace

std::vector<PointVertices> points_of(const RightNormals& rights, std::span<const std::uint32_t> vertices,
                                     std::span<const std::uint32_t> element_of_vertex) {
  using Key = std::tuple<std::uint32_t, double, double, double, std::uint32_t>;
  std::vector<Key> keys;
  for (const std::uint32_t v : vertices) {
    const Vec3d stored = rights.stored(v);
    if (length(stored) >= BaseNormal::kShortest)
      keys.emplace_back(element_of_vertex[v], stored.x, stored.y, stored.z, v);
  }
  std::sort(keys.begin(), keys.end());
  std::vector<PointVertices> points;
  for (std::size_t n = 0; n < keys.size(); ++n) {
    const auto& [element, x, y, z, vertex] = keys[n];
    const bool is_new =
        n == 0 || std::tie(element, x, y, z) != std::tie(std::get<0>(keys[n - 1]), std::get<1>(keys[n - 1]),
                                                         std::get<2>(keys[n - 1]), std::get<3>(keys[n - 1]));
    if (is_new) points.emplace_back();
    points.back().push_back(vertex);
  }
  // Sorts points by their first vertex, so that points that are near each other in the file stay so in the list.
  std::sort(points.begin(), points.end());
  return points;
}

FileInstants::FileInstants(const MeshWeights& weights) {
  for (const WeightTrack& track : weights.tracks) {
    const CurveNodes& nodes = tracks.emplace_back(track);
    first.push_back(poses.size());
    for (std::size_t node = 0; node < nodes.size(); ++node) poses.push_back(nodes.pose(track, node));
  }
  first.push_back(poses.size());
  const auto stored = weights.poses.begin() + static_cast<std::ptrdiff_t>(weights.stored_poses);
  poses.insert(poses.end(), weights.poses.begin(), stored);
}

MissingNormals::MissingNormals(const RightNormals& rights, std::span<const PointVertices> points,
                               std::span<const std::uint32_t> element_of_vertex, const VertexColumns& own,
                               PoseList poses, bool across)
    : poses_(std::move(poses)),
      stride_((poses_.size() + kStridePadding - 1) / kStridePadding * kStridePadding),
      numbers_(points.size()),
      shown_(points.size() * 3 * stride_),
      missing_(points.size() * 3 * stride_) {
  for (std::size_t p = 0; p < points.size(); ++p) numbers_[p] = p;
  for (std::size_t first = 0; first < poses_.size(); first += kPosesAtOnce) {
    const std::size_t count = std::min(kPosesAtOnce, poses_.size() - first);
    std::vector<std::vector<Vec3d>> normals(count);
    parallel_for(count, [&](std::size_t r) {
      normals[r] = rights.of_elements(std::span(poses_[first + r]).first(rights.targets()));
    });
    // The weights of own targets, one column for each target, so that a loop adds a delta in all poses at once.
    std::vector<std::array<double, kPosesAtOnce>> weights(rights.targets());
    for (std::size_t r = 0; r < count; ++r)
      for (std::size_t c = 0; c < weights.size(); ++c) weights[c][r] = poses_[first + r][c];
    parallel_each(points.size(), kMissingBlock, [&](std::size_t p) {
      const std::uint32_t vertex = points[p].front();
      const BaseNormal base(rights.stored(vertex));
      std::array<double, kPosesAtOnce> x, y, z;
      x.fill(base.direction.x), y.fill(base.direction.y), z.fill(base.direction.z);
      for (const auto& [column, single] : own.of(p)) {
        const Vec3d delta = to_double(single);
        for (std::size_t r = 0; r < kPosesAtOnce; ++r) {
          const double weight = weights[column][r] / base.length;
          x[r] += weight * delta.x, y[r] += weight * delta.y, z[r] += weight * delta.z;
        }
      }
      float* const shown = shown_.data() + 3 * stride_ * p + first;
      float* const missing = missing_.data() + 3 * stride_ * p + first;
      for (std::size_t r = 0; r < count; ++r) {
        const Vec3d right = rights.of_vertex(vertex, normals[r][element_of_vertex[vertex]]);
        if (right == Vec3d{}) continue;
        const Vec3d sum = {x[r], y[r], z[r]};
        const Vec3d goal = across ? reached_across(base.direction, sum, right) : right;
        const Vec3f of_shown = to_float(sum), of_missing = to_float(goal - sum);
        shown[r] = of_shown.x, shown[stride_ + r] = of_shown.y, shown[2 * stride_ + r] = of_shown.z;
        missing[r] = of_missing.x, missing[stride_ + r] = of_missing.y, missing[2 * stride_ + r] = of_missing.z;
      }
    });
  }
}

std::vector<double> MissingNormals::inner_products(std::span<const float> importance, std::size_t step) const {
  constexpr std::size_t kPoints = 16, kParts = 32, kColumnsAtOnce = 64;
  const std::size_t rows = this->rows(), sampled = (points() + step - 1) / step;
  std::vector<std::vector<double>> of_parts(kParts);  // sums over parts of the points; each sum is a whole matrix
  parallel_for(kParts, [&](std::size_t part) {
    std::vector<double>& sum = of_parts[part];
    sum.assign(rows * stride_, 0.0);
    std::vector<float> scaled(3 * kPoints * stride_), products(rows * stride_);
    const std::size_t end = sampled * (part + 1) / kParts;
    for (std::size_t first = sampled * part / kParts; first < end; first += kPoints) {
      const std::size_t count = std::min(kPoints, end - first);
      for (std::size_t n = 0; n < count; ++n) {
        const std::size_t point = (first + n) * step;
        const float* const lack = missing(point);
        for (std::size_t c = 0; c < 3 * stride_; ++c) scaled[3 * stride_ * n + c] = importance[point] * lack[c];
      }
      std::fill(products.begin(), products.end(), 0.0F);
      // Computes only half of the matrix, because the product of rows i and j equals that of rows j and i.
      for (std::size_t i = 0; i < rows; i += kColumnsAtOnce) {
        const StridedMatrix a{scaled.data() + i, 3 * count, std::min(kColumnsAtOnce, rows - i), stride_, 1};
        const StridedMatrix b{scaled.data() + i, 3 * count, stride_ - i, stride_, 1};
        add_products(a, b, products.data() + i * stride_ + i, stride_);
      }
      for (std::size_t n = 0; n < sum.size(); ++n) sum[n] += static_cast<double>(products[n]);
    }
  });
  std::vector<double> result(rows * rows, 0.0);
  for (const std::vector<double>& sum : of_parts) {
    for (std::size_t i = 0; i < rows; ++i)
      for (std::size_t j = i; j < rows; ++j) result[i * rows + j] += sum[i * stride_ + j];
  }
  for (std::size_t i = 0; i < rows; ++i)
    for (std::size_t j = 0; j < i; ++j) result[i * rows + j] = result[j * rows + i];
  return result;
}

void MissingNormals::show_more(std::size_t point, std::span<const float> more) {
  const std::size_t first = 3 * stride_ * point;
  for (std::size_t n = 0; n < more.size(); ++n) {
    shown_[first + n] += more[n];
    missing_[first + n] -= more[n];
  }
}

void MissingNormals::keep_beyond(double degrees) {
  std::vector<char> is_kept(points(), 0);
  const double sine = portable::sin(degrees / kDegreesPerRadian);
  const auto most = static_cast<float>(degrees < 90 ? sine * sine : 2 - sine * sine);
  parallel_each(points(), kMissingBlock, [&](std::size_t p) {
    const float *s = shown(p), *m = missing(p);
    for (std::size_t r = 0; r < rows() && is_kept[p] == 0; ++r) {
      const Vec3f now = {s[r], s[stride_ + r], s[2 * stride_ + r]};
      const Vec3f lack = {m[r], m[stride_ + r], m[2 * stride_ + r]};
      if (openness(now, now + lack) > most) is_kept[p] = 1;
    }
  });
  const std::size_t size = 3 * stride_;
  std::size_t kept = 0;
  for (std::size_t p = 0; p < is_kept.size(); ++p) {
    if (is_kept[p] == 0) continue;
    for (std::vector<float>* floats : {&shown_, &missing_}) {
      const auto from = floats->begin() + static_cast<std::ptrdiff_t>(size * p);
      if (kept < p)
        std::copy(from, from + static_cast<std::ptrdiff_t>(size),
                  floats->begin() + static_cast<std::ptrdiff_t>(size * kept));
    }
    numbers_[kept++] = numbers_[p];
  }
  numbers_.resize(kept);
  shown_.resize(size * kept);
  missing_.resize(size * kept);
}

double degrees_of(float openness) noexcept {
  const double square = static_cast<double>(openness > 1 ? 2 - openness : openness);
  const double angle = portable::atan2(std::sqrt(square), std::sqrt(1 - square)) * kDegreesPerRadian;
  return openness > 1 ? 180 - angle : angle;
}

}  // namespace chronormal::inline internal
