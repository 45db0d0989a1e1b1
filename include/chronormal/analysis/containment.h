/// Finds which points are inside a closed mesh that deforms, and when and where each point crosses the surface.
///
/// In a segment the vertices move on straight lines, and so does a point. The point is in the plane of the face (a, b,
/// c) when (p(t) - a(t)) . n(t), a cubic in t, is zero; if the point is then between the edges, it crosses the face.
/// The winding number w counts how many times the surface goes around the point; a point is *inside* if w is not 0. A
/// crossing changes w by +1 if the point moves from the front of a face, to which the normal points, to its back
/// (inward), and by -1 in the other direction. So between any two times (except for moments of touching, see *Moments*
/// below),
///
///     w(later) - w(earlier) = inward crossings - outward crossings
///
/// holds, also if a point crosses an edge or a vertex, moves along a face, or touches the surface: every decision is
/// exact for the given positions, by integers if double cannot decide.
///
/// Ties       A point on the surface counts as if moved by an infinitely small step along +x, and if it is still on the
///            surface then, along +y, then +z. So if two closed meshes share a face, a point on the face is inside
///            exactly one of them. A cube from (0, 0, 0) to (1, 1, 1) contains its face x = 0, but not its face
///            x = 1. The step is the same at all times, so a resting point on a resting face does not cross the face.
/// Closed     Every edge must occur equally often in both directions among its faces, so that w is an integer
///            everywhere. Surfaces may intersect themselves, and have several pieces. Edges are between points of the
///            surface (normals/normal_groups.h), so seams of a file do not open the surface. A face of more than three
///            corners is cut into triangles at the given positions: a fan around its first corner, or ears if the fan
///            does not cover the face.
/// Moments    Crossings within a moment of 2^-47 of a segment may be reported as their sum: a point that touches an
///            edge from outside has no crossing, and a point that goes through the edge has one. At the very moment of
///            touching, the tie may be decided either way, so w may differ from its value right before and right after.
/// Shapes     P = points, as (P, 3) float32.
/// Threads    const functions may run at the same time, and use all cores. Results are the same on any number of cores.
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

/// A crossing of a point through the surface.
struct Crossing {
  std::uint32_t point = 0;  ///< index of the point
  std::uint32_t face = 0;   ///< the face; if an edge or a vertex is crossed, one of its faces
  double t = 0;             ///< t in the segment, within 2^-44 of the exact root
  bool inward = false;      ///< true if the point moves to the back of the face; the winding number then rises
  Vec3d normal;             ///< unit normal of the face at t; (0, 0, 0) if the face has no normal there

  friend bool operator==(const Crossing&, const Crossing&) = default;
};

class Containment {
 public:
  /// Prepares a mesh for any number of segments and points, in O(corners log corners). The positions may be those of
  /// any keyframe. They only tell which faces are close to each other, and do not change any result. Errors:
  /// kInvalidInput for a mesh that is not closed. The message gives the number of boundary edges, which belong to a
  /// single face, and the number of edges that several faces share but that occur more often in one direction than in
  /// the other.
  [[nodiscard]] static Result<Containment> make(const Topology& topology, const Points& points,
                                                VectorView<const float> positions);

  Containment(Containment&&) noexcept;
  Containment& operator=(Containment&&) noexcept;
  ~Containment();

  /// Returns the winding number of each point at t, which is rounded to a multiple of 2^-48. Points move on straight
  /// lines like vertices; a point rests if its positions in `from` and `to` are the same. Preconditions: the segment
  /// has the topology that was given to make(); `from` and `to` have a position for each point.
  [[nodiscard]] std::vector<std::int32_t> winding_numbers(const Segment& segment, double t,
                                                          VectorView<const float> from,
                                                          VectorView<const float> to) const;

  /// Finds all crossings in the segment, ordered by point and t.
  /// Cost for each point: O(log F) for F faces, and the roots of a cubic for each face that comes near the point.
  [[nodiscard]] std::vector<Crossing> crossings(const Segment& segment, VectorView<const float> from,
                                                VectorView<const float> to) const;

 private:
  struct Mesh;
  explicit Containment(std::unique_ptr<const Mesh> mesh);

  std::unique_ptr<const Mesh> mesh_;
};

}  // namespace chronormal

#endif  // CHRONORMAL_ANALYSIS_CONTAINMENT_H_
