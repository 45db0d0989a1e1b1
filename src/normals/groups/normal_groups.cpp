#include "chronormal/normals/normal_groups.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>

#include "chronormal/normals/control_normals.h"
#include "core/portable_math.h"
#include "core/text.h"
#include "normals/groups/corner_sets.h"
#include "normals/groups/rings.h"
#include "normals/groups/sides.h"

namespace chronormal {
namespace {

constexpr double kRadiansPerDegree = 1 / kDegreesPerRadian;

// The error, in radians, that rounding positions to float32 may cause in the angle at an edge.
constexpr double kCreaseRounding = 1e-6;

// The largest number of faces at a smooth edge. Edges with more faces are always hard. The limit bounds the time,
// because all pairs of faces at an edge are compared.
constexpr std::size_t kMostFacesAtSmoothEdge = 16;

// Returns the faces in an order that follows from their vertices alone. Faces with the same vertices in the same order
// may come in any order, since their normals have the same bits.
std::vector<std::uint32_t> faces_by_vertices(const Topology& topology) {
  std::vector<std::uint32_t> order(topology.face_count());
  std::iota(order.begin(), order.end(), 0U);
  std::sort(order.begin(), order.end(), [&topology](std::uint32_t a, std::uint32_t b) {
    const auto p = topology.face(a), q = topology.face(b);
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
  });
  return order;
}

std::vector<Vec3d> unit_face_normals(const Segment& still) {
  std::vector<Vec3d> normals(still.topology->face_count());
  for (std::size_t f = 0; f < normals.size(); ++f) {
    ControlNormals control;
    face_control_normals(still, {f, 1}, {&control, 1});
    normals[f] = unit(control.n0);
  }
  return normals;
}

// An edge of corner `corner`, from the point of this corner to the point `to`.
struct Spoke {
  std::uint32_t to, corner;

  friend bool operator<(const Spoke& a, const Spoke& b) { return a.to != b.to ? a.to < b.to : a.corner < b.corner; }
};

// The direction of a normal that a file stores at a point, and a corner that has this direction.
struct StoredNormal {
  Vec3d direction;
  std::uint32_t corner;

