/// A number type that counts the operations on its values. Schemes run their own evaluation with this type, so the
/// counts that they report cannot differ from the code.
#ifndef CHRONORMAL_SCHEMES_COUNTING_H_
#define CHRONORMAL_SCHEMES_COUNTING_H_

#include <cmath>

#include "chronormal/schemes/scheme.h"
#include "simd/trigonometry.h"

namespace chronormal::inline internal {

/// A float whose additions, multiplications and so on are counted. Comparisons and changes of sign are not counted.
/// Branches depend on the values, as with float.
class Counting {
 public:
  Counting() = default;
  explicit Counting(float value) : value_(value) {}
  explicit Counting(int value) : value_(static_cast<float>(value)) {}

  /// Returns the counts of this thread since the last call of reset().
  static OperationCounts& counts() {
    thread_local OperationCounts counts;
    return counts;
  }
  static void reset() { counts() = {}; }

  friend Counting operator+(Counting a, Counting b) { return counted(counts().add, a.value_ + b.value_); }
  friend Counting operator-(Counting a, Counting b) { return counted(counts().add, a.value_ - b.value_); }
  friend Counting operator*(Counting a, Counting b) { return counted(counts().multiply, a.value_ * b.value_); }
  friend Counting operator/(Counting a, Counting b) { return counted(counts().divide, a.value_ / b.value_); }
  friend Counting operator-(Counting a) { return Counting(-a.value_); }
  friend bool operator<(Counting a, Counting b) { return a.value_ < b.value_; }
  friend bool operator>(Counting a, Counting b) { return a.value_ > b.value_; }
  friend bool operator==(Counting a, Counting b) { return a.value_ == b.value_; }

  friend Counting sqrt(Counting a) { return counted(counts().sqrt, std::sqrt(a.value_)); }
  friend Counting upper_angle(Counting y, Counting x) {
    return counted(counts().trigonometric, upper_angle(y.value_, x.value_));
  }
  friend SinCos<Counting> sin_cos(Counting x) {
    ++counts().trigonometric;
    const auto [s, c] = sin_cos(x.value_);
    return {Counting(s), Counting(c)};
  }

 private:
  static Counting counted(int& count, float value) {
    ++count;
    return Counting(value);
  }

  float value_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_SCHEMES_COUNTING_H_
