/// Holds what hosts show after a bake against what they showed before, vertex by vertex. Private to workflow.
///
/// A bake has several forms to choose from for each vertex: the first is what the file stores. Of the forms that are
/// harmless at all vertices of a normal, the one that is nearest to the right normals is taken:
///
///     harmless   in every pose of the file (its animations as hosts play them, its targets alone) and in every named
///                host, error <= max(error of the stored form + 0.02 degrees, tolerance), but for what the rounding of
///                a compressor adds to either; over mixed poses (random ones, cross-fades) neither the mean nor the
///                worst nor that of 99.9 % is above that of the stored form, all vertices together
///
///     error      the angle between what is shown and what is right, both as the skin of the pose carries them in
///                the host
///
/// Shapes     n = number of a vertex in the list of those that are judged; columns = the mesh's own targets, then extra
///            ones.
/// Units      degrees.
/// Threads    on all cores; the same bits on any number of them.
#ifndef CHRONORMAL_WORKFLOW_BAKE_JUDGE_HOST_JUDGE_H_
#define CHRONORMAL_WORKFLOW_BAKE_JUDGE_HOST_JUDGE_H_

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "chronormal/workflow/bake.h"
#include "chronormal/workflow/hosts.h"
#include "workflow/bake/judge/right_normals.h"
#include "workflow/bake/judge/seen_pose.h"
#include "workflow/bake/judge/vertex_columns.h"

namespace chronormal::inline internal {

/// By how much an error may grow where nothing else is said: what the rounding of float32 and of float16 may turn.
inline constexpr double kHarmless = 0.02;

/// The same host without what is too fine to choose by, or a compressor's own: halves, and numbers of so many bits.
/// What is left is what becomes of lengths: they are kept, or made 1, or cut.
[[nodiscard]] Host judged_as(Host host);
/// Whether two such hosts show the same of all deltas.
[[nodiscard]] bool shows_alike(const Host& a, const Host& b);

/// The kinds of poses that HostChange tells apart.
inline constexpr std::size_t kPoseKinds = 3;

/// Poses of one kind, and the hosts that may come to show them.
struct PoseSet {
  enum class Kind { kFile, kRandom, kFades };
  Kind kind = Kind::kFile;
  std::vector<std::size_t> hosts;
  std::vector<SeenPose> poses;
  std::vector<std::uint32_t> numbers = {};  ///< of the vertices that these poses move, ascending; none: all of them
};

/// Which of the harmless forms a vertex gets.
enum class FormPreference {
  kNearest,        ///< by the sum of squares over all poses
  kNearestInFile,  ///< the same over those of the file
  kLast            ///< the last that is nearer than what is stored
};

class HostJudge {
 public:
  /// The vertices that are judged, with their elements, and whether each has a new base normal, so that there is no
  /// stored form to return to. All of these, and rights, must outlive this. No form may do harm in hosts that are
  /// binding.
  HostJudge(const RightNormals& rights, std::span<const std::uint32_t> vertices,
            std::span<const std::uint32_t> element_of_vertex, const std::vector<bool>& is_new,
            std::span<const Host> hosts, std::vector<bool> is_binding, double tolerance);

  /// The largest error of one form over some poses for each vertex, in a host that adds up what is stored.
  [[nodiscard]] std::vector<float> worst(const VertexColumns& form, const PoseList& poses) const;

  /// Chooses a harmless form for each vertex, the same for all of one element.
  [[nodiscard]] std::vector<std::uint8_t> choose(std::span<const VertexColumns> forms, std::span<const PoseSet> sets,
                                                 FormPreference preference) const;

  /// Measures the chosen forms against the stored ones, host by host. Elements whose form is not harmless in these
  /// poses, and where mixed poses as a whole are worse and count, those that make them so, get the stored form.
  [[nodiscard]] std::vector<HostChange> settle(std::span<const VertexColumns> forms, std::span<const PoseSet> sets,
                                               std::vector<std::uint8_t>& choice, bool mixed_count = true) const;

 private:
  struct Kind {
    Host host;
    bool is_binding = false;
  };
  // Whether two hosts, as they are judged, show the same in these poses.
  [[nodiscard]] static bool is_alike(const PoseSet& set, const Host& a, const Host& b);
  [[nodiscard]] std::vector<Kind> kinds_of(const PoseSet& set) const;
  [[nodiscard]] bool is_harmed(float before, float after) const noexcept;
  // Returns whether that changes anything.
  bool return_to_stored(const std::vector<char>& noted, std::vector<std::uint8_t>& choice) const;
  template <class Visit>
  void compare(std::span<const VertexColumns> forms, const PoseSet& set, std::span<const Kind> kinds,
               const Visit& visit) const;

  const RightNormals& rights_;
  std::span<const std::uint32_t> vertices_, element_of_vertex_;
  const std::vector<bool>& is_new_;
  std::vector<Host> hosts_;
  std::vector<bool> is_binding_;
  double tolerance_;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_JUDGE_HOST_JUDGE_H_
