// Tests the extensions EXT_meshopt_compression and KHR_draco_mesh_compression. The data come from the encoders of the
// libraries meshoptimizer and Draco.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "io/gltf/gltf_motion.h"
#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_compressed.h"

namespace chronormal::gltf_compressed_test {
namespace {

using test::GltfBuilder, test::GltfFixture, test::DracoOrder;
using Corners = std::vector<std::uint32_t>;

const Corners kCorners(test::kQuadCorners.begin(), test::kQuadCorners.end());

GltfGeometry geometry_of(const GltfFixture& file) {
  EXPECT_TRUE(file.ok()) << file.error();
  if (!file.ok()) return {};
  Result<GltfGeometry> geometry = file->geometry(0, 0, {true, true});
  EXPECT_TRUE(geometry.ok()) << geometry.error().text();
  return geometry ? geometry.value() : GltfGeometry{};
}

// A grid of vertices that is so large that the encoder makes more than one block.
struct Grid {
  std::vector<float> positions;
  std::vector<float> normals;
  std::vector<float> bulge;  // the position deltas of a target
  Corners corners;
};

Grid make_grid(std::uint32_t side) {
  Grid grid;
  for (std::uint32_t y = 0; y < side; ++y) {
    for (std::uint32_t x = 0; x < side; ++x) {
      const float u = 0.125F * static_cast<float>(x), v = 0.125F * static_cast<float>(y);
      grid.positions.insert(grid.positions.end(), {u, v, u * v});
      const float size = std::sqrt(u * u + v * v + 1);
      grid.normals.insert(grid.normals.end(), {-v / size, -u / size, 1 / size});
      grid.bulge.insert(grid.bulge.end(), {0, 0.25F * u, static_cast<float>(x % 3)});
      if (x + 1 == side || y + 1 == side) continue;
      const std::uint32_t a = y * side + x;
      for (const std::uint32_t corner : {a, a + 1, a + side, a + 1, a + side + 1, a + side})
        grid.corners.push_back(corner);
    }
  }
  return grid;
}

TEST(GltfMeshopt, attributes_and_triangles_come_back_bit_for_bit) {
  const Grid grid = make_grid(40);
  GltfBuilder builder;
  const std::size_t vertices = grid.positions.size() / 3;
  const std::size_t base = test::add_meshopt_positions(builder, grid.positions);
  const std::size_t bulge = test::add_meshopt_positions(builder, grid.bulge);
  const std::size_t view = test::add_meshopt_view(builder, test::meshopt_triangles(grid.corners, vertices),
                                                  grid.corners.size(), 4, "TRIANGLES");
  const std::size_t corners = builder.add_accessor_over(view, "SCALAR", 5125, grid.corners.size());
  builder.add_mesh(GltfBuilder::primitive(base, corners, {{{"POSITION", bulge}}}));
  const GltfFixture file(builder);
  const GltfGeometry geometry = geometry_of(file);
  EXPECT_EQ(geometry.positions, grid.positions);
  ASSERT_EQ(geometry.targets.size(), 1U);
  EXPECT_EQ(geometry.targets[0].positions, grid.bulge);
  // The encoder keeps the order of triangles and their winding, but may begin a triangle with another corner.
  ASSERT_EQ(geometry.corners.size(), grid.corners.size());
  for (std::size_t f = 0; f < grid.corners.size(); f += 3) {
    std::array<std::uint32_t, 3> read{}, written{};
    std::copy_n(&geometry.corners[f], 3, read.begin());
    std::copy_n(&grid.corners[f], 3, written.begin());
    std::rotate(read.begin(), std::find(read.begin(), read.end(), written[0]), read.end());
    EXPECT_EQ(read, written) << f;
  }
  EXPECT_EQ(geometry_of(file).positions, grid.positions) << "a second time";
  EXPECT_TRUE(read_gltf_motion(*file, {}).ok());
}

TEST(GltfMeshopt, indices_of_two_and_four_bytes_come_back) {
  const Corners indices = {3, 1, 2, 0, 1, 3, 2, 2, 0};
  for (const int width : {2, 4}) {
    GltfBuilder builder;
    const std::size_t base = builder.add_positions(test::kQuad);
    const std::size_t view = test::add_meshopt_view(builder, test::meshopt_indices(indices, 4), indices.size(),
                                                    static_cast<std::size_t>(width), "INDICES");
    const std::size_t corners = builder.add_accessor_over(view, "SCALAR", width == 2 ? 5123 : 5125, indices.size());
    builder.add_mesh(GltfBuilder::primitive(base, corners));
    EXPECT_EQ(geometry_of(GltfFixture(builder)).corners, indices) << width;
  }
}

TEST(GltfMeshopt, triangles_of_two_bytes_come_back) {
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(test::kQuad);
  const std::size_t view =
      test::add_meshopt_view(builder, test::meshopt_triangles(kCorners, 4), kCorners.size(), 2, "TRIANGLES");
  builder.add_mesh(GltfBuilder::primitive(base, builder.add_accessor_over(view, "SCALAR", 5123, kCorners.size())));
  EXPECT_EQ(geometry_of(GltfFixture(builder)).corners, kCorners);
}

// Decodes an octahedral normal by the formula in appendix B of the specification of EXT_meshopt_compression. coded[0]
// and coded[1] are x and y as integers, and coded[2] is the integer that stands for 1.
std::array<double, 3> octahedral(const std::array<int, 3>& coded, int largest) {
  const double one = coded[2];
  double x = coded[0] / one, y = coded[1] / one;
  const double z = 1 - std::fabs(x) - std::fabs(y);
  const double t = std::min(z, 0.0);
  x += x >= 0 ? t : -t;
  y += y >= 0 ? t : -t;
  const double size = std::sqrt(x * x + y * y + z * z);
  std::array<double, 3> result{};
  const double components[] = {x, y, z};
  for (std::size_t k = 0; k < 3; ++k) result[k] = std::round(components[k] / size * largest) / largest;
  return result;
}

template <class T>
void expect_octahedral(int bits) {
  const Grid grid = make_grid(20);
  const std::size_t vertices = grid.positions.size() / 3;
  std::vector<float> four;  // the encoder takes four components per normal
  for (std::size_t i = 0; i < vertices; ++i) {
    for (std::size_t k = 0; k < 3; ++k) four.push_back((i % 2 == 0 ? 1.0F : -1.0F) * grid.normals[3 * i + k]);
    four.push_back(0);
  }
  constexpr std::size_t kStride = 4 * sizeof(T);
  std::vector<T> filtered(4 * vertices);
  meshopt_encodeFilterOct(filtered.data(), vertices, kStride, bits, four.data());

  GltfBuilder builder;
  auto primitive = GltfBuilder::primitive(builder.add_positions(grid.positions), builder.add_indices(grid.corners));
  const std::size_t view = test::add_meshopt_view(builder, test::meshopt_attributes(test::bytes_of(filtered), kStride),
                                                  vertices, kStride, "ATTRIBUTES", "OCTAHEDRAL");
  primitive["attributes"]["NORMAL"] =
      builder.add_accessor_over(view, "VEC3", GltfBuilder::component_type<T>(), vertices, true);
  builder.add_mesh(primitive);
  builder.json["extensionsRequired"].push_back("KHR_mesh_quantization");
  builder.json["extensionsUsed"].push_back("KHR_mesh_quantization");
  const GltfGeometry geometry = geometry_of(GltfFixture(builder));
  ASSERT_EQ(geometry.normals.size(), 3 * vertices);
  const int largest = std::numeric_limits<T>::max();
  for (std::size_t i = 0; i < vertices; ++i) {
    const auto expected = octahedral({filtered[4 * i], filtered[4 * i + 1], filtered[4 * i + 2]}, largest);
    for (std::size_t k = 0; k < 3; ++k) {
      // The reader computes in float32, so the last bit of a component may be rounded up or down.
      EXPECT_NEAR(static_cast<double>(geometry.normals[3 * i + k]), expected[k], 1.001 / largest) << i;
      EXPECT_NEAR(static_cast<double>(geometry.normals[3 * i + k]), static_cast<double>(four[4 * i + k]),
                  4.0 / (1 << (bits - 1)))
          << i;
    }
  }
}

TEST(GltfMeshopt, octahedral_filter_gives_unit_normals) {
  expect_octahedral<std::int8_t>(8);
  expect_octahedral<std::int16_t>(12);
  expect_octahedral<std::int16_t>(16);
}

TEST(GltfMeshopt, exponential_filter_gives_mantissa_times_power_of_two) {
  const Grid grid = make_grid(20);
  const std::size_t vertices = grid.positions.size() / 3;
  std::vector<std::uint32_t> filtered(grid.bulge.size());
  meshopt_encodeFilterExp(filtered.data(), vertices, 12, 15, grid.bulge.data());
  std::vector<float> expected;
  for (const std::uint32_t word : filtered) {
    const auto mantissa = static_cast<std::int32_t>(word << 8) >> 8, exponent = static_cast<std::int32_t>(word) >> 24;
    expected.push_back(std::ldexp(static_cast<float>(mantissa), exponent));
  }
  GltfBuilder builder;
  const std::size_t base = builder.add_positions(grid.positions);
  const std::size_t view = test::add_meshopt_view(builder, test::meshopt_attributes(test::bytes_of(filtered), 12),
                                                  vertices, 12, "ATTRIBUTES", "EXPONENTIAL");
  const std::size_t bulge = builder.add_accessor_over(view, "VEC3", 5126, vertices);
  builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(grid.corners), {{{"POSITION", bulge}}}));
  const GltfGeometry geometry = geometry_of(GltfFixture(builder));
  ASSERT_EQ(geometry.targets.size(), 1U);
  EXPECT_EQ(geometry.targets[0].positions, expected);
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_NEAR(expected[i], grid.bulge[i], 2e-4F) << i;
}

