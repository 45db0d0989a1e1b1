// Tests the kernel that computes the cone around three control normals. The components are floats, so integer
// arithmetic can decide exactly whether a control normal lies in the cone.
#include "analysis/cones/kernels/cones_of_three.h"

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "tests/support/cone_oracle.h"
#include "tests/support/fixtures.h"

namespace chronormal::cones_of_three_test {
namespace {

TEST(ConesOfThree, rounds_outwards) {
  constexpr std::size_t kCount = 4096;
  fixtures::Random random(77);
  std::vector<ControlNormals> normals;
  for (std::size_t i = 0; i < kCount; ++i) {
    const fixtures::Point near = random.in_cube(1);
    const double spread = std::ldexp(1, -static_cast<int>(random.below(30)));
    const auto vector = [&] {
      const fixtures::Point by = random.in_cube(spread);
      return to_double(to_float({near[0] + by[0], near[1] + by[1], near[2] + by[2]}));
    };
    const Vec3d n0 = vector(), m = vector();
    normals.push_back({n0, m, i % 4 == 0 ? n0 : vector()});
  }
  std::vector<NormalCone> cones(kCount);
  std::vector<std::uint16_t> flags(kCount / kConesPerFlags);
  cones_of_three(normals.data(), kCount, 0, cones.data(), flags.data());
  std::size_t outside = 0, whole = 0;
  for (std::size_t i = 0; i < kCount; ++i) {
    whole += cones[i].is_whole_sphere() ? 1U : 0U;
    for (const Vec3d& v : {normals[i].n0, normals[i].m, normals[i].n1}) {
      const Vec3f f = to_float(v);
      outside +=
          test::contains(cones[i], {test::integer_of(f.x), test::integer_of(f.y), test::integer_of(f.z)}) ? 0U : 1U;
    }
  }
  EXPECT_EQ(outside, 0u);
  EXPECT_EQ(whole, 0u);
}

TEST(ConesOfThree, flags_what_has_no_direction) {
  const double infinity = std::numeric_limits<double>::infinity(), nan = std::nan("");
  const Vec3d x{1, 0, 0}, y{0, 1, 0};
  const std::vector<ControlNormals> normals{{x, y, x},
                                            {x, {}, x},
                                            {{}, {}, {}},
                                            {x, y, {infinity, 0, 0}},
                                            {x, {0, nan, 0}, y},
                                            {x, y, -x},
                                            {x, -x, x},
                                            {5e-324 * x, 1e308 * y, x},
                                            {y, {0, 5e-324, 0}, y}};
  std::vector<NormalCone> cones(normals.size());
  std::array<std::uint16_t, 1> flags{};
  cones_of_three(normals.data(), normals.size(), kNormalShare, cones.data(), flags.data());
  EXPECT_EQ(flags[0], 0b110011110);
  // Bit i of flags[0] is set if the kernel cannot make the cone of element i. The kernel computes the control normals
  // of the curve between two times. For element 6, {x, -x, x}, one of the computed normals is zero only if the part
  // contains t = 1/2, where n(t) is zero. Lengths far below 2^-1000 count as uncertain.
  cones_of_parts(normals.data(), normals.size(), Restriction::to(0, 0.25), cones.data(), flags.data());
  EXPECT_EQ(flags[0], 0b10011100);
  cones_of_parts(normals.data(), normals.size(), Restriction::to(0.25, 0.5), cones.data(), flags.data());
  EXPECT_EQ(flags[0], 0b01011100);
}

}  // namespace
}  // namespace chronormal::cones_of_three_test
