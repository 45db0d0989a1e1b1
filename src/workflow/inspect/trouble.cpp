#include "workflow/inspect/trouble.h"

#include <algorithm>

#include "core/text.h"

namespace chronormal::inline internal {
namespace {

constexpr std::size_t kLongestName = 40;

// The distance from 0 or 1 up to which a weight counts as 0 or 1, because exporters compute weights with rounding
// errors.
constexpr double kRoundedWeight = 1e-3;

std::string numbered(const char* what, std::size_t number) { return what + (' ' + std::to_string(number)); }

std::string with_name(std::string label, const std::string& name) {
  if (!name.empty() && name != label) label += " (" + printable(name, kLongestName) + ")";
  return label;
}

std::string faces(std::size_t count) { return counted(count, "face", "faces"); }
std::string edges(std::size_t count) { return counted(count, "edge", "edges"); }
std::string vertices(std::size_t count) { return counted(count, "vertex", "vertices"); }

// Returns the counted things with the verb in singular or plural, such as "12 faces have" or "1 face has".
std::string have(const std::string& counted_things, std::size_t count) {
  return counted_things + (count == 1 ? " has" : " have");
}

// Returns the number of reports, such as ", 30 times altogether", if some face is reported more than once. Otherwise
// returns an empty text.
std::string in_all(const Places& places) {
  return places.pairs > places.faces ? ", " + grouped(places.pairs) + " times altogether" : "";
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
  // Adds a problem such as "2 faces turn over" or "1 face turns over". In this example, `verb` is " turn" and `rest` is
  // " over".
  void in_segments(std::string kind, const Places& places, const std::string& verb, const std::string& rest,
                   bool has_instant, std::string meaning) {
    if (places.pairs == 0) return;
    const std::string what = verb + (places.faces == 1 ? "s" : "") + rest;
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
    troubles.at_keyframes("no_area", found.no_area, " no area",
                          "there is no normal, so results have (0, 0, 0) in its place");
  } else {
    troubles.in_segments("no_normal", found.without_normals, " lack", " an area during a whole segment", false,
                         "there is no normal, so results have (0, 0, 0) in its place");
    troubles.at_keyframes("no_area_at_keyframe", found.no_area, " no area at a keyframe",
                          "results use the normal just before or after that moment, if there is one");
  }
  troubles.in_segments("turns_over", found.turned_over, " turn",
                       " over between two keyframes, at an instant without area", true,
                       "the normal flips to the opposite direction at that instant");
  Places others = found.collapses;
  if (found.turned_over.pairs == others.pairs) others.pairs = 0;  // the line above has reported all of these faces
  troubles.in_segments("collapses", others, " lose", " all area between two keyframes", true,
                       found.turned_over.pairs > 0 ? "the normal flips, or is lost for an instant and comes back"
                                                   : "the normal is lost for an instant and comes back");
  troubles.in_segments(
      "turns_far", found.turned_far, " turn", " by more than 90 degrees between two keyframes", false,
      "interpolated normals have their largest errors there; chronormal compare shows how large these are");
  troubles.at_keyframes("sliver", found.slivers, " almost no area at a keyframe",
                        "the faces are so thin that the rounding of positions decides where the normal points");
}

void add_surface_trouble(const Inspected& input, Troubles& troubles) {
  const Inspection& found = *input.inspection;
  const Surface& surface = found.surface;
  troubles.on_surface(
      "non_manifold_edge", surface.non_manifold_edges,
      have(edges(surface.non_manifold_edges.count), surface.non_manifold_edges.count) + " more than two faces",
      "a vertex normal there is the sum over all sheets that meet at the edge; split the vertices to keep the sheets "
      "apart");
  troubles.on_surface("turned_edge", surface.turned_edges,
                      edges(surface.turned_edges.count) + " between faces whose corners run in opposite orders",
                      "their normals point to opposite sides and cancel each other in vertex normals; flip such faces");
  troubles.on_surface(
      "back_to_back", surface.back_to_back,
      counted(surface.back_to_back.count, "pair of faces", "pairs of faces") + " on the same vertices, back to back",
      "their normals cancel each other in vertex normals; give each side vertices of its own");
  troubles.on_surface(
      "doubled_face", surface.doubled_faces,
      have(faces(surface.doubled_faces.count), surface.doubled_faces.count) + " the vertices of another face",
      "such faces count twice in vertex normals; remove one face of each such pair");
  troubles.on_surface(
      "repeating_face", surface.repeating_faces,
      have(faces(surface.repeating_faces.count), surface.repeating_faces.count) + " the same point at two corners",
      "a triangle then has no area, and a larger face counts twice in the vertex normal; remove the repeated corner");
  troubles.on_surface("concave_face", found.cut, counted(found.cut.count, "face is", "faces are") + " not convex",
                      "commands that need triangles cut such a face into triangles that do not overlap");
  std::string meaning =
      "shading has a seam there, unless such vertices share a normal; other commands let them share one, unless "
      "--no-weld is given";
  if (const std::size_t split = input.gltf ? input.gltf->split : 0; split > 0)
    meaning = "shading has a seam there; " + counted(split, "of them is a hard edge", "of them are hard edges") +
              " in the stored normals too";
  troubles.add("doubled_vertex", found.doubled.count,
               have(vertices(found.doubled.count), found.doubled.count) +
                   " the same place as another vertex at all times, along " + edges(surface.seam_edges.count),
               "", std::move(meaning));
  const std::size_t parting = found.doubled_at_start.count - found.doubled.count;
  troubles.add("parting_vertex", parting,
               have(vertices(parting), parting) + " the same place as another vertex at the first keyframe only", "",
               "they separate later, so they must not be merged by their first positions");
}

// Returns the name of a primitive in a motion, such as "Head, primitive 1". Adds the name of the node if several nodes
// have the mesh.
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
  troubles.add(
      "normals_stay", left,
      have(counted(left, "primitive", "primitives"), left) + " targets that move positions but have no normals",
      left_at, "the shading stays as in the base while the shape changes; bake writes the missing normals");
  troubles.add("tangents_stay", tangents,
               have(counted(tangents, "primitive", "primitives"), tangents) +
                   " targets that move positions but have no tangents",
               tangents_at, "viewers apply normal maps as if the base did not move; export the targets with tangents");
  troubles.add("no_normals", flat, have(counted(flat, "primitive", "primitives"), flat) + " no normals", flat_at,
               "viewers shade them flat, with a normal for each face; bake --smooth writes smooth normals");
  troubles.add("off_length", lengths, counted(lengths, "stored normal is", "stored normals are") + " not of length 1",
               length_at, "viewers differ in how they render such normals; scale them to length 1");

