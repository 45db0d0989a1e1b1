// Computes the normals of moving triangles and the angles of an audit in lanes. Operations are in the same order as in
// functions that compute one number at a time, so the bits are the same.
#include "analysis/quality/kernels/shown_angles.h"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "analysis/quality/kernels/shown_angles.cpp"
#include "simd/foreach_target-inl.h"
#include "simd/highway-inl.h"

#include <algorithm>
#include <cassert>
#include <limits>

#include "simd/angles-inl.h"
#include "simd/double_rows-inl.h"

#ifndef CHRONORMAL_ANALYSIS_KERNELS_SHOWN_ANGLES_ONCE
#define CHRONORMAL_ANALYSIS_KERNELS_SHOWN_ANGLES_ONCE
namespace chronormal::inline internal {
namespace {

// Triangles are stored in groups of eight, which is the number of doubles in the widest SIMD vector. Value k of
// triangle i of a group is at k * kTriangles + i. The values are x, y, z of each corner at the start, and then x, y, z
// of each corner at the end.
constexpr std::size_t kTriangles = 8, kPositionValues = 18;

}  // namespace
}  // namespace chronormal::inline internal
#endif

HWY_BEFORE_NAMESPACE();
namespace chronormal::inline internal::HWY_NAMESPACE {

HWY_INLINE Real Promoted(const float* from) { return hn::PromoteTo(kDoubles, hn::LoadU(HalfFloatTag(), from)); }
HWY_INLINE Real RoundedToFloat(Real a) {
#if CHRONORMAL_DEMOTE_CLAMPS
  double rounded[kDoubleLanes];
  a.store(rounded);
  for (double& value : rounded) value = double{static_cast<float>(value)};
  return Real::load(rounded);
#else
  return hn::PromoteTo(kDoubles, hn::DemoteTo(HalfFloatTag(), a.v));
#endif
}

void TriangleNormals(const float* groups, std::size_t count, double t, TrianglesInMotion::Normal* result) {
  const Real of_t(t), s = Real(1.0) - of_t;
  for (std::size_t first = 0; first < count; first += kTriangles, groups += kTriangles * kPositionValues) {
    TrianglesInMotion::Normal normals[kTriangles];
    const std::size_t last = std::min(kTriangles, count - first);
    TrianglesInMotion::Normal* const to = last == kTriangles ? result + first : normals;
    for (std::size_t lane = 0; lane < kTriangles; lane += kDoubleLanes) {
      const auto coordinate = [&](std::size_t k) HWY_ATTR {
        const float* const from = groups + k * kTriangles + lane;
        return s * Promoted(from) + of_t * Promoted(from + 9 * kTriangles);
      };
      const auto corner = [&](std::size_t c) HWY_ATTR {
        return Real3{coordinate(3 * c), coordinate(3 * c + 1), coordinate(3 * c + 2)};
      };
      const Real3 a = corner(0), e = corner(1) - a, f = corner(2) - a;
      const Real3 n = Real3{Real(0.0), Real(0.0), Real(0.0)} + cross(e, f);
      hn::StoreInterleaved4(n.x.v, n.y.v, n.z.v, max_abs(n).v, kDoubles, &to[lane].x);
    }
    if (to == normals) std::copy_n(normals, last, result + first);
  }
}

// Adds up the normals of the faces around each element. A normal is a row of four numbers: x, y, z and its size. Sums
// are also rows at first, and are then transposed to columns, with one element per lane.
void SumsAround(const TrianglesInMotion::Normal* normals, const std::uint32_t* faces,
                std::span<const std::uint32_t> ends, PlanesOf4& sums) {
  alignas(64) double rows[kDoubleLanes][4];
  std::uint32_t i = 0;
  for (std::size_t first = 0; first < ends.size(); first += kDoubleLanes) {
    const std::size_t count = std::min(kDoubleLanes, ends.size() - first);
    for (std::size_t lane = 0; lane < count; ++lane) {
      DoubleRow sum = MakeRow([](std::size_t) HWY_ATTR { return hn::Zero(DoubleRowTag()); });
      for (; i < ends[first + lane]; ++i) sum = sum + LoadDoubleRow(&normals[faces[i]].x);
      StoreDoubleRow(sum, rows[lane]);
    }
    if (count == kDoubleLanes) {
      const DoubleColumns columns = ColumnsOfDoubles([&rows](std::size_t lane) { return rows[lane]; });
      hn::StoreU(columns.xyz.x, kDoubles, &sums.x[first]);
      hn::StoreU(columns.xyz.y, kDoubles, &sums.y[first]);
      hn::StoreU(columns.xyz.z, kDoubles, &sums.z[first]);
      hn::StoreU(columns.w, kDoubles, &sums.w[first]);
      continue;
    }
    for (std::size_t lane = 0; lane < count; ++lane) {
      sums.x[first + lane] = rows[lane][0];
      sums.y[first + lane] = rows[lane][1];
      sums.z[first + lane] = rows[lane][2];
      sums.w[first + lane] = rows[lane][3];
    }
  }
}

// A vector v divided by its largest component, `scale`, and the length of this quotient. All numbers are zero for the
// zero vector.
struct Scaled {
  Real3 vector;
  Real scale, length;

