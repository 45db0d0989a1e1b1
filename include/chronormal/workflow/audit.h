/// Compares what a viewer shows with what it should show: the errors of stored normals over a motion.
///
/// A viewer shows at a sample what its rule makes of the stored normals; it should show n(t), area-weighted or by
/// another weighting, from the positions at that time, in double. An author may give normals of his own (another
/// weighting, a bevel); that offset is kept and is no fault:
///
///     authored offset    the angle between a stored base normal and the weighted normal of the geometry
///     motion error       the angle between what is shown at a sample and what should be, the offset kept
///
///     glTF       the rotation from n(0) to the stored N, fixed per vertex
///     skins      both as the skin of a node takes them to the screen, in the pose of that time (docs/decisions/0022).
///                The errors of skinning itself are reported apart from these.
///     sequences  at each keyframe towards its stored normal, but by no more than the angle of keyframe 0: what an
///                offset grows by is an error. Between two keyframes the two rotations are blended
///
/// Samples    t = i / (samples - 1) of each segment: a target from weight 0 to 1, or the time between two keys of an
///            animation or two frames of a sequence. Weights are LINEAR, STEP or CUBICSPLINE as the file says.
///            Expressions of an avatar, poses in which a file opens, and poses that are asked for stand still: one
///            sample each.
/// Judged     samples of vertices that move: a face around them does, or their stored normal.
/// Unlit      a shown normal that is zero, infinite or NaN cannot be lit: such a sample has an error of 180 degrees,
///            the most that there is, and is counted.
/// No normal  samples whose n(t) is below 1e-4 of the largest control normal of its element over the motion are counted
///            apart, and are in no mean and no worst error. Their shown normal must be finite; and it must not be zero
///            if the faces around have an area, since these are drawn.
/// Faint      samples without a normal whose n(t) is more than what rounding the positions to float32 may change it by.
///            They have a direction all the same, and a gate must not pass what is lit from behind: is_within() of
///            audits and viewers looks at them, with the angle less what that rounding explains.
/// Cancelled  samples without a normal that are not faint although the faces around have an area: faces that lie back
///            to back and share their vertices. Nobody knows what is right there, and no gate passes.
/// Units      degrees; weights; seconds.
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_H_
#define CHRONORMAL_WORKFLOW_AUDIT_H_

#include <algorithm>
#include <array>
#include <cmath>
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
#include "chronormal/workflow/errors.h"
#include "chronormal/workflow/viewers.h"

namespace chronormal {

/// Selects what a viewer makes of stored normals between two keyframes.
enum class AuditRule {
  kGltf,   ///< normalize(N + sum w D), with the file's deltas, in float32
  kLerp,   ///< a straight line between the stored normals of the keyframes
  kNlerp,  ///< the same between their unit vectors
  kSlerp,  ///< the arc between them
  kStep,   ///< the normals of the keyframe before, up to the next one
  kFlat,   ///< face normals of the mesh as it is, instead of stored ones
};

[[nodiscard]] std::string_view audit_rule_name(AuditRule rule) noexcept;
/// Finds a rule by its name. Errors: kUsage, with all names.
[[nodiscard]] Result<AuditRule> make_audit_rule(std::string_view name);

/// Errors below this are no fault of a file, since some files store normals in 8 bits.
inline constexpr double kAuditFault = 1;  // degrees

inline constexpr std::size_t kRandomPoses = 200;  ///< of a mesh, where poses are asked for and none are given

inline constexpr std::size_t kMostAuditSamples = 1000001;  ///< of a segment

struct AuditOptions {
  std::optional<AuditRule> rule = {};       ///< nothing: kGltf for glTF, kNlerp for sequences
  std::optional<std::size_t> samples = {};  ///< per segment; nothing: 21, or fewer in long tracks (about 210 in all)
  /// glTF: in longer tracks every second, third or later segment is judged, so that about so many are. 0: all are.
  std::size_t most_segments = 0;
  std::string animation = {};  ///< glTF: this one alone, by name or index; empty: the targets and all of them
  /// The weighting of the right normals: that of the program which the file comes from. Nothing: for each mesh, and for
  /// a sequence, the one that its stored base normals follow clearly, or else area.
  std::optional<Weighting> weighting = {};
  /// glTF: the document that this one was baked from, whose normals are its author's; it must have the same meshes.
  /// Nothing: the normals of this one are its author's.
  const GltfDocument* author = nullptr;
  /// glTF: the weights between which each target is judged alone; the first is below the second, and both are finite.
  std::array<double, 2> weights = {0, 1};
  /// glTF: poses that are judged too, for meshes of which they name a target, or which have their number of targets.
  /// Without any, but with is_posed, kRandomPoses of each mesh that a program may set (docs/cli.md).
  bool is_posed = false;
  std::vector<RigPose> poses = {};
  std::vector<Viewer> viewers = {};  ///< glTF, by the rule gltf: these are judged too
  bool skins = true;                 ///< glTF: judges meshes in nodes with a skin as they are seen through it
  bool weld = true;                  ///< vertices at one point throughout are one
  bool keep_errors = false;          ///< every single one, in Audit::errors
  /// Is called with the number of segments.
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// One motion: a target from weight 0 to 1, the weight track of a node, a sequence, an expression of an avatar, the
/// weights with which a file opens, or poses that were asked for, which are samples of one subject.
struct AuditSubject {
  enum class Kind { kTarget, kTrack, kSequence, kExpression, kOpening, kPoses };

