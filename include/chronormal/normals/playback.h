/// Sequential access to curves of normals: t = start, start + step, start + 2 step, ...
///
/// A quadratic sampled at equal steps is a sum of differences that are themselves sums (forward differences): the next
/// n(t) costs two additions per component, and no multiplication (Hast 2003, as cited by the paper). Every addition
/// rounds, so the state drifts; every `anchor_interval` steps it is made anew from the curves.
///
/// Use        to follow the paper. Since memory is what evaluation waits for, and the state is read and written, it is
///            slower than random access (docs/benchmarks.md); to play many frames, evaluate blocks of them at once
///            (NormalCurves::unit_normals with many t).
/// Drift      The error of the state is absolute, so the direction suffers where |n(t)| is small against where it came
///            from. Elements for which it cannot be shown that the largest control normal stays below 4 |n(t)| are not
///            played but evaluated at random access. For the others, 64 steps are within 5e-5 rad by a bound on every
///            rounding; measured it is a tenth of that (docs/paper.md, section 3).
/// Compact    what NormalCurves keeps in less than float32, or as a unit normal, is evaluated at random access.
/// Memory     the state is read and written at every step: 36 bytes an element of degree 2, beside the curves.
/// Ownership  the curves must outlive the playback. Results go to the caller's memory.
/// Moves      what was moved from may only be destroyed or assigned to.
/// Threads    one playback belongs to one thread at a time.
#ifndef CHRONORMAL_NORMALS_PLAYBACK_H_
#define CHRONORMAL_NORMALS_PLAYBACK_H_

#include <cstddef>
#include <memory>

#include "chronormal/core/views.h"
#include "chronormal/normals/normal_curves.h"

namespace chronormal {

/// Keeps the drift of polynomials of degree up to 3 and of arcs below 5e-6 rad on the built-in morphs (docs/paper.md,
/// section 3). A scheme that normalises a short vector, as linear does between nearly antipodal ends, drifts by as much
/// more as that vector is shorter than 1.
inline constexpr std::size_t kDefaultAnchorInterval = 64;

class NormalPlayback {
 public:
  /// Begins at start. It and every start + k step that is played must lie in [0, 1]. With an anchor_interval of 0 the
  /// state is never made anew.
  NormalPlayback(const NormalCurves& curves, double start, double step,
                 std::size_t anchor_interval = kDefaultAnchorInterval);
  NormalPlayback(NormalPlayback&&) noexcept;
  NormalPlayback& operator=(NormalPlayback&&) noexcept;
  ~NormalPlayback();

  /// Writes the unit normals at the current t, as NormalCurves::unit_normals() does but for the drift, and steps on.
  /// Returns the number of (0, 0, 0) written. result must have as many vectors as the curves have elements
  std::size_t next(VectorView<float> result) noexcept;

  /// How many elements are not played but evaluated at random access, the flagged and compact ones of the curves aside.
  [[nodiscard]] std::size_t unplayed_count() const noexcept;
  /// Memory of the state, in bytes.
  [[nodiscard]] std::size_t bytes() const noexcept;

 private:
  struct Parts;

  std::unique_ptr<Parts> parts_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_PLAYBACK_H_
