#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/bake.h"
#include "tests/support/audit_fixture.h"
#include "tests/support/gltf_compressed.h"
#include "tests/support/skinned_mesh.h"
#include "workflow/json/json.h"

namespace chronormal::skinned_audit_test {
namespace {

using test::audit_of;
using test::GltfBuilder;
using test::GltfFixture;
using test::Real;
using test::Rows;
using test::SeenErrors;
using test::ShadedMesh;
using test::Skin;
using test::Trs;
using Json = GltfBuilder::Json;
using Kind = AuditFinding::Kind;

constexpr std::size_t kSide = 5, kTargets = 2;

const AuditFinding* find(const Audit& audit, Kind kind) {
  const auto found = std::find_if(audit.findings.begin(), audit.findings.end(),
                                  [&](const AuditFinding& finding) { return finding.kind == kind; });
  return found == audit.findings.end() ? nullptr : &*found;
}

// Makes a skin with three joints and two sets of weights, whose sum is not 1.
Skin random_skin(fixtures::Random& random, std::size_t vertices) {
  Skin skin;
  for (std::size_t j = 0; j < 3; ++j) {
    std::array<float, 16>& bind = skin.inverse_binds.emplace_back();
    bind = {1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
    for (std::size_t c = 0; c < 4; ++c)
      for (std::size_t r = 0; r < 3; ++r) bind[4 * c + r] += static_cast<float>(random.uniform(-0.2, 0.2));
  }
  for (std::size_t n = 0; n < 2; ++n) {
    skin.joints.emplace_back();
    skin.weights.emplace_back();
    for (std::size_t i = 0; i < 4 * vertices; ++i) {
      skin.joints.back().push_back(static_cast<std::uint8_t>(random.below(3)));
      skin.weights.back().push_back(random.below(3) == 0 ? 0 : static_cast<float>(random.uniform(0.1, 0.9)));
    }
  }
  return skin;
}

Trs random_place(fixtures::Random& random, double scale) {
  Trs place;
  Real length = 0;
  for (Real& c : place.translation) c = random.uniform(-2, 2);
  for (Real& c : place.rotation) {
    c = random.uniform(-1, 1);
    length += c * c;
  }
  for (Real& c : place.rotation) c /= std::sqrt(length);
  for (Real& c : place.scale) c = 1 + random.uniform(-scale, scale);
  return place;
}

// The nodes of a rig. Node 0 has the mesh, and its own transform must have no effect. Node 1 is a joint, and so is its
// child, node 2. Node 3 is a joint and a child of node 4, which has a matrix.
struct Rig {
  Trs one, two, three;
  Rows four = {{{{1, 0.25, 0, 2}, {0, 1, 0.5, 0}, {0.125, 0, 1, -1}}}};

  void add_to(GltfBuilder& builder) const {
    builder.json["nodes"][0]["translation"] = {3, 4, 5};
    Json first = one.json();
    first["children"] = {2};
    builder.add("nodes", first);
    builder.add("nodes", two.json());
    builder.add("nodes", three.json());
    Json matrix = Json::array();
    for (std::size_t c = 0; c < 4; ++c) {
      for (std::size_t r = 0; r < 3; ++r) matrix.push_back(static_cast<double>(four.m[r][c]));
      matrix.push_back(c == 3 ? 1 : 0);
    }
    builder.add("nodes", {{"matrix", matrix}, {"children", {3}}});
  }
  [[nodiscard]] std::vector<Rows> world() const {
    return {one.rows(), test::after(one.rows(), two.rows()), test::after(four, three.rows())};
  }
};

struct Sums {
  std::size_t count = 0;
  double sum = 0, worst = 0;

  void add(double error) {
    ++count;
    sum += error;
    worst = std::max(worst, error);
  }
  [[nodiscard]] double mean() const { return sum / static_cast<double>(count); }
};

void expect_subject(const AuditSubject& subject, const Sums& shown, const Sums& skinning) {
  EXPECT_EQ(subject.error.judged, shown.count);
  EXPECT_NEAR(subject.error.worst, shown.worst, 2e-5);
  EXPECT_NEAR(subject.error.mean(), shown.mean(), 1e-5);
  ASSERT_TRUE(subject.skinning);
  EXPECT_EQ(subject.skinning->judged, skinning.count);
  EXPECT_NEAR(subject.skinning->worst, skinning.worst, 1e-6);
  EXPECT_NEAR(subject.skinning->mean(), skinning.mean(), 1e-7);
}

// ---- errors that the oracle computes

TEST(SkinnedAudit, targets_are_seen_through_the_skin_as_the_file_poses_it) {
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    fixtures::Random random(seed);
    const ShadedMesh mesh = test::random_sheet(seed, kSide, kTargets, 0.2);
    const Skin skin = random_skin(random, mesh.vertices());
    const Rig rig{random_place(random, 0.5), random_place(random, 0.5), random_place(random, 0.5)};
    GltfBuilder builder = mesh.file();
    rig.add_to(builder);
    skin.add_to(builder, {1, 2, 3});
    const Audit result = audit_of(builder);
    ASSERT_EQ(result.subjects.size(), kTargets);
    double most = 0;
    for (std::size_t k = 0; k < kTargets; ++k) {
      Sums shown, skinning;
      for (std::size_t i = 0; i <= 20; ++i) {
        std::vector<double> weights(kTargets);
        weights[k] = static_cast<double>(i) / 20;
        for (std::size_t v = 0; v < mesh.vertices(); ++v) {
          const SeenErrors errors = test::seen_errors(mesh, skin, rig.world(), v, weights);
          shown.add(errors.shown);
          skinning.add(errors.skinning);
        }
      }
      expect_subject(result.subjects[k], shown, skinning);
      most = std::max(most, skinning.worst);
    }
    const AuditFinding* note = find(result, Kind::kSkinned);
    ASSERT_NE(note, nullptr);
    EXPECT_FALSE(note->is_fault());
    EXPECT_EQ(note->count, 1U);
    EXPECT_NEAR(note->degrees, most, 1e-6);
    // The audit without the skin must have different errors.
    EXPECT_GT(std::fabs(audit_of(builder, {.skins = false}).error.mean() - result.error.mean()), 0.05) << seed;
  }
}

TEST(SkinnedAudit, viewers_see_the_same_normals_through_a_skin_in_ways_of_their_own) {
  const ShadedMesh mesh = test::random_sheet(11, kSide, 1, 0.2);
  fixtures::Random random(11);
  const Skin skin = random_skin(random, mesh.vertices());
  Rig rig{random_place(random, 0.5), random_place(random, 0.5), random_place(random, 0.5)};
  rig.three.scale[1] *= -1;  // this joint mirrors, the others do not
  GltfBuilder builder = mesh.file();
  rig.add_to(builder);
  skin.add_to(builder, {1, 2, 3});
  AuditOptions options;
  for (const SkinRule rule : {SkinRule::kBlended, SkinRule::kInverseTranspose, SkinRule::kByJoint, SkinRule::kBlended})
    options.viewers.emplace_back().skins = rule;
  const Audit result = audit_of(builder, options);
  const std::array rules = {test::Carry::kBlended, test::Carry::kInverseTranspose, test::Carry::kByJoint,
                            test::Carry::kBlended};
  for (std::size_t h = 0; h < rules.size(); ++h) {
    Sums shown;
    for (std::size_t i = 0; i <= 20; ++i)
      for (std::size_t v = 0; v < mesh.vertices(); ++v)
        shown.add(test::seen_errors(mesh, skin, rig.world(), v, {static_cast<double>(i) / 20}, rules[h]).shown);
    EXPECT_EQ(result.viewers[h].error.judged, shown.count);
    EXPECT_NEAR(result.viewers[h].error.worst, shown.worst, 2e-5) << h;
    EXPECT_NEAR(result.viewers[h].error.mean(), shown.mean(), 1e-5) << h;
  }
  EXPECT_EQ(result.viewers[0].error.sum, result.error.sum);
  EXPECT_GT(std::fabs(result.viewers[1].error.mean() - result.error.mean()), 0.1);
  EXPECT_GT(std::fabs(result.viewers[2].error.mean() - result.viewers[1].error.mean()), 0.1);
}

// Returns the value of a track at a time, by the formulas of the glTF specification. If `just_before` is true and the
// time is that of a keyframe, uses the interval before the keyframe.
template <std::size_t N>
std::array<Real, N> value_at(const std::string& interpolation, const std::vector<float>& times,
                             const std::vector<float>& values, double time, bool just_before) {
  const bool cubic = interpolation == "CUBICSPLINE";
  const auto value = [&](std::size_t key, std::size_t which, std::size_t c) {
    return static_cast<Real>(values[(cubic ? 3 * key + which : key) * N + c]);
  };
  std::size_t key = 0;
  while (key + 1 < times.size() && (just_before ? times[key + 1] < time : times[key + 1] <= time)) ++key;
  std::array<Real, N> result{};
  for (std::size_t c = 0; c < N; ++c) result[c] = value(key, 1, c);
  if (time <= times.front() || key + 1 == times.size() || interpolation == "STEP") return result;
  const Real d = static_cast<Real>(times[key + 1]) - times[key], t = (time - times[key]) / d;
  if (cubic) {
    for (std::size_t c = 0; c < N; ++c)
      result[c] = (2 * t * t * t - 3 * t * t + 1) * value(key, 1, c) +
                  d * (t * t * t - 2 * t * t + t) * value(key, 2, c) +
                  (3 * t * t - 2 * t * t * t) * value(key + 1, 1, c) + d * (t * t * t - t * t) * value(key + 1, 0, c);
    return result;
  }
  std::array<Real, N> to{};
  for (std::size_t c = 0; c < N; ++c) to[c] = value(key + 1, 1, c);
  Real s = 1 - t, r = t;
  if (N == 4) {  // rotations are interpolated by slerp
    Real cosine = 0, a = 0, b = 0;
    for (std::size_t c = 0; c < N; ++c) {
      a += result[c] * result[c];
      b += to[c] * to[c];
    }
    for (std::size_t c = 0; c < N; ++c) {
      result[c] /= std::sqrt(a);
      to[c] /= std::sqrt(b);
      cosine += result[c] * to[c];
    }
    const Real angle = std::acos(std::fabs(cosine));
    s = std::sin((1 - t) * angle) / std::sin(angle);
    r = (cosine < 0 ? -1 : 1) * std::sin(t * angle) / std::sin(angle);
  }
  for (std::size_t c = 0; c < N; ++c) result[c] = s * result[c] + r * to[c];
  return result;
}

// An animation channel of a node, which can be evaluated at any time.
struct Channel {
  std::string path, interpolation;
  std::vector<float> times, values;

