/// Viewers and their rules for stored normals. A viewer is a program that shows a glTF file, or a compressor, which
/// rewrites the file before it is shown.
///
/// The specification demands normalize(N + sum_k w_k D_k), with the weights of the file's tracks. Every viewer here
/// renders normalize(N' + sum_k w'_k D'_k) instead, where N', D'_k and w'_k are the values that the viewer stores:
///
///     sum       N' = N, D' = D                             as 32-bit floats, or deltas as 16-bit ones
///     unit      N' = u(N), D' = u(N + D) - u(N)            a unit normal u for each target: the direction of N + D, or
///               with by_frame a different vector if |N + D| is not 1
///     clamped   N' and D' are rounded to signed integers of a few bits that stand for [-1, 1]: larger components of D
///               are cut
///
///     w'        zero if |w| is at most least_weight, and for targets beyond the first most_targets; with
///               weight_bits below 32, weights of tracks are rounded to unsigned integers that stand for [0, 1]
///
/// If |N + D| = 1 and no component of D exceeds 1, viewers of all three rules render the same up to rounding.
///
/// The model does not include changes of positions by compressors, the keys that Godot's importer removes, and
/// Filament's use of texture coordinates or tangents for its frame if there are any.
///
/// Threads    everything here is pure
#ifndef CHRONORMAL_WORKFLOW_VIEWERS_H_
#define CHRONORMAL_WORKFLOW_VIEWERS_H_

#include <array>
#include <cstddef>
#include <span>
#include <string_view>
#include <vector>

#include "chronormal/core/result.h"
#include "chronormal/core/vec3.h"

namespace chronormal {

/// The rules by which viewers compute the rendered normal from stored normals and deltas: kSum adds deltas to normals
/// as stored, kUnit first makes a unit normal for each target, and kClamped first rounds normals and deltas to integers
/// that stand for [-1, 1]. The formulas are at the top of this file.
enum class NormalRule { kSum, kUnit, kClamped };

/// The rules by which viewers play a track of weights. A resampled track has kViewerSampleRate values per second. A
/// viewer interpolates between these values linearly, or not at all if the track is a STEP track.
enum class TrackRule {
  kSpecified,  ///< tracks are played as appendix C of the glTF specification demands
  /// A CUBICSPLINE track is resampled from time 0 to its last key; other tracks are played as specified.
  kSplinesResampled,
  kAllResampled,  ///< every track is resampled, from the first key of the animation on
  /// Tangents of a CUBICSPLINE track are multiplied by the elapsed share of the time between two keys, from 0 to 1,
  /// instead of by the whole time between these keys.
  kSplinesWithoutDuration,
  /// Only the in-tangents of a CUBICSPLINE track are taken, and read as the in-tangent, value and out-tangent of each
  /// key. The weights of later keys, for which no numbers are left, are zero.
  kSplinesMisread,
};

/// The rules by which viewers transform a normal by the skin of a node (docs/decisions/0022).
enum class SkinRule {
  kBlended,           ///< transforms by the linear part of the blended matrix of the joints
  kInverseTranspose,  ///< transforms by the inverse transpose of that linear part
  kByJoint            ///< transforms by the cofactors of each joint, and then blends the unit vectors
};

inline constexpr double kViewerSampleRate = 30;  ///< number of samples per second of resampled tracks

struct Viewer {
  std::string_view name;   ///< the name on the command line
  std::string_view title;  ///< the name for users: "three.js", "after gltfpack"
  NormalRule normals = NormalRule::kSum;
  /// The number of bits of a stored number. For kSum, the number is the float that stores a component of a delta. For
  /// kUnit, the number is one of the two octahedral numbers that store a direction, or one of the four numbers of a
  /// quaternion. For kClamped, the number is the integer that stores a component, including the sign.
  int bits = 32;
  /// For kUnit, true if u is the third axis of the rotation of a stored quaternion. The quaternion stands for the frame
  /// that Frisvad's rule makes from the vector N or N + D. The rule is meant for unit vectors, but viewers apply the
  /// rule to vectors of any length. (Building an Orthonormal Basis from a 3D Unit Vector Without Normalization, 2012.)
  bool by_frame = false;
  bool octahedral_base = false;  ///< for kClamped: N is first rounded to octahedral numbers with as many bits
  TrackRule tracks = TrackRule::kSpecified;
  SkinRule skins = SkinRule::kBlended;
  int weight_bits = 32;  ///< number of bits of a weight in a track
  double least_weight = 0;
  bool adds_tangents = true;     ///< true to add up tangents of targets; otherwise the tangents of the base are used
  std::size_t most_targets = 0;  ///< largest number of targets of a primitive; 0 if there is no known limit
  /// A description of how the viewer treats a file with more than most_targets targets, if the viewer has such a limit.
  std::string_view beyond = {};
  std::string_view source = {};  ///< the place where this behaviour is documented

