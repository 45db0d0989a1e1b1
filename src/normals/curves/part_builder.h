/// Builds one part of some curves, chunk by chunk. A chunk starts as tiles of control normals and ends as packed
/// blocks. curve_builder.cpp puts the parts together.
#ifndef CHRONORMAL_NORMALS_CURVES_PART_BUILDER_H_
#define CHRONORMAL_NORMALS_CURVES_PART_BUILDER_H_

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "chronormal/core/polynomial.h"
#include "core/memory.h"
#include "normals/curves/certificate.h"
#include "normals/curves/curve_data.h"
#include "normals/curves/curve_sources.h"
#include "normals/curves/kernels/certify.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/pack.h"

namespace chronormal::inline internal {

inline constexpr std::size_t kChunkTiles = 32;
inline constexpr std::size_t kChunk = kChunkTiles * kTile;
inline constexpr std::size_t kWrittenTiles = 4;  // number of tiles that one call of a source writes

inline constexpr std::size_t kShortestRun = 4;  // the fewest blocks that form a run of their own

inline constexpr double kSmallestShare = kSmallestEnd / kLargestComponent;

inline double smaller_end(const ControlNormals& c) { return std::min(max_abs(c.n0), max_abs(c.n1)); }

inline ControlNormals scaled(double scale, const ControlNormals& c) {
  return {scale * c.n0, scale * c.m, scale * c.n1};
}

// The control normals that stand in a block in place of a flagged element, whatever the kind of the block.
inline constexpr ControlNormals kPlaceHolder{{1, 0, 0}, {1, 0, 0}, {1, 0, 0}};

// The precision and the degree that the elements of a block need.
struct Need {
  Precision precision = Precision::k11;
  int degree = 0;

  [[nodiscard]] bool fits_into(const Need& other) const {
    return precision <= other.precision && degree <= other.degree;
  }
  friend bool operator==(const Need&, const Need&) = default;
};

struct NeedRun {
  std::size_t blocks;
  Need need;
};

// Returns the runs of blocks with the same need. A run of fewer than kShortestRun blocks is not worth its overhead, and
// is joined to a neighbouring run that can hold its elements.
inline std::vector<NeedRun> runs_of(std::span<const Need> needs) {
  std::vector<NeedRun> runs;
  const auto append = [](std::vector<NeedRun>& to, const NeedRun& run) {
    if (!to.empty() && to.back().need == run.need) {
      to.back().blocks += run.blocks;
    } else {
      to.push_back(run);
    }
  };
  for (const Need& need : needs) append(runs, {1, need});
  if (runs.size() == 1) return runs;

  for (bool joined = true; joined;) {
    joined = false;
    std::vector<NeedRun> longer;
    for (std::size_t i = 0; i < runs.size(); ++i) {
      NeedRun run = runs[i];
      if (run.blocks < kShortestRun) {
        const Need* into = nullptr;
        if (i + 1 < runs.size() && run.need.fits_into(runs[i + 1].need)) into = &runs[i + 1].need;
        if (!longer.empty() && run.need.fits_into(longer.back().need) &&
            (into == nullptr || longer.back().need.fits_into(*into)))
          into = &longer.back().need;
        if (into != nullptr && !(*into == run.need)) {
          run.need = *into;
          joined = true;
        }
      }
      append(longer, run);
    }
    runs = std::move(longer);
  }
  return runs;
}

// The results of one part of the curves, which one thread builds.
struct CurvePart {
  IndexRange elements;
  std::byte* begin = nullptr;  // place of the part's blocks in memory; nullptr if they are only counted
  std::size_t bytes = 0;
  std::vector<CurveData::Run> runs;  // the runs of the part, whose offsets count from `begin`
  FlaggedElements flagged;
  std::vector<CurveData::ExactElement> exact;
  std::vector<std::int32_t> exact_digits;
  std::vector<std::int16_t> exponents;  // empty, or one exponent for each block
  std::array<std::size_t, 3> degree_counts{};

