#include "io/gltf/glb/glb_targets.h"

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/normal_groups.h"
#include "core/vector_area.h"
#include "io/gltf/glb/glb_builder.h"
#include "motion/triangles.h"

namespace chronormal::inline internal {
namespace {

using Json = nlohmann::ordered_json;

std::vector<float> base_normals(const Motion& motion, bool weld) {
  const Points points = weld ? weld_coincident(motion) : separate_points(motion.topology.vertex_count());
  const std::vector<float>& base = motion.keyframes[0].positions;
  const auto positions = VectorView<const float>::packed(base.data(), base.size() / 3);
  std::vector<Vec3d> of_points(points.count);
  for (std::size_t f = 0; f < motion.topology.face_count(); ++f) {
    const auto face = motion.topology.face(f);
    const Vec3d area = twice_vector_area(face.size(), [&](std::size_t c) { return to_double(positions[face[c]]); });
    for (const std::uint32_t v : face) {
      Vec3d& sum = of_points[points.point_of_vertex[v]];
      sum = sum + area;
    }
  }
  std::vector<float> normals(base.size());
  const auto result = VectorView<float>::packed(normals.data(), normals.size() / 3);
  for (std::size_t v = 0; v < result.count; ++v) {
    const Vec3d normal = unit(of_points[points.point_of_vertex[v]]);
    result.set(v, to_float(normal == Vec3d{} ? Vec3d{0, 0, 1} : normal));
  }
  return normals;
}

}  // namespace

Result<std::string> write_glb_targets(const Motion& motion, bool weld) {
  assert(motion.kind == MotionKind::kTargets);
  GlbBuilder builder;
  const std::vector<float>& base = motion.keyframes[0].positions;
  const std::size_t triangles =
      builder.set_triangles(cut_polygons(motion.topology, base, motion.topology.corners()), base.size() / 3);
  const Json attributes = {{"POSITION", builder.add_vectors(base, {true, true})},
                           {"NORMAL", builder.add_vectors(base_normals(motion, weld), {false, true})}};
  Json targets = Json::array(), names = Json::array(), weights = Json::array();
  for (std::size_t k = 1; k < motion.keyframes.size(); ++k) {
    std::vector<float> deltas = motion.keyframes[k].positions;
    for (std::size_t i = 0; i < deltas.size(); ++i) deltas[i] -= base[i];
    targets.push_back({{"POSITION", builder.add_vectors(deltas, {true, false})}});
    const std::string& name = motion.keyframes[k].name;
    names.push_back(name.empty() ? "target " + std::to_string(k - 1) : name);
    weights.push_back(0);
  }
  const Json primitive = {{"attributes", attributes}, {"indices", triangles}, {"targets", targets}};
  Json& document = builder.document();
  document["scene"] = 0;
  document["scenes"] = Json::array({{{"nodes", Json::array({0})}}});
  Json node = {{"mesh", 0}};
  if (motion.origin != std::array<double, 3>{}) node["translation"] = motion.origin;
  document["nodes"] = Json::array({std::move(node)});
  document["meshes"] = Json::array({{{"name", motion.keyframes[0].name},
                                     {"primitives", Json::array({primitive})},
                                     {"weights", weights},
                                     {"extras", {{"targetNames", names}}}}});
  return builder.finish();
}

}  // namespace chronormal::inline internal
