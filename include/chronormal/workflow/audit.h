/// Audits stored normals: compares the normals that a viewer renders with the true ones, over a motion.
///
/// At a sample, a viewer renders a normal that its rule computes from the stored normals; the true normal is n(t),
/// area-weighted or by another weighting, from the positions at that time, in double. An author may have edited normals
/// (another weighting, a bevel); this offset is kept and is not an error:
///
///     authored offset    the angle between a stored base normal and the weighted normal of the geometry
///     motion error       the angle between the rendered and the true normal at a sample, with the offset kept
///
/// The offset is kept in a different way for each kind of input:
///
///     glTF       the rotation from n(0) to the stored N, fixed per vertex
///     skins      both normals as the skin of a node transforms them, in the pose of that time (docs/decisions/0022).
///                The errors of skinning itself are reported separately.
///     sequences  at each keyframe a rotation towards its stored normal, but by at most the angle of keyframe 0: growth
///                of the offset is an error. Between two keyframes the two rotations are blended.
///
/// Samples    t = i / (samples - 1) of each segment: a target alone (AuditOptions::weights), or the time between two
///            keys of an animation or two frames of a sequence. Weights are LINEAR, STEP or CUBICSPLINE as in the file.
///            Expressions of an avatar, poses in which a file opens, and requested poses have one sample each.
/// Judged     samples of vertices with a face that moves, or with a stored normal that changes.
/// Unlit      a rendered normal that is zero, infinite or NaN cannot be lit: such a sample has the largest possible
///            error, 180 degrees, and is counted.
/// No normal  samples whose n(t) is below 1e-4 of the largest control normal of its element over the motion are counted
///            separately, and are not part of the mean or the worst error. Their rendered normal must be finite; and it
///            must not be zero if the faces around have an area, since such faces are drawn.
/// Faint      samples without a normal whose n(t) is larger than the effect of rounding positions to float32. They
///            still have a direction, and rendered normals that point backwards must not pass. So is_within() of audits
///            and viewers checks their angle, reduced by the effect of that rounding.
/// Cancelled  samples without a normal that are not faint although the faces around have an area: faces that are back
///            to back and share their vertices. Their true normal is unknown, and is_within() is false.
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

/// The rules by which viewers find normals between two keyframes. All rules except kFlat use the stored normals.
enum class AuditRule {
  kGltf,   ///< normalize(N + sum w D) with the deltas of the file, in float32
  kLerp,   ///< linear interpolation between the stored normals of the keyframes
  kNlerp,  ///< linear interpolation between the unit vectors of the stored normals
  kSlerp,  ///< slerp between the unit vectors of the stored normals
  kStep,   ///< the normals of the earlier keyframe, until the next keyframe
  kFlat,   ///< face normals of the current mesh; stored normals are not used
};

[[nodiscard]] std::string_view audit_rule_name(AuditRule rule) noexcept;
/// Finds a rule by its name. Errors: kUsage for an unknown name, with all names.
[[nodiscard]] Result<AuditRule> make_audit_rule(std::string_view name);

/// The error in degrees up to which normals do not count as faulty. The limit is this large because some files store
/// normals in 8 bits.
inline constexpr double kAuditFault = 1;  // in degrees

/// The number of random poses of a mesh that are judged if poses are requested without a list of them.
inline constexpr std::size_t kRandomPoses = 200;

inline constexpr std::size_t kMostAuditSamples = 1000001;  ///< largest number of samples per segment

struct Audit;

