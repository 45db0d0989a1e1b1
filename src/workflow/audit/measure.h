/// The loop of an audit, which compares the rendered normals of a moving part of a mesh with the true normals. Private
/// to workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_MEASURE_H_
#define CHRONORMAL_WORKFLOW_AUDIT_MEASURE_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "analysis/quality/kernels/shown_angles.h"
#include "chronormal/analysis/quality.h"
#include "chronormal/workflow/audit.h"
#include "core/bits.h"
#include "core/blocks.h"
#include "workflow/audit/judged_part.h"
#include "workflow/audit/watched_audit.h"
#include "workflow/shading/authored_weighting.h"

namespace chronormal::inline internal {

/// The shortest length of a normal whose error counts, relative to the largest control normal of its element. Errors of
/// shorter normals are left out of the sums of errors. The surface nearly collapses there, and its shading mostly
/// follows from the normals around it. If the caller sets a limit of the error (--tolerance), the limit applies to such
/// a normal as long as the normal has a direction.
inline constexpr double kVanished = 1e-4;

/// The value that stands for the error of an output whose faces have an area, but whose face normals cancel each other.
inline constexpr double kCancels = -3;

inline constexpr std::size_t kAuditSamples = 21, kAuditFewSamples = 5, kAuditSamplesOfAll = 210;
inline constexpr std::size_t kAuditFewSamplesOfTarget = 11;

/// The number of outputs (judged normals) that are computed together, so that their data fit into the fastest cache.
inline constexpr std::size_t kOutputsAtOnce = 256;

/// Returns the index of the bin of the histogram (kAuditBinEdges) to which an error in [0, 180] degrees belongs.
[[nodiscard]] inline std::size_t bin_of(double degrees) noexcept {
  std::size_t bin = 0;
  for (const double edge : kAuditBinEdges) bin += degrees >= edge ? 1U : 0U;
  return bin;
}

/// Returns the bin of the fine histogram for an error in degrees. If the processor does not round to nearest, an angle
/// may also be -0 or slightly more than 180 degrees, so the result is clamped to the last bin.
[[nodiscard]] inline std::size_t fine_bin_of(double degrees) noexcept {
  // Each doubling of the angle in degrees has 128 bins, so the exponent of a double and the first 7 bits of its
  // fraction, read as one integer, are the index of the bin plus a constant.
  static_assert(kAuditBinsOfDoubling == 128);
  constexpr int kFractionBits = 52 - 7, kExponentBias = 1023;
  constexpr std::uint64_t kFirst = std::uint64_t{kExponentBias + kAuditLeastExponent} * kAuditBinsOfDoubling;
  const std::uint64_t number = degrees > 0 ? bit_cast<std::uint64_t>(degrees) >> kFractionBits : 0;
  const std::uint64_t fine_bin = number >= kFirst ? number - kFirst + 1 : 0;
  return static_cast<std::size_t>(std::min<std::uint64_t>(fine_bin, kAuditFineBins - 1));
}

/// Returns a lower bound, in degrees, of the angle between the rendered and the true normal. The bound is the computed
/// angle minus the angle by which rounding may have turned the true normal. `length` is the length of the true normal,
/// and `rounding` a bound of its rounding error. Returns kNotJudged if rounding may give the true normal any direction.
[[nodiscard]] double faint_degrees(const Vec3d& shown, const Vec3d& right, double length, double rounding) noexcept;

/// Returns the unit normal that a viewer renders by a rule between two stored normals. Returns (0, 0, 0) if the blended
/// normal is zero.
[[nodiscard]] Vec3f blend_stored(AuditRule rule, const Vec3d& from, const Vec3d& to, double t) noexcept;

/// Returns the number of moments in each segment at which normals are measured. If targets are judged one by one, each
/// target is a segment.
[[nodiscard]] std::size_t samples_per_segment(const AuditOptions& options, std::size_t segments,
                                              std::size_t fewest = kAuditFewSamples) noexcept;

/// Returns the position of the i-th sample in its segment, from 0 to 1.
[[nodiscard]] inline double time_of_sample(std::size_t i, std::size_t samples) noexcept {
  return samples > 1 ? static_cast<double>(i) / static_cast<double>(samples - 1) : 0;
}

[[nodiscard]] Status check_samples(const AuditOptions& options);

/// Returns the angles between the stored normals and the normals of the geometry, for the requested weighting of faces.
/// If no weighting is requested, uses the detected weighting.
[[nodiscard]] AuthoredOffset authored_offset(const AuthoredWeighting& authored, std::optional<Weighting> asked);

/// Returns the fault of a subject whose stored normals have an error above kAuditFault. If the subject has several
/// faults, returns the first in this order: normals that cannot be lit, errors at keys, errors between keys.
[[nodiscard]] std::optional<AuditFinding> find_wrong_normals(const AuditSubject& subject);

/// Adds the errors of a segment to the errors of its subject.
inline void add_segment(const SegmentErrors& found, AuditSubject& subject) {
  subject.error.add(found.error);
  subject.at_keys.add(found.at_keys);
}

/// Finishes an audit: adds up the errors of all subjects, finds the worst subject, and puts faults before notes.
void finish(Audit& result);

// A source is a motion together with the normals that are rendered during it. It has these functions:
//     place(segment, t, positions)   writes the positions of the part; returns false if they are as in the last call
//     forget()                       makes the next call of place() return true
//     turn(positions, normals)       turns the normals of the part into true directions, and keeps their lengths
//     begin(start, end)              gets the normals of elements at both ends of a segment, before its samples are
//                                    measured (is called if kNeedsEnds is true)
//     show()                         is called after each placement, before shown()
//     shown(first, normals)          writes the rendered normals of outputs from number `first` on; zero if no sum
//                                    exists
//     seen(i, n)                     returns a normal of the i-th output as the screen shows it
//     right(first, normals)          replaces normals of the geometry by the true directions for outputs from number
//                                    `first` on
//     hides(output, n)               tells whether the true normal has no direction on the screen and is not judged
//     at(segment, t, output)         returns the place of an error, for messages
//
// Segments tell where to measure. They have these functions:
//     look_over(look)                calls look(segment) for segments that determine the largest normals; returns a
//                                    Status
//     maximize(numbers)              replaces each number by the largest value that any process has, if processes share
//                                    the segments
//     over(subject, work)            adds work(segment), the errors of each measured segment, to the subject; returns a
//                                    Status

/// The positions and normals of a part at the moment of the last place().
struct PlacedPart {
  explicit PlacedPart(const JudgedPart& judged) : part(judged), positions(judged.vertices().size()) {}

