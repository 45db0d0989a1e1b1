/// An oracle for every scheme: the textbook definition in long double, computed independently.
///
/// This file includes no chronormal header and shares no line with src/, so a mistake in the product stays hidden only
/// if this file repeats it. If there are several methods, the file uses the more direct and slower one:
///
///     exact        eq. 1 on the interpolated vertices, never a polynomial
///     lagrange     Neville's recursion, never weights
///     slerp        the paper's eq. 5; de Casteljau as its literal recursion
///     quaternion   a slerp in four dimensions between the quaternions of two frames; the normal is a matrix column
///     circle       plane, circumcentre, radius and in-plane angles of three points, never an axis formula
///     optimal      a dense search over the circles of eq. 6; gives only the error, not the path
///     scaled       a dense search over the scale; also gives only the error
///
/// A triangle is given by six points, and t is in [0, 1]. Functions return std::nullopt if a scheme is not defined, or
/// if t is so close to such a case that rounding decides the answer. A scheme is not defined for antipodal ends of a
/// slerp, two coinciding points of a circle, a node (a time of an interpolated normal) at which the normal is zero, or
/// a quaternion arc of exactly half a turn. Tests skip such cases.
#ifndef CHRONORMAL_TESTS_SUPPORT_REFERENCE_H_
#define CHRONORMAL_TESTS_SUPPORT_REFERENCE_H_

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <optional>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <utility>
#include <vector>

