/// The loop of an audit for motions without stored normals whose faces are all triangles. The loop has the same results
/// as measure(), but takes less time because it works block by block.
///
/// A block has some outputs with their elements and faces. The positions of a block are gathered once for each segment
/// and stay in the cache over all samples. The normals and angles of a block are computed in SIMD lanes
/// (analysis/quality/kernels/shown_angles.h). Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_MEASURE_BLOCKS_H_
#define CHRONORMAL_WORKFLOW_AUDIT_MEASURE_BLOCKS_H_

#include <cstddef>
#include <functional>
#include <span>

#include "chronormal/motion/motion.h"
#include "chronormal/workflow/audit.h"
#include "workflow/audit/judged_part.h"
#include "workflow/audit/measure.h"

namespace chronormal::inline internal {

/// Returns true if measure_blocks() can be used. measure_blocks() needs triangles with area weights, a rule that
/// interpolates linearly or not at all, and so few samples that the errors of one segment take little memory.
[[nodiscard]] bool can_measure_blocks(const JudgedPart& part, AuditRule rule, Weighting weighting,
                                      std::size_t samples) noexcept;

/// A function that returns the place (segment, time and vertex) by which messages name an error.
using FindPlace = std::function<AuditPlace(std::size_t segment, double t, const JudgedOutput& output)>;

/// The segments of a subject in a motion, with the functions that measure() calls.
struct SegmentsOfRun {
  MotionStream& stream;
  std::span<const std::size_t> of_motion;  ///< indices of these segments in the motion
  AuditRun& run;

  [[nodiscard]] auto keys() const {
    return [&motion = stream.motion(), own = of_motion](std::size_t s) { return motion.segments[own[s]]; };
  }
  /// Returns the segments that the run reads first, to find which vertices move and how long normals get.
  [[nodiscard]] IndexRange looked_at() const noexcept { return run.looked_at(of_motion.size()); }
  /// Returns the segments whose errors the run measures. If the run is divided, the result has the segments of its
  /// share that no earlier run has measured. Otherwise the result has all segments.
  [[nodiscard]] IndexRange rest() const noexcept {
    return run.is_divided() ? run.rest() : IndexRange{0, of_motion.size()};
  }
  template <class Look>
  [[nodiscard]] Status look_over(const Look& look) const {
    return SegmentRun::look_over(stream, keys(), looked_at(), 1, [&](IndexRange one) {
      look(one.first);
      return Status(Success{});
    });
  }
  void maximize(std::span<double> numbers) const { run.maximize(numbers); }
  template <class Work>
  [[nodiscard]] Status over(AuditSubject& subject, const Work& work) const {
    return run.over(stream, keys(), rest(), 1, [&](IndexRange one) {
      return run.take(work(one.first), [&](const SegmentErrors& found) { add_segment(found, subject); });
    });
  }
};

/// Measures all samples of `segments`, with the same result as measure(), for viewers that compute the normals at
/// keyframes themselves. The outputs of the part must be in the order of their elements. Errors: those of the stream
/// and of the run.
[[nodiscard]] Status measure_blocks(const SegmentsOfRun& segments, const JudgedPart& part, AuditRule rule,
                                    const FindPlace& at, AuditSubject& subject);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_MEASURE_BLOCKS_H_
