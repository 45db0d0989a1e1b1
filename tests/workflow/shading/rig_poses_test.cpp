// Tests the poses for which a rig is baked: which targets are used together, and how many targets are active.
#include "workflow/shading/rig_poses.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

namespace chronormal::rig_poses_test {
namespace {

const std::vector<std::string> kNames = {"eyeBlink_L", "eyeBlink_R", "jawOpen", "mouthSmileLeft", "tail"};

RigPoses rig(PoseList given = {}) { return {kNames, {0, 1, 2, 3, 4}, 5, std::move(given)}; }

TEST(RigPoses, the_left_and_the_right_of_one_thing_go_together_most_and_the_jaw_goes_with_the_mouth) {
  EXPECT_EQ(togetherness("eyeBlink_L", "eyeBlink_R"), 8);
  EXPECT_EQ(togetherness("mouthSmileLeft", "mouthSmileRight"), 8);
  EXPECT_EQ(togetherness("Brow.l", "Brow.r"), 8);
  EXPECT_EQ(togetherness("jawOpen", "mouthSmileLeft"), 3);
  EXPECT_EQ(togetherness("tailUp", "tailDown"), 3);
  EXPECT_EQ(togetherness("jawOpen", "tail"), 1);
  EXPECT_EQ(togetherness("", ""), 1);
}

TEST(RigPoses, one_to_seven_targets_are_active_and_pairs_by_how_often_their_names_go_together) {
  std::size_t blinks = 0, blink_and_tail = 0, active = 0;
  const PoseList poses = rig().sample(4000, 1);
  ASSERT_EQ(poses.size(), 4000U);
  for (const std::vector<double>& pose : poses) {
    EXPECT_TRUE(std::all_of(pose.begin(), pose.end(), [](double w) { return w >= 0 && w <= 1; }));
    const auto count = std::count_if(pose.begin(), pose.end(), [](double w) { return w > 0; });
    EXPECT_GE(count, 1);
    active += static_cast<std::size_t>(count);
    if (count != 2) continue;
    blinks += pose[0] > 0 && pose[1] > 0 ? 1U : 0U;
    blink_and_tail += pose[0] > 0 && pose[4] > 0 ? 1U : 0U;
  }
  EXPECT_NEAR(static_cast<double>(active) / 4000, 3, 0.1);
  EXPECT_GT(blinks, 3 * blink_and_tail);
}

TEST(RigPoses, another_seed_draws_other_poses_and_the_same_seed_the_same) {
  EXPECT_EQ(rig().sample(20, 1), rig().sample(20, 1));
  EXPECT_NE(rig().sample(20, 1), rig().sample(20, 2));
}

TEST(RigPoses, poses_that_are_given_are_mixed_two_by_two_and_with_rest) {
  const PoseList given = {{1, 0, 0, 0, 0}, {0, 0, 1, 0, 0}};
  for (const std::vector<double>& pose : rig(given).sample(200, 1)) {
    EXPECT_EQ(pose[1] + pose[3] + pose[4], 0);
    EXPECT_LE(pose[0] + pose[2], 1 + 1e-12);
  }
}

}  // namespace
}  // namespace chronormal::rig_poses_test
