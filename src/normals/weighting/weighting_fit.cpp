#include "chronormal/normals/weighting.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <span>

#include "chronormal/normals/normal_groups.h"
#include "core/blocks.h"
#include "core/portable_math.h"
#include "core/vector_area.h"
#include "normals/weighting/corner_terms.h"
#include "normals/weighting/sampled_normal.h"
#include "normals/weighting/series_bounds.h"
#include "normals/weighting/taylor.h"

namespace chronormal {
namespace {

constexpr std::size_t kFitBlock = 64;

constexpr std::size_t kSamples = 16;      // number of samples of the error, with which the bound is compared
constexpr double kTightness = 2;          // a bound of up to this multiple of the largest sampled error is tight enough
constexpr double kFineEnough = 1e-9;      // an angle in radians; a bound of up to this is tight enough
constexpr int kDeepest = 20;              // largest number of times that the segment is halved
constexpr std::size_t kMostPieces = 256;  // largest number of pieces of the segment for one element

// The control normals of a face, as intervals that contain the exact values.
struct IntervalNormals {
  std::array<std::array<Interval, 3>, 3> control;  // x, y and z of n0, of m and of n1
  // True if the face has an area at some time that is more than rounding error.
  bool area = false;
};

struct IntervalEdge {
  std::array<Interval, 3> from, to;  // the edge at t = 0 and at t = 1
};

std::array<Interval, 3> difference(const Vec3d& a, const Vec3d& b) {
  const auto p = Interval::point;
  return {p(a.x) - p(b.x), p(a.y) - p(b.y), p(a.z) - p(b.z)};
}

std::array<Interval, 3> edge_at(const SegmentEnd& end, std::uint32_t a, std::uint32_t b) {
  std::array<Interval, 3> edge = difference(to_double(end.position(b)), to_double(end.position(a)));
  const std::array<Interval, 3> more = difference(end.residual(b), end.residual(a));
  for (std::size_t i = 0; i < 3; ++i) edge[i] = edge[i] + more[i];
  return edge;
}

IntervalEdge edge_between(const Segment& segment, std::uint32_t a, std::uint32_t b) {
  return {edge_at(SegmentEnd::from(segment), a, b), edge_at(SegmentEnd::to(segment), a, b)};
}

std::array<Interval, 3> cross_of(const std::array<Interval, 3>& a, const std::array<Interval, 3>& b) {
  std::array<Interval, 3> result;
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    result[i] = a[j] * b[k] - a[k] * b[j];
  }
  return result;
}

IntervalNormals face_intervals(const Segment& segment, std::span<const std::uint32_t> face) {
  IntervalNormals sum{};
  const auto edge_to = [&](std::size_t c) { return edge_between(segment, face[0], face[c]); };
  for_fan(face.size(), edge_to, [&sum](const IntervalEdge& e, const IntervalEdge& f) {
    const auto n0 = cross_of(e.from, f.from), n1 = cross_of(e.to, f.to);
    const auto before = cross_of(e.from, f.to), after = cross_of(e.to, f.from);
    for (std::size_t i = 0; i < 3; ++i) {
      sum.control[0][i] = sum.control[0][i] + n0[i];
      sum.control[1][i] = sum.control[1][i] + 0.5 * (before[i] + after[i]);
      sum.control[2][i] = sum.control[2][i] + n1[i];
    }
  });
  return sum;
}

// Returns a quadratic in Bernstein form as a Taylor series about t.
Series<3> about(const Interval& n0, const Interval& m, const Interval& n1, double t) {
  const Interval s = Interval::point(t), rest = Interval::point(1) - s;
  const Interval first = m - n0, last = n1 - m;
  return {rest * (rest * n0 + s * m) + s * (rest * m + s * n1), 2.0 * (rest * first + s * last), last - first};
}

VectorSeries<3> about(const IntervalNormals& n, double t) {
  VectorSeries<3> result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = about(n.control[0][i], n.control[1][i], n.control[2][i], t);
  return result;
}

VectorSeries<2> about(const IntervalEdge& e, double t) {
  const Interval s = Interval::point(t), rest = Interval::point(1) - s;
  VectorSeries<2> result;
  for (std::size_t i = 0; i < 3; ++i) result[i] = {rest * e.from[i] + s * e.to[i], e.to[i] - e.from[i]};
  return result;
}

// Returns the squared length of a vector, given by its series about c, as a series about all points of c + around. The
// first coefficient about c is computed as a sum of squares, so that it is never negative.
template <std::size_t M>
Series<2 * M - 1> squared_length(const VectorSeries<M>& v, const Interval& around) {
  Series<2 * M - 1> squares = dot_product<2 * M - 1>(v, v);
  squares[0] = square(v[0][0]) + square(v[1][0]) + square(v[2][0]);
  return shifted(squares, around);
}

VectorSeries<kTerms> unit_series(const VectorSeries<3>& n, const Interval& around) {
  const Series<5> squares = squared_length(n, around);
  return scaled_by<kTerms>(power<kTerms>(squares, -0.5, reciprocal(square_root(squares[0]))), shifted(n, around));
}

// Returns the angle between two edges, in radians, as a series. The derivative of the angle is
// (x y' - y x') / (x^2 + y^2) with x = e.f and y = |e x f|.
Series<kTerms> angle_series(const VectorSeries<2>& e, const VectorSeries<2>& f, const Interval& around) {
  const VectorSeries<3> c = cross_product<3>(e, f);
  const Series<3> x_here = dot_product<3>(e, f), x = shifted(x_here, around);
  const Series<5> y_squared = squared_length(c, around);
  const Series<kTerms> y = power<kTerms>(y_squared, 0.5, square_root(y_squared[0]));
  const Series<5> lengths = product<5>(squared_length(e, around), squared_length(f, around));
  const Series<kTerms - 1> numerator = product<kTerms - 1>(x, derivative(y)) - product<kTerms - 1>(y, derivative(x));
  const Series<kTerms - 1> speed =
      product<kTerms - 1>(numerator, power<kTerms - 1>(lengths, -1, reciprocal(lengths[0])));

  // The series of the derivative is integrated, starting from the angle at the centre.
  const Interval y_here = square_root(square(c[0][0]) + square(c[1][0]) + square(c[2][0]));
  Series<kTerms> angle;
  angle[0] = angle_of(y_here, x_here[0]);
  if (around.low != 0 || around.high != 0) angle[0] = angle[0] + around * speed[0];
  for (std::size_t k = 1; k < kTerms; ++k) angle[k] = (1 / static_cast<double>(k)) * speed[k - 1];
  return angle;
}

// An angle in radians that differs from `middle` by at most `radius` over a piece of time.
struct CoarseAngle {
  double middle, radius;
};

// Returns the angle between two edges over all of centre + around, for pieces of time in which the angle is not smooth.
// Near 0 and near pi the angle is computed from its tangent.
CoarseAngle coarse_angle(const VectorSeries<2>& e, const VectorSeries<2>& f, const Interval& around) {
  const VectorSeries<3> c = shifted(cross_product<3>(e, f), around);
  const Interval x = shifted(dot_product<3>(e, f), around)[0];
  const double y = largest_length(c[0][0], c[1][0], c[2][0]);
  constexpr double kPi = std::numbers::pi;
  double low = 0, high = kPi;
  if (x.low > 0) high = std::min(kPi, y / x.low);
  if (x.high < 0) low = std::max(0.0, kPi + y / x.high);
  return {low + (high - low) / 2, (high - low) / 2 + 1e-15};
}

// The term that a corner adds, as two series: one about the centre of a piece, and one about all points of the piece.
// The true term may differ from the series by a vector of length `slack`.
struct TermSeries {
  VectorSeries<kTerms> here, around;
  double slack = 0;
};

TermSeries term_series(const Segment& segment, const IntervalNormals& of_face, const CornerVertices& corner,
                       Weighting weighting, double centre, const Interval& piece) {
  constexpr Interval kHere{0, 0};
  const VectorSeries<3> n = about(of_face, centre);
  if (weighting == Weighting::kUniform) return {unit_series(n, kHere), unit_series(n, piece)};

  const VectorSeries<2> e = about(edge_between(segment, corner.here, corner.next), centre);
  const VectorSeries<2> f = about(edge_between(segment, corner.here, corner.previous), centre);
  if (weighting == Weighting::kMax) {
    const auto term = [&](const Interval& around) {
      const Series<5> lengths = product<5>(squared_length(e, around), squared_length(f, around));
      return scaled_by<kTerms>(power<kTerms>(lengths, -1, reciprocal(lengths[0])),
                               shifted(cross_product<3>(e, f), around));
    };
    return {term(kHere), term(piece)};
  }

  if (weighting == Weighting::kInverseEdges || weighting == Weighting::kInverseRoots) {
    const bool of_roots = weighting == Weighting::kInverseRoots;
    const auto term = [&](const Interval& around) {
      const Series<5> lengths = product<5>(squared_length(e, around), squared_length(f, around));
      const Interval root = square_root(lengths[0]);
      const Series<kTerms> weight =
          power<kTerms>(lengths, of_roots ? -0.25 : -0.5, reciprocal(of_roots ? square_root(root) : root));
      return scaled_by<kTerms>(weight, unit_series(n, around));
    };
    return {term(kHere), term(piece)};
  }

  Series<kTerms> angle_here = angle_series(e, f, kHere), angle_around = angle_series(e, f, piece);
  const bool by_area = weighting == Weighting::kAreaAngle;
  double slack = 0;
  if (!std::all_of(angle_around.begin(), angle_around.end(), [](const Interval& a) { return a.finite(); })) {
    const CoarseAngle angle = coarse_angle(e, f, piece);
    angle_here = angle_around = {Interval::point(angle.middle)};
    const VectorSeries<3> all = shifted(n, piece);
    slack = angle.radius * (by_area ? largest_length(all[0][0], all[1][0], all[2][0]) : 1 + 0x1p-50);
  }
  if (by_area) return {scaled_by<kTerms>(angle_here, n), scaled_by<kTerms>(angle_around, shifted(n, piece)), slack};
  return {scaled_by<kTerms>(angle_here, unit_series(n, kHere)), scaled_by<kTerms>(angle_around, unit_series(n, piece)),
          slack};
}

// The data from which the bounds of one element are computed.
struct Element {
  const Segment* segment;
  std::span<const IntervalNormals> of_faces;
  std::span<const std::uint32_t> corners, faces;
  Weighting weighting;
  ControlNormals fit;

