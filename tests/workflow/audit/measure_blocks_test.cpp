// Checks that an audit gives the same figures whether it measures blocks of faces or one vertex after the other. An
// audit that keeps the errors of single samples measures one vertex after the other.
#include "workflow/audit/measure_blocks.h"

#include <gtest/gtest.h>

#include <string>

#include "chronormal/core/parallel.h"
#include "chronormal/io/input.h"
#include "tests/support/hard_motions.h"

namespace chronormal::measure_blocks_test {
namespace {

void expect_same(const AuditPlace& a, const AuditPlace& b) {
  EXPECT_EQ(a.vertex, b.vertex);
  EXPECT_EQ(a.segment, b.segment);
  EXPECT_EQ(a.at, b.at);
}

void expect_same(const MotionError& a, const MotionError& b) {
  EXPECT_EQ(a.judged, b.judged);
  EXPECT_EQ(a.sum, b.sum);
  EXPECT_EQ(a.sum_of_squares, b.sum_of_squares);
  EXPECT_EQ(a.worst, b.worst);
  EXPECT_EQ(a.histogram, b.histogram);
  EXPECT_EQ(a.counts, b.counts);
  EXPECT_EQ(a.no_normal, b.no_normal);
  EXPECT_EQ(a.cancelled, b.cancelled);
  EXPECT_EQ(a.unlit, b.unlit);
  if (a.worst > 0) expect_same(a.worst_at, b.worst_at);
  if (a.unlit > 0) expect_same(a.unlit_at, b.unlit_at);
}

// Audits a motion in blocks and then vertex by vertex, and compares both results. Returns the number of judged samples.
std::size_t expect_same_audits(const Motion& motion, AuditOptions options) {
  const Result<Audit> blocks = audit(motion, {}, options);
  options.keep_errors = true;
  const Result<Audit> vertices = audit(motion, {}, options);
  if (!blocks || !vertices) {
    ADD_FAILURE() << (blocks ? vertices : blocks).error().text();
    return 0;
  }
  EXPECT_EQ(blocks.value().subjects.size(), vertices.value().subjects.size());
  for (std::size_t s = 0; s < blocks.value().subjects.size(); ++s) {
    const AuditSubject &a = blocks.value().subjects[s], &b = vertices.value().subjects[s];
    EXPECT_EQ(a.vertices, b.vertices);
    expect_same(a.error, b.error);
    expect_same(a.at_keys, b.at_keys);
  }
  return blocks.value().error.judged;
}

TEST(MeasureBlocks, give_the_numbers_of_an_audit_vertex_by_vertex) {
  for (const char* const name : {"twist", "eversion", "bumps"}) {
    const Motion motion = make_builtin_morph(name).value();
    for (const AuditRule rule : {AuditRule::kNlerp, AuditRule::kLerp, AuditRule::kStep}) {
      SCOPED_TRACE(std::string(name).append(", ").append(audit_rule_name(rule)));
      EXPECT_GT(expect_same_audits(motion, {.rule = rule, .samples = 3}), 1000U);
    }
  }
}

TEST(MeasureBlocks, do_so_on_motions_that_leave_nothing_of_a_normal_and_on_any_number_of_threads) {
  fixtures::Random random(8);
  std::size_t judged = 0;
  for (const test::HardMotions& hard : test::hard_motions()) {
    SCOPED_TRACE(hard.name);
    const Motion motion = hard.make(random);
    for (const std::size_t threads : {1U, 3U}) {
      const ThreadLimit limit(threads);
      judged += expect_same_audits(motion, {.samples = 4, .weld = threads == 1});
    }
  }
  EXPECT_GT(judged, 1000U);
}

}  // namespace
}  // namespace chronormal::measure_blocks_test
