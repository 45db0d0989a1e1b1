#include "chronormal/analysis/cones.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <optional>
#include <vector>

#include "analysis/cones/interval_normals.h"
#include "motion/segment_end.h"
#include "normals/control/local_time.h"

namespace chronormal {
namespace {

constexpr std::size_t kAxisRefinements = 10;
// The sine of the widest half-angle, 84 degrees, of a cone that is kept. A wider cone would hardly ever pass the
// culling test.
constexpr double kWidest = 0.995;
constexpr double kTestSlack = 0x1p-20;  // the error of the culling test in float32: some ten roundings of 2^-24
// The factor by which a bound is enlarged, so that rounding the bound to float, and the roundings before, cannot make
// the bound too small.
constexpr double kRoundUp = 1 + 0x1p-22;
constexpr double kSumRounding = 0x1p-46;  // relative rounding error of sums of products in double
constexpr double kSteps = 127;            // number of steps of a component in 8 bits, from 0 to 1

// The positions of a vertex at both ends of the interval, and a bound of their rounding error in mesh units.
struct Ends {
  Vec3d from, to;
  double error = 0;
};

class Cluster {
 public:
  Cluster(const Segment& segment, std::span<const std::uint32_t> faces, double t0, double t1)
      : segment_(segment), faces_(faces), t0_(t0), t1_(t1) {
    load_normals();
  }

  // Finds nearly the smallest sphere around all vertices on their paths (Badoiu, Clarkson 2003). Vertices move on
  // straight lines, so a sphere around both ends of each line suffices.
  void set_sphere(ClusterBounds& bounds) const {
    if (faces_.empty()) return;
    std::vector<std::uint32_t> vertices;
    for (const std::uint32_t f : faces_) {
      const std::span<const std::uint32_t> face = segment_.topology->face(f);
      vertices.insert(vertices.end(), face.begin(), face.end());
    }
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::vector<Vec3d> points;
    double error = 0;
    for (const std::uint32_t vertex : vertices) {
      const Ends p = corner(vertex);
      points.push_back(p.from);
      points.push_back(p.to);
      error = std::fmax(error, p.error);
    }
    Vec3d center = points.front();
    for (std::size_t i = 0; i < kAxisRefinements; ++i)
      center = center + (1 / static_cast<double>(i + 2)) * (farthest_from(center, points) - center);
    const Vec3f rounded = to_float(center);
    set(bounds.center, rounded);
    const Vec3d off = farthest_from(to_double(rounded), points) - to_double(rounded);
    bounds.radius = static_cast<float>(kRoundUp * (length(off) + error));
  }

  // Returns a cone around the normal cones of all faces of the cluster.
  [[nodiscard]] NormalCone cone() const {
    std::vector<NormalCone> cones(faces_.size());
    for_runs([&](IndexRange run, std::size_t at) {
      face_normal_cones(segment_, run, t0_, t1_, std::span(cones).subspan(at, run.count));
    });
    return enclosing_cone(cones);
  }

  // Returns the point center - s axis, with the smallest s >= 0 for which the point is behind all faces, or no value if
  // float32 has no such point. The point is behind a face if
  //     s n(t).axis >= n(t).(center - p(t))
  // Both sides are cubics in t, so the inequality holds if it holds for each pair of Bernstein coefficients.
  [[nodiscard]] std::optional<Vec3f> apex(const Vec3d& center, const NormalCone& cone) const {
    const Vec3d axis = to_double(cone.axis);
    double s = 0;
    for (std::size_t i = 0; i < faces_.size(); ++i) {
      const auto& [c, unknown] = normals_[i];
      const Ends p = corner(segment_.topology->face(faces_[i])[0]);
      const Vec3d from = center - p.from, to = center - p.to;
      const double distance = std::fmax(length(from), length(to));
      const std::array<double, 4> height = cubic(dot(c.n0, from), dot(c.m, from), dot(c.n1, from),  //
                                                 dot(c.n0, to), dot(c.m, to), dot(c.n1, to));
      const double a0 = dot(c.n0, axis), a1 = dot(c.m, axis), a2 = dot(c.n1, axis);
      const double s0 = length(c.n0), s1 = length(c.m), s2 = length(c.n1);
      const std::array<double, 4> along = cubic(a0, a1, a2, a0, a1, a2), size = cubic(s0, s1, s2, s0, s1, s2);
      for (std::size_t k = 0; k < size.size(); ++k) {
        if (size[k] == 0) continue;
        const double error = 2 * (unknown + kSumRounding) * size[k];
        if (!(along[k] > 2 * error)) return std::nullopt;
        s = std::fmax(s, (height[k] + error * distance + 2 * p.error * size[k]) / (along[k] - error));
      }
    }
    // The point is moved further back along the axis, by more than rounding can have moved the point forward.
    const double cosine = std::sqrt((1 - double{cone.sine}) * (1 + double{cone.sine}));
    s += 0x1p-22 * (length(center) + s) / cosine + 0x1p-120;
    const Vec3d point = center - s * axis;
    constexpr double kLargest = 1e38;
    if (!(max_abs(point) < kLargest)) return std::nullopt;
    return to_float(point);
  }

