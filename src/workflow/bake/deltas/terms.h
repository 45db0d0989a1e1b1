/// The terms of the normals of one mesh, whichever the weighting, and how they become deltas of its vertices. Private
/// to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_TERMS_H_
#define CHRONORMAL_WORKFLOW_BAKE_TERMS_H_

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "normals/blend/blend_terms.h"
#include "workflow/bake/poses/pose_memory.h"
#include "workflow/shading/gltf_shading.h"
#include "workflow/truth/author_truth.h"

namespace chronormal::inline internal {

/// The truth of all elements as a quadratic form. By area it is exact. By other rules the truth is no polynomial, and
/// the form is fitted: it has the direction of the truth, and the length by area, where one target has the weight 0, 1/2
/// or 1, and where two have the weight 1.
class NormalTerms {
 public:
  /// The shading and its truth must outlive this. Fits all targets where the truth is not by area.
  NormalTerms(const GltfShading& shading, const AuthorTruth& truth);

  /// n(0) of an element.
  [[nodiscard]] Vec3d base_of(std::uint32_t element) const {
    return base_.empty() ? by_area_.base_of(element) : base_[element];
  }
  /// A_i and C_ij, without their noise.
  [[nodiscard]] BlendTerm linear(std::size_t i) const;
  [[nodiscard]] BlendTerm pair(std::size_t i, std::size_t j) const;
  /// The same, element by element.
  class Term;
  [[nodiscard]] Term linear_by_element(std::size_t i) const;
  [[nodiscard]] Term pair_by_element(std::size_t i, std::size_t j) const;
  /// All elements where a target may have terms, ascending.
  [[nodiscard]] std::vector<std::uint32_t> elements(std::size_t i) const {
    return is_fitted() ? fits_[i].elements : by_area_.elements(i);
  }
  /// All elements where their pair may have a term, ascending.
  [[nodiscard]] std::vector<std::uint32_t> elements(std::size_t i, std::size_t j) const;
  /// Whether there is something between two targets: a face that both move, or for fitted weightings an element.
  [[nodiscard]] bool overlap(std::size_t i, std::size_t j) const;
  /// The right normals at some weights from the blended positions, with the length by area; and those by area whatever
  /// the weighting.
  [[nodiscard]] std::vector<Vec3d> exact_at(std::span<const double> weights) const;
  [[nodiscard]] std::vector<Vec3d> at(std::span<const double> weights) const { return exact_at(weights); }
  [[nodiscard]] std::vector<Vec3d> by_area_at(std::span<const double> weights) const {
    return normals_from_positions(shading_, weights);
  }
  /// The normals of some elements at some weights by a weighting that is fitted, with the length by area.
  [[nodiscard]] std::vector<Vec3d> weighted_at(std::span<const double> weights,
                                               std::span<const std::uint32_t> elements) const;
  [[nodiscard]] bool is_fitted() const noexcept { return !truth_.is_plain(); }
  /// Whether the file has the author's normals of its targets, which the truth goes through.
  [[nodiscard]] bool follow_keys() const { return truth_.follows_keys(); }
  /// How far the fit of a target alone is from the weighted normals that are shown, in radians, at eighths of its
  /// weight; 0 by area.
  [[nodiscard]] double fit_error(std::size_t i) const { return is_fitted() ? fits_[i].error : 0; }

 private:
  // Of one target: its terms where it moves a face of an element.
  struct Fit {
    std::vector<std::uint32_t> elements;
    std::vector<Vec3d> linear, square;
    double error = 0;
  };
  static constexpr std::size_t kMostSampledBytes = std::size_t{256} << 20;

  void fit_targets();
  // The truth of all elements at some weights, with the length by area, which it keeps where there is room.
  [[nodiscard]] std::vector<Vec3d> sample_all(std::span<const double> weights, std::span<const double> positions) const;

  const GltfShading& shading_;
  const AuthorTruth& truth_;
  BlendTerms by_area_;
  std::vector<Vec3d> base_;  // where it is fitted, or takes little memory
  std::vector<Fit> fits_;
  mutable PoseMemory sampled_{kMostSampledBytes};  // all elements
};

/// A term whose values are computed or found where they are asked for. Threads: const functions may run at once.
class NormalTerms::Term {
 public:
  /// Whether an element has the term; then its value.
  [[nodiscard]] bool find(std::uint32_t element, Vec3d& value) const;

 private:
  friend class NormalTerms;
  explicit Term(BlendTerms::Term by_area) : by_area_(std::move(by_area)) {}
  explicit Term(BlendTerm fitted) : fitted_(std::move(fitted)) {}

  std::optional<BlendTerms::Term> by_area_;
  BlendTerm fitted_;
};

/// The control normals of a target alone, from weight 0 to 1.
[[nodiscard]] ControlNormals of_powers(const Vec3d& base, const Vec3d& linear, const Vec3d& square) noexcept;

/// Those from one weight to another, where these from 0 to 1 are given.
[[nodiscard]] ControlNormals normals_between(const ControlNormals& normals, double from, double to) noexcept;

/// What turns and scales the terms of an element into those of a vertex that shows it: divided by |n(0)|, times the
/// length of the stored normal N, by the smallest rotation from n(0) to N. Where n(0) is zero or next to it, the terms
/// cannot be divided by it: they are made so long that N does not count beside them.
class VertexTerms {
 public:
  /// base and largest are of the element: n(0), and the length of its largest term.
  VertexTerms(const Vec3d& base, double largest, const Vec3d& stored) noexcept;

  [[nodiscard]] static bool has_base(const Vec3d& base, double largest) noexcept {
    return has_base(length(base), largest);
  }
  [[nodiscard]] static bool has_base(double length_of_base, double largest) noexcept {
    return largest <= kLongest * length_of_base;
  }

  /// Of a term of n(w).
  [[nodiscard]] Vec3d operator()(const Vec3d& term) const noexcept { return scale_ * turn(term); }
  /// Of the best single delta, for which |n(0)| is 1.
  [[nodiscard]] Vec3d end_delta(const Vec3d& delta, const ControlNormals& normals) const noexcept;
  /// Of a fitted one (fitted_lines.h), likewise.
  [[nodiscard]] Vec3d fitted_delta(const Vec3d& delta) const noexcept;

 private:
  static constexpr double kLongest = 1e6;

  [[nodiscard]] Vec3d turn(const Vec3d& v) const noexcept;

  Vec3d base_, stored_;  // unit vectors, or zero
  double length_ = 1, scale_ = 0, side_ = 1;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_TERMS_H_