  Channel(fixtures::Random& random, std::string of, std::string by)
      : path(std::move(of)), interpolation(std::move(by)) {
    const std::size_t width = path == "rotation" ? 4 : 3;
    for (const float time : {0.125F, 0.75F, 1.0F, 1.875F}) {
      times.push_back(time);
      for (std::size_t n = 0; n < (interpolation == "CUBICSPLINE" ? 3 * width : width); ++n)
        values.push_back(static_cast<float>(path == "scale" ? random.uniform(0.5, 1.5) : random.uniform(-1, 1)));
    }
  }
  void add_to(GltfBuilder& builder, std::size_t animation, std::size_t node, bool by_pointer) const {
    Json& json = builder.json["animations"][animation];
    const std::size_t input = builder.add_accessor("SCALAR", times),
                      output = builder.add_accessor(path == "rotation" ? "VEC4" : "VEC3", values);
    Json& samplers = builder.json["animations"][animation]["samplers"];
    Json target = {{"node", node}, {"path", path}};
    if (by_pointer) {
      const std::string pointer = "/nodes/" + std::to_string(node) + "/" + path;
      target = {{"path", "pointer"}, {"extensions", {{"KHR_animation_pointer", {{"pointer", pointer}}}}}};
    }
    json["channels"].push_back({{"sampler", samplers.size()}, {"target", target}});
    samplers.push_back({{"input", input}, {"output", output}, {"interpolation", interpolation}});
  }
};

TEST(SkinnedAudit, tracks_are_seen_in_the_pose_of_their_animation_at_that_time) {
  const std::vector<std::string> kinds = {"LINEAR", "STEP", "CUBICSPLINE"};
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    fixtures::Random random(100 + seed);
    const ShadedMesh mesh = test::random_sheet(seed, kSide, kTargets, 0.2);
    const Skin skin = random_skin(random, mesh.vertices());
    const Rig rig{random_place(random, 0.3), random_place(random, 0.3), random_place(random, 0.3)};
    GltfBuilder builder = mesh.file();
    rig.add_to(builder);
    skin.add_to(builder, {1, 2, 3});
    const std::size_t animation = builder.add_animation("talk");
    const std::vector<float> times = {0.25F, 1, 1.5F};
    std::vector<float> keys = {0, 0.5F, 1, 0.25F, 0.5F, 1};
    if (seed % 2 == 0) keys = {0, 0.5F, 1, 0.25F, 1, 0.25F};  // only joints move between the last two keys
    builder.add_track(animation, 0, times, keys);
    const Channel turn(random, "rotation", kinds[seed % 3]), grow(random, "scale", kinds[(seed + 1) % 3]),
        move(random, "translation", kinds[(seed + 2) % 3]), other(random, "rotation", kinds[(seed + 1) % 3]);
    turn.add_to(builder, animation, 1, false);
    grow.add_to(builder, animation, 2, seed % 2 == 0);
    move.add_to(builder, animation, 2, false);
    other.add_to(builder, animation, 0, false);  // the transform of the node with the mesh turns no normals
    // An animation that is not selected must have no effect.
    other.add_to(builder, builder.add_animation("walk"), 2, false);
    const Audit result = audit_of(builder, {.animation = "talk"});
    ASSERT_EQ(result.subjects.size(), 1U);
    Sums shown, skinning;
    for (std::size_t s = 0; s < 2; ++s) {
      for (std::size_t i = 0; i <= 20; ++i) {
        const double t = static_cast<double>(i) / 20;
        const double time = i == 20 ? times[s + 1] : (1 - t) * times[s] + t * times[s + 1];
        std::vector<double> weights;
        for (std::size_t k = 0; k < kTargets; ++k)
          weights.push_back((1 - t) * keys[kTargets * s + k] + t * keys[kTargets * (s + 1) + k]);
        Rig posed = rig;
        posed.one.rotation = value_at<4>(turn.interpolation, turn.times, turn.values, time, i == 20);
        posed.two.scale = value_at<3>(grow.interpolation, grow.times, grow.values, time, i == 20);
        posed.two.translation = value_at<3>(move.interpolation, move.times, move.values, time, i == 20);
        for (std::size_t v = 0; v < mesh.vertices(); ++v) {
          const SeenErrors errors = test::seen_errors(mesh, skin, posed.world(), v, weights);
          shown.add(errors.shown);
          skinning.add(errors.skinning);
        }
      }
    }
    expect_subject(result.subjects[0], shown, skinning);
  }
}

// ---- invariants

// Returns all errors of an audit in a list, which can be compared with ==.
std::vector<double> figures(const Audit& audit) {
  std::vector<double> result;
  for (const AuditSubject& subject : audit.subjects)
    result.insert(result.end(), {subject.error.worst, subject.error.sum, subject.error.sum_of_squares,
                                 static_cast<double>(subject.error.judged), subject.at_keys.sum});
  for (const ViewerAudit& viewer : audit.viewers) result.insert(result.end(), {viewer.error.sum, viewer.error.worst});
  return result;
}

// Gives a mesh a skin with one joint, which has this transform. The skin has no inverse bind matrices.
GltfBuilder with_one_joint(const ShadedMesh& mesh, const Json& place) {
  GltfBuilder builder = mesh.file();
  builder.add("nodes", place);
  Skin skin;
  skin.joints.emplace_back(4 * mesh.vertices(), 0);
  skin.weights.emplace_back(4 * mesh.vertices(), 0.25F);
  skin.add_to(builder, {1});
  return builder;
}

TEST(SkinnedAudit, bind_pose_gives_the_figures_without_a_skin_and_so_do_turns_and_even_scales) {
  const ShadedMesh mesh = test::random_sheet(7, kSide, kTargets, 0.2);
  AuditOptions options;
  options.viewers = {kViewers.begin(), kViewers.end()};
  GltfBuilder plain = mesh.file();
  plain.add_track(plain.add_animation(""), 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
  const std::vector<double> expected = figures(audit_of(plain, options));
  for (const Json& place :
       {Json::object(), Json{{"rotation", {0.6, 0, 0, 0.8}}, {"translation", {1, 2, 3}}, {"scale", {0.01, 0.01, 0.01}}},
        Json{{"scale", {-1, 1, 1}}}}) {
    GltfBuilder builder = with_one_joint(mesh, place);
    builder.add_track(builder.add_animation(""), 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
    const Audit result = audit_of(builder, options);
    const std::vector<double> found = figures(result);
    ASSERT_EQ(found.size(), expected.size());
    for (std::size_t i = 0; i < found.size(); ++i) EXPECT_NEAR(found[i], expected[i], 1e-5 * (1 + expected[i])) << i;
    for (const AuditSubject& subject : result.subjects) EXPECT_LT(subject.skinning->worst, 1e-6);
    EXPECT_LT(find(result, Kind::kSkinned)->degrees, 1e-6);
  }
}

TEST(SkinnedAudit, hinge_under_a_joint_that_flattens_has_the_angles_of_a_drawing) {
  // The normal of the folding face goes from (0, 0, 1) to (-1, 0, 0), while the rendered normal of vertex 3 stays (0,
  // 0, 1). On the screen, the joint halves the z of normals. The true normal, (-sin, 0, cos) of the fold angle, is
  // therefore turned towards -x.
  const Audit result = audit_of(with_one_joint(test::hinge(), {{"scale", {1, 1, 0.5}}}), {.samples = 2});
  ASSERT_EQ(result.subjects.size(), 1U);
  const MotionError& error = result.subjects[0].error;
  EXPECT_EQ(error.judged, 6U);
  EXPECT_NEAR(error.worst, 90, 1e-12);
  // At the edge, n is (-1, 0, 1), and its z is halved on the screen.
  const double edge = std::atan2(1, 0.5) * 180 / std::numbers::pi;
  EXPECT_NEAR(error.mean(), (edge + edge + 90) / 6, 1e-12);
  // The normal of the skinned surface is turned in the opposite direction: at the edge, it is (-0.5, 0, 1).
  const double skinned = std::atan2(0.5, 1) * 180 / std::numbers::pi;
  EXPECT_NEAR(result.subjects[0].skinning->worst, edge - skinned, 1e-12);
  EXPECT_EQ(result.subjects[0].skinning->judged, 6U);
}

TEST(SkinnedAudit, what_a_joint_makes_vanish_is_not_judged) {
  const Audit result = audit_of(with_one_joint(test::hinge(), {{"scale", {0, 0, 0}}}));
  ASSERT_EQ(result.subjects.size(), 1U);
  const MotionError& error = result.subjects[0].error;
  EXPECT_EQ(error.judged, 0U);
  EXPECT_EQ(error.unlit, 0U);
  EXPECT_EQ(error.faint, 0U);
  EXPECT_EQ(error.no_normal, 3U * 21);
  EXPECT_EQ(result.subjects[0].skinning->judged, 0U);
  // A joint that scales z by 0 keeps only the x of normals. True normals at the edge then point along x, and nothing
  // remains of the rendered normal (0, 0, 1).
  const Audit flat = audit_of(with_one_joint(test::hinge(), {{"scale", {1, 1, 0}}}), {.samples = 2});
  EXPECT_EQ(flat.subjects[0].error.unlit, 3U);
  EXPECT_EQ(flat.subjects[0].error.no_normal, 3U);
  // A scale of 1e308 makes vectors overflow. Such vectors have no direction, and the sum of the errors must stay
  // finite.
  const Audit huge = audit_of(with_one_joint(test::hinge(), {{"scale", {1e308, 1e308, 1e308}}}));
  EXPECT_TRUE(std::isfinite(huge.error.sum));
}

TEST(SkinnedAudit, bake_makes_right_what_is_seen_and_leaves_what_skinning_does) {
  ShadedMesh mesh = test::random_sheet(3, kSide, kTargets, 0.1);
  for (ShadedMesh::Target& target : mesh.targets) target.normals.clear();
  GltfBuilder builder = with_one_joint(mesh, {{"scale", {1, 1, 0.4}}});
  builder.add_track(builder.add_animation(""), 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
  const GltfFixture fixture(builder);
  const Audit before = audit(*fixture, {}).value();
  GltfEdit edit(*fixture);
  BakeOptions options;
  options.encoding = BakeEncoding::kExact;
  ASSERT_TRUE(bake(*fixture, options, edit).ok());
  const GltfFixture baked(edit.bytes("a.glb").value());
  const Audit after = audit(*baked, {}).value();
  EXPECT_GT(before.error.worst, 5);
  EXPECT_LT(after.error.worst, 0.01);
  EXPECT_GT(find(before, Kind::kSkinned)->degrees, 5);
  EXPECT_NEAR(find(after, Kind::kSkinned)->degrees, find(before, Kind::kSkinned)->degrees, 1e-9);
}

TEST(SkinnedAudit, nodes_of_one_mesh_are_judged_each_through_its_own_skin) {
  const ShadedMesh mesh = test::random_sheet(5, kSide, kTargets, 0.1);
  GltfBuilder builder = with_one_joint(mesh, {{"scale", {1, 1, 0.4}}});
  builder.add("skins", {{"joints", {0}}});
  builder.add_node(0);                 // node 2 has no skin
  builder.add_node(0, {{"skin", 1}});  // the skin of node 3 is rigid
  const std::size_t animation = builder.add_animation("");
  builder.add_track(animation, 0, std::vector<float>{0, 1}, std::vector<float>{0, 0, 1, 1});
  for (const std::size_t node : {2U, 3U}) {
    Json channel = builder.json["animations"][0]["channels"][0];
    channel["target"]["node"] = node;
    builder.json["animations"][0]["channels"].push_back(channel);
  }
  const Audit result = audit_of(builder);
  ASSERT_EQ(result.subjects.size(), 5U);
  const auto worst = [&](std::size_t s) { return result.subjects[s].error.worst; };
  EXPECT_GT(std::fabs(worst(2) - worst(3)), 0.1);
  EXPECT_NEAR(worst(3), worst(4), 1e-5);
  EXPECT_TRUE(result.subjects[2].skinning);
  EXPECT_FALSE(result.subjects[3].skinning);
  EXPECT_LT(result.subjects[4].skinning->worst, 1e-6);
  EXPECT_EQ(find(result, Kind::kSkinned)->count, 2U);
}

TEST(SkinnedAudit, joints_and_weights_that_draco_holds_give_the_same_figures) {
  const ShadedMesh mesh = test::random_sheet(9, kSide, kTargets, 0.2);
  fixtures::Random random(9);
  test::DracoShares shares;
  for (std::size_t i = 0; i < 4 * mesh.vertices(); ++i) {
    shares.joints.push_back(static_cast<std::uint8_t>(random.below(2)));
    shares.weights.push_back(static_cast<float>(random.uniform(0.1, 0.9)));
  }
  const auto add_joints = [](GltfBuilder& builder) {
    builder.add("nodes", {{"scale", {1, 1, 0.4}}});
    builder.add("nodes", {{"rotation", {0.6, 0, 0, 0.8}}});
  };
  GltfBuilder plain = mesh.file();
  add_joints(plain);
  Skin skin;
  skin.joints = {shares.joints};
  skin.weights = {shares.weights};
  skin.add_to(plain, {1, 2});

  GltfBuilder compressed;
  std::vector<Json> targets;
  for (const ShadedMesh::Target& target : mesh.targets)
    targets.push_back({{"POSITION", compressed.add_positions(target.positions)},
                       {"NORMAL", compressed.add_positions(target.normals)}});
  const std::string coded =
      test::draco_mesh(mesh.positions, mesh.corners, test::DracoOrder::kKept, mesh.normals, 0, shares);
  Json primitive = test::draco_primitive(compressed, coded, mesh.vertices(), mesh.corners.size(), true, targets);
  for (const auto& [key, id, type] : {std::tuple("JOINTS_0", 2, 5121), {"WEIGHTS_0", 3, 5126}}) {
    primitive["attributes"][key] = compressed.add_accessor_over(std::nullopt, "VEC4", type, mesh.vertices());
    primitive["extensions"]["KHR_draco_mesh_compression"]["attributes"][key] = id;
  }
  compressed.add_node(compressed.add_mesh(primitive), {{"skin", 0}});
  add_joints(compressed);
  compressed.add("skins", {{"joints", {1, 2}}});

  const Audit result = audit_of(compressed);
  EXPECT_EQ(figures(result), figures(audit_of(plain)));
  EXPECT_NE(figures(result), figures(audit_of(compressed, {.skins = false})));
  EXPECT_EQ(find(result, Kind::kUnreadSkin), nullptr);
}

// ---- skins that cannot be read

TEST(SkinnedAudit, skin_that_cannot_be_read_is_told_with_its_place_and_left_out) {
  const ShadedMesh mesh = test::random_sheet(5, kSide, kTargets, 0.1);
  const std::vector<double> expected = figures(audit_of(mesh.file()));
  GltfBuilder builder = with_one_joint(mesh, {{"scale", {1, 1, 0.4}}});
  builder.json["skins"][0]["joints"] = {1, 7};
  const Audit result = audit_of(builder);
  EXPECT_EQ(figures(result), expected);
  EXPECT_EQ(find(result, Kind::kSkinned), nullptr);
  const AuditFinding* note = find(result, Kind::kUnreadSkin);
  ASSERT_NE(note, nullptr);
  EXPECT_EQ(note->count, 1U);
  EXPECT_FALSE(note->is_fault());
  EXPECT_EQ(note->reason->place, "a.gltf, /skins/0/joints/1");
  const Json json = Json::parse(audit_json("a.gltf", result, {}));
  EXPECT_EQ(json["findings"].back()["kind"], "unread_skin");
  EXPECT_EQ(json["findings"].back()["reason"], note->reason->text());
  EXPECT_TRUE(json["subjects"][0]["skinning_worst_degrees"].is_null());
}

}  // namespace
}  // namespace chronormal::skinned_audit_test
