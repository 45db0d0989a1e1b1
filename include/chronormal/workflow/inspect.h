/// Inspects a motion: its contents, and problems for programs that need its normals. For a glTF file, inspects also the
/// stored normals, the targets that change these normals, and the tracks of weights.
///
/// Faces at keyframes or in segments are counted as Places. A Places has the number of (face, keyframe) combinations,
/// the number of different faces in these, and the first combination, by keyframe or segment and then by face.
///
/// Units      positions as in the file; radians; seconds; bytes.
#ifndef CHRONORMAL_WORKFLOW_INSPECT_H_
#define CHRONORMAL_WORKFLOW_INSPECT_H_

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/analysis/surface.h"
#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/io/input.h"
#include "chronormal/motion/motion.h"

namespace chronormal {

/// Counts of the combinations of a face and a keyframe, or of a face and a segment, that have some property, and the
/// first such combination.
struct Places {
  std::size_t pairs = 0;
  std::size_t faces = 0;
  std::size_t first_at = 0;    ///< the keyframe or segment of the first combination
  std::size_t first_face = 0;  ///< the face of the first combination
  double first_t = 0;          ///< the local t of the first combination, if it happens at an instant
};

/// The largest value of a quantity, and the first place where it occurs.
struct Largest {
  double value = 0;
  std::size_t segment = 0, element = 0;  ///< the number of the segment, and of the vertex or face
};

/// The results of inspecting one segment. For morph targets, a segment is a target.
struct SegmentInspection {
  std::size_t moved_vertices = 0;
  Largest motion;              ///< the longest displacement of a vertex, in units of length of the file
  Largest turn;                ///< the largest angle in radians between the normals of a face at both ends
  std::size_t turned_far = 0;  ///< number of faces whose normals at both ends differ by more than 90 degrees
  /// The number of faces that have no area, or nearly none, at an instant inside the segment.
  std::size_t collapses = 0;
  std::size_t vanishing = 0;        ///< number of the faces in `collapses` that have exactly no area
  std::size_t turned_over = 0;      ///< number of the faces in `collapses` that have the opposite normal afterwards
  std::size_t without_normals = 0;  ///< number of faces without area in the whole segment
  std::size_t flagged = 0;          ///< number of faces that are evaluated in double (NormalCurves)
  std::size_t bytes = 0;            ///< bytes of memory that the NormalCurves of the segment take
};

struct Inspection {
  std::size_t vertices = 0, faces = 0, keyframes = 0;
  double first_time = 0, last_time = 0;  ///< the times of the first and the last keyframe
  Vec3d low, high;                       ///< the corners of the bounding box over all keyframes
  double diagonal = 0;                   ///< the diagonal of the bounding box
  Largest motion, turn;                  ///< the largest values over all segments
  Found doubled;                         ///< vertices that coincide with a vertex of lower number in all keyframes
  /// The vertices that coincide with a vertex of lower number in keyframe 0. There are at least as many as in
  /// `doubled`.
  Found doubled_at_start;
  Surface surface;
  /// The faces that a fan around the first corner does not cover in keyframe 0, so that another triangulation is used.
  Found cut;
  std::vector<SegmentInspection> segments;

  Places no_area;  ///< at keyframes: faces without area
  Places slivers;  ///< at keyframes: faces that are slivers, as inspect() defines them
  /// The faces whose normal vanishes at an instant inside a segment, or becomes shorter there than 1e-6 of its control
  /// normals.
  Places collapses;
  Places vanishing;         ///< in segments: faces whose normal is exactly zero at an instant inside (analysis/signs.h)
  Places turned_over;       ///< in segments: collapsing faces with the opposite normal afterwards
  Places turned_far;        ///< in segments: faces whose normals at both ends are more than 90 degrees apart
  Places without_normals;   ///< in segments: faces without area in the whole segment, which have no normal
  std::size_t flagged = 0;  ///< number of (face, segment) combinations that are evaluated in double

