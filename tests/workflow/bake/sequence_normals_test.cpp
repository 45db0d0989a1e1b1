// Compares the normals from which a bake of a sequence computes keys and correction targets with normals that are
// computed in integers of any size.

#include "workflow/bake/sequence/sequence_normals.h"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "chronormal/normals/normal_groups.h"
#include "tests/support/fixtures.h"
#include "tests/support/hard_motions.h"
#include "tests/support/integer_normal.h"

namespace chronormal::sequence_normals_test {
namespace {

// Returns the vector areas of the faces at the points a + b, which are twice the midpoints of a and b.
std::vector<test::IntegerVector> areas_of_sums(const Topology& topology, const std::vector<float>& a,
                                               const std::vector<float>& b) {
  const Segment segment{&topology, VectorView<const float>::packed(a.data(), a.size() / 3),
                        VectorView<const float>::packed(b.data(), b.size() / 3)};
  return test::IntegerNormals(segment).at(test::IntegerTime::of(0.5));
}

void expect_directions(const std::vector<Vec3d>& found, const std::vector<test::IntegerVector>& faces,
                       const NormalGroups& groups, const std::string& what) {
  for (std::size_t e = 0; e < found.size(); ++e) {
    const test::IntegerVector n = test::sum_of(faces, groups.faces(e));
    if (test::is_zero(n))
      EXPECT_EQ(found[e], Vec3d{}) << what << ", element " << e;
    else
      EXPECT_LE(test::angle_between(to_float(unit(found[e])), test::direction_of(n)), 1e-6)
          << what << ", element " << e;
  }
}

TEST(SequenceNormals, of_vertices_whose_faces_cancel_are_exact) {
  constexpr std::uint64_t kSeed = 4951;
  fixtures::Random random(kSeed);
  for (int i = 0; i < 60; ++i) {
    const Motion motion = test::cancelling_star(random);
    const Topology& topology = motion.topology;
    const NormalGroups groups = NormalGroups::of_vertices(topology, separate_points(topology.vertex_count()));
    MotionStream stream(motion);
    const Result<SequenceNormals> made = SequenceNormals::make(stream, groups, Weighting::kArea);
    ASSERT_TRUE(made.ok());
    const SequenceNormals& normals = made.value();
    const std::string star = "star " + std::to_string(i) + " from seed " + std::to_string(kSeed);
    std::vector<float> back = normals.deltas(0);
    for (float& x : back) x = -x;
    const auto first = areas_of_sums(topology, normals.base(), normals.deltas(0)),
               second = areas_of_sums(topology, normals.base(), normals.deltas(1)),
               bend = areas_of_sums(topology, normals.deltas(1), back);
    expect_directions(normals.at_key(0), first, groups, star + ", key 0");
    expect_directions(normals.at_key(1), second, groups, star + ", key 1");
    expect_directions(normals.bends(0), bend, groups, star + ", bend");
    SequenceNormals::Rows rows;
    normals.each_block(0, rows, [&](IndexRange all, std::span<const Vec3d> n, std::span<const Vec3d> d) {
      ASSERT_EQ(all.count, groups.size());
      expect_directions({n.begin(), n.end()}, second, groups, star + ", key 1 of a segment");
      expect_directions({d.begin(), d.end()}, bend, groups, star + ", bend of a segment");
    });
  }
}

}  // namespace
}  // namespace chronormal::sequence_normals_test
