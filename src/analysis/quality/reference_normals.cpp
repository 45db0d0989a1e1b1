// Computes the exact normals with which all schemes are compared. A normal is a sum of cross products of edges at t, in
// double. If double cannot tell this sum from its rounding error, integers compute the normal.
#include "chronormal/analysis/quality.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <vector>

#include "analysis/quality/shared_reference.h"
#include "core/wide_integer.h"
#include "motion/segment_end.h"

namespace chronormal {
namespace {

// The size of a sum, relative to the size of its terms, below which the sum is computed in integers. This share is
// about 500,000 rounding errors, so a larger sum has a direction with an error of at most 1e-5 rad.
constexpr double kDoubtfulShare = 1e-10;
// The largest angle, in radians, by which rounding t may turn a normal. A normal that turns more has no definite
// direction at t.
constexpr double kMostTurned = 1e-5;

// A vector interpolated between two others, and the size of the terms of this sum, which bounds the rounding error.
struct Interpolated {
  Vec3d vector;
  double size;

  friend Interpolated operator-(const Interpolated& a, const Interpolated& b) {
    return {a.vector - b.vector, a.size + b.size};
  }
};

bool is_certain(const ReferenceArea& area) noexcept { return max_abs(area.n) > kDoubtfulShare * area.products; }

ReferenceArea vector_area_at(const Segment& segment, std::span<const std::uint32_t> face, double t) {
  // Corners are taken relative to the first corner, since differences of float32 positions are exact in double, or
  // nearly exact.
  const SegmentEnd start = SegmentEnd::from(segment), end = SegmentEnd::to(segment);
  const auto vertex_at = [&](std::uint32_t vertex) {
    const Vec3d from = start.edge(face[0], vertex), to = end.way_from(start, face[0], vertex);
    return Interpolated{lerp(from, to, t), (1 - t) * max_abs(from) + t * max_abs(to)};
  };
  const Interpolated a = vertex_at(face[0]);
  ReferenceArea area;
  Interpolated e = vertex_at(face[1]) - a;
  for (std::size_t c = 2; c < face.size(); ++c) {
    const Interpolated f = vertex_at(face[c]) - a;
    area.n = area.n + cross(e.vector, f.vector);
    area.products += e.size * max_abs(f.vector) + f.size * max_abs(e.vector);
    e = f;
  }
  return area;
}

// The numbers of digits of positions and areas at t as wide integers. These numbers suffice for floats of up to 277
// bits and for a time of up to 253 bits.
constexpr std::size_t kPointDigits = 24, kAreaDigits = 50;
using Point = std::array<WideInteger<kPointDigits>, 3>;

// The sum of n(t) over some faces, computed in integers and rounded only once. All coordinates are integers in units of
// 2^(base - 149). The unit of positions at t is smaller by the factor 2^-t.scale.
class ExactArea {
 public:
  ExactArea(const SharedFaces& shared, std::span<const std::uint32_t> faces) : segment_(shared.segment()) {
    const Segment& segment = segment_;
    for (const std::uint32_t f : faces) {
      if (LargeFaceValues<ExactCurve>::are_kept_of(*segment.topology, f)) {
        large_.push_back(shared.exact(f));
        base_ = std::min(base_, large_.back().base());
        continue;
      }
      faces_.push_back(f);
      for (const std::uint32_t vertex : segment.topology->face(f)) {
        for (const SegmentEnd& end : {SegmentEnd::from(segment), SegmentEnd::to(segment)}) {
          end.for_parts(vertex, [this](const Vec3f& p) {
            for (const float x : {p.x, p.y, p.z}) {
              const FloatParts parts = FloatParts::of(x);
              if (parts.mantissa != 0) base_ = std::min(base_, parts.shift);
            }
          });
        }
      }
    }
  }

  // Returns the sum of n(t) over the faces at a time. The sum of the cross products of neighbouring corners is twice
  // the vector area of a face, whatever the origin.
  [[nodiscard]] Vec3d at(double time) const {
    const UnitFraction t = UnitFraction::of(time < 0x1p-200 ? 0 : time);
    std::array<WideInteger<kAreaDigits>, 3> sum;
    for (const std::uint32_t f : faces_) {
      const auto face = segment_.topology->face(f);
      Point before = point(face.back(), t);
      for (const std::uint32_t vertex : face) {
        const Point here = point(vertex, t);
        for (std::size_t k = 0; k < 3; ++k) {
          const std::size_t i = (k + 1) % 3, j = (k + 2) % 3;
          sum[k].add_product(before[i], here[j]);
          sum[k].add_product(before[j], here[i], -1);
          sum[k].settle();
        }
        before = here;
      }
    }
    for (const ExactCurve& curve : large_) {
      const ExactCurve::Value value = curve.integers_at(t);
      for (std::size_t k = 0; k < 3; ++k) {
        sum[k].add_shifted(value[k], 2 * (curve.base() - base_));
        sum[k].settle();
      }
    }
    const int unit = 2 * static_cast<int>(base_) - 298 - 2 * static_cast<int>(t.scale);
    return {sum[0].to_double(unit), sum[1].to_double(unit), sum[2].to_double(unit)};
  }

