/// Computes the normals of a motion at chosen moments.
///
/// A moment is
///     a time     of a sequence, in its own seconds; there is no motion before its first and after its last
///     weights    of blend shapes, one for each target: the vertices are at base + sum of w (target - base). They may
///                be negative or more than 1, which extrapolates
///     neither    of a mesh that stands still: one keyframe and no segment
///
/// Area-weighted normals are within 1e-6 rad of exact arithmetic, however thin, small or mixed in size the faces are:
/// at times from positions, or by curves of the segment where kCurvesFrom times or more are asked for there
/// (normals/mesh_normals.h), areas themselves and a mesh that stands still from positions. At weights that
/// holds for positions before they are rounded to float32. Other weightings, which are no polynomials, are
/// computed anew in double.
///
/// Elements   faces, or groups of corners (normals/normal_groups.h); outputs are faces, vertices or corners, and those
///            that show the same element have the same bits.
/// Degenerate An element without a normal has (0, 0, 0). Where n(t) is zero at one time only, area-weighted unit
///            normals at times are the limit (Direction in normals/control_normals.h), and the others (0, 0, 0).
///
/// Schemes    With a scheme the normals are the ones that it gives, and only normals at the ends of a segment are
///            exact. At weights it goes from the base to one target: its weight must be in [0, 1], and the other
///            weights must be 0.
///
/// Files      write_samples() writes them as
///     npy    an array (moments, outputs, 3) of float32
///     npz    `normals` as above; `times` (moments) or `weights` (moments, targets) of float64; `positions` (moments,
///            V, 3); and, where all faces have as many corners, `faces`
///     ply    a file per moment, binary, of the mesh as it is then; nx, ny, nz of vertices or of faces
///     obj    a file per moment; vn of faces (f v//vn with one vn per face), vertices (one vn per vertex) or corners
///            (one for each normal that differs)
#ifndef CHRONORMAL_WORKFLOW_SAMPLE_H_
#define CHRONORMAL_WORKFLOW_SAMPLE_H_

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"
#include "chronormal/schemes/scheme.h"

namespace chronormal {

inline namespace internal {
class SchemeNormals;
}

enum class NormalLength {
  kUnit,  ///< 1
  kArea,  ///< n itself: for a face, twice its area; for a vertex or corner, that of the sum
};

/// The steps of sequential access (section 3 of the paper): normals at t = 0, 1/steps, ..., 1 of each segment, each
/// made from the ones before it by additions or by a rotation.
struct Stepping {
  std::size_t steps = 1;  ///< of a segment, 1 or more
  /// The state is made anew every so many steps; 0: never, as in the paper.
  std::size_t anchor_interval = kDefaultAnchorInterval;
};

struct SampleOptions {
  ElementOptions elements = {ElementKind::kVertices};
  Weighting weighting = Weighting::kArea;
  NormalLength length = NormalLength::kUnit;  ///< kArea for the weighting kArea only
  /// Interpolates by this scheme (schemes/scheme.h) between the exact normals at the ends of a segment; empty: exact
  /// normals. For the weighting kArea and the length kUnit only.
  std::string scheme = {};
  std::optional<Stepping> stepping = {};  ///< plays the scheme, at the times of step_moments() only
};

/// Checks that a pose can have these weights. Errors: kUsage for a motion that is not blend shapes, if there is not one
/// weight for each target, or for a weight that is not finite.
[[nodiscard]] Status check_weights(const Motion& motion, std::span<const double> weights);

/// The moments in the order of the output. At most one list has any; if both are empty, the mesh stands still.
struct Moments {
  std::vector<double> times;
  std::vector<std::vector<double>> weights;

  [[nodiscard]] std::size_t count() const noexcept {
    return times.empty() && weights.empty() ? 1 : times.size() + weights.size();
  }
};

/// The largest angle between normals that were played and the normals of the same scheme at random access, at the same
/// t.
struct Drift {
  double largest = 0;      ///< radians
  std::size_t output = 0;  ///< the first one that shows it
  double time = 0;         ///< or the weight of the target
};

/// A mesh at one moment.
struct Pose {
  std::vector<float> positions;  ///< (V, 3)
  std::vector<float> normals;    ///< (elements, 3)
};

class NormalSampler {
 public:
  /// Makes a sampler. The motion must be valid or stand still, and outlive the sampler. Errors: of make_groups() and
  /// make_scheme(); kUsage for faces with another weighting than area, for the length kArea with another weighting, for
  /// a scheme with either, with elements that it has no meaning for, or for a mesh that stands still, and for stepping
  /// without a scheme or with one that has no sequential form.
  [[nodiscard]] static Result<NormalSampler> make(const Motion& motion, const SampleOptions& options);
  /// Makes a sampler of a stream: a pose at a time reads the two keyframes around it, and a pose of weights reads all
  /// keyframes. Errors: also those of the stream, here and for each pose.
  [[nodiscard]] static Result<NormalSampler> make(MotionStream& stream, const SampleOptions& options);

  /// Computes the pose at a time. evaluations says how many times of its segment will follow each other, this one
  /// included; what is prepared for the first of them serves all. Errors: of find_instant(); kUsage if no step leads to
  /// the time.
  [[nodiscard]] Result<Pose> at_time(double time, double evaluations = 1);

