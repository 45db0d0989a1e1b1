/// Changes to a glTF file that leave everything else as it is, byte for byte.
///
/// The JSON is not printed anew: what changes is spliced into the text of the source, so that every token that is not
/// named by a pointer keeps its bytes (64-bit integers, 1e400, unknown extensions, the order of members, blanks). New
/// arrays go behind the BIN chunk of the source, which stays a prefix of the new one unless leave_out_unused() is
/// called.
///
///     GltfEdit edit(document);
///     const std::size_t a = edit.add_vectors(deltas, {});               // a new accessor
///     edit.set("/meshes/0/primitives/0/targets/0/NORMAL", std::to_string(a));
///     edit.append("/meshes/0/weights", "0");
///     edit.write("walk.exact.glb", /*force=*/false);
///
/// Pointers   RFC 6901. Changes are made in the order of the calls, each on what those before it left: what was set or
///            appended can be changed again. Of members that come twice, the last counts, as for the reader.
/// Container  by the extension of the path, .glb or .gltf; streams (-, /dev/stdout, pipes) get that of the source.
///            GLB to GLB: the source, with a longer BIN chunk. .gltf to GLB: buffers that lie outside (files, data
///            URIs) move into the BIN chunk, and so do images that are files: the file stands alone. To .gltf: the BIN
///            chunk and the new arrays become data URIs, so that one file is replaced at once.
/// Folders    into another folder than that of the source, or into a stream, files that the source refers to are taken
///            along, buffers and images: into the BIN chunk, or as data URIs. Beside the source the references stay.
///            URIs in extensions are not looked for.
/// Memory     of new arrays, once, and of the changes; the source is streamed from its mapping. Data URIs are built in
///            memory.
/// Threads    an edit and its document belong to one thread at a time.
#ifndef CHRONORMAL_IO_GLTF_EDIT_H_
#define CHRONORMAL_IO_GLTF_EDIT_H_

#include <cstddef>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"

namespace chronormal {

/// How an accessor of new numbers is written.
struct GltfVectors {
  bool bounds = false;  ///< min and max, which positions and times need
  /// Write all zeros as bytes too. Otherwise arrays that are mostly zero become a sparse accessor where that is
  /// smaller, and those that all are an accessor without a bufferView, which some readers (Assimp) refuse.
  bool dense = false;
};

class GltfEdit {
 public:
  /// The document must outlive this.
  explicit GltfEdit(const GltfDocument& source);
  GltfEdit(GltfEdit&&) noexcept;
  GltfEdit& operator=(GltfEdit&&) noexcept;
  GltfEdit(const GltfEdit&) = delete;
  GltfEdit& operator=(const GltfEdit&) = delete;
  ~GltfEdit();

  /// Replaces the value at a pointer, or adds the member that its last token names; objects that are missing on the way
  /// are made. json is the text of a value. What is wrong with either, bytes() and write() say.
  void set(std::string pointer, std::string json);
  /// Adds a value to the end of an array, which is made where it is missing.
  void append(std::string pointer, std::string json);
  /// Whether the source, without changes, has a value at a pointer; and its text, empty where there is none.
  [[nodiscard]] bool has(const std::string& pointer) const;
  [[nodiscard]] std::string text(const std::string& pointer) const;

  /// Adds an accessor of float32 VEC3 (n, 3), meant for vertices, or of SCALAR (n), for animations, and returns its
  /// index. Arrays with the same bytes and options share one accessor. n > 0, and values must be finite.
  [[nodiscard]] std::size_t add_vectors(std::span<const float> vectors, const GltfVectors& options = {});
  [[nodiscard]] std::size_t add_scalars(std::span<const float> scalars, const GltfVectors& options = {});

  /// From now on leaves out what the changes leave unused: the bytes of arrays that the source refers to and its result
  /// does not, in buffers that the result holds itself (BIN chunk, data URIs). What follows them moves towards the
  /// front; all indices stay. Files with extensions that may refer to arrays in ways of their own keep all their bytes.
  void leave_out_unused();

  /// What a file at this path has otherwise than the source: pointers that are replaced or added, as they are in the
  /// result, sorted; /accessors/N, /buffers/N and so on of what is new among them. Of what was added together, the
  /// outermost. Without a path: in the container and the folder of the source. Errors: as of write(), but for the file.
  [[nodiscard]] Result<std::vector<std::string>> pointers(const std::string& path = "") const;
  /// What a file at this path can not take along: images that are not there. A sentence each.
  [[nodiscard]] std::vector<std::string> warnings(const std::string& path) const;
  /// How many bytes of arrays were added.
  [[nodiscard]] std::size_t added_bytes() const noexcept;
  /// How many bytes of the source a file at this path is without, by leave_out_unused(). Errors: as of pointers().
  [[nodiscard]] Result<std::size_t> unused_bytes(const std::string& path = "") const;

  /// The whole new file in memory, as write() would write it to path.
  [[nodiscard]] Result<std::string> bytes(const std::string& path) const;
  /// Writes the new file, by write_output() (io/output.h).
  /// Errors: of write_output(); kUsage for another extension; kInvalidInput with the pointer as the place where the
  /// source is such that a change is not possible (a parent that is no object, an array that is none), for JSON that is
  /// none, for buffers that can not be read, images that are of no known kind, and for a GLB of 4 GiB or more.
  [[nodiscard]] Status write(const std::string& path, bool force) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_IO_GLTF_EDIT_H_
