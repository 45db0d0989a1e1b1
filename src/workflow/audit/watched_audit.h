/// Audits of a share of a sequence, and audits that tell of each sample, for whoever keeps more of it than its sums.
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_WATCHED_AUDIT_H_
#define CHRONORMAL_WORKFLOW_AUDIT_WATCHED_AUDIT_H_

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/io/input.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/workflow/audit.h"
#include "workflow/audit/judged_part.h"
#include "workflow/segments/segment_run.h"

namespace chronormal::inline internal {

/// The errors in one segment, and those at its ends alone.
struct SegmentErrors {
  std::size_t segment = 0;
  MotionError error, at_keys;
};

using AuditRun = RecordedRun<SegmentErrors>;
using AuditShard = ShardOf<Audit, SegmentErrors>;

/// The audit of a sequence as the run has it: of its share of the segments. Every shard finds out for itself what
/// follows from the whole motion (which vertices move, how long a normal gets); with peers they find it out together,
/// by maximize(). Errors: also kUsage for single errors of a run that is divided, or for targets, and for known
/// segments of another audit; those of run.keep.
[[nodiscard]] Result<Audit> audit(MotionStream& stream, const StoredNormals& normals, const AuditOptions& options,
                                  AuditRun& run);

/// Joins the shards of one audit into what one run would have found. Errors: those of join(). There must be some
[[nodiscard]] Result<Audit> merge(std::vector<AuditShard> shards);

/// A sample of a subject as it was judged. Views are good for the call.
struct AuditSample {
  std::size_t subject_index = 0;  ///< of Audit::subjects, which does not have it yet
  const AuditSubject& subject;    ///< without its errors
  std::size_t segment = 0;        ///< of the subject; of a motion, of the motion
  double t = 0;                   ///< in the segment
  double at = 0;                  ///< weight or time
  const JudgedPart& part;
  std::span<const double> largest;  ///< of the elements of the part, the length of the largest control normal
  const MotionError& error;
  std::span<const float> degrees;               ///< of the outputs of the part; NaN where none is judged
  std::span<const double> weights;              ///< of a glTF file, of all targets
  std::span<const std::vector<double>> played;  ///< of a glTF file, those that each viewer of the options plays
};

using AuditWatch = std::function<void(const AuditSample&)>;

/// The audits of workflow/audit.h, told as they go: subject after subject, sample after sample. Tracks with the same
/// keys are told once, as the first of their subjects. An empty watch is told nothing.
[[nodiscard]] Result<Audit> watched_audit(const GltfDocument& document, const AuditOptions& options,
                                          const AuditWatch& watch);
[[nodiscard]] Result<Audit> watched_audit(MotionStream& stream, const StoredNormals& normals,
                                          const AuditOptions& options, AuditRun& run, const AuditWatch& watch);

/// Which corners of a motion share a normal, as its audit has it: those of smooth edges, as the stored normals of
/// keyframe 0 say, where there are any. Errors: of NormalGroups and of the stream
[[nodiscard]] Result<NormalGroups> audited_groups(MotionStream& stream, const StoredNormals& normals, bool weld);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_WATCHED_AUDIT_H_
