// The line u0 + w (s u1 - u0) leads from u0 to s u1. Its direction moves along the great circle from u0 to u1, and s
// only changes the speed of this direction. For each w, the angle between the line and the exact normal n(w) decreases
// with s while the line is behind n(w), seen along the circle, and increases when the line is ahead. Hence, if all
// angles are below 90 degrees, their maximum over w has a single minimum in s. At this s, the worst angle behind equals
// the worst angle ahead, so s is the root of a monotone function.
//
// The search takes the maximum over a list of sampled w. To this list, the search then adds the w at which the angle
// for the found s is largest, and searches again, until the error can hardly become smaller (an exchange as in the
// algorithm of Remez).

#include "analysis/fits/end_delta.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "core/portable_math.h"

namespace chronormal::inline internal {
namespace {

constexpr double kHalfPi = 1.57079632679489661923;
constexpr double kRange = 11.090354888959125;  // the logarithm of 2^16, which is the largest s

// Returns the angle in radians that has a given key. Angles are compared by their keys, which grow with the angle and
// need no trigonometry. A key is the square of the sine or, from 90 degrees on, 2 minus this square.
double angle_of_key(double key) noexcept {
  return key <= 1 ? portable::asin(std::sqrt(key)) : 2 * kHalfPi - portable::asin(std::sqrt(std::max(2 - key, 0.0)));
}

double key_of(double sine_square, double cosine) noexcept {
  const double square = std::min(sine_square, 1.0);
  return cosine < 0 ? 2 - square : square;
}

double key_between(const Vec3d& line, const Vec3d& u) noexcept {
  const Vec3d c = cross(line, u);
  return key_of(dot(c, c) / dot(line, line), dot(line, u));
}

// A weight w, and the exact normal at this weight.
struct Sample {
  double w = 0;
  Vec3d u;  // the exact unit normal at w
};

class Samples {
 public:
  static constexpr std::size_t kMost = 128;

  // Makes equidistant samples, and then additional samples where the normal turns fast.
  explicit Samples(const ControlNormals& normals) noexcept : normals_(normals) {
    constexpr std::size_t kIntervals = 16, kMostTurning = 80;
    constexpr int kLevels = 20;
    constexpr double kTurn = 0.2;  // the largest angle in radians between the normals of neighbouring samples
    for (std::size_t i = 0; i <= kIntervals; ++i)
      samples_[count_++] = at(static_cast<double>(i) / static_cast<double>(kIntervals));
    for (int level = 0; level < kLevels; ++level) {
      const std::size_t before = count_;
      for (std::size_t i = count_ - 1; i > 0 && count_ < kMostTurning; --i) {
        const Vec3d step = samples_[i].u - samples_[i - 1].u;
        if (dot(step, step) > kTurn * kTurn) insert(0.5 * (samples_[i - 1].w + samples_[i].w));
      }
      if (count_ == before) break;
    }
  }

  [[nodiscard]] std::size_t size() const noexcept { return count_; }
  [[nodiscard]] const Sample& operator[](std::size_t i) const noexcept { return samples_[i]; }
  [[nodiscard]] Sample at(double w) const noexcept { return {w, unit_normal_at(normals_, w).vector}; }

  // Inserts a sample at w, unless the list is full or has a sample at w already.
  void insert(double w) noexcept {
    if (count_ == kMost) return;
    const auto end = samples_.begin() + static_cast<std::ptrdiff_t>(count_);
    const auto place = std::lower_bound(samples_.begin(), end, w, [](const Sample& a, double b) { return a.w < b; });
    if (place != end && place->w == w) return;
    std::move_backward(place, end, end + 1);
    *place = at(w);
    ++count_;
  }