  // Takes the memory of a part that is no longer needed. The flagged elements of that part must have been taken before.
  void take_memory(CurvePart& done) {
    const auto take = [](auto& to, auto& from) {
      to = std::move(from);
      to.clear();
    };
    take(runs, done.runs);
    take(exact, done.exact);
    take(exact_digits, done.exact_digits);
  }
};

// The result of examining an element that the quick test in float32 did not settle.
struct Examined {
  ControlNormals normals;              // the control normals in double, as precise as the direction requires
  std::optional<Precision> precision;  // the precision that the element needs; no value if it is flagged
  // The relative size of n(t) above which double is certain of the direction. Only flagged elements need it.
  double certain = 0;
  // True if the element is flagged, and n(t) is not proven to be above `certain` at every t.
  bool needs_exact = false;
};

template <class Source>
Examined examined(const Source& source, std::size_t element, const PrecisionLimits& limits) {
  const BoundedNormals rounded = source.in_double(element);
  Examined result;
  result.normals = rounded.normals;
  double share = rounded.largest_share();
  // Control normals from a caller count as exact, since more precise ones cannot be computed without positions.
  constexpr bool kHasExact = !std::is_same_v<Source, GivenNormals>;
  if constexpr (kHasExact) {
    if (!(share <= kLargestShare)) {
      result.normals = source.exact(element).rounded();
      share = 0;
    }
  }
  result.precision = precision_for(result.normals, limits);
  result.certain = smallest_certain(share);
  result.needs_exact = kHasExact && !result.precision && !stays_certain(result.normals, result.certain);
  return result;
}

// The requirements that follow from a tolerance. The members say whether blocks keep lengths, and how precise elements
// must be: for tiles that are computed in double and, if the tolerance allows it, for tiles in float32.
struct BuildLimits {
  explicit BuildLimits(double tolerance)
      : with_lengths(!(tolerance > kExactTolerance)),
        in_double(PrecisionLimits::for_tolerance(tolerance)),
        in_float(PrecisionLimits::for_float_tiles(tolerance)) {}

  bool with_lengths;
  PrecisionLimits in_double;
  std::optional<PrecisionLimits> in_float;
};

template <class Source>
concept WritesInFloat = requires(const Source& source, std::span<ControlTile> tiles) {
  { source.has_float() } -> std::same_as<bool>;
  source.write_in_float(IndexRange{}, tiles);
};

// A rule that decides whether the next tiles are tried in float32. After a failed try, float32 is not tried for a
// while. After another failure, the pause is twice as long.
class FloatTrials {
 public:
  [[nodiscard]] bool is_tried() {
    if (left_alone_ == 0) return true;
    --left_alone_;
    return false;
  }
  void note(bool in_vain) {
    left_alone_ = in_vain ? next_ : 0;
    next_ = in_vain ? std::min(2 * next_, kMost) : kFirst;
  }

 private:
  static constexpr std::size_t kFirst = 8, kMost = 64;
  std::size_t left_alone_ = 0, next_ = kFirst;
};

class PartBuilder {
 public:
  PartBuilder(CurvePart& part, const BuildLimits& limits) : part_(part), limits_(limits), tiles_(kChunkTiles) {}

  // Builds the next chunk of the part. Returns true if chunks are left.
  template <class Source>
  bool make_chunk(Source& source) {
    const IndexRange elements{part_.elements.first + made_, std::min(kChunk, part_.elements.count - made_)};
    add_chunk(source, elements);
    made_ += elements.count;
    return made_ < part_.elements.count;
  }

 private:
  // Returns a number in which the bits of the first `count` lanes are set.
  static constexpr std::uint32_t lanes_of(std::size_t count) { return (std::uint32_t{1} << count) - 1; }

