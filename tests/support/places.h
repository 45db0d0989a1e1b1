/// The paths that tests need: the program, the sources and the build folder. Only places.cpp is compiled with these
/// paths, so all other object files of the tests are the same in every build.
#ifndef TESTS_SUPPORT_PLACES_H_
#define TESTS_SUPPORT_PLACES_H_

namespace chronormal {

extern const char* const kProgram;       ///< path of the program
extern const char* const kVersion;       ///< the version that the program must print
extern const char* const kSourceFolder;  ///< root of the repository
extern const char* const kBuildFolder;   ///< root of the build
extern const char* const kFaultLayer;    ///< path of the library of tests/faults/fault_layer.cpp

}  // namespace chronormal

#endif  // TESTS_SUPPORT_PLACES_H_
