// Fits a single delta to each of several targets that move the same normal.
#include "workflow/bake/deltas/fitted_lines.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "analysis/fits/end_delta.h"
#include "core/blocks.h"
#include "core/cholesky.h"

namespace chronormal::inline internal {
namespace {

// The largest number of rounds of a fit. A viewer scales the sum of a normal and its deltas to length 1, so the sum may
// have any length. Each round fits the sum to the vector in the true direction that is nearest to the sum of the round
// before.
constexpr int kRounds = 12;
// A fit ends with the first round that leaves more than this part of the squared error of the round before.
constexpr double kStandstill = 0.99;
// If a sum of a normal and its deltas points away from the true normal, the sum is fitted to a vector in the direction
// of the true normal. The length of this vector is kLeastPart times the length of the sum.
constexpr double kLeastPart = 0.1;
// The smallest length of a normal that is judged, relative to its longest term.
constexpr double kLeastLine = 1e-4;
// A fit pulls each delta towards the best delta that its target has alone. kRidge is the strength of this pull,
// relative to the mean diagonal entry of the normal equations. If the weights of two targets differ by only a
// thousandth in all poses, the poses do not tell the two deltas apart, and the pull decides. Weights below kLeastWeight
// tell nothing about a delta.
constexpr double kRidge = 1e-4, kLeastWeight = 1e-3;
// The error in radians up to which an element is not fitted. Directions are rounded to a third of this error.
constexpr double kLeastError = 1e-4;
// The largest number of targets that are fitted together. If more targets move an element, each target keeps the best
// delta that it has alone.
constexpr std::size_t kMostTargets = 64;
// kSums is the largest number of weighted deltas that a round adds up, over all elements and poses. The other constants
// limit the number of poses to which deltas are fitted.
constexpr std::size_t kSums = 50000000, kPosesPerTarget = 4, kLeastPoses = 17, kEnoughPoses = 256, kMostPoses = 2000;
// The largest number of poses in which the error after the fit is measured. If there are few elements, these poses
// include all keys.
constexpr std::size_t kMostStated = 100000;
constexpr std::size_t kLineBlock = 64;

using Matrix = std::vector<std::vector<double>>;  // a row of weights for each pose

// A direction whose components are rounded to 3e-5. (0, 0, 0) stands for a normal that is not judged.
using Rounded = std::array<std::int16_t, 3>;

Rounded rounded(const Vec3d& unit) {
  const auto part = [](double c) { return static_cast<std::int16_t>(std::lround(32767 * c)); };
  return {part(unit.x), part(unit.y), part(unit.z)};
}

Vec3d direction(const Rounded& r) {
  return unit({static_cast<double>(r[0]), static_cast<double>(r[1]), static_cast<double>(r[2])});
}

struct Element {
  std::uint32_t index = 0;
  Vec3d base;  // n(0) of the element with length 1, or zero
  std::vector<std::uint32_t> targets;
  std::vector<Vec3d> deltas;

  [[nodiscard]] Vec3d shown(const std::vector<double>& weights) const {
    Vec3d sum = base;
    for (std::size_t k = 0; k < targets.size(); ++k) sum = sum + weights[targets[k]] * deltas[k];
    return sum;
  }
};

// The errors of one element, added up over all poses: the sum of squared angles, and the largest angle in radians.
struct Misfit {
  double squares = 0, worst = 0;
};

double angle_to(const Vec3d& shown, const Vec3d& right) {
  return max_abs(shown) > 0 ? angle_between(shown, right) : std::numbers::pi;
}

class Fit {
 public:
  Fit(const Element& alone, const Matrix& poses, std::span<const Rounded> right) : alone_(alone) {
    for (std::size_t p = 0; p < poses.size(); ++p) {
      if (right[p] == Rounded{}) continue;
      Row& row = rows_.emplace_back();
      row.right = direction(right[p]);
      row.first = active_.size();
      for (std::size_t k = 0; k < alone.targets.size(); ++k) {
        const double w = poses[p][alone.targets[k]];
        if (w != 0) active_.push_back({k, w});
      }
      row.count = active_.size() - row.first;
      row.alone = row.shown = shown(row, alone_.deltas);
      row.part = max_abs(row.alone) > 0 ? 1 / dot(row.alone, row.alone) : 0;
    }
    before_ = error();
    worst_ = before_.worst;
  }

  // Searches for deltas with a smaller error than the best delta of each target alone. If some round finds deltas with
  // a smaller error, writes the deltas of the best round to `deltas` and returns true.
  bool improve(std::vector<Vec3d>& deltas) {
    if (!(before_.worst > kLeastError) || deltas.size() > kMostTargets || !take_matrix()) return false;
    Misfit best = before_, last = before_;
    for (int round = 0; round < kRounds; ++round) {
      const std::vector<Vec3d> next = solve_round();
      for (Row& row : rows_) row.shown = shown(row, next);
      const Misfit now = error();
      if (now.squares < best.squares && now.worst <= before_.worst) {
        best = now;
        worst_ = now.worst;
        deltas = next;
      }
      if (round > 0 && now.squares > kStandstill * last.squares) break;
      last = now;
    }
    return best.squares < before_.squares;
  }
  /// Returns the largest angle that the best round leaves between a rendered and a true normal, in radians.
  [[nodiscard]] double worst() const noexcept { return worst_; }

