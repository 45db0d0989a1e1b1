// Computes the mean of the unit normal by Gauss's rule on small pieces of the interval, with a bound of its error.
//
// In a piece n(s) = a + b s + c s^2 with s in [-1, 1], and |n(s)|^2 = q(s) is a quartic with q(0) = |a|^2. For complex
// s with |s| <= R
//     |q(s) - q(0)| <= |q1| R + |q2| R^2 + |q3| R^3 + |q4| R^4 = k |a|^2
// so if k < 1 the unit normal n(s) / sqrt(q(s)) is analytic in that disc, and its component along any direction is at
// most M = (|a| + |b| R + |c| R^2) / (|a| sqrt(1 - k)). The disc with R = (4 + 1/4) / 2 contains the ellipse with the
// foci -1 and 1 whose half-axes have the sum 4, and there Chebyshev's coefficients of an analytic function are at most
// 2 M 4^-j. Gauss's rule with 8 nodes is exact up to degree 15, so the error of the mean is at most
//     32/15 M 4^-16 / (1 - 4^-2)                               (Trefethen, Approximation Theory and Practice, chapter
//                                                              19)
#include "chronormal/analysis/cones.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "analysis/cones/interval_normals.h"
#include "chronormal/core/polynomial.h"
#include "normals/control/local_time.h"

namespace chronormal {
namespace {

constexpr double kRadius = 2.125;
constexpr double kGaussError = 32.0 / 15 * 0x1p-32 / (1 - 0x1p-4);
constexpr double kNearness = 0.5;           // a piece is small enough if k, as defined above, is at most this
constexpr int kDeepest = 28;                // largest number of times that the interval is halved
constexpr double kCurveRounding = 0x1p-47;  // relative rounding error of n(t) and of sums of unit vectors

constexpr std::array<double, 4> kNodes{0.18343464249564980, 0.52553240991632899, 0.79666647741362674,
                                       0.96028985649753623};
constexpr std::array<double, 4> kWeights{0.36268378337836198, 0.31370664587788729, 0.22238103445337447,
                                         0.10122853629037626};

// A piece of the curve n(t). Each control normal of the piece is a sum of vectors, and `size` bounds the sum of the
// lengths of these vectors.
struct Piece {
  Bernstein<Vec3d, 2> n;
  Bernstein<double, 2> size;
};

struct Sum {
  Vec3d unit;
  double error = 0;
};

// The quadratic n(s) = a + b s + c s^2 of a piece, with s in [-1, 1].
struct Centred {
  Vec3d a, b, c;

  explicit Centred(const Bernstein<Vec3d, 2>& n)
      : a(0.25 * (n[0] + 2.0 * n[1] + n[2])), b(0.5 * (n[2] - n[0])), c(0.25 * (n[0] - 2.0 * n[1] + n[2])) {}

  // Returns a number k such that |n(s)|^2 differs from |a|^2 by at most k |a|^2 for all complex s with |s| <= kRadius.
  // The result is infinite or NaN if a = n(0) is zero.
  [[nodiscard]] double nearness() const {
    const double q1 = 2 * dot(a, b), q2 = dot(b, b) + 2 * dot(a, c), q3 = 2 * dot(b, c), q4 = dot(c, c);
    const double sum = kRadius * (std::fabs(q1) + kRadius * (std::fabs(q2) + kRadius * (std::fabs(q3) + kRadius * q4)));
    return sum / dot(a, a);
  }

