/// The control normals of vertices and corners, sixteen at a time. NormalCurves::of_groups starts from them.
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

/// A writer of tiles of elements, from the points on the paths around them (groups/rings.h). The first object for some
/// groups makes these paths, which the groups keep.
class GroupTiles {
 public:
  /// Prepares for the elements of groups. Throws std::bad_alloc only. groups must outlive the object, belong to the
  /// topology of the segment, and have their corners (or paths made before the corners were forgotten). `fetch`
  /// prefetches points, which pays if neighbours are scattered in memory.
  GroupTiles(const Segment& segment, const NormalGroups& groups, bool fetch);

  /// Writes the tiles of a range of elements (see ControlTile). The values are those of group_control_normals() except
  /// for the rounding of sums in another order: they are within 2^-47 of the magnitude of the sum, rounded to float32,
  /// and zero if they are no larger than that bound. Elements with many faces are added up as in
  /// group_control_normals(). elements must begin at a multiple of 16, and end at a multiple of 16 or at the last
  /// element; elements.count > 0; tiles must have ceil(elements.count / 16) elements
  void write(IndexRange elements, std::span<ControlTile> tiles) const noexcept;

  /// Writes tiles and, for a closer examination of each tile, its sums in double before any correction, with bounds on
  /// their errors. Elements with many faces are left out of the sums. bounded must have as many elements as tiles
  void write(IndexRange elements, std::span<ControlTile> tiles, std::span<BoundedTile> bounded) const noexcept;

  /// Writes the tiles of a range of elements entirely in float32, in about half the time. `magnitude` bounds the error
  /// of any component, and is infinite for elements with many faces. `degree` is 2 if the curve bends by more than that
  /// error, so that its degree is 2 without a doubt, and at most 1 elsewhere. The preconditions are the ones of write()
  void write_in_float(IndexRange elements, std::span<ControlTile> tiles) const noexcept;

  /// Returns the faces that elements share, for a closer examination of these faces.
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