  // The cross product and the dot product of the fit and the element's normal, as series about the centre of a piece,
  // and as series about all points of the piece.
  struct Products {
    VectorSeries<kTerms> cross_here, cross_around;
    Series<kTerms> dot_here, dot_around;
    double slack;  // the error of all four series
  };
  [[nodiscard]] Products products(double centre, const Interval& piece) const {
    TermSeries sum;
    for (std::size_t c = 0; c < corners.size(); ++c) {
      if (!adds_something(c)) continue;
      const TermSeries term =
          term_series(*segment, of_faces[faces[c]], corner_vertices(*segment->topology, corners[c], faces[c]),
                      weighting, centre, piece);
      for (std::size_t i = 0; i < 3; ++i) {
        sum.here[i] = sum.here[i] + term.here[i];
        sum.around[i] = sum.around[i] + term.around[i];
      }
      sum.slack += term.slack;
    }
    IntervalNormals control;
    double largest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3d& n = k == 0 ? fit.n0 : k == 1 ? fit.m : fit.n1;
      control.control[k] = {Interval::point(n.x), Interval::point(n.y), Interval::point(n.z)};
      largest = std::max(largest, length(n));
    }
    const VectorSeries<3> q = about(control, centre), q_around = shifted(q, piece);
    return {cross_product<kTerms>(q, sum.here), cross_product<kTerms>(q_around, sum.around),
            dot_product<kTerms>(q, sum.here), dot_product<kTerms>(q_around, sum.around),
            (1 + 1e-12) * sum.slack * largest};
  }

