#include "normals/curves/curve_builder.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

#include "chronormal/core/polynomial.h"
#include "core/blocks.h"
#include "motion/coherence.h"
#include "normals/curves/certificate.h"
#include "normals/curves/curve_sources.h"
#include "normals/curves/kernels/curve_blocks.h"
#include "normals/curves/kernels/pack.h"
#include "normals/groups/kernels/group_tiles.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kChunkTiles = 32;
constexpr std::size_t kChunk = kChunkTiles * kTile;
constexpr std::size_t kWrittenTiles = 4;  // by one call of a source

// Elements that a thread makes at a time: enough that windows of faces and moves at the end cost little, and several
// for each thread. Of the size alone, and so the same for any number of threads.
std::size_t part_size(std::size_t size) {
  constexpr std::size_t kParts = 16;
  const std::size_t chunks = (size / kParts + kChunk - 1) / kChunk;
  return std::clamp<std::size_t>(chunks, 16, 128) * kChunk;
}

constexpr std::size_t kShortestRun = 4;  // blocks

// Blocks are scaled so that no component is above 2^50 and no end that counts below 2^-52: then |n(t)|^2, at worst that
// of 2^-53 / 64, stays in the range of float32.
constexpr int kLargestExponent = 50;
constexpr double kLargestComponent = 0x1p50;
constexpr double kSmallestEnd = 0x1p-52;
constexpr double kSmallestShare = kSmallestEnd / kLargestComponent;
// Below this, that scale itself would leave the range of double.
constexpr double kSmallestMesh = 0x1p-900;

double smaller_end(const ControlNormals& c) { return std::min(max_abs(c.n0), max_abs(c.n1)); }

// The fewest bits that keep the tolerance for this element at every t; nothing where double is needed.
std::optional<Precision> precision_for(const ControlNormals& normals, const PrecisionLimits& limits) {
  const double largest = largest_component(normals);
  if (!(largest >= kSmallestMesh)) return std::nullopt;
  const double scale = 1 / largest;
  const Bernstein<Vec3d, 2> n = {scale * normals.n0, scale * normals.m, scale * normals.n1};
  const Bernstein<double, 2> one = {1, 1, 1}, lengths = {length(n[0]), length(n[1]), length(n[2])};
  if (limits.largest_ratio16 > 0 && stays_above(n, limits.largest_ratio16, one))
    return stays_above(n, limits.largest_ratio11, one) ? Precision::k11 : Precision::k16;
  if (limits.sum_ratio_scaled16 > 0) {
    constexpr double kSmallestScale = 0x1p-30;  // exponents end there
    const Bernstein<double, 2> scales = {lengths[0] + kSmallestScale, lengths[1] + kSmallestScale,
                                         lengths[2] + kSmallestScale};
    if (stays_above(n, limits.sum_ratio_scaled16, scales)) return Precision::kScaled16;
  }
  if (stays_above(n, limits.sum_ratio32, lengths)) return Precision::k32;
  return std::nullopt;
}

ControlNormals scaled(double scale, const ControlNormals& c) { return {scale * c.n0, scale * c.m, scale * c.n1}; }

// What a flagged element leaves in its block, whatever the kind.
constexpr ControlNormals kPlaceHolder{{1, 0, 0}, {1, 0, 0}, {1, 0, 0}};

// What a block must be able to hold.
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

