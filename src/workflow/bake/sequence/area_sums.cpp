// Computes vector areas of faces, and their sums around elements, from rows of points, block by block
// (normals/groups/kernels/vector_areas.h). Polygons with more than three corners are computed one by one.
#include "workflow/bake/sequence/area_sums.h"

#include <algorithm>
#include <array>

#include "core/blocks.h"
#include "core/rounding.h"
#include "core/vector_area.h"
#include "normals/groups/kernels/vector_areas.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kAreaBlock = 4096;  // the number of elements in a block
// The number of faces in a block, if the areas of all faces are computed before the sums.
constexpr std::size_t kAreaFaces = 8 * kAreaBlock;

IndexRange faces_around(const NormalGroups& groups, IndexRange elements) {
  std::uint32_t first = ~std::uint32_t{0}, end = 0;
  for (std::size_t e = elements.first; e < elements.end(); ++e) {
    for (const std::uint32_t f : groups.faces(e)) {
      first = std::min(first, f);
      end = std::max(end, f + 1);
    }
  }
  return end == 0 ? IndexRange{} : IndexRange{first, end - first};
}

// Returns the normal of a polygon, with twice its area as length. Components that are only rounding errors become zero.
Vec3d polygon_area(std::span<const std::uint32_t> face, const double* points) {
  const auto point = [&](std::size_t c) {
    const double* const row = points + kAreaRow * std::size_t{face[c]};
    return Vec3d{row[0], row[1], row[2]};
  };
  CrossSum sum;
  const Vec3d a = point(0);
  for_fan(
      face.size(), [&](std::size_t c) { return point(c) - a; },
      [&sum](const Vec3d& e, const Vec3d& f) { sum.add(e, f); });
  return sum.without_rounding();
}

}  // namespace

AreaSums::AreaSums(const Topology& topology, const NormalGroups& groups)
    : topology_(&topology), groups_(&groups), faces_of_block_(block_count(groups.size(), kAreaBlock)) {
  numbered_blocks(groups.size(), kAreaBlock, [&](std::size_t b, std::size_t first, std::size_t end) {
    faces_of_block_[b] = faces_around(groups, {first, end - first});
  });
  std::size_t computed = 0;
  for (const IndexRange& faces : faces_of_block_) computed += faces.count;
  are_scattered_ = computed > 2 * topology.face_count();
}

void AreaSums::write_areas(const PointRows& points, IndexRange faces, double* areas) const {
  if (topology_->all_triangles())
    return triangle_areas(points.data(), topology_->corners().subspan(3 * faces.first, 3 * faces.count), areas);
  for (std::size_t f = faces.first; f < faces.end(); ++f, areas += kAreaRow) {
    const Vec3d area = polygon_area(topology_->face(f), points.data());
    const std::array<double, kAreaRow> row = {area.x, area.y, area.z, 0};
    std::copy(row.begin(), row.end(), areas);
  }
}

void AreaSums::settle(const double* areas, std::size_t first_face, IndexRange elements, const Exact& exact,
                      std::span<Vec3d> sums) const {
  constexpr double kMostCancelled = 0x1p20;
  for (std::size_t i = 0; i < elements.count; ++i) {
    double size = 0;
    for (const std::uint32_t f : groups_->faces(elements.first + i)) {
      const double* const row = areas + kAreaRow * (f - first_face);
      size += max_abs(Vec3d{row[0], row[1], row[2]});
    }
    if (size > 0 && !(kMostCancelled * max_abs(sums[i]) > size)) sums[i] = exact(elements.first + i);
  }
}

void AreaSums::each_block(const PointRows& a, const PointRows* b, const Exact& of_a, const Exact& of_b,
                          const Body& body) const {
  const std::array<const PointRows*, 2> points = {&a, b};
  const std::array<const Exact*, 2> exact = {&of_a, &of_b};
  std::array<AlignedArray<double>, 2> all;  // the areas of all faces, for the points a and for the points b
  for (std::size_t k = 0; k < points.size() && are_scattered_; ++k) {
    if (points[k] == nullptr) continue;
    all[k] = AlignedArray<double>(kAreaRow * topology_->face_count());
    parallel_blocks(topology_->face_count(), kAreaFaces,
                    [&](IndexRange faces) { write_areas(*points[k], faces, all[k].data() + kAreaRow * faces.first); });
  }
  parallel_for(faces_of_block_.size(), [&](std::size_t block) {
    const IndexRange elements{block * kAreaBlock, std::min(kAreaBlock, groups_->size() - block * kAreaBlock)};
    const IndexRange faces = faces_of_block_[block];
    AlignedArray<double> near(are_scattered_ ? 0 : kAreaRow * faces.count);
    std::array<std::vector<Vec3d>, 2> sums;
    for (std::size_t k = 0; k < points.size(); ++k) {
      if (points[k] == nullptr) continue;
      sums[k].resize(elements.count);
      if (!are_scattered_) write_areas(*points[k], faces, near.data());
      const double* const areas = are_scattered_ ? all[k].data() : near.data();
      const std::size_t first_face = are_scattered_ ? 0 : faces.first;
      sums_of_areas(areas, first_face, *groups_, elements, sums[k].data());
      if (*exact[k]) settle(areas, first_face, elements, *exact[k], sums[k]);
    }
    body(elements, sums[0], sums[1]);
  });
}

}  // namespace chronormal::inline internal
