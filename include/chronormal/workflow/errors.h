/// Every single error of an audit or a comparison: one for each vertex at each sample, for plots and heat maps.
///
///     AuditOptions options;
///     options.keep_errors = true;
///     const ErrorTable& table = audit(document, options).value().errors[0];
///     table.degrees[row * table.columns() + vertex];      // at table.times[row], or table.weights[row]
///
/// Shapes     degrees is (rows, columns): a row for each sample, a column for each face, vertex or corner. NaN where
///            nothing was judged: the vertex does not move, or there is no right normal. A vertex that shows several
///            normals has the worst of them.
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

// The errors that an audit adds up: the angles between shown normals and right ones, over samples of vertices
// (workflow/audit.h says which samples are judged).
//
// Units      degrees
// Threads    these are plain values. Adding the same parts in the same order gives the same bits.

/// The edges of the bins of the histogram: below 0.1, 0.1 to 0.5, ... and from 90 on.
inline constexpr std::array<double, 9> kAuditBinEdges = {0.1, 0.5, 1, 2, 5, 10, 25, 45, 90};
inline constexpr std::size_t kAuditBins = kAuditBinEdges.size() + 1;

/// The bins of MotionError::counts: below 2^-10 degrees, and then 128 to each doubling, so that a percentile is known
/// to 0.001 degrees or to 0.8 %.
inline constexpr int kAuditLeastExponent = -10, kAuditBinsOfDoubling = 128;
inline constexpr std::size_t kAuditFineBins = 1 + 18 * std::size_t{kAuditBinsOfDoubling};  // up to 256 degrees

/// A vertex at a moment, numbered as in the file.
struct AuditPlace {
  std::optional<std::size_t> mesh, primitive;  ///< of a glTF file
  std::size_t vertex = 0;                      ///< of the primitive, or of the motion
  std::size_t segment = 0;                     ///< of the subject
  double at = 0;                               ///< weight of the target, or time in seconds
};

/// The counts in the fine bins. Most errors of a small mesh are in a few bins, and a file may have thousands of
/// motions, so that only bins are kept that are not empty, 8 bytes each.
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

  /// The bins that are not empty, by number.
  [[nodiscard]] std::span<const Bin> filled() const noexcept { return bins_; }
  [[nodiscard]] std::size_t operator[](std::size_t number) const noexcept;

  /// number < kAuditFineBins, count <= kMostCount
  void add(std::size_t number, std::uint64_t count);
  void add(const FineBins& other);
  friend bool operator==(const FineBins&, const FineBins&) = default;

 private:
  std::vector<Bin> bins_;
};

struct MotionError {
  std::size_t judged = 0;  ///< samples
  double sum = 0, sum_of_squares = 0;
  double worst = 0;
  AuditPlace worst_at;  ///< the first sample of that error; means nothing where worst is 0
  std::array<std::size_t, kAuditBins> histogram{};
  FineBins counts;            ///< the same in finer bins
  std::size_t no_normal = 0;  ///< samples that are not judged: n(t) is too small to have a direction
  std::size_t unlit = 0;      ///< judged samples whose shown normal cannot be lit, which counts as 180 degrees
  AuditPlace unlit_at;        ///< the first of them; means nothing where there are none
  /// Samples without a normal whose n(t) is small, although the positions as float32 determine its direction. Their
  /// error is the angle less what such rounding of the positions may turn n(t).
  std::size_t faint = 0;
  double faint_worst = 0;
  AuditPlace faint_at;  ///< the first sample of that error; means nothing where faint_worst is 0
  /// Samples without a normal that are not faint although the faces around have an area: their normals cancel, so that
  /// nobody knows what is right.
  std::size_t cancelled = 0;
  AuditPlace cancelled_at;  ///< the first of them; means nothing where there are none
  /// Edges over which errors jump by more than 10, 20 and 40 degrees: a picture shows a fold there that the surface
  /// does not have. They are the edges of faces, and the seams between copies of a point, each counted once at every
  /// sample.
  std::array<std::size_t, 3> torn{};
  std::size_t samples = 0;    ///< at which they were counted; 0: nobody counted them, as in sequences
  std::size_t most_torn = 0;  ///< beyond 10 degrees, at one sample
  AuditPlace most_torn_at;    ///< the first sample with so many: mesh, segment and moment

