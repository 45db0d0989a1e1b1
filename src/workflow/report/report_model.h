/// The data of a report before they become bytes: the parts, their motions and the worst places, in the form of
/// docs/formats.md. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_REPORT_REPORT_MODEL_H_
#define CHRONORMAL_WORKFLOW_REPORT_REPORT_MODEL_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/normals/weighting.h"
#include "chronormal/workflow/audit.h"
#include "chronormal/workflow/viewers.h"
#include "workflow/report/report.h"

namespace chronormal::inline internal {

inline constexpr std::uint32_t kNoReportElement = static_cast<std::uint32_t>(-1);

/// Vectors of some vertices, in ascending order of the vertices, or of all vertices if is_dense is true.
struct ModelVectors {
  bool is_dense = false;
  std::vector<std::uint32_t> vertices;  ///< the vertices that have a vector; empty if is_dense is true
  std::vector<float> values;            ///< (n, 3), the vectors

  [[nodiscard]] std::size_t size() const noexcept { return values.size() / 3; }
  [[nodiscard]] std::uint32_t vertex(std::size_t i) const noexcept {
    return is_dense ? static_cast<std::uint32_t>(i) : vertices[i];
  }
  /// Drops the list of vertices if every vertex of the mesh has a vector.
  void drop_vertices_of(std::size_t vertex_count) {
    is_dense = vertex_count > 0 && vertices.size() == vertex_count;
    if (is_dense) vertices.clear();
  }
};

/// The normals and deltas of a glTF mesh as some viewers store them.
struct ModelShown {
  std::vector<std::string> viewers;
  bool keeps_halves = false;
  double least_weight = 0;
  std::vector<float> normals;         ///< (V, 3) the base normals
  std::vector<ModelVectors> targets;  ///< deltas of each target
};

/// The author's offset of an element: how the author's normal differs from the sum of face normals. The offset is
/// measured in a frame that moves with the surface (truth/offset_frame.h).
struct ModelOffset {
  std::uint32_t element = 0;
  /// True if the stored normal points to the side of the surface opposite to the sum of face normals.
  bool is_other_side = false;
  std::vector<std::uint32_t> edges;            ///< (n, 2) vertices: each edge leads from the element to a neighbour
  std::uint32_t reference = kNoReportElement;  ///< the edge from which azimuths are measured
  /// The directions z and x of the frame in the base (truth/offset_frame.h). Only used if there is no reference edge.
  std::array<double, 6> turned = {};
  std::array<float, 2> base = {};
};

/// The data for the true normals of a glTF mesh, if the true normals are more than sums over its triangles
/// (truth/author_truth.h).
struct ModelTruth {
  /// The changes of the author's offsets that a target makes at weight 1. Each change has the index of an offset in the
  /// list of offsets, and two coordinates in the frame of this offset (truth/offset_frame.h).
  struct Changes {
    std::vector<std::uint32_t> offsets;
    std::vector<float> values;  ///< (n, 2), the changes of these offsets
  };

  /// The corners of the polygons whose normals are added up, and the first corner of each polygon. Both lists are empty
  /// if triangles are added up.
  std::vector<std::uint32_t> first, corners;
  /// Pairs of a corner of a polygon and the element that adds up this corner, in ascending order of corners, (n, 2).
  /// The list is empty if each corner counts for its own vertex.
  std::vector<std::uint32_t> terms;
  std::vector<ModelOffset> offsets;
  std::vector<Changes> changes;  ///< for each target, its changes of offsets; empty if there are no offsets

  [[nodiscard]] bool is_plain() const noexcept { return first.empty() && offsets.empty(); }
};

/// The weights that some viewers play at all samples of a motion, (S, n). Only the n targets whose weight is not always
/// 0 are listed.
struct ModelWeights {
  std::vector<std::string> viewers;
  std::vector<std::uint32_t> targets;  ///< (n) the indices of the targets, in ascending order
  std::vector<float> values;
};

struct ModelMotion {
  AuditSubject subject;  ///< the subject of the audit, without its errors
  std::size_t subject_index = 0;
  std::vector<double> at;               ///< (S) the weight, or the time in seconds
  std::vector<std::uint32_t> segments;  ///< (S) the segment of each sample; empty for glTF
  std::vector<double> t;                ///< (S) the position in the segment, from 0 to 1; empty for glTF
  std::vector<ModelWeights> weights;    ///< the weights for glTF; the first entry is the specification
  std::vector<float> worst, mean;       ///< (S) errors in degrees
  std::vector<double> least;            ///< (E) the length below which an element's normal has no direction
  /// The errors of a scheme, at the samples of a motion. The scheme that the audit judged is not listed.
  struct Scheme {
    std::string name;
    std::vector<float> worst, mean;  ///< (S) errors in degrees
  };
  std::vector<Scheme> schemes;
};

struct ModelPrimitive {
  std::size_t primitive = 0, first = 0, count = 0;
  bool is_flat = false;
};

/// The largest error of a vertex, in degrees, and the motion and the sample in which it occurs.
struct ModelPeak {
  float degrees = 0;
  std::uint32_t motion = 0, sample = 0;
};

struct ModelPart {
  std::string name;
  std::optional<std::size_t> mesh;
  std::vector<ModelPrimitive> primitives;
  /// The number of each vertex in the file, (V). The list is empty if the report numbers vertices as the file does.
  std::vector<std::uint32_t> labels;
  std::vector<std::uint32_t> triangles, faces, coarse;
  std::vector<std::uint32_t> backs;  ///< the corners of triangles whose vertex shows the other side of a sheet
  std::size_t elements = 0;
  std::vector<std::uint32_t> element;  ///< (V) the element of each vertex
  Weighting weighting = Weighting::kArea;
  std::vector<float> positions, normals;  ///< (V, 3); normals are empty if the file has none
  // Members that are only used for glTF files.
  std::vector<std::string> target_names;
  std::vector<ModelVectors> targets;  ///< deltas of positions, for each target
  std::optional<GltfBakeMark> mark;
  std::vector<ModelShown> shown;
  ModelTruth truth;
  // Members that are only used for motions that are not glTF. A keyframe has values instead of deltas. A vertex that a
  // keyframe does not list is as in keyframe 0.
  std::vector<double> times;
  std::vector<std::size_t> keyframe_numbers;
  std::vector<ModelVectors> keyframe_positions, keyframe_normals;
  std::vector<std::uint32_t> segments;  ///< (n, 2) the keyframes at both ends of each segment

  std::vector<ModelMotion> motions;
  std::vector<ModelPeak> peaks;  ///< (V) the largest error of each vertex

  [[nodiscard]] std::size_t vertex_count() const noexcept { return element.size(); }
};

struct ReportModel {
  std::string kind;  ///< "gltf", "sequence" or "targets"
  std::vector<ModelPart> parts;
  std::vector<ReportPlace> worst;
  std::vector<std::string> thinned;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_REPORT_REPORT_MODEL_H_
