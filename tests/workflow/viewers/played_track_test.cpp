// Compares the weights that viewers play from tracks with plain loops, which follow the sources of the viewers.
#include "workflow/viewers/played_track.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "tests/support/viewer_oracle.h"

namespace chronormal::played_track_test {
namespace {

constexpr unsigned kSeed = 18;
constexpr std::size_t kTargets = 2;

struct Track {
  GltfInterpolation interpolation = GltfInterpolation::kLinear;
  std::vector<float> times, values;

  [[nodiscard]] GltfKeys keys() const { return {{times.begin(), times.end()}, {values.begin(), values.end()}}; }
};

Viewer viewer_named(std::string_view name) { return find_viewers(name).value().at(0); }

Track random_track(GltfInterpolation interpolation, std::mt19937& random) {
  std::uniform_real_distribution<float> gap(0.02F, 0.4F), value(-0.4F, 1.4F);
  Track track{interpolation, {random() % 2 == 0 ? 0.0F : gap(random)}, {}};
  for (std::size_t key = random() % 9; key > 0; --key) track.times.push_back(track.times.back() + gap(random));
  const std::size_t numbers = interpolation == GltfInterpolation::kCubicSpline ? 3 : 1;
  for (std::size_t i = 0; i < track.times.size() * numbers * kTargets; ++i) track.values.push_back(value(random));
  return track;
}

std::vector<double> played(const Viewer& viewer, const Track& track, const TimeRange& range, double time) {
  std::vector<double> weights(kTargets);
  PlayedTrack(viewer, track.keys(), track.interpolation, kTargets, range).at(time, false, weights);
  return weights;
}

TEST(PlayedTrack, every_viewer_plays_what_its_source_says) {
  std::mt19937 random(kSeed);
  for (const Viewer& viewer : kViewers) {
    for (int round = 0; round < 60; ++round) {
      constexpr GltfInterpolation kAll[] = {GltfInterpolation::kLinear, GltfInterpolation::kStep,
                                            GltfInterpolation::kCubicSpline};
      const Track track = random_track(kAll[round % 3], random);
      const double first = track.times.front(), last = track.times.back();
      // The animation may begin earlier and end later than this track, because of other tracks.
      const TimeRange range{round % 2 == 0 ? first : first / 2, round % 4 < 2 ? last : last + 0.1};
      for (int i = 0; i < 20; ++i) {
        const double time = std::uniform_real_distribution<double>(0, last + 0.2)(random);
        std::vector<double> expected = test::played_by(viewer.name, track.interpolation, track.times, track.values,
                                                       kTargets, range.first, range.last, time);
        for (double& w : expected)
          if (std::fabs(w) <= viewer.least_weight) w = 0;
        const std::vector<double> weights = played(viewer, track, range, time);
        for (std::size_t k = 0; k < kTargets; ++k)
          EXPECT_NEAR(weights[k], expected[k], 1e-9)
              << viewer.name << " at " << time << ", round " << round << ", seed " << kSeed;
      }
    }
  }
}

TEST(PlayedTrack, says_whether_it_is_as_specified) {
  const Track linear{GltfInterpolation::kLinear, {0, 1}, {0, 0, 1, 1}};
  const Track spline{GltfInterpolation::kCubicSpline, {0, 1}, {0, 0, 0, 0, 0, 0, 0, 0, 1, 1, 0, 0}};
  const auto as_specified = [](const char* viewer, const Track& track) {
    return PlayedTrack(viewer_named(viewer), track.keys(), track.interpolation, kTargets, {0, 1}).is_as_specified();
  };
  EXPECT_TRUE(as_specified("three", spline));
  EXPECT_TRUE(as_specified("filament", linear));
  EXPECT_FALSE(as_specified("filament", spline));
  EXPECT_TRUE(as_specified("godot", linear));
  EXPECT_FALSE(as_specified("godot", spline));
  EXPECT_FALSE(as_specified("playcanvas", spline));
  EXPECT_TRUE(as_specified("playcanvas", linear));
  EXPECT_FALSE(as_specified("gltfpack", linear));
}

TEST(PlayedTrack, filament_multiplies_tangents_by_the_part_that_has_gone_by) {
  // The weight goes from 0 to 0 within an eighth of a second, and its slope at the first key is 3 per second. By the
  // specification, the weight in the middle is the slope times the length of the interval, divided by eight. Filament
  // uses 1/2, the elapsed share, in place of the length.
  const Track track{GltfInterpolation::kCubicSpline, {0, 0.125F}, {0, 0, 0, 0, 3, 3, 0, 0, 0, 0, 0, 0}};
  EXPECT_NEAR(played(viewer_named("three"), track, {0, 0.125}, 0.0625)[0], 3 * 0.125 / 8, 1e-12);
  EXPECT_NEAR(played(viewer_named("filament"), track, {0, 0.125}, 0.0625)[0], 3.0 / 8 / 2, 1e-12);
}

TEST(PlayedTrack, playcanvas_has_no_weights_where_a_spline_has_two_keys) {
  const Track track{GltfInterpolation::kCubicSpline, {0, 1}, {0, 0, 1, 1, 0, 0, 0, 0, 1, 1, 0, 0}};
  EXPECT_EQ(played(viewer_named("three"), track, {0, 1}, 0.5), (std::vector<double>{1, 1}));
  EXPECT_EQ(played(viewer_named("playcanvas"), track, {0, 1}, 0.5), (std::vector<double>{0, 0}));
}

TEST(PlayedTrack, gltfpack_has_no_weights_below_zero_or_above_one) {
  const Track track{GltfInterpolation::kLinear, {0, 1}, {-0.5F, 1.5F, -0.5F, 1.5F}};
  EXPECT_EQ(played(viewer_named("gltfpack"), track, {0, 1}, 0.4), (std::vector<double>{0, 1}));
}

TEST(PlayedTrack, a_jump_has_two_sides) {
  const Track track{GltfInterpolation::kStep, {0, 1}, {0.25F, 0, 1, 0}};
  for (const char* name : {"three", "gltfpack"}) {
    const PlayedTrack curve(viewer_named(name), track.keys(), track.interpolation, kTargets, {0, 1});
    std::vector<double> before(kTargets), after(kTargets);
    curve.at(1, true, before);
    curve.at(1, false, after);
    EXPECT_NEAR(before[0], 0.25, 0.002) << name;
    EXPECT_EQ(after[0], 1) << name;
  }
}

TEST(PlayedTrack, a_long_track_is_not_sampled_beforehand) {
  const Track track{GltfInterpolation::kLinear, {0, 1e30F}, {0, 0, 1, 1}};
  EXPECT_NEAR(played(viewer_named("gltfpack"), track, {0, 1e30}, 5e29)[0], 0.5, 0.01);
}

}  // namespace
}  // namespace chronormal::played_track_test