  /// Returns the number of edges that are torn by more than 10 degrees, on average over the samples.
  [[nodiscard]] double torn_edges() const noexcept {
    return samples > 0 ? static_cast<double>(torn[0]) / static_cast<double>(samples) : 0;
  }
  [[nodiscard]] double mean() const noexcept { return judged > 0 ? sum / static_cast<double>(judged) : 0; }
  [[nodiscard]] double rms() const noexcept {
    return judged > 0 ? std::sqrt(sum_of_squares / static_cast<double>(judged)) : 0;
  }
  /// Returns the error, in degrees, that at least this share of the judged samples does not exceed, as counts know it;
  /// 0 if nothing is judged. 0 < share <= 1.
  [[nodiscard]] double percentile(double share) const noexcept;
  /// Returns true if every sample can be lit and no error is above this.
  [[nodiscard]] bool is_within(double degrees) const noexcept { return unlit == 0 && worst <= degrees; }
  /// Does the same for a gate, which also looks at faint samples, and passes nothing with cancelled ones.
  [[nodiscard]] bool passes(double degrees) const noexcept {
    return is_within(degrees) && faint_worst <= degrees && cancelled == 0;
  }
  void add(double degrees, const AuditPlace& place);
  void add_unlit(const AuditPlace& place);
  void add(const MotionError& other);
};

/// The angles by which a skin turns right normals away from the normals of the surface that it makes, over samples of
/// vertices. No target can mend them.
struct SkinningError {
  std::size_t judged = 0;  ///< samples
  double sum = 0, worst = 0;
  AuditPlace worst_at;  ///< the first sample of that error; means nothing where worst is 0

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

/// The respects in which an audit after a change is worse than one before: more samples that cannot be lit, a worst or
/// mean error that grew by more than what the rounding of float32 may turn, or more torn edges. With the two exchanged,
/// it holds the respects in which the change is better.
struct WorseRespects {
  bool unlit = false, mean = false, worst = false, torn = false;

  [[nodiscard]] bool any() const noexcept { return unlit || mean || worst || torn; }
};
[[nodiscard]] WorseRespects find_worse(const MotionError& after, const MotionError& before) noexcept;
/// Returns true if the audit after is worse in any respect.
[[nodiscard]] inline bool is_worse(const MotionError& after, const MotionError& before) noexcept {
  return find_worse(after, before).any();
}

struct ErrorTable {
  std::string name;  ///< "mesh0" of a glTF file, or the scheme; empty where one table has all
  ElementKind kind = ElementKind::kVertices;
  Topology topology;             ///< the mesh
  std::vector<float> positions;  ///< (V, 3), at the first keyframe, or of the base
  /// (V) for a glTF mesh: the primitive of each vertex, and which of its vertices it is; otherwise empty.
  std::vector<std::int64_t> primitives = {}, vertices = {};

  /// The subject of each row (Audit::subjects), or the segment of the motion; and its moment. One of time and weight is
  /// NaN.
  std::vector<std::int64_t> subjects = {};
  std::vector<double> times = {}, weights = {};
  std::vector<float> degrees = {};  ///< (rows, columns)

  [[nodiscard]] std::size_t rows() const noexcept { return subjects.size(); }
  [[nodiscard]] std::size_t columns() const noexcept;
  /// Returns the worst error of each column; NaN where nothing was judged.
  [[nodiscard]] std::vector<float> worst() const;
};

/// The most bytes that the errors of one table may have.
inline constexpr std::size_t kMostErrorBytes = std::size_t{1} << 30;

/// Refuses before a long computation what write_errors() would refuse. Errors: kUsage for another extension than .npz
/// and .ply; those of check_output().
[[nodiscard]] Status check_errors_output(const std::string& path, bool force);

/// Writes tables as a file, all or nothing:
///
///     .npz    errors (rows, columns) float32, subjects (rows) int64, times and weights (rows) float64 as far as there
///             are any, and for glTF primitives and vertices (columns) int64. If tables have names, so do their arrays:
///             mesh0_errors, linear_times
///     .ply    the mesh with the worst error, as it is at the first keyframe, with a property float quality for each
///             vertex or face: the worst error of all samples, 0 if nothing was judged. MeshLab and Blender show it
///
/// Errors: those of check_errors_output() and write_output(); kInvalidInput where there is no table; kUsage in PLY for
/// corners, and for tables of several schemes, of which only one can be shown.
[[nodiscard]] Status write_errors(std::span<const ErrorTable> tables, const std::string& path, bool force);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_ERRORS_H_
