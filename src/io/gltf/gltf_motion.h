/// Reads the motions of a glTF file, which are its morph targets or one of its animations, as keyframes and segments.
/// Private to io; other code gets motions from an Input (chronormal/io/input.h).
///
///     targets      keyframe 0 is the base, keyframe k has target k - 1 of every mesh at weight 1; segments from 0 to k
///     animation    one keyframe for each time at which any of its weight tracks has a key; two if weights step there
///
/// LINEAR tracks are exact: weights, and so positions, are linear between keys. STEP tracks rest between keys and jump
/// at keys, where there is no segment; a jump at the last key is not part of the motion. CUBICSPLINE tracks are cut
/// into straight pieces. The pieces are so short that the distance of each vertex from its true position is below
/// curve_error.
///
/// Each mesh is a separate body. A mesh that is read for several nodes is a separate body for each node. Vertices are
/// those of the file, not welded, part by part. The parts have the order of meshes and primitives for targets, and the
/// order of nodes and primitives for an animation or in the world.
///
/// Positions are in the space of the mesh, or in the world, where the nodes of the file move them. Animations of nodes
/// are not applied; by the specification, a node with a skin does not move its mesh. If a node mirrors, faces are
/// reversed, so that their normals still point outwards.
///
/// On request, skins move vertices, always in the world, and an animation may move a mesh by its joints alone. Joints
/// move vertices on curves, which are cut into straight pieces, so that normals are within kPathTolerance of the
/// normals on the curves (gltf_skinned_part.h). Vertices that a skin moves are rounded to float32.
#ifndef CHRONORMAL_IO_GLTF_GLTF_MOTION_H_
#define CHRONORMAL_IO_GLTF_GLTF_MOTION_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "chronormal/motion/paths.h"
#include "io/bytes/expansion.h"

namespace chronormal::inline internal {

struct GltfMotionOptions {
  std::string animation;  ///< name or index of the animation; empty for the targets
  bool world = false;     ///< true for positions in the world, where each node that carries a mesh adds a copy of it
  bool skins = false;     ///< true if skins move vertices
  /// The largest number of straight pieces into which the curves of vertices that skins move are cut between two keys.
  std::size_t most_pieces = chronormal::kMostPieces;
  /// The largest allowed distance between the straight pieces of a cubic spline and the spline itself, relative to the
  /// diagonal of the bounding box.
  double curve_tolerance = 1e-5;
  /// The largest memory for keyframes in bytes. The limit is needed because a small file can ask for much memory.
  std::size_t most_bytes = addressable(std::uint64_t{4} << 30);
};

struct GltfMotion {
  Motion motion;
  std::vector<GltfPart> parts;
  /// A bound of the distance between the straight pieces of cubic splines and the splines themselves, in units of the
  /// file. The bound is 0 without cubic splines.
  double curve_error = 0;
  /// The times of the keys of an animation, ascending, without the times at which cubic splines were cut.
  std::vector<double> key_times = {};
  std::vector<Error> unread_skins = {};  ///< why skins were ignored that cannot be read
  std::optional<CutPath> cut = {};  ///< how the paths of vertices behind skins were cut; nothing if there is no skin
};

/// Returns true if some target of the document moves a primitive with faces.
[[nodiscard]] bool has_moving_targets(const GltfDocument& document) noexcept;

/// Reads the motion that the options name. Only parts that can move are included, which are primitives with faces and
/// targets. An animation includes only the parts that it drives. The result is valid (validate() in motion/motion.h).
///
/// Errors: those of GltfDocument; kInvalidInput if nothing can move, or the keyframes would take more than most_bytes;
/// kUsage for an animation that does not exist.
[[nodiscard]] Result<GltfMotion> read_gltf_motion(const GltfDocument& document, const GltfMotionOptions& options);

/// Reads all primitives with faces at the default weights of their meshes, as one keyframe. There is no segment, so the
/// result is not a valid motion. The option `animation` has no effect. Errors: those of GltfDocument; kInvalidInput if
/// there are no primitives, or they take more than most_bytes.
[[nodiscard]] Result<GltfMotion> read_gltf_mesh(const GltfDocument& document, const GltfMotionOptions& options = {});

/// Reads the stored normals of the base. The result has one normal for each corner of `motion`, (corners, 3), in the
/// space of the mesh, and (0, 0, 0) for primitives without normals. `motion` must have been read from this document.
/// Returns an empty list if no primitive has normals. Errors: those of GltfDocument.
[[nodiscard]] Result<std::vector<float>> read_gltf_corner_normals(const GltfDocument& document, const Motion& motion,
                                                                  std::span<const GltfPart> parts);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_IO_GLTF_GLTF_MOTION_H_
