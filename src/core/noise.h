/// Sums of vectors that know what of them is rounding.
#ifndef CHRONORMAL_CORE_NOISE_H_
#define CHRONORMAL_CORE_NOISE_H_

#include <cmath>
#include <cstddef>
#include <limits>

#include "chronormal/core/vec3.h"

namespace chronormal {

class VectorSum {
 public:
  void add(const Vec3d& term) noexcept {
    value_ = value_ + term;
    magnitude_ = magnitude_ + Vec3d{std::fabs(term.x), std::fabs(term.y), std::fabs(term.z)};
    ++terms_;
  }

  /// The sum, with components that are nothing but rounding set to zero: below 2 eps of all terms for each term, of
  /// which half an eps is the addition and the rest the rounding of the term itself.
  [[nodiscard]] Vec3d without_noise() const noexcept {
    const double noise = 2 * std::numeric_limits<double>::epsilon() * static_cast<double>(terms_);
    const auto keep = [noise](double v, double m) { return std::fabs(v) <= noise * m ? 0.0 : v; };
    return {keep(value_.x, magnitude_.x), keep(value_.y, magnitude_.y), keep(value_.z, magnitude_.z)};
  }

 private:
  Vec3d value_, magnitude_;
  std::size_t terms_ = 0;
};

}  // namespace chronormal

#endif  // CHRONORMAL_CORE_NOISE_H_
