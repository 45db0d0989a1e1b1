// Defines the question `shutter` of the command `query`: mean normals for motion blur.

#include "cli/commands/query_question.h"

namespace chronormal::cli {

Question shutter_question() {
  return {"shutter",
          "average normals while a shutter is open, for motion blur",
          {},
          [] { return Result<Ask>(query_shutter); },
          true};
}

}  // namespace chronormal::cli
