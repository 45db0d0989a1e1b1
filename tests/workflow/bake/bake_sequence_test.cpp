// Tests animated GLB files that bakes of sequences write, with an independent reader.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/bake.h"
#include "core/text.h"
#include "io/gltf/gltf_motion.h"
#include "tests/support/fixtures.h"
#include "tests/support/places.h"
#include "tests/support/read_input.h"
#include "tests/support/reference.h"
#include "tests/support/shown_glb.h"
#include "tests/support/temporary_folder.h"

namespace chronormal::bake_sequence_test {
namespace {

namespace fs = std::filesystem;
using fixtures::Random;
using reference::VectorD;
using test::ShownGlb;

constexpr double kDegree = std::numbers::pi / 180;
// A viewer that adds up deltas. If no viewer is named, a bake warns about viewers that do not add up deltas.
const std::vector<Viewer> kAddingUp = {kViewers[0]};

// The vertices of each face of a file, and for each vertex the group of vertices that share its normal.
struct Surface {
  std::vector<std::vector<std::uint32_t>> faces;
  std::vector<std::size_t> group;
};

// Returns the surface of a motion in which all edges are smooth. The surface has the faces of the motion, and vertices
// that coincide in all keyframes share a normal.
Surface smooth_surface(const Motion& motion) {
  Surface surface;
  for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
    const auto face = motion.topology.face(f);
    surface.faces.emplace_back(face.begin(), face.end());
  }
  std::map<std::vector<float>, std::size_t> points;
  for (std::size_t v = 0; v < motion.topology.vertex_count(); ++v) {
    std::vector<float> path;
    for (const Motion::Keyframe& key : motion.keyframes) {
      for (std::size_t c = 0; c < 3; ++c) path.push_back(key.positions[3 * v + c] + 0.0F);
    }
    surface.group.push_back(points.emplace(std::move(path), points.size()).first->second);
  }
  return surface;
}

// Returns the surface of a file: its triangles, and a separate normal for every vertex.
Surface split_surface(const ShownGlb& glb) {
  Surface surface;
  for (std::size_t i = 0; i < glb.corners.size(); i += 3)
    surface.faces.push_back({glb.corners[i], glb.corners[i + 1], glb.corners[i + 2]});
  for (std::size_t v = 0; v < glb.vertices(); ++v) surface.group.push_back(v);
  return surface;
}

// Returns n(t) of every group as a sum of cross products of the positions in the file.
std::vector<VectorD> exact_normals(const ShownGlb& glb, const Surface& surface, double time) {
  const std::vector<double> weights = glb.weights(time);
  std::vector<VectorD> positions, groups(surface.group.size(), VectorD{});
  for (std::size_t v = 0; v < glb.vertices(); ++v) positions.push_back(glb.position(v, weights));
  for (const auto& face : surface.faces) {
    VectorD area{};
    for (std::size_t c = 2; c < face.size(); ++c)
      area = reference::add(area, reference::cross(reference::subtract(positions[face[c - 1]], positions[face[0]]),
                                                   reference::subtract(positions[face[c]], positions[face[0]])));
    for (const std::uint32_t v : face) groups[surface.group[v]] = reference::add(groups[surface.group[v]], area);
  }
  return groups;
}

struct Judged {
  double mean = 0, max = 0;  // average and largest error, in degrees
  // The numbers of all samples, and of the samples that are not judged because n is nearly zero.
  std::size_t count = 0, nearly = 0;
};

Judged judge(const ShownGlb& glb, const Surface& surface, int times = 101) {
  Judged judged;
  for (int i = 0; i < times; ++i) {
    const double time = glb.times[0] + (glb.end() - glb.times[0]) * i / (times - 1);
    std::size_t k = 0;
    while (k + 2 < glb.times.size() && time >= glb.times[k + 1]) ++k;
    const std::vector<double> weights = glb.weights(time);
    const auto exact = exact_normals(glb, surface, time), from = exact_normals(glb, surface, glb.times[k]),
               to = exact_normals(glb, surface, glb.times[k + 1]),
               half = exact_normals(glb, surface, 0.5 * (double{glb.times[k]} + double{glb.times[k + 1]}));
    for (std::size_t v = 0; v < glb.vertices(); ++v) {
      const std::size_t g = surface.group[v];
      VectorD middle{};
      for (std::size_t c = 0; c < 3; ++c) middle[c] = 2 * half[g][c] - 0.5 * (from[g][c] + to[g][c]);
      const double largest =
          std::max({reference::length(from[g]), reference::length(to[g]), reference::length(middle)});
      if (largest == 0) continue;
      if (reference::length(exact[g]) < 1e-4 * largest) {
        ++judged.nearly;
        continue;
      }
      const double angle = reference::angle(glb.normal(v, weights), exact[g]) / kDegree;
      judged.max = std::max(judged.max, std::isfinite(angle) ? angle : 1000);
      judged.mean += angle;
      ++judged.count;
    }
  }
  judged.mean /= static_cast<double>(std::max<std::size_t>(judged.count, 1));
  return judged;
}

void expect_exact(const ShownGlb& glb, const Surface& surface) {
  const Judged judged = judge(glb, surface);
  EXPECT_GT(judged.count, 0U);
  EXPECT_LT(judged.max, 0.05);
  EXPECT_LT(judged.mean, 0.01);
}

std::string bake(const Motion& motion, const BakeOptions& options, SequenceBake* baked = nullptr) {
  EXPECT_TRUE(validate(motion).ok());
  std::string glb;
  Result<SequenceBake> result = bake_sequence(motion, options, glb);
  EXPECT_TRUE(result.ok()) << result.error().text();
  if (result && baked != nullptr) *baked = result.value();
  return glb;
}

// Makes a motion of a closed mesh whose vertices move independently of each other. The keys are at uneven times.
Motion wandering(const fixtures::ClosedMesh& mesh, std::size_t keys, double distance, std::uint64_t seed) {
  Motion motion;
  motion.topology = mesh.topology;
  Random random(seed);
  double time = 0;
  for (std::size_t k = 0; k < keys; ++k) {
    Motion::Keyframe key;
    key.time = time;
    for (const auto& point : mesh.points) {
      for (const double c : point) key.positions.push_back(static_cast<float>(c + random.uniform(-distance, distance)));
    }
    motion.keyframes.push_back(std::move(key));
    time += random.uniform(0.01, 2);
  }
  motion.connect_as_sequence();
  return motion;
}

TEST(BakeSequence, exact_normals_are_shown_at_every_instant) {
  for (const double distance : {0.02, 0.2}) {
    const Motion motion = wandering(fixtures::icosphere(2), 5, distance, 1);
    SequenceBake baked;
    const std::string file = bake(motion, {.viewers = kAddingUp}, &baked);
    const ShownGlb glb(file);
    EXPECT_EQ(glb.vertices(), motion.topology.vertex_count());
    EXPECT_EQ(glb.targets(), 8U);
    EXPECT_EQ(baked.keyframes, 5U);
    EXPECT_EQ(baked.targets, 4U);
    EXPECT_EQ(baked.extra_targets, 4U);
    EXPECT_EQ(baked.bytes, file.size());
    EXPECT_EQ(baked.largest_error, 0);
    EXPECT_TRUE(baked.warnings.empty());
    expect_exact(glb, smooth_surface(motion));
  }
}

TEST(BakeSequence, what_is_shown_without_the_extra_targets_is_wrong) {
  const Motion motion = wandering(fixtures::icosphere(2), 3, 0.3, 2);
  const std::string file = bake(motion, {});
  ShownGlb glb(file);
  for (std::size_t i = 2; i < 4; ++i) std::fill(glb.normal_deltas[i].begin(), glb.normal_deltas[i].end(), 0.0F);
  EXPECT_GT(judge(glb, smooth_surface(motion)).max, 1);
}

TEST(BakeSequence, weights_are_hats_and_bubbles_between_the_times_in_the_file) {
  const Motion motion = wandering(fixtures::icosphere(1), 4, 0.1, 3);
  const std::string file = bake(motion, {});
  const ShownGlb glb(file);
  for (std::size_t k = 0; k < 4; ++k)
    EXPECT_EQ(glb.times[k], static_cast<float>(motion.keyframes[k].time)) << "seconds stay seconds";
  for (std::size_t s = 0; s < 3; ++s) {
    for (const double t : {0.0, 0.1, 0.5, 0.93}) {
      const auto w = glb.weights(glb.times[s] + t * (double{glb.times[s + 1]} - double{glb.times[s]}));
      for (std::size_t k = 1; k < 4; ++k)
        EXPECT_NEAR(w[k - 1], k == s ? 1 - t : k == s + 1 ? t : 0, 2e-7) << s << " " << t;
      for (std::size_t b = 0; b < 3; ++b) EXPECT_NEAR(w[3 + b], b == s ? t * (1 - t) : 0, 2e-7) << s << " " << t;
    }
  }
}

// Returns the normal in a viewer that stores only the directions of N and of N + D: N + sum w (unit(N + D) - N).
VectorD unit_rule(const ShownGlb& glb, std::size_t v, const std::vector<double>& weights) {
  VectorD base{}, sum{};
  for (std::size_t c = 0; c < 3; ++c) base[c] = sum[c] = glb.normals[3 * v + c];
  for (std::size_t i = 0; i < weights.size(); ++i) {
    VectorD target = base;
    for (std::size_t c = 0; c < 3; ++c) target[c] += glb.normal_deltas[i][3 * v + c];
    const double size = reference::length(target);
    for (std::size_t c = 0; c < 3; ++c) sum[c] += weights[i] * (target[c] / size - base[c]);
  }
  return sum;
}

TEST(BakeSequence, harmless_is_the_same_by_sums_and_by_directions_and_better_than_lines_between_keys) {
  const Motion motion = wandering(fixtures::icosphere(2), 5, 0.2, 1);
  SequenceBake baked;
  const std::string file = bake(motion, {.encoding = BakeEncoding::kHarmless}, &baked);
  ShownGlb glb(file);
  EXPECT_EQ(glb.json["animations"][0]["samplers"][0]["interpolation"], "LINEAR");
  EXPECT_EQ(baked.targets, 4U);
  EXPECT_EQ(baked.extra_targets, 4U);
  double apart = 0, unit = 0, moved = 0;
  for (int i = 0; i <= 60; ++i) {
    const double time = glb.end() * i / 60;
    const std::vector<double> weights = glb.weights(time);
    for (const double w : weights) EXPECT_TRUE(w >= 0 && w <= 1) << w;
    std::size_t k = 0;
    while (k + 2 < motion.keyframes.size() && time >= motion.keyframes[k + 1].time) ++k;
    const auto &from = motion.keyframes[k], &to = motion.keyframes[k + 1];
    const double t = (time - from.time) / (to.time - from.time);
    for (std::size_t v = 0; v < glb.vertices(); ++v) {
      apart = std::max(apart, reference::angle(glb.normal(v, weights), unit_rule(glb, v, weights)));
      const VectorD shown = glb.position(v, weights);
      for (std::size_t c = 0; c < 3; ++c)
        moved = std::max(moved, std::abs(shown[c] - ((1 - t) * double{from.positions[3 * v + c]} +
                                                     t * double{to.positions[3 * v + c]})));
    }
  }
  for (const std::vector<float>& deltas : glb.normal_deltas) {
    for (std::size_t i = 0; i < deltas.size(); i += 3) {
      VectorD u{};
      for (std::size_t c = 0; c < 3; ++c) u[c] = glb.normals[i + c] + deltas[i + c];
      unit = std::max(unit, std::abs(reference::length(u) - 1));
    }
  }
  EXPECT_LT(apart / kDegree, 1e-3);
  EXPECT_LT(unit, 1e-6);
  EXPECT_LT(moved, 1e-6) << "keys between keys move nothing";
  const Judged bent = judge(glb, smooth_surface(motion));
  EXPECT_LT(bent.max, baked.largest_error + 0.05);
  for (std::size_t i = 4; i < 8; ++i) std::fill(glb.normal_deltas[i].begin(), glb.normal_deltas[i].end(), 0.0F);
  const Judged straight = judge(glb, smooth_surface(motion));
  EXPECT_LT(bent.mean, straight.mean / 4) << straight.mean;
  EXPECT_LT(bent.max, 0.7 * straight.max) << straight.max;
  for (const Motion::Keyframe& key : motion.keyframes) {
    const auto right = exact_normals(glb, smooth_surface(motion), key.time);
    for (std::size_t v = 0; v < glb.vertices(); ++v)
      EXPECT_LT(reference::angle(glb.normal(v, glb.weights(key.time)), right[v]) / kDegree, 1e-3);
  }
}

TEST(BakeSequence, harmless_bends_no_more_segments_than_the_viewers_have_room_for) {
  const Motion motion = wandering(fixtures::icosphere(1), 5, 0.2, 4);
  Viewer small =
      *std::find_if(kViewers.begin(), kViewers.end(), [](const Viewer& viewer) { return viewer.name == "filament"; });
  small.most_targets = 6;
  SequenceBake baked;
  const ShownGlb glb(bake(motion, {.encoding = BakeEncoding::kHarmless, .viewers = {small}}, &baked));
  EXPECT_EQ(baked.targets, 4U);
  EXPECT_EQ(baked.extra_targets, 2U);
  EXPECT_EQ(glb.targets(), 6U);
  EXPECT_TRUE(baked.warnings.empty());
  small.most_targets = 3;
  (void)bake(motion, {.encoding = BakeEncoding::kHarmless, .viewers = {small}}, &baked);
  EXPECT_EQ(baked.extra_targets, 0U);
  ASSERT_EQ(baked.warnings.size(), 1U);
  EXPECT_NE(baked.warnings[0].find("4 targets are too many for Filament"), std::string::npos) << baked.warnings[0];
}

TEST(BakeSequence, harmless_says_which_extra_target_follows_from_which_keys) {
  const Motion motion = wandering(fixtures::icosphere(1), 3, 0.2, 5);
  const ShownGlb glb(bake(motion, {.encoding = BakeEncoding::kHarmless}));
  EXPECT_EQ(glb.json["meshes"][0]["extras"]["chronormal"], R"({"version": 2, "encode": "harmless", "sequence": true,
    "extras": [{"target": 2, "linear": [[0, 4.0]], "quadratic": [[0, 0, -4.0], [1, 0, -4.0]]},
               {"target": 3, "linear": [], "quadratic": [[0, 1, 4.0]]}]})"_json);
}

