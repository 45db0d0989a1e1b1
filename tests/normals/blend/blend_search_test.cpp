// Searches for the worst cases of BlendNormals: sets and weights whose errors come as close as possible to the
// guaranteed 1e-6 radians, on every path of the computation (BlendPath). Errors are computed in rational numbers.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iostream>
#include <limits>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "normals/blend/blend_normals.h"
#include "tests/support/blend_oracle.h"
#include "tests/support/exact_normal.h"
#include "tests/support/fixtures.h"

namespace chronormal::blend_search_test {
namespace {

constexpr double kPromised = 1e-6;  // in radians, the guaranteed largest error

// A case that the search tries: a face with 3 or 4 corners (or, if is_ring, the faces around vertex 0), with three
// targets and their weights.
struct Candidate {
  BlendSet set;
  std::vector<double> weights;
  bool is_ring = false;
};

// Returns the error of the face, or of vertex 0 of a ring, divided by the guaranteed error. Returns 0 if nothing is
// guaranteed or there is no normal. On the path that adds up terms, also returns 0 if the element is computed from
// positions instead.
double used_up(const Candidate& candidate, BlendPath path) {
  const BlendNormalsOptions options{std::numeric_limits<std::size_t>::max(), path};
  const Topology& topology = candidate.set.topology;
  const NormalGroups groups = NormalGroups::of_vertices(topology, separate_points(topology.vertex_count()));
  BlendNormals normals = candidate.is_ring ? BlendNormals::of_groups(candidate.set, groups, options)
                                           : BlendNormals::of_faces(candidate.set, options);
  const std::size_t count = candidate.is_ring ? groups.size() : 1;
  std::vector<float> u(3 * count);
  const BlendEvaluation done = normals.unit_normals(candidate.weights, VectorView<float>::packed(u.data(), count));
  if (done.uncertain_elements + done.zeros > 0) return 0;
  if (path == BlendPath::kTerms && done.recomputed_elements > 0) return 0;
  const exact::Vector expected =
      test::exact_normals(candidate.set, candidate.is_ring ? &groups : nullptr, candidate.weights).front();
  return exact::is_zero(expected) ? 4 / kPromised : exact::angle(u[0], u[1], u[2], expected) / kPromised;
}

// Makes a face that nearly collapses: the first target moves the last corner almost onto the line through two other
// corners. In some cases, all corners also move far away and back.
Candidate near_a_collapse(fixtures::Random& random) {
  Candidate result;
  const auto corners = static_cast<std::uint32_t>(3 + random.below(2));
  result.set.topology =
      corners == 3 ? fixtures::make_triangles(3, {0, 1, 2}) : fixtures::make_polygons(4, {0, 4}, {0, 1, 3, 2});
  const auto push = [&](std::vector<float>& to, double size) {
    for (const double c : random.in_cube(size)) to.push_back(static_cast<float>(c));
  };
  for (std::uint32_t v = 0; v < corners; ++v) push(result.set.base, 1);
  const float* const p = result.set.base.data();
  BlendTarget fold{"", {2}, {}};
  const double along = random.uniform(0, 1);
  for (std::size_t k = 0; k < 3; ++k)
    fold.deltas.push_back(static_cast<float>(p[k] + along * (double{p[3 + k]} - double{p[k]}) - double{p[6 + k]}));
  result.set.targets.push_back(fold);
  for (int target = 0; target < 2; ++target) {
    BlendTarget& other = result.set.targets.emplace_back();
    for (std::uint32_t v = 0; v < corners; ++v) {
      if (random.below(3) == 0) continue;
      other.vertices.push_back(v);
      push(other.deltas, std::ldexp(1, static_cast<int>(random.below(12)) - 8));
    }
    result.weights.push_back(random.uniform(-1, 1));
  }
  result.weights.insert(result.weights.begin(),
                        1 - std::ldexp(random.uniform(-1, 1), -static_cast<int>(random.below(34))));
  return result;
}

// Makes 4 to 8 triangles around vertex 0 whose normals nearly cancel. The first target moves their outline almost onto
// a line, so the outline has nearly no area, although the triangles have.
Candidate ring_near_a_collapse(fixtures::Random& random) {
  Candidate result;
  result.is_ring = true;
  const auto ring = static_cast<std::uint32_t>(4 + random.below(5));
  std::vector<std::uint32_t> corners;
  for (std::uint32_t k = 0; k < ring; ++k)
    for (const std::uint32_t v : {0U, 1 + k, 1 + (k + 1) % ring}) corners.push_back(v);
  result.set.topology = fixtures::make_triangles(ring + 1, corners);
  const auto push = [&](std::vector<float>& to, double size) {
    for (const double c : random.in_cube(size)) to.push_back(static_cast<float>(c));
  };
  for (std::uint32_t v = 0; v <= ring; ++v) push(result.set.base, 1);
  const std::vector<float>& base = result.set.base;
  const auto from = random.in_cube(1), way = random.in_cube(1);
  BlendTarget& fold = result.set.targets.emplace_back();
  for (std::uint32_t v = 1; v <= ring; ++v) {
    fold.vertices.push_back(v);
    const double along = random.uniform(-1, 1);
    for (std::size_t k = 0; k < 3; ++k)
      fold.deltas.push_back(static_cast<float>(from[k] + along * way[k] - double{base[3 * v + k]}));
  }
  result.weights.push_back(1 - std::ldexp(random.uniform(-1, 1), -static_cast<int>(random.below(30))));
  for (int target = 0; target < 2; ++target) {
    BlendTarget& other = result.set.targets.emplace_back();
    for (std::uint32_t v = 0; v <= ring; ++v) {
      if (random.below(3) == 0) continue;
      other.vertices.push_back(v);
      push(other.deltas, std::ldexp(1, static_cast<int>(random.below(12)) - 8));
    }
    result.weights.push_back(random.uniform(-1, 1) * std::ldexp(1, -static_cast<int>(random.below(20))));
  }
  return result;
}

Candidate changed(Candidate candidate, fixtures::Random& random) {
  const double step = std::ldexp(random.uniform(-1, 1), -static_cast<int>(random.below(40)));
  const auto nudge = [step](float& x) { x = static_cast<float>(double{x} + step * (1 + std::fabs(double{x}))); };
  switch (random.below(4)) {
    case 0:
      nudge(candidate.set.base[random.below(candidate.set.base.size())]);
      break;
    case 1: {
      BlendTarget& target = candidate.set.targets[random.below(3)];
      if (!target.deltas.empty()) nudge(target.deltas[random.below(target.deltas.size())]);
      break;
    }
    default: {
      double& weight = candidate.weights[random.below(3)];
      weight += step * (1 + std::fabs(weight));
    }
  }
  return candidate;
}

// Returns the largest error, divided by the guaranteed error, that hill climbing from several starts finds.
template <class Start>
double worst_found(const Start& start_at, int starts, int steps, BlendPath path) {
  fixtures::Random random(79);
  double worst = 0;
  for (int start = 0; start < starts; ++start) {
    Candidate best = start_at(random);
    double share = used_up(best, path);
    for (int tries = 0; tries < 200 && share == 0; ++tries) {
      best = start_at(random);
      share = used_up(best, path);
    }
    for (int step = 0; step < steps; ++step) {
      Candidate candidate = changed(best, random);
      const double other = used_up(candidate, path);
      if (other < share) continue;
      share = other;
      best = std::move(candidate);
    }
    worst = std::max(worst, share);
  }
  return worst;
}

// Returns the share of the guaranteed error that the search must at least find, since a search that finds only small
// errors proves nothing. On the path BlendPath::kTerms, errors are larger, because terms are stored in float32. On the
// path by positions, only the result is rounded to float32.
double least_of_a_search(BlendPath path) { return path == BlendPath::kTerms ? 0.3 : 0.04; }

TEST(BlendNormals, keep_the_promise_in_the_worst_cases_that_a_search_finds) {
  for (const BlendPath path : {BlendPath::kTerms, BlendPath::kWhole}) {
    const double worst = worst_found(near_a_collapse, 12, 600, path);
    std::cout << "  " << test::name_of(path) << ": " << worst << " of the promise\n";
    EXPECT_LE(worst, 1) << test::name_of(path);
    EXPECT_GT(worst, least_of_a_search(path)) << test::name_of(path);
  }
}

TEST(BlendNormals, keep_the_promise_at_vertices_whose_faces_nearly_cancel) {
  for (const BlendPath path : {BlendPath::kTerms, BlendPath::kWhole}) {
    const double worst = worst_found(ring_near_a_collapse, 8, 300, path);
    std::cout << "  rings, " << test::name_of(path) << ": " << worst << " of the promise\n";
    EXPECT_LE(worst, 1) << test::name_of(path);
    EXPECT_GT(worst, 0.04) << test::name_of(path);
  }
}

}  // namespace
}  // namespace chronormal::blend_search_test
