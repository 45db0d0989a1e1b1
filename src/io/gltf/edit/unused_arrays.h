/// Finds the arrays of a glTF file to which nothing refers after an edit. Private to io.
///
///     unused    accessors that the source refers to and the edited document does not: from primitives, targets,
///               samplers and skins. Accessors that were already unused in the source stay.
///     left out  bytes of buffers inside the result (the BIN chunk, data URIs, included files), if they belong only to
///               such accessors; later bytes move to the front of the buffer by multiples of 4, so that every number
///               stays aligned
///
/// Indices of accessors and views stay valid: an unused accessor is replaced by an accessor of a single zero, and a
/// buffer view of unused accessors by a view of one byte. A buffer with only unused arrays therefore keeps its first
/// four bytes. An unknown extension may refer to accessors and views anywhere. A file that has an extension which is
/// not known to be free of such references keeps all its bytes.
#ifndef CHRONORMAL_IO_GLTF_EDIT_UNUSED_ARRAYS_H_
#define CHRONORMAL_IO_GLTF_EDIT_UNUSED_ARRAYS_H_

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/gltf/model/gltf_model.h"

namespace chronormal::inline internal::gltf {

struct UnusedArrays {
  struct Range {
    std::size_t begin = 0, end = 0;
  };

  /// the ranges that are left out of each buffer, ascending, and without common bytes; empty if nothing is left out
  std::vector<std::vector<Range>> ranges;
  std::vector<std::size_t> view_offsets;  ///< new start of each view in its buffer; empty if no view moves
  /// Changes to the JSON that follow from leaving out bytes, as pairs of a JSON pointer and a new value.
  std::vector<std::pair<std::string, std::string>> changes;

  [[nodiscard]] bool any() const noexcept { return !ranges.empty(); }
  [[nodiscard]] std::size_t bytes_of(std::size_t buffer) const noexcept;
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Returns the pieces of a buffer, in order, that remain without the ranges to leave out.
  [[nodiscard]] std::vector<std::string_view> kept(std::size_t buffer, std::string_view bytes) const;
};

/// Finds the unused arrays of `model`, which was parsed from `before`, the JSON of the source. `after` is the JSON of
/// the edited document. For each buffer that may become shorter, `sizes` has the number of bytes of the buffer, and for
/// other buffers no value. O(size of the JSON).
[[nodiscard]] UnusedArrays find_unused_arrays(const Model& model, std::span<const std::optional<std::size_t>> sizes,
                                              std::string_view before, std::string_view after);

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_EDIT_UNUSED_ARRAYS_H_