struct AuditOptions {
  std::optional<AuditRule> rule = {};  ///< by default kGltf for glTF, and kNlerp for sequences
  /// The number of samples per segment. The default is 21, or fewer in long tracks, which get about 210 samples in all.
  std::optional<std::size_t> samples = {};
  /// For glTF, the approximate number of segments of a track that are judged. In a longer track, segments at equal
  /// steps are judged. 0 stands for all segments.
  std::size_t most_segments = 0;
  /// For glTF, the only animation to judge, by name or index. If no animation is named, all targets and animations are
  /// judged.
  std::string animation = {};
  /// The weighting of the true normals, which should be the weighting of the program that made the file. By default,
  /// each mesh or sequence has the weighting that its stored base normals clearly follow, or else area.
  std::optional<Weighting> weighting = {};
  /// For glTF, the original document, from which the audited document was baked, and which must have the same meshes.
  /// The normals of the original then count as the author's. By default, the normals of the audited document do.
  const GltfDocument* author = nullptr;
  /// For glTF, the lowest and the highest weight at which each target is judged alone: two finite numbers, of which the
  /// first is smaller.
  std::array<double, 2> weights = {0, 1};
  /// For glTF: if is_posed is true, the poses are judged in addition to the motions of the file. A pose is judged in
  /// the meshes whose targets it names, or that have as many targets as it has weights. If there are no poses,
  /// kRandomPoses random poses are judged for each mesh whose weights a program may set (docs/cli.md).
  bool is_posed = false;
  std::vector<RigPose> poses = {};
  std::vector<Viewer> viewers = {};  ///< viewers that are judged, too; for glTF with the rule kGltf
  /// True to judge a glTF mesh in a node with a skin as the skin transforms the mesh.
  bool skins = true;
  /// For glTF, an earlier audit of the same motions. Each motion then counts as much in averages as it does there,
  /// however many samples it has here. A bake adds keys, and an audit of its result has more samples of animations.
  const Audit* weighed_like = nullptr;
  bool weld = true;          ///< true if vertices that coincide in all keyframes share a normal
  bool keep_errors = false;  ///< true to keep every single error in Audit::errors
  /// A function that is called with the number of segments that are done, and the number of all segments.
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// The motion that is judged: a target alone (AuditOptions::weights), the weight track of a node, a sequence, an
/// avatar's expression, or the weights with which a file opens. Requested poses are the samples of a single subject.
struct AuditSubject {
  enum class Kind { kTarget, kTrack, kSequence, kExpression, kOpening, kPoses };

  Kind kind = Kind::kTarget;
  std::string name;  ///< name of the target, animation or expression; may be empty
  /// The indices of the mesh and the target in a glTF file. `target` is also set for targets over a base mesh (--base).
  std::optional<std::size_t> mesh, target;
  /// `animation` and `track` are set for a track, together with its node. For a pose in which the file opens, `node` is
  /// the first node that opens in it.
  std::optional<std::size_t> animation, track, node;
  std::optional<std::size_t> expression;   ///< index among the expressions of the mesh
  Weighting weighting = Weighting::kArea;  ///< weighting of the true normals
  std::vector<std::size_t> driven;         ///< the targets to which a track gives nonzero weights
  std::size_t segments = 0, samples = 0;   ///< number of segments, and number of samples per segment
  std::size_t vertices = 0;                ///< number of judged vertices, or of corners if a vertex has several normals
  MotionError error;
  MotionError at_keys;                         ///< the errors only at both ends of each segment
  std::optional<SkinningError> skinning = {};  ///< present if the mesh was judged through a skin

  /// Returns true if a sample of the subject is identified by its weight, and not by its time.
  [[nodiscard]] bool is_weighed() const noexcept {
    return kind == Kind::kTarget || kind == Kind::kExpression || kind == Kind::kOpening;
  }
};

/// Returns the name of a kind of subject: "target", "track", "sequence", "expression", "opening" or "poses".
[[nodiscard]] const char* audit_subject_name(AuditSubject::Kind kind) noexcept;
/// Returns the name of the number that tells apart the samples of a kind of subject: "weight", "time", or "pose" if
/// poses are numbered.
[[nodiscard]] const char* audit_moment_name(AuditSubject::Kind kind) noexcept;

/// The angles between stored base normals and the normals of the geometry.
struct AuthoredOffset {
  std::optional<std::size_t> mesh;         ///< the number of the mesh in a glTF file
  Weighting weighting = Weighting::kArea;  ///< weighting of the true normals
  /// False if the caller chose the weighting. True if the weighting was derived from the stored normals, or if it is
  /// the default because the stored normals follow no weighting clearly.
  bool is_detected = false;
  std::size_t vertices = 0;  ///< number of vertices that have both a stored and a true normal
  double sum = 0, worst = 0;
  AuditPlace worst_at;
  double area_mean = 0;  ///< mean angle to area-weighted normals in degrees
  /// True if true normals are summed over polygons, although the file has only their triangles.
  bool of_polygons = false;
  /// The weighting whose normals are closest to the stored normals on average. `closest_mean` and `closest_worst` are
  /// the average and the largest angle between its normals and the stored normals, in degrees.
  Weighting closest = Weighting::kArea;
  double closest_mean = 0, closest_worst = 0;

