#include "chronormal/analysis/quality.h"
#include "workflow/inspect/trouble.h"
#include "workflow/json/json.h"
#include "workflow/json/object.h"

namespace chronormal::inline internal {
namespace {

Json found_json(const Found& found, const char* what) {
  return {{"count", found.count}, {what, found.count > 0 ? Json(found.first) : Json()}};
}

Json places_json(const Places& places, const char* at, bool has_instant = false) {
  Json first;
  if (places.pairs > 0) {
    first = {{at, places.first_at}, {"face", places.first_face}};
    if (has_instant) first["t"] = places.first_t;
  }
  return {{"faces", places.faces}, {"pairs", places.pairs}, {"first", first}};
}

Json motion_json(const Largest& motion) {
  return {{"distance", motion.value}, {"segment", motion.segment}, {"vertex", motion.element}};
}

Json turn_json(const Largest& turn) {
  return {{"degrees", turn.value * kDegreesPerRadian}, {"segment", turn.segment}, {"face", turn.element}};
}

Json segments_json(const Inspected& input) {
  Json segments = Json::array();
  for (std::size_t s = 0; s < input.inspection->segments.size(); ++s) {
    const SegmentInspection& found = input.inspection->segments[s];
    segments.push_back({{"from", input.segments[s].from},
                        {"to", input.segments[s].to},
                        {"name", input.keyframe_names[input.segments[s].to]},
                        {"moved_vertices", found.moved_vertices},
                        {"largest_motion", found.motion.value},
                        {"largest_turn_degrees", found.turn.value * kDegreesPerRadian},
                        {"turns_far", found.turned_far},
                        {"collapses", found.collapses},
                        {"vanishes", found.vanishing},
                        {"turns_over", found.turned_over},
                        {"without_normals", found.without_normals},
                        {"flagged", found.flagged},
                        {"bytes", found.bytes}});
  }
  return segments;
}

Json vector_json(const Vec3d& v) { return {v.x, v.y, v.z}; }

void add_inspection(const Inspected& input, Json& json) {
  const Inspection& found = *input.inspection;
  const Surface& surface = found.surface;
  json["kind"] = found.segments.empty() ? "mesh" : input.has_targets() ? "targets" : "sequence";
  json["time"] = input.has_targets() ? Json() : Json({{"first", found.first_time}, {"last", found.last_time}});
  json["box"] = {{"low", vector_json(found.low)}, {"high", vector_json(found.high)}, {"diagonal", found.diagonal}};
  json["largest_motion"] = motion_json(found.motion);
  json["largest_turn"] = turn_json(found.turn);
  json["surface"] = {{"triangles", surface.triangles},
                     {"most_corners", surface.most_corners},
                     {"pieces", surface.pieces},
                     {"edges", surface.edges},
                     {"open_edges", found_json(surface.open_edges, "first_face")},
                     {"non_manifold_edges", found_json(surface.non_manifold_edges, "first_face")},
                     {"turned_edges", found_json(surface.turned_edges, "first_face")},
                     {"seam_edges", found_json(surface.seam_edges, "first_face")},
                     {"doubled_faces", found_json(surface.doubled_faces, "first_face")},
                     {"back_to_back", found_json(surface.back_to_back, "first_face")},
                     {"concave_faces", found_json(found.cut, "first_face")},
                     {"repeating_faces", found_json(surface.repeating_faces, "first_face")},
                     {"unreferenced_vertices", found_json(surface.unreferenced, "first_vertex")},
                     {"doubled_vertices", found_json(found.doubled, "first_vertex")},
                     {"doubled_at_start", found_json(found.doubled_at_start, "first_vertex")}};
  json["keyframe_faces"] = {{"no_area", places_json(found.no_area, "keyframe")},
                            {"slivers", places_json(found.slivers, "keyframe")}};
  json["segment_faces"] = {{"without_normals", places_json(found.without_normals, "segment")},
                           {"collapses", places_json(found.collapses, "segment", true)},
                           {"vanishes", places_json(found.vanishing, "segment", true)},
                           {"turns_over", places_json(found.turned_over, "segment", true)},
                           {"turns_far", places_json(found.turned_far, "segment")},
                           {"flagged", found.flagged}};
  json["bytes"] = {{"keyframes", found.keyframe_bytes}, {"normals", found.normal_bytes}};
  json["segments"] = segments_json(input);
}

Json primitive_json(const GltfPrimitive& primitive) {
  Json targets = Json::array();
  for (const GltfPrimitive::Target& target : primitive.targets)
    targets.push_back({{"positions", target.positions}, {"normals", target.normals}, {"tangents", target.tangents}});
  return {{"mode", primitive.mode},           {"vertices", primitive.vertex_count},
          {"normals", primitive.has_normals}, {"tangents", primitive.has_tangents},
          {"draco", primitive.has_draco},     {"targets", targets}};
}

Json meshes_json(const InspectedGltf& gltf) {
  const GltfDocument& document = *gltf.document;
  Json meshes = Json::array();
  for (std::size_t m = 0; m < document.meshes().size(); ++m) {
    const GltfMesh& mesh = document.meshes()[m];
    Json primitives = Json::array();
    for (const GltfPrimitive& primitive : mesh.primitives) primitives.push_back(primitive_json(primitive));
    meshes.push_back({{"name", mesh.name},
                      {"nodes", gltf.inspection.instances[m]},
                      {"targets", mesh.target_count},
                      {"target_names", mesh.target_names},
                      {"weights", mesh.weights},
                      {"primitives", std::move(primitives)}});
  }
  for (const GltfPrimitiveInspection& found : gltf.inspection.primitives) {
    Json& primitive = meshes[found.mesh]["primitives"][found.primitive];
    primitive["triangles"] = found.triangles;
    primitive["doubled_vertices"] = found.doubled;
    primitive["split_normals"] = found.split;
    primitive["normals_off_length"] = found.off_length;
  }
  return meshes;
}

Json animations_json(const InspectedGltf& gltf) {
  const GltfDocument& document = *gltf.document;
  Json animations = Json::array();
  for (const GltfAnimation& animation : document.animations())
    animations.push_back(
        {{"name", animation.name}, {"channels", animation.channel_count}, {"weight_tracks", Json::array()}});
  for (const GltfTrackInspection& found : gltf.inspection.tracks) {
    const GltfTrack& track = document.animations()[found.animation].tracks[found.track];
    animations[found.animation]["weight_tracks"].push_back({{"node", track.node},
                                                            {"node_name", document.nodes()[track.node].name},
                                                            {"interpolation", interpolation_name(track.interpolation)},
                                                            {"keys", track.key_count},
                                                            {"first_time", found.first_time},
                                                            {"last_time", found.last_time},
                                                            {"lowest_weight", found.lowest},
                                                            {"highest_weight", found.highest}});
  }
  return animations;
}

Json gltf_json(const InspectedGltf& gltf) {
  Json parts = Json::array();
  for (const GltfPart& part : gltf.parts)
    parts.push_back({{"node", or_null(part.node)},
                     {"mesh", part.mesh},
                     {"primitive", part.primitive},
                     {"first_vertex", part.first_vertex},
                     {"vertices", part.vertex_count},
                     {"first_face", part.first_face},
                     {"faces", part.face_count}});
  return {{"extensions", gltf.document->extensions()},
          {"nodes", gltf.document->nodes().size()},
          {"skinned_nodes", gltf.inspection.skinned_nodes},
          {"meshes", meshes_json(gltf)},
          {"animations", animations_json(gltf)},
          {"animation", or_null(gltf.animation)},
          {"curve_error", gltf.curve_error},
          {"split_normals", gltf.split},
          {"parts", std::move(parts)}};
}

}  // namespace

std::string inspect_json(const Inspected& input) {
  Json json = json_of_command("inspect");
  const bool has_faces = input.inspection.has_value();
  json["input"] = {{"name", input.name()},
                   {"vertices", has_faces ? input.inspection->vertices : 0},
                   {"faces", has_faces ? input.inspection->faces : 0},
                   {"keyframes", has_faces ? input.inspection->keyframes : 0},
                   {"segments", input.segments.size()}};
  if (const auto series = input.opened ? input.opened->series() : std::nullopt)
    json["files"] = {{"count", series->count},         {"first", series->first},
                     {"last", series->last},           {"least_step", series->least_step},
                     {"most_step", series->most_step}, {"are_seconds", series->are_seconds}};
  if (has_faces) add_inspection(input, json);
  if (input.gltf) json["gltf"] = gltf_json(*input.gltf);
  json["trouble"] = Json::array();
  for (const Trouble& trouble : find_trouble(input))
    json["trouble"].push_back({{"kind", trouble.kind},
                               {"count", trouble.count},
                               {"what", trouble.what},
                               {"where", trouble.where.empty() ? Json() : Json(trouble.where)},
                               {"meaning", trouble.meaning}});
  json["notes"] = input.opened ? input.opened->notes() : std::vector<std::string>{};
  return json_text(json);
}

}  // namespace chronormal::inline internal
