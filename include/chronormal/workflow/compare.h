/// Compares every scheme with the exact normals of a motion, like the paper's Table 1. Also compares the deltas of
/// blend shapes with their exact normals.
///
/// A viewer that adds one normal delta per target renders normalize(N + sum_i w_i D_i); the true normal is a quadratic
/// form in the weights (docs/theory.md, section 14). The comparison includes the deltas of a glTF file, end-point
/// deltas (exact for each target alone at weight 1), the best deltas by least squares
/// (analysis/quality/blend_quality.h), and the exact normals of MeshNormals, which have only rounding errors. True
/// normals are cross products of blended positions in double.
///
/// Weights    random, from 0 to 1, for 1, 2, 4, 8, 16 targets at once and for all; or the weights of an animation.
///            Least squares use as many other random weights of the same kind, or 16 for each target if that is more,
///            so they are not fitted to the weights of the comparison; for an animation they use the same weights.
/// Compared   normals that a target with nonzero weight changes: by moving a face around it, or by a delta in the file.
///            Each different normal counts once; in a glTF file, once for each vertex.
/// glTF       each mesh separately, with elements by its stored normals. If an author edited base normals, the true
///            normals are turned in the same way, as in an audit (workflow/shading/gltf_shading.h). Flat primitives
///            have no errors in viewers and are left out. Correction targets get their weights by formulas.
#ifndef CHRONORMAL_WORKFLOW_COMPARE_H_
#define CHRONORMAL_WORKFLOW_COMPARE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/analysis/quality.h"
#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "chronormal/motion/paths.h"
#include "chronormal/schemes/scheme.h"
#include "chronormal/workflow/errors.h"
#include "chronormal/workflow/sample.h"