  template <class Source>
  void add_chunk(Source& source, IndexRange elements) {
    const std::size_t tile_count = (elements.count + kTile - 1) / kTile;
    const std::span<ControlTile> tiles(tiles_.data(), tile_count);
    Need needs[kChunkTiles];
    for (std::size_t k = 0; k < tile_count; k += kWrittenTiles) {
      const std::size_t first = k * kTile, count = std::min(kWrittenTiles, tile_count - k);
      fetch_destination(k, count);
      add_tiles(source, {elements.first + first, std::min(count * kTile, elements.count - first)},
                tiles.subspan(k, count), needs + k);
    }

    const std::size_t bytes_before = part_.bytes;
    std::size_t k = 0;
    for (const NeedRun& run : runs_of(std::span(needs, tile_count))) {
      const BlockKind kind = kind_for(run.need.precision, run.need.degree, limits_.with_lengths);
      if (part_.begin != nullptr) pack_tiles(tiles.subspan(k, run.blocks), kind, part_.begin + part_.bytes);
      append_run(elements.first / kTile + k, run.blocks, kind);
      k += run.blocks;
    }
    chunk_bytes_ = part_.bytes - bytes_before;
  }

  // Returns the elements in `count` tiles, from tile `first_tile` on. Tile 0 begins with the first of `elements`.
  static IndexRange range_of(IndexRange elements, std::size_t first_tile, std::size_t count) {
    const std::size_t first = first_tile * kTile;
    return {elements.first + first, std::min(count * kTile, elements.count - first)};
  }

  // Computes a few tiles, and finds for each of them the precision and the degree that its block needs.
  template <class Source>
  void add_tiles(Source& source, IndexRange elements, std::span<ControlTile> tiles, Need* needs) {
    std::array<TileSummary, kWrittenTiles> summaries;
    write_tiles(source, elements, tiles, std::span(summaries).first(tiles.size()));
    for (std::size_t k = 0; k < tiles.size(); ++k) {
      const IndexRange range = range_of(elements, k, 1);
      needs[k].precision = summaries[k].precision;
      const std::uint32_t all = lanes_of(range.count);
      std::uint32_t counted = all;
      if (summaries[k].uncertain != 0) counted &= ~examine(source, range, k, tiles[k], needs[k], summaries[k]);
      const std::uint32_t moving = summaries[k].moving & all, bending = summaries[k].bending & all;
      if (bending == all) {
        part_.degree_counts[2] += range.count;
      } else {
        part_.degree_counts[0] += static_cast<std::size_t>(std::popcount(all & ~moving));
        part_.degree_counts[1] += static_cast<std::size_t>(std::popcount(moving & ~bending));
        part_.degree_counts[2] += static_cast<std::size_t>(std::popcount(bending));
      }
      needs[k].degree = (bending & counted) != 0 ? 2 : (moving & counted) != 0 ? 1 : counted != 0 ? 0 : kNoDegree;
    }
  }

  // Writes a few tiles and their summaries. Tries float32 first if that may suffice, and uses double for the tiles for
  // which float32 does not suffice.
  template <class Source>
  void write_tiles(Source& source, IndexRange elements, std::span<ControlTile> tiles,
                   std::span<TileSummary> summaries) {
    // If elements of the last tiles had to be examined, elements of the next tiles probably will be, too. So error
    // bounds are requested together with the tiles, which costs little.
    const bool with_bounds = std::exchange(is_examined_, false);
    has_bounds_ = 0;
    const auto in_double = [&](std::size_t first, std::size_t count) {
      const IndexRange range = range_of(elements, first, count);
      const std::span<ControlTile> some = tiles.subspan(first, count);
      if (with_bounds) {
        source.write(range, some, std::span(bounded_).subspan(first, count));
        has_bounds_ |= lanes_of(count) << first;
      } else {
        source.write(range, some);
      }
      summarize_tiles(some, limits_.in_double, summaries.subspan(first, count));
    };
    if constexpr (WritesInFloat<Source>) {
      if (limits_.in_float && source.has_float() && float_.is_tried()) {
        source.write_in_float(elements, tiles);
        summarize_tiles(tiles, *limits_.in_float, summaries);
        std::size_t in_vain = 0;
        for (std::size_t k = 0; k < tiles.size(); ++k) {
          if (summaries[k].uncertain == 0) continue;
          in_double(k, 1);
          ++in_vain;
        }
        float_.note(2 * in_vain > tiles.size());
        return;
      }
    }
    in_double(0, tiles.size());
  }