  explicit HWY_INLINE Scaled(const Real3& v) : scale(max_abs(v)) {
    const Real divisor = select(scale == Real(0.0), Real(1.0), scale);
    vector = {v.x / divisor, v.y / divisor, v.z / divisor};
    length = sqrt(dot(vector, vector));
  }
  // Returns v scaled to length 1, by the operations of unit() and length() in core/vec3.h in the same order.
  [[nodiscard]] HWY_INLINE Real3 unit() const {
    return (Real(1.0) / select(length == Real(0.0), Real(1.0), length)) * vector;
  }
  [[nodiscard]] HWY_INLINE Real whole_length() const { return scale * length; }
};

HWY_INLINE Real3 load3(const PlanesOf4& planes, std::size_t i) {
  return {Real::load(planes.x.data() + i), Real::load(planes.y.data() + i), Real::load(planes.z.data() + i)};
}

HWY_INLINE Real ShownAngle(const Real3& from, const Real3& to, const Real3& sum, Real least, Real size, Real rounding,
                           Real t) {
  const Real zero(0.0);
  const Real3 u = Scaled((Real(1.0) - t) * from + t * to).unit();
  const Real3 shown{RoundedToFloat(u.x), RoundedToFloat(u.y), RoundedToFloat(u.z)};
  const RealMask counts = max_abs(sum) > rounding * size;
  const Scaled right(Real3{select(counts, sum.x, zero), select(counts, sum.y, zero), select(counts, sum.z, zero)});
  const Real3 now = right.unit();
  const Real angle = upper_angle(Scaled(cross(shown, now)).whole_length(), dot(shown, now));
  const RealMask is_drawn = size > least, has_normal = right.whole_length() > least;
  const RealMask shows = !(max_abs(shown) == zero);
  const Real judged = select(has_normal & is_drawn, angle * Real(kDegreesPerRadian), Real(kNotJudged));
  return select(shows | !is_drawn, judged, Real(kNotLit));
}

void ShownAngles(const ShownElements& elements, double time, std::span<double> degrees) {
  const Real t(time), rounding(elements.rounding);
  const auto& [from, to, right, share] = elements;
  std::size_t i = 0;
  for (; i + kDoubleLanes <= degrees.size(); i += kDoubleLanes) {
    ShownAngle(load3(from, i), load3(to, i), load3(right, i), Real::load(from.w.data() + i),
               Real::load(right.w.data() + i), rounding, t)
        .store(degrees.data() + i);
  }
  // The remaining elements are computed one at a time, with equal values in all lanes.
  const auto all3 = [](const PlanesOf4& planes, std::size_t k) HWY_ATTR {
    return Real3{Real(planes.x[k]), Real(planes.y[k]), Real(planes.z[k])};
  };
  for (; i < degrees.size(); ++i) {
    double result[kDoubleLanes];
    ShownAngle(all3(from, i), all3(to, i), all3(right, i), Real(from.w[i]), Real(right.w[i]), rounding, t)
        .store(result);
    degrees[i] = result[0];
  }
}

HWY_INLINE Real3 LoadVectors(const Vec3d* from) {
  Real3 v;
  hn::LoadInterleaved3(kDoubles, &from->x, v.x.v, v.y.v, v.z.v);
  return v;
}
HWY_INLINE void StoreVectors(const Real3& v, Vec3d* to) {
  hn::StoreInterleaved3(v.x.v, v.y.v, v.z.v, kDoubles, &to->x);
}

// Replaces each vector v by make(v). The last vectors, which do not fill a vector of lanes, are computed in a buffer.
template <class Make>
HWY_INLINE void ReplaceVectors(std::span<Vec3d> vectors, const Make& make) {
  std::size_t i = 0;
  for (; i + kDoubleLanes <= vectors.size(); i += kDoubleLanes)
    StoreVectors(make(LoadVectors(&vectors[i])), &vectors[i]);
  if (i == vectors.size()) return;
  Vec3d last[kDoubleLanes];
  std::copy(vectors.begin() + static_cast<std::ptrdiff_t>(i), vectors.end(), last);
  StoreVectors(make(LoadVectors(last)), last);
  std::copy_n(last, vectors.size() - i, &vectors[i]);
}

void MakeUnits(std::span<Vec3d> vectors) {
  ReplaceVectors(vectors, [](const Real3& v) HWY_ATTR { return Scaled(v).unit(); });
}

void MakeRoundedUnits(std::span<Vec3d> vectors) {
  ReplaceVectors(vectors, [](const Real3& v) HWY_ATTR {
    const Real3 u = Scaled(v).unit();
    return Real3{RoundedToFloat(u.x), RoundedToFloat(u.y), RoundedToFloat(u.z)};
  });
}

void LengthsOf(std::span<const Vec3d> vectors, std::span<double> lengths) {
  std::size_t i = 0;
  for (; i + kDoubleLanes <= vectors.size(); i += kDoubleLanes)
    Scaled(LoadVectors(&vectors[i])).whole_length().store(&lengths[i]);
  if (i == vectors.size()) return;
  Vec3d last[kDoubleLanes];
  double of_last[kDoubleLanes];
  std::copy(vectors.begin() + static_cast<std::ptrdiff_t>(i), vectors.end(), last);
  Scaled(LoadVectors(last)).whole_length().store(of_last);
  std::copy_n(of_last, vectors.size() - i, &lengths[i]);
}

HWY_INLINE Real3 Select(RealMask mask, const Real3& a, const Real3& b) {
  return {select(mask, a.x, b.x), select(mask, a.y, b.y), select(mask, a.z, b.z)};
}

// Scales vectors to length 1. Most vectors have nearly this length already, and are returned unchanged.
HWY_INLINE Real3 ToUnit(const Real3& v) {
  const RealMask is_near = absolute(dot(v, v) - Real(1.0)) < Real(1e-6);
  return any(!is_near) ? Select(is_near, v, Scaled(v).unit()) : v;
}

void ErrorsOfPairs(std::span<const Vec3d> rendered, std::span<const Vec3d> right, std::span<double> degrees,
                   std::span<Vec3f> differences) {
  const auto compare = [](const Vec3d* of_rendered, const Vec3d* of_right, double* of_degrees,
                          Vec3f* difference) HWY_ATTR {
    const Real3 shown = LoadVectors(of_rendered), truth = LoadVectors(of_right);
    (upper_angle(Scaled(cross(shown, truth)).whole_length(), dot(shown, truth) + Real(0.0)) * Real(kDegreesPerRadian))
        .store(of_degrees);
    const Real zero(0.0), nan(std::numeric_limits<double>::quiet_NaN());
    const Real3 u = ToUnit(truth);
    const Real3 of_lit = ToUnit(shown) - u, of_unlit = Real(-2.0) * u;
    const Real3 found = Select(max_abs(shown) == zero, of_unlit, of_lit);
    Vec3d all[kDoubleLanes];
    StoreVectors(Select(max_abs(truth) == zero, {nan, nan, nan}, found), all);
    for (std::size_t lane = 0; lane < kDoubleLanes; ++lane) difference[lane] = to_float(all[lane]);
  };
  std::size_t i = 0;
  for (; i + kDoubleLanes <= degrees.size(); i += kDoubleLanes)
    compare(&rendered[i], &right[i], &degrees[i], &differences[i]);
  if (i == degrees.size()) return;
  Vec3d last_rendered[kDoubleLanes], last_right[kDoubleLanes];
  double last[kDoubleLanes];
  Vec3f last_differences[kDoubleLanes];
  std::copy(rendered.begin() + static_cast<std::ptrdiff_t>(i), rendered.end(), last_rendered);
  std::copy(right.begin() + static_cast<std::ptrdiff_t>(i), right.end(), last_right);
  compare(last_rendered, last_right, last, last_differences);
  std::copy_n(last, degrees.size() - i, &degrees[i]);
  std::copy_n(last_differences, degrees.size() - i, &differences[i]);
}

void AnglesOfPairs(std::span<const Vec3d> a, std::span<const Vec3d> b, std::span<double> degrees, double per_radian) {
  const auto angles = [per_radian](const Vec3d* of_a, const Vec3d* of_b, double* result) HWY_ATTR {
    const Real3 u = LoadVectors(of_a), v = LoadVectors(of_b);
    // Adding 0 turns -0 into 0, as angle_between() does.
    (upper_angle(Scaled(cross(u, v)).whole_length(), dot(u, v) + Real(0.0)) * Real(per_radian)).store(result);
  };
  std::size_t i = 0;
  for (; i + kDoubleLanes <= degrees.size(); i += kDoubleLanes) angles(&a[i], &b[i], &degrees[i]);
  if (i == degrees.size()) return;
  Vec3d last_a[kDoubleLanes], last_b[kDoubleLanes];
  double last[kDoubleLanes];
  std::copy(a.begin() + static_cast<std::ptrdiff_t>(i), a.end(), last_a);
  std::copy(b.begin() + static_cast<std::ptrdiff_t>(i), b.end(), last_b);
  angles(last_a, last_b, last);
  std::copy_n(last, degrees.size() - i, &degrees[i]);
}

void UpperAngles(std::span<const double> y, std::span<const double> x, std::span<double> radians) {
  std::size_t i = 0;
  for (; i + kDoubleLanes <= radians.size(); i += kDoubleLanes)
    upper_angle(Real::load(&y[i]), Real::load(&x[i])).store(&radians[i]);
  for (; i < radians.size(); ++i) {
    double result[kDoubleLanes];
    upper_angle(Real(y[i]), Real(x[i])).store(result);
    radians[i] = result[0];
  }
}

}  // namespace chronormal::inline internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace chronormal::inline internal {

