// Stores deltas as dense rows for groups of outputs, and multiplies the deltas by the weights of several moments at
// once.
#include "workflow/audit/stored_sums.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "analysis/fits/kernels/products.h"
#include "analysis/quality/kernels/shown_angles.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kGroupsPerTask = 16;

}  // namespace

StoredSums::StoredSums(const GltfShading& shading, std::span<const JudgedOutput> outputs,
                       std::vector<std::size_t> involved, const Viewer& viewer)
    : shading_(shading),
      outputs_(outputs),
      involved_(std::move(involved)),
      viewer_(viewer),
      stride_(3 * kGroup * block_count(outputs.size(), kGroup)) {}

void StoredSums::make_groups() {
  if (viewer_.normals != NormalRule::kSum) {
    kept_normals_.resize(outputs_.size());
    parallel_each(outputs_.size(), kGroup * kGroupsPerTask,
                  [&](std::size_t i) { kept_normals_[i] = kept_normal(viewer_, stored(i)); });
  }
  groups_.resize(block_count(outputs_.size(), kGroup));
  parallel_each(groups_.size(), kGroupsPerTask, [&](std::size_t g) {
    Group& group = groups_[g];
    const std::size_t first = g * kGroup, count = std::min(kGroup, outputs_.size() - first);
    for (std::size_t k = 0; k < involved_.size(); ++k) {
      const std::vector<float>& all = shading_.normal_deltas[involved_[k]];
      if (all.empty()) continue;
      std::array<float, 3 * kGroup> row{};
      for (std::size_t i = 0; i < count; ++i)
        std::copy_n(all.data() + 3 * std::size_t{outputs_[first + i].vertex}, 3, row.data() + 3 * i);
      if (std::all_of(row.begin(), row.end(), [](float d) { return d == 0; })) continue;
      for (std::size_t i = 0; i < count; ++i) {
        const Vec3f delta = vector_at(row, i);
        if (delta == Vec3f{}) continue;
        const Vec3f kept_one = kept_delta(viewer_, stored(first + i), kept(first + i), delta);
        row[3 * i] = kept_one.x, row[3 * i + 1] = kept_one.y, row[3 * i + 2] = kept_one.z;
      }
      group.targets.push_back(static_cast<std::uint32_t>(k));
      group.deltas.insert(group.deltas.end(), row.begin(), row.end());
    }
  });
}

void StoredSums::add_up(std::vector<std::vector<double>> sets) {
  if (groups_.empty()) make_groups();
  sets_ = std::move(sets);
  sums_.resize(sets_.size() * stride_);
  std::vector<float> by_target(involved_.size() * sets_.size());
  std::vector<bool> is_finite(sets_.size(), true);
  for (std::size_t k = 0; k < involved_.size(); ++k) {
    if (shading_.normal_deltas[involved_[k]].empty()) continue;
    for (std::size_t s = 0; s < sets_.size(); ++s) {
      const auto weight = static_cast<float>(sets_[s][k]);
      if (std::isfinite(weight))
        by_target[k * sets_.size() + s] = weight;
      else
        is_finite[s] = false;
    }
  }
  parallel_each(groups_.size(), kGroupsPerTask, [&](std::size_t g) { add_group(g, by_target); });
  for (std::size_t s = 0; s < sets_.size(); ++s)
    if (!is_finite[s]) std::fill_n(sums_.data() + s * stride_, stride_, std::numeric_limits<float>::quiet_NaN());
}

// Adds up the normals and weighted deltas of group g. by_target has the weights as an array (targets, sets of weights).
void StoredSums::add_group(std::size_t g, std::span<const float> by_target) {
  const Group& group = groups_[g];
  const std::size_t sets = sets_.size(), first = g * kGroup, count = std::min(kGroup, outputs_.size() - first);
  float* const sums = sums_.data() + 3 * first;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f term = first_of_sum(viewer_, kept(first + i));
    sums[3 * i] = term.x, sums[3 * i + 1] = term.y, sums[3 * i + 2] = term.z;
  }
  for (std::size_t s = 1; s < sets; ++s) std::copy_n(sums, 3 * count, sums + s * stride_);

  const auto is_active = [&](std::uint32_t k) {
    const std::span<const float> weights = by_target.subspan(k * sets, sets);
    return std::any_of(weights.begin(), weights.end(), [](float weight) { return weight != 0; });
  };
  std::vector<float> weights;  // weights of a range of targets, (targets, sets)
  for (std::size_t row = 0; row < group.targets.size();) {
    weights.clear();
    std::size_t end = row;
    for (; end < group.targets.size() && is_active(group.targets[end]); ++end) {
      const std::span<const float> of_target = by_target.subspan(group.targets[end] * sets, sets);
      weights.insert(weights.end(), of_target.begin(), of_target.end());
    }
    const float* const deltas = group.deltas.data() + row * 3 * kGroup;
    add_products({weights.data(), end - row, sets, sets, 1}, {deltas, end - row, 3 * kGroup, 3 * kGroup, 1}, sums,
                 stride_);
    row = end + 1;
  }
}

Vec3f StoredSums::stored(std::size_t output) const { return vector_at(shading_.normals, outputs_[output].vertex); }

Vec3f StoredSums::kept(std::size_t output) const {
  return kept_normals_.empty() ? stored(output) : kept_normals_[output];
}

void StoredSums::shown(std::span<const float> sums, std::size_t first, std::span<Vec3d> normals) const {
  for (std::size_t k = 0; k < normals.size(); ++k)
    normals[k] = to_double(vector_of_sum(viewer_, kept(first + k), vector_at(sums, first + k)));
  make_rounded_units(normals);
}

std::span<const float> StoredSums::find(const std::vector<double>& weights) const noexcept {
  const auto found = std::find(sets_.begin(), sets_.end(), weights);
  if (found == sets_.end()) return {};
  return std::span(sums_).subspan(static_cast<std::size_t>(found - sets_.begin()) * stride_, 3 * outputs_.size());
}

}  // namespace chronormal::inline internal
