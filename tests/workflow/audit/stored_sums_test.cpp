// Checks that the sums of stored normals for several sets of weights equal, bit for bit, the sums that a viewer
// computes vertex by vertex.
#include "workflow/audit/stored_sums.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

namespace chronormal::stored_sums_test {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Fixture {
  GltfShading shading;
  std::vector<JudgedOutput> outputs;
};

// Makes stored normals. Every third vertex has a zero normal. Target 0 turns the normals of all vertices, target 1 of
// no vertex, target 2 of the last vertex, target 3 of some vertices in the middle, and target 5 of every second vertex.
// Target 4 has no normals.
Fixture make_fixture(std::size_t vertices, std::mt19937& random) {
  std::uniform_real_distribution<float> number(-1, 1);
  Fixture result;
  for (std::size_t i = 0; i < 3 * vertices; ++i) result.shading.normals.push_back(number(random));
  const auto is_turned = [vertices](std::size_t target, std::size_t v) {
    switch (target) {
      case 0:
        return true;
      case 2:
        return v + 1 == vertices;
      case 3:
        return v >= vertices / 3 && v < vertices / 2;
      case 5:
        return v % 2 == 0;
      default:
        return false;
    }
  };
  for (std::size_t k = 0; k < 6; ++k) {
    std::vector<float>& deltas = result.shading.normal_deltas.emplace_back();
    if (k != 4) deltas.resize(3 * vertices);
    for (std::size_t i = 0; i < deltas.size(); ++i)
      if (is_turned(k, i / 3)) deltas[i] = number(random);
  }
  for (std::uint32_t v = 0; v < vertices; ++v)
    if (v % 3 != 2) result.outputs.push_back({v, v, 0, 0});
  return result;
}

// Returns one component of N + sum w D, added up in float32 target by target.
float plain_sum(const GltfShading& shading, std::size_t i, const std::vector<double>& weights) {
  float sum = shading.normals[i];
  for (std::size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] == 0 || shading.normal_deltas[k].empty()) continue;
    sum += static_cast<float>(weights[k]) * shading.normal_deltas[k][i];
  }
  return sum;
}

TEST(StoredSums, are_those_that_a_viewer_makes_vertex_by_vertex) {
  constexpr unsigned kSeed = 20261125;
  SCOPED_TRACE(kSeed);
  std::mt19937 random(kSeed);
  std::uniform_real_distribution<double> weight(-2, 2);
  for (const std::size_t vertices : {1U, 95U, 96U, 97U, 3000U}) {
    const Fixture fixture = make_fixture(vertices, random);
    StoredSums sums(fixture.shading, fixture.outputs, {0, 1, 2, 3, 4, 5});
    for (std::size_t count = 1; count <= 5; ++count) {
      std::vector<std::vector<double>> sets(count, std::vector<double>(6));
      for (std::vector<double>& set : sets)
        for (double& w : set) w = random() % 3 == 0 ? 0 : weight(random);
      sums.add_up(sets);
      for (const std::vector<double>& set : sets) {
        const std::span<const float> found = sums.find(set);
        ASSERT_EQ(found.size(), 3 * fixture.outputs.size());
        for (std::size_t i = 0; i < found.size(); ++i) {
          const std::size_t component = 3 * std::size_t{fixture.outputs[i / 3].vertex} + i % 3;
          ASSERT_EQ(found[i], plain_sum(fixture.shading, component, set)) << vertices << " vertices, output " << i / 3;
        }
      }
    }
  }
}

TEST(StoredSums, know_only_what_was_added_up_last) {
  std::mt19937 random(1);
  const Fixture fixture = make_fixture(10, random);
  StoredSums sums(fixture.shading, fixture.outputs, {0, 1, 2, 3, 4, 5});
  const std::vector<double> before(6, 0.5), after(6, 0.25);
  EXPECT_TRUE(sums.find(before).empty());
  sums.add_up({before});
  EXPECT_FALSE(sums.find(before).empty());
  sums.add_up({after});
  EXPECT_TRUE(sums.find(before).empty());
  EXPECT_FALSE(sums.find(after).empty());
}

TEST(StoredSums, are_not_numbers_where_a_weight_is_beyond_float32) {
  std::mt19937 random(2);
  const Fixture fixture = make_fixture(200, random);
  StoredSums sums(fixture.shading, fixture.outputs, {0, 1, 2, 3, 4, 5});
  std::vector<double> plain(6, 0.5), infinite = plain, large = plain, without_deltas = plain;
  infinite[2] = kInfinity;
  large[5] = 1e39;
  without_deltas[4] = kInfinity;
  sums.add_up({plain, infinite, large, without_deltas});
  for (std::size_t i = 0; i < 3 * fixture.outputs.size(); ++i) {
    ASSERT_TRUE(std::isnan(sums.find(infinite)[i]));
    ASSERT_TRUE(std::isnan(sums.find(large)[i]));
    ASSERT_FALSE(std::isnan(sums.find(plain)[i]));
    ASSERT_EQ(sums.find(plain)[i], sums.find(without_deltas)[i]);
  }
}

TEST(StoredSums, leave_out_targets_that_are_not_involved) {
  std::mt19937 random(3);
  const Fixture fixture = make_fixture(200, random);
  StoredSums sums(fixture.shading, fixture.outputs, {0, 2, 3, 5});
  StoredSums of_all(fixture.shading, fixture.outputs, {0, 1, 2, 3, 4, 5});
  const std::vector<double> some = {0.5, 0.25, 2, -1}, all = {0.5, 0, 0.25, 2, 0, -1};
  sums.add_up({some});
  of_all.add_up({all});
  const std::span<const float> a = sums.find(some), b = of_all.find(all);
  EXPECT_EQ(std::vector<float>(a.begin(), a.end()), std::vector<float>(b.begin(), b.end()));
}

}  // namespace
}  // namespace chronormal::stored_sums_test
