/// Measures what viewers render with a candidate, over the poses of a file. All decisions of a bake rest on these
/// measurements. Private to workflow.
///
///     error    the angle between the rendered and the right normal, after the skin of the pose has transformed both as
///              the viewer does
///     tear     the angle by which errors of neighbouring vertices differ (surface_edges.h)
///
/// The right normals of all poses are computed once. The normals that viewers render of the file before the bake are
/// computed once as well.
///
/// Units      degrees
/// Threads    Uses all cores for one measurement after the other. The results have the same bits on any number of
///            cores.
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

/// The angle in degrees by which an error may always grow, because rounding to float32 and float16 may turn a normal by
/// this angle.
inline constexpr double kHarmless = 0.02;

/// The errors of one viewer in poses of one kind.
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

/// The errors of one viewer, separately for each kind of poses.
using ErrorsOfKinds = std::array<JudgedErrors, kPoseKinds>;

/// Returns the errors over the poses of all kinds together.
[[nodiscard]] JudgedErrors errors_of_all(const ErrorsOfKinds& kinds);

class Judge {
 public:
  /// The depth of a measurement: the viewers and the poses that are included.
  enum class Depth {
    kGlance,   ///< the named viewers, without tears, in about an eighth of the poses that decide (decides())
    kRounded,  ///< the viewers with NormalRule::kClamped, rounded as by compressors, in about an eighth of the poses
    kAll       ///< all viewers in all poses
  };

  /// Creates a judge. The first `named` viewers are the viewers for which the bake is made. All arguments must outlive
  /// the judge.
  Judge(const DeltaSource& source, const RightNormals& rights, const MeshWeights& weights,
        std::span<const Viewer> viewers, std::size_t named, bool animations_only);

  /// Returns the vertices that are judged, in ascending order.
  [[nodiscard]] std::span<const std::uint32_t> vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::span<const Viewer> viewers() const noexcept { return viewers_; }

  /// Returns true if errors in poses of this kind decide which candidate is chosen. Poses that the file plays always
  /// decide. If the file has no animation, all poses decide.
  [[nodiscard]] bool decides(PoseKind kind) const noexcept { return kind == PoseKind::kFile || !weights_.is_driven; }

  /// Measures what each viewer renders in each kind of poses. Viewers and poses that `depth` does not include have no
  /// errors in the result.
  [[nodiscard]] std::vector<ErrorsOfKinds> measure(const Candidate& candidate, Depth depth) const;
  /// Returns the largest error of each judged vertex in the given poses, in degrees, for a viewer that adds up deltas
  /// as stored.
  [[nodiscard]] std::vector<float> worst(const VertexColumns& columns, const PoseList& poses) const;

 private:
  // A set of poses, and the right normals in these poses.
  struct KnownSet {
    PoseSet set;
    std::vector<std::uint32_t> numbers;  // the vertices that are judged in this set
    std::vector<SurfaceEdge> edges;      // ends as indices into `numbers`; beyond the end if a vertex is not judged
    std::vector<float> right;  // (vertices, 3, poses); unit vectors, or (0, 0, 0) if the right normal is not known
  };

  // The differences between rendered and right unit normals, for all vertices of a set in all its poses.
  struct Differences {
    std::vector<float> planes;   // (vertices, 3, poses), the differences as planes of x, y and z
    std::vector<float> largest;  // (vertices), the length of the largest difference of each vertex
    std::size_t poses = 0;
  };

  [[nodiscard]] VertexColumns kept_columns(const Viewer& viewer, VertexColumns columns) const;
  [[nodiscard]] JudgedErrors errors_of(const KnownSet& known, const Viewer& viewer, const VertexColumns& columns,
                                       std::span<const SeenPose> poses, Depth depth) const;
  [[nodiscard]] TearCounts tears_of(const KnownSet& known, const Differences& differences) const;

  const RightNormals& rights_;
  const MeshWeights& weights_;
  std::span<const Viewer> viewers_;
  std::size_t named_;
  bool are_sliders_driven_;  // true if a program may drive correction targets although animations do so, too
  std::vector<std::uint32_t> vertices_;
  std::vector<KnownSet> sets_;
  mutable Differences differences_;  // kept, so that each measurement uses the same memory
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_JUDGE_H_
