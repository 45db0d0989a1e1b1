/// The class that most schemes share. Coefficients are fitted per element in double, kept as float32 in blocks, and
/// evaluated by one of the formulas of kernels/formulas-inl.h.
///
/// A scheme of this kind is a *policy*: a small class that has only its own parts,
///
///     std::size_t plane_count() const                    how many floats an element keeps
///     Formula formula() const                            what is evaluated
///     void fit(ElementMotion& element, double* c) const  fills c; calls element.use_fallback() where undefined
///
/// and if the formula is a sum, or takes anything but its shared_values(),
///
///     void shared(double t, float* values) const         what all elements have in common at t, as the formula asks
///
/// and if certify() is to bound the errors of a sum, and the weights that shared() rounds to float32 are polynomials,
///
///     WeightBasis basis() const                          these polynomials; may be std::optional
///
/// (for a sum without basis(), or another formula with its own shared(), no bound below half a turn is certified), and
/// if the scheme reads the vertices of the face,
///
///     bool needs_faces = true
///
/// and if elements can be fitted faster together,
///
///     void begin(const ElementBlock& block)              reads all elements before they are fitted
///
/// and, if the scheme can be played step by step,
///
///     std::size_t state_planes() const                   how many floats the state of an element has; 0: not played
///     void anchor(ElementCoefficients c, double t, double step, double* state)  makes the state at t
///
/// An element that has no direction at any time is not fitted. Its coefficients are zero, and its normals are (0, 0,
/// 0).
#ifndef CHRONORMAL_SCHEMES_CURVE_SCHEME_H_
#define CHRONORMAL_SCHEMES_CURVE_SCHEME_H_

#include <algorithm>
#include <cassert>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "chronormal/schemes/scheme.h"
#include "core/memory.h"
#include "schemes/fitted_curves.h"

namespace chronormal::inline internal {

/// One element of a block while a scheme is fitted to it.
class ElementMotion {
 public:
  /// Prepares to fit a scheme to the i-th element of a block.
  ElementMotion(const ElementBlock& block, std::size_t i)
      : segment_(*block.segment),
        element_(block.elements.first + i),
        is_face_(block.are_faces),
        normals_(block.normals[i]),
        block_(block),
        index_(i),
        start_(unit_normal_at(normals_, 0)),
        end_(unit_normal_at(normals_, 1)) {}

  [[nodiscard]] const Segment& segment() const { return segment_; }
  [[nodiscard]] std::size_t element() const { return element_; }
  [[nodiscard]] bool is_face() const { return is_face_; }
  [[nodiscard]] const ControlNormals& control_normals() const { return normals_; }
  /// Return the exact unit normals at t = 0 and t = 1, which are u0 and u1 in docs/theory.md.
  [[nodiscard]] const UnitNormal& start() const { return start_; }
  [[nodiscard]] const UnitNormal& end() const { return end_; }

  /// Returns the exact unit normal at a t inside the segment. If the element collapses exactly there, the result is the
  /// limit from earlier times, and counts as a fallback.
  [[nodiscard]] Vec3d node(double t) {
    const Vec3d exact = block_.exact ? unit(block_.exact(index_, t)) : Vec3d{};
    if (exact != Vec3d{}) return exact;
    const UnitNormal u = unit_normal_at(normals_, t);
    if (u.direction == Direction::kDiscontinuous) use_fallback();
    return u.vector;
  }

  /// Records that a documented fallback was used for this element.
  void use_fallback() { used_fallback_ = true; }
  [[nodiscard]] bool used_fallback() const { return used_fallback_; }

 private:
  const Segment& segment_;
  std::size_t element_;
  bool is_face_;
  const ControlNormals& normals_;
  const ElementBlock& block_;
  std::size_t index_;
  UnitNormal start_, end_;
  bool used_fallback_ = false;
};

/// Writes vector k of an element that is being fitted, which has the planes 3k, 3k + 1 and 3k + 2.
inline void put_vector(double* c, std::size_t k, const Vec3d& v) {
  c[3 * k] = v.x;
  c[3 * k + 1] = v.y;
  c[3 * k + 2] = v.z;
}

/// A store for float32 values of elements in the layout of blocks (kernels/curve_kernels.h), which schemes fill when
/// they are fitted or played.
class BlockedValues {
 public:
  BlockedValues() = default;

