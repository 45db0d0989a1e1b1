/// Computes n(t) of an element without any rounding, for cases that double cannot decide.
///
/// The control normals of a face are sums of products of its coordinates, which are floats or sums of a few floats
/// (motion/segment_end.h). The control normals of a group are sums of those of its faces. So all control normals are
/// integers times 2^-298 (core/wide_integer.h). A double t is an integer times a power of two as well, and by Horner's
/// rule
///
///     n(t) = n0 + t (2m - 2 n0 + t (n0 - 2m + n1))                             (eq. 5 in powers of t)
///
/// is such an integer, too. If t is a quotient of differences of doubles (LocalTime), n(t) is such an integer divided
/// by the square of the divisor. So the zeros and the direction of n(t) are known exactly. An exact evaluation takes
/// about a microsecond for each t, hundreds of times longer than in double. So integers are only used where double
/// fails: where the bound of its rounding error is not small relative to |n(t)|.
///
/// No edges are computed. The sum of the products of neighbouring corners is the vector area (the shoelace formula),
/// and for integers the distance from the origin does not matter.
#ifndef CHRONORMAL_NORMALS_CONTROL_EXACT_CURVE_H_
#define CHRONORMAL_NORMALS_CONTROL_EXACT_CURVE_H_

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "core/wide_integer.h"

namespace chronormal::inline internal {

/// A time t = part / whole, where both are integers. Doubles and their differences are integers times 2^-1074, which
/// have at most 2099 bits.
struct TimeFraction {
  static constexpr std::size_t kDigits = 89;

  WideInteger<kDigits> part, whole;  ///< both settled (WideInteger::settle())

  [[nodiscard]] static TimeFraction of(const LocalTime& t) noexcept {
    const DoubleParts start = DoubleParts::of(t.start), time = DoubleParts::of(t.time), end = DoubleParts::of(t.end);
    unsigned shift = std::numeric_limits<unsigned>::max();
    for (const DoubleParts& parts : {start, time, end})
      if (parts.mantissa != 0) shift = std::min(shift, parts.shift);
    TimeFraction result;
    result.part.add(time, shift);
    result.part.add(start, shift, -1);
    result.whole.add(end, shift);
    result.whole.add(start, shift, -1);
    result.part.settle();
    result.whole.settle();
    return result;
  }
};

class ExactCurve {
 public:
  // The number of digits (WideInteger) of a coefficient. Products have up to 23 digits; the other digits are for sums
  // of up to 2^40 products.
  static constexpr std::size_t kDigits = 26;
  using Coefficient = WideInteger<kDigits>;
  using CoefficientVector = std::array<Coefficient, 3>;

  /// Make the curve of a polygon, given by its vertices, and the curve of several faces, which is the sum of their
  /// curves.
  [[nodiscard]] static ExactCurve of_polygon(const Segment& segment, std::span<const std::uint32_t> vertices) noexcept;
  [[nodiscard]] static ExactCurve of_faces(const Segment& segment, std::span<const std::uint32_t> faces) noexcept;

  /// Adds another curve. The result has the same bits as that of of_faces() for the faces of both curves.
  void add(const ExactCurve& other) noexcept;

  /// Makes a curve from the numbers that append_to() has written.
  [[nodiscard]] static ExactCurve of_kept(const std::int32_t* kept) noexcept;
  /// Appends the numbers of this curve to a list, as few as possible. A curve has about 40 numbers if all coordinates
  /// are of similar size.
  void append_to(std::vector<std::int32_t>& kept) const;

  /// Returns the control normals. Each component is rounded once or twice.
  [[nodiscard]] ControlNormals rounded() const noexcept;
  /// Returns n(t). Each component is rounded a few times. t must be the result of local_time().
  [[nodiscard]] Vec3d normal_at(const LocalTime& t) const noexcept;
  /// Returns the middle control normal of the part [s, t] of the curve, rounded as by normal_at(). The result is the
  /// blossom (polar form) of n at (s, t), which is n(t) if s = t. s and t must be doubles from local_time().
  [[nodiscard]] Vec3d blossom_at(double s, double t) const noexcept;
  /// Returns n(t) / |n(t)|. The cases of Direction are decided exactly. t must be the result of local_time().
  [[nodiscard]] UnitNormal unit_normal_at(const LocalTime& t) const noexcept;
  /// Returns n(t) without any rounding, as integers that are settled (WideInteger::settle()), in units of 2^(2 base() -
  /// 298 - 2 t.scale).
  static constexpr std::size_t kValueDigits = 50;  // the two factors t have 2 (53 + 200) bits together
  using Value = std::array<WideInteger<kValueDigits>, 3>;
  [[nodiscard]] Value integers_at(const UnitFraction& t) const noexcept;
  /// Returns the exponent of the unit of coordinates: all coordinates are multiples of 2^(base - 149).
  [[nodiscard]] unsigned base() const noexcept { return base_; }
  /// Returns the coefficients c0, c1, c2 of n(t) = c0 + c1 t + c2 t^2, as integers that are settled
  /// (WideInteger::settle()), with a common unit that is a power of two.
  [[nodiscard]] std::array<CoefficientVector, 3> in_powers() const noexcept;

 private:
  template <class Body>
  [[nodiscard]] static ExactCurve of(const Segment& segment, const Body& for_polygons) noexcept;
  void add_polygon(const Segment& segment, std::span<const std::uint32_t> vertices) noexcept;

  // Calls body for each component of all control normals, in the order of ControlNormals: x, y, z of n0, and so on.
  template <class Body>
  void for_components(const Body& body);
  template <class Body>
  void for_components(const Body& body) const;

  [[nodiscard]] Vec3d normal_at_double(double t) const noexcept;
  [[nodiscard]] UnitNormal unit_normal_at_double(double t) const noexcept;

  [[nodiscard]] int unit() const noexcept { return 2 * static_cast<int>(base_) - 298; }

  [[nodiscard]] CoefficientVector linear() const noexcept;  // the coefficient 2m - 2 n0 of t
  [[nodiscard]] CoefficientVector bend() const noexcept;    // the coefficient n0 - 2m + n1 of t^2

  CoefficientVector n0_, twice_m_, n1_;
  unsigned base_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_NORMALS_CONTROL_EXACT_CURVE_H_
