// The glTF files of the real data that pages are written about, and results that such a page cannot do without.
#ifndef SUPPORT_OTHER_FILES_H_
#define SUPPORT_OTHER_FILES_H_

#include <stdexcept>
#include <utility>

#include "chronormal/core/result.h"

namespace chronormal::pages {

// Below the folder that CHRONORMAL_DATA names: all whose targets turn stored normals, but for those that take minutes.
inline constexpr const char* kOtherFiles[] = {
    "gltf/AnimatedMorphCube/glTF/AnimatedMorphCube.gltf",
    "gltf/AnimatedMorphSphere/glTF/AnimatedMorphSphere.gltf",
    "gltf/MorphPrimitivesTest/glTF/MorphPrimitivesTest.gltf",
    "gltf/MorphStressTest/glTF/MorphStressTest.gltf",
    "gltf/RobotExpressive/RobotExpressive.glb",
    "gltf/blenderio_01_cs_morph/01_cs_morph.gltf",
    "gltf/blenderio_01_morphed_cube/01_morphed_cube.gltf",
    "rigs/blender_suzanne_two_keys.glb",
};

// The value, or an exception with the words of the error.
template <class T>
T value_of(Result<T> result) {
  if (!result) throw std::runtime_error(result.error().text());
  return std::move(result).value();
}

}  // namespace chronormal::pages

#endif  // SUPPORT_OTHER_FILES_H_
