// Tests how a JSON file with poses of a rig is read, and the messages about files without valid poses.
#include "chronormal/io/input.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

namespace chronormal::poses_file_test {
namespace {

TEST(PosesFile, has_weights_by_name_or_in_order) {
  const auto poses = parse_poses(R"([{"smile": 1, "jaw/open": 0.5}, [0, -1.5, 2]])", "poses.json");
  ASSERT_TRUE(poses.ok()) << poses.error().text();
  ASSERT_EQ(poses.value().size(), 2U);
  const std::vector<RigPose::Named>& named = poses.value()[0].named;
  ASSERT_EQ(named.size(), 2U);
  EXPECT_EQ(named[0].target, "jaw/open");
  EXPECT_EQ(named[0].weight, 0.5);
  EXPECT_EQ(named[0].place, "poses.json, /0/jaw~1open");
  EXPECT_EQ(poses.value()[1].in_order, (std::vector<double>{0, -1.5, 2}));
}

TEST(PosesFile, errors_say_where) {
  for (const auto& [text, message] : std::vector<std::pair<std::string, std::string>>{
           {"{}", "p: the file must be a list of at least one pose, such as [{\"smile\": 1}]"},
           {"[]", "p: the file must be a list of at least one pose, such as [{\"smile\": 1}]"},
           {"[3]",
            "p, /0: a pose must be an object with the weights of targets by name, such as {\"smile\": 1}, or a list of "
            "weights"},
           {R"([{}, {"smile": "1"}])", "p, /1/smile: the value must be a number, not a string"},
           {"[[1, 1e999]]", "p, /0/1: the number is too large for a double; use a smaller number"}}) {
    const auto poses = parse_poses(text, "p");
    ASSERT_FALSE(poses.ok()) << text;
    EXPECT_EQ(poses.error().text(), message);
    EXPECT_EQ(poses.error().code, ErrorCode::kInvalidInput);
  }
  EXPECT_TRUE(parse_poses("[{]", "p").error().place.starts_with("p, byte"));
}

TEST(PosesFile, a_file_that_is_not_there_is_a_failure) {
  EXPECT_EQ(read_poses_file("/nowhere/poses.json").error().code, ErrorCode::kFailed);
}

}  // namespace
}  // namespace chronormal::poses_file_test