  /// Places the part at position t of a segment. Returns true if any position has changed since the last call.
  template <class Source>
  bool place(Source& source, std::size_t segment, double t) {
    const bool differs = source.place(segment, t, positions);
    if (differs) {
      part.normals(positions, normals);
      source.turn(positions, normals.elements);
    }
    return differs;
  }

  const JudgedPart& part;
  std::vector<Vec3d> positions;
  PartNormals normals;
};

/// Returns the length of the largest control normal of each element in all segments. The control normals of a segment
/// follow from the normals at its ends and its middle. If vertices move on curved paths, the control normals belong to
/// the parabola through these three normals, which is accurate enough to tell which normals vanish (kVanished).
template <class Source, class Segments>
[[nodiscard]] Result<std::vector<double>> largest_control_normals(Source& source, Segments& segments,
                                                                  PlacedPart& placed) {
  std::vector<double> largest(placed.part.elements().size(), 0.0);
  const auto normals_at = [&](std::size_t s, double t) {
    placed.place(source, s, t);
    return placed.normals.elements;
  };
  source.forget();
  const Status looked = segments.look_over([&](std::size_t s) {
    const std::vector<Vec3d> start = normals_at(s, 0), middle = normals_at(s, 0.5);
    placed.place(source, s, 1);
    const std::vector<Vec3d>& end = placed.normals.elements;
    parallel_each(largest.size(), kRange, [&](std::size_t e) {
      const Vec3d m = 2.0 * middle[e] - 0.5 * (start[e] + end[e]);
      largest[e] = std::max({largest[e], length(start[e]), length(m), length(end[e])});
    });
  });
  if (!looked) return looked.error();
  segments.maximize(largest);
  return largest;
}

/// Adds the errors of some outputs, in order, to an empty result. Has the same effect as MotionError::add() and
/// add_unlit(), in less time. degrees_of() returns the error of an output in degrees, kNotLit or kNotJudged. For an
/// output with kNotJudged, faint_of() is called. faint_of() returns the error in degrees to which a tolerance of the
/// caller applies, or kCancels, or kNotJudged if no face around the output has an area.
template <class Degrees, class Faint, class At>
void add_errors(std::span<const JudgedOutput> outputs, const Degrees& degrees_of, const Faint& faint_of, const At& at,
                MotionError& result) {
  double sum = 0, sum_of_squares = 0, worst = 0;  // copies of the members of `result`, so that they stay in registers
  std::size_t judged = 0;
  std::array<std::uint32_t, kAuditFineBins> counts{};  // the fine histogram of at most kRange outputs
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const JudgedOutput& output = outputs[i];
    double degrees = degrees_of(output, i);
    if (degrees < 0) {
      if (degrees == kNotJudged) {
        ++result.no_normal;
        const double faint = faint_of(output, i);
        if (faint >= 0) ++result.faint;
        if (faint == kCancels && result.cancelled++ == 0) result.cancelled_at = at(output);
        if (faint > result.faint_worst) {
          result.faint_worst = faint;
          result.faint_at = at(output);
        }
        continue;
      }
      if (result.unlit++ == 0) result.unlit_at = at(output);
      degrees = 180;
    }
    ++judged;
    sum += degrees;
    sum_of_squares += degrees * degrees;
    ++result.histogram[bin_of(degrees)];
    ++counts[fine_bin_of(degrees)];
    if (degrees > worst) {
      worst = degrees;
      result.worst_at = at(output);
    }
  }
  result.judged = judged;
  result.sum = sum;
  result.sum_of_squares = sum_of_squares;
  result.worst = worst;
  for (std::size_t bin = 0; bin < counts.size(); ++bin)
    if (counts[bin] > 0) result.counts.add(bin, counts[bin]);
}

