/// The paper's Table 1 for any motion: every scheme held against the exact normals.
#ifndef CHRONORMAL_WORKFLOW_COMPARE_H_
#define CHRONORMAL_WORKFLOW_COMPARE_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "chronormal/analysis/quality.h"
#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "chronormal/schemes/scheme.h"
#include "chronormal/workflow/elements.h"

namespace chronormal {

/// The rows of the paper's table, and ours; but for faces without those that look at the faces themselves.
[[nodiscard]] std::vector<std::string> default_schemes(ElementKind kind = ElementKind::kFaces);

/// How the samples of a segment are visited (section 3 of the paper).
enum class Access {
  kRandom,      ///< each on its own
  kSequential,  ///< each from the one before, by the schemes that can; the others as in kRandom
};

struct CompareOptions {
  std::vector<std::string> schemes;  ///< names, in the order of the rows; empty: default_schemes()
  std::size_t samples = 21;          ///< per segment, ends included; 2 or more
  Access access = Access::kRandom;
  /// Told how much of the work is done, from the calling thread; may be empty.
  std::function<void(std::size_t done, std::size_t total)> progress;
  ElementOptions elements = {};  ///< of which normals
};

/// One scheme on one motion. quality.max_at names a face, or the first vertex or corner of the element. Costs are per
/// element; times are those of a thread among all that work, the median over blocks of up to 1,024 elements that stay
/// in cache (on a smaller mesh, the calls themselves are most of it).
struct SchemeComparison {
  std::string scheme;
  Quality quality;
  std::optional<double> relative_to_linear;  ///< sum / sum of linear; nothing where linear errs by rounding only
  std::size_t fallbacks = 0;                 ///< (element, segment) pairs prepared with a stated fallback
  std::size_t flagged = 0;                   ///< (element, segment) pairs evaluated in double
  bool sequential = false;                   ///< whether the scheme was played step by step
  double prepare_ns = 0;                     ///< control normals included, where the scheme uses them
  double evaluate_ns = 0;                    ///< per sample
  double bytes = 0;                          ///< read by an evaluation
  OperationCounts operations;                ///< of the access that was measured
};

struct Comparison {
  ElementKind kind = ElementKind::kFaces;
  std::size_t vertices = 0;
  std::size_t faces = 0;
  std::size_t elements = 0;  ///< that were compared: faces, or different normals of vertices or corners
  std::size_t segments = 0;
  std::size_t samples = 0;
  std::vector<SchemeComparison> schemes;
};

/// Compares schemes on the faces of a motion, or on its vertices or corners, over all its segments.
///
/// Errors     kUsage for a scheme that does not exist or needs faces, fewer than 2 samples, or a wrong crease angle.
/// Threads    uses all (core/parallel.h); everything but the times is the same on any number of them.
/// Memory     a few MB beyond the motion, and 8 bytes per scheme and block of 1,024 elements for the times; for
///            vertices and corners also their groups and 72 bytes for each face and element.
/// Cost       segments x faces x samples x schemes evaluations, plus an exact normal and an arc tangent for each.
/// Precondition: the motion is valid (validate() in motion/motion.h)
[[nodiscard]] Result<Comparison> compare(const Motion& motion, const CompareOptions& options);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_H_