  std::size_t beyond = 0;
  double lowest = 0, highest = 1;
  for (const GltfTrackInspection& track : gltf.inspection.tracks) {
    if (track.lowest >= -kRoundedWeight && track.highest <= 1 + kRoundedWeight) continue;
    ++beyond;
    lowest = std::min(lowest, track.lowest);
    highest = std::max(highest, track.highest);
  }
  troubles.add("weights_beyond", input.has_targets() ? beyond : 0,
               counted(beyond, "track", "tracks") + " with weights outside of 0 to 1, from " + with_digits(lowest, 4) +
                   " to " + with_digits(highest, 4),
               "", "targets are only examined here for weights from 0 to 1");
  const std::size_t skinned = gltf.inspection.skinned_nodes;
  troubles.add("skin", skinned, have(counted(skinned, "node", "nodes"), skinned) + " a skin", "",
               "only audit, bake and report apply the skeleton; the results of all other commands are without it");
  const std::size_t without_faces = gltf.inspection.without_faces;
  troubles.add("no_faces", without_faces,
               counted(without_faces, "primitive is", "primitives are") + " points, lines or empty", "",
               "they have no faces, so they are ignored");
  std::size_t unused = 0;
  std::string unused_at;
  for (std::size_t m = 0; m < gltf.inspection.instances.size(); ++m) {
    if (gltf.inspection.instances[m] == 0 && unused++ == 0) unused_at = mesh_label(document, m);
  }
  troubles.add("unused_mesh", unused, counted(unused, "mesh is", "meshes are") + " in no node", unused_at,
               "no scene shows them, but they are examined too");
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
                 "there is no normal, so results have (0, 0, 0) in its place");
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
