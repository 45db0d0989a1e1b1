/// Computes the normals of a motion at chosen moments.
///
/// A moment is
///     a time     of a sequence, in seconds; there is no motion before its first time and after its last
///     weights    of blend shapes, one for each target: the vertices are at base + sum of w (target - base). A
///                weight may be negative or more than 1, which extrapolates
///     neither    for a mesh at rest: one keyframe and no segment
///
/// Area-weighted normals are within 1e-6 rad of the result of exact arithmetic, also for thin and small faces and for
/// faces of mixed sizes. For a time, normals are computed by the curves of its segment, so they have the same bits
/// whatever other times are asked for. For weights, normals are computed from blended positions, and the guarantee is
/// for these positions before they are rounded to float32. Normals with other weightings are no polynomials, so they
/// are computed in double at each moment.
///
/// Elements   faces, or groups of corners (normals/normal_groups.h); outputs are faces, vertices or corners, and
///            outputs of the same element have the same bits.
/// Degenerate An element without a normal gets (0, 0, 0). If n(t) is zero only at this time, area-weighted unit normals
///            are the limit (Direction in normals/control_normals.h), and all other normals are (0, 0, 0).
///
/// Schemes    If a scheme is given, it interpolates the normals, and only the normals at the ends of a segment are
///            exact. At weights, a scheme interpolates from the base to one target, whose weight must be in [0, 1]; all
///            other weights must be 0.
///
/// Files      write_samples() writes them as
///     npy    an array (moments, outputs, 3) of float32
///     npz    `normals` as above; `times` (moments) or `weights` (moments, targets) of float64; `positions` (moments,
///            V, 3); and, if all faces have equally many corners, `faces`
///     ply    a binary file per moment, with the mesh at that moment; nx, ny, nz of vertices or of faces
///     obj    a file per moment; vn of faces (f v//vn with one vn per face), vertices (one vn per vertex) or corners
///            (one for each different normal)
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
  kUnit,  ///< unit vectors
  kArea,  ///< n itself, which has a length of twice the area of a face; for a vertex or corner the sum over its faces
};

/// The steps of sequential access (section 3 of the paper). Normals are computed at t = 0, 1/steps, ..., 1 of each
/// segment, each from the normals of the previous steps, by additions or by a rotation.
struct Stepping {
  std::size_t steps = 1;  ///< number of steps per segment, at least 1
  /// The number of steps after which normals are computed directly from t again, so that errors do not add up further.
  /// 0 means never, as in the paper.
  std::size_t anchor_interval = kDefaultAnchorInterval;
};

struct SampleOptions {
  ElementOptions elements = {};
  Weighting weighting = Weighting::kArea;
  NormalLength length = NormalLength::kUnit;  ///< kArea is allowed only for Weighting::kArea
  /// The name of a scheme (schemes/scheme.h) that interpolates between the exact normals at the ends of a segment. If
  /// the name is empty, all normals are exact. A scheme is allowed only for Weighting::kArea and NormalLength::kUnit.
  std::string scheme = {};
  /// The steps in which the scheme computes normals, each from the previous one. If steps are given, the sampler can
  /// only compute normals at the moments that step_moments() returns.
  std::optional<Stepping> stepping = {};
};

/// Checks that a motion can have a pose with the weights `weights`. Errors: kUsage for a motion that is not blend
/// shapes, for a number of weights other than the number of targets, and for a weight that is not finite.
[[nodiscard]] Status check_weights(const Motion& motion, std::span<const double> weights);

/// The moments at which normals are computed, in the order of the output. At most one of the two lists is not empty. If
/// both are empty, the mesh is at rest.
struct Moments {
  std::vector<double> times;
  std::vector<std::vector<double>> weights;

  [[nodiscard]] std::size_t count() const noexcept {
    return times.empty() && weights.empty() ? 1 : times.size() + weights.size();
  }
};

/// The error of playback: the largest angle between normals that a scheme plays step by step and normals that the
/// scheme computes directly at the same t.
struct Drift {
  double largest = 0;      ///< the angle in radians
  std::size_t output = 0;  ///< the first output with this angle
  double time = 0;         ///< the time, or the weight of the target, at which this angle occurs
};

/// The positions and normals of a mesh at one moment.
struct Pose {
  std::vector<float> positions;  ///< positions of all vertices, (V, 3)
  std::vector<float> normals;    ///< normals of all elements, (elements, 3)
};

class NormalSampler {
 public:
  /// Makes a sampler of a motion, which must be valid or a mesh at rest, and must outlive the sampler. Errors: those of
  /// make_groups() and make_scheme(). kUsage for faces with a weighting other than area, and for the length kArea with
  /// another weighting. kUsage for a scheme with another weighting, with the length kArea, with elements that the
  /// scheme does not support, or for a mesh at rest. kUsage for stepping without a scheme, or with a scheme that cannot
  /// be played step by step.
  [[nodiscard]] static Result<NormalSampler> make(const Motion& motion, const SampleOptions& options);
  /// Makes a sampler of a stream. For a pose at a time, the sampler reads the two keyframes around the time; for a pose
  /// of weights, it reads all keyframes. Errors: those of make() for a motion, and those of the stream, here and for
  /// each pose.
  [[nodiscard]] static Result<NormalSampler> make(MotionStream& stream, const SampleOptions& options);

  /// Computes the pose at a time in seconds. Prepares the segment that contains this time, unless the last request was
  /// for the same segment. Errors: those of find_instant(); kUsage if the options have stepping and no step is at this
  /// time.
  [[nodiscard]] Result<Pose> at_time(double time);

