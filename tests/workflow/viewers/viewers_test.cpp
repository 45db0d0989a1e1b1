// Compares the normals that viewers store and render with plain loops, which follow the formulas in the sources of the
// viewers.
#include "chronormal/workflow/viewers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iostream>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "tests/support/viewer_oracle.h"

namespace chronormal::viewers_test {
namespace {

using test::Triple;

constexpr unsigned kSeed = 18;
constexpr double kDegrees = 57.29577951308232;

Viewer viewer_named(std::string_view name) { return find_viewers(name).value().at(0); }

Vec3f to_vec(const Triple& v) { return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])}; }

// Draws numbers that float32 represents, as in a file.
Triple random_vector(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> number(-size, size);
  const auto draw = [&] { return static_cast<double>(static_cast<float>(number(random))); };
  return {draw(), draw(), draw()};
}

Triple random_unit(std::mt19937& random) {
  Triple u = test::scaled_to_one(random_vector(random, 1));
  for (double& c : u) c = static_cast<double>(static_cast<float>(c));
  return u;
}

Triple shown_of(const Viewer& viewer, const Triple& normal, const std::vector<Triple>& deltas,
                std::vector<double> weights) {
  drop_weights(viewer, weights);
  const Vec3f kept = kept_normal(viewer, to_vec(normal));
  Vec3f sum = first_of_sum(viewer, kept);
  for (std::size_t k = 0; k < deltas.size(); ++k)
    sum = sum + static_cast<float>(weights[k]) * kept_delta(viewer, to_vec(normal), to_vec(deltas[k]));
  const Vec3f shown = shown_of_sum(viewer, kept, sum);
  return {static_cast<double>(shown.x), static_cast<double>(shown.y), static_cast<double>(shown.z)};
}

double degrees_between(const Triple& a, const Triple& b) {
  return angle_between(Vec3d{a[0], a[1], a[2]}, Vec3d{b[0], b[1], b[2]}) * kDegrees;
}

TEST(Viewers, each_has_a_name_of_its_own_a_title_and_a_source) {
  std::set<std::string_view> names, titles;
  for (const Viewer& viewer : kViewers) {
    names.insert(viewer.name);
    titles.insert(viewer.title);
    EXPECT_FALSE(viewer.source.empty()) << viewer.name;
    EXPECT_EQ(viewer.most_targets > 0, !viewer.beyond.empty()) << viewer.name;
  }
  EXPECT_EQ(names.size(), kViewers.size());
  EXPECT_EQ(titles.size(), kViewers.size());
  EXPECT_EQ(names.count("all") + names.count(""), 0U);
}

TEST(Viewers, lists_are_in_the_order_asked_for_each_viewer_once) {
  const Result<std::vector<Viewer>> viewers = find_viewers("godot,three,godot");
  ASSERT_TRUE(viewers);
  ASSERT_EQ(viewers.value().size(), 2U);
  EXPECT_EQ(viewers.value()[0].title, "Godot 4");
  EXPECT_EQ(viewers.value()[1].title, "three.js");
  ASSERT_TRUE(find_viewers("all"));
  // "all" selects the viewers that render a file unchanged. Programs that compress files must be named.
  EXPECT_EQ(find_viewers("all").value().size(), 6U);
  const Result<std::vector<Viewer>> and_others = find_viewers("all,three,gltfpack,quantize,meshopt");
  ASSERT_TRUE(and_others);
  EXPECT_TRUE(std::equal(kViewers.begin(), kViewers.end(), and_others.value().begin(), and_others.value().end()));
}

