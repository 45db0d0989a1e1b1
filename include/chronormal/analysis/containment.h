/// Points and a closed mesh that deforms: which are inside, and when and where each goes through the surface.
///
/// In a segment the vertices move on straight lines, and so does a point. It is in the plane of the face (a, b, c)
/// where (p(t) - a(t)) . n(t) is zero, a cubic in t; where it is between the edges too, it crosses. What is *inside* is
/// told by the winding number w, how many times the surface goes round the point: inside where w is not 0. A crossing
/// changes w by one: by +1 where the point goes from the front of a face, to which the normal points, to its back
/// (inward), and by -1 the other way. So between any two times, neither of which is a moment as described under
/// *Moments* below,
///
///     w(later) - w(earlier) = inward crossings - outward crossings
///
/// holds without exception, also where a point goes through an edge or a vertex, along a face, or touches the surface:
/// every decision is exact, in integers where double cannot decide, on the positions as they are.
///
/// Ties       A point that is on the surface is taken as moved by an infinitely small step along +x, and where that
///            leaves it on the surface along +y, then +z. So of two closed meshes that share a face, a point on it is
///            inside exactly one; of a cube from (0, 0, 0) to (1, 1, 1), x = 0 is inside and x = 1 is outside. The step
///            is the same at all times: a point that rests on a face that rests does not cross it.
/// Closed     Every edge must be passed as often one way as the other by the faces that have it: then w is a whole
///            number everywhere. Surfaces may go through themselves, and have several pieces. Edges are between points
///            of the surface (normals/normal_groups.h), so that seams of a file do not open it. A face of more than
///            three corners is the triangles that it is cut into at the given
///            positions: a fan around its first one, or ears where that does not cover it.
/// Moments    What happens within a moment of 2^-47 of a segment is reported by its sum where it cannot be told apart:
///            a point that touches an edge from outside has no crossing, and one that goes through it has one. At the
///            very moment of touching, the tie may be decided either way, so that w may differ from its value right
///            before and right after.
/// Shapes     P = points, as (P, 3) float32.
/// Threads    const functions may run at the same time, and use all cores. Results are the same on any number.
/// Source     docs/theory.md, section 2; Edelsbrunner, Muecke, Simulation of Simplicity (1990).
#ifndef CHRONORMAL_ANALYSIS_CONTAINMENT_H_
#define CHRONORMAL_ANALYSIS_CONTAINMENT_H_

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

/// A passage of a point through the surface.
struct Crossing {
  std::uint32_t point = 0;  ///< index of the point
  std::uint32_t face = 0;   ///< of an edge or a vertex, one of its faces
  double t = 0;             ///< in the segment, within 2^-44 of the exact root
  bool inward = false;      ///< the winding number rises
  Vec3d normal;             ///< unit normal of the face at t; (0, 0, 0) where it has none

  friend bool operator==(const Crossing&, const Crossing&) = default;
};

class Containment {
 public:
  /// Prepares a mesh for any number of segments and points: O(corners log corners), once. The positions, of any one
  /// keyframe, say which faces are near to each other; they have no influence on results.
  /// Errors: kInvalidInput for a mesh that is not closed, with the number of its boundary edges, which one face has,
  /// and of those that are passed more often one way by several.
  [[nodiscard]] static Result<Containment> make(const Topology& topology, const Points& points,
                                                VectorView<const float> positions);

  Containment(Containment&&) noexcept;
  Containment& operator=(Containment&&) noexcept;
  ~Containment();

  /// Returns the winding number of each point at t, which is rounded to a multiple of 2^-48. Points move on straight
  /// lines as the segment does; a point that rests has the same position twice.
  /// The segment must be of the topology that this was made of; from and to must have one position for each point
  [[nodiscard]] std::vector<std::int32_t> winding_numbers(const Segment& segment, double t,
                                                          VectorView<const float> from,
                                                          VectorView<const float> to) const;

  /// Finds all crossings in the segment, ordered by point and t.
  /// Cost: O(log F) for each point, and a cubic for each face that comes near it.
  [[nodiscard]] std::vector<Crossing> crossings(const Segment& segment, VectorView<const float> from,
                                                VectorView<const float> to) const;

 private:
  struct Mesh;
  explicit Containment(std::unique_ptr<const Mesh> mesh);

  std::unique_ptr<const Mesh> mesh_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_CONTAINMENT_H_