TEST(BakeSequence, other_forms_say_in_which_viewers_they_can_be_off) {
  const Motion motion = wandering(fixtures::icosphere(1), 3, 0.2, 6);
  for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kEndpoint}) {
    SequenceBake baked;
    (void)bake(motion, {.encoding = encoding}, &baked);
    ASSERT_EQ(baked.warnings.size(), 1U);
    EXPECT_NE(baked.warnings[0].find("can look wrong in Godot 4, Filament"), std::string::npos);
    (void)bake(motion, {.encoding = encoding, .viewers = kAddingUp}, &baked);
    EXPECT_TRUE(baked.warnings.empty());
  }
}

TEST(BakeSequence, one_segment_is_enough) {
  const Motion motion = fixtures::smooth_morph(12);
  const std::string file = bake(motion, {});
  const ShownGlb glb(file);
  EXPECT_EQ(glb.targets(), 2U);
  expect_exact(glb, smooth_surface(motion));
}

TEST(BakeSequence, normals_are_those_of_polygons_and_not_of_their_triangles) {
  const Motion motion = wandering(fixtures::box_grid(3), 3, 0.2, 4);
  const std::string file = bake(motion, {});
  const ShownGlb glb(file);
  ASSERT_EQ(glb.corners.size(), 2 * 3 * motion.topology.face_count());
  for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
    const auto quad = motion.topology.face(f);
    const std::array<std::uint32_t, 6> fan = {quad[0], quad[1], quad[2], quad[0], quad[2], quad[3]};
    EXPECT_TRUE(std::equal(fan.begin(), fan.end(), glb.corners.begin() + static_cast<std::ptrdiff_t>(6 * f)));
  }
  expect_exact(glb, smooth_surface(motion));
  EXPECT_GT(judge(glb, split_surface(glb)).max, 1);  // the normals of triangles alone are different
}