namespace chronormal::reference {

using Real = long double;

template <class S>
using Vec = std::array<S, 3>;
using Vector = Vec<Real>;
using VectorD = Vec<double>;  ///< in double, for the dense searches, which compute millions of angles

inline constexpr Real kPi = std::numbers::pi_v<Real>;

/// If the angle between two unit vectors differs from half a turn by less than this limit, in radians, rounding decides
/// which great circle joins the vectors.
inline constexpr Real kNearAntipodal = 1e-6L;
/// If two points on the unit sphere are closer than this distance, in radians, they count as one point of a circle.
inline constexpr Real kNearCoincident = 1e-6L;
/// Below this angle, in radians, slerp and normalised linear interpolation differ by far less than the precision of
/// float32.
inline constexpr Real kTinyAngle = 1e-9L;
/// The limit of |q0 . q1| below which rounding decides which arc between the quaternions q0 and q1 is shorter.
inline constexpr Real kNearHalfTurn = 1e-9L;

/// The indices of a face (`element`) and of a segment, which determine the angle by which `quaternion:random` rotates
/// the second frame about its normal.
struct Place {
  std::uint64_t element = 0;
  std::uint64_t segment = 0;
};

/// A triangle: its corners a, b, c at t = 0 and at t = 1.
struct Triangle {
  std::array<Vector, 3> from;
  std::array<Vector, 3> to;
};

// ---- vectors -------------------------------------------------------------------------------------------------------

template <class S, std::size_t N>
[[nodiscard]] std::array<S, N> add(const std::array<S, N>& a, const std::array<S, N>& b) {
  std::array<S, N> sum{};
  for (std::size_t i = 0; i < N; ++i) sum[i] = a[i] + b[i];
  return sum;
}

template <class S, std::size_t N>
[[nodiscard]] std::array<S, N> scaled(S factor, const std::array<S, N>& a) {
  std::array<S, N> product{};
  for (std::size_t i = 0; i < N; ++i) product[i] = factor * a[i];
  return product;
}

template <class S, std::size_t N>
[[nodiscard]] std::array<S, N> subtract(const std::array<S, N>& a, const std::array<S, N>& b) {
  return add(a, scaled(S(-1), b));
}

template <class S, std::size_t N>
[[nodiscard]] S dot(const std::array<S, N>& a, const std::array<S, N>& b) {
  S sum = 0;
  for (std::size_t i = 0; i < N; ++i) sum += a[i] * b[i];
  return sum;
}

template <class S, std::size_t N>
[[nodiscard]] S length(const std::array<S, N>& a) {
  return std::sqrt(dot(a, a));
}

template <class S, std::size_t N>
[[nodiscard]] std::array<S, N> normalised(const std::array<S, N>& a) {
  return scaled(S(1) / length(a), a);
}

template <class S>
[[nodiscard]] Vec<S> cross(const Vec<S>& a, const Vec<S>& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

/// Returns the angle between a and b in radians, by atan2. The vectors need not have length 1.
template <class S>
[[nodiscard]] S angle(const Vec<S>& a, const Vec<S>& b) {
  return std::atan2(length(cross(a, b)), dot(a, b));
}

[[nodiscard]] inline VectorD to_double(const Vector& a) {
  return {static_cast<double>(a[0]), static_cast<double>(a[1]), static_cast<double>(a[2])};
}

[[nodiscard]] inline Vector to_real(const VectorD& a) { return {Real(a[0]), Real(a[1]), Real(a[2])}; }

// ---- exact normals -------------------------------------------------------------------------------------------------

/// Returns n(t) by eq. 1 of the paper, from the corners at t.
[[nodiscard]] inline Vector exact_normal(const Triangle& triangle, Real t) {
  std::array<Vector, 3> corner{};
  for (std::size_t i = 0; i < 3; ++i) {
    corner[i] = add(scaled(1 - t, triangle.from[i]), scaled(t, triangle.to[i]));
  }
  return cross(subtract(corner[1], corner[0]), subtract(corner[2], corner[0]));
}

/// Returns the exact unit normal, or nothing if the normal is zero or below the rounding error of long double.
[[nodiscard]] inline std::optional<Vector> exact_unit_normal(const Triangle& triangle, Real t) {
  const Vector normal = exact_normal(triangle, t);
  Real edge = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    for (const auto& corners : {triangle.from, triangle.to}) {
      edge = std::max(edge, length(subtract(corners[i], corners[(i + 1) % 3])));
    }
  }
  if (!(length(normal) > 1e-18L * edge * edge)) return std::nullopt;
  return normalised(normal);
}

// ---- slerp, Lagrange, de Casteljau ---------------------------------------------------------------------------------

/// Interpolates spherically between two unit vectors of any dimension, by eq. 5 of the paper.
template <std::size_t N>
[[nodiscard]] std::optional<std::array<Real, N>> slerp(const std::array<Real, N>& from, const std::array<Real, N>& to,
                                                       Real t) {
  // Computes half the angle from the lengths of the difference and of the sum of the vectors. This method is accurate
  // for small and large angles, and needs no cross product, which does not exist in four dimensions.
  const Real theta = 2 * std::atan2(length(subtract(to, from)), length(add(to, from)));
  if (theta > kPi - kNearAntipodal) return std::nullopt;
  if (theta < kTinyAngle) return normalised(add(scaled(1 - t, from), scaled(t, to)));
  return scaled(1 / std::sin(theta), add(scaled(std::sin((1 - t) * theta), from), scaled(std::sin(t * theta), to)));
}

/// Returns exact unit normals at `count` equidistant times from 0 to 1. `Moving` is Triangle, or another type that
/// exact_unit_normal() accepts.
template <class Moving>
[[nodiscard]] std::optional<std::vector<Vector>> exact_nodes(const Moving& triangle, std::size_t count) {
  std::vector<Vector> nodes;
  for (std::size_t i = 0; i < count; ++i) {
    const auto node = exact_unit_normal(triangle, static_cast<Real>(i) / static_cast<Real>(count - 1));
    if (!node) return std::nullopt;
    nodes.push_back(*node);
  }
  return nodes;
}

/// Interpolates exact unit normals by Lagrange's polynomial of degree `degree`, which Neville's recursion evaluates,
/// and normalises the result.
template <class Moving>
[[nodiscard]] std::optional<Vector> lagrange(const Moving& triangle, std::size_t degree, Real t) {
  auto nodes = exact_nodes(triangle, degree + 1);
  if (!nodes) return std::nullopt;
  const auto time = [degree](std::size_t i) { return static_cast<Real>(i) / static_cast<Real>(degree); };
  for (std::size_t width = 1; width <= degree; ++width) {
    for (std::size_t i = 0; i + width <= degree; ++i) {
      const Real left = (time(i + width) - t) / (time(i + width) - time(i));
      (*nodes)[i] = add(scaled(left, (*nodes)[i]), scaled(1 - left, (*nodes)[i + 1]));
    }
  }
  if (length(nodes->front()) < 1e-7L) return std::nullopt;  // float32 cannot distinguish such a short vector from zero
  return normalised(nodes->front());
}

/// Evaluates de Casteljau's algorithm on the sphere: replaces neighbouring vectors by their slerp at t until one vector
/// is left.
[[nodiscard]] inline std::optional<Vector> spherical_de_casteljau(const std::vector<Vector>& polygon, Real t) {
  if (polygon.size() == 1) return polygon.front();
  std::vector<Vector> shorter;
  for (std::size_t i = 0; i + 1 < polygon.size(); ++i) {
    const auto between = slerp(polygon[i], polygon[i + 1], t);
    if (!between) return std::nullopt;
    shorter.push_back(*between);
  }
  return spherical_de_casteljau(shorter, t);
}

// ---- matrices and quaternions --------------------------------------------------------------------------------------

template <std::size_t N>
using Matrix = std::array<std::array<Real, N>, N>;  ///< an array of rows

using Quaternion = std::array<Real, 4>;  ///< in the order w, x, y, z

/// A frame: the columns tangent, binormal and normal of a rotation matrix.
struct Frame {
  Vector tangent, binormal, normal;
};

template <std::size_t N>
[[nodiscard]] Matrix<N> multiply(const Matrix<N>& a, const Matrix<N>& b) {
  Matrix<N> product{};
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) {
      for (std::size_t k = 0; k < N; ++k) product[i][j] += a[i][k] * b[k][j];
    }
  }
  return product;
}