  Kind kind = Kind::kTarget;
  std::string name;                                   ///< of the target, animation or expression; may be empty
  std::optional<std::size_t> mesh, target;            ///< of a glTF file; target: of --base too
  std::optional<std::size_t> animation, track, node;  ///< of a track; node: the first that opens so, too
  std::optional<std::size_t> expression;              ///< among those of the mesh
  Weighting weighting = Weighting::kArea;             ///< of its right normals
  std::vector<std::size_t> driven;                    ///< the targets that a track gives other weights than 0
  std::size_t segments = 0, samples = 0;              ///< samples of each segment
  std::size_t vertices = 0;                           ///< judged vertices, or corners where there is no one-to-one
  MotionError error;
  MotionError at_keys;                         ///< of the same, those at both ends of each segment
  std::optional<SkinningError> skinning = {};  ///< where it was judged through a skin

  /// Returns true if a sample is found by a weight, and not by a time.
  [[nodiscard]] bool is_weighed() const noexcept {
    return kind == Kind::kTarget || kind == Kind::kExpression || kind == Kind::kOpening;
  }
};

/// Returns "target", "track", "sequence", "expression", "opening" or "poses".
[[nodiscard]] const char* audit_subject_name(AuditSubject::Kind kind) noexcept;
/// Names what a sample of a subject is found by: "weight", "time", or "pose" for the number of a pose.
[[nodiscard]] const char* audit_moment_name(AuditSubject::Kind kind) noexcept;

/// The distance of stored base normals from the geometry.
struct AuthoredOffset {
  std::optional<std::size_t> mesh;         ///< of a glTF file
  Weighting weighting = Weighting::kArea;  ///< of the right normals
  bool is_detected = false;                ///< nobody asked for it: the stored normals follow it, or none clearly
  std::size_t vertices = 0;                ///< vertices that have both
  double sum = 0, worst = 0;
  AuditPlace worst_at;
  double area_mean = 0;      ///< the same by area
  bool of_polygons = false;  ///< the right normals are weighed by polygons, of which the file has the triangles
  /// The weighting that comes closest to the stored normals on average, and how close.
  Weighting closest = Weighting::kArea;
  double closest_mean = 0, closest_worst = 0;

