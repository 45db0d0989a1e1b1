/// Declares audits that report each sample, for callers who need more than the sums of errors. Also declares the audit
/// of a share of a sequence. Private to workflow.
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

/// The errors at all samples of one segment, and the errors at its two ends alone.
struct SegmentErrors {
  std::size_t segment = 0;
  MotionError error, at_keys;
};

using AuditRun = RecordedRun<SegmentErrors>;
using AuditShard = ShardOf<Audit, SegmentErrors>;

/// Audits the share of a sequence's segments that belongs to the run. Every shard needs facts about the whole motion,
/// such as which vertices move and how long a normal gets. A shard without peers finds these facts in all segments. A
/// shard with peers examines only its own segments, and asks the peers with maximize(). Errors: those of an undivided
/// audit; kUsage if single errors are requested of a divided run or of targets, or if known segments belong to another
/// audit; those of run.keep.
[[nodiscard]] Result<Audit> audit(MotionStream& stream, const StoredNormals& normals, const AuditOptions& options,
                                  AuditRun& run);

/// Joins the shards of one audit. The result equals that of an audit in one run. There must be at least one shard.
/// Errors: those of join() for shards.
[[nodiscard]] Result<Audit> merge(std::vector<AuditShard> shards);

/// A judged sample of a subject. Spans and references are valid during the call.
struct AuditSample {
  std::size_t subject_index = 0;  ///< the index that the subject will have in Audit::subjects
  const AuditSubject& subject;    ///< the subject, before its errors are known
  std::size_t segment = 0;        ///< its index: in the subject for a glTF file, otherwise in the motion
  double t = 0;                   ///< the position of the sample in the segment, from 0 to 1
  double at = 0;                  ///< the weight, or the time in seconds, as messages name it
  const JudgedPart& part;
  std::span<const double> largest;  ///< for each element of the part, the length of its largest control normal
  const MotionError& error;
  std::span<const float> degrees;               ///< for each output of the part, its error; NaN if it is not judged
  std::span<const double> weights;              ///< for a glTF file, the weights of all targets
  std::span<const std::vector<double>> played;  ///< for a glTF file, the weights that each viewer plays
};

using AuditWatch = std::function<void(const AuditSample&)>;

/// A mesh as its author made it, with its true normals. The object must not be moved, because `truth` refers to
/// `shading`.
struct AuthorOfMesh {
  AuthorOfMesh(GltfShading read, std::optional<Weighting> asked)
      : shading(std::move(read)), truth(author_truth(shading, asked)), weighting(find_authored_weighting(shading)) {}

  GltfShading shading;
  AuthorTruth truth;
  AuthoredWeighting weighting;  ///< the weighting that the base normals follow
};

/// The meshes of the author's file, keyed by the index of the mesh.
using KnownAuthors = std::map<std::size_t, std::shared_ptr<AuthorOfMesh>>;

/// Audits a file. If options.author is the file of an earlier audit in `known`, uses the facts about the author that
/// the earlier audit found. Otherwise stores these facts in `known`. Both audits must use the same weighting, and weld
/// the same points.
[[nodiscard]] Result<Audit> audit(const GltfDocument& document, const AuditOptions& options, KnownAuthors& known);

/// Run the audits of workflow/audit.h and report each sample, subject by subject. Tracks with the same keys are
/// reported once, as the first of these tracks. If `watch` is empty, no sample is reported.
[[nodiscard]] Result<Audit> watched_audit(const GltfDocument& document, const AuditOptions& options,
                                          const AuditWatch& watch, KnownAuthors* known = nullptr);
[[nodiscard]] Result<Audit> watched_audit(MotionStream& stream, const StoredNormals& normals,
                                          const AuditOptions& options, AuditRun& run, const AuditWatch& watch);

/// Returns the groups of corners that share a normal in the audit of a motion. Corners are in one group if smooth edges
/// join them. If keyframe 0 has stored normals, these determine which edges are smooth. Errors: those of NormalGroups
/// and of the stream.
[[nodiscard]] Result<NormalGroups> audited_groups(MotionStream& stream, const StoredNormals& normals, bool weld);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_WATCHED_AUDIT_H_
