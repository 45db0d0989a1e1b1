/// What commands ask of their inputs before they read them.
#ifndef CLI_INPUTS_H_
#define CLI_INPUTS_H_

#include <string>
#include <string_view>

#include "chronormal/core/result.h"
#include "chronormal/motion/topology.h"
#include "chronormal/workflow/audit.h"
#include "cli/command.h"

namespace chronormal::cli {

/// Whether the input is a single file, or the standard input.
[[nodiscard]] bool is_one_file(const InputOptions& input);

/// Whether a file is glTF, by its name or else by its content.
[[nodiscard]] bool is_gltf(const std::string& path, std::string_view bytes);

/// The normals that .obj files of a sequence store: of all keyframes where every file has some, else of keyframe 0
/// where that has. Of the mesh of a cache or of targets, its own. Errors: of opening and reading.
[[nodiscard]] Result<StoredNormals> read_stored_normals(const InputOptions& input, const Topology& topology);

}  // namespace chronormal::cli

#endif  // CLI_INPUTS_H_
