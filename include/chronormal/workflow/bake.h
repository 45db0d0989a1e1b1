/// Writes right normals into ordinary glTF files.
///
///     smallest   the default: of all these candidates and more, the one of fewest bytes whose worst error along the
///                animations is within a tolerance in every viewer that is named; nowhere worse than before. Candidates
///                are what the file has, deltas of its targets alone, correction targets that products of weights
///                drive, and correction targets of low rank that only the animations of the file drive
///                (docs/theory.md, section 17)
///     harmless   unit normals at weight 1 for each target, and correction targets of unit normals for errors that
///                remain on the way and where targets meet, as far as they are beyond a tolerance: nearly right in
///                every viewer that is named, and in none of them worse than before (docs/theory.md, section 16)
///     exact      correction targets that carry the quadratic terms of eq. 32, driven by quadratics of the weights:
///                exact at every instant in every viewer that adds up targets
///     endpoint   the best single delta per target (analysis/fits/end_delta.h): right at the ends, with a stated error
///                between; where the file has several targets active at once, deltas fitted to its weights by least
///                squares (docs/theory.md, eq. 44); in viewers that add up targets no worse than before
///
///     keys       for sequences: nothing but unit normals at keys, as few keys as viewers need that draw straight lines
///                between them, certified at every instant (docs/uses.md)
///
/// The base NORMAL stays as it is, and so does every other byte of the file that is not named by GltfBake::pointers.
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
class Expansion;  // how much a file may make us hold or write
}

inline constexpr double kHarmlessTolerance = 0.5, kExactBakeTolerance = 0.001;  ///< degrees
inline constexpr double kLeastKeyTolerance = 0.001;  ///< degrees: float32 in viewers takes some

struct BakeOptions {
  std::optional<BakeEncoding> encoding = {};  ///< nothing: smallest; of sequences exact
  /// The viewers that the bake is made for. Nothing: the viewers that add up deltas (three.js, Babylon.js, PlayCanvas,
  /// Bevy), and `spared` are then those that keep unit normals (Godot, Filament).
  std::vector<Viewer> viewers = {};
  /// Viewers in which nothing should get worse: among candidates that are alike in the other viewers, one that keeps to
  /// this comes first.
  std::vector<Viewer> spared = {};
  /// The bytes of the document, which decide whether a result is too large if neither a tolerance nor a limit is asked
  /// for; 0: no size is too large.
  std::size_t bytes_of_file = 0;
  /// The weighting of the right normals. Weightings other than area are fitted, with a stated error. Nothing: for each
  /// mesh the one that its stored base normals follow clearly (as audit has it), or else area; area if normals are made
  /// anew, by recompute_base.
  std::optional<Weighting> weighting = {};
  bool smooth = false;        ///< primitives without NORMAL get normals, instead of staying flat
  double crease_angle = 180;  ///< degrees: hard edges of those, and of sequences
  /// The normals of keyframe 0 of a sequence, one for each corner, or empty. They say which edges are hard in place of
  /// the crease angle and, unless one is asked for, which weighting the right normals have. Their offset from the right
  /// normals is kept throughout. (keys takes hard edges alone.)
  VectorView<const float> normal_of_corner = {};
  bool weld = true;  ///< vertices at one point throughout are one, but for hard edges and the two sides of a sheet
  bool recompute_base = false;  ///< replace the base normals by those of the geometry; hard edges stay
  bool dense_zeros = false;     ///< write zeros as bytes: for readers that need every accessor to have some
  std::optional<std::size_t> most_bytes = {};  ///< refuse to add more than this
  const Expansion* expansion = nullptr;  ///< of sequences, by the program; nullptr: anything; a document has its own
  /// Degrees. For smallest, the largest worst error. For harmless and exact, correction targets are left out whose
  /// lack, all together, turns no normal by more; tracks are cut to this. For keys, the largest error of a normal at
  /// any instant, kLeastKeyTolerance or more. Nothing: kHarmlessTolerance, and kExactBakeTolerance for exact.
  std::optional<double> tolerance = {};
  /// The most targets that a mesh may have, its own ones among them (smallest). Nothing: as many as the viewers bear.
  std::optional<std::size_t> most_targets = {};
  /// Promises that only the animations of the file will ever be played, so that smallest may fit the deltas of the
  /// mesh's own targets to them. Such deltas mean nothing alone.
  bool animations_only = false;
  /// The most bytes of arrays of deltas and tangents that a mesh may have, and its tracks may grow by (smallest); the
  /// nearest candidate that keeps to it is taken.
  std::optional<std::size_t> most_delta_bytes = {};
  /// Promises that a program poses the meshes that no animation drives, and drives their correction targets as the file
  /// says. Only then smallest gives them any.
  bool is_posed = false;
  /// The poses that these meshes are made for, by the names of targets or in their order. A mesh takes no part if the
  /// poses name none of its targets and none has its number of weights. None: random poses (docs/cli.md).
  std::vector<RigPose> poses = {};
  bool plan = false;  ///< of smallest: look at all candidates, also where one is found to be the smallest
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// Returns the options, with the usual viewers if they name none.
[[nodiscard]] BakeOptions with_viewers(BakeOptions options);

/// The errors of shown normals, in degrees.
struct ShownErrors {
  std::size_t judged = 0;  ///< samples: a vertex in a pose
  double mean = 0;
  double most = 0;  ///< 99.9 % of the errors are smaller than this, to a tenth
  double worst = 0;
  /// Samples (an edge in a pose) at which errors jump by more than 10, 20 and 40 degrees.
  std::array<std::size_t, 3> tears{};
  std::size_t poses = 0;

