/// Computes the control normals of vertices and corners, sixteen at a time, for NormalCurves::of_groups().
#ifndef CHRONORMAL_NORMALS_GROUPS_KERNELS_GROUP_TILES_H_
#define CHRONORMAL_NORMALS_GROUPS_KERNELS_GROUP_TILES_H_

#include <cstddef>
#include <cstdint>
#include <span>

#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "normals/control/kernels/control_tile.h"
#include "normals/control/kernels/exact_tile.h"
#include "normals/control/shared_faces.h"
#include "normals/groups/rings.h"

namespace chronormal::inline internal {

/// Writes tiles of elements, which are computed from the points on the paths around the elements (groups/rings.h). The
/// first object for some groups makes these paths, which the groups keep.
class GroupTiles {
 public:
  /// Prepares to write elements of groups. The groups must outlive the object, belong to the topology of the segment,
  /// and have their corners (or paths that were made before the corners were forgotten). If `fetch` is true, points are
  /// prefetched, which pays if neighbours are scattered in memory. Throws only std::bad_alloc.
  GroupTiles(const Segment& segment, const NormalGroups& groups, bool fetch);

  /// Writes the tiles of a range of elements (see ControlTile). The values are those of group_control_normals(), but
  /// the terms of a sum are added in another order. The values are within 2^-47 of the magnitude of the sum, rounded to
  /// float32, and zero if they are no larger than that bound. Elements with many faces are computed by
  /// group_control_normals(). Preconditions: elements begins at a multiple of 16, and ends at a multiple of 16 or at
  /// the last element; elements.count > 0; tiles has ceil(elements.count / 16) elements.
  void write(IndexRange elements, std::span<ControlTile> tiles) const noexcept;

  /// Writes tiles and, for a closer examination, the sums of each tile in double before any correction, with bounds of
  /// their errors. Elements with many faces are left out of these sums. Precondition: bounded has as many elements as
  /// tiles.
  void write(IndexRange elements, std::span<ControlTile> tiles, std::span<BoundedTile> bounded) const noexcept;

  /// Writes the tiles of a range of elements entirely in float32, in about half the time. `magnitude` bounds the error
  /// of any component, and is infinite for elements with many faces. `degree` is 2 if the curve bends by more than that
  /// error, so that its degree is certainly 2; otherwise it is at most 1. The preconditions are those of write().
  void write_in_float(IndexRange elements, std::span<ControlTile> tiles) const noexcept;

  /// Returns the faces that elements share, with which callers examine elements more closely.
  [[nodiscard]] const SharedFaces& faces() const noexcept { return faces_; }

 private:
  [[nodiscard]] std::span<const std::uint32_t> left_out(IndexRange elements) const noexcept;
  void set_alone(std::size_t element, IndexRange elements, std::span<ControlTile> tiles) const noexcept;

  Segment segment_;
  SharedFaces faces_;
  const NormalGroups* groups_;
  const Rings* rings_;
  bool fetch_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_KERNELS_GROUP_TILES_H_
