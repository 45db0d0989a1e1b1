/// Certificates: lower and upper bounds of the largest angular error of a scheme over a whole segment.
///
/// Samples can miss the worst instant. A certificate cannot: for each element it encloses
///
///     the supremum over t in [0, 1] of the angle between what the scheme shows, in float32, and the exact n(t)
///
/// so that no sample at whatever t is ever above `upper`, and the error reaches `lower` at the t that is given.
///
///     auto slerp = make_scheme("slerp").value();
///     slerp->prepare({&segment, {0, normals.size()}, normals});
///     std::vector<ErrorBounds> bounds(normals.size());
///     certify(*slerp, {&segment, {0, normals.size()}, normals}, bounds);
///
/// Method     [0, 1] is cut into pieces. On each, the scheme is a cubic and a ball around it, the normal a quadratic,
///            and the Bernstein coefficients of their cross and dot products bound the angle; the piece with the
///            largest bound is halved until that bound meets the largest error found in the middle of a piece
///            (docs/theory.md, section 19).
/// Rounding   is included: coefficients are taken as float32 has them, the ball has a proven bound of what evaluating
///            them in float32 adds, and control normals count with their errors. `polynomial` and `recompute` have the
///            bound that they promise, kExactTolerance.
/// Collapses  Where n(t) vanishes inside the segment, or what the scheme normalises does, no bound below half a turn is
///            claimed: `upper` is pi, and [from, to] holds the place.
/// Units      radians; local t.
/// Threads    pure. Allocates a little, once for each call.
/// Cost       some 10 pieces an element: 1.5 to 5 microseconds; schemes of slerps of slerps take 50 times as long.
/// Limits     Normals at random access: playback drifts, and is not covered. Bounds are of scheme and control normals
///            that are prepared from the same block.
#ifndef CHRONORMAL_ANALYSIS_CERTIFY_H_
#define CHRONORMAL_ANALYSIS_CERTIFY_H_

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/core/result.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/schemes/scheme.h"

namespace chronormal {

/// The largest angular error of one element over a segment, between two bounds.
struct ErrorBounds {
  double lower = 0;         ///< radians; the error reaches it at `at`
  double upper = 0;         ///< radians; no error is above it; pi where none could be shown
  double at = 0;            ///< local t
  double from = 0, to = 1;  ///< local t: the piece of which the bound is the largest
};

struct CertifyOptions {
  /// Ends an element when its bounds differ by no more than this share of the upper one plus `gap`, not counting what
  /// rounding may add.
  double relative_gap = 1e-3;
  double gap = 1e-6;  ///< radians
  /// Ends an element when its upper bound is not above this.
  double enough = 0;  ///< radians
  /// Ends an element when its upper bound is not above the largest lower bound of the elements before it in the block,
  /// for callers who only ask for the worst.
  bool only_worst = false;
  /// Ends an element when the segment is in so many pieces.
  std::size_t most_pieces = 256;  // at most 256
};

/// The largest distance of each component of n0, m and n1 of an element from the true one.
using ControlErrors = std::array<double, 3>;

/// Bounds the errors of all elements of a block. An element without a normal in the whole segment has the error 0, 0.
/// scheme must be prepared from this block, and result must have as many elements. `errors` has one entry for each
/// element, or is empty: then every control normal is within 2^-26 of its length, as face_control_normals() promises.
void certify(const Scheme& scheme, const ElementBlock& block, std::span<ErrorBounds> result,
             const CertifyOptions& options = {}, std::span<const ControlErrors> errors = {});

/// Bounds the errors of all faces of a segment for a scheme that is given by its name. Errors: those of make_scheme().
[[nodiscard]] Result<std::vector<ErrorBounds>> certify(std::string_view scheme, const Segment& segment,
                                                       const CertifyOptions& options = {},
                                                       Threads threads = Threads::kOne);

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_CERTIFY_H_