template <std::size_t N>
[[nodiscard]] std::array<Real, N> multiply(const Matrix<N>& a, const std::array<Real, N>& v) {
  std::array<Real, N> product{};
  for (std::size_t i = 0; i < N; ++i) product[i] = dot(a[i], v);
  return product;
}

template <std::size_t N>
[[nodiscard]] Matrix<N> transposed(const Matrix<N>& a) {
  Matrix<N> result{};
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) result[i][j] = a[j][i];
  }
  return result;
}

/// Returns the inverse of a matrix by Gauss-Jordan elimination with row pivoting, or nothing if the matrix is singular.
template <std::size_t N>
[[nodiscard]] std::optional<Matrix<N>> inverse(Matrix<N> a) {
  Matrix<N> result{};
  for (std::size_t i = 0; i < N; ++i) result[i][i] = 1;
  for (std::size_t column = 0; column < N; ++column) {
    std::size_t pivot = column;
    for (std::size_t row = column + 1; row < N; ++row) {
      if (std::fabs(a[row][column]) > std::fabs(a[pivot][column])) pivot = row;
    }
    if (!(std::fabs(a[pivot][column]) > 1e-15L)) return std::nullopt;
    std::swap(a[pivot], a[column]);
    std::swap(result[pivot], result[column]);
    const Real factor = 1 / a[column][column];
    a[column] = scaled(factor, a[column]);
    result[column] = scaled(factor, result[column]);
    for (std::size_t row = 0; row < N; ++row) {
      if (row == column) continue;
      const Real multiple = a[row][column];
      a[row] = subtract(a[row], scaled(multiple, a[column]));
      result[row] = subtract(result[row], scaled(multiple, result[column]));
    }
  }
  return result;
}

[[nodiscard]] inline Matrix<3> to_matrix(const Frame& frame) {
  return transposed(Matrix<3>{frame.tangent, frame.binormal, frame.normal});
}

/// Converts a rotation matrix to a unit quaternion. Computes the component with the largest absolute value first, and
/// the others from it.
[[nodiscard]] inline Quaternion to_quaternion(const Matrix<3>& r) {
  const Real trace = r[0][0] + r[1][1] + r[2][2];
  std::array<Real, 4> four_squares{1 + trace, 1 + 2 * r[0][0] - trace, 1 + 2 * r[1][1] - trace,
                                   1 + 2 * r[2][2] - trace};
  const auto largest = static_cast<std::size_t>(
      std::distance(four_squares.begin(), std::max_element(four_squares.begin(), four_squares.end())));
  // Each variable is four times the product of two components of the quaternion: wx is 4 w x. The antisymmetric part of
  // the matrix gives w x, w y and w z, and the symmetric part gives the others.
  const Real wx = r[2][1] - r[1][2], wy = r[0][2] - r[2][0], wz = r[1][0] - r[0][1];
  const Real xy = r[0][1] + r[1][0], xz = r[0][2] + r[2][0], yz = r[1][2] + r[2][1];
  Quaternion q{};
  if (largest == 0) q = {four_squares[0], wx, wy, wz};
  if (largest == 1) q = {wx, four_squares[1], xy, xz};
  if (largest == 2) q = {wy, xy, four_squares[2], yz};
  if (largest == 3) q = {wz, xz, yz, four_squares[3]};
  return normalised(q);
}