  [[nodiscard]] double mean() const noexcept { return vertices > 0 ? sum / static_cast<double>(vertices) : 0; }
};

struct AuditFinding {
  enum class Kind {
    kUnlit,           ///< a shown normal is zero, infinite or NaN somewhere
    kMissingNormals,  ///< a target moves positions, and the base has normals, but the target has none
    kWrongAtKeys,     ///< stored normals contradict the geometry at weight 1, or at keyframes
    kWrongBetween,    ///< right there, and off on the way
    kWrongTogether,   ///< off where an animation or expression has several targets, by more than each of them alone
    kWrongPose,       ///< the pose in which a file opens, or one that was asked for, is off
    kStaleTangents,   ///< tangents that are not perpendicular to the right normal at weight 1, as they were in the base
    kStaleKeys,       ///< a note: stored normals of a target tell nothing of the author's, of `count` vertices
    kUnknownRule,     ///< a note: base normals follow no rule; degrees is how far rules are from each other
    kFlat,            ///< a note: primitives without normals, which viewers shade flat and right
    kSkinned,         ///< a note: nodes with a skin, through which normals are judged; degrees is what skinning turns
    kUnreadSkin,      ///< a note: nodes with a skin that cannot be read, so that normals are judged without it
    kBaked,           ///< a note: a bake was here
    kEmptied,  ///< a note: another program remade the normals that a bake wrote; its correction targets turn nothing
    kSequenceTargets,  ///< a note: baked keyframes, which mean nothing one by one
    kBeyondViewer      ///< a note: a mesh has more targets than a viewer takes
  };
  Kind kind;
  std::optional<std::size_t> mesh, target, node, animation, expression;
  std::size_t count = 0;               ///< samples, primitives, targets or nodes, as the kind has it
  double degrees = 0;                  ///< the worst
  std::optional<Error> reason = {};    ///< why something could not be read
  std::optional<AuditPlace> worst_at;  ///< where there is one
  std::optional<Viewer> viewer;        ///< the viewer that it is about; nothing: all

  /// Returns true for a fault. Normals may be missing where the motion does not turn them.
  [[nodiscard]] bool is_fault() const noexcept { return kind < Kind::kStaleKeys && degrees > kAuditFault; }
};

/// The errors of one viewer on a file. It should show n(w) at the weights that it plays.
struct ViewerAudit {
  Viewer viewer;
  MotionError error;                 ///< of all subjects
  std::optional<std::size_t> worst;  ///< the subject with the worst error
  /// The largest distance of a vertex from where the specification has it: a share of the diagonal of the box around
  /// the base of its mesh.
  double displaced = 0;
  /// The number of targets of a mesh beyond those that the viewer takes: it shows nothing then (Viewer::beyond). The
  /// errors above are as if it left these targets out.
  std::size_t beyond = 0;

  /// Returns true if the viewer shows the file, and its errors pass the gate (MotionError::passes()).
  [[nodiscard]] bool is_within(double degrees) const noexcept { return beyond == 0 && error.passes(degrees); }
  /// Returns true if no more edges are torn than this at any sample.
  [[nodiscard]] bool is_whole(std::size_t most_torn) const noexcept { return error.most_torn <= most_torn; }
};

struct Audit {
  AuditRule rule = AuditRule::kGltf;
  /// The weighting of the normals that all subjects are judged against; empty where meshes have different ones.
  std::optional<Weighting> weighting = Weighting::kArea;
  /// True if normals are stored for every keyframe; otherwise a viewer computes them there.
  bool stored = true;
  std::array<double, 2> span = {};  ///< of a sequence: the times of its first and its last keyframe
  std::optional<CutPath> cut = {};  ///< of curves, set by who has cut them: for reports
  std::vector<AuditSubject> subjects;
  /// The number of targets, tracks and expressions that move nothing, or nothing that can be judged: they are no
  /// subjects.
  std::size_t still = 0;
  MotionError error;                 ///< of all subjects
  std::optional<std::size_t> worst;  ///< the subject with the worst error
  std::vector<ViewerAudit> viewers;  ///< the viewers of the options, in their order
  std::vector<AuthoredOffset> offsets;
  std::vector<AuditFinding> findings;  ///< faults first
  std::vector<std::string> notes;      ///< of a glTF file: what was left out, or read in another way than it was meant
  /// The tables of keep_errors: one for each mesh of a glTF file that has subjects, and one for other inputs. Tracks
  /// with the same keys have rows once, as the first of their subjects.
  std::vector<ErrorTable> errors;

