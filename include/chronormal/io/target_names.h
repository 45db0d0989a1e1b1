/// The morph targets of an input by their names.
///
///     base.obj smile.obj lift.target     0 smile, 1 lift: the names of the files
///     face.glb                           extras.targetNames of its meshes; target k of a motion is target k of every
///                                        mesh, so that it has as many names as meshes call it differently
///
/// Threads    pure.
#ifndef CHRONORMAL_IO_TARGET_NAMES_H_
#define CHRONORMAL_IO_TARGET_NAMES_H_

#include <cstddef>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/input.h"

namespace chronormal {

/// The names of each target, in the order of the targets. A target without a name has none here.
using TargetNames = std::vector<std::vector<std::string>>;

/// The names of the targets that the motion of an input has; empty where it is no set of targets. Errors: of
/// Input::motion()
[[nodiscard]] Result<TargetNames> target_names(Input& input);

/// The target of a name, or else of a number in digits, counted from 0. Errors: kUsage for a name that no target has,
/// with the nearest one, and for a name that several have, with their numbers.
[[nodiscard]] Result<std::size_t> find_target(const TargetNames& names, const std::string& name_or_number);

/// "3 (smile)", or "3" for a target without a name: what tables and messages call target 3.
[[nodiscard]] std::string target_label(const TargetNames& names, std::size_t target);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_TARGET_NAMES_H_
