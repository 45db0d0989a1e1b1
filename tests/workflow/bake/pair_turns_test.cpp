// Tests the search for the largest angle by which a pair of targets turns a normal. The search evaluates only a few
// elements and poses. The test compares the result with an evaluation of all elements in all poses.
#include "workflow/bake/deltas/pair_turns.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/bake_fixture.h"

namespace chronormal::pair_turns_test {
namespace {

constexpr std::size_t kTargets = 4;

// Hills that morph, with all objects that a PairMeter refers to.
class Field {
 public:
  explicit Field(unsigned seed)
      : file_(test::still_hills_document(kTargets, seed)),
        shading_(read_gltf_shading(*file_, 0).value()),
        truth_(shading_, Weighting::kArea),
        terms_(shading_, truth_),
        is_shown_(shading_.groups.size(), true),
        largest_(shading_.groups.size(), 0.0) {
    std::mt19937 random(seed);
    for (int p = 0; p < 30; ++p) {
      std::vector<double>& pose = poses_.emplace_back();
      for (std::size_t i = 0; i < kTargets; ++i)
        pose.push_back(random() % 3 == 0 ? 0.0 : std::uniform_real_distribution<double>(-0.5, 1)(random));
    }
    for (std::size_t i = 0; i < kTargets; ++i)
      for (std::size_t j = i; j < kTargets; ++j) pairs_.emplace_back(i, j);
  }

  [[nodiscard]] PairMeter meter() { return {shading_, terms_, poses_, is_shown_, largest_}; }
  [[nodiscard]] const std::vector<PairMeter::Pair>& pairs() const { return pairs_; }
  [[nodiscard]] const PoseList& poses() const { return poses_; }
  [[nodiscard]] std::vector<Vec3d> normals(const std::vector<double>& pose) const {
    return normals_from_positions(shading_, pose);
  }
  // Returns how much the normals with both targets at weight 1 differ from the sum of the effects of each target alone.
  // If i equals j, returns the part that is quadratic in the weight of the target.
  [[nodiscard]] std::vector<Vec3d> term(std::size_t i, std::size_t j) const {
    std::vector<double> none(kTargets, 0.0), a = none, b = none, both = none;
    a[i] += 1;
    b[j] += i == j ? -1 : 1;
    both[i] += 1;
    both[j] += 1;
    const std::vector<Vec3d> n = normals(none), n_a = normals(a), n_b = normals(b), n_both = normals(both);
    std::vector<Vec3d> result;
    for (std::size_t e = 0; e < n.size(); ++e)
      result.push_back(i == j ? 0.5 * (n_a[e] + n_b[e] - 2.0 * n[e]) : n_both[e] - n_a[e] - n_b[e] + n[e]);
    return result;
  }

 private:
  test::GltfFixture file_;
  GltfShading shading_;
  AuthorTruth truth_;
  NormalTerms terms_;
  std::vector<bool> is_shown_;
  std::vector<double> largest_;
  PoseList poses_;
  std::vector<PairMeter::Pair> pairs_;
};

// Returns the weight of the correction target of a pair of targets i and j: w_i w_j, or w_i (w_i - 1) if i equals j.
double weight_of(const PairMeter::Pair& pair, const std::vector<double>& pose) {
  const auto [i, j] = pair;
  return i == j ? pose[i] * (pose[i] - 1) : pose[i] * pose[j];
}

TEST(PairTurns, the_largest_turn_and_the_gain_are_those_of_a_look_at_all_elements_in_all_poses) {
  for (unsigned seed = 1; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    Field field(seed);
    const std::vector<MeasuredPair> measured = field.meter().measure(field.pairs());
    ASSERT_EQ(measured.size(), field.pairs().size());
    for (std::size_t k = 0; k < measured.size(); ++k) {
      const auto [i, j] = field.pairs()[k];
      const std::vector<Vec3d> term = field.term(i, j);
      double turn = 0, aside = 0, size = 0;
      for (const std::vector<double>& pose : field.poses()) {
        const std::vector<Vec3d> normals = field.normals(pose);
        for (std::size_t e = 0; e < normals.size(); ++e) {
          turn = std::max(turn, angle_between(normals[e], normals[e] - weight_of({i, j}, pose) * term[e]));
          size = std::max(size, length(term[e]) / length(normals[e]));
          aside = std::max(aside, length(cross(unit(normals[e]), term[e])) / length(normals[e]));
        }
      }
      EXPECT_EQ(measured[k].extra.i, i);
      EXPECT_EQ(measured[k].extra.j, j);
      EXPECT_NEAR(measured[k].size, size, 1e-6 * size);
      EXPECT_NEAR(measured[k].extra.gain, 1.02 * aside + 1e-3 * size, 1e-6 * size);
      // The search returns pi for angles of 90 degrees and more.
      EXPECT_NEAR(measured[k].turn, turn < 1.57 ? turn : 3.141592653589793, 1e-6);
    }
  }
}

TEST(PairTurns, without_several_pairs_the_turn_is_that_of_their_sum) {
  for (unsigned seed = 1; seed < 12; ++seed) {
    SCOPED_TRACE(seed);
    Field field(seed);
    PairMeter meter = field.meter();
    std::vector<ExtraWeight> extras;
    std::vector<PairMeter::Pair> left_out;
    for (const MeasuredPair& pair : meter.measure(field.pairs())) {
      if ((pair.extra.i + pair.extra.j + seed) % 3 == 0) continue;
      extras.push_back(pair.extra);
      left_out.emplace_back(pair.extra.i, pair.extra.j);
    }
    double turn = 0;
    for (const std::vector<double>& pose : field.poses()) {
      const std::vector<Vec3d> normals = field.normals(pose);
      std::vector<Vec3d> without = normals;
      for (const PairMeter::Pair& pair : left_out) {
        const std::vector<Vec3d> term = field.term(pair.first, pair.second);
        for (std::size_t e = 0; e < term.size(); ++e) without[e] = without[e] - weight_of(pair, pose) * term[e];
      }
      for (std::size_t e = 0; e < normals.size(); ++e) turn = std::max(turn, angle_between(normals[e], without[e]));
    }
    EXPECT_NEAR(meter.turn_without(extras), turn < 1.57 ? turn : 3.141592653589793, 1e-6);
  }
}

}  // namespace
}  // namespace chronormal::pair_turns_test