  // Adds samples at the weights that divide the turn of the line from `from` to `to` into roughly equal angles. The
  // line turns fast near an end if `from` or `to` is much shorter than the other vector.
  void follow(const Vec3d& from, const Vec3d& to) noexcept {
    const double ratio = length(to) / length(from);
    constexpr int kShares = 8;
    if (ratio > 0.5 && ratio < 2) return;
    for (int k = 1; k < kShares; ++k) insert(k / (k + ratio * (kShares - k)));
  }

 private:
  const ControlNormals& normals_;
  std::array<Sample, kMost> samples_;
  std::size_t count_ = 0;
};

struct Peak {
  double w = 0, key = 0;
};

// Returns the key (angle_of_key()) of the angle between the line and the normal of a sample. If the line is zero at the
// sample, the direction of the line jumps there, and both directions count.
double line_key(const Vec3d& from, const Vec3d& to, const Sample& sample) noexcept {
  const Vec3d line = (1 - sample.w) * from + sample.w * to;
  if (max_abs(line) > 1e-15 * std::max(max_abs(from), max_abs(to))) return key_between(line, sample.u);
  return std::max(key_between(from, sample.u), key_between(to, sample.u));
}

// Returns the largest key (angle_of_key()) of the angles between the line and the normals of all samples.
double largest_key(const Samples& samples, const Vec3d& from, const Vec3d& to) noexcept {
  double largest = 0;
  for (std::size_t i = 0; i < samples.size(); ++i) largest = std::max(largest, line_key(from, to, samples[i]));
  return largest;
}

// Finds the largest angle between the line and the exact normal over all w, by golden section around the highest local
// maxima of the samples.
Peak highest_peak(const Samples& samples, const Vec3d& from, const Vec3d& to) noexcept {
  constexpr double kGolden = 0.6180339887498949, kWorthwhile = 0.8;
  constexpr int kSteps = 12;
  std::array<double, Samples::kMost> keys;
  Peak best;
  const std::size_t n = samples.size();
  for (std::size_t i = 0; i < n; ++i) {
    keys[i] = line_key(from, to, samples[i]);
    if (keys[i] > best.key) best = {samples[i].w, keys[i]};
  }
  const double enough = kWorthwhile * best.key;
  for (std::size_t i = 0; i < n; ++i) {
    if (keys[i] < enough || (i > 0 && keys[i - 1] > keys[i]) || (i + 1 < n && keys[i + 1] > keys[i])) continue;
    double a = samples[i == 0 ? 0 : i - 1].w, b = samples[std::min(i + 1, n - 1)].w;
    double x1 = b - kGolden * (b - a), x2 = a + kGolden * (b - a);
    double f1 = line_key(from, to, samples.at(x1)), f2 = line_key(from, to, samples.at(x2));
    for (int step = 0; step < kSteps; ++step) {
      if (f1 >= f2) {
        b = x2;
        x2 = x1;
        f2 = f1;
        x1 = b - kGolden * (b - a);
        f1 = line_key(from, to, samples.at(x1));
      } else {
        a = x1;
        x1 = x2;
        f1 = f2;
        x2 = a + kGolden * (b - a);
        f2 = line_key(from, to, samples.at(x2));
      }
      if (f1 > best.key) best = {x1, f1};
      if (f2 > best.key) best = {x2, f2};
    }
  }
  return best;
}

// Has the angles at all samples as functions of s, the factor of u1, and searches for the s whose largest angle is
// smallest.
class ScaleSearch {
 public:
  ScaleSearch(const Vec3d& u0, const Vec3d& u1) noexcept : u0_(u0), u1_(u1), pole_(unit(cross(u0, u1))) {}

  void add(const Sample& sample) noexcept {
    const double w = sample.w, v = 1 - w;
    if (w == 0 || w == 1) return;  // the line is exact at the ends, or as exact as a limit can be
    const double height = dot(sample.u, pole_);
    terms_[count_++] = {v * dot(pole_, cross(u0_, sample.u)),
                        w * dot(pole_, cross(u1_, sample.u)),
                        v * dot(u0_, sample.u),
                        w * dot(u1_, sample.u),
                        height * height,
                        v * v,
                        2 * v * w * dot(u0_, u1_),
                        w * w};
  }
  void clear() noexcept { count_ = 0; }

