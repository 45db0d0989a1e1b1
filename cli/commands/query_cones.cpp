// Defines the question `cones` of the command `query`: cones that contain the normals of faces and of meshlets.

#include <memory>

#include "cli/commands/query_question.h"

namespace chronormal::cli {

Question cones_question() {
  auto meshlets = std::make_shared<std::optional<std::size_t>>();
  return {"cones",
          "cones that contain all normals of a face, and bounds of meshlets",
          {{"--meshlets N", meshlets.get(),
            "also build meshlets, which are groups of up to N triangles\nThe bounds of meshlets have the format of "
            "meshoptimizer"}},
          [meshlets] {
            return Result<Ask>(
                [meshlets](const Motion& motion, const QuerySpan& span, const QueryProgress& progress,
                           const ElementOptions&) { return query_cones(motion, *meshlets, span, progress); });
          }};
}

}  // namespace chronormal::cli
