#include <algorithm>
#include <utility>

#include "workflow/audit/blend_source.h"
#include "workflow/report/report_parts.h"
#include "workflow/shading/gltf_shading.h"

namespace chronormal::inline internal {
namespace {

// Vectors of all vertices, as those that are not zero, or all where none is.
ModelVectors without_zeros(const std::vector<float>& vectors) {
  ModelVectors result;
  for (std::size_t v = 0; 3 * v < vectors.size(); ++v) {
    if (vector_at(vectors, v) == Vec3f{}) continue;
    result.vertices.push_back(static_cast<std::uint32_t>(v));
    result.values.insert(result.values.end(), &vectors[3 * v], &vectors[3 * v] + 3);
  }
  result.drop_vertices_of(vectors.size() / 3);
  return result;
}

// The normals and deltas that one host keeps of the stored ones. The specification keeps all of them.
ModelShown shown_by(const GltfShading& shading, const Host& host) {
  ModelShown shown;
  shown.keeps_halves = host.keeps_halves();
  shown.least_weight = host.least_weight;
  shown.normals = shading.normals;
  for (const std::vector<float>& deltas : shading.normal_deltas) shown.targets.push_back(without_zeros(deltas));
  if (host.normals == NormalRule::kSum && host.bits == 32) return shown;
  const auto put = [](const Vec3f& vector, float* to) { std::copy_n(&vector.x, 3, to); };
  for (std::size_t v = 0; 3 * v < shown.normals.size(); ++v)
    put(kept_normal(host, vector_at(shading.normals, v)), &shown.normals[3 * v]);
  for (ModelVectors& target : shown.targets) {
    for (std::size_t i = 0; i < target.size(); ++i) {
      const Vec3f normal = vector_at(shading.normals, target.vertex(i)), delta = vector_at(target.values, i);
      put(kept_delta(host, normal, delta), &target.values[3 * i]);
    }
  }
  return shown;
}

bool show_alike(const Host& a, const Host& b) noexcept {
  return a.normals == b.normals && a.bits == b.bits && a.by_frame == b.by_frame &&
         a.octahedral_base == b.octahedral_base && a.least_weight == b.least_weight;
}

// The first entry is what the specification shows, with the names of all hosts that show the same. The others are what
// the rest of `hosts` show.
std::vector<ModelShown> shown_of(const GltfShading& shading, std::span<const Host> hosts) {
  const Host specification{.name = "specification", .title = ""};
  std::vector<Host> firsts = {specification};
  std::vector<ModelShown> result = {shown_by(shading, specification)};
  result[0].hosts.emplace_back(specification.name);
  for (const Host& host : kHosts) {
    const auto alike = std::find_if(firsts.begin(), firsts.end(), [&](const Host& h) { return show_alike(h, host); });
    const bool is_wanted = std::find(hosts.begin(), hosts.end(), host) != hosts.end();
    if (alike == firsts.end() && !is_wanted) continue;
    if (alike == firsts.end()) {
      firsts.push_back(host);
      result.push_back(shown_by(shading, host));
      result.back().hosts.emplace_back(host.name);
    } else if (is_wanted || alike == firsts.begin()) {
      result[static_cast<std::size_t>(alike - firsts.begin())].hosts.emplace_back(host.name);
    }
  }
  return result;
}

}  // namespace

Result<ModelPart> gltf_part(const GltfDocument& document, std::size_t mesh, std::span<const Host> hosts,
                            WatchedPart watched) {
  const Result<GltfShading> read = read_gltf_shading(document, mesh);
  if (!read) return read.error();
  const GltfShading& shading = read.value();
  const GltfMesh& described = document.meshes()[mesh];
  ModelPart part;
  part.name = described.name;
  part.mesh = mesh;
  for (const GltfPart& p : shading.parts)
    part.primitives.push_back(
        {p.primitive, p.first_vertex, p.vertex_count, !described.primitives[p.primitive].has_normals});
  const auto corners = shading.set.topology.corners();
  part.triangles.assign(corners.begin(), corners.end());
  part.elements = shading.groups.size();
  part.element = shading.element_of_vertex;
  part.weighting = watched.motions[0].subject.weighting;
  part.positions = shading.set.base;
  part.normals = shading.normals;
  part.target_names = described.target_names;
  part.target_names.resize(shading.set.targets.size());
  for (const BlendTarget& target : shading.set.targets) {
    part.targets.push_back({false, target.vertices, target.deltas});
    part.targets.back().drop_vertices_of(part.vertex_count());
  }
  part.mark = shading.mark;
  part.shown = shown_of(shading, hosts);
  part.motions = std::move(watched.motions);
  part.peaks = std::move(watched.peaks);
  return part;
}

}  // namespace chronormal::inline internal
