/// The unit normals of a mesh that deforms: between two arrays of positions, or at weights of blend shapes.
///
/// MeshNormals is the main interface of the library for engines and bindings. It has the topology, the corners that
/// share a normal, the weighting of faces and the accuracy. It takes a segment (positions at t = 0 and at t = 1) or a
/// set of blend shapes, prepares data for fast evaluation, and then writes normals as often as needed:
///
///     MeshNormals normals = MeshNormals::make(topology, {.tolerance = kCompactTolerance}).value();
///     if (const Status status = normals.set_segment(from, to); !status) return status;
///     normals.unit_normals(t, result);                         // all normals on this thread, or
///     normals.unit_normals(t, result, {first, count});         // a range, on any thread of your job system
///
///     if (const Status status = normals.set_targets(std::move(blend_set)); !status) return status;
///     normals.set_weights(weights);                            // once per frame
///     normals.unit_normals(result, {first, count});            // on any thread
///
/// Outputs    the faces, vertices or corners of the topology, in its order. A result has a place for every output; a
///            call for a range of outputs writes only that range. Outputs of the same element, such as copies of a
///            vertex along a seam, get the same bits, and every division into ranges gives the same bits as one call.
/// Sharing    is decided by the first segment or set of targets, or by the motion given to make(), and then fixed:
///            vertices that coincide at both ends (in all keyframes; in the base and at full weight of each target)
///            share a normal. Hard edges are determined at t = 0.
/// Accuracy   the direction of every normal is within `tolerance` of exact arithmetic on the positions, by a proven
///            bound. For blend shapes it is within 1e-6 rad, unless blends_in_float32 is set. Weightings other than
///            area add fit_bound().
/// Degenerate (0, 0, 0) if there is no normal; calls return the number of such results, usually 0. If n(t) is zero only
///            at this t, the limit is written (Direction in control_normals.h). t outside [0, 1] is moved to the nearer
///            end; if t is NaN every normal is (0, 0, 0).
/// Cost       Preparing a segment costs about as much as recomputing its normals once, and an evaluation a thirtieth of
///            that (docs/benchmarks.md, "Frames of a segment"). If two ranges share elements, these are evaluated
///            twice.
/// Memory     const functions use at most 48 KiB of the stack. set_segment() reuses the memory of the previous segment.
/// Ownership  positions are read while set_segment() runs, or from begin_segment() to finish_segment(), and are not
///            kept.
/// Threads    const functions may run at the same time on the same object. Functions that are noexcept do not allocate.
///            prepare() may run at the same time as const functions; other functions need exclusive access.
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
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"

namespace chronormal {

struct MeshNormalsOptions {
  ElementOptions elements = {};
  Weighting weighting = Weighting::kArea;  ///< must be kArea for faces and for blend shapes
  /// The largest error of a normal in radians, for segments; at least kExactTolerance.
  double tolerance = kExactTolerance;
  Threads threads = Threads::kOne;  ///< the threads that prepare segments
  /// The most bytes that blend shapes may take beside the set itself. Only memory that is needed in any case may take
  /// more. Normals are faster if all terms of the quadratic form in the weights fit; normals whose terms do not fit are
  /// computed from blended positions.
  std::size_t most_blend_bytes = std::size_t{1} << 30;
  /// True to use float32 if all positions of blend shapes are blended, like FloatRecompute. Float32 takes about half as
  /// long, but guarantees no accuracy of the normals. A position has an error of a unit in the last place, which turns
  /// a normal by the ratio of that unit to the length of an edge. The accuracy is enough for shading. The option has no
  /// effect if some normal belongs to a ring of more than 64 points.
  bool blends_in_float32 = false;
};

/// A range that stands for all outputs, however many there are.
inline constexpr IndexRange kAllOutputs = {0, ~std::size_t{0}};

/// The formats of control normals in vertex buffers, for shaders. A shader computes (1-t)^2 n0 + 2t(1-t) m + t^2 n1 and
/// normalises the result. Only kFloat32 keeps the lengths; the other formats divide the three vectors of an output by
/// their largest component.
enum class ControlFormat {
  kFloat32,  ///< 36 bytes: n0, m, n1 as x y z
  kSnorm16,  ///< 20 bytes: n0, m, n1 as x y z, then 2 bytes of 0. The error of a component is at most 1.6e-5
  /// 12 bytes: one 32-bit word for each of x, y and z. In a word, n0 has the lowest 11 bits, n1 the next 11, and m the
  /// highest 10. The error of a component is at most 1e-3.
  kSnorm11,
};

/// Returns the number of bytes that an output takes in a format: 36, 20 or 12.
[[nodiscard]] std::size_t bytes_of(ControlFormat format) noexcept;

class MeshNormals {
 public:
  /// Makes an object without positions. Errors: kInvalidInput for a mesh without faces; kUsage for faces with another
  /// weighting than area.
  [[nodiscard]] static Result<MeshNormals> make(Topology topology, const MeshNormalsOptions& options = {});
  /// Makes an object for the segments of a motion, whose keyframes together decide which vertices share a normal. The
  /// motion must be valid, or at rest. Errors: those of make() for a topology, and those of make_groups().
  [[nodiscard]] static Result<MeshNormals> make(const Motion& motion, const MeshNormalsOptions& options = {});

  /// Makes another object for the same mesh, for example one for each of many characters. The new object has no
  /// positions or targets yet, and shares this object's memory of the topology and the groups of corners. Both objects
  /// may be used at the same time.
  [[nodiscard]] MeshNormals another() const;

