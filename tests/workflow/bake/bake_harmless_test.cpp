// Tests deltas that viewers of all kinds render in the same way, and the guarantee that a bake makes no viewer worse.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "chronormal/analysis/quality.h"
#include "tests/support/bake_fixture.h"
#include "workflow/bake/candidates/makers.h"

namespace chronormal::bake_harmless_test {
namespace {

using Json = nlohmann::json;
using test::Baked;
using test::GltfBuilder;
using test::Real;
using test::Vector;

enum class Rule { kSum, kUnit };

Vector unit_of(const Vector& v) {
  const Real size = test::length_of(v);
  return size == 0 ? v : Vector{v[0] / size, v[1] / size, v[2] / size};
}

// Returns the normal that a viewer renders at a vertex: the weighted sum of the base normal and the deltas, in the form
// in which the viewer stores them.
Vector shown(const test::GltfPlayer& player, const Json& primitive, std::size_t v, const std::vector<double>& weights,
             Rule rule) {
  const auto vector_of = [&](const Json& accessor) {
    const std::vector<float>& all = player.cached(accessor.get<std::size_t>());
    return Vector{static_cast<Real>(all[3 * v]), static_cast<Real>(all[3 * v + 1]), static_cast<Real>(all[3 * v + 2])};
  };
  const Vector normal = vector_of(primitive["attributes"]["NORMAL"]);
  const Vector base = rule == Rule::kSum ? normal : unit_of(normal);
  Vector sum = base;
  for (std::size_t k = 0; k < weights.size(); ++k) {
    const Json& target = primitive["targets"][k];
    if (!target.contains("NORMAL")) continue;
    Vector delta = vector_of(target["NORMAL"]);
    if (rule == Rule::kUnit) {
      const Vector end = unit_of({normal[0] + delta[0], normal[1] + delta[1], normal[2] + delta[2]});
      for (std::size_t c = 0; c < 3; ++c) delta[c] = end[c] - base[c];
    }
    for (std::size_t c = 0; c < 3; ++c) sum[c] += static_cast<Real>(weights[k]) * delta[c];
  }
  return sum;
}

struct Weights {
  std::vector<double> before, after;
};

std::vector<double> doubles(const std::vector<float>& values) { return {values.begin(), values.end()}; }

// Returns the weights at instants of a track that are neither keys nor simple fractions of the intervals between keys.
std::vector<Weights> on_track(const Baked& baked, std::size_t instants = 137) {
  const Json& sampler = baked.before->json["animations"][0]["samplers"][0];
  const std::vector<float> times = baked.before->accessor(sampler["input"].get<std::size_t>());
  std::vector<Weights> result;
  for (std::size_t n = 0; n <= instants; ++n) {
    const auto from = static_cast<double>(times.front()), to = static_cast<double>(times.back());
    const double time = from + (to - from) * static_cast<double>(n) / static_cast<double>(instants);
    result.push_back({doubles(baked.before->weights_at(0, 0, time)), doubles(baked.after->weights_at(0, 0, time))});
  }
  return result;
}

// Returns the weights for each target alone. The weights of correction targets follow from the formulas in the file
// (docs/formats.md).
std::vector<Weights> alone(const Baked& baked) {
  std::vector<Weights> result;
  const Json& mesh = baked.mesh();
  const std::size_t targets = baked.before->json["meshes"][0]["primitives"][0]["targets"].size();
  for (std::size_t k = 0; k < targets; ++k) {
    for (int step = 1; step <= 23; ++step) {
      Weights pose{std::vector<double>(targets, 0.0),
                   std::vector<double>(mesh["primitives"][0]["targets"].size(), 0.0)};
      pose.before[k] = pose.after[k] = step / 23.0;
      if (mesh.contains("extras") && mesh["extras"].contains("chronormal")) {
        for (const Json& extra : mesh["extras"]["chronormal"]["extras"]) {
          double weight = 0;
          const auto of = [&](const Json& index) { return pose.before[index.get<std::size_t>()]; };
          for (const Json& term : extra["linear"]) weight += term[1].get<double>() * of(term[0]);
          for (const Json& term : extra["quadratic"]) weight += term[2].get<double>() * of(term[0]) * of(term[1]);
          pose.after[extra["target"].get<std::size_t>()] = weight;
        }
      }
      result.push_back(std::move(pose));
    }
  }
  return result;
}

struct Change {
  double before = 0, after = 0;  // sums of errors, in degrees
  double worst_before = 0, worst = 0;
  std::size_t judged = 0;

