/// Compares every scheme with the exact normals of any motion, as the paper's Table 1 does, and the deltas of blend
/// shapes with theirs.
///
/// A viewer that adds one normal delta per target shows normalize(N + sum_i w_i D_i); the true normal is a quadratic
/// form in the weights (docs/theory.md, section 14). Compared are the deltas of a glTF file, end-point deltas (right
/// for each target alone at weight 1), the best deltas by least squares (analysis/quality/blend_quality.h), and the
/// exact normals of BlendNormals, whose errors are those of rounding. The truth is made of cross products of blended
/// positions in double.
///
/// Weights    random, from 0 to 1, for 1, 2, 4, 8, 16 targets at once and for all; or the weights of an animation.
///            Least squares use as many other random weights of the same kind, or 16 for each target if that is more,
///            so that they cannot know the weights that they are judged by; for an animation they use the very ones.
/// Compared   normals that a target of weight other than 0 moves: normals with a face that it moves, and normals that a
///            file moves by a delta. There is one for each different normal; for a glTF file, one for each vertex.
/// glTF       Each mesh on its own, with elements by its stored normals. Where an author gave base normals of his own,
///            the truth is turned as these are, as in an audit (workflow/gltf_shading.h). Flat primitives are right in
///            viewers and are left out. Targets that a bake added get products of weights.
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

/// Names the rows of the paper's table, and ours; for elements other than faces without the schemes that look at faces.
[[nodiscard]] std::vector<std::string> default_schemes(ElementKind kind = ElementKind::kFaces);

/// Selects how the samples of a segment are visited (section 3 of the paper).
enum class Access {
  kRandom,      ///< each on its own
  kSequential,  ///< each from the one before, by the schemes that can; the others as in kRandom
};

/// Bounds of the largest error of a scheme at any time of a motion (analysis/certify.h). No sample is above the upper
/// one.
struct CertifiedError {
  double lower = 0;  ///< radians
  double upper = 0;  ///< radians; pi where no better one could be shown
  /// The first piece of a segment, from local t to local t, on which the error may be as large as the upper bound.
  std::size_t segment = 0, element = 0;
  double from = 0, to = 1;
  std::size_t unbounded = 0;  ///< (element, segment) pairs for which no bound below half a turn could be shown
};

struct CompareOptions {
  std::vector<std::string> schemes;  ///< names, in the order of the rows; empty: default_schemes()
  std::size_t samples = 21;          ///< per segment, ends included; 2 or more
  Access access = Access::kRandom;
  /// Is told from the calling thread how much of the work is done; may be empty.
  std::function<void(std::size_t done, std::size_t total)> progress;
  ElementOptions elements = {};  ///< of which normals
  /// The weighting of faces in the normals of vertices and corners. With another weighting than area the normals are no
  /// quadratics: schemes are prepared from the exact weighted normals, and `polynomial` is the quadratic through three
  /// of them. `quaternion:optimal` and `linear:scaled` look for what is best for that quadratic.
  Weighting weighting = Weighting::kArea;
  bool keep_errors = false;   ///< every single one, in Comparison::errors
  bool keep_samples = false;  ///< keep the errors of each sample together, in SchemeComparison::samples
  bool certify = false;       ///< bound the largest error at any time, in SchemeComparison::certified
  /// Degrees, 0 or more: certify, and find the cheapest scheme whose error is never above, in Comparison::cheapest.
  std::optional<double> tolerance = {};
};

/// One scheme on one motion. quality.max_at names a face, or the first vertex or corner of the element. Costs are per
/// element; times are those of one thread among all that work: the median over segments of the median over blocks of up
/// to 1,024 elements that stay in cache (on a smaller mesh, the calls themselves take most of the time).
struct SchemeComparison {
  std::string scheme;
  Quality quality;
  std::optional<double> relative_to_linear;      ///< sum / sum of linear; nothing where linear errs by rounding only
  std::size_t fallbacks = 0;                     ///< (element, segment) pairs prepared with a stated fallback
  std::size_t flagged = 0;                       ///< (element, segment) pairs evaluated in double
  bool sequential = false;                       ///< the scheme was played step by step
  double prepare_ns = 0;                         ///< control normals included, where the scheme uses them
  double evaluate_ns = 0;                        ///< per sample
  double bytes = 0;                              ///< read by an evaluation
  OperationCounts operations;                    ///< of the access that was measured
  std::vector<Quality> samples = {};             ///< with keep_samples: of each sample, segment after segment
  std::optional<CertifiedError> certified = {};  ///< where it was asked for
};