  MeshNormals(MeshNormals&&) noexcept;
  MeshNormals& operator=(MeshNormals&&) noexcept;
  ~MeshNormals();

  /// Prepares a segment from the positions at t = 0 and t = 1, and reuses the memory of the previous segment. Errors,
  /// after which nothing has changed: kInvalidInput if the number of positions differs from the number of vertices, or
  /// if a position is not finite (the place is "keyframe 0, vertex V"); for the first segment also those of
  /// make_groups().
  [[nodiscard]] Status set_segment(VectorView<const float> from, VectorView<const float> to);
  /// Prepares a segment of a motion of the same mesh. Uses the residuals of positions, which are the remainders of
  /// their rounding to float32. Errors: those of set_segment() for positions.
  [[nodiscard]] Status set_segment(const Segment& segment);

  /// Prepares the next segment step by step, while the current one is evaluated. begin_segment() does no work yet; its
  /// errors are those of set_segment(). prepare() does a share of the work, from 0 to 1, on the calling thread, and
  /// returns true when all is done. finish_segment() does the remaining work and makes the next segment current. The
  /// results have the same bits as with set_segment(). (Fits for weightings other than area are computed by
  /// finish_segment().)
  [[nodiscard]] Status begin_segment(VectorView<const float> from, VectorView<const float> to);
  bool prepare(double share);
  void finish_segment();

  /// Writes the unit normals at t. Returns the number of (0, 0, 0) written. Preconditions: a segment is set; result has
  /// size() elements.
  std::size_t unit_normals(const LocalTime& t, VectorView<float> result,
                           IndexRange outputs = kAllOutputs) const noexcept;
  /// Writes the unit normals at t, encoded in four bytes each (normals/normal_curves.h). A zero normal is written as 0,
  /// which Octahedral decodes as (0, 0, 1).
  std::size_t unit_normals(const LocalTime& t, std::span<Octahedral> result,
                           IndexRange outputs = kAllOutputs) const noexcept;
  std::size_t unit_normals(const LocalTime& t, std::span<Rgb10A2> result,
                           IndexRange outputs = kAllOutputs) const noexcept;
  /// Writes the unit normals at many t, in one pass over the prepared data. results[k] gets the normals at times[k], so
  /// the two lists must be of the same length.
  std::size_t unit_normals(std::span<const double> times, std::span<const VectorView<float>> results,
                           IndexRange outputs = kAllOutputs) const noexcept;
  /// Writes the unit normals at t with the given threads. With Threads::kAll this function uses the thread pool of
  /// parallel.h, which may allocate.
  std::size_t unit_normals(const LocalTime& t, VectorView<float> result, Threads threads) const;

  /// Writes the control normals of a segment for every output, one output after the other. The tolerance of this object
  /// must be kExactTolerance. Errors: kUsage for another tolerance, or if `bytes` does not have size() *
  /// bytes_of(format) elements.
  [[nodiscard]] Status fill_vertex_buffer(ControlFormat format, std::span<std::byte> bytes) const;

  /// Prepares a set of blend shapes, with all weights 0. Errors: kUsage for a weighting other than area; kInvalidInput
  /// for a set of another mesh; those of validate() for a set. The first set can also give those of make_groups().
  [[nodiscard]] Status set_targets(BlendSet set);
  /// Sets the weights, chooses the cheapest way to compute normals at these weights, and blends positions if this way
  /// needs them. The choice is a pure function of the set, the weights and the options. The accuracy is the same at
  /// all weights, also at negative weights and above 1. If n(w) is below its own rounding error, the normal is
  /// (0, 0, 0). Weights that are not finite, or so large that n(w) overflows, give (0, 0, 0) at least for the elements
  /// that they affect. With one thread this function does not allocate or throw. Preconditions: targets are set, and
  /// there is a weight for each.
  void set_weights(std::span<const double> weights, Threads threads = Threads::kOne);
  /// Write the unit normals at the current weights, and return the number of (0, 0, 0) written. Precondition: result
  /// has size() elements.
  std::size_t unit_normals(VectorView<float> result, IndexRange outputs = kAllOutputs) const noexcept;
  std::size_t unit_normals(std::span<Octahedral> result, IndexRange outputs = kAllOutputs) const noexcept;
  std::size_t unit_normals(std::span<Rgb10A2> result, IndexRange outputs = kAllOutputs) const noexcept;
  /// Sets the weights and writes all normals in one call. Threads::kAll uses the thread pool of parallel.h.
  std::size_t unit_normals(std::span<const double> weights, VectorView<float> result, Threads threads = Threads::kOne);

  /// Returns the number of outputs: faces, vertices or corners.
  [[nodiscard]] std::size_t size() const noexcept;
  /// Returns the number of different normals, of which several outputs may share one. The number is known once the
  /// first segment or set of targets is given. For faces the number is size().
  [[nodiscard]] std::size_t element_count() const noexcept;
  [[nodiscard]] const Topology& topology() const noexcept;
  [[nodiscard]] const MeshNormalsOptions& options() const noexcept;
  /// Returns a bound of the error that a weighting other than area adds: the largest angle in radians, over all
  /// elements, between the fitted curve and the exact weighted normal. The bound is 0 for area.
  [[nodiscard]] double fit_bound() const noexcept;
  /// Returns the memory in bytes that the segment and the targets take.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;
  explicit MeshNormals(std::unique_ptr<Parts> parts) noexcept;

  std::unique_ptr<Parts> parts_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_MESH_NORMALS_H_
