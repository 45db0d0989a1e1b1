/// Writes true normals into ordinary glTF files.
///
///     smallest   the default: the candidate with the fewest bytes whose worst error along the animations is within a
///                tolerance in every named viewer, and nowhere worse than before. Candidates are all that follow, the
///                file's own normals, deltas of its targets alone, correction targets driven by products of weights,
///                and correction targets of low rank that only the animations of the file drive (docs/theory.md,
///                section 17)
///     harmless   unit normals at weight 1 for each target, and correction targets of unit normals for the remaining
///                errors beyond a tolerance, at other weights and for combined targets: small errors in every named
///                viewer, and in none of them worse than before (docs/theory.md, section 16)
///     exact      correction targets that carry the quadratic terms of eq. 32, driven by quadratics of the weights:
///                exact at every instant in every viewer that adds up targets
///     endpoint   the best single delta per target (analysis/fits/end_delta.h): exact at the ends, with a stated error
///                in between; if the file activates several targets at once, deltas fitted to its weights by least
///                squares (docs/theory.md, eq. 44); in viewers that add up targets no worse than before
///
///     keys       for sequences: only unit normals at keys, with as few keys as a certified error of linear
///                interpolation at every instant allows (docs/uses.md)
///
/// The base NORMAL does not change, and neither does any other byte of the file that GltfBake::pointers does not name.
#ifndef CHRONORMAL_WORKFLOW_BAKE_H_
#define CHRONORMAL_WORKFLOW_BAKE_H_

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/io/input.h"
#include "chronormal/motion/motion.h"
#include "chronormal/motion/paths.h"
#include "chronormal/normals/weighting.h"
#include "chronormal/workflow/viewers.h"

namespace chronormal {

inline namespace internal {
class Expansion;  // limits the memory and output that a file may cause
}

inline constexpr double kHarmlessTolerance = 0.5, kExactBakeTolerance = 0.001;  ///< degrees
inline constexpr double kLeastKeyTolerance = 0.001;  ///< degrees; float32 in viewers needs a part of the tolerance

struct BakeOptions {
  std::optional<BakeEncoding> encoding = {};  ///< default: smallest; exact for sequences
  /// The viewers to bake for. By default these are the viewers that add up deltas (three.js, Babylon.js, PlayCanvas,
  /// Bevy). In this case `spared` becomes the viewers that keep unit normals (Godot, Filament).
  std::vector<Viewer> viewers = {};
  /// Viewers in which normals should not become worse: among candidates that are otherwise equal, one that satisfies
  /// this is preferred.
  std::vector<Viewer> spared = {};
  /// The size of the document, which decides whether a result is too large if neither a tolerance nor a limit is given;
  /// 0 means that no size is too large.
  std::size_t bytes_of_file = 0;
  /// The weighting of the true normals. Weightings other than area are fitted, with a stated error. By default, each
  /// mesh has the weighting that its stored base normals clearly follow (as in an audit), or else area. With
  /// recompute_base, the default is always area.
  std::optional<Weighting> weighting = {};
  bool smooth = false;        ///< gives normals to primitives without NORMAL, which otherwise stay flat
  double crease_angle = 180;  ///< degrees; hard edges of smoothed primitives and of sequences
  /// The normals of keyframe 0 of a sequence, one for each corner, or empty. They determine the hard edges instead of
  /// the crease angle, and the weighting of the true normals if none is given. Their offset from the true normals is
  /// kept. (The encoding keys only uses the hard edges.)
  VectorView<const float> normal_of_corner = {};
  /// Vertices that coincide in all keyframes share a normal, except at hard edges and for the two sides of a sheet.
  bool weld = true;
  bool recompute_base = false;  ///< replaces the base normals by those of the geometry; hard edges stay
  bool dense_zeros = false;     ///< stores zeros as bytes, for readers that need bytes for every accessor
  std::optional<std::size_t> most_bytes = {};  ///< fails if more bytes would be added
  /// For sequences: the limit of memory and output, which the program sets. nullptr means no limit. A document has a
  /// limit of its own.
  const Expansion* expansion = nullptr;
  /// The tolerance in degrees. For smallest: the limit of the worst error. For harmless and exact: correction targets
  /// are left out as long as this changes no normal by more than the tolerance, and tracks are cut to the tolerance.
  /// For keys: the largest error of a normal at any instant, at least kLeastKeyTolerance. Default: kHarmlessTolerance,
  /// or kExactBakeTolerance for exact.
  std::optional<double> tolerance = {};
  /// The largest number of targets of a mesh, including its own (for smallest). Default: as many as the viewers
  /// support.
  std::optional<std::size_t> most_targets = {};
  /// Promises that only the animations of the file will be played, so that smallest may fit the deltas of the mesh's
  /// own targets to them. Such deltas have no meaning alone.
  bool animations_only = false;
  /// The largest total size of a mesh's arrays of deltas and tangents, plus the growth of its tracks (for smallest);
  /// the closest candidate within this limit is chosen.
  std::optional<std::size_t> most_delta_bytes = {};
  /// Promises that a program sets poses of the meshes that no animation drives, and also sets the weights of their
  /// correction targets by the file's formulas. Without this promise, smallest gives these meshes no correction
  /// targets.
  bool is_posed = false;
  /// The poses for which meshes are baked if is_posed is set, with weights by name or in the order of targets. A mesh
  /// is left out if the poses name none of its targets and none has its number of weights. Default: random poses
  /// (docs/cli.md).
  std::vector<RigPose> poses = {};
  bool plan = false;  ///< for smallest: evaluate all candidates, even after the smallest one is found
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Returns the options with the default viewers if they name none.
[[nodiscard]] BakeOptions with_viewers(BakeOptions options);

/// The errors of rendered normals in degrees.
struct ShownErrors {
  std::size_t judged = 0;  ///< number of samples, each a vertex in a pose
  double mean = 0;
  double most = 0;  ///< 99.9 % of the errors are below this, within a tenth
  double worst = 0;
  /// The number of samples (an edge in a pose) at which errors jump by more than 10, 20 and 40 degrees.
  std::array<std::size_t, 3> tears{};
  std::size_t poses = 0;

