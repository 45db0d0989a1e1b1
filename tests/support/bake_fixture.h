/// Makes glTF files of hills that morph, and bakes these files.
#ifndef CHRONORMAL_TESTS_SUPPORT_BAKE_FIXTURE_H_
#define CHRONORMAL_TESTS_SUPPORT_BAKE_FIXTURE_H_

#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <optional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_truth.h"

namespace chronormal::test {

/// A glTF document, the result of its bake, and a reader for each of the two files.
struct Baked {
  std::unique_ptr<GltfFixture> source;
  std::string bytes;  ///< the result; empty if the bake failed
  std::string error;
  GltfBake report;
  std::unique_ptr<GltfPlayer> before, after;

  [[nodiscard]] bool ok() const { return error.empty(); }
  [[nodiscard]] const nlohmann::json& json() const { return after->json; }
  [[nodiscard]] const nlohmann::json& mesh(std::size_t m = 0) const { return after->json["meshes"][m]; }
  [[nodiscard]] std::vector<float> numbers(const nlohmann::json& accessor) const {
    return after->accessor(accessor.get<std::size_t>());
  }
};

[[nodiscard]] inline Baked bake_bytes(const std::string& glb, const BakeOptions& options = {},
                                      const GltfOptions& reading = GltfOptions{.strict = true}) {
  Baked result;
  result.source = std::make_unique<GltfFixture>(glb, std::nullopt, reading);
  if (!result.source->ok()) {
    result.error = result.source->error();
    return result;
  }
  GltfEdit edit(**result.source);
  Result<GltfBake> report = bake(**result.source, options, edit);
  if (!report) {
    result.error = report.error().text();
    return result;
  }
  result.report = std::move(report).value();
  Result<std::string> bytes = edit.bytes("a.glb");
  if (!bytes) {
    result.error = bytes.error().text();
    return result;
  }
  result.bytes = std::move(bytes).value();
  result.before = std::make_unique<GltfPlayer>(glb);
  result.after = std::make_unique<GltfPlayer>(result.bytes);
  return result;
}
[[nodiscard]] inline Baked bake_document(const GltfBuilder& builder, const BakeOptions& options = {}) {
  return bake_bytes(builder.glb(), options);
}

/// A sheet of side x side vertices with random hills.
class Hills {
 public:
  explicit Hills(unsigned seed, std::size_t side = 5) : random_(seed), side_(side) {
    for (std::size_t y = 0; y < side; ++y) {
      for (std::size_t x = 0; x < side; ++x) {
        positions.push_back(static_cast<float>(x));
        positions.push_back(static_cast<float>(y));
        positions.push_back(uniform(-0.3, 0.3));
      }
    }
    for (std::size_t y = 0; y + 1 < side; ++y) {
      for (std::size_t x = 0; x + 1 < side; ++x) {
        const auto a = static_cast<std::uint16_t>(y * side + x), up = static_cast<std::uint16_t>(a + side);
        for (const int corner : {a + 0, a + 1, up + 1, a + 0, up + 1, up + 0})
          corners.push_back(static_cast<std::uint16_t>(corner));
      }
    }
    for (std::size_t v = 0; v < side * side; ++v) {
      // Normals point upwards, but are tilted as if an author had edited them.
      const double x = uniform(-0.3, 0.3), y = uniform(-0.3, 0.3), length = std::sqrt(x * x + y * y + 1);
      for (const double c : {x, y, 1.0}) normals.push_back(static_cast<float>(c / length));
    }
  }

  std::vector<float> positions, normals;
  std::vector<std::uint16_t> corners;

