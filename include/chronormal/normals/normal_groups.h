/// Finds the corners of faces that share one normal, and the control normals of such groups of corners.
///
/// The normal of a vertex is a sum over the faces around it; the normal of a corner is a sum over those faces around it
/// that smooth edges join. Both are a partition of the corners into *elements*; each element has one normal. Two
/// triangles 0 1 2 and 2 1 3 with a hard edge between them, and a vertex 4 without faces:
///
///     corner    0  1  2  3  4  5            of face 0, and of face 1
///     vertex    0  1  2  2  1  3
///     vertices: elements {0} {1 4} {2 3} {5} {}       one for each vertex, 4 has none of the corners
///     corners:  elements {0} {1} {2} {3} {4} {5}      with a smooth edge {0} {1 4} {2 3} {5}
///
/// An *output* is what a file or a renderer wants a normal for: a vertex, or a corner. Several outputs may show the
/// same element: copies of a vertex that are one point of the surface, corners across a smooth edge. Their normals are
/// then the same to the last bit.
///
/// Files cut a surface at seams of texture and at hard edges: there, two or more vertices lie at one *point*. Where
/// they lie at one point in every keyframe, they are one point of the surface that deforms, and a seam must not show:
///
///     vertex            0  1  2  3  4        1 and 3 coincide in all keyframes, 2 and 4 in the first one only
///     point_of_vertex   0  1  2  1  3
///
/// Two sides  If all faces at a point lie back to back, the corners of the two sides share no normal, since one is the
///            opposite of the other. (A vertex that has corners of both, and one normal, keeps a sum of zero.)
/// Sums       The length of a face normal is twice the area of the face, so the area-weighted normal of an element is
///            the plain sum of the n(t) of its faces: a sum of quadratics, hence a quadratic, exact at every t. The
///            control normals are added once; after that vertices and corners are elements like any other, for
///            NormalCurves and for every scheme that takes control normals, and nobody looks at the connectivity again.
///            No other weighting has this property (normals/weighting.h).
/// Order      The corners of an element are listed in an order that follows from the vertices of their faces and not
///            from the order of the faces in the mesh. Sums in this order have the same bits however the faces are
///            shuffled, and on any number of threads. (The order of the corners within a face does matter, in the last
///            bits.)
/// Polygons   A face that has two corners at one point counts with both.
/// Degenerate An element without corners, or whose faces all have no area, has zero control normals; its unit normal is
///            (0, 0, 0), which NormalCurves counts. A face without area adds nothing; a duplicate face adds its normal
///            twice, and two faces of opposite orientation cancel.
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

/// Tells which vertices are one point of the surface. Points are numbered in the order of their first vertices.
struct Points {
  std::vector<std::uint32_t> point_of_vertex;
  std::size_t count = 0;
};

/// Makes every vertex a point of its own.
[[nodiscard]] Points separate_points(std::size_t vertex_count);

/// Makes one point of the vertices of one body (motion/motion.h) whose coordinates are equal in all keyframes. Equal
/// means equal float32, to the last bit, but -0 equals 0: there is no tolerance, since vertices that are merely close
/// may belong to two sides of a slit. If two sheets lie back to back, so that each face of one has the points of a face
/// of the other the other way round, the vertices of each sheet are points of their own. O(V log V + F), and the number
/// of keyframes times as much if vertices coincide. The motion must be valid.
[[nodiscard]] Points weld_coincident(const Motion& motion);
/// Does the same for a stream, whose keyframes are read until no two vertices coincide. Errors: those of the stream.
[[nodiscard]] Result<Points> weld_coincident(MotionStream& stream);

