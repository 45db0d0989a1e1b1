#include "workflow/shading/authored_weighting.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "core/blocks.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 1024;
constexpr double kTells = 0.1 / kDegreesPerRadian;  // radians, and small enough to be its own sine
constexpr double kClear = 2.0 / 3;
constexpr double kNone = -1;  // in place of an angle

// The angle of each stored normal to that of its element, in degrees.
std::vector<double> angles_to(std::span<const StoredNormal> stored, const std::vector<Vec3d>& normals) {
  std::vector<double> angles(stored.size());
  parallel_each(stored.size(), kBlock, [&](std::size_t i) {
    const Vec3d& normal = normals[stored[i].element];
    angles[i] = normal == Vec3d{} ? kNone : angle_between(stored[i].normal, normal) * kDegreesPerRadian;
  });
  return angles;
}

WeightingDistance distance_of(std::span<const StoredNormal> stored, const std::vector<double>& angles) {
  WeightingDistance result;
  for (std::size_t i = 0; i < angles.size(); ++i) {
    if (angles[i] == kNone) continue;
    ++result.count;
    result.sum += angles[i];
    if (angles[i] > result.worst) {
      result.worst = angles[i];
      result.worst_at = stored[i].vertex;
    }
  }
  return result;
}

bool differ(const Vec3d& a, const Vec3d& b) {
  const Vec3d across = cross(a, b);
  const double along = dot(a, b);
  return dot(across, across) > kTells * kTells * dot(a, a) * dot(b, b) || along < 0;
}

double median_of_telling(std::span<const StoredNormal> stored, const std::vector<char>& tells,
                         const std::vector<float>& angles) {
  std::vector<float> told;
  for (std::size_t i = 0; i < angles.size(); ++i)
    if (tells[stored[i].element] != 0 && angles[i] >= 0) told.push_back(angles[i]);
  if (told.empty()) return 0;
  const auto middle = told.begin() + static_cast<std::ptrdiff_t>(told.size() / 2);
  std::nth_element(told.begin(), middle, told.end());
  return *middle;
}

}  // namespace

AuthoredWeighting find_authored_weighting(const Topology& topology, VectorView<const float> positions,
                                          const NormalGroups& groups, std::span<const StoredNormal> stored) {
  AuthoredWeighting result;
  if (stored.empty()) return result;
  const Segment still{&topology, positions, positions, 0, 1, 0};
  std::vector<Vec3d> by_area;
  std::vector<char> tells(groups.size());  // of each element
  std::array<std::vector<float>, kWeightings.size()> angles;
  for (std::size_t w = 0; w < kWeightings.size(); ++w) {
    std::vector<Vec3d> normals = all_weighted_normals_at(still, groups, kWeightings[w].weighting, 0);
    const std::vector<double> of_weighting = angles_to(stored, normals);
    result.distances[w] = distance_of(stored, of_weighting);
    angles[w].assign(of_weighting.begin(), of_weighting.end());
    if (w == 0) {
      by_area = std::move(normals);
      continue;
    }
    parallel_each(normals.size(), kBlock, [&](std::size_t e) {
      if (differ(normals[e], by_area[e])) tells[e] = 1;
    });
  }
  for (const StoredNormal& normal : stored) result.telling += tells[normal.element] != 0 ? 1U : 0U;
  std::size_t closest = 0;
  for (std::size_t w = 0; w < kWeightings.size(); ++w) {
    result.distances[w].of_telling = median_of_telling(stored, tells, angles[w]);
    if (result.distances[w].of_telling < result.distances[closest].of_telling) closest = w;
  }
  if (result.distances[closest].of_telling <= kClear * result.distances[0].of_telling)
    result.detected = kWeightings[closest].weighting;
  return result;
}

AuthoredWeighting find_authored_weighting(const GltfShading& shading) {
  const std::size_t vertices = shading.set.topology.vertex_count();
  std::vector<StoredNormal> stored;
  for (std::uint32_t v = 0; v < vertices; ++v) {
    const float* const n = shading.normals.data() + 3 * std::size_t{v};
    const Vec3d normal = to_double(Vec3f{n[0], n[1], n[2]});
    if (shading.element_of_vertex[v] != GltfShading::kNoElement && normal != Vec3d{})
      stored.push_back({v, shading.element_of_vertex[v], normal});
  }
  return find_authored_weighting(
      shading.set.topology, VectorView<const float>::packed(shading.set.base.data(), vertices), shading.groups, stored);
}

}  // namespace chronormal::inline internal