TEST(GltfMeshopt, filter_none_may_be_written_out_and_a_fallback_buffer_is_not_opened) {
  GltfBuilder builder;
  const std::size_t view = test::add_meshopt_view(builder, test::meshopt_attributes(test::bytes_of(test::kQuad), 12), 4,
                                                  12, "ATTRIBUTES", "NONE");
  const std::size_t base = builder.add_accessor_over(view, "VEC3", 5126, 4);
  builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners)));
  EXPECT_EQ(geometry_of(GltfFixture(builder)).positions, test::kQuad);
  builder.json["buffers"][1]["uri"] = "no_such_file.bin";
  EXPECT_EQ(geometry_of(GltfFixture(builder.glb(), ".")).positions, test::kQuad);
}

TEST(GltfMeshopt, stride_of_a_view_must_be_that_of_its_compressed_elements) {
  for (const int stride : {0, 16, 24}) {
    GltfBuilder builder;
    const std::size_t base = test::add_meshopt_positions(builder, test::kQuad);
    builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners)));
    auto& view = builder.json["bufferViews"][0];
    if (stride > 0)
      view["byteStride"] = stride;
    else
      view.erase("byteStride");
    builder.json["accessors"][0]["count"] = stride == 24 ? 2 : 3;
    if (stride == 0) {
      EXPECT_TRUE(GltfFixture(builder).ok());
    } else {
      EXPECT_TRUE(GltfFixture(builder).error().starts_with("a.gltf, /bufferViews/0")) << GltfFixture(builder).error();
    }
  }
}

