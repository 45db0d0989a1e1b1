/// Makes small glTF documents, which tests then damage. Together, the documents use everything that the glTF reader
/// supports.
#ifndef CHRONORMAL_TESTS_SUPPORT_GLTF_DOCUMENTS_H_
#define CHRONORMAL_TESTS_SUPPORT_GLTF_DOCUMENTS_H_

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/gltf_builder.h"
#include "tests/support/gltf_compressed.h"

namespace chronormal::test {

/// Makes a document with strided normals, a sparse target without a buffer view, weights, a chain of nodes, and LINEAR
/// and STEP tracks.
[[nodiscard]] inline GltfBuilder sparse_document() {
  GltfBuilder builder = quad_document();
  const std::size_t sparse = builder.add_accessor_over(std::nullopt, "VEC3", 5126, 4);
  builder.make_sparse<std::uint8_t, float>(sparse, {1, 3}, {1, 2, 3, 4, 5, 6});
  const std::size_t normals = builder.add_strided<float>("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, 16);
  auto& mesh = builder.json["meshes"][0];
  mesh["weights"] = {0.5, 0};
  mesh["extras"]["targetNames"] = {"lift", "shift"};
  mesh["primitives"][0]["targets"][1] = {{"POSITION", sparse}, {"NORMAL", 2}};
  mesh["primitives"][0]["attributes"]["NORMAL"] = normals;
  builder.add_primitive(0, mesh["primitives"][0]);
  mesh["primitives"][1]["mode"] = 5;
  builder.add_node(0, {{"weights", {0, 1}}, {"children", {0}}});
  builder.json["accessors"][0]["byteOffset"] = 0;
  const std::size_t animation = builder.add_animation("both");
  builder.add_track<float>(animation, 0, {0, 1, 2}, {0, 0, 1, 0, 0, 1});
  builder.add_track<float>(animation, 1, {0.5F, 2}, {0, 0, 1, 0}, "STEP");
  return builder;
}

/// Makes a document with KHR_mesh_quantization, a triangle fan without indices, and a CUBICSPLINE track of normalised
/// integers.
[[nodiscard]] inline GltfBuilder quantised_document() {
  GltfBuilder builder;
  const std::size_t base = builder.add_strided<std::uint16_t>("VEC3", {0, 0, 0, 99, 0, 0, 99, 99, 0, 0, 99, 50}, 8);
  const std::size_t lift = builder.add_strided<std::int8_t>("VEC3", {0, 0, 9, 0, 0, -9, 0, 0, 8, 7, 6, 5}, 4, true);
  builder.add_mesh(GltfBuilder::primitive(base, std::nullopt, {{{"POSITION", lift}}}, 6));
  builder.add_node(0);
  builder.add_track<std::int8_t>(builder.add_animation(""), 0, {0, 1, 2}, {0, 0, 99, 9, 50, -20, 0, 100, 0},
                                 "CUBICSPLINE");
  builder.json["extensionsUsed"] = builder.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  return builder;
}

/// Makes a document with EXT_meshopt_compression of positions, of triangles, and of a target with the exponential
/// filter.
[[nodiscard]] inline GltfBuilder meshopt_document() {
  GltfBuilder builder;
  const std::size_t base = add_meshopt_positions(builder, kQuad);
  std::vector<std::uint32_t> filtered(kLift.size());
  meshopt_encodeFilterExp(filtered.data(), 4, 12, 12, kLift.data());
  const std::size_t lift = builder.add_accessor_over(
      add_meshopt_view(builder, meshopt_attributes(bytes_of(filtered), 12), 4, 12, "ATTRIBUTES", "EXPONENTIAL"), "VEC3",
      5126, 4);
  const std::vector<std::uint32_t> corners(kQuadCorners.begin(), kQuadCorners.end());
  const std::size_t indices = builder.add_accessor_over(
      add_meshopt_view(builder, meshopt_triangles(corners, 4), 6, 2, "TRIANGLES"), "SCALAR", 5123, 6);
  builder.add_mesh(GltfBuilder::primitive(base, indices, {{{"POSITION", lift}}}));
  builder.add_primitive(
      0, GltfBuilder::primitive(
             base,
             builder.add_accessor_over(add_meshopt_view(builder, meshopt_indices(corners, 4), 6, 4, "INDICES"),
                                       "SCALAR", 5125, 6),
             {{{"POSITION", lift}}}));
  builder.add_node(0);
  builder.add_track<float>(builder.add_animation("one"), 0, {0, 1}, {0, 1});
  return builder;
}

/// Makes a document with KHR_draco_mesh_compression of positions and normals, and an uncompressed target.
[[nodiscard]] inline GltfBuilder draco_document(DracoOrder order = DracoOrder::kKept) {
  GltfBuilder builder;
  const std::size_t lift = builder.add_positions(kLift);
  const std::vector<std::uint32_t> corners(kQuadCorners.begin(), kQuadCorners.end());
  const std::string coded = draco_mesh(kQuad, corners, order, {0, 0, 1, 0, 0, 1, 0, 1, 0, 0, 0, 1});
  builder.add_mesh(draco_primitive(builder, coded, 4, 6, true, {{{"POSITION", lift}}}));
  builder.add_node(0);
  builder.add_track<float>(builder.add_animation("one"), 0, {0, 1}, {0, 1});
  return builder;
}

/// Returns all documents of this file, with their names.
[[nodiscard]] inline std::vector<std::pair<std::string, GltfBuilder>> all_documents() {
  std::vector<std::pair<std::string, GltfBuilder>> documents;
  documents.emplace_back("sparse", sparse_document());
  documents.emplace_back("quantised", quantised_document());
  documents.emplace_back("meshopt", meshopt_document());
  documents.emplace_back("draco", draco_document());
  documents.emplace_back("draco_edgebreaker", draco_document(DracoOrder::kFree));
  return documents;
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_GLTF_DOCUMENTS_H_
