/// Computes the figures of the paper for one face. From these numbers, users can draw Figures 1 to 3 of the paper
/// for faces of their own.
///
/// One face moves in one segment. At equally spaced times, the figure has the exact normal of the face, and its length,
/// which is twice the area. For each scheme, it has the normal that the scheme computes, the length of that normal
/// before normalization (Figure 2), and its angle to the exact normal. It also shows how the scheme computes the normal
/// (Figure 3), by the points of de Casteljau's algorithm and the frames of quaternions.
///
/// Numbers    Normals are those of Scheme::evaluate(). Angles are those of compare() at the same samples, so that their
///            sum is q of the paper. Lengths, points and frames are computed in double from the values that the scheme
///            keeps.
/// Threads    All functions are pure.
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
  std::vector<std::string> schemes;  ///< the names of schemes; if empty, default_schemes() of faces
  std::size_t samples = 21;          ///< the number of times, with t = 0 and t = 1; 2 or more
};

/// The figures of one scheme. S is the number of samples.
struct SchemeFigure {
  std::string scheme;
  double sum = 0;               ///< the sum of the angles in radians, q of the paper
  std::vector<Vec3d> normals;   ///< (S) the normals that the scheme computes: unit vectors, or zero
  std::vector<double> angles;   ///< (S) radians: the angles to the exact normals; NaN if one of the two normals is zero
  std::vector<double> lengths;  ///< (S) lengths before normalization; empty if the length is always 1
  /// The steps of de Casteljau's algorithm. `nodes` has the exact normals with which the algorithm begins, (K).
  /// `points` has the points that the algorithm computes at each sample: K - 1 of the first level, K - 2 of the second,
  /// ..., 1 of the last level, (S, K (K - 1) / 2). Both lists are empty for schemes that do not use this algorithm.
  std::vector<Vec3d> nodes, points;
  /// The tangent of a quaternion scheme's frame at each sample, (S). The binormal is normal x tangent. The list is
  /// empty for other schemes, and if the scheme used its fallback.
  std::vector<Vec3d> tangents;
};

struct FaceFigure {
  std::size_t face = 0, segment = 0;
  std::vector<std::array<Vec3d, 2>> corners;  ///< the positions of each corner at t = 0 and at t = 1
  std::vector<double> times;                  ///< (S) the times t, from 0 to 1
  /// The exact unit normal at each sample, (S). If the area is zero at a sample, the entry is the limit of the normal,
  /// or zero if there is no limit.
  std::vector<Vec3d> normals;
  std::vector<double> lengths;  ///< (S) the length of n(t), which is twice the area
  /// The paper's matrix M (eq. 8), by rows. It is the affine map that takes the first, the second and the last corner
  /// and the unit normal from t = 0 to t = 1. Not set if the face has no area at t = 0 or at t = 1.
  std::optional<std::array<std::array<double, 4>, 3>> matrix;
  std::vector<SchemeFigure> schemes;
};

/// Computes the figures of one face. The motion must be valid (validate() in motion/motion.h). Errors: kUsage for a
/// face, segment or scheme that does not exist, and for fewer than 2 samples.
[[nodiscard]] Result<FaceFigure> face_figure(const Motion& motion, const FaceFigureOptions& options);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_FACE_FIGURE_H_