  friend bool operator<(const StoredNormal& a, const StoredNormal& b) {
    if (a.direction.x != b.direction.x) return a.direction.x < b.direction.x;
    if (a.direction.y != b.direction.y) return a.direction.y < b.direction.y;
    return a.direction.z < b.direction.z;
  }
};

// Joins the corners of any two directions whose distance is at most `chord`. Equal directions are joined first, since
// there may be many of them.
void join_close_directions(std::vector<StoredNormal>& normals, double chord, CornerSets& sets) {
  std::sort(normals.begin(), normals.end());
  std::size_t distinct = 0;
  for (const StoredNormal& normal : normals) {
    if (distinct > 0 && normals[distinct - 1].direction == normal.direction)
      sets.join(normals[distinct - 1].corner, normal.corner);
    else
      normals[distinct++] = normal;
  }
  for (std::size_t i = 0; i < distinct; ++i) {
    for (std::size_t k = i + 1; k < distinct; ++k) {
      const Vec3d between = normals[k].direction - normals[i].direction;
      if (between.x > chord) break;  // all later directions are farther away than `chord`, too
      if (dot(between, between) <= chord * chord) sets.join(normals[i].corner, normals[k].corner);
    }
  }
}

}  // namespace

NormalGroups::NormalGroups(const Topology& topology, std::vector<std::uint32_t> element_of_corner,
                           std::size_t element_count)
    : offsets_(element_count + 1),
      corners_(topology.corner_count()),
      faces_(topology.corner_count()),
      element_of_corner_(std::move(element_of_corner)),
      rings_(std::make_shared<RingsOfGroups>()) {
  for (const std::uint32_t e : element_of_corner_) ++offsets_[e + 1];
  std::partial_sum(offsets_.begin(), offsets_.end(), offsets_.begin());

  // Corners are added to their elements face by face. The order of the faces depends only on their vertices, so the
  // sums have the same bits if the mesh lists its faces in another order.
  std::vector<std::uint32_t> next = offsets_;
  for (const std::uint32_t f : faces_by_vertices(topology)) {
    const std::size_t first = first_corner(topology, f);
    for (std::size_t c = first; c < first + topology.face(f).size(); ++c) {
      const std::uint32_t place = next[element_of_corner_[c]]++;
      corners_[place] = static_cast<std::uint32_t>(c);
      faces_[place] = f;
    }
  }
}

NormalGroups NormalGroups::of_corner_sets(const Topology& topology, const Points& points,
                                          std::vector<std::uint32_t> set_of_corner) {
  take_sides_apart(topology, points, set_of_corner);
  constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> element_of_set(set_of_corner.size(), kNone);
  std::uint32_t count = 0;
  for (std::uint32_t& set : set_of_corner) {
    if (element_of_set[set] == kNone) element_of_set[set] = count++;
    set = element_of_set[set];
  }
  return {topology, std::move(set_of_corner), count};
}

NormalGroups NormalGroups::of_vertices(const Topology& topology, const Points& points) {
  return of_vertices(topology, points, {});
}

NormalGroups NormalGroups::of_vertices(const Topology& topology, const Points& points,
                                       const std::vector<bool>& left_out) {
  assert(points.point_of_vertex.size() == topology.vertex_count());
  constexpr std::uint32_t kNone = 0xFFFFFFFF;
  std::vector<std::uint32_t> element_of_corner, without(left_out.empty() ? 0 : points.count, kNone);
  element_of_corner.reserve(topology.corner_count());
  std::size_t count = points.count;
  for (const std::uint32_t vertex : topology.corners()) {
    std::uint32_t element = points.point_of_vertex[vertex];
    if (!left_out.empty() && left_out[element_of_corner.size()]) {
      if (without[element] == kNone) without[element] = static_cast<std::uint32_t>(count++);
      element = without[element];
    }
    element_of_corner.push_back(element);
  }
  NormalGroups groups(topology, std::move(element_of_corner), count);
  groups.element_of_vertex_ = points.point_of_vertex;
  groups.outputs_are_vertices_ = true;
  return groups;
}

Result<NormalGroups> NormalGroups::by_crease_angle(const Motion& motion, const Points& points, double degrees) {
  if (!(0 <= degrees && degrees <= 180))
    return Error{ErrorCode::kUsage, "", "the crease angle must be from 0 to 180 degrees"};
  const Topology& topology = motion.topology;
  assert(!motion.keyframes.empty());
  assert(points.point_of_vertex.size() == topology.vertex_count());
  const double crease = degrees * kRadiansPerDegree + kCreaseRounding;
  const std::vector<Vec3d> normals = unit_face_normals(still_segment(topology, motion.keyframes.front()));
  const std::vector<std::uint32_t> face_of_corner = face_of_each_corner(topology);

  const auto smooth = [&](std::uint32_t f, std::uint32_t g) {
    if (f == g) return true;
    const bool both = normals[f] != Vec3d{} && normals[g] != Vec3d{};
    return (both ? angle_between(normals[f], normals[g]) : std::numbers::pi) <= crease;
  };

  CornerSets sets(topology.corner_count());
  const Listing around = corners_of_points(topology, points);
  std::vector<Spoke> spokes;
  for (std::uint32_t p = 0; p < points.count; ++p) {
    // Each corner has two edges, to the vertices after and before it in its face.
    spokes.clear();
    for (const std::uint32_t c : around.of(p)) {
      const auto face = topology.face(face_of_corner[c]);
      const std::size_t here = c - first_corner(topology, face_of_corner[c]);
      for (const std::size_t step : {face.size() - 1, std::size_t{1}}) {
        const std::uint32_t other = points.point_of_vertex[face[(here + step) % face.size()]];
        if (other != p) spokes.push_back({other, c});
      }
    }
    std::sort(spokes.begin(), spokes.end());

    for (std::size_t first = 0, end = 0; first < spokes.size(); first = end) {
      while (end < spokes.size() && spokes[end].to == spokes[first].to) ++end;
      if (degrees == 180) {
        for (std::size_t i = first + 1; i < end; ++i) sets.join(spokes[first].corner, spokes[i].corner);
        continue;
      }
      if (end - first > kMostFacesAtSmoothEdge) continue;
      for (std::size_t i = first; i < end; ++i) {
        for (std::size_t k = i + 1; k < end; ++k) {
          const std::uint32_t a = spokes[i].corner, b = spokes[k].corner;
          if (smooth(face_of_corner[a], face_of_corner[b])) sets.join(a, b);
        }
      }
    }
  }
  return of_corner_sets(topology, points, std::move(sets).roots());
}

Result<NormalGroups> NormalGroups::by_smoothing_group(const Topology& topology, const Points& points,
                                                      std::span<const std::uint32_t> group_of_face) {
  assert(points.point_of_vertex.size() == topology.vertex_count());
  if (group_of_face.size() != topology.face_count())
    return invalid_input("", "the list of smoothing groups has " + counted(group_of_face.size(), "entry", "entries") +
                                 " for " + counted(topology.face_count(), "face", "faces") +
                                 "; give one entry for each face");
  CornerSets sets(topology.corner_count());
  const Listing around = corners_of_points(topology, points);
  const std::vector<std::uint32_t> face_of_corner = face_of_each_corner(topology);
  const auto group = [&](std::uint32_t corner) { return group_of_face[face_of_corner[corner]]; };

  std::vector<std::uint32_t> corners;
  for (std::size_t p = 0; p < points.count; ++p) {
    const auto all = around.of(p);
    corners.assign(all.begin(), all.end());
    std::sort(corners.begin(), corners.end(), [&](std::uint32_t a, std::uint32_t b) { return group(a) < group(b); });
    for (std::size_t i = 1; i < corners.size(); ++i) {
      if (group(corners[i]) != 0 && group(corners[i]) == group(corners[i - 1])) sets.join(corners[i - 1], corners[i]);
    }
  }
  return of_corner_sets(topology, points, std::move(sets).roots());
}

Result<NormalGroups> NormalGroups::by_split_normals(const Topology& topology, const Points& points,
                                                    VectorView<const float> normal_of_corner, double degrees) {
  assert(points.point_of_vertex.size() == topology.vertex_count());
  if (!(0 <= degrees && degrees <= 45))
    return Error{ErrorCode::kUsage, "", "the tolerance of stored normals must be from 0 to 45 degrees"};
  if (normal_of_corner.count != topology.corner_count())
    return invalid_input("", "the list of normals has " + counted(normal_of_corner.count, "entry", "entries") +
                                 " for " + counted(topology.corner_count(), "corner", "corners") +
                                 "; give one normal for each corner");
  for (std::size_t c = 0; c < normal_of_corner.count; ++c) {
    const Vec3f n = normal_of_corner[c];
    if (!std::isfinite(n.x) || !std::isfinite(n.y) || !std::isfinite(n.z))
      return invalid_input("corner " + std::to_string(c), "the normal is NaN or infinite; give finite normals");
  }

  CornerSets sets(topology.corner_count());
  const Listing around = corners_of_points(topology, points);
  const double chord = 2 * portable::sin(degrees * kRadiansPerDegree / 2) + 4 * std::numeric_limits<double>::epsilon();
  std::vector<StoredNormal> normals;
  for (std::size_t p = 0; p < points.count; ++p) {
    normals.clear();
    for (const std::uint32_t c : around.of(p)) normals.push_back({unit(to_double(normal_of_corner[c])), c});
    join_close_directions(normals, chord, sets);
  }
  return of_corner_sets(topology, points, std::move(sets).roots());
}

std::size_t NormalGroups::isolated_count() const noexcept {
  std::size_t count = 0;
  for (std::size_t e = 0; e < size(); ++e) count += static_cast<std::size_t>(faces(e).empty());
  return count;
}

void NormalGroups::forget_corners() noexcept {
  corners_ = std::vector<std::uint32_t>();  // assigning {} would keep the memory
  element_of_corner_ = std::vector<std::uint32_t>();
}

void NormalGroups::copy_to_outputs(VectorView<const float> of_elements, VectorView<float> of_outputs) const noexcept {
  const auto element = element_of_output();
  assert(of_elements.count == size() && of_outputs.count == element.size());
  for (std::size_t i = 0; i < element.size(); ++i) of_outputs.set(i, of_elements[element[i]]);
}

}  // namespace chronormal
