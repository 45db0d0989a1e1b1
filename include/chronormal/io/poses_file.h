/// Poses of a rig from a JSON file: the weights that a program or a person gives its morph targets.
///
///     [{"jawOpen": 0.7, "mouthSmile_L": 1},     weights by the names of targets; all others are 0
///      [0, 0.7, 0, 1]]                          or one for each target of a mesh, in its order
///
/// Errors     kInvalidInput with the file and a JSON pointer as the place ("poses.json, /1/jawOpen"), or a byte for
///            what is no JSON; kFailed where the file cannot be read.
/// Threads    pure
#ifndef CHRONORMAL_IO_POSES_FILE_H_
#define CHRONORMAL_IO_POSES_FILE_H_

#include <string>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"

namespace chronormal {

/// One pose: weights by name, or in the order of the targets; one of the two is empty.
struct RigPose {
  struct Named {
    std::string target;
    double weight = 0;
    std::string place;  ///< for messages: "poses.json, /1/jawOpen"
  };
  std::vector<Named> named;
  std::vector<double> in_order;
  std::string place;
};

/// Reads a file of poses. One at least, each with finite weights.
[[nodiscard]] Result<std::vector<RigPose>> read_poses_file(const std::string& path);

/// The same of its text; name is for messages.
[[nodiscard]] Result<std::vector<RigPose>> parse_poses(std::string_view text, const std::string& name);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_POSES_FILE_H_
