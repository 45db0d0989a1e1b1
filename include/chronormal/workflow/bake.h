/// Writes true normals into ordinary glTF files.
///
///     smallest   the default: the candidate with the fewest bytes whose worst error along the animations is within a
///                tolerance in every named viewer, and nowhere worse than before. The candidates are the file's own
///                normals, deltas of its targets alone, correction targets driven by products or by quadratics of
///                weights, and correction targets of low rank that only the animations of the file drive
///                (docs/theory.md, section 17)
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
class Expansion;  // limits the memory and the output that reading a file may cause
}

inline constexpr double kHarmlessTolerance = 0.5, kExactBakeTolerance = 0.001;  ///< in degrees
/// The smallest tolerance of the encoding kKeys, in degrees. If a tolerance were smaller, the rounding to float32 in
/// viewers alone could exceed the tolerance.
inline constexpr double kLeastKeyTolerance = 0.001;

struct BakeOptions {
  std::optional<BakeEncoding> encoding = {};  ///< by default kSmallest, and kExact for sequences
  /// The viewers to bake for. If the list is empty, the bake is for the viewers that add up deltas (three.js,
  /// Babylon.js, PlayCanvas, Bevy), and the viewers that keep unit normals (Godot, Filament) are added to `spared`.
  std::vector<Viewer> viewers = {};
  /// Viewers in which normals should not become worse. Among candidates that are otherwise equal, one that makes no
  /// normal worse in these viewers is preferred.
  std::vector<Viewer> spared = {};
  /// The size of the document in bytes. If neither a tolerance nor a limit is given, this size decides whether a result
  /// is too large. 0 means that no size is too large.
  std::size_t bytes_of_file = 0;
  /// The weighting of the true normals. Normals with a weighting other than area are fitted, with a stated error. By
  /// default, each mesh has the weighting that its stored base normals clearly follow (as in an audit), or else area.
  /// The default is always area if recompute_base is set.
  std::optional<Weighting> weighting = {};
  bool smooth = false;        ///< true to give normals to primitives without NORMAL, which otherwise stay flat
  double crease_angle = 180;  ///< degrees; decides the hard edges of smoothed primitives and of sequences
  /// The normals of keyframe 0 of a sequence, one for each corner, or empty. They determine the hard edges instead of
  /// the crease angle, and also the weighting of the true normals if no weighting is given. The rotation from the true
  /// normals to these normals is kept. (The encoding kKeys uses them only for the hard edges.) If their median angle to
  /// the surface exceeds 45 degrees, they do not belong to it and are ignored, with a warning.
  VectorView<const float> normal_of_corner = {};
  /// Reads the normals that keyframe k of a sequence stores, one for each corner, or an empty list. If this function is
  /// given, the weighting follows from the normals of later keyframes, too: a flat keyframe 0 has the same normals by
  /// all weightings. Errors of the function leave a keyframe out.
  std::function<Result<std::vector<float>>(std::size_t keyframe)> normals_of_keyframe = {};
  /// True if vertices that coincide in all keyframes share a normal. Vertices at hard edges, and those on the two sides
  /// of a sheet, never do.
  bool weld = true;
  bool recompute_base = false;  ///< true to replace the base normals by those of the geometry; hard edges stay
  bool dense_zeros = false;     ///< true to store every zero, for readers that need bytes for every accessor
  std::optional<std::size_t> most_bytes = {};  ///< the bake fails if it would add more bytes than this
  /// For sequences, the limit on memory and output, which the program sets; nullptr stands for no limit. A document has
  /// a limit of its own.
  const Expansion* expansion = nullptr;
  /// The tolerance in degrees. For kSmallest the tolerance is the limit of the worst error. For kHarmless and kExact,
  /// correction targets are left out as long as leaving them out changes no normal by more than the tolerance, and
  /// tracks are cut into lines within the tolerance. For kKeys the tolerance is the largest error of a normal at any
  /// instant, and at least kLeastKeyTolerance. The default is kHarmlessTolerance, or kExactBakeTolerance for kExact.
  std::optional<double> tolerance = {};
  /// The largest number of targets of a mesh for kSmallest, including the targets that the mesh has already. The
  /// default is the number that the viewers support.
  std::optional<std::size_t> most_targets = {};
  /// A promise that only the animations of the file will be played. kSmallest may then fit the deltas of the mesh's own
  /// targets to these animations. Such deltas have no meaning alone.
  bool animations_only = false;
  /// For kSmallest, the largest number of bytes of a mesh's deltas and tangents together, plus the growth of its
  /// tracks. Within this limit, the candidate with the smallest error is chosen.
  std::optional<std::size_t> most_delta_bytes = {};
  /// A promise that a program sets poses of the meshes that no animation drives, and also sets the weights of their
  /// correction targets by the file's formulas. Without this promise, kSmallest gives these meshes no correction
  /// targets.
  bool is_posed = false;
  /// The poses for which meshes are baked if is_posed is true, with weights by name or in the order of targets. A mesh
  /// is left out if no pose names one of its targets or has as many weights as it has targets. The default is random
  /// poses (docs/cli.md).
  std::vector<RigPose> poses = {};
  bool plan = false;  ///< true to make kSmallest evaluate all candidates, even after the smallest is found
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Returns the options, with the default viewers if `options` names none.
[[nodiscard]] BakeOptions with_viewers(BakeOptions options);

/// The errors of rendered normals, in degrees, over the samples of a mesh.
struct ShownErrors {
  std::size_t judged = 0;  ///< number of samples, each a vertex in a pose
  double mean = 0;
  double most = 0;  ///< 99.9 % of the errors are below this angle, which is rounded by at most a tenth
  double worst = 0;
  /// The numbers of samples, each an edge in a pose, at which the errors at both ends of the edge differ by more than
  /// 10, 20 and 40 degrees.
  std::array<std::size_t, 3> tears{};
  std::size_t poses = 0;

