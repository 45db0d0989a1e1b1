// Who shares a normal, the curves of those, and a copy for each that shows it.
#include "chronormal/normals/element_curves.h"

#include <algorithm>
#include <cassert>
#include <string>
#include <utility>

namespace chronormal {
namespace {

// Positions in memory of their own, as a keyframe has them.
std::vector<float> packed(VectorView<const float> positions) {
  std::vector<float> result(3 * positions.count);
  for (std::size_t i = 0; i < positions.count; ++i) {
    const Vec3f p = positions[i];
    result[3 * i] = p.x;
    result[3 * i + 1] = p.y;
    result[3 * i + 2] = p.z;
  }
  return result;
}

Status check(const Topology& topology, VectorView<const float> positions, std::size_t keyframe) {
  const std::string place = "keyframe " + std::to_string(keyframe);
  if (positions.count != topology.vertex_count()) {
    return invalid_input(place, "there are " + std::to_string(positions.count) + " positions for " +
                                    std::to_string(topology.vertex_count()) + " vertices");
  }
  for (std::size_t i = 0; i < positions.count; ++i) {
    if (!is_finite(to_double(positions[i])))
      return invalid_input(place + ", vertex " + std::to_string(i), "the position is not finite");
  }
  return Success{};
}

// Whether every output shows the element of its own number.
bool are_outputs(const NormalGroups& groups) {
  const auto elements = groups.element_of_output();
  if (groups.size() != elements.size()) return false;
  for (std::size_t i = 0; i < elements.size(); ++i)
    if (elements[i] != i) return false;
  return true;
}

}  // namespace

Result<ElementCurves> ElementCurves::make(Topology topology, VectorView<const float> from, VectorView<const float> to,
                                          const ElementCurvesOptions& options) {
  if (topology.face_count() == 0) return invalid_input("", "the mesh has no faces");
  ElementCurves result;
  if (Status status = check(topology, from, 0); !status) return status.error();
  if (Status status = check(topology, to, 1); !status) return status.error();
  const bool are_faces = options.elements.kind == ElementKind::kFaces;
  if (are_faces && options.weighting != Weighting::kArea)
    return Error{ErrorCode::kUsage, "weighting", "a face has one normal; weightings are for vertices and corners"};
  result.options_ = options;
  if (!are_faces) {
    Motion motion;  // of copies, for as long as it takes to see who shares a normal
    motion.topology = std::move(topology);
    motion.keyframes = {{packed(from), 0, "from"}, {packed(to), 1, "to"}};
    motion.connect_as_sequence();
    Result<NormalGroups> groups = make_groups(motion, options.elements);
    if (!groups) return groups.error();
    result.groups_ = std::move(groups).value();
    result.shares_ = !are_outputs(result.groups_);
    topology = std::move(motion.topology);
  }
  result.options_.elements.group_of_face = {};  // the caller's, and no longer needed
  result.options_.elements.normal_of_corner = {};
  result.topology_ = std::move(topology);
  result.prepare({&result.topology_, from, to});
  return result;
}

Status ElementCurves::next(VectorView<const float> from, VectorView<const float> to) {
  if (Status status = check(topology_, from, 0); !status) return status;
  if (Status status = check(topology_, to, 1); !status) return status;
  prepare({&topology_, from, to});
  return Success{};
}

void ElementCurves::prepare(const Segment& segment) {
  const CurveOptions options{options_.tolerance};
  if (options_.elements.kind == ElementKind::kFaces) {
    curves_ = NormalCurves::of_faces(segment, options, options_.threads, &curves_);
  } else if (options_.weighting == Weighting::kArea) {
    curves_ = NormalCurves::of_groups(segment, groups_, options, options_.threads, &curves_);
  } else {
    const WeightingFit fit = fit_weighting(segment, groups_, options_.weighting);
    fit_bound_ = fit.bounds.empty() ? 0 : *std::max_element(fit.bounds.begin(), fit.bounds.end());
    curves_ = NormalCurves(fit.normals, options);
  }
  if (shares_) scratch_.resize(3 * curves_.size());
}

std::size_t ElementCurves::size() const noexcept {
  return options_.elements.kind == ElementKind::kFaces ? topology_.face_count() : groups_.element_of_output().size();
}

std::size_t ElementCurves::unit_normals(double t, VectorView<float> result, Threads threads) {
  assert(result.count == size());
  if (!shares_) return curves_.unit_normals(t, result, threads);
  const VectorView<float> of_elements = VectorView<float>::packed(scratch_.data(), curves_.size());
  const std::size_t zeros = curves_.unit_normals(t, of_elements, threads);
  groups_.copy_to_outputs(of_elements, result);
  if (zeros == 0) return 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < result.count; ++i)
    if (result[i] == Vec3f{}) ++count;
  return count;
}

}  // namespace chronormal
