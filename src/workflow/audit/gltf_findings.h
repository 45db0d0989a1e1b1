/// Finds the faults and the notes that an audit reports about a mesh of a glTF file. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_AUDIT_GLTF_FINDINGS_H_
#define CHRONORMAL_WORKFLOW_AUDIT_GLTF_FINDINGS_H_

#include <cstddef>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "chronormal/workflow/audit.h"
#include "workflow/audit/blend_source.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// Lists notes: facts that are no faults, but that a user of the audit should know.
[[nodiscard]] std::vector<AuditFinding> notes_of(const GltfDocument& document, const GltfShading& shading);

/// Makes notes on the nodes that have the mesh and a skin. The notes tell which skins were used to judge the subjects,
/// and which skins or animations could not be read.
[[nodiscard]] std::vector<AuditFinding> notes_of_skins(const GltfDocument& document, const GltfShading& shading,
                                                       std::span<const AuditSubject> subjects,
                                                       const std::map<std::size_t, Error>& unread);

/// Lists the viewers that support fewer targets than the mesh has.
[[nodiscard]] std::vector<AuditFinding> limits_of(const GltfShading& shading, std::span<const Viewer> viewers);

/// Finds the faults of a measured target. `weights` is the function that wrote the weights of the involved targets when
/// the target was measured.
[[nodiscard]] std::vector<AuditFinding> faults_of_target(const GltfDocument& document, const GltfShading& shading,
                                                         const AuthorTruth& truth, AuditRule rule,
                                                         const AuditSubject& subject, const JudgedPart& part,
                                                         std::span<const std::size_t> involved, const Weights& weights);

/// Finds the fault of a measured track. are_targets_judged tells whether each target was judged alone before, and
/// worst_target is the largest error of these targets in degrees.
[[nodiscard]] std::optional<AuditFinding> fault_of_track(const AuditSubject& subject, bool are_targets_judged,
                                                         double worst_target);

/// Makes notes on keys from which the author's normals cannot be derived, and on stored normals that follow no known
/// rule by which face normals are added up.
[[nodiscard]] std::vector<AuditFinding> notes_of_truth(const GltfShading& shading, const AuthorTruth& truth);

/// Finds the fault of a pose in which a file opens, or of a requested pose.
[[nodiscard]] std::optional<AuditFinding> fault_of_pose(const AuditSubject& subject);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_GLTF_FINDINGS_H_