  [[nodiscard]] double mean_before() const { return before / static_cast<double>(judged); }
  [[nodiscard]] double mean_after() const { return after / static_cast<double>(judged); }
};

Change change(const Baked& baked, const std::vector<Weights>& poses, Rule rule) {
  const test::GltfTruth truth(*baked.before, 0);
  const std::vector<Vector> base = truth.normals_at(std::vector<double>(poses[0].before.size(), 0.0));
  const Json &was = baked.before->json["meshes"][0]["primitives"][0], &is = baked.mesh()["primitives"][0];
  Change result;
  for (const Weights& pose : poses) {
    const std::vector<Vector> exact = truth.normals_at(pose.before);
    for (std::size_t v = 0; v < exact.size(); ++v) {
      if (test::length_of(exact[v]) < 1e-3L * test::length_of(base[v])) continue;
      const Vector right = test::GltfTruth::turn(base[v], truth.vertices[v].stored, exact[v]);
      const double before = test::degrees_between(shown(*baked.before, was, v, pose.before, rule), right);
      const double after = test::degrees_between(shown(*baked.after, is, v, pose.after, rule), right);
      result.before += before;
      result.after += after;
      result.worst = std::max(result.worst, after);
      result.worst_before = std::max(result.worst_before, before);
      ++result.judged;
    }
  }
  return result;
}

// Makes hills with two or three targets, which are activated one after the other and overlap in time.
GltfBuilder moving(std::size_t targets, unsigned seed, double size = 0.4, const char* interpolation = "LINEAR") {
  GltfBuilder builder;
  test::Hills hills(seed);
  std::vector<std::vector<float>> deltas;
  for (std::size_t k = 0; k < targets; ++k) deltas.push_back(hills.deltas(1, size));
  builder.add_node(builder.add_mesh(hills.primitive(builder, deltas), {{"name", "hills"}}));
  builder.add_animation("move");
  std::vector<float> times, values;
  for (std::size_t key = 0; key <= targets + 1; ++key) {
    times.push_back(0.3F * static_cast<float>(key));
    for (std::size_t k = 0; k < targets; ++k)
      values.push_back(key == 0 || key == k + 2 ? 0.0F : key > k ? 1.0F : 0.25F);
  }
  builder.add_track(0, 0, times, values, interpolation);
  return builder;
}

Baked baked(const GltfBuilder& builder, BakeOptions options = {}) {
  options.encoding = options.encoding.value_or(BakeEncoding::kHarmless);
  Baked result = test::bake_document(builder, options);
  EXPECT_EQ(result.error, "");
  return result;
}

BakeOptions for_viewers(const char* names) {
  BakeOptions options;
  options.viewers = find_viewers(names).value();
  return options;
}

const Json& sampler_of(const Baked& of) {
  const Json& a = of.json()["animations"][0];
  return a["samplers"][a["channels"][0]["sampler"].get<std::size_t>()];
}

TEST(BakeHarmless, is_as_near_in_viewers_of_unit_normals_as_in_those_that_add_up) {
  double before = 0, sum = 0, unit = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    const Baked result = baked(moving(2, seed));
    const std::vector<Weights> poses = on_track(result);
    const Change of_sum = change(result, poses, Rule::kSum), of_unit = change(result, poses, Rule::kUnit);
    EXPECT_NEAR(of_sum.mean_after(), of_unit.mean_after(), 1e-3);
    before += of_sum.mean_before() / 12;
    sum += of_sum.mean_after() / 12;
    unit += of_unit.mean_after() / 12;
  }
  RecordProperty("before", std::to_string(before));
  RecordProperty("after", std::to_string(sum));
  EXPECT_LT(sum, 0.1 * before);
  EXPECT_LT(unit, 0.1 * before);
}

TEST(BakeHarmless, every_target_has_unit_normals_and_no_component_beyond_1) {
  GltfBuilder turning;  // a sheet that turns by 100 degrees
  test::Hills hills(3);
  std::vector<float> over = hills.positions;
  for (std::size_t i = 0; i < over.size(); i += 3) {
    const float x = over[i], z = over[i + 2], c = -0.1736F, s = 0.9848F;
    over[i] = c * x + s * z - x;
    over[i + 1] = 0;
    over[i + 2] = c * z - s * x - z;
  }
  turning.add_node(turning.add_mesh(hills.primitive(turning, {over, hills.deltas()}), {{"name", "hills"}}));
  turning.add_animation("over");
  turning.add_track(0, 0, std::vector<float>{0, 1, 2}, std::vector<float>{0, 0, 1, 0, 1, 1});
  std::size_t added = 0;
  for (const GltfBuilder& builder : {moving(3, 5), moving(2, 6, 1.5), turning}) {
    const Baked result = baked(builder);
    const Json& primitive = result.mesh()["primitives"][0];
    const std::vector<float> normals = result.numbers(primitive["attributes"]["NORMAL"]);
    added += result.report.added_targets;
    for (const Json& target : primitive["targets"]) {
      const std::vector<float> deltas = result.numbers(target["NORMAL"]);
      for (std::size_t v = 0; 3 * v < deltas.size(); ++v) {
        Real square = 0;
        for (std::size_t c = 3 * v; c < 3 * v + 3; ++c) {
          EXPECT_LE(std::fabs(deltas[c]), 1.0F);
          square += (static_cast<Real>(normals[c]) + static_cast<Real>(deltas[c])) *
                    (static_cast<Real>(normals[c]) + static_cast<Real>(deltas[c]));
        }
        EXPECT_NEAR(static_cast<double>(square), 1, 1e-5);
      }
    }
  }
  EXPECT_GT(added, 4U);
}

TEST(BakeHarmless, weights_stay_within_0_and_1_and_tracks_linear_with_the_weights_that_they_had) {
  std::size_t added = 0;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    const Baked result = baked(moving(3, seed));
    EXPECT_EQ(sampler_of(result)["interpolation"], "LINEAR");
    EXPECT_EQ(result.report.converted_tracks, 0U);
    added += result.report.added_targets;
    for (const Weights& pose : on_track(result)) {
      for (std::size_t k = 0; k < pose.before.size(); ++k) EXPECT_NEAR(pose.before[k], pose.after[k], 1e-6);
      for (const double weight : pose.after) {
        EXPECT_GE(weight, 0);
        EXPECT_LE(weight, 1.0001);
      }
    }
  }
}

