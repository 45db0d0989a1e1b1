// Inspects an input of any format: its motion, and the other contents of a glTF file.
#include <utility>

#include "chronormal/workflow/inspect.h"

namespace chronormal {
namespace {

using ProgressCallback = std::function<void(std::size_t done, std::size_t total)>;

// Inspects a motion. A mesh at rest is a motion with a single keyframe.
Status inspect_keyframes(MotionStream& stream, const ProgressCallback& progress, Inspected& result) {
  const Motion& motion = stream.motion();
  Result<Inspection> inspection = inspect(stream, progress);
  if (!inspection) return inspection.error();
  result.inspection = std::move(inspection).value();
  for (const Motion::Keyframe& keyframe : motion.keyframes) result.keyframe_names.push_back(keyframe.name);
  result.segments = motion.segments;
  result.kind = motion.kind;
  return Success{};
}

Status inspect_opened(const ProgressCallback& progress, Inspected& result) {
  const Result<MotionStream*> read = result.opened->stream();
  if (!read) return read.error();
  return inspect_keyframes(*read.value(), progress, result);
}

// Inspects the contents of a glTF file, and then the motions of its meshes that move.
Status inspect_document(const std::string& animation, const ProgressCallback& progress, Inspected& result) {
  Input& input = *result.opened;
  const GltfDocument& document = *input.document();
  Result<GltfInspection> inspection = inspect(document);
  if (!inspection) return inspection.error();
  InspectedGltf gltf;
  gltf.document = &document;
  gltf.inspection = std::move(inspection).value();
  if (!gltf.inspection.primitives.empty() || !animation.empty()) {
    if (Status status = inspect_opened(progress, result); !status) return status;
    if (!animation.empty()) gltf.animation = document.find_animation(animation).value();
    const Result<std::size_t> split = count_split_normals(document, *input.motion().value(), input.parts());
    if (!split) return split.error();
    gltf.split = split.value();
    gltf.parts = input.parts();
    gltf.curve_error = input.curve_error();
  }
  result.gltf = std::move(gltf);
  return Success{};
}

}  // namespace

Result<Inspected> inspect_input(Input input, const std::string& animation, const ProgressCallback& progress) {
  Inspected result;
  result.opened = std::move(input);
  const Status status = result.opened->document() != nullptr ? inspect_document(animation, progress, result)
                                                             : inspect_opened(progress, result);
  if (!status) return status.error();
  return result;
}

Inspected inspect_input(const Motion& motion, std::string name) {
  Inspected result;
  result.motion_name = std::move(name);
  MotionStream stream(motion);
  (void)inspect_keyframes(stream, {}, result);  // reading a motion that is in memory cannot fail
  return result;
}

}  // namespace chronormal
