/// The elements of curves for which float32 is not accurate enough, in ascending order. They are stored as their
/// numbers, and as their control normals in tiles of sixteen.
#ifndef CHRONORMAL_NORMALS_CURVES_FLAGGED_ELEMENTS_H_
#define CHRONORMAL_NORMALS_CURVES_FLAGGED_ELEMENTS_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/normals/control_normals.h"
#include "core/blocks.h"
#include "core/memory.h"
#include "normals/curves/kernels/flagged_normals.h"

namespace chronormal::inline internal {

struct FlaggedElements {
  std::vector<std::size_t> numbers;
  std::vector<FlaggedTile, AlignedAllocator<FlaggedTile>> tiles;
  std::vector<std::int16_t> exponents;  ///< the control normals of an element are those in its tile times 2^exponent

  [[nodiscard]] std::size_t size() const noexcept { return numbers.size(); }

  /// Returns the control normals of the flagged element at place `index` as its tile stores them, multiplied by a
  /// power of two.
  [[nodiscard]] ControlNormals scaled_normals(std::size_t index) const noexcept {
    return element_of(tiles[index / kTile].normals, index % kTile);
  }

  /// Removes all elements, but keeps their memory.
  void clear() noexcept {
    numbers.clear();
    tiles.clear();
    exponents.clear();
  }

  void reserve(std::size_t count) {
    numbers.reserve(count);
    tiles.reserve(block_count(count, kTile));
    exponents.reserve(count);
  }

  void add(std::size_t number, const FlaggedNormals& normals) {
    const std::size_t lane = size() % kTile;
    if (lane == 0) tiles.emplace_back();
    tiles.back().set(lane, normals);
    exponents.push_back(normals.exponent);
    numbers.push_back(number);
  }

  /// Adds elements that are side by side in another tile. The first added element is in lane `first` of that tile.
  void append(std::span<const std::size_t> more, const FlaggedTile& from, std::size_t first,
              std::span<const std::int16_t> of_more) {
    const std::size_t lane = size() % kTile, fitting = std::min(more.size(), kTile - lane);
    if (more.size() == kTile && lane == 0) {
      tiles.push_back(from);
    } else {
      if (lane == 0) tiles.emplace_back();
      tiles.back().set_lanes(lane, from, first, fitting);
      if (fitting < more.size()) tiles.emplace_back().set_lanes(0, from, first + fitting, more.size() - fitting);
    }
    numbers.insert(numbers.end(), more.begin(), more.end());
    exponents.insert(exponents.end(), of_more.begin(), of_more.end());
  }
  void append(const FlaggedElements& more) {
    for (std::size_t k = 0; k < more.size(); k += kTile) {
      const std::size_t count = std::min(kTile, more.size() - k);
      append(std::span(more.numbers).subspan(k, count), more.tiles[k / kTile], 0,
             std::span(more.exponents).subspan(k, count));
    }
  }
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_FLAGGED_ELEMENTS_H_