// Makes a sheet of squares that is flat and regular in keyframe 0, where all weightings give the same normals, and hilly
// in all later keyframes. If are_cut is true, the squares are cut into triangles.
Motion flat_at_first(bool are_cut, std::size_t keyframes, std::uint64_t seed) {
  constexpr std::uint32_t kSide = 6;
  Random random(seed);
  std::vector<std::uint32_t> offsets = {0}, corners;
  const auto add_face = [&](std::initializer_list<std::uint32_t> face) {
    corners.insert(corners.end(), face);
    offsets.push_back(static_cast<std::uint32_t>(corners.size()));
  };
  for (std::uint32_t row = 0; row + 1 < kSide; ++row) {
    for (std::uint32_t a = row * kSide; a + 1 < (row + 1) * kSide; ++a) {
      if (are_cut) {
        add_face({a, a + 1, a + kSide + 1});
        add_face({a, a + kSide + 1, a + kSide});
      } else {
        add_face({a, a + 1, a + kSide + 1, a + kSide});
      }
    }
  }
  Motion motion;
  motion.topology = Topology::polygons(kSide * kSide, std::move(offsets), std::move(corners)).value();
  for (std::size_t k = 0; k < keyframes; ++k) {
    Motion::Keyframe& keyframe = motion.keyframes.emplace_back();
    keyframe.time = static_cast<double>(k);
    for (std::uint32_t v = 0; v < kSide * kSide; ++v) {
      for (const std::uint32_t c : {v % kSide, v / kSide, 0U})
        keyframe.positions.push_back(
            static_cast<float>(static_cast<double>(c) + (k == 0 ? 0 : random.uniform(-0.3, 0.3))));
    }
  }
  motion.connect_as_sequence();
  return motion;
}

