/// Finds the arrays of a glTF file to which nothing refers after an edit. Private to io.
///
///     unused    accessors that the source refers to and the edited document does not: from primitives, targets,
///               samplers and skins. Accessors that were already unused in the source stay.
///     left out  bytes of buffers inside the result (the BIN chunk, data URIs, included files), if they belong only to
///               such accessors; later bytes move to the front of the buffer by multiples of 4, so that every number
///               stays aligned
///
/// Indices stay: an unused accessor becomes one of a single zero, and a buffer view of unused accessors a view of one
/// byte. So a buffer with only unused arrays keeps its first four bytes. An unknown extension may refer to accessors
/// and views anywhere, so a file keeps all its bytes unless all of its extensions are known not to.
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

  std::vector<std::vector<Range>> ranges;  ///< ranges of each buffer, ascending and apart; empty if nothing is left out
  std::vector<std::size_t> view_offsets;   ///< new start of each view in its buffer; empty if no view moves
  /// Changes to the JSON that follow from leaving out bytes: JSON pointers and new values.
  std::vector<std::pair<std::string, std::string>> changes;

  [[nodiscard]] bool any() const noexcept { return !ranges.empty(); }
  [[nodiscard]] std::size_t bytes_of(std::size_t buffer) const noexcept;
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// Returns the pieces of a buffer that remain.
  [[nodiscard]] std::vector<std::string_view> kept(std::size_t buffer, std::string_view bytes) const;
};

/// Finds the unused arrays of `model`, which was parsed from `before`, the JSON of the source. `after` is the JSON of
/// the edited document. For each buffer, `sizes` has the number of its bytes if it may become shorter, and nothing
/// otherwise. O(size of the JSON).
[[nodiscard]] UnusedArrays find_unused_arrays(const Model& model, std::span<const std::optional<std::size_t>> sizes,
                                              std::string_view before, std::string_view after);

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_EDIT_UNUSED_ARRAYS_H_
