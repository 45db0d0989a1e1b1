/// The loop of an audit where nothing is stored and all is triangles: measure() block by block, with the same results.
///
/// A block is some outputs with their elements and faces. It gathers its positions once for each segment, stays in cache
/// over all samples, and computes in lanes (analysis/quality/kernels/shown_angles.h). Private to workflow.
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

/// Whether measure_blocks() knows how: triangles by area, a rule that interpolates along straight lines or not at all, and
/// not so many samples of a segment that its memory would count.
[[nodiscard]] bool can_measure_blocks(const JudgedPart& part, AuditRule rule, Weighting weighting,
                                      std::size_t samples) noexcept;

/// For people, as a source has it (measure.h).
using FindPlace = std::function<AuditPlace(std::size_t segment, double t, const JudgedOutput& output)>;

/// Measures all samples of these segments of a motion, as measure() does for normals that a host computes at keyframes.
/// The outputs of the part must be in the order of their elements. Calls progress after each segment. Of kept, only the
/// shard counts, and where its segments go. Errors: those of the stream, of which a segment is held at a time.
[[nodiscard]] Status measure_blocks(MotionStream& stream, std::span<const std::size_t> segments, const JudgedPart& part,
                                    AuditRule rule, const FindPlace& at, const std::function<void()>& progress,
                                    AuditSubject& subject, const KeptErrors& kept);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_MEASURE_BLOCKS_H_