  std::size_t keyframe_bytes = 0;  ///< bytes of memory for the positions of all keyframes
  std::size_t normal_bytes = 0;    ///< bytes of memory for the NormalCurves of all segments at once
};

/// Inspects a motion. A mesh may be given as a motion of one keyframe and no segment. progress(done, total), if given,
/// is called from the calling thread.
///
/// A face is a sliver at a keyframe if its area is not zero, but so small that it may only be the rounding of the
/// positions to float32. Moving its positions by half a unit in the last place could then turn its normal in any
/// direction. Slivers and boxes use float32 positions; everything else uses the residuals of a computed motion.
///
/// Threads    uses all threads (core/parallel.h); the result is the same for any number of threads.
/// Memory     about 100 bytes per face, for the edges between faces; no memory grows with faces x segments.
/// Cost       control normals of every segment, and an estimate of its NormalCurves, which are not built; the rest is
///            nearly linear.
/// Precondition: the motion is valid (validate() in motion/motion.h), except that it may have no segment
[[nodiscard]] Inspection inspect(const Motion& motion,
                                 const std::function<void(std::size_t done, std::size_t total)>& progress = {});
/// Inspects a stream while holding two keyframes, or for small meshes enough keyframes to keep all threads busy.
/// Errors: those of the stream.
[[nodiscard]] Result<Inspection> inspect(MotionStream& stream,
                                         const std::function<void(std::size_t done, std::size_t total)>& progress = {});

/// The inspection of a primitive with faces. Further properties of the primitive are in GltfPrimitive.
struct GltfPrimitiveInspection {
  std::size_t mesh = 0, primitive = 0;
  std::size_t triangles = 0;
  std::size_t off_length = 0;  ///< number of stored normals whose length is not 1 within the rounding of 8-bit integers
  /// `doubled` is the number of vertices that coincide in the base with a vertex of lower number. `split` is the number
  /// of doubled vertices whose normal differs from the normal of the vertex with the lowest number, by more than
  /// kSplitNormalTolerance of normals/normal_groups.h.
  std::size_t doubled = 0, split = 0;
  /// The number of targets that move positions, and the numbers of these targets that also change normals or tangents.
  std::size_t moving = 0, moving_normals = 0, moving_tangents = 0;
};

/// The inspection of a track of weights. Times are in seconds.
struct GltfTrackInspection {
  std::size_t animation = 0, track = 0;
  double first_time = 0, last_time = 0;
  double lowest = 0, highest = 0;  ///< the range of the weights, also between keys
};

struct GltfInspection {
  std::vector<GltfPrimitiveInspection> primitives;
  std::vector<GltfTrackInspection> tracks;
  std::vector<std::size_t> instances;  ///< for each mesh, the number of nodes that show it
  std::size_t skinned_nodes = 0;       ///< number of nodes with a skin and a mesh
  std::size_t without_faces = 0;       ///< number of primitives of points or lines, or without positions
};

/// Inspects a document. Reads all geometry and all weight tracks one after the other. Memory: that of the largest
/// primitive, and data that the document keeps. Errors: those of GltfDocument.
[[nodiscard]] Result<GltfInspection> inspect(const GltfDocument& document);

/// Counts the vertices of a motion that coincide with a vertex of lower number in all keyframes, but have another
/// stored normal. The normal is compared with the normal of the coinciding vertex that has the lowest number among
/// those with a normal. The counted vertices are among those of Inspection::doubled, also across primitives.
/// (Coinciding vertices belong to the same mesh and node, so normals need no transform.) Memory and errors are those of
/// inspect(). Precondition: the motion belongs to this document and these parts.
[[nodiscard]] Result<std::size_t> count_split_normals(const GltfDocument& document, const Motion& motion,
                                                      std::span<const GltfPart> parts);

/// The facts about a glTF file that are not part of its motion.
struct InspectedGltf {
  const GltfDocument* document = nullptr;  ///< the document of the input
  GltfInspection inspection;
  std::span<const GltfPart> parts;  ///< the primitives from which the vertices and faces of the input come
  /// Input::curve_error(): the error of the cut curves, in units of length of the file.
  double curve_error = 0;
  std::size_t split = 0;                 ///< the result of count_split_normals()
  std::optional<std::size_t> animation;  ///< the animation that was inspected; no value for targets or a mesh at rest
};

/// An input, and the results of its inspection.
struct Inspected {
  std::optional<Input> opened;           ///< no value for a motion of the caller
  std::string motion_name;               ///< the name of a motion of the caller
  std::optional<Inspection> inspection;  ///< no value for a glTF file without faces
  std::vector<std::string> keyframe_names;
  std::vector<Motion::SegmentKeys> segments;
  MotionKind kind = MotionKind::kSequence;
  std::optional<InspectedGltf> gltf;

  [[nodiscard]] const std::string& name() const noexcept { return opened ? opened->name() : motion_name; }
  /// Returns true if the input has morph targets. Segment k then goes from keyframe 0 at weight 0 to target k at weight
  /// 1.
  [[nodiscard]] bool has_targets() const noexcept { return kind == MotionKind::kTargets && !segments.empty(); }
};

/// Inspects an input of any kind that was opened with allow_mesh. `animation` is the animation in the options with
/// which it was opened; `progress` is called as by inspect(). Errors: those of Input::motion() and GltfDocument.
[[nodiscard]] Result<Inspected> inspect_input(
    Input input, const std::string& animation,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

/// Inspects a motion, or a mesh at rest, that did not come from a file. `name` is its name in messages.
[[nodiscard]] Inspected inspect_input(const Motion& motion, std::string name);

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_INSPECT_H_
