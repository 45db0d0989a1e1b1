/// Measures what viewers render with a candidate, over the poses of a file. All decisions of a bake rest on this judge.
/// Private to workflow.
///
///     error    the angle between the rendered normal and the right one, both as the viewer carries them by the skin of
///              the pose
///     tear     the angle by which errors jump between neighbours (surface_edges.h)
///
/// The right normals of all poses are computed once, and so are the normals that viewers render of the file as it is.
///
/// Shapes     n = number of a vertex in the list of those that are judged
/// Units      degrees
/// Threads    on all cores, one measurement after the other; the same bits on any number of them.
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
/// it.
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

/// The errors in every kind of poses.
using ErrorsOfKinds = std::array<JudgedErrors, kPoseKinds>;

/// Adds up the errors over all kinds.
[[nodiscard]] JudgedErrors errors_of_all(const ErrorsOfKinds& kinds);

class Judge {
 public:
  /// The part that is measured.
  enum class Depth {
    kGlance,   ///< the named viewers, without tears, in about an eighth of the poses that decide (decides())
    kRounded,  ///< the viewers that compressors round for, with this rounding, in about an eighth of the poses
    kAll       ///< all viewers in all poses
  };

  /// The first `named` viewers are those that the bake is made for. All arguments must outlive this.
  Judge(const DeltaSource& source, const RightNormals& rights, const MeshWeights& weights,
        std::span<const Viewer> viewers, std::size_t named, bool animations_only);

  /// Returns the vertices that are judged, ascending.
  [[nodiscard]] std::span<const std::uint32_t> vertices() const noexcept { return vertices_; }
  [[nodiscard]] std::span<const Viewer> viewers() const noexcept { return viewers_; }

  /// Returns true if errors in poses of this kind decide. Poses that the file plays decide, and if the file has no
  /// animation, all poses do.
  [[nodiscard]] bool decides(PoseKind kind) const noexcept { return kind == PoseKind::kFile || !weights_.is_driven; }

  /// Measures what each viewer renders, in each kind of poses. There are no errors of viewers and poses that the depth
  /// leaves out.
  [[nodiscard]] std::vector<ErrorsOfKinds> measure(const Candidate& candidate, Depth depth) const;
  /// Returns the largest error of each vertex over some poses, in a viewer that adds up deltas as stored.
  [[nodiscard]] std::vector<float> worst(const VertexColumns& columns, const PoseList& poses) const;

 private:
  // A set of poses, and the right normals in these poses.
  struct KnownSet {
    PoseSet set;
    std::vector<std::uint32_t> numbers;  // the vertices that it judges
    std::vector<SurfaceEdge> edges;      // by indices into `numbers`; the second may be beyond its end
    std::vector<float> right;            // (vertices, 3, poses): unit vectors, or (0, 0, 0) if none is known
  };

  // The differences between rendered and right unit normals, for the vertices of a set.
  struct Differences {
    std::vector<float> planes;   // (vertices, 3, poses)
    std::vector<float> largest;  // (vertices), the largest length of a difference
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
  std::vector<std::uint32_t> vertices_;
  std::vector<KnownSet> sets_;
  mutable Differences differences_;  // memory of the last measurement, which the next one writes over
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_JUDGE_H_