/// Converts a unit quaternion to a rotation matrix.
[[nodiscard]] inline Matrix<3> to_matrix(const Quaternion& q) {
  const auto [w, x, y, z] = q;
  return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
           {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
           {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

/// Interpolates two frames by a quaternion slerp on the shorter arc. Returns the normal, which is the third column of
/// the resulting matrix.
[[nodiscard]] inline std::optional<Vector> quaternion_slerp(const Frame& from, const Frame& to, Real t) {
  const Quaternion q0 = to_quaternion(to_matrix(from));
  Quaternion q1 = to_quaternion(to_matrix(to));
  if (std::fabs(dot(q0, q1)) < kNearHalfTurn) return std::nullopt;
  if (dot(q0, q1) < 0) q1 = scaled(Real(-1), q1);
  const auto q = slerp(q0, q1, t);
  if (!q) return std::nullopt;
  const Matrix<3> r = to_matrix(*q);
  return Vector{r[0][2], r[1][2], r[2][2]};
}

// ---- frames --------------------------------------------------------------------------------------------------------

[[nodiscard]] inline std::optional<Frame> edge_frame(const std::array<Vector, 3>& corners, const Vector& normal) {
  const Vector edge = subtract(corners[1], corners[0]);
  if (!(length(edge) > 0)) return std::nullopt;
  const Vector tangent = normalised(edge);
  return Frame{tangent, cross(normal, tangent), normal};
}

/// Returns the matrix M of eqs. 7 and 8, which maps the corners (w = 1) and the normal (w = 0) at t = 0 to the corners
/// and the normal at t = 1.
[[nodiscard]] inline std::optional<Matrix<4>> triangle_map(const Triangle& triangle, const Vector& normal0,
                                                           const Vector& normal1) {
  const auto homogeneous = [](const std::array<Vector, 3>& corners, const Vector& normal) {
    Matrix<4> columns{};
    for (std::size_t j = 0; j < 4; ++j) {
      const Vector& column = j < 3 ? corners[j] : normal;
      for (std::size_t i = 0; i < 3; ++i) columns[i][j] = column[i];
      columns[3][j] = j < 3 ? 1 : 0;
    }
    return columns;
  };
  const auto back = inverse(homogeneous(triangle.from, normal0));
  if (!back) return std::nullopt;
  return multiply(homogeneous(triangle.to, normal1), *back);
}

/// Returns the rotation in the polar decomposition of a matrix, by Newton's iteration R <- (R + R^-T) / 2.
[[nodiscard]] inline std::optional<Matrix<3>> polar_rotation(Matrix<3> r) {
  for (int i = 0; i < 100; ++i) {
    const auto back = inverse(r);
    if (!back) return std::nullopt;
    const Matrix<3> other = transposed(*back);
    Real change = 0;
    for (std::size_t row = 0; row < 3; ++row) {
      const Vector next = scaled(Real(0.5L), add(r[row], other[row]));
      change = std::max(change, length(subtract(next, r[row])));
      r[row] = next;
    }
    if (change < 1e-17L) return r;
  }
  return std::nullopt;
}

/// Returns the angle in radians by which `quaternion:random:SEED` rotates the second frame about its normal.
[[nodiscard]] inline Real random_turn(std::uint64_t seed, const Place& place) {
  std::uint64_t z = seed + 0x9E3779B97F4A7C15U * (1 + place.element + 0x100000000U * place.segment);
  z = (z ^ (z >> 30U)) * 0xBF58476D1CE4E5B9U;
  z = (z ^ (z >> 27U)) * 0x94D049BB133111EBU;
  z = z ^ (z >> 31U);
  return 2 * kPi * (static_cast<Real>(z) / 0x1p64L);
}

/// Returns the frames of a triangle at t = 0 and at t = 1. `choice` says how their tangents are chosen: "matrix",
/// "edge", "polar" or "random".
[[nodiscard]] inline std::optional<std::pair<Frame, Frame>> frames(std::string_view choice, const Triangle& triangle,
                                                                   std::uint64_t seed, const Place& place) {
  const auto normal0 = exact_unit_normal(triangle, 0);
  const auto normal1 = exact_unit_normal(triangle, 1);
  if (!normal0 || !normal1) return std::nullopt;
  const auto frame0 = edge_frame(triangle.from, *normal0);
  const auto frame1 = edge_frame(triangle.to, *normal1);
  if (!frame0 || !frame1) return std::nullopt;
  if (choice == "edge") return std::pair{*frame0, *frame1};
  if (choice == "random") {
    const Real psi = random_turn(seed, place);
    Frame turned = *frame1;
    turned.tangent = add(scaled(std::cos(psi), frame1->tangent), scaled(std::sin(psi), frame1->binormal));
    turned.binormal = cross(turned.normal, turned.tangent);
    return std::pair{*frame0, turned};
  }
  const auto map = triangle_map(triangle, *normal0, *normal1);
  if (!map) return std::nullopt;
  if (choice == "matrix") {
    const Vector& b = frame0->binormal;
    const auto image = multiply(*map, std::array<Real, 4>{b[0], b[1], b[2], 0});
    Frame mapped{};
    mapped.normal = *normal1;
    mapped.binormal = normalised(Vector{image[0], image[1], image[2]});
    // As the tangent, the paper prints n1 x b1, which would give a frame with the determinant -1. The correct tangent
    // is the cross product of the binormal and the normal.
    mapped.tangent = cross(mapped.binormal, mapped.normal);
    return std::pair{*frame0, mapped};
  }
  Matrix<3> linear{};
  for (std::size_t i = 0; i < 3; ++i) {
    for (std::size_t j = 0; j < 3; ++j) linear[i][j] = (*map)[i][j];
  }
  const auto rotation = polar_rotation(linear);
  if (!rotation) return std::nullopt;
  return std::pair{*frame0, Frame{multiply(*rotation, frame0->tangent), multiply(*rotation, frame0->binormal),
                                  multiply(*rotation, frame0->normal)}};
}

// ---- circles -------------------------------------------------------------------------------------------------------

/// The circle through three points, which runs from the first point through the second to the third.
struct Circle {
  Vector centre, x, y;  ///< x and y are unit vectors: x points to the first point, and the circle starts along y
  Real radius = 0;
  Real middle = 0;  ///< angle of the second point
  Real end = 0;     ///< angle of the third point; 0 < middle < end < 2 pi

  [[nodiscard]] Vector at(Real turn) const {
    return add(centre, add(scaled(radius * std::cos(turn), x), scaled(radius * std::sin(turn), y)));
  }
};

[[nodiscard]] inline std::optional<Circle> circle_through(const Vector& first, const Vector& second,
                                                          const Vector& third) {
  const Vector p = subtract(second, first), q = subtract(third, first);
  if (length(p) < kNearCoincident || length(q) < kNearCoincident || length(subtract(p, q)) < kNearCoincident) {
    return std::nullopt;
  }
  const Vector normal = cross(p, q);
  // `arm` goes from the first point to the circumcentre of the three points.
  const Vector arm = scaled(1 / (2 * dot(normal, normal)),
                            add(scaled(dot(q, q), cross(normal, p)), scaled(dot(p, p), cross(q, normal))));
  Circle circle;
  circle.centre = add(first, arm);
  circle.radius = length(arm);
  circle.x = scaled(-1 / circle.radius, arm);
  // The plane of the circle has two opposite normals. The code may use either normal, since the angles below decide the
  // direction of the circle.
  const Real side = normal[0] + Real(0.37L) * normal[1] + Real(0.11L) * normal[2] > 0 ? 1 : -1;
  circle.y = cross(normalised(scaled(side, normal)), circle.x);
  const auto turn = [&circle](const Vector& point) {
    const Vector spoke = subtract(point, circle.centre);
    const Real found = std::atan2(dot(spoke, circle.y), dot(spoke, circle.x));
    return found < 0 ? found + 2 * kPi : found;
  };
  circle.middle = turn(second);
  circle.end = turn(third);
  if (circle.middle > circle.end) {  // the end comes before the middle, so the direction is reversed
    circle.y = scaled(Real(-1), circle.y);
    circle.middle = 2 * kPi - circle.middle;
    circle.end = 2 * kPi - circle.end;
  }
  return circle;
}

/// Returns the normal at t by the scheme `circle` or, if `timed`, `circle:timed`.
template <class Moving>
[[nodiscard]] std::optional<Vector> circle_normal(const Moving& triangle, bool timed, Real t) {
  const auto u0 = exact_unit_normal(triangle, 0);
  const auto uh = exact_unit_normal(triangle, Real(0.5L));
  const auto u1 = exact_unit_normal(triangle, 1);
  if (!u0 || !uh || !u1) return std::nullopt;
  if (length(add(*u0, *uh)) < kNearCoincident) return std::nullopt;  // here the scheme uses a documented fallback
  const auto circle = circle_through(*u0, *uh, *u1);
  if (!circle) return std::nullopt;
  Real share = t;
  if (timed) {
    const Real r = circle->middle / circle->end;
    share = r * t / ((1 - r) * (1 - t) + r * t);
  }
  return circle->at(share * circle->end);
}

// ---- every scheme by its name --------------------------------------------------------------------------------------

/// The parts of the name of a scheme: "quaternion:random:7" has the kind "quaternion:random" and the number 7.
struct SchemeName {
  std::string_view kind;
  std::uint64_t number = 0;
};

/// Splits the name of a scheme into its parts. Returns nothing if this oracle does not know the scheme.
[[nodiscard]] inline std::optional<SchemeName> parse_scheme(std::string_view name) {
  static constexpr std::array<std::string_view, 14> kPlain{
      "recompute",     "polynomial",        "rational",        "linear",           "quadratic", "cubic",
      "slerp",         "quaternion:matrix", "quaternion:edge", "quaternion:polar", "circle",    "circle:timed",
      "linear:scaled", "quaternion:optimal"};
  for (const auto plain : kPlain) {
    if (name == plain) return SchemeName{plain, 0};
  }
  if (name == "lagrange:K" || name == "decasteljau:K" || name == "quaternion:random:SEED") return std::nullopt;
  if (name == "decasteljau") return SchemeName{"decasteljau", 4};
  for (const std::string_view numbered : {"lagrange", "decasteljau", "quaternion:random"}) {
    if (name.size() <= numbered.size() + 1 || !name.starts_with(numbered) || name[numbered.size()] != ':') continue;
    const std::string_view digits = name.substr(numbered.size() + 1);
    SchemeName parsed{numbered, 0};
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), parsed.number);
    if (error == std::errc{} && end == digits.data() + digits.size()) return parsed;
  }
  return std::nullopt;
}

/// Tells whether a scheme finds a parameter of its path by a search.
[[nodiscard]] inline bool is_searched(std::string_view name) {
  return name == "quaternion:optimal" || name == "linear:scaled";
}

/// Returns the unit normal that a scheme must give at t, or nothing if the scheme is not defined there or `name` is
/// unknown.
///
/// A scheme for which is_searched() is true finds a parameter of its path by a search. For such a scheme,
/// `observed_middle` is the result of the tested scheme at t = 1/2, which determines the parameter, and thereby the
/// result at every other t. Without `observed_middle`, the function returns nothing for such a scheme.
/// optimal_circle_error() and scaled_linear_error() test the search itself.
template <class Moving>
[[nodiscard]] std::optional<Vector> unit_normal(std::string_view name, const Moving& triangle, Real t,
                                                const Place& place = {},
                                                const std::optional<Vector>& observed_middle = {}) {
  const auto scheme = parse_scheme(name);
  if (!scheme) return std::nullopt;
  const auto kind = scheme->kind;
  const auto number = static_cast<std::size_t>(scheme->number);
  if (kind == "recompute" || kind == "polynomial" || kind == "rational") return exact_unit_normal(triangle, t);
  if (kind == "linear") return lagrange(triangle, 1, t);
  if (kind == "quadratic") return lagrange(triangle, 2, t);
  if (kind == "cubic") return lagrange(triangle, 3, t);
  if (kind == "lagrange") return lagrange(triangle, number, t);
  if (kind == "circle") return circle_normal(triangle, false, t);
  if (kind == "circle:timed") return circle_normal(triangle, true, t);
  if (kind == "slerp") {
    const auto ends = exact_nodes(triangle, 2);
    return ends ? slerp(ends->front(), ends->back(), t) : std::nullopt;
  }
  if (kind == "decasteljau") {
    const auto nodes = exact_nodes(triangle, number);
    return nodes ? spherical_de_casteljau(*nodes, t) : std::nullopt;
  }
  if (is_searched(kind)) {
    const auto ends = exact_nodes(triangle, 2);
    if (!ends || !observed_middle) return std::nullopt;
    if (kind == "linear:scaled") {
      // At t = 1/2, the observed normal (`middle`) is parallel to u0 + s u1, where u0 and u1 are the normals at t = 0
      // and t = 1. The number s is |u0 x middle| divided by |middle x u1|.
      const Real with_end = length(cross(*observed_middle, ends->back()));
      const Real with_start = length(cross(ends->front(), *observed_middle));
      if (length(cross(ends->front(), ends->back())) < kNearCoincident) return std::nullopt;
      const Vector sum = add(scaled((1 - t) * with_end, ends->front()), scaled(t * with_start, ends->back()));
      if (length(sum) < 1e-7L) return std::nullopt;
      return normalised(sum);
    }
    const auto circle = circle_through(ends->front(), normalised(*observed_middle), ends->back());
    return circle ? std::optional(circle->at(t * circle->end)) : std::nullopt;
  }
  if constexpr (std::is_same_v<Moving, Triangle>) {
    const auto pair = frames(kind.substr(kind.find(':') + 1), triangle, scheme->number, place);
    return pair ? quaternion_slerp(pair->first, pair->second, t) : std::nullopt;
  }
  return std::nullopt;  // only faces have frames
}

// ---- errors and dense searches -------------------------------------------------------------------------------------

/// Exact unit normals in double at the equidistant times i / (count - 1). An entry is empty if the normal is zero.
struct ExactSamples {
  std::vector<std::optional<VectorD>> unit;

  ExactSamples(const Triangle& triangle, std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) {
      const auto u = exact_unit_normal(triangle, static_cast<Real>(i) / static_cast<Real>(count - 1));
      unit.push_back(u ? std::optional(to_double(*u)) : std::nullopt);
    }
  }

  [[nodiscard]] double time(std::size_t i) const {
    return static_cast<double>(i) / static_cast<double>(unit.size() - 1);
  }
};

