/// The exact normals that a comparison on curved paths needs in each segment, and a scheme that is made of them.
/// Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_COMPARE_CURVED_SEGMENTS_H_
#define CHRONORMAL_WORKFLOW_COMPARE_CURVED_SEGMENTS_H_

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string_view>
#include <vector>

#include "chronormal/analysis/certify.h"
#include "chronormal/motion/motion.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/paths.h"
#include "chronormal/schemes/scheme.h"

namespace chronormal::inline internal {

/// The name of the row of the exact normals of a curved path.
inline constexpr std::string_view kExactCurve = "exact";

/// What an evaluation of that row costs.
[[nodiscard]] OperationCounts exact_curve_operations() noexcept;

class CurvedSegments {
 public:
  /// groups is nullptr for faces; certified says whether truth() will be asked for. The motion and the groups must
  /// outlive the object.
  CurvedSegments(const Motion& motion, PathKind path, const NormalGroups* groups, bool certified)
      : motion_(&motion), path_(path), groups_(groups), certified_(certified) {}

  /// Prepares for segments first to last, and forgets those before.
  void enter(std::size_t first, std::size_t last);
  /// The time, in nanoseconds of one thread, for the faces of a segment that groups share; 0 for faces.
  [[nodiscard]] double shared_ns() const noexcept { return shared_ns_; }

  /// The normals of a range of faces of a segment that was entered, from the positions of vertices at t.
  void face_normals(std::size_t segment, IndexRange range, double t, std::span<Vec3d> result) const noexcept;
  /// The control normals of degree 6 of a range of elements.
  [[nodiscard]] std::vector<PolynomialNormals<3>> control_normals(std::size_t segment, IndexRange range) const;
  /// The same with their errors, for certificates.
  [[nodiscard]] PathTruth truth(std::size_t segment, IndexRange range) const;
  /// PathCurves as a scheme, on blocks of segments that were entered. This object must outlive the scheme.
  [[nodiscard]] std::unique_ptr<Scheme> scheme() const;

 private:
  struct Entered {
    PolynomialSegment<3> curve;
    PathTruth of_faces;  // for groups; errors where certificates are asked for
  };

  const Motion* motion_;
  PathKind path_;
  const NormalGroups* groups_;
  bool certified_;
  std::map<std::size_t, Entered> segments_;
  double shared_ns_ = 0;
};

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_COMPARE_CURVED_SEGMENTS_H_
