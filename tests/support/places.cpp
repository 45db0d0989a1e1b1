#include "tests/support/places.h"

namespace chronormal {

const char* const kProgram = CHRONORMAL_PROGRAM;
const char* const kVersion = CHRONORMAL_VERSION;
const char* const kSourceFolder = CHRONORMAL_SOURCE_DIR;
const char* const kBuildFolder = CHRONORMAL_BUILD_DIR;

}  // namespace chronormal