/// Stored normals closer than this are one normal that was rounded twice.
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

  /// Makes an element of each point, with all of its corners. Outputs are vertices; elements are numbered as points.
  /// The points must be of this topology. O(corners log corners), as are all builders unless they say otherwise.
  [[nodiscard]] static NormalGroups of_vertices(const Topology& topology, const Points& points);
  /// Leaves some corners out of the elements of their points. The corners that are left out of a point become an
  /// element of their own, which no vertex shows. left_out has one value for each corner.
  [[nodiscard]] static NormalGroups of_vertices(const Topology& topology, const Points& points,
                                                const std::vector<bool>& left_out);

  /// Outputs are corners. Two corners of a point share a normal if their faces have an edge in common that begins or
  /// ends at this point, and the angle between the two face normals in keyframe 0 is at most the crease angle (and
  /// 1e-6 rad, for the rounding of positions); or if both share it with a third. So smoothness spreads from edge to
  /// edge around a point, across angles that add up, and stops at boundaries: two fans that touch in a point only stay
  /// apart. Edges are between points, whatever their direction. More exactly:
  ///   * between two faces that are wound in opposite ways the angle is taken as it is, near 180 degrees: a hard edge;
  ///   * an edge of 3 to 16 faces is smooth between those pairs of them that satisfy the angle;
  ///     an edge of more is hard;
  ///   * a face without a normal in keyframe 0 counts as 180 degrees from every other.
  /// A crease angle of 180 makes every edge smooth, whatever its faces. Errors: kUsage where it is outside [0, 180].
  [[nodiscard]] static Result<NormalGroups> by_crease_angle(const Motion& motion, const Points& points, double degrees);

  /// Outputs are corners. Two corners of a point share a normal if their faces are in the same smoothing group, whether
  /// they have an edge in common or not; the corners of faces in group 0 share with none. (The statement `s` of OBJ.)
  /// Errors: kInvalidInput where there is not one group for each face.
  [[nodiscard]] static Result<NormalGroups> by_smoothing_group(const Topology& topology, const Points& points,
                                                               std::span<const std::uint32_t> group_of_face);

  /// Outputs are corners. Two corners of a point share a normal if the normals that a file stores for them are within
  /// the tolerance of each other, or both within that of a third. Stored normals need no length of 1; (0, 0, 0) is
  /// within the tolerance of (0, 0, 0) only.
  /// Errors: kInvalidInput where there is not one finite normal for each corner, with the place "corner C"; kUsage for
  /// a tolerance outside [0, 45]. Cost: quadratic in the number of different normals around one point, at the worst.
  [[nodiscard]] static Result<NormalGroups> by_split_normals(const Topology& topology, const Points& points,
                                                             VectorView<const float> normal_of_corner,
                                                             double degrees = kSplitNormalTolerance);

  /// Returns the number of elements, and so of different normals.
  [[nodiscard]] std::size_t size() const noexcept { return offsets_.size() - 1; }
  /// Returns the corners that share the normal of element e, as indices into Topology::corners(); none for an isolated
  /// vertex.
  [[nodiscard]] std::span<const std::uint32_t> corners(std::size_t e) const noexcept { return part(corners_, e); }
  /// Returns the face of each of the element's corners, in their order.
  [[nodiscard]] std::span<const std::uint32_t> faces(std::size_t e) const noexcept { return part(faces_, e); }

  /// Returns the element of each corner.
  [[nodiscard]] std::span<const std::uint32_t> element_of_corner() const noexcept { return element_of_corner_; }
  /// Returns the element of each output: of each vertex, or of each corner.
  [[nodiscard]] std::span<const std::uint32_t> element_of_output() const noexcept {
    return outputs_are_vertices_ ? element_of_vertex_ : element_of_corner_;
  }
  [[nodiscard]] bool outputs_are_vertices() const noexcept { return outputs_are_vertices_; }

  /// Returns the number of elements without a corner: isolated vertices. Their normal is (0, 0, 0).
  [[nodiscard]] std::size_t isolated_count() const noexcept;

  /// Frees what only sums by angle and curves need. From then on corners(e), element_of_corner() and, if outputs are
  /// corners, element_of_output() must not be called, and neither curves nor anything that recomputes normals may be
  /// made for these groups.
  void forget_corners() noexcept;

  /// Copies the normal of each element to every output that shows it.
  /// of_elements must have size() elements, of_outputs as many as element_of_output()
  void copy_to_outputs(VectorView<const float> of_elements, VectorView<float> of_outputs) const noexcept;

 private:
  // Lists the corners of each element. element_of_corner has values below element_count.
  NormalGroups(const Topology& topology, std::vector<std::uint32_t> element_of_corner, std::size_t element_count);

  // Numbers sets of corners, named by any of their members, in the order of their first corners. The corners of the two
  // sides of a sheet come apart.
  [[nodiscard]] static NormalGroups of_corner_sets(const Topology& topology, const Points& points,
                                                   std::vector<std::uint32_t> set_of_corner);

  [[nodiscard]] std::span<const std::uint32_t> part(const std::vector<std::uint32_t>& values,
                                                    std::size_t e) const noexcept {
    assert(e < size());
    return {values.data() + offsets_[e], values.data() + offsets_[e + 1]};
  }

  std::vector<std::uint32_t> offsets_ = {0};      // where the corners of each element begin, and the end
  std::vector<std::uint32_t> corners_;            // element after element
  std::vector<std::uint32_t> faces_;              // of these corners
  std::vector<std::uint32_t> element_of_corner_;  // the inverse
  std::vector<std::uint32_t> element_of_vertex_;  // where outputs are vertices
  bool outputs_are_vertices_ = false;
  std::shared_ptr<RingsOfGroups> rings_;  // of these corners, and so shared with copies; nothing: no elements
  friend const Rings& internal::rings_around(const Topology& topology, const NormalGroups& groups);
};