TEST(BakeHarmless, steps_and_splines_keep_their_keys) {
  GltfBuilder spline = test::hills_document(2);
  spline.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 0, 0, 1, 2, 0, 0, 1, 0.5F, 0, 0},
                   "CUBICSPLINE");
  for (const GltfBuilder& builder : {moving(2, 3, 0.4, "STEP"), spline}) {
    const Baked result = baked(builder);
    EXPECT_EQ(sampler_of(result)["interpolation"], builder.json["animations"][0]["samplers"][0]["interpolation"]);
    EXPECT_EQ(sampler_of(result)["input"], builder.json["animations"][0]["samplers"][0]["input"]);
    const std::vector<Weights> poses = on_track(result);
    for (const Weights& pose : poses) {
      for (std::size_t k = 0; k < 2; ++k) EXPECT_NEAR(pose.before[k], pose.after[k], 1e-6);
    }
    EXPECT_LE(change(result, on_track(result), Rule::kSum).worst,
              change(result, on_track(result), Rule::kSum).worst_before + 0.5);
  }
}

// Gives the targets of the hills the normal deltas that a bake writes, with added noise.
GltfBuilder with_deltas(GltfBuilder builder, BakeEncoding encoding, unsigned seed, double noise) {
  BakeOptions options;
  options.encoding = encoding;
  const Baked right = test::bake_document(test::still_hills_document(2, seed), options);
  test::Hills random(seed + 100);
  for (std::size_t k = 0; k < 2; ++k) {
    std::vector<float> deltas = right.numbers(right.mesh()["primitives"][0]["targets"][k]["NORMAL"]);
    for (float& c : deltas) c += random.uniform(-noise, noise);
    builder.json["meshes"][0]["primitives"][0]["targets"][k]["NORMAL"] = builder.add_positions(deltas);
  }
  return builder;
}

