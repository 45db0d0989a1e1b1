// Answers the query `cones`. The answer has a cone that contains every normal of a face during a motion, and bounds of
// meshlets for culling that hold for the whole motion.

#include "chronormal/analysis/cones.h"

#include <meshoptimizer.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "chronormal/workflow/query.h"
#include "workflow/query/parts.h"

namespace chronormal {
namespace {

constexpr std::size_t kMostTriangles = 512;  // the largest number that meshoptimizer allows for a meshlet
// The weight, from 0 to 1, with which meshoptimizer prefers meshlets whose faces point in similar directions, since
// such meshlets are culled more often.
constexpr float kConeWeight = 0.5F;

// Returns the half angle of a cone in degrees, rounded up.
double degrees_of(const NormalCone& cone) { return half_angle(cone) * kDegreesPerRadian * (1 + 0x1p-48); }

struct Meshlets {
  std::vector<std::uint32_t> faces, offsets = {0};  // the faces of all meshlets, one meshlet after the other

  [[nodiscard]] std::size_t size() const { return offsets.size() - 1; }
  [[nodiscard]] std::span<const std::uint32_t> operator[](std::size_t m) const {
    return std::span(faces).subspan(offsets[m], offsets[m + 1] - offsets[m]);
  }
};

// Builds meshlets with meshoptimizer. Also finds their faces, because meshoptimizer returns only the corners of
// triangles and may rotate these corners.
Meshlets build_meshlets(const Motion& motion, std::size_t most_triangles) {
  const std::span<const std::uint32_t> corners = motion.topology.corners();
  const std::vector<float>& positions = motion.keyframes.front().positions;
  constexpr std::size_t kMostVertices = 255;
  const std::size_t most = meshopt_buildMeshletsBound(corners.size(), kMostVertices, most_triangles);
  std::vector<meshopt_Meshlet> meshlets(most);
  std::vector<unsigned> vertices(most * kMostVertices);
  std::vector<unsigned char> triangles(most * most_triangles * 3);
  meshlets.resize(meshopt_buildMeshlets(meshlets.data(), vertices.data(), triangles.data(), corners.data(),
                                        corners.size(), positions.data(), positions.size() / 3, 3 * sizeof(float),
                                        kMostVertices, most_triangles, kConeWeight));
  using Triangle = std::array<std::uint32_t, 3>;
  const auto from_the_lowest = [](Triangle triangle) {
    std::rotate(triangle.begin(), std::min_element(triangle.begin(), triangle.end()), triangle.end());
    return triangle;
  };
  std::vector<std::pair<Triangle, std::uint32_t>> faces;
  for (std::size_t f = 0; 3 * f < corners.size(); ++f)
    faces.push_back(
        {from_the_lowest({corners[3 * f], corners[3 * f + 1], corners[3 * f + 2]}), static_cast<std::uint32_t>(f)});
  std::sort(faces.begin(), faces.end());
  std::vector<std::uint8_t> taken(faces.size());
  Meshlets result;
  for (const meshopt_Meshlet& meshlet : meshlets) {
    for (std::size_t i = 0; i < meshlet.triangle_count; ++i) {
      const unsigned char* const local = &triangles[meshlet.triangle_offset + 3 * i];
      const unsigned* const global = &vertices[meshlet.vertex_offset];
      const Triangle triangle = from_the_lowest({global[local[0]], global[local[1]], global[local[2]]});
      // If several faces have the same corners, takes a face that was not taken before.
      auto found = std::lower_bound(faces.begin(), faces.end(), std::pair{triangle, std::uint32_t{0}});
      while (taken[found->second] != 0) ++found;
      taken[found->second] = 1;
      result.faces.push_back(found->second);
    }
    result.offsets.push_back(static_cast<std::uint32_t>(result.faces.size()));
  }
  return result;
}

// Makes a table with the columns of meshopt_Bounds, and with a row for each meshlet in each segment.
QueryTable meshlet_table(const Motion& motion, const Meshlets& meshlets, std::span<const SegmentPart> parts,
                         const QueryProgress& progress) {
  const std::vector<std::vector<ClusterBounds>> found =
      for_parts<std::vector<ClusterBounds>>(parts, progress, [&](const SegmentPart& part) {
        std::vector<ClusterBounds> bounds;
        for (std::size_t m = 0; m < meshlets.size(); ++m)
          bounds.push_back(cluster_bounds(motion.segment(part.segment), meshlets[m], part.t0, part.t1));
        return bounds;
      });
  std::vector<std::int64_t> segments, numbers, cutoffs_s8, axes_s8;
  std::vector<float> centers, radii, apexes, axes, cutoffs;
  for (std::size_t p = 0; p < found.size(); ++p) {
    for (std::size_t m = 0; m < found[p].size(); ++m) {
      const ClusterBounds& b = found[p][m];
      segments.push_back(static_cast<std::int64_t>(parts[p].segment));
      numbers.push_back(static_cast<std::int64_t>(m));
      centers.insert(centers.end(), std::begin(b.center), std::end(b.center));
      radii.push_back(b.radius);
      apexes.insert(apexes.end(), std::begin(b.cone_apex), std::end(b.cone_apex));
      axes.insert(axes.end(), std::begin(b.cone_axis), std::end(b.cone_axis));
      cutoffs.push_back(b.cone_cutoff);
      axes_s8.insert(axes_s8.end(), std::begin(b.cone_axis_s8), std::end(b.cone_axis_s8));
      cutoffs_s8.push_back(b.cone_cutoff_s8);
    }
  }
  return {"meshlet",
          "bounds of meshlets, in the format of meshoptimizer",
          {{"segment", std::move(segments)},
           {"index", std::move(numbers)},
           {"center", std::move(centers), 3},
           {"radius", std::move(radii)},
           {"cone_apex", std::move(apexes), 3},
           {"cone_axis", std::move(axes), 3},
           {"cone_cutoff", std::move(cutoffs)},
           {"cone_axis_s8", std::move(axes_s8), 3},
           {"cone_cutoff_s8", std::move(cutoffs_s8)}}};
}

QueryTable member_table(const Meshlets& meshlets) {
  std::vector<std::int64_t> index, faces(meshlets.faces.begin(), meshlets.faces.end());
  for (std::size_t m = 0; m < meshlets.size(); ++m)
    index.insert(index.end(), meshlets[m].size(), static_cast<std::int64_t>(m));
  return {"member", "the faces of each meshlet", {{"meshlet", std::move(index)}, {"face", std::move(faces)}}};
}

Status check_meshlets(const Motion& motion, std::size_t most_triangles) {
  if (most_triangles < 4 || most_triangles > kMostTriangles || most_triangles % 4 != 0)
    return Error{ErrorCode::kUsage, "--meshlets", "the number of triangles must be a multiple of 4, from 4 to 512"};
  if (!motion.topology.all_triangles())
    return Error{ErrorCode::kUsage, "--meshlets",
                 "meshlets need a mesh of triangles, but this mesh has faces with more than three corners; triangulate "
                 "it first"};
  return Success{};
}

}  // namespace

Result<QueryAnswer> query_cones(const Motion& motion, std::optional<std::size_t> meshlets, const QuerySpan& span,
                                const QueryProgress& progress) {
  const Result<std::vector<SegmentPart>> parts = segment_parts(motion, span);
  if (!parts) return parts.error();
  if (meshlets) {
    if (const Status status = check_meshlets(motion, *meshlets); !status) return status.error();
  }
  constexpr std::uint64_t kBytesPerRow = 2 * sizeof(std::int64_t) + 4 * sizeof(float) + sizeof(double);
  if (const Status status = check_rows(motion.topology.face_count(), "face", parts.value(), kBytesPerRow, span);
      !status)
    return status.error();
  const std::size_t count = motion.topology.face_count();
  const std::vector<std::vector<NormalCone>> found =
      for_parts<std::vector<NormalCone>>(parts.value(), progress, [&](const SegmentPart& part) {
        std::vector<NormalCone> cones(count);
        face_normal_cones(motion.segment(part.segment), {0, count}, part.t0, part.t1, cones);
        return cones;
      });

  std::vector<std::int64_t> segments, faces;
  std::vector<float> axes, sines;
  std::vector<double> half_angles;
  std::size_t whole = 0, empty = 0;
  double sum = 0, largest = 0;
  for (std::size_t p = 0; p < found.size(); ++p) {
    for (std::size_t f = 0; f < count; ++f) {
      const NormalCone& cone = found[p][f];
      segments.push_back(static_cast<std::int64_t>(parts.value()[p].segment));
      faces.push_back(static_cast<std::int64_t>(f));
      axes.insert(axes.end(), {cone.axis.x, cone.axis.y, cone.axis.z});
      sines.push_back(cone.sine);
      half_angles.push_back(degrees_of(cone));
      whole += cone.is_whole_sphere() ? 1U : 0U;
      empty += cone.is_empty() ? 1U : 0U;
      if (cone.is_whole_sphere() || cone.is_empty()) continue;
      sum += half_angles.back();
      largest = std::max(largest, half_angles.back());
    }
  }
  const auto number = [](std::size_t value) { return static_cast<double>(value); };
  const std::size_t narrow = faces.size() - whole - empty;
  QueryAnswer answer{
      "cones",
      {{"segments", worded(parts.value().size(), "segment examined", "segments examined"),
        number(parts.value().size())},
       {"faces", worded(count, "face in each segment", "faces in each segment"), number(count)},
       {"whole_sphere", worded(whole, "cone that covers the whole sphere", "cones that cover the whole sphere"),
        number(whole)},
       {"empty",
        worded(empty, "empty cone, of a face that never has an area", "empty cones, of faces that never have an area"),
        number(empty)},
       {"mean_half_angle", "average half-angle in degrees, of the cones that are neither empty nor the whole sphere",
        narrow == 0 ? 0 : sum / number(narrow)},
       {"largest_half_angle", "largest half-angle in degrees, of the cones that are neither empty nor the whole sphere",
        largest}},
      {{"",
        "cones that contain every normal of a face, half-angles in degrees",
        {{"segment", std::move(segments)},
         {"face", std::move(faces)},
         {"axis", std::move(axes), 3},
         {"sine", std::move(sines)},
         {"half_angle", std::move(half_angles)}}}}};
  if (meshlets) {
    const Meshlets built = build_meshlets(motion, *meshlets);
    answer.facts.push_back({"meshlets", "meshlets", number(built.size())});
    answer.tables.push_back(meshlet_table(motion, built, parts.value(), progress));
    answer.tables.push_back(member_table(built));
  }
  return answer;
}

}  // namespace chronormal
