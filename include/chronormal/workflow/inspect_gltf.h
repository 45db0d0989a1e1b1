/// What a glTF file holds beside its motion: the normals that it stores, which of them follow the targets, tracks.
///
/// Units      positions as in the file; seconds.
#ifndef CHRONORMAL_WORKFLOW_INSPECT_GLTF_H_
#define CHRONORMAL_WORKFLOW_INSPECT_GLTF_H_

#include <cstddef>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/io/gltf_motion.h"

namespace chronormal {

/// One primitive that has faces; what is not here is in GltfPrimitive.
struct GltfPrimitiveInspection {
  std::size_t mesh = 0, primitive = 0;
  std::size_t triangles = 0;
  std::size_t off_length = 0;  ///< stored normals that are not of length 1, to the rounding of 8-bit integers
  /// Vertices at the place of a lower one in the base, and those of them with another normal than the lowest one there
  /// (by more than kSplitNormalTolerance of normals/normal_groups.h).
  std::size_t doubled = 0, split = 0;
  /// Targets that move positions, and those of them that move normals and tangents too.
  std::size_t moving = 0, moving_normals = 0, moving_tangents = 0;
};

/// One track of weights.
struct GltfTrackInspection {
  std::size_t animation = 0, track = 0;
  double first_time = 0, last_time = 0;
  double lowest = 0, highest = 0;  ///< of the weights, between the keys too
};

struct GltfInspection {
  std::vector<GltfPrimitiveInspection> primitives;
  std::vector<GltfTrackInspection> tracks;
  std::vector<std::size_t> instances;  ///< per mesh: how many nodes have it
  std::size_t skinned_nodes = 0;       ///< that have a mesh
  std::size_t without_faces = 0;       ///< primitives of points or lines, or without positions
};

/// Reads all geometry and all weight tracks, one after the other. Memory: that of the largest primitive, and what the
/// document keeps. Errors: of GltfDocument.
[[nodiscard]] Result<GltfInspection> inspect(const GltfDocument& document);

/// Counts the vertices of a motion that are at the place of a lower one in all keyframes and have another normal stored
/// than the lowest one there that has any: some of Inspection::doubled, across primitives too. (Vertices at one place
/// are of one mesh and one node, so that their normals need no transform.) Memory and errors as of inspect(). The
/// motion must be one of this document.
[[nodiscard]] Result<std::size_t> count_split_normals(const GltfDocument& document, const GltfMotion& motion);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_INSPECT_GLTF_H_
