/// Computes control normals of faces, sixteen at a time, for NormalCurves::of_faces and every scheme.
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

/// Writes the tiles of a range of faces: tile k holds the faces faces.first + 16 k ... (see ControlTile). Values and
/// degrees are those of face_control_normals(), with the values rounded to float32. tiles must have ceil(faces.count /
/// 16) elements; faces.count > 0
void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles) noexcept;

/// Writes tiles, and for each tile its values before rounding, which have the bits of face_control_normals(), and its
/// longest edges. exact must have as many elements as tiles
void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles,
                        std::span<EdgedTile> exact) noexcept;

/// Writes the tiles of triangles, and also bounds on the errors of the values before rounding. `exact` must have as
/// many elements as `tiles`
void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles,
                        std::span<BoundedTile> exact) noexcept;

/// Writes the tiles of triangles entirely in float32. `magnitude` bounds the error of any component. `degree` is 2 if
/// the curve bends by more than that error, so that its degree is certainly 2, and otherwise at most 1. The
/// preconditions are those of face_control_tiles()
void float_triangle_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles) noexcept;

/// Writes the results of face_control_normals() for a mesh of triangles.
void triangle_control_normals(const Segment& segment, IndexRange faces, std::span<ControlNormals> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_KERNELS_FACE_TILES_H_
