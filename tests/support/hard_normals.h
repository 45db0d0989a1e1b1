/// Makes control normals that are hard to store in few bits, and measures the errors of stored control normals.
///
/// The control normals depend only on random numbers and powers of two, and have the same bits with every compiler.
/// Errors are computed in long double from the original control normals. On x86, rounding changes the errors by less
/// than 1e-18 of the largest control normal.
#ifndef CHRONORMAL_TESTS_SUPPORT_HARD_NORMALS_H_
#define CHRONORMAL_TESTS_SUPPORT_HARD_NORMALS_H_

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/normals/control_normals.h"
#include "tests/support/fixtures.h"

namespace chronormal::test {

using Real = long double;
using RealVector = std::array<Real, 3>;

[[nodiscard]] inline RealVector normal_in_long_double(const ControlNormals& c, double t) {
  const Real s = 1 - Real{t}, w0 = s * s, wm = 2 * Real{t} * s, w1 = Real{t} * t;
  return {w0 * c.n0.x + wm * c.m.x + w1 * c.n1.x, w0 * c.n0.y + wm * c.m.y + w1 * c.n1.y,
          w0 * c.n0.z + wm * c.m.z + w1 * c.n1.z};
}

[[nodiscard]] inline Real length(const RealVector& v) { return std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]); }

[[nodiscard]] inline double largest_of(const ControlNormals& c) {
  return std::max({max_abs(c.n0), max_abs(c.m), max_abs(c.n1)});
}

/// Returns the angle between u and the normal n(t) in radians, or NaN if a component of u is NaN.
[[nodiscard]] inline double angle_to(const Vec3f& u, const ControlNormals& c, double t) {
  const RealVector n = normal_in_long_double(c, t);
  const Real x = u.y * n[2] - u.z * n[1], y = u.z * n[0] - u.x * n[2], z = u.x * n[1] - u.y * n[0];
  return static_cast<double>(std::atan2(length({x, y, z}), u.x * n[0] + u.y * n[1] + u.z * n[2]));
}

/// Returns the t in [0, 1] at which |n(t)| is smallest. The search narrows an interval of t down to a length of about
/// 2^-40.
[[nodiscard]] inline double hardest_time(const ControlNormals& c) {
  const auto size = [&c](double t) { return length(normal_in_long_double(c, t)); };
  double best = 0;
  for (int i = 1; i <= 64; ++i) {
    if (size(i / 64.0) < size(best)) best = i / 64.0;
  }
  double low = std::max(0.0, best - 1 / 64.0), high = std::min(1.0, best + 1 / 64.0);
  for (int i = 0; i < 60; ++i) {
    const double third = (high - low) / 3;
    if (size(low + third) < size(high - third)) {
      high -= third;
    } else {
      low += third;
    }
  }
  return size(low) < size(best) ? low : best;
}

/// Returns times at which large errors are likely: the ends and times near them, simple fractions, the time at which
/// |n(t)| is smallest and times near it, and random times.
[[nodiscard]] inline std::vector<double> hard_times(const ControlNormals& c, fixtures::Random& random) {
  std::vector<double> times{0,   1,       1e-3,    1e-6, 0x1p-40, 1 - 1e-3, 1 - 1e-6,
                            0.5, 1.0 / 3, 2.0 / 3, 0.25, 0.75,    0x1p-150, 1 - 0x1p-53};
  const double hardest = hardest_time(c);
  for (const double step : {0.0, 1e-1, 1e-2, 1e-3, 1e-5}) {
    times.push_back(std::max(0.0, hardest - step));
    times.push_back(std::min(1.0, hardest + step));
  }
  for (int i = 0; i < 4; ++i) times.push_back(random.uniform(0, 1));
  times.push_back(std::ldexp(random.uniform(0.5, 1), -static_cast<int>(random.below(40))));
  return times;
}

[[nodiscard]] inline Vec3d random_vector(fixtures::Random& random) {
  const double x = random.uniform(-1, 1), y = random.uniform(-1, 1);
  return {x, y, random.uniform(-1, 1)};
}

/// Returns 2^-k for a random integer k in [0, most].
[[nodiscard]] inline double random_power(fixtures::Random& random, std::size_t most) {
  return std::ldexp(1, -static_cast<int>(random.below(most + 1)));
}

[[nodiscard]] inline ControlNormals scaled_by(double s, const ControlNormals& c) {
  return {s * c.n0, s * c.m, s * c.n1};
}

/// Returns three control normals whose directions are close to n. Each of the three vectors is the sum of n and `turn`
/// times a random vector, multiplied by a number from factor().
template <class Factor>
[[nodiscard]] ControlNormals three_near(fixtures::Random& random, const Vec3d& n, double turn, Factor factor) {
  std::array<Vec3d, 3> v;
  for (Vec3d& one : v) {
    const double s = factor();
    one = s * (n + turn * random_vector(random));
  }
  return {v[0], v[1], v[2]};
}

struct HardFamily {
  const char* name;
  ControlNormals (*make)(fixtures::Random&);
};