TEST(GltfMeshopt, elements_wider_than_what_is_read_of_them_need_the_stride_of_the_view) {
  // An element of the stream has 16 bytes: a position and four bytes that are not read.
  std::vector<float> wide;
  for (std::size_t i = 0; i < 12; ++i) {
    wide.push_back(test::kQuad[i]);
    if (i % 3 == 2) wide.push_back(7);
  }
  for (const bool has_stride : {true, false}) {
    GltfBuilder builder;
    const std::size_t view =
        test::add_meshopt_view(builder, test::meshopt_attributes(test::bytes_of(wide), 16), 4, 16, "ATTRIBUTES");
    const std::size_t base = builder.add_accessor_over(view, "VEC3", 5126, 4);
    builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners)));
    if (!has_stride) builder.json["bufferViews"][view].erase("byteStride");
    const GltfFixture file(builder);
    if (has_stride) {
      EXPECT_EQ(geometry_of(file).positions, test::kQuad);
    } else if (file.ok()) {
      // If the view has no stride, elements are packed without gaps, as the glTF specification demands.
      const std::vector<float> packed(wide.begin(), wide.begin() + 12);
      EXPECT_EQ(geometry_of(file).positions, packed);
    }
  }
}

TEST(GltfMeshopt, broken_streams_and_descriptions_are_refused) {
  struct Case {
    const char* key;
    nlohmann::json value;
  };
  const std::vector<Case> cases = {{"mode", "NOTHING"},
                                   {"mode", nullptr},
                                   {"filter", "NOTHING"},
                                   {"count", 5},
                                   {"count", 3},
                                   {"byteStride", 16},
                                   {"byteStride", 260},
                                   {"byteLength", 5},
                                   {"byteLength", 1000000},
                                   {"byteOffset", 3},
                                   {"buffer", 9},
                                   {"mode", "TRIANGLES"},
                                   {"mode", "INDICES"},
                                   {"byteStride", nullptr},
                                   {"filter", "OCTAHEDRAL"},
                                   {"filter", "QUATERNION"}};
  for (const Case& edit : cases) {
    SCOPED_TRACE(std::string(edit.key) + " := " + edit.value.dump());
    GltfBuilder builder;
    const std::size_t base = test::add_meshopt_positions(builder, test::kQuad);
    builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners)));
    auto& extension = builder.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"];
    if (edit.value.is_null())
      extension.erase(edit.key);
    else
      extension[edit.key] = edit.value;
    const GltfFixture file(builder);
    if (!file.ok()) {
      EXPECT_TRUE(file.error().starts_with("a.gltf, /")) << file.error();
      continue;
    }
    const Result<GltfGeometry> geometry = file->geometry(0, 0, {});
    ASSERT_FALSE(geometry.ok());
    EXPECT_EQ(geometry.error().code, ErrorCode::kInvalidInput);
    EXPECT_TRUE(geometry.error().place.starts_with("a.gltf, /")) << geometry.error().text();
  }
}

