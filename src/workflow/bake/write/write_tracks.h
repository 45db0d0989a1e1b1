/// The weight tracks of a file as edits: those that drive a mesh with extra targets get their weights too. Private to
/// workflow.
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

/// A mesh that got extra targets, one at least.
struct GrownMesh {
  std::size_t mesh = 0;
  ExtraDrivers drivers;
  bool keeps_kind = false;  ///< LINEAR tracks stay LINEAR, and cubic splines get no keys
};

/// The JSON pointer of a channel in which KHR_animation_pointer drives weights of a mesh that no track has, one of them
/// or those of a mesh without a node; nothing where there is none.
[[nodiscard]] std::optional<std::string> find_lone_weight(const GltfDocument& document, std::size_t mesh,
                                                          const GltfEdit& edit);

struct WrittenTracks {
  std::vector<double> errors;      ///< of each mesh: a bound of what inserted keys leave, in radians
  std::vector<std::size_t> bytes;  ///< of each mesh: those by which its tracks grow
  std::size_t converted = 0;       ///< tracks that are cubic splines now
};

/// Extends the tracks of all animations that drive these meshes; cubic splines get keys until no normal is off by more
/// than tolerance (radians). Errors: of GltfDocument; kInvalidInput where an extension drives weights of any mesh.
[[nodiscard]] Result<WrittenTracks> write_tracks(const GltfDocument& document, std::span<const GrownMesh> meshes,
                                                 double tolerance, GltfEdit& edit);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_WRITE_WRITE_TRACKS_H_
