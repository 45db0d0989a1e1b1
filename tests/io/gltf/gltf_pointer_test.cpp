// Tests KHR_animation_pointer with pointers to single weights. All channels of a node together must form one track,
// like a channel that animates all weights.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "tests/support/gltf_builder.h"

namespace chronormal::gltf_pointer_test {
namespace {

using test::GltfBuilder, test::GltfFixture;

const std::vector<float> kTimes = {0, 1, 3};

// Adds a channel that animates a single weight, which the JSON pointer `pointer` names.
void add_pointer(GltfBuilder& builder, const std::string& pointer, const std::vector<float>& times,
                 const std::vector<float>& values, const char* interpolation = "LINEAR") {
  builder.add_track(0, 0, times, values, interpolation);
  builder.json["animations"][0]["channels"].back()["target"] = {
      {"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
  builder.json["extensionsUsed"] = {"KHR_animation_pointer"};
}

GltfBuilder document() {
  GltfBuilder builder = test::quad_document();
  builder.add_animation("move");
  return builder;
}

// Returns the error of reading a document and its first track, or "" if there is no error.
std::string error_of(const GltfBuilder& builder) {
  const GltfFixture file(builder);
  if (!file.ok()) return file.error();
  const Result<GltfKeys> keys = file->keys(0, 0);
  return keys ? "" : keys.error().text();
}

TEST(GltfPointers, channels_of_single_weights_are_the_track_that_one_channel_of_all_weights_is) {
  struct Case {
    const char* interpolation;
    std::vector<float> of_first, of_second, of_both;
  };
  for (const auto& [interpolation, of_first, of_second, of_both] :
       {Case{"LINEAR", {0, 1, 2}, {3, 4, 5}, {0, 3, 1, 4, 2, 5}},
        Case{"STEP", {0, 1, 2}, {3, 4, 5}, {0, 3, 1, 4, 2, 5}},
        Case{"CUBICSPLINE",
             {0, 1, 2, 3, 4, 5, 6, 7, 8},
             {10, 11, 12, 13, 14, 15, 16, 17, 18},
             {0, 10, 1, 11, 2, 12, 3, 13, 4, 14, 5, 15, 6, 16, 7, 17, 8, 18}}}) {
    for (const std::string list : {"/nodes/0", "/meshes/0"}) {
      GltfBuilder whole = document(), single = document();
      whole.add_track(0, 0, kTimes, of_both, interpolation);
      add_pointer(single, list + "/weights/1", kTimes, of_second, interpolation);
      add_pointer(single, list + "/weights/0", kTimes, of_first, interpolation);
      const GltfFixture one(whole), other(single);
      ASSERT_TRUE(one.ok() && other.ok()) << other.error();
      ASSERT_EQ(other->animations()[0].tracks.size(), 1U);
      const GltfTrack& track = other->animations()[0].tracks[0];
      EXPECT_TRUE(track.is_assembled);
      EXPECT_EQ(track.interpolation, one->animations()[0].tracks[0].interpolation);
      EXPECT_EQ(track.key_count, kTimes.size());
      const Result<GltfKeys> expected = one->keys(0, 0), found = other->keys(0, 0);
      ASSERT_TRUE(expected && found) << found.error().text();
      EXPECT_EQ(found.value().times, expected.value().times);
      EXPECT_EQ(found.value().values, expected.value().values) << interpolation;
    }
  }
}

TEST(GltfPointers, a_weight_without_a_channel_stays_at_rest) {
  GltfBuilder builder = document();
  builder.json["nodes"][0]["weights"] = {0.25, 0.75};
  add_pointer(builder, "/nodes/0/weights/0", kTimes, {1, 2, 3});
  EXPECT_EQ(GltfFixture(builder)->keys(0, 0).value().values, (std::vector<double>{1, 0.75, 2, 0.75, 3, 0.75}));
  GltfBuilder cubic = document();
  cubic.json["meshes"][0]["weights"] = {0.25, 0.75};
  add_pointer(cubic, "/meshes/0/weights/1", {0, 1}, {1, 2, 3, 4, 5, 6}, "CUBICSPLINE");
  EXPECT_EQ(GltfFixture(cubic)->keys(0, 0).value().values,
            (std::vector<double>{0, 1, 0.25, 2, 0, 3, 0, 4, 0.25, 5, 0, 6}));
}

TEST(GltfPointers, a_weight_of_a_mesh_is_that_of_each_node_without_weights_of_its_own) {
  GltfBuilder builder = document();
  builder.add_node(0);
  builder.json["nodes"][builder.add_node(0)]["weights"] = {0.5, 0.5};
  add_pointer(builder, "/meshes/0/weights/1", kTimes, {1, 2, 3});
  const GltfFixture file(builder);
  ASSERT_TRUE(file.ok()) << file.error();
  const std::vector<GltfTrack>& tracks = file->animations()[0].tracks;
  ASSERT_EQ(tracks.size(), 2U);
  EXPECT_EQ(tracks[1].node, 1U);
  EXPECT_EQ(tracks[1].same_keys_as, 0U);
}

// Returns the value of a channel at a time, by the formulas in appendix C of the glTF specification.
double weight_at(const std::vector<float>& times, const std::vector<float>& values, const std::string& interpolation,
                 double time) {
  const bool is_cubic = interpolation == "CUBICSPLINE";
  const auto value = [&](std::size_t k) { return static_cast<double>(values[is_cubic ? 3 * k + 1 : k]); };
  const auto at = [&](std::size_t k) { return static_cast<double>(times[k]); };
  if (time <= at(0)) return value(0);
  if (time >= at(times.size() - 1)) return value(times.size() - 1);
  std::size_t k = 0;
  while (at(k + 1) <= time) ++k;
  const double length = at(k + 1) - at(k), t = (time - at(k)) / length;
  if (interpolation == "STEP") return value(k);
  if (interpolation == "LINEAR") return (1 - t) * value(k) + t * value(k + 1);
  const double out = static_cast<double>(values[3 * k + 2]), in = static_cast<double>(values[3 * k + 3]);
  return (2 * t * t * t - 3 * t * t + 1) * value(k) + length * (t * t * t - 2 * t * t + t) * out +
         (-2 * t * t * t + 3 * t * t) * value(k + 1) + length * (t * t * t - t * t) * in;
}

TEST(GltfPointers, channels_with_keys_of_their_own_take_the_course_that_each_takes_alone) {
  struct Channel {
    const char* interpolation;
    std::vector<float> times, values;
  };
  struct Case {
    Channel first, second;
    const char* together;
    std::vector<double> times;
  };
  const Channel line{"LINEAR", {0, 1, 3}, {0, 4, 1}}, late_line{"LINEAR", {0.5F, 2, 4}, {3, -1, 2}};
  const Channel step{"STEP", {0, 1, 3}, {0, 4, 1}}, late_step{"STEP", {0.5F, 2}, {3, -1}};
  const Channel cubic{"CUBICSPLINE", {1, 2, 5}, {7, 1, 2, -3, 2, 5, 4, -2, 9}};
  const Channel early_cubic{"CUBICSPLINE", {0, 4}, {1, 2, 3, 4, 5, 6}}, single{"LINEAR", {2.5F}, {6}};
  const std::vector<Case> cases = {
      {line, late_line, "LINEAR", {0, 0.5, 1, 2, 3, 4}},       {step, late_step, "STEP", {0, 0.5, 1, 2, 3}},
      {cubic, early_cubic, "CUBICSPLINE", {0, 1, 2, 4, 5}},    {line, cubic, "CUBICSPLINE", {0, 1, 2, 3, 5}},
      {early_cubic, late_line, "CUBICSPLINE", {0, 0.5, 2, 4}}, {single, line, "LINEAR", {0, 1, 2.5, 3}},
      {single, cubic, "CUBICSPLINE", {1, 2, 2.5, 5}}};
  for (std::size_t c = 0; c < cases.size(); ++c) {
    const auto& [first, second, together, times] = cases[c];
    GltfBuilder builder = document();
    add_pointer(builder, "/nodes/0/weights/0", first.times, first.values, first.interpolation);
    add_pointer(builder, "/nodes/0/weights/1", second.times, second.values, second.interpolation);
    const GltfFixture file(builder);
    ASSERT_TRUE(file.ok()) << file.error();
    EXPECT_EQ(file->animations()[0].tracks[0].key_count, times.size()) << "case " << c;
    const Result<GltfKeys> keys = file->keys(0, 0);
    ASSERT_TRUE(keys) << keys.error().text();
    ASSERT_EQ(keys.value().times, times) << "case " << c;
    for (const std::size_t target : {std::size_t{0}, std::size_t{1}}) {
      const Channel& alone = target == 0 ? first : second;
      std::vector<float> course_times(times.begin(), times.end()), course;
      const bool is_cubic = std::string(together) == "CUBICSPLINE";
      for (std::size_t row = target; row < keys.value().values.size(); row += 2)
        course.push_back(static_cast<float>(keys.value().values[row]));
      ASSERT_EQ(course.size(), times.size() * (is_cubic ? 3 : 1));
      for (double time = -0.25; time < 6; time += 0.0625) {
        EXPECT_NEAR(weight_at(course_times, course, together, time),
                    weight_at(alone.times, alone.values, alone.interpolation, time), 1e-5)
            << "case " << c << ", target " << target << ", time " << time;
      }
    }
  }
}

TEST(GltfPointers, equal_times_in_arrays_of_their_own_are_counted_once) {
  GltfBuilder builder = document();
  add_pointer(builder, "/nodes/0/weights/0", kTimes, {0, 1, 2});
  add_pointer(builder, "/nodes/0/weights/1", kTimes, {3, 4, 5});
  const GltfFixture file(builder);
  EXPECT_EQ(file->animations()[0].tracks[0].key_count, kTimes.size());
  EXPECT_EQ(file->keys(0, 0).value().values, (std::vector<double>{0, 3, 1, 4, 2, 5}));
}

TEST(GltfPointers, keys_of_many_channels_count_against_the_expansion_that_is_allowed) {
  // In memory, each key of each channel becomes a row with all weights, so few bytes of the file become many numbers.
  GltfBuilder builder = document();
  std::vector<float> times(40000);
  for (std::size_t k = 0; k < times.size(); ++k) times[k] = static_cast<float>(k);
  add_pointer(builder, "/nodes/0/weights/0", times, std::vector<float>(times.size()));
  for (float& time : times) time += 0.5F;
  add_pointer(builder, "/nodes/0/weights/1", times, std::vector<float>(times.size()));
  builder.json["meshes"][0].erase("weights");
  const auto targets = builder.json["meshes"][0]["primitives"][0]["targets"];
  for (std::size_t k = 0; k < 498; ++k) builder.json["meshes"][0]["primitives"][0]["targets"].push_back(targets[k % 2]);
  EXPECT_NE(error_of(builder).find("--max-expansion"), std::string::npos) << error_of(builder);
}

TEST(GltfPointers, what_cannot_be_put_together_is_refused) {
  const auto with_two = [](const std::string& second, const std::vector<float>& times, const char* interpolation) {
    GltfBuilder builder = document();
    add_pointer(builder, "/nodes/0/weights/0", kTimes, {0, 1, 2});
    std::vector<float> values(times.size());
    add_pointer(builder, second, times, values, interpolation);
    return error_of(builder);
  };
  EXPECT_EQ(with_two("/nodes/0/weights/1", kTimes, "LINEAR"), "");
  EXPECT_NE(with_two("/nodes/0/weights/1", kTimes, "STEP").find("the same interpolation"), std::string::npos);
  EXPECT_NE(with_two("/nodes/0/weights/1", {0, 3, 2}, "LINEAR").find("not later"), std::string::npos);
  for (const char* const absent : {"/nodes/0/weights/2", "/nodes/0/weights/-", "/nodes/0/weights/",
                                   "/nodes/7/weights/0", "/meshes/0/weights/2", "/nodes/0/weights/1x"})
    EXPECT_NE(with_two(absent, kTimes, "LINEAR").find("drives " + std::string(absent)), std::string::npos)
        << with_two(absent, kTimes, "LINEAR");
  for (const char* const twice : {"/nodes/0/weights/0", "/meshes/0/weights/0"})
    EXPECT_NE(with_two(twice, kTimes, "LINEAR").find("drives the same weights"), std::string::npos) << twice;
  GltfBuilder both = document();
  both.add_track(0, 0, kTimes, std::vector<float>(6));
  add_pointer(both, "/nodes/0/weights/0", kTimes, {0, 1, 2});
  EXPECT_NE(error_of(both).find("drives the same weights"), std::string::npos);
}

}  // namespace
}  // namespace chronormal::gltf_pointer_test