TEST(GltfDraco, sequential_mesh_comes_back_bit_for_bit_with_its_targets) {
  const Grid grid = make_grid(20);
  for (const bool has_targets : {false, true}) {
    for (const bool has_normals : {false, true}) {
      GltfBuilder builder;
      std::vector<GltfBuilder::Json> targets;
      if (has_targets) targets.push_back({{"POSITION", builder.add_positions(grid.bulge)}});
      const std::string coded = test::draco_mesh(grid.positions, grid.corners, DracoOrder::kKept,
                                                 has_normals ? grid.normals : std::vector<float>());
      builder.add_mesh(
          test::draco_primitive(builder, coded, grid.positions.size() / 3, grid.corners.size(), has_normals, targets));
      const GltfFixture file(builder);
      ASSERT_TRUE(file.ok()) << file.error();
      EXPECT_TRUE(file->meshes()[0].primitives[0].has_draco);
      const GltfGeometry geometry = geometry_of(file);
      EXPECT_EQ(geometry.positions, grid.positions);
      EXPECT_EQ(geometry.corners, grid.corners);
      EXPECT_EQ(geometry.normals, has_normals ? grid.normals : std::vector<float>());
      ASSERT_EQ(geometry.targets.size(), has_targets ? 1U : 0U);
      if (has_targets) {
        EXPECT_EQ(geometry.targets[0].positions, grid.bulge);
        EXPECT_TRUE(read_gltf_motion(*file, {}).ok());
      }
      EXPECT_TRUE(read_gltf_mesh(*file).ok());
    }
  }
}

// Returns each triangle as the nine coordinates of its corners. Rotates each triangle so that its smallest corner is
// first, and sorts the triangles.
std::vector<std::array<float, 9>> sorted_triangles(const std::vector<float>& positions, const Corners& corners) {
  std::vector<std::array<float, 9>> triangles;
  for (std::size_t f = 0; f + 3 <= corners.size(); f += 3) {
    std::array<std::array<float, 3>, 3> points{};
    for (std::size_t k = 0; k < 3; ++k)
      std::copy_n(&positions.at(std::size_t{3} * corners[f + k]), 3, points[k].begin());
    std::rotate(points.begin(), std::min_element(points.begin(), points.end()), points.end());
    std::array<float, 9>& triangle = triangles.emplace_back();
    for (std::size_t k = 0; k < 9; ++k) triangle[k] = points[k / 3][k % 3];
  }
  std::sort(triangles.begin(), triangles.end());
  return triangles;
}

