// What bake chooses for small meshes, against everything that could be chosen.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/bake_fixture.h"
#include "tests/support/cheapest_bake.h"

namespace chronormal::bake_choice_test {
namespace {

using test::Baked;
using test::CheapestBake;
using test::GltfBuilder;

constexpr unsigned kSeed = 20261122;
constexpr std::size_t kSide = 3;

// A small field whose targets move some of its vertices, and a track.
class Case {
 public:
  explicit Case(unsigned seed) : random_(seed), hills_(seed, kSide) {
    const std::size_t targets = 1 + below(3), keys = 2 + below(3);
    mesh.positions = field_of(hills_.positions);
    for (std::size_t c = 0; c < hills_.corners.size(); c += 3)
      mesh.faces.push_back({hills_.corners[c], hills_.corners[c + 1], hills_.corners[c + 2]});
    mesh.normals = unit(normals_at({}));
    const double size = std::pow(10.0, uniform(-1.7, 0));
    for (std::size_t i = 0; i < targets; ++i) {
      mesh.targets.push_back(field_of(hills_.deltas(uniform(0.2, 1), size * uniform(0.3, 1))));
      mesh.stored.push_back(stored_of(i));
    }
    track.is_step = below(3) == 0;
    for (std::size_t k = 0; k < keys; ++k) {
      track.times.push_back(static_cast<double>(k));
      std::vector<double>& key = track.keys.emplace_back();
      for (std::size_t i = 0; i < targets; ++i) key.push_back(below(3) == 0 ? 0 : to_float(uniform(0, 1)));
    }
    track.keys.back()[0] = 0.5;  // or nothing would drive the mesh
    tolerance = to_float(std::pow(10.0, uniform(-0.8, 0.6)));
  }

  CheapestBake::Mesh mesh;
  CheapestBake::Track track;
  double tolerance = 0;

  [[nodiscard]] std::string glb() const {
    GltfBuilder builder;
    std::vector<GltfBuilder::Json> of_targets;
    for (std::size_t i = 0; i < mesh.targets.size(); ++i)
      of_targets.push_back({{"POSITION", builder.add_positions(floats(mesh.targets[i]))},
                            {"NORMAL", builder.add_positions(floats(mesh.stored[i]))}});
    GltfBuilder::Json primitive = GltfBuilder::primitive(builder.add_positions(floats(mesh.positions)),
                                                         builder.add_indices(hills_.corners), of_targets);
    primitive["attributes"]["NORMAL"] = builder.add_positions(floats(mesh.normals));
    builder.add_node(builder.add_mesh(primitive));
    builder.add_animation("move");
    std::vector<float> times, values;
    for (const double time : track.times) times.push_back(static_cast<float>(time));
    for (const std::vector<double>& key : track.keys)
      for (const double w : key) values.push_back(static_cast<float>(w));
    builder.add_track(0, 0, times, values, track.is_step ? "STEP" : "LINEAR");
    return builder.glb();
  }

  static CheapestBake::Field field_of(const std::vector<float>& values) {
    CheapestBake::Field field;
    for (std::size_t v = 0; v + 2 < values.size(); v += 3) field.push_back({values[v], values[v + 1], values[v + 2]});
    return field;
  }

 private:
  static double to_float(double value) { return static_cast<double>(static_cast<float>(value)); }
  double uniform(double from, double to) { return std::uniform_real_distribution<double>(from, to)(random_); }
  std::size_t below(std::size_t count) { return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_); }

  static std::vector<float> floats(const CheapestBake::Field& field) {
    std::vector<float> values;
    for (const auto& v : field)
      for (const double c : v) values.push_back(static_cast<float>(c));
    return values;
  }

  // The normals of the field with one delta of positions, which are (0, 0, 0) where there is none.
  [[nodiscard]] CheapestBake::Field normals_at(const CheapestBake::Field& deltas) const {
    CheapestBake::Field sums(mesh.positions.size());
    for (const auto& face : mesh.faces) {
      std::array<std::array<double, 3>, 3> at;
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t c = 0; c < 3; ++c)
          at[k][c] = mesh.positions[face[k]][c] + (deltas.empty() ? 0 : deltas[face[k]][c]);
      for (std::size_t c = 0; c < 3; ++c) {
        const std::size_t d = (c + 1) % 3, e = (c + 2) % 3;
        const double n = (at[1][d] - at[0][d]) * (at[2][e] - at[0][e]) - (at[1][e] - at[0][e]) * (at[2][d] - at[0][d]);
        for (const std::size_t v : face) sums[v][c] += n;
      }
    }
    return sums;
  }