  [[nodiscard]] constexpr bool keeps_halves() const noexcept { return normals == NormalRule::kSum && bits == 16; }
  friend bool operator==(const Viewer& a, const Viewer& b) noexcept { return a.name == b.name; }
};

inline constexpr std::array<Viewer, 9> kViewers = {{
    {.name = "three",
     .title = "three.js",
     .adds_tangents = false,
     .source = "three.js r187, src/renderers/shaders/ShaderChunk/morphnormal_vertex.glsl.js and "
               "skinnormal_vertex.glsl.js, and examples/jsm/loaders/GLTFLoader.js"},
    {.name = "babylon",
     .title = "Babylon.js",
     .source = "Babylon.js 9.28, packages/dev/core/src/Shaders/ShadersInclude/morphTargetsVertex.fx and "
               "bonesVertex.fx"},
    {.name = "playcanvas",
     .title = "PlayCanvas",
     .bits = 16,
     .tracks = TrackRule::kSplinesMisread,
     .least_weight = 1e-5,
     .adds_tangents = false,
     .source = "PlayCanvas 2.23, src/scene/morph.js, src/scene/morph-instance.js, "
               "src/scene/shader-lib/glsl/chunks/common/vert/normalCore.js, "
               "src/framework/parsers/glb-parser.js (createMorphTargetCurves) and "
               "src/framework/anim/evaluator/anim-cache.js"},
    {.name = "godot",
     .title = "Godot 4",
     .normals = NormalRule::kUnit,
     .bits = 16,
     .tracks = TrackRule::kSplinesResampled,
     .least_weight = 1e-4,
     .source = "Godot 4, modules/gltf/gltf_document.cpp (_parse_meshes, _import_animation) and "
               "servers/rendering/renderer_rd/shaders/skeleton.glsl"},
    {.name = "filament",
     .title = "Filament",
     .normals = NormalRule::kUnit,
     .bits = 16,
     .by_frame = true,
     .tracks = TrackRule::kSplinesWithoutDuration,
     .skins = SkinRule::kByJoint,
     .most_targets = 256,
     .beyond = "the viewer exits",
     .source =
         "Filament 1.53, shaders/src/surface_getters.vs (morphNormal, skinNormal), libs/gltfio/src/TangentsJob.cpp, "
         "libs/geometry/src/SurfaceOrientation.cpp, libs/math/include/math/mat3.h (packTangentFrame), "
         "libs/gltfio/include/gltfio/math.h (cubicSpline) and CONFIG_MAX_MORPH_TARGET_COUNT of EngineEnums.h"},
    {.name = "bevy",
     .title = "Bevy",
     .skins = SkinRule::kInverseTranspose,
     .most_targets = 256,
     .beyond = "the file is refused",
     .source =
         "Bevy, crates/bevy_pbr/src/render/mesh.wgsl and skinning.wgsl, crates/bevy_animation/src/gltf_curves.rs and "
         "MAX_MORPH_WEIGHTS of crates/bevy_mesh/src/morph.rs"},
    {.name = "gltfpack",
     .title = "after gltfpack",
     .normals = NormalRule::kClamped,
     .bits = 8,
     .tracks = TrackRule::kAllResampled,
     .weight_bits = 8,
     .source = "gltfpack 1.3 without options, gltf/stream.cpp (writeVertexStream, writeKeyframeStream) and "
               "gltf/animation.cpp"},
    {.name = "quantize",
     .title = "after quantize",
     .normals = NormalRule::kClamped,
     .bits = 10,
     .source = "glTF Transform 4.5 quantize without options, packages/functions/src/quantize.ts"},
    {.name = "meshopt",
     .title = "after meshopt",
     .normals = NormalRule::kClamped,
     .bits = 8,
     .octahedral_base = true,
     .source = "glTF Transform 4.5 meshopt without options, packages/functions/src/meshopt.ts and "
               "packages/extensions/src/ext-meshopt-compression/encoder.ts"},
}};

/// Finds the viewers in a list of names or titles with commas between them, in the order of the list and each once.
/// Upper case and blanks around a name do not matter. "all" selects the viewers that show a file unchanged, which
/// leaves out compressors. Errors: kUsage for an unknown name; the message has all names, and the most similar name if
/// there is one.
[[nodiscard]] Result<std::vector<Viewer>> find_viewers(std::string_view names);

/// Returns the value N' that a viewer stores for the base normal N; (0, 0, 0) if N is zero.
[[nodiscard]] Vec3f kept_normal(const Viewer& viewer, const Vec3f& normal) noexcept;

/// Returns the value D' that a viewer stores for the delta D of a target. For each unit of the target's weight, a
/// viewer adds D' to kept_normal().
[[nodiscard]] Vec3f kept_delta(const Viewer& viewer, const Vec3f& normal, const Vec3f& delta) noexcept;
/// Returns the same value as kept_delta() above, for callers that already have `kept_normal`, the result of
/// kept_normal().
[[nodiscard]] Vec3f kept_delta(const Viewer& viewer, const Vec3f& normal, const Vec3f& kept_normal,
                               const Vec3f& delta) noexcept;

/// Sets to zero the weights that a viewer ignores. `weights` has a weight for each target in `targets`, or for every
/// target of the mesh if `targets` is empty.
void drop_weights(const Viewer& viewer, std::span<double> weights, std::span<const std::size_t> targets = {}) noexcept;

/// Returns the vector with which a viewer begins to add up the normal of a vertex. The vector is N', or zero in viewers
/// with 16-bit floats, which sum deltas separately. Each target in turn adds its weight times kept_delta() to this
/// vector, in float32.
[[nodiscard]] constexpr Vec3f first_of_sum(const Viewer& viewer, const Vec3f& kept_normal) noexcept {
  return viewer.keeps_halves() ? Vec3f{} : kept_normal;
}

/// Return the normal that a viewer renders, computed from the sum at a vertex (first_of_sum() and the weighted deltas).
/// vector_of_sum() returns a vector in the direction of the normal, and shown_of_sum() the unit normal. The result is
/// zero or not finite if the sum is.
[[nodiscard]] Vec3f vector_of_sum(const Viewer& viewer, const Vec3f& kept_normal, const Vec3f& sum) noexcept;
[[nodiscard]] Vec3f shown_of_sum(const Viewer& viewer, const Vec3f& kept_normal, const Vec3f& sum) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_VIEWERS_H_