/// Counts the torn edges of a part. `differences` has, for each output, the rendered unit normal minus the true one, or
/// NaN if the output is not judged.
void count_torn(const JudgedPart& part, std::span<const Vec3f> differences, const AuditPlace& at, MotionError& error);

/// The true normal of a placed output.
struct RightOutput {
  Vec3d direction;          ///< the direction that source.right() returns
  bool is_hidden = false;   ///< the result of source.hides()
  bool has_normal = false;  ///< true if the normal is long enough to be judged (kVanished)
  bool has_area = false;    ///< true if a face around the output has an area; faces without area are not drawn
};

/// The true normals of all placed outputs, in 25 bytes each.
class RightOutputs {
 public:
  void resize(std::size_t count) {
    directions_.resize(count);
    flags_.resize(count);
  }
  void set(std::size_t i, const RightOutput& output) noexcept {
    directions_[i] = output.direction;
    flags_[i] = static_cast<std::uint8_t>((output.is_hidden ? kHidden : 0) | (output.has_normal ? kNormal : 0) |
                                          (output.has_area ? kArea : 0));
  }
  [[nodiscard]] RightOutput operator[](std::size_t i) const noexcept {
    return {directions_[i], (flags_[i] & kHidden) != 0, (flags_[i] & kNormal) != 0, (flags_[i] & kArea) != 0};
  }

 private:
  static constexpr int kHidden = 1, kNormal = 2, kArea = 4;
  std::vector<Vec3d> directions_;
  std::vector<std::uint8_t> flags_;
};

