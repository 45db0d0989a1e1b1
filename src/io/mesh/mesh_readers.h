/// The list of mesh formats that can be read, one entry each.
///
/// A new format is a new entry; tests/io/readers_test.cpp walks the list and fails for an entry that has no
/// truncation, boundary and mutation tests, or no fuzz target fuzz/NAME_fuzz.cpp.
#ifndef CHRONORMAL_IO_MESH_MESH_READERS_H_
#define CHRONORMAL_IO_MESH_MESH_READERS_H_

#include <span>
#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "io/mesh/mesh_frame.h"

namespace chronormal {

struct MeshReader {
  std::string_view name;                         ///< "obj": in messages, and of its fuzz target
  std::span<const std::string_view> extensions;  ///< lower case, with the dot: ".obj"
  /// Whether a file that begins with these bytes (a few hundred are enough) looks like this format.
  bool (*recognises)(std::string_view first_bytes);
  /// Reads one mesh; name is for messages. Errors: kInvalidInput, always with a place.
  Result<MeshFrame> (*read)(std::string_view bytes, const std::string& name);
};

/// All readers, in the order in which they are asked whether they recognise a file.
[[nodiscard]] std::span<const MeshReader> mesh_readers() noexcept;

/// The reader whose extension the file name has (in upper or lower case), or nullptr.
[[nodiscard]] const MeshReader* find_mesh_reader(std::string_view file_name) noexcept;

/// The reader for a file: by its extension, or else by its content (name "<stdin>", or an extension unknown).
/// Errors: kInvalidInput with file_name as the place; the message lists what can be read.
[[nodiscard]] Result<const MeshReader*> choose_mesh_reader(std::string_view bytes, const std::string& file_name);

/// Reads a mesh with the reader for it. Errors: of choose_mesh_reader() and of the reader.
[[nodiscard]] Result<MeshFrame> read_mesh(std::string_view bytes, const std::string& name);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_MESH_MESH_READERS_H_
