// The t-variant cross product, eq. 5: exact. Thin: the work is NormalCurves (normals/normal_curves.h) and
// NormalPlayback (normals/playback.h).

#include "chronormal/normals/normal_curves.h"
#include "normals/curves/curve_elements.h"
#include "schemes/counting.h"
#include "schemes/makers.h"

namespace chronormal::inline internal {
namespace {

class PolynomialPlayback final : public SchemePlayback {
 public:
  PolynomialPlayback(const NormalCurves& curves, double start, double step, std::size_t anchor_interval)
      : playback_(curves, start, step, anchor_interval) {}

  std::size_t next(VectorView<float> result) noexcept override { return playback_.next(result); }

 private:
  NormalPlayback playback_;
};

class Polynomial final : public Scheme {
 public:
  void prepare(const ElementBlock& block) override { curves_ = NormalCurves(block.normals); }

  std::size_t evaluate(double t, VectorView<float> result) const noexcept override {
    return curves_.unit_normals(t, result);
  }

  [[nodiscard]] bool is_exact() const noexcept override { return true; }
  [[nodiscard]] std::size_t fallback_count() const noexcept override { return 0; }
  [[nodiscard]] std::size_t flagged_count() const noexcept override { return curves_.flagged_count(); }
  [[nodiscard]] std::size_t bytes() const noexcept override { return curves_.bytes(); }

  [[nodiscard]] std::unique_ptr<SchemePlayback> play(double start, double step,
                                                     std::size_t anchor_interval) const override {
    return std::make_unique<PolynomialPlayback>(curves_, start, step, anchor_interval);
  }

  // Of an element of degree 2, evaluated in float32.
  [[nodiscard]] OperationCounts operations() const override {
    using C = Counting;
    const Vec3<C> n0{C(1), C(0), C(0)}, m{C(0.7f), C(0.6f), C(0.2f)}, n1{C(0), C(1), C(0)};
    const auto weights = QuadraticWeights<C>::at(0.375);
    C::reset();
    (void)normalized(quadratic_normal(n0, m, n1, weights));
    return C::counts();
  }

  [[nodiscard]] std::optional<OperationCounts> sequential_operations() const override {
    using C = Counting;
    const QuadraticState<C> state{{C(1), C(0), C(0)}, {C(0.1f), C(0.1f), C(0)}, {C(0.1f), C(0), C(0.1f)}};
    C::reset();
    const QuadraticState<C> next = state.next();
    (void)normalized(next.n);
    return C::counts();
  }

 private:
  NormalCurves curves_;
};

}  // namespace

std::unique_ptr<Scheme> make_polynomial() { return std::make_unique<Polynomial>(); }

}  // namespace chronormal::inline internal
