/// The harmless form of a mesh: deltas that are right, or nearly, in every host (docs/theory.md, section 16). Private
/// to workflow.
///
/// Each target of the mesh gets the delta to the right normal at its weight 1. What this leaves wrong on the way, and
/// where targets meet, extra targets correct; they move no vertex, and their weights follow from those of the targets:
///
///     turn      w_i            where a turn to weight 1 is so large that a delta of unit length would not fit; two
///     self      4 w_i (1-w_i)  right at w_i = 1/2 as well
///     pair      s w_i w_j      right where both are strongest in the file; one or two
///
/// Every one of them is a unit normal beside N, with a weight from 0 to 1 where those of the file are: what a host
/// leaves of it, be it the direction or 8 bits, is the same. Where all hosts keep weights below 0, corrections have the
/// lengths of n(w), each as two unit normals with opposite weights; where all hosts add up what is stored, everything
/// has.
#ifndef CHRONORMAL_WORKFLOW_BAKE_FORMS_HARMLESS_FORM_H_
#define CHRONORMAL_WORKFLOW_BAKE_FORMS_HARMLESS_FORM_H_

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "workflow/bake/judge/host_judge.h"
#include "workflow/bake/judge/right_normals.h"
#include "workflow/bake/terms.h"
#include "workflow/bake/write/tracks.h"
#include "workflow/shading/target_weights.h"

namespace chronormal::inline internal {

struct HarmlessForm {
  std::vector<VertexVectors> own;     ///< of each target of the mesh
  std::vector<ExtraWeight> weights;   ///< of the extra targets, whose gain is not set
  std::vector<VertexVectors> extras;  ///< and their deltas
  std::size_t left_out = 0;           ///< extra targets beyond the limit, which would have gained least
};

/// What the vectors of a form may be.
enum class FormLengths {
  kUnit,      ///< unit normals beside N, with weights from 0 to 1: in any host
  kOpposite,  ///< corrections as two unit normals with opposite weights, which have the length of n(w) between them: where
              ///< weights below 0 are kept
  kFree       ///< of any length: where all hosts add up what is stored
};

struct HarmlessLimits {
  FormLengths lengths = FormLengths::kUnit;
  std::size_t most_extras = 0;
  double tolerance = 0;  ///< degrees: vertices that are within it need no extra targets
};

/// Computes the deltas of the mesh's own targets, for all vertices of elements that these move.
[[nodiscard]] HarmlessForm end_point_form(const GltfShading& shading, const NormalTerms& terms,
                                          const RightNormals& rights, FormLengths lengths);

/// Adds extra targets for the poses of a file, to vertices that have need of them (`worst` is what the form is off by
/// at each of `vertices`, degrees).
void add_corrections(const GltfShading& shading, const NormalTerms& terms, const RightNormals& rights,
                     const PoseList& poses, std::span<const std::uint32_t> vertices, std::span<const float> worst,
                     const HarmlessLimits& limits, HarmlessForm& form);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_BAKE_FORMS_HARMLESS_FORM_H_
