#include "workflow/bake/poses/tracks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "tests/support/bake_fixture.h"
#include "workflow/bake/candidates/cut_tracks.h"

namespace chronormal::tracks_test {
namespace {

// Makes a spline track of two keys and two targets. Each key has in-tangents, values and out-tangents.
WeightTrack bent_track() {
  return {GltfInterpolation::kCubicSpline, {{0, 1}, {0, 0, 0.1, 0.3, 1, -2, 2, 1, 0.9, 0.6, 0, 0}}, 2};
}

double stated_error(const std::vector<ExtraWeight>& extras) {
  return extended_track(bent_track(), extras, std::numeric_limits<double>::infinity()).error;
}

TEST(Tracks, errors_of_extra_weights_add_up) {
  // The stated error must hold in the worst case, in which all correction targets turn the same normal in the same
  // direction.
  const std::vector<ExtraWeight> extras = {{0, 0, 1, -1, 0.5}, {0, 1, 0, 1, 0.7}, {1, 1, 1, -1, 0.2}};
  double sum = 0;
  for (const ExtraWeight& extra : extras) {
    EXPECT_GT(stated_error({extra}), 1e-3);
    sum += stated_error({extra});
  }
  EXPECT_NEAR(stated_error(extras), sum, 1e-12);
}

TEST(Tracks, the_error_grows_with_how_much_a_weight_turns) {
  EXPECT_NEAR(stated_error({{0, 1, 0, 1, 3.0}}), 3 * stated_error({{0, 1, 0, 1, 1.0}}), 1e-12);
}

TEST(Tracks, pieces_that_are_cut_stay_within_the_tolerance) {
  const std::vector<ExtraWeight> extras = {{0, 0, 1, -1, 0.5}, {0, 1, 0, 1, 0.7}, {1, 1, 1, -1, 0.2}};
  const ExtendedTrack cut = extended_track(bent_track(), extras, 1e-4);
  EXPECT_GT(cut.keys, 2U);
  EXPECT_GT(cut.error, 0);
  EXPECT_LE(cut.error, 1e-4);
}

// The weight 4 w (1 - w) is 0 at both keys and 1 halfway, so a straight line between the keys misses it completely.
TEST(Tracks, what_straight_pieces_leave_is_what_they_leave_out_in_the_middle_of_a_gap) {
  const test::GltfFixture file(test::still_hills_document(1, 3));
  const GltfShading shading = read_gltf_shading(*file, 0).value();
  const AuthorTruth truth(shading, Weighting::kArea);
  const NormalTerms terms(shading, truth);
  const std::vector<double> largest(shading.groups.size(), 1.0);
  const RightNormals rights(shading, terms, shading.normals, largest);
  std::vector<VertexVectors> columns(2);  // the target, and its correction target
  std::vector<std::uint32_t> vertices;
  for (std::uint32_t v = 0; v < shading.element_of_vertex.size(); ++v) {
    vertices.push_back(v);
    const auto part = static_cast<float>(v);
    columns[0].vectors.push_back({0.3F * std::sin(part), 0.2F, 0.1F});
    columns[1].vectors.push_back({0.01F * part, 0.2F * std::cos(part), -0.1F});
  }
  columns[0].vertices = columns[1].vertices = vertices;
  double expected = 0;
  for (const std::uint32_t v : vertices) {
    const Vec3d half = rights.stored(v) + 0.5 * to_double(columns[0].vectors[v]);
    expected = std::max(expected, angle_between(half, half + to_double(columns[1].vectors[v])));
  }
  ASSERT_GT(expected, 0.1);

  MeshWeights weights{
      {{GltfInterpolation::kLinear, {{0, 1}, {0, 1}}, 1}}, {{0, 0}}, {{}}, {}, 0, WeightUse(1), true, {}};
  for (const std::size_t pieces : {std::size_t{1}, std::size_t{2}, std::size_t{5}}) {
    // Between two keys, the bake cuts the curve of a weight into straight pieces. The error decreases with the square
    // of the number of pieces, so this tolerance requires exactly `pieces` pieces.
    const auto count = static_cast<double>(pieces);
    Candidate form;
    form.own = {columns[0]};
    form.extras = {columns[1]};
    form.drivers.formulas = {{0, 0, 4, -4}};
    cut_tracks(rights, weights, kViewers, vertices, 1.01 * expected / (count * count), form);
    EXPECT_EQ(form.drivers.pieces.at({0, 0}), std::vector<std::uint32_t>{static_cast<std::uint32_t>(pieces)});
    EXPECT_NEAR(form.track_error, expected / (count * count), 1e-6) << pieces;
  }
}

}  // namespace
}  // namespace chronormal::tracks_test
