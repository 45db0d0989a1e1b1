/// Finds the corners of faces that share a normal, and computes the control normals of such groups of corners.
///
/// The normal of a vertex is a sum over the faces around the vertex. The normal of a corner is a sum over those faces
/// around its vertex that smooth edges connect to its own face. Either rule divides the corners into *elements*, each
/// with one normal. Two triangles 0 1 2 and 2 1 3 with a hard edge between them, and a vertex 4 without faces:
///
///     corner    0  1  2  3  4  5            of face 0, and of face 1
///     vertex    0  1  2  2  1  3
///     vertices: elements {0} {1 4} {2 3} {5} {}       one for each vertex, 4 has none of the corners
///     corners:  elements {0} {1} {2} {3} {4} {5}      with a smooth edge {0} {1 4} {2 3} {5}
///
/// An *output* is a vertex or a corner for which a file or a renderer needs a normal. Several outputs may belong to the
/// same element: copies of a vertex that are one point of the surface, or corners across a smooth edge. Their normals
/// then have the same bits.
///
/// Files cut a surface at texture seams and at hard edges, where two or more vertices are at one *point*. Vertices that
/// coincide in every keyframe are one point of the deforming surface, so that a seam does not show:
///
///     vertex            0  1  2  3  4        1 and 3 coincide in all keyframes, 2 and 4 in the first one only
///     point_of_vertex   0  1  2  1  3
///
/// Two sides  If all faces at a point are back to back, the corners of the two sides do not share a normal, since the
///            two normals are opposite. (If one normal is for both sides, because they share a vertex, the sum is
///            zero.)
/// Sums       The length of a face normal is twice the area of the face, so the area-weighted normal of an element is
///            the plain sum of the n(t) of its faces: a sum of quadratics, hence a quadratic, exact at every t. The
///            control normals are added once; afterwards vertices and corners are elements like faces, for NormalCurves
///            and for every scheme that uses control normals, and the connectivity is no longer needed. No other
///            weighting has this property (normals/weighting.h).
/// Order      The corners of an element are listed in an order that follows from the vertices of their faces and not
///            from the order of the faces in the mesh. Sums in this order have the same bits however the faces are
///            shuffled, and on any number of threads. (The order of the corners within a face does matter, in the last
///            bits.)
/// Polygons   A face with two corners at one point is added twice.
/// Degenerate An element without corners, or whose faces all have no area, has zero control normals; its unit normal is
///            (0, 0, 0), and NormalCurves counts such elements. A face without area adds nothing, a duplicate face is
///            added twice, and two faces of opposite orientation cancel.
/// Threads    const functions may run at the same time.
#ifndef CHRONORMAL_NORMALS_NORMAL_GROUPS_H_
#define CHRONORMAL_NORMALS_NORMAL_GROUPS_H_

#include <cassert>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/control_normals.h"

namespace chronormal {

/// The partition of vertices into points of the surface. Points are numbered in the order of their first vertices.
struct Points {
  std::vector<std::uint32_t> point_of_vertex;
  std::size_t count = 0;
};

/// Makes every vertex a point of its own.
[[nodiscard]] Points separate_points(std::size_t vertex_count);

/// Makes one point of the vertices of one body (motion/motion.h) whose coordinates are equal in all keyframes.
/// Coordinates must be exactly equal as float32 (-0 equals 0): there is no tolerance, since vertices that are merely
/// close may belong to two sides of a slit. If two sheets are back to back, so that each face of one sheet has the
/// points of a face of the other in reversed order, the sheets do not share points. O(V log V + F), times the number of
/// keyframes if vertices coincide. The motion must be valid.
[[nodiscard]] Points weld_coincident(const Motion& motion);
/// Makes one point of the vertices whose coordinates are equal in all keyframes of a stream. Keyframes are read only
/// until no two vertices coincide in all of them. Errors: those of the stream.
[[nodiscard]] Result<Points> weld_coincident(MotionStream& stream);

/// The largest angle in degrees between two stored normals that count as roundings of the same normal.
inline constexpr double kSplitNormalTolerance = 0.1;  // degrees

class NormalGroups;

inline namespace internal {
class Rings;
struct RingsOfGroups;
const Rings& rings_around(const Topology& topology, const NormalGroups& groups);
}  // namespace internal

class NormalGroups {
 public:
  NormalGroups() = default;

  /// Makes one element of each point, with all corners at this point. Outputs are vertices; an element has the number
  /// of its point. Precondition: the points belong to this topology. Takes O(corners log corners), as do all functions
  /// below that state no other cost.
  [[nodiscard]] static NormalGroups of_vertices(const Topology& topology, const Points& points);
  /// Makes one element of each point, with all corners at this point except those that are left out. All left-out
  /// corners of a point become a separate element, to which no vertex belongs. `left_out` has a value for each corner,
  /// which is true to leave the corner out.
  [[nodiscard]] static NormalGroups of_vertices(const Topology& topology, const Points& points,
                                                const std::vector<bool>& left_out);

