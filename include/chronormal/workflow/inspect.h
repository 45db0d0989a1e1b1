/// Inspects a motion: what it holds, and what in it will trouble a program that needs its normals. Inspects what a glTF
/// file holds beside its motion: the normals that it stores, which of them follow the targets, and tracks of weights.
///
/// Counts of faces over keyframes or segments come as Places: how many (face, keyframe) pairs there are, how many
/// different faces take part, and the first pair, by keyframe or segment and then by face.
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

/// Counts faces at keyframes or in segments.
struct Places {
  std::size_t pairs = 0;
  std::size_t faces = 0;
  std::size_t first_at = 0;    ///< the keyframe or segment of the first pair
  std::size_t first_face = 0;  ///< its face
  double first_t = 0;          ///< where in the segment, for what has an instant there
};

/// The largest value of something, and the first place where it is.
struct Largest {
  double value = 0;
  std::size_t segment = 0, element = 0;  ///< element: a vertex or a face
};

/// One segment: for a star of targets, one target.
struct SegmentInspection {
  std::size_t moved_vertices = 0;
  Largest motion;                   ///< the longest way of a vertex
  Largest turn;                     ///< the angle between the normals of a face at both ends
  std::size_t turned_far = 0;       ///< faces of which that is more than 90 degrees
  std::size_t collapses = 0;        ///< faces that have no area at an instant inside, or nearly none
  std::size_t vanishing = 0;        ///< faces among these that lose it exactly, and not nearly
  std::size_t turned_over = 0;      ///< faces among these that come out of it with the opposite normal
  std::size_t without_normals = 0;  ///< faces that have no area throughout
  std::size_t flagged = 0;          ///< faces that are evaluated in double (NormalCurves)
  std::size_t bytes = 0;            ///< of its NormalCurves
};

struct Inspection {
  std::size_t vertices = 0, faces = 0, keyframes = 0;
  double first_time = 0, last_time = 0;  ///< of keyframes
  Vec3d low, high;                       ///< bounding box over all keyframes
  double diagonal = 0;                   ///< of that box
  Largest motion, turn;                  ///< over all segments
  Found doubled;                         ///< vertices that are at the place of a lower one in all keyframes
  Found doubled_at_start;                ///< in keyframe 0; never fewer
  Surface surface;
  Found cut;  ///< faces that a fan around the first corner does not cover in keyframe 0, so that ears are cut off
  std::vector<SegmentInspection> segments;

  Places no_area;           ///< keyframes: no area at all
  Places slivers;           ///< keyframes: see inspect()
  Places collapses;         ///< segments: the normal vanishes inside, or falls below 1e-6 of its control normals
  Places vanishing;         ///< segments: the normal is zero inside, exactly (analysis/signs.h)
  Places turned_over;       ///< segments: those of which the normal is opposed afterwards
  Places turned_far;        ///< segments: the normals at both ends are more than 90 degrees apart
  Places without_normals;   ///< segments: no area throughout, so there is no direction to give
  std::size_t flagged = 0;  ///< (face, segment) pairs that are evaluated in double

  std::size_t keyframe_bytes = 0;  ///< positions of all keyframes
  std::size_t normal_bytes = 0;    ///< NormalCurves of all segments at once
};

/// Inspects a motion, or a mesh: a motion of one keyframe and no segment. progress(done, total), if given, is called
/// from the calling thread.
///
/// A face is a sliver at a keyframe where it has an area, but so small a one that it may be nothing but the rounding of
/// the positions to float32: where moving them by half a unit in the last place could turn its normal any way. So that,
/// and the boxes, are of float32 positions; everything else counts the residuals of a computed motion.
///
/// Threads    uses all (core/parallel.h); the result is the same on any number of them.
/// Memory     some 100 bytes a face, for the edges between faces; nothing grows with faces x segments.
/// Cost       control normals of every segment, once, and a look at what its NormalCurves would take, which are not
///            made; the rest is near linear.
/// Precondition: the motion is valid (validate() in motion/motion.h), but that it may have no segment
[[nodiscard]] Inspection inspect(const Motion& motion,
                                 const std::function<void(std::size_t done, std::size_t total)>& progress = {});
