/// What `inspect` found, and the part of it that is bad news: in words, with what it means for normals.
#ifndef CLI_INSPECT_TROUBLE_H_
#define CLI_INSPECT_TROUBLE_H_

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "chronormal/io/file.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/io/gltf_motion.h"
#include "chronormal/motion/motion.h"
#include "chronormal/workflow/inspect.h"
#include "chronormal/workflow/inspect_gltf.h"

namespace chronormal::cli {

struct InspectedGltf {
  std::unique_ptr<FileBytes> file;  ///< that the document lies in
  GltfDocument document;
  GltfInspection inspection;
  std::vector<GltfPart> parts;  ///< where the vertices and faces of the motion came from; of a mesh that is still too
  double curve_error = 0;       ///< as in GltfMotion
  std::size_t split = 0;        ///< of count_split_normals()
  std::optional<std::size_t> animation;  ///< the one that is looked at; nothing: the targets, or what stands still
};

/// One input, and what is known of it.
struct Inspected {
  std::string name;
  std::optional<Inspection> inspection;  ///< nothing for a glTF file without faces
  std::vector<std::string> keyframe_names;
  std::vector<Motion::SegmentKeys> segments;
  bool is_star = false;  ///< morph targets: segment k goes from keyframe 0 to target k
  std::optional<InspectedGltf> gltf;
};

struct Trouble {
  std::string kind;  ///< for programs: "no_area_at_keyframe"
  std::size_t count = 0;
  std::string what;     ///< "2 faces have no area at a keyframe"
  std::string where;    ///< the first of them, or empty
  std::string meaning;  ///< for normals
};

/// All that is bad news, the worst first.
[[nodiscard]] std::vector<Trouble> find_trouble(const Inspected& input);

/// "keyframe 3 (walk_3.obj)", "segment 3 (smile)", "face 7 of Head, primitive 1": as a person finds it again.
[[nodiscard]] std::string keyframe_label(const Inspected& input, std::size_t keyframe);
[[nodiscard]] std::string segment_label(const Inspected& input, std::size_t segment);
[[nodiscard]] std::string face_label(const Inspected& input, std::size_t face);
[[nodiscard]] std::string vertex_label(const Inspected& input, std::size_t vertex);

/// "LINEAR", as glTF has it.
[[nodiscard]] const char* interpolation_name(GltfInterpolation interpolation);

/// The name of a mesh, or "mesh 3" where it has none.
[[nodiscard]] std::string mesh_label(const GltfDocument& document, std::size_t mesh);

}  // namespace chronormal::cli

#endif  // CLI_INSPECT_TROUBLE_H_
