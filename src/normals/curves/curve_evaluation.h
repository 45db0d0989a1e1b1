/// Evaluates prepared curves, for any class that has CurveData. An evaluation goes through the runs of blocks
/// (curve_data.h), passes each run to the kernel as a whole, and then overwrites the flagged elements, for which
/// float32 is not accurate enough, with values computed in double. outputs.h lists the forms of results. Nothing here
/// allocates or throws.
#ifndef CHRONORMAL_NORMALS_CURVES_CURVE_EVALUATION_H_
#define CHRONORMAL_NORMALS_CURVES_CURVE_EVALUATION_H_

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/views.h"
#include "chronormal/normals/control_normals.h"
#include "normals/control/exact_curve.h"
#include "normals/control/local_time.h"
#include "normals/curves/curve_data.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/flagged_normals.h"
#include "normals/curves/outputs.h"

namespace chronormal::inline internal {

/// Returns the digits of the ExactCurve of a flagged element, or nullptr if double suffices for the element at every t.
inline const std::int32_t* digits_of(const CurveData& curves, std::size_t element) {
  const auto at = std::lower_bound(curves.exact.begin(), curves.exact.end(), element,
                                   [](const CurveData::ExactElement& e, std::size_t i) { return e.element < i; });
  const bool is_exact = at != curves.exact.end() && at->element == element;
  return is_exact ? curves.exact_digits.data() + at->digits : nullptr;
}

/// Returns the number of flagged elements, from place `first` of the list on, that have consecutive numbers. Stops
/// before place `last`.
inline std::size_t run_from(const std::vector<std::size_t>& flagged, std::size_t first, std::size_t last) noexcept {
  if (flagged[last - 1] - flagged[first] == last - 1 - first) return last - first;
  std::size_t count = 1;
  while (first + count < last && flagged[first + count] == flagged[first] + count) ++count;
  return count;
}

/// Computes the normals of the flagged elements of a range in double at t, and calls write(element, xyz, count) for
/// each run of neighbouring elements. Then calls settle(index, element) for each element for which double does not
/// suffice; `index` is the place of this element among the flagged elements.
template <class Write, class Settle>
void for_flagged(const CurveData& curves, IndexRange range, const LocalTime& t, const Write& write,
                 const Settle& settle) {
  const auto index_of = [&flagged = curves.flagged.numbers](std::size_t element) {
    return static_cast<std::size_t>(std::lower_bound(flagged.begin(), flagged.end(), element) - flagged.begin());
  };
  constexpr std::size_t kBatch = 4;  // number of tiles that are evaluated in one call
  const std::size_t begin = index_of(range.first), end = index_of(range.end());
  FlaggedUnits batch[kBatch];
  for (std::size_t tile = begin / kTile; tile * kTile < end; tile += kBatch) {
    const std::size_t count = std::min(kBatch, curves.flagged.tiles.size() - tile);
    flagged_unit_normals(std::span(curves.flagged.tiles).subspan(tile, count), t, batch);
    for (std::size_t i = 0; i < count; ++i) {
      const FlaggedUnits& units = batch[i];
      const std::size_t first = (tile + i) * kTile, last = std::min(first + kTile, end);
      for (std::size_t k = std::max(first, begin); k < last;) {
        const std::size_t run = run_from(curves.flagged.numbers, k, last);
        write(curves.flagged.numbers[k], units.xyz + 3 * (k - first), run);
        k += run;
      }
      if (units.uncertain == 0) continue;
      for (std::size_t k = std::max(first, begin); k < last; ++k)
        if ((units.uncertain >> (k - first) & 1) != 0) settle(k, curves.flagged.numbers[k]);
    }
  }
}

/// Writes the normals of the flagged elements of a range. Returns the number of elements that have no direction.
template <class Output>
std::size_t write_flagged_range(const CurveData& curves, IndexRange range, const LocalTime& t,
                                const Output& output) noexcept {
  std::size_t without_direction = 0;
  for_flagged(
      curves, range, t,
      [&output](std::size_t element, const float* xyz, std::size_t count) { set_run(output, element, xyz, count); },
      [&](std::size_t index, std::size_t element) {
        const std::int32_t* const digits = digits_of(curves, element);
        const UnitNormal u = digits != nullptr ? ExactCurve::of_kept(digits).unit_normal_at(t)
                                               : unit_normal_at(curves.flagged.scaled_normals(index), t);
        output.set(element, to_float(u.vector));
        if (u.direction == Direction::kNone) ++without_direction;
      });
  return without_direction;
}

/// Writes the normals of the elements of a range at one t, in one pass over their blocks. Returns the number of
/// elements that have no direction. Precondition: range.first is a multiple of kTile.
template <class Output>
std::size_t evaluate_range(const CurveData& curves, IndexRange range, const LocalTime& t, const CurveWeights& weights,
                           const Output& output) noexcept {
  const std::size_t first_block = range.first / kTile;
  auto run = std::upper_bound(curves.runs.begin(), curves.runs.end(), first_block,
                              [](std::size_t block, const CurveData::Run& r) { return block < r.first_block; });
  std::size_t element = range.first;
  for (--run; element < range.end(); ++run) {
    const IndexRange of_run = run->elements(range.end());
    const std::size_t skipped = element - of_run.first;
    const std::byte* const blocks = curves.blocks.data() + run->offset + skipped * bytes_of(run->kind);
    output.write({blocks, run->kind, of_run.end() - element}, weights, element);
    element = of_run.end();
  }
  return write_flagged_range(curves, range, t, output);
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_CURVE_EVALUATION_H_
