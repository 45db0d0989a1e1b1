/// Programs that show a glTF file, and compressors that rewrite it on the way, with what they make of stored normals.
///
/// The specification wants normalize(N + sum_k w_k D_k), with the weights of the file's tracks. Every viewer here shows
/// normalize(N' + sum_k w'_k D'_k) instead, of what it keeps of N, of D_k and of the weights:
///
///     sum       N' = N, D' = D                             as 32-bit floats, or deltas as 16-bit ones
///     unit      N' = u(N), D' = u(N + D) - u(N)            a unit normal u for each target: the direction of N + D, or
///                                                          through a frame what is no direction if |N + D| is not 1
///     clamped   N' and D' are rounded to signed integers of a few bits that stand for [-1, 1]: larger components of D
///               are cut
///
///     w'        zero where |w| is not above least_weight, and for targets beyond the first most_targets; with
///               weight_bits below 32, weights of tracks are rounded to unsigned integers that stand for [0, 1]
///
/// If |N + D| = 1 and no component of D is beyond 1, viewers of all three rules show the same but for rounding.
///
/// The model leaves out what compressors do to positions, the keys that Godot's importer removes, and that Filament
/// makes its frame of texture coordinates or tangents where there are any, and not of the normal alone.
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

/// Selects how a viewer makes the normal that it shows.
enum class NormalRule { kSum, kUnit, kClamped };

/// Selects how a viewer plays a track of weights. Resampled tracks have 30 samples a second and are linear between them
/// (steps stay steps).
enum class TrackRule {
  kSpecified,               ///< as appendix C of the glTF specification has it
  kSplinesResampled,        ///< CUBICSPLINE from time 0 on, with its last key; others as specified
  kAllResampled,            ///< every track, from the first key of the animation on
  kSplinesWithoutDuration,  ///< CUBICSPLINE with tangents times the part of the time between keys that has gone by
  kSplinesMisread,          ///< CUBICSPLINE by the first third of its numbers, and weights of zero beyond these
};

/// Selects how a viewer takes a normal through the skin of a node (docs/decisions/0022).
enum class SkinRule {
  kBlended,           ///< through the linear part of the blended matrix of the joints
  kInverseTranspose,  ///< through the inverse transpose of that
  kByJoint            ///< through the cofactors of each joint, and blends the unit vectors
};

inline constexpr double kViewerSampleRate = 30;  ///< samples a second of tracks that are resampled

struct Viewer {
  std::string_view name;   ///< on the command line
  std::string_view title;  ///< for people: "three.js", "after gltfpack"
  NormalRule normals = NormalRule::kSum;
  /// The number of bits. sum: of the float that keeps a component of a delta; unit: of each of the two octahedral
  /// numbers that keep a direction, or of the four numbers of a quaternion; clamped: of the integer that keeps a
  /// component, its sign included.
  int bits = 32;
  /// unit: u is the third axis of the rotation that a quaternion has, which is taken from the frame that Frisvad's rule
  /// makes of the vector, as if that were of length 1. (Building an Orthonormal Basis from a 3D Unit Vector Without
  /// Normalization, 2012.)
  bool by_frame = false;
  bool octahedral_base = false;  ///< clamped: N goes through octahedral numbers of as many bits before
  TrackRule tracks = TrackRule::kSpecified;
  SkinRule skins = SkinRule::kBlended;
  int weight_bits = 32;  ///< of a weight in a track
  double least_weight = 0;
  bool adds_tangents = true;     ///< of targets; else the tangents of the base stay, whatever the targets do
  std::size_t most_targets = 0;  ///< of a primitive; 0: no limit is known
  std::string_view beyond = {};  ///< what happens to a file with more targets, where there is a limit
  std::string_view source = {};  ///< where this can be read

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
     .beyond = "the program ends",
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

/// Finds the viewers of a list of names with commas between them, in the order of the list and each once; "all" names
/// the viewers that show a file as it is, which compressors do not.
/// Errors: kUsage for a name that there is none of, with all names, and the nearest one where it is near.
[[nodiscard]] Result<std::vector<Viewer>> find_viewers(std::string_view names);

/// Returns what a viewer keeps of the base normal N; (0, 0, 0) for zero.
[[nodiscard]] Vec3f kept_normal(const Viewer& viewer, const Vec3f& normal) noexcept;

/// Returns what a viewer keeps of the delta D of a target, and adds to kept_normal() for each unit of weight.
[[nodiscard]] Vec3f kept_delta(const Viewer& viewer, const Vec3f& normal, const Vec3f& delta) noexcept;
/// Does the same if the result of kept_normal() is known.
[[nodiscard]] Vec3f kept_delta(const Viewer& viewer, const Vec3f& normal, const Vec3f& kept_normal,
                               const Vec3f& delta) noexcept;

/// Replaces weights that a viewer leaves out by zero. There is one weight for each named target, or for each of all
/// targets if none are named.
void drop_weights(const Viewer& viewer, std::span<double> weights, std::span<const std::size_t> targets = {}) noexcept;

/// Returns the start of the sum of a vertex, to which each target adds its weight times kept_delta() in their order, in
/// float32: N', or zero in viewers of 16-bit floats, which add up deltas alone.
[[nodiscard]] constexpr Vec3f first_of_sum(const Viewer& viewer, const Vec3f& kept_normal) noexcept {
  return viewer.keeps_halves() ? Vec3f{} : kept_normal;
}

/// Returns the unit normal that is shown for a sum; zero, or not finite, if the sum is.
[[nodiscard]] Vec3f shown_of_sum(const Viewer& viewer, const Vec3f& kept_normal, const Vec3f& sum) noexcept;

}  // namespace chronormal

#endif  // CHRONORMAL_WORKFLOW_VIEWERS_H_
