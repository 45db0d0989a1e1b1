// The scheme linear:scaled, which is linear interpolation with one end scaled. The direction of u0 + t (s u1 - u0) is
// exact at both ends for every s > 0. With the best s, the curve is faster where the true normal is faster
// (docs/theory.md, section 4.8). A viewer that only adds one delta can do no better. The best s of each element is
// found by a search over its logarithm.

#include "core/portable_math.h"
#include "schemes/makers.h"
#include "schemes/mean_error.h"
#include "schemes/minimize.h"

namespace chronormal::inline internal {
namespace {

class ScaledLinear {
 public:
  [[nodiscard]] std::size_t plane_count() const { return 6; }  // u0 and s u1

  void fit(ElementMotion& element, double* c) const {
    const Vec3d u0 = element.start().vector, u1 = element.end().vector;
    put_vector(c, 0, u0);
    put_vector(c, 1, best_scale(element, u0, u1) * u1);
  }

  [[nodiscard]] Formula formula() const { return Formula::kSumOf2; }
  void shared(double t, float* values) const {
    values[0] = static_cast<float>(1 - t);
    values[1] = static_cast<float>(t);
  }
  [[nodiscard]] WeightBasis basis() const { return {1, {{1, 0}, {0, 1}}}; }

 private:
  static double best_scale(const ElementMotion& element, const Vec3d& u0, const Vec3d& u1) {
    if (u0 == u1) return 1;
    // If the scale s of an end were beyond e^6, the curve would practically jump, and the shorter end would lose digits
    // in float32.
    constexpr double kRange = 6;
    constexpr std::size_t kGrid = 25;
    std::array<double, kGrid + 1> points;
    for (std::size_t i = 0; i < kGrid; ++i)
      points[i] = kRange * (2.0 * static_cast<double>(i) / (kGrid - 1) - 1);  // s = 1 is among these points
    // The ratio of the areas at both ends is the exact s for an element of degree 1, so its logarithm is one of the
    // points.
    const double areas = length(element.control_normals().n1) / length(element.control_normals().n0);
    points[kGrid] = std::isnormal(areas) ? std::clamp(portable::log(areas), -kRange, kRange) : 0;
    std::sort(points.begin(), points.end());

    const ExactSamples exact(element.control_normals());
    return portable::exp(
        minimize(points, [&](double s) { return exact.mean_error_of_line(u0, portable::exp(s) * u1); }));
  }
};

}  // namespace

std::unique_ptr<Scheme> make_scaled_linear() { return std::make_unique<CurveScheme<ScaledLinear>>(ScaledLinear{}); }

}  // namespace chronormal::inline internal