  [[nodiscard]] double mean() const noexcept { return vertices > 0 ? sum / static_cast<double>(vertices) : 0; }
};

struct AuditFinding {
  enum class Kind {
    kUnlit,           ///< a rendered normal is zero, infinite or NaN in some sample
    kMissingNormals,  ///< a target moves positions, but only the base has normals
    kWrongAtKeys,     ///< stored normals contradict the geometry at weight 1 or at keyframes
    kWrongBetween,    ///< normals are correct at weight 1 or at keyframes, but wrong in between
    /// Normals are wrong where an animation or expression combines targets, with a larger error than for each target
    /// alone.
    kWrongTogether,
    kWrongPose,      ///< normals are wrong in the pose in which a file opens, or in a requested pose
    kStaleTangents,  ///< tangents are not perpendicular to the true normal at weight 1, although they are in the base
    kStaleKeys,      ///< a note: the stored normals of a target do not tell the author's intention for `count` vertices
    kUnknownRule,    ///< a note: base normals follow no known rule; `degrees` is the angle between the rules
    kFlat,           ///< a note: there are primitives without normals, which viewers shade flat and without error
    /// A note: there are nodes with a skin, and normals are judged as the skin transforms them. `degrees` is the error
    /// of skinning.
    kSkinned,
    kUnreadSkin,  ///< a note: a skin of a node cannot be read, so normals are judged without it
    kBaked,       ///< a note: the file was baked
    /// A note: another program has recomputed the normals of a baked file, so the correction targets of the file have
    /// no effect any more.
    kEmptied,
    kSequenceTargets,  ///< a note: targets are the keyframes of a baked sequence, which have no meaning one by one
    kBeyondViewer      ///< a note: a mesh has more targets than a viewer supports
  };
  Kind kind;
  std::optional<std::size_t> mesh, target, node, animation, expression;
  std::size_t count = 0;               ///< number of samples, primitives, targets or nodes, depending on the kind
  double degrees = 0;                  ///< the worst error of the finding, in degrees
  std::optional<Error> reason = {};    ///< the reason why a part of the file could not be read
  std::optional<AuditPlace> worst_at;  ///< the place of the worst error, if there is one
  std::optional<Viewer> viewer;        ///< the viewer concerned; no value if the finding concerns all viewers

  /// Returns true for a fault: the kind is no note, and the error is larger than kAuditFault. So missing normals are
  /// not a fault if the motion turns no normals.
  [[nodiscard]] bool is_fault() const noexcept { return kind < Kind::kStaleKeys && degrees > kAuditFault; }
};

/// The errors of one viewer on a file. The rendered normals are compared with n(w) at the weights w that this viewer
/// plays.
struct ViewerAudit {
  Viewer viewer;
  MotionError error;                 ///< errors of all subjects
  std::optional<std::size_t> worst;  ///< index of the subject with the worst error
  /// The largest distance between a vertex in this viewer and its position by the specification, divided by the
  /// diagonal of the bounding box of the mesh's base.
  double displaced = 0;
  /// The number of targets of a mesh beyond the viewer's limit; Viewer::beyond tells how the viewer treats a mesh with
  /// more targets. `error` is then the error of a viewer that ignores the targets beyond the limit.
  std::size_t beyond = 0;

  /// Returns true if the viewer supports the file and its errors are within the limit in degrees
  /// (MotionError::passes()).
  [[nodiscard]] bool is_within(double degrees) const noexcept { return beyond == 0 && error.passes(degrees); }
  /// Returns true if no sample has more torn edges than `most_torn`.
  [[nodiscard]] bool is_whole(std::size_t most_torn) const noexcept { return error.most_torn <= most_torn; }
};

struct Audit {
  AuditRule rule = AuditRule::kGltf;
  /// The weighting of the true normals of all subjects; no value if meshes have different weightings.
  std::optional<Weighting> weighting = Weighting::kArea;
  /// True if normals are stored for every keyframe; otherwise the viewer has to compute the normals at keyframes.
  bool stored = true;
  std::array<double, 2> span = {};  ///< for a sequence: the times of its first and last keyframe
  std::optional<CutPath> cut = {};  ///< the cut of curved paths; the caller that has cut them sets it, for reports
  std::vector<AuditSubject> subjects;
  /// The number of targets, tracks and expressions that are not in `subjects`, because they move no vertex whose
  /// normals can be judged.
  std::size_t still = 0;
  MotionError error;                 ///< errors of all subjects
  std::optional<std::size_t> worst;  ///< index of the subject with the worst error
  std::vector<ViewerAudit> viewers;  ///< one for each viewer of the options, in the same order
  std::vector<AuthoredOffset> offsets;
  std::vector<AuditFinding> findings;  ///< the findings, faults first
  /// For a glTF file: sentences on parts that were left out or interpreted differently.
  std::vector<std::string> notes;
  /// The errors that keep_errors asks for. There is one table for each mesh of a glTF file with subjects, or one table
  /// for any other input. Tracks with the same keys share rows, which name the first of these tracks.
  std::vector<ErrorTable> errors;

