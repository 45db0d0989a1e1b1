#include "chronormal/analysis/containment.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include "analysis/containment/crossing_signs.h"
#include "analysis/containment/moving_boxes.h"
#include "chronormal/core/parallel.h"
#include "core/text.h"
#include "motion/segment_end.h"
#include "motion/triangles.h"

namespace chronormal {
namespace {

constexpr std::size_t kPointsPerBlock = 64;

// An edge of a face, and the direction in which the outline of the face passes along the edge.
struct PassedEdge {
  std::uint32_t low, high;  // numbers of its two points, the lower one first
  bool upwards;
  std::uint32_t face;
};

struct EdgeFaults {
  std::size_t boundary = 0, unbalanced = 0;
  std::uint32_t first_face = static_cast<std::uint32_t>(-1);
};

EdgeFaults find_edge_faults(const Topology& topology, const Points& points) {
  std::vector<PassedEdge> edges;
  edges.reserve(topology.corner_count());
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    for (std::size_t c = 0; c < face.size(); ++c) {
      const std::uint32_t a = points.point_of_vertex[face[c]],
                          b = points.point_of_vertex[face[c + 1 == face.size() ? 0 : c + 1]];
      if (a != b) edges.push_back({std::min(a, b), std::max(a, b), a < b, static_cast<std::uint32_t>(f)});
    }
  }
  const auto ends = [](const PassedEdge& edge) { return std::pair(edge.low, edge.high); };
  std::sort(edges.begin(), edges.end(), [&ends](const auto& a, const auto& b) { return ends(a) < ends(b); });
  EdgeFaults faults;
  for (auto begin = edges.begin(); begin != edges.end();) {
    const auto end =
        std::find_if(begin, edges.end(), [&](const PassedEdge& edge) { return ends(edge) != ends(*begin); });
    const auto upwards = std::count_if(begin, end, [](const PassedEdge& edge) { return edge.upwards; });
    if (2 * upwards != end - begin) {
      ++(end - begin == 1 ? faults.boundary : faults.unbalanced);
      for (auto edge = begin; edge != end; ++edge) faults.first_face = std::min(faults.first_face, edge->face);
    }
    begin = end;
  }
  return faults;
}

// The triangles of all faces. Vertices at the same place are one point, and `corners` names this point by the first of
// these vertices. A triangle that names a point twice has no area at any time, and is left out.
struct Triangles {
  std::vector<std::uint32_t> corners;  // three vertices for each triangle
  std::vector<std::uint32_t> faces;
};

Triangles triangles_of(const Topology& topology, const Points& points, VectorView<const float> positions) {
  std::vector<float> places;  // the positions of all vertices, if there are polygons that must be cut into triangles
  for (std::size_t v = 0; v < positions.count && !topology.all_triangles(); ++v) {
    const Vec3f place = positions[v];
    places.insert(places.end(), {place.x, place.y, place.z});
  }
  std::vector<std::uint32_t> first_vertex(points.count);
  for (std::size_t v = topology.vertex_count(); v-- > 0;)
    first_vertex[points.point_of_vertex[v]] = static_cast<std::uint32_t>(v);
  Triangles triangles;
  for (std::size_t f = 0; f < topology.face_count(); ++f) {
    const auto face = topology.face(f);
    const auto vertex = [&](std::size_t c) { return first_vertex[points.point_of_vertex[face[c]]]; };
    for (const auto& [a, b, c] : triangles_of_face(face, places)) {
      const std::uint32_t u = vertex(a), v = vertex(b), w = vertex(c);
      if (u == v || v == w || w == u) continue;
      triangles.corners.insert(triangles.corners.end(), {u, v, w});
      triangles.faces.push_back(static_cast<std::uint32_t>(f));
    }
  }
  return triangles;
}

// Returns the axis along which a component of n(t) may be largest, or kNoAxis if n(t) is zero throughout.
constexpr std::size_t kNoAxis = 3;
std::size_t axis_of(const ControlNormals& n) {
  const auto size = [&n](double Vec3d::*axis) {
    return std::max({std::fabs(n.n0.*axis), std::fabs(n.m.*axis), std::fabs(n.n1.*axis)});
  };
  const double x = size(&Vec3d::x), y = size(&Vec3d::y), z = size(&Vec3d::z);
  if (std::max({x, y, z}) == 0) return kNoAxis;
  return x >= y && x >= z ? 0 : y >= z ? 1 : 2;
}

constexpr std::size_t kUpwards = 2;

// Returns a root of p in [0, 1] to the precision of double. Uses Newton's method, restricted to an interval that
// brackets the root. If p has the same sign at 0 and at 1, returns the first root, or no value if there is none.
std::optional<double> first_root(const Bernstein<double, 3>& p) {
  if (!(p[0] < 0 && p[3] > 0) && !(p[0] > 0 && p[3] < 0)) {
    const Roots<3> roots = roots_in_unit_interval(p);
    return roots.count > 0 ? std::optional(roots.t[0]) : std::nullopt;
  }
  double low = 0, high = 1, t = p[0] / (p[0] - p[3]);
  for (int i = 0; i < 60; ++i) {
    const Halves<double, 3> halves = split(p, t);
    const double value = halves.after[0], slope = 3 * (halves.after[1] - value) / (1 - t);
    ((value < 0) == (p[0] < 0) ? low : high) = t;
    double next = t - value / slope;
    if (!(low < next && next < high)) next = low + (high - low) / 2;
    if (std::fabs(next - t) <= 0x1p-52) return next;
    t = next;
  }
  return t;
}

// The data of a segment that are the same for all points.
struct MeshInSegment {
  Segment segment;  // the segment, whose topology is the triangles
  std::span<const std::uint32_t> faces;
  std::span<const BoxNode> nodes;
  std::vector<MovingBox> boxes;
  std::vector<ControlNormals> normals;
};

}  // namespace

