// Decides the sides of faces by the sign of f(t) = n(t) . w(t), where w is the vector to the viewer. Each of three
// stages settles the faces for which its answer is certain.
//
// 1. The Bernstein coefficients of f, from control normals that are within 2^-26 of their length of the exact ones:
//    if all are clearly positive, or all negative, so is f. This stage settles most faces.
// 2. The same coefficients with the bound of the face's own rounding, and their roots: the only root in lanes
//    (analysis/signs/kernels/facing_lanes.h), several roots one face at a time (analysis/signs/certain_roots.h).
// 3. Integers (analysis/signs/exact_roots.h), for faces that touch edge-on, are edge-on at an end or in the middle, or
//    have no area. If a bracket of the second stage is too wide, signs of integers narrow it.

#include "chronormal/analysis/signs.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>

#include "analysis/signs/certain_roots.h"
#include "analysis/signs/exact_roots.h"
#include "analysis/signs/kernels/facing_lanes.h"
#include "analysis/signs/length_1.h"
#include "core/rounding.h"
#include "motion/segment_end.h"
#include "normals/control/exact_curve.h"
#include "normals/control/polygon_normals.h"

namespace chronormal {
namespace {

Side side_of(int sign) { return static_cast<Side>(sign); }

// Returns true if products with the vector to the viewer do not underflow in double. The condition is that no nonzero
// component of the view is smaller than the smallest float32.
bool fits_double(const View& view) noexcept {
  const auto fits = [](double component) { return component == 0 || std::fabs(component) >= 0x1p-149; };
  return fits(view.from.x) && fits(view.from.y) && fits(view.from.z) && fits(view.to.x) && fits(view.to.y) &&
         fits(view.to.z);
}

// Returns the position of the eye on its path. The error is at most 3 u (u = 2^-53) times the largest component of both
// ends of the path.
Vec3d eye_at(const View& view, const LocalTime& on_way) noexcept {
  if (on_way.t == 0) return view.from;
  return on_way.rest == 0 ? view.to : on_way.rest * view.from + on_way.t * view.to;
}

bool is_whole_way(const View& view) noexcept { return view.start.t == 0 && view.end.rest == 0; }

// Marks face i of a block as undecided, so that a later stage decides its side.
void leave(std::size_t i, FacingCoefficients& f) noexcept {
  f.signs[i] = 0;
  for (auto& bounds : f.bounds) bounds[i] = std::numeric_limits<double>::infinity();
}

// Computes the coefficients of f = n . w for a block of faces from their control normals, which is the first stage.
void glance(const Segment& segment, IndexRange faces, const ControlNormals* normals, const View& view,
            FacingCoefficients& result) noexcept {
  const bool fits = fits_double(view);
  if (!view.is_eye) {
    facing_of_direction(normals, faces.count, view.from, result);
    for (std::size_t i = 0; i < faces.count && !fits; ++i) leave(i, result);
    return;
  }
  FacingWays ways{};
  const Vec3d from = eye_at(view, view.start), to = eye_at(view, view.end);
  for (std::size_t i = 0; i < faces.count; ++i) {
    const std::uint32_t corner = segment.topology->face(faces.first + i)[0];
    const Vec3d at_start = SegmentEnd::from(segment).way_to(from, corner),
                at_end = SegmentEnd::to(segment).way_to(to, corner);
    ways.at[0][i] = at_start.x, ways.at[1][i] = at_start.y, ways.at[2][i] = at_start.z;
    ways.at[3][i] = at_end.x, ways.at[4][i] = at_end.y, ways.at[5][i] = at_end.z;
  }
  facing_of_eye(normals, faces.count, ways, result);
  // The position of an eye on a part of its path has an error of 3 u of the size of the path's ends. This error is at
  // most 6 u of the vector from a face to the eye, if that vector is at least half as large as the path's ends. Faces
  // with shorter vectors are left to integers.
  const double shortest = is_whole_way(view) ? 0 : 0.5 * std::max(max_abs(view.from), max_abs(view.to));
  if (fits && shortest == 0) return;
  for (std::size_t i = 0; i < faces.count; ++i) {
    double longest = 0;
    for (const auto& component : ways.at) longest = std::max(longest, std::fabs(component[i]));
    if (!fits || longest < shortest) leave(i, result);
  }
}

// Returns the sides of a face that the viewer may see while the shutter is open, from the coefficients of the first
// stage alone. Returns no value if the coefficients are not precise enough.
template <std::size_t M>
std::optional<ShutterSide> side_by_glance(const FacingCoefficients& f, std::size_t i, double t0, double t1) noexcept {
  if (f.signs[i] != 0) return static_cast<ShutterSide>(f.signs[i]);
  const auto is_clear = [&f, i](std::size_t k) { return std::fabs(f.values[k][i]) > f.bounds[k][i]; };
  const bool differ = (f.values[0][i] < 0) != (f.values[M - 1][i] < 0);
  if (t0 == 0 && t1 == 1 && differ && is_clear(0) && is_clear(M - 1)) return ShutterSide::kBoth;
  if (!(t0 < t1)) return std::nullopt;
  std::array<double, M> p;
  double size = 0, bound = 0;
  for (std::size_t k = 0; k < M; ++k) {
    constexpr double kShareOfInner = 1.0 / (M - 1);
    p[k] = k == 0 || k == M - 1 ? f.values[k][i] : kShareOfInner * f.values[k][i];
    size = std::max(size, std::fabs(p[k]));
    bound = std::max(bound, f.bounds[k][i]);
  }
  constexpr double kRoundings = 64;  // number of roundings in the coefficients and in restrict_to()
  bound += kRoundings * kUnitRoundoff * size;
  // If the front is certainly seen at one of the five times below, and the back at another, the answer is kBoth.
  bool shows_front = false, shows_back = false;
  for (const double share : {0.0, 1.0, 0.5, 0.25, 0.75}) {
    const double t = share == 1 ? t1 : t0 + share * (t1 - t0);
    const double value = t == 0 ? p[0] : t == 1 ? p[M - 1] : evaluate(p, t);
    shows_front |= value > bound;
    shows_back |= value < -bound;
    if (shows_front && shows_back) return ShutterSide::kBoth;
  }
  const std::array<double, M> part = restrict_to(p, t0, t1);
  if (std::all_of(part.begin(), part.end(), [bound](double b) { return b > bound; })) return ShutterSide::kFront;
  if (std::all_of(part.begin(), part.end(), [bound](double b) { return b < -bound; })) return ShutterSide::kBack;
  return std::nullopt;
}

// Returns a bound of the error of any component of the control normals of a triangle. In n0 and n1, a component is a
// sum of two products of a component of one edge and a component of the other edge; in m it is half of a sum of four
// such products. The error is at most 48 u of the largest such product by core/rounding.h, and smaller for normals that
// were computed in integers.
double rounding_of_triangle(const Segment& segment, std::span<const std::uint32_t> corners) noexcept {
  const auto largest_edge = [&segment, corners](std::size_t c) {
    const auto edge = [corners, c](const SegmentEnd& end) { return max_abs(end.edge(corners[0], corners[c])); };
    return std::max(edge(SegmentEnd::from(segment)), edge(SegmentEnd::to(segment)));
  };
  return 64 * kUnitRoundoff * largest_edge(1) * largest_edge(2);
}

double rounding_of(const Segment& segment, std::size_t face) noexcept {
  const auto corners = segment.topology->face(face);
  if (corners.size() == 3) return rounding_of_triangle(segment, corners);
  const PolygonNormals polygon = polygon_control_normals(segment, corners);
  return *std::max_element(polygon.errors.begin(), polygon.errors.end());
}

// Writes the polynomial f = n . w of face i of a block, and the bound of its error, to a lane of `roots`.
template <std::size_t M>
void put(const Segment& segment, std::size_t face, const FacingCoefficients& f, std::size_t i, std::size_t lane,
         SingleRoots& roots) noexcept {
  double bound = 0;
  for (std::size_t k = 0; k < M; ++k) {
    constexpr double kShareOfInner = 1.0 / (M - 1);
    roots.p[k][lane] = k == 0 || k == M - 1 ? f.values[k][i] : kShareOfInner * f.values[k][i];
    bound = std::max(bound, f.bounds[k][i]);
  }
  // There are up to 16 roundings: of the position of the eye and the vector to the eye, of the products and sums of a
  // dot product, and of a mean of three numbers. The terms of a dot product are at most bound / kDotShare.
  constexpr double kRoundings = 16;
  roots.error[lane] = f.reach[i] * rounding_of(segment, face) + kRoundings * kUnitRoundoff / kDotShare * bound;
}

// The numbers of digits that wide integers need here. Differences of doubles up to 2^128 have 1,203 bits. A vector to
// the viewer is a sum of a few differences, or of differences that are multiplied by the integers of two times
// (TimeFraction).
constexpr std::size_t kNormalDigits = ExactCurve::kDigits, kPlaceDigits = 52;
constexpr std::size_t kWayDigits = kPlaceDigits + 1, kPartDigits = kPlaceDigits + 2 * TimeFraction::kDigits + 2;
template <std::size_t kDigits>
using WideVector = std::array<WideInteger<kDigits>, 3>;

// Returns the smallest shift (DoubleParts) of all nonzero components of some vectors.
unsigned lowest_shift(std::span<const Vec3d> vectors) noexcept {
  unsigned lowest = std::numeric_limits<unsigned>::max();
  for (const Vec3d& v : vectors) {
    for (const double component : {v.x, v.y, v.z}) {
      const DoubleParts parts = DoubleParts::of(component);
      if (parts.mantissa != 0) lowest = std::min(lowest, parts.shift);
    }
  }
  return lowest;
}

// The position of a corner at an end of the segment, as the sum of a position in float32 and the residual of its
// rounding.
struct Place {
  Vec3d position, residual;