TEST(Viewers, names_and_titles_may_have_upper_case_and_blanks_around_them) {
  constexpr std::uint32_t kCaseSeed = 20261128;
  std::cout << "seed " << kCaseSeed << '\n';
  std::mt19937 random(kCaseSeed);
  for (const Viewer& viewer : kViewers) {
    for (int round = 0; round < 20; ++round) {
      std::string name(random() % 2 == 0 ? viewer.name : viewer.title);
      for (char& c : name)
        if (random() % 2 == 0 && c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
      const std::string list = std::string(random() % 3, ' ') + name + std::string(random() % 3, ' ') + ", three";
      const Result<std::vector<Viewer>> found = find_viewers(list);
      ASSERT_TRUE(found) << list;
      EXPECT_EQ(found.value()[0].name, viewer.name) << list;
      EXPECT_EQ(found.value().size(), viewer.name == "three" ? 1U : 2U) << list;
    }
  }
  EXPECT_EQ(find_viewers("ALL").value().size(), find_viewers("all").value().size());
}

TEST(Viewers, an_unknown_name_is_told_all_names_and_the_nearest) {
  for (const char* wrong : {"gdot", "three,gdot", "gdot,three"}) {
    const Result<std::vector<Viewer>> viewers = find_viewers(wrong);
    ASSERT_FALSE(viewers) << wrong;
    EXPECT_EQ(viewers.error().code, ErrorCode::kUsage);
    EXPECT_EQ(viewers.error().message,
              "there is no viewer 'gdot'; did you mean godot? Choose from three, babylon, playcanvas, godot, filament, "
              "bevy, gltfpack, quantize, meshopt, and all");
  }
  EXPECT_NE(find_viewers("gotod").error().message.find("did you mean godot?"), std::string::npos);
  EXPECT_NE(find_viewers("GDOT").error().message.find("'GDOT'; did you mean godot?"), std::string::npos);
  for (const char* wrong : {"", " ", ",", "three,", "Three.js 187", "unreal"}) {
    const Result<std::vector<Viewer>> viewers = find_viewers(wrong);
    ASSERT_FALSE(viewers) << wrong;
    EXPECT_EQ(viewers.error().message.find("did you mean"), std::string::npos) << wrong;
  }
}

TEST(Viewers, each_shows_what_the_formulas_of_its_source_say) {
  std::mt19937 random(kSeed);
  for (const Viewer& viewer : kViewers) {
    double worst = 0;
    for (int round = 0; round < 400; ++round) {
      const Triple normal = round % 4 == 0 ? random_vector(random, 1.2) : random_unit(random);
      std::vector<Triple> deltas;
      std::vector<double> weights;
      for (std::size_t k = random() % 4 + 1; k > 0; --k) {
        deltas.push_back(random_vector(random, round % 3 == 0 ? 2.5 : 0.8));
        weights.push_back(std::uniform_real_distribution<double>(-0.5, 1.5)(random));
      }
      const Triple expected = test::shown_by(viewer.name, normal, deltas, weights);
      // If the terms of a sum nearly cancel, the direction of the sum is only rounding error, so such sums are skipped.
      Triple plain = normal;
      for (std::size_t k = 0; k < deltas.size(); ++k)
        for (std::size_t c = 0; c < 3; ++c) plain[c] += weights[k] * deltas[k][c];
      if (std::fabs(plain[0]) + std::fabs(plain[1]) + std::fabs(plain[2]) < 0.05) continue;
      worst = std::max(worst, degrees_between(shown_of(viewer, normal, deltas, weights), expected));
    }
    // In float32, a component that is halfway between two representable numbers may be rounded up or down, but this is
    // rare.
    EXPECT_LT(worst, viewer.keeps_halves() ? 0.2 : 0.02) << viewer.name << ", seed " << kSeed;
  }
}

TEST(Viewers, targets_of_unit_length_look_alike_everywhere) {
  std::mt19937 random(kSeed);
  for (int round = 0; round < 200; ++round) {
    const Triple normal = random_unit(random), first = random_unit(random);
    Triple delta{};
    for (std::size_t c = 0; c < 3; ++c) delta[c] = first[c] - normal[c];
    if (std::any_of(delta.begin(), delta.end(), [](double d) { return std::fabs(d) > 1; })) continue;
    const double weight = std::uniform_real_distribution<double>(0, 1)(random);
    Triple sum{};
    for (std::size_t c = 0; c < 3; ++c) sum[c] = normal[c] + weight * delta[c];
    const double length = std::sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
    for (const Viewer& viewer : kViewers) {
      const double step = viewer.normals == NormalRule::kClamped ? 1.2 : 0.07;  // largest rounding error, in degrees
      EXPECT_LT(degrees_between(shown_of(viewer, normal, {delta}, {weight}), sum), step / length) << viewer.name;
    }
  }
}

TEST(Viewers, a_long_delta_turns_by_its_direction_alone_where_unit_normals_are_kept) {
  // N + D is (3, 0, 3). At weight 1/2, the result has the direction of (0.35, 0, 0.85) if the viewer stores unit
  // normals, and of (1.5, 0, 2) by the specification.
  const Triple normal = {0, 0, 1}, delta = {3, 0, 2};
  EXPECT_NEAR(degrees_between(shown_of(viewer_named("godot"), normal, {delta}, {0.5}), normal), 22.5, 1e-2);
  EXPECT_NEAR(degrees_between(shown_of(viewer_named("three"), normal, {delta}, {0.5}), normal), 36.8699, 1e-4);
  // gltfpack clamps the components of N + D to 1, which gives (1, 0, 1), so the result at weight 1/2 has the direction
  // of (0.5, 0, 1.5).
  EXPECT_NEAR(degrees_between(shown_of(viewer_named("gltfpack"), normal, {delta}, {0.5}), normal), 18.4349, 1e-4);
}

TEST(Viewers, filament_does_not_keep_the_direction_of_a_long_normal) {
  // Filament 1.53.4 renders the normals that this test expects, up to the rounding of colours to eight bits. For N + D
  // = (0, 0, 3), Filament makes the frame (0, -3, -8), (24, 0, 0), which is not a rotation.
  const Vec3f along = kept_normal(viewer_named("filament"), {0, 0, 1});
  EXPECT_NEAR(along.z, 1, 1e-6);
  const Vec3f longer = kept_normal(viewer_named("filament"), {0.6F, 0, 2.4F});
  const Triple kept = test::through_filament({static_cast<double>(0.6F), 0, static_cast<double>(2.4F)});
  EXPECT_NEAR(longer.x, kept[0], 1e-4);
  EXPECT_NEAR(longer.y, kept[1], 1e-4);
  EXPECT_NEAR(longer.z, kept[2], 1e-4);
  EXPECT_GT(
      degrees_between({static_cast<double>(longer.x), static_cast<double>(longer.y), static_cast<double>(longer.z)},
                      {0.6, 0, 2.4}),
      10);
}

TEST(Viewers, keep_components_as_their_tools_write_them) {
  // The first two lines expect the values that glTF Transform 4.5 and gltfpack 1.3 write.
  EXPECT_EQ(kept_delta(viewer_named("quantize"), {}, {0.3F, -0.3F, 7}), (Vec3f{9811 / 32767.0F, -9811 / 32767.0F, 1}));
  EXPECT_EQ(kept_delta(viewer_named("gltfpack"), {}, {0.3F, -0.3F, -7}), (Vec3f{38 / 127.0F, -38 / 127.0F, -1}));
  EXPECT_EQ(kept_delta(viewer_named("playcanvas"), {}, {0.1F, 1e-9F, 1e6F}), (Vec3f{0.0999755859375F, 0, INFINITY}));
}

TEST(Viewers, zero_stays_zero) {
  for (const Viewer& viewer : kViewers) {
    EXPECT_EQ(kept_normal(viewer, {}), Vec3f{}) << viewer.name;
    EXPECT_EQ(kept_delta(viewer, {}, {}), Vec3f{}) << viewer.name;
    EXPECT_EQ(shown_of_sum(viewer, {}, {}), Vec3f{}) << viewer.name;
    EXPECT_EQ(kept_delta(viewer, {0, 0, 1}, {}), Vec3f{}) << viewer.name;
  }
}

TEST(Viewers, what_is_not_finite_does_not_become_a_normal_in_a_viewer_that_adds_floats) {
  EXPECT_TRUE(std::isnan(shown_of_sum(viewer_named("three"), {0, 0, 1}, {NAN, 0, 1}).x));
}

TEST(Viewers, small_weights_and_targets_beyond_the_limit_are_left_out) {
  std::vector<double> weights(258, 0.5);
  weights[0] = 1e-4;
  weights[1] = -1e-4;
  weights[2] = 1.1e-4;
  std::vector<double> of_godot = weights, of_filament = weights, of_three = weights;
  drop_weights(viewer_named("godot"), of_godot);
  drop_weights(viewer_named("filament"), of_filament);
  drop_weights(viewer_named("three"), of_three);
  EXPECT_EQ(of_three, weights);
  EXPECT_EQ(of_godot[0], 0);
  EXPECT_EQ(of_godot[1], 0);
  EXPECT_EQ(of_godot[2], 1.1e-4);
  EXPECT_EQ(of_godot[257], 0.5);
  EXPECT_EQ(of_filament[0], 1e-4);
  EXPECT_EQ(of_filament[255], 0.5);
  EXPECT_EQ(of_filament[256], 0);
  EXPECT_EQ(of_filament[257], 0);
}

}  // namespace
}  // namespace chronormal::viewers_test