struct Containment::Mesh {
  Topology triangles;  // the triangles in the order of the tree's leaves
  std::vector<std::uint32_t> faces;
  std::vector<BoxNode> nodes;

  [[nodiscard]] MeshInSegment in(const Segment& whole) const {
    Segment segment = whole;
    segment.topology = &triangles;
    return {segment, faces, nodes, moving_boxes(nodes, segment), all_face_control_normals(segment)};
  }
};

namespace {

// The passage of one point through a segment, during which the point may cross triangles.
class Passage {
 public:
  Passage(const MeshInSegment& mesh, const MovingPoint& point) : mesh_(mesh), point_(point) {}

  // Returns the winding number of the point at a time. The winding number is the sum of the signs with which the
  // half-line upwards from the point crosses triangles.
  [[nodiscard]] std::int32_t winding_number(Tick t) const {
    std::int32_t sum = 0;
    const double share = static_cast<double>(t) / static_cast<double>(kTicks);
    visit_boxes(
        mesh_.nodes, mesh_.boxes, [&](const MovingBox& box) { return box.is_above(point_, share); },
        [&](std::uint32_t i) { sum += signs_of(i).crossing_of_ray(kUpwards, t); });
    return sum;
  }

  // Appends the crossings of this point, ordered by t. The caller fills in the index of the point.
  void find_crossings(std::vector<Crossing>& result) {
    std::vector<std::uint32_t> open;
    visit_boxes(
        mesh_.nodes, mesh_.boxes, [&](const MovingBox& box) { return box.meets(point_); },
        [&](std::uint32_t i) {
          const CrossingSigns signs = signs_of(i);
          if (!signs.is_beside() && is_open(signs, i, {})) open.push_back(i);
        });
    if (!open.empty()) cut({}, open, 0);
    const std::size_t first = result.size();
    for (const Root& root : roots_) result.push_back(crossing_at(root.triangle, time_of(root), root.change));
    result.insert(result.end(), summed_.begin(), summed_.end());
    std::sort(result.begin() + static_cast<std::ptrdiff_t>(first), result.end(),
              [](const auto& a, const auto& b) { return std::pair(a.t, a.face) < std::pair(b.t, b.face); });
  }

 private:
  // A time at which the volume of a triangle (crossing_signs.h) is zero. The volume has no other zero in `cell`. At
  // this time the point is between the edges of the triangle, so the point crosses the triangle.
  struct Root {
    std::uint32_t triangle;
    Cell cell;
    int change;
  };

  [[nodiscard]] CrossingSigns signs_of(std::uint32_t i) const {
    const auto v = mesh_.segment.topology->face(i);
    const SegmentEnd from = SegmentEnd::from(mesh_.segment), to = SegmentEnd::to(mesh_.segment);
    const auto corner = [&](std::size_t k) {
      return MovingPoint{from.position(v[k]), to.position(v[k]), from.residual(v[k]), to.residual(v[k])};
    };
    return {{corner(0), corner(1), corner(2)}, point_};
  }