/// Inspects a stream, of which two keyframes are held, or for small meshes as many as keep all threads busy. Errors:
/// those of the stream.
[[nodiscard]] Result<Inspection> inspect(MotionStream& stream,
                                         const std::function<void(std::size_t done, std::size_t total)>& progress = {});

/// One primitive that has faces; what is not here is in GltfPrimitive.
struct GltfPrimitiveInspection {
  std::size_t mesh = 0, primitive = 0;
  std::size_t triangles = 0;
  std::size_t off_length = 0;  ///< stored normals that are not of length 1, to the rounding of 8-bit integers
  /// Vertices at the place of a lower one in the base, and the number of them with another normal than the lowest one
  /// there (by more than kSplitNormalTolerance of normals/normal_groups.h).
  std::size_t doubled = 0, split = 0;
  /// Targets that move positions, and the numbers of them that move normals and tangents too.
  std::size_t moving = 0, moving_normals = 0, moving_tangents = 0;
};

/// One track of weights.
struct GltfTrackInspection {
  std::size_t animation = 0, track = 0;
  double first_time = 0, last_time = 0;
  double lowest = 0, highest = 0;  ///< of the weights, between the keys too
};

struct GltfInspection {
  std::vector<GltfPrimitiveInspection> primitives;
  std::vector<GltfTrackInspection> tracks;
  std::vector<std::size_t> instances;  ///< per mesh: how many nodes have it
  std::size_t skinned_nodes = 0;       ///< nodes with a skin that have a mesh
  std::size_t without_faces = 0;       ///< primitives of points or lines, or without positions
};

/// Reads all geometry and all weight tracks, one after the other. Memory: that of the largest primitive, and what the
/// document keeps. Errors: of GltfDocument.
[[nodiscard]] Result<GltfInspection> inspect(const GltfDocument& document);

/// Counts the vertices of a motion that are at the place of a lower one in all keyframes and have another normal stored
/// than the lowest one there that has any: some of Inspection::doubled, across primitives too. (Vertices at one place
/// are of one mesh and one node, so that their normals need no transform.) Memory and errors as of inspect(). The
/// motion must be one of this document, and of these parts.
[[nodiscard]] Result<std::size_t> count_split_normals(const GltfDocument& document, const Motion& motion,
                                                      std::span<const GltfPart> parts);

/// The facts about a glTF file that its motion does not hold.
struct InspectedGltf {
  const GltfDocument* document = nullptr;  ///< of the input
  GltfInspection inspection;
  std::span<const GltfPart> parts;       ///< of the input: where vertices and faces came from
  double curve_error = 0;                ///< as Input has it
  std::size_t split = 0;                 ///< of count_split_normals()
  std::optional<std::size_t> animation;  ///< the one that is looked at; nothing: the targets, or what stands still
};

/// An opened input, and what is known of it.
struct Inspected {
  Input opened;
  std::optional<Inspection> inspection;  ///< nothing for a glTF file without faces
  std::vector<std::string> keyframe_names;
  std::vector<Motion::SegmentKeys> segments;
  MotionKind kind = MotionKind::kSequence;
  std::optional<InspectedGltf> gltf;

  [[nodiscard]] const std::string& name() const noexcept { return opened.name(); }
  /// Returns true if the input has morph targets: segment k goes from keyframe 0 to target k, from weight 0 to 1.
  [[nodiscard]] bool has_targets() const noexcept { return kind == MotionKind::kTargets && !segments.empty(); }
};

/// Inspects an input of any kind, opened with allow_mesh; animation is the one of its options. progress is as for
/// inspect().
/// Errors: those of Input::motion() and GltfDocument.
[[nodiscard]] Result<Inspected> inspect_input(
    Input input, const std::string& animation,
    const std::function<void(std::size_t done, std::size_t total)>& progress = {});

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_INSPECT_H_