/// Returns the average angle, in radians, between exact samples and a curve. The curve is a function of t that returns
/// a VectorD, whose length need not be 1. Uses every `stride`-th sample.
template <class Curve>
[[nodiscard]] double mean_error(const ExactSamples& exact, Curve&& curve, std::size_t stride = 1) {
  double sum = 0;
  std::size_t counted = 0;
  for (std::size_t i = 0; i < exact.unit.size(); i += stride) {
    if (!exact.unit[i]) continue;
    sum += angle(*exact.unit[i], curve(exact.time(i)));
    ++counted;
  }
  return counted == 0 ? 0 : sum / static_cast<double>(counted);
}

/// Returns the smallest value of f that a golden-section search between low and high finds.
template <class F>
[[nodiscard]] double golden_section_minimum(F&& f, double low, double high, int steps) {
  const double golden = (std::sqrt(5.0) - 1) / 2;
  double left = high - golden * (high - low), right = low + golden * (high - low);
  double at_left = f(left), at_right = f(right);
  double best = std::min(at_left, at_right);
  for (int i = 0; i < steps; ++i) {
    if (at_left < at_right) {
      high = std::exchange(right, left);
      at_right = std::exchange(at_left, f(left = high - golden * (high - low)));
    } else {
      low = std::exchange(left, right);
      at_left = std::exchange(at_right, f(right = low + golden * (high - low)));
    }
    best = std::min({best, at_left, at_right});
  }
  return best;
}