 private:
  // Returns the position of a vertex at t, times 2^t.scale: from 2^t.scale + (to - from) t 2^t.scale.
  [[nodiscard]] Point point(std::uint32_t vertex, const UnitFraction& t) const {
    std::array<WideInteger<14>, 3> start, step;
    const auto add = [this](const SegmentEnd& end, std::uint32_t of, auto& sum, std::int64_t sign) {
      end.for_parts(of, [&](const Vec3f& p) {
        sum[0].add_product(parts(p.x), {1, 0}, sign);
        sum[1].add_product(parts(p.y), {1, 0}, sign);
        sum[2].add_product(parts(p.z), {1, 0}, sign);
      });
    };
    add(SegmentEnd::from(segment_), vertex, start, 1);
    add(SegmentEnd::to(segment_), vertex, step, 1);
    add(SegmentEnd::from(segment_), vertex, step, -1);
    Point result;
    for (std::size_t k = 0; k < 3; ++k) {
      start[k].settle();
      step[k].settle();
      result[k].add_shifted(start[k], t.scale);
      result[k].add_product(step[k], t);
      result[k].settle();
    }
    return result;
  }
  [[nodiscard]] FloatParts parts(float x) const {
    const FloatParts parts = FloatParts::of(x);
    return {parts.mantissa, parts.mantissa == 0 ? 0 : parts.shift - base_};
  }

  const Segment& segment_;
  std::vector<std::uint32_t> faces_;  // faces with few corners, which are added up from their positions at t
  std::vector<ExactCurve> large_;     // the curves of the other faces
  unsigned base_ = 253;               // the highest shift that a float can have
};

Vec3d exact_normal_at(const SharedFaces& shared, std::span<const std::uint32_t> faces, double t) {
  const ExactArea area(shared, faces);
  const Vec3d n = area.at(t);
  if (n == Vec3d{} || t <= 0 || t >= 1) return n;
  for (const double end : {0.0, 1.0}) {
    const Vec3d beside = area.at(std::nextafter(t, end));
    if (max_abs(beside - n) > kMostTurned * max_abs(n)) return {};
  }
  return n;
}

}  // namespace

void reference_normals(const Segment& segment, IndexRange faces, double t, std::span<Vec3d> result) noexcept {
  assert(result.size() == faces.count && faces.end() <= segment.topology->face_count());
  for (std::size_t i = 0; i < faces.count; ++i) {
    const auto face = static_cast<std::uint32_t>(faces.first + i);
    const ReferenceArea area = reference_area(segment, face, t);
    result[i] = is_certain(area) ? area.n : exact_normal_at(SharedFaces(segment), {&face, 1}, t);
  }
}

ReferenceArea reference_area(const Segment& segment, std::uint32_t face, double t) noexcept {
  return vector_area_at(segment, segment.topology->face(face), t);
}

Vec3d reference_normal(const Segment& segment, std::span<const std::uint32_t> faces, double t) noexcept {
  ReferenceArea sum;
  for (const std::uint32_t face : faces) {
    const ReferenceArea area = reference_area(segment, face, t);
    sum.n = sum.n + area.n;
    sum.products += area.products;
  }
  return is_certain(sum) ? sum.n : exact_normal_at(SharedFaces(segment), faces, t);
}

inline namespace internal {

Vec3d reference_normal(const SharedFaces& shared, std::span<const std::uint32_t> faces,
                       std::span<const ReferenceArea> areas, double t) noexcept {
  assert(areas.size() == faces.size());
  ReferenceArea sum;
  for (const ReferenceArea& area : areas) {
    sum.n = sum.n + area.n;
    sum.products += area.products;
  }
  return is_certain(sum) ? sum.n : exact_normal_at(shared, faces, t);
}

}  // namespace internal

}  // namespace chronormal
