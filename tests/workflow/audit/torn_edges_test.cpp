// Tests which edges count as torn. At a torn edge, the errors of its two vertices differ by more than a limit in
// degrees. Compares the audit with a count edge by edge, in which angles are computed in long double.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <set>
#include <utility>
#include <vector>

#include "chronormal/workflow/audit.h"
#include "tests/support/bake_fixture.h"
#include "tests/support/gltf_builder.h"

namespace chronormal::torn_edges_test {
namespace {

using Vector = std::array<long double, 3>;
using test::GltfBuilder;

Vector at(const std::vector<float>& values, std::size_t i) {
  return {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
}

Vector sum(const Vector& a, const Vector& b, long double factor = 1) {
  return {a[0] + factor * b[0], a[1] + factor * b[1], a[2] + factor * b[2]};
}

Vector scaled_to_one(const Vector& a) {
  const long double size = std::sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
  return {a[0] / size, a[1] / size, a[2] / size};
}

// Returns the area-weighted normals of hills, with one target at this weight.
std::vector<Vector> right_normals(const test::Hills& hills, const std::vector<float>& deltas, long double weight) {
  std::vector<Vector> result(hills.vertices(), Vector{});
  for (std::size_t f = 0; f < hills.corners.size(); f += 3) {
    std::array<Vector, 3> p;
    for (std::size_t c = 0; c < 3; ++c)
      p[c] = sum(at(hills.positions, hills.corners[f + c]), at(deltas, hills.corners[f + c]), weight);
    const Vector e = sum(p[1], p[0], -1), g = sum(p[2], p[0], -1);
    const Vector n = {e[1] * g[2] - e[2] * g[1], e[2] * g[0] - e[0] * g[2], e[0] * g[1] - e[1] * g[0]};
    for (std::size_t c = 0; c < 3; ++c) result[hills.corners[f + c]] = sum(result[hills.corners[f + c]], n);
  }
  for (Vector& n : result) n = scaled_to_one(n);
  return result;
}

TEST(TornEdges, are_those_over_which_errors_jump) {
  std::size_t torn = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    test::Hills hills(seed, 6);
    const std::vector<float> deltas = hills.deltas(0.7, 0.8), of_normals = hills.deltas(1, 0.5);
    const std::vector<Vector> base = right_normals(hills, deltas, 0);
    for (std::size_t i = 0; i < hills.normals.size(); ++i) hills.normals[i] = static_cast<float>(base[i / 3][i % 3]);
    GltfBuilder builder;
    GltfBuilder::Json primitive = hills.primitive(builder, {deltas});
    primitive["targets"][0]["NORMAL"] = builder.add_positions(of_normals);
    builder.add_node(builder.add_mesh(primitive));
    const test::GltfFixture file(builder);
    constexpr std::size_t kSamples = 9;
    const Audit found = audit(*file, {.samples = kSamples, .weighting = Weighting::kArea}).value();
    ASSERT_EQ(found.subjects.size(), 1U);

    std::set<std::pair<std::size_t, std::size_t>> edges;
    for (std::size_t f = 0; f < hills.corners.size(); f += 3)
      for (std::size_t c = 0; c < 3; ++c)
        edges.insert(std::minmax<std::size_t>(hills.corners[f + c], hills.corners[f + (c + 1) % 3]));
    std::array<std::size_t, 3> counts{};
    std::size_t most = 0;
    for (std::size_t s = 0; s < kSamples; ++s) {
      const long double weight = static_cast<long double>(s) / (kSamples - 1);
      const std::vector<Vector> right = right_normals(hills, deltas, weight);
      std::vector<Vector> off;
      for (std::size_t v = 0; v < hills.vertices(); ++v)
        off.push_back(sum(scaled_to_one(sum(at(hills.normals, v), at(of_normals, v), weight)), right[v], -1));
      std::size_t here = 0;
      for (const auto& [a, b] : edges) {
        const Vector jump = sum(off[a], off[b], -1);
        const long double half = std::sqrt(jump[0] * jump[0] + jump[1] * jump[1] + jump[2] * jump[2]) / 2;
        const long double degrees = 2 * std::asin(std::min(1.0L, half)) * 180 / std::acos(-1.0L);
        counts[0] += degrees > 10 ? 1U : 0U;
        counts[1] += degrees > 20 ? 1U : 0U;
        counts[2] += degrees > 40 ? 1U : 0U;
        here += degrees > 10 ? 1U : 0U;
      }
      most = std::max(most, here);
    }
    const MotionError& error = found.error;
    EXPECT_EQ(error.torn, counts);
    EXPECT_EQ(error.samples, kSamples);
    EXPECT_EQ(error.most_torn, most);
    EXPECT_DOUBLE_EQ(error.torn_edges(), static_cast<double>(counts[0]) / kSamples);
    EXPECT_TRUE(found.is_whole(most));
    EXPECT_FALSE(found.is_whole(most - 1));
    EXPECT_TRUE(AuditLimits{}.allow(found));
    EXPECT_FALSE((AuditLimits{.torn_edges = most - 1}).allow(found));
    torn += counts[2];
  }
  EXPECT_GT(torn, 100U);
}

TEST(TornEdges, of_facets_are_none) {
  test::Hills hills(3);
  GltfBuilder builder;
  builder.add_node(builder.add_mesh(hills.primitive(builder, {hills.deltas()})));
  const test::GltfFixture file(builder);
  EXPECT_EQ(audit(*file, {.rule = AuditRule::kFlat}).value().error.samples, 0U);
  EXPECT_GT(audit(*file, {}).value().error.samples, 0U);
}

}  // namespace
}  // namespace chronormal::torn_edges_test
