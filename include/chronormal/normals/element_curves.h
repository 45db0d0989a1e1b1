/// The normals of one segment for every face, vertex or corner, straight from arrays: what bindings and engines call.
///
/// NormalCurves knows elements; a mesh wants a normal for each vertex or corner, several of which may show the same
/// element (normal_groups.h). ElementCurves is both in one: it decides who shares a normal, prepares the curves, and
/// writes a normal for every output.
///
///     Result<ElementCurves> curves = ElementCurves::make(topology, from, to, {});
///     curves.value().unit_normals(0.5, VectorView<float>::packed(xyz, curves.value().size()));
///
/// Accuracy   of NormalCurves; weightings other than area add the bound of their fit, fit_bound().
/// Ownership  positions are read while make() and next() run, and are not kept; results go to the caller's memory.
/// Threads    unit_normals() uses scratch of the object where outputs share elements: one call at a time.
#ifndef CHRONORMAL_NORMALS_ELEMENT_CURVES_H_
#define CHRONORMAL_NORMALS_ELEMENT_CURVES_H_

#include <cstddef>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/topology.h"
#include "chronormal/normals/elements.h"
#include "chronormal/normals/normal_curves.h"
#include "chronormal/normals/normal_groups.h"
#include "chronormal/normals/weighting.h"

namespace chronormal {

struct ElementCurvesOptions {
  ElementOptions elements = {ElementKind::kVertices};
  Weighting weighting = Weighting::kArea;  ///< kArea for faces
  double tolerance = kExactTolerance;      ///< radians, of NormalCurves
  Threads threads = Threads::kOne;         ///< to prepare on
};

class ElementCurves {
 public:
  /// Prepares the curves between two arrays of positions, one for each vertex of the topology.
  /// Errors: kInvalidInput for another number of positions than there are vertices, or one that is not finite (the
  /// place is "keyframe 0, vertex V"); those of make_groups(); kUsage for faces with another weighting than area.
  [[nodiscard]] static Result<ElementCurves> make(Topology topology, VectorView<const float> from,
                                                  VectorView<const float> to, const ElementCurvesOptions& options = {});

  /// The same for another segment of the same mesh, in the memory of the one before. Who shares a normal stays as it
  /// was. Errors: those of make() for positions; the curves are then what they were.
  Status next(VectorView<const float> from, VectorView<const float> to);

  /// Writes the unit normal of every output; (0, 0, 0) where there is none. Returns how many of those were written.
  /// result must have size() elements
  std::size_t unit_normals(double t, VectorView<float> result, Threads threads = Threads::kOne);

  /// Outputs: faces, vertices or corners.
  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] const NormalCurves& curves() const noexcept { return curves_; }
  [[nodiscard]] const Topology& topology() const noexcept { return topology_; }
  [[nodiscard]] const ElementCurvesOptions& options() const noexcept { return options_; }
  /// Radians: the largest angle by which a fit of the weighting may be off, over all elements; 0 for area.
  [[nodiscard]] double fit_bound() const noexcept { return fit_bound_; }

 private:
  ElementCurves() = default;

  void prepare(const Segment& segment);

  Topology topology_;
  ElementCurvesOptions options_;
  NormalGroups groups_;  // but for faces
  bool shares_ = false;  // an element is not an output of the same number, so that results are copied from scratch
  NormalCurves curves_;
  double fit_bound_ = 0;
  std::vector<float> scratch_;  // (elements, 3)
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_ELEMENT_CURVES_H_
