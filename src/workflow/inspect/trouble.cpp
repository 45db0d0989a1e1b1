#include "workflow/inspect/trouble.h"

#include <algorithm>

#include "core/text.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kLongestName = 40;

// Exporters compute weights, and miss 0 and 1 slightly.
constexpr double kRoundedWeight = 1e-3;

std::string numbered(const char* what, std::size_t number) { return what + (' ' + std::to_string(number)); }

std::string with_name(std::string label, const std::string& name) {
  if (!name.empty() && name != label) label += " (" + printable(name, kLongestName) + ")";
  return label;
}

std::string faces(std::size_t count) { return counted(count, "face", "faces"); }
std::string edges(std::size_t count) { return counted(count, "edge", "edges"); }
std::string vertices(std::size_t count) { return counted(count, "vertex", "vertices"); }

// Returns "12 faces have" or "1 face has".
std::string have(const std::string& counted_things, std::size_t count) {
  return counted_things + (count == 1 ? " has" : " have");
}

// Returns ", 30 times in all" if some faces are reported more than once.
std::string in_all(const Places& places) {
  return places.pairs > places.faces ? ", " + grouped(places.pairs) + " times in all" : "";
}

class Troubles {
 public:
  explicit Troubles(const Inspected& input) : input_(input) {}

  void add(std::string kind, std::size_t count, std::string what, std::string where, std::string meaning) {
    if (count > 0) list_.push_back({std::move(kind), count, std::move(what), std::move(where), std::move(meaning)});
  }
  void at_keyframes(std::string kind, const Places& places, const std::string& what, std::string meaning) {
    if (places.pairs == 0) return;
    add(std::move(kind), places.faces, have(faces(places.faces), places.faces) + what + in_all(places),
        face_label(input_, places.first_face) +
            (input_.segments.empty() ? "" : " at " + keyframe_label(input_, places.first_at)),
        std::move(meaning));
  }
  void in_segments(std::string kind, const Places& places, const std::string& what, bool has_instant,
                   std::string meaning) {
    if (places.pairs == 0) return;
    const std::string when =
        has_instant ? (input_.has_targets() ? " at w = " : " at t = ") + with_decimals(places.first_t, 4) : "";
    add(std::move(kind), places.faces, faces(places.faces) + what + in_all(places),
        face_label(input_, places.first_face) + " in " + segment_label(input_, places.first_at) + when,
        std::move(meaning));
  }
  void on_surface(std::string kind, const Found& found, std::string what, std::string meaning) {
    add(std::move(kind), found.count, std::move(what), found.count > 0 ? face_label(input_, found.first) : "",
        std::move(meaning));
  }

  [[nodiscard]] std::vector<Trouble> take() { return std::move(list_); }

 private:
  const Inspected& input_;
  std::vector<Trouble> list_;
};

void add_motion_trouble(const Inspection& found, Troubles& troubles) {
  const bool moves = !found.segments.empty();
  if (!moves) {
    troubles.at_keyframes("no_area", found.no_area, " no area", "there is no normal to give: (0, 0, 0)");
  } else {
    troubles.in_segments("no_normal", found.without_normals, " without area in a whole segment", false,
                         "there is no normal to give: (0, 0, 0)");
    troubles.at_keyframes("no_area_at_keyframe", found.no_area, " no area at a keyframe",
                          "the normal there is the limit from inside the segment, where there is one");
  }
  troubles.in_segments("turns_over", found.turned_over, " turning over inside a segment, through no area", true,
                       "the normal jumps to its opposite at that instant");
  Places others = found.collapses;
  if (found.turned_over.pairs == others.pairs) others.pairs = 0;  // all of them were reported
  troubles.in_segments("collapses", others, " losing all area inside a segment", true,
                       found.turned_over.pairs > 0 ? "the normal jumps or comes back, the ones that turn over included"
                                                   : "the normal is lost for an instant, and comes back");
  troubles.in_segments(
      "turns_far", found.turned_far, " turning by more than 90 degrees in a segment", false,
      "normals interpolated from keyframes err the most there: hold them against exact ones (compare)");
  troubles.at_keyframes("sliver", found.slivers, " hardly more area than the rounding of positions at a keyframe",
                        "the direction of the normal there is that of the rounding");
}

