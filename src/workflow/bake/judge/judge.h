/// Measures what viewers show of a candidate over the poses of a file: the one judge of a bake. Private to workflow.
///
///     error    the angle between the normal that is shown and the right one, both as the skin of the pose carries them
///              in the viewer
///     tear     the angle by which errors jump between neighbours (surface_edges.h)
///
/// The right normals of all poses are computed once, and so is what viewers show of the file as it is.
///
/// Shapes     n = number of a vertex in the list of those that are judged
/// Units      degrees
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_JUDGE_JUDGE_H_
#define CHRONORMAL_WORKFLOW_BAKE_JUDGE_JUDGE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "chronormal/workflow/viewers.h"
#include "workflow/bake/deltas/candidate.h"
#include "workflow/bake/deltas/right_normals.h"
#include "workflow/bake/deltas/vertex_columns.h"
#include "workflow/bake/judge/error_spread.h"
#include "workflow/bake/poses/pose_sets.h"
#include "workflow/shading/surface_edges.h"

namespace chronormal::inline internal {

/// Degrees by which an error may grow where nothing else is said: rounding to float32 and float16 may turn so much.
inline constexpr double kHarmless = 0.02;

/// The errors that one viewer shows in poses of one kind.
struct JudgedErrors {
  ErrorSpread spread;
  TearCounts tears;
  std::size_t poses = 0;

  void add(const JudgedErrors& other) {
    spread.add(other.spread);
    tears.add(other.tears);
    poses += other.poses;
  }
  [[nodiscard]] ShownErrors errors() const;
};

/// The errors of every kind.
using ErrorsOfKinds = std::array<JudgedErrors, kPoseKinds>;

/// Over all kinds.
[[nodiscard]] JudgedErrors errors_of_all(const ErrorsOfKinds& kinds);

class Judge {
 public:
  /// The poses that a judge looks at: about an eighth of them, or all.
  enum class Depth { kGlance, kAll };

  /// All arguments must outlive this.
  Judge(const DeltaSource& source, const RightNormals& rights, const MeshWeights& weights,
        std::span<const Viewer> viewers, bool animations_only);

  /// The vertices that are judged, ascending.
  [[nodiscard]] std::span<const std::uint32_t> vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::span<const Viewer> viewers() const noexcept { return viewers_; }

  /// Measures what each viewer shows, in all kinds of poses. What compressors round is left out, unless it is asked for.
  [[nodiscard]] std::vector<ErrorsOfKinds> measure(const Candidate& candidate, Depth depth,
                                                   bool with_rounding = false) const;
  /// The largest error of each vertex over some poses, in a viewer that adds up what is stored.
  [[nodiscard]] std::vector<float> worst(const VertexColumns& columns, const PoseList& poses) const;

 private:
  // Poses with what is right there.
  struct KnownSet {
    PoseSet set;
    std::vector<std::uint32_t> numbers;  // of the vertices that it looks at
    std::vector<SurfaceEdge> edges;      // by places in `numbers`; the second may be behind all of these
    std::vector<float> right;            // (vertices, 3, poses): unit vectors, or (0, 0, 0) where none is known
  };

  // The differences between shown and right unit normals, of the vertices of a set.
  struct Differences {
    std::vector<float> planes;   // (vertices, 3, poses)
    std::vector<float> largest;  // (vertices), how long any of them is
    std::size_t poses = 0;
  };

  [[nodiscard]] JudgedErrors errors_of(const KnownSet& known, const Viewer& viewer, const VertexColumns& columns,
                                       std::span<const SeenPose> poses, std::size_t step) const;
  [[nodiscard]] TearCounts tears_of(const KnownSet& known, const Differences& differences) const;

  const RightNormals& rights_;
  const MeshWeights& weights_;
  std::span<const Viewer> viewers_;
  std::vector<std::uint32_t> vertices_;
  std::vector<KnownSet> sets_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_JUDGE_H_
