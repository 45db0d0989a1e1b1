/// What is wrong with the mesh of a glTF file, in the words of an audit. Private to workflow.
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

/// What is no fault, but good to know.
[[nodiscard]] std::vector<AuditFinding> notes_of(const GltfDocument& document, const GltfShading& shading);

/// The nodes with a skin that carry the mesh: through which it was judged, by what was found of these subjects, and those
/// of which the skin or an animation could not be read.
[[nodiscard]] std::vector<AuditFinding> notes_of_skins(const GltfDocument& document, const GltfShading& shading,
                                                       std::span<const AuditSubject> subjects,
                                                       const std::map<std::size_t, Error>& unread);

/// The viewers that take fewer targets than the mesh has.
[[nodiscard]] std::vector<AuditFinding> limits_of(const GltfShading& shading, std::span<const Viewer> viewers);

/// The faults of a target that was measured, at the weights that measured it, which are those of the involved targets.
[[nodiscard]] std::vector<AuditFinding> faults_of_target(const GltfDocument& document, const GltfShading& shading,
                                                         const AuthorTruth& truth, AuditRule rule,
                                                         const AuditSubject& subject, const JudgedPart& part,
                                                         std::span<const std::size_t> involved, const Weights& weights);

/// The fault of a track that was measured. are_targets_judged says whether targets were judged one by one before, and
/// worst_target how far off they were.
[[nodiscard]] std::optional<AuditFinding> fault_of_track(const AuditSubject& subject, bool are_targets_judged,
                                                         double worst_target);

/// Notes keys that tell nothing of the author's normals, and a rule that is not known.
[[nodiscard]] std::vector<AuditFinding> notes_of_truth(const GltfShading& shading, const AuthorTruth& truth);

/// The fault of a pose in which a file opens, or of those that were asked for.
[[nodiscard]] std::optional<AuditFinding> fault_of_pose(const AuditSubject& subject);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_AUDIT_GLTF_FINDINGS_H_
