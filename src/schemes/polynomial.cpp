// The scheme polynomial: the cross product as a quadratic in t, eq. 5, which is exact. Random access works like
// NormalCurves (normals/normal_curves.h). Sequential access works as in the paper, with two additions per component and
// step in float32, and starts again after every anchor_interval steps.

#include <algorithm>
#include <vector>

#include "chronormal/normals/normal_curves.h"
#include "normals/curves/certificate.h"
#include "normals/curves/curve_elements.h"
#include "schemes/counting.h"
#include "schemes/makers.h"

namespace chronormal::inline internal {
namespace {

// The largest factor by which a normal may shrink if its element is to be played in float32. The error of the state
// does not shrink with the normal (docs/theory.md, section 4.9).
constexpr double kMaxShrinkage = 4;
// The bounds of the size of the control normals of an element that is played. Between the bounds, squares of normals
// and of their differences are normal (not subnormal) numbers of float32.
constexpr double kSmallestPlayed = 0x1p-50, kLargestPlayed = 0x1p50;

// Returns true if the drift of an element that is played stays within the bound that chronormal/schemes/scheme.h states
// (kDefaultAnchorInterval).
bool can_be_played(const ControlNormals& c) {
  const double largest = largest_component(c);
  if (!(largest > kSmallestPlayed && largest < kLargestPlayed)) return false;
  const Bernstein<Vec3d, 2> n = {1 / largest * c.n0, 1 / largest * c.m, 1 / largest * c.n1};
  const double longest = std::max({length(n[0]), length(n[1]), length(n[2])});
  return stays_above(n, kMaxShrinkage, {longest, longest, longest});
}

// Returns control normals as blocks of curves store them: rounded to float32, and with m halfway between n0 and n1 if
// n(t) is linear.
ControlNormals rounded(const ControlNormals& c) {
  const Vec3d n0 = to_double(to_float(c.n0)), n1 = to_double(to_float(c.n1));
  return {n0, degree(c) == 2 ? to_double(to_float(c.m)) : 0.5 * (n0 + n1), n1};
}

class PolynomialPlayback final : public SchemePlayback {
 public:
  PolynomialPlayback(std::span<const ControlNormals> normals, double start, double step, std::size_t anchor_interval)
      : normals_(normals), start_(start), step_(step), anchor_interval_(anchor_interval), states_(normals.size()) {
    for (std::size_t i = 0; i < normals.size(); ++i) is_played_.push_back(can_be_played(normals[i]));
  }

  std::size_t next(VectorView<float> result) noexcept override {
    const double t = start_ + static_cast<double>(index_) * step_;
    if (index_ == 0 || (anchor_interval_ != 0 && index_ % anchor_interval_ == 0)) anchor(t);
    ++index_;
    std::size_t without_direction = 0;
    for (std::size_t i = 0; i < normals_.size(); ++i) {
      if (is_played_[i]) {
        result.set(i, normalized(states_[i].n));
        states_[i] = states_[i].next();
        continue;
      }
      const UnitNormal u = unit_normal_at(normals_[i], t);
      result.set(i, to_float(u.vector));
      if (u.direction == Direction::kNone) ++without_direction;
    }
    return without_direction;
  }

 private:
  void anchor(double t) noexcept {
    for (std::size_t i = 0; i < normals_.size(); ++i) {
      if (!is_played_[i]) continue;
      const ControlNormals c = rounded(normals_[i]);
      const Vec3d here = normal_at(c, t);
      states_[i] = {to_float(here), to_float(normal_at(c, t + step_) - here),
                    to_float((2 * step_ * step_) * ((c.n0 - c.m) + (c.n1 - c.m)))};
    }
  }

  std::span<const ControlNormals> normals_;
  double start_, step_;
  std::size_t anchor_interval_;
  std::size_t index_ = 0;  // the number of the current step
  std::vector<QuadraticState<float>> states_;
  std::vector<bool> is_played_;
};

class Polynomial final : public Scheme {
 public:
  void prepare(const ElementBlock& block) override {
    normals_ = block.normals;
    curves_ = NormalCurves(block.normals);
  }

  std::size_t evaluate(double t, VectorView<float> result) const noexcept override {
    return curves_.unit_normals(t, result);
  }

  [[nodiscard]] bool is_exact() const noexcept override { return true; }
  [[nodiscard]] std::size_t fallback_count() const noexcept override { return 0; }
  [[nodiscard]] std::size_t flagged_count() const noexcept override { return curves_.flagged_count(); }
  [[nodiscard]] std::size_t bytes() const noexcept override { return curves_.bytes(); }

  [[nodiscard]] std::unique_ptr<SchemePlayback> play(double start, double step,
                                                     std::size_t anchor_interval) const override {
    return std::make_unique<PolynomialPlayback>(normals_, start, step, anchor_interval);
  }

  // Returns the operations for an element of degree 2 that is evaluated in float32.
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
  std::span<const ControlNormals> normals_;  // the control normals of the block
  NormalCurves curves_;
};

}  // namespace

std::unique_ptr<Scheme> make_polynomial() { return std::make_unique<Polynomial>(); }

}  // namespace chronormal::inline internal
