# Compiles the libraries that find_package() normally finds from Debian's sources, which tools/wasm.sh unpacks into
# build/wasm-sources. Only the parts that the product needs are compiled. Header-only libraries come from the system.
#
# The wasm module is built in this way, as are programs for machines on which nothing is installed (CHRONORMAL_STATIC).
enable_language(C)  # for zlib
set(sources ${PROJECT_SOURCE_DIR}/build/wasm-sources)
if(NOT EXISTS ${sources})
  message(FATAL_ERROR "the sources of libraries are not in ${sources}: `./run npm` and `./run dist` get them")
endif()
set(headers ${PROJECT_BINARY_DIR}/headers)
file(MAKE_DIRECTORY ${headers})
# Only these headers of /usr/include are used, since others may not fit the target system.
foreach(header fmt CLI nlohmann fast_float)
  file(CREATE_LINK /usr/include/${header} ${headers}/${header} SYMBOLIC)
endforeach()

# chronormal_source_library(NAME FOLDER FILES...): makes a library from files in a folder of the sources.
function(chronormal_source_library name folder)
  file(GLOB root ${sources}/${folder})
  list(TRANSFORM ARGN PREPEND ${root}/ OUTPUT_VARIABLE patterns)
  file(GLOB files ${patterns})
  list(FILTER files EXCLUDE REGEX "_test\\.cc$|_test_utils\\.cc$")
  add_library(${name} STATIC ${files})
  target_compile_options(${name} PRIVATE -w)
  set(root ${root} PARENT_SCOPE)
endfunction()

chronormal_source_library(hwy highway-* hwy/targets.cc hwy/per_target.cc hwy/aligned_allocator.cc)
target_include_directories(hwy SYSTEM PUBLIC ${root})
add_library(hwy::hwy ALIAS hwy)

chronormal_source_library(zlib zlib-* adler32.c crc32.c deflate.c inffast.c inflate.c inftrees.c trees.c zutil.c
                          compress.c uncompr.c)
target_include_directories(zlib SYSTEM PUBLIC ${root})
add_library(ZLIB::ZLIB ALIAS zlib)

chronormal_source_library(pugixml pugixml-* src/pugixml.cpp)
target_include_directories(pugixml SYSTEM PUBLIC ${root}/src)
add_library(pugixml::pugixml ALIAS pugixml)

chronormal_source_library(meshoptimizer meshoptimizer-* src/indexcodec.cpp src/vertexcodec.cpp src/vertexfilter.cpp
                          src/simplifier.cpp src/clusterizer.cpp src/allocator.cpp)
target_include_directories(meshoptimizer SYSTEM PUBLIC ${root}/src)
add_library(meshoptimizer::meshoptimizer ALIAS meshoptimizer)

# Compiles only the parts of Draco that a decoder needs.
set(code src/draco/compression)
chronormal_source_library(
  draco draco-* src/draco/attributes/*.cc src/draco/core/*.cc src/draco/mesh/*.cc src/draco/point_cloud/*.cc
  src/draco/metadata/*.cc ${code}/decode.cc ${code}/attributes/*decoder*.cc ${code}/bit_coders/*decoder.cc
  ${code}/entropy/*.cc ${code}/mesh/*decoder*.cc ${code}/point_cloud/*decoder.cc
  ${code}/point_cloud/algorithms/*decoder.cc ${code}/point_cloud/algorithms/point_cloud_compression_method.cc)
set(features "")
foreach(feature POINT_CLOUD_COMPRESSION MESH_COMPRESSION NORMAL_ENCODING STANDARD_EDGEBREAKER PREDICTIVE_EDGEBREAKER
                BACKWARDS_COMPATIBILITY ATTRIBUTE_INDICES_DEDUPLICATION ATTRIBUTE_VALUES_DEDUPLICATION)
  string(APPEND features "#define DRACO_${feature}_SUPPORTED\n")
endforeach()
file(CONFIGURE OUTPUT ${headers}/draco/draco_features.h CONTENT "${features}")
target_include_directories(draco SYSTEM PUBLIC ${root}/src ${headers})
add_library(draco::draco ALIAS draco)

foreach(name nlohmann_json::nlohmann_json CLI11::CLI11 fmt::fmt)
  add_library(${name} INTERFACE IMPORTED GLOBAL)
  target_include_directories(${name} INTERFACE ${headers})
endforeach()
target_compile_definitions(fmt::fmt INTERFACE FMT_HEADER_ONLY)
