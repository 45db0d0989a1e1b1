/// Control normals of faces, sixteen at a time: the front end of NormalCurves::of_faces, and of every scheme.
#ifndef CHRONORMAL_NORMALS_CONTROL_KERNELS_FACE_TILES_H_
#define CHRONORMAL_NORMALS_CONTROL_KERNELS_FACE_TILES_H_

#include <cstddef>
#include <span>

#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "normals/control/kernels/control_tile.h"
#include "normals/control/kernels/exact_tile.h"

namespace chronormal::inline internal {

/// Writes the tiles of a range of faces: tile k holds the faces faces.first + 16 k ... (see ControlTile). The values
/// are those of face_control_normals(), rounded to float32, and so is the degree.
/// tiles must have ceil(faces.count / 16) elements; faces.count > 0
void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles) noexcept;

/// The same, and beside each tile what it is rounded from: the bits of face_control_normals(), and the longest edges.
/// exact must have as many elements as tiles
void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles,
                        std::span<EdgedTile> exact) noexcept;

/// The same of triangles, and beside each tile what it is rounded from, with bounds on the errors, for a closer look.
/// exact must have as many elements as tiles
void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles,
                        std::span<BoundedTile> exact) noexcept;

/// Writes the tiles of triangles in float32 throughout, with a bound on their errors: `magnitude` is one of the error
/// of any component; `degree` is 2 where the curve bends by more than that error, so that its degree is 2 without a
/// doubt, and 1 elsewhere. The same preconditions
void float_triangle_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles) noexcept;

/// face_control_normals() of a mesh of triangles.
void triangle_control_normals(const Segment& segment, IndexRange faces, std::span<ControlNormals> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_KERNELS_FACE_TILES_H_
