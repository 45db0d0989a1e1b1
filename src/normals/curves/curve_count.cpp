// Counts the bytes of curves. A PartBuilder finds out which blocks it would make, without making them, and their sizes
// are added up.
#include "normals/curves/curve_count.h"

#include <algorithm>
#include <cassert>

#include "chronormal/normals/normal_curves.h"
#include "core/blocks.h"
#include "normals/curves/curve_sources.h"
#include "normals/curves/part_builder.h"

namespace chronormal::inline internal {
namespace {

static_assert(kCountedTogether == kChunk);

// A source that writes the tiles of the faces of a segment, and keeps the control normals in double from which it makes
// the tiles.
class KeptFaces : public FaceNormals {
 public:
  KeptFaces(const Segment& segment, IndexRange faces, std::span<EdgedTile> kept)
      : FaceNormals(segment), segment_(segment), first_(faces.first), kept_(kept) {}

  void write(IndexRange faces, std::span<ControlTile> tiles) const {
    face_control_tiles(segment_, faces, tiles, kept_.subspan((faces.first - first_) / kTile, tiles.size()));
  }
  void write(IndexRange faces, std::span<ControlTile> tiles, std::span<BoundedTile> bounded) const {
    FaceNormals::write(faces, tiles, bounded);
    write(faces, tiles);
  }

 private:
  const Segment& segment_;
  std::size_t first_;
  std::span<EdgedTile> kept_;
};

template <class Runs>
void add_runs(const Runs& runs, CurveCount& count) {
  count.runs = runs.size();
  if (runs.empty()) return;
  count.first = runs.front().kind;
  count.last = runs.back().kind;
}

}  // namespace

CurveCount CurveCount::of(const CurveData& curves) noexcept {
  CurveCount count;
  count.block_bytes = curves.blocks.size();
  add_runs(curves.runs, count);
  count.flagged = curves.flagged.size();
  count.exact = curves.exact.size();
  count.digits = curves.exact_digits.size();
  count.has_exponents = !curves.exponents.empty();
  return count;
}

void CurveCount::add(const CurveCount& next) noexcept {
  if (next.runs == 0) return;
  if (runs == 0) first = next.first;
  runs += next.runs - (runs > 0 && last == next.first ? 1U : 0U);
  last = next.last;
  block_bytes += next.block_bytes;
  flagged += next.flagged;
  exact += next.exact;
  digits += next.digits;
  has_exponents = has_exponents || next.has_exponents;
}

std::size_t CurveCount::bytes(std::size_t size) const noexcept {
  const std::size_t filling = runs == 0 ? 0 : (kTile - size % kTile) % kTile;
  const std::size_t unused = filling == 0 ? 0 : filling * bytes_of(last);
  // An index counts as 8 bytes on every machine, so that 32-bit machines report the same numbers.
  constexpr std::size_t kIndex = 8, kRun = 4 * kIndex, kExact = 2 * kIndex;
  static_assert(sizeof(std::size_t) != kIndex ||
                (sizeof(CurveData::Run) == kRun && sizeof(CurveData::ExactElement) == kExact));
  return block_bytes - unused + runs * kRun + (has_exponents ? block_count(size, kTile) * sizeof(std::int16_t) : 0) +
         flagged * (kIndex + sizeof(FlaggedTile) / kTile + sizeof(std::int16_t)) + exact * kExact +
         digits * sizeof(std::int32_t);
}

CurveCount count_curves(const Segment& segment, IndexRange faces, std::span<EdgedTile> exact) {
  assert(exact.size() == block_count(faces.count, kTile));
  CurveCount count;
  if (faces.count == 0) return count;
  assert(faces.first % kCountedTogether == 0);
  CurvePart part;
  part.elements = faces;
  const BuildLimits limits(CurveOptions().tolerance);
  PartBuilder builder(part, limits);
  KeptFaces source(segment, faces, exact);
  while (builder.make_chunk(source)) {
  }
  count.block_bytes = part.bytes;
  add_runs(part.runs, count);
  count.flagged = part.flagged.size();
  count.exact = part.exact.size();
  count.digits = part.exact_digits.size();
  count.has_exponents = !part.exponents.empty();
  return count;
}

}  // namespace chronormal::inline internal