TEST(BakeSequence, an_audit_knows_the_polygons_of_a_baked_sequence_that_is_flat_at_first) {
  constexpr std::uint64_t kFirstSeed = 1130;
  std::printf("  from seed %d\n", static_cast<int>(kFirstSeed));
  for (std::uint64_t seed = kFirstSeed; seed < kFirstSeed + 8; ++seed) {
    for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kHarmless}) {
      const std::string file = bake(flat_at_first(false, 3, seed), {.encoding = encoding});
      const Result<GltfDocument> document = GltfDocument::read(file, "baked.glb");
      ASSERT_TRUE(document.ok());
      const Result<Audit> found = audit(document.value(), {});
      ASSERT_TRUE(found.ok());
      EXPECT_LT(found.value().error.worst, encoding == BakeEncoding::kExact ? 1e-3 : 3) << "seed " << seed;
    }
  }
}

TEST(BakeSequence, the_weighting_follows_from_later_keyframes_if_the_first_is_flat) {
  constexpr std::uint64_t kSeed = 1131;
  std::printf("  seed %d\n", static_cast<int>(kSeed));
  const Motion motion = flat_at_first(true, 4, kSeed);
  const auto corners = motion.topology.corners();
  // Returns the angle-weighted normal of each corner in a keyframe.
  const auto normals_of = [&](std::size_t k) -> std::vector<float> {
    const auto edge = [&](std::uint32_t from, std::uint32_t to) {
      VectorD result;
      for (std::size_t c = 0; c < 3; ++c)
        result[c] =
            double{motion.keyframes[k].positions[3 * to + c]} - double{motion.keyframes[k].positions[3 * from + c]};
      return result;
    };
    std::vector<VectorD> sums(motion.topology.vertex_count());
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const std::size_t first = c - c % 3;
      const VectorD a = edge(corners[c], corners[first + (c + 1) % 3]),
                    b = edge(corners[c], corners[first + (c + 2) % 3]);
      const VectorD n = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
      const double length = std::hypot(n[0], n[1], n[2]),
                   angle = std::atan2(length, a[0] * b[0] + a[1] * b[1] + a[2] * b[2]);
      for (std::size_t i = 0; i < 3; ++i) sums[corners[c]][i] += angle / length * n[i];
    }
    std::vector<float> result;
    for (const std::uint32_t v : corners)
      for (const double c : sums[v]) result.push_back(static_cast<float>(c));
    return result;
  };
  const std::vector<float> of_first = normals_of(0);
  BakeOptions options{.viewers = kAddingUp};
  options.normal_of_corner = VectorView<const float>::packed(of_first.data(), of_first.size() / 3);
  SequenceBake alone, together, without;
  (void)bake(motion, options, &alone);
  options.normals_of_keyframe = [&](std::size_t k) -> Result<std::vector<float>> { return normals_of(k); };
  (void)bake(motion, options, &together);
  options.normals_of_keyframe = [](std::size_t) -> Result<std::vector<float>> {
    return Error{ErrorCode::kFailed, "", "the file is gone"};
  };
  (void)bake(motion, options, &without);
  EXPECT_EQ(alone.weighting, Weighting::kArea);
  EXPECT_EQ(together.weighting, Weighting::kAngle);
  EXPECT_EQ(without.weighting, Weighting::kArea);
}

TEST(BakeSequence, time_reversal_shows_the_same_normals_at_mirrored_times) {
  const Motion motion = wandering(fixtures::icosphere(1), 4, 0.15, 5);
  Motion reversed = motion;
  std::reverse(reversed.keyframes.begin(), reversed.keyframes.end());
  for (Motion::Keyframe& key : reversed.keyframes) key.time = 16 - key.time;
  const std::string file = bake(motion, {}), back_file = bake(reversed, {});
  const ShownGlb glb(file), back(back_file);
  for (int i = 0; i <= 20; ++i) {
    const double time = glb.end() * i / 20;
    const auto w = glb.weights(time), back_w = back.weights(16 - time);
    for (std::size_t v = 0; v < glb.vertices(); ++v)
      EXPECT_LT(reference::angle(glb.normal(v, w), back.normal(v, back_w)) / kDegree, 0.01) << i;
  }
}

TEST(BakeSequence, coinciding_vertices_show_one_normal) {
  // Makes a roof of two quads with separate vertices at the ridge: vertex 4 is at the position of vertex 3, and vertex
  // 5 at the position of vertex 2.
  Motion motion;
  motion.topology = fixtures::make_polygons(8, {0, 4, 8}, {0, 1, 2, 3, 4, 5, 6, 7});
  Random random(6);
  for (int k = 0; k < 3; ++k) {
    std::vector<float> p = {0, 0, 0, 0, 1, 0, 1, 1, 1, 1, 0, 1, 1, 0, 1, 1, 1, 1, 2, 1, 0, 2, 0, 0};
    for (std::size_t i = 0; i < p.size(); ++i) p[i] += static_cast<float>(random.uniform(-0.3, 0.3));
    std::copy_n(p.begin() + 9, 3, p.begin() + 12);
    std::copy_n(p.begin() + 6, 3, p.begin() + 15);
    motion.keyframes.push_back({p, static_cast<double>(k), ""});
  }
  motion.connect_as_sequence();
  const std::string file = bake(motion, {});
  const ShownGlb glb(file);
  const Surface surface = smooth_surface(motion);
  EXPECT_EQ(surface.group[3], surface.group[4]);
  expect_exact(glb, surface);
  // If the edge at the ridge is hard, the two quads of the roof have separate normals. No vertices are added, since
  // each quad has its own vertices.
  const std::string hard_file = bake(motion, {.crease_angle = 20});
  const ShownGlb hard(hard_file);
  EXPECT_EQ(hard.vertices(), 8U);
  EXPECT_GT(reference::angle(hard.normal(3, hard.weights(0)), hard.normal(4, hard.weights(0))) / kDegree, 20);
}

