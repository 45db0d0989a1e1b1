/// Describes the problems that inspect_input() has found, in sentences for people, and what these problems mean for
/// normals. Private to workflow and the program.
#ifndef CHRONORMAL_WORKFLOW_INSPECT_TROUBLE_H_
#define CHRONORMAL_WORKFLOW_INSPECT_TROUBLE_H_

#include <cstddef>
#include <string>
#include <vector>

#include "chronormal/io/gltf_document.h"
#include "chronormal/workflow/inspect.h"

namespace chronormal::inline internal {

struct Trouble {
  std::string kind;  ///< a name for programs, such as "no_area_at_keyframe"
  std::size_t count = 0;
  std::string what;     ///< the problem, such as "2 faces have no area at a keyframe"
  std::string where;    ///< the first place with the problem, or empty
  std::string meaning;  ///< the consequences of the problem for normals
};

/// Lists all problems of an input, the worst problem first.
[[nodiscard]] std::vector<Trouble> find_trouble(const Inspected& input);

/// Return names by which a user finds a place in the file, such as "keyframe 3 (walk_3.obj)", "segment 3 (smile)" or
/// "face 7 of Head, primitive 1".
[[nodiscard]] std::string keyframe_label(const Inspected& input, std::size_t keyframe);
[[nodiscard]] std::string segment_label(const Inspected& input, std::size_t segment);
[[nodiscard]] std::string face_label(const Inspected& input, std::size_t face);
[[nodiscard]] std::string vertex_label(const Inspected& input, std::size_t vertex);

/// Returns the name of an interpolation in glTF, such as "LINEAR".
[[nodiscard]] const char* interpolation_name(GltfInterpolation interpolation);

/// Returns the name of a mesh, or a text such as "mesh 3" if the mesh has no name.
[[nodiscard]] std::string mesh_label(const GltfDocument& document, std::size_t mesh);

}  // namespace chronormal::inline internal

#endif  // CHRONORMAL_WORKFLOW_INSPECT_TROUBLE_H_
