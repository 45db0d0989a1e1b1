// Whole meshes from arrays: who shares a normal, what is written for each that shows it, and what is refused. The truth
// is a sum of cross products, made here.
#include "chronormal/normals/element_curves.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

namespace chronormal::element_curves_test {
namespace {

// Two triangles that share an edge, once by the same vertices (0 1 2 and 2 1 3) and once with a seam between them: 4
// and 5 lie where 1 and 2 do.
const std::vector<std::uint32_t> kCorners = {0, 1, 2, 5, 4, 3};
const std::vector<float> kFrom = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0.5F, 1, 0, 0, 0, 1, 0};
const std::vector<float> kTo = {0, 0, 1, 1, 0.5F, 0, 0, 1, 1, 2, 1, -1, 1, 0.5F, 0, 0, 1, 1};

VectorView<const float> view(const std::vector<float>& values) {
  return VectorView<const float>::packed(values.data(), values.size() / 3);
}

Result<ElementCurves> curves_of(const ElementCurvesOptions& options) {
  return ElementCurves::make(Topology::triangles(6, kCorners).value(), view(kFrom), view(kTo), options);
}

Vec3d position(std::size_t v, double t) {
  const auto at = [&](std::size_t c) { return (1 - t) * kFrom[3 * v + c] + t * kTo[3 * v + c]; };
  return {at(0), at(1), at(2)};
}

Vec3d face_normal(std::size_t f, double t) {
  const Vec3d a = position(kCorners[3 * f], t);
  return cross(position(kCorners[3 * f + 1], t) - a, position(kCorners[3 * f + 2], t) - a);
}

std::vector<float> normals_at(ElementCurves& curves, double t) {
  std::vector<float> result(3 * curves.size(), 7.0F);
  EXPECT_EQ(curves.unit_normals(t, VectorView<float>::packed(result.data(), curves.size())), 0U);
  return result;
}

void expect_direction(const std::vector<float>& normals, std::size_t i, const Vec3d& right) {
  const Vec3d shown = to_double(view(normals)[i]);
  EXPECT_LT(length(shown - unit(right)), 1e-6) << "output " << i;
}

TEST(ElementCurves, faces_have_their_own_normals) {
  Result<ElementCurves> curves = curves_of({{ElementKind::kFaces}});
  ASSERT_EQ(curves.value().size(), 2U);
  for (const double t : {0.0, 0.3, 1.0})
    for (std::size_t f = 0; f < 2; ++f) expect_direction(normals_at(curves.value(), t), f, face_normal(f, t));
}

TEST(ElementCurves, vertices_across_a_seam_share_a_normal_unless_they_are_separate) {
  ElementCurvesOptions options;
  Result<ElementCurves> welded = curves_of(options);
  options.elements.weld = false;
  Result<ElementCurves> separate = curves_of(options);
  for (const double t : {0.0, 0.3, 1.0}) {
    const std::vector<float> one = normals_at(welded.value(), t), two = normals_at(separate.value(), t);
    const Vec3d left = face_normal(0, t), right = face_normal(1, t);
    expect_direction(one, 0, left);
    expect_direction(one, 1, left + right);
    expect_direction(one, 4, left + right);
    expect_direction(one, 3, right);
    expect_direction(two, 1, left);
    expect_direction(two, 4, right);
  }
}

TEST(ElementCurves, corners_keep_hard_edges_apart) {
  ElementCurvesOptions options{{ElementKind::kCorners}};
  options.elements.crease_angle = 1;
  Result<ElementCurves> hard = curves_of(options);
  options.elements.crease_angle = 180;
  Result<ElementCurves> smooth = curves_of(options);
  const std::vector<float> apart = normals_at(hard.value(), 0.5), joined = normals_at(smooth.value(), 0.5);
  const Vec3d left = face_normal(0, 0.5), right = face_normal(1, 0.5);
  expect_direction(apart, 1, left);
  expect_direction(apart, 4, right);
  expect_direction(joined, 1, left + right);
  expect_direction(joined, 4, left + right);
}

TEST(ElementCurves, the_next_segment_is_that_of_curves_made_anew) {
  for (const ElementKind kind : {ElementKind::kFaces, ElementKind::kVertices, ElementKind::kCorners}) {
    Result<ElementCurves> reused = curves_of({{kind}});
    ASSERT_TRUE(reused.value().next(view(kTo), view(kFrom)));
    Result<ElementCurves> fresh =
        ElementCurves::make(Topology::triangles(6, kCorners).value(), view(kTo), view(kFrom), {{kind}});
    EXPECT_EQ(normals_at(reused.value(), 0.25), normals_at(fresh.value(), 0.25));
  }
}

TEST(ElementCurves, a_fitted_weighting_states_its_bound) {
  ElementCurvesOptions options;
  options.weighting = Weighting::kAngle;
  Result<ElementCurves> curves = curves_of(options);
  EXPECT_GT(curves.value().fit_bound(), 0);
  const Vec3d left = unit(face_normal(0, 0)), right = unit(face_normal(1, 0));
  const auto angle = [](std::size_t at, std::size_t a, std::size_t b) {
    return angle_between(position(a, 0) - position(at, 0), position(b, 0) - position(at, 0));
  };
  expect_direction(normals_at(curves.value(), 0), 1, angle(1, 0, 2) * left + angle(4, 5, 3) * right);
}

TEST(ElementCurves, what_does_not_fit_is_refused_with_its_place) {
  const Topology topology = Topology::triangles(6, kCorners).value();
  std::vector<float> broken = kTo;
  broken[13] = std::numeric_limits<float>::infinity();
  const auto text_of = [](const Result<ElementCurves>& made) { return made ? std::string() : made.error().text(); };
  EXPECT_EQ(text_of(ElementCurves::make(topology, view(kFrom), view(broken))),
            "keyframe 1, vertex 4: the position is not finite");
  const std::vector<float> few(15);
  EXPECT_EQ(text_of(ElementCurves::make(topology, view(few), view(kTo))),
            "keyframe 0: there are 5 positions for 6 vertices");
  EXPECT_EQ(text_of(ElementCurves::make(Topology(), {}, {})), "the mesh has no faces");
  const Result<ElementCurves> weighted = curves_of({{ElementKind::kFaces}, Weighting::kAngle});
  EXPECT_EQ(weighted ? ErrorCode::kFailed : weighted.error().code, ErrorCode::kUsage);

  Result<ElementCurves> curves = curves_of({});
  const std::vector<float> before = normals_at(curves.value(), 0.5);
  EXPECT_FALSE(curves.value().next(view(kFrom), view(broken)));
  EXPECT_EQ(normals_at(curves.value(), 0.5), before);
}

}  // namespace
}  // namespace chronormal::element_curves_test
