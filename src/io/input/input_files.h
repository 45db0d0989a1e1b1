/// The files that inputs stand for, and one mesh out of them: what sequences and targets share. Private to io.
#ifndef CHRONORMAL_IO_INPUT_INPUT_FILES_H_
#define CHRONORMAL_IO_INPUT_INPUT_FILES_H_

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/motion/topology.h"
#include "io/mesh/mesh_frame.h"

namespace chronormal {

/// Which files of a folder count, in any order.
using FolderLister = std::function<Result<std::vector<std::string>>(const std::string& folder)>;

/// The files that inputs stand for, as io/sequence.h describes them; folders are asked of list_folder. Does not open
/// them. Errors: kFailed where nothing of that name exists or nothing matches a pattern; kUsage for "-" twice; those of
/// list_folder. The place is the input.
[[nodiscard]] Result<std::vector<std::string>> find_input_files(std::span<const std::string> inputs,
                                                                const FolderLister& list_folder);

/// The last part of a path; "<stdin>" for "-".
[[nodiscard]] std::string file_name_of(const std::string& path);

/// Opens and reads one mesh. The place of every error is `place`, or begins with it.
[[nodiscard]] Result<MeshFrame> read_mesh_file(const std::string& path, const std::string& place);

/// Whether other has the vertex count and the faces of first, which messages call first_name.
[[nodiscard]] Status check_same_topology(const Topology& first, const std::string& first_name, const Topology& other,
                                         const std::string& place);

}  // namespace chronormal

#endif  // CHRONORMAL_IO_INPUT_INPUT_FILES_H_