  static CheapestBake::Field unit(CheapestBake::Field field) {
    for (auto& v : field) {
      const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
      for (double& c : v) c = to_float(c / length);
    }
    return field;
  }

  // Right at weight 1, or nearly; or nothing.
  CheapestBake::Field stored_of(std::size_t i) {
    const std::size_t kind = below(5);
    CheapestBake::Field result(mesh.positions.size());
    if (kind < 2) return result;
    const CheapestBake::Field end = unit(normals_at(mesh.targets[i]));
    for (std::size_t v = 0; v < result.size(); ++v)
      for (std::size_t c = 0; c < 3; ++c)
        result[v][c] = to_float(end[v][c] - mesh.normals[v][c] + (kind == 4 ? uniform(-0.05, 0.05) : 0));
    return result;
  }

  std::mt19937 random_;
  test::Hills hills_;
};

// The deltas of all targets in a file that was baked, and the bytes of those that are new and of its track.
struct Written {
  std::vector<CheapestBake::Field> columns;
  std::size_t bytes = 0;
};

Written written(const Case& of, const Baked& baked) {
  Written result;
  const auto& targets = baked.mesh()["primitives"][0]["targets"];
  for (std::size_t k = 0; k < targets.size(); ++k) {
    CheapestBake::Field deltas(of.mesh.positions.size());
    if (targets[k].contains("NORMAL")) deltas = Case::field_of(baked.numbers(targets[k]["NORMAL"]));
    if (k >= of.mesh.stored.size() || deltas != of.mesh.stored[k]) result.bytes += CheapestBake::bytes_of(deltas);
    result.columns.push_back(std::move(deltas));
  }
  const auto numbers_of = [](const test::GltfPlayer& player) {
    const auto& sampler = player.json["animations"][0]["samplers"][0];
    return std::pair(player.accessor(sampler["input"]).size(), player.accessor(sampler["output"]).size());
  };
  const auto before = numbers_of(*baked.before), after = numbers_of(*baked.after);
  result.bytes += 4 * (after.second - before.second) + (after.first > before.first ? 4 * after.first : 0);
  return result;
}

TEST(BakeChoice, no_combination_of_candidates_takes_fewer_bytes_at_no_larger_an_error) {
  constexpr unsigned kCases = 200;
  std::map<std::string, std::size_t> chosen;
  std::size_t beaten = 0, combinations = 0;
  for (unsigned n = 0; n < kCases; ++n) {
    const Case of(kSeed + n);
    BakeOptions options;
    options.hosts = {kHosts[0]};
    options.weighting = Weighting::kArea;
    options.tolerance = of.tolerance;
    const Baked baked = test::bake_bytes(of.glb(), options);
    ASSERT_TRUE(baked.ok()) << baked.error;
    if (baked.report.meshes.empty()) continue;
    const CheapestBake cheapest(of.mesh, of.track, of.tolerance);
    const Written file = written(of, baked);
    const double error = cheapest.error_along(file.columns, [&](std::size_t gap, double part) {
      const double time = of.track.times[gap] + part * (of.track.is_step ? 0 : 1);
      const std::vector<float> weights = baked.after->weights_at(0, 0, time);
      return std::vector<double>(weights.begin(), weights.end());
    });
    std::string form;
    bool within = false;
    for (const BakeChoice& choice : baked.report.meshes[0].choices)
      if (choice.chosen) form = choice.form, within = choice.within;
    ++chosen[form + (within ? "" : ", beyond")];
    // Where no form was near enough, none of any size may be.
    const CheapestBake::Found better =
        cheapest.cheaper_than(within ? file.bytes : 1000000, std::min(within ? error : 360, 0.999 * of.tolerance));
    combinations += better.combinations;
    if (better.bytes < file.bytes || (!within && better.bytes < 1000000)) {
      ++beaten;
      ADD_FAILURE() << "seed " << kSeed + n << ", " << of.mesh.targets.size() << " targets, tolerance " << of.tolerance
                    << ": " << form << (within ? "" : ", beyond") << " of " << file.bytes << " bytes and " << error
                    << " degrees, against " << better.bytes << " and " << better.error;
    }
  }
  for (const auto& [form, count] : chosen) RecordProperty(form, static_cast<int>(count));
  std::string words;
  for (const auto& [form, count] : chosen) words += form + " " + std::to_string(count) + "; ";
  std::printf("seed %u: %s%zu combinations\n", kSeed, words.c_str(), combinations);
  EXPECT_EQ(beaten, 0U);
  EXPECT_GT(chosen["pruned"], 20U);
  EXPECT_GT(chosen["as it is"], 5U);
}

}  // namespace
}  // namespace chronormal::bake_choice_test
