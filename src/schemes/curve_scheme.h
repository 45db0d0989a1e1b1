/// The frame that most schemes share: coefficients are fitted per element in double, kept as float32 planes, and
/// evaluated by one inlined formula.
///
/// A scheme of this kind is a *policy*: a small class that says only what is its own,
///
///     std::size_t plane_count() const                    how many floats an element keeps
///     void fit(ElementMotion& element, double* c) const  fills them; calls element.use_fallback() where undefined
///     auto at<S>(double t) const                         what all elements share at t
///     Vec3<S> evaluate<S>(Coefficients<S> c, shared)     the unit normal of one element
///
/// where it looks at the face itself,
///
///     bool needs_faces = true
///
/// and, where the scheme can be played step by step,
///
///     std::size_t state_planes() const                       how many floats the state of an element has
///     void anchor(Coefficients<float> c, double t, double step, double* state)  the state at t
///     Vec3<S> advance<S>(Coefficients<S> c, State<S> state)  the unit normal of the state, which moves on by a step
///
/// `evaluate` is a template on the scalar: float runs, Counting counts. An element that has no direction at all is not
/// fitted: its coefficients are zero, and `evaluate` must turn them into (0, 0, 0).
#ifndef CHRONORMAL_SCHEMES_CURVE_SCHEME_H_
#define CHRONORMAL_SCHEMES_CURVE_SCHEME_H_

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

#include "chronormal/schemes/scheme.h"
#include "normals/curve_elements.h"
#include "schemes/counting.h"

namespace chronormal {

/// One element while it is fitted.
class ElementMotion {
 public:
  ElementMotion(const Segment& segment, std::size_t element, const ControlNormals& normals)
      : segment_(segment),
        element_(element),
        normals_(normals),
        start_(unit_normal_at(normals, 0)),
        end_(unit_normal_at(normals, 1)) {}

  [[nodiscard]] const Segment& segment() const { return segment_; }
  [[nodiscard]] std::size_t element() const { return element_; }
  [[nodiscard]] const ControlNormals& control_normals() const { return normals_; }
  /// Exact unit normals at the ends: u0, u1 of docs/theory.md.
  [[nodiscard]] const UnitNormal& start() const { return start_; }
  [[nodiscard]] const UnitNormal& end() const { return end_; }

  /// The exact unit normal inside. A collapse exactly there counts as a fallback: the limit from before is taken.
  [[nodiscard]] Vec3d node(double t) {
    const UnitNormal u = unit_normal_at(normals_, t);
    if (u.direction == Direction::kDiscontinuous) use_fallback();
    return u.vector;
  }

  /// Says that this element got a stated fallback.
  void use_fallback() { used_fallback_ = true; }
  [[nodiscard]] bool used_fallback() const { return used_fallback_; }

 private:
  const Segment& segment_;
  std::size_t element_;
  const ControlNormals& normals_;
  UnitNormal start_, end_;
  bool used_fallback_ = false;
};

/// The coefficients of one element, one per plane.
template <class S>
struct Coefficients {
  const S* first;
  std::size_t stride;  // from one plane to the next

  S operator[](std::size_t plane) const { return first[plane * stride]; }
  /// The vector in the planes 3k, 3k + 1, 3k + 2.
  [[nodiscard]] Vec3<S> vector(std::size_t k) const {
    const S* p = first + 3 * k * stride;
    return {p[0], p[stride], p[2 * stride]};
  }
};

/// The state of one element that is being played, one value per plane.
template <class S>
struct State {
  S* first;
  std::size_t stride;

  S& operator[](std::size_t plane) const { return first[plane * stride]; }
  [[nodiscard]] Vec3<S> vector(std::size_t k) const { return Coefficients<S>{first, stride}.vector(k); }
  void set_vector(std::size_t k, const Vec3<S>& v) const {
    S* p = first + 3 * k * stride;
    p[0] = v.x;
    p[stride] = v.y;
    p[2 * stride] = v.z;
  }
};

/// Whether a policy can be played.
template <class Policy>
concept Playable = requires(const Policy& policy) {
  policy.state_planes();
};

/// Writes a vector into the planes 3k, 3k + 1, 3k + 2 of one element that is being fitted.
inline void put_vector(double* c, std::size_t k, const Vec3d& v) {
  c[3 * k] = v.x;
  c[3 * k + 1] = v.y;
  c[3 * k + 2] = v.z;
}

/// v scaled to length 1, or `fallback` where v is as good as zero: opposite unit vectors can cancel.
template <class S>
[[nodiscard]] Vec3<S> normalized_or(const Vec3<S>& v, const Vec3<S>& fallback) {
  using std::sqrt;
  const S square = dot(v, v);
  const bool vanished = !(square > S(1e-16f));
  const S scale = S(1) / sqrt(vanished ? S(1) : square);
  const Vec3<S> u = scale * v;
  return {vanished ? fallback.x : u.x, vanished ? fallback.y : u.y, vanished ? fallback.z : u.z};
}

/// Plays the coefficients of a CurveScheme.
template <Playable Policy>
class CurvePlayback final : public Playback {
 public:
  CurvePlayback(const Policy& policy, const std::vector<float>& planes, std::size_t count,
                std::size_t without_direction, double start, double step, std::size_t anchor_interval)
      : policy_(policy),
        planes_(planes),
        count_(count),
        without_direction_(without_direction),
        start_(start),
        step_(step),
        anchor_interval_(anchor_interval),
        state_(policy.state_planes() * count),
        exact_state_(policy.state_planes()) {}

