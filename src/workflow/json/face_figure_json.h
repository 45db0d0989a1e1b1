/// Makes JSON from the figures of one face, for `chronormal compare` and for reports. Private to workflow.
#ifndef CHRONORMAL_WORKFLOW_JSON_FACE_FIGURE_JSON_H_
#define CHRONORMAL_WORKFLOW_JSON_FACE_FIGURE_JSON_H_

#include "workflow/compare/face_figure.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {

/// Returns the figures of one face as an object. Lists of vectors are flat arrays of x, y, z. Directions and degrees
/// are rounded to 1e-7, the accuracy of float32.
[[nodiscard]] Json face_figure_object(const FaceFigure& figure);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_JSON_FACE_FIGURE_JSON_H_