TEST(BakeSequence, hard_edges_double_vertices_but_no_more_than_needed) {
  const Motion motion = wandering(fixtures::box_grid(4), 3, 0.03, 7);
  SequenceBake baked;
  const std::string file = bake(motion, {.crease_angle = 45}, &baked);
  const ShownGlb glb(file);
  // A cube with 4 x 4 quads per side has 6 x 25 vertices if the vertices of each side are separate.
  EXPECT_EQ(glb.vertices(), 150U);
  EXPECT_EQ(baked.vertices, 150U);
  // In the file, the vertices of the motion precede the added vertices.
  for (std::size_t i = 0; i < motion.keyframes[0].positions.size(); ++i)
    EXPECT_EQ(glb.positions[i], motion.keyframes[0].positions[i]);
  Surface surface = split_surface(glb);
  surface.faces.clear();
  for (std::size_t i = 0; i < glb.corners.size(); i += 6)
    surface.faces.push_back({glb.corners[i], glb.corners[i + 1], glb.corners[i + 2], glb.corners[i + 5]});
  expect_exact(glb, surface);
}

TEST(BakeSequence, corners_of_faces_without_area_do_not_count_as_errors) {
  // A flat sheet of four triangles turns over. A hard edge separates a face without area from it, so the corners of
  // this face get vertices of their own, whose normals say nothing.
  for (const std::uint32_t last : {3U, 6U}) {
    Motion motion;
    motion.topology = Topology::triangles(7, {0, 3, 4, 0, 4, 1, 1, 4, 5, 1, 5, 2, 0, 3, last}).value();
    motion.keyframes = {{{0, 0, 0, 0, 1, 0, 0, 2, 0, 1, 0, 0, 1, 1, 0, 1, 2, 0, 1, 0, 0}, 0, ""},
                        {{0, 0, 0, 0, -1, 0, 0, -2, 0, 1, 0, 0.1F, 1, -1, 0.1F, 1, -2, 0.1F, 1, 0, 0.1F}, 1, ""}};
    motion.connect_as_sequence();
    const std::string file = bake(motion, {.crease_angle = 45});
    const Result<GltfDocument> document = GltfDocument::read(file, "a.glb");
    ASSERT_TRUE(document.ok()) << document.error().text();
    const Result<Audit> found = audit(document.value(), {});
    ASSERT_TRUE(found.ok()) << found.error().text();
    EXPECT_GT(found.value().error.judged, 0U);
    EXPECT_LT(found.value().error.worst, 0.05) << "corner " << last;
  }
}

// Makes a sheet that is a point in its first keyframe or, if keep_half, a line.
Motion unfolding(bool keep_half) {
  Motion motion = fixtures::smooth_morph(6);
  motion.keyframes.push_back(motion.keyframes[1]);
  motion.keyframes[1] = motion.keyframes[0];
  motion.keyframes[1].time = 1;
  motion.keyframes[2].time = 3;
  std::vector<float>& first = motion.keyframes[0].positions;
  for (std::size_t v = keep_half ? first.size() / 6 : 0; v < first.size() / 3; ++v)
    std::fill_n(&first[3 * v], 3, 0.25F);
  motion.connect_as_sequence();
  return motion;
}

TEST(BakeSequence, a_first_keyframe_without_area_gets_a_target_of_its_own) {
  for (const bool keep_half : {false, true}) {
    const Motion motion = unfolding(keep_half);
    SequenceBake baked;
    const std::string file = bake(motion, {.viewers = kAddingUp}, &baked);
    const ShownGlb glb(file);
    EXPECT_EQ(baked.targets, 3U);
    ASSERT_EQ(baked.warnings.size(), 1U);
    EXPECT_NE(baked.warnings[0].find("keyframe 0"), std::string::npos);
    EXPECT_EQ(glb.json["meshes"][0]["weights"][0], 1);
    EXPECT_EQ(glb.json["meshes"][0]["extras"]["chronormal"]["extras"][0],
              R"({"target": 3, "linear": [], "quadratic": [[0, 1, 1.0]]})"_json);
    const Judged judged = judge(glb, smooth_surface(motion));
    EXPECT_LT(judged.max, 0.05);
    EXPECT_LT(judged.mean, 0.01);
    for (std::size_t v = 0; v < glb.vertices(); ++v)
      EXPECT_NEAR(reference::length(glb.normal(v, std::vector<double>(glb.targets(), 0.0))), 1, 1e-6);
  }
}

TEST(BakeSequence, elements_that_shrink_a_million_times_keep_their_directions) {
  Motion motion = wandering(fixtures::icosphere(1), 4, 0.2, 8);
  for (std::size_t k = 1; k < 3; ++k) {
    for (float& c : motion.keyframes[k + 1].positions) c *= 0x1p-12F;  // divides areas by 2^24
  }
  SequenceBake baked;
  const std::string file = bake(motion, {.viewers = kAddingUp}, &baked);
  const ShownGlb glb(file);
  EXPECT_EQ(baked.warnings.size(), 1U);
  // The file stores positions as base + delta. The sphere has shrunk to half a millionth of its size, so rounding the
  // positions changes the surface. The normals must fit the rounded positions.
  expect_exact(glb, smooth_surface(motion));
}

// Elements shrink or appear only near the end of the motion. A bake that looks only at the first segments would not
// notice this.
TEST(BakeSequence, elements_that_shrink_or_appear_at_the_end_are_right_from_the_start) {
  const test::TemporaryFolder folder;
  for (const bool appears : {false, true}) {
    Motion motion = wandering(fixtures::icosphere(1), 6, 0.2, 9);
    if (appears) {
      // All vertices are at one point until the last segment.
      for (std::size_t k = 0; k < 5; ++k) {
        std::vector<float>& positions = motion.keyframes[k].positions;
        std::fill(positions.begin(), positions.end(), 1.0F);
      }
    } else {
      for (std::size_t k = 4; k < 6; ++k)
        for (float& c : motion.keyframes[k].positions) c *= 0x1p-12F;
    }
    std::size_t last = 0, whole = 0;
    BakeOptions options{.viewers = kAddingUp};
    options.progress = [&](std::size_t done, std::size_t total) {
      EXPECT_GT(done, last);
      last = done;
      whole = total;
    };
    SequenceBake baked;
    const std::string file = bake(motion, options, &baked);
    EXPECT_EQ(last, whole);
    const ShownGlb glb(file);
    EXPECT_EQ(baked.targets, 6U);
    EXPECT_EQ(baked.warnings.size(), 1U);
    EXPECT_EQ(baked.without_normals, 0U);
    expect_exact(glb, smooth_surface(motion));

    MotionStream stream(motion);
    options.progress = {};
    ASSERT_TRUE(bake_sequence(stream, options, folder / "out.glb", true).ok());
    std::ifstream written(folder / "out.glb", std::ios::binary);
    EXPECT_TRUE(std::string(std::istreambuf_iterator<char>(written), {}) == file);
  }
}

