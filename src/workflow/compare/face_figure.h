/// The figures of the paper for one face: the numbers from which people can draw Figures 1 to 3 for their own faces.
///
/// One face moves in one segment. At equally spaced times, the figure has the exact normal of the face, its length,
/// which is twice the area, and for each scheme its normal, the length of that normal before normalization (Figure 2),
/// the angle to the exact normal, and the way it was computed (Figure 3): the points of de Casteljau's algorithm, and
/// the frames of quaternions.
///
/// Numbers    normals are those of Scheme::evaluate(), angles those of compare() at the same samples, so that their sum
///            is q of the paper. Lengths, points and frames are computed in double from the values that the scheme
///            keeps.
/// Threads    pure.
#ifndef CHRONORMAL_WORKFLOW_COMPARE_FACE_FIGURE_H_
#define CHRONORMAL_WORKFLOW_COMPARE_FACE_FIGURE_H_

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/motion/motion.h"

namespace chronormal::inline internal {

struct FaceFigureOptions {
  std::size_t face = 0, segment = 0;
  std::vector<std::string> schemes;  ///< names; empty: default_schemes() of faces
  std::size_t samples = 21;          ///< ends included; 2 or more
};

/// The figures of one scheme; S = samples.
struct SchemeFigure {
  std::string scheme;
  double sum = 0;               ///< sum of the angles in radians: q of the paper
  std::vector<Vec3d> normals;   ///< (S) unit vectors, or zero
  std::vector<double> angles;   ///< (S) radians; NaN if the exact normal or this normal is zero
  std::vector<double> lengths;  ///< (S) before normalization; empty if the length is always one
  /// The exact normals that de Casteljau's algorithm begins with, (K), and at each sample the points that the algorithm
  /// computes: K - 1 of the first level, K - 2 of the second, ..., 1 of the last level, (S, K (K - 1) / 2). Other
  /// schemes have none.
  std::vector<Vec3d> nodes, points;
  /// (S) the tangent of the frame of a quaternion at each sample; the binormal is normal x tangent. Empty for other
  /// schemes, and if the scheme used its fallback.
  std::vector<Vec3d> tangents;
};

struct FaceFigure {
  std::size_t face = 0, segment = 0;
  std::vector<std::array<Vec3d, 2>> corners;  ///< the place of each corner at t = 0 and at t = 1
  std::vector<double> times;                  ///< (S) t
  std::vector<Vec3d> normals;                 ///< (S) exact unit normals, with their limits; zero if there is none
  std::vector<double> lengths;                ///< (S) of n(t): twice the area
  /// The paper's matrix M (eq. 8), by rows: the affine map from t = 0 to t = 1 of the first, the second and the last
  /// corner and the unit normal. Missing if the face has no area at t = 0 or at t = 1.
  std::optional<std::array<std::array<double, 4>, 3>> matrix;
  std::vector<SchemeFigure> schemes;
};

/// Computes the figures of one face. Errors: kUsage for a face, segment or scheme that does not exist, and for fewer
/// than 2 samples. Precondition: the motion is valid (validate() in motion/motion.h)
[[nodiscard]] Result<FaceFigure> face_figure(const Motion& motion, const FaceFigureOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_FACE_FIGURE_H_
