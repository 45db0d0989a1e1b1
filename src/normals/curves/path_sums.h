/// Control normals of elements on curved paths as the sums of those of their faces, for any way to find the latter.
#ifndef CHRONORMAL_NORMALS_CURVES_PATH_SUMS_H_
#define CHRONORMAL_NORMALS_CURVES_PATH_SUMS_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/views.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/paths.h"
#include "core/rounding.h"

namespace chronormal::inline internal {

/// Adds up the control normals of the faces of each element, in their order; of_face(f) returns those of face f. Calls
/// cancelled(i) where those of element i of the range cancel to less than 2^-20 of them, so that their rounding counts.
/// result must have as many elements as the range
template <std::size_t K, class OfFace, class Cancelled>
void sum_path_normals(const NormalGroups& groups, IndexRange elements, const OfFace& of_face,
                      std::span<PolynomialNormals<K>> result, const Cancelled& cancelled) noexcept {
  for (std::size_t i = 0; i < elements.count; ++i) {
    std::array<VectorSum, 2 * K + 1> sum;
    for (const std::uint32_t f : groups.faces(elements.first + i)) {
      const PolynomialNormals<K>& normals = of_face(f);
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k].add(normals[k]);
    }
    bool has_cancelled = false;
    for (std::size_t k = 0; k < sum.size(); ++k) {
      result[i][k] = sum[k].without_rounding();
      has_cancelled |= max_abs(result[i][k]) < 0x1p-20 * sum[k].size();
    }
    if (has_cancelled) cancelled(i);
  }
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_PATH_SUMS_H_