  /// Returns true if there was anything to judge. If nothing turns normals, or no face ever has an area, nothing is
  /// known to be right.
  [[nodiscard]] bool is_judged() const noexcept { return error.judged + error.faint > 0; }
  /// Returns true if every named viewer passes the gate, or the rule if none was named: MotionError::passes(). If there
  /// are motions, some sample must have been judged; a file in which nothing moves is within anything.
  [[nodiscard]] bool is_within(double degrees) const noexcept {
    if (!subjects.empty() && !is_judged()) return false;
    if (viewers.empty()) return error.passes(degrees);
    return std::all_of(viewers.begin(), viewers.end(),
                       [degrees](const ViewerAudit& viewer) { return viewer.is_within(degrees); });
  }
  /// Returns true if no more edges are torn than this at any sample, in any named viewer, or by the rule if none was
  /// named.
  [[nodiscard]] bool is_whole(std::size_t most_torn) const noexcept {
    if (viewers.empty()) return error.most_torn <= most_torn;
    return std::all_of(viewers.begin(), viewers.end(),
                       [most_torn](const ViewerAudit& viewer) { return viewer.is_whole(most_torn); });
  }
};

/// The most that an audit may find; an empty limit allows anything.
struct AuditLimits {
  std::optional<double> degrees = {};          ///< of the worst error
  std::optional<std::size_t> torn_edges = {};  ///< at one sample

  [[nodiscard]] bool any() const noexcept { return degrees || torn_edges; }
  /// Returns true if an audit, or one of its viewers, keeps to the limits.
  template <class Found>
  [[nodiscard]] bool allow(const Found& found) const noexcept {
    return (!degrees || found.is_within(*degrees)) && (!torn_edges || found.is_whole(*torn_edges));
  }
};

/// Adds up the errors of the subjects of one mesh; the result is empty for a mesh without subjects.
[[nodiscard]] MotionError error_of_mesh(const Audit& audit, std::size_t mesh);

/// Audits the targets of all meshes, each alone, the expressions of an avatar, the poses in which the file opens (if a
/// mesh or a node gives targets weights), and all weight tracks. Correction targets of a bake are no subjects: with
/// each target alone, in expressions and in poses that are asked for, they get the weights that follow
/// (docs/formats.md); a track, and the pose in which the file opens, give them what the file says. A file in which
/// nothing moves has no subjects.
/// subjects.
/// Errors: of GltfDocument; kInvalidInput where extras.chronormal of a mesh is not what a bake writes; kUsage for an
/// animation that is not there, viewers with another rule than gltf, fewer than 2 samples, weights that are
/// not ascending, and errors to keep that take more than kMostErrorBytes; kInvalidInput for poses that fit no mesh.
[[nodiscard]] Result<Audit> audit(const GltfDocument& document, const AuditOptions& options);

/// Audits a motion that is read without a document: a sequence, or targets over a base, each of which is a subject
/// then. Without stored normals, a viewer computes them at keyframes, area-weighted, and interpolates: the audit
/// compares its normals in between with the truth. Residuals of positions count, except for finding the weighting that
/// stored normals follow, which differences of a tenth of a degree tell. Errors: kUsage for the rule gltf, for viewers,
/// and for fewer than 2 samples; kInvalidInput for normals that do not fit. Precondition: the motion is valid
[[nodiscard]] Result<Audit> audit(const Motion& motion, const StoredNormals& normals, const AuditOptions& options);
/// Audits a stream, of which two keyframes are held at a time. It is read twice, once more up to where all vertices
/// have moved, and once more up to where none coincide any more. Errors: also those of the stream.
[[nodiscard]] Result<Audit> audit(MotionStream& stream, const StoredNormals& normals, const AuditOptions& options);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_H_
