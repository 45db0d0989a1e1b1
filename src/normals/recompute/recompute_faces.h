/// Recomputes the normals of a range of faces, for schemes, which get blocks of faces. Private to the library.
#ifndef CHRONORMAL_NORMALS_RECOMPUTE_RECOMPUTE_FACES_H_
#define CHRONORMAL_NORMALS_RECOMPUTE_RECOMPUTE_FACES_H_

#include <cstddef>

#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Writes the unit normals at t of a range of faces, with the same bits as NormalRecompute. Pure: no allocation, no
/// throw, and no scratch memory, so it is slower than NormalRecompute on meshes in random order and on positions that
/// are not packed. Preconditions: result has faces.count elements; the faces exist in the topology.
std::size_t unit_normals_at(const Segment& segment, IndexRange faces, double t, VectorView<float> result) noexcept;

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_RECOMPUTE_RECOMPUTE_FACES_H_
