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

/// Adds up the control normals of the faces of each element, in their order; of_face(f) returns those of face f.
/// result must have as many elements as the range
template <std::size_t K, class OfFace>
void sum_path_normals(const NormalGroups& groups, IndexRange elements, const OfFace& of_face,
                      std::span<PolynomialNormals<K>> result) noexcept {
  for (std::size_t i = 0; i < elements.count; ++i) {
    std::array<VectorSum, 2 * K + 1> sum;
    for (const std::uint32_t f : groups.faces(elements.first + i)) {
      const PolynomialNormals<K>& normals = of_face(f);
      for (std::size_t k = 0; k < sum.size(); ++k) sum[k].add(normals[k]);
    }
    for (std::size_t k = 0; k < sum.size(); ++k) result[i][k] = sum[k].without_rounding();
  }
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_PATH_SUMS_H_