HWY_EXPORT(TriangleNormals);
HWY_EXPORT(SumsAround);
HWY_EXPORT(ShownAngles);
HWY_EXPORT(AnglesOfPairs);
HWY_EXPORT(ErrorsOfPairs);
HWY_EXPORT(LengthsOf);
HWY_EXPORT(MakeUnits);
HWY_EXPORT(MakeRoundedUnits);
HWY_EXPORT(UpperAngles);

void TrianglesInMotion::gather(VectorView<const float> from, VectorView<const float> to,
                               std::span<const std::uint32_t> corners) {
  assert(corners.size() % 3 == 0);
  count_ = corners.size() / 3;
  positions_.resize((count_ + kTriangles - 1) / kTriangles * kTriangles * kPositionValues);
  for (std::size_t i = 0; i < count_; ++i) {
    float* const first = positions_.data() + i / kTriangles * kTriangles * kPositionValues + i % kTriangles;
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3f start = from[corners[3 * i + c]], end = to[corners[3 * i + c]];
      float* const of_corner = first + 3 * c * kTriangles;
      for (const auto& [k, value] :
           {std::pair{0U, start.x}, {1U, start.y}, {2U, start.z}, {9U, end.x}, {10U, end.y}, {11U, end.z}})
        of_corner[k * kTriangles] = value;
    }
  }
}

