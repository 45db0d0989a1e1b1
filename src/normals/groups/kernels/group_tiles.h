/// Control normals of vertices and corners, sixteen at a time: the front end of NormalCurves::of_groups.
#ifndef CHRONORMAL_NORMALS_GROUPS_KERNELS_GROUP_TILES_H_
#define CHRONORMAL_NORMALS_GROUPS_KERNELS_GROUP_TILES_H_

#include <cstddef>
#include <span>

#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "core/memory.h"
#include "normals/control/kernels/control_tile.h"
#include "normals/groups/face_window.h"

namespace chronormal::inline internal {

/// A window of control normals, a row for each face: nine components and the magnitude, at the beginning of two cache
/// lines. It begins and ends at multiples of 16, and grows where faces that have left it are missed.
struct RowWindow : FaceWindow {
  static constexpr std::size_t kRow = 16;
  static constexpr std::size_t kSmallest = 1024, kLargest = 32768;  // faces; powers of two

  RowWindow() : FaceWindow{kSmallest} {}

  [[nodiscard]] double* row(std::size_t face) const noexcept { return rows + place(face) * kRow; }

  double* rows = nullptr;           ///< of `largest` faces, or of all
  std::size_t largest = kLargest;   ///< what capacity may grow to
  std::size_t late = 0, early = 0;  ///< faces that were missed, before `begin` and after `end`
  std::size_t strange = 0;          ///< corners since an element last used the window
};

/// The control normals of all faces in such rows: for meshes in no order, whose neighbours are anywhere. 128 bytes a
/// face, shared by all threads.
class AllFaceRows {
 public:
  /// Makes room for so many faces. Throws std::bad_alloc.
  explicit AllFaceRows(std::size_t face_count);

  /// Writes the rows of a range of faces, which must begin at a multiple of 16.
  void write(const Segment& segment, IndexRange faces) noexcept;

  [[nodiscard]] double* data() const noexcept { return rows_.data(); }

 private:
  mutable AlignedArray<double> rows_;  // a window could write, but one over all faces never does
};

/// Walks over ascending ranges of elements; one object for each thread. Keeps the control normals of the faces that
/// were used last, so that those around neighbouring elements are computed once on a well-ordered mesh, and no array
/// of all of them is needed. On a mesh in any other order, without all_rows, they are computed for every corner.
class GroupTiles {
 public:
  /// Throws std::bad_alloc only. groups must outlive the object and belong to the topology of the segment
  /// all_rows must be of this segment, and outlive the object as well; without them a window of its own is used.
  GroupTiles(const Segment& segment, const NormalGroups& groups, const AllFaceRows* all_rows = nullptr);

  /// Writes the tiles of a range of elements (see ControlTile); ranges that ascend are fast. The values are those of
  /// group_control_normals(), rounded to float32, and so is the degree.
  /// tiles must have ceil(elements.count / 16) elements; elements.count > 0
  void write(IndexRange elements, std::span<ControlTile> tiles) noexcept;

 private:
  Segment segment_;
  const NormalGroups* groups_;
  AlignedArray<double> rows_;  // of the window; what is not used costs no memory
  RowWindow window_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_GROUPS_KERNELS_GROUP_TILES_H_
