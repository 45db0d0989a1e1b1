/// The ways in which tools weigh the faces around a vertex, and quadratic curves that replace sums which are not
/// quadratic in time.
///
/// The normal of an element (normals/normal_groups.h) is a sum over its corners: face normal times weight. With the
/// vector area n of the face (length: twice its area), its unit normal u, and the edges e to the next and f to the
/// previous corner,
///
///     name           adds                       used by
///     area           n                          trimesh, PyTorch3D; the default of chronormal
///     angle          angle(e, f) u              3ds Max, MeshLab (Thuermer, Wuethrich 1998)
///     uniform        u                          Gouraud 1971
///     area-angle     angle(e, f) n              Maya, Marvelous Designer
///     max            e x f / (|e|^2 |f|^2)      N. Max 1999, exact on spheres
///     inverse-edges  u / (|e| |f|)              Jin, Lewis, West 2005
///     inverse-roots  u / sqrt(|e| |f|)          Jin, Lewis, West 2005
///
/// Area is the default because it is the only weighting whose sum is a polynomial in time, which three control normals
/// represent exactly. Normals of the other weightings are computed again for each t, or *fitted*. A fit replaces the
/// normals of each element and segment by a quadratic curve that has the weighted direction and the area-weighted
/// length at t = 0, 1/2 and 1. NormalCurves plays these curves like exact normals. The curves are approximations, so
/// each element has a bound of its error.
///
/// Polygons   n and u are those of the polygon's vector area, and the angle is the polygon's own corner angle in [0,
///            pi]; the triangles into which a tool would cut the polygon do not matter. e x f is the cross product at
///            the corner. It points along n in a triangle and in a convex planar polygon, and against n at a reflex
///            corner.
/// Degenerate A face whose n is zero, or only rounding error, adds nothing by any weighting. Neither does a corner at
///            an edge of length 0, except by area and uniform, which do not depend on edges. A duplicate face is added
///            twice. A sum that is only the rounding error of its terms is (0, 0, 0).
/// Bound      The bound of a fit is an angle in radians: at no t in [0, 1] is the angle between the quadratic and the
///            weighted normal larger. The bound is proven in interval arithmetic, by Taylor polynomials of degree 4
///            with remainders over pieces of the segment. The segment is cut into more pieces, up to about 256, until
///            the bound is within twice the largest sampled error, or 1e-9 rad. The bound is pi if nothing could be
///            proven: if a face of the element loses its area inside the segment (the weighted normal jumps there,
///            except by area-angle), if the sum vanishes, or if the error of the quadratic exceeds a right angle.
///            Bounds for angle and area-angle are looser if corners are nearly straight, or edges have nearly no
///            length. NormalCurves adds its own 1e-6 rad. Elements without any area have zero control normals and the
///            bound 0. Elements of a single triangle have its direction, which is exact, and the bound 0.
/// Threads    Everything except the fit is pure. Results have the same bits on every system.
/// Source     Jin, Lewis, West, A comparison of algorithms for vertex normal computation, The Visual Computer 21
///            (2005): uniform, angle, area, max, inverse-edges and inverse-roots.
///            Moore, Interval Analysis (1966), for Taylor coefficients in intervals.
#ifndef CHRONORMAL_NORMALS_WEIGHTING_H_
#define CHRONORMAL_NORMALS_WEIGHTING_H_

#include <array>
#include <span>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"
#include "chronormal/normals/normal_groups.h"

namespace chronormal {

enum class Weighting { kArea, kAngle, kUniform, kAreaAngle, kMax, kInverseEdges, kInverseRoots };

struct WeightingInfo {
  Weighting weighting;
  std::string_view name;     ///< the name on the command line
  std::string_view summary;  ///< a description of one line
};

/// All weightings, with their names and meanings. The first is the default.
inline constexpr std::array<WeightingInfo, 7> kAllWeightings = {{
    {Weighting::kArea, "area", "the area of the face; only this weighting is exact at every time"},
    {Weighting::kAngle, "angle", "the angle of the face at the vertex"},
    {Weighting::kUniform, "uniform", "all faces alike"},
    {Weighting::kAreaAngle, "area-angle", "area times angle"},
    {Weighting::kMax, "max", "the sine of the angle over the product of the lengths of its two edges (Max 1999)"},
    {Weighting::kInverseEdges, "inverse-edges", "one over the product of the lengths of the two edges at the vertex"},
    {Weighting::kInverseRoots, "inverse-roots",
     "one over the square root of the product of the lengths of the two edges at the vertex"},
}};

/// The weightings that tools use for shading. If the weighting of stored normals is unknown, only these weightings are
/// tried.
inline constexpr std::array<WeightingInfo, 5> kWeightings = {kAllWeightings[0], kAllWeightings[1], kAllWeightings[2],
                                                             kAllWeightings[3], kAllWeightings[4]};

[[nodiscard]] std::string_view weighting_name(Weighting weighting) noexcept;

/// Finds a weighting by its name. Errors: kUsage for an unknown name, with all names.
[[nodiscard]] Result<Weighting> make_weighting(std::string_view name);

/// Writes n of a range of faces at t: twice the vector area, with an error of at most 2^-30 of its length. n is exactly
/// (0, 0, 0) if the vector area is zero. (control_normals.h explains t outside of [0, 1].) Precondition: result has as
/// many elements as the range.
void face_normals_at(const Segment& segment, const LocalTime& t, IndexRange faces, std::span<Vec3d> result) noexcept;

/// Writes the weighted normals of a range of elements at t, not scaled to length 1. The terms of a sum are added in the
/// order of NormalGroups, so shuffling the faces of the mesh gives the same bits. Pure: no allocation, no throw.
/// Preconditions: of_faces has the result of face_normals_at() for all faces at this t, and result has as many elements
/// as the range.
void weighted_normals_at(const Segment& segment, const NormalGroups& groups, Weighting weighting, const LocalTime& t,
                         std::span<const Vec3d> of_faces, IndexRange elements, std::span<Vec3d> result) noexcept;

/// Returns the weighted normals of all elements at t, not scaled to length 1. Runs on all cores.
[[nodiscard]] std::vector<Vec3d> all_weighted_normals_at(const Segment& segment, const NormalGroups& groups,
                                                         Weighting weighting, const LocalTime& t);

struct WeightingFit {
  std::vector<ControlNormals> normals;  ///< the control normals of the fits, one for each element
  /// Bounds of the errors of the fits in radians, in [0, pi], one for each element.
  std::vector<double> bounds;
};

/// Fits the normals of all elements of a segment. For area the control normals are those of
/// all_group_control_normals(), and the bounds are 0. Runs on all cores, and takes about 0.1 ms per element with little
/// motion, and up to 1.5 ms with strong motion. The bits are the same for every number of threads.
[[nodiscard]] WeightingFit fit_weighting(const Segment& segment, const NormalGroups& groups, Weighting weighting);

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_WEIGHTING_H_
