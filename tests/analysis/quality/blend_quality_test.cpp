#include "analysis/quality/blend_quality.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <set>
#include <vector>

#include "tests/support/blend_oracle.h"

namespace chronormal::blend_quality_test {
namespace {

BlendNormals normals_of(const BlendSet& set) { return BlendNormals::of_groups(set, test::vertices_of(set)); }

TEST(BlendQuality, random_weights_are_as_many_and_as_large_as_asked_for) {
  const BlendWeightOptions options{.targets = 12, .rows = 50, .active = 5, .low = -1, .high = 2, .seed = 3};
  const std::vector<double> weights = random_blend_weights(options);
  ASSERT_EQ(weights.size(), 12U * 50);
  EXPECT_EQ(weights, random_blend_weights(options));
  std::set<std::size_t> used;
  for (std::size_t row = 0; row < 50; ++row) {
    std::size_t active = 0;
    for (std::size_t k = 0; k < 12; ++k) {
      const double w = weights[12 * row + k];
      EXPECT_TRUE(w >= -1 && w < 2);
      if (w == 0) continue;
      ++active;
      used.insert(k);
    }
    EXPECT_EQ(active, 5U);
  }
  EXPECT_EQ(used.size(), 12U);
  const std::vector<double> all = random_blend_weights({.targets = 4, .rows = 3});
  EXPECT_EQ(std::count(all.begin(), all.end(), 0.0), 0);
  EXPECT_TRUE(random_blend_weights({}).empty());
}

TEST(BlendQuality, endpoint_deltas_are_right_for_each_target_alone_at_weight_1_and_wrong_together) {
  const BlendSet set = test::random_blend_set(4, {.targets = 3, .reach = 0.8});
  BlendNormals normals = normals_of(set);
  const DeltaNormals ends = endpoint_deltas(normals);
  const Quality alone = delta_quality(ends, normals, std::vector<double>{1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  EXPECT_GT(alone.count, 0U);
  EXPECT_LT(alone.max, 1e-6);
  const Quality together = delta_quality(ends, normals, std::vector<double>{1, 1, 1});
  EXPECT_GT(together.max, 0.01);
}

TEST(BlendQuality, errors_are_the_angles_to_blended_positions_over_what_turns) {
  const BlendSet set = test::random_blend_set(5, {.targets = 4, .reach = 0.6});
  const NormalGroups groups = test::vertices_of(set);
  BlendNormals normals = normals_of(set);
  const DeltaNormals ends = endpoint_deltas(normals);
  const std::vector<double> weights = random_blend_weights({.targets = 4, .rows = 3, .active = 2});
  const Quality quality = delta_quality(ends, normals, weights);
  double sum = 0, largest = 0;
  std::size_t count = 0;
  const auto real = [](const reference::Vector& n) { return reference::normalised(n); };
  const auto at = [&](std::vector<double> w) { return test::real_normals(set, &groups, w); };
  const auto base = at({0, 0, 0, 0});
  for (std::size_t row = 0; row < 3; ++row) {
    const std::vector<double> w(weights.begin() + static_cast<std::ptrdiff_t>(4 * row),
                                weights.begin() + static_cast<std::ptrdiff_t>(4 * row + 4));
    const auto exact = at(w);
    const std::vector<bool> touched = test::touched_elements(set, &groups, w);
    for (std::size_t e = 0; e < exact.size(); ++e) {
      if (!touched[e]) continue;
      reference::Vector shown = real(base[e]);
      for (std::size_t k = 0; k < 4; ++k) {
        std::vector<double> one(4);
        one[k] = 1;
        const auto end = real(at(one)[e]);
        shown =
            reference::add(shown, reference::scaled(reference::Real(w[k]), reference::subtract(end, real(base[e]))));
      }
      const auto error = static_cast<double>(reference::angle(shown, exact[e]));
      sum += error;
      largest = std::max(largest, error);
      ++count;
    }
  }
  EXPECT_EQ(quality.count, count);
  EXPECT_NEAR(quality.sum, sum, 1e-6 * static_cast<double>(count));
  EXPECT_NEAR(quality.max, largest, 1e-6);
}

// Returns the sum that best_deltas() minimises: the squared distances between the exact and the blended normals of all
// elements, in all poses. Each row of `weights` is a pose.
double squares(const DeltaNormals& deltas, BlendNormals& normals, const std::vector<double>& weights) {
  const std::size_t targets = deltas.deltas.size();
  double sum = 0;
  for (std::size_t row = 0; row * targets < weights.size(); ++row) {
    const std::span<const double> w = std::span(weights).subspan(row * targets, targets);
    std::vector<float> exact(3 * normals.size());
    (void)normals.unit_normals(w, VectorView<float>::packed(exact.data(), normals.size()));
    std::vector<double> shown(deltas.base.begin(), deltas.base.end());
    for (std::size_t k = 0; k < targets; ++k) {
      for (std::size_t n = 0; n < deltas.deltas[k].vertices.size(); ++n)
        for (std::size_t c = 0; c < 3; ++c)
          shown[3 * deltas.deltas[k].vertices[n] + c] += w[k] * static_cast<double>(deltas.deltas[k].deltas[3 * n + c]);
    }
    for (std::size_t i = 0; i < shown.size(); ++i) sum += std::pow(shown[i] - static_cast<double>(exact[i]), 2);
  }
  return sum;
}

TEST(BlendQuality, best_deltas_cannot_be_improved_by_changing_any_of_them) {
  const BlendSet set = test::random_blend_set(6, {.cells = 4, .targets = 4, .reach = 0.9});
  BlendNormals normals = normals_of(set);
  const std::vector<double> weights = random_blend_weights({.targets = 4, .rows = 30, .active = 3});
  DeltaNormals best = best_deltas(normals, weights);
  const double smallest = squares(best, normals, weights);
  EXPECT_LT(smallest, 0.8 * squares(endpoint_deltas(normals), normals, weights));
  for (BlendTarget& target : best.deltas) {
    for (float& d : target.deltas) {
      for (const float step : {-1e-2F, 1e-2F}) {
        const float before = d;
        d += step;
        EXPECT_GT(squares(best, normals, weights), smallest);
        d = before;
      }
    }
  }
  EXPECT_LT(delta_quality(best, normals, weights).rms(),
            delta_quality(endpoint_deltas(normals), normals, weights).rms());
}

TEST(BlendQuality, rows_that_tell_nothing_leave_the_endpoint_deltas) {
  const BlendSet set = test::random_blend_set(6, {.targets = 3, .reach = 0.9});
  BlendNormals normals = normals_of(set);
  const DeltaNormals ends = endpoint_deltas(normals);
  for (const std::vector<double>& weights : {std::vector<double>{}, std::vector<double>(6)}) {
    const DeltaNormals best = best_deltas(normals, weights);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(best.deltas[k].deltas, ends.deltas[k].deltas);
  }
  // If there is a single pose, deltas can give the exact normals of all elements. Every delta must be finite.
  const std::vector<double> one = {0.5, 1, 0};
  const DeltaNormals best = best_deltas(normals, one);
  EXPECT_LT(delta_quality(best, normals, one).max, 1e-4);
  EXPECT_EQ(best.deltas[2].deltas, ends.deltas[2].deltas);
}

TEST(BlendQuality, sets_without_targets_have_nothing_to_measure) {
  BlendSet set = test::random_blend_set(6, {.targets = 0});
  BlendNormals normals = normals_of(set);
  EXPECT_EQ(delta_quality(best_deltas(normals, {}), normals, {}).count, 0U);
}

}  // namespace
}  // namespace chronormal::blend_quality_test
