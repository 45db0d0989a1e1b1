# Adds the targets of the product: libraries and the program. The function chronormal_add_product() defines these
# targets. The targets are built once for users and, if tests are built, once more with sanitizers for the tests.
#
#   chronormal       core, simd, motion, normals, schemes, analysis
#   chronormal_io    io and workflow                                      (CHRONORMAL_IO)
#   chronormal_c     a shared library with the functions of chronormal_c.h for C   (CHRONORMAL_C)
#   chronormal_cli   the program                                          (CHRONORMAL_PROGRAM)
if(EMSCRIPTEN)
  include(cmake/wasm.cmake)
elseif(CHRONORMAL_STATIC)
  set(CMAKE_POSITION_INDEPENDENT_CODE ON)
  include(cmake/sources.cmake)
else()
  find_package(hwy QUIET)
endif()
if(NOT EMSCRIPTEN)
  find_package(Threads REQUIRED)
endif()
if(TARGET hwy::hwy)
  set(has_highway ON)
else()
  set(has_highway OFF)
  message(STATUS "Google Highway was not found (Debian: libhwy-dev): kernels are plain C++, of one instruction set")
endif()
option(CHRONORMAL_HIGHWAY "Compile kernels with Google Highway, for every instruction set; OFF: in plain C++" ${has_highway})
if(CHRONORMAL_HIGHWAY AND NOT has_highway)
  message(FATAL_ERROR "CHRONORMAL_HIGHWAY is ON, and Google Highway was not found (Debian: libhwy-dev)")
endif()
if(CHRONORMAL_IO AND NOT TARGET ZLIB::ZLIB)
  find_package(ZLIB REQUIRED)
  find_package(pugixml REQUIRED)
  find_package(nlohmann_json REQUIRED)
  find_package(meshoptimizer REQUIRED)
  find_package(draco REQUIRED)
endif()
if(CHRONORMAL_PROGRAM AND NOT TARGET fmt::fmt)
  find_package(CLI11 REQUIRED)
  find_package(fmt REQUIRED)
endif()