  // Returns the logarithm of the best s for the samples, and writes the key (angle_of_key()) of the largest angle at
  // this s.
  [[nodiscard]] double best_log_scale(double guess, double& key) const noexcept {
    double low = -kRange, high = kRange;
    const double best = below_right_angle(low, high) ? balance(low, high, guess) : best_of_grid();
    key = largest(best);
    return best;
  }

 private:
  // The coefficients of the polynomials in s that give the angle at one w: the component of (line x u) along the pole,
  // the cosine, and the squared length of the line. `height` is the height of u above the plane of the great circle.
  struct Term {
    double ahead0, ahead1, cosine0, cosine1, height, square0, square1, square2;
  };
  struct Worst {
    double behind = 0, ahead = 0;  // keys of the largest angle by which the line is behind or ahead of the normal
  };

  [[nodiscard]] Worst worst(double log_scale) const noexcept {
    const double s = portable::exp(log_scale);
    Worst result;
    for (std::size_t i = 0; i < count_; ++i) {
      const Term& t = terms_[i];
      const double side = t.ahead0 + s * t.ahead1;
      const double square = t.square0 + s * (t.square1 + s * t.square2);
      const double key = key_of(t.height + side * side / square, t.cosine0 + s * t.cosine1);
      double& of_side = side > 0 ? result.behind : result.ahead;
      of_side = std::max(of_side, key);
    }
    return result;
  }

  [[nodiscard]] double largest(double log_scale) const noexcept {
    const Worst w = worst(log_scale);
    return std::max(w.behind, w.ahead);
  }

  // Narrows [low, high] to the values of log s for which all angles are below 90 degrees. For each w, the values that
  // keep the angle below 90 degrees are an interval. Returns false if no value remains.
  [[nodiscard]] bool below_right_angle(double& low, double& high) const noexcept {
    for (std::size_t i = 0; i < count_; ++i) {
      const Term& t = terms_[i];
      if (t.cosine0 <= 0 && t.cosine1 <= 0) return false;
      if (t.cosine0 <= 0) low = std::max(low, portable::log(-t.cosine0 / t.cosine1));
      if (t.cosine1 < 0) high = std::min(high, portable::log(-t.cosine0 / t.cosine1));
    }
    return low < high;
  }

  // Returns the log s at which the worst angles behind and ahead are equal, by false position with the Illinois rule.
  [[nodiscard]] double balance(double low, double high, double guess) const noexcept {
    constexpr int kSteps = 60;
    constexpr double kEqual = 5e-4, kNarrow = 1e-9;
    const auto difference = [](const Worst& w) { return std::sqrt(w.behind) - std::sqrt(w.ahead); };
    double f_low = difference(worst(low)), f_high = difference(worst(high));
    if (f_low <= 0) return low;
    if (f_high >= 0) return high;
    double x = std::clamp(guess, low, high);
    for (int step = 0; step < kSteps && high - low > kNarrow; ++step) {
      if (!(low < x && x < high) || step % 4 == 3) x = 0.5 * (low + high);
      const Worst w = worst(x);
      const double f = difference(w);
      if (std::fabs(f) <= kEqual * std::sqrt(std::max(w.behind, w.ahead))) break;
      if (f > 0) {
        low = x;
        f_low = f;
        f_high /= 2;
      } else {
        high = x;
        f_high = f;
        f_low /= 2;
      }
      x = low + (high - low) * (f_low / (f_low - f_high));
    }
    return x;
  }

