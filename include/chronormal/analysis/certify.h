/// Certificates: lower and upper bounds of the largest angular error of a scheme over a whole segment.
///
/// Samples can miss the worst instant, and a certificate cannot. For each element the certificate encloses
///
///     the supremum over t in [0, 1] of the angle between the scheme's normal, in float32, and the exact n(t)
///
/// The error is at most `upper` at every t, and at least `lower` at the t named `at`.
///
///     auto slerp = make_scheme("slerp").value();
///     slerp->prepare({&segment, {0, normals.size()}, normals});
///     std::vector<ErrorBounds> bounds(normals.size());
///     certify(*slerp, {&segment, {0, normals.size()}, normals}, bounds);
///
/// Method     [0, 1] is cut into pieces. In each piece, the scheme's curve lies within a ball around a cubic, and the
///            exact normal is a quadratic. The Bernstein coefficients of their cross and dot products bound the angle.
///            The piece with the largest bound is halved until this bound meets the largest error found in the middle
///            of a piece (docs/theory.md, section 19).
/// Rounding   The bounds include rounding. The scheme's coefficients are taken as the float32 numbers that the scheme
///            stores. The radius of the ball includes a proven bound of the rounding error when the curve is evaluated
///            in float32. The errors of the control normals are added to the bound. The bound of `polynomial` and
///            `recompute` is kExactTolerance, which these schemes guarantee.
/// Collapses  If n(t), or the vector that the scheme normalises, vanishes inside the segment, no bound below half a
///            turn is claimed: `upper` is pi, and [from, to] contains the t at which it vanishes.
/// Units      angles in radians; t is the fraction of the segment, from 0 to 1.
/// Threads    pure. Allocates a little, once for each call.
/// Cost       about 10 pieces per element: 1.5 to 5 microseconds; schemes of nested slerps take 50 times as long.
/// Limits     The bounds hold if a scheme is evaluated at arbitrary t. They do not hold for playback, whose errors add
///            up from frame to frame. The scheme must be prepared from the block that is given to certify().
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

/// The result for one element: the largest angular error of a scheme over a segment lies between two bounds.
struct ErrorBounds {
  double lower = 0;         ///< a lower bound in radians: the error at `at` is at least this
  double upper = 0;         ///< an upper bound in radians: no error is larger; pi if no smaller bound could be shown
  double at = 0;            ///< a t in [0, 1] at which the error is at least `lower`
  double from = 0, to = 1;  ///< the piece of [0, 1], in t, that has the largest bound
};

struct CertifyOptions {
  /// Stops refining an element when its two bounds differ by at most `relative_gap` times the upper bound, plus `gap`.
  /// The part of the difference that is due to rounding does not count.
  double relative_gap = 1e-3;
  double gap = 1e-6;  ///< an angle in radians, as used above
  /// Stops refining an element when its upper bound is at most this angle.
  double enough = 0;  ///< an angle in radians; 0 refines every element as far as the other limits allow
  /// Stops refining an element when its upper bound is at most the largest lower bound of earlier elements in the
  /// block, for callers who only need the worst element.
  bool only_worst = false;
  /// Stops refining an element when [0, 1] is cut into this many pieces for the element.
  std::size_t most_pieces = 256;  // may not exceed 256
};

/// Bounds of the errors of the three control normals n0, m and n1 of an element. Each bound is the largest possible
/// difference between a component of the control normal and the exact value of this component.
using ControlErrors = std::array<double, 3>;

/// Bounds the errors of all elements of a block. An element without a normal in the whole segment gets the bounds 0, 0.
/// The scheme must be prepared from this block, and `result` must have as many elements. `errors` has an entry for each
/// element, or is empty if every control normal has a relative error of at most 2^-26, as face_control_normals()
/// guarantees.
void certify(const Scheme& scheme, const ElementBlock& block, std::span<ErrorBounds> result,
             const CertifyOptions& options = {}, std::span<const ControlErrors> errors = {});

/// Bounds the errors of a scheme, given by its name, for all faces of a segment. Errors: those of make_scheme().
[[nodiscard]] Result<std::vector<ErrorBounds>> certify(std::string_view scheme, const Segment& segment,
                                                       const CertifyOptions& options = {},
                                                       Threads threads = Threads::kOne);

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_CERTIFY_H_