  // Prefetches the memory to which the blocks of some tiles will be written, as many bytes as the blocks of the last
  // chunk took. The memory arrives while the tiles are computed. Only a little is prefetched at a time, since a core
  // that requests too many cache lines at once has to wait.
  void fetch_destination(std::size_t tile, std::size_t count) const {
#if defined(__GNUC__)
    if (part_.begin == nullptr) return;
    constexpr std::size_t kCacheLine = 64;
    const std::size_t each = chunk_bytes_ / kChunkTiles;
    const std::byte* const destination = part_.begin + part_.bytes + tile * each;
    for (std::size_t i = 0; i < count * each; i += kCacheLine) __builtin_prefetch(destination + i, 1);
#endif
  }

  // Examines in double those elements of tile k that the quick test did not settle, first sixteen at a time, and then
  // the remaining elements one by one. Returns the bits of the flagged elements, and corrects degrees.
  template <class Source>
  std::uint32_t examine(Source& source, IndexRange elements, std::size_t k, ControlTile& tile, Need& need,
                        TileSummary& summary) {
    constexpr int kFewest = 3;  // number of elements from which it is faster to examine sixteen at a time
    const std::uint32_t uncertain = summary.uncertain & lanes_of(elements.count);
    TileCertificates& known = certificates_;
    known.clear();
    if (std::popcount(uncertain) >= kFewest) {
      is_examined_ = true;
      BoundedTile& bounded = bounded_[k];
      if ((has_bounds_ >> k & 1) == 0) source.write(elements, std::span(&tile, 1), std::span(&bounded, 1));
      certify_tile(bounded, limits_.in_double, uncertain & ~bounded.left_out, known);
      need.precision = std::max(need.precision, known.precision);
    }
    if (known.flagged == lanes_of(kTile)) {
      add_known(elements.first, 0, kTile);
      for (std::size_t plane = 0; plane < 9; ++plane)
        std::fill_n(tile.normals[plane], kTile, plane % 3 == 0 ? 1.0F : 0.0F);  // the values of kPlaceHolder
      add_exact(source, elements.first, known.needs_exact);
      return known.flagged;
    }
    return examine_alone(source, elements, uncertain & ~known.known, tile, need, summary);
  }

  // Examines some elements of a tile one by one. Then adds all flagged elements of the tile, also those that
  // certify_tile() has found.
  template <class Source>
  std::uint32_t examine_alone(Source& source, IndexRange elements, std::uint32_t asked, ControlTile& tile, Need& need,
                              TileSummary& summary) {
    const TileCertificates& known = certificates_;
    std::uint32_t flagged = known.flagged, needs_exact = known.needs_exact;
    bool out_of_range = false;
    std::array<std::optional<Examined>, kTile> alone;
    for_lanes(asked, [&](std::size_t lane) {
      alone[lane] = examined(source, elements.first + lane, limits_.in_double);
      const auto& [normals, precision, certain, lane_needs_exact] = *alone[lane];
      if (precision) {
        need.precision = std::max(need.precision, *precision);
        put(tile, lane, normals);
        out_of_range |= largest_component(normals) > kLargestComponent || smaller_end(normals) < kSmallestEnd;
      } else {
        flagged |= 1u << lane;
        needs_exact |= static_cast<std::uint32_t>(lane_needs_exact) << lane;
      }
    });
    if (out_of_range) flagged |= rescale(source, elements, flagged, tile, alone);
    // New values in the tile have replaced sums that were only rounding error, so the degrees of these elements may
    // have changed.
    for (std::size_t lane = 0; lane < kTile; ++lane) {
      if (alone[lane]) summary.set_degree(lane, degree(alone[lane]->normals));
    }
    for_lanes(flagged, [&](std::size_t lane) { put(tile, lane, kPlaceHolder); });
    for (std::size_t lane = 0; flagged >> lane != 0;) {
      const std::uint32_t left = flagged >> lane;
      if ((left & 1) == 0) {
        lane += static_cast<std::size_t>(std::countr_zero(left));
      } else if (alone[lane]) {
        part_.flagged.add(elements.first + lane, FlaggedNormals::scaled(alone[lane]->normals, alone[lane]->certain));
        ++lane;
      } else {
        const auto neighbours = static_cast<std::size_t>(std::countr_one(known.flagged >> lane));
        add_known(elements.first, lane, neighbours);
        lane += neighbours;
      }
    }
    add_exact(source, elements.first, needs_exact);
    for (std::size_t lane = elements.count; lane < kTile; ++lane)
      for (auto& plane : tile.normals) plane[lane] = plane[elements.count - 1];
    return flagged;
  }

