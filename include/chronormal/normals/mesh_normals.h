/// The unit normals of a mesh that deforms: between two arrays of positions, or at weights of blend shapes.
///
/// MeshNormals is the library's face for engines and bindings. It knows the topology, who shares a normal, how faces
/// are weighted and how accurate normals must be; it is given a segment (positions at t = 0 and at t = 1) or a set of
/// blend shapes, prepares what makes an evaluation cheap, and then writes normals as often as it is asked to:
///
///     MeshNormals normals = MeshNormals::make(topology, {.tolerance = kCompactTolerance}).value();
///     if (const Status status = normals.set_segment(from, to); !status) return status;
///     normals.unit_normals(t, result);                         // all of them on this thread, or
///     normals.unit_normals(t, result, {first, count});         // a range, on any thread of your job system
///
///     if (const Status status = normals.set_targets(std::move(blend_set)); !status) return status;
///     normals.set_weights(weights);                            // once for a frame
///     normals.unit_normals(result, {first, count});            // on any thread
///
/// Outputs    the faces, vertices or corners of the topology, in its order. A result has a place for every output; a
///            call for a range of outputs writes that range and nothing else. Outputs that show one element, such as
///            the copies of a vertex along a seam, get the same bits, and every division into ranges gives the bits of
///            one call.
/// Sharing    is decided by the first segment or set of targets, or by the motion that make() was given, and stays:
///            vertices that are at one point at both ends (in all keyframes; in the base and at full weight of each
///            target) are one. Hard edges are those of t = 0.
/// Accuracy   the direction of every normal is within `tolerance` of exact arithmetic on the positions, by a bound; at
///            weights within 1e-6 rad (blend_normals.h). Weightings other than area add fit_bound().
/// Degenerate (0, 0, 0) where there is no normal; calls return how many of those they wrote, usually 0. Where n(t) is
///            zero at one t the limit is written (Direction in control_normals.h). t outside [0, 1] is moved to the
///            nearer end; where t is NaN every normal is (0, 0, 0).
/// Cost       Preparing a segment costs about as much as recomputing its normals once, an evaluation a thirtieth of
///            that (docs/benchmarks.md, "Frames of a segment"). Ranges of outputs that share elements evaluate what is
///            at their rims twice.
/// Memory     const functions use 48 KiB of the stack at most. set_segment() uses the memory of the segment
///            before again.
/// Ownership  positions are read while set_segment() runs, or from begin_segment() to finish_segment(), and are not
///            kept.
/// Threads    const functions may run at the same time, on one object. What is noexcept does not allocate either.
///            prepare() may run beside them; other functions need the object for themselves.
#ifndef CHRONORMAL_NORMALS_MESH_NORMALS_H_
#define CHRONORMAL_NORMALS_MESH_NORMALS_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

#include "chronormal/core/parallel.h"
#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/blend_normals.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"

namespace chronormal {

/// The number of evaluations of a segment from which on preparing it is cheaper than recomputing its normals within
/// 1e-6 rad. It was measured: curves are ahead from the first or the second frame on, on all meshes of
/// docs/benchmarks.md, "Frames of a segment".
inline constexpr double kCurvesFrom = 2;

struct MeshNormalsOptions {
  ElementOptions elements = {ElementKind::kVertices};
  Weighting weighting = Weighting::kArea;  ///< kArea for faces, and for blend shapes
  double tolerance = kExactTolerance;      ///< radians, of segments: at least kExactTolerance
  Threads threads = Threads::kOne;         ///< to prepare on
};

/// A range of all outputs, however many there are.
inline constexpr IndexRange kAllOutputs = {0, ~std::size_t{0}};

/// Control normals in vertex buffers, for shaders: n(t) is (1-t)^2 n0 + 2t(1-t) m + t^2 n1, to be normalised. Only
/// float32 keeps lengths; in the others the three are divided by their largest component.
enum class ControlFormat {
  kFloat32,  ///< 36 bytes: n0, m, n1 as x y z
  kSnorm16,  ///< 20 bytes: likewise, and 2 bytes of 0. The error of a component is at most 1.6e-5
  kSnorm11,  ///< 12 bytes: a word each for x, y, z; n0 in its lowest 11 bits, then n1 in 11, m in 10: errors up to 1e-3
};

/// Returns the bytes of one output: 36, 20 or 12.
[[nodiscard]] std::size_t bytes_of(ControlFormat format) noexcept;

class MeshNormals {
 public:
  /// Makes an object that knows no positions yet. Errors: kInvalidInput for a mesh without faces; kUsage for faces with
  /// another weighting than area.
  [[nodiscard]] static Result<MeshNormals> make(Topology topology, const MeshNormalsOptions& options = {});
  /// Makes an object for the segments of a motion, all of whose keyframes say which vertices are one. The motion must
  /// be valid, or stand still. Errors: also those of make_groups().
  [[nodiscard]] static Result<MeshNormals> make(const Motion& motion, const MeshNormalsOptions& options = {});

