/// Writes morph targets over a base as a new GLB file, whose mesh has these targets and their names. Private to io.
#ifndef CHRONORMAL_IO_GLTF_GLB_GLB_TARGETS_H_
#define CHRONORMAL_IO_GLTF_GLB_GLB_TARGETS_H_

#include <string>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

/// Makes a GLB of one mesh. The base has the area-weighted normals of the polygons; a vertex whose polygons have no
/// area gets (0, 0, 1). Vertices that coincide in the base and in all targets share normals unless `weld` is false.
/// Polygons become fans of triangles. Targets have the names of their keyframes, and only deltas of positions (stored
/// sparse if that is smaller); a bake adds deltas of normals. The motion must be valid, and have the kind kTargets.
/// Errors: kInvalidInput if the file would be too large.
[[nodiscard]] Result<std::string> write_glb_targets(const Motion& motion, bool weld = true);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_GLTF_GLB_GLB_TARGETS_H_
