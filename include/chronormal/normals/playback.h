/// Sequential access to curves of normals: t = start, start + step, start + 2 step, ...
///
/// A quadratic sampled at equal steps is a sum of differences that are themselves sums (forward differences): the next
/// n(t) costs two additions per component, and no multiplication (Hast 2003, as cited by the paper). Every addition
/// rounds, so the state drifts; every `anchor_interval` steps it is made anew from the curves.
///
/// Memory     the state is read and written at every step: 36 bytes an element of degree 2, beside the curves.
/// Drift      docs/paper.md has it measured against the number of steps.
/// Ownership  the curves must outlive the playback. Results go to the caller's memory.
/// Threads    one playback belongs to one thread at a time.
#ifndef CHRONORMAL_NORMALS_PLAYBACK_H_
#define CHRONORMAL_NORMALS_PLAYBACK_H_

#include <cstddef>
#include <vector>

#include "chronormal/core/views.h"
#include "chronormal/normals/evaluate.h"

namespace chronormal {

/// Keeps the drift of every incremental scheme of degree up to 3 below 5e-6 rad (docs/paper.md, section 3).
inline constexpr std::size_t kDefaultAnchorInterval = 64;

class NormalPlayback {
 public:
  /// start and every start + k step that is played lie in [0, 1]. anchor_interval 0 means: never after the first time.
  NormalPlayback(const NormalCurves& curves, double start, double step,
                 std::size_t anchor_interval = kDefaultAnchorInterval);

  /// Writes the unit normals at the current t, as NormalCurves::unit_normals() does but for the drift, and steps on.
  /// Returns the number of (0, 0, 0) written. result must have as many vectors as the curves have elements
  std::size_t next(VectorView<float> result) noexcept;

  /// Memory of the state, in bytes.
  [[nodiscard]] std::size_t bytes() const noexcept { return state_.size() * sizeof(float); }

 private:
  void anchor(double t) noexcept;

  const NormalCurves* curves_;
  double start_, step_;
  std::size_t anchor_interval_;
  std::size_t index_ = 0;     // of the current step
  std::vector<float> state_;  // per run, in its order: planes of n and its differences
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_PLAYBACK_H_
