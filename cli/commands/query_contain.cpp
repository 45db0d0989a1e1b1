// Defines the question `contain` of the command `query`: the points inside a closed mesh, and the times when they cross
// its surface.

#include <memory>
#include <utility>

#include "chronormal/io/input.h"
#include "cli/commands/query_question.h"
#include "cli/options/command.h"

namespace chronormal::cli {

Question contain_question() {
  const auto file = std::make_shared<std::string>();
  return {"contain",
          "which points are inside a closed mesh, and when they cross its surface",
          {{"--points P.npy", file.get(),
            "read the points from this .npy file, an array of shape (n, 3)\nIf the shape is (n, 2, 3), each point "
            "moves straight from its first to its second place during the motion"}},
          [file]() -> Result<Ask> {
            if (file->empty())
              return misuse("--points", "the points are missing; name a .npy file of points with --points");
            Result<PointPaths> points = read_points_file(*file);
            if (!points) return points.error();
            return Ask([points = std::move(points).value()](const Motion& motion, const QuerySpan& span,
                                                            const QueryProgress& progress, const ElementOptions&) {
              return query_contain(motion, points, span, progress);
            });
          }};
}

}  // namespace chronormal::cli
