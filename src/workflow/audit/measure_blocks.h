/// The loop of an audit where no normals are stored and all faces are triangles: it does what measure() does, block by
/// block, with the same results.
///
/// A block has some outputs with their elements and faces. Its positions are gathered once for each segment and stay in
/// cache over all samples, and its normals and angles are computed in lanes (analysis/quality/kernels/shown_angles.h).
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_MEASURE_BLOCKS_H_
#define CHRONORMAL_WORKFLOW_AUDIT_MEASURE_BLOCKS_H_

#include <cstddef>
#include <functional>
#include <span>

#include "chronormal/motion/motion_stream.h"
#include "chronormal/workflow/audit.h"
#include "workflow/audit/judged_part.h"
#include "workflow/audit/measure.h"

namespace chronormal::inline internal {

/// Whether measure_blocks() applies: to triangles with area weights, a rule that interpolates along straight lines or
/// not at all, and a number of samples for which the memory of a segment stays small.
[[nodiscard]] bool can_measure_blocks(const JudgedPart& part, AuditRule rule, Weighting weighting,
                                      std::size_t samples) noexcept;

/// Names a moment and a vertex for people, as a source does (measure.h).
using FindPlace = std::function<AuditPlace(std::size_t segment, double t, const JudgedOutput& output)>;

/// Measures all samples of these segments of a motion, as measure() does for normals that a viewer computes at keyframes.
/// The outputs of the part must be in the order of their elements. Calls progress after each segment. Of `kept`, only
/// the shard, the known segments and tell_segment are used. Errors: those of the stream, of which one segment is held
/// at a time.
[[nodiscard]] Status measure_blocks(MotionStream& stream, std::span<const std::size_t> segments, const JudgedPart& part,
                                    AuditRule rule, const FindPlace& at, const std::function<void()>& progress,
                                    AuditSubject& subject, const KeptErrors& kept);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_MEASURE_BLOCKS_H_
