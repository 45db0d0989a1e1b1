# Sets the compiler options of every target of the project.
#
#   -ffp-contract=off                   a * b + c is rounded twice: the same bits from every compiler
#   -fno-math-errno -fno-trapping-math  let sqrt and selects become vector instructions; results do not change
#
# A parent project keeps its own build type and flags. Options for all targets are only set if this project is not a
# part of another one.
if(PROJECT_IS_TOP_LEVEL)
  if(NOT CMAKE_BUILD_TYPE AND NOT CMAKE_CONFIGURATION_TYPES)
    set(CMAKE_BUILD_TYPE Release CACHE STRING "" FORCE)
  endif()
  set(CMAKE_CXX_FLAGS_RELEASE "-O3")  # chronormal_product_flags alone decides if NDEBUG is defined
  set(CMAKE_CXX_FLAGS_RELWITHDEBINFO "-O2 -g")
  set(CMAKE_CXX_STANDARD 20)
  set(CMAKE_CXX_STANDARD_REQUIRED ON)
  set(CMAKE_CXX_EXTENSIONS OFF)
  set(CMAKE_EXPORT_COMPILE_COMMANDS ON)
endif()

add_library(chronormal_flags INTERFACE)
target_compile_options(
  chronormal_flags
  INTERFACE -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wsign-conversion
            -ffp-contract=off -fno-math-errno -fno-trapping-math)
if(CMAKE_CXX_COMPILER_ID STREQUAL "GNU" AND NOT CMAKE_BUILD_TYPE STREQUAL "Release")
  # At -O2, GCC 12 falsely warns of overruns in string + char* (its bug 105651), so these warnings are off. At -O3,
  # which ./test uses, GCC does not warn falsely, and the warnings are on.
  target_compile_options(chronormal_flags INTERFACE -Wno-array-bounds -Wno-restrict -Wno-stringop-overflow
                                                    -Wno-stringop-overread)
endif()
if(MINGW)
  # GCC wrongly assumes that the stack on Windows is aligned to 32 or 64 bytes (its bug 54412). The assembler therefore
  # replaces instructions that need this alignment. -mbig-obj allows the kernels more sections than an ordinary object
  # file may have.
  target_compile_options(chronormal_flags INTERFACE -Wa,-muse-unaligned-vector-move -Wa,-mbig-obj)
endif()
if(CHRONORMAL_WERROR)
  target_compile_options(chronormal_flags INTERFACE -Werror)
endif()
if(CHRONORMAL_SANITIZE)
  target_compile_options(chronormal_flags INTERFACE -fsanitize=${CHRONORMAL_SANITIZE} -fno-sanitize-recover=all
                                                    -fno-omit-frame-pointer)
  target_link_options(chronormal_flags INTERFACE -fsanitize=${CHRONORMAL_SANITIZE})
endif()
if(CHRONORMAL_FUZZ)
  target_compile_options(chronormal_flags INTERFACE -fsanitize=fuzzer-no-link)
endif()

# In Release, the product has no assertions. Tests and benchmarks run this product, since users get it. Assertions are
# on under sanitizers, in fuzz targets, and in every other build type.
add_library(chronormal_product_flags INTERFACE)
target_link_libraries(chronormal_product_flags INTERFACE chronormal_flags)
if(CMAKE_BUILD_TYPE STREQUAL "Release" AND NOT CHRONORMAL_FUZZ)
  target_compile_definitions(chronormal_product_flags INTERFACE NDEBUG)
endif()
