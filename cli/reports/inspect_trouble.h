/// What `inspect` found, and the part of it that is bad news: in words, with what it means for normals.
#ifndef CLI_REPORTS_INSPECT_TROUBLE_H_
#define CLI_REPORTS_INSPECT_TROUBLE_H_

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "chronormal/io/input.h"
#include "chronormal/workflow/inspect.h"

namespace chronormal::cli {

/// What is known of a glTF file beside.
struct InspectedGltf {
  const GltfDocument* document = nullptr;  ///< of the input
  GltfInspection inspection;
  std::span<const GltfPart> parts;       ///< of the input: where vertices and faces came from
  double curve_error = 0;                ///< as Input has it
  std::size_t split = 0;                 ///< of count_split_normals()
  std::optional<std::size_t> animation;  ///< the one that is looked at; nothing: the targets, or what stands still
};

/// One input, and what is known of it.
struct Inspected {
  Input opened;
  std::optional<Inspection> inspection;  ///< nothing for a glTF file without faces
  std::vector<std::string> keyframe_names;
  std::vector<Motion::SegmentKeys> segments;
  MotionKind kind = MotionKind::kSequence;
  std::optional<InspectedGltf> gltf;

  [[nodiscard]] const std::string& name() const noexcept { return opened.name(); }
  /// Whether it has morph targets: segment k goes from keyframe 0 to target k, from weight 0 to 1.
  [[nodiscard]] bool has_targets() const noexcept { return kind == MotionKind::kTargets && !segments.empty(); }
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

#endif  // CLI_REPORTS_INSPECT_TROUBLE_H_