struct Comparison {
  ElementKind kind = ElementKind::kFaces;
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t elements = 0;  ///< compared elements: faces, or different normals of vertices or corners
  std::size_t segments = 0;
  std::size_t samples = 0;
  std::vector<SchemeComparison> schemes;
  MotionKind motion = MotionKind::kSequence;  ///< the kind of the segments
  std::vector<ErrorTable> errors = {};        ///< with keep_errors: one for each scheme that was asked for
  std::optional<double> tolerance = {};       ///< degrees, where it was given
  std::optional<std::size_t> cheapest = {};   ///< of those judged: within the tolerance for certain; nothing: none is
  Weighting weighting = Weighting::kArea;     ///< of vertices and corners
  std::array<double, 2> span = {};            ///< the times of the first and the last keyframe
  std::optional<CutPath> cut = {};            ///< of curves, set by who has cut them: for reports
};

/// Compares schemes on the faces of a motion, or on its vertices or corners, over all its segments.
///
/// Errors     kUsage for a scheme that does not exist or needs faces, fewer than 2 samples, a wrong crease angle or
///            tolerance, another weighting than area with faces or certificates, certificates of sequential access,
///            errors to keep that take more than kMostErrorBytes.
/// Threads    uses all (core/parallel.h); everything but the times is the same on any number of them.
/// Memory     a few MB beyond the motion, and 8 bytes per scheme and segment for the times; for
///            vertices and corners also their groups and 72 bytes for each face and element.
/// Cost       segments x faces x samples x schemes evaluations, plus an exact normal and an arc tangent for each.
/// Precondition: the motion is valid (validate() in motion/motion.h)
[[nodiscard]] Result<Comparison> compare(const Motion& motion, const CompareOptions& options);
/// Compares them for a stream, of which a few segments are held at a time: as many as have a few thousand elements for
/// each thread, but at least one. Errors: also those of the stream.
[[nodiscard]] Result<Comparison> compare(MotionStream& stream, const CompareOptions& options);

/// Estimates the cost of an evaluation, to put schemes in order: 1 for each byte that is read, for an addition and for
/// a multiplication, 4 for a quotient or a root, 20 for a sine with its cosine.
[[nodiscard]] double evaluation_cost(const SchemeComparison& scheme) noexcept;

/// The cheapest scheme whose error is certainly never above a tolerance: the one of the least evaluation_cost().
/// Candidates are options.schemes, or all schemes that have no parameter and fit the elements.
struct Choice {
  std::optional<std::string> scheme;  ///< nothing: none is within the tolerance
  Comparison comparison;              ///< of all that were looked at, at two samples of each segment
};
/// Finds the cheapest scheme; tolerance: degrees, 0 or more. Errors: those of compare().
[[nodiscard]] Result<Choice> choose(const Motion& motion, double tolerance, CompareOptions options = {});

inline constexpr std::size_t kMostBlendRows = 10000;

