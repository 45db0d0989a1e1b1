// Spherical de Casteljau over K exact unit normals at equidistant t: slerp in place of every linear interpolation
// (section 2.4 of the paper). Meets the first and the last normal only. K (K - 1) / 2 slerps an evaluation.

#include <array>

#include "chronormal/core/trigonometry.h"
#include "schemes/curve_scheme.h"
#include "schemes/makers.h"

namespace chronormal {
namespace {

// Slerp of vectors that are only known at run time. Antipodal ones turn about a fixed perpendicular.
template <class S>
Vec3<S> slerp_at(const Vec3<S>& a, const Vec3<S>& b, const S& t) {
  using std::sqrt;
  const Vec3<S> normal = cross(a, b);
  const S sine = sqrt(dot(normal, normal)), cosine = dot(a, b);
  // Below 1e-4 rad, the chord and the arc differ by less than rounding.
  if (sine < S(1e-4f) && cosine > S(0)) return lerp(a, b, t);
  if (sine < S(1e-6f)) {
    const bool along_x = a.x * a.x > S(0.5f);
    const Vec3<S> other = along_x ? cross(a, Vec3<S>{S(0), S(1), S(0)}) : cross(a, Vec3<S>{S(1), S(0), S(0)});
    const auto [turn_sine, turn_cosine] = sin_cos(t * S(3.14159265f));
    return turn_cosine * a + turn_sine * normalized_or(other, a);
  }
  const auto [turn_sine, turn_cosine] = sin_cos(t * upper_angle(sine, cosine));
  const S b_weight = turn_sine / sine;
  return (turn_cosine - b_weight * cosine) * a + b_weight * b;
}

class DeCasteljau {
 public:
  explicit DeCasteljau(std::size_t normal_count) : count_(normal_count) {}

  [[nodiscard]] std::size_t plane_count() const { return 3 * count_; }

  void fit(ElementMotion& element, double* c) const {
    put_vector(c, 0, element.start().vector);
    for (std::size_t k = 1; k + 1 < count_; ++k)
      put_vector(c, k, element.node(static_cast<double>(k) / static_cast<double>(count_ - 1)));
    put_vector(c, count_ - 1, element.end().vector);
  }

  template <class S>
  [[nodiscard]] S at(double t) const {
    return S(static_cast<float>(t));
  }

  template <class S>
  [[nodiscard]] Vec3<S> evaluate(Coefficients<S> c, const S& t) const {
    std::array<Vec3<S>, kMaxDeCasteljauNormals> row;
    for (std::size_t k = 0; k < count_; ++k) row[k] = c.vector(k);
    for (std::size_t left = count_ - 1; left > 0; --left) {
      for (std::size_t k = 0; k < left; ++k) row[k] = slerp_at(row[k], row[k + 1], t);
    }
    return normalized_or(row[0], c.vector(0));
  }

 private:
  std::size_t count_;
};

}  // namespace

std::unique_ptr<Scheme> make_de_casteljau(std::size_t normal_count) {
  return std::make_unique<CurveScheme<DeCasteljau>>(DeCasteljau(normal_count));
}

}  // namespace chronormal
