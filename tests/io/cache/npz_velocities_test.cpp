// Checks that the array `velocities` of an .npz file is read back as it was written, and that the reader refuses an
// array without exactly one velocity per vertex.

#include <gtest/gtest.h>

#include <limits>
#include <span>
#include <string>
#include <vector>

#include "io/cache/npz.h"
#include "tests/support/curved_motion.h"
#include "tests/support/written.h"

namespace chronormal::npz_velocities_test {
namespace {

Motion moving() {
  Motion motion = test::curved_motion({0, 0.5, 1}, 1, 5, 3);
  for (Motion::Keyframe& key : motion.keyframes)
    for (const float p : key.positions) key.velocities.push_back(2 * p - 1);
  return motion;
}

TEST(NpzVelocities, come_back_as_they_were_written) {
  const Motion motion = moving(), read = read_npz(test::written(motion, ".npz").value(), "walk.npz").value();
  for (std::size_t k = 0; k < 3; ++k) EXPECT_EQ(read.keyframes[k].velocities, motion.keyframes[k].velocities);
  Motion without = motion;
  without.keyframes[1].velocities.clear();
  const Motion none = read_npz(test::written(without, ".npz").value(), "walk.npz").value();
  EXPECT_TRUE(none.keyframes[0].velocities.empty()) << "an array has them for all keyframes or for none";
}

TEST(NpzVelocities, of_another_shape_or_not_finite_are_refused_with_their_place) {
  const Motion motion = moving();
  const std::size_t vertices = motion.topology.vertex_count();
  NpyBytes positions({3, vertices, 3}), fewer({3, vertices - 1, 3}), nan({3, vertices, 3});
  for (const Motion::Keyframe& key : motion.keyframes) {
    positions.append(key.positions);
    fewer.append(std::span(key.positions).first(3 * (vertices - 1)));
    std::vector<float> broken = key.velocities;
    broken[7] = std::numeric_limits<float>::quiet_NaN();
    nan.append(broken);
  }
  const std::string faces = write_npy_faces(motion.topology).value();
  const auto refused = [&](const NpyBytes& velocities) {
    const std::vector<NpzMember> members = {
        {"positions", positions.bytes()}, {"faces", faces}, {"velocities", velocities.bytes()}};
    const Result<Motion> read = read_npz(write_npz(members), "walk.npz");
    return read ? std::string() : read.error().text();
  };
  EXPECT_NE(refused(fewer).find("walk.npz, velocities: velocities must have the same shape as positions"),
            std::string::npos)
      << refused(fewer);
  EXPECT_NE(refused(nan).find("walk.npz, velocities[0, 2, 1]"), std::string::npos) << refused(nan);
  EXPECT_EQ(refused(positions), "");
}

}  // namespace
}  // namespace chronormal::npz_velocities_test