  std::size_t next(VectorView<float> result) noexcept override {
    assert(result.count == count_);
    if (index_ == 0 || (anchor_interval_ != 0 && index_ % anchor_interval_ == 0))
      anchor(start_ + static_cast<double>(index_) * step_);
    ++index_;
    const float* planes = planes_.data();
    float* state = state_.data();
    fill(result, [this, planes, state](std::size_t i) {
      return policy_.template advance<float>(Coefficients<float>{planes + i, count_}, State<float>{state + i, count_});
    });
    return without_direction_;
  }

 private:
  void anchor(double t) noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      policy_.anchor(Coefficients<float>{planes_.data() + i, count_}, t, step_, exact_state_.data());
      for (std::size_t k = 0; k < exact_state_.size(); ++k)
        state_[k * count_ + i] = static_cast<float>(exact_state_[k]);
    }
  }

  const Policy& policy_;
  const std::vector<float>& planes_;
  std::size_t count_, without_direction_;
  double start_, step_;
  std::size_t anchor_interval_;
  std::size_t index_ = 0;
  std::vector<float> state_;
  std::vector<double> exact_state_;  // of one element
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
    planes_.assign(policy_.plane_count() * count_, 0.0f);

    std::vector<double> c(policy_.plane_count());
    for (std::size_t i = 0; i < count_; ++i) {
      ElementMotion element(*block.segment, block.elements.first + i, block.normals[i]);
      if (element.start().direction == Direction::kNone) {
        ++without_direction_;
        continue;
      }
      policy_.fit(element, c.data());
      if (element.used_fallback()) ++fallbacks_;
      for (std::size_t k = 0; k < c.size(); ++k) planes_[k * count_ + i] = static_cast<float>(c[k]);
    }
  }

  std::size_t evaluate(double t, VectorView<float> result) const noexcept override {
    assert(result.count == count_);
    const auto shared = policy_.template at<float>(t);
    const float* planes = planes_.data();
    fill(result, [this, planes, &shared](std::size_t i) {
      return policy_.template evaluate<float>(Coefficients<float>{planes + i, count_}, shared);
    });
    return without_direction_;
  }

  [[nodiscard]] bool needs_faces() const noexcept override {
    if constexpr (requires { policy_.needs_faces; })
      return policy_.needs_faces;
    else
      return false;
  }
  [[nodiscard]] std::size_t fallback_count() const noexcept override { return fallbacks_; }
  [[nodiscard]] std::size_t bytes() const noexcept override { return planes_.size() * sizeof(float); }

  [[nodiscard]] std::unique_ptr<Playback> play(double start, double step, std::size_t anchor_interval) const override {
    if constexpr (Playable<Policy>) {
      return std::make_unique<CurvePlayback<Policy>>(policy_, planes_, count_, without_direction_, start, step,
                                                     anchor_interval);
    } else {
      return Scheme::play(start, step, anchor_interval);
    }
  }

  [[nodiscard]] OperationCounts operations() const override {
    const auto coefficients = counting(example_coefficients());
    const auto shared = policy_.template at<Counting>(kExampleTime);
    Counting::reset();
    (void)policy_.template evaluate<Counting>(Coefficients<Counting>{coefficients.data(), 1}, shared);
    return Counting::counts();
  }

  [[nodiscard]] std::optional<OperationCounts> sequential_operations() const override {
    if constexpr (Playable<Policy>) {
      const std::vector<float> values = example_coefficients();
      std::vector<double> exact_state(policy_.state_planes());
      policy_.anchor(Coefficients<float>{values.data(), 1}, kExampleTime, 0.125, exact_state.data());
      const auto coefficients = counting(values);
      auto state = counting({exact_state.begin(), exact_state.end()});
      Counting::reset();
      (void)policy_.template advance<Counting>(Coefficients<Counting>{coefficients.data(), 1},
                                               State<Counting>{state.data(), 1});
      return Counting::counts();
    } else {
      return std::nullopt;
    }
  }

 private:
  static constexpr double kExampleTime = 0.375;

  [[nodiscard]] static std::vector<Counting> counting(const std::vector<float>& values) {
    std::vector<Counting> result(values.size());
    std::transform(values.begin(), values.end(), result.begin(), [](float value) { return Counting(value); });
    return result;
  }

  // Of a face that turns from +x to +y, so that no formula takes a short cut.
  [[nodiscard]] std::vector<float> example_coefficients() const {
    const ControlNormals turning{{1, 0, 0}, {0.7, 0.6, 0.2}, {0, 1, 0}};
    const Segment segment = example_segment();
    ElementMotion element(segment, 0, turning);
    std::vector<double> c(policy_.plane_count());
    policy_.fit(element, c.data());
    return {c.begin(), c.end()};
  }

  // A triangle with edges to go with those control normals, for schemes that look at the face itself.
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
  std::vector<float> planes_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_SCHEMES_CURVE_SCHEME_H_