  [[nodiscard]] Vec3d mean_unit() const {
    Vec3d sum;
    for (std::size_t i = 0; i < kNodes.size(); ++i) {
      for (const double s : {-kNodes[i], kNodes[i]}) {
        const Vec3d n = a + s * (b + s * c);
        sum = sum + (kWeights[i] / std::sqrt(dot(n, n))) * n;
      }
    }
    return 0.5 * sum;
  }
};

void add_piece(const Piece& piece, double share, int depth, Sum& sum) noexcept {
  const Centred n(piece.n);
  const double nearness = n.nearness();
  if (nearness <= kNearness) {
    const double a = length(n.a), root = std::sqrt(1 - nearness);
    const double bound = (a + kRadius * (length(n.b) + kRadius * length(n.c))) / (a * root);
    const double size = std::max({piece.size[0], piece.size[1], piece.size[2]});
    // If two vectors differ by e, their unit vectors differ by at most 2 e divided by the sum of their lengths.
    const double of_input = std::fmin(2 * (kNormalShare + kCurveRounding) * size / (a * root), 2.0);
    sum.unit = sum.unit + share * n.mean_unit();
    sum.error += share * (1.01 * kGaussError * bound + of_input + kCurveRounding);
  } else if (depth == kDeepest) {
    sum.error += share;
  } else {
    const auto n_halves = split(piece.n, 0.5);
    const auto size_halves = split(piece.size, 0.5);
    add_piece({n_halves.before, size_halves.before}, share / 2, depth + 1, sum);
    add_piece({n_halves.after, size_halves.after}, share / 2, depth + 1, sum);
  }
}

// Returns the mean normal and the mean unit normal of a curve whose control normals are sums of vectors. `lengths` has
// the sums of the lengths of these vectors, whose relative errors are at most kNormalShare.
ShutterNormal means_of(const ControlNormals& c, const Bernstein<double, 2>& lengths) noexcept {
  const auto& [n0, m, n1] = c;
  const double largest = std::max({lengths[0], lengths[1], lengths[2]});
  if (largest == 0) return {};
  const Vec3d mean = 1.0 / 3 * (n0 + m + n1);
  if (!std::isfinite(largest)) return {mean, {}, 1};
  // All vectors are scaled by a power of two, so that squares neither overflow nor underflow.
  int exponent = 0;
  (void)std::frexp(largest, &exponent);
  const auto scaled = [exponent](double x) { return std::ldexp(x, -exponent); };
  const auto scaled_vector = [&](const Vec3d& v) { return Vec3d{scaled(v.x), scaled(v.y), scaled(v.z)}; };
  Sum sum;
  add_piece({{scaled_vector(n0), scaled_vector(m), scaled_vector(n1)},
             {scaled(lengths[0]), scaled(lengths[1]), scaled(lengths[2])}},
            1, 0, sum);
  return {mean, sum.unit, std::fmin(sum.error, 2.0)};
}

Bernstein<double, 2> lengths_of(const ControlNormals& c) { return {length(c.n0), length(c.m), length(c.n1)}; }

// Returns the mean normal and the mean unit normal over a part of a segment. `c` has the control normals of the whole
// segment, and `part` has the control normals of the part.
ShutterNormal means_of_part(const ControlNormals& c, const IntervalNormals& part,
                            const Restriction& restriction) noexcept {
  const Bernstein<double, 2> whole = lengths_of(c);
  Bernstein<double, 2> lengths{};
  for (std::size_t k = 0; k < lengths.size(); ++k) {
    for (std::size_t j = 0; j < whole.size(); ++j) lengths[k] += restriction.weights[k][j] * whole[j];
  }
  return means_of(part.normals, lengths);
}

}  // namespace

ShutterNormal shutter_normal(const ControlNormals& normals, double t0, double t1) noexcept {
  assert(0 <= t0 && t0 <= t1 && t1 <= 1);
  const Restriction restriction = Restriction::to(local_time(t0), local_time(t1));
  return means_of_part(normals, part_of(normals, restriction), restriction);
}

ShutterNormal shutter_normal_of_faces(const Segment& segment, std::span<const std::uint32_t> faces, double t0,
                                      double t1) noexcept {
  assert(0 <= t0 && t0 <= t1 && t1 <= 1);
  const ControlNormals exact =
      exact_part_of(ExactCurve::of_faces(segment, faces), local_time(t0), local_time(t1)).normals;
  return means_of(exact, lengths_of(exact));
}

void face_shutter_normals(const Segment& segment, IndexRange faces, double t0, double t1,
                          std::span<ShutterNormal> result) noexcept {
  assert(result.size() == faces.count && faces.end() <= segment.topology->face_count());
  assert(0 <= t0 && t0 <= t1 && t1 <= 1);
  constexpr std::size_t kFacesAtATime = 128;
  const double from = local_time(t0), to = local_time(t1);
  const Restriction restriction = Restriction::to(from, to);
  std::array<ControlNormals, kFacesAtATime> memory;
  for (std::size_t first = 0; first < faces.count; first += kFacesAtATime) {
    const std::span<ControlNormals> normals(memory.data(), std::min(kFacesAtATime, faces.count - first));
    face_control_normals(segment, {faces.first + first, normals.size()}, normals);
    for (std::size_t i = 0; i < normals.size(); ++i) {
      const IntervalNormals part = part_of(normals[i], restriction);
      if (part.is_known()) {
        result[first + i] = means_of_part(normals[i], part, restriction);
      } else {
        const std::span<const std::uint32_t> face = segment.topology->face(faces.first + first + i);
        const ControlNormals exact = exact_part_of(ExactCurve::of_polygon(segment, face), from, to).normals;
        result[first + i] = means_of(exact, lengths_of(exact));
      }
    }
  }
}

}  // namespace chronormal