  /// Returns true if at least one sample was judged. If not, nothing changes normals, or no face ever has an area. The
  /// audit then says nothing about the normals.
  [[nodiscard]] bool is_judged() const noexcept { return error.judged + error.faint > 0; }
  /// Returns true if every viewer of the options is within the limit in degrees (MotionError::passes()), or the rule if
  /// there are no viewers. If the file has motions, at least one sample must have been judged; a file in which nothing
  /// moves always passes.
  [[nodiscard]] bool is_within(double degrees) const noexcept {
    if (!subjects.empty() && !is_judged()) return false;
    if (viewers.empty()) return error.passes(degrees);
    return std::all_of(viewers.begin(), viewers.end(),
                       [degrees](const ViewerAudit& viewer) { return viewer.is_within(degrees); });
  }
  /// Returns true if no sample has more torn edges than `most_torn`, in any viewer of the options, or by the rule if
  /// there are no viewers.
  [[nodiscard]] bool is_whole(std::size_t most_torn) const noexcept {
    if (viewers.empty()) return error.most_torn <= most_torn;
    return std::all_of(viewers.begin(), viewers.end(),
                       [most_torn](const ViewerAudit& viewer) { return viewer.is_whole(most_torn); });
  }
};

/// The limits for the errors of an audit. A limit without a value allows everything.
struct AuditLimits {
  std::optional<double> degrees = {};          ///< limit of the worst error in degrees
  std::optional<std::size_t> torn_edges = {};  ///< limit of the number of torn edges at a single sample

  [[nodiscard]] bool any() const noexcept { return degrees || torn_edges; }
  /// Returns true if an audit, or one viewer of an audit, is within the limits.
  template <class Found>
  [[nodiscard]] bool allow(const Found& found) const noexcept {
    return (!degrees || found.is_within(*degrees)) && (!torn_edges || found.is_whole(*torn_edges));
  }
};

/// Returns the sum of the errors of the subjects of one mesh; the sum is empty for a mesh without subjects.
[[nodiscard]] MotionError error_of_mesh(const Audit& audit, std::size_t mesh);

/// Audits the targets of all meshes, each alone, the expressions of an avatar, the poses in which the file opens (if a
/// mesh or a node gives targets weights), and all weight tracks. Correction targets of a bake are not subjects. Their
/// weights follow from their formulas (docs/formats.md) with each target alone, in expressions and in requested poses;
/// in tracks and in the pose in which the file opens, they are those of the file. A file in which nothing moves has no
/// subjects. Errors: those of GltfDocument; kInvalidInput if extras.chronormal of a mesh is not a valid mark; kUsage
/// for an unknown animation, viewers with another rule than gltf, fewer than 2 samples, weights that do not ascend, and
/// kept errors of more than kMostErrorBytes; kInvalidInput for poses that fit no mesh.
[[nodiscard]] Result<Audit> audit(const GltfDocument& document, const AuditOptions& options);

/// Audits a motion that is not from a glTF file. A sequence is one subject; each target over a base is a subject.
/// If there are no stored normals, a viewer computes area-weighted normals at keyframes and interpolates between them;
/// the audit compares these normals with the true ones. Residuals of positions are used in all computations but one:
/// the weighting of stored normals is detected from the rounded positions, because a tenth of a degree can decide which
/// weighting fits these normals. Errors: kUsage if the options have the rule gltf, any viewer, or fewer than 2 samples;
/// kInvalidInput if the number of normals does not fit. Precondition: the motion is valid.
[[nodiscard]] Result<Audit> audit(const Motion& motion, const StoredNormals& normals, const AuditOptions& options);
/// Audits a stream while holding two keyframes at a time. The stream is read twice in full. It is also read twice in
/// part: until all vertices have moved, and until no two vertices coincide. Errors: those of audit() for a motion, and
/// those of the stream.
[[nodiscard]] Result<Audit> audit(MotionStream& stream, const StoredNormals& normals, const AuditOptions& options);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_H_
