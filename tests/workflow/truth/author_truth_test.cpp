// Compares the normals that an author saw, as the library finds them, with sums over polygons in long double, on random
// meshes.
#include "workflow/truth/author_truth.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iostream>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/bake_fixture.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/reference_elements.h"
#include "tests/support/shaded_mesh.h"
#include "workflow/truth/stored_keys.h"

namespace chronormal::author_truth_test {
namespace {

using reference::Real;
using reference::Vector;
using test::GltfBuilder;
using test::GltfFixture;
using test::ShadedMesh;

constexpr unsigned kSeed = 20261126;
const std::array<const char*, 5> kNames = {"area", "angle", "uniform", "area-angle", "max"};

Vector vector_of(const std::vector<float>& values, std::size_t v) {
  return {static_cast<Real>(values[3 * v]), static_cast<Real>(values[3 * v + 1]), static_cast<Real>(values[3 * v + 2])};
}

double degrees_between(const Vector& a, const Vector& b) {
  using namespace reference;
  return static_cast<double>(std::atan2(length(cross(a, b)), dot(a, b)) * 180 / kPi);
}

// Polygons with positions and two targets, together with the file in which the author stores them.
struct Authored {
  std::vector<std::vector<std::size_t>> polygons;
  ShadedMesh file;

  // Returns the polygons with positions at these weights of the targets.
  [[nodiscard]] reference::Mesh mesh(const std::vector<double>& weights) const {
    reference::Mesh result{polygons, {}, {}};
    for (std::size_t v = 0; v < file.vertices(); ++v) {
      Vector p = vector_of(file.positions, v);
      for (std::size_t k = 0; k < weights.size(); ++k)
        p = reference::add(p,
                           reference::scaled(static_cast<Real>(weights[k]), vector_of(file.targets[k].positions, v)));
      result.from.push_back(p);
    }
    result.to = result.from;
    return result;
  }
  // Returns for each vertex the sum of the normals of its faces, by `weighting`, in the pose with these target weights.
  [[nodiscard]] std::vector<Vector> sums(const std::string& weighting, const std::vector<double>& weights) const {
    const reference::Mesh at = mesh(weights);
    std::vector<Vector> result(file.vertices(), Vector{});
    for (const reference::Corner& corner : reference::corners_of(at)) {
      Vector& sum = result[reference::vertex_of(at, corner)];
      sum = reference::add(sum, reference::contribution(at, corner, weighting, 0));
    }
    for (Vector& sum : result) sum = reference::normalised(sum);
    return result;
  }
  // Stores normals in the file: the normals of the base, and the normals of each target as deltas.
  void store(const std::vector<Vector>& base, const std::vector<std::vector<Vector>>& keys) {
    file.normals.clear();
    for (const Vector& n : base)
      for (const Real c : n) file.normals.push_back(static_cast<float>(c));
    for (std::size_t k = 0; k < keys.size(); ++k) {
      file.targets[k].normals.clear();
      for (std::size_t v = 0; v < keys[k].size(); ++v)
        for (std::size_t c = 0; c < 3; ++c)
          file.targets[k].normals.push_back(
              static_cast<float>(keys[k][v][c] - static_cast<Real>(file.normals[3 * v + c])));
    }
  }
  void store_by(const std::string& weighting) {
    store(sums(weighting, {0, 0}), {sums(weighting, {1, 0}), sums(weighting, {0, 1})});
  }
};

// Makes a hilly sheet of quads, whose targets move every vertex.
Authored quads(std::mt19937& random, std::size_t side = 9) {
  Authored mesh;
  std::uniform_real_distribution<float> hill(-0.35F, 0.35F);
  for (std::size_t row = 0; row < side; ++row)
    for (std::size_t column = 0; column < side; ++column)
      for (const float c :
           {static_cast<float>(column) + hill(random), static_cast<float>(row) + hill(random), hill(random)})
        mesh.file.positions.push_back(c);
  mesh.file.targets.resize(2);
  for (auto& target : mesh.file.targets)
    for (std::size_t i = 0; i < mesh.file.positions.size(); ++i) target.positions.push_back(1.5F * hill(random));
  for (std::size_t row = 0; row + 1 < side; ++row) {
    for (std::size_t column = 0; column + 1 < side; ++column) {
      const std::size_t a = row * side + column;
      mesh.polygons.push_back({a, a + 1, a + side + 1, a + side});
      for (const std::size_t v : {a, a + 1, a + side + 1, a, a + side + 1, a + side})
        mesh.file.corners.push_back(static_cast<std::uint32_t>(v));
    }
  }
  return mesh;
}

// Adds the points of a tube: ring after ring, with n points in each ring.
void add_rings(Authored& mesh, std::size_t rings, std::size_t n, const std::function<float()>& hill) {
  for (std::size_t ring = 0; ring < rings; ++ring) {
    for (std::size_t i = 0; i < n; ++i) {
      const double angle = 2 * 3.14159265358979 * static_cast<double>(i) / static_cast<double>(n);
      for (const double c : {std::cos(angle), std::sin(angle), static_cast<double>(ring)})
        mesh.file.positions.push_back(static_cast<float>(c) + hill());
    }
  }
}

// Adds a polygon, and cuts it into triangles from its first corner.
void add_fan(Authored& mesh, const std::vector<std::size_t>& polygon) {
  mesh.polygons.push_back(polygon);
  for (std::size_t i = 1; i + 1 < polygon.size(); ++i)
    for (const std::size_t v : {polygon[0], polygon[i], polygon[i + 1]})
      mesh.file.corners.push_back(static_cast<std::uint32_t>(v));
}

struct Truth {
  explicit Truth(const ShadedMesh& file) : Truth(file.file().glb()) {}
  explicit Truth(const std::string& glb) : fixture(glb), shading(read_gltf_shading(*fixture, 0).value()) {
    split_by_keys(shading);
    truth.emplace(shading);
  }
  [[nodiscard]] Vector at(std::size_t vertex, const Authored& mesh, const std::vector<double>& weights) const {
    const std::vector<Vector> places = mesh.mesh(weights).from;
    const auto position = [&](std::uint32_t v) {
      return Vec3d{static_cast<double>(places[v][0]), static_cast<double>(places[v][1]),
                   static_cast<double>(places[v][2])};
    };
    const Vec3d n = truth->at(shading.element_of_vertex[vertex], position, truth->pose(weights)).normal;
    return {n.x, n.y, n.z};
  }