  /// Sets the numbers of planes and elements, and sets all values to zero. Reuses the memory if it is large enough.
  void assign(std::size_t plane_count, std::size_t element_count) {
    plane_count_ = plane_count;
    element_count_ = element_count;
    if (size() > values_.size()) values_ = AlignedArray<float>(size());
    std::fill_n(values_.data(), size(), 0.0f);
  }

  /// Stores the values of element i, one for each plane.
  void put(std::size_t i, std::span<const double> values) noexcept {
    assert(values.size() == plane_count_);
    float* to = values_.data() + offset(i);
    for (std::size_t k = 0; k < values.size(); ++k) to[k * kBlock] = static_cast<float>(values[k]);
  }

  [[nodiscard]] ElementCoefficients of(std::size_t i) const noexcept { return coefficients_of(view(), i); }

  [[nodiscard]] CoefficientBlocks view() const noexcept { return {values_.data(), plane_count_, element_count_}; }
  [[nodiscard]] float* data() noexcept { return values_.data(); }
  /// Returns the number of bytes of the values, without those that fill up the last block.
  [[nodiscard]] std::size_t bytes() const noexcept { return element_count_ * plane_count_ * sizeof(float); }

 private:
  [[nodiscard]] std::size_t offset(std::size_t i) const noexcept {
    return i / kBlock * kBlock * plane_count_ + i % kBlock;
  }
  [[nodiscard]] std::size_t size() const noexcept {
    return (element_count_ + kBlock - 1) / kBlock * kBlock * plane_count_;
  }

  std::size_t plane_count_ = 0, element_count_ = 0;
  AlignedArray<float> values_;
};

/// A policy with a member shared(), which computes the values that all elements have in common at t.
template <class Policy>
concept SharesValues = requires(const Policy& policy, float* values) {
  policy.shared(0.0, values);
};

/// A policy whose scheme can be played step by step.
template <class Policy>
concept Playable = requires(const Policy& policy) {
  policy.state_planes();
};

/// The playback of the coefficients of a CurveScheme, step by step.
template <Playable Policy>
class CurvePlayback final : public SchemePlayback {
 public:
  CurvePlayback(const Policy& policy, const BlockedValues& values, std::size_t count, std::size_t without_direction,
                double start, double step, std::size_t anchor_interval)
      : policy_(policy),
        values_(values),
        count_(count),
        without_direction_(without_direction),
        start_(start),
        step_(step),
        anchor_interval_(anchor_interval),
        exact_state_(policy.state_planes()) {
    state_.assign(policy.state_planes(), count);
  }

  std::size_t next(VectorView<float> result) noexcept override {
    if (index_ == 0 || (anchor_interval_ != 0 && index_ % anchor_interval_ == 0))
      anchor(start_ + static_cast<double>(index_) * step_);
    ++index_;
    advance_curves(policy_.formula(), values_.view(), state_.data(), result);
    return without_direction_;
  }

 private:
  void anchor(double t) noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      policy_.anchor(values_.of(i), t, step_, exact_state_.data());
      state_.put(i, exact_state_);
    }
  }

  const Policy& policy_;
  const BlockedValues& values_;
  std::size_t count_, without_direction_;
  double start_, step_;
  std::size_t anchor_interval_;
  std::size_t index_ = 0;
  BlockedValues state_;
  std::vector<double> exact_state_;  // the state of one element in double
};

template <class Policy>
class CurveScheme final : public Scheme {
 public:
  explicit CurveScheme(Policy policy) : policy_(std::move(policy)) {}

  void prepare(const ElementBlock& block) override {
    assert(block.normals.size() == block.elements.count);
    count_ = block.elements.count;
    fallbacks_ = 0;
    without_direction_ = 0;
    values_.assign(policy_.plane_count(), count_);

    if constexpr (requires { policy_.begin(block); }) policy_.begin(block);
    std::vector<double> c(policy_.plane_count());
    for (std::size_t i = 0; i < count_; ++i) {
      ElementMotion element(block, i);
      if (element.start().direction == Direction::kNone) {
        ++without_direction_;
        continue;
      }
      policy_.fit(element, c.data());
      if (element.used_fallback()) ++fallbacks_;
      values_.put(i, c);
    }
  }

