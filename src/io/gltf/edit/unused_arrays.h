/// The arrays of a glTF file that an edit leaves without anybody who refers to them. Private to io.
///
///     unused    accessors that the source refers to and the edited document does not: from primitives, targets, samplers
///               and skins. What nobody referred to before is not ours, and stays.
///     left out  bytes of buffers that the result holds itself (the BIN chunk, data URIs, files that it takes in), where
///               they belong to such accessors and to nothing else; what follows moves towards the front of its buffer by
///               whole multiples of 4, so that every number stays aligned
///
/// Indices stay: an unused accessor becomes one of a single zero, and a buffer view of unused ones a view of one byte. So a
/// buffer of nothing but unused arrays keeps its first four bytes.
/// An extension may refer to accessors and views where only its author knows: files with another one than those that
/// are known to do without keep all their bytes.
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

  std::vector<std::vector<Range>> ranges;  ///< of each buffer, ascending and apart; empty where nothing is left out
  std::vector<std::size_t> view_offsets;   ///< where each view begins in its buffer then; empty as well
  /// Pointers and the values that they need once these bytes are left out.
  std::vector<std::pair<std::string, std::string>> changes;

  [[nodiscard]] bool any() const noexcept { return !ranges.empty(); }
  [[nodiscard]] std::size_t bytes_of(std::size_t buffer) const noexcept;
  [[nodiscard]] std::size_t bytes() const noexcept;
  /// The pieces of a buffer that remain.
  [[nodiscard]] std::vector<std::string_view> kept(std::size_t buffer, std::string_view bytes) const;
};

/// sizes has the bytes of each buffer of the model that may become shorter, and nothing for the others; before and after
/// are the JSON of the source, which the model was parsed from, and of the edited document. O(size of the JSON).
[[nodiscard]] UnusedArrays find_unused_arrays(const Model& model, std::span<const std::optional<std::size_t>> sizes,
                                              std::string_view before, std::string_view after);

}  // namespace chronormal::inline internal::gltf

#endif  // CHRONORMAL_IO_GLTF_EDIT_UNUSED_ARRAYS_H_
