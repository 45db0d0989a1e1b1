// The t-variant cross product, eq. 5: exact. Thin: the work is NormalCurves (normals/evaluate.h).

#include "chronormal/normals/evaluate.h"
#include "normals/curve_elements.h"
#include "schemes/counting.h"
#include "schemes/makers.h"

namespace chronormal {
namespace {

class Polynomial final : public Scheme {
 public:
  void prepare(const ElementBlock& block) override { curves_ = NormalCurves(block.normals); }

  std::size_t evaluate(double t, VectorView<float> result) const noexcept override {
    return curves_.unit_normals(t, result);
  }

  [[nodiscard]] std::size_t fallback_count() const noexcept override { return 0; }
  [[nodiscard]] std::size_t flagged_count() const noexcept override { return curves_.flagged_count(); }
  [[nodiscard]] std::size_t bytes() const noexcept override { return curves_.bytes(); }

  // Of an element of degree 2, evaluated in float32.
  [[nodiscard]] OperationCounts operations() const override {
    using C = Counting;
    const Vec3<C> n0{C(1), C(0), C(0)}, m{C(0.7f), C(0.6f), C(0.2f)}, n1{C(0), C(1), C(0)};
    const auto weights = QuadraticWeights<C>::at(0.375);
    C::reset();
    (void)normalized(quadratic_normal(n0, m, n1, weights));
    return C::counts();
  }

 private:
  NormalCurves curves_;
};

}  // namespace

std::unique_ptr<Scheme> make_polynomial() { return std::make_unique<Polynomial>(); }

}  // namespace chronormal
