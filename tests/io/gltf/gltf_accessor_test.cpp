// Tests how the glTF reader turns the bytes of buffers into numbers: strides, sparse accessors, and quantised
// components.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "tests/support/gltf_builder.h"

namespace chronormal::gltf_accessor_test {
namespace {

using test::GltfBuilder, test::GltfFixture;

GltfGeometry geometry_of(const GltfBuilder& builder) {
  const GltfFixture file(builder);
  EXPECT_TRUE(file.ok()) << file.error();
  if (!file.ok()) return {};
  Result<GltfGeometry> geometry = file->geometry(0, 0, {true, true});
  EXPECT_TRUE(geometry.ok()) << geometry.error().text();
  return geometry ? geometry.value() : GltfGeometry{};
}

TEST(GltfAccessors, elements_may_stand_apart) {
  for (const std::size_t stride : {std::size_t{12}, std::size_t{16}, std::size_t{24}, std::size_t{252}}) {
    GltfBuilder builder;
    const std::size_t base = builder.add_strided("VEC3", test::kQuad, stride);
    const std::size_t lift = builder.add_strided("VEC3", test::kLift, stride);
    builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners), {{{"POSITION", lift}}}));
    const GltfGeometry geometry = geometry_of(builder);
    EXPECT_EQ(geometry.positions, test::kQuad) << stride;
    ASSERT_EQ(geometry.targets.size(), 1U);
    EXPECT_EQ(geometry.targets[0].positions, test::kLift) << stride;
  }
}

TEST(GltfAccessors, positions_and_normals_may_be_interleaved) {
  // The buffer view has a position, a normal, a position, a normal and so on. The last normal ends exactly at the end
  // of the view.
  std::vector<float> mixed;
  const std::vector<float> normals = {0, 0, 1, 0, 1, 0, 1, 0, 0, 0, 0, -1};
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t k = 0; k < 3; ++k) mixed.push_back(test::kQuad[3 * i + k]);
    for (std::size_t k = 0; k < 3; ++k) mixed.push_back(normals[3 * i + k]);
  }
  GltfBuilder builder;
  const std::size_t view = builder.add_view(test::bytes_of(mixed), 24);
  const std::size_t base = builder.add_accessor_over(view, "VEC3", 5126, 4);
  const std::size_t second = builder.add_accessor_over(view, "VEC3", 5126, 4);
  builder.json["accessors"][second]["byteOffset"] = 12;
  auto primitive = GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners));
  primitive["attributes"]["NORMAL"] = second;
  builder.add_mesh(primitive);
  EXPECT_EQ(geometry_of(builder).positions, test::kQuad);
  EXPECT_EQ(geometry_of(builder).normals, normals);

  // Ends the buffer view with the last position, so that its last stride is incomplete.
  builder.json["bufferViews"][view]["byteLength"] = 24 * 3 + 12;
  builder.json["meshes"][0]["primitives"][0]["attributes"].erase("NORMAL");
  EXPECT_EQ(geometry_of(builder).positions, test::kQuad);
}

TEST(GltfAccessors, accessors_may_begin_inside_their_view) {
  GltfBuilder builder;
  std::vector<float> both = {7, 7, 7};
  both.insert(both.end(), test::kQuad.begin(), test::kQuad.end());
  const std::size_t base = builder.add_positions(both);
  builder.json["accessors"][base]["byteOffset"] = 12;
  builder.json["accessors"][base]["count"] = 4;
  builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners)));
  EXPECT_EQ(geometry_of(builder).positions, test::kQuad);
}

TEST(GltfAccessors, whole_numbers_may_be_written_as_floats) {
  GltfBuilder builder = test::quad_document();
  builder.json["accessors"][0]["count"] = 4.0;
  builder.json["accessors"][0]["byteOffset"] = 0.0;
  EXPECT_EQ(geometry_of(builder).positions, test::kQuad);
}

// The elements by which a sparse accessor replaces elements 1 and 3 of the quad (kReplacing), and the result
// (kReplaced). kReplacedZeros is the result if all other elements are zeros.
const std::vector<float> kReplacing = {5, 6, 7, 8, 9, 10};
const std::vector<float> kReplaced = {0, 0, 0, 5, 6, 7, 1, 1, 0, 8, 9, 10};
const std::vector<float> kReplacedZeros = {0, 0, 0, 5, 6, 7, 0, 0, 0, 8, 9, 10};

template <class Index>
void expect_sparse() {
  GltfBuilder over;
  const std::size_t replaced = over.add_positions(test::kQuad);
  over.add_mesh(GltfBuilder::primitive(replaced, over.add_indices(test::kQuadCorners)));
  over.make_sparse<Index>(replaced, {1, 3}, kReplacing);
  EXPECT_EQ(geometry_of(over).positions, kReplaced);

  // Without a buffer view, the elements that a sparse accessor does not replace are zero, as in a target that moves few
  // vertices.
  GltfBuilder alone;
  const std::size_t base = alone.add_positions(test::kQuad);
  const std::size_t target = alone.add_accessor_over(std::nullopt, "VEC3", 5126, 4);
  alone.make_sparse<Index>(target, {1, 3}, kReplacing);
  alone.add_mesh(GltfBuilder::primitive(base, alone.add_indices(test::kQuadCorners), {{{"POSITION", target}}}));
  const GltfGeometry geometry = geometry_of(alone);
  EXPECT_EQ(geometry.positions, test::kQuad);
  ASSERT_EQ(geometry.targets.size(), 1U);
  EXPECT_EQ(geometry.targets[0].positions, kReplacedZeros);
}

