// The scheme decasteljau:K. This scheme runs De Casteljau's algorithm over K exact unit normals at equidistant t, with
// slerp in place of every linear interpolation (section 2.4 of the paper). The curve passes only through the first and
// the last normal, and takes K (K - 1) / 2 slerps per evaluation.

#include "schemes/curve_scheme.h"
#include "schemes/makers.h"

namespace chronormal::inline internal {
namespace {

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

  [[nodiscard]] Formula formula() const { return Formula::kDeCasteljau; }

 private:
  std::size_t count_;
};

}  // namespace

std::unique_ptr<Scheme> make_de_casteljau(std::size_t normal_count) {
  return std::make_unique<CurveScheme<DeCasteljau>>(DeCasteljau(normal_count));
}

}  // namespace chronormal::inline internal