  // Returns true if this cell of time is too long to tell whether the point crosses the triangle, so that the caller
  // must examine parts of the cell. Otherwise records the crossing, if there is one.
  bool is_open(const CrossingSigns& signs, std::uint32_t i, const Cell& cell) {
    const std::size_t axis = axis_of(mesh_.normals[i]);
    if (axis == kNoAxis) return false;
    const Verdict verdict = signs.judge(axis, cell);
    if (verdict.kind == Verdict::kCrossing) roots_.push_back({i, cell, verdict.change});
    return verdict.kind == Verdict::kOpen;
  }

  // Splits a cell in which some triangles are open, that is, undecided. The cell is split around a root of the first
  // open triangle or, if that did not help, in half.
  void cut(const Cell& cell, const std::vector<std::uint32_t>& open, int level) {
    const Tick width = cell.to - cell.from;
    if (width <= 2) {
      sum_up(cell, open);
      return;
    }
    std::array<Tick, 4> bounds{cell.from, cell.from + width / 2, cell.to, cell.to};
    if (level % 4 != 3) {
      if (const std::optional<double> share = first_root(signs_of(open[0]).rounded_volume(cell))) {
        const Tick root = cell.from + std::llround(*share * static_cast<double>(width));
        const Tick margin = std::max(Tick{1}, width >> 16U);
        bounds[1] = std::max(cell.from, root - margin);
        bounds[2] = std::min(cell.to, root + margin);
      }
    }
    for (std::size_t i = 0; i < 3; ++i) {
      const Cell part{bounds[i], bounds[i + 1]};
      if (part.from == part.to) continue;
      std::vector<std::uint32_t> still_open;
      for (const std::uint32_t triangle : open) {
        if (is_open(signs_of(triangle), triangle, part)) still_open.push_back(triangle);
      }
      if (!still_open.empty()) cut(part, still_open, level + 1);
    }
  }

  // Returns the sign at t of the volume between a triangle and the point (crossing_signs.h). The sign changes at the
  // root.
  [[nodiscard]] static int sign_at(const Root& root, const CrossingSigns& signs, Tick t) {
    if (t <= root.cell.from) return -root.change;
    if (t >= root.cell.to) return root.change;
    return signs.volume_at(t);
  }

  // Adds crossings of the open triangles within a cell of at most two ticks, which counts as one moment. The number of
  // added crossings is the change of the winding number that the known roots do not explain.
  void sum_up(const Cell& moment, std::vector<std::uint32_t> open) {
    int change = winding_number(moment.to) - winding_number(moment.from);
    for (const Root& root : roots_) {
      if (root.cell.to <= moment.from || moment.to <= root.cell.from) continue;
      const CrossingSigns signs = signs_of(root.triangle);
      if (sign_at(root, signs, moment.from) != sign_at(root, signs, moment.to)) change -= root.change;
    }
    if (change == 0) return;
    const int direction = change < 0 ? -1 : 1;
    std::stable_partition(open.begin(), open.end(), [&](std::uint32_t triangle) {
      const CrossingSigns signs = signs_of(triangle);
      return signs.volume_at(moment.from) == -direction && signs.volume_at(moment.to) == direction;
    });
    const double t = static_cast<double>(moment.from + moment.to) / static_cast<double>(2 * kTicks);
    for (std::size_t i = 0; i < static_cast<std::size_t>(std::abs(change)); ++i)
      summed_.push_back(crossing_at(open[i % open.size()], t, direction));
  }

  // Returns the time of a root. The time is computed in double first. If exact signs on both sides of that time do not
  // agree with a root there, a bisection with exact signs finds the time instead.
  [[nodiscard]] double time_of(const Root& root) const {
    constexpr Tick kMargin = 8;
    const CrossingSigns signs = signs_of(root.triangle);
    Tick low = root.cell.from, high = root.cell.to;
    if (const std::optional<double> share = first_root(signs.rounded_volume(root.cell))) {
      const double ticks = static_cast<double>(low) + *share * static_cast<double>(high - low);
      const Tick nearest = std::llround(ticks);
      if (sign_at(root, signs, nearest - kMargin) == -root.change &&
          sign_at(root, signs, nearest + kMargin) == root.change)
        return ticks / static_cast<double>(kTicks);
    }
    while (high - low > 1) {
      const Tick middle = low + (high - low) / 2;
      (sign_at(root, signs, middle) == root.change ? high : low) = middle;
    }
    return static_cast<double>(low + high) / static_cast<double>(2 * kTicks);
  }

