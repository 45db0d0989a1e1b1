// The values of a triangle that do not depend on t are computed once. Its corners are a, b and c, and the position of a
// at the start of the segment is the origin. The corners are then
//
//     a(t) = t a1        b(t) = (1 - t) b0 + t b1        c(t) = (1 - t) c0 + t c1
//
// and the largest component of each of a1, b0, b1, c0, c1 tells the rounding error of n(t) = (b - a) x (c - a).
#include "analysis/quality/kernels/reference_angles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/quality/kernels/reference_angles.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "chronormal/analysis/quality.h"
#include "motion/segment_end.h"
#include "simd/angles-inl.h"

#if !defined(CHRONORMAL_ANALYSIS_REFERENCE_ANGLES_ONCE)
#define CHRONORMAL_ANALYSIS_REFERENCE_ANGLES_ONCE
namespace chronormal::inline internal {
namespace {

// Triangles are stored in groups of eight, which is the number of doubles in the widest SIMD vector. Value k of
// triangle i of a group is at k * kGroup + i.
constexpr std::size_t kGroup = 8, kValues = 20;
// A normal whose size is below this share of the size of its terms is doubtful, so reference_normals() computes that
// normal. The share equals kDoubtfulShare in reference_normals.cpp.
constexpr double kZeroShare = 1e-10;

}  // namespace
}  // namespace chronormal::inline internal
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

HWY_INLINE Real3 load3(const double* first) {
  return {Real::load(first), Real::load(first + kGroup), Real::load(first + 2 * kGroup)};
}

// Returns the normals of one triangle per lane, each divided by its own largest component.
HWY_INLINE Real3 NormalOf(const double* group, Real s, Real t) {
  const Real3 a1 = load3(group), b0 = load3(group + 3 * kGroup), b1 = load3(group + 6 * kGroup),
              c0 = load3(group + 9 * kGroup), c1 = load3(group + 12 * kGroup);
  const auto size = [group](std::size_t k) HWY_ATTR { return Real::load(group + (15 + k) * kGroup); };
  const Real3 zero{Real(0.0), Real(0.0), Real(0.0)};
  const Real3 a = s * zero + t * a1;
  const Real size_a = s * Real(0.0) + t * size(0);
  const Real3 e = (s * b0 + t * b1) - a, f = (s * c0 + t * c1) - a;
  const Real size_e = (s * size(1) + t * size(2)) + size_a, size_f = (s * size(3) + t * size(4)) + size_a;
  const Real3 n = zero + cross(e, f);
  const Real products = size_e * max_abs(f) + size_f * max_abs(e);
  const Real scale = max_abs(n);
  const RealMask counts = scale > Real(kZeroShare) * products;
  const Real divisor = select(counts, scale, Real(1.0));
  return {select(counts, n.x / divisor, Real(0.0)), select(counts, n.y / divisor, Real(0.0)),
          select(counts, n.z / divisor, Real(0.0))};
}

void Normals(const double* groups, std::size_t count, double t, Vec3d* result) {
  const Real of_t(t), s = Real(1.0) - of_t;
  for (std::size_t first = 0; first < count; first += kGroup, groups += kGroup * kValues) {
    double x[kGroup], y[kGroup], z[kGroup];
    for (std::size_t lane = 0; lane < kGroup; lane += kDoubleLanes) {
      const Real3 n = NormalOf(groups + lane, s, of_t);
      n.x.store(x + lane);
      n.y.store(y + lane);
      n.z.store(z + lane);
    }
    const std::size_t last = std::min(kGroup, count - first);
    for (std::size_t i = 0; i < last; ++i) result[first + i] = {x[i], y[i], z[i]};
  }
}

