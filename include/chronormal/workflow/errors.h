/// Every single error of an audit or a comparison, for plots and heat maps. There is one error for each vertex, face or
/// corner at each sample.
///
///     AuditOptions options;
///     options.keep_errors = true;
///     const ErrorTable& table = audit(document, options).value().errors[0];
///     table.degrees[row * table.columns() + vertex];      // at table.times[row], or table.weights[row]
///
/// Shapes     degrees is (rows, columns): a row for each sample, a column for each face, vertex or corner. NaN means
///            not judged: the vertex does not move, or there is no true normal. A vertex with several normals has their
///            worst error.
/// Units      degrees, seconds, weights.
#ifndef CHRONORMAL_WORKFLOW_ERRORS_H_
#define CHRONORMAL_WORKFLOW_ERRORS_H_

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

// Statistics of an audit: the angles between rendered and true normals, over samples of vertices (workflow/audit.h
// explains which samples are judged).
//
// Units      degrees
// Threads    these are plain values. Adding the same parts in the same order gives the same bits.

/// The limits in degrees between the bins of the histogram of errors: below 0.1, 0.1 to 0.5, ... and from 90 on.
inline constexpr std::array<double, 9> kAuditBinEdges = {0.1, 0.5, 1, 2, 5, 10, 25, 45, 90};
inline constexpr std::size_t kAuditBins = kAuditBinEdges.size() + 1;

/// The layout of the fine bins, MotionError::counts. There is one bin below 2^-10 degrees, and then 128 bins for each
/// doubling of the angle, so that percentiles have an error of at most 0.001 degrees or 0.8 %.
inline constexpr int kAuditLeastExponent = -10, kAuditBinsOfDoubling = 128;
// The number of fine bins of the histogram of errors, which cover angles up to 256 degrees.
inline constexpr std::size_t kAuditFineBins = 1 + 18 * std::size_t{kAuditBinsOfDoubling};

/// A vertex at a moment. All numbers are those of the file, counted from 0.
struct AuditPlace {
  std::optional<std::size_t> mesh, primitive;  ///< the numbers of the mesh and of its primitive in a glTF file
  std::size_t vertex = 0;                      ///< the number of the vertex in the primitive, or in the motion
  std::size_t segment = 0;                     ///< the segment of the subject's motion
  double at = 0;                               ///< the weight of the target, or the time in seconds
};

/// The numbers of errors in the fine bins, each of which is a narrow range of angles. Only bins that are not empty are
/// stored, with 8 bytes each. Most errors of a small mesh are in a few bins, and a file may have thousands of motions,
/// so leaving out empty bins saves memory.
class FineBins {
 public:
  class Bin {
   public:
    constexpr Bin(std::size_t number, std::uint64_t count) noexcept
        : word_(std::uint64_t{number} << kCountBits | count) {}
    [[nodiscard]] constexpr std::size_t number() const noexcept {
      return static_cast<std::size_t>(word_ >> kCountBits);
    }
    [[nodiscard]] constexpr std::size_t count() const noexcept {
      return static_cast<std::size_t>(word_ & ((std::uint64_t{1} << kCountBits) - 1));
    }
    friend bool operator==(const Bin&, const Bin&) = default;

   private:
    std::uint64_t word_;
  };
  static constexpr unsigned kCountBits = 48;
  static constexpr std::uint64_t kMostCount = (std::uint64_t{1} << kCountBits) - 1;

  /// Returns the bins that are not empty, in the order of their numbers.
  [[nodiscard]] std::span<const Bin> filled() const noexcept { return bins_; }
  [[nodiscard]] std::size_t operator[](std::size_t number) const noexcept;

  /// Adds `count` to the count of the bin `number`. Preconditions: number < kAuditFineBins and count <= kMostCount.
  void add(std::size_t number, std::uint64_t count);
  void add(const FineBins& other);
  friend bool operator==(const FineBins&, const FineBins&) = default;

 private:
  std::vector<Bin> bins_;
};

struct MotionError {
  std::size_t judged = 0;  ///< number of samples that were judged
  double sum = 0, sum_of_squares = 0;
  double worst = 0;
  AuditPlace worst_at;  ///< the first sample with the worst error; has no meaning if worst is 0
  std::array<std::size_t, kAuditBins> histogram{};
  FineBins counts;            ///< the counts in the fine bins
  std::size_t no_normal = 0;  ///< number of samples that are not judged, since n(t) is too small to have a direction
  /// The number of judged samples whose rendered normal cannot be lit. The error of such a sample is 180 degrees.
  std::size_t unlit = 0;
  AuditPlace unlit_at;  ///< the first sample that cannot be lit; has no meaning if there are none
  /// The number of samples that are not judged although the float32 positions determine a direction, since n(t) is
  /// small but not zero. faint_worst is their worst error: the angle minus the effect that rounding the positions may
  /// have.
  std::size_t faint = 0;
  double faint_worst = 0;
  AuditPlace faint_at;  ///< the first sample with the worst faint error; has no meaning if faint_worst is 0
  /// The number of samples that are not judged and not faint although the faces around the vertex have an area. The
  /// normals of these faces cancel, so the true normal is unknown.
  std::size_t cancelled = 0;
  AuditPlace cancelled_at;  ///< the first cancelled sample; has no meaning if there are none
  /// The numbers of edges between two vertices whose errors differ by more than 10, 20 and 40 degrees. A picture shows
  /// a fold at such an edge that the surface does not have. Edges of faces, and seams between copies of a point, each
  /// count once at every sample.
  std::array<std::size_t, 3> torn{};
  /// The number of samples at which edges were counted; 0 if none were counted, as in sequences.
  std::size_t samples = 0;
  std::size_t most_torn = 0;  ///< the largest number of edges at one sample whose errors differ by more than 10 degrees
  AuditPlace most_torn_at;    ///< the first sample with this number of edges: mesh, segment and moment