  [[nodiscard]] Crossing crossing_at(std::uint32_t triangle, double t, int change) const {
    return {0, mesh_.faces[triangle], t, change > 0, unit_normal_at(mesh_.normals[triangle], t).vector};
  }

  const MeshInSegment& mesh_;
  const MovingPoint point_;
  std::vector<Root> roots_;
  std::vector<Crossing> summed_;
};

// Calls body(block, range) for each block of points, in parallel. `range` has the indices of the points.
template <class Body>
void for_blocks(std::size_t count, const Body& body) {
  parallel_for((count + kPointsPerBlock - 1) / kPointsPerBlock, [&](std::size_t block) {
    body(block, IndexRange{block * kPointsPerBlock, std::min(kPointsPerBlock, count - block * kPointsPerBlock)});
  });
}

}  // namespace

Containment::Containment(std::unique_ptr<const Mesh> mesh) : mesh_(std::move(mesh)) {}
Containment::Containment(Containment&&) noexcept = default;
Containment& Containment::operator=(Containment&&) noexcept = default;
Containment::~Containment() = default;

Result<Containment> Containment::make(const Topology& topology, const Points& points,
                                      VectorView<const float> positions) {
  assert(points.point_of_vertex.size() == topology.vertex_count() && positions.count == topology.vertex_count());
  if (const EdgeFaults faults = find_edge_faults(topology, points); faults.boundary + faults.unbalanced > 0) {
    std::string message = "the mesh is not closed, so points cannot be inside it; ";
    if (faults.boundary > 0)
      message += counted(faults.boundary, "edge has a face on one side only (fill such holes)",
                         "edges have a face on one side only (fill such holes)");
    if (faults.boundary > 0 && faults.unbalanced > 0) message += ", and ";
    if (faults.unbalanced > 0)
      message += counted(faults.unbalanced, "edge lies", "edges lie") +
                 " between two faces whose corners run in opposite orders (flip one of the two)";
    return invalid_input("face " + std::to_string(faults.first_face), std::move(message));
  }
  const Triangles triangles = triangles_of(topology, points, positions);
  BoxTree tree = build_box_tree(positions, triangles.corners);
  std::vector<std::uint32_t> corners, faces;
  for (const std::uint32_t i : tree.order) {
    const auto first = triangles.corners.begin() + 3 * static_cast<std::ptrdiff_t>(i);
    corners.insert(corners.end(), first, first + 3);
    faces.push_back(triangles.faces[i]);
  }
  return Containment(
      std::make_unique<Mesh>(Mesh{Topology::triangles(topology.vertex_count(), std::move(corners)).value(),
                                  std::move(faces), std::move(tree.nodes)}));
}

std::vector<std::int32_t> Containment::winding_numbers(const Segment& segment, double t, VectorView<const float> from,
                                                       VectorView<const float> to) const {
  assert(0 <= t && t <= 1 && from.count == to.count);
  const MeshInSegment mesh = mesh_->in(segment);
  const Tick tick = std::llround(t * static_cast<double>(kTicks));
  std::vector<std::int32_t> result(from.count);
  for_blocks(from.count, [&](std::size_t, const IndexRange& block) {
    for (std::size_t p = block.first; p < block.end(); ++p)
      result[p] = Passage(mesh, {from[p], to[p]}).winding_number(tick);
  });
  return result;
}

std::vector<Crossing> Containment::crossings(const Segment& segment, VectorView<const float> from,
                                             VectorView<const float> to) const {
  assert(from.count == to.count);
  const MeshInSegment mesh = mesh_->in(segment);
  std::vector<std::vector<Crossing>> of_blocks((from.count + kPointsPerBlock - 1) / kPointsPerBlock);
  for_blocks(from.count, [&](std::size_t index, const IndexRange& block) {
    std::vector<Crossing>& found = of_blocks[index];
    for (std::size_t p = block.first; p < block.end(); ++p) {
      const std::size_t first = found.size();
      Passage(mesh, {from[p], to[p]}).find_crossings(found);
      for (std::size_t i = first; i < found.size(); ++i) found[i].point = static_cast<std::uint32_t>(p);
    }
  });
  std::vector<Crossing> result;
  for (const std::vector<Crossing>& block : of_blocks) result.insert(result.end(), block.begin(), block.end());
  return result;
}

}  // namespace chronormal
