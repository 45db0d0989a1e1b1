// KHR_animation_pointer to single weights: the channels of one node are one track, as a channel of all weights is.
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

// Adds a channel for one weight.
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

// Returns the complaint about a document, or the keys of its first track.
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

TEST(GltfPointers, what_cannot_be_put_together_is_refused) {
  const auto with_two = [](const std::string& second, const std::vector<float>& times, const char* interpolation) {
    GltfBuilder builder = document();
    add_pointer(builder, "/nodes/0/weights/0", kTimes, {0, 1, 2});
    std::vector<float> values(times.size());
    add_pointer(builder, second, times, values, interpolation);
    return error_of(builder);
  };
  EXPECT_EQ(with_two("/nodes/0/weights/1", kTimes, "LINEAR"), "");
  EXPECT_NE(with_two("/nodes/0/weights/1", {0, 2, 3}, "LINEAR").find("not at the same times"), std::string::npos);
  EXPECT_NE(with_two("/nodes/0/weights/1", {0, 3}, "LINEAR").find("different keys"), std::string::npos);
  EXPECT_NE(with_two("/nodes/0/weights/1", kTimes, "STEP").find("different keys or interpol"), std::string::npos);
  EXPECT_NE(with_two("/nodes/0/weights/1", {0, 3, 2}, "LINEAR").find("not after"), std::string::npos);
  for (const char* const absent : {"/nodes/0/weights/2", "/nodes/0/weights/-", "/nodes/0/weights/",
                                   "/nodes/7/weights/0", "/meshes/0/weights/2", "/nodes/0/weights/1x"})
    EXPECT_NE(with_two(absent, kTimes, "LINEAR").find("there is no " + std::string(absent)), std::string::npos)
        << with_two(absent, kTimes, "LINEAR");
  for (const char* const twice : {"/nodes/0/weights/0", "/meshes/0/weights/0"})
    EXPECT_NE(with_two(twice, kTimes, "LINEAR").find("two channels for these weights"), std::string::npos) << twice;
  GltfBuilder both = document();
  both.add_track(0, 0, kTimes, std::vector<float>(6));
  add_pointer(both, "/nodes/0/weights/0", kTimes, {0, 1, 2});
  EXPECT_NE(error_of(both).find("two channels for these weights"), std::string::npos);
}

}  // namespace
}  // namespace chronormal::gltf_pointer_test