file(GLOB_RECURSE library_sources CONFIGURE_DEPENDS src/core/*.cpp src/simd/*.cpp src/motion/*.cpp src/normals/*.cpp
                                                    src/schemes/*.cpp src/analysis/*.cpp)
set(kernel_sources ${library_sources})
list(FILTER kernel_sources INCLUDE REGEX "/kernels/")
file(GLOB_RECURSE io_sources CONFIGURE_DEPENDS src/io/*.cpp src/workflow/*.cpp)
file(GLOB_RECURSE cli_sources CONFIGURE_DEPENDS cli/*.cpp)
if(CHRONORMAL_MPI)
  set(MPI_CXX_SKIP_MPICXX ON)  # only the interface of MPI for C is used
  find_package(MPI REQUIRED COMPONENTS CXX)
  list(FILTER cli_sources EXCLUDE REGEX "/ranks/alone\\.cpp$")
else()
  list(FILTER cli_sources EXCLUDE REGEX "/ranks/mpi\\.cpp$")
endif()
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR STREQUAL "aarch64")
  # Without these options, GCC 12 for 64-bit ARM stops with an internal error in vect_transform_reduction.
  set_source_files_properties(src/workflow/bake/sequence/fewest_keys.cpp
                              PROPERTIES COMPILE_OPTIONS -fno-tree-vectorize SKIP_UNITY_BUILD_INCLUSION ON)
endif()
# The headers of Windows define macros with common names, so windows.cpp is compiled alone.
set_source_files_properties(src/io/system/windows.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
set_source_files_properties(src/io/gltf/glb/glb_builder.cpp src/workflow/json/json.cpp
                            PROPERTIES COMPILE_DEFINITIONS CHRONORMAL_VERSION="${PROJECT_VERSION}")
if(CHRONORMAL_REPORT_PAGE)
  set_source_files_properties(cli/commands/built_in_page.cpp PROPERTIES OBJECT_DEPENDS ${CHRONORMAL_REPORT_PAGE}
                              COMPILE_DEFINITIONS CHRONORMAL_REPORT_PAGE="${CHRONORMAL_REPORT_PAGE}")
endif()

# chronormal_compile_together(TARGET SOURCES...): with CHRONORMAL_UNITY, compiles up to eight files of a folder as one,
# so that the compiler reads their headers and instantiates their templates only once. Files of different folders are
# never combined, so private names may be equal in different folders. Kernels, which are compiled once for every
# instruction set, and files with their own options are compiled separately.
function(chronormal_compile_together target)
  if(NOT CHRONORMAL_UNITY)
    return()
  endif()
  set(folders "")
  foreach(source ${ARGN})
    get_filename_component(folder ${source} DIRECTORY)
    list(APPEND folders ${folder})
  endforeach()
  list(REMOVE_DUPLICATES folders)
  foreach(folder ${folders})
    set(sources ${ARGN})
    list(FILTER sources INCLUDE REGEX "^${folder}/[^/]+$")
    list(LENGTH sources count)
    math(EXPR groups "(${count} + 7) / 8")
    math(EXPR size "(${count} + ${groups} - 1) / ${groups}")
    set(i 0)
    foreach(source ${sources})
      math(EXPR group "${i} / ${size}")
      math(EXPR i "${i} + 1")
      file(STRINGS ${source} targets REGEX "simd/foreach_target-inl.h")
      if(targets)
        set_source_files_properties(${source} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
      else()
        string(REGEX REPLACE "[^a-z0-9]" "_" name "${folder}")
        set_source_files_properties(${source} PROPERTIES UNITY_GROUP "${name}_${group}")
      endif()
    endforeach()
  endforeach()
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  # If files are compiled as one, GCC takes private types of one .cpp file for types of a header, and warns about them.
  target_compile_options(${target} PRIVATE $<$<CXX_COMPILER_ID:GNU>:-Wno-subobject-linkage>)
endfunction()

# The static libraries can be linked into a shared object, such as an engine's plugin, which then exports none of their
# names.
set(position_independent ON)
if(EMSCRIPTEN)
  # A wasm module is never loaded as a library, and is smaller without position-independent code.
  set(position_independent OFF)
endif()
set(linkable POSITION_INDEPENDENT_CODE ${position_independent} CXX_VISIBILITY_PRESET hidden VISIBILITY_INLINES_HIDDEN ON CXX_EXTENSIONS OFF)

# chronormal_add_product(SUFFIX FLAGS): adds the targets of the product. Their names end with this suffix, and they are
# compiled with the options of the interface library FLAGS.
function(chronormal_add_product suffix flags)
  add_library(chronormal${suffix} STATIC ${library_sources})
  target_include_directories(chronormal${suffix} PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                        $<INSTALL_INTERFACE:include> PRIVATE src)
  target_compile_features(chronormal${suffix} PUBLIC cxx_std_20)
  set_target_properties(chronormal${suffix} PROPERTIES ${linkable})
  chronormal_compile_together(chronormal${suffix} ${library_sources})
  target_link_libraries(chronormal${suffix} PRIVATE $<BUILD_INTERFACE:${flags}>)
  if(CHRONORMAL_HIGHWAY)
    target_link_libraries(chronormal${suffix} PRIVATE hwy::hwy)
    # Kernels are compiled for four levels of x86-64: baseline (Highway's plain C++), SSE4, AVX2 and AVX-512. Vectors
    # whose size the compiler does not know (SVE) cannot be members of structs, which our kernels need.
    target_compile_definitions(
      chronormal${suffix}
      PRIVATE CHRONORMAL_HIGHWAY "HWY_DISABLED_TARGETS=(HWY_SSSE3|HWY_AVX3_DL|HWY_SVE|HWY_SVE2|HWY_SVE_256|HWY_SVE2_128|HWY_RVV)")
    if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND CMAKE_SYSTEM_PROCESSOR MATCHES "aarch64|arm64")
      # Highway enables the crypto instructions by a pragma, but GCC 12 ignores the pragma in constructors that the
      # compiler generates.
      target_compile_options(chronormal${suffix} PRIVATE -march=armv8-a+crypto)
    endif()
  endif()
  if(NOT EMSCRIPTEN)
    target_link_libraries(chronormal${suffix} PRIVATE Threads::Threads)
  endif()

  if(EMSCRIPTEN)
    target_link_libraries(chronormal${suffix} PRIVATE fmt::fmt)  # fmt writes numbers as text
    target_compile_options(chronormal${suffix} PRIVATE -msimd128)
  endif()

  if(NOT CHRONORMAL_IO)
    return()
  endif()
  add_library(chronormal_io${suffix} STATIC ${io_sources})
  set_target_properties(chronormal_io${suffix} PROPERTIES ${linkable})
  chronormal_compile_together(chronormal_io${suffix} ${io_sources})
  # Most files include these headers, so the headers are parsed once for all of them. Each file must still include the
  # headers that it uses; ./test --full clang checks this.
  target_precompile_headers(chronormal_io${suffix} PRIVATE <algorithm> <functional> <map> <memory> <optional> <string> <string_view>
                                                           <vector> <nlohmann/json.hpp>)
  target_include_directories(chronormal_io${suffix} PRIVATE src)
  target_link_libraries(chronormal_io${suffix} PUBLIC chronormal${suffix}
                                               PRIVATE $<BUILD_INTERFACE:${flags}> ZLIB::ZLIB pugixml::pugixml
                                                       $<BUILD_INTERFACE:nlohmann_json::nlohmann_json>
                                                       meshoptimizer::meshoptimizer draco::draco)

  if(NOT CHRONORMAL_PROGRAM)
    return()
  endif()
  add_executable(chronormal_cli${suffix} ${cli_sources})
  set_target_properties(chronormal_cli${suffix} PROPERTIES OUTPUT_NAME chronormal${suffix})
  chronormal_compile_together(chronormal_cli${suffix} ${cli_sources})
  target_precompile_headers(chronormal_cli${suffix} PRIVATE <algorithm> <functional> <map> <memory> <optional> <string> <string_view>
                                                            <vector> <fmt/format.h> <nlohmann/json.hpp>)
  # The program is compiled for size, since all loops that take time are in the libraries.
  if(EMSCRIPTEN)
    target_compile_options(chronormal_cli${suffix} PRIVATE ${for_size})
  elseif(PROJECT_IS_TOP_LEVEL)
    target_compile_options(chronormal_cli${suffix} PRIVATE $<$<CONFIG:Release>:-O1>)
  endif()
  target_include_directories(chronormal_cli${suffix} PRIVATE . src)
  target_compile_definitions(chronormal_cli${suffix} PRIVATE CHRONORMAL_VERSION="${PROJECT_VERSION}")
  target_link_libraries(chronormal_cli${suffix} PRIVATE chronormal_io${suffix} ${flags} CLI11::CLI11 fmt::fmt
                                                        nlohmann_json::nlohmann_json)
  if(WIN32)
    # On Windows, the main thread gets as much stack as on Linux.
    target_link_options(chronormal_cli${suffix} PRIVATE -static -Wl,--stack,8388608)
  elseif(CHRONORMAL_STATIC)
    # The program is linked with -static-pie, so that the system may load it at any address.
    target_link_options(chronormal_cli${suffix} PRIVATE -static-pie)
  endif()
  if(CHRONORMAL_MPI)
    target_link_libraries(chronormal_cli${suffix} PRIVATE MPI::MPI_CXX)
  endif()
endfunction()

chronormal_add_product("" chronormal_product_flags)
# The names of the targets are the same in this build tree and in an installed package.
add_library(chronormal::chronormal ALIAS chronormal)
if(CHRONORMAL_IO)
  add_library(chronormal::chronormal_io ALIAS chronormal_io)
endif()
if(CHRONORMAL_C)
  set(symbols ${PROJECT_SOURCE_DIR}/capi/chronormal_c.map)
  add_library(chronormal_c SHARED capi/chronormal_c.cpp)
  set_target_properties(chronormal_c PROPERTIES ${linkable} VERSION ${PROJECT_VERSION} SOVERSION 0 LINK_DEPENDS ${symbols})
  target_include_directories(chronormal_c PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include>
                                                 $<INSTALL_INTERFACE:include>)
  target_compile_definitions(chronormal_c PRIVATE CHRONORMAL_VERSION="${PROJECT_VERSION}")
  target_link_libraries(chronormal_c PRIVATE $<BUILD_INTERFACE:chronormal_io> $<BUILD_INTERFACE:chronormal_product_flags>)
  if(WIN32)
    set_target_properties(chronormal_c PROPERTIES PREFIX "" IMPORT_PREFIX "")
    target_link_options(chronormal_c PRIVATE -static)
  else()
    target_link_options(chronormal_c PRIVATE -Wl,--version-script=${symbols} -Wl,--no-undefined)
  endif()
  add_library(chronormal::chronormal_c ALIAS chronormal_c)
endif()

if(CHRONORMAL_FUZZ)
  # Fuzzing exercises the readers, which call no kernels. Kernels take long to compile with sanitizers, so they are
  # compiled without sanitizers.
  set_source_files_properties(${kernel_sources} PROPERTIES COMPILE_OPTIONS -fno-sanitize=all)
elseif(CHRONORMAL_SANITIZED)
  # The targets with sanitizers for addresses and undefined behaviour use an optimisation level that compiles fast.
  # Checks that double the compile time are left out: a null pointer crashes without a check, and clang's build (./test
  # --full fuzz) has all checks.
  set(sanitizers -fsanitize=address,undefined -fno-sanitize=null,object-size,vptr -fno-sanitize-recover=all)
  add_library(chronormal_sanitized_flags INTERFACE)
  target_link_libraries(chronormal_sanitized_flags INTERFACE chronormal_flags)
  target_compile_options(chronormal_sanitized_flags INTERFACE -O1 -g1 -fno-omit-frame-pointer ${sanitizers}
                                                              -fno-sanitize-address-use-after-scope)
  # Sanitizers describe every place in .data by pointers. A program that may be loaded at any address would relocate all
  # 1.5 million pointers at each start, and the tests start thousands of programs.
  target_link_options(chronormal_sanitized_flags INTERFACE ${sanitizers} -no-pie)
  chronormal_add_product(_sanitized chronormal_sanitized_flags)
  # Static libraries do not pass on link options by themselves, so the options are repeated here.
  target_link_options(chronormal_sanitized INTERFACE ${sanitizers})
endif()