/// Returns the global minimum of a function between the first and the last point of a grid, whose points must ascend.
/// Evaluates an approximation of the function, `coarse`, at all points of the grid, and then refines the best few local
/// minima with `fine`.
template <class Coarse, class Fine>
[[nodiscard]] double dense_minimum(const std::vector<double>& grid, Coarse&& coarse, Fine&& fine) {
  std::vector<double> values;
  for (const double x : grid) values.push_back(coarse(x));
  std::vector<std::pair<double, std::size_t>> minima;
  for (std::size_t i = 0; i < grid.size(); ++i) {
    const bool left_is_lower = i > 0 && values[i - 1] < values[i];
    const bool right_is_lower = i + 1 < grid.size() && values[i + 1] < values[i];
    if (!left_is_lower && !right_is_lower) minima.emplace_back(values[i], i);
  }
  std::sort(minima.begin(), minima.end());
  double best = fine(grid[minima.front().second]);
  for (std::size_t k = 0; k < std::min<std::size_t>(minima.size(), 4); ++k) {
    const std::size_t i = minima[k].second;
    const double low = grid[i == 0 ? 0 : i - 1], high = grid[std::min(i + 1, grid.size() - 1)];
    best = std::min(best, golden_section_minimum(fine, low, high, 16));
  }
  return best;
}

