/// Decides into how many straight pieces curved motions of vertices must be cut, by a bound of the angle between the
/// normals of the pieces and those of the curves. Private to motion and io.
///
/// Let e and f be edges of a face over one piece, on the chords, and let the edges on the curves differ from them by p
/// and q times s (1 - s), where s runs from 0 to 1. Then the normal on the curves differs from the normal n on the
/// chords by
///
///     d = s (1 - s) (e x q + p x f) + s^2 (1 - s)^2 p x q                                                         (1)
///
/// added up over the triangles of the face's fan. If p and q are linear, as for cubics, both products are quadratics in
/// s, and so is n. A quadratic is never longer than the longest of its Bernstein coefficients, and nowhere shorter than
/// the shortest of their projections on a direction. As s (1 - s) <= 1/4, this bounds |d| from above by r and |n| from
/// below by l, and the angle between n and n + d by asin(r / l). Sums over faces differ by no more than the sum of
/// their r, so that the same bounds serve vertices and corners.
///
/// For other curves only lengths are known: |p| <= h^2 / 2 max |e''| if a piece takes the time h, and |e| is largest at
/// an end.
///
/// Rounding a keyframe to float32 moves each coordinate by up to 2^-24 of its value. This changes the normal like (1),
/// by up to |e| |dq| + |dp| |f| + |dp| |dq|. Cutting a piece whose r is below this change gains nothing.
#ifndef CHRONORMAL_MOTION_PIECE_BOUNDS_H_
#define CHRONORMAL_MOTION_PIECE_BOUNDS_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "chronormal/core/vec3.h"
#include "chronormal/motion/paths.h"
#include "core/rounding.h"
#include "core/vector_area.h"

namespace chronormal::inline internal {

/// A vector that changes linearly over a piece, given by its values at both ends.
struct Ends {
  Vec3d from, to;
};

/// An edge of a face from its first corner, over a piece: `chord` between points on the chords, and chord + s (1 - s) p
/// between points on the curves. `beside` is the known part of p, `farther` bounds the length of the rest of p, and
/// `rounding` bounds the rounding error of the edge at either end.
struct PieceEdge {
  Ends chord, beside;
  double farther = 0, rounding = 0;
};

/// Returns a bound of the rounding error of an edge whose ends have no coordinate larger than `size`.
[[nodiscard]] inline double edge_rounding(double size) noexcept {
  return 2 * std::sqrt(3.0) * kFloatUnitRoundoff * size;
}

/// The sum of the cross products e x f of moving edges, as the Bernstein coefficients of a quadratic in s.
class EdgeProducts {
 public:
  void add(const Ends& e, const Ends& f) noexcept {
    from_ = from_ + cross(e.from, f.from);
    middle_ = middle_ + 0.5 * (cross(e.from, f.to) + cross(e.to, f.from));
    to_ = to_ + cross(e.to, f.to);
  }
  [[nodiscard]] double longest() const noexcept { return std::max({length(from_), length(middle_), length(to_)}); }
  [[nodiscard]] double shortest() const noexcept {
    const Vec3d direction = unit(from_ + 2 * middle_ + to_);
    return std::min({dot(from_, direction), dot(middle_, direction), dot(to_, direction)});
  }

 private:
  Vec3d from_, middle_, to_;
};

/// Returns true if the normal of a face on its chords stays within an angle, given by its sine, of the normal on the
/// curves over a piece, or as near as rounding to float32 allows. edge_to(c) makes the edge to corner c. Returns false
/// if a bound is NaN or infinite.
template <class EdgeTo>
[[nodiscard]] bool is_within(std::size_t corners, const EdgeTo& edge_to, double sine) {
  EdgeProducts normal, beside, beside_both;
  double farther = 0, rounding = 0;
  for_fan(corners, edge_to, [&](const PieceEdge& e, const PieceEdge& f) {
    normal.add(e.chord, f.chord);
    beside.add(e.chord, f.beside);
    beside.add(e.beside, f.chord);
    beside_both.add(e.beside, f.beside);
    const auto size = [](const Ends& ends) { return std::max(length(ends.from), length(ends.to)); };
    farther += (size(e.chord) * f.farther + e.farther * size(f.chord)) / 4 +
               (size(e.beside) * f.farther + e.farther * size(f.beside) + e.farther * f.farther) / 16;
    rounding += size(e.chord) * f.rounding + e.rounding * size(f.chord) + e.rounding * f.rounding;
  });
  const double most = (1 + 0x1p-30) * (beside.longest() / 4 + beside_both.longest() / 16 + farther);
  return most <= rounding || most <= sine * normal.shortest();
}

struct Pieces {
  std::size_t count = 1;
  std::size_t beyond = 0;  ///< number of faces for which the count is not enough
};

/// Returns the smallest number of pieces that is enough for every face, but at most `most`. Faces for which no number
/// of pieces is enough do not count. bounds.not_within(faces, pieces) returns those of `faces` for which `pieces`
/// pieces are not enough, in their order; nullptr stands for all faces.
template <class Bounds>
[[nodiscard]] Pieces pieces_for(const Bounds& bounds, std::size_t most) {
  const std::size_t tried = std::max(most, kMostPieces);
  // The numbers of pieces that are tried, ascending, and for each number the count of faces for which it is not enough.
  std::vector<std::size_t> ladder, left;
  for (std::size_t n = 1; n <= tried; n *= 2) {
    ladder.push_back(n);
    if (n > 1 && n + n / 2 <= tried) ladder.push_back(n + n / 2);
  }
  std::vector<std::uint32_t> never = bounds.not_within(nullptr, 1);
  left.push_back(never.size());
  for (std::size_t r = 1; r < ladder.size() && !never.empty(); ++r) {
    never = bounds.not_within(&never, ladder[r]);
    left.push_back(never.size());
  }
  auto rung = static_cast<std::size_t>(std::find(left.begin(), left.end(), never.size()) - left.begin());
  // Smaller pieces should suffice for every face for which larger pieces did. This assumption is checked once more,
  // because the tolerance is guaranteed.
  for (; rung > 0 && rung + 1 < ladder.size(); ++rung) {
    const std::vector<std::uint32_t> now = bounds.not_within(nullptr, ladder[rung]);
    if (std::includes(never.begin(), never.end(), now.begin(), now.end())) break;
  }
  if (ladder[rung] <= most) return {ladder[rung], never.size()};
  while (ladder[rung] > most) --rung;
  return {ladder[rung], bounds.not_within(nullptr, ladder[rung]).size()};
}

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_MOTION_PIECE_BOUNDS_H_