  /// Returns the number of edges at which errors differ by more than 10 degrees, on average over the poses.
  [[nodiscard]] double torn_edges() const noexcept {
    return poses > 0 ? static_cast<double>(tears[0]) / static_cast<double>(poses) : 0;
  }
};

/// The errors of a mesh in one viewer before and after a bake. The skins of the nodes with the mesh transform the
/// normals before these are compared.
struct ViewerChange {
  struct Errors {
    ShownErrors before, after;
  };
  std::string viewer;
  bool is_named = true;  ///< true if the bake is made for this viewer, false for a viewer that is only spared
  /// True if the mean error decreases and no error grows by more than the tolerance allows. If an encoding other than
  /// kSmallest was requested, errors may also grow as long as no more edges are torn.
  bool is_better = false;
  /// The errors in three kinds of poses. The first kind has the poses in the animations of the file as the viewer plays
  /// them, and in the file's constant weights. The second kind has each target alone, at weights from 0 to 1. The third
  /// kind has poses that a program sets.
  std::array<Errors, 3> poses;
};

/// A way to store the normals of a mesh that kSmallest has tried, with its size and its errors.
struct BakedCandidate {
  /// The name of the kind of candidate: "as it is", "own deltas", "products", "quadratics" or "low rank".
  std::string_view name;
  std::size_t targets = 0, bytes = 0;  ///< `bytes` counts new deltas and tangents, and the growth of tracks
  /// The errors in the worst of the named viewers, along the animations of the file, also between keys, and in the
  /// file's constant weights. If no animation drives weights, the errors are those with each target alone, and in the
  /// poses of the options, to which nothing was fitted. Samples count if n(w) is longer than a thousandth of n(0).
  /// Normals are transformed by the skins of the nodes with the mesh.
  ShownErrors played;
  /// The errors in each viewer before the bake and with this candidate: the named viewers first, then the others.
  std::vector<ViewerChange> viewers;
  bool within = false;  ///< true if the worst error is within the tolerance, and the size within the limits
  bool chosen = false;
  bool animations_only = false;  ///< true if the deltas are fitted to the animations, and have no meaning alone
  /// True if a skin does more than rotate and scale uniformly, so that `played` depends on it.
  bool skinned = false;
  /// The worst error in degrees that compressors among the named viewers cause by rounding, for the chosen candidate.
  /// No candidate can avoid this error, so the choice ignores it. The error is 0 if no compressor is named.
  double rounded = 0;
};

/// Returns true if the chosen candidate misses the given tolerance only because compressors of glTF files round
/// normals.
[[nodiscard]] inline bool is_beyond_by_rounding(const BakedCandidate& choice, const BakeOptions& options) {
  return options.tolerance && choice.within && choice.rounded > *options.tolerance;
}

/// The result of a bake for one mesh.
struct BakedMesh {
  std::size_t mesh = 0;
  std::string name;
  BakeEncoding encoding = BakeEncoding::kExact;
  Weighting weighting =
      Weighting::kArea;                 ///< weighting of the true normals; meaningless for a mesh that was baked before
  std::size_t elements = 0;             ///< number of different normals
  std::vector<GltfExtraTarget> extras;  ///< correction targets, added now or by an earlier bake
  /// The number of bytes of new arrays, without those that are shared with an earlier mesh, plus the growth of tracks.
  std::size_t bytes = 0;
  /// For kExact, the number of moving targets that no animation drives, and that are therefore baked as with kEndpoint.
  std::size_t undriven = 0;
  std::size_t left_flat = 0;  ///< number of primitives without NORMAL, which stay flat
  /// The number of vertices whose stored base normal is zero or nearly zero, so that deltas cannot be added to it.
  std::size_t without_stored = 0;
  /// The number of vertices whose stored base normal was too long or too short for float32, and is now a unit vector.
  std::size_t rescaled = 0;
  /// The number of targets whose tangents were not perpendicular to the true normals. For viewers that add up tangents,
  /// these tangents are recomputed.
  std::size_t new_tangents = 0;
  /// The number of targets that keep their tangents, because new tangents would exceed most_delta_bytes.
  std::size_t left_tangents = 0;
  std::size_t stilled = 0;       ///< number of targets that moved normals but no positions; their deltas are now zero
  std::size_t without_base = 0;  ///< number of vertices whose faces have no area in the base (docs/cli.md)
  /// The largest error in degrees of kEndpoint targets and of fits. Each target is compared alone, over the weights
  /// from 0 to 1, and beyond if the file has such weights. Targets that are active together are compared at the weights
  /// of the file: at keys, and at up to fifteen instants between two keys.
  double largest_error = 0;
  /// For kEndpoint, the number of elements whose deltas were computed by least squares, since several targets are
  /// active at once.
  std::size_t fitted_elements = 0;
  /// The error in degrees, along the animations, that comes from cutting cubic splines into lines and from leaving out
  /// pairs of targets.
  double resampling_error = 0;
  /// True if an animation drives a single weight of the mesh by KHR_animation_pointer. The mesh then gets no correction
  /// targets; a bake with the encoding kExact fails if the mesh needs any.
  bool has_lone_weight = false;
  /// True if a channel drives the weights of the mesh by numbers that cannot be read. The mesh then gets no correction
  /// targets either.
  bool has_unread_track = false;
  /// True if nothing was changed, because the mesh was baked before. `candidates` then shows the errors of its present
  /// normals.
  bool already_baked = false;
  std::vector<ViewerChange> viewers;       ///< errors in each viewer, named ones first; empty for kExact
  std::vector<BakedCandidate> candidates;  ///< the candidates that kSmallest has evaluated
  /// The number of correction targets that were left out, because viewers do not support so many targets.
  std::size_t left_out = 0;
  /// The nodes with the mesh whose extras are not a JSON object, so that the drivers of correction targets cannot be
  /// stored there.
  std::vector<std::size_t> unmarked_nodes;
};

struct GltfBake {
  std::vector<BakedMesh> meshes;      ///< the results for all meshes with targets that move
  std::vector<std::string> pointers;  ///< JSON pointers of the result that were replaced or added
  std::vector<std::string> warnings;  ///< whole sentences for users
  std::size_t added_targets = 0, added_bytes = 0;
  std::size_t bytes_of_file = 0;     ///< size of the document before the bake
  std::size_t left_out_bytes = 0;    ///< bytes of arrays of the source that the result does not use any more
  std::size_t converted_tracks = 0;  ///< number of weight tracks that became cubic splines
  bool changed = false;
  std::string drivers;  ///< the drivers of the correction targets of all meshes, as separate JSON (docs/formats.md)
};

/// Bakes a document into a new edit of the document, which the caller then writes. Meshes that were baked before do not
/// change.
///
/// Weights    The weights of all animations, nodes and meshes of the file count: if two targets are active at once in
///            them, their pair gets a correction target. The encoding exact is exact at these weights, and at other
///            weights except for pairs without a correction target.
/// Fits       with weightings other than area, n(w) is not a polynomial: exact then uses the quadratic form that is
///            exact if one target has the weight 0, 1/2 or 1, or if two have the weight 1.
///
/// Errors: those of GltfDocument; kUsage for the encoding kKeys; kInvalidInput if nothing moves, if more than
/// most_bytes would be added (the message has the necessary number of bytes), if extras of a mesh are not an object or
/// extras.chronormal is not a valid mark, if base normals to replace are compressed by Draco, or for kExact if an
/// extension drives a single weight.
[[nodiscard]] Result<GltfBake> bake(const GltfDocument& document, const BakeOptions& options, GltfEdit& edit);

struct SequenceBake {
  std::size_t keyframes = 0, vertices = 0, targets = 0, extra_targets = 0;
  std::size_t bytes = 0;                   ///< size of the file in bytes
  double largest_error = 0;                ///< degrees; for kEndpoint, kHarmless and fitted weightings
  std::size_t without_normals = 0;         ///< number of elements that have no area at any time of the motion
  Weighting weighting = Weighting::kArea;  ///< weighting of the true normals: that of the stored normals, or area
  /// True if the stored normals of keyframe 0 differ from the true normals by rotations, which are kept.
  bool has_offsets = false;
  std::vector<std::string> warnings;
  /// The numbers of keys, for the encoding kKeys.
  struct Keys {
    std::size_t count = 0;       ///< number of keys, including those at the first and at the last keyframe
    std::size_t in_between = 0;  ///< number of keys between two keyframes
    std::size_t left_out = 0;    ///< number of keyframes without a key, whose positions are on the lines between keys
    /// The number of keys that would be needed if all keyframes were keys, and if there were equally many keys between
    /// any two keyframes.
    std::size_t even = 0;
    /// The number of samples, each a normal in a segment, that miss the tolerance with any keys, because the normal
    /// collapses.
    std::size_t beyond = 0;
  };
  std::optional<Keys> keys = {};
  std::optional<CutPath> cut = {};  ///< the cut of curved paths; the caller that has cut them sets it, for reports
};

/// Makes an animated GLB from a sequence: keyframe 0 is the base, and every later keyframe is a target with hat-shaped
/// weights. The encodings differ:
///     exact      adds a target per segment with the weight t (1 - t) (docs/theory.md, section 15)
///     harmless   has unit normals in all targets, more targets with the weight 4 t (1 - t) for as many segments as
///                viewers support, and a LINEAR track (section 16)
///     keys       is like harmless without the additional targets, chooses its keys itself, and requires weights by area
/// Vertices at hard edges (crease angle) are doubled. `glb` gets the bytes of the file, or does not change if there is an error. The file holds
/// float32 positions, and its normals are exact for these positions; residuals of a computed motion are left out.
/// Polygons become fans of triangles with the normals of the polygons; if a fan does not cover its polygon in keyframe
/// 0, there is a warning. Errors: kInvalidInput for more than most_bytes or 4 GiB; kUsage if the encoding keys is used
/// with another weighting than area or with a tolerance below kLeastKeyTolerance. Precondition: the motion is valid and
/// a sequence, in which segment k leads from keyframe k to keyframe k + 1.
[[nodiscard]] Result<SequenceBake> bake_sequence(const Motion& motion, const BakeOptions& options, std::string& glb);

/// Bakes a stream, into a file that is written as chronormal/io/output.h describes. The stream is read in several
/// passes that hold two keyframes at a time, or for the encoding keys all keyframes between two keys. The arrays wait
/// in an unnamed file in the folder of `path` until the JSON in front of them is known, so only this JSON and fits of a
/// weighting need memory that grows with the number of keyframes. If `path` is a stream or a device, the arrays wait in
/// memory. Errors: those of bake_sequence() for a motion, of the stream and of write_output().
[[nodiscard]] Result<SequenceBake> bake_sequence(MotionStream& stream, const BakeOptions& options,
                                                 const std::string& path, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_BAKE_H_