/// Returns the average error, in radians, of the normals on one circle of eq. 6 of the paper through u0 and u1. The
/// angle phi, in radians, selects the axis of the circle.
[[nodiscard]] inline double circle_family_error(const ExactSamples& exact, const VectorD& u0, const VectorD& u1,
                                                double phi, std::size_t stride = 1) {
  const VectorD axis =
      add(scaled(std::cos(phi), normalised(cross(u0, u1))), scaled(std::sin(phi), normalised(add(u0, u1))));
  const VectorD w = scaled(dot(axis, u0), axis);
  const VectorD p = subtract(u0, w), q = cross(axis, u0), p1 = subtract(u1, w);
  double arc = std::atan2(dot(p1, q), dot(p1, p));
  if (arc < 0) arc += 2 * static_cast<double>(kPi);
  return mean_error(
      exact, [&](double t) { return add(w, add(scaled(std::cos(t * arc), p), scaled(std::sin(t * arc), q))); }, stride);
}

/// Returns the smallest average error over the samples, in radians, that a dense search over all pairs of frames finds.
/// Each pair of frames gives a circle of eq. 6 of the paper, which an angle phi selects. The normal runs at constant
/// speed on the shorter arc of the circle, for which |phi| <= pi/2. Returns nothing if the normals u0 at t = 0 and u1
/// at t = 1 coincide or are antipodal.
///
/// The search tries `density` values that are equidistant in phi, and as many that are equidistant in the direction in
/// which the circle leaves u0. Equidistant directions are needed if u0 and u1 are close, since circles then differ
/// visibly only if phi is near +-pi/2.
[[nodiscard]] inline std::optional<double> optimal_circle_error(const Triangle& triangle, const ExactSamples& exact,
                                                                std::size_t density = 100,
                                                                std::size_t coarse_stride = 5) {
  const auto end0 = exact_unit_normal(triangle, 0), end1 = exact_unit_normal(triangle, 1);
  if (!end0 || !end1) return std::nullopt;
  const Real between = angle(*end0, *end1);
  if (between < kNearCoincident || between > kPi - kNearAntipodal) return std::nullopt;
  const VectorD u0 = to_double(*end0), u1 = to_double(*end1);
  const double half_sine = std::sin(static_cast<double>(between) / 2);
  const double quarter = static_cast<double>(kPi) / 2;
  std::vector<double> grid;
  for (std::size_t i = 0; i <= density; ++i) {
    const double even = quarter * (2 * static_cast<double>(i) / static_cast<double>(density) - 1);
    grid.push_back(even);
    // If T is the angle between u0 and u1, the circle and the great circle through u0 and u1 meet at u0 at the angle
    // atan(-tan(phi) sin(T/2)).
    grid.push_back(std::atan2(std::sin(even), std::cos(even) * half_sine));
  }
  std::sort(grid.begin(), grid.end());
  return dense_minimum(
      grid, [&](double phi) { return circle_family_error(exact, u0, u1, phi, coarse_stride); },
      [&](double phi) { return circle_family_error(exact, u0, u1, phi); });
}