void add_surface_trouble(const Inspected& input, Troubles& troubles) {
  const Inspection& found = *input.inspection;
  const Surface& surface = found.surface;
  troubles.on_surface(
      "non_manifold_edge", surface.non_manifold_edges,
      have(edges(surface.non_manifold_edges.count), surface.non_manifold_edges.count) + " more than two faces",
      "a normal per vertex is the sum over all sheets that meet there");
  troubles.on_surface("turned_edge", surface.turned_edges,
                      edges(surface.turned_edges.count) + " between faces that are wound against each other",
                      "their normals point to opposite sides, and cancel in a normal per vertex");
  troubles.on_surface(
      "back_to_back", surface.back_to_back,
      counted(surface.back_to_back.count, "pair of faces", "pairs of faces") + " on the same vertices, back to back",
      "their normals cancel in a normal per vertex, unless the two sides are kept apart");
  troubles.on_surface(
      "doubled_face", surface.doubled_faces,
      have(faces(surface.doubled_faces.count), surface.doubled_faces.count) + " the vertices of another face",
      "they count twice in a normal per vertex");
  troubles.on_surface("repeating_face", surface.repeating_faces,
                      have(faces(surface.repeating_faces.count), surface.repeating_faces.count) + " a point twice",
                      "a triangle has no area then; a larger face counts with both corners in a normal per vertex");
  troubles.on_surface("concave_face", found.cut, counted(found.cut.count, "face is", "faces are") + " not convex",
                      "where triangles are needed, as in glTF, ears are cut off, so that they cover it once");
  std::string meaning = "a normal per vertex breaks there, unless such vertices are taken as one point";
  if (const std::size_t split = input.gltf ? input.gltf->split : 0; split > 0)
    meaning =
        "a normal per vertex breaks there; at " + grouped(split) + " of them so do the stored normals: hard edges";
  troubles.add("doubled_vertex", found.doubled.count,
               have(vertices(found.doubled.count), found.doubled.count) + " the place of another throughout, along " +
                   edges(surface.seam_edges.count),
               "", std::move(meaning));
  const std::size_t parting = found.doubled_at_start.count - found.doubled.count;
  troubles.add("parting_vertex", parting,
               have(vertices(parting), parting) + " the place of another at the first keyframe only", "",
               "they come apart: they must not be welded by their first positions");
}

// Returns "Head, primitive 1", and adds the node if several nodes have the mesh.
std::string part_label(const InspectedGltf& gltf, const GltfPart& part) {
  std::string label = mesh_label(*gltf.document, part.mesh) + numbered(", primitive", part.primitive);
  if (part.node && gltf.inspection.instances[part.mesh] > 1)
    label += ", " + with_name(numbered("node", *part.node), gltf.document->nodes()[*part.node].name);
  return label;
}

