/// The sources from which curves get control normals. Each source writes tiles for the quick test of pack.h, and
/// provides the values that a closer examination of some elements needs.
///
///     write(elements, tiles)   writes tiles of sixteen elements, computed in double and rounded to float32
///     write(elements, tiles, bounded)   also writes the values before rounding, and bounds of their errors
///     write_in_float(elements, tiles)   writes tiles computed entirely in float32, with bounds on the errors, if
///                              has_float() is true; not every source has write_in_float() and has_float()
///     in_double(i)             returns one element, and bounds of its errors
///     exact(i)                 returns one element without any rounding, if there are positions to compute it from
#ifndef CHRONORMAL_NORMALS_CURVES_CURVE_SOURCES_H_
#define CHRONORMAL_NORMALS_CURVES_CURVE_SOURCES_H_

#include <algorithm>
#include <cstddef>
#include <span>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"
#include "motion/segment_end.h"
#include "normals/control/exact_curve.h"
#include "normals/control/kernels/control_tile.h"
#include "normals/control/kernels/face_tiles.h"
#include "normals/control/polygon_normals.h"
#include "normals/curves/certificate.h"
#include "normals/groups/group_sum.h"
#include "normals/groups/kernels/group_tiles.h"

namespace chronormal::inline internal {

/// Writes the control normals of elements of a source into tiles, one element after the other.
template <class Source>
void put_each(const Source& source, IndexRange elements, std::span<BoundedTile> bounded) {
  for (std::size_t i = 0; i < bounded.size() * kTile; ++i)
    put(bounded[i / kTile], i % kTile, source.in_double(elements.first + std::min(i, elements.count - 1)));
}

/// A source of control normals that the caller has computed.
class GivenNormals {
 public:
  explicit GivenNormals(std::span<const ControlNormals> normals) : normals_(normals) {}

  void write(IndexRange elements, std::span<ControlTile> tiles) const {
    for (std::size_t i = 0; i < tiles.size() * kTile; ++i) {
      const ControlNormals& c = normals_[elements.first + std::min(i, elements.count - 1)];
      ControlTile& tile = tiles[i / kTile];
      put(tile, i % kTile, c);
      // No products were rounded for given values, so the values count as exact.
      tile.magnitude[i % kTile] = static_cast<float>(largest_component(c));
      tile.degree[i % kTile] = degree(c);
    }
  }
  void write(IndexRange elements, std::span<ControlTile> tiles, std::span<BoundedTile> bounded) const {
    write(elements, tiles);
    put_each(*this, elements, bounded);
  }
  // Given control normals count as exact, since the positions from which they were computed are not known.
  [[nodiscard]] BoundedNormals in_double(std::size_t i) const { return {normals_[i], {}}; }

 private:
  std::span<const ControlNormals> normals_;
};

/// A source that computes the control normals of the faces of a segment.
class FaceNormals {
 public:
  explicit FaceNormals(const Segment& segment) : segment_(segment) {}

  void write(IndexRange faces, std::span<ControlTile> tiles) const { face_control_tiles(segment_, faces, tiles); }
  void write(IndexRange faces, std::span<ControlTile> tiles, std::span<BoundedTile> bounded) const {
    if (fits_lanes(segment_)) {
      face_control_tiles(segment_, faces, tiles, bounded);
    } else {
      face_control_tiles(segment_, faces, tiles);
      put_each(*this, faces, bounded);
    }
  }
  [[nodiscard]] bool has_float() const { return fits_lanes(segment_); }
  void write_in_float(IndexRange faces, std::span<ControlTile> tiles) const {
    float_triangle_tiles(segment_, faces, tiles);
  }
  [[nodiscard]] BoundedNormals in_double(std::size_t i) const {
    const PolygonNormals polygon = polygon_control_normals(segment_, segment_.topology->face(i));
    return {polygon.normals, polygon.errors};
  }
  [[nodiscard]] ExactCurve exact(std::size_t i) const {
    return ExactCurve::of_polygon(segment_, segment_.topology->face(i));
  }

 private:
  const Segment& segment_;
};

/// A source that computes the control normals of the elements of groups.
class GroupNormals {
 public:
  GroupNormals(const Segment& segment, const NormalGroups& groups, bool fetch)
      : segment_(segment), groups_(groups), tiles_(segment, groups, fetch) {}

  void write(IndexRange elements, std::span<ControlTile> tiles) const { tiles_.write(elements, tiles); }
  void write(IndexRange elements, std::span<ControlTile> tiles, std::span<BoundedTile> bounded) const {
    if (has_residuals(segment_)) {
      tiles_.write(elements, tiles);
      put_each(*this, elements, bounded);
    } else {
      tiles_.write(elements, tiles, bounded);
    }
  }
  [[nodiscard]] bool has_float() const { return !has_residuals(segment_); }
  void write_in_float(IndexRange elements, std::span<ControlTile> tiles) const {
    tiles_.write_in_float(elements, tiles);
  }
  [[nodiscard]] BoundedNormals in_double(std::size_t i) const {
    return control_normals_of_group(tiles_.faces(), groups_, i);
  }
  [[nodiscard]] ExactCurve exact(std::size_t i) const { return tiles_.faces().exact_sum(groups_.faces(i)); }

 private:
  const Segment& segment_;
  const NormalGroups& groups_;
  GroupTiles tiles_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CURVES_CURVE_SOURCES_H_
