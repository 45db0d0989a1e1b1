// Three stages, of which each decides what it is sure of.
//
// 1. The Bernstein coefficients of f, from control normals that are within 2^-26 of their length of the exact ones:
// where
//    all are clearly positive, or all negative, so is f. This is the answer for almost every face.
// 2. The same coefficients with the bound that the face's own rounding has, and their roots
// (analysis/signs/certain_roots.h). 3. Integers (analysis/signs/exact_roots.h), for what touches edge-on, is edge-on at
// an end or in the middle, or has no area.

#include "chronormal/analysis/facing.h"
#include "analysis/signs/length_1.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <optional>

#include "analysis/signs/certain_roots.h"
#include "analysis/signs/exact_roots.h"
#include "core/rounding.h"
#include "normals/control/exact_curve.h"
#include "normals/control/polygon_normals.h"

namespace chronormal {
namespace {

// By how much a dot product with a control normal may be off, against the length_1 of that and the largest component of
// the other vector: sqrt(3) 2^-26 and a few roundings.
constexpr double kDotShare = 0x1p-25;

Side side_of(int sign) { return static_cast<Side>(sign); }

// The way to the eye at both ends.
struct Ways {
  Vec3d from, to;
};

Ways ways_to_eye(const Segment& segment, std::size_t face, const View& view) noexcept {
  const std::uint32_t corner = segment.topology->face(face)[0];
  return {to_double(view.from) - to_double(segment.from[corner]), to_double(view.to) - to_double(segment.to[corner])};
}

// Bernstein coefficients, each times its binomial coefficient, and how far each may be off.
template <std::size_t M>
struct Bounded {
  std::array<double, M> values, bounds;
};

// 1 or -1 where all are beyond their bounds on that side.
template <std::size_t M>
int common_sign(const Bounded<M>& f) noexcept {
  bool is_front = true, is_back = true;
  for (std::size_t k = 0; k < M; ++k) {
    is_front &= f.values[k] > f.bounds[k];
    is_back &= f.values[k] < -f.bounds[k];
  }
  return static_cast<int>(is_front) - static_cast<int>(is_back);
}

Bounded<3> from_far(const ControlNormals& c, const Vec3d& w) noexcept {
  const double share = kDotShare * max_abs(w);
  return {{dot(c.n0, w), 2 * dot(c.m, w), dot(c.n1, w)},
          {share * length_1(c.n0), 2 * share * length_1(c.m), share * length_1(c.n1)}};
}

Bounded<4> from_eye(const ControlNormals& c, const Ways& w) noexcept {
  const double share = kDotShare * std::fmax(max_abs(w.from), max_abs(w.to));
  const double n0 = share * length_1(c.n0), m = 2 * share * length_1(c.m), n1 = share * length_1(c.n1);
  return {{dot(c.n0, w.from), dot(c.n0, w.to) + 2 * dot(c.m, w.from), 2 * dot(c.m, w.to) + dot(c.n1, w.from),
           dot(c.n1, w.to)},
          {n0, n0 + m, m + n1, n1}};
}

// Calls body with the coefficients of f by the control normals.
template <class Body>
auto glance(const Segment& segment, std::size_t face, const ControlNormals& normals, const View& view,
            const Body& body) noexcept {
  if (view.is_eye) return body(from_eye(normals, ways_to_eye(segment, face, view)));
  return body(from_far(normals, to_double(view.from)));
}

// What a shutter sees by the control normals alone, where they can tell.
template <std::size_t M>
std::optional<ShutterSide> side_by_glance(const Bounded<M>& f, double t0, double t1) noexcept {
  if (const int sign = common_sign(f); sign != 0) return static_cast<ShutterSide>(sign);
  const auto is_clear = [&f](std::size_t k) { return std::fabs(f.values[k]) > f.bounds[k]; };
  const bool differ = (f.values[0] < 0) != (f.values[M - 1] < 0);
  if (t0 == 0 && t1 == 1 && differ && is_clear(0) && is_clear(M - 1)) return ShutterSide::kBoth;
  if (!(t0 < t1)) return std::nullopt;
  std::array<double, M> p;
  double size = 0, bound = 0;
  for (std::size_t k = 0; k < M; ++k) {
    constexpr double kShareOfInner = 1.0 / (M - 1);
    p[k] = k == 0 || k == M - 1 ? f.values[k] : kShareOfInner * f.values[k];
    size = std::fmax(size, std::fabs(p[k]));
    bound = std::fmax(bound, f.bounds[k]);
  }
  constexpr double kRoundings = 64;  // of restrict_to() and of the coefficients
  bound += kRoundings * kUnitRoundoff * size;
  // A front and a back that are seen for certain settle it: at the ends, or between them.
  bool shows_front = false, shows_back = false;
  for (const double share : {0.0, 1.0, 0.5, 0.25, 0.75}) {
    const double t = share == 1 ? t1 : t0 + share * (t1 - t0);
    const double value = t == 0 ? p[0] : t == 1 ? p[M - 1] : evaluate(p, t);
    shows_front |= value > bound;
    shows_back |= value < -bound;
    if (shows_front && shows_back) return ShutterSide::kBoth;
  }
  Bounded<M> part{restrict_to(p, t0, t1), {}};
  part.bounds.fill(bound);
  const int sign = common_sign(part);
  return sign != 0 ? std::optional(static_cast<ShutterSide>(sign)) : std::nullopt;
}

std::optional<ExactRoots> in_double(const Segment& segment, std::size_t face, const View& view) noexcept {
  const PolygonNormals own = polygon_control_normals(segment, segment.topology->face(face));
  const auto& [n0, m, n1] = own.normals;
  const double error = *std::max_element(own.errors.begin(), own.errors.end());
  const double size = std::fmax(max_abs(n0), std::fmax(max_abs(m), max_abs(n1)));
  constexpr double kRoundings = 16;  // of w, of the products and sums of a dot product, and of a mean of three
  const auto bound = [&](double w) { return (error + kRoundings * kUnitRoundoff * size) * w; };
  if (!view.is_eye) {
    const Vec3d w = to_double(view.from);
    return CertainRoots<3>::of({dot(n0, w), dot(m, w), dot(n1, w)}, bound(length_1(w)));
  }
  const Ways w = ways_to_eye(segment, face, view);
  return CertainRoots<4>::of({dot(n0, w.from), (dot(n0, w.to) + 2 * dot(m, w.from)) / 3,
                              (2 * dot(m, w.to) + dot(n1, w.from)) / 3, dot(n1, w.to)},
                             bound(std::fmax(length_1(w.from), length_1(w.to))));
}

constexpr std::size_t kNormalDigits = ExactCurve::kDigits, kWayDigits = 14;
using Way = std::array<WideInteger<kWayDigits>, 3>;
using Coefficient = WideInteger<kNormalDigits + kWayDigits + 1>;

void add_float(float value, std::int64_t sign, WideInteger<kWayDigits>& sum) noexcept {
  sum.add_product(FloatParts::of(value), FloatParts{1, 0}, sign);
}

void add_vector(const Vec3f& v, std::int64_t sign, Way& sum) noexcept {
  add_float(v.x, sign, sum[0]);
  add_float(v.y, sign, sum[1]);
  add_float(v.z, sign, sum[2]);
}

void add_dot(const ExactCurve::CoefficientVector& n, const Way& w, Coefficient& sum) noexcept {
  for (std::size_t k = 0; k < 3; ++k) sum.add_product(n[k], w[k]);
}

ExactRoots in_integers(const Segment& segment, std::size_t face, const View& view) noexcept {
  const auto vertices = segment.topology->face(face);
  const auto c = ExactCurve::of_polygon(segment, vertices).in_powers();
  // w(t) = start + t change
  Way start, change;
  add_vector(view.from, 1, start);
  if (view.is_eye) {
    const Vec3f from = segment.from[vertices[0]], to = segment.to[vertices[0]];
    add_vector(from, -1, start);
    add_vector(view.to, 1, change);
    add_vector(view.from, -1, change);
    add_vector(to, -1, change);
    add_vector(from, 1, change);
  }
  for (std::size_t k = 0; k < 3; ++k) {
    start[k].settle();
    change[k].settle();
  }
  std::array<Coefficient, 4> f;
  for (std::size_t k = 0; k < 3; ++k) {
    add_dot(c[k], start, f[k]);
    if (view.is_eye) add_dot(c[k], change, f[k + 1]);
  }
  for (Coefficient& coefficient : f) coefficient.settle();
  if (!view.is_eye) return exact_roots(IntegerPolynomial<2, kNormalDigits + kWayDigits + 1>{{f[0], f[1], f[2]}});
  return exact_roots(IntegerPolynomial<3, kNormalDigits + kWayDigits + 1>{f});
}

Facing behind_glance(const Segment& segment, std::size_t face, const View& view) noexcept {
  const std::optional<ExactRoots> quick = in_double(segment, face, view);
  const ExactRoots roots = quick ? *quick : in_integers(segment, face, view);
  Facing facing;
  facing.side = side_of(roots.sign);
  for (const ExactRoot& root : roots.all())
    facing.at[facing.count++] = {root.lower, root.upper, side_of(root.before), side_of(root.after)};
  return facing;
}

// The sides that may be seen in [t0, t1].
ShutterSide side_over(const Facing& facing, double t0, double t1) noexcept {
  bool shows_front = false, shows_back = false;
  const auto show = [&](Side side) {
    shows_front |= side == Side::kFront;
    shows_back |= side == Side::kBack;
  };
  if (facing.count == 0) show(facing.side);
  for (const FacingChange& change : facing.changes()) {
    if (t0 < change.upper && (&change == facing.at.data() || (&change - 1)->lower < t1)) show(change.before);
  }
  if (facing.count > 0 && facing.at[facing.count - 1].lower < t1) show(facing.last());
  if (!shows_front) return ShutterSide::kBack;
  return shows_back ? ShutterSide::kBoth : ShutterSide::kFront;
}

}  // namespace

Facing find_facing(const Segment& segment, std::size_t face, const ControlNormals& normals, const View& view) noexcept {
  const int sign = glance(segment, face, normals, view, [](const auto& f) { return common_sign(f); });
  if (sign != 0) return {{}, 0, side_of(sign)};
  return behind_glance(segment, face, view);
}

Facing find_facing(const Segment& segment, std::size_t face, const View& view) noexcept {
  ControlNormals normals;
  face_control_normals(segment, {face, 1}, {&normals, 1});
  return find_facing(segment, face, normals, view);
}

void sides_over(const Segment& segment, IndexRange faces, std::span<const ControlNormals> normals, const View& view,
                double t0, double t1, std::span<ShutterSide> result) noexcept {
  assert(normals.size() == faces.count && result.size() == faces.count && 0 <= t0 && t0 <= t1 && t1 <= 1);
  for (std::size_t i = 0; i < faces.count; ++i) {
    const std::size_t face = faces.first + i;
    const auto quick =
        glance(segment, face, normals[i], view, [&](const auto& f) { return side_by_glance(f, t0, t1); });
    result[i] = quick ? *quick : side_over(behind_glance(segment, face, view), t0, t1);
  }
}

}  // namespace chronormal