  GltfFixture fixture;
  GltfShading shading;
  std::optional<AuthorTruth> truth;
};

Vector bent(const Vector& n, std::mt19937& random, double most) {
  std::uniform_real_distribution<double> part(-1, 1);
  const Vector by = {part(random), part(random), part(random)};
  return reference::normalised(reference::add(n, reference::scaled(static_cast<Real>(most), by)));
}

TEST(AuthorTruth, the_polygons_and_the_weighting_that_keys_follow_are_found) {
  std::mt19937 random(kSeed);
  for (std::size_t w = 0; w < kNames.size(); ++w) {
    SCOPED_TRACE(kNames[w]);
    for (int draw = 0; draw < 4; ++draw) {
      Authored mesh = quads(random);
      mesh.store_by(kNames[w]);
      const Truth truth(mesh.file);
      EXPECT_TRUE(truth.truth->rule().is_followed);
      EXPECT_TRUE(truth.truth->rule().any_polygons);
      EXPECT_EQ(truth.truth->rule().weighting, kWeightings[w].weighting);
      EXPECT_TRUE(truth.truth->stale().empty());
      for (const std::vector<double>& weights : {std::vector<double>{0.5, 0}, {0.3, 0.8}, {-0.4, 1}}) {
        const std::vector<Vector> right = mesh.sums(kNames[w], weights);
        for (std::size_t v = 0; v < right.size(); ++v)
          EXPECT_LT(degrees_between(truth.at(v, mesh, weights), right[v]), 0.02) << v;
      }
    }
  }
}

TEST(AuthorTruth, a_mesh_of_plain_triangles_keeps_its_triangles) {
  std::mt19937 random(kSeed + 1);
  for (int draw = 0; draw < 4; ++draw) {
    Authored mesh = quads(random);
    mesh.polygons.clear();
    for (std::size_t c = 0; c < mesh.file.corners.size(); c += 3)
      mesh.polygons.push_back({mesh.file.corners[c], mesh.file.corners[c + 1], mesh.file.corners[c + 2]});
    mesh.store_by("angle");
    const Truth truth(mesh.file);
    EXPECT_FALSE(truth.truth->rule().any_polygons);
    EXPECT_EQ(truth.truth->rule().weighting, Weighting::kAngle);
    mesh.store_by("area");
    EXPECT_TRUE(Truth(mesh.file).truth->is_plain());
  }
}

TEST(AuthorTruth, larger_polygons_are_found_in_whatever_order_their_triangles_are) {
  std::mt19937 random(kSeed + 2);
  for (int draw = 0; draw < 6; ++draw) {
    // A cylinder of quads has a polygon of n corners as cap. The cap is cut into triangles from a random corner.
    const std::size_t n = 5 + random() % 6;
    Authored mesh;
    std::uniform_real_distribution<float> hill(-0.15F, 0.15F);
    add_rings(mesh, 3, n, [&] { return hill(random); });
    mesh.file.targets.resize(2);
    for (auto& target : mesh.file.targets)
      for (std::size_t i = 0; i < mesh.file.positions.size(); ++i) target.positions.push_back(3 * hill(random));
    for (std::size_t ring = 0; ring < 2; ++ring) {
      for (std::size_t i = 0; i < n; ++i) {
        const std::size_t a = ring * n + i, b = ring * n + (i + 1) % n;
        mesh.polygons.push_back({a, b, b + n, a + n});
        for (const std::size_t v : {a, b, b + n, a, b + n, a + n})
          mesh.file.corners.push_back(static_cast<std::uint32_t>(v));
      }
    }
    std::vector<std::size_t> cap;
    for (std::size_t i = 0; i < n; ++i) cap.push_back(2 * n + i);
    mesh.polygons.push_back(cap);
    std::vector<std::array<std::size_t, 3>> cut;
    for (std::size_t i = 1; i + 1 < n; ++i) cut.push_back({cap[0], cap[i], cap[i + 1]});
    std::shuffle(cut.begin(), cut.end(), random);
    for (const auto& triangle : cut)
      for (const std::size_t v : triangle) mesh.file.corners.push_back(static_cast<std::uint32_t>(v));
    mesh.store_by("angle");
    const Truth truth(mesh.file);
    const std::vector<double> weights = {0.4, 0.3};
    const std::vector<Vector> right = mesh.sums("angle", weights);
    for (std::size_t v = 0; v < right.size(); ++v)
      EXPECT_LT(degrees_between(truth.at(v, mesh, weights), right[v]), 0.02) << draw << ", " << v << " of " << n;
  }
}

TEST(AuthorTruth, triangles_back_to_back_whose_vertices_store_one_normal_are_no_sheet) {
  std::mt19937 random(kSeed + 20);
  std::uniform_real_distribution<float> hill(-0.15F, 0.15F);
  for (int draw = 0; draw < 6; ++draw) {
    // A polygon of the wall shares three points of the rim with the cap. Both the polygon and the cap are cut so that
    // these three points form a triangle.
    const std::size_t n = 7 + random() % 4;
    Authored mesh;
    add_rings(mesh, 2, n, [&] { return hill(random); });
    mesh.file.targets.resize(2);
    for (auto& target : mesh.file.targets)
      for (std::size_t i = 0; i < mesh.file.positions.size(); ++i) target.positions.push_back(3 * hill(random));
    add_fan(mesh, {n + 2, n + 1, n, 0, 1, 2});
    for (std::size_t i = 2; i < n; ++i) add_fan(mesh, {i, (i + 1) % n, (i + 1) % n + n, i + n});
    std::vector<std::size_t> cap;
    for (std::size_t i = 0; i < n; ++i) cap.push_back(n + i);
    const std::size_t of_wall = mesh.file.corners.size();
    add_fan(mesh, cap);
    std::array<std::vector<Vector>, 3> stored = {mesh.sums("angle", {0, 0}), mesh.sums("angle", {1, 0}),
                                                 mesh.sums("angle", {0, 1})};
    const std::vector<double> weights = {0.4, 0.3};
    std::vector<Vector> right = mesh.sums("angle", weights);
    // The cap gets separate vertices, as at a seam of a texture.
    for (std::size_t c = of_wall; c < mesh.file.corners.size(); ++c)
      mesh.file.corners[c] += static_cast<std::uint32_t>(n);
    for (std::size_t v = n; v < 2 * n; ++v) {
      for (std::size_t c = 0; c < 3; ++c) {
        mesh.file.positions.push_back(mesh.file.positions[3 * v + c]);
        for (auto& target : mesh.file.targets) target.positions.push_back(target.positions[3 * v + c]);
      }
      for (std::vector<Vector>& normals : stored) normals.push_back(normals[v]);
      right.push_back(right[v]);
    }
    mesh.store(stored[0], {stored[1], stored[2]});
    const Truth truth(mesh.file);
    for (std::size_t v = 0; v < right.size(); ++v)
      EXPECT_LT(degrees_between(truth.at(v, mesh, weights), right[v]), 0.02) << draw << ", " << v << " of " << n;
  }
}

TEST(AuthorTruth, quads_that_every_key_keeps_flat_are_found_beside_large_caps) {
  constexpr std::size_t kPoints = 13, kRings = 7;
  Authored mesh;
  add_rings(mesh, kRings, kPoints, [] { return 0.0F; });
  mesh.file.targets.resize(2);
  for (std::size_t v = 0; v < mesh.file.vertices(); ++v) {
    const float* const p = mesh.file.positions.data() + 3 * v;
    const float wider = 0.2F * static_cast<float>(v / kPoints % 3);
    for (const float c : {wider * p[0], wider * p[1], 0.0F}) mesh.file.targets[0].positions.push_back(c);
    // The second target turns all vertices by a right angle about the x axis.
    for (const float c : {0.0F, -p[2] - p[1], p[1] - p[2]}) mesh.file.targets[1].positions.push_back(c);
  }
  for (std::size_t ring = 0; ring + 1 < kRings; ++ring)
    for (std::size_t i = 0; i < kPoints; ++i)
      add_fan(mesh, {ring * kPoints + i, ring * kPoints + (i + 1) % kPoints, (ring + 1) * kPoints + (i + 1) % kPoints,
                     (ring + 1) * kPoints + i});
  std::vector<std::size_t> bottom, top;
  for (std::size_t i = 0; i < kPoints; ++i) {
    bottom.push_back(kPoints - 1 - i);
    top.push_back((kRings - 1) * kPoints + i);
  }
  add_fan(mesh, bottom);
  add_fan(mesh, top);
  mesh.store_by("angle");
  const Truth truth(mesh.file);
  const std::vector<double> weights = {0.9, 0.4};
  const std::vector<Vector> right = mesh.sums("angle", weights);
  for (std::size_t v = 0; v < right.size(); ++v)
    EXPECT_LT(degrees_between(truth.at(v, mesh, weights), right[v]), 0.02) << v;
}

TEST(AuthorTruth, what_the_author_bent_is_kept_at_the_base_and_at_every_key) {
  std::mt19937 random(kSeed + 3);
  for (int draw = 0; draw < 4; ++draw) {
    Authored mesh = quads(random);
    std::array<std::vector<Vector>, 3> stored = {mesh.sums("angle", {0, 0}), mesh.sums("angle", {1, 0}),
                                                 mesh.sums("angle", {0, 1})};
    // A third of the normals are edited, differently in the base and in each target.
    for (std::size_t v = 0; v < stored[0].size(); v += 3)
      for (std::vector<Vector>& of_key : stored) of_key[v] = bent(of_key[v], random, 0.3);
    mesh.store(stored[0], {stored[1], stored[2]});
    const Truth truth(mesh.file);
    EXPECT_EQ(truth.truth->rule().weighting, Weighting::kAngle);
    EXPECT_GT(truth.truth->offset_count(), stored[0].size() / 4);
    for (std::size_t v = 0; v < stored[0].size(); ++v) {
      EXPECT_LT(degrees_between(truth.at(v, mesh, {0, 0}), stored[0][v]), 0.02) << v;
      EXPECT_LT(degrees_between(truth.at(v, mesh, {1, 0}), stored[1][v]), 0.02) << v;
      EXPECT_LT(degrees_between(truth.at(v, mesh, {0, 1}), stored[2][v]), 0.02) << v;
    }
    // Normals that were not edited follow the weighting at all weights of the targets.
    const std::vector<Vector> right = mesh.sums("angle", {0.6, 0.7});
    for (std::size_t v = 1; v < right.size(); v += 3)
      EXPECT_LT(degrees_between(truth.at(v, mesh, {0.6, 0.7}), right[v]), 0.02) << v;
  }
}

// Returns the offset of a stored normal from a sum of face normals, both of length 1. The offset is perpendicular to
// the sum, and its length is the angle in radians.
Vector added_to(const Vector& sum, const Vector& stored) {
  using namespace reference;
  const Vector across = normalised(add(stored, scaled(-dot(sum, stored), sum)));
  return scaled(std::atan2(length(cross(sum, stored)), dot(sum, stored)), across);
}

TEST(AuthorTruth, what_the_author_bent_is_blended_from_base_and_keys_in_between_and_on_either_side) {
  using namespace reference;
  std::mt19937 random(kSeed + 8);
  RecordProperty("seed", static_cast<int>(kSeed + 8));
  constexpr std::size_t kSide = 9;
  for (int draw = 0; draw < 4; ++draw) {
    // In the first five rows of the sheet, both targets only scale the mesh, so they do not change the directions of
    // the sums. In these rows, it makes no difference from which edge the azimuth of an offset (its direction around
    // the normal) is measured.
    Authored mesh = quads(random, kSide);
    for (auto& target : mesh.file.targets)
      for (std::size_t i = 0; i < 3 * 5 * kSide; ++i) target.positions[i] = mesh.file.positions[i];
    std::array<std::vector<Vector>, 3> stored = {mesh.sums("angle", {0, 0}), mesh.sums("angle", {1, 0}),
                                                 mesh.sums("angle", {0, 1})};
    for (std::size_t v = 0; v < 4 * kSide; ++v) {
      for (std::vector<Vector>& of_key : stored) {
        if (v % 3 == 0) of_key[v] = bent(of_key[v], random, 0.2);
        if (v % 4 == 0) of_key[v] = scaled(Real(-1), of_key[v]);  // turns the normal to the back of the surface
      }
    }
    mesh.store(stored[0], {stored[1], stored[2]});
    const Truth truth(mesh.file);
    ASSERT_EQ(truth.truth->rule().weighting, Weighting::kAngle);
    for (const std::vector<double>& weights : {std::vector<double>{0.5, 0}, {0.3, 0.6}, {-0.25, 0.5}, {1, 1}}) {
      const std::vector<Vector> sums = mesh.sums("angle", weights);
      for (std::size_t v = 0; v < 4 * kSide; ++v) {
        const Vector sum = scaled(Real(v % 4 == 0 ? -1 : 1), sums[v]);
        Vector right = sum;
        if (v % 3 == 0) {
          const Vector base = added_to(sum, stored[0][v]);
          Vector offset = base;
          for (std::size_t k = 0; k < 2; ++k)
            offset = add(offset, scaled(static_cast<Real>(weights[k]),
                                        add(added_to(sum, stored[k + 1][v]), scaled(Real(-1), base))));
          right = add(scaled(std::cos(length(offset)), sum), scaled(std::sin(length(offset)), normalised(offset)));
        }
        const Vector shown = scaled(Real(v % 4 == 0 && v % 3 != 0 ? -1 : 1), truth.at(v, mesh, weights));
        EXPECT_LT(degrees_between(shown, right), 0.02) << draw << ", " << v;
      }
    }
  }
}

TEST(AuthorTruth, azimuths_are_measured_from_the_edge_with_which_offsets_change_least) {
  std::mt19937 random(kSeed + 13);
  constexpr std::size_t kSide = 9, kBent = 2 * kSide + 4;
  Authored mesh = quads(random, kSide);
  // Five rows of the sheet are flat. Of these rows, only vertex kBent + 1 moves, and this vertex stays in the plane.
  // The normal of its neighbour kBent is edited.
  for (std::size_t v = 0; v < 5 * kSide; ++v) {
    mesh.file.positions[3 * v] = static_cast<float>(v % kSide);
    mesh.file.positions[3 * v + 1] = static_cast<float>(v / kSide);
    mesh.file.positions[3 * v + 2] = 0;
    for (auto& target : mesh.file.targets)
      std::fill_n(target.positions.begin() + 3 * static_cast<std::ptrdiff_t>(v), 3, 0.0F);
  }
  mesh.file.targets[0].positions[3 * (kBent + 1) + 1] = 0.7F;
  std::array<std::vector<Vector>, 3> stored = {mesh.sums("angle", {0, 0}), mesh.sums("angle", {1, 0}),
                                               mesh.sums("angle", {0, 1})};
  const Vector normal = bent(stored[0][kBent], random, 0.4);
  for (std::vector<Vector>& of_key : stored) of_key[kBent] = normal;
  mesh.store(stored[0], {stored[1], stored[2]});
  const Truth truth(mesh.file);
  EXPECT_GT(truth.truth->offset_count(), 0U);
  EXPECT_GT(degrees_between(mesh.sums("angle", {0, 0})[kBent], normal), 5);
  EXPECT_LT(degrees_between(truth.at(kBent, mesh, {0.5, 0}), normal), 0.02);
}

TEST(AuthorTruth, smooth_normals_beside_faces_that_are_shaded_flat_add_up_these_too) {
  using namespace reference;
  std::mt19937 random(kSeed + 10);
  for (int draw = 0; draw < 4; ++draw) {
    Authored mesh = quads(random);
    const std::size_t points = mesh.file.vertices();
    std::array<std::vector<Vector>, 3> stored = {mesh.sums("angle", {0, 0}), mesh.sums("angle", {1, 0}),
                                                 mesh.sums("angle", {0, 1})};
    const std::array<reference::Mesh, 3> keys = {mesh.mesh({0, 0}), mesh.mesh({1, 0}), mesh.mesh({0, 1})};
    for (std::size_t q = 0; q < mesh.polygons.size(); ++q) {
      if (random() % 5 != 0) continue;
      // The flat-shaded face gets separate vertices, but its corners still contribute to the vertices around it.
      const std::vector<std::size_t>& corners = mesh.polygons[q];
      for (const std::size_t corner : corners) {
        const auto copy = static_cast<std::uint32_t>(mesh.file.vertices());
        for (std::size_t c = 0; c < 6; ++c)
          if (mesh.file.corners[6 * q + c] == corner) mesh.file.corners[6 * q + c] = copy;
        for (std::size_t c = 0; c < 3; ++c) {
          mesh.file.positions.push_back(mesh.file.positions[3 * corner + c]);
          for (auto& target : mesh.file.targets) target.positions.push_back(target.positions[3 * corner + c]);
        }
        for (std::size_t k = 0; k < 3; ++k) {
          const auto along = [&](std::size_t from, std::size_t to) {
            return add(keys[k].from[corners[to]], scaled(Real(-1), keys[k].from[corners[from]]));
          };
          stored[k].push_back(normalised(cross(along(0, 2), along(1, 3))));
        }
      }
    }
    mesh.store(stored[0], {stored[1], stored[2]});
    const Truth truth(mesh.file);
    EXPECT_TRUE(truth.truth->rule().any_whole_point);
    EXPECT_EQ(truth.truth->offset_count(), 0U);
    const std::vector<double> weights = {0.4, 0.5};
    const std::vector<Vector> right = mesh.sums("angle", weights);
    for (std::uint32_t v = 0; v < points; ++v) {
      if (truth.shading.element_of_vertex[v] == AuthorTruth::kNone) continue;
      EXPECT_LT(degrees_between(truth.at(v, mesh, weights), right[v]), 0.02) << draw << ", " << v;
    }
  }
}

// All angles of a rectangle are equal, so the normals of a strip of rectangles follow both the angle weighting and the
// uniform weighting. On the hills beside the strip, normals follow the author's weighting less exactly than on the
// strip, and normals by the other weightings are within a degree of the author's normals.
TEST(AuthorTruth, a_weighting_that_most_normals_follow_precedes_one_that_is_as_near_on_a_part) {
  std::cout << "  from seed " << kSeed + 30 << '\n';
  std::mt19937 random(kSeed + 30);
  std::uniform_real_distribution<double> width(0.3, 1.5), slope(-0.6, 0.6);
  for (int draw = 0; draw < 12; ++draw) {
    const std::string name = draw % 2 == 0 ? "uniform" : "angle";
    Authored mesh = quads(random);
    for (std::size_t i = 2; i < mesh.file.positions.size(); i += 3) mesh.file.positions[i] *= 0.1F;
    for (auto& target : mesh.file.targets)
      for (float& delta : target.positions) delta *= 0.1F;
    // The strip is bent across its length, differently in the base and in each target.
    constexpr std::size_t kColumns = 9, kRows = 9;
    std::array<std::vector<std::array<double, 2>>, 3> outlines;
    for (auto& outline : outlines) {
      outline = {{0, 50}};
      while (outline.size() < kColumns) {
        const double length = width(random), angle = slope(random);
        outline.push_back({outline.back()[0] + length * std::cos(angle), outline.back()[1] + length * std::sin(angle)});
      }
    }
    const std::size_t first = mesh.file.vertices();
    for (std::size_t row = 0; row < kRows; ++row) {
      for (std::size_t column = 0; column < kColumns; ++column) {
        const auto point = [&](std::size_t k) {
          return std::array<double, 3>{outlines[k][column][0], static_cast<double>(row), outlines[k][column][1]};
        };
        for (std::size_t c = 0; c < 3; ++c) {
          mesh.file.positions.push_back(static_cast<float>(point(0)[c]));
          for (std::size_t k = 0; k < 2; ++k)
            mesh.file.targets[k].positions.push_back(static_cast<float>(point(k + 1)[c] - point(0)[c]));
        }
        if (row + 1 == kRows || column + 1 == kColumns) continue;
        const std::size_t v = first + row * kColumns + column;
        add_fan(mesh, {v, v + 1, v + kColumns + 1, v + kColumns});
      }
    }
    std::array<std::vector<Vector>, 3> stored = {mesh.sums(name, {0, 0}), mesh.sums(name, {1, 0}),
                                                 mesh.sums(name, {0, 1})};
    for (std::vector<Vector>& normals : stored)
      for (std::size_t v = 0; v < first; ++v) normals[v] = bent(normals[v], random, 1.5e-5);
    mesh.store(stored[0], {stored[1], stored[2]});
    const Truth truth(mesh.file);
    EXPECT_TRUE(truth.truth->rule().is_followed) << draw;
    EXPECT_EQ(truth.truth->rule().weighting, name == "angle" ? Weighting::kAngle : Weighting::kUniform) << draw;
  }
}

// One face of the front has separate vertices, so normals could be sums over all faces at a point. Such sums would be
// zero, since the front and the back cancel.
TEST(AuthorTruth, the_rule_of_a_sheet_with_two_sides_is_found_on_each_side) {
  std::cout << "  from seed " << kSeed + 31 << '\n';
  std::mt19937 random(kSeed + 31);
  for (int draw = 0; draw < 6; ++draw) {
    const std::string name = draw % 2 == 0 ? "uniform" : "angle";
    Authored mesh = quads(random);
    const std::size_t points = mesh.file.vertices(), triangles = mesh.file.corners.size() / 3;
    std::array<std::vector<Vector>, 3> stored = {mesh.sums(name, {0, 0}), mesh.sums(name, {1, 0}),
                                                 mesh.sums(name, {0, 1})};
    const auto copy = [&](std::size_t v, Real side) {
      for (std::size_t c = 0; c < 3; ++c) {
        mesh.file.positions.push_back(mesh.file.positions[3 * v + c]);
        for (auto& target : mesh.file.targets) target.positions.push_back(target.positions[3 * v + c]);
      }
      for (std::vector<Vector>& normals : stored) normals.push_back(reference::scaled(side, normals[v]));
    };
    for (std::size_t v = 0; v < points; ++v) copy(v, -1);
    for (std::size_t t = 0; t < triangles; ++t)
      for (const std::size_t c : {0U, 2U, 1U})
        mesh.file.corners.push_back(mesh.file.corners[3 * t + c] + static_cast<std::uint32_t>(points));
    const std::size_t own = random() % mesh.polygons.size();
    for (const std::size_t corner : mesh.polygons[own]) {
      const auto last = static_cast<std::uint32_t>(mesh.file.vertices());
      copy(corner, 1);
      for (std::vector<Vector>& normals : stored) normals.back() = bent(normals.back(), random, 0.5);
      for (std::size_t c = 0; c < 6; ++c)
        if (mesh.file.corners[6 * own + c] == corner) mesh.file.corners[6 * own + c] = last;
    }
    mesh.store(stored[0], {stored[1], stored[2]});
    const Truth truth(mesh.file);
    EXPECT_TRUE(truth.truth->rule().is_followed) << draw;
    EXPECT_EQ(truth.truth->rule().weighting, name == "angle" ? Weighting::kAngle : Weighting::kUniform) << draw;
  }
}

TEST(AuthorTruth, normals_in_eight_bits_have_no_offsets) {
  std::mt19937 random(kSeed + 11);
  Authored mesh = quads(random);
  const auto rounded = [](std::vector<Vector> normals) {
    for (Vector& n : normals)
      for (Real& c : n) c = std::round(127 * c) / 127;
    return normals;
  };
  mesh.store(rounded(mesh.sums("angle", {0, 0})),
             {rounded(mesh.sums("angle", {1, 0})), rounded(mesh.sums("angle", {0, 1}))});
  const Truth truth(mesh.file);
  EXPECT_EQ(truth.truth->rule().weighting, Weighting::kAngle);
  EXPECT_EQ(truth.truth->offset_count(), 0U);
}

TEST(AuthorTruth, a_key_that_bends_a_normal_far_from_what_it_moves_turns_it) {
  std::mt19937 random(kSeed + 12);
  Authored mesh = quads(random);
  std::vector<float>& moved = mesh.file.targets[1].positions;
  std::fill(moved.begin(), moved.begin() + 3 * 5 * 9, 0.0F);
  std::vector<Vector> second = mesh.sums("angle", {0, 1});
  second[3] = bent(second[3], random, 0.3);
  mesh.store(mesh.sums("angle", {0, 0}), {mesh.sums("angle", {1, 0}), second});
  const Truth truth(mesh.file);
  const std::vector<std::uint32_t> turned = truth.truth->elements_of(1);
  const auto has = [&](std::size_t v) {
    return std::find(turned.begin(), turned.end(), truth.shading.element_of_vertex[v]) != turned.end();
  };
  EXPECT_TRUE(has(3));
  EXPECT_FALSE(has(4));
  EXPECT_TRUE(has(80));
}

TEST(AuthorTruth, a_key_whose_normals_turn_with_the_surface_but_farther_is_the_authors) {
  std::mt19937 random(kSeed + 9);
  Authored mesh = quads(random);
  for (float& delta : mesh.file.targets[1].positions) delta *= 0.4F;
  const std::vector<Vector> base = mesh.sums("angle", {0, 0});
  std::vector<Vector> second = mesh.sums("angle", {0, 1});
  for (std::size_t v = 0; v < second.size(); ++v) second[v] = test::rotated(base[v], second[v], second[v]);
  mesh.store(base, {mesh.sums("angle", {1, 0}), second});
  const Truth truth(mesh.file);
  EXPECT_TRUE(truth.truth->stale().empty());
  for (std::size_t v = 0; v < second.size(); ++v)
    EXPECT_LT(degrees_between(truth.at(v, mesh, {0, 1}), second[v]), 0.02);
}

TEST(AuthorTruth, a_key_that_does_not_turn_as_the_surface_does_is_stale_and_the_rule_counts) {
  std::mt19937 random(kSeed + 4);
  for (const bool is_noise : {false, true}) {
    Authored mesh = quads(random);
    const std::vector<Vector> base = mesh.sums("angle", {0, 0});
    // Without noise, the normals differ from the base only so much that an exporter keeps the target.
    std::vector<Vector> second = base;
    for (Vector& n : second) n = bent(n, random, is_noise ? 0.6 : 1e-3);
    mesh.store(base, {mesh.sums("angle", {1, 0}), second});
    const Truth truth(mesh.file);
    ASSERT_EQ(truth.truth->stale().size(), 1U) << is_noise;
    EXPECT_EQ(truth.truth->stale()[0].target, 1U);
    const std::vector<Vector> right = mesh.sums("angle", {0, 1});
    for (std::size_t v = 0; v < right.size(); ++v)
      EXPECT_LT(degrees_between(truth.at(v, mesh, {0, 1}), right[v]), 0.02) << v;
  }
}

TEST(AuthorTruth, an_edge_that_is_hard_in_a_key_alone_stays_hard) {
  // The two halves of a sheet have separate vertices where they meet, with the same normal on both sides, as on a box
  // that was flattened.
  ShadedMesh mesh;
  mesh.positions = {-1, 0, 0, 0, 0, 0, 0, 1, 0, -1, 1, 0, 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  mesh.corners = {0, 1, 2, 0, 2, 3, 4, 5, 6, 4, 6, 7};
  for (int v = 0; v < 8; ++v) mesh.normals.insert(mesh.normals.end(), {0, 0, 1});
  // In the target, the right half folds down by 90 degrees. The vertices of this half then have the normal of the
  // folded half.
  mesh.targets.push_back({{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, -1, 0, -1, -1, 0, -1, 0, 0, 0},
                          {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1, 0, -1, 1, 0, -1, 1, 0, -1, 1, 0, -1},
                          {}});
  const Truth truth(mesh);
  EXPECT_NE(truth.shading.element_of_vertex[1], truth.shading.element_of_vertex[4]);
  EXPECT_NE(truth.shading.element_of_vertex[2], truth.shading.element_of_vertex[7]);
  const test::Baked baked = test::bake_document(mesh.file(), {.encoding = BakeEncoding::kExact});
  ASSERT_TRUE(baked.ok()) << baked.error;
  const Truth after(baked.bytes);
  EXPECT_NE(after.shading.element_of_vertex[1], after.shading.element_of_vertex[4]);
  EXPECT_NE(after.shading.element_of_vertex[2], after.shading.element_of_vertex[7]);
  mesh.targets[0].normals.clear();
  const Truth smooth(mesh);
  EXPECT_EQ(smooth.shading.element_of_vertex[1], smooth.shading.element_of_vertex[4]);
}

TEST(AuthorTruth, normals_that_a_bake_spread_over_its_targets_are_still_those_of_the_author) {
  std::mt19937 random(kSeed + 6);
  RecordProperty("seed", static_cast<int>(kSeed + 6));
  for (const BakeEncoding encoding : {BakeEncoding::kExact, BakeEncoding::kSmallest}) {
    for (int draw = 0; draw < 3; ++draw) {
      Authored mesh = quads(random);
      std::array<std::vector<Vector>, 3> stored = {mesh.sums("angle", {0, 0}), mesh.sums("angle", {1, 0}),
                                                   mesh.sums("angle", {0, 1})};
      for (std::size_t v = 0; v < stored[0].size(); v += 3)
        for (std::vector<Vector>& of_key : stored) of_key[v] = bent(of_key[v], random, 0.2);
      mesh.store(stored[0], {stored[1], stored[2]});
      GltfBuilder builder = mesh.file.file();
      builder.add_track(builder.add_animation(""), 0, std::vector<float>{0, 1, 2},
                        std::vector<float>{0, 0, 1, 0.4F, 0.2F, 1});
      BakeOptions options;
      options.encoding = encoding;
      options.viewers = find_viewers("three").value();
      options.tolerance = 0.01;
      const test::Baked baked = test::bake_document(builder, options);
      ASSERT_TRUE(baked.ok()) << baked.error;
      ASSERT_FALSE(baked.report.meshes.at(0).extras.empty());
      const Truth before(builder.glb()), after(baked.bytes);
      ASSERT_TRUE(after.shading.mark && after.shading.mark->author);
      EXPECT_EQ(after.truth->rule().weighting, Weighting::kAngle);
      EXPECT_TRUE(after.truth->rule().any_polygons);
      for (std::size_t v = 0; v < stored[0].size(); ++v) {
        EXPECT_LT(degrees_between(after.at(v, mesh, {0, 0}), stored[0][v]), 0.02) << v;
        EXPECT_LT(degrees_between(after.at(v, mesh, {1, 0}), stored[1][v]), 0.02) << v;
        EXPECT_LT(degrees_between(after.at(v, mesh, {0, 1}), stored[2][v]), 0.02) << v;
        EXPECT_LT(degrees_between(after.at(v, mesh, {0.6, 0.5}), before.at(v, mesh, {0.6, 0.5})), 0.2) << v;
      }
    }
  }
}

TEST(AuthorTruth, keys_of_a_bake_that_no_author_made_tell_nothing) {
  std::mt19937 random(kSeed + 7);
  Authored mesh = quads(random);
  // The stored normals use area weights over the triangles of the file, so they do not tell which polygons the author
  // had.
  mesh.polygons.clear();
  for (std::size_t c = 0; c < mesh.file.corners.size(); c += 3)
    mesh.polygons.push_back({mesh.file.corners[c], mesh.file.corners[c + 1], mesh.file.corners[c + 2]});
  mesh.store_by("area");
  const test::Baked baked = test::bake_document(mesh.file.file(), {.encoding = BakeEncoding::kExact});
  ASSERT_TRUE(baked.ok()) << baked.error;
  const Truth truth(baked.bytes);
  ASSERT_TRUE(truth.shading.mark);
  EXPECT_FALSE(truth.shading.mark->author);
  EXPECT_TRUE(targets_with_normals(truth.shading).empty());
}

TEST(AuthorTruth, an_asked_weighting_asks_no_author) {
  std::mt19937 random(kSeed + 5);
  Authored mesh = quads(random);
  mesh.store_by("angle");
  const GltfFixture fixture(mesh.file.file());
  const GltfShading shading = read_gltf_shading(*fixture, 0).value();
  EXPECT_TRUE(AuthorTruth(shading, Weighting::kArea).is_plain());
  const AuthorTruth uniform(shading, Weighting::kUniform);
  EXPECT_FALSE(uniform.rule().any_polygons);
  EXPECT_EQ(uniform.offset_count(), 0U);
}

}  // namespace
}  // namespace chronormal::author_truth_test