// Joins runs that are too short to pay into a neighbour that can hold them.
std::vector<NeedRun> runs_of(std::span<const Need> needs) {
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

// Positions of both ends that a cache near the core holds in any order; looking at the order would take longer.
constexpr std::size_t kNearBytes = std::size_t{1} << 20;
// Up to here the control normals of all faces may be held for a while: half a gigabyte.
constexpr std::size_t kMostRows = std::size_t{4} << 20;

// A copy of a segment in which both positions of a vertex share a cache line: 32 bytes a vertex. Half the misses where
// every vertex is one.
class EndsSideBySide {
 public:
  // Into memory that is there, where that is enough.
  EndsSideBySide(const Segment& segment, Threads threads, AlignedArray<float> memory)
      : ends_(std::move(memory)), segment_(segment) {
    const std::size_t count = segment.from.count;
    if (ends_.size() < kRow * count) {
      ends_ = {};
      ends_ = AlignedArray<float>(kRow * count);
    }
    blocks_on(threads, count, part_size(count), [&](IndexRange vertices) {
      for (std::size_t v = vertices.first; v < vertices.end(); ++v) {
        const Vec3f from = segment.from[v], to = segment.to[v];
        const float row[kRow] = {from.x, from.y, from.z, 0, to.x, to.y, to.z, 0};
        std::copy_n(row, kRow, ends_.data() + kRow * v);
      }
    });
    const float* const p = ends_.data();
    segment_.from = {p, p + 1, p + 2, count, kRow};
    segment_.to = {p + 4, p + 5, p + 6, count, kRow};
  }

  [[nodiscard]] const Segment& segment() const { return segment_; }
  [[nodiscard]] AlignedArray<float> take_memory() { return std::move(ends_); }

 private:
  static constexpr std::size_t kRow = kScatteredBytes / sizeof(float);
  AlignedArray<float> ends_;
  Segment segment_;
};

// What one thread makes at a time.
struct Part {
  IndexRange elements;
  std::byte* begin = nullptr;  // of its blocks
  std::size_t bytes = 0;
  std::vector<CurveData::Run> runs;  // offsets from begin
  std::vector<std::size_t> flagged;
  std::vector<FlaggedNormals> flagged_normals;
  std::vector<CurveData::ExactElement> exact;
  std::vector<std::int32_t> exact_digits;
  std::vector<std::int16_t> exponents;  // empty, or one for each of its blocks
  std::array<std::size_t, 3> degree_counts{};
};

// The result of examining one element that the quick test in float32 did not settle.
struct Examined {
  ControlNormals normals;              // in double, as right as its direction needs
  std::optional<Precision> precision;  // nothing: it is flagged
  double certain = 0;                  // where it is flagged: the share above which double has a direction
  bool needs_exact = false;            // flagged, and n(t) is not above that share at every t
};

template <class Source>
Examined examined(const Source& source, std::size_t element, const PrecisionLimits& limits) {
  const BoundedNormals rounded = source.in_double(element);
  Examined result;
  result.normals = rounded.normals;
  double share = rounded.largest_share();
  // Control normals that a caller gave are exact by definition: there are no positions to compute better ones from.
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

class PartBuilder {
 public:
  PartBuilder(Part& part, const PrecisionLimits& limits, bool with_lengths)
      : part_(part), limits_(limits), with_lengths_(with_lengths), tiles_(kChunkTiles) {}

  template <class Source>
  void run(Source& source) {
    for (std::size_t first = 0; first < part_.elements.count; first += kChunk)
      add_chunk(source, {part_.elements.first + first, std::min(kChunk, part_.elements.count - first)});
  }

 private:
  template <class Source>
  void add_chunk(Source& source, IndexRange elements) {
    const std::size_t tile_count = (elements.count + kTile - 1) / kTile;
    const std::span<ControlTile> tiles(tiles_.data(), tile_count);
    for (std::size_t k = 0; k < tile_count; k += kWrittenTiles) {
      const std::size_t count = std::min(kWrittenTiles, tile_count - k), first = k * kTile;
      fetch_destination(k, count);
      source.write({elements.first + first, std::min(count * kTile, elements.count - first)}, tiles.subspan(k, count));
    }
    TileSummary summaries[kChunkTiles];
    summarize_tiles(tiles, limits_, std::span(summaries, tile_count));

    Need needs[kChunkTiles];
    for (std::size_t k = 0; k < tile_count; ++k) {
      const IndexRange range{elements.first + k * kTile, std::min(kTile, elements.count - k * kTile)};
      needs[k].precision = summaries[k].precision;
      const std::uint32_t all = range.count == kTile ? 0xFFFF : (1u << range.count) - 1;
      std::uint32_t counted = all;
      if (summaries[k].uncertain != 0) counted &= ~examine(source, range, summaries[k], tiles[k], needs[k]);
      const std::uint32_t moving = summaries[k].moving & all, bending = summaries[k].bending & all;
      if (bending == all) {
        part_.degree_counts[2] += range.count;
      } else {
        part_.degree_counts[0] += static_cast<std::size_t>(std::popcount(all & ~moving));
        part_.degree_counts[1] += static_cast<std::size_t>(std::popcount(moving & ~bending));
        part_.degree_counts[2] += static_cast<std::size_t>(std::popcount(bending));
      }
      needs[k].degree = (bending & counted) != 0 ? 2 : (moving & counted) != 0 ? 1 : 0;
    }

    const std::size_t bytes_before = part_.bytes;
    std::size_t k = 0;
    for (const NeedRun& run : runs_of(std::span(needs, tile_count))) {
      const BlockKind kind = kind_for(run.need.precision, run.need.degree, with_lengths_);
      pack_tiles(tiles.subspan(k, run.blocks), kind, part_.begin + part_.bytes);
      append_run(elements.first / kTile + k, run.blocks, kind);
      k += run.blocks;
    }
    chunk_bytes_ = part_.bytes - bytes_before;
  }

  // Asks for the memory that the blocks of some tiles will go to, as many bytes as those of the last chunk had: it
  // comes while tiles are computed, a little at a time, for the core would wait where more is asked for than can be
  // under way.
  void fetch_destination(std::size_t tile, std::size_t count) const {
#if defined(__GNUC__)
    constexpr std::size_t kCacheLine = 64;
    const std::size_t each = chunk_bytes_ / kChunkTiles;
    const std::byte* const destination = part_.begin + part_.bytes + tile * each;
    for (std::size_t i = 0; i < count * each; i += kCacheLine) __builtin_prefetch(destination + i, 1);
#endif
  }

  // Looks in double at the elements of a tile that a glance cannot judge. Returns those that are flagged, as bits.
  template <class Source>
  std::uint32_t examine(Source& source, IndexRange elements, TileSummary& summary, ControlTile& tile, Need& need) {
    std::uint32_t flagged = 0, needs_exact = 0;
    bool out_of_range = false;
    Examined found[kTile];
    for (std::size_t lane = 0; lane < kTile; ++lane) {
      if ((summary.uncertain >> lane & 1) == 0) continue;
      if (lane >= elements.count) {  // a repetition of the last element
        for (auto& plane : tile.normals) plane[lane] = plane[elements.count - 1];
        continue;
      }
      found[lane] = examined(source, elements.first + lane, limits_);
      const auto& [normals, precision, certain, lane_needs_exact] = found[lane];
      set_degree(summary, lane, degree(normals));
      if (precision) {
        need.precision = std::max(need.precision, *precision);
        put(tile, lane, normals);
        out_of_range |= largest_component(normals) > kLargestComponent || smaller_end(normals) < kSmallestEnd;
      } else {
        flagged |= 1u << lane;
        needs_exact |= static_cast<std::uint32_t>(lane_needs_exact) << lane;
      }
    }
    if (out_of_range) {
      for (std::size_t lane = 0; lane < elements.count; ++lane) {
        if ((summary.uncertain >> lane & 1) == 0) found[lane] = examined(source, elements.first + lane, limits_);
      }
      flagged |= rescale(found, elements, flagged, tile);
    }
    for (std::size_t lane = 0; lane < elements.count; ++lane) {
      if ((flagged >> lane & 1) == 0) continue;
      put(tile, lane, kPlaceHolder);
      part_.flagged.push_back(elements.first + lane);
      part_.flagged_normals.push_back({found[lane].normals, found[lane].certain});
      if constexpr (!std::is_same_v<Source, GivenNormals>) {
        if ((needs_exact >> lane & 1) == 0) continue;
        part_.exact.push_back({elements.first + lane, part_.exact_digits.size()});
        source.exact(elements.first + lane).append_to(part_.exact_digits);
      }
    }
    for (std::size_t lane = elements.count; lane < kTile; ++lane)
      for (auto& plane : tile.normals) plane[lane] = plane[elements.count - 1];
    return flagged;
  }

  static void set_degree(TileSummary& summary, std::size_t lane, int element_degree) {
    const std::uint32_t bit = 1u << lane;
    summary.moving = element_degree > 0 ? summary.moving | bit : summary.moving & ~bit;
    summary.bending = element_degree > 1 ? summary.bending | bit : summary.bending & ~bit;
  }

  // Gives a tile an exponent of its own. Returns the elements that are too small for it beside the others.
  std::uint32_t rescale(const Examined* found, IndexRange elements, std::uint32_t flagged, ControlTile& tile) {
    double largest = 0;
    for (std::size_t lane = 0; lane < elements.count; ++lane) {
      if ((flagged >> lane & 1) == 0) largest = std::max(largest, largest_component(found[lane].normals));
    }
    const int exponent = std::ilogb(largest) - kLargestExponent;
    std::uint32_t too_small = 0;
    for (std::size_t lane = 0; lane < elements.count; ++lane) {
      if ((flagged >> lane & 1) != 0) continue;
      if (!(smaller_end(found[lane].normals) >= kSmallestShare * largest)) {
        too_small |= 1u << lane;
      } else {
        put(tile, lane, scaled(std::ldexp(1.0, -exponent), found[lane].normals));
      }
    }
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

  Part& part_;
  const PrecisionLimits& limits_;
  bool with_lengths_;
  AlignedArray<ControlTile> tiles_;
  std::size_t chunk_bytes_ = 0;  // of the last chunk
};

template <class MakeSource>
CurveData build(std::size_t size, const CurveOptions& options, Threads threads, CurveData* reuse,
                MakeSource make_source) {
  CurveData curves;
  if (reuse != nullptr) curves.blocks = std::exchange(*reuse, {}).blocks;
  curves.blocks.resize(0);
  curves.size = size;
  curves.keeps_lengths = !(options.tolerance > kExactTolerance);
  if (size == 0) return curves;
  const PrecisionLimits limits = PrecisionLimits::for_tolerance(options.tolerance);

  // Room for the worst; what is not written costs nothing.
  constexpr std::size_t kWorst = bytes_of(BlockKind::kQuadratic32);
  const std::size_t part = part_size(size);
  std::vector<Part> parts((size + part - 1) / part);
  const std::size_t whole = (size + kTile - 1) / kTile * kTile;
  if (curves.blocks.capacity() < whole * kWorst) {
    curves.blocks = {};
    curves.blocks = AlignedBytes(whole * kWorst);
  }
  const auto make = [&](std::size_t p, std::byte* begin, auto& source) {
    parts[p].elements = {p * part, std::min(part, size - p * part)};
    parts[p].begin = begin;
    PartBuilder(parts[p], limits, curves.keeps_lengths).run(source);
  };
  if (threads == Threads::kAll && parts.size() > 1) {
    // A source for each thread, which takes the next part until there is none.
    std::atomic<std::size_t> next = 0;
    parallel_for(std::min(thread_count(), parts.size()), [&](std::size_t) {
      auto source = make_source();
      for (std::size_t p = next++; p < parts.size(); p = next++)
        make(p, curves.blocks.data() + p * part * kWorst, source);
    });
  } else {
    auto source = make_source();
    std::byte* begin = curves.blocks.data();
    for (std::size_t p = 0; p < parts.size(); ++p) {
      make(p, begin, source);
      begin += parts[p].bytes;
    }
  }

  // Move the parts together, and put what they found one after the other.
  std::size_t bytes = 0;
  for (const Part& made : parts) {
    std::memmove(curves.blocks.data() + bytes, made.begin, made.bytes);
    for (const CurveData::Run& run : made.runs) {
      if (!curves.runs.empty() && curves.runs.back().kind == run.kind) {
        curves.runs.back().block_count += run.block_count;
      } else {
        curves.runs.push_back({run.first_block, run.block_count, bytes + run.offset, run.kind});
      }
    }
    bytes += made.bytes;
    curves.flagged.insert(curves.flagged.end(), made.flagged.begin(), made.flagged.end());
    curves.flagged_normals.insert(curves.flagged_normals.end(), made.flagged_normals.begin(),
                                  made.flagged_normals.end());
    for (const auto& [element, digits] : made.exact)
      curves.exact.push_back({element, curves.exact_digits.size() + digits});
    curves.exact_digits.insert(curves.exact_digits.end(), made.exact_digits.begin(), made.exact_digits.end());
    for (std::size_t d = 0; d < 3; ++d) curves.degree_counts[d] += made.degree_counts[d];
    if (!made.exponents.empty() && curves.keeps_lengths) {
      curves.exponents.resize(whole / kTile);
      std::copy(made.exponents.begin(), made.exponents.end(),
                curves.exponents.begin() + static_cast<std::ptrdiff_t>(made.elements.first / kTile));
    }
  }
  curves.blocks.resize(bytes);
  if (reuse == nullptr && threads == Threads::kAll) curves.blocks.release_rest();
  return curves;
}

// Builds from a copy of the segment in which both positions of a vertex lie side by side.
template <class Build>
CurveData from_both_ends(const Segment& segment, Threads threads, CurveData* reuse, Build build_from) {
  EndsSideBySide ends(segment, threads, reuse != nullptr ? std::exchange(reuse->scratch, {}) : AlignedArray<float>());
  CurveData curves = build_from(ends.segment());
  if (reuse != nullptr) curves.scratch = ends.take_memory();
  return curves;
}

}  // namespace

CurveData build_curves(std::span<const ControlNormals> normals, const CurveOptions& options) {
  return build(normals.size(), options, Threads::kOne, nullptr, [&] { return GivenNormals(normals); });
}

CurveData build_curves(const Segment& segment, const CurveOptions& options, Threads threads, CurveData* reuse) {
  const auto build_from = [&](const Segment& from) {
    return build(from.topology->face_count(), options, threads, reuse, [&] { return FaceNormals(from); });
  };
  const bool near = segment.from.count * 6 * sizeof(float) <= kNearBytes;
  if (!near && segment.topology->all_triangles() && lines_per_face(*segment.topology) > kScatteredLines)
    return from_both_ends(segment, threads, reuse, build_from);
  return build_from(segment);
}

CurveData build_curves(const Segment& segment, const NormalGroups& groups, const CurveOptions& options, Threads threads,
                       CurveData* reuse) {
  const auto build_from = [&](const Segment& from, const AllFaceRows* rows) {
    return build(groups.size(), options, threads, reuse, [&, rows] { return GroupNormals(from, groups, rows); });
  };
  if (lines_per_face(*segment.topology) > kScatteredLines) {
    return from_both_ends(segment, threads, reuse, [&](const Segment& ends) {
      std::optional<AllFaceRows> rows;
      if (segment.topology->face_count() <= kMostRows) rows.emplace(ends, threads);
      return build_from(ends, rows ? &*rows : nullptr);
    });
  }
  return build_from(segment, nullptr);
}

}  // namespace chronormal::inline internal