  /// Makes elements by a crease angle; outputs are corners. Two corners of a point share a normal if their faces have a
  /// common edge at this point, and the angle between the two face normals in keyframe 0 is at most the crease angle
  /// (plus 1e-6 rad, for the rounding of positions). Two corners also share a normal if both share a normal with a
  /// third corner. So smoothness spreads from edge to edge around a point, even if angles add up, and stops at
  /// boundaries: two fans that only touch in a point stay separate. Edges are between points, in either direction. More
  /// exactly:
  ///   * two faces with opposite windings have an angle near 180 degrees, so their edge is hard;
  ///   * an edge of 3 to 16 faces is smooth between those pairs of faces whose angle is small enough; an edge of more
  ///     faces is hard;
  ///   * a face without a normal in keyframe 0 counts as 180 degrees from every other face.
  /// A crease angle of 180 makes every edge smooth. Errors: kUsage for an angle outside of [0, 180].
  [[nodiscard]] static Result<NormalGroups> by_crease_angle(const Motion& motion, const Points& points, double degrees);

  /// Makes elements by smoothing groups (the statement `s` of OBJ); outputs are corners. Two corners of a point share a
  /// normal if their faces are in the same smoothing group, with or without a common edge; corners of faces in group 0
  /// share no normals. Errors: kInvalidInput unless there is one group for each face.
  [[nodiscard]] static Result<NormalGroups> by_smoothing_group(const Topology& topology, const Points& points,
                                                               std::span<const std::uint32_t> group_of_face);

  /// Makes elements by stored normals; outputs are corners. Two corners of a point share a normal if the normals that a
  /// file stores for them are within the tolerance of each other, or both within the tolerance of a third. Stored
  /// normals need not be unit vectors; (0, 0, 0) agrees only with (0, 0, 0). Errors: kInvalidInput, with the place
  /// "corner C", unless there is one finite normal for each corner; kUsage for a tolerance outside of [0, 45]. Cost: in
  /// the worst case quadratic in the number of different normals around a point.
  [[nodiscard]] static Result<NormalGroups> by_split_normals(const Topology& topology, const Points& points,
                                                             VectorView<const float> normal_of_corner,
                                                             double degrees = kSplitNormalTolerance);

  /// Returns the number of elements, which is the number of different normals.
  [[nodiscard]] std::size_t size() const noexcept { return offsets_.size() - 1; }
  /// Returns the corners that share the normal of element e, as indices into Topology::corners(). An isolated vertex
  /// has no corners.
  [[nodiscard]] std::span<const std::uint32_t> corners(std::size_t e) const noexcept { return part(corners_, e); }
  /// Returns the faces to which the element's corners belong, in the order of corners(e).
  [[nodiscard]] std::span<const std::uint32_t> faces(std::size_t e) const noexcept { return part(faces_, e); }

  /// Returns the number of the element to which each corner belongs.
  [[nodiscard]] std::span<const std::uint32_t> element_of_corner() const noexcept { return element_of_corner_; }
  /// Returns the element of each output, where the outputs are either all vertices or all corners.
  [[nodiscard]] std::span<const std::uint32_t> element_of_output() const noexcept {
    return outputs_are_vertices_ ? element_of_vertex_ : element_of_corner_;
  }
  [[nodiscard]] bool outputs_are_vertices() const noexcept { return outputs_are_vertices_; }

  /// Returns the number of elements without corners, which are those of isolated vertices. Their normal is (0, 0, 0).
  [[nodiscard]] std::size_t isolated_count() const noexcept;

  /// Frees the data that only curves, and sums weighted by angle, need. Afterwards corners(e), element_of_corner() and,
  /// if outputs are corners, element_of_output() must not be called. Afterwards no object that computes normals, such
  /// as NormalCurves, may be made for these groups.
  void forget_corners() noexcept;

  /// Copies the normal of each element to all of its outputs. Preconditions: of_elements has size() elements, and
  /// of_outputs has as many as element_of_output().
  void copy_to_outputs(VectorView<const float> of_elements, VectorView<float> of_outputs) const noexcept;

 private:
  // Makes groups from the number of the element of each corner. These numbers must be below element_count.
  NormalGroups(const Topology& topology, std::vector<std::uint32_t> element_of_corner, std::size_t element_count);

  // Makes groups from sets of corners. A set is named by any of its members, and sets are numbered in the order of
  // their first corners. Sets that have corners of both sides of a sheet are split.
  [[nodiscard]] static NormalGroups of_corner_sets(const Topology& topology, const Points& points,
                                                   std::vector<std::uint32_t> set_of_corner);