/// Writes the true normals of all placed outputs.
template <class Source>
void find_right(const Source& source, const PlacedPart& placed, std::span<const double> largest, RightOutputs& result) {
  const std::span<const JudgedOutput> outputs = placed.part.outputs();
  result.resize(outputs.size());
  parallel_blocks(outputs.size(), kOutputsAtOnce, [&](IndexRange range) {
    std::array<Vec3d, kOutputsAtOnce> normals;
    const std::span<Vec3d> some = std::span(normals).first(range.count);
    for (std::size_t k = 0; k < range.count; ++k) some[k] = placed.normals.elements[outputs[range.first + k].element];
    source.right(range.first, some);
    for (std::size_t k = 0; k < range.count; ++k) {
      const JudgedOutput& output = outputs[range.first + k];
      const Vec3d& normal = placed.normals.elements[output.element];
      const double least = kVanished * largest[output.element];
      // Comparing the largest component takes less time than computing a length, and decides for most normals.
      const bool has_normal = max_abs(normal) > least || length(normal) > least;
      result.set(range.first + k,
                 {some[k], source.hides(output, normal), has_normal, placed.normals.sizes[output.element] > least});
    }
  });
}

/// Returns the errors of all placed outputs. shown(first, normals) writes the rendered normals of outputs from number
/// `first` on, and `right` has the true normals. If `each` is not empty, it receives the error of every output in
/// degrees, or NaN for an output that is not judged.
template <class Source, class Shown>
[[nodiscard]] MotionError error_at(const Source& source, const PlacedPart& placed, bool is_flat, std::size_t segment,
                                   double t, const Shown& shown, const RightOutputs& right,
                                   std::span<float> each = {}) {
  const std::span<const JudgedOutput> outputs = placed.part.outputs();
  const bool has_edges = !placed.part.edges().empty();
  std::vector<Vec3f> differences(has_edges ? outputs.size() : 0);
  std::vector<MotionError> of_blocks(block_count(outputs.size(), kRange));
  numbered_blocks(outputs.size(), kRange, [&](std::size_t b, std::size_t first, std::size_t end) {
    std::vector<double> degrees(end - first);
    std::array<Vec3d, kOutputsAtOnce> is_shown, is_right;
    for (std::size_t from = first; from < end; from += is_shown.size()) {
      const std::size_t count = std::min(is_shown.size(), end - from);
      const std::span<double> of_some = std::span(degrees).subspan(from - first, count);
      shown(from, std::span(is_shown).first(count));
      for (std::size_t k = 0; k < count; ++k) {
        const RightOutput is = right[from + k];
        const bool may_be_lit = is_flat ? is_shown[k] != Vec3d{} : is.has_area;
        // The skin collapses the true normal of a hidden output, so this output is not judged.
        of_some[k] = is.is_hidden                                                        ? kNotJudged
                     : !is_finite(is_shown[k]) || (may_be_lit && is_shown[k] == Vec3d{}) ? kNotLit
                     : !is.has_normal || !may_be_lit                                     ? kNotJudged
                                                                                         : 0;
        is_right[k] = is.direction;
        if (of_some[k] == kNotJudged) is_shown[k] = is_right[k] = {};
        if (of_some[k] == kNotLit) is_shown[k] = {};
      }
      std::array<double, is_shown.size()> angles;
      const std::span<const Vec3d> of_shown = std::span(is_shown).first(count),
                                   of_right = std::span(is_right).first(count);
      if (has_edges)
        errors_of_pairs(of_shown, of_right, std::span(angles).first(count),
                        std::span(differences).subspan(from, count));
      else
        angles_of_pairs(of_shown, of_right, std::span(angles).first(count));
      for (std::size_t k = 0; k < count; ++k)
        if (of_some[k] == 0) of_some[k] = angles[k];
    }
    add_errors(
        outputs.subspan(first, end - first), [&](const JudgedOutput&, std::size_t i) { return degrees[i]; },
        [&](const JudgedOutput& output, std::size_t i) {
          const Vec3d& normal = placed.normals.elements[output.element];
          if (normal != Vec3d{} && source.hides(output, normal)) return kNotJudged;
          Vec3d now;
          shown(first + i, std::span(&now, 1));
          const RightOutput is = right[first + i];
          const double faint = normal == Vec3d{}
                                   ? kNotJudged
                                   : faint_degrees(now, is.direction, length(normal),
                                                   placed.part.rounding_of(placed.positions, output.element));
          return faint == kNotJudged && (is_flat ? now != Vec3d{} : is.has_area) ? kCancels : faint;
        },
        [&](const JudgedOutput& output) { return source.at(segment, t, output); }, of_blocks[b]);
    for (std::size_t i = first; !each.empty() && i < end; ++i) {
      const double found = degrees[i - first];
      each[i] = found == kNotJudged ? std::numeric_limits<float>::quiet_NaN()
                                    : static_cast<float>(found == kNotLit ? 180 : found);
    }
  });
  MotionError all;
  for (const MotionError& of_block : of_blocks) all.add(of_block);
  if (has_edges) count_torn(placed.part, differences, source.at(segment, t, outputs.front()), all);
  return all;
}

