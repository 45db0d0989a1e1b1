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

/// Writes the tiles of a range of faces. Tile k has the faces from faces.first + 16 k on (see ControlTile). Values and
/// degrees are those of face_control_normals(), with the values rounded to float32. Preconditions: tiles has
/// ceil(faces.count / 16) elements; faces.count > 0.
void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles) noexcept;

/// Writes the tiles of a range of faces. For each tile, also writes its values before they are rounded to float32,
/// which have the bits of face_control_normals(), and the longest edges of its faces. Precondition: `exact` has as many
/// elements as `tiles`.
void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles,
                        std::span<EdgedTile> exact) noexcept;

/// Writes the tiles of a range of triangles. For each tile, also writes its values before they are rounded to float32,
/// and bounds of their errors. Precondition: `exact` has as many elements as `tiles`.
void face_control_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles,
                        std::span<BoundedTile> exact) noexcept;

/// Writes the tiles of triangles, computed entirely in float32. `magnitude` bounds the error of any component. `degree`
/// is 2 if the curve bends by more than that error, so that its degree is certainly 2; otherwise it is at most 1. The
/// preconditions are those of face_control_tiles().
void float_triangle_tiles(const Segment& segment, IndexRange faces, std::span<ControlTile> tiles) noexcept;

/// Writes the control normals of a range of faces of a mesh of triangles, as face_control_normals() does.
void triangle_control_normals(const Segment& segment, IndexRange faces, std::span<ControlNormals> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_KERNELS_FACE_TILES_H_