/// Returns the average error, in radians, of the normals along the straight line u0 + t (s u1 - u0).
[[nodiscard]] inline double scaled_family_error(const ExactSamples& exact, const VectorD& u0, const VectorD& u1,
                                                double s, std::size_t stride = 1) {
  return mean_error(
      exact, [&](double t) { return add(scaled(1 - t, u0), scaled(t * s, u1)); }, stride);
}

/// Returns the smallest average error, in radians, of the normals along a straight line u0 + t (s u1 - u0), over all s
/// > 0.
[[nodiscard]] inline std::optional<double> scaled_linear_error(const Triangle& triangle, const ExactSamples& exact,
                                                               std::size_t density = 320,
                                                               std::size_t coarse_stride = 2) {
  const auto end0 = exact_unit_normal(triangle, 0), end1 = exact_unit_normal(triangle, 1);
  if (!end0 || !end1) return std::nullopt;
  const VectorD u0 = to_double(*end0), u1 = to_double(*end1);
  std::vector<double> grid;  // values of log2(s)
  for (std::size_t i = 0; i <= density; ++i) {
    grid.push_back(16 * (2 * static_cast<double>(i) / static_cast<double>(density) - 1));
  }
  return dense_minimum(
      grid, [&](double s) { return scaled_family_error(exact, u0, u1, std::exp2(s), coarse_stride); },
      [&](double s) { return scaled_family_error(exact, u0, u1, std::exp2(s)); });
}

}  // namespace chronormal::reference

#endif  // CHRONORMAL_TESTS_SUPPORT_REFERENCE_H_