/// The table that stores the error of every sample, and the subject to which the errors belong.
struct KeptErrors {
  ErrorTable* table = nullptr;  ///< nullptr if errors are not kept
  std::size_t subject = 0;
  bool are_watched = false;  ///< tells whether each_sample() needs the error of each output

  [[nodiscard]] bool any() const noexcept { return table != nullptr || are_watched; }
};

/// The data of a measured sample (one moment of a segment) that each_sample() receives.
struct MeasuredSample {
  std::size_t segment = 0;
  double t = 0;
  const PlacedPart& placed;
  std::span<const double> largest;  ///< the result of largest_control_normals()
  std::span<const double> next;     ///< positions of the next samples in the segment, from 0 to 1
  const RightOutputs& right;        ///< true normals of all outputs
  const MotionError& error;
  /// The error of each output in degrees, or NaN if the output is not judged. Empty if single errors are not kept.
  std::span<const float> each;
};

/// Appends the errors at a sample to the table, in degrees. A vertex with several outputs gets the largest of their
/// errors.
void keep_sample(const KeptErrors& kept, std::span<const JudgedOutput> outputs, std::span<const float> degrees,
                 bool is_weight, double at);

/// Measures all samples of a subject's segments, and writes the errors into the subject. Calls each_sample with a
/// MeasuredSample for every sample. Errors: those of the functions of `segments`.
template <class Source, class Segments, class EachSample>
[[nodiscard]] Status measure(Source& source, Segments segments, const JudgedPart& part, AuditRule rule,
                             AuditSubject& subject, const KeptErrors& kept, const EachSample& each_sample) {
  PlacedPart placed(part);
  const Result<std::vector<double>> all_largest = largest_control_normals(source, segments, placed);
  if (!all_largest) return all_largest.error();
  const std::vector<double>& largest = all_largest.value();
  source.forget();
  const bool is_flat = rule == AuditRule::kFlat;
  const auto shown = [&](std::size_t from, std::span<Vec3d> normals) {
    if (!is_flat) return source.shown(from, normals);
    for (std::size_t k = 0; k < normals.size(); ++k)
      normals[k] = source.seen(from + k, placed.normals.faces[part.outputs()[from + k].face]);
  };
  RightOutputs right;
  MotionError error;  // the error at the sample that was placed last
  std::vector<float> each(kept.any() ? part.outputs().size() : 0);
  const Status measured = segments.over(subject, [&](std::size_t s) {
    SegmentErrors found{s, {}, {}};
    if constexpr (Source::kNeedsEnds) {
      placed.place(source, s, 0);
      std::vector<Vec3d> start = placed.normals.elements;
      placed.place(source, s, 1);
      source.begin(std::move(start), placed.normals.elements);
      source.forget();
    }
    std::vector<double> times(subject.samples);
    for (std::size_t i = 0; i < times.size(); ++i) times[i] = time_of_sample(i, times.size());
    for (std::size_t i = 0; i < times.size(); ++i) {
      const double t = times[i];
      if (placed.place(source, s, t)) {
        source.show();
        find_right(source, placed, largest, right);
        error = error_at(source, placed, is_flat, s, t, shown, right, each);
      }
      if (kept.table != nullptr)
        keep_sample(kept, part.outputs(), each, subject.is_weighed(), source.at(s, t, part.outputs().front()).at);
      found.error.add(error);
      if (i == 0 || i + 1 == subject.samples) found.at_keys.add(error);
      each_sample(MeasuredSample{s, t, placed, largest, std::span(times).subspan(i + 1), right, error, each});
    }
    return found;
  });
  if (!measured) return measured;
  subject.vertices = part.outputs().size();
  return Success{};
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_MEASURE_H_
