#include "chronormal/normals/weighting.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <string>

#include "core/blocks.h"
#include "core/vector_area.h"
#include "normals/control/exact_curve.h"
#include "normals/control/local_time.h"
#include "normals/weighting/corner_terms.h"
#include "normals/weighting/shared_weighting.h"

namespace chronormal {
namespace {

constexpr std::size_t kElementsAtOnce = 1024;

// The largest relative error of the normal of a face, and the largest angle, in radians, by which such errors may turn
// a sum of faces. The angle 2^-23 = 1.2e-7 rad is only exceeded if faces cancel so far that their sum is shorter than a
// hundredth of the sum of their lengths.
constexpr double kFaceError = 0x1p-30, kLargestAngle = 0x1p-23;

// Returns the normal of a face. The normal is computed in double, or in integers if double is not precise enough.
Vec3d face_normal_at(const Segment& segment, std::span<const std::uint32_t> face, const LocalTime& t) {
  Vec3d n;
  double size = 0;
  const auto edge_to = [&](std::size_t c) { return MovingEdge::at(segment, face[0], face[c], t); };
  for_fan(face.size(), edge_to, [&](const MovingEdge& e, const MovingEdge& f) {
    n = n + cross(e.vector, f.vector);
    size += e.size * f.size;
  });
  const double error = kCrossError * (static_cast<double>(face.size() - 2) * size);
  return error < kFaceError * max_abs(n) ? n : ExactCurve::of_polygon(segment, face).normal_at(t);
}

}  // namespace

std::string_view weighting_name(Weighting weighting) noexcept {
  for (const WeightingInfo& info : kAllWeightings) {
    if (info.weighting == weighting) return info.name;
  }
  return "";
}

Result<Weighting> make_weighting(std::string_view name) {
  for (const WeightingInfo& info : kAllWeightings) {
    if (info.name == name) return info.weighting;
  }
  std::string message = "there is no weighting '";
  message += name;
  message += "'; choose one of";
  for (const WeightingInfo& info : kAllWeightings) {
    message += info.weighting == kAllWeightings.front().weighting ? " " : ", ";
    message += info.name;
  }
  return Error{ErrorCode::kUsage, "", std::move(message)};
}

void face_normals_at(const Segment& segment, const LocalTime& time, IndexRange faces,
                     std::span<Vec3d> result) noexcept {
  assert(result.size() == faces.count && faces.end() <= segment.topology->face_count());
  const LocalTime t = local_time(time);
  if (std::isnan(t.t)) return std::fill(result.begin(), result.end(), Vec3d{});
  for (std::size_t i = 0; i < faces.count; ++i)
    result[i] = face_normal_at(segment, segment.topology->face(faces.first + i), t);
}

void weighted_normals_at(const Segment& segment, const NormalGroups& groups, Weighting weighting, const LocalTime& t,
                         std::span<const Vec3d> of_faces, IndexRange elements, std::span<Vec3d> result) noexcept {
  weighted_normals_at(SharedFaces(segment), groups, weighting, t, of_faces, elements, result);
}

inline namespace internal {

void weighted_normals_at(const SharedFaces& shared, const NormalGroups& groups, Weighting weighting,
                         const LocalTime& time, std::span<const Vec3d> of_faces, IndexRange elements,
                         std::span<Vec3d> result) noexcept {
  const Segment& segment = shared.segment();
  assert(result.size() == elements.count && elements.end() <= groups.size());
  assert(of_faces.size() == segment.topology->face_count());
  const LocalTime t = local_time(time);
  if (std::isnan(t.t)) return std::fill(result.begin(), result.end(), Vec3d{});
  for (std::size_t i = 0; i < elements.count; ++i) {
    const auto corners = groups.corners(elements.first + i), faces = groups.faces(elements.first + i);
    Vec3d sum;
    double size = 0;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      const Vec3d& n = of_faces[faces[c]];
      if (n == Vec3d{}) continue;
      const Vec3d term =
          corner_term(segment, corner_vertices(*segment.topology, corners[c], faces[c]), n, weighting, t);
      sum = sum + term;
      size += max_abs(term);
    }
    const bool is_exact = weighting == Weighting::kArea && !(kFaceError * size < kLargestAngle * max_abs(sum));
    result[i] = is_exact ? shared.exact_sum(faces).normal_at(t) : without_rounding(sum, kCrossError * size);
  }
}

std::vector<Vec3d> all_weighted_normals_at(const Segment& segment, const NormalGroups& groups, Weighting weighting,
                                           const LocalTime& t, std::span<const Vec3d> of_faces) {
  const SharedFaces shared(segment);
  std::vector<Vec3d> result(groups.size());
  parallel_blocks(result.size(), kElementsAtOnce, [&](IndexRange elements) {
    weighted_normals_at(shared, groups, weighting, t, of_faces, elements,
                        std::span(result).subspan(elements.first, elements.count));
  });
  return result;
}

}  // namespace internal

std::vector<Vec3d> all_weighted_normals_at(const Segment& segment, const NormalGroups& groups, Weighting weighting,
                                           const LocalTime& t) {
  std::vector<Vec3d> of_faces(segment.topology->face_count());
  parallel_blocks(of_faces.size(), kElementsAtOnce, [&](IndexRange faces) {
    face_normals_at(segment, t, faces, std::span(of_faces).subspan(faces.first, faces.count));
  });
  return all_weighted_normals_at(segment, groups, weighting, t, of_faces);
}

}  // namespace chronormal
