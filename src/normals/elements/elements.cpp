// Finds a kind of elements by its name, and makes the groups for a kind.
#include "chronormal/normals/normal_groups.h"

#include <array>
#include <cassert>
#include <string>

namespace chronormal {
namespace {

constexpr std::array<std::string_view, 3> kNames = {"faces", "vertices", "corners"};
constexpr std::array<std::string_view, 3> kSingular = {"face", "vertex", "corner"};

}  // namespace

std::string_view element_kind_name(ElementKind kind) noexcept { return kNames[static_cast<std::size_t>(kind)]; }

std::string_view one_element(ElementKind kind) noexcept { return kSingular[static_cast<std::size_t>(kind)]; }

Result<ElementKind> make_element_kind(std::string_view name) {
  for (std::size_t i = 0; i < kNames.size(); ++i) {
    if (kNames[i] == name) return static_cast<ElementKind>(i);
  }
  return Error{
      ErrorCode::kUsage, "",
      std::string("there is no kind of elements '").append(name).append("'; choose faces, vertices or corners")};
}

Result<NormalGroups> make_groups(const Motion& motion, const ElementOptions& options) {
  MotionStream stream(motion);
  return make_groups(stream, options);
}

Result<NormalGroups> make_groups(MotionStream& stream, const ElementOptions& options) {
  assert(options.kind != ElementKind::kFaces);
  const Motion& motion = stream.motion();
  const Result<Points> welded =
      options.weld ? weld_coincident(stream) : Result<Points>(separate_points(motion.topology.vertex_count()));
  if (!welded) return welded.error();
  const Points& points = welded.value();
  if (options.kind == ElementKind::kVertices) return NormalGroups::of_vertices(motion.topology, points);
  if (!options.group_of_face.empty())
    return NormalGroups::by_smoothing_group(motion.topology, points, options.group_of_face);
  if (options.normal_of_corner.count > 0)
    return NormalGroups::by_split_normals(motion.topology, points, options.normal_of_corner);
  if (const Status status = stream.hold(0, 0); !status) return status.error();
  return NormalGroups::by_crease_angle(motion, points, options.crease_angle);
}

}  // namespace chronormal
