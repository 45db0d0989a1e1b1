// Defines the question `collapse` of the command `query`: the times when faces have no area.

#include "cli/commands/query_question.h"

namespace chronormal::cli {

Question collapse_question() {
  return {"collapse", "when faces lose their area, and which faces turn over then (exact)", {}, [] {
            return Result<Ask>([](const Motion& motion, const QuerySpan& span, const QueryProgress& progress,
                                  const ElementOptions&) { return query_collapse(motion, span, progress); });
          }};
}

}  // namespace chronormal::cli