TEST(GltfDraco, quantised_floats_are_within_a_step_of_the_true_ones) {
  const Grid grid = make_grid(20);
  GltfBuilder builder;
  const std::string coded = test::draco_mesh(grid.positions, grid.corners, DracoOrder::kKept, {}, 12);
  builder.add_mesh(test::draco_primitive(builder, coded, grid.positions.size() / 3, grid.corners.size(), false, {}));
  const GltfGeometry geometry = geometry_of(GltfFixture(builder));
  ASSERT_EQ(geometry.positions.size(), grid.positions.size());
  const float range = *std::max_element(grid.positions.begin(), grid.positions.end());  // of x and y, from 0
  for (std::size_t i = 0; i < grid.positions.size(); ++i)
    EXPECT_NEAR(geometry.positions[i], grid.positions[i], range / 4095) << i;
}

TEST(GltfDraco, whole_numbers_are_normalised_as_their_accessor_says) {
  const auto check = [](auto zero) {
    using T = decltype(zero);
    constexpr T kMost = std::numeric_limits<T>::max(), kLeast = std::numeric_limits<T>::min();
    const std::vector<T> positions = {0, 1, kMost, kLeast, 2, 3, 4, 5, 60, 7, 100, 9};
    for (const bool normalized : {false, true}) {
      GltfBuilder builder;
      const std::string coded = test::draco_mesh(positions, kCorners, DracoOrder::kKept);
      auto primitive = test::draco_primitive(builder, coded, 4, 6, false, {});
      auto& accessor = builder.json["accessors"][primitive["attributes"]["POSITION"].get<std::size_t>()];
      accessor["componentType"] = GltfBuilder::component_type<T>();
      accessor["normalized"] = normalized;
      builder.add_mesh(primitive);
      builder.json["extensionsUsed"].push_back("KHR_mesh_quantization");
      builder.json["extensionsRequired"].push_back("KHR_mesh_quantization");
      const GltfGeometry geometry = geometry_of(GltfFixture(builder));
      ASSERT_EQ(geometry.positions.size(), positions.size());
      for (std::size_t i = 0; i < positions.size(); ++i) {
        const double expected = std::max(static_cast<double>(positions[i]) / static_cast<double>(kMost), -1.0);
        EXPECT_EQ(geometry.positions[i], normalized ? static_cast<float>(expected) : static_cast<float>(positions[i]))
            << i;
      }
    }
  };
  check(std::int8_t{});
  check(std::uint8_t{});
  check(std::int16_t{});
  check(std::uint16_t{});
}

TEST(GltfDraco, edgebreaker_mesh_has_the_same_triangles) {
  const Grid grid = make_grid(20);
  GltfBuilder builder;
  const std::string coded = test::draco_mesh(grid.positions, grid.corners, DracoOrder::kFree);
  builder.add_mesh(test::draco_primitive(builder, coded, grid.positions.size() / 3, grid.corners.size(), false, {}));
  const GltfGeometry geometry = geometry_of(GltfFixture(builder));
  EXPECT_EQ(sorted_triangles(geometry.positions, geometry.corners), sorted_triangles(grid.positions, grid.corners));
}

TEST(GltfDraco, mesh_that_is_not_as_declared_is_refused) {
  struct Case {
    const char* label;
    void (*edit)(GltfBuilder& builder, GltfBuilder::Json& primitive, GltfBuilder::Json& extension);
  };
  const Case cases[] = {
      {"more vertices",
       [](auto& b, auto& p, auto&) {
         b.json["accessors"][p["attributes"]["POSITION"].template get<std::size_t>()]["count"] = 5;
       }},
      {"fewer vertices",
       [](auto& b, auto& p, auto&) {
         b.json["accessors"][p["attributes"]["POSITION"].template get<std::size_t>()]["count"] = 3;
       }},
      {"more corners",
       [](auto& b, auto& p, auto&) { b.json["accessors"][p["indices"].template get<std::size_t>()]["count"] = 9; }},
      {"fewer corners",
       [](auto& b, auto& p, auto&) { b.json["accessors"][p["indices"].template get<std::size_t>()]["count"] = 3; }},
      {"no such attribute", [](auto&, auto&, auto& e) { e["attributes"]["POSITION"] = 7; }},
      {"no such view", [](auto&, auto&, auto& e) { e["bufferView"] = 77; }},
      {"no view", [](auto&, auto&, auto& e) { e.erase("bufferView"); }},
      {"no attributes", [](auto&, auto&, auto& e) { e.erase("attributes"); }},
      {"other bytes", [](auto& b, auto&, auto&) { b.buffer[0] = 'X'; }},
      {"a fan", [](auto&, auto& p, auto&) { p["mode"] = 6; }},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.label);
    GltfBuilder builder;
    auto primitive =
        test::draco_primitive(builder, test::draco_mesh(test::kQuad, kCorners, DracoOrder::kKept), 4, 6, false, {});
    auto extension = primitive["extensions"]["KHR_draco_mesh_compression"];
    c.edit(builder, primitive, extension);
    primitive["extensions"]["KHR_draco_mesh_compression"] = extension;
    builder.add_mesh(primitive);
    const GltfFixture file(builder);
    if (!file.ok()) {
      EXPECT_TRUE(file.error().starts_with("a.gltf, /")) << file.error();
      continue;
    }
    const Result<GltfGeometry> geometry = file->geometry(0, 0, {});
    ASSERT_FALSE(geometry.ok());
    EXPECT_TRUE(geometry.error().place.starts_with("a.gltf, /")) << geometry.error().text();
  }
}