  /// Computes the pose at the weights of blend shapes. Errors: those of check_weights(); kUsage for weights with which
  /// a vertex exceeds the range of float32 and, with a scheme, for weights that are not all 0 except for one target's
  /// weight in [0, 1].
  [[nodiscard]] Result<Pose> at_weights(std::span<const double> weights);

  /// Computes the pose of keyframe 0, which is the only pose of a mesh at rest. Precondition: if the motion is read as
  /// a stream, keyframe 0 is in memory.
  [[nodiscard]] Pose at_rest() const;

  /// Returns the number of outputs: one for each face, vertex or corner.
  [[nodiscard]] std::size_t output_count() const noexcept;

  /// Returns the index of the element of each output; the span is empty for faces, which are their own elements.
  [[nodiscard]] std::span<const std::uint32_t> element_of_output() const noexcept;

  /// Returns the normals of a pose as (outputs, 3): each output gets a copy of its element's normal.
  [[nodiscard]] std::vector<float> normals_of_outputs(const Pose& pose) const;

  /// Returns the largest error of playback in all poses so far. The error is zero if the options have no stepping.
  [[nodiscard]] const Drift& drift() const noexcept { return drift_; }

 private:
  NormalSampler(MotionStream& stream, const SampleOptions& options)
      : stream_(&stream), motion_(&stream.motion()), options_(options) {}

  [[nodiscard]] bool are_faces() const noexcept { return options_.elements.kind == ElementKind::kFaces; }
  [[nodiscard]] std::size_t element_count() const noexcept;
  // Computes area-weighted unit normals at t by the curves of the segment, which are kept for later moments.
  [[nodiscard]] std::vector<float> unit_normals(const Segment& segment, const LocalTime& t);
  // Computes normals for this moment only, without preparing data for other moments.
  [[nodiscard]] std::vector<float> normals_anew(const Segment& segment, const LocalTime& t) const;
  // Computes normals with the scheme. `time` is only used to report where the drift is largest.
  [[nodiscard]] Result<std::vector<float>> scheme_normals(const Segment& segment, double t, double time);
  // Returns the normals as floats, scaled to length 1 if the options ask for unit normals.
  [[nodiscard]] std::vector<float> as_asked(std::span<const Vec3d> exact) const;
  [[nodiscard]] bool are_exact_units() const noexcept {
    return options_.weighting == Weighting::kArea && options_.length == NormalLength::kUnit;
  }

  // A stream of the motion, if make() was given a motion instead of a stream.
  std::unique_ptr<MotionStream> whole_ = {};
  MotionStream* stream_;
  const Motion* motion_;  // the motion of the stream
  SampleOptions options_;
  // The corners that share a normal, to which curves_ and scheme_normals_ refer; nullptr for faces, which need no
  // groups.
  std::unique_ptr<const NormalGroups> groups_;
  NormalCurves curves_;                            // the curves of the current segment
  std::shared_ptr<SchemeNormals> scheme_normals_;  // the scheme for the current segment; nullptr without a scheme
  std::optional<std::size_t> segment_;             // the number of the current segment
  Drift drift_;
};

/// Returns the moments of all steps through a motion. The moments of a sequence are times, and the end of a segment is
/// also the beginning of the next segment. The moments of targets are weights, from 0 to 1 for each target alone.
/// Errors: kUsage if the motion has no segment.
[[nodiscard]] Result<Moments> step_moments(const Motion& motion, std::size_t steps);

enum class SampleFormat { kNpy, kNpz, kPly, kObj };

/// Finds a format by its name. Errors: kUsage for an unknown name; the message lists all names.
[[nodiscard]] Result<SampleFormat> make_sample_format(std::string_view name);

/// Finds the format of a file by its extension; returns no value for another extension.
[[nodiscard]] std::optional<SampleFormat> find_sample_format(std::string_view path);

/// The largest number of bytes of the arrays in a .npz file that is written to a pipe. These arrays stay in memory
/// until the file is written.
inline constexpr std::size_t kMostSampleBytes = addressable(std::uint64_t{4} << 30);

struct SampleOutput {
  /// The path of the output; "-" is the standard output. In a name of .ply or .obj, %d or %0Nd is replaced by the
  /// number of the moment.
  std::string path;
  SampleFormat format = SampleFormat::kNpy;
  bool force = false;
};

/// Returns the names of the files for `count` moments. Checks that these files can be written, so that a caller learns
/// of an error before a long computation. Errors: kUsage for normals of corners in PLY, and for several moments in one
/// .ply or .obj; those of check_output().
[[nodiscard]] Result<std::vector<std::string>> sample_files(const SampleOutput& output, ElementKind kind,
                                                            std::size_t count);

struct SampleSummary {
  std::size_t normals = 0;  ///< number of written normals, which is moments x outputs
  std::size_t zeros = 0;    ///< number of written normals that are (0, 0, 0)
  Drift drift = {};         ///< the largest drift in this call; zero without stepping
};

/// Computes the poses and writes each of them immediately, so that only one pose is in memory. Only a .npz file for a
/// pipe is collected in memory, since its checksums precede the bytes that they are for. progress(done, total), if
/// given, is called after each moment.
///
/// Errors: those of NormalSampler, sample_files() and write_output(); kUsage for more than kMostSampleBytes in memory.
/// All moments are checked before the first is computed, and if one of the files exists, nothing is written unless
/// `force` is true.
[[nodiscard]] Result<SampleSummary> write_samples(
    const Motion& motion, const SampleOptions& options, const Moments& moments, const SampleOutput& output,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});
[[nodiscard]] Result<SampleSummary> write_samples(
    MotionStream& stream, const SampleOptions& options, const Moments& moments, const SampleOutput& output,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_SAMPLE_H_