TEST(BakeSequence, elements_without_area_show_something_and_are_counted) {
  Motion motion = fixtures::smooth_morph(2);
  for (Motion::Keyframe& key : motion.keyframes) std::fill(key.positions.begin(), key.positions.end(), 1.0F);
  SequenceBake baked;
  const std::string file = bake(motion, {}, &baked);
  const ShownGlb glb(file);
  EXPECT_EQ(baked.without_normals, 1U);  // all vertices are at one point
  EXPECT_EQ(baked.extra_targets, 0U);
  for (std::size_t v = 0; v < glb.vertices(); ++v)
    EXPECT_EQ(glb.normal(v, glb.weights(0.5)), (ShownGlb::Point{0, 0, 1}));
}

TEST(BakeSequence, normals_that_have_nothing_to_do_with_the_surface_are_ignored) {
  constexpr std::uint64_t kSeed = 139;
  std::printf("seed %d\n", static_cast<int>(kSeed));
  Random random(kSeed);
  const Motion motion = wandering(fixtures::icosphere(2), 3, 0.02, kSeed);
  std::vector<std::array<double, 3>> any(motion.topology.vertex_count());
  for (auto& direction : any)
    for (double& c : direction) c = random.uniform(-1, 1);
  const auto bake_with = [&](const auto& normal_of_vertex, BakeEncoding encoding, SequenceBake& baked) {
    std::vector<float> normals;
    for (const std::uint32_t v : motion.topology.corners())
      for (const double c : normal_of_vertex(v)) normals.push_back(static_cast<float>(c));
    BakeOptions options{.encoding = encoding, .viewers = kAddingUp};
    options.normal_of_corner = VectorView<const float>::packed(normals.data(), normals.size() / 3);
    return bake(motion, options, &baked);
  };
  const auto at_keyframe_0 = [&](std::size_t v, double sign) {
    const float* const p = motion.keyframes[0].positions.data() + 3 * v;  // on a sphere around the origin
    return std::array<double, 3>{sign * double{p[0]}, sign * double{p[1]}, sign * double{p[2]}};
  };
  for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kHarmless, BakeEncoding::kKeys}) {
    SequenceBake plain, foreign;
    const std::string without = bake(motion, {.encoding = encoding, .viewers = kAddingUp}, &plain);
    const std::string file = bake_with([&](std::size_t v) { return any[v]; }, encoding, foreign);
    EXPECT_FALSE(foreign.has_offsets);
    ASSERT_EQ(foreign.warnings.size(), plain.warnings.size() + 1);
    EXPECT_NE(foreign.warnings[0].find("check that the cache belongs to this mesh"), std::string::npos);
    EXPECT_TRUE(file == without);
    // Normals of the surface are kept, on either side of it.
    for (const double sign : {1.0, -1.0}) {
      SequenceBake own;
      (void)bake_with([&](std::size_t v) { return at_keyframe_0(v, sign); }, encoding, own);
      EXPECT_EQ(own.has_offsets, encoding != BakeEncoding::kKeys);
      for (const std::string& warning : own.warnings)
        EXPECT_EQ(warning.find("check that the cache"), std::string::npos) << warning;
    }
  }
}

TEST(BakeSequence, rigid_translation_needs_no_extra_targets) {
  Motion motion = wandering(fixtures::icosphere(1), 3, 0, 9);
  for (float& c : motion.keyframes[0].positions) c = std::round(c * 1024) / 1024;
  for (std::size_t k = 1; k < 3; ++k) {
    motion.keyframes[k].positions = motion.keyframes[0].positions;
    for (float& c : motion.keyframes[k].positions) c += static_cast<float>(k);
  }
  SequenceBake baked;
  const std::string file = bake(motion, {}, &baked);
  EXPECT_EQ(baked.extra_targets, 0U);
  expect_exact(ShownGlb(file), smooth_surface(motion));
}

TEST(BakeSequence, endpoint_states_its_true_error_and_is_right_at_the_keys) {
  const Motion motion = wandering(fixtures::icosphere(2), 5, 0.1, 10);
  SequenceBake baked;
  const std::string file = bake(motion, {.encoding = BakeEncoding::kEndpoint}, &baked);
  const ShownGlb glb(file);
  EXPECT_EQ(glb.targets(), 4U);
  EXPECT_EQ(baked.extra_targets, 0U);
  const Surface surface = smooth_surface(motion);
  const Judged judged = judge(glb, surface, 801);
  EXPECT_NEAR(judged.max, baked.largest_error, 0.02 * baked.largest_error);
  for (const float time : glb.times) {
    const auto exact = exact_normals(glb, surface, time);
    for (std::size_t v = 0; v < glb.vertices(); ++v)
      EXPECT_LT(reference::angle(glb.normal(v, glb.weights(time)), exact[surface.group[v]]) / kDegree, 0.01);
  }
  // The error with correction targets must be smaller than the error with only unit normals at the keys.
  ShownGlb plain = glb;
  for (std::size_t k = 1; k < glb.times.size(); ++k) {
    const auto exact = exact_normals(glb, surface, glb.times[k]);
    for (std::size_t v = 0; v < glb.vertices(); ++v) {
      const VectorD u = reference::normalised(exact[surface.group[v]]);
      for (std::size_t c = 0; c < 3; ++c)
        plain.normal_deltas[k - 1][3 * v + c] = static_cast<float>(u[c]) - plain.normals[3 * v + c];
    }
  }
  const Judged unit = judge(plain, surface, 801);
  EXPECT_LT(judged.max, 0.8 * unit.max);
  EXPECT_LT(judged.mean, 0.8 * unit.mean);
}