// Over a whole surface, neither the average error nor the worst error may grow by more than the tolerance, even if
// single normals become worse.
TEST(BakeHarmless, no_surface_is_worse_than_before_whatever_normals_the_author_gave) {
  std::size_t changed = 0;
  for (unsigned seed = 1; seed <= 6; ++seed) {
    for (const BakeEncoding encoding : {BakeEncoding::kHarmless, BakeEncoding::kSmallest}) {
      for (const double noise : {0.0, 0.02, 0.5}) {
        SCOPED_TRACE(std::string(name_of(encoding)) + ", " + std::to_string(seed) + ", " + std::to_string(noise));
        GltfBuilder builder = test::hills_document(2, seed);
        builder.add_track(0, 0, std::vector<float>{0, 1, 2, 3}, std::vector<float>{0, 0, 1, 0.25F, 0.5F, 1, 0, 0.5F});
        builder = with_deltas(std::move(builder), BakeEncoding::kEndpoint, seed, noise);
        BakeOptions geometric;  // the true normals of this test follow from areas alone
        geometric.weighting = Weighting::kArea;
        geometric.encoding = encoding;
        const Baked result = baked(builder, geometric);
        changed += result.report.changed ? 1U : 0U;
        for (const std::vector<Weights>& poses : {on_track(result), alone(result)}) {
          const Change found = change(result, poses, Rule::kSum);
          EXPECT_LE(found.mean_after(), std::max(found.mean_before() + 0.03, 0.7));
          if (encoding == BakeEncoding::kSmallest) {
            EXPECT_LE(found.worst, std::max(1.05 * found.worst_before + 0.03, 0.6));
          }
        }
      }
    }
  }
  EXPECT_GT(changed, 20U) << "else this says nothing";
}

TEST(BakeHarmless, extra_targets_stay_within_the_room_of_the_viewers) {
  GltfBuilder builder = test::hills_document(24, 2);
  std::vector<float> values(24, 0.0F);
  for (int k = 0; k < 24; ++k) values.push_back(0.3F);
  builder.add_track(0, 0, std::vector<float>{0, 1}, values);
  const Baked all = baked(builder);
  EXPECT_LE(all.mesh()["primitives"][0]["targets"].size(), 256U);
  const Baked three = baked(builder, for_viewers("three"));
  EXPECT_EQ(three.report.meshes[0].left_out, 0U);
}

// A bake prefers short deltas of correction targets with large weights. A bake must not write such deltas if errors
// would then grow in viewers that store unit normals.
TEST(BakeHarmless, a_plain_bake_is_nearly_right_where_deltas_add_up_and_no_worse_where_they_do_not) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    BakeOptions plain;
    plain.encoding = BakeEncoding::kSmallest;
    const Baked result = baked(moving(2, seed), plain);
    const Change sum = change(result, on_track(result), Rule::kSum),
                 unit = change(result, on_track(result), Rule::kUnit);
    EXPECT_LT(sum.mean_after(), 0.1 * sum.mean_before());
    EXPECT_LT(unit.mean_after(), 0.8 * unit.mean_before());
    EXPECT_LE(unit.worst, 1.02 * unit.worst_before);
  }
}

TEST(BakeHarmless, the_report_says_what_each_viewer_shows) {
  const Baked result = baked(moving(2, 4), for_viewers("three,filament"));
  const std::vector<ViewerChange>& viewers = result.report.meshes[0].viewers;
  ASSERT_EQ(viewers.size(), 2U);
  for (const ViewerChange& viewer : viewers) {
    const auto& [before, after] = viewer.poses[0];
    EXPECT_GT(before.judged, 300U);
    EXPECT_LT(after.mean, before.mean);
    EXPECT_LE(after.worst, before.worst);
    EXPECT_LE(viewer.poses[1].after.mean, viewer.poses[1].before.mean);
    EXPECT_LE(viewer.poses[1].after.worst, viewer.poses[1].before.worst);
  }
  std::vector<Weights> poses = on_track(result);
  const std::vector<Weights> of_targets = alone(result);
  poses.insert(poses.end(), of_targets.begin(), of_targets.end());
  EXPECT_NEAR(change(result, poses, Rule::kSum).worst, viewers[0].poses[0].after.worst, 0.5);
}

