#include <algorithm>
#include <utility>

#include "workflow/audit/blend_source.h"
#include "workflow/report/report_parts.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/truth/author_truth.h"

namespace chronormal::inline internal {
namespace {

// Returns the vectors that are not zero, with the indices of their vertices. If no vector is zero, returns all vectors,
// without indices.
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

// Returns the normals and deltas of a mesh as one viewer stores them. A viewer that follows the specification stores
// the values of the file.
ModelShown shown_by(const GltfShading& shading, const Viewer& viewer) {
  ModelShown shown;
  shown.keeps_halves = viewer.keeps_halves();
  shown.least_weight = viewer.least_weight;
  shown.normals = shading.normals;
  for (const std::vector<float>& deltas : shading.normal_deltas) shown.targets.push_back(without_zeros(deltas));
  if (viewer.normals == NormalRule::kSum && viewer.bits == 32) return shown;
  const auto put = [](const Vec3f& vector, float* to) { std::copy_n(&vector.x, 3, to); };
  for (std::size_t v = 0; 3 * v < shown.normals.size(); ++v)
    put(kept_normal(viewer, vector_at(shading.normals, v)), &shown.normals[3 * v]);
  for (ModelVectors& target : shown.targets) {
    for (std::size_t i = 0; i < target.size(); ++i) {
      const Vec3f normal = vector_at(shading.normals, target.vertex(i)), delta = vector_at(target.values, i);
      put(kept_delta(viewer, normal, delta), &target.values[3 * i]);
    }
  }
  return shown;
}

bool show_alike(const Viewer& a, const Viewer& b) noexcept {
  return a.normals == b.normals && a.bits == b.bits && a.by_frame == b.by_frame &&
         a.octahedral_base == b.octahedral_base && a.least_weight == b.least_weight;
}

// Returns the normals of a mesh as viewers store them, with one entry for all viewers that store the same values. The
// first entry is for the specification, with the names of all viewers that store the values of the file. The other
// entries are for the other viewers in `viewers`.
std::vector<ModelShown> shown_of(const GltfShading& shading, std::span<const Viewer> viewers) {
  const Viewer specification{.name = "specification", .title = ""};
  std::vector<Viewer> firsts = {specification};
  std::vector<ModelShown> result = {shown_by(shading, specification)};
  result[0].viewers.emplace_back(specification.name);
  for (const Viewer& viewer : kViewers) {
    const auto alike =
        std::find_if(firsts.begin(), firsts.end(), [&](const Viewer& h) { return show_alike(h, viewer); });
    const bool is_wanted = std::find(viewers.begin(), viewers.end(), viewer) != viewers.end();
    if (alike == firsts.end() && !is_wanted) continue;
    if (alike == firsts.end()) {
      firsts.push_back(viewer);
      result.push_back(shown_by(shading, viewer));
      result.back().viewers.emplace_back(viewer.name);
    } else if (is_wanted || alike == firsts.begin()) {
      result[static_cast<std::size_t>(alike - firsts.begin())].viewers.emplace_back(viewer.name);
    }
  }
  return result;
}

// Adds the polygons whose normals are summed up to true normals. If elements sum up other corners than their own, also
// adds the corners of each element.
void add_sums(const AuthorTruth& truth, const GltfShading& shading, ModelTruth& result) {
  const AuthorSums& sums = truth.sums();
  result.first = {0};
  for (std::size_t p = 0; p < sums.polygon_count(); ++p) {
    const std::span<const std::uint32_t> loop = sums.polygon(p);
    result.corners.insert(result.corners.end(), loop.begin(), loop.end());
    result.first.push_back(static_cast<std::uint32_t>(result.corners.size()));
  }
  if (!truth.rule().any_whole_point && shading.at_the_back.empty()) return;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> terms;
  for (std::uint32_t e = 0; e < shading.groups.size(); ++e)
    sums.for_corners(e, [&](std::uint32_t p, std::uint32_t c) { terms.emplace_back(result.first[p] + c, e); });
  std::sort(terms.begin(), terms.end());
  for (const auto& [corner, element] : terms) result.terms.insert(result.terms.end(), {corner, element});
}

void add_offsets(const AuthorTruth& truth, std::size_t targets, ModelTruth& result) {
  result.offsets.resize(truth.frames().size());
  for (std::uint32_t e = 0; e < truth.frame_of_element().size(); ++e) {
    const std::uint32_t n = truth.frame_of_element()[e];
    if (n == AuthorTruth::kNone) continue;
    const AuthorTruth::Frame& frame = truth.frames()[n];
    ModelOffset& offset = result.offsets[n];
    offset.element = e;
    offset.is_other_side = frame.side < 0;
    for (const OffsetEdge& edge : truth.edges().subspan(frame.first_edge, frame.edge_count))
      offset.edges.insert(offset.edges.end(), {edge.from, edge.to});
    const Vec3d &z = frame.base_z, &x = frame.base_x;
    if (frame.edge == AuthorTruth::kNone)
      offset.turned = {z.x, z.y, z.z, x.x, x.y, x.z};
    else
      offset.reference = frame.edge - frame.first_edge;
    offset.base = {static_cast<float>(frame.base.x), static_cast<float>(frame.base.y)};
  }
  if (result.offsets.empty()) return;
  result.changes.resize(targets);
  for (std::size_t k = 0; k < truth.changes().size(); ++k) {
    for (const AuthorTruth::Change& change : truth.changes()[k]) {
      result.changes[k].offsets.push_back(change.frame);
      result.changes[k].values.insert(result.changes[k].values.end(),
                                      {static_cast<float>(change.by.x), static_cast<float>(change.by.y)});
    }
  }
}

}  // namespace

Result<ModelPart> gltf_part(const GltfDocument& document, std::size_t mesh, std::optional<Weighting> asked,
                            std::span<const Viewer> viewers, WatchedPart watched) {
  Result<GltfShading> read = read_gltf_shading(document, mesh);
  if (!read) return read.error();
  GltfShading& shading = read.value();
  const AuthorTruth truth = author_truth(shading, asked);
  const GltfMesh& described = document.meshes()[mesh];
  ModelPart part;
  part.name = described.name;
  part.mesh = mesh;
  for (const GltfPart& p : shading.parts)
    part.primitives.push_back(
        {p.primitive, p.first_vertex, p.vertex_count, !described.primitives[p.primitive].has_normals});
  const auto corners = shading.set.topology.corners();
  part.triangles.assign(corners.begin(), corners.end());
  for (std::uint32_t c = 0; c < shading.at_the_back.size(); ++c)
    if (shading.at_the_back[c]) part.backs.push_back(c);
  part.elements = shading.groups.size();
  part.element = shading.element_of_vertex;
  part.weighting = truth.rule().weighting;
  part.positions = shading.set.base;
  part.normals = shading.normals;
  part.target_names = described.target_names;
  part.target_names.resize(shading.set.targets.size());
  for (const BlendTarget& target : shading.set.targets) {
    part.targets.push_back({false, target.vertices, target.deltas});
    part.targets.back().drop_vertices_of(part.vertex_count());
  }
  part.mark = shading.mark;
  part.shown = shown_of(shading, viewers);
  if (truth.rule().any_polygons || truth.rule().any_whole_point) add_sums(truth, shading, part.truth);
  add_offsets(truth, part.targets.size(), part.truth);
  part.motions = std::move(watched.motions);
  part.peaks = std::move(watched.peaks);
  return part;
}

}  // namespace chronormal::inline internal