TEST(BakeSequence, other_weightings_are_fitted_and_their_error_is_stated) {
  const Motion motion = wandering(fixtures::icosphere(1), 3, 0.05, 11);
  for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kEndpoint}) {
    SequenceBake baked;
    const std::string file = bake(motion, {.encoding = encoding, .weighting = Weighting::kAngle}, &baked);
    const ShownGlb glb(file);
    EXPECT_GT(baked.largest_error, 0);
    EXPECT_LT(baked.largest_error, 5);
    // At the keys, the normals follow the weighting: they are sums of unit normals, weighted by angles.
    for (std::size_t k = 0; k < 3; ++k) {
      std::vector<VectorD> expected(glb.vertices(), VectorD{});
      const auto position = [&](std::uint32_t v) { return glb.position(v, glb.weights(glb.times[k])); };
      for (std::size_t i = 0; i < glb.corners.size(); ++i) {
        const std::size_t face = i - i % 3;
        const VectorD a = position(glb.corners[i]), b = position(glb.corners[face + (i + 1) % 3]),
                      c = position(glb.corners[face + (i + 2) % 3]);
        const VectorD e = reference::subtract(b, a), f = reference::subtract(c, a);
        VectorD& sum = expected[glb.corners[i]];
        sum = reference::add(sum,
                             reference::scaled(reference::angle(e, f), reference::normalised(reference::cross(e, f))));
      }
      for (std::size_t v = 0; v < glb.vertices(); ++v)
        EXPECT_LT(reference::angle(glb.normal(v, glb.weights(glb.times[k])), expected[v]) / kDegree, 0.01);
    }
  }
}

TEST(BakeSequence, our_own_reader_gives_the_keyframes_back) {
  for (const bool degenerate : {false, true}) {
    const Motion motion = degenerate ? unfolding(true) : wandering(fixtures::icosphere(1), 4, 0.1, 12);
    for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kEndpoint}) {
      const std::string file = bake(motion, {.encoding = encoding});
      const Result<GltfDocument> document = GltfDocument::read(file, "baked");
      ASSERT_TRUE(document.ok()) << document.error().text();
      const Result<GltfMotion> read = read_gltf_motion(document.value(), {.animation = "motion"});
      ASSERT_TRUE(read.ok()) << read.error().text();
      ASSERT_TRUE(document.value().meshes()[0].mark.has_value());
      EXPECT_TRUE(document.value().meshes()[0].mark->sequence);
      const auto& keys = read.value().motion.keyframes;
      ASSERT_EQ(keys.size(), motion.keyframes.size());
      for (std::size_t k = 0; k < keys.size(); ++k) {
        EXPECT_EQ(keys[k].time, static_cast<double>(static_cast<float>(motion.keyframes[k].time)));
        for (std::size_t i = 0; i < keys[k].positions.size(); ++i)
          EXPECT_NEAR(keys[k].positions[i], motion.keyframes[k].positions[i], 4e-7);
      }
    }
  }
}

TEST(BakeSequence, zeros_have_bytes_where_that_is_asked_for) {
  const Motion motion = wandering(fixtures::icosphere(2), 3, 0.1, 13);
  const std::string lean_file = bake(motion, {}), dense_file = bake(motion, {.dense_zeros = true});
  const ShownGlb lean(lean_file), dense(dense_file);
  EXPECT_LT(lean_file.size(), dense_file.size());
  for (const auto& accessor : dense.json["accessors"]) {
    EXPECT_TRUE(accessor.contains("bufferView"));
    EXPECT_FALSE(accessor.contains("sparse"));
  }
  EXPECT_EQ(lean.position_deltas, dense.position_deltas);
  EXPECT_EQ(lean.normal_deltas, dense.normal_deltas);
}

TEST(BakeSequence, names_say_what_targets_are) {
  const std::string file = bake(wandering(fixtures::icosphere(1), 3, 0.1, 14), {});
  const ShownGlb glb(file);
  const nlohmann::json expected = R"({
    "targetNames": ["key 1", "key 2", "bend 0", "bend 1"],
    "chronormal": {"version": 2, "encode": "exact", "sequence": true, "extras": [
      {"target": 2, "linear": [[0, 1.0]], "quadratic": [[0, 0, -1.0], [1, 0, -1.0]]},
      {"target": 3, "linear": [], "quadratic": [[0, 1, 1.0]]}]}})"_json;
  EXPECT_EQ(glb.json["meshes"][0]["extras"], expected);
  EXPECT_EQ(glb.json["nodes"][0]["extras"]["chronormal"], expected["chronormal"])
      << "for viewers that hand on only these";
  EXPECT_EQ(glb.json["animations"][0]["name"], "motion");
  EXPECT_EQ(glb.json["asset"]["version"], "2.0");
  EXPECT_TRUE(glb.json["asset"]["generator"].get<std::string>().starts_with("chronormal "));
}

TEST(BakeSequence, bounds_in_the_file_are_those_of_the_values) {
  const std::string file = bake(wandering(fixtures::icosphere(1), 3, 0.1, 15), {});
  const ShownGlb glb(file);
  const auto expect_bounds = [&](const nlohmann::json& index, const std::vector<float>& values,
                                 std::size_t components) {
    const auto& accessor = glb.json["accessors"][index.get<std::size_t>()];
    for (std::size_t c = 0; c < components; ++c) {
      float low = values[c], high = values[c];
      for (std::size_t i = c; i < values.size(); i += components)
        low = std::min(low, values[i]), high = std::max(high, values[i]);
      EXPECT_EQ(accessor["min"][c].get<double>(), low);
      EXPECT_EQ(accessor["max"][c].get<double>(), high);
    }
  };
  const auto& primitive = glb.json["meshes"][0]["primitives"][0];
  expect_bounds(primitive["attributes"]["POSITION"], glb.positions, 3);
  for (std::size_t i = 0; i < glb.targets(); ++i)
    expect_bounds(primitive["targets"][i]["POSITION"], glb.position_deltas[i], 3);
  expect_bounds(glb.json["animations"][0]["samplers"][0]["input"], glb.times, 1);
}