 private:
  // A target of the element that has a weight in a pose: its index in the element, and the weight.
  struct Active {
    std::size_t k;
    double w;
  };
  struct Row {
    Vec3d right, alone, shown;         // the true direction, the sum of single deltas, and the present sum
    std::size_t first = 0, count = 0;  // the range of the row in active_
    double part = 0;  // the factor of the row in the least squares; it turns a small error into an angle
  };
  [[nodiscard]] std::span<const Active> active(const Row& row) const {
    return std::span(active_).subspan(row.first, row.count);
  }

  [[nodiscard]] Vec3d shown(const Row& row, const std::vector<Vec3d>& deltas) const {
    Vec3d sum = alone_.base;
    for (const auto& [k, w] : active(row)) sum = sum + w * deltas[k];
    return sum;
  }

  [[nodiscard]] Misfit error() const {
    Misfit error;
    for (const Row& row : rows_) {
      const double angle = angle_to(row.shown, row.right);
      error.squares += angle * angle;
      error.worst = std::fmax(error.worst, angle);
    }
    return error;
  }

  bool take_matrix() {
    const std::size_t size = alone_.targets.size();
    std::vector<double> matrix(size * size);
    double trace = 0, all = 0;
    for (const Row& row : rows_) {
      for (const auto& [i, w] : active(row)) {
        for (const auto& [j, v] : active(row)) {
          if (j > i) break;  // the targets are in ascending order
          matrix[i * size + j] += row.part * w * v;
        }
        trace += row.part * w * w;
      }
      all += row.part;
    }
    const double ridge = kRidge * trace / static_cast<double>(size) + kLeastWeight * kLeastWeight * all;
    if (!(ridge > 0) || !std::isfinite(ridge)) return false;
    for (std::size_t i = 0; i < size; ++i) matrix[i * size + i] += ridge;
    matrix_ = Cholesky(std::move(matrix), size, ridge);
    return true;
  }

  [[nodiscard]] std::vector<Vec3d> solve_round() const {
    std::vector<Vec3d> values(alone_.targets.size());
    for (const Row& row : rows_) {
      const double along = std::fmax(dot(row.shown, row.right), kLeastPart * length(row.shown));
      const Vec3d missing = row.part * (along * row.right - row.alone);
      for (const auto& [k, w] : active(row)) values[k] = values[k] + w * missing;
    }
    matrix_.solve(values);
    for (std::size_t k = 0; k < values.size(); ++k) values[k] = values[k] + alone_.deltas[k];
    return values;
  }

  const Element& alone_;
  std::vector<Row> rows_;
  std::vector<Active> active_;
  Cholesky matrix_;  // the matrix of the normal equations
  Misfit before_;
  double worst_ = 0;
};

// Finds the elements that several targets move in the same pose.
class Together {
 public:
  Together(const GltfShading& shading, const NormalTerms& terms, const WeightUse& use)
      : terms_(terms), targets_of_(shading.groups.size()) {
    for (std::size_t i = 0; i < use.targets(); ++i) {
      if (shading.set.targets[i].vertices.empty() || !use.together(i, i)) continue;
      active_.push_back(i);
      for (const std::uint32_t e : terms.elements(i)) targets_of_[e].push_back(static_cast<std::uint32_t>(i));
    }
    place_.resize(use.targets());
    pairs_.resize(active_.size() * active_.size());
    for (std::size_t a = 0; a < active_.size(); ++a) {
      place_[active_[a]] = a;
      for (std::size_t b = 0; b < a; ++b) pairs_[a * active_.size() + b] = use.together(active_[a], active_[b]);
    }
  }

  // Returns the shown elements that at least two targets move at the same time in some pose. Each element has, for each
  // of its targets, the delta that is best for this target alone.
  [[nodiscard]] std::vector<Element> elements(const std::vector<bool>& is_shown) const {
    std::vector<Element> result;
    for (std::uint32_t e = 0; e < targets_of_.size(); ++e) {
      if (!is_shown[e] || !any_pair(targets_of_[e])) continue;
      Element& element = result.emplace_back();
      element.index = e;
      element.base = unit(terms_.base_of(e));
    }
    for (const std::size_t i : active_) {
      const NormalTerms::Term linear = terms_.linear_by_element(i), square = terms_.pair_by_element(i, i);
      parallel_each(result.size(), kLineBlock, [&](std::size_t n) { add(i, linear, square, result[n]); });
    }
    return result;
  }
  [[nodiscard]] std::size_t active() const noexcept { return active_.size(); }

 private:
  [[nodiscard]] bool any_pair(const std::vector<std::uint32_t>& of) const {
    for (std::size_t a = 0; a < of.size(); ++a) {
      for (std::size_t b = 0; b < a; ++b) {
        if (pairs_[place_[of[a]] * active_.size() + place_[of[b]]]) return true;
      }
    }
    return false;
  }