  [[nodiscard]] std::span<const std::uint32_t> part(const std::vector<std::uint32_t>& values,
                                                    std::size_t e) const noexcept {
    assert(e < size());
    return {values.data() + offsets_[e], values.data() + offsets_[e + 1]};
  }

  std::vector<std::uint32_t> offsets_ = {0};      // index of the first corner of each element, and the end
  std::vector<std::uint32_t> corners_;            // the corners of all elements, one element after the other
  std::vector<std::uint32_t> faces_;              // the face of each of these corners
  std::vector<std::uint32_t> element_of_corner_;  // the element of each corner
  std::vector<std::uint32_t> element_of_vertex_;  // the element of each vertex; empty if outputs are corners
  bool outputs_are_vertices_ = false;
  std::shared_ptr<RingsOfGroups> rings_;  // shared with copies of these groups; nullptr if there are no elements
  friend const Rings& internal::rings_around(const Topology& topology, const NormalGroups& groups);
};

/// Writes the control normals of a range of elements, each as the sum of the control normals of its faces: nine
/// additions per corner. A component of a sum that is smaller than the rounding error of its terms is written as
/// exactly zero. The errors of the given face normals remain in the sums, even if the face normals cancel. Pure: no
/// allocation, no throw. Preconditions: of_faces has the control normals of all faces, and result has as many elements
/// as the range.
void group_control_normals(const NormalGroups& groups, std::span<const ControlNormals> of_faces, IndexRange elements,
                           std::span<ControlNormals> result) noexcept;

/// Writes the control normals of a range of elements of a segment from the control normals of its faces, with errors of
/// at most 2^-24 of their lengths. If faces cancel so far that rounding in double could exceed this bound, integer
/// arithmetic computes the sums. Pure.
void group_control_normals(const Segment& segment, const NormalGroups& groups, std::span<const ControlNormals> of_faces,
                           IndexRange elements, std::span<ControlNormals> result) noexcept;

/// Return the control normals of all faces of a segment, or of all elements of groups, as precise as
/// face_control_normals() or group_control_normals() computes them for a segment. Run on all cores.
[[nodiscard]] std::vector<ControlNormals> all_face_control_normals(const Segment& segment);
[[nodiscard]] std::vector<ControlNormals> all_group_control_normals(const Segment& segment, const NormalGroups& groups);

// The kinds of elements that have a normal (each face, each vertex, or each corner of a face), and the rules by which
// corners share a normal.
//
// Threads: everything here is pure.

enum class ElementKind { kFaces, kVertices, kCorners };

/// Returns the name of a kind in the plural: "faces", "vertices" or "corners".
[[nodiscard]] std::string_view element_kind_name(ElementKind kind) noexcept;

/// Returns the name of a kind in the singular: "face", "vertex" or "corner".
[[nodiscard]] std::string_view one_element(ElementKind kind) noexcept;

/// Finds a kind of element by its name. Errors: kUsage for an unknown name, with all names.
[[nodiscard]] Result<ElementKind> make_element_kind(std::string_view name);

/// The elements for which normals are computed, and the rule by which corners share a normal. Corners share normals
/// across smooth edges. Hard edges come from the crease angle, or from the smoothing groups or the normals of a file
/// (Input in io/input.h). The arrays of groups and normals must outlive the options.
struct ElementOptions {
  ElementKind kind = ElementKind::kVertices;
  /// True if vertices that coincide in all keyframes share a normal, so that seams do not show.
  bool weld = true;
  /// The crease angle in degrees, for corners: an edge is hard if the angle between its faces in keyframe 0 is larger.
  double crease_angle = 180;
  std::span<const std::uint32_t> group_of_face = {};  ///< the smoothing group of each face, or empty
  VectorView<const float> normal_of_corner = {};      ///< the stored normal of each corner, or empty
};

/// Makes the groups of corners for the vertices or the corners of a motion. Errors: kUsage for a crease angle outside
/// [0, 180]; kInvalidInput if there is not one smoothing group for each face, or one finite normal for each corner. The
/// motion may be a mesh at rest, which is a keyframe without segments. Preconditions: the motion is otherwise valid;
/// the kind is not kFaces.
[[nodiscard]] Result<NormalGroups> make_groups(const Motion& motion, const ElementOptions& options);
/// Makes the groups of corners for a stream, whose keyframes are read as by weld_coincident(). Errors: those of
/// make_groups() for a motion, and those of the stream.
[[nodiscard]] Result<NormalGroups> make_groups(MotionStream& stream, const ElementOptions& options);

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_NORMAL_GROUPS_H_
