/// Fits correction targets for a rig that no animation drives. The own deltas of a mesh leave errors in the poses for
/// which the rig is made. These errors are written as a sum of a few deltas whose weights are quadratic in the weights
/// of the rig (docs/theory.md, section 18). Private to workflow.
///
///     n(w) / |n(0)|  =  N + sum_i w_i D_i + sum_k s_k(w) E_k, nearly,   s_k(w) = sum_i l_ki w_i + sum_ij q_kij w_i w_j
///
/// The missing normals in some poses of the rig form a matrix that is nearly of low rank. Its leading right singular
/// vectors are the deltas E_k that help most. n(w) is a quadratic form, so the best weight s_k is a quadratic form too.
/// Its terms are the terms of n(w) projected on E_k. Small terms are dropped. Then the E_k are fitted again for each
/// point, to the missing normal divided by the length of n(w). The length of this quotient is about the angle of the
/// error.
///
/// Threads    Uses all cores. The result has the same bits on any number of cores.
#ifndef CHRONORMAL_WORKFLOW_BAKE_FITS_QUADRATIC_FIT_H_
#define CHRONORMAL_WORKFLOW_BAKE_FITS_QUADRATIC_FIT_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "workflow/bake/deltas/deltas.h"
#include "workflow/bake/deltas/vertex_columns.h"
#include "workflow/bake/fits/missing_normals.h"
#include "workflow/shading/rig_poses.h"

namespace chronormal::inline internal {

/// The largest number of terms in the weight of one correction target.
inline constexpr std::size_t kMostTerms = 160;

class QuadraticFit {
 public:
  /// Prepares the fit. `own` has the deltas of the mesh's own targets. Only those vertices in `vertices` that have
  /// errors are fitted. rights must outlive this object. Computes the right normals in 400 poses, and all terms of
  /// n(w).
  QuadraticFit(const DeltaSource& source, const RightNormals& rights, std::span<const std::uint32_t> vertices,
               const std::vector<VertexVectors>& own, const RigPoses& rig,
               std::span<const std::vector<double>> standing, std::size_t most_extras, double tolerance);

  /// Returns the largest number of correction targets that is worth trying.
  [[nodiscard]] std::size_t extras() const noexcept { return extras_; }

  struct Extras {
    /// Weights of the correction targets, from about -1 to 1 in the poses of the rig. The member `target` of each
    /// weight is not set.
    std::vector<GltfExtraTarget> weights;
    std::vector<VertexVectors> vectors;  ///< deltas of any length
  };
  /// Returns the best `count` correction targets. count must be at most extras(). If keeps_lengths is false, only the
  /// direction of the sum of the stored normal and all deltas is fitted, and the length of this sum changes as little
  /// as possible.
  [[nodiscard]] Extras best(std::size_t count, bool keeps_lengths) const;

 private:
  // A factor that depends on the weights, in a term of n(w): the weight w_i, or the product w_i w_j.
  struct Feature {
    std::size_t i = 0, j = 0;
    bool is_linear = false;

    [[nodiscard]] double at(std::span<const double> pose) const noexcept {
      return is_linear ? pose[i] : pose[i] * pose[j];
    }
  };

  void find_features(const DeltaSource& source);
  [[nodiscard]] std::vector<float> directions(std::span<const double> vectors) const;
  void project(const DeltaSource& source, const VertexColumns& own, std::span<const float> directions);
  void leave_out_small(const RigPoses& rig);
  void evaluate();

  const RightNormals& rights_;
  double tolerance_;
  std::size_t extras_ = 0, padded_ = 0;
  std::vector<PointVertices> points_;
  MissingNormals missing_;
  std::vector<float> importance_;  // for each point, the factor by which it counts in the fit
  std::vector<Feature> features_;
  std::vector<double> terms_;   // (features, extras), the factors of all features
  std::vector<float> weights_;  // (rows, padded), the weights in the poses of the fit
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FITS_QUADRATIC_FIT_H_