  /// Another object of the same mesh, as for each of many characters: without positions and targets, with the topology
  /// and, as soon as it is known, who shares a normal in the memory of this one, at no cost. The two may be used at the
  /// same time.
  [[nodiscard]] MeshNormals another() const;

  MeshNormals(MeshNormals&&) noexcept;
  MeshNormals& operator=(MeshNormals&&) noexcept;
  ~MeshNormals();

  /// Prepares a segment, in the memory of the one before. Errors, after which everything is as it was: kInvalidInput
  /// for another number of positions than there are vertices, or one that is not finite (the place is "keyframe 0,
  /// vertex V"); at first also those of make_groups().
  [[nodiscard]] Status set_segment(VectorView<const float> from, VectorView<const float> to);
  /// Prepares a segment of a motion of the same mesh; its residuals count too.
  [[nodiscard]] Status set_segment(const Segment& segment);

  /// Prepares the next segment a little at a time, while the present one is evaluated. begin_segment() does no work
  /// yet; its errors are those of set_segment(). prepare() does a share of all the work, 0 to 1, on the thread that
  /// calls it, and returns whether all is done. finish_segment() does what is left and makes the next segment the
  /// present one. The bits are those of set_segment(). (Fits of other weightings than area are made by
  /// finish_segment().)
  [[nodiscard]] Status begin_segment(VectorView<const float> from, VectorView<const float> to);
  bool prepare(double share);
  void finish_segment();

  /// Writes the unit normals at t. Returns the number of (0, 0, 0) written. A segment must be set.
  /// result must have size() elements
  std::size_t unit_normals(const LocalTime& t, VectorView<float> result,
                           IndexRange outputs = kAllOutputs) const noexcept;
  /// Writes them in four bytes each; normals/normal_curves.h says what becomes of (0, 0, 0).
  std::size_t unit_normals(const LocalTime& t, std::span<Octahedral> result,
                           IndexRange outputs = kAllOutputs) const noexcept;
  std::size_t unit_normals(const LocalTime& t, std::span<Rgb10A2> result,
                           IndexRange outputs = kAllOutputs) const noexcept;
  /// Writes them at many t, in one pass over what is prepared. results[k] is for times[k], and there are as many.
  std::size_t unit_normals(std::span<const double> times, std::span<const VectorView<float>> results,
                           IndexRange outputs = kAllOutputs) const noexcept;
  /// Writes them on all cores, by the pool of parallel.h, which may allocate.
  std::size_t unit_normals(const LocalTime& t, VectorView<float> result, Threads threads) const;

  /// Writes the control normals of a segment for every output, one after the other. The tolerance must be
  /// kExactTolerance. Errors: kUsage for another, or where bytes is not of size() * bytes_of(format).
  [[nodiscard]] Status fill_vertex_buffer(ControlFormat format, std::span<std::byte> bytes) const;

  /// Prepares blend shapes, at weights of 0. Errors: kUsage for another weighting than area; kInvalidInput for a set of
  /// another mesh; those of validate() for a set, and at first of make_groups().
  [[nodiscard]] Status set_targets(BlendSet set, const BlendNormalsOptions& options = {});
  /// Chooses how the normals at these weights are made, and moves positions if that is needed. On one thread it does
  /// not allocate or throw. Targets must be set, and weights must have one for each
  BlendChoice set_weights(std::span<const double> weights, Threads threads = Threads::kOne);
  /// Writes the unit normals at the weights that are set; returns the number of (0, 0, 0).
  /// result must have size() elements
  std::size_t unit_normals(VectorView<float> result, IndexRange outputs = kAllOutputs) const noexcept;
  std::size_t unit_normals(std::span<Octahedral> result, IndexRange outputs = kAllOutputs) const noexcept;
  std::size_t unit_normals(std::span<Rgb10A2> result, IndexRange outputs = kAllOutputs) const noexcept;
  /// Sets weights and writes all normals, for callers with one thread, or with those of parallel.h.
  std::size_t unit_normals(std::span<const double> weights, VectorView<float> result, Threads threads = Threads::kOne);

  /// The number of outputs: faces, vertices or corners.
  [[nodiscard]] std::size_t size() const noexcept;
  /// The number of different normals, as soon as it is decided who shares them; size() for faces.
  [[nodiscard]] std::size_t element_count() const noexcept;
  [[nodiscard]] const Topology& topology() const noexcept;
  [[nodiscard]] const MeshNormalsOptions& options() const noexcept;
  /// Returns the largest angle, in radians, between a fit of the weighting and the weighted normal, over all elements;
  /// 0 for area.
  [[nodiscard]] double fit_bound() const noexcept;
  /// Returns the bytes that the segment and the targets take.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;
  explicit MeshNormals(std::unique_ptr<Parts> parts) noexcept;

  std::unique_ptr<Parts> parts_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_MESH_NORMALS_H_
