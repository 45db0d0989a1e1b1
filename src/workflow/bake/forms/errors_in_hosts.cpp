#include "workflow/bake/forms/errors_in_hosts.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "workflow/bake/forms/worthwhile_columns.h"
#include "workflow/bake/judge/played_errors.h"

namespace chronormal::inline internal {

ShownErrors errors_in_hosts(const RightNormals& rights, const GltfShading& shading, std::span<const Host> hosts,
                            std::span<const std::uint32_t> vertices, const VertexColumns& form, const PoseList& poses) {
  std::vector<Host> kinds;
  for (const Host& host : hosts) {
    const Host kind = judged_as(host);
    if (std::none_of(kinds.begin(), kinds.end(), [&](const Host& known) { return shows_alike(known, kind); }))
      kinds.push_back(kind);
  }
  ShownErrors most;
  std::vector<VertexColumns> looked_at;
  for (const Host& kind : kinds) {
    VertexColumns kept = kept_columns(kind, rights, vertices, form);
    const auto is_known = [&](const VertexColumns& known) { return known.entries == kept.entries; };
    if (std::any_of(looked_at.begin(), looked_at.end(), is_known)) continue;
    const ShownErrors errors = played_errors(rights, vertices, shading.element_of_vertex, kept, poses);
    most = {errors.judged, std::fmax(most.mean, errors.mean), std::fmax(most.most, errors.most),
            std::fmax(most.worst, errors.worst)};
    looked_at.push_back(std::move(kept));
  }
  return most;
}

double rounded_worst(const RightNormals& rights, const GltfShading& shading, std::span<const Host> hosts,
                     std::span<const std::uint32_t> vertices, const VertexColumns& form, const PoseList& poses) {
  double worst = 0;
  for (const Host& host : hosts) {
    if (shows_alike(host, judged_as(host)) || host.normals != NormalRule::kClamped) continue;
    const VertexColumns kept = kept_columns(host, rights, vertices, form);
    worst = std::fmax(worst, played_errors(rights, vertices, shading.element_of_vertex, kept, poses, host).worst);
  }
  return worst;
}

}  // namespace chronormal::inline internal