struct BlendCompareOptions {
  std::size_t rows = 100;  ///< weight vectors for each number of active targets; 1 to kMostBlendRows
  std::size_t active = 0;  ///< targets at once; 0: 1, 2, 4, 8, 16 and all, as far as there are
  std::uint64_t seed = 1;  ///< of random weights: the same ones on every system
  ElementOptions elements = {ElementKind::kVertices};  ///< of a motion; those of a glTF file are as it stores them
  std::string animation = {};  ///< of a glTF file, by name or index: up to `rows` of its weight vectors, evenly
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

enum class BlendDeltas { kFile, kEndPoint, kLeastSquares, kExact };

/// Returns "file", "end point", "least squares" or "exact".
[[nodiscard]] std::string_view name_of(BlendDeltas deltas) noexcept;

struct BlendError {
  struct Weight {
    std::size_t target = 0;
    double weight = 0;
  };
  BlendDeltas deltas = BlendDeltas::kFile;
  /// max_at has the weight vector as segment and the output as element. count is the same for all deltas: every sample
  /// whose geometry has a normal. missing counts samples among them that show zero, infinity or NaN, which count as 180
  /// degrees.
  Quality quality;
  std::vector<Weight> worst_weights;           ///< where the largest error is: the active targets
  std::optional<std::size_t> worst_primitive;  ///< of a glTF mesh
  std::size_t worst_output = 0;                ///< the vertex (of the primitive), face or corner that shows it
};

/// The errors at one number of active targets.
struct BlendErrors {
  std::size_t active = 0;  ///< of targets at once; of an animation, at most
  std::size_t rows = 0;    ///< weight vectors
  std::vector<BlendError> deltas;
};

/// One motion, or one mesh of a glTF file.
struct BlendSubject {
  std::optional<std::size_t> mesh;  ///< of a glTF file
  std::string name;                 ///< of the mesh; may be empty
  ElementKind kind = ElementKind::kVertices;
  std::size_t vertices = 0, faces = 0;
  std::size_t outputs = 0;           ///< normals that can be compared
  std::vector<std::string> targets;  ///< names
  std::vector<BlendErrors> errors;
};

struct BlendComparison {
  std::vector<BlendSubject> subjects;
  std::size_t flat = 0;   ///< glTF meshes with targets, but without a stored normal
  std::size_t still = 0;  ///< glTF meshes of which no target moves a normal
};

/// Compares the deltas of blend shapes, given as a valid star of segments. Cost: for each row an evaluation, a
/// recomputation of the mesh, and the angles. Errors: kUsage for options beyond their range, more active targets than
/// there are, and a motion that is no star; those of make_groups() and blend_set_of(); kInvalidInput if there are more
/// targets than memory for rows of their weights.
[[nodiscard]] Result<BlendComparison> compare_blends(const Motion& star, const BlendCompareOptions& options = {});

/// Compares them for all meshes of a file that have targets and normals; with options.animation, for the meshes that it
/// drives. Errors: those above, and those of GltfDocument; kUsage if an animation is not there or drives none of them,
/// and for random weights of a mesh whose targets are the keyframes of a baked sequence; kInvalidInput if no mesh can
/// be compared.
[[nodiscard]] Result<BlendComparison> compare_blends(const GltfDocument& document,
                                                     const BlendCompareOptions& options = {});

// Compares interpolated normals with keyframes that were left out: with what a sampled motion really did.
//
// Everything else here takes the motion between two keyframes to be straight, and asks how near the normals are to the
// normals of that motion. For blend shapes and a shutter that is the truth. A simulation or a capture did something
// else between its frames, and the frames themselves tell what: all but every N-th keyframe are left out, normals are
// interpolated between the kept ones, and compared with the normals of the ones that were left out.
//
// Paths      "linear": vertices move straight, and the schemes are those of compare(). "catmull-rom": each vertex
//            moves on cubics through the kept keyframes. Its velocity at each of them is that of the parabola through
//            it and its two neighbours, and at an end of the motion that of the cubic through the nearest four. Its
//            normals are exact on that path. "hermite": the same with the velocities of the keyframes, where they have
//            them.
// Bend       that of the kept keyframes, by bend_of() in motion/paths.h.
// Source     docs/truth.md.

struct TruthOptions {
  std::size_t every = 2;             ///< keyframes 0, N, 2 N, ... are kept; 2 or more
  std::vector<std::string> schemes;  ///< names; empty: those that compare() takes
  ElementOptions elements = {};      ///< of which normals
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// One way to make normals between the kept keyframes.
struct TruthRow {
  std::string path;    ///< "linear", "catmull-rom" or "hermite"
  std::string scheme;  ///< of a linear path; "exact" on a curved one
  Quality quality;     ///< max_at: the kept segment, the face or the first vertex or corner, and the local t
};

struct TruthComparison {
  ElementKind kind = ElementKind::kFaces;
  std::size_t vertices = 0, faces = 0, elements = 0;
  std::size_t kept = 0;      ///< keyframes
  std::size_t left_out = 0;  ///< keyframes that the rows are held against; those behind the last one kept are neither
  double bend = 0;           ///< of the kept keyframes; 0 where there are two
  std::vector<TruthRow> rows;
};

/// Compares schemes on straight paths, and exact normals on curved ones, with the keyframes that were left out. There
/// is a row for each scheme, then one for "catmull-rom", and one for "hermite" where keyframes have velocities.
///
/// Errors     kUsage for a motion that is no sequence (targets and animations of weights are straight: there is no
///            other truth), fewer than two kept keyframes, and what compare() refuses in schemes and elements.
/// Threads    uses all; the same on any number of them.
/// Memory     the control normals of one segment: 72 bytes for each face and element, and the positions that are left
///            out.
/// Precondition: the motion is valid (validate() in motion/motion.h)
[[nodiscard]] Result<TruthComparison> compare_with_truth(const Motion& motion, const TruthOptions& options);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_H_
