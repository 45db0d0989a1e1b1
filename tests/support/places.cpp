#include "tests/support/places.h"

namespace chronormal {

const char* const kProgram = CHRONORMAL_PROGRAM;
const char* const kVersion = CHRONORMAL_VERSION;
const char* const kSourceFolder = CHRONORMAL_SOURCE_DIR;
const char* const kBuildFolder = CHRONORMAL_BUILD_DIR;
const char* const kFaultLayer = CHRONORMAL_FAULT_LAYER;

}  // namespace chronormal
