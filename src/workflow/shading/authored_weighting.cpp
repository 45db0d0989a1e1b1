#include "workflow/shading/authored_weighting.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kBlock = 1024;                // the number of elements in a block
constexpr double kTells = 0.1 / kDegreesPerRadian;  // radians; for such small angles the sine equals the angle
constexpr double kClear = 2.0 / 3;
constexpr double kFollows = 1;  // degrees: the largest distance of a weighting that the author may have used

using Stored = std::span<const StoredNormal>;  // stored normals in the order of their elements

// A small mesh to which some elements are copied, so that memory does not grow with the whole mesh. Each element gets
// its own copy of its faces. The element is one vertex of these faces, and no other element uses their other vertices.
class Block {
 public:
  Block(const Topology& topology, VectorView<const float> positions, const NormalGroups& groups, Stored stored) {
    std::vector<std::uint32_t> offsets = {0}, corners;
    std::vector<float> placed;
    const auto place = [&](std::uint32_t vertex) {
      const Vec3f p = positions[vertex];
      placed.insert(placed.end(), {p.x, p.y, p.z});
      return static_cast<std::uint32_t>(placed.size() / 3 - 1);
    };
    for (std::size_t i = 0; i < stored.size(); ++i) {
      const std::uint32_t element = stored[i].element;
      if (i > 0 && element == stored[i - 1].element) {
        own_.push_back(own_.back());
        continue;
      }
      const auto own_corners = groups.corners(element), faces = groups.faces(element);
      own_.push_back(own_corners.empty() ? kNone : place(topology.corners()[own_corners[0]]));
      for (std::size_t k = 0; k < faces.size(); ++k) {
        const std::span<const std::uint32_t> face = topology.face(faces[k]);
        const auto first = static_cast<std::size_t>(face.data() - topology.corners().data());
        for (std::size_t c = 0; c < face.size(); ++c)
          corners.push_back(first + c == own_corners[k] ? own_.back() : place(face[c]));
        offsets.push_back(static_cast<std::uint32_t>(corners.size()));
      }
    }
    topology_ = Topology::polygons(placed.size() / 3, std::move(offsets), std::move(corners)).value();
    positions_ = std::move(placed);
    groups_ = NormalGroups::of_vertices(topology_, separate_points(topology_.vertex_count()));
  }

  // Returns for each stored normal the normal that its element gets by a weighting of faces, or (0, 0, 0) if the
  // element has no normal.
  [[nodiscard]] std::vector<Vec3d> normals(Weighting weighting) const {
    const auto view = VectorView<const float>::packed(positions_.data(), topology_.vertex_count());
    const std::vector<Vec3d> all = all_weighted_normals_at({&topology_, view, view, 0, 1, 0}, groups_, weighting, 0);
    std::vector<Vec3d> result;
    for (const std::uint32_t own : own_) result.push_back(own == kNone ? Vec3d{} : all[own]);
    return result;
  }

 private:
  static constexpr std::uint32_t kNone = static_cast<std::uint32_t>(-1);

  std::vector<std::uint32_t> own_;  // for each stored normal, the vertex that represents its element
  Topology topology_;
  std::vector<float> positions_;
  NormalGroups groups_;
};

bool differ(const Vec3d& a, const Vec3d& b) {
  const Vec3d across = cross(a, b);
  const double along = dot(a, b);
  return dot(across, across) > kTells * kTells * dot(a, a) * dot(b, b) || along < 0;
}

// The angles between stored and computed normals, which are added up over blocks of elements.
struct Distances {
  std::array<WeightingDistance, kAllWeightings.size()> of_weightings;
  std::array<std::vector<float>, kWeightings.size()> told;  // distances in degrees, only of normals that tell
  std::size_t telling = 0;

  void add(std::size_t w, const StoredNormal& stored, double degrees) {
    WeightingDistance& distance = of_weightings[w];
    ++distance.count;
    distance.sum += degrees;
    if (degrees > distance.worst || (degrees == distance.worst && stored.vertex < distance.worst_at)) {
      distance.worst = degrees;
      distance.worst_at = stored.vertex;
    }
  }

  void add(const Distances& other) {
    telling += other.telling;
    for (std::size_t w = 0; w < kAllWeightings.size(); ++w) {
      WeightingDistance& distance = of_weightings[w];
      const WeightingDistance& more = other.of_weightings[w];
      distance.count += more.count;
      distance.sum += more.sum;
      if (more.worst > distance.worst || (more.worst == distance.worst && more.worst_at < distance.worst_at)) {
        distance.worst = more.worst;
        distance.worst_at = more.worst_at;
      }
      if (w < told.size()) told[w].insert(told[w].end(), other.told[w].begin(), other.told[w].end());
    }
  }
};

Distances distances_of(const Block& block, Stored stored) {
  Distances result;
  std::array<std::vector<Vec3d>, kAllWeightings.size()> normals;
  for (std::size_t w = 0; w < normals.size(); ++w) normals[w] = block.normals(kAllWeightings[w].weighting);
  for (std::size_t i = 0; i < stored.size(); ++i) {
    bool tells = false;
    for (std::size_t w = 1; w < kWeightings.size(); ++w) tells = tells || differ(normals[w][i], normals[0][i]);
    result.telling += tells ? 1U : 0U;
    for (std::size_t w = 0; w < normals.size(); ++w) {
      if (normals[w][i] == Vec3d{}) continue;
      // Ignores the side of the surface, because an author may show the other side.
      const double angle = angle_between(stored[i].normal, normals[w][i]) * kDegreesPerRadian;
      const double degrees = std::fmin(angle, 180 - angle);
      result.add(w, stored[i], degrees);
      if (tells && w < result.told.size()) result.told[w].push_back(static_cast<float>(degrees));
    }
  }
  return result;
}

