/// A report before it becomes bytes: the parts, their motions and the worst places, as in docs/formats.md. Private to
/// workflow.
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

/// Vectors of some vertices, in ascending order, or of all vertices if dense.
struct ModelVectors {
  bool is_dense = false;
  std::vector<std::uint32_t> vertices;  ///< empty if dense
  std::vector<float> values;            ///< (n, 3)

  [[nodiscard]] std::size_t size() const noexcept { return values.size() / 3; }
  [[nodiscard]] std::uint32_t vertex(std::size_t i) const noexcept {
    return is_dense ? static_cast<std::uint32_t>(i) : vertices[i];
  }
  /// Makes the vectors dense if every vertex of the mesh has a vector.
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
  std::vector<float> normals;         ///< (V, 3)
  std::vector<ModelVectors> targets;  ///< deltas
};

/// The author's offset from the sum of an element, in a frame that the surface carries (truth/offset_frame.h).
struct ModelOffset {
  std::uint32_t element = 0;
  bool is_other_side = false;                  ///< the author shows the other side of the sum
  std::vector<std::uint32_t> edges;            ///< (n, 2) vertices: from the element to its neighbours
  std::uint32_t reference = kNoReportElement;  ///< the edge from which azimuths are measured
  std::array<double, 6> turned = {};           ///< without a reference: z and x of the base
  std::array<float, 2> base = {};
};

/// The true normals of a glTF mesh if they are more than sums over its triangles (truth/author_truth.h).
struct ModelTruth {
  /// The changes of offsets by a target at weight 1: indices into the list of offsets, and a vector for each.
  struct Changes {
    std::vector<std::uint32_t> offsets;
    std::vector<float> values;  ///< (n, 2)
  };

  std::vector<std::uint32_t> first, corners;  ///< corners of polygons; empty if triangles are added up
  /// (n, 2): pairs of a corner of a polygon, ascending, and the element that adds it up. Empty if each corner counts
  /// for its own vertex.
  std::vector<std::uint32_t> terms;
  std::vector<ModelOffset> offsets;
  std::vector<Changes> changes;  ///< changes of each target; empty without offsets

  [[nodiscard]] bool is_plain() const noexcept { return first.empty() && offsets.empty(); }
};

/// Weights at all samples as some viewers play them, (S, n), for the targets whose weight is not always 0.
struct ModelWeights {
  std::vector<std::string> viewers;
  std::vector<std::uint32_t> targets;  ///< (n), ascending
  std::vector<float> values;
};

struct ModelMotion {
  AuditSubject subject;  ///< errors not filled in
  std::size_t subject_index = 0;
  std::vector<double> at;               ///< (S)
  std::vector<std::uint32_t> segments;  ///< (S) for motions that are not glTF
  std::vector<double> t;                ///< (S) for motions that are not glTF
  std::vector<ModelWeights> weights;    ///< glTF; the first is the specification
  std::vector<float> worst, mean;       ///< (S) degrees
  std::vector<double> least;            ///< (E) the length below which a normal has no direction
  /// The errors of a scheme other than the one that the audit judged.
  struct Scheme {
    std::string name;
    std::vector<float> worst, mean;  ///< (S)
  };
  std::vector<Scheme> schemes;
};

struct ModelPrimitive {
  std::size_t primitive = 0, first = 0, count = 0;
  bool is_flat = false;
};

/// The largest error of a vertex, and its moment.
struct ModelPeak {
  float degrees = 0;
  std::uint32_t motion = 0, sample = 0;
};

struct ModelPart {
  std::string name;
  std::optional<std::size_t> mesh;
  std::vector<ModelPrimitive> primitives;
  std::vector<std::uint32_t> labels;  ///< (V) number of each vertex in the file; empty if the numbers are the same
  std::vector<std::uint32_t> triangles, faces, coarse;
  std::vector<std::uint32_t> backs;  ///< corners of triangles whose vertex shows the other side of a sheet
  std::size_t elements = 0;
  std::vector<std::uint32_t> element;  ///< (V)
  Weighting weighting = Weighting::kArea;
  std::vector<float> positions, normals;  ///< (V, 3); normals may be empty
  // Members for glTF files.
  std::vector<std::string> target_names;
  std::vector<ModelVectors> targets;  ///< deltas of positions
  std::optional<GltfBakeMark> mark;
  std::vector<ModelShown> shown;
  ModelTruth truth;
  // The next members are for motions that are not glTF. Each keyframe has values, not deltas; vertices that are left
  // out are as in keyframe 0.
  std::vector<double> times;
  std::vector<std::size_t> keyframe_numbers;
  std::vector<ModelVectors> keyframe_positions, keyframe_normals;
  std::vector<std::uint32_t> segments;  ///< (n, 2) keyframes at both ends

  std::vector<ModelMotion> motions;
  std::vector<ModelPeak> peaks;  ///< (V)

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
