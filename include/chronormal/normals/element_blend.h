/// The normals of blend shapes for every face, vertex or corner, straight from arrays: what bindings and engines call.
///
/// As ElementCurves (element_curves.h) is to NormalCurves, so is ElementBlend to BlendNormals: it decides who shares a
/// normal, prepares the terms, and writes a normal for every output.
///
///     Result<ElementBlend> blend = ElementBlend::make(std::move(set), {ElementKind::kVertices});
///     blend.value().unit_normals(weights, VectorView<float>::packed(xyz, blend.value().size()));
///
/// Accuracy   of BlendNormals.
/// Threads    unit_normals() uses scratch of the object: one call at a time.
#ifndef CHRONORMAL_NORMALS_ELEMENT_BLEND_H_
#define CHRONORMAL_NORMALS_ELEMENT_BLEND_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "chronormal/core/parallel.h"
#include "chronormal/core/result.h"
#include "chronormal/core/views.h"
#include "chronormal/motion/blend_set.h"
#include "chronormal/normals/blend_normals.h"
#include "chronormal/normals/elements.h"

namespace chronormal {

class ElementBlend {
 public:
  /// Prepares the terms of all targets. Vertices are one point where they are at one place in the base and at full
  /// weight of each target. Errors: those of validate() for a set, and of make_groups().
  [[nodiscard]] static Result<ElementBlend> make(BlendSet set, const ElementOptions& options);

  /// Writes the unit normal of every output; (0, 0, 0) where there is none. Returns how many of those were written.
  /// weights must have one for each target, result size() elements
  std::size_t unit_normals(std::span<const double> weights, VectorView<float> result, Threads threads = Threads::kOne);

  /// Outputs: faces, vertices or corners.
  [[nodiscard]] std::size_t size() const noexcept;
  [[nodiscard]] const BlendNormals& normals() const noexcept { return normals_; }

 private:
  explicit ElementBlend(BlendNormals normals) : normals_(std::move(normals)) {}

  BlendNormals normals_;
  std::vector<std::uint32_t> element_of_output_;  // empty where outputs are elements
  std::vector<float> scratch_;                    // (elements, 3), where they are not
};

}  // namespace chronormal

#endif  // CHRONORMAL_NORMALS_ELEMENT_BLEND_H_
