/// Audits glTF files that a test builds in memory.
#ifndef CHRONORMAL_TESTS_SUPPORT_AUDIT_FIXTURE_H_
#define CHRONORMAL_TESTS_SUPPORT_AUDIT_FIXTURE_H_

#include <gtest/gtest.h>

#include <utility>

#include "chronormal/workflow/audit.h"
#include "tests/support/gltf_builder.h"

namespace chronormal::test {

/// Returns the audit of a file. If the file cannot be read or audited, fails the test and returns an empty audit.
[[nodiscard]] inline Audit audit_of(const GltfBuilder& builder, const AuditOptions& options = {}) {
  const GltfFixture fixture(builder);
  EXPECT_TRUE(fixture.ok()) << fixture.error();
  if (!fixture.ok()) return {};
  Result<Audit> result = audit(*fixture, options);
  EXPECT_TRUE(result.ok()) << (result.ok() ? "" : result.error().text());
  return result.ok() ? std::move(result).value() : Audit{};
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_AUDIT_FIXTURE_H_