TEST(BakeHarmless, the_mean_of_the_report_is_over_all_vertices) {
  // All vertices have similar errors, so the average over all vertices is not much smaller than the worst error.
  const Baked result = test::bake_document(test::with_misleading_normals(test::still_hills_document(2)));
  ASSERT_EQ(result.error, "");
  const ViewerChange& viewer = result.report.meshes[0].viewers.at(0);
  const ShownErrors& alone = viewer.poses[1].before;
  EXPECT_GT(alone.worst, 90);
  EXPECT_GT(alone.mean, 0.3 * alone.worst);
  EXPECT_LE(alone.mean, alone.most);
  EXPECT_LE(alone.most, alone.worst);
}

TEST(BakeHarmless, exact_is_right_at_weight_1_without_its_extra_targets) {
  BakeOptions options;
  options.encoding = BakeEncoding::kExact;
  for (unsigned seed = 1; seed <= 4; ++seed) {
    GltfBuilder builder = test::hills_document(1, seed);
    builder.add_track(0, 0, std::vector<float>{0, 1}, std::vector<float>{0, 1});
    const Baked result = baked(builder, options);
    ASSERT_EQ(result.report.added_targets, 1U);
    EXPECT_LT(change(result, {{{1}, {1, 0}}, {{0}, {0, 0}}}, Rule::kSum).worst, 1e-3);
    EXPECT_GT(change(result, {{{0.5}, {0.5, 0}}}, Rule::kSum).worst, 0.5) << "and between them it needs these";
  }
}

// A correction target for a single target must give true normals halfway between the keys, where the weight of the
// correction target is largest.
TEST(BakeHarmless, what_a_target_corrects_of_itself_makes_it_right_half_way) {
  for (const Lengths lengths : {Lengths::kUnit, Lengths::kShort, Lengths::kFree}) {
    GltfBuilder builder = test::hills_document(1, 5);
    builder.add_track(0, 0, std::vector<float>{0, 1, 2}, std::vector<float>{0, 0.3F, 1});
    const test::GltfFixture file(builder);
    const GltfShading shading = read_gltf_shading(*file, 0).value();
    const AuthorTruth truth(shading, Weighting::kArea);
    const NormalTerms terms(shading, truth);
    MeshPlan plan;
    plan.is_driven = true;
    plan.largest.assign(shading.groups.size(), 1.0);
    const DeltaSource source{shading, terms, plan, shading.normals};
    const RightNormals rights(shading, terms, shading.normals, plan.largest);
    const MeshWeights weights = read_weights(*file, shading).value();
    const std::array<Viewer, 1> viewer = {kViewers[0]};
    const Judge judge(source, rights, weights, viewer, 1, false);
    const Candidate made = products_candidate({source, rights, weights, judge, viewer, lengths, 1e-6, 100});
    ASSERT_GT(made.extras.size(), 0U);
    const auto worst_at = [&](double w, bool with_extras) {
      double most = 0;
      const std::vector<Vec3d> normals = rights.of_elements(std::vector<double>{w});
      const std::vector<double> pose = made.drivers.with_extras({w});
      for (const std::uint32_t v : judge.vertices()) {
        Vec3d shown = rights.stored(v) + w * to_double(made.own[0].at(v));
        for (std::size_t k = 0; k < made.extras.size() && with_extras; ++k)
          shown = shown + pose[1 + k] * to_double(made.extras[k].at(v));
        const Vec3d right = rights.of_vertex(v, normals[shading.element_of_vertex[v]]);
        most = std::max(most, angle_between(shown, right) * kDegreesPerRadian);
      }
      return most;
    };
    EXPECT_LT(worst_at(1, true), 1e-3);
    EXPECT_LT(worst_at(0.5, true), 1e-3) << "lengths " << static_cast<int>(lengths);
    EXPECT_GT(worst_at(0.5, false), 1) << "else there is nothing to correct";
  }
}

}  // namespace
}  // namespace chronormal::bake_harmless_test