  static void set(float (&to)[3], const Vec3f& v) {
    to[0] = v.x;
    to[1] = v.y;
    to[2] = v.z;
  }

 private:
  // Returns the Bernstein coefficients of n(t).l(t), for a quadratic n and a line l. The arguments are the dot products
  // of n0, m, n1 with both ends of l.
  [[nodiscard]] static std::array<double, 4> cubic(double n0_from, double m_from, double n1_from, double n0_to,
                                                   double m_to, double n1_to) {
    return {n0_from, (n0_to + 2 * m_from) / 3, (2 * m_to + n1_from) / 3, n1_to};
  }

  // Calls body(run, at) for each run of consecutive face numbers in faces_. The run begins at faces_[at].
  template <class Body>
  void for_runs(const Body& body) const {
    for (std::size_t first = 0; first < faces_.size();) {
      std::size_t last = first + 1;
      while (last < faces_.size() && faces_[last] == faces_[last - 1] + 1) ++last;
      body(IndexRange{faces_[first], last - first}, first);
      first = last;
    }
  }

  void load_normals() {
    const Restriction restriction = Restriction::to(t0_, t1_);
    std::vector<ControlNormals> whole(faces_.size());
    for_runs([&](IndexRange run, std::size_t at) {
      face_control_normals(segment_, run, std::span(whole).subspan(at, run.count));
    });
    normals_.reserve(whole.size());
    for (std::size_t i = 0; i < whole.size(); ++i) {
      normals_.push_back(part_of(whole[i], restriction));
      if (!normals_[i].is_known())
        normals_[i] = exact_part_of(ExactCurve::of_polygon(segment_, segment_.topology->face(faces_[i])), t0_, t1_);
    }
  }

  [[nodiscard]] Ends corner(std::uint32_t vertex) const {
    const Vec3d a = SegmentEnd::from(segment_)[vertex], b = SegmentEnd::to(segment_)[vertex];
    return {lerp(a, b, t0_), lerp(a, b, t1_), 0x1p-50 * (max_abs(a) + max_abs(b))};
  }

  [[nodiscard]] static Vec3d farthest_from(const Vec3d& center, std::span<const Vec3d> points) {
    Vec3d farthest = center;
    double largest = -1;
    for (const Vec3d& point : points) {
      const Vec3d off = point - center;
      const double distance = dot(off, off);
      if (distance > largest) {
        largest = distance;
        farthest = point;
      }
    }
    return farthest;
  }

  const Segment& segment_;
  std::span<const std::uint32_t> faces_;
  double t0_, t1_;
  std::vector<IntervalNormals> normals_;
};

// Rounds the axis and the cutoff of the culling test to 8 bits each. A unit vector v satisfies n.v >= 0 for all n of
// the cone if v.axis_s8 / 127 is at least the sine of the cone plus the error that rounding the axis can make in
// v.axis.
void set_8_bits(const NormalCone& cone, ClusterBounds& bounds) {
  const Vec3d axis = unit(to_double(cone.axis));
  const auto rounded = [](double x) { return std::nearbyint(kSteps * x); };
  const Vec3d steps{rounded(axis.x), rounded(axis.y), rounded(axis.z)};
  const double off = length(axis - (1 / kSteps) * steps);
  const double cutoff = std::ceil(kSteps * kRoundUp * (double{cone.sine} + off + kTestSlack));
  if (!(cutoff <= kSteps)) return;
  bounds.cone_axis_s8[0] = static_cast<std::int8_t>(steps.x);
  bounds.cone_axis_s8[1] = static_cast<std::int8_t>(steps.y);
  bounds.cone_axis_s8[2] = static_cast<std::int8_t>(steps.z);
  bounds.cone_cutoff_s8 = static_cast<std::int8_t>(cutoff);
}

}  // namespace

ClusterBounds cluster_bounds(const Segment& segment, std::span<const std::uint32_t> faces, double t0, double t1) {
  assert(0 <= t0 && t0 <= t1 && t1 <= 1);
  const Cluster cluster(segment, faces, local_time(t0), local_time(t1));
  ClusterBounds bounds;
  cluster.set_sphere(bounds);
  std::copy_n(bounds.center, 3, bounds.cone_apex);
  const NormalCone cone = cluster.cone();
  if (cone.is_empty()) return bounds;

  bounds.cone_cutoff = 1;
  bounds.cone_cutoff_s8 = static_cast<std::int8_t>(kSteps);
  if (!(double{cone.sine} <= kWidest)) return bounds;
  const Vec3d center{double{bounds.center[0]}, double{bounds.center[1]}, double{bounds.center[2]}};
  const std::optional<Vec3f> apex = cluster.apex(center, cone);
  if (!apex) return bounds;
  Cluster::set(bounds.cone_apex, *apex);
  Cluster::set(bounds.cone_axis, cone.axis);
  bounds.cone_cutoff = static_cast<float>(kRoundUp * (double{cone.sine} + kTestSlack));
  set_8_bits(cone, bounds);
  return bounds;
}

}  // namespace chronormal