void add_gltf_trouble(const Inspected& input, Troubles& troubles) {
  const InspectedGltf& gltf = *input.gltf;
  const GltfDocument& document = *gltf.document;
  const auto first_label = [&document](const GltfPrimitiveInspection& primitive) {
    return mesh_label(document, primitive.mesh) + numbered(", primitive", primitive.primitive);
  };
  std::string flat_at, left_at, tangents_at, length_at;
  std::size_t flat = 0, left = 0, tangents = 0, lengths = 0;
  const auto note = [&](std::string& at, std::size_t& sum, std::size_t count, const auto& primitive) {
    if (count > 0 && sum == 0) at = first_label(primitive);
    sum += count;
  };
  for (const GltfPrimitiveInspection& primitive : gltf.inspection.primitives) {
    const GltfPrimitive& described = document.meshes()[primitive.mesh].primitives[primitive.primitive];
    note(length_at, lengths, primitive.off_length, primitive);
    note(flat_at, flat, described.has_normals ? 0 : 1, primitive);
    if (!described.has_normals) continue;
    note(left_at, left, primitive.moving_normals < primitive.moving ? 1 : 0, primitive);
    if (described.has_tangents)
      note(tangents_at, tangents, primitive.moving_tangents < primitive.moving ? 1 : 0, primitive);
  }
  troubles.add("normals_stay", left,
               have(counted(left, "primitive", "primitives"), left) + " targets that move positions and not normals",
               left_at, "the shading stays that of the base while the shape changes");
  troubles.add(
      "tangents_stay", tangents,
      have(counted(tangents, "primitive", "primitives"), tangents) + " targets that move positions and not tangents",
      tangents_at, "normal maps are put on as if the base stood still");
  troubles.add("no_normals", flat, have(counted(flat, "primitive", "primitives"), flat) + " no normals", flat_at,
               "shown flat, by the specification: a normal per face, from the positions");
  troubles.add("off_length", lengths, counted(lengths, "stored normal is", "stored normals are") + " not of length 1",
               length_at, "engines differ in what they make of them");

  std::size_t beyond = 0;
  double lowest = 0, highest = 1;
  for (const GltfTrackInspection& track : gltf.inspection.tracks) {
    if (track.lowest >= -kRoundedWeight && track.highest <= 1 + kRoundedWeight) continue;
    ++beyond;
    lowest = std::min(lowest, track.lowest);
    highest = std::max(highest, track.highest);
  }
  troubles.add("weights_beyond", input.has_targets() ? beyond : 0,
               counted(beyond, "track", "tracks") + " with weights beyond 0 to 1: " + with_digits(lowest, 4) + " to " +
                   with_digits(highest, 4),
               "", "targets go farther than what is looked at here, w from 0 to 1");
  const std::size_t skinned = gltf.inspection.skinned_nodes;
  troubles.add("skin", skinned, have(counted(skinned, "node", "nodes"), skinned) + " a skin", "",
               "audit judges its normals through the skin; everything else applies no skeleton");
  const std::size_t without_faces = gltf.inspection.without_faces;
  troubles.add("no_faces", without_faces,
               counted(without_faces, "primitive is", "primitives are") + " points, lines or empty", "",
               "no faces, no normals: passed over");
  std::size_t unused = 0;
  std::string unused_at;
  for (std::size_t m = 0; m < gltf.inspection.instances.size(); ++m) {
    if (gltf.inspection.instances[m] == 0 && unused++ == 0) unused_at = mesh_label(document, m);
  }
  troubles.add("unused_mesh", unused, counted(unused, "mesh is", "meshes are") + " in no node", unused_at,
               "no scene shows it, it is looked at all the same");
}

}  // namespace

std::vector<Trouble> find_trouble(const Inspected& input) {
  Troubles troubles(input);
  if (input.inspection) add_motion_trouble(*input.inspection, troubles);
  if (input.gltf) add_gltf_trouble(input, troubles);
  if (input.inspection) {
    add_surface_trouble(input, troubles);
    const Found& unreferenced = input.inspection->surface.unreferenced;
    troubles.add("unreferenced_vertex", unreferenced.count,
                 counted(unreferenced.count, "vertex is", "vertices are") + " in no face",
                 unreferenced.count > 0 ? vertex_label(input, unreferenced.first) : "",
                 "they have no normal: (0, 0, 0)");
  }
  return troubles.take();
}

std::string keyframe_label(const Inspected& input, std::size_t keyframe) {
  return with_name(numbered("keyframe", keyframe), input.keyframe_names[keyframe]);
}

std::string segment_label(const Inspected& input, std::size_t segment) {
  if (!input.has_targets()) return numbered("segment", segment);
  return with_name(numbered("target", segment), input.keyframe_names[input.segments[segment].to]);
}

std::string face_label(const Inspected& input, std::size_t face) {
  if (input.gltf) {
    for (const GltfPart& part : input.gltf->parts) {
      if (face >= part.first_face && face - part.first_face < part.face_count)
        return numbered("face", face - part.first_face) + " of " + part_label(*input.gltf, part);
    }
  }
  return numbered("face", face);
}

std::string vertex_label(const Inspected& input, std::size_t vertex) {
  if (input.gltf) {
    for (const GltfPart& part : input.gltf->parts) {
      if (vertex >= part.first_vertex && vertex - part.first_vertex < part.vertex_count)
        return numbered("vertex", vertex - part.first_vertex) + " of " + part_label(*input.gltf, part);
    }
  }
  return numbered("vertex", vertex);
}

const char* interpolation_name(GltfInterpolation interpolation) {
  if (interpolation == GltfInterpolation::kStep) return "STEP";
  return interpolation == GltfInterpolation::kCubicSpline ? "CUBICSPLINE" : "LINEAR";
}

std::string mesh_label(const GltfDocument& document, std::size_t mesh) {
  const std::string& name = document.meshes()[mesh].name;
  return name.empty() ? numbered("mesh", mesh) : printable(name, kLongestName);
}

}  // namespace chronormal::inline internal