  // Returns true if a corner adds something to the normal at some time. A corner adds nothing if its face never has an
  // area or, unless weights are uniform, if an edge at the corner always has length 0.
  [[nodiscard]] bool adds_something(std::size_t c) const {
    if (!of_faces[faces[c]].area) return false;
    if (weighting == Weighting::kUniform) return true;
    const CornerVertices v = corner_vertices(*segment->topology, corners[c], faces[c]);
    const auto apart = [&](std::uint32_t other) {
      return SegmentEnd::from(*segment).edge(v.here, other) != Vec3d{} ||
             SegmentEnd::to(*segment).edge(v.here, other) != Vec3d{};
    };
    return apart(v.next) && apart(v.previous);
  }

  // Returns an upper bound, in radians, of the angle between the fit and the element's normal over [t0, t1]. Returns pi
  // if no bound is proven.
  [[nodiscard]] double bound(double t0, double t1) const {
    const double centre = t0 + (t1 - t0) / 2, half = (t1 - t0) / 2;
    const Products series = products(centre, Interval{-half, half});
    const double sine = largest_length_over(series.cross_here, series.cross_around, half, series.slack);
    const double cosine = least_over(series.dot_here, series.dot_around, half, series.slack);
    if (!std::isfinite(sine) || !(cosine > 0)) return std::numbers::pi;
    return (1 + 0x1p-48) * portable::atan2((1 + 0x1p-50) * sine, (1 - 0x1p-50) * cosine);
  }

