/// Audits a share of a sequence, and reports each sample of an audit to callers that keep more than sums. Private to
/// workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_WATCHED_AUDIT_H_
#define CHRONORMAL_WORKFLOW_AUDIT_WATCHED_AUDIT_H_

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/io/input.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/workflow/audit.h"
#include "workflow/audit/judged_part.h"
#include "workflow/segments/segment_run.h"
#include "workflow/shading/authored_weighting.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/truth/author_truth.h"

namespace chronormal::inline internal {

/// The errors in one segment, and the errors at its ends alone.
struct SegmentErrors {
  std::size_t segment = 0;
  MotionError error, at_keys;
};

using AuditRun = RecordedRun<SegmentErrors>;
using AuditShard = ShardOf<Audit, SegmentErrors>;

/// Audits the share of a sequence's segments that belongs to the run. Facts about the whole motion (which vertices
/// move, how long a normal gets) are needed by every shard. Each shard derives them from all segments, or, with peers,
/// from its own segments and maximize(). Errors: also kUsage for single errors of a run that is divided, or for
/// targets, and for known segments of another audit; errors of run.keep.
[[nodiscard]] Result<Audit> audit(MotionStream& stream, const StoredNormals& normals, const AuditOptions& options,
                                  AuditRun& run);

/// Joins the shards of one audit into the result of one run. Errors: as join() returns them. There must be at least one
/// shard.
[[nodiscard]] Result<Audit> merge(std::vector<AuditShard> shards);

/// A judged sample of a subject. Views are valid during the call.
struct AuditSample {
  std::size_t subject_index = 0;  ///< its future index in Audit::subjects
  const AuditSubject& subject;    ///< errors not filled in yet
  std::size_t segment = 0;        ///< index in the subject, or in the motion
  double t = 0;                   ///< t within the segment
  double at = 0;                  ///< weight or time
  const JudgedPart& part;
  std::span<const double> largest;  ///< per element of the part: length of the largest control normal
  const MotionError& error;
  std::span<const float> degrees;               ///< per output of the part; NaN if not judged
  std::span<const double> weights;              ///< weights of all targets of a glTF file
  std::span<const std::vector<double>> played;  ///< for a glTF file, the weights that each viewer plays
};

using AuditWatch = std::function<void(const AuditSample&)>;

/// A mesh as its author made it, with its true normals. It must not be moved, because `truth` refers to `shading`.
struct AuthorOfMesh {
  AuthorOfMesh(GltfShading read, std::optional<Weighting> asked)
      : shading(std::move(read)), truth(author_truth(shading, asked)), weighting(find_authored_weighting(shading)) {}

  GltfShading shading;
  AuthorTruth truth;
  AuthoredWeighting weighting;  ///< of the base normals
};

/// The meshes of an audited file, keyed by index.
using KnownAuthors = std::map<std::size_t, std::shared_ptr<AuthorOfMesh>>;

/// Audits a file. If options.author is the file of an earlier audit in `known`, uses what that audit found out about
/// the author; otherwise stores in `known` what this audit finds out. Both audits must have the same weighting and weld
/// the same points.
[[nodiscard]] Result<Audit> audit(const GltfDocument& document, const AuditOptions& options, KnownAuthors& known);

/// Run the audits of workflow/audit.h and report each sample, subject after subject. Tracks with the same keys are
/// reported only once, as the first of them. If the watch is empty, nothing is reported.
[[nodiscard]] Result<Audit> watched_audit(const GltfDocument& document, const AuditOptions& options,
                                          const AuditWatch& watch, KnownAuthors* known = nullptr);
[[nodiscard]] Result<Audit> watched_audit(MotionStream& stream, const StoredNormals& normals,
                                          const AuditOptions& options, AuditRun& run, const AuditWatch& watch);

/// Returns the groups of corners that share a normal in the audit of a motion: corners joined by smooth edges, which
/// the stored normals of keyframe 0 determine if there are any. Errors: as NormalGroups and the stream return them.
[[nodiscard]] Result<NormalGroups> audited_groups(MotionStream& stream, const StoredNormals& normals, bool weld);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_WATCHED_AUDIT_H_