  [[nodiscard]] std::shared_ptr<const FittedCurves> fitted_curves() const override {
    FittedCurves fitted{policy_.formula(), values_.view(), std::nullopt};
    if constexpr (requires { policy_.basis(); }) fitted.basis = policy_.basis();
    const bool is_known = is_sum(fitted.formula) ? fitted.basis.has_value() : !SharesValues<Policy>;
    return is_known ? std::make_shared<const FittedCurves>(std::move(fitted)) : nullptr;
  }

  std::size_t evaluate(double t, VectorView<float> result) const noexcept override {
    evaluate_curves(policy_.formula(), values_.view(), shared(t), result);
    return without_direction_;
  }

  [[nodiscard]] bool needs_faces() const noexcept override {
    if constexpr (requires { policy_.needs_faces; })
      return policy_.needs_faces;
    else
      return false;
  }
  [[nodiscard]] std::size_t fallback_count() const noexcept override { return fallbacks_; }
  [[nodiscard]] std::size_t bytes() const noexcept override { return values_.bytes(); }

  [[nodiscard]] std::unique_ptr<SchemePlayback> play(double start, double step,
                                                     std::size_t anchor_interval) const override {
    if constexpr (Playable<Policy>) {
      if (policy_.state_planes() > 0) {
        return std::make_unique<CurvePlayback<Policy>>(policy_, values_, count_, without_direction_, start, step,
                                                       anchor_interval);
      }
    }
    return Scheme::play(start, step, anchor_interval);
  }

  [[nodiscard]] OperationCounts operations() const override {
    return count_evaluation(policy_.formula(), example_coefficients(), shared(kExampleTime));
  }

  [[nodiscard]] std::optional<OperationCounts> sequential_operations() const override {
    if constexpr (Playable<Policy>) {
      if (policy_.state_planes() > 0) {
        const std::vector<float> values = example_coefficients();
        BlockedValues example;
        example.assign(values.size(), 1);
        example.put(0, std::vector<double>(values.begin(), values.end()));
        std::vector<double> state(policy_.state_planes());
        policy_.anchor(example.of(0), kExampleTime, 0.125, state.data());
        return count_advance(policy_.formula(), values, std::vector<float>(state.begin(), state.end()));
      }
    }
    return std::nullopt;
  }

 private:
  static constexpr double kExampleTime = 0.375;

  [[nodiscard]] SharedValues shared(double t) const noexcept {
    if constexpr (SharesValues<Policy>) {
      SharedValues values{};
      policy_.shared(t, values.data());
      return values;
    } else {
      return shared_values(policy_.formula(), t);
    }
  }

  // Returns the coefficients of an example element for counting operations. The example is a face whose normal turns
  // from +x to +y, so that no formula takes a shortcut.
  [[nodiscard]] std::vector<float> example_coefficients() const {
    const ControlNormals turning{{1, 0, 0}, {0.7, 0.6, 0.2}, {0, 1, 0}};
    const Segment segment = example_segment();
    const ElementBlock block{&segment, {0, 1}, {&turning, 1}};
    ElementMotion element(block, 0);
    std::vector<double> c(policy_.plane_count());
    policy_.fit(element, c.data());
    return {c.begin(), c.end()};
  }

  // Returns the segment of the example. Its triangle has edges that are not zero, for schemes that read the vertices of
  // faces.
  [[nodiscard]] static Segment example_segment() {
    static const Topology topology = Topology::triangles(3, {0, 1, 2}).value();
    static const float from[] = {0, 0, 0, 0, 1, 0, 0, 0, 1};
    static const float to[] = {0, 0, 0, 0, 0, 1, 1, 0, 0};
    return {&topology, VectorView<const float>::packed(from, 3), VectorView<const float>::packed(to, 3), 0, 1, 0};
  }

  Policy policy_;
  std::size_t count_ = 0;
  std::size_t fallbacks_ = 0;
  std::size_t without_direction_ = 0;
  BlockedValues values_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_CURVE_SCHEME_H_
