#include "workflow/bake/write/tracks.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace chronormal::tracks_test {
namespace {

// Two keys, two targets: in-tangents, values, out-tangents of each.
WeightTrack bent_track() {
  return {GltfInterpolation::kCubicSpline, {{0, 1}, {0, 0, 0.1, 0.3, 1, -2, 2, 1, 0.9, 0.6, 0, 0}}, 2};
}

double stated_error(const std::vector<ExtraWeight>& extras) {
  return extended_track(bent_track(), extras, std::numeric_limits<double>::infinity()).error;
}

TEST(Tracks, errors_of_extra_weights_add_up) {
  // All of them may turn the same normal to the same side.
  const std::vector<ExtraWeight> extras = {{0, 0, 1, -1, 0.5}, {0, 1, 0, 1, 0.7}, {1, 1, 1, -1, 0.2}};
  double sum = 0;
  for (const ExtraWeight& extra : extras) {
    EXPECT_GT(stated_error({extra}), 1e-3);
    sum += stated_error({extra});
  }
  EXPECT_NEAR(stated_error(extras), sum, 1e-12);
}

TEST(Tracks, the_error_grows_with_how_much_a_weight_turns) {
  EXPECT_NEAR(stated_error({{0, 1, 0, 1, 3.0}}), 3 * stated_error({{0, 1, 0, 1, 1.0}}), 1e-12);
}

TEST(Tracks, pieces_that_are_cut_stay_within_the_tolerance) {
  const std::vector<ExtraWeight> extras = {{0, 0, 1, -1, 0.5}, {0, 1, 0, 1, 0.7}, {1, 1, 1, -1, 0.2}};
  const ExtendedTrack cut = extended_track(bent_track(), extras, 1e-4);
  EXPECT_GT(cut.keys, 2U);
  EXPECT_GT(cut.error, 0);
  EXPECT_LE(cut.error, 1e-4);
}

}  // namespace
}  // namespace chronormal::tracks_test
