// Who shares a normal of a sequence, the curves of the segment that a time lies in, and a copy for each that shows it.
#include "chronormal/normals/element_paths.h"

#include <cassert>
#include <utility>

namespace chronormal {

Result<ElementPaths> ElementPaths::make(Motion sequence, const ElementPathsOptions& options) {
  if (Status status = validate(sequence); !status) return status.error();
  if (sequence.kind != MotionKind::kSequence)
    return Error{ErrorCode::kUsage, "", "only the keyframes of a sequence have paths between them"};
  if (Status status = check_path(sequence, options.path); !status) return status.error();
  ElementPaths result;
  result.options_ = options;
  if (options.elements.kind != ElementKind::kFaces) {
    Result<NormalGroups> groups = make_groups(sequence, options.elements);
    if (!groups) return groups.error();
    result.groups_ = std::move(groups).value();
    result.scratch_.resize(3 * result.groups_.size());
  }
  result.options_.elements.group_of_face = {};  // the caller's, and no longer needed
  result.options_.elements.normal_of_corner = {};
  result.motion_ = std::move(sequence);
  return result;
}

void ElementPaths::enter(std::size_t segment, Threads threads) {
  if (segment_ == segment) return;
  const PolynomialSegment<3> path = path_segment(motion_, segment, options_.path);
  curves_ = are_faces() ? PathCurves(path, threads) : PathCurves(path, groups_, threads);
  segment_ = segment;
}

std::size_t ElementPaths::size() const noexcept {
  return are_faces() ? motion_.topology.face_count() : groups_.element_of_output().size();
}

Result<std::size_t> ElementPaths::unit_normals(double time, VectorView<float> result, Threads threads) {
  assert(result.count == size());
  const Result<Instant> instant = find_instant(motion_, time);
  if (!instant) return instant.error();
  enter(instant.value().segment, threads);
  if (are_faces()) return curves_.unit_normals(instant.value().t, result, threads);
  const VectorView<float> of_elements = VectorView<float>::packed(scratch_.data(), curves_.size());
  const std::size_t zeros = curves_.unit_normals(instant.value().t, of_elements, threads);
  groups_.copy_to_outputs(of_elements, result);
  if (zeros == 0) return zeros;
  std::size_t count = 0;
  for (std::size_t i = 0; i < result.count; ++i)
    if (result[i] == Vec3f{}) ++count;
  return count;
}

}  // namespace chronormal
