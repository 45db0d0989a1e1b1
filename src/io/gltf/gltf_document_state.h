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

  // Returns an error if the arrays of a primitive and this many targets would take too much memory.
  [[nodiscard]] Status check_size(std::size_t mesh, std::size_t primitive, std::size_t targets, bool shading);
  // Reads the wanted arrays that an object of attributes names, except arrays that already have values.
  [[nodiscard]] Status read(const gltf::Attributes& attributes, bool shading, std::vector<float>& positions,
                            std::vector<float>& normals, std::vector<float>& tangents);
  // Releases memory that maps the files, after this many vertices were read.
  void release(std::size_t vertices) const noexcept;

  std::optional<FileBytes> file;  // if the document keeps it
  GlbChunks chunks;               // for a .gltf file: its JSON, at offset 0
  gltf::Model model;
  std::string name;
  gltf::Bytes bytes;
  std::size_t most_bytes;
};

}  // namespace chronormal

#endif  // CHRONORMAL_IO_GLTF_GLTF_DOCUMENT_STATE_H_
