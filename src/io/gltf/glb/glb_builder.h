/// Builds a new GLB file with one primitive from arrays and a JSON document.
///
///     GlbBuilder builder(most_bytes);
///     const std::size_t triangles = builder.set_triangles(corners, vertex_count);
///     const std::size_t positions = builder.add_vectors(xyz, {.bounds = true});
///     builder.document()["meshes"] = ...;         // names accessors by index
///     Result<std::string> file = builder.finish();
///
/// The builder writes the members asset, buffers, bufferViews and accessors; the caller writes the rest. Memory: the
/// triangles, the document, and the spool. Private to io and workflow.
#ifndef CHRONORMAL_IO_GLTF_GLB_GLB_BUILDER_H_
#define CHRONORMAL_IO_GLTF_GLB_GLB_BUILDER_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/spool.h"
#include "io/gltf/glb/new_arrays.h"

namespace chronormal::inline internal {

/// Returns the text that files name as their generator, such as "chronormal 0.2.0".
[[nodiscard]] std::string_view generator_name() noexcept;

class GlbBuilder {
 public:
  /// A function that gets the bytes of a file, piece by piece in order. `file_size` is the size of the whole file in
  /// bytes.
  using Take = std::function<Status(std::string_view bytes, std::size_t file_size)>;
  /// Returns a Take that appends the bytes to `file`. The text `file` must outlive the Take.
  [[nodiscard]] static Take gather_in(std::string& file);

  /// The largest size of a GLB, which stores its size in 32 bits.
  static constexpr std::size_t kMostBytes = 0xFFFFFFFF;

  /// Begins a file of at most most_bytes bytes, or of kMostBytes if most_bytes is larger or not given. The arrays stay
  /// in the spool until finish(), because the JSON with their places comes first in the file.
  explicit GlbBuilder(std::optional<std::size_t> most_bytes = {}, Spool spool = {});

  /// Sets the corners of the triangles, and returns the index of their accessor. Indices have 16 bits if that is enough
  /// for vertex_count vertices, and 32 bits otherwise.
  std::size_t set_triangles(std::span<const std::uint32_t> corners, std::size_t vertex_count);
  /// Adds an accessor of float32 VEC3 (n, 3), or of SCALAR (n), and returns its index. Equal arrays are stored only
  /// once. The preconditions are those of GltfEdit.
  std::size_t add_vectors(std::span<const float> vectors, const GltfVectors& options = {});
  std::size_t add_scalars(std::span<const float> scalars, const GltfVectors& options = {});
  /// Adds an accessor of SCALAR (rows x width), and returns its index. fill(row, values) is called for each row in
  /// order, with zeros in `values`, and writes the numbers of this row.
  std::size_t add_table(std::size_t rows, std::size_t width,
                        const std::function<void(std::size_t row, std::span<float> values)>& fill);

  /// Renumbers the accessors of arrays: accessor order[i] becomes the i-th accessor after the accessor of the
  /// triangles, with i from 0, and the bytes of the arrays get the same order. Nothing may be added after this call.
  /// `order` must contain each accessor of an array once.
  void put_in_order(std::span<const std::size_t> order);

  /// Moves the spool out, so that it can be cleared and used again.
  [[nodiscard]] Spool take_spool() && { return std::move(arrays_).take_spool(); }

  /// Returns success if all arrays could be stored. Errors: those of the spool.
  [[nodiscard]] const Status& status() const noexcept { return arrays_.status(); }
  /// Returns the number of bytes of all arrays so far.
  [[nodiscard]] std::uint64_t byte_count() const noexcept { return indices_.size() + arrays_.byte_count(); }
  [[nodiscard]] std::size_t most_bytes() const noexcept { return most_bytes_; }
  [[nodiscard]] nlohmann::ordered_json& document() noexcept { return document_; }

  /// Assembles the file, passes its bytes to `take`, and forgets them. Returns the size of the file in bytes. Errors:
  /// kInvalidInput if the file would be too large (found before `take` is called); those of the spool and of `take`.
  [[nodiscard]] Result<std::size_t> finish(const Take& take);
  /// Assembles the file in memory and returns its bytes. Errors: kInvalidInput if the file would be too large; those of
  /// the spool.
  [[nodiscard]] Result<std::string> finish();

 private:
  nlohmann::ordered_json document_, index_accessor_;
  std::string indices_;
  gltf::NewArrays arrays_;
  std::size_t most_bytes_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_GLTF_GLB_GLB_BUILDER_H_