TEST(GltfSparse, elements_are_replaced_over_a_view_and_over_zeros) {
  expect_sparse<std::uint8_t>();
  expect_sparse<std::uint16_t>();
  expect_sparse<std::uint32_t>();
}

TEST(GltfSparse, base_positions_may_be_sparse_over_zeros) {
  GltfBuilder builder;
  const std::size_t base = builder.add_accessor_over(std::nullopt, "VEC3", 5126, 4);
  builder.make_sparse<std::uint16_t>(base, {1, 3}, kReplacing);
  builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners)));
  EXPECT_EQ(geometry_of(builder).positions, kReplacedZeros);
}

TEST(GltfSparse, target_without_view_and_sparse_part_is_all_zero) {
  GltfBuilder builder = test::quad_document();
  builder.json["accessors"][2].erase("bufferView");
  EXPECT_EQ(geometry_of(builder).targets[0].positions, std::vector<float>(12, 0.0F));
}

TEST(GltfSparse, strided_view_is_replaced_at_the_right_places) {
  GltfBuilder builder;
  const std::size_t base = builder.add_strided("VEC3", test::kQuad, 20);
  builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners)));
  builder.make_sparse<std::uint8_t>(base, {1, 3}, kReplacing);
  EXPECT_EQ(geometry_of(builder).positions, kReplaced);
}

TEST(GltfSparse, indices_of_corners_may_be_sparse) {
  GltfBuilder builder = test::quad_document();
  builder.make_sparse<std::uint8_t, std::uint16_t>(1, {0, 5}, {3, 1});
  EXPECT_EQ(geometry_of(builder).corners, (std::vector<std::uint32_t>{3, 1, 2, 0, 2, 1}));
}

// Returns the number for which a component c stands, by the formulas of section 3.6.2.2 of the glTF specification, in
// long double. The reader must return the nearest float.
template <class T>
float as_float(T c, bool normalized) {
  if (!normalized) return static_cast<float>(c);
  const long double f = static_cast<long double>(c) / static_cast<long double>(std::numeric_limits<T>::max());
  return static_cast<float>(std::max(f, -1.0L));
}

// Reads twelve components of type T, including the smallest and the largest value. Every element is padded to a
// multiple of four bytes.
template <class T>
void expect_quantised() {
  constexpr T kMin = std::numeric_limits<T>::min(), kMax = std::numeric_limits<T>::max();
  const std::vector<T> values = {0,   1, kMin, kMax, static_cast<T>(kMin + 1), 64, 2, 3, static_cast<T>(kMax - 1),
                                 100, 9, 10};
  for (const bool normalized : {false, true}) {
    SCOPED_TRACE(std::to_string(GltfBuilder::component_type<T>()) + (normalized ? " normalised" : ""));
    std::vector<float> expected;
    for (const T value : values) expected.push_back(as_float(value, normalized));

    GltfBuilder builder;
    const std::size_t base = builder.add_strided("VEC3", values, (3 * sizeof(T) + 3) / 4 * 4, normalized);
    builder.add_mesh(GltfBuilder::primitive(base, builder.add_indices(test::kQuadCorners), {{{"POSITION", base}}}));
    builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
    // The specification permits only signed integers as components of targets.
    const bool is_target = std::is_signed_v<T>;
    if (!is_target) builder.json["meshes"][0]["primitives"][0].erase("targets");
    const GltfGeometry geometry = geometry_of(builder);
    EXPECT_EQ(geometry.positions, expected);
    if (is_target) {
      ASSERT_EQ(geometry.targets.size(), 1U);
      EXPECT_EQ(geometry.targets[0].positions, expected);
    }
  }
}

TEST(GltfQuantised, components_follow_the_formulas_of_the_specification) {
  expect_quantised<std::int8_t>();
  expect_quantised<std::uint8_t>();
  expect_quantised<std::int16_t>();
  expect_quantised<std::uint16_t>();
}

TEST(GltfQuantised, formulas_as_numbers) {
  EXPECT_EQ(as_float<std::int8_t>(-128, true), -1.0F);
  EXPECT_EQ(as_float<std::int8_t>(-127, true), -1.0F);
  EXPECT_EQ(as_float<std::int8_t>(127, true), 1.0F);
  EXPECT_EQ(as_float<std::uint8_t>(51, true), 0.2F);
  EXPECT_EQ(as_float<std::uint16_t>(65535, true), 1.0F);
  EXPECT_EQ(as_float<std::int16_t>(-32768, true), -1.0F);
}

TEST(GltfQuantised, normals_and_tangents_are_normalised_signed_integers) {
  GltfBuilder builder = test::quad_document();
  const std::vector<std::int8_t> normals = {0, 0, 127, 0, -127, 0, 127, 0, 0, 0, 0, -128};
  const std::vector<std::int16_t> tangents = {32767, 0,     0, 32767, 0, 0,      32767, -32767,
                                              0,     32767, 0, 32767, 0, -32768, 0,     -32767};
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  auto& attributes = builder.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] = builder.add_strided("VEC3", normals, 4, true);
  attributes["TANGENT"] = builder.add_strided("VEC4", tangents, 8, true);
  const GltfGeometry geometry = geometry_of(builder);
  EXPECT_EQ(geometry.normals, (std::vector<float>{0, 0, 1, 0, -1, 0, 1, 0, 0, 0, 0, -1}));
  EXPECT_EQ(geometry.tangents, (std::vector<float>{1, 0, 0, 1, 0, 0, 1, -1, 0, 1, 0, 1, 0, -1, 0, -1}));
}

}  // namespace
}  // namespace chronormal::gltf_accessor_test