  /// Returns the number of edges whose errors differ by more than 10 degrees, on average over the samples.
  [[nodiscard]] double torn_edges() const noexcept {
    return samples > 0 ? static_cast<double>(torn[0]) / static_cast<double>(samples) : 0;
  }
  [[nodiscard]] double mean() const noexcept { return judged > 0 ? sum / static_cast<double>(judged) : 0; }
  [[nodiscard]] double rms() const noexcept {
    return judged > 0 ? std::sqrt(sum_of_squares / static_cast<double>(judged)) : 0;
  }
  /// Returns the error in degrees that at least `share` of the judged samples do not exceed, with the precision of the
  /// bins. Returns 0 if nothing was judged. Precondition: 0 < share <= 1.
  [[nodiscard]] double percentile(double share) const noexcept;
  /// Returns true if every judged sample can be lit and no error is above `degrees`.
  [[nodiscard]] bool is_within(double degrees) const noexcept { return unlit == 0 && worst <= degrees; }
  /// Returns true if is_within(degrees), if the errors of faint samples are not above `degrees` either, and if no
  /// sample is cancelled.
  [[nodiscard]] bool passes(double degrees) const noexcept {
    return is_within(degrees) && faint_worst <= degrees && cancelled == 0;
  }
  void add(double degrees, const AuditPlace& place);
  void add_unlit(const AuditPlace& place);
  void add(const MotionError& other);
};

/// The error of skinning: the angles between true normals as a skin transforms them and the normals of the skinned
/// surface, over samples of vertices. No morph target can correct this error.
struct SkinningError {
  std::size_t judged = 0;  ///< number of samples
  double sum = 0, worst = 0;
  AuditPlace worst_at;  ///< the first sample with the worst error; has no meaning if worst is 0

  [[nodiscard]] double mean() const noexcept { return judged > 0 ? sum / static_cast<double>(judged) : 0; }
  void add(double degrees, const AuditPlace& place) noexcept { add({1, degrees, degrees, place}); }
  void add(const SkinningError& other) noexcept {
    judged += other.judged;
    sum += other.sum;
    if (!(other.worst > worst)) return;
    worst = other.worst;
    worst_at = other.worst_at;
  }
};

/// The respects in which one audit is worse than an earlier one: more samples cannot be lit (`unlit`), the mean or the
/// worst error increased by more than rounding to float32 explains, or more edges are torn. If the two audits are
/// exchanged, the result has the respects in which the later audit is better.
struct WorseRespects {
  bool unlit = false, mean = false, worst = false, torn = false;

  [[nodiscard]] bool any() const noexcept { return unlit || mean || worst || torn; }
};
[[nodiscard]] WorseRespects find_worse(const MotionError& after, const MotionError& before) noexcept;
/// Returns true if the audit `after` is worse than the audit `before` in any respect.
[[nodiscard]] inline bool is_worse(const MotionError& after, const MotionError& before) noexcept {
  return find_worse(after, before).any();
}

struct ErrorTable {
  std::string name;  ///< "mesh0" for a glTF file, or the name of the scheme; empty if there is only one table
  ElementKind kind = ElementKind::kVertices;
  Topology topology;             ///< the faces of the mesh
  std::vector<float> positions;  ///< (V, 3), at the first keyframe, or in the base
  /// For a glTF mesh, the primitive of each vertex, and the number of the vertex in that primitive, (V) each; otherwise
  /// empty.
  std::vector<std::int64_t> primitives = {}, vertices = {};

  /// For each row, the subject (Audit::subjects) or the segment of the motion, and the moment, which is a time or a
  /// weight. If the moment is a time, the weight of the row is NaN, and vice versa.
  std::vector<std::int64_t> subjects = {};
  std::vector<double> times = {}, weights = {};
  std::vector<float> degrees = {};  ///< the errors in degrees, (rows, columns)

  [[nodiscard]] std::size_t rows() const noexcept { return subjects.size(); }
  [[nodiscard]] std::size_t columns() const noexcept;
  /// Returns the worst error of each column in degrees; NaN if nothing was judged in a column.
  [[nodiscard]] std::vector<float> worst() const;
};

/// The largest number of bytes that the errors of a table may take.
inline constexpr std::size_t kMostErrorBytes = std::size_t{1} << 30;

/// Returns the errors that write_errors() would return for a path, so that a caller can find out before a long
/// computation. Errors: kUsage for an extension other than .npz and .ply; those of check_output().
[[nodiscard]] Status check_errors_output(const std::string& path, bool force);

/// Writes tables as a file atomically:
///
///     .npz    errors (rows, columns) float32, subjects (rows) int64, times and weights (rows) float64 if there are
///             any, and for glTF primitives and vertices (columns) int64. If tables have names, so do their arrays:
///             mesh0_errors, linear_times
///     .ply    the mesh with the worst error, as it is at the first keyframe, with a property float quality for each
///             vertex or face: the worst error of all samples, 0 if nothing was judged. MeshLab and Blender show
///             this property
///
/// Errors: those of check_errors_output() and write_output(); kInvalidInput if there is no table; kUsage in PLY for
/// corners, and for tables of several schemes, of which only one can be shown.
[[nodiscard]] Status write_errors(std::span<const ErrorTable> tables, const std::string& path, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_ERRORS_H_
