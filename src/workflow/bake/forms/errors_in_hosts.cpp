#include "workflow/bake/forms/errors_in_hosts.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "workflow/bake/forms/worthwhile_columns.h"

namespace chronormal::inline internal {

ShownErrors errors_in_hosts(const RightNormals& rights, const GltfShading& shading, std::span<const Host> hosts,
                            std::span<const std::uint32_t> vertices, const VertexColumns& form,
                            std::span<const SeenPose> poses) {
  const bool is_skinned = any_skinned(poses);
  const auto carry_alike = [&](const Host& a, const Host& b) { return !is_skinned || a.skins == b.skins; };
  std::vector<Host> kinds;
  for (const Host& host : hosts) {
    const Host kind = judged_as(host);
    if (std::none_of(kinds.begin(), kinds.end(),
                     [&](const Host& known) { return shows_alike(known, kind) && carry_alike(known, kind); }))
      kinds.push_back(kind);
  }
  ShownErrors most;
  std::vector<std::pair<Host, VertexColumns>> looked_at;
  for (const Host& kind : kinds) {
    VertexColumns kept = kept_columns(kind, rights, vertices, form);
    const auto is_known = [&](const auto& known) {
      return carry_alike(known.first, kind) && known.second.entries == kept.entries;
    };
    if (std::any_of(looked_at.begin(), looked_at.end(), is_known)) continue;
    Host adds_up;
    adds_up.skins = kind.skins;
    const ShownErrors errors = played_errors(rights, vertices, shading.element_of_vertex, kept, poses, adds_up);
    most = {errors.judged, std::fmax(most.mean, errors.mean), std::fmax(most.most, errors.most),
            std::fmax(most.worst, errors.worst)};
    looked_at.emplace_back(kind, std::move(kept));
  }
  return most;
}

double rounded_worst(const RightNormals& rights, const GltfShading& shading, std::span<const Host> hosts,
                     std::span<const std::uint32_t> vertices, const VertexColumns& form,
                     std::span<const SeenPose> poses) {
  double worst = 0;
  for (const Host& host : hosts) {
    if (shows_alike(host, judged_as(host)) || host.normals != NormalRule::kClamped) continue;
    const VertexColumns kept = kept_columns(host, rights, vertices, form);
    worst = std::fmax(worst, played_errors(rights, vertices, shading.element_of_vertex, kept, poses, host).worst);
  }
  return worst;
}

}  // namespace chronormal::inline internal
