/// Writes the weight tracks of a file as edits. Tracks that drive a mesh with correction targets get the weights of
/// these targets too. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_WRITE_WRITE_TRACKS_H_
#define CHRONORMAL_WORKFLOW_BAKE_WRITE_WRITE_TRACKS_H_

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "workflow/bake/poses/extra_curves.h"

namespace chronormal::inline internal {

/// A mesh to which the bake has added correction targets.
struct GrownMesh {
  std::size_t mesh = 0;
  ExtraDrivers drivers;
  bool keeps_kind = false;  ///< if true, LINEAR tracks stay LINEAR, and cubic splines get no new keys
};

/// Finds a channel in which KHR_animation_pointer drives weights that no track of glTF can hold: a single weight of the
/// mesh, or weights of a mesh without a node. Returns the JSON pointer of the driven weights, or nothing if there is no
/// such channel.
[[nodiscard]] std::optional<std::string> find_lone_weight(const GltfDocument& document, std::size_t mesh,
                                                          const GltfEdit& edit);

/// Finds a channel that drives all weights of the mesh, but that is no track, and whose numbers cannot be extended to
/// more targets. Returns the JSON pointer of the channel, or nothing if there is no such channel.
[[nodiscard]] std::optional<std::string> find_unread_track(const GltfDocument& document, std::size_t mesh);

struct WrittenTracks {
  /// For each mesh, a bound of the angle, in radians, by which errors of correction targets' weights turn normals.
  std::vector<double> errors;
  std::vector<std::size_t> bytes;  ///< for each mesh, the number of bytes added to its tracks
  std::size_t converted = 0;       ///< the number of tracks that became cubic splines
};

/// Extends all tracks that drive these meshes, in all animations, also those that break a rule of the format and are
/// not read: correction targets get the weight 0 in them. Cubic splines get more keys until the errors of
/// correction targets' weights turn no normal by more than tolerance (radians). Errors: those of reading tracks from
/// the document; kInvalidInput if an extension drives weights of any of these meshes.
[[nodiscard]] Result<WrittenTracks> write_tracks(const GltfDocument& document, std::span<const GrownMesh> meshes,
                                                 double tolerance, GltfEdit& edit);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_WRITE_WRITE_TRACKS_H_