  // Returns the best log s of a grid, refined by halving its step. The grid is used if some angle is 90 degrees or more
  // for every s, since the largest angle may then have several local minima.
  [[nodiscard]] double best_of_grid() const noexcept {
    constexpr int kGrid = 44, kHalvings = 20;
    double step = 2 * kRange / kGrid, best = 0, best_key = largest(0);
    const auto offer = [&](double x) {
      const double key = std::fabs(x) <= kRange ? largest(x) : 3;
      if (key < best_key) {
        best_key = key;
        best = x;
      }
    };
    for (int i = 0; i <= kGrid; ++i) offer(step * i - kRange);
    for (int i = 0; i < kHalvings; ++i) {
      step /= 2;
      const double centre = best;
      offer(centre - step);
      offer(centre + step);
    }
    return best;
  }

  Vec3d u0_, u1_, pole_;
  std::array<Term, Samples::kMost> terms_;
  std::size_t count_ = 0;
};

// Returns the log s for which the line has exactly the direction of n(w). There is such an s if n(w) has degree 0 or 1,
// or if n(w) is w or 1 - w times a line.
double log_of_degree_1(const ControlNormals& normals) noexcept {
  const Vec3d from = max_abs(normals.n0) == 0 ? 2 * normals.m : normals.n0;
  const Vec3d to = max_abs(normals.n1) == 0 ? 2 * normals.m : normals.n1;
  const double ratio = length(to) / length(from);
  return std::isnormal(ratio) ? std::clamp(portable::log(ratio), -kRange, kRange) : 0;
}

bool all_zero(const ControlNormals& normals) noexcept {
  return max_abs(normals.n0) == 0 && max_abs(normals.m) == 0 && max_abs(normals.n1) == 0;
}

}  // namespace

double largest_line_error(const ControlNormals& normals, const Vec3d& from, const Vec3d& to) noexcept {
  if (all_zero(normals)) return 0;
  Samples samples(normals);
  samples.follow(from, to);
  return angle_of_key(highest_peak(samples, from, to).key);
}

EndDelta best_end_delta(const ControlNormals& normals) noexcept {
  if (all_zero(normals)) return {};
  const Vec3d u0 = unit_normal_at(normals, 0).vector, u1 = unit_normal_at(normals, 1).vector;
  Samples samples(normals);
  const Samples first = samples;
  const auto plain = [&] { return EndDelta{u1 - u0, 1, angle_of_key(highest_peak(first, u0, u1).key)}; };
  // The sine of the smallest angle between two directions that do not count as equal or antipodal. Below this sine,
  // rounding would decide which direction is ahead.
  constexpr double kSmallestSine = 1e-10;
  if (length(cross(u0, u1)) < kSmallestSine) return plain();

  // Round 0 tries the s that is exact for an element of degree 1, which a search would only approximate.
  double log_scale = log_of_degree_1(normals), lowest_possible = 0;
  Peak best{0, 3};
  double best_scale = 1;
  ScaleSearch search(u0, u1);
  constexpr int kExchanges = 6;
  // The smallest ratio of two errors that counts as a gain, and the largest error that counts as exact, both as keys
  // (angle_of_key()). A key is about the square of the angle, so in angles the gain is half as much.
  constexpr double kGain = 1 + 1e-3, kExact = 1e-24;
  for (int round = 0; round <= kExchanges; ++round) {
    const double s = portable::exp(log_scale);
    samples.follow(u0, s * u1);
    const Peak peak = highest_peak(samples, u0, s * u1);
    if (peak.key < best.key) {
      best = peak;
      best_scale = s;
    }
    if (best.key < kExact || best.key <= kGain * lowest_possible) break;
    samples.insert(peak.w);
    search.clear();
    for (std::size_t i = 0; i < samples.size(); ++i) search.add(samples[i]);
    log_scale = search.best_log_scale(log_scale, lowest_possible);
  }
  if (!(best.key < largest_key(first, u0, u1)) && !(best.key < highest_peak(first, u0, u1).key)) return plain();
  return {best_scale * u1 - u0, best_scale, angle_of_key(best.key)};
}

}  // namespace chronormal::inline internal