TEST(BakeSequence, negative_times_are_shifted_and_that_is_said) {
  Motion motion = wandering(fixtures::icosphere(1), 3, 0.1, 16);
  for (Motion::Keyframe& key : motion.keyframes) key.time -= 5;
  SequenceBake baked;
  const std::string file = bake(motion, {.viewers = kAddingUp}, &baked);
  EXPECT_EQ(ShownGlb(file).times[0], 0);
  EXPECT_EQ(baked.warnings.size(), 1U);
}

TEST(BakeSequence, indices_have_16_bits_below_the_one_that_restarts_primitives) {
  for (const std::uint32_t vertices : {65535U, 65536U}) {
    Motion motion;
    motion.topology = fixtures::make_triangles(vertices, {0, 1, vertices - 1});
    for (const double time : {0.0, 1.0}) motion.keyframes.push_back({std::vector<float>(3 * vertices), time, ""});
    motion.keyframes[1].positions[3] = motion.keyframes[1].positions[3 * vertices - 2] = 1;
    motion.connect_as_sequence();
    const std::string file = bake(motion, {});
    const ShownGlb glb(file);
    EXPECT_EQ(glb.json["accessors"][0]["componentType"], vertices == 65535 ? 5123 : 5125);
    EXPECT_EQ(glb.corners, (std::vector<std::uint32_t>{0, 1, vertices - 1}));
  }
}

TEST(BakeSequence, what_cannot_be_written_is_refused) {
  Motion motion = wandering(fixtures::icosphere(1), 3, 0.1, 17);
  std::string glb = "untouched";
  const auto refusal = [&](const BakeOptions& options) {
    const Result<SequenceBake> result = bake_sequence(motion, options, glb);
    EXPECT_FALSE(result.ok());
    EXPECT_EQ(glb, "untouched");
    return result.ok() ? Error{} : result.error();
  };
  for (const std::size_t most : {std::size_t{0}, std::size_t{2000}, bake(motion, {}).size() - 1}) {
    const Error error = refusal({.most_bytes = most});
    EXPECT_EQ(error.code, ErrorCode::kInvalidInput);
    EXPECT_NE(error.message.find(grouped(most)), std::string::npos) << error.message;
  }
  EXPECT_TRUE(bake_sequence(motion, {.most_bytes = bake(motion, {}).size()}, glb).ok());
  glb = "untouched";
  EXPECT_EQ(refusal({.crease_angle = 190}).code, ErrorCode::kUsage);
  EXPECT_EQ(refusal({.crease_angle = std::nan("")}).code, ErrorCode::kUsage);

  motion.keyframes[1].time = 1e9;
  motion.keyframes[2].time = 1e9 + 1;
  const Error times = refusal({});
  EXPECT_EQ(times.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(times.place, "keyframe 2");
  motion.keyframes[2].time = 2e9;

  motion.keyframes[0].positions[0] = -3e38F;
  motion.keyframes[1].positions[0] = 3e38F;
  const Error far = refusal({});
  EXPECT_EQ(far.code, ErrorCode::kInvalidInput);
  EXPECT_EQ(far.place, "keyframe 1, vertex 0");
}

TEST(BakeSequence, progress_ends_with_everything_done) {
  const Motion motion = wandering(fixtures::icosphere(1), 4, 0.1, 18);
  std::size_t last = 0, whole = 0;
  BakeOptions options;
  options.progress = [&](std::size_t done, std::size_t total) {
    EXPECT_GT(done, last);
    last = done;
    whole = total;
  };
  (void)bake(motion, options);
  EXPECT_EQ(last, whole);
  EXPECT_GT(whole, 0U);
}

// Formats a number with as many digits as the documents show. If the number rounds to zero, the text is "below" and the
// smallest number with as many digits, such as "below 0.001".
std::string at_least(double value, int digits) {
  char text[32];
  std::snprintf(text, sizeof text, "%.*f", digits, value);
  return std::atof(text) > 0 ? text : "below " + std::string(text, std::strlen(text) - 1) + "1";
}

TEST(BakeSequence, real_sequences_are_exact) {
  const char* const data = std::getenv("CHRONORMAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "set CHRONORMAL_DATA to the folder of the real data to run this test";
  const fs::path folder = data;
  const std::vector<std::vector<std::string>> inputs = {
      {(folder / "sequences/rumba_13").string()},
      {(folder / "sequences/thick_cloth").string()},
      {(folder / "sequences/md2_faerie/faerie.md2").string()},
      {(folder / "caches/max_cache_box/max_cache_box_44.obj").string(),
       (folder / "caches/max_cache_box/max_cache_box.pc2").string()}};
  // Takes samples at several times of every segment, including both ends. The results in section 15 of docs/theory.md
  // are for 16 times per segment.
  const bool is_full = std::getenv("CHRONORMAL_FULL") != nullptr;
  const int times = is_full ? 16 : 5;
  const std::string theory = test::read_whole(std::string(kSourceFolder) + "/docs/theory.md");
  for (const auto& input : inputs) {
    InputOptions options = test::files(input, 24);
    constexpr std::size_t kLastOfFirstClip = 39;
    if (input[0].ends_with(".md2")) options.to = kLastOfFirstClip;  // the mesh rests between clips
    const Result<Motion> motion = test::read_motion(options);
    ASSERT_TRUE(motion.ok()) << motion.error().text();
    SequenceBake baked;
    const std::string file = bake(motion.value(), {}, &baked);
    const ShownGlb glb(file);
    const Judged judged = judge(glb, smooth_surface(motion.value()), times * static_cast<int>(baked.keyframes - 1) + 1);
    std::printf("%s: %zu keyframes, %zu bytes, mean %.6f, max %.5f degrees, %zu of %zu left out\n", input[0].c_str(),
                baked.keyframes, baked.bytes, judged.mean, judged.max, judged.nearly, judged.count);
    EXPECT_LT(judged.max, 0.05) << input[0];
    EXPECT_LT(judged.mean, 0.01) << input[0];
    char row[80];
    std::snprintf(row, sizeof row, "| %s | %s | %s |", grouped(baked.bytes).c_str(), at_least(judged.mean, 6).c_str(),
                  at_least(judged.max, 5).c_str());
    if (is_full) {
      EXPECT_NE(theory.find(row), std::string::npos) << row;
    }
  }
}

}  // namespace
}  // namespace chronormal::bake_sequence_test