void TrianglesInMotion::normals(double t, std::vector<Normal>& result) const {
  result.resize(count_);
  HWY_DYNAMIC_DISPATCH(TriangleNormals)(positions_.data(), count_, t, result.data());
}

void sums_around(const std::vector<TrianglesInMotion::Normal>& normals, std::span<const std::uint32_t> faces,
                 std::span<const std::uint32_t> ends, PlanesOf4& sums) {
  assert(ends.empty() || ends.back() == faces.size());
  sums.resize(ends.size());
  HWY_DYNAMIC_DISPATCH(SumsAround)(normals.data(), faces.data(), ends, sums);
}

void shown_angles(const ShownElements& elements, double t, std::span<double> degrees) noexcept {
  HWY_DYNAMIC_DISPATCH(ShownAngles)(elements, t, degrees);
}

void angles_of_pairs(std::span<const Vec3d> a, std::span<const Vec3d> b, std::span<double> angles,
                     double per_radian) noexcept {
  assert(a.size() == angles.size() && b.size() == angles.size());
  HWY_DYNAMIC_DISPATCH(AnglesOfPairs)(a, b, angles, per_radian);
}

void errors_of_pairs(std::span<const Vec3d> rendered, std::span<const Vec3d> right, std::span<double> degrees,
                     std::span<Vec3f> differences) noexcept {
  assert(rendered.size() == degrees.size() && right.size() == degrees.size() && differences.size() == degrees.size());
  HWY_DYNAMIC_DISPATCH(ErrorsOfPairs)(rendered, right, degrees, differences);
}

void lengths_of(std::span<const Vec3d> vectors, std::span<double> lengths) noexcept {
  assert(vectors.size() == lengths.size());
  HWY_DYNAMIC_DISPATCH(LengthsOf)(vectors, lengths);
}

void make_units(std::span<Vec3d> vectors) noexcept { HWY_DYNAMIC_DISPATCH(MakeUnits)(vectors); }

void make_rounded_units(std::span<Vec3d> vectors) noexcept { HWY_DYNAMIC_DISPATCH(MakeRoundedUnits)(vectors); }

void upper_angles(std::span<const double> y, std::span<const double> x, std::span<double> radians) noexcept {
  assert(y.size() == radians.size() && x.size() == radians.size());
  HWY_DYNAMIC_DISPATCH(UpperAngles)(y, x, radians);
}

}  // namespace chronormal::inline internal
#endif  // HWY_ONCE
