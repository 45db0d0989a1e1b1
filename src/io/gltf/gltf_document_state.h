/// The data of a GltfDocument. Private to io.
#ifndef CHRONORMAL_IO_GLTF_GLTF_DOCUMENT_STATE_H_
#define CHRONORMAL_IO_GLTF_GLTF_DOCUMENT_STATE_H_

#include <cstddef>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "io/bytes/file.h"
#include "io/gltf/decode/gltf_bytes.h"
#include "io/gltf/glb/glb.h"
#include "io/gltf/model/gltf_model.h"

namespace chronormal {

struct GltfDocument::State {
  State(GlbChunks found, gltf::Model parsed, gltf::Origin asset, std::size_t most)
      : chunks(found), model(std::move(parsed)), name(asset.name), bytes(model, std::move(asset)), most_bytes(most) {}

  // Checks that memory for the arrays of a primitive with `targets` targets may be taken. Errors: the arrays would
  // exceed the limit of expansion.
  [[nodiscard]] Status check_size(std::size_t mesh, std::size_t primitive, std::size_t targets, bool shading);
  // Reads the arrays that `attributes` names: positions and, if `shading` is true, normals and tangents. Arrays that
  // already have values are skipped.
  [[nodiscard]] Status read(const gltf::Attributes& attributes, bool shading, std::vector<float>& positions,
                            std::vector<float>& normals, std::vector<float>& tangents);
  // Releases the memory that holds pages of mapped files, if many vertices were read. Call this function after reading
  // the arrays of `vertices` vertices.
  void release(std::size_t vertices) const noexcept;

  std::optional<FileBytes> file;  // the file, if the document keeps it
  GlbChunks chunks;               // for a .gltf file, only the JSON, at offset 0
  gltf::Model model;
  std::string name;
  gltf::Bytes bytes;
  std::size_t most_bytes;
};

}  // namespace chronormal

#endif  // CHRONORMAL_IO_GLTF_GLTF_DOCUMENT_STATE_H_
