/// Checks invariants of everything that can be read from a glTF file, for any bytes. The tests use these checks too.
#ifndef CHRONORMAL_FUZZ_GLTF_INVARIANTS_H_
#define CHRONORMAL_FUZZ_GLTF_INVARIANTS_H_

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/io/gltf_document.h"
#include "chronormal/motion/motion.h"
#include "io/gltf/gltf_motion.h"

namespace chronormal::fuzz {

/// The result of reading every part of a glTF file, with the errors of the parts that could not be read.
class GltfReading {
 public:
  std::vector<Error> errors;    ///< in the order in which they occurred
  std::size_t motions = 0;      ///< number of motions that were read, of targets and animations
  bool has_mesh = false;        ///< true if read_gltf_mesh() had a result
  std::vector<Error> no_moves;  ///< errors of valid files without motion or faces
  std::string broken;           ///< the first invariant that does not hold; empty if all do

  void require(bool condition, const char* what) {
    if (!condition && broken.empty()) broken = what;
  }
};

namespace detail {

inline bool all_finite(const auto& values) {
  return std::all_of(values.begin(), values.end(), [](auto x) { return std::isfinite(x); });
}

inline bool is_index_or_none(const auto& index, std::size_t count) { return !index || *index < count; }

inline void check_structure(const GltfDocument& document, GltfReading& reading) {
  for (const GltfMesh& mesh : document.meshes()) {
    reading.require(!mesh.primitives.empty(), "the mesh has no primitives");
    reading.require(mesh.weights.size() == mesh.target_count && all_finite(mesh.weights), "a target has one weight");
    reading.require(mesh.target_names.empty() || mesh.target_names.size() == mesh.target_count, "all names or none");
    for (const GltfPrimitive& primitive : mesh.primitives) {
      reading.require(primitive.mode >= 0 && primitive.mode <= 6, "a mode is known");
      reading.require(primitive.targets.size() == mesh.target_count, "all primitives have the targets of the mesh");
    }
  }
  for (const GltfNode& node : document.nodes()) {
    reading.require(is_index_or_none(node.mesh, document.meshes().size()), "the mesh of a node is there");
    reading.require(is_index_or_none(node.parent, document.nodes().size()), "the parent of a node is there");
    reading.require(
        node.weights.empty() || (node.mesh && node.weights.size() == document.meshes()[*node.mesh].target_count),
        "a node has weights for the targets of its mesh");
    reading.require(all_finite(node.weights), "weights are finite");
  }
  for (const GltfAnimation& animation : document.animations()) {
    reading.require(animation.tracks.size() <= animation.channel_count, "a track is a channel");
    for (const GltfTrack& track : animation.tracks) {
      reading.require(track.node < document.nodes().size(), "the node of a track is there");
      reading.require(track.channel < animation.channel_count, "the channel of a track is there");
      reading.require(track.key_count > 0, "a track has a key");
    }
  }
}

inline void check_geometry(const GltfPrimitive& primitive, const GltfGeometry& geometry, GltfReading& reading) {
  const std::size_t vertices = primitive.vertex_count;
  const auto is_plane = [&](const std::vector<float>& values, std::size_t width) {
    return values.size() == width * vertices && all_finite(values);
  };
  const auto is_plane_or_none = [&](const std::vector<float>& values, std::size_t width) {
    return values.empty() || is_plane(values, width);
  };
  reading.require(geometry.corners.size() % 3 == 0, "three corners make a face");
  reading.require(std::all_of(geometry.corners.begin(), geometry.corners.end(),
                              [&](std::uint32_t corner) { return corner < vertices; }),
                  "corners name vertices");
  reading.require(is_plane(geometry.positions, 3), "positions are there");
  reading.require(is_plane_or_none(geometry.normals, 3) && is_plane_or_none(geometry.tangents, 4), "shading fits");
  reading.require(geometry.targets.size() == primitive.targets.size(), "targets are there");
  for (const GltfGeometry::Target& target : geometry.targets) {
    for (const std::vector<float>* deltas : {&target.positions, &target.normals, &target.tangents})
      reading.require(is_plane_or_none(*deltas, 3), "deltas fit");
  }
}

inline void check_keys(const GltfTrack& track, std::size_t target_count, const GltfKeys& keys, GltfReading& reading) {
  const std::size_t per_key = (track.interpolation == GltfInterpolation::kCubicSpline ? 3 : 1) * target_count;
  reading.require(keys.times.size() == track.key_count, "a key has a time");
  reading.require(std::adjacent_find(keys.times.begin(), keys.times.end(),
                                     [](double a, double b) { return !(a < b); }) == keys.times.end(),
                  "times ascend");
  reading.require(keys.values.size() == track.key_count * per_key, "a key has values");
  reading.require(all_finite(keys.times) && all_finite(keys.values), "keys are finite");
}

inline void check_parts(const GltfDocument& document, const GltfMotion& result, GltfReading& reading) {
  std::size_t vertices = 0, faces = 0;
  for (const GltfPart& part : result.parts) {
    reading.require(is_index_or_none(part.node, document.nodes().size()), "the node of a part is there");
    reading.require(part.mesh < document.meshes().size(), "the mesh of a part is there");
    if (!reading.broken.empty()) return;
    reading.require(part.primitive < document.meshes()[part.mesh].primitives.size(), "the primitive is there");
    reading.require(part.first_vertex == vertices && part.first_face == faces, "parts follow each other");
    vertices += part.vertex_count;
    faces += part.face_count;
  }
  reading.require(vertices == result.motion.topology.vertex_count(), "every vertex is in a part");
  reading.require(faces == result.motion.topology.face_count(), "every face is in a part");
  reading.require(std::isfinite(result.curve_error) && result.curve_error >= 0, "the error is a bound");
  for (const Motion::Keyframe& keyframe : result.motion.keyframes)
    reading.require(keyframe.positions.size() == 3 * vertices && all_finite(keyframe.positions), "keyframes are there");
}

inline void add_error(const std::string& name, const Error& error, GltfReading& reading) {
  reading.require(error.code == ErrorCode::kInvalidInput, "the code of an error is kInvalidInput");
  reading.require(!error.message.empty(), "an error has a message");
  const std::string_view place = error.place;
  reading.require(place.starts_with(name), "an error names the file");
  // If a file has nothing to read, the place of the error is only the name of the file.
  if (place == name) return reading.no_moves.push_back(error);
  const std::string_view rest = place.substr(std::min(place.size(), name.size()));
  reading.require(rest.starts_with(", /") || rest.starts_with(", byte "), "an error has a JSON pointer or a byte");
  reading.errors.push_back(error);
}

}  // namespace detail

/// Reads everything in a file: every primitive with its shading, every track, the mesh, and every motion. Returns what
/// was found, with the errors.
[[nodiscard]] inline GltfReading read_all_of(const Result<GltfDocument>& opened, const std::string& name,
                                             std::size_t most_bytes) {
  GltfReading reading;
  if (!opened) {
    detail::add_error(name, opened.error(), reading);
    return reading;
  }
  const GltfDocument& document = opened.value();
  detail::check_structure(document, reading);
  if (!reading.broken.empty()) return reading;
  for (std::size_t m = 0; m < document.meshes().size(); ++m) {
    for (std::size_t p = 0; p < document.meshes()[m].primitives.size(); ++p) {
      const GltfPrimitive& primitive = document.meshes()[m].primitives[p];
      if (!primitive.has_faces()) continue;
      const Result<GltfGeometry> geometry = document.geometry(m, p, {true, true});
      if (geometry)
        detail::check_geometry(primitive, geometry.value(), reading);
      else
        detail::add_error(name, geometry.error(), reading);
    }
  }
  GltfMotionOptions options;
  options.most_bytes = most_bytes;
  const auto read_motion = [&] {
    const Result<GltfMotion> motion = read_gltf_motion(document, options);
    if (!motion) return detail::add_error(name, motion.error(), reading);
    ++reading.motions;
    reading.require(validate(motion.value().motion).ok(), "a motion that was read is valid");
    reading.require(
        motion.value().motion.keyframes.size() * motion.value().motion.topology.vertex_count() * 12 <= most_bytes,
        "keyframes keep to the memory allowed");
    detail::check_parts(document, motion.value(), reading);
  };
  read_motion();
  for (std::size_t a = 0; a < document.animations().size(); ++a) {
    const GltfAnimation& animation = document.animations()[a];
    for (std::size_t t = 0; t < animation.tracks.size(); ++t) {
      const GltfTrack& track = animation.tracks[t];
      const Result<GltfKeys> keys = document.keys(a, t);
      if (!keys) {
        detail::add_error(name, keys.error(), reading);
        continue;
      }
      const auto mesh = document.nodes()[track.node].mesh;
      reading.require(mesh.has_value(), "a track drives a mesh");
      if (mesh) detail::check_keys(track, document.meshes()[*mesh].target_count, keys.value(), reading);
    }
    // If the name of another animation is this number, the option selects that animation, which is then read twice.
    options.animation = std::to_string(a);
    read_motion();
  }
  if (const Result<GltfMotion> mesh = read_gltf_mesh(document); mesh) {
    reading.has_mesh = true;
    reading.require(mesh.value().motion.keyframes.size() == 1 && mesh.value().motion.segments.empty(), "one keyframe");
    detail::check_parts(document, mesh.value(), reading);
  } else {
    detail::add_error(name, mesh.error(), reading);
  }
  return reading;
}

}  // namespace chronormal::fuzz

#endif  // CHRONORMAL_FUZZ_GLTF_INVARIANTS_H_