  [[nodiscard]] static Place of(const SegmentEnd& end, std::uint32_t vertex) noexcept {
    return {to_double(end.position(vertex)), end.residual(vertex)};
  }
};

// Returns p - q as integers whose common unit is given by `shift`.
WideVector<kPlaceDigits> difference(const Place& p, const Place& q, unsigned shift) noexcept {
  WideVector<kPlaceDigits> result;
  const auto add = [&](const Vec3d& v, std::int64_t sign) {
    result[0].add(DoubleParts::of(v.x), shift, sign);
    result[1].add(DoubleParts::of(v.y), shift, sign);
    result[2].add(DoubleParts::of(v.z), shift, sign);
  };
  add(p.position, 1);
  add(p.residual, 1);
  add(q.position, -1);
  add(q.residual, -1);
  for (auto& component : result) component.settle();
  return result;
}

// The vector to the viewer, w(t) = start + t change, multiplied by a positive number.
template <std::size_t kDigits>
struct Way {
  WideVector<kDigits> start, change;

  void settle() noexcept {
    for (std::size_t k = 0; k < 3; ++k) {
      start[k].settle();
      change[k].settle();
    }
  }
};

// Returns the vector w from a corner to the viewer. An eye is at view.from and view.to at the ends of the segment; for
// a direction, w does not depend on the corner.
Way<kWayDigits> whole_way(const View& view, const Place& from_corner, const Place& to_corner) noexcept {
  Way<kWayDigits> way;
  const Place from = view.is_eye ? from_corner : Place{}, to = view.is_eye ? to_corner : Place{};
  const unsigned shift =
      lowest_shift(std::array{view.from, view.to, from.position, from.residual, to.position, to.residual});
  const auto start = difference({view.from, {}}, from, shift), end = difference({view.to, {}}, to, shift);
  for (std::size_t k = 0; k < 3; ++k) {
    way.start[k].add(start[k], 1);
    way.change[k].add(end[k], 1);
    way.change[k].add(start[k], -1);
  }
  way.settle();
  return way;
}

// Returns the vector from a corner to an eye that passes only a part of its path in the segment, multiplied by the
// denominators of both times. For the times p / q and r / s, the vector at t = 0 is q s (view.from - from) + p s
// (view.to - view.from).
Way<kPartDigits> part_of_way(const View& view, const Place& from, const Place& to) noexcept {
  constexpr std::size_t kProductDigits = 2 * TimeFraction::kDigits;
  const TimeFraction start = TimeFraction::of(view.start), end = TimeFraction::of(view.end);
  WideInteger<kProductDigits> whole, before, done;
  whole.add_product(start.whole, end.whole);
  before.add_product(start.part, end.whole);
  done.add_product(end.part, start.whole);
  done.add_product(start.part, end.whole, -1);
  for (auto* one : {&whole, &before, &done}) one->settle();
  const unsigned shift =
      lowest_shift(std::array{view.from, view.to, from.position, from.residual, to.position, to.residual});
  const auto to_first = difference({view.from, {}}, from, shift),
             moved = difference({view.to, {}}, {view.from, {}}, shift), corner_moved = difference(to, from, shift);
  Way<kPartDigits> way;
  for (std::size_t k = 0; k < 3; ++k) {
    way.start[k].add_product(to_first[k], whole);
    way.start[k].add_product(moved[k], before);
    way.change[k].add_product(moved[k], done);
    way.change[k].add_product(corner_moved[k], whole, -1);
  }
  way.settle();
  return way;
}

// Returns c n . w as a polynomial in t, for a normal n and a vector w to the viewer. The factor c > 0 makes the
// coefficients whole numbers, so that the sign is exact.
template <std::size_t kDegree, std::size_t kDigits>
auto times_normal(const ExactCurve& normal, const Way<kDigits>& way) noexcept {
  IntegerPolynomial<kDegree, kNormalDigits + kDigits + 1> f;
  const auto c = normal.in_powers();
  for (std::size_t k = 0; k < 3; ++k) {
    for (std::size_t i = 0; i < 3; ++i) {
      f.a[k].add_product(c[k][i], way.start[i]);
      if constexpr (kDegree == 3) f.a[k + 1].add_product(c[k][i], way.change[i]);
    }
  }
  for (auto& coefficient : f.a) coefficient.settle();
  return f;
}

// Calls body(f) with the exact f = n . w of a normal n and the vector w from a vertex to the viewer. M is the number of
// coefficients of f, which is 3 for a direction and 4 for an eye.
template <std::size_t M, class Body>
void in_integers(const Segment& segment, const ExactCurve& normal, std::uint32_t vertex, const View& view,
                 const Body& body) noexcept {
  const Place from = Place::of(SegmentEnd::from(segment), vertex), to = Place::of(SegmentEnd::to(segment), vertex);
  if constexpr (M == 4) {
    if (!is_whole_way(view)) return body(times_normal<3>(normal, part_of_way(view, from, to)));
  }
  body(times_normal<M - 1>(normal, whole_way(view, from, to)));
}
template <std::size_t M, class Body>
void in_integers(const Segment& segment, std::size_t face, const View& view, const Body& body) noexcept {
  const auto vertices = segment.topology->face(face);
  in_integers<M>(segment, ExactCurve::of_polygon(segment, vertices), vertices[0], view, body);
}

// Narrows a bracket of a root. The signs of f at both ends of the bracket are known and differ. The middle of the
// bracket is a good guess of the root, so one step to either side of the middle is usually enough.
template <class Polynomial>
void close_in(const Polynomial& f, int before, double& lower, double& upper) noexcept {
  double step = 0x1p-49, probe = lower + (upper - lower) / 2 - step;
  while (upper - lower > kWidestBracket) {
    // A probe must be inside the bracket. A t below 2^-200 is not distinguished from 0.
    if (!(lower < probe && probe < upper && probe >= 0x1p-200)) probe = lower + (upper - lower) / 2;
    const int sign = f.sign_at(UnitFraction::of(probe));
    if (sign == 0) {
      lower = upper = probe;
    } else if (sign == before) {
      lower = probe;
      probe += 2 * step;
    } else {
      upper = probe;
      probe -= 2 * step;
    }
    step *= 4;
  }
}

bool is_wide(const ExactRoot& root) noexcept { return root.upper - root.lower > kWidestBracket; }

// Finds all roots of f, whose coefficients are within `error` of p. If the roots are not certain, calls decide(body),
// which calls body with the exact f.
template <std::size_t M, class Decide>
Facing facing_by_roots(const std::array<double, M>& p, double error, const Decide& decide) noexcept {
  ExactRoots roots;
  if (!CertainRoots<M>::find(p, error, roots)) {
    decide([&roots](const auto& f) { roots = exact_roots(f); });
  } else if (std::any_of(roots.all().begin(), roots.all().end(), is_wide)) {
    decide([&roots](const auto& f) {
      for (std::size_t k = 0; k < roots.count; ++k)
        close_in(f, roots.at[k].before, roots.at[k].lower, roots.at[k].upper);
    });
  }
  Facing facing;
  facing.side = side_of(roots.sign);
  for (const ExactRoot& root : roots.all())
    facing.at[facing.count++] = {root.lower, root.upper, side_of(root.before), side_of(root.after)};
  return facing;
}

template <std::size_t M>
Facing facing_by_roots(const Segment& segment, std::size_t face, const View& view, const SingleRoots& from,
                       std::size_t lane) noexcept {
  std::array<double, M> p;
  for (std::size_t k = 0; k < M; ++k) p[k] = from.p[k][lane];
  return facing_by_roots<M>(p, from.error[lane], [&](const auto& body) { in_integers<M>(segment, face, view, body); });
}

// The sum of the control normals of some faces in double. `error` bounds the error of any component of the sum, and
// `size` is the size of the terms of the sum.
struct SummedNormals {
  ControlNormals normals;
  double error = 0, size = 0;
};
SummedNormals sum_of(const Segment& segment, std::span<const std::uint32_t> faces) noexcept {
  SummedNormals sum;
  for (const std::uint32_t face : faces) {
    ControlNormals one;
    face_control_normals(segment, {face, 1}, {&one, 1});
    sum.normals = {sum.normals.n0 + one.n0, sum.normals.m + one.m, sum.normals.n1 + one.n1};
    sum.error += rounding_of(segment, face);
    sum.size += std::max({max_abs(one.n0), max_abs(one.m), max_abs(one.n1)});
  }
  sum.error = 2 * (sum.error + static_cast<double>(faces.size()) * kUnitRoundoff * sum.size);
  return sum;
}

template <std::size_t M>
Facing facing_of_sum(const Segment& segment, std::uint32_t vertex, std::span<const std::uint32_t> faces,
                     const View& view) noexcept {
  const auto decide = [&](const auto& body) {
    in_integers<M>(segment, ExactCurve::of_faces(segment, faces), vertex, view, body);
  };
  const SummedNormals sum = sum_of(segment, faces);
  const auto& [n0, m, n1] = sum.normals;
  std::array<double, M> p;
  Vec3d at_start = view.from, at_end = view.to;
  if constexpr (M == 4) {
    at_start = SegmentEnd::from(segment).way_to(view.from, vertex);
    at_end = SegmentEnd::to(segment).way_to(view.to, vertex);
    p = {dot(n0, at_start), (dot(n0, at_end) + 2 * dot(m, at_start)) / 3, (dot(n1, at_start) + 2 * dot(m, at_end)) / 3,
         dot(n1, at_end)};
  } else {
    p = {dot(n0, at_start), dot(m, at_start), dot(n1, at_start)};
  }
  // Integers decide in two cases: if the eye is on a part of its path, where its position would be rounded, or if a
  // component of the view is so small that products with it may be rounded to 0.
  const bool is_sure = fits_double(view) && is_whole_way(view);
  // At most 16 roundings occur, of terms that are no larger than sum.size: in the vector to the viewer, products, sums
  // of three and of two terms, and a third of a sum.
  constexpr double kRoundings = 16;
  const double longest = std::max(length_1(at_start), length_1(at_end));
  const double error = longest * (sum.error + kRoundings * kUnitRoundoff * sum.size);
  return facing_by_roots<M>(p, is_sure ? error : std::numeric_limits<double>::infinity(), decide);
}

template <std::size_t M>
void find_in_block(const Segment& segment, IndexRange faces, const ControlNormals* normals, const View& view,
                   Facing* result) noexcept {
  FacingCoefficients f;
  glance(segment, faces, normals, view, f);
  SingleRoots roots{};
  std::array<std::uint8_t, kFacingBlock> face_of_lane;
  std::size_t lanes = 0;
  for (std::size_t i = 0; i < faces.count; ++i) {
    result[i].count = 0;
    result[i].side = side_of(f.signs[i]);
    if (f.signs[i] != 0) continue;
    put<M>(segment, faces.first + i, f, i, lanes, roots);
    face_of_lane[lanes++] = static_cast<std::uint8_t>(i);
  }
  find_single_roots(M - 1, lanes, roots);
  for (std::size_t lane = 0; lane < lanes; ++lane) {
    const std::size_t i = face_of_lane[lane];
    const int before = roots.before[lane];
    if (before == 0) {
      result[i] = facing_by_roots<M>(segment, faces.first + i, view, roots, lane);
    } else {
      FacingChange& change = result[i].at[0];
      result[i].count = 1;
      change = {roots.lower[lane], roots.upper[lane], side_of(before), side_of(-before)};
      if (change.upper - change.lower > kWidestBracket)
        in_integers<M>(segment, faces.first + i, view,
                       [&](const auto& f_of_face) { close_in(f_of_face, before, change.lower, change.upper); });
    }
  }
}

// Returns the sides of a face that the viewer may see at some t in [t0, t1].
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

template <std::size_t M>
void sides_in_block(const Segment& segment, IndexRange faces, const ControlNormals* normals, const View& view,
                    double t0, double t1, ShutterSide* result) noexcept {
  FacingCoefficients f;
  glance(segment, faces, normals, view, f);
  for (std::size_t i = 0; i < faces.count; ++i) {
    if (const std::optional<ShutterSide> quick = side_by_glance<M>(f, i, t0, t1))
      result[i] = *quick;
    else
      result[i] = side_over(find_facing(segment, faces.first + i, normals[i], view), t0, t1);
  }
}

}  // namespace

void find_facings(const Segment& segment, IndexRange faces, std::span<const ControlNormals> normals, const View& view,
                  std::span<Facing> result) noexcept {
  assert(normals.size() == faces.count && result.size() == faces.count);
  for (std::size_t i = 0; i < faces.count; i += kFacingBlock) {
    const IndexRange block{faces.first + i, std::min(kFacingBlock, faces.count - i)};
    if (view.is_eye)
      find_in_block<4>(segment, block, &normals[i], view, &result[i]);
    else
      find_in_block<3>(segment, block, &normals[i], view, &result[i]);
  }
}

Facing find_facing(const Segment& segment, std::size_t face, const ControlNormals& normals, const View& view) noexcept {
  Facing facing;
  find_facings(segment, {face, 1}, {&normals, 1}, view, {&facing, 1});
  return facing;
}

Facing find_facing(const Segment& segment, std::size_t face, const View& view) noexcept {
  ControlNormals normals;
  face_control_normals(segment, {face, 1}, {&normals, 1});
  return find_facing(segment, face, normals, view);
}

Facing find_vertex_facing(const Segment& segment, std::uint32_t vertex, std::span<const std::uint32_t> faces,
                          const View& view) noexcept {
  return view.is_eye ? facing_of_sum<4>(segment, vertex, faces, view) : facing_of_sum<3>(segment, vertex, faces, view);
}

void sides_over(const Segment& segment, IndexRange faces, std::span<const ControlNormals> normals, const View& view,
                double t0, double t1, std::span<ShutterSide> result) noexcept {
  assert(normals.size() == faces.count && result.size() == faces.count && 0 <= t0 && t0 <= t1 && t1 <= 1);
  for (std::size_t i = 0; i < faces.count; i += kFacingBlock) {
    const IndexRange block{faces.first + i, std::min(kFacingBlock, faces.count - i)};
    if (view.is_eye)
      sides_in_block<4>(segment, block, &normals[i], view, t0, t1, &result[i]);
    else
      sides_in_block<3>(segment, block, &normals[i], view, t0, t1, &result[i]);
  }
}

}  // namespace chronormal