// Computes the angles between kGroup exact normals and the normals to compare with them.
HWY_INLINE void Angles(const Vec3d* exact, const float* x, const float* y, const float* z, double* angles) {
  const Real zero(0.0), one(1.0);
  const auto promoted = [](const float* from)
                            HWY_ATTR { return Real(hn::PromoteTo(kDoubles, hn::LoadU(HalfFloatTag(), from))); };
  for (std::size_t i = 0; i < kGroup; i += kDoubleLanes) {
    Real3 n;
    hn::LoadInterleaved3(kDoubles, &exact[i].x, n.x.v, n.y.v, n.z.v);
    const Real scale = max_abs(n);
    const RealMask has_exact = !(scale == zero);
    if (any(has_exact & !(scale == one))) {
      const Real divisor = select(has_exact, scale, one);
      n = {n.x / divisor, n.y / divisor, n.z / divisor};
    }
    const Real3 u{promoted(x + i), promoted(y + i), promoted(z + i)};
    const Real square = dot(u, u);
    const RealMask has_normal = (square > zero) & (square < Real(std::numeric_limits<double>::infinity()));
    const Real3 across = cross(n, u);
    const Real angle = upper_angle(sqrt(dot(across, across)), dot(n, u));
    select(has_exact, select(has_normal, angle, Real(kNoNormal)), Real(kNoExactNormal)).store(angles + i);
  }
}

void AnglesToExact(std::span<const Vec3d> exact, VectorView<const float> shown, double* angles) {
  for (std::size_t first = 0; first < exact.size(); first += kGroup) {
    const std::size_t count = std::min(kGroup, exact.size() - first);
    if (count == kGroup && shown.stride == 1) {
      Angles(exact.data() + first, shown.x + first, shown.y + first, shown.z + first, angles + first);
      continue;
    }
    Vec3d n[kGroup];
    float x[kGroup] = {}, y[kGroup] = {}, z[kGroup] = {};
    for (std::size_t i = 0; i < count; ++i) {
      const Vec3f u = shown[first + i];
      n[i] = exact[first + i];
      x[i] = u.x, y[i] = u.y, z[i] = u.z;
    }
    double result[kGroup];
    Angles(n, x, y, z, result);
    std::copy_n(result, count, angles + first);
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(Normals);
HWY_EXPORT(AnglesToExact);

ReferenceTriangles::ReferenceTriangles(const Segment& segment, IndexRange faces)
    : segment_(segment), faces_(faces), edges_((faces.count + kGroup - 1) / kGroup * kGroup * kValues) {
  assert(segment.topology->all_triangles() && faces.end() <= segment.topology->face_count());
  for (std::size_t i = 0; i < faces.count; ++i) {
    const auto face = segment.topology->face(faces.first + i);
    const SegmentEnd from = SegmentEnd::from(segment), to = SegmentEnd::to(segment);
    const Vec3d parts[] = {to.way_from(from, face[0], face[0]), from.edge(face[0], face[1]),
                           to.way_from(from, face[0], face[1]), from.edge(face[0], face[2]),
                           to.way_from(from, face[0], face[2])};
    double* const first = edges_.data() + i / kGroup * kGroup * kValues + i % kGroup;
    for (std::size_t k = 0; k < 5; ++k) {
      first[(3 * k) * kGroup] = parts[k].x;
      first[(3 * k + 1) * kGroup] = parts[k].y;
      first[(3 * k + 2) * kGroup] = parts[k].z;
      first[(15 + k) * kGroup] = max_abs(parts[k]);
    }
  }
}

void ReferenceTriangles::normals(double t, std::span<Vec3d> result) const noexcept {
  assert(result.size() == faces_.count);
  HWY_DYNAMIC_DISPATCH(Normals)(edges_.data(), faces_.count, t, result.data());
  for (std::size_t i = 0; i < result.size(); ++i) {
    if (result[i] != Vec3d{}) continue;
    reference_normals(segment_, {faces_.first + i, 1}, t, result.subspan(i, 1));
    if (const double scale = max_abs(result[i]); scale > 0)
      result[i] = {result[i].x / scale, result[i].y / scale, result[i].z / scale};
  }
}

void angles_to_exact(std::span<const Vec3d> exact, VectorView<const float> shown, std::span<double> angles) noexcept {
  assert(shown.count == exact.size() && angles.size() == exact.size());
  HWY_DYNAMIC_DISPATCH(AnglesToExact)(exact, shown, angles.data());
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