  void add(std::size_t target, const NormalTerms::Term& linear, const NormalTerms::Term& square,
           Element& element) const {
    Vec3d a, c;
    const bool has_linear = linear.find(element.index, a), has_square = square.find(element.index, c);
    if (!has_linear && !has_square) return;
    const ControlNormals normals = of_powers(terms_.base_of(element.index), a, c);
    element.targets.push_back(static_cast<std::uint32_t>(target));
    // An element without a normal in the base has no direction to which a delta could be added, so its delta is the
    // true normal at weight 1.
    element.deltas.push_back(max_abs(element.base) > 0 ? best_end_delta(normals).delta
                                                       : unit_normal_at(normals, 1).vector);
  }

  const NormalTerms& terms_;
  std::vector<std::size_t> active_;                     // the targets that have a weight in some pose
  std::vector<std::vector<std::uint32_t>> targets_of_;  // for each element, its active targets
  std::vector<std::size_t> place_;                      // for each target, its index in active_
  std::vector<bool> pairs_;  // (active, active), below the diagonal: true if both are active together
};

}  // namespace

FittedLines::FittedLines(const GltfShading& shading, const NormalTerms& terms, const WeightUse& use,
                         const std::vector<bool>& is_shown, const std::vector<double>& largest) {
  const Together together(shading, terms, use);
  std::vector<Element> elements = together.elements(is_shown);
  if (elements.empty()) return;
  // Calls body(n, direction), on all cores, for each element whose normal is judged in the pose. n is the index of the
  // element in the list.
  const auto judge = [&](const std::vector<double>& pose, const auto& body) {
    const std::vector<Vec3d> by_area = terms.by_area_at(pose);
    const std::vector<Vec3d> weighted = terms.is_fitted() ? terms.exact_at(pose) : std::vector<Vec3d>();
    const std::vector<Vec3d>& exact = terms.is_fitted() ? weighted : by_area;
    parallel_each(elements.size(), kLineBlock, [&](std::size_t n) {
      const std::uint32_t e = elements[n].index;
      const double least = kLeastLine * std::fmax(length(terms.base_of(e)), largest[e]);
      if (length(by_area[e]) > least && max_abs(exact[e]) > 0) body(n, unit(exact[e]));
    });
  };
  const std::size_t least = std::clamp(kPosesPerTarget * together.active(), kLeastPoses, kEnoughPoses);
  std::size_t sums = 1;
  for (const Element& element : elements) sums += element.targets.size();
  const std::size_t most = std::clamp(kSums / sums, least, kMostPoses);
  const Matrix poses = use.samples_with_keys(most);
  std::vector<Rounded> right(elements.size() * poses.size(), Rounded{});
  for (std::size_t p = 0; p < poses.size(); ++p)
    judge(poses[p], [&](std::size_t n, const Vec3d& unit) { right[n * poses.size() + p] = rounded(unit); });
  std::vector<char> is_fitted(elements.size());
  std::vector<double> errors(elements.size());
  parallel_each(elements.size(), kLineBlock, [&](std::size_t n) {
    std::vector<Vec3d> deltas = elements[n].deltas;
    Fit fit(elements[n], poses, std::span(right).subspan(n * poses.size(), poses.size()));
    is_fitted[n] = fit.improve(deltas) ? 1 : 0;
    if (fit.worst() > kLeastError) errors[n] = fit.worst();  // a smaller error is only rounding error
    elements[n].deltas = std::move(deltas);
  });
  right = std::vector<Rounded>();
  const std::size_t stated = std::clamp(4 * kSums / sums, 2 * most, kMostStated);
  for (const std::vector<double>& pose : use.sample_count() <= most ? poses : use.samples_with_keys(stated))
    judge(pose, [&](std::size_t n, const Vec3d& unit) {
      errors[n] = std::fmax(errors[n], angle_to(elements[n].shown(pose), unit));
    });
  for (const double error : errors) largest_error_ = std::fmax(largest_error_, error);
  deltas_.resize(use.targets());
  for (std::size_t n = 0; n < elements.size(); ++n) {
    if (is_fitted[n] != 0) ++elements_;
    for (std::size_t k = 0; k < elements[n].targets.size(); ++k) {
      BlendTarget& target = deltas_[elements[n].targets[k]];
      const Vec3f delta = to_float(elements[n].deltas[k]);
      target.vertices.push_back(elements[n].index);
      target.deltas.insert(target.deltas.end(), {delta.x, delta.y, delta.z});
    }
  }
}

bool FittedLines::find(std::size_t target, std::uint32_t element, Vec3d& delta) const {
  if (target >= deltas_.size()) return false;
  const BlendTarget& found = deltas_[target];
  const auto at = std::lower_bound(found.vertices.begin(), found.vertices.end(), element);
  if (at == found.vertices.end() || *at != element) return false;
  const float* const d = found.deltas.data() + 3 * (at - found.vertices.begin());
  delta = to_double(Vec3f{d[0], d[1], d[2]});
  return true;
}

}  // namespace chronormal::inline internal
