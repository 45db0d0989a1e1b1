/// The terms of the normals of one mesh, for any weighting, and how they become deltas of its vertices. Private to
/// workflow.
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

/// The true normals of all elements as a quadratic form in the weights. With area weights the form is exact. With other
/// weightings the true normal is no polynomial, and the form is fitted. It then has the true direction, and the length
/// by area, if one target has the weight 0, 1/2 or 1, or if two have the weight 1.
class NormalTerms {
 public:
  /// Fits the terms of all targets if the true normals are not weighted by area. The shading and its truth must outlive
  /// this object.
  NormalTerms(const GltfShading& shading, const AuthorTruth& truth);

  /// Returns n(0) of an element.
  [[nodiscard]] Vec3d base_of(std::uint32_t element) const {
    return base_.empty() ? by_area_.base_of(element) : base_[element];
  }
  /// Return the linear term A_i of a target and the term C_ij of a pair (docs/theory.md), without rounding noise.
  [[nodiscard]] BlendTerm linear(std::size_t i) const;
  [[nodiscard]] BlendTerm pair(std::size_t i, std::size_t j) const;
  /// Return terms whose values are looked up element by element.
  class Term;
  [[nodiscard]] Term linear_by_element(std::size_t i) const;
  [[nodiscard]] Term pair_by_element(std::size_t i, std::size_t j) const;
  /// Returns the elements in which a target may have terms, ascending.
  [[nodiscard]] std::vector<std::uint32_t> elements(std::size_t i) const {
    return is_fitted() ? fits_[i].elements : by_area_.elements(i);
  }
  /// Returns the elements in which the pair may have a term, ascending.
  [[nodiscard]] std::vector<std::uint32_t> elements(std::size_t i, std::size_t j) const;
  /// Returns true if two targets can have a term as a pair: if both move the same face or, for fitted weightings, the
  /// same element.
  [[nodiscard]] bool overlap(std::size_t i, std::size_t j) const;
  /// Return normals at some weights, computed from the blended positions: exact_at() the right ones with the length by
  /// area, by_area_at() those weighted by area, whatever the weighting.
  [[nodiscard]] std::vector<Vec3d> exact_at(std::span<const double> weights) const;
  [[nodiscard]] std::vector<Vec3d> at(std::span<const double> weights) const { return exact_at(weights); }
  [[nodiscard]] std::vector<Vec3d> by_area_at(std::span<const double> weights) const {
    return normals_from_positions(shading_, weights);
  }
  /// Returns the normals of some elements by a fitted weighting at some weights, with the length by area.
  [[nodiscard]] std::vector<Vec3d> weighted_at(std::span<const double> weights,
                                               std::span<const std::uint32_t> elements) const;
  [[nodiscard]] bool is_fitted() const noexcept { return !truth_.is_plain(); }
  /// Returns true if the file has the author's normals at keys, and the true normals equal them there.
  [[nodiscard]] bool follow_keys() const { return truth_.follows_keys(); }
  /// Returns the largest angle between the fitted and the true normals of a single target, in radians, measured at
  /// eighths of its weight; 0 by area.
  [[nodiscard]] double fit_error(std::size_t i) const { return is_fitted() ? fits_[i].error : 0; }

 private:
  // The terms of one target, for the elements of the faces that it moves.
  struct Fit {
    std::vector<std::uint32_t> elements;
    std::vector<Vec3d> linear, square;
    double error = 0;
  };
  static constexpr std::size_t kMostSampledBytes = std::size_t{256} << 20;

  void fit_targets();
  // Returns the true normals of all elements at some weights, with the length by area. Keeps them while there is room.
  [[nodiscard]] std::vector<Vec3d> sample_all(std::span<const double> weights, std::span<const double> positions) const;

  const GltfShading& shading_;
  const AuthorTruth& truth_;
  BlendTerms by_area_;
  std::vector<Vec3d> base_;  // set if the truth is fitted, or if it takes little memory
  std::vector<Fit> fits_;
  mutable PoseMemory sampled_{kMostSampledBytes};  // all elements
};

/// A term whose values are computed or looked up when they are needed. Threads: const functions may run at once.
class NormalTerms::Term {
 public:
  /// Returns whether an element has the term, and writes its value.
  [[nodiscard]] bool find(std::uint32_t element, Vec3d& value) const;

 private:
  friend class NormalTerms;
  explicit Term(BlendTerms::Term by_area) : by_area_(std::move(by_area)) {}
  explicit Term(BlendTerm fitted) : fitted_(std::move(fitted)) {}

  std::optional<BlendTerms::Term> by_area_;
  BlendTerm fitted_;
};

/// Returns the control normals of a single target from weight 0 to 1, from its terms.
[[nodiscard]] ControlNormals of_powers(const Vec3d& base, const Vec3d& linear, const Vec3d& square) noexcept;

/// Returns the control normals from weight `from` to weight `to`, given those from 0 to 1.
[[nodiscard]] ControlNormals normals_between(const ControlNormals& normals, double from, double to) noexcept;

/// A map that turns and scales the terms of an element for a vertex that shows it: it divides them by |n(0)|,
/// multiplies by the length of the stored normal N, and applies the smallest rotation from n(0) to N. If n(0) is nearly
/// zero, a division is impossible; the terms are then made so long that N does not matter beside them.
class VertexTerms {
 public:
  /// Takes n(0) of the element, the length of its largest term, and the stored normal of the vertex.
  VertexTerms(const Vec3d& base, double largest, const Vec3d& stored) noexcept;

  [[nodiscard]] static bool has_base(const Vec3d& base, double largest) noexcept {
    return has_base(length(base), largest);
  }
  [[nodiscard]] static bool has_base(double length_of_base, double largest) noexcept {
    return largest <= kLongest * length_of_base;
  }

  /// Converts a term of n(w).
  [[nodiscard]] Vec3d operator()(const Vec3d& term) const noexcept { return scale_ * turn(term); }
  /// Converts the best single delta, for which |n(0)| is 1.
  [[nodiscard]] Vec3d end_delta(const Vec3d& delta, const ControlNormals& normals) const noexcept;
  /// Converts a fitted delta (fitted_lines.h), for which |n(0)| is 1.
  [[nodiscard]] Vec3d fitted_delta(const Vec3d& delta) const noexcept;

 private:
  static constexpr double kLongest = 1e6;

  [[nodiscard]] Vec3d turn(const Vec3d& v) const noexcept;

  Vec3d base_, stored_;  // unit vectors, or zero
  double length_ = 1, scale_ = 0, side_ = 1;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_TERMS_H_
