/// When a face collapses: the instants at which its normal vanishes, decided exactly.
///
/// n(t) vanishes for no t, at one or two instants, or in the whole segment. At a simple zero the face turns over: the
/// directions before and after are antipodal. At a double zero it does not: the face shrinks to nothing and comes back
/// as it was. That is a question about integers, for positions in float32 are integers times a power of two, and it is
/// answered as one: no threshold decides, and no rounding.
///
///     const Collapses found = find_collapses(segment, face);
///     for (const Collapse& one : found.instants()) ...       // one.lower <= t <= one.upper
///
/// Certain    whether there is a collapse, how many, whether each turns the face over, and that its instant t lies in
///            [lower, upper]: equal where a double is t, else neighbours, but for t below 2^-200, which lie in [0,
///            2^-200]. The limit directions are within 1e-14 of their value.
/// Nearly     A face may come so close to a collapse that its direction is as good as discontinuous: what was made to
///            collapse, and then rounded. It does not count here; workflow/inspect.h counts both.
/// Units      t: fraction of the segment, in [0, 1].
/// Threads    pure; for one face without allocation or throw.
/// Source     docs/theory.md, section 3.
#ifndef CHRONORMAL_ANALYSIS_COLLAPSE_H_
#define CHRONORMAL_ANALYSIS_COLLAPSE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal {

/// One instant without a normal.
struct Collapse {
  double lower = 0, upper = 0;  ///< t lies between these
  bool turns_over = false;      ///< the direction after is opposed to that before; false at t = 0 and t = 1
  Vec3d before, after;          ///< the limits of n(t) / |n(t)|; (0, 0, 0) before t = 0 and after t = 1
};

struct Collapses {
  std::array<Collapse, 2> at;  ///< ascending in t
  std::size_t count = 0;
  bool always = false;  ///< n is zero in the whole segment; count is 0

  [[nodiscard]] std::span<const Collapse> instants() const& noexcept { return {at.data(), count}; }
  void instants() && = delete;  ///< a loop over a temporary would outlive it
};

/// Decides for one face, from its positions. Cost: three dot products for most faces; where those do not prove that
/// n(t) stays away from zero, a few microseconds of integers.
[[nodiscard]] Collapses find_collapses(const Segment& segment, std::size_t face) noexcept;

/// The same where the control normals of the face, as face_control_normals() makes them of this segment, are at hand.
[[nodiscard]] Collapses find_collapses(const Segment& segment, std::size_t face,
                                       const ControlNormals& normals) noexcept;

struct FaceCollapses {
  std::size_t face = 0;
  Collapses collapses;
};

/// Finds those of a range of faces that collapse, ascending; normals are those of the range. Allocates the result
/// alone.
[[nodiscard]] std::vector<FaceCollapses> find_collapses(const Segment& segment, IndexRange faces,
                                                        std::span<const ControlNormals> normals);

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_COLLAPSE_H_
