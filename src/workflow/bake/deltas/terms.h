/// Computes the terms of the normals of one mesh, for any weighting, and converts them to deltas of vertices. Private
/// to workflow.
#ifndef CHRONORMAL_WORKFLOW_BAKE_DELTAS_TERMS_H_
#define CHRONORMAL_WORKFLOW_BAKE_DELTAS_TERMS_H_

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

/// The true normals of all elements as a quadratic form in the weights. If normals are weighted by area, the form is
/// exact. If not, the true normal is no polynomial, and the form is fitted to it. The length by area of a normal is the
/// length of the normal weighted by area. At some weights, the fitted form has the true direction and the length by
/// area: if one target has the weight 0, 1/2 or 1, or if two targets have the weight 1, and all other weights are 0.
class NormalTerms {
 public:
  /// Fits the terms of all targets, if the true normals are not weighted by area. The shading and its truth must
  /// outlive this object.
  NormalTerms(const GltfShading& shading, const AuthorTruth& truth);

  /// Returns n(0) of an element.
  [[nodiscard]] Vec3d base_of(std::uint32_t element) const {
    return base_.empty() ? by_area_.base_of(element) : base_[element];
  }
  /// Return the linear term A_i of a target and the term C_ij of a pair (docs/theory.md), without bounds of their
  /// rounding errors.
  [[nodiscard]] BlendTerm linear(std::size_t i) const;
  [[nodiscard]] BlendTerm pair(std::size_t i, std::size_t j) const;
  /// Return a linear term and the term of a pair as objects, which compute or look up the value of one element at a
  /// time.
  class Term;
  [[nodiscard]] Term linear_by_element(std::size_t i) const;
  [[nodiscard]] Term pair_by_element(std::size_t i, std::size_t j) const;
  /// Returns the elements at which target i may have terms, in ascending order.
  [[nodiscard]] std::vector<std::uint32_t> elements(std::size_t i) const {
    return is_fitted() ? fits_[i].elements : by_area_.elements(i);
  }
  /// Returns the elements at which the pair (i, j) may have a term, in ascending order.
  [[nodiscard]] std::vector<std::uint32_t> elements(std::size_t i, std::size_t j) const;
  /// Returns true if two targets can have a term as a pair: if both move the same face or, in a fitted form, the same
  /// element.
  [[nodiscard]] bool overlap(std::size_t i, std::size_t j) const;
  /// Return the normals of all elements at some weights, computed from the blended positions. exact_at() returns
  /// normals with the true direction and the length of normals weighted by area. by_area_at() returns normals weighted
  /// by area, even if the mesh has another weighting.
  [[nodiscard]] std::vector<Vec3d> exact_at(std::span<const double> weights) const;
  [[nodiscard]] std::vector<Vec3d> at(std::span<const double> weights) const { return exact_at(weights); }
  [[nodiscard]] std::vector<Vec3d> by_area_at(std::span<const double> weights) const {
    return normals_from_positions(shading_, weights);
  }
  /// Returns the true normals of some elements at some weights, if normals are not weighted by area. The result has the
  /// lengths of normals weighted by area.
  [[nodiscard]] std::vector<Vec3d> weighted_at(std::span<const double> weights,
                                               std::span<const std::uint32_t> elements) const;
  [[nodiscard]] bool is_fitted() const noexcept { return !truth_.is_plain(); }
  /// Returns true if the file has the author's normals at keys, and the true normals at these keys equal the author's.
  [[nodiscard]] bool follow_keys() const { return truth_.follows_keys(); }
  /// Returns the largest angle between the fitted and the true normals of a single target, in radians, measured at the
  /// weights 1/8, 2/8 and so on up to 1. Returns 0 if normals are weighted by area.
  [[nodiscard]] double fit_error(std::size_t i) const { return is_fitted() ? fits_[i].error : 0; }

 private:
  // The fitted terms of one target, for the elements around the faces that the target moves.
  struct Fit {
    std::vector<std::uint32_t> elements;
    std::vector<Vec3d> linear, square;
    double error = 0;
  };
  static constexpr std::size_t kMostSampledBytes = std::size_t{256} << 20;

  void fit_targets();
  // Returns the true normals of all elements at some weights, with the lengths of normals weighted by area. Stores the
  // result for later calls, unless the memory for such results is used up.
  [[nodiscard]] std::vector<Vec3d> sample_all(std::span<const double> weights, std::span<const double> positions) const;

  const GltfShading& shading_;
  const AuthorTruth& truth_;
  BlendTerms by_area_;
  std::vector<Vec3d> base_;  // set if the truth is fitted, or if the list takes little memory
  std::vector<Fit> fits_;
  mutable PoseMemory sampled_{kMostSampledBytes};  // the true normals of all elements in some poses
};

/// A term of n(w), one value for each element. Values are computed or looked up when they are needed. Threads: const
/// functions may run at the same time.
class NormalTerms::Term {
 public:
  /// Returns true if the term has a value for an element, and writes this value.
  [[nodiscard]] bool find(std::uint32_t element, Vec3d& value) const;

 private:
  friend class NormalTerms;
  explicit Term(BlendTerms::Term by_area) : by_area_(std::move(by_area)) {}
  explicit Term(BlendTerm fitted) : fitted_(std::move(fitted)) {}

  std::optional<BlendTerms::Term> by_area_;
  BlendTerm fitted_;
};

/// Returns the control normals of a single target from weight 0 to 1, computed from the terms of the target.
[[nodiscard]] ControlNormals of_powers(const Vec3d& base, const Vec3d& linear, const Vec3d& square) noexcept;

/// Returns the control normals from weight `from` to weight `to`. `normals` are the control normals from 0 to 1.
[[nodiscard]] ControlNormals normals_between(const ControlNormals& normals, double from, double to) noexcept;

/// The map from the terms of an element to deltas of a vertex that shows this element. The map divides a term by
/// |n(0)|, multiplies it by the length of the stored normal N, and applies the smallest rotation from n(0) to N. If
/// n(0) is nearly zero, this division is impossible. The terms then become so long that N hardly matters in the sum.
class VertexTerms {
 public:
  /// Creates the map. `base` is n(0) of the element, `largest` is the length of its largest term, and `stored` is the
  /// normal that the file stores for the vertex.
  VertexTerms(const Vec3d& base, double largest, const Vec3d& stored) noexcept;

  [[nodiscard]] static bool has_base(const Vec3d& base, double largest) noexcept {
    return has_base(length(base), largest);
  }
  [[nodiscard]] static bool has_base(double length_of_base, double largest) noexcept {
    return largest <= kLongest * length_of_base;
  }

  /// Converts a term of n(w) of the element to a delta of the vertex.
  [[nodiscard]] Vec3d operator()(const Vec3d& term) const noexcept { return scale_ * turn(term); }
  /// Converts the best single delta of an element to a delta of the vertex. `delta` is scaled so that |n(0)| is 1.
  [[nodiscard]] Vec3d end_delta(const Vec3d& delta, const ControlNormals& normals) const noexcept;
  /// Converts a fitted delta of an element (fitted_lines.h) to a delta of the vertex. `delta` is scaled so that |n(0)|
  /// is 1.
  [[nodiscard]] Vec3d fitted_delta(const Vec3d& delta) const noexcept;

 private:
  static constexpr double kLongest = 1e6;

  [[nodiscard]] Vec3d turn(const Vec3d& v) const noexcept;

  Vec3d base_, stored_;  // the directions of n(0) and N as unit vectors, or zero
  double length_ = 1, scale_ = 0, side_ = 1;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_DELTAS_TERMS_H_
