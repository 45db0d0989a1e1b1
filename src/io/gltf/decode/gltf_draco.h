/// Decodes primitives that KHR_draco_mesh_compression compresses. Private to io.
#ifndef CHRONORMAL_IO_GLTF_DECODE_GLTF_DRACO_H_
#define CHRONORMAL_IO_GLTF_DECODE_GLTF_DRACO_H_

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "io/bytes/expansion.h"
#include "io/gltf/model/gltf_model.h"

namespace chronormal::inline internal::gltf {

/// Decodes the triangles and positions of a primitive and, if with_shading is true, its normals and tangents. The
/// accessors of the primitive, which must have `draco`, define the types of the numbers. Errors: kInvalidInput at
/// `place` for invalid bytes, for no triangles, for a number of vertices other than the accessors declare, for an
/// attribute that is missing or of another type, and for more faces than the limit of expansion allows. The limit is
/// checked first.
[[nodiscard]] Result<GltfGeometry> decode_draco(std::string_view bytes, const Model& model,
                                                const PrimitiveSource& source, bool with_shading,
                                                const Expansion& expansion, const std::string& place);

/// Decodes some attributes of a compressed mesh with vertex_count vertices. Each attribute is named by its id in the
/// compressed mesh. The vertices have the same order as in the result of decode_draco(). Errors: those of
/// decode_draco(); errors of attribute n have the place place_of(n).
[[nodiscard]] Result<std::vector<std::vector<float>>> decode_draco_attributes(
    std::string_view bytes, const Model& model, std::size_t vertex_count, std::span<const AttributeSource> attributes,
    const Expansion& expansion, const std::string& place, const std::function<std::string(std::size_t n)>& place_of);

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_DECODE_GLTF_DRACO_H_
