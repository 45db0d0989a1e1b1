/// Reads the motions of a glTF file: its morph targets, or one of its animations, as keyframes and segments. Private to
/// io; other code asks an Input for them (chronormal/io/input.h).
///
///     targets      keyframe 0 is the base, keyframe k has target k - 1 of every mesh at weight 1; segments 0 -> k
///     animation    one keyframe for each time at which any of its weight tracks has a key; two if weights step there
///
/// LINEAR tracks are exact: weights, and so positions, are linear between keys. STEP tracks hold still between keys and
/// jump at them, where no segment is; a jump at the last key leads out of the motion. CUBICSPLINE tracks are cut into
/// straight pieces so short that no vertex is farther from its true place than a stated distance.
///
/// Each mesh is a separate body, and so is each node that carries it. Vertices are the file's, not welded, part after
/// part: in the order of meshes and primitives for targets, of nodes and primitives for an animation or in the world.
/// They are where the mesh has them, or in the world where its nodes put them as they stand in the file (animations of
/// nodes and skins are not applied; by the specification, a node with a skin does not move its mesh). If a node
/// mirrors, faces are turned round, so that their normals keep the outward side.
#ifndef CHRONORMAL_IO_GLTF_GLTF_MOTION_H_
#define CHRONORMAL_IO_GLTF_GLTF_MOTION_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "io/bytes/expansion.h"

namespace chronormal::inline internal {

struct GltfMotionOptions {
  std::string animation;  ///< name or index; empty for the targets
  bool world = false;     ///< whether vertices are where nodes put them, once for each node
  /// The largest distance between a cut cubic spline and the true one, relative to the diagonal of the bounding box.
  double curve_tolerance = 1e-5;
  /// The most memory that keyframes may take, in bytes: a small file can ask for much.
  std::size_t most_bytes = addressable(std::uint64_t{4} << 30);
};

struct GltfMotion {
  Motion motion;
  std::vector<GltfPart> parts;
  /// A bound of the distance between cut cubic splines and the true ones, in units of the file; 0 if there are none.
  double curve_error = 0;
  /// The times of the keys of an animation, ascending. The cuts of cubic splines are not among them.
  std::vector<double> key_times = {};
};

/// Returns whether a target moves the positions of a primitive with faces.
[[nodiscard]] bool has_moving_targets(const GltfDocument& document) noexcept;

/// Reads the motion that the options name. Only parts that can move take part: primitives with faces and targets, and
/// in an animation only the ones that it drives. The result is valid (validate() in motion/motion.h).
///
/// Errors: from GltfDocument; kInvalidInput if nothing can move, or the keyframes would take more than most_bytes;
/// kUsage for an animation that does not exist.
[[nodiscard]] Result<GltfMotion> read_gltf_motion(const GltfDocument& document, const GltfMotionOptions& options);

/// Reads all primitives with faces at the default weights of their meshes, as one keyframe without a segment. (So the
/// result is not valid by itself.) The animation of the options is not used. Errors: from GltfDocument;
/// kInvalidInput if there are no primitives, or they take more than most_bytes.
[[nodiscard]] Result<GltfMotion> read_gltf_mesh(const GltfDocument& document, const GltfMotionOptions& options = {});

/// Reads the normals that a file stores for the base, one for each corner of a motion that was read from it: (corners,
/// 3), in the space of the mesh; (0, 0, 0) where a primitive has none. Empty if no primitive has any. Errors: errors of
/// GltfDocument.
[[nodiscard]] Result<std::vector<float>> read_gltf_corner_normals(const GltfDocument& document, const Motion& motion,
                                                                  std::span<const GltfPart> parts);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_GLTF_GLTF_MOTION_H_
