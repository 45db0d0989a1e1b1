// Checks that the time of every computation of normals, and of every comparison, grows only linearly with the number of
// corners of a polygon, although the normal at each corner depends on the whole polygon.

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "chronormal/motion/paths.h"
#include "chronormal/normals/mesh_normals.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "chronormal/workflow/bake.h"
#include "chronormal/workflow/compare.h"
#include "chronormal/workflow/sample.h"
#include "normals/recompute/recompute.h"
#include "tests/support/cpu_time.h"
#include "tests/support/large_polygons.h"

namespace chronormal::growth_test {
namespace {

using fixtures::Random;
using test::LargePolygons;

struct Way {
  std::string name;
  std::function<void(const Motion&)> run;
};

NormalGroups vertices_of(const Motion& motion) {
  return NormalGroups::of_vertices(motion.topology, separate_points(motion.topology.vertex_count()));
}

template <class Object>
void evaluate(Object&& object, double t) {
  std::vector<float> normals(3 * object.size());
  object.unit_normals(t, VectorView<float>::packed(normals.data(), object.size()), Threads::kAll);
}

Way compare_on(bool certify) {
  return {certify ? "certificates" : "compare", [certify](const Motion& motion) {
            CompareOptions options;
            options.schemes = {"linear"};
            options.certify = certify;
            options.elements.kind = ElementKind::kVertices;
            options.elements.weld = false;
            options.samples = 3;
            EXPECT_EQ(compare(motion, options).value().elements, motion.topology.vertex_count());
          }};
}

std::vector<Way> ways() {
  std::vector<Way> all;
  for (const double tolerance : {kExactTolerance, kCompactTolerance}) {
    all.push_back({"curves to " + std::to_string(tolerance), [tolerance](const Motion& motion) {
                     evaluate(NormalCurves::of_groups(motion.segment(0), vertices_of(motion), {tolerance}), 0.3);
                   }});
  }
  all.push_back({"recompute", [](const Motion& motion) {
                   const NormalGroups groups = vertices_of(motion);
                   evaluate(NormalRecompute(motion.segment(0), groups), 0.3);
                 }});
  all.push_back({"the normals of a mesh", [](const Motion& motion) {
                   MeshNormals normals = MeshNormals::make(motion.topology).value();
                   ASSERT_TRUE(normals.set_segment(motion.segment(0)));
                   evaluate(std::move(normals), 0.3);
                 }});
  all.push_back({"sums of control normals", [](const Motion& motion) {
                   (void)all_group_control_normals(motion.segment(0), vertices_of(motion));
                 }});
  all.push_back({"sums by area", [](const Motion& motion) {
                   (void)all_weighted_normals_at(motion.segment(0), vertices_of(motion), Weighting::kArea, 0.3);
                 }});
  all.push_back({"cutting curves", [](const Motion& motion) {
                   Motion sequence = motion;
                   for (std::size_t k = 0; k < sequence.keyframes.size(); ++k)
                     sequence.keyframes[k].time = static_cast<double>(k);
                   sequence.connect_as_sequence();
                   EXPECT_TRUE(cut_into_segments(sequence, {PathKind::kCatmullRom, 1}, 4).ok());
                 }});
  all.push_back({"weights", [](const Motion& motion) {
                   Motion targets = motion;
                   targets.connect_as_targets();
                   NormalSampler sampler = NormalSampler::make(targets, {}).value();
                   (void)sampler.at_weights(std::vector<double>{0.3, 0.4}).value();
                 }});
  for (const bool certify : {false, true}) all.push_back(compare_on(certify));
  all.push_back({"baking a sequence", [](const Motion& motion) {
                   std::string glb;
                   EXPECT_TRUE(bake_sequence(motion, {}, glb));
                 }});
  return all;
}

TEST(Growth, is_linear_in_the_corners_of_a_polygon) {
  constexpr std::uint32_t kFew = 1000, kMany = 8000;
  constexpr double kOnce = 0.05;  // in seconds, for computations in integers that only large polygons need
  for (const LargePolygons kind : {LargePolygons::kAlone, LargePolygons::kPillow, LargePolygons::kPrism}) {
    Random random(49007);
    const Motion few = test::large_polygons(kind, kFew, random, 3), many = test::large_polygons(kind, kMany, random, 3);
    for (const Way& way : ways()) {
      SCOPED_TRACE(way.name + " of kind " + std::to_string(static_cast<int>(kind)));
      test::expect_growth(
          4.0 * kMany / kFew, kOnce, [&] { way.run(few); }, [&] { way.run(many); });
    }
  }
}

}  // namespace
}  // namespace chronormal::growth_test
