/// What a GltfDocument holds. Private to io.
#ifndef CHRONORMAL_IO_GLTF_DOCUMENT_STATE_H_
#define CHRONORMAL_IO_GLTF_DOCUMENT_STATE_H_

#include <cstddef>
#include <optional>
#include <string>
#include <utility>

#include "chronormal/io/file.h"
#include "chronormal/io/gltf_document.h"
#include "io/glb.h"
#include "io/gltf_bytes.h"
#include "io/gltf_model.h"

namespace chronormal {

struct GltfDocument::State {
  State(GlbChunks found, gltf::Model parsed, gltf::Origin asset, std::size_t most)
      : chunks(found), model(std::move(parsed)), name(asset.name), bytes(model, std::move(asset)), most_bytes(most) {}

  std::optional<FileBytes> file;  // where the document opened it
  GlbChunks chunks;               // of a .gltf file: its JSON, at offset 0
  gltf::Model model;
  std::string name;
  gltf::Bytes bytes;
  std::size_t most_bytes;
};

}  // namespace chronormal

#endif  // CHRONORMAL_IO_GLTF_DOCUMENT_STATE_H_
