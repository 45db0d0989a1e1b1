/// How far a form is off along the animations of its file, in the hosts that are named. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_FORMS_ERRORS_IN_HOSTS_H_
#define CHRONORMAL_WORKFLOW_BAKE_FORMS_ERRORS_IN_HOSTS_H_

#include <cstdint>
#include <span>

#include "workflow/bake/judge/host_judge.h"
#include "workflow/bake/judge/played_errors.h"
#include "workflow/bake/judge/right_normals.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {

/// The largest mean, 99.9 % and worst of the hosts, without what compressors round (judged_as).
[[nodiscard]] ShownErrors errors_in_hosts(const RightNormals& rights, const GltfShading& shading,
                                          std::span<const Host> hosts, std::span<const std::uint32_t> vertices,
                                          const VertexColumns& form, std::span<const SeenPose> poses);

/// The worst in those hosts that are compressors, with what they round; 0 where none of them is.
[[nodiscard]] double rounded_worst(const RightNormals& rights, const GltfShading& shading, std::span<const Host> hosts,
                                   std::span<const std::uint32_t> vertices, const VertexColumns& form,
                                   std::span<const SeenPose> poses);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_ERRORS_IN_HOSTS_H_