  /// Computes the pose of weights. Errors: of check_weights(); kUsage for weights with which a vertex leaves the range
  /// of float32 and, with a scheme, for weights that are not between the base and one target.
  [[nodiscard]] Result<Pose> at_weights(std::span<const double> weights);

  /// Computes the pose of keyframe 0, the only one of a mesh that stands still. A stream must hold that keyframe.
  [[nodiscard]] Pose at_rest() const;

  /// Returns the number of faces, vertices or corners.
  [[nodiscard]] std::size_t output_count() const noexcept;

  /// Returns the element of each vertex or corner; empty for faces, which are the elements.
  [[nodiscard]] std::span<const std::uint32_t> element_of_output() const noexcept;

  /// Returns the normals of a pose for every output: (outputs, 3).
  [[nodiscard]] std::vector<float> normals_of_outputs(const Pose& pose) const;

  /// Returns the largest drift of all poses so far; zero without stepping.
  [[nodiscard]] const Drift& drift() const noexcept { return drift_; }

 private:
  NormalSampler(MotionStream& stream, const SampleOptions& options)
      : stream_(&stream), motion_(&stream.motion()), options_(options) {}

  [[nodiscard]] bool are_faces() const noexcept { return options_.elements.kind == ElementKind::kFaces; }
  [[nodiscard]] std::size_t element_count() const noexcept;
  // Computes area-weighted normals, prepared for the next moment of the segment.
  [[nodiscard]] std::vector<float> unit_normals(const Segment& segment, const LocalTime& t, double evaluations);
  // Computes normals anew, for this moment only.
  [[nodiscard]] std::vector<float> normals_anew(const Segment& segment, const LocalTime& t) const;
  // Computes normals by the scheme; time is reported with a drift.
  [[nodiscard]] Result<std::vector<float>> scheme_normals(const Segment& segment, double t, double time);
  // Scales the normals to unit length if the options ask for that.
  [[nodiscard]] std::vector<float> as_asked(std::span<const Vec3d> exact) const;
  [[nodiscard]] bool are_exact_units() const noexcept {
    return options_.weighting == Weighting::kArea && options_.length == NormalLength::kUnit;
  }

  std::unique_ptr<MotionStream> whole_ = {};  // where a motion was given
  MotionStream* stream_;
  const Motion* motion_;  // of the stream
  SampleOptions options_;
  std::unique_ptr<const NormalGroups> groups_;     // but for faces; prepared normals refer to them
  NormalCurves curves_;                            // of one segment
  std::shared_ptr<SchemeNormals> scheme_normals_;  // likewise, where there is a scheme
  std::optional<std::size_t> segment_;             // which
  Drift drift_;
};

/// Returns the moments at which stepping goes through a motion: times of a sequence, in which the end of a segment is
/// the beginning of the next one; for targets, each of them from weight 0 to 1. Errors: kUsage where the motion has no
/// segment.
[[nodiscard]] Result<Moments> step_moments(const Motion& motion, std::size_t steps);

/// Counts for each time how many times from it on lie in the same segment without a break: the evaluations that
/// NormalSampler::at_time() wants to know of. Errors: of find_instant()
[[nodiscard]] Result<std::vector<double>> times_in_a_row(const Motion& motion, std::span<const double> times);

enum class SampleFormat { kNpy, kNpz, kPly, kObj };

/// Finds a format by its name. Errors: kUsage, with all names.
[[nodiscard]] Result<SampleFormat> make_sample_format(std::string_view name);

/// Finds the format of a file by its extension; nothing for another extension.
[[nodiscard]] std::optional<SampleFormat> find_sample_format(std::string_view path);

/// The most bytes that the arrays of a .npz file for a pipe may have: they are in memory until it is written.
inline constexpr std::size_t kMostSampleBytes = addressable(std::uint64_t{4} << 30);

struct SampleOutput {
  std::string path;  ///< "-" is the standard output; %d or %0Nd in a name of .ply or .obj is the number of the moment
  SampleFormat format = SampleFormat::kNpy;
  bool force = false;
};

/// Names the files that `count` moments will be written to, and checks before a long computation that they can be.
/// Errors: kUsage for normals of corners in PLY, and for several moments in one .ply or .obj; those of check_output().
[[nodiscard]] Result<std::vector<std::string>> sample_files(const SampleOutput& output, ElementKind kind,
                                                            std::size_t count);

struct SampleSummary {
  std::size_t normals = 0;  ///< normals that were written: moments x outputs
  std::size_t zeros = 0;    ///< normals among these that are (0, 0, 0)
  Drift drift = {};         ///< of those that were computed by this call, with stepping
};

/// Computes the poses and writes each at once, so that only one is in memory. Only a .npz file for a pipe is gathered
/// in memory, since its checksums come before the bytes that they cover.
/// progress(done, total), if given, is called after each moment.
///
/// Errors: of NormalSampler, sample_files() and write_output(); kUsage for more than kMostSampleBytes in memory. All
/// moments are checked before the first is computed, and a file of the names that exist stops all unless force is
/// given.
[[nodiscard]] Result<SampleSummary> write_samples(
    const Motion& motion, const SampleOptions& options, const Moments& moments, const SampleOutput& output,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});
[[nodiscard]] Result<SampleSummary> write_samples(
    MotionStream& stream, const SampleOptions& options, const Moments& moments, const SampleOutput& output,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_H_
