/// New arrays of a glTF file: how they are stored, and the accessors and buffer views that name them. Private to io.
#ifndef CHRONORMAL_IO_GLTF_EDIT_GLTF_EDIT_ARRAYS_H_
#define CHRONORMAL_IO_GLTF_EDIT_GLTF_EDIT_ARRAYS_H_

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include "chronormal/io/gltf_edit.h"

namespace chronormal::inline internal::gltf {

/// Arrays of one kind share a buffer view: vectors, whose target is ARRAY_BUFFER (section 3.6.2.4 of the
/// specification), scalars, and the indices and values of sparse accessors, neither of which may have a target.
class NewArrays {
 public:
  /// Stores an array of `components` numbers per element, 1 or 3, unless there is the same already. Returns its index.
  std::size_t add(std::span<const float> values, std::size_t components, const GltfVectors& options);

  [[nodiscard]] std::size_t count() const noexcept { return arrays_.size(); }
  /// Of all bytes, a multiple of 4.
  [[nodiscard]] std::size_t byte_count() const noexcept;
  [[nodiscard]] std::size_t view_count() const noexcept;
  /// The bytes, which live as long as this.
  [[nodiscard]] std::vector<std::string_view> pieces() const;

  /// The JSON of buffer views and of accessors, in the order of their indices, for bytes that begin at `offset` of a
  /// buffer, and buffer views that are numbered from first_view.
  struct Json {
    std::vector<std::string> views, accessors;
  };
  [[nodiscard]] Json json(std::size_t buffer, std::size_t offset, std::size_t first_view) const;

 private:
  struct Array {
    std::size_t components = 1, count = 0;
    std::string dense;  // padded to a multiple of 4, as all bytes are
    std::size_t sparse_count = 0;
    std::size_t index_type = 0;
    std::string indices, values;  // of the sparse_count elements that are not zero
    std::string least, most;      // bounds as JSON, or empty

    bool operator==(const Array&) const = default;
  };
  struct Sizes {
    std::size_t vectors = 0, scalars = 0, sparse = 0;
  };

  [[nodiscard]] static Array encode(std::span<const float> values, std::size_t components, const GltfVectors& options);
  [[nodiscard]] Sizes sizes() const noexcept;

  std::vector<Array> arrays_;
  std::unordered_multimap<std::size_t, std::size_t> by_hash_;
};

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_EDIT_GLTF_EDIT_ARRAYS_H_