  // Adds neighbouring elements to the flagged elements of the part. Their control normals are in certificates_.
  void add_known(std::size_t first, std::size_t lane, std::size_t count) {
    std::array<std::size_t, kTile> numbers;
    for (std::size_t i = 0; i < count; ++i) numbers[i] = first + lane + i;
    part_.flagged.append(std::span(numbers).first(count), certificates_.scaled, lane,
                         std::span(certificates_.exponents).subspan(lane, count));
  }

  // Adds the exact curves of elements for which double does not suffice at every t.
  template <class Source>
  void add_exact(const Source& source, std::size_t first, std::uint32_t lanes) {
    if constexpr (!std::is_same_v<Source, GivenNormals>) {
      for_lanes(lanes, [&](std::size_t lane) {
        part_.exact.push_back({first + lane, part_.exact_digits.size()});
        source.exact(first + lane).append_to(part_.exact_digits);
      });
    }
  }

  // Calls body(lane) for each set bit of `lanes`.
  template <class Body>
  static void for_lanes(std::uint32_t lanes, const Body& body) {
    for (; lanes != 0; lanes &= lanes - 1) body(static_cast<std::size_t>(std::countr_zero(lanes)));
  }

  // Scales a tile by a power of two of its own. All its elements that are not flagged must have been examined. Returns
  // the elements that are so much smaller than the others that float32 cannot hold them with this exponent.
  template <class Source>
  std::uint32_t rescale(const Source& source, IndexRange elements, std::uint32_t flagged, ControlTile& tile,
                        std::array<std::optional<Examined>, kTile>& alone) {
    const std::uint32_t others = lanes_of(elements.count) & ~flagged;
    double largest = 0;
    for_lanes(others, [&](std::size_t lane) {
      if (!alone[lane]) alone[lane] = examined(source, elements.first + lane, limits_.in_double);
      largest = std::max(largest, largest_component(alone[lane]->normals));
    });
    const int exponent = std::ilogb(largest) - kLargestExponent;
    std::uint32_t too_small = 0;
    for_lanes(others, [&](std::size_t lane) {
      const ControlNormals& normals = alone[lane]->normals;
      if (!(smaller_end(normals) >= kSmallestShare * largest)) {
        too_small |= 1u << lane;
      } else {
        put(tile, lane, scaled(std::ldexp(1.0, -exponent), normals));
      }
    });
    if (part_.exponents.empty()) part_.exponents.resize((part_.elements.count + kTile - 1) / kTile);
    part_.exponents[(elements.first - part_.elements.first) / kTile] = static_cast<std::int16_t>(exponent);
    return too_small;
  }

  void append_run(std::size_t first_block, std::size_t block_count, BlockKind kind) {
    if (!part_.runs.empty() && part_.runs.back().kind == kind) {
      part_.runs.back().block_count += block_count;
    } else {
      part_.runs.push_back({first_block, block_count, part_.bytes, kind});
    }
    part_.bytes += block_count * kTile * bytes_of(kind);
  }

  CurvePart& part_;
  const BuildLimits& limits_;
  AlignedArray<ControlTile> tiles_;
  std::size_t made_ = 0;  // number of elements that were built
  FloatTrials float_;
  std::array<BoundedTile, kWrittenTiles> bounded_;  // the tiles that are being added, with error bounds
  TileCertificates certificates_;                   // the results of certify_tile() for the tile that is being examined
  std::uint32_t has_bounds_ = 0;                    // bits of the tiles that have bounds
  // True if elements of one of the last tiles were examined, sixteen at a time.
  bool is_examined_ = false;
  std::size_t chunk_bytes_ = 0;  // number of bytes of the last chunk's blocks
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_PART_BUILDER_H_
