// Tests the poses that an audit judges: the poses in which a file opens, requested poses, and weights of targets
// outside of 0 to 1.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "chronormal/workflow/audit.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/shaded_mesh.h"

namespace chronormal::audit_poses_test {
namespace {

using test::GltfBuilder;
using test::GltfFixture;
using test::hinge;
using test::ShadedMesh;
using Kind = AuditSubject::Kind;

Result<Audit> audited(const GltfBuilder& builder, const AuditOptions& options = {}) {
  const GltfFixture fixture(builder);
  EXPECT_TRUE(fixture.ok()) << fixture.error();
  return audit(*fixture, options);
}

std::vector<AuditSubject> subjects_of(const Audit& audit, Kind kind) {
  std::vector<AuditSubject> result;
  for (const AuditSubject& subject : audit.subjects)
    if (subject.kind == kind) result.push_back(subject);
  return result;
}

// Returns the hinge with a second target that is the same as the first, so that both targets together fold the hinge
// further.
ShadedMesh two_targets() {
  ShadedMesh mesh = hinge();
  mesh.targets.push_back(mesh.targets[0]);
  return mesh;
}

TEST(AuditPoses, a_file_that_opens_at_rest_has_no_opening_pose) {
  EXPECT_TRUE(subjects_of(audited(two_targets().file()).value(), Kind::kOpening).empty());
  GltfBuilder builder = two_targets().file();
  builder.json["meshes"][0]["weights"] = {0.0, 0.0};
  EXPECT_TRUE(subjects_of(audited(builder).value(), Kind::kOpening).empty());
}

TEST(AuditPoses, the_weights_of_every_node_are_a_subject_each_and_shut_the_gate) {
  GltfBuilder builder = two_targets().file();
  builder.json["meshes"][0]["weights"] = {0.25, 0.0};
  builder.json["nodes"].push_back({{"mesh", 0}, {"weights", {1.0, 1.0}}});
  builder.json["nodes"].push_back({{"mesh", 0}, {"weights", {1.0, 1.0}}});  // a second node with the same mesh
  builder.json["nodes"].push_back({{"mesh", 0}, {"weights", {0.0, 0.0}}});
  const Audit audit = audited(builder).value();
  const std::vector<AuditSubject> opening = subjects_of(audit, Kind::kOpening);
  ASSERT_EQ(opening.size(), 2U);
  EXPECT_EQ(opening[0].node, std::size_t{0});
  EXPECT_EQ(opening[1].node, std::size_t{1});
  // An audit of a requested pose with the weights of a node must give the same errors as the audit above gives for the
  // node.
  for (std::size_t n = 0; n < 2; ++n) {
    AuditOptions options;
    options.is_posed = true;
    options.poses = {RigPose{{}, n == 0 ? std::vector<double>{0.25, 0} : std::vector<double>{1, 1}, "here"}};
    const std::vector<AuditSubject> posed = subjects_of(audited(two_targets().file(), options).value(), Kind::kPoses);
    ASSERT_EQ(posed.size(), 1U);
    EXPECT_EQ(posed[0].segments, 1U);
    EXPECT_DOUBLE_EQ(posed[0].error.worst, opening[n].error.worst);
    EXPECT_GT(opening[n].error.worst, 0);
  }
  const double alone = subjects_of(audit, Kind::kTarget)[0].error.worst;
  EXPECT_GT(opening[1].error.worst, alone + 1);
  EXPECT_FALSE(audit.is_within(alone));
  EXPECT_TRUE(std::any_of(audit.findings.begin(), audit.findings.end(), [](const AuditFinding& finding) {
    return finding.kind == AuditFinding::Kind::kWrongPose && finding.node == std::size_t{1} && finding.is_fault();
  }));
}

TEST(AuditPoses, targets_are_judged_between_the_weights_that_are_asked_for) {
  AuditOptions options;
  options.weights = {-0.5, 2};
  options.samples = 6;
  const Audit audit = audited(hinge().file(), options).value();
  const AuditSubject& subject = audit.subjects.at(0);
  EXPECT_EQ(subject.error.worst_at.at, 2);
  EXPECT_GT(subject.error.worst, 90.001) << "at weight 1 it is 90";
  options.weights = {-1, 0};
  const Audit below = audited(hinge().file(), options).value();
  EXPECT_EQ(below.error.worst, below.subjects.at(0).error.worst);
  EXPECT_EQ(below.subjects.at(0).error.worst_at.at, -1);
  EXPECT_GT(below.error.worst, 1);
  options.weights = {1, 1};
  EXPECT_EQ(audited(hinge().file(), options).error().code, ErrorCode::kUsage);
  options.weights = {0, HUGE_VAL};
  EXPECT_EQ(audited(hinge().file(), options).error().code, ErrorCode::kUsage);
}

TEST(AuditPoses, poses_name_targets_and_without_any_there_are_random_ones) {
  AuditOptions options;
  options.is_posed = true;
  const std::vector<AuditSubject> random = subjects_of(audited(two_targets().file(), options).value(), Kind::kPoses);
  ASSERT_EQ(random.size(), 1U);
  EXPECT_EQ(random[0].segments, kRandomPoses);
  EXPECT_GT(random[0].error.judged, kRandomPoses);
  options.poses = {RigPose{{{"jaw", 1, "poses.json, /0/jaw"}}, {}, "poses.json, /0"}};
  EXPECT_EQ(audited(two_targets().file(), options).error().code, ErrorCode::kInvalidInput) << "there is no such target";
  EXPECT_TRUE(subjects_of(audited(two_targets().file()).value(), Kind::kPoses).empty());
}

}  // namespace
}  // namespace chronormal::audit_poses_test
