// Tests the errors of single samples of an audit or a comparison, and their files. The sums of these errors must equal
// the totals.

#include "chronormal/workflow/errors.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/compare.h"
#include "io/mesh/ply.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/shaded_mesh.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::errors_test {
namespace {

struct Sums {
  std::size_t judged = 0;
  double sum = 0, worst = 0;
};

Sums sums_of(const std::vector<float>& degrees) {
  Sums sums;
  for (const float value : degrees) {
    if (std::isnan(value)) continue;
    ++sums.judged;
    sums.sum += static_cast<double>(value);
    sums.worst = std::max(sums.worst, static_cast<double>(value));
  }
  return sums;
}

Input twist() {
  InputOptions options;
  options.samples = {"twist"};
  return open_input(options).value();
}

// Audits two triangles that fold: by a target alone, and in an animation of two seconds.
Audit hinge_audit(bool keep_errors) {
  test::GltfBuilder builder = test::hinge().file();
  builder.add_track(builder.add_animation("swing"), 0, std::vector<float>{0, 2}, std::vector<float>{0, 1});
  const std::string glb = builder.glb();
  AuditOptions options;
  options.keep_errors = keep_errors;
  return audit(GltfDocument::read(glb, "hinge.glb").value(), options).value();
}

TEST(ErrorTables, of_a_sequence_have_every_pair_that_its_audit_judged) {
  Input input = twist();
  AuditOptions options;
  options.keep_errors = true;
  options.samples = 5;
  const Audit found = audit(*input.motion().value(), *input.normals().value(), options).value();
  ASSERT_EQ(found.errors.size(), 1u);
  const ErrorTable& table = found.errors[0];
  EXPECT_EQ(table.rows(), 5u);
  EXPECT_EQ(table.columns(), input.motion().value()->topology.vertex_count());
  ASSERT_EQ(table.degrees.size(), table.rows() * table.columns());
  const Sums sums = sums_of(table.degrees);
  EXPECT_EQ(sums.judged, found.error.judged);
  EXPECT_NEAR(sums.sum, found.error.sum, 1e-5 * found.error.sum);
  EXPECT_FLOAT_EQ(static_cast<float>(sums.worst), static_cast<float>(found.error.worst));
  const AuditPlace& worst = found.error.worst_at;
  const auto row = std::find(table.times.begin(), table.times.end(), worst.at) - table.times.begin();
  EXPECT_EQ(table.degrees[static_cast<std::size_t>(row) * table.columns() + worst.vertex],
            static_cast<float>(found.error.worst));
  EXPECT_TRUE(std::isnan(table.weights[0]));
}

TEST(ErrorTables, of_a_gltf_file_have_rows_for_each_target_and_track) {
  const Audit found = hinge_audit(true);
  ASSERT_EQ(found.errors.size(), 1u);
  const ErrorTable& table = found.errors[0];
  EXPECT_EQ(table.name, "mesh0");
  EXPECT_EQ(table.vertices.size(), table.columns());
  std::size_t rows = 0, judged = 0;
  for (const AuditSubject& subject : found.subjects) rows += subject.segments * subject.samples;
  EXPECT_EQ(table.rows(), rows);
  judged = sums_of(table.degrees).judged;
  EXPECT_EQ(judged, found.error.judged);
  EXPECT_EQ(table.subjects.front(), 0);
  EXPECT_EQ(table.subjects.back(), 1);
  EXPECT_EQ(table.weights[0], 0);
  EXPECT_TRUE(std::isnan(table.times[0]));
  EXPECT_EQ(table.times.back(), 2);
  EXPECT_TRUE(hinge_audit(false).errors.empty()) << "they were not asked for";
}

TEST(ErrorTables, of_a_comparison_add_up_to_its_sums_for_every_kind_of_element) {
  Input input = twist();
  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices, ElementKind::kCorners}) {
    CompareOptions options{.schemes = {"linear", "quadratic"}, .samples = 3, .progress = {}, .elements = {kind}};
    options.keep_errors = true;
    const Comparison found = compare(*input.motion().value(), options).value();
    ASSERT_EQ(found.errors.size(), 2u);
    for (std::size_t s = 0; s < 2; ++s) {
      const ErrorTable& table = found.errors[s];
      EXPECT_EQ(table.name, options.schemes[s]);
      EXPECT_EQ(table.rows(), 3u);
      const Sums sums = sums_of(table.degrees);
      const Quality& quality = found.schemes[s].quality;
      EXPECT_FLOAT_EQ(static_cast<float>(sums.worst), static_cast<float>(quality.max * kDegreesPerRadian));
      // Corners of a vertex can share an element. The table repeats the error of the element for each of these corners,
      // so the sums over the table differ from the totals.
      if (kind == ElementKind::kCorners) continue;
      EXPECT_EQ(sums.judged, quality.count);
      EXPECT_NEAR(sums.sum, quality.sum * kDegreesPerRadian, 1e-5 * sums.sum);
    }
  }
}