  /// Returns the number of edges that are torn by more than 10 degrees, on average over the poses.
  [[nodiscard]] double torn_edges() const noexcept {
    return poses > 0 ? static_cast<double>(tears[0]) / static_cast<double>(poses) : 0;
  }
};

/// The errors of a mesh in a viewer before and after a bake, through the skins of the nodes with the mesh.
struct ViewerChange {
  struct Errors {
    ShownErrors before, after;
  };
  std::string viewer;
  bool is_named = true;    ///< true if the bake is made for this viewer
  bool is_better = false;  ///< true if the errors decrease as a whole, and in no respect increase beyond the allowance
  /// The errors in three kinds of poses: first, in the animations of the file as the viewer plays them, and with its
  /// constant weights; second, with each target alone from 0 to 1; third, in poses that a program sets.
  std::array<Errors, 3> poses;
};

/// A candidate for a mesh that smallest has evaluated.
struct BakedCandidate {
  /// The kind of candidate: "as it is", "own deltas", "products", "quadratics" or "low rank".
  std::string_view name;
  std::size_t targets = 0, bytes = 0;  ///< bytes of new deltas and tangents, plus the growth of tracks
  /// The errors in the worst of the named viewers: along the animations of the file, also between keys, and in its
  /// constant weights; or, without animations of weights, with each target alone and in the poses of the options, to
  /// which nothing was fitted. Samples count if n(w) is longer than a thousandth of n(0). Normals are transformed by
  /// the skins of the nodes with the mesh.
  ShownErrors played;
  /// The errors of each named viewer. Empty if "as it is" was the only candidate, and for the numbers of "quadratics"
  /// that were tried for all vertices at once.
  std::vector<ViewerChange> viewers;
  bool within = false;  ///< the worst error is within the tolerance, and the size within the limits
  bool chosen = false;
  bool animations_only = false;  ///< its deltas are fitted to the animations, and have no meaning alone
  bool skinned = false;          ///< a skin does more than rotate and scale uniformly, so `played` depends on it
  /// Degrees, for the chosen candidate: the worst error that compressors among the named viewers cause by rounding. No
  /// candidate can avoid it, and the choice ignores it; 0 if no compressor is named.
  double rounded = 0;
};

/// Returns true if a candidate misses the given tolerance only because of the rounding of compressors.
[[nodiscard]] inline bool is_beyond_by_rounding(const BakedCandidate& choice, const BakeOptions& options) {
  return options.tolerance && choice.within && choice.rounded > *options.tolerance;
}

/// The result for one mesh.
struct BakedMesh {
  std::size_t mesh = 0;
  std::string name;
  BakeEncoding encoding = BakeEncoding::kExact;
  Weighting weighting =
      Weighting::kArea;                 ///< weighting of the true normals; meaningless for a mesh that was baked before
  std::size_t elements = 0;             ///< different normals
  std::vector<GltfExtraTarget> extras;  ///< correction targets, added now or by an earlier bake
  /// Bytes of new arrays, not counting those shared with an earlier mesh, plus the growth of tracks.
  std::size_t bytes = 0;
  /// For exact: the number of moving targets that no animation drives. They are baked like endpoint.
  std::size_t undriven = 0;
  std::size_t left_flat = 0;  ///< primitives without NORMAL that stay flat
  /// The number of vertices whose stored base normal is zero or nearly zero, so that deltas cannot be added to it.
  std::size_t without_stored = 0;
  /// The number of vertices whose stored base normal was too long or too short for float32, and is now a unit vector.
  std::size_t rescaled = 0;
  /// The number of targets whose tangents were not perpendicular to the true normals. Their tangents are recomputed,
  /// for viewers that add up tangents.
  std::size_t new_tangents = 0;
  std::size_t left_tangents = 0;  ///< targets for whose tangents most_delta_bytes has no room; they do not change
  std::size_t stilled = 0;        ///< targets that moved normals but no positions; their deltas are zero now
  std::size_t without_base = 0;   ///< vertices whose faces have no area in the base (docs/cli.md)
  /// The largest error in degrees, for endpoint targets and fits. Each target is compared alone, over w in [0, 1] and
  /// beyond if the file has such weights. Targets that are active together are compared at the weights of the file, at
  /// keys and at up to fifteen instants between two keys.
  double largest_error = 0;
  /// For endpoint: the number of elements whose deltas were computed by least squares, since several targets are active
  /// at once.
  std::size_t fitted_elements = 0;
  double resampling_error = 0;  ///< degrees, from cutting cubic splines and leaving out pairs, along the animations
  /// True if KHR_animation_pointer drives a single weight, so that only the encoding exact adds correction targets.
  bool has_lone_weight = false;
  /// True if nothing was changed, because the mesh was baked before. `candidates` has the evaluation of the present
  /// normals by smallest.
  bool already_baked = false;
  std::vector<ViewerChange> viewers;       ///< except for exact: the errors of each named viewer, if the mesh changed
  std::vector<BakedCandidate> candidates;  ///< for smallest: the candidates that were evaluated
  std::size_t left_out = 0;                ///< number of correction targets for which the viewers have no room
  /// Nodes with the mesh whose extras are not an object, so the drivers of correction targets cannot be recorded there.
  std::vector<std::size_t> unmarked_nodes;
};

struct GltfBake {
  std::vector<BakedMesh> meshes;      ///< the meshes with targets that move
  std::vector<std::string> pointers;  ///< JSON pointers of the result that were replaced or added
  std::vector<std::string> warnings;  ///< sentences for people
  std::size_t added_targets = 0, added_bytes = 0;
  std::size_t bytes_of_file = 0;     ///< size of the document before the bake
  std::size_t left_out_bytes = 0;    ///< bytes of arrays of the source that are not used any more
  std::size_t converted_tracks = 0;  ///< number of weight tracks that became cubic splines
  bool changed = false;
  std::string drivers;  ///< the drivers of the correction targets of all meshes, as separate JSON (docs/formats.md)
};

/// Bakes a document into a new edit of the document, which the caller then writes. Meshes that were baked before do not
/// change.
///
/// Weights    those of all animations, of nodes and of meshes: if two targets are active at once, their pair gets a
///            correction target. The encoding exact is exact at these weights, and at other weights except for pairs
///            without a correction target.
/// Fits       with weightings other than area, n(w) is not a polynomial: exact then uses the quadratic form that is
///            exact if one target has the weight 0, 1/2 or 1, or if two have the weight 1.
///
/// Errors: those of GltfDocument; kUsage for the encoding keys; kInvalidInput if nothing moves, if more than most_bytes
/// would be added (with the necessary number of bytes), if extras of a mesh are not an object or extras.chronormal is
/// not a valid mark, if base normals to replace are compressed by Draco, or for exact if an extension drives a single
/// weight.
[[nodiscard]] Result<GltfBake> bake(const GltfDocument& document, const BakeOptions& options, GltfEdit& edit);

struct SequenceBake {
  std::size_t keyframes = 0, vertices = 0, targets = 0, extra_targets = 0;
  std::size_t bytes = 0;                   ///< size of the file
  double largest_error = 0;                ///< degrees, for endpoint, harmless and fitted weightings
  std::size_t without_normals = 0;         ///< elements that never have an area in the motion
  Weighting weighting = Weighting::kArea;  ///< weighting of the true normals: that of the stored normals, or area
  bool has_offsets = false;  ///< stored normals of keyframe 0 differ from the true normals by rotations, which are kept
  std::vector<std::string> warnings;
  /// The numbers that --encode keys reports.
  struct Keys {
    std::size_t count = 0;       ///< number of keys, including the first and last keyframe
    std::size_t in_between = 0;  ///< keys between two keyframes
    std::size_t left_out = 0;    ///< keyframes without a key: their positions are on the lines between keys
    /// Number of keys that would be needed if all keyframes were keys, with equally many keys between any two.
    std::size_t even = 0;
    std::size_t beyond = 0;  ///< (normal, segment) pairs that miss the tolerance with any keys, since they collapse
  };
  std::optional<Keys> keys = {};
  std::optional<CutPath> cut = {};  ///< for curves; set by the caller that has cut them, for reports
};

/// Makes an animated GLB from a sequence: keyframe 0 is the base, and every later keyframe is a target with hat-shaped
/// weights. The encoding exact adds a target per segment with the weight t (1 - t) (docs/theory.md, section 15). The
/// encoding harmless has unit normals in all targets, additional targets with the weight 4 t (1 - t) if viewers have
/// room, and a LINEAR track (section 16). The encoding keys is like harmless, but without additional targets; it
/// chooses its keys itself, and requires area weights. Vertices at hard edges (crease angle) are doubled. `glb` gets
/// the bytes of the file; it does not change after an error. The file holds float32 positions, and its normals are
/// exact for these positions; residuals of a computed motion are left out. Polygons become fans of triangles with the
/// normals of the polygons; if a fan does not cover its polygon in keyframe 0, there is a warning. Errors:
/// kInvalidInput for more than most_bytes or 4 GiB; kUsage in keys for other weights than area or a tolerance below
/// kLeastKeyTolerance. Precondition: the motion is valid and a sequence (segments k -> k + 1)
[[nodiscard]] Result<SequenceBake> bake_sequence(const Motion& motion, const BakeOptions& options, std::string& glb);

/// Bakes a stream, into a file that is written as chronormal/io/output.h describes. The stream is read in several
/// passes that hold two keyframes at a time, or for the encoding keys all keyframes between two keys. The arrays wait
/// in an unnamed file in the folder of `path` until the JSON in front of them is known, so only this JSON and fits of a
/// weighting need memory that grows with the number of keyframes. If `path` is a stream or a device, the arrays wait in
/// memory. Errors: also those of the stream and of write_output()
[[nodiscard]] Result<SequenceBake> bake_sequence(MotionStream& stream, const BakeOptions& options,
                                                 const std::string& path, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_BAKE_H_