  /// Returns the number of edges that are torn by more than 10 degrees, on average over the poses.
  [[nodiscard]] double torn_edges() const noexcept {
    return poses > 0 ? static_cast<double>(tears[0]) / static_cast<double>(poses) : 0;
  }
};

/// The errors that a viewer shows of a mesh before and after a bake, seen through the skins of the nodes that carry it.
struct ViewerChange {
  struct Errors {
    ShownErrors before, after;
  };
  std::string viewer;
  bool is_named = true;    ///< the bake is made for it
  bool is_better = false;  ///< as a whole, and by more than is allowed for in no respect worse
  /// The errors in the animations of the file as the viewer plays them, and its standing weights; with each target
  /// alone from 0 to 1; and in poses that a program sets.
  std::array<Errors, 3> poses;
};

/// A candidate for a mesh that smallest looked at.
struct BakedCandidate {
  /// The kind of candidate: "as it is", "own deltas", "products", "quadratics" or "low rank".
  std::string_view name;
  std::size_t targets = 0, bytes = 0;  ///< bytes: of new deltas and tangents, and those by which tracks grow
  /// The errors in the worst of the named viewers, along the animations of the file, between its keys, and in its
  /// standing weights; or, in a file without an animation of weights, with each target alone and in the poses that the
  /// mesh is made for, to which nothing was fitted. Samples count if n(w) is longer than a thousandth of n(0). They are
  /// seen through the skins of the nodes that show the mesh.
  ShownErrors played;
  /// The errors of each named viewer. Empty if bake looked at no other candidate than "as it is", and for the numbers
  /// of "quadratics" that bake tried on all vertices alike.
  std::vector<ViewerChange> viewers;
  bool within = false;  ///< its worst is within the tolerance, and it within the limits
  bool chosen = false;
  bool animations_only = false;  ///< its deltas are fitted to the animations, and mean nothing alone
  bool skinned = false;  ///< some skin does more than turn and scale evenly, so that played is other than without
  /// Degrees, of the chosen candidate: the worst error that compressors among the named viewers make by rounding what
  /// they keep, which no candidate can help and no choice looks at; 0 if no compressor is named.
  double rounded = 0;
};

/// Returns true if a candidate misses the tolerance that was asked for only by what compressors round.
[[nodiscard]] inline bool is_beyond_by_rounding(const BakedCandidate& choice, const BakeOptions& options) {
  return options.tolerance && choice.within && choice.rounded > *options.tolerance;
}

/// The result for one mesh.
struct BakedMesh {
  std::size_t mesh = 0;
  std::string name;
  BakeEncoding encoding = BakeEncoding::kExact;
  Weighting weighting = Weighting::kArea;  ///< of the right normals; means nothing where it was baked before
  std::size_t elements = 0;                ///< different normals
  std::vector<GltfExtraTarget> extras;     ///< correction targets, added now or by the bake before
  std::size_t bytes = 0;  ///< of new arrays, without those that an earlier mesh has too, and those by which tracks grow
  std::size_t undriven = 0;        ///< of exact: moving targets that no animation drives, baked as endpoint
  std::size_t left_flat = 0;       ///< primitives without NORMAL that stay flat
  std::size_t without_stored = 0;  ///< vertices whose stored base normal is zero, or nearly: nothing can be added to
  std::size_t rescaled = 0;  ///< vertices whose stored base normal was too long or short for float32: now of length 1
  /// Targets whose tangents leaned on the right normals. These are made anew, for viewers that add up tangents.
  std::size_t new_tangents = 0;
  std::size_t left_tangents = 0;  ///< targets for which most_delta_bytes has no room: they stay as they are
  std::size_t stilled = 0;        ///< targets that moved normals and no position: their deltas are zero now
  std::size_t without_base = 0;   ///< vertices whose faces have no area in the base: see docs/cli.md
  /// Degrees, of endpoint targets and fits: each alone, over w in [0, 1] and beyond as the file goes. Targets that are
  /// active together are compared at the weights of the file, at keys and at up to fifteen instants between any two.
  double largest_error = 0;
  std::size_t fitted_elements = 0;  ///< of endpoint: with deltas by least squares, for targets active together
  double resampling_error = 0;      ///< degrees, of cubic splines and left-out pairs, along the animations
  bool has_lone_weight = false;     ///< KHR_animation_pointer drives a weight alone: no correction targets but of exact
  bool already_baked = false;       ///< nothing was changed; `candidates` has what smallest finds it to be
  std::vector<ViewerChange> viewers;       ///< but of exact: what each named viewer shows, where the mesh changed
  std::vector<BakedCandidate> candidates;  ///< of smallest: those that were looked at
  std::size_t left_out = 0;                ///< correction targets that the viewers have no room for
  /// Nodes that carry the mesh and whose extras are no object, so that the drivers of correction targets do not stand
  /// there.
  std::vector<std::size_t> unmarked_nodes;
};

struct GltfBake {
  std::vector<BakedMesh> meshes;      ///< the meshes with targets that move
  std::vector<std::string> pointers;  ///< JSON pointers that were replaced or added
  std::vector<std::string> warnings;  ///< for a person: one sentence each
  std::size_t added_targets = 0, added_bytes = 0;
  std::size_t bytes_of_file = 0;     ///< of the document before
  std::size_t left_out_bytes = 0;    ///< of arrays of the source that nothing refers to any more
  std::size_t converted_tracks = 0;  ///< weight tracks that are cubic splines now
  bool changed = false;
  std::string drivers;  ///< the drivers of the correction targets of all meshes, as JSON of its own (docs/formats.md)
};

/// Bakes a document into a new edit of it, which the caller writes. Meshes that were baked before stay as they are.
///
/// Weights    those of all animations, of nodes and of meshes: if two targets are active at once, their pair gets a
///            correction target. Exact is exact at these weights; other weights are as exact except for pairs that got
///            none.
/// Fits       with weightings other than area, n(w) is no polynomial: exact stands for the quadratic form that is right
///            where one target has the weight 0, 1/2 or 1, and where two have the weight 1.
///
/// Errors: of GltfDocument; kUsage for keys; kInvalidInput if nothing moves, if more than most_bytes would be added
/// (with the number of bytes that it would take), if extras of a mesh are no object or extras.chronormal is not what a
/// bake writes, if base normals to replace are compressed by Draco, or for exact if an extension drives a weight alone.
[[nodiscard]] Result<GltfBake> bake(const GltfDocument& document, const BakeOptions& options, GltfEdit& edit);

struct SequenceBake {
  std::size_t keyframes = 0, vertices = 0, targets = 0, extra_targets = 0;
  std::size_t bytes = 0;                   ///< of the file
  double largest_error = 0;                ///< degrees, of endpoint and harmless; of a weighting that is fitted
  std::size_t without_normals = 0;         ///< elements that have no area in the whole motion
  Weighting weighting = Weighting::kArea;  ///< of the right normals: that of the stored ones, or area
  bool has_offsets = false;  ///< stored normals of keyframe 0 differ from those by rotations, which are kept throughout
  std::vector<std::string> warnings;
  /// The numbers that --encode keys reports.
  struct Keys {
    std::size_t count = 0;       ///< the first and the last among them
    std::size_t in_between = 0;  ///< keys that lie between two keyframes
    std::size_t left_out = 0;    ///< keyframes that are no keys: their positions lie on the lines between keys
    std::size_t even = 0;        ///< the number of keys if all keyframes stayed, and all segments were cut alike
    std::size_t beyond = 0;      ///< (normal, segment) pairs that no keys bring within the tolerance: they collapse
  };
  std::optional<Keys> keys = {};
  std::optional<CutPath> cut = {};  ///< of curves, set by who has cut them: for reports
};

/// Makes an animated GLB of a sequence: keyframe 0 is the base, and every later one a target with hat weights. Exact
/// adds one more target per segment, with the weight t (1 - t) (docs/theory.md, section 15). Harmless has unit normals
/// in all targets, bends with 4 t (1 - t) if viewers have room, and a LINEAR track (section 16). Vertices of hard edges
/// (crease angle) are doubled. Keys is harmless without bends, at keys of its own choice, for area weights. glb gets
/// the bytes of the file; on an error it stays as it was.
/// The file holds float32 positions, and its normals are exact for these: residuals of a computed motion are left out.
/// Polygons become fans of triangles, and keep the normals of polygons; if a fan does not fit in keyframe 0, a warning
/// says so. Errors: kInvalidInput for more than most_bytes or 4 GiB; kUsage in keys for other weights than area or a
/// tolerance below kLeastKeyTolerance. Precondition: the motion is valid and a sequence (segments k -> k + 1)
[[nodiscard]] Result<SequenceBake> bake_sequence(const Motion& motion, const BakeOptions& options, std::string& glb);

/// Bakes a stream, into a file that is written as chronormal/io/output.h describes. The stream is read in several
/// passes that hold two keyframes at a time, and for keys as many as lie between two keys. The arrays wait in a file
/// without a name in the folder of path until the JSON in front of them is known. So only that JSON, and the fits of a
/// weighting, grow with the number of keyframes. If path is a stream or a device, the arrays wait in memory. Errors:
/// also those of the stream and of write_output()
[[nodiscard]] Result<SequenceBake> bake_sequence(MotionStream& stream, const BakeOptions& options,
                                                 const std::string& path, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_BAKE_H_