/// Returns the families of control normals that are hard to store. Each family has a name, and a function that makes
/// the control normals of one element at random.
[[nodiscard]] inline const std::vector<HardFamily>& hard_families() {
  using fixtures::Random;
  static const std::vector<HardFamily> families{
      {"any directions",
       [](Random& r) {
         return ControlNormals{random_vector(r), random_vector(r), random_vector(r)};
       }},
      {"one direction, turned a little",
       [](Random& r) {
         const Vec3d n = random_vector(r);
         return three_near(r, n, 0.3, [&r] { return r.uniform(0.5, 1.5); });
       }},
      {"lengths in any ratio up to 2^60",
       [](Random& r) {
         const Vec3d n = random_vector(r);
         return three_near(r, n, r.uniform(0, 1), [&r] { return random_power(r, 60); });
       }},
      {"nearly antipodal ends",
       [](Random& r) {
         const Vec3d n = random_vector(r);
         const double gap = random_power(r, 24), back = r.uniform(0.5, 2);
         return ControlNormals{n, gap * random_vector(r), gap * random_vector(r) - back * n};
       }},
      {"collapse at an end",
       [](Random& r) {
         const double s = random_power(r, 40);
         const bool at_start = r.below(2) == 0, wholly = r.below(4) == 0;
         const Vec3d n = random_vector(r);
         const ControlNormals c{n, s * (n + random_vector(r)), wholly ? Vec3d{} : s * s * random_vector(r)};
         return at_start ? ControlNormals{c.n1, c.m, c.n0} : c;
       }},
      {"collapse inside, or nearly",  // (t - z)^2 n, plus random vectors of length 1 to 2^-30
       [](Random& r) {
         const Vec3d n = random_vector(r);
         const double z = r.uniform(0.02, 0.98), gap = random_power(r, 30);
         return ControlNormals{z * z * n + gap * random_vector(r), -(z * (1 - z)) * n + gap * random_vector(r),
                               (1 - z) * (1 - z) * n + gap * random_vector(r)};
       }},
      {"slivers that grow",
       [](Random& r) {
         const Vec3d n = random_vector(r);
         const double s = random_power(r, 30);
         const ControlNormals c = three_near(r, n, 0.2, [] { return 1.0; });
         return r.below(2) == 0 ? ControlNormals{s * s * c.n0, s * c.m, c.n1}
                                : ControlNormals{c.n0, s * c.m, s * s * c.n1};
       }},
      {"degrees 0 and 1, or barely more",
       [](Random& r) {
         const Vec3d n0 = random_vector(r), n1 = r.below(3) == 0 ? n0 : random_vector(r);
         const double bend = r.below(2) == 0 ? 0 : std::ldexp(1, -static_cast<int>(24 + r.below(8)));
         return ControlNormals{n0, 0.5 * (n0 + n1) + bend * random_vector(r), n1};
       }},
      {"around a wide cone",  // at t = 1/2, the three vectors cancel except along the axis
       [](Random& r) {
         const double height = r.uniform(0.3, 0.6) * random_power(r, 8);
         const auto turned = [axis = r.below(3)](const Vec3d& v) {
           return axis == 0 ? v : axis == 1 ? Vec3d{v.y, v.z, -v.x} : Vec3d{-v.z, v.x, v.y};
         };
         const ControlNormals c{turned({1, 0, height}), turned({-0.5, 0.875, height}), turned({-0.5, -0.875, height})};
         const auto near = [&r, height](const Vec3d& v) { return v + 0.1 * height * random_vector(r); };
         return ControlNormals{near(c.n0), 0.5 * near(c.m), near(c.n1)};
       }},
      // Control normals that are stored as integers are rounded to multiples of M / 1023 or M / 32767, where M is the
      // largest component. The components here are hard to round: M, -M, a value halfway between two such multiples, or
      // a value close to one of these.
      {"where integers round",
       [](Random& r) {
         const double largest = r.below(3) == 0 ? r.uniform(0.5, 1) : 1;
         const auto component = [&] {
           const double sign = r.below(2) == 0 ? 1 : -1, steps = r.below(2) == 0 ? 1023 : 32767;
           const auto near = [&r](double v) {
             const std::array<double, 5> by{0, 0x1p-24, -0x1p-24, 0x1p-50, -0x1p-50};
             return v + by[r.below(by.size())] * v;
           };
           const std::array<double, 8> inside{1, 511.5 / 512, 495.5 / 511.5, 496 / 511.5, 512 / 1023.0, 0.5, 0, -1};
           switch (r.below(3)) {
             case 0:
               return sign * largest * std::min(1.0, near(inside[r.below(inside.size())]));
             case 1:
               return sign * largest * std::min(1.0, near((std::floor(r.uniform(0, steps)) + 0.5) / steps));
             default:
               return sign * largest;
           }
         };
         const auto vector = [&] {
           const double x = component(), y = component();
           return Vec3d{x, y, component()};
         };
         ControlNormals c{vector(), vector(), vector()};
         // Makes every z positive or 0, so that the three vectors do not cancel. Most normals n(t) are then long enough
         // for the vectors to be stored as integers.
         for (Vec3d* v : {&c.n0, &c.m, &c.n1}) v->z = std::fabs(v->z);
         if (r.below(2) == 0) c.m.z = largest;
         return c;
       }},
  };
  return families;
}

/// Makes the control normals of an element of a random family. If `any_scale` is true, multiplies about a third of the
/// elements by a random power of two between 2^-1000 and 2^999.
[[nodiscard]] inline ControlNormals hard_element(fixtures::Random& random, bool any_scale) {
  const auto& families = hard_families();
  const ControlNormals c = families[random.below(families.size())].make(random);
  if (!any_scale || random.below(3) != 0) return c;
  return scaled_by(std::ldexp(1, static_cast<int>(random.below(2000)) - 1000), c);
}

}  // namespace chronormal::test

#endif  // CHRONORMAL_TESTS_SUPPORT_HARD_NORMALS_H_
