/// Interpolated normals against keyframes that were left out: what a sampled motion really did.
///
/// Everything else here takes the motion between two keyframes to be straight, and asks how near the normals are to
/// those of that motion. For blend shapes and a shutter that is the truth. A simulation or a capture did something else
/// between its frames, and the frames themselves tell what: all but every N-th keyframe are left out, normals are
/// interpolated between those that are kept, and held against the normals of those that were left out.
///
/// Paths      "linear": vertices move straight, and the schemes are those of compare(). "catmull-rom": each vertex
///            moves on cubics through the kept keyframes. Its velocity at each of them is that of the parabola through
///            it and its two neighbours, and at an end of the motion that of the cubic through the nearest four. Its
///            normals are exact on that path. "hermite": the same with the velocities of the keyframes, where they have
///            them.
/// Bend       that of the kept keyframes, by bend_of() in motion/paths.h.
/// Source     docs/truth.md.
#ifndef CHRONORMAL_WORKFLOW_TRUTH_H_
#define CHRONORMAL_WORKFLOW_TRUTH_H_

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "chronormal/analysis/quality.h"
#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "chronormal/motion/paths.h"
#include "chronormal/workflow/sample.h"

namespace chronormal {

struct TruthOptions {
  std::size_t every = 2;             ///< which keyframes are kept: 0, N, 2 N, ...; 2 or more
  std::vector<std::string> schemes;  ///< names; empty: those that compare() takes
  ElementOptions elements = {};      ///< of which normals
  std::function<void(std::size_t done, std::size_t total)> progress = {};
};

/// One way to make normals between the kept keyframes.
struct TruthRow {
  std::string path;    ///< "linear", "catmull-rom" or "hermite"
  std::string scheme;  ///< of a linear path; "exact" on a curved one
  Quality quality;     ///< max_at: the kept segment, the face or the first vertex or corner, and the local t
};

struct TruthComparison {
  ElementKind kind = ElementKind::kFaces;
  std::size_t vertices = 0, faces = 0, elements = 0;
  std::size_t kept = 0;      ///< keyframes
  std::size_t left_out = 0;  ///< keyframes that the rows are held against; those behind the last one kept are neither
  double bend = 0;           ///< of the kept keyframes; 0 where there are two
  std::vector<TruthRow> rows;
};

/// Compares schemes on straight paths, and exact normals on curved ones, with the keyframes that were left out. There
/// is a row for each scheme, then one for "catmull-rom", and one for "hermite" where keyframes have velocities.
///
/// Errors     kUsage for a motion that is no sequence (targets and animations of weights are straight: there is no
///            other truth), fewer than two kept keyframes, and what compare() refuses in schemes and elements.
/// Threads    uses all; the same on any number of them.
/// Memory     the control normals of one segment: 72 bytes for each face and element, and the positions of those left out.
/// Precondition: the motion is valid (validate() in motion/motion.h)
[[nodiscard]] Result<TruthComparison> compare_with_truth(const Motion& motion, const TruthOptions& options);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_TRUTH_H_