  [[nodiscard]] std::size_t vertices() const { return positions.size() / 3; }
  [[nodiscard]] float uniform(double from, double to) {
    return static_cast<float>(std::uniform_real_distribution<double>(from, to)(random_));
  }
  [[nodiscard]] std::size_t below(std::size_t count) {
    return std::uniform_int_distribution<std::size_t>(0, count - 1)(random_);
  }
  /// Draws random position deltas of up to `size` for a share of the vertices. All other deltas are zero.
  [[nodiscard]] std::vector<float> deltas(double share = 1, double size = 0.4) {
    std::vector<float> result(positions.size());
    const auto rows = static_cast<std::size_t>(std::ceil(share * static_cast<double>(side_)));
    const std::size_t first = below(side_ - rows + 1);
    for (std::size_t i = 3 * side_ * first; i < 3 * side_ * (first + rows); ++i) result[i] = uniform(-size, size);
    return result;
  }

  /// Makes a primitive of the sheet. `targets` has the position deltas of each target. If with_normals is false, the
  /// base has no normals.
  [[nodiscard]] GltfBuilder::Json primitive(GltfBuilder& builder, const std::vector<std::vector<float>>& targets,
                                            bool with_normals = true) const {
    std::vector<GltfBuilder::Json> of_targets;
    const std::size_t base = builder.add_positions(positions);
    for (const std::vector<float>& deltas : targets)
      of_targets.push_back({{"POSITION", builder.add_positions(deltas)}});
    GltfBuilder::Json primitive = GltfBuilder::primitive(base, builder.add_indices(corners), of_targets);
    if (with_normals) primitive["attributes"]["NORMAL"] = builder.add_positions(normals);
    return primitive;
  }

 private:
  std::mt19937 random_;
  std::size_t side_;
};

/// Makes a document of hills with `targets` targets. The hills are one mesh, on node 0.
[[nodiscard]] inline GltfBuilder still_hills_document(std::size_t targets, unsigned seed = 1) {
  GltfBuilder builder;
  Hills hills(seed);
  std::vector<std::vector<float>> deltas;
  for (std::size_t k = 0; k < targets; ++k) deltas.push_back(hills.deltas());
  builder.add_node(builder.add_mesh(hills.primitive(builder, deltas), {{"name", "hills"}}));
  return builder;
}

/// Makes the document of still_hills_document() with an empty animation.
[[nodiscard]] inline GltfBuilder hills_document(std::size_t targets, unsigned seed = 1) {
  GltfBuilder builder = still_hills_document(targets, seed);
  builder.add_animation("move");
  return builder;
}

/// Returns the document with added normal deltas. These deltas cause large errors at every weight except 0, so every
/// bake improves the document.
[[nodiscard]] inline GltfBuilder with_misleading_normals(GltfBuilder builder) {
  for (auto& mesh : builder.json["meshes"]) {
    for (auto& primitive : mesh["primitives"]) {
      const auto count = builder.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()]["count"];
      std::vector<float> deltas(3 * count.get<std::size_t>());
      for (std::size_t i = 0; i < deltas.size(); ++i) deltas[i] = i % 3 == 2 ? -1000.0F : 70.0F;
      const std::size_t accessor = builder.add_positions(deltas);
      for (auto& target : primitive["targets"]) target["NORMAL"] = accessor;
    }
  }
  return builder;
}

/// Returns the errors of the rendered normals while a weight track plays, at 101 times.
[[nodiscard]] inline ShownError track_error(const Baked& baked, std::size_t animation = 0, std::size_t channel = 0) {
  const auto& target = baked.before->json["animations"][animation]["channels"][channel]["target"];
  const std::size_t mesh = baked.before->json["nodes"][target["node"].get<std::size_t>()]["mesh"];
  const GltfTruth truth(*baked.before, mesh);
  return shown_error(truth, *baked.after, mesh, poses_of(*baked.before, *baked.after, animation, channel));
}

inline void expect_exact(const ShownError& error) {
  EXPECT_GT(error.judged, 0U);
  EXPECT_LT(error.mean(), 0.01);
  EXPECT_LT(error.worst, 0.05);
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_BAKE_FIXTURE_H_