/// Writes the control normals of a range of elements as sums of the given ones: nine additions per corner. A component
/// of a sum that is smaller than the rounding error of its own terms is written as exactly zero. Errors of the face
/// normals themselves remain, however far they cancel. Pure: no allocation, no throw.
/// of_faces must have the control normals of all faces, result as many elements as the range
void group_control_normals(const NormalGroups& groups, std::span<const ControlNormals> of_faces, IndexRange elements,
                           std::span<ControlNormals> result) noexcept;

/// Writes the control normals of a range of elements of a segment from the control normals of its faces, within 2^-24
/// of their lengths of the exact ones. Where faces cancel, so that the rounding of double could be more, integers
/// compute them. Pure.
void group_control_normals(const Segment& segment, const NormalGroups& groups, std::span<const ControlNormals> of_faces,
                           IndexRange elements, std::span<ControlNormals> result) noexcept;

/// Returns the control normals of all faces of a segment, or of all elements, as precisely. Runs on all cores.
[[nodiscard]] std::vector<ControlNormals> all_face_control_normals(const Segment& segment);
[[nodiscard]] std::vector<ControlNormals> all_group_control_normals(const Segment& segment, const NormalGroups& groups);

// Selects what has a normal: each face, each vertex, or each corner of a face; and who shares one.
//
// Threads    everything here is pure.

enum class ElementKind { kFaces, kVertices, kCorners };

/// Returns "faces", "vertices" or "corners".
[[nodiscard]] std::string_view element_kind_name(ElementKind kind) noexcept;

/// Returns "face", "vertex" or "corner".
[[nodiscard]] std::string_view one_element(ElementKind kind) noexcept;

/// Finds a kind by its name. Errors: kUsage, with all names.
[[nodiscard]] Result<ElementKind> make_element_kind(std::string_view name);

/// Selects the normals. Corners share theirs across smooth edges; the hard edges come from one of three sources: the
/// crease angle, or else what a file says (Input in io/input.h), which the caller keeps alive.
struct ElementOptions {
  ElementKind kind = ElementKind::kFaces;
  bool weld = true;           ///< vertices at one point in all keyframes are one, so that seams do not show
  double crease_angle = 180;  ///< degrees; corners: edges that are sharper in keyframe 0 are hard
  std::span<const std::uint32_t> group_of_face = {};  ///< smoothing groups, where not empty
  VectorView<const float> normal_of_corner = {};      ///< split normals, where not empty
};

/// Makes the groups of corners that vertices or corners of a motion stand for. Errors: kUsage for a crease angle
/// outside [0, 180]; kInvalidInput if there is not one smoothing group for each face, or one finite normal for each
/// corner. The motion may stand still: a keyframe without segments. Preconditions: the motion is otherwise valid; the
/// kind is not kFaces
[[nodiscard]] Result<NormalGroups> make_groups(const Motion& motion, const ElementOptions& options);
/// Makes the groups for a stream, of which it reads keyframes as weld_coincident() does. Errors: also those of the
/// stream.
[[nodiscard]] Result<NormalGroups> make_groups(MotionStream& stream, const ElementOptions& options);

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_NORMAL_GROUPS_H_