namespace chronormal {

/// Returns the names of the default schemes: the schemes in the rows of the paper's Table 1, and our own. For elements
/// other than faces, schemes that need faces are left out.
[[nodiscard]] std::vector<std::string> default_schemes(ElementKind kind = ElementKind::kFaces);

/// The orders in which the samples of a segment are computed (section 3 of the paper).
enum class Access {
  kRandom,      ///< each sample is computed independently of the others
  kSequential,  ///< each sample is computed from the previous one, if the scheme can; otherwise as with kRandom
};

/// Bounds of the largest error of a scheme at any time of a motion (analysis/certify.h). The error is never above the
/// upper bound.
struct CertifiedError {
  double lower = 0;  ///< the lower bound in radians
  double upper = 0;  ///< the upper bound in radians; pi if no smaller bound could be shown
  /// The first piece of a segment, as an interval of local t, on which the error may reach the upper bound.
  std::size_t segment = 0, element = 0;
  double from = 0, to = 1;
  /// The number of (element, segment) combinations for which no bound below half a turn could be shown.
  std::size_t unbounded = 0;
};

struct CompareOptions {
  std::vector<std::string> schemes;  ///< names of schemes, in the order of the rows; if empty, default_schemes()
  std::size_t samples = 21;          ///< number of samples per segment, both ends included; at least 2
  Access access = Access::kRandom;
  /// A function that is called in the calling thread with the number of units of work that are done, and their total.
  /// The function may be empty.
  std::function<void(std::size_t done, std::size_t total)> progress;
  /// The elements whose normals are compared: faces by default, as in the tables of the paper.
  ElementOptions elements = {ElementKind::kFaces};
  /// The weighting of faces in the normals of vertices and corners. Normals with a weighting other than area are not
  /// quadratic in time. Schemes are then prepared from the exact weighted normals, and `polynomial` is the quadratic
  /// through three of these normals. `quaternion:optimal` and `linear:scaled` search for the optimum for this
  /// quadratic.
  Weighting weighting = Weighting::kArea;
  bool keep_errors = false;   ///< true to keep every single error in Comparison::errors
  bool keep_samples = false;  ///< true to keep the errors of each sample in SchemeComparison::samples
  bool certify = false;       ///< true to bound the largest error at any time in SchemeComparison::certified
  /// The tolerance in degrees, at least 0. If a tolerance is given, errors are certified, and Comparison::cheapest is
  /// the cheapest scheme whose error never exceeds the tolerance.
  std::optional<double> tolerance = {};
};

/// The errors and costs of one scheme on one motion. quality.max_at names a face, or the first vertex or corner of the
/// element. Costs are per element. Each time is measured in one thread while all threads work. A time is the median
/// over segments of the median over blocks of up to 1,024 elements, which stay in the cache (on smaller meshes, the
/// calls themselves take most of the time).
struct SchemeComparison {
  std::string scheme;
  Quality quality;
  /// The sum of the errors of this scheme divided by the sum of the errors of `linear`; no value if `linear` has only
  /// rounding errors.
  std::optional<double> relative_to_linear;
  /// The number of (element, segment) combinations for which the scheme is not defined, so that it used a documented
  /// fallback.
  std::size_t fallbacks = 0;
  /// The number of (element, segment) combinations that are evaluated in double.
  std::size_t flagged = 0;
  bool sequential = false;  ///< true if the scheme was played step by step
  /// The time of prepare() in nanoseconds per element, including the time for control normals if the scheme uses them.
  double prepare_ns = 0;
  double evaluate_ns = 0;  ///< nanoseconds per element and sample
  double bytes = 0;        ///< number of bytes per element that an evaluation reads
  /// The numbers of operations per element and sample, for the kind of access that was measured.
  OperationCounts operations;
  std::vector<Quality> samples = {};  ///< with keep_samples, the errors of each sample, segment by segment
  /// Bounds of the largest error; no value unless certificates were requested.
  std::optional<CertifiedError> certified = {};
};

struct Comparison {
  ElementKind kind = ElementKind::kFaces;
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t elements = 0;  ///< number of compared elements: faces, or different normals of vertices or corners
  std::size_t segments = 0;
  std::size_t samples = 0;
  std::vector<SchemeComparison> schemes;
  MotionKind motion = MotionKind::kSequence;  ///< the kind of the motion
  std::vector<ErrorTable> errors = {};        ///< with keep_errors, one table for each requested scheme
  std::optional<double> tolerance = {};       ///< the tolerance in degrees, if one was given
  /// The index of the cheapest scheme that is certainly within the tolerance; no value if no scheme is.
  std::optional<std::size_t> cheapest = {};
  Weighting weighting = Weighting::kArea;  ///< the weighting for vertices and corners
  std::array<double, 2> span = {};         ///< the times of the first and the last keyframe
  /// The numbers that describe how curved paths were cut into straight pieces. The caller that has cut the paths sets
  /// them, for reports.
  std::optional<CutPath> cut = {};
};

/// Compares schemes on the faces of a motion, or on its vertices or corners, over all its segments.
///
/// Errors     kUsage for an unknown scheme or one that needs faces, fewer than 2 samples, an invalid crease angle or
///            tolerance, a weighting other than area with faces or certificates, certificates of sequential access, and
///            kept errors of more than kMostErrorBytes.
/// Threads    uses all threads (core/parallel.h); all results except times are the same for any number of threads.
/// Memory     a few MB beyond the motion, and 8 bytes per scheme and segment for the times; for
///            vertices and corners also their groups and 72 bytes for each face and element.
/// Cost       segments x faces x samples x schemes evaluations, plus an exact normal and an arc tangent for each.
/// Precondition: the motion is valid (validate() in motion/motion.h)
[[nodiscard]] Result<Comparison> compare(const Motion& motion, const CompareOptions& options);
/// Compares the schemes for a stream. Holds so many segments at a time that each thread has a few thousand elements,
/// and at least one segment. Errors: those of compare() for a motion, and those of the stream.
[[nodiscard]] Result<Comparison> compare(MotionStream& stream, const CompareOptions& options);

/// Estimates the cost of an evaluation, by which schemes are sorted. Each byte that is read, each addition and each
/// multiplication costs 1, a quotient or a root costs 4, and a sine with its cosine 20.
[[nodiscard]] double evaluation_cost(const SchemeComparison& scheme) noexcept;

/// The scheme with the least evaluation_cost() among those whose error certainly never exceeds a tolerance. Candidates
/// are options.schemes, or all schemes without a parameter that support the elements.
struct Choice {
  std::optional<std::string> scheme;  ///< the name of the scheme; no value if no scheme is within the tolerance
  Comparison comparison;              ///< all candidates, compared at two samples of each segment
};
/// Finds the cheapest scheme whose error never exceeds `tolerance`, which is in degrees and at least 0. Errors: those
/// of compare().
[[nodiscard]] Result<Choice> choose(const Motion& motion, double tolerance, CompareOptions options = {});

inline constexpr std::size_t kMostBlendRows = 10000;

struct BlendCompareOptions {
  std::size_t rows = 100;  ///< number of weight vectors for each number of active targets; 1 to kMostBlendRows
  /// The number of targets with nonzero weights; 0 stands for 1, 2, 4, 8, 16 and all, up to the number of targets.
  std::size_t active = 0;
  std::uint64_t seed = 1;  ///< seed of random weights, which are the same on every system
  /// The elements of a motion whose normals are compared. The elements of a glTF file follow from its stored normals.
  ElementOptions elements = {};
  /// An animation of a glTF file, by name or index, from which the weights come: up to `rows` of its weight vectors,
  /// evenly spaced. Without an animation, weights are random.
  std::string animation = {};
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

enum class BlendDeltas { kFile, kEndPoint, kLeastSquares, kExact };

/// Returns the name of a kind of deltas: "file", "end point", "least squares" or "exact".
[[nodiscard]] std::string_view name_of(BlendDeltas deltas) noexcept;

struct BlendError {
  struct Weight {
    std::size_t target = 0;
    double weight = 0;
  };
  BlendDeltas deltas = BlendDeltas::kFile;
  /// The errors of one kind of deltas. In max_at, `segment` is the number of the weight vector and `element` is the
  /// output. `count` is equal for all kinds: the number of samples whose geometry has a normal. `missing` counts the
  /// samples whose rendered normal is zero, infinite or NaN; the error of such a sample is 180 degrees.
  Quality quality;
  std::vector<Weight> worst_weights;           ///< the active targets at the largest error
  std::optional<std::size_t> worst_primitive;  ///< the primitive with the largest error, for a glTF mesh
  std::size_t worst_output = 0;                ///< the vertex (of the primitive), face or corner with the largest error
};

/// The errors for one number of targets that are active at the same time.
struct BlendErrors {
  /// The number of active targets; for an animation, the largest number at any of its weight vectors.
  std::size_t active = 0;
  std::size_t rows = 0;  ///< number of weight vectors
  std::vector<BlendError> deltas;
};

/// A motion, or a mesh of a glTF file, whose deltas are compared.
struct BlendSubject {
  std::optional<std::size_t> mesh;  ///< the number of the mesh in a glTF file
  std::string name;                 ///< name of the mesh; may be empty
  ElementKind kind = ElementKind::kVertices;
  std::size_t vertices = 0, faces = 0;
  std::size_t outputs = 0;           ///< number of normals that can be compared
  std::vector<std::string> targets;  ///< the names of the targets
  std::vector<BlendErrors> errors;
};

struct BlendComparison {
  std::vector<BlendSubject> subjects;
  std::size_t flat = 0;   ///< number of glTF meshes with targets, but without stored normals
  std::size_t still = 0;  ///< number of glTF meshes whose targets do not change normals
};

/// Compares the deltas of blend shapes, which are given as a valid motion of targets. Cost: for each weight vector an
/// evaluation of the deltas, a recomputation of the normals of the mesh, and the angles between both. Errors: kUsage
/// for options beyond their range, more active targets than there are, and a motion that is not blend shapes; those of
/// make_groups() and blend_set_of(); kInvalidInput if there are so many targets that the weight vectors do not fit into
/// memory.
[[nodiscard]] Result<BlendComparison> compare_blends(const Motion& star, const BlendCompareOptions& options = {});

/// Compares the deltas for all meshes of a file that have targets and normals; with options.animation, only for the
/// meshes that this animation drives. Errors: those of compare_blends() for a motion, and those of GltfDocument; kUsage
/// if the animation does not exist or drives none of the meshes, and for random weights of a mesh whose targets are the
/// keyframes of a baked sequence; kInvalidInput if no mesh can be compared.
[[nodiscard]] Result<BlendComparison> compare_blends(const GltfDocument& document,
                                                     const BlendCompareOptions& options = {});

// Compares interpolated normals with keyframes that were left out, which show the real motion.
//
// All other comparisons assume straight motion between two keyframes, and compare normals with the exact normals of
// this motion. For blend shapes and shutters the assumption is true, but a simulation or a capture moves differently
// between its frames. The frames themselves show the difference. All keyframes except every N-th are left out, and
// normals are interpolated between the kept keyframes. These normals are compared with the normals of the keyframes
// that were left out.
//
// Paths      "linear": vertices move straight, and the schemes are those of compare(). "catmull-rom": each vertex
//            moves on cubics through the kept keyframes. Its velocity at a keyframe is that of the parabola through the
//            keyframe and its two neighbours, and at an end of the motion that of the cubic through the nearest four
//            keyframes. Normals are exact on that path. "hermite": cubics with the velocities of the keyframes, if
//            there are any.
// Bend       the bend of the kept keyframes, by bend_of() in motion/paths.h.
// Source     docs/truth.md.

struct TruthOptions {
  std::size_t every = 2;                            ///< N; the keyframes 0, N, 2 N, ... are kept; at least 2
  std::vector<std::string> schemes;                 ///< names of schemes; if empty, the default schemes of compare()
  ElementOptions elements = {ElementKind::kFaces};  ///< the elements whose normals are compared
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// The errors of one way to compute normals between the kept keyframes.
struct TruthRow {
  std::string path;    ///< "linear", "catmull-rom" or "hermite"
  std::string scheme;  ///< the scheme on a linear path; "exact" on a curved one
  /// In max_at, `segment` is the segment between two kept keyframes, `element` is the face or the first vertex or
  /// corner of the element, and t is the local t.
  Quality quality;
};

struct TruthComparison {
  ElementKind kind = ElementKind::kFaces;
  std::size_t vertices = 0, faces = 0, elements = 0;
  std::size_t kept = 0;      ///< number of keyframes that were kept
  std::size_t left_out = 0;  ///< number of keyframes that are compared; those after the last kept keyframe do not count
  double bend = 0;           ///< bend_of() for the kept keyframes; 0 if there are only two
  std::vector<TruthRow> rows;
};

/// Compares schemes on straight paths, and exact normals on curved ones, with the keyframes that were left out. There
/// is a row for each scheme, then a row for "catmull-rom", and a row for "hermite" if keyframes have velocities.
///
/// Errors     kUsage for a motion that is not a sequence (the motion of targets and of animated weights is truly
///            straight), fewer than two kept keyframes, and schemes and elements that compare() refuses.
/// Threads    uses all threads; results are the same for any number of threads.
/// Memory     the control normals of one segment: 72 bytes for each face and element, and the positions that are left
///            out.
/// Precondition: the motion is valid (validate() in motion/motion.h)
[[nodiscard]] Result<TruthComparison> compare_with_truth(const Motion& motion, const TruthOptions& options);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_H_