TEST(ErrorFiles, a_ply_file_has_the_worst_of_each_vertex_as_its_quality) {
  const test::TemporaryFolder folder;
  const Audit found = hinge_audit(true);
  ASSERT_TRUE(write_errors(found.errors, folder / "e.ply", false).ok());
  const std::string bytes = test::read_whole(folder / "e.ply");
  const Result<MeshFrame> mesh = read_ply(bytes, "e.ply");
  ASSERT_TRUE(mesh.ok()) << mesh.error().text();
  const std::size_t vertices = found.errors[0].columns();
  EXPECT_EQ(mesh.value().topology.vertex_count(), vertices);
  ASSERT_NE(bytes.find("property float z\nproperty float quality\n"), std::string::npos);
  const std::size_t first = bytes.find("end_header\n") + 11;
  const std::vector<float> worst = found.errors[0].worst();
  for (std::size_t v = 0; v < vertices; ++v) {
    float quality = -1;
    std::memcpy(&quality, bytes.data() + first + 16 * v + 12, sizeof quality);
    EXPECT_EQ(quality, std::isnan(worst[v]) ? 0 : worst[v]) << v;
  }
  EXPECT_GT(sums_of(worst).worst, 1);
}

TEST(ErrorFiles, refuse_what_they_cannot_hold) {
  const test::TemporaryFolder folder;
  Input input = twist();
  CompareOptions options{.schemes = {"linear"}, .samples = 2, .progress = {}, .elements = {ElementKind::kCorners}};
  options.keep_errors = true;
  const Comparison corners = compare(*input.motion().value(), options).value();
  EXPECT_EQ(write_errors(corners.errors, folder / "e.ply", false).error().code, ErrorCode::kUsage);
  options.elements.kind = ElementKind::kFaces;
  options.schemes = {"linear", "cubic"};
  const Comparison faces = compare(*input.motion().value(), options).value();
  EXPECT_EQ(write_errors(faces.errors, folder / "e.ply", false).error().code, ErrorCode::kUsage);
  EXPECT_TRUE(write_errors(std::span(faces.errors).first(1), folder / "e.ply", false).ok());
  EXPECT_EQ(write_errors(faces.errors, folder / "e.ply", false).error().code, ErrorCode::kFailed) << "it exists";
  EXPECT_EQ(write_errors(faces.errors, folder / "e.txt", false).error().code, ErrorCode::kUsage);
  EXPECT_EQ(write_errors({}, folder / "none.npz", false).error().code, ErrorCode::kInvalidInput);
  options.samples = 100000;
  EXPECT_EQ(compare(*input.motion().value(), options).error().code, ErrorCode::kUsage) << "14 GB";
  AuditOptions many;
  many.keep_errors = true;
  many.samples = 100000;
  EXPECT_EQ(audit(*input.motion().value(), *input.normals().value(), many).error().code, ErrorCode::kUsage);
}

}  // namespace
}  // namespace chronormal::errors_test