TEST(GltfDraco, vertices_that_no_face_names_are_counted) {
  std::vector<float> five = test::kQuad;
  five.insert(five.end(), {7, 8, 9});
  const std::string coded = test::draco_mesh(five, kCorners, DracoOrder::kKept);
  for (const std::size_t declared : {std::size_t{4}, std::size_t{5}}) {
    GltfBuilder builder;
    builder.add_mesh(test::draco_primitive(builder, coded, declared, 6, false, {}));
    const GltfFixture file(builder);
    ASSERT_TRUE(file.ok()) << file.error();
    EXPECT_EQ(file->geometry(0, 0, {}).ok(), declared == 5);
  }
}

// The Draco mesh holds some attributes of the primitive, and ordinary accessors hold the others.
TEST(GltfDraco, attributes_that_are_not_compressed_are_read_from_their_accessors) {
  const std::vector<float> normals = {0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, -1};
  const auto read = [&](auto edit) {
    GltfBuilder builder;
    auto primitive =
        test::draco_primitive(builder, test::draco_mesh(test::kQuad, kCorners, DracoOrder::kKept), 4, 6, false, {});
    primitive["attributes"]["NORMAL"] = builder.add_positions(normals);
    builder.add_mesh(primitive);
    edit(builder);
    const GltfFixture file(builder);
    if (!file.ok()) return std::pair(file.error(), std::vector<float>());
    const Result<GltfGeometry> geometry = file->geometry(0, 0, {true, true});
    if (!geometry) return std::pair(geometry.error().text(), std::vector<float>());
    EXPECT_EQ(geometry.value().positions, test::kQuad);
    return std::pair(std::string(), geometry.value().normals);
  };
  EXPECT_EQ(read([](GltfBuilder&) {}), std::pair(std::string(), normals));
  EXPECT_NE(read([](GltfBuilder& b) { b.json["bufferViews"][1]["byteLength"] = 44; }).first, "");
  EXPECT_NE(read([](GltfBuilder& b) { b.json["accessors"][2]["count"] = 3; }).first, "");
  EXPECT_NE(read([](GltfBuilder& b) { b.json["accessors"][2]["byteOffset"] = 4; }).first, "");
}

TEST(GltfDraco, attribute_of_the_extension_alone_is_refused) {
  GltfBuilder builder;
  const std::string coded = test::draco_mesh(test::kQuad, kCorners, DracoOrder::kKept, std::vector<float>(12, 1.0F));
  auto primitive = test::draco_primitive(builder, coded, 4, 6, true, {});
  primitive["attributes"].erase("NORMAL");
  builder.add_mesh(primitive);
  const GltfFixture file(builder);
  EXPECT_TRUE(file.error().starts_with("a.gltf, /meshes/0/primitives/0/extensions/KHR_draco_mesh_compression"))
      << file.error();
}

TEST(GltfDraco, every_truncated_stream_is_refused) {
  const std::string coded = test::draco_mesh(test::kQuad, kCorners, DracoOrder::kKept);
  for (std::size_t size = 1; size < coded.size(); ++size) {
    GltfBuilder builder;
    builder.add_mesh(test::draco_primitive(builder, coded.substr(0, size), 4, 6, false, {}));
    const GltfFixture file(builder);
    ASSERT_TRUE(file.ok()) << file.error();
    EXPECT_FALSE(file->geometry(0, 0, {}).ok()) << size;
  }
}

}  // namespace
}  // namespace chronormal::gltf_compressed_test