  // Returns an upper bound, in radians, of the angle between the fit and the element's normal over the whole segment.
  // Pieces are halved until their bounds are close to `goal`, also in radians. If a piece of the smallest allowed
  // length has no bound, the result is pi.
  [[nodiscard]] double bound_over_segment(double goal) const {
    struct Piece {
      double t0, t1;
      int depth;
    };
    std::array<Piece, kDeepest + 2> stack;
    std::size_t waiting = 0, pieces = 0;
    stack[waiting++] = {0, 1, 0};
    double worst = 0;
    while (waiting > 0) {
      const Piece piece = stack[--waiting];
      const double here = bound(piece.t0, piece.t1);
      ++pieces;
      if (here <= std::max(goal, worst)) {
        worst = std::max(worst, here);
      } else if (piece.depth < kDeepest && (pieces < kMostPieces || here >= std::numbers::pi)) {
        const double middle = piece.t0 + (piece.t1 - piece.t0) / 2;
        stack[waiting++] = {middle, piece.t1, piece.depth + 1};
        stack[waiting++] = {piece.t0, middle, piece.depth + 1};
      } else {
        if (here >= std::numbers::pi) return std::numbers::pi;
        worst = std::max(worst, here);
      }
    }
    return worst;
  }
};

// Returns true if all corners belong to one face and the sum of the terms of the corners certainly has the direction of
// this face. The weights of a triangle vanish only with its area. For other polygons, the result is true only for
// uniform weights.
bool is_direction_of_one_face(const Segment& segment, std::span<const std::uint32_t> faces, Weighting weighting) {
  if (faces.empty()) return false;
  for (const std::uint32_t face : faces) {
    if (face != faces.front()) return false;
  }
  return weighting == Weighting::kUniform || segment.topology->face(faces.front()).size() == 3;
}

}  // namespace

WeightingFit fit_weighting(const Segment& segment, const NormalGroups& groups, Weighting weighting) {
  WeightingFit fit;
  if (weighting == Weighting::kArea) {
    fit.normals = all_group_control_normals(segment, groups);
    fit.bounds.assign(groups.size(), 0.0);
    return fit;
  }
  fit.normals.resize(groups.size());
  fit.bounds.resize(groups.size());

  // The normals of all faces are computed once: as intervals, and at the times of the samples.
  const std::size_t face_count = segment.topology->face_count();
  std::vector<IntervalNormals> intervals(face_count);
  std::vector<std::vector<Vec3d>> of_faces(kSamples + 1, std::vector<Vec3d>(face_count));
  const auto sample_time = [](std::size_t i) { return static_cast<double>(i) / kSamples; };
  parallel_blocks(face_count, kFitBlock, [&](IndexRange faces) {
    for (std::size_t f = faces.first; f < faces.end(); ++f) {
      ControlNormals n;
      face_control_normals(segment, {f, 1}, {&n, 1});
      intervals[f] = face_intervals(segment, segment.topology->face(f));
      intervals[f].area = n != ControlNormals{};
    }
    for (std::size_t i = 0; i <= kSamples; ++i)
      face_normals_at(segment, sample_time(i), faces, std::span(of_faces[i]).subspan(faces.first, faces.count));
  });

  parallel_blocks(groups.size(), kFitBlock, [&](IndexRange elements) {
    for (std::size_t e = elements.first; e < elements.end(); ++e) {
      if (is_direction_of_one_face(segment, groups.faces(e), weighting)) {
        face_control_normals(segment, {groups.faces(e).front(), 1}, {&fit.normals[e], 1});
        continue;
      }
      Element element{&segment, intervals, groups.corners(e), groups.faces(e), weighting, {}};
      std::array<Vec3d, kSamples + 1> truth;
      std::array<Vec3d, 3> node;
      for (std::size_t i = 0; i <= kSamples; ++i) {
        const auto normal_of_face = [&](std::uint32_t f) { return of_faces[i][f]; };
        const SampledNormal sampled =
            sample_normal(segment, normal_of_face, element.corners, element.faces, weighting, sample_time(i));
        truth[i] = sampled.normal;
        if (i % (kSamples / 2) == 0) node[i / (kSamples / 2)] = sampled.with_area_length();
      }
      element.fit = quadratic_through(node[0], node[1], node[2]);
      fit.normals[e] = element.fit;

      bool anything = false;
      for (std::size_t c = 0; c < element.corners.size(); ++c) anything = anything || element.adds_something(c);
      double largest = 0;
      for (std::size_t i = 0; i <= kSamples; ++i)
        largest = std::max(largest, angle_between(normal_at(element.fit, sample_time(i)), truth[i]));
      fit.bounds[e] = anything ? element.bound_over_segment(std::max(kTightness * largest, kFineEnough)) : 0;
    }
  });
  return fit;
}

}  // namespace chronormal