double median(std::vector<float>& values) {
  if (values.empty()) return 0;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Compares stored normals with the normals of all weightings of a mesh.
Distances distances_of(const Topology& topology, VectorView<const float> positions, const NormalGroups& groups,
                       std::vector<StoredNormal> stored) {
  std::sort(stored.begin(), stored.end(), [](const StoredNormal& a, const StoredNormal& b) {
    return std::pair(a.element, a.vertex) < std::pair(b.element, b.vertex);
  });
  Distances all;
  const Stored sorted(stored);
  const std::size_t blocks = (sorted.size() + kBlock - 1) / kBlock;
  // The number of blocks that are examined at a time, because the results of blocks take memory.
  constexpr std::size_t kAtOnce = 64;
  for (std::size_t first = 0; first < blocks; first += kAtOnce) {
    std::vector<Distances> found(std::min(kAtOnce, blocks - first));
    parallel_for(found.size(), [&](std::size_t k) {
      const std::size_t begin = (first + k) * kBlock;
      const Stored part = sorted.subspan(begin, std::min(kBlock, sorted.size() - begin));
      found[k] = distances_of(Block(topology, positions, groups, part), part);
    });
    for (const Distances& of_block : found) all.add(of_block);
  }
  return all;
}

AuthoredWeighting weighting_of(Distances all) {
  AuthoredWeighting result;
  result.distances = all.of_weightings;
  result.telling = all.telling;
  std::size_t closest = 0;
  for (std::size_t w = 0; w < kWeightings.size(); ++w) {
    result.distances[w].of_telling = median(all.told[w]);
    if (result.distances[w].of_telling < result.distances[closest].of_telling) closest = w;
  }
  const double least = result.distances[closest].of_telling;
  if (least <= kFollows && least <= kClear * result.distances[0].of_telling)
    result.detected = kWeightings[closest].weighting;
  return result;
}

}  // namespace

AuthoredWeighting find_authored_weighting(const Topology& topology, VectorView<const float> positions,
                                          const NormalGroups& groups, std::vector<StoredNormal> stored) {
  return weighting_of(distances_of(topology, positions, groups, std::move(stored)));
}

AuthoredWeighting find_authored_weighting(
    const Topology& topology, const NormalGroups& groups, std::size_t keyframes,
    const std::function<std::optional<ShadedKeyframe>(std::size_t keyframe)>& read) {
  constexpr std::size_t kMostLater = 4;
  Distances all;
  AuthoredWeighting result;
  const std::size_t last = keyframes - 1, later = std::min(kMostLater, last);
  for (std::size_t i = 0; i <= later; ++i) {
    std::optional<ShadedKeyframe> keyframe = read(later == 0 ? 0 : last * i / later);
    if (!keyframe) continue;
    Distances found = distances_of(topology, keyframe->positions, groups, std::move(keyframe->stored));
    if (i == 0) result = weighting_of(found);
    all.add(found);
  }
  result.detected = weighting_of(std::move(all)).detected;
  return result;
}

double median_angle(const Topology& topology, VectorView<const float> positions, const NormalGroups& groups,
                    VectorView<const float> normal_of_corner) {
  const std::vector<Vec3d> normals =
      all_weighted_normals_at({&topology, positions, positions, 0, 1, 0}, groups, Weighting::kArea, 0);
  std::vector<float> angles;
  for (std::size_t e = 0; e < groups.size(); ++e) {
    if (groups.corners(e).empty()) continue;
    const Vec3d stored = to_double(normal_of_corner[groups.corners(e)[0]]);
    if (stored == Vec3d{} || !is_finite(stored) || normals[e] == Vec3d{}) continue;
    const double angle = angle_between(stored, normals[e]) * kDegreesPerRadian;
    angles.push_back(static_cast<float>(std::fmin(angle, 180 - angle)));
  }
  return median(angles);
}

AuthoredWeighting find_authored_weighting(const GltfShading& shading, std::size_t most) {
  const std::size_t vertices = shading.set.topology.vertex_count();
  const auto normal_of = [&](std::size_t v) {
    const float* const n = shading.normals.data() + 3 * v;
    return to_double(Vec3f{n[0], n[1], n[2]});
  };
  const auto is_stored = [&](std::size_t v) {
    return shading.element_of_vertex[v] != GltfShading::kNoElement && normal_of(v) != Vec3d{};
  };
  std::size_t count = 0;
  for (std::size_t v = 0; v < vertices; ++v) count += is_stored(v) ? 1U : 0U;
  const std::size_t step = count / most + 1;
  std::vector<StoredNormal> stored;
  stored.reserve(count / step + 1);
  for (std::size_t v = 0, seen = 0; v < vertices; ++v) {
    if (is_stored(v) && seen++ % step == 0)
      stored.push_back({static_cast<std::uint32_t>(v), shading.element_of_vertex[v], normal_of(v)});
  }
  const auto base = VectorView<const float>::packed(shading.set.base.data(), vertices);
  return find_authored_weighting(shading.set.topology, base, shading.groups, std::move(stored));
}

}  // namespace chronormal::inline internal
